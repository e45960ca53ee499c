"""Sweeps whose processes die, are interrupted, or work on a cluster: the results are those of one process."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numba
import psutil
import pytest
from plans import FRICTION, assert_same_as_serial
from threadpoolctl import threadpool_info

from fastpin import sweep
from fastpin.casefile import Case
from fastpin.plan import Plan, Point
from fastpin.pool import Pool

ROOT = Path(__file__).resolve().parents[1]


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
        "from threadpoolctl import threadpool_info\nfrom fastpin.worker import one_thread\n"
        "one_thread()\nprint({library['num_threads'] for library in threadpool_info()})"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT)
    assert done.stdout == "{1}\n"


def test_a_worker_that_is_killed_costs_nothing(tmp_path: Path) -> None:
    plan = sweep.parse_plan(FRICTION.replace("COUNT", "8"))

    def workers() -> list[int]:
        found = psutil.Process().children(recursive=True)
        return [child.pid for child in found if "spawn_main" in " ".join(child.cmdline())]

    summary = sweep.run(plan, tmp_path, workers=2, progress=killer(workers))
    assert (summary.done, summary.failed, summary.waiting) == (8, [], 0)
    assert_same_as_serial(plan, tmp_path)


def test_the_run_that_kills_its_worker_is_found(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    plan = sweep.parse_plan(FRICTION.replace("COUNT", "5"))
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
    assert sweep.run(plan, tmp_path, workers=1).ended == 0
    again = sweep.run(plan, tmp_path, workers=1, retry=True)
    assert (again.done, again.failed, again.ended) == (5, [], 1)
    assert_same_as_serial(plan, tmp_path)


def test_an_interrupted_and_a_killed_sweep_go_on(tmp_path: Path) -> None:
    path, directory = tmp_path / "plan.toml", tmp_path / "out"
    path.write_text(FRICTION.replace("COUNT", "41"))
    plan = sweep.read_plan(path)
    command = [sys.executable, "-m", "fastpin", "sweep", str(path), "-o", str(directory), "--workers", "2"]
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}

    def started() -> subprocess.Popen[str]:
        return subprocess.Popen(
            command, text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE, env=environment, start_new_session=True
        )

    def wait_for(done: int) -> None:
        until = time.monotonic() + 60.0
        while sweep.status(plan, directory).done < done:
            assert time.monotonic() < until
            time.sleep(0.005)

    with started() as main:
        wait_for(3)
        os.killpg(main.pid, signal.SIGINT)  # as Ctrl-C does: the workers are meant, too
        out, err = main.communicate(timeout=30)
    kept = sweep.status(plan, directory)
    assert main.returncode == 130
    assert 3 <= kept.done < 41
    assert out == ""
    assert err == f"fastpin: interrupted; {kept.done} of 41 runs are finished and kept; the same command goes on\n"

    with started() as main:
        wait_for(kept.done + 3)
        workers = psutil.Process(main.pid).children(recursive=True)
        main.kill()
        main.communicate(timeout=30)
    assert psutil.wait_procs(workers, timeout=10)[1] == []
    before = sweep.status(plan, directory).done
    assert kept.done + 3 <= before < 41

    done = subprocess.run(command, capture_output=True, text=True, env=environment, check=False)
    assert done.returncode == 0
    assert f"41 runs in {directory}: 41 done, 0 failed, 0 waiting; {41 - before} in " in done.stdout
    assert {file.name for file in (directory / "results").iterdir()} == {f"{run}.h5" for run in plan.runs}
    assert_same_as_serial(plan, directory)


def test_a_cluster_that_loses_a_worker(tmp_path: Path) -> None:
    from distributed import Client, LocalCluster

    plan = sweep.parse_plan(FRICTION.replace("COUNT", "12"))
    with (
        LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None, silence_logs=50) as cluster,
        Client(cluster) as client,
    ):
        pids = list(client.run(os.getpid).values())
        summary = sweep.run(plan, tmp_path, client.get_executor(), progress=killer(lambda: pids))
        assert len(set(pids)) == 2
        assert pids[0] not in client.run(os.getpid).values()
    assert (summary.done, summary.failed, summary.ended) == (12, [], 12)
    assert_same_as_serial(plan, tmp_path)
