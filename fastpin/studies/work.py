"""The tasks of a sweep: batches of runs for the workers, and what comes back."""

from __future__ import annotations

import os
from collections.abc import Collection, Generator
from concurrent.futures import Executor, Future
from contextlib import closing
from pathlib import Path

from threadpoolctl import threadpool_limits

from fastpin.errors import FastpinError, InputError
from fastpin.studies.index import Index
from fastpin.studies.outcomes import OutcomeValue, check_loadable, pickled
from fastpin.studies.plan import Plan
from fastpin.studies.run_end import RunEnd
from fastpin.studies.workers import (
    DIED,
    Batch,
    BrokenError,
    PickledOutcomes,
    Setting,
    Size,
    Submit,
    in_turn,
    read_run,
    run_tasks,
    solve_run,
)
from fastpin.version import __version__

MOST_PACKED = 1_000_000
"""Largest result that is kept in the index, bytes. HDF5 takes little of the time of a larger one, and compresses it."""

BATCH_SECONDS = 0.25
"""Time of a batch of runs, s. A kill loses the unfinished batches; a message and a commit take some 5 ms."""

MOST_IN_BATCH = 32
"""Most runs of a batch."""


def pickled_outcomes(plan: Plan) -> PickledOutcomes:
    """Return the outcomes of a plan for workers. The files of functions are run, to find their faults early."""
    check_loadable(plan.outcomes)
    content = {}
    for name, outcome in plan.outcomes.items():
        try:
            content[name] = outcome.definition, pickled(outcome)
        except FastpinError as error:
            raise InputError("outcomes", f"{name}: {error}") from None
    return content


class Work:
    """The tasks of one call: runs that are solved, and finished runs whose outcomes are read."""

    def __init__(
        self,
        plan: Plan,
        index: Index,
        results: Path,
        outcomes: PickledOutcomes,
        executor: Executor | None,
        workers: int,
        files: bool,
    ) -> None:
        self._plan, self._index, self._results, self._outcomes = plan, index, results, outcomes
        self._executor, self._workers = executor, workers
        self._setting = Setting(os.getpid(), __version__, 0 if files else MOST_PACKED)
        self._submitted: set[str] = set()

    def solve(self, todo: Collection[str]) -> Generator[list[RunEnd], None, None]:
        """Yield the ends of the runs of each batch when it ends."""
        pace, todo = Pace(self._workers), neighbours(self._plan, todo)
        for run in todo:
            self._path(run).unlink(missing_ok=True)  # A damaged file, or the states of a failed run.
        with closing(self._run(todo, self._submit_solve, pace.size)) as ended:
            for ends in ended:
                pace.learn(ends)
                yield [_arrived(end, self._path(end.id)) for end in ends]

    def read(self, missing: dict[str, list[str]]) -> Generator[list[RunEnd], None, None]:
        """Yield the outcomes of finished runs, when they are read. `missing` has their names by run."""

        def submit(executor: Executor, batch: Batch[str]) -> Future[list[RunEnd]]:
            tasks = []
            for run in batch:
                path = self._path(run)
                packed = None if path.exists() else self._index.content(run)
                wanted = {name: self._outcomes[name] for name in missing[run]}
                tasks.append((run, str(path), packed, wanted, self._setting))
            return executor.submit(in_turn, read_run, tasks)

        pace = Pace(self._workers)
        with closing(self._run(missing, submit, pace.size)) as ended:
            for ends in ended:
                pace.learn(ends)
                yield [end if end.reason is None else self._lost(end, missing[end.id]) for end in ends]

    def _lost(self, end: RunEnd, names: list[str]) -> RunEnd:
        """The end of a run whose outcomes could not be read."""
        lost = {name: OutcomeValue(self._outcomes[name][0], None, end.reason) for name in names}
        return RunEnd(end.id, None, outcomes=lost)

    def _submit_solve(self, executor: Executor, batch: Batch[str]) -> Future[list[RunEnd]]:
        """Submit runs. If its worker died, perhaps in a function of the user, a run's outcomes are left for later."""
        tasks = []
        for run in batch:
            outcomes = {} if run in self._submitted else self._outcomes
            self._submitted.add(run)
            case = self._plan.case(self._plan.runs[run])
            tasks.append((run, case, str(self._path(run)), outcomes, self._setting))
        return executor.submit(in_turn, solve_run, tasks)

    def _run(
        self, tasks: Collection[str], submit: Submit[str, RunEnd], size: Size
    ) -> Generator[list[RunEnd], None, None]:
        """Run tasks. An exception of a worker is the end of each run of its batch, with the exception as its reason."""
        if not tasks:
            return
        # An executor may run its tasks in this process. They have one thread for BLAS, as in every worker.
        with threadpool_limits(limits=1, user_api="blas"):
            try:
                with closing(run_tasks(self._executor, self._workers, tasks, submit, size)) as ended:
                    for batch, ends in ended:
                        if isinstance(ends, BaseException):
                            died = type(ends).__name__ in ("WorkerDiedError", "KilledWorker")  # KilledWorker is dask's.
                            reason = DIED if died else f"{type(ends).__name__}: {ends}"
                            yield [RunEnd(run, reason) for run in batch]
                        else:
                            yield ends
            except BrokenError:
                raise FastpinError("the executor has stopped working; runs that are finished are kept") from None

    def _path(self, run: str) -> Path:
        return self._results / f"{run}.h5"


class Pace:
    """Chooses the size of batches from the time of the runs that have ended."""

    def __init__(self, workers: int) -> None:
        self._workers, self._runs, self._seconds = workers, 0, 0.0

    def learn(self, ends: list[RunEnd]) -> None:
        """Note the times of some runs. A run without a time has failed before it began."""
        self._runs += len(ends)
        self._seconds += sum(end.seconds or 0.0 for end in ends)

    def size(self, waiting: int) -> int:
        """Number of runs of the next batch: fewer towards the end, so that all workers end together."""
        if self._runs == 0:
            return 1
        by_time = BATCH_SECONDS * self._runs / max(self._seconds, 1e-3)
        return max(1, min(int(by_time), MOST_IN_BATCH, waiting // (4 * self._workers)))


def neighbours(plan: Plan, todo: Collection[str]) -> list[str]:
    """Order runs so that runs follow one another which differ in friction only: such runs share their matrices."""
    groups: dict[str, list[str]] = {}
    for run in todo:
        others = {name: value for name, value in plan.runs[run].values.items() if name != "contact.friction"}
        groups.setdefault(repr(others), []).append(run)
    return [run for group in groups.values() for run in group]


def _arrived(end: RunEnd, path: Path) -> RunEnd:
    """Return the end of a run. A missing result becomes a failure."""
    if end.reason is None and end.content is None and not path.exists():
        return RunEnd(end.id, f"the result did not arrive: {end.host} must see {path.parent} under the same path")
    return end
