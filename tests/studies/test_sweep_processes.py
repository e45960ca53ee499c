"""Sweeps whose processes die, are interrupted, or work on a cluster: the results are those of one process."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, suppress
from pathlib import Path
from typing import Any

import numba
import psutil
import pytest
from threadpoolctl import threadpool_info

from fastpin.cli.main import main
from fastpin.model.case import Case
from fastpin.studies import sweep
from fastpin.studies.plan import Plan, Point, parse_plan, read_plan
from fastpin.studies.workers import Pace, Pool
from scripts.inline import Inline
from tests.support.outcomes import FILE
from tests.support.plans import FRICTION, assert_same_as_serial
from tests.support.processes import LONGEST, ROOT, fastpin, finished, python, started, without_progress
from tests.support.tiers import some_survey
from tests.support.turnstiles import Turnstile

pytestmark = pytest.mark.gate

OUTCOME = """
[outcomes]
pressure = { function = "mine.py:largest_pressure" }
"""


def threads() -> list[int]:
    """Threads of all BLAS and OpenMP libraries of this process, and of Numba."""
    return [library["num_threads"] for library in threadpool_info()] + [numba.config.NUMBA_NUM_THREADS]


class Poison:
    """A case that ends the process which unpacks it."""

    def __reduce__(self) -> Any:
        return os._exit, (9,)


def killer(victims: Callable[[], list[int]]) -> Callable[[int, int], None]:
    """A progress function that kills the first of some processes when the second run has ended."""

    def progress(ended: int, total: int) -> None:
        if ended == 2:
            os.kill(victims()[0], signal.SIGKILL)

    return progress


@pytest.fixture
def many_threads(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "NUMBA_NUM_THREADS"):
        monkeypatch.setenv(name, "2")


def test_a_worker_has_one_thread(many_threads: None) -> None:
    pool = Pool(1)
    try:
        found = pool.executor.submit(threads).result()
    finally:
        pool.stop(busy=False)
    assert len(found) > 1
    assert set(found) == {1}


def test_a_worker_of_others_has_one_thread(many_threads: None) -> None:
    code = (
        "from threadpoolctl import threadpool_info\nfrom fastpin.studies.workers import one_thread\n"
        "one_thread()\nprint({library['num_threads'] for library in threadpool_info()})"
    )
    assert finished(python(code)).stdout == "{1}\n"


def test_a_worker_that_is_killed_costs_nothing(tmp_path: Path) -> None:
    plan = parse_plan(FRICTION.replace("COUNT", "8"))

    victims = killer(lambda: [child.pid for child in workers(os.getpid())])
    summary = sweep.run(plan, tmp_path, workers=2, progress=victims)
    assert (summary.done, summary.failed, summary.waiting) == (8, [], 0)
    assert_same_as_serial(plan, tmp_path)


@pytest.mark.parametrize("size", some_survey([1, 3], 1))
def test_the_run_that_kills_its_worker_is_found(size: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Also among others of its batch."""
    monkeypatch.setattr(Pace, "size", lambda self, waiting: size)
    plan = parse_plan(FRICTION.replace("COUNT", "5"))
    guilty = plan.points[2]
    case = Plan.case

    def poisoned(self: Plan, point: Point) -> Case | Poison:
        return Poison() if point == guilty else case(self, point)

    monkeypatch.setattr(Plan, "case", poisoned)
    summary = sweep.run(plan, tmp_path, workers=2)
    assert (summary.done, summary.waiting) == (4, 0)
    ((point, reason),) = summary.failed
    assert point == guilty
    assert reason.startswith("the worker process died")
    monkeypatch.setattr(Plan, "case", case)
    assert sweep.run(plan, tmp_path, Inline()).ended == 0
    again = sweep.run(plan, tmp_path, Inline(), retry=True)
    assert (again.done, again.failed, again.ended) == (5, [], 1)
    assert_same_as_serial(plan, tmp_path)


def sweeping(path: Path, directory: Path, *folders: Path) -> AbstractContextManager[subprocess.Popen[str]]:
    """The command line's main process, leader of a process group as in a terminal."""
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(map(str, (*folders, ROOT)))}
    return started(fastpin("sweep", path, "-o", directory, "--workers", 2), env=environment)


@pytest.fixture
def turnstile(tmp_path: Path) -> Iterator[Turnstile]:
    found = Turnstile(tmp_path)
    yield found
    found.close()


def workers(main: int) -> list[psutil.Process]:
    """The worker processes of a main process."""
    found = []
    for child in psutil.Process(main).children(recursive=True):
        with suppress(psutil.Error):  # it has just ended
            if "spawn_main" in " ".join(child.cmdline()):
                found.append(child)
    return found


def test_workers_that_are_being_started_are_deaf_to_interrupts(tmp_path: Path, turnstile: Turnstile) -> None:
    path = tmp_path / "plan.toml"
    path.write_text(FRICTION.replace("COUNT", "12"))
    (tmp_path / "sitecustomize.py").write_text(
        f"import sys\nif 'spawn_main' in ' '.join(sys.orig_argv):\n    {turnstile.code}\n"
    )
    with sweeping(path, tmp_path / "out", tmp_path) as process:
        turnstile.come(2)
        os.killpg(process.pid, signal.SIGINT)
        turnstile.let_go(2)
        err = process.communicate()[1]
    assert process.returncode == 130
    assert (
        without_progress(err)
        == "fastpin: interrupted; 0 of 12 runs are finished and kept; the same command continues\n"
    )


@pytest.mark.survey
def test_an_interrupted_and_a_killed_sweep_go_on_with_their_outcomes(tmp_path: Path, turnstile: Turnstile) -> None:
    """Runs wait with their outcomes. So few are left that each is sent by itself."""
    path, directory = tmp_path / "plan.toml", tmp_path / "out"
    (tmp_path / "mine.py").write_text(FILE.replace("return Largest(", f"{turnstile.code}; return Largest("))
    path.write_text(FRICTION.replace("COUNT", "12") + OUTCOME)
    plan = read_plan(path)

    def let_end(runs: int, done: int) -> None:
        """Let so many more runs end, and wait until so many are kept."""
        turnstile.let_go(runs)
        while sweep.status(plan, directory).done < done:
            assert process.poll() is None
            time.sleep(0.005)

    with sweeping(path, directory) as process:
        let_end(3, 3)
        os.killpg(process.pid, signal.SIGINT)  # as Ctrl-C does: the workers are meant, too
        out, err = process.communicate()
    assert (process.returncode, out, sweep.status(plan, directory).done) == (130, "", 3)
    words = "fastpin: interrupted; 3 of 12 runs are finished and kept; the same command continues\n"
    assert without_progress(err) == words

    with sweeping(path, directory) as process:
        let_end(3, 6)
        left = workers(process.pid)
        process.kill()
        process.wait()
        assert len(left) == 2
        assert psutil.wait_procs(left, timeout=LONGEST)[1] == []
    known = [row for row in sweep.rows(plan, directory) if row["status"] == "done"]
    assert len(known) == 6
    assert all(row["pressure"] == row["max_pressure"] for row in known)  # they come with the end of the run

    turnstile.let_go(6)
    with sweeping(path, directory) as process:
        out, err = process.communicate()
    assert (process.returncode, without_progress(err)) == (0, "")
    assert f"12 runs in {directory}: 12 done, 0 failed, 0 waiting; 6 in " in out
    assert "were read from their results" not in out
    assert all(row["pressure"] == row["max_pressure"] for row in sweep.rows(plan, directory))
    assert list((directory / "results").iterdir()) == []
    assert_same_as_serial(plan, directory)


@pytest.mark.survey
def test_a_cluster_that_loses_a_worker(tmp_path: Path) -> None:
    from distributed import Client, LocalCluster

    plan = parse_plan(FRICTION.replace("COUNT", "12"))
    with (
        LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None, silence_logs=50) as cluster,
        Client(cluster) as client,
    ):
        pids = list(client.run(os.getpid).values())
        summary = sweep.run(plan, tmp_path, client.get_executor(), progress=killer(lambda: pids))
        assert len(set(pids)) == 2
        assert pids[0] not in client.run(os.getpid).values()

        (tmp_path / "plan.toml").write_text(plan.text)
        arguments = ["-o", str(tmp_path / "again"), "--dask", cluster.scheduler_address]
        assert main(["sweep", str(tmp_path / "plan.toml"), *arguments]) == 0
    assert (summary.done, summary.failed, summary.ended) == (12, [], 12)
    for directory in (tmp_path, tmp_path / "again"):
        assert_same_as_serial(plan, directory)


def test_a_script_that_its_workers_run_again_is_told(tmp_path: Path) -> None:
    script = tmp_path / "script.py"
    script.write_text(
        "from fastpin import studies\n"
        f"plan = studies.parse_plan({FRICTION.replace('COUNT', '3')!r})\n"
        f"studies.sweep.run(plan, {str(tmp_path / 'out')!r}, workers=1)\n"
    )
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    done = finished([sys.executable, script], check=False, env=environment)
    assert done.returncode == 1
    assert "must do so under if __name__" in done.stderr.splitlines()[-1]
    assert {row["status"] for row in sweep.load(tmp_path / "out")} == {"waiting"}
