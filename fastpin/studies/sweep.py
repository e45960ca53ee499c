"""Parameter sweeps: many workers solve the runs of a plan. A directory holds the index and the results.

    >>> from fastpin.studies import read_plan, sweep
    >>> plan = read_plan("plan.toml")                               # doctest: +SKIP
    >>> summary = sweep.run(plan, "plan")                           # doctest: +SKIP
    >>> rows = sweep.load("plan")                                   # doctest: +SKIP

Finished runs are skipped. Thus a sweep continues after a stop, a kill or an extension of its plan.
"""

from __future__ import annotations

import os
import shutil
import time
from collections.abc import Callable, Collection, Generator, Iterable, Sequence
from concurrent.futures import Executor, Future
from contextlib import closing
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from threadpoolctl import threadpool_limits

from fastpin.errors import FastpinError, InputError
from fastpin.kernels.threads import cores
from fastpin.model.checks import as_toml, check_callable, file_path, instance, items, true_or_false, whole_number
from fastpin.storage.files import replacing
from fastpin.studies.index import DONE, FAILED, FILE, WAITING, Index, ensure_directory, has_index, lock_directory
from fastpin.studies.outcomes import OutcomeValue, pickled
from fastpin.studies.plan import Plan, Point
from fastpin.studies.run_end import RunEnd
from fastpin.studies.workers import DIED, BrokenError, PickledOutcomes, Submit, read_run, run_tasks, solve_run
from fastpin.version import __version__

RESULTS = "results"
"""Folder of the results in the directory of a sweep."""

HDF5 = b"\x89HDF\r\n\x1a\n"
"""First bytes of an HDF5 file."""

PLAN = "plan.toml"
"""Name of the plan's copy in the directory of a sweep."""

MUST_AGREE = ("states", "nodes", "peak_pressure", "max_pressure", "contact_width")
"""Key figures that agree to :data:`AGREEMENT` in two solutions of one run, also from different machines."""

AGREEMENT = 1e-6
"""Largest relative difference of these key figures."""

Progress = Callable[[int, int], None]
"""Receives the number of ended runs and the number of all runs."""


@dataclass(frozen=True)
class Summary:
    """The progress of a plan.

    Attributes
    ----------
    done, waiting : int
        Numbers of finished and of waiting runs.
    failed : list of (Point, str)
        Failed runs, each with its reason.
    ended : int
        Number of runs that ended in this call, done or failed.
    seconds : float
        Wall time of this call with all workers, s.
    read : int
        Number of finished runs whose outcomes were read from their results in this call.
    unread : list of (Point, str, str)
        Outcomes of finished runs that could not be read: the run, the name of the outcome and the reason.
    """

    done: int
    waiting: int
    failed: list[tuple[Point, str]]
    ended: int = 0
    seconds: float = 0.0
    read: int = 0
    unread: list[tuple[Point, str, str]] = field(default_factory=list)

    @property
    def total(self) -> int:
        """Number of all runs."""
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
    """Solve all unfinished runs of a plan, and read the outcomes of all runs.

    An outcome that is new in the plan is read from the stored results of finished runs, which are not solved again.

    Parameters
    ----------
    plan : Plan
        A function of :meth:`Plan.with_outcomes` runs in the workers, which import it by its name.
    directory : path
        Folder of the index (``index.sqlite``), the results (``results/ID.h5``) and a copy of the plan. It is created if
        there is none. A changed plan may use the same directory: common runs are not solved again.
    executor : Executor, optional
        An object with the interface of :mod:`concurrent.futures`, such as ``client.get_executor()`` of a dask cluster.
        Its workers must see the directory under the same path. Without an executor the function starts processes on
        this machine, each with one thread for BLAS. It must then be called under ``if __name__ == "__main__"``.
    workers : int, optional
        Number of these processes. By default the number of processors that this process may use.
    retry : bool
        Also solve runs that failed before, and read outcomes that could not be read before.
    shard : (int, int), optional
        (i, n): solve only the i-th of n parts, i from 1 to n. Every part needs a separate directory; see
        :func:`merge`.
    progress : callable, optional
        Called as ``progress(ended, all)`` with numbers of runs, at the beginning and when a run has ended or its
        outcomes have been read.

    Returns
    -------
    Summary
        The progress of the plan, or of the part.

    Raises
    ------
    InputError
        If an argument is out of range, another sweep runs in the directory, or its files can't be used.
    FastpinError
        If the executor breaks. Finished runs stay in the directory.
    """
    points = shard_of(plan, shard)
    true_or_false("retry", retry)
    if executor is not None and not callable(getattr(executor, "submit", None)):
        raise InputError("executor", f"must be an executor of concurrent.futures, not {as_toml(executor)}")
    check_callable("progress", progress)
    workers = cores() if workers is None else whole_number("workers", workers, 1)
    content = _pickled_outcomes(plan)
    directory = ensure_directory(file_path("directory", directory))
    with lock_directory(directory):
        _check_plan_copy(directory, plan.text)
        with Index(directory, create=True) as index:
            results = ensure_directory(directory / RESULTS).resolve()
            _clear(results)
            _keep_plan(directory, plan.text)
            index.expect(plan, points.values())
            if retry:
                index.forget_unread()
            skipped = (DONE,) if retry else (DONE, FAILED)
            todo = [run for run, (state, _) in _now(index, points, results).items() if state not in skipped]
            missing = _missing_outcomes(index, plan, points, results)
            work = _Work(plan, results, content, executor, workers)
            report = progress or (lambda ended, all_runs: None)
            began = time.perf_counter()
            report(0, len(todo) + len(missing))
            with closing(work.solve(todo)) as ends:
                for ended, end in enumerate(ends, start=1):
                    index.record(end)
                    report(ended, len(todo) + len(missing))
            missing = _missing_outcomes(index, plan, points, results)  # Also of runs that were solved again alone.
            with closing(work.read(missing)) as ends:
                for ended, end in enumerate(ends, start=len(todo) + 1):
                    index.record_outcomes(end.id, end.outcomes)
                    report(ended, len(todo) + len(missing))
            summary = _summary(index, plan, points, results)
            return replace(summary, ended=len(todo), seconds=time.perf_counter() - began, read=len(missing))


def status(plan: Plan, directory: str | Path, shard: tuple[int, int] | None = None) -> Summary:
    """Return the progress of a plan without solving a run.

    Raises
    ------
    InputError
        If the index can't be used, or `shard` is out of range.
    """
    points, directory = shard_of(plan, shard), file_path("directory", directory)
    if not has_index(directory):
        return Summary(0, len(points), [])
    with Index(directory) as index:
        return _summary(index, plan, points, directory / RESULTS)


def load(directory: str | Path) -> list[dict[str, Any]]:
    """Read all rows of the index in a directory, one for each run.

    ``pandas.DataFrame(load(directory))`` makes a table of them.

    Returns
    -------
    list of dict
        Keys are "id", "status" ("waiting", "done", "failed"), "reason" (of a failure), "dimensionless" (1 for units of
        the paper, 0 for SI), the key figures (:data:`fastpin.studies.run_end.KEY_FIGURES`), "seconds", "started" (UTC),
        "host", "versions" and "input" (dicts), the varied fields, such as "contact.friction", and the outcomes that are
        known of the run. None stands for an unknown value.

    Raises
    ------
    InputError
        If the directory holds no index, or the index can't be used.
    """
    with Index(file_path("directory", directory)) as index:
        outcomes = index.outcomes()
        return [
            row | {name: value.value for name, value in outcomes.get(row["id"], {}).items()} for row in index.rows()
        ]


def rows(plan: Plan, directory: str | Path) -> list[dict[str, Any]]:
    """Return one row for each point of a plan, in the order of the plan, with the keys of :func:`load`.

    The outcomes are those of the plan; None stands for a value that is not known. The row of a point that is not in the
    index has only its status "waiting", reason, id, fields and outcomes.

    Raises
    ------
    InputError
        If the index can't be used.
    """
    instance("plan", plan, Plan, "a Plan")
    known_rows: dict[str, dict[str, Any]] = {}
    outcomes: dict[str, dict[str, OutcomeValue]] = {}
    if has_index(file_path("directory", directory)):
        with Index(file_path("directory", directory)) as index:
            known_rows, outcomes = {row["id"]: row for row in index.rows()}, index.outcomes()
    found = []
    for point in plan.points:
        row = known_rows.get(point.id, {"status": WAITING, "reason": None})
        values = outcomes.get(point.id, {}) if row["status"] == DONE else {}
        chosen = {name: value.value for name, value in values.items() if _is_of(plan, name, value)}
        fields = dict.fromkeys(plan.fields) | point.values
        found.append({**row, "id": point.id, **fields, **dict.fromkeys(plan.outcomes), **chosen})
    return found


def shard_of(plan: Plan, shard: tuple[int, int] | None) -> dict[str, Point]:
    """Return the runs of one part by id, or all runs. Of the sorted ids, every n-th belongs to the same part.

    Raises
    ------
    InputError
        If `shard` is out of range.
    """
    runs = instance("plan", plan, Plan, "a Plan").runs
    if shard is None:
        return runs
    numbers = items("shard", shard, "two numbers, i and n")
    if len(numbers) != 2:
        raise InputError("shard", f"must be two numbers, i and n, not {as_toml(shard)}")
    part, count = numbers
    whole_number("shard", count, 1)
    if not 1 <= whole_number("shard", part, 1) <= count:
        raise InputError("shard", f"must be i/n with i from 1 to n, not {part}/{count}")
    chosen = set(sorted(runs)[part - 1 :: count])
    return {run: point for run, point in runs.items() if run in chosen}


# -- running and status --------------------------------------------------------------------------------------


def _pickled_outcomes(plan: Plan) -> PickledOutcomes:
    """Return the outcomes of a plan for workers."""
    content = {}
    for name, outcome in plan.outcomes.items():
        try:
            content[name] = outcome.definition, pickled(outcome)
        except FastpinError as error:
            raise InputError("outcomes", f"{name}: {error}") from None
    return content


def _missing_outcomes(index: Index, plan: Plan, points: dict[str, Point], results: Path) -> dict[str, list[str]]:
    """Return the names of the outcomes that finished runs lack, by run."""
    if not plan.outcomes:
        return {}
    known = index.outcomes()
    missing = {
        run: [name for name in plan.outcomes if name not in known.get(run, {})]
        for run, (state, _) in _now(index, points, results).items()
        if state == DONE
    }
    return {run: names for run, names in missing.items() if names}


class _Work:
    """The tasks of one call: runs that are solved, and finished runs whose outcomes are read."""

    def __init__(
        self, plan: Plan, results: Path, outcomes: PickledOutcomes, executor: Executor | None, workers: int
    ) -> None:
        self._plan, self._results, self._outcomes = plan, results, outcomes
        self._executor, self._workers = executor, workers
        self._submitted: set[str] = set()

    def solve(self, todo: Collection[str]) -> Generator[RunEnd, None, None]:
        """Yield the end of each run when it ends."""
        with closing(self._run(todo, self._submit_solve)) as ended:
            for run, end in ended:
                yield _check_end(run, end, self._results)

    def read(self, missing: dict[str, list[str]]) -> Generator[RunEnd, None, None]:
        """Yield the outcomes of finished runs, when they are read. `missing` has their names by run."""

        def submit(executor: Executor, run: str) -> Future[RunEnd]:
            wanted = {name: self._outcomes[name] for name in missing[run]}
            return executor.submit(read_run, run, self._path(run), wanted, os.getpid(), __version__)

        with closing(self._run(missing, submit)) as ended:
            for run, unchecked in ended:
                end = _as_end(run, unchecked)
                lost = {name: OutcomeValue(self._outcomes[name][0], None, end.reason) for name in missing[run]}
                yield end if end.reason is None else RunEnd(run, None, outcomes=lost)

    def _submit_solve(self, executor: Executor, run: str) -> Future[RunEnd]:
        """Submit a run. If its worker died, perhaps in a function of the user, its outcomes are left for later."""
        outcomes = {} if run in self._submitted else self._outcomes
        self._submitted.add(run)
        case = self._plan.case(self._plan.runs[run])
        return executor.submit(solve_run, run, case, self._path(run), outcomes, os.getpid(), __version__)

    def _run(
        self, tasks: Collection[str], submit: Submit[str, RunEnd]
    ) -> Generator[tuple[str, RunEnd | BaseException], None, None]:
        if not tasks:
            return
        # An executor may run its tasks in this process. They have one thread for BLAS, as in every worker.
        with threadpool_limits(limits=1, user_api="blas"):
            try:
                ended = run_tasks(self._executor, self._workers, tasks, submit)
                with closing(ended):
                    yield from ended
            except BrokenError:
                raise FastpinError("the executor has stopped working; runs that are finished are kept") from None

    def _path(self, run: str) -> str:
        return str(self._results / f"{run}.h5")


def _as_end(run: str, end: RunEnd | BaseException) -> RunEnd:
    """Return the end of a run. An exception of the worker becomes a failure."""
    if not isinstance(end, BaseException):
        return end
    died = type(end).__name__ in ("WorkerDiedError", "KilledWorker")  # KilledWorker is dask's.
    return RunEnd(run, DIED if died else f"{type(end).__name__}: {end}")


def _check_end(run: str, end: RunEnd | BaseException, results: Path) -> RunEnd:
    """Return the end of a run. An exception of the worker, or a missing result, becomes a failure."""
    end = _as_end(run, end)
    if end.reason is None and not (results / f"{run}.h5").exists():
        return RunEnd(run, f"the result did not arrive: {end.host} must see {results} under the same path")
    return end


def _now(index: Index, points: Iterable[str], results: Path) -> dict[str, tuple[str, str | None]]:
    """Return status and reason of each run. A done run without its result file is waiting again."""
    present = {path.stem for path in results.glob("[!.]*.h5") if _is_hdf5(path)}  # Unfinished files begin with a dot.
    waiting = WAITING, None
    known = index.statuses()
    stored = {run: known.get(run, waiting) for run in points}
    return {run: waiting if entry[0] == DONE and run not in present else entry for run, entry in stored.items()}


def _is_hdf5(path: Path) -> bool:
    """Whether a file begins with the signature of HDF5."""
    try:
        with path.open("rb") as file:
            return file.read(len(HDF5)) == HDF5
    except OSError:
        return False


def _summary(index: Index, plan: Plan, points: dict[str, Point], results: Path) -> Summary:
    statuses = _now(index, points, results)
    failed = [(points[run], reason or "") for run, (state, reason) in statuses.items() if state == FAILED]
    done, waiting = (sum(state == wanted for state, _ in statuses.values()) for wanted in (DONE, WAITING))
    unread = [
        (points[run], name, value.reason)
        for run, values in index.outcomes().items()
        if statuses.get(run, (WAITING, None))[0] == DONE
        for name, value in values.items()
        if value.reason is not None and _is_of(plan, name, value)
    ]
    return Summary(done, waiting, failed, unread=unread)


def _is_of(plan: Plan, name: str, value: OutcomeValue) -> bool:
    """Whether the value belongs to an outcome of the plan, with the same definition."""
    return name in plan.outcomes and plan.outcomes[name].definition == value.definition


def _check_plan_copy(directory: Path, text: str = "") -> None:
    """Raise :class:`InputError` if the copy of the plan would overwrite another file of the user."""
    path = directory / PLAN
    if path.exists() and not (directory / FILE).exists() and path.read_bytes() != text.encode():
        raise InputError(str(directory), f"holds another {PLAN}, but no sweep; choose another directory")


def _keep_plan(directory: Path, text: str) -> None:
    with replacing(directory / PLAN) as temporary:
        temporary.write_text(text, encoding="utf-8")


def _clear(results: Path) -> None:
    """Remove the partly written files of killed workers."""
    for path in results.glob(".*.h5"):
        path.unlink(missing_ok=True)


# -- merging -------------------------------------------------------------------------------------------------


def merge(sources: Sequence[str | Path], directory: str | Path) -> int:
    """Join the directories of the parts of one plan.

    A run that is done in one part is done. A run that failed in one part and waits in another part has failed. Result
    files are copied.

    Parameters
    ----------
    sources : sequence of paths
        Directories of the parts.
    directory : path
        Directory of the whole. It is created if there is none. Its runs of the same plan stay.

    Returns
    -------
    int
        Number of runs in the index of `directory` now.

    Raises
    ------
    InputError
        If the parts belong to different plans or versions of fastpin, two results of one run disagree, or files can't
        be used.
    """
    target = file_path("directory", directory)
    if isinstance(sources, str | Path):
        raise InputError("sources", f"must be a list of directories, not {as_toml(str(sources))}")
    parts = [file_path("sources", source) for source in items("sources", sources, "a list of directories")]
    for source in parts:
        if source.resolve() == target.resolve():
            raise InputError(str(source), "can't be merged into itself")
    _check_parts([*([target] if (target / FILE).exists() else []), *parts])
    _check_plan_copy(ensure_directory(target))
    with lock_directory(target), Index(target, create=True) as index:
        ensure_directory(target / RESULTS)
        for source in parts:
            with Index(source) as other:
                _absorb(index, other, target, source)
        return len(index.statuses())


def _check_parts(parts: Sequence[Path]) -> None:
    """Check, before any writing, that all parts belong to one plan and agree."""
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
    """Copy the runs of another part, with their results, if their status there is better, or they are new here."""
    statuses = index.statuses()
    rank = (WAITING, FAILED, DONE)
    wanted = [
        run
        for run, (state, _) in other.statuses().items()
        if run not in statuses or rank.index(state) > rank.index(statuses[run][0])
    ]
    for run in wanted:
        path = source / RESULTS / f"{run}.h5"
        if path.exists():
            with replacing(target / RESULTS / path.name) as temporary:
                shutil.copyfile(path, temporary)
    index.absorb(other, wanted)
    _keep_plan(target, index.read_note("text") or "")


def _check_agreement(first_row: dict[str, Any], second_row: dict[str, Any], source: Path) -> None:
    for name in MUST_AGREE:
        first, second = first_row[name], second_row[name]
        if first is None or second is None:
            raise InputError(str(source), f"run {first_row['id']} is done, but has no {name}")
        if abs(first - second) > AGREEMENT * max(abs(first), abs(second)):
            raise InputError(str(source), f"run {first_row['id']} has {name} = {second:.9g}, elsewhere {first:.9g}")
