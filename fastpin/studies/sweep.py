"""Parameter sweeps: the runs of a plan solved by many workers, with an index and the results in a directory.

    >>> import fastpin.sweep
    >>> plan = fastpin.sweep.read_plan("plan.toml")                 # doctest: +SKIP
    >>> summary = fastpin.sweep.run(plan, "plan")                   # doctest: +SKIP
    >>> rows = fastpin.sweep.load("plan")                           # doctest: +SKIP

What is finished is skipped, so a sweep that was stopped, killed or whose plan has grown goes on where it was.
"""

from __future__ import annotations

import os
import shutil
import time
from collections.abc import Callable, Generator, Iterable, Sequence
from concurrent.futures import Executor, Future
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from threadpoolctl import threadpool_limits

from fastpin.errors import FastpinError, InputError
from fastpin.model.checks import whole_number
from fastpin.storage.files import replacing
from fastpin.studies.index import DONE, FAILED, FILE, WAITING, Index, ensure_directory, has_index, lock_directory
from fastpin.studies.outcome import Outcome
from fastpin.studies.plan import Plan, Point
from fastpin.studies.workers import DIED, BrokenError, cores, run_tasks, solve_run
from fastpin.version import __version__

RESULTS = "results"
HDF5 = b"\x89HDF\r\n\x1a\n"
PLAN = "plan.toml"
MUST_AGREE = ("states", "nodes", "peak_pressure", "max_pressure", "contact_width")
"""Key figures in which two solutions of one run agree to :data:`AGREEMENT`, also from different machines."""

AGREEMENT = 1e-6

Progress = Callable[[int, int], None]


@dataclass(frozen=True)
class Summary:
    """How far a plan is.

    Attributes
    ----------
    done, waiting : int
        Numbers of runs.
    failed : list of (Point, str)
        Runs that failed, and why.
    ended : int
        Runs that ended in this call, done or failed.
    seconds : float
        Time that they took together, with all workers.
    """

    done: int
    waiting: int
    failed: list[tuple[Point, str]]
    ended: int = 0
    seconds: float = 0.0

    @property
    def total(self) -> int:
        """Number of runs."""
        return self.done + self.waiting + len(self.failed)


def run(
    plan: Plan,
    directory: str | Path,
    executor: Executor | None = None,
    workers: int | None = None,
    retry: bool = False,
    shard: tuple[int, int] | None = None,
    progress: Progress | None = None,
) -> Summary:
    """Solve all runs of a plan that are not finished yet.

    Parameters
    ----------
    plan : Plan
    directory : path
        For the index (``index.sqlite``), the results (``results/ID.h5``) and a copy of the plan; made if there is
        none. A plan that was changed may use the same one: runs that both have are not solved again.
    executor : Executor, optional
        Anything that has the interface of :mod:`concurrent.futures`, such as ``client.get_executor()`` of a dask
        cluster; its workers must see the directory under the same path. Without one, processes of this machine are
        started, each with one thread for BLAS; the function must then be called under ``if __name__ == "__main__"``.
    workers : int, optional
        Number of these processes; by default that of the processors that this process may use.
    retry : bool
        Also solve what failed before.
    shard : (int, int), optional
        (i, n): only the i-th of n parts, i from 1 to n. Every part needs a directory of its own; see :func:`merge`.
    progress : callable, optional
        Called as ``progress(ended, all)`` with numbers of runs, at the beginning and when a run ends.

    Returns
    -------
    Summary
        Of all runs of the plan, or of the part.

    Raises
    ------
    InputError
        If an argument is out of range, another sweep runs in the directory, or its files can't be used.
    FastpinError
        If the executor breaks. What is finished is kept.
    """
    points = shard_of(plan, shard)
    workers = cores() if workers is None else whole_number("workers", workers, 1)
    directory = ensure_directory(Path(directory))
    with lock_directory(directory):
        _check_plan_copy(directory, plan.text)
        with Index(directory, create=True) as index:
            results = ensure_directory(directory / RESULTS).resolve()
            _clear(results)
            _keep_plan(directory, plan.text)
            index.expect(plan, points.values())
            before = _now(index, points, results)
            unwanted = (DONE,) if retry else (DONE, FAILED)
            todo = [run for run, (state, _) in before.items() if state not in unwanted]
            began = time.perf_counter()
            report = progress or (lambda ended, all_runs: None)
            report(0, len(todo))
            with closing(_outcomes(plan, points, todo, results, executor, workers)) as outcomes:
                for ended, outcome in enumerate(outcomes, start=1):
                    index.record(outcome)
                    report(ended, len(todo))
            return _summary(index, points, results, len(todo), time.perf_counter() - began)


def status(plan: Plan, directory: str | Path, shard: tuple[int, int] | None = None) -> Summary:
    """How far a plan is, without running anything.

    Raises
    ------
    InputError
        If the index can't be used, or `shard` is out of range.
    """
    points, directory = shard_of(plan, shard), Path(directory)
    if not has_index(directory):
        return Summary(0, len(points), [])
    with Index(directory) as index:
        return _summary(index, points, directory / RESULTS)


def load(directory: str | Path) -> list[dict[str, Any]]:
    """All rows of the index in a directory, one a run: ``pandas.DataFrame(load(directory))`` is a table.

    Returns
    -------
    list of dict
        Keys are "id", "status" ("waiting", "done", "failed"), "reason" (of a failure), "dimensionless" (1 for units of
        the paper, 0 for SI), the key figures (:data:`fastpin.keyfigures.KEY_FIGURES`), "seconds", "started" (UTC),
        "host", "versions" and "input" (dicts), and the varied fields, such as "contact.friction". None stands for what
        is not known.

    Raises
    ------
    InputError
        If the directory holds no index, or it can't be used.
    """
    with Index(Path(directory)) as index:
        return index.rows()


def rows(plan: Plan, directory: str | Path) -> list[dict[str, Any]]:
    """As :func:`load`, but one row for each point of a plan and in its order; a point not in the index is waiting."""
    known = {row["id"]: row for row in load(directory)} if has_index(Path(directory)) else {}
    nothing = {"status": WAITING, "reason": None}
    return [
        {**known.get(point.id, nothing), "id": point.id, **dict.fromkeys(plan.fields), **point.values}
        for point in plan.points
    ]


def shard_of(plan: Plan, shard: tuple[int, int] | None) -> dict[str, Point]:
    """The runs of one part, by id, or all: every n-th id in their order is in the same part."""
    runs = plan.runs
    if shard is None:
        return runs
    part, count = shard
    whole_number("shard", count, 1)
    if not 1 <= whole_number("shard", part, 1) <= count:
        raise InputError("shard", f"must be i/n with i from 1 to n, not {part}/{count}")
    chosen = set(sorted(runs)[part - 1 :: count])
    return {run: point for run, point in runs.items() if run in chosen}


# -- running -------------------------------------------------------------------------------------------------


def _outcomes(
    plan: Plan, points: dict[str, Point], todo: list[str], results: Path, executor: Executor | None, workers: int
) -> Generator[Outcome, None, None]:
    """How each of the runs ends, in the order in which they do."""

    def submit(executor: Executor, run: str) -> Future[Outcome]:
        path = str(results / f"{run}.h5")
        return executor.submit(solve_run, run, plan.case(points[run]), path, os.getpid(), __version__)

    if not todo:
        return
    # One thread for BLAS, as in every worker, where an executor runs its tasks in this process.
    ended = run_tasks(executor, workers, todo, submit)
    with threadpool_limits(limits=1, user_api="blas"), closing(ended):
        try:
            for run, outcome in ended:
                yield _check_outcome(run, outcome, results)
        except BrokenError:
            raise FastpinError("the executor has stopped working; runs that are finished are kept") from None


def _check_outcome(run: str, outcome: Outcome | BaseException, results: Path) -> Outcome:
    """The outcome of a run, whatever its worker returned or raised."""
    if isinstance(outcome, BaseException):
        died = type(outcome).__name__ in ("WorkerDiedError", "KilledWorker")  # the latter is dask's
        return Outcome(run, DIED if died else f"{type(outcome).__name__}: {outcome}")
    if outcome.reason is None and not (results / f"{run}.h5").exists():
        return Outcome(run, f"the result did not arrive: {outcome.host} must see {results} under the same path")
    return outcome


def _now(index: Index, points: Iterable[str], results: Path) -> dict[str, tuple[str, str | None]]:
    """Status and reason of each run; one whose result is gone is waiting again."""
    present = {path.stem for path in results.glob("[!.]*.h5") if _is_hdf5(path)}  # not what is being written
    waiting = WAITING, None
    known = index.statuses()
    found = {run: known.get(run, waiting) for run in points}
    return {run: waiting if now[0] == DONE and run not in present else now for run, now in found.items()}


def _is_hdf5(path: Path) -> bool:
    """Whether a file begins as a result does."""
    try:
        with path.open("rb") as file:
            return file.read(len(HDF5)) == HDF5
    except OSError:
        return False


def _summary(index: Index, points: dict[str, Point], results: Path, ended: int = 0, seconds: float = 0.0) -> Summary:
    now = _now(index, points, results)
    failed = [(points[run], reason or "") for run, (state, reason) in now.items() if state == FAILED]
    done, waiting = (sum(state == wanted for state, _ in now.values()) for wanted in (DONE, WAITING))
    return Summary(done, waiting, failed, ended, seconds)


def _check_plan_copy(directory: Path, text: str = "") -> None:
    """The copy of a plan must not take the place of another file of the user's."""
    path = directory / PLAN
    if path.exists() and not (directory / FILE).exists() and path.read_bytes() != text.encode():
        raise InputError(str(directory), f"holds another {PLAN}, but no sweep; choose another directory")


def _keep_plan(directory: Path, text: str) -> None:
    with replacing(directory / PLAN) as temporary:
        temporary.write_text(text, encoding="utf-8")


def _clear(results: Path) -> None:
    """Remove what workers that were killed left half written."""
    for path in results.glob(".*.h5"):
        path.unlink(missing_ok=True)


# -- merging -------------------------------------------------------------------------------------------------


def merge(sources: Sequence[str | Path], directory: str | Path) -> int:
    """Join the directories of the parts of one plan.

    What is done anywhere is done; what failed in one part and waits in another has failed. Result files are copied.

    Parameters
    ----------
    sources : sequence of paths
    directory : path
        Made if there is none; what it holds of the same plan stays.

    Returns
    -------
    int
        Number of runs that are known now.

    Raises
    ------
    InputError
        If the parts are of different plans or versions of fastpin, two results of one run disagree, or files can't be
        used.
    """
    target = Path(directory)
    for source in map(Path, sources):
        if source.resolve() == target.resolve():
            raise InputError(str(source), "can't be merged into itself")
    _check_parts([*([target] if (target / FILE).exists() else []), *map(Path, sources)])
    _check_plan_copy(ensure_directory(target))
    with lock_directory(target), Index(target, create=True) as index:
        ensure_directory(target / RESULTS)
        for source in map(Path, sources):
            with Index(source) as other:
                _absorb(index, other, target, source)
        return len(index.statuses())


def _check_parts(parts: Sequence[Path]) -> None:
    """See that all parts are of one plan and agree, before anything is written."""
    notes: dict[str, str | None] = {}
    done: dict[str, dict[str, Any]] = {}
    for part in parts:
        with Index(part) as index:
            for name, words in (
                ("version", "was made by another version of fastpin"),
                ("plan", "belongs to another plan"),
            ):
                if notes.setdefault(name, index.read_note(name)) != index.read_note(name):
                    raise InputError(str(part), f"{words} than {parts[0]}")
            for row in index.rows():
                if row["status"] == DONE:
                    _check_agreement(done.setdefault(row["id"], row), row, part)


def _absorb(index: Index, other: Index, target: Path, source: Path) -> None:
    mine = index.statuses()
    rank = (WAITING, FAILED, DONE)
    wanted = [
        run
        for run, (state, _) in other.statuses().items()
        if run not in mine or rank.index(state) > rank.index(mine[run][0])
    ]
    for run in wanted:
        path = source / RESULTS / f"{run}.h5"
        if path.exists():
            with replacing(target / RESULTS / path.name) as temporary:
                shutil.copyfile(path, temporary)
    index.absorb(other, wanted)
    _keep_plan(target, index.read_note("text") or "")


def _check_agreement(one: dict[str, Any], two: dict[str, Any], source: Path) -> None:
    for name in MUST_AGREE:
        first, second = one[name], two[name]
        if abs(first - second) > AGREEMENT * max(abs(first), abs(second)):
            raise InputError(str(source), f"run {one['id']} has {name} = {second:.9g}, elsewhere {first:.9g}")
