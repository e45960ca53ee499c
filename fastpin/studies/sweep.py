"""Parameter sweeps: many workers solve the runs of a plan. A directory holds the index and the results.

    >>> from fastpin.studies import read_plan, sweep
    >>> plan = read_plan("plan.toml")                               # doctest: +SKIP
    >>> summary = sweep.run(plan, "plan")                           # doctest: +SKIP
    >>> rows = sweep.load("plan")                                   # doctest: +SKIP

Finished runs are skipped. Thus a sweep continues after a stop, a kill or an extension of its plan.
"""

from __future__ import annotations

import json
import math
import shutil
import time
from collections.abc import Iterable, Mapping, Sequence
from concurrent.futures import Executor
from contextlib import closing
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fastpin.errors import InputError
from fastpin.model.checks import as_toml, check_callable, file_path, instance, items, true_or_false, whole_number
from fastpin.model.inputs import HDF5_SIGNATURE
from fastpin.model.units import Unit, units
from fastpin.runtime.threads import cores
from fastpin.storage.files import INDEX, forget_temporaries, replacing
from fastpin.storage.packed import FOLDER
from fastpin.studies.index import DONE, FAILED, WAITING, Index, ensure_directory, has_index, lock_directory
from fastpin.studies.outcomes import OutcomeValue
from fastpin.studies.plan import Plan, Point, SweepProgress
from fastpin.studies.run_end import JOINT_FIGURES, KEY_FIGURES, bar_column
from fastpin.studies.run_kinds import RUNS, OfCases, OfJoints
from fastpin.studies.workers import Work, pickled_outcomes

if TYPE_CHECKING:  # they import compiled code, and a plan is read without it
    import xarray


PLAN = "plan.toml"
"""Name of the plan's copy in the directory of a sweep."""

AGREEMENT = 1e-6
"""Largest relative difference of key figures in two solutions of one run, also from different machines."""


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
    progress: SweepProgress | None = None,
    files: bool = False,
) -> Summary:
    """Solve all unfinished runs of a plan, and read the outcomes of all runs.

    An outcome that is new in the plan is read from the stored results of finished runs, which are not solved again.

    Parameters
    ----------
    plan : Plan
        A function of :meth:`Plan.with_outcomes` runs in the workers, which import it by its name.
    directory : path
        Folder of the index with the results (``index.sqlite``) and a copy of the plan. It is created if there is none.
        A changed plan may use the same directory: common runs are not solved again.
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
    files : bool
        Write each result to an HDF5 file ``results/ID.h5``, also those of runs that are finished already. Otherwise
        only results of more than 1 MB get files. :func:`fastpin.load` reads both kinds by this path.

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
    true_or_false("files", files)
    if executor is not None and not callable(getattr(executor, "submit", None)):
        raise InputError("executor", f"must be an executor of concurrent.futures, not {as_toml(executor)}")
    check_callable("progress", progress)
    workers = cores() if workers is None else whole_number("workers", workers, 1)
    content = pickled_outcomes(plan)
    directory = ensure_directory(file_path("directory", directory))
    with lock_directory(directory):
        _check_plan_copy(directory, plan.text)
        with Index(directory, write=True) as index:
            results = ensure_directory(directory / FOLDER).resolve()
            forget_temporaries(results, {f"{run}.h5" for run in points})  # Killed workers leave them.
            _keep_plan(directory, plan.text)
            index.expect(plan, points.values())
            if retry:
                index.forget_unread()
            skipped = (DONE,) if retry else (DONE, FAILED)
            todo = [run for run, (state, _) in _now(index, points, results).items() if state not in skipped]
            missing = _missing_outcomes(index, plan, points, results)
            work = Work(plan, index, results, content, executor, workers, files)
            report = progress or (lambda ended, all_runs: None)
            began, ended = time.perf_counter(), 0
            report(0, len(todo) + len(missing))
            with closing(work.solve(todo)) as batches:
                for ends in batches:
                    index.record(ends)
                    for _ in ends:
                        report(ended := ended + 1, len(todo) + len(missing))
            missing = _missing_outcomes(index, plan, points, results)  # Also of runs that were solved again alone.
            with closing(work.read(missing)) as batches:
                for ends in batches:
                    index.record_outcomes(ends)
                    for _ in ends:
                        report(ended := ended + 1, len(todo) + len(missing))
            if files:
                _write_files(RUNS[plan.base.form], index, points, results)
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
        return _summary(index, plan, points, directory / FOLDER)


def load(directory: str | Path) -> list[dict[str, Any]]:
    """Read all rows of the index in a directory, one for each run.

    ``pandas.DataFrame(load(directory))`` makes a table of them.

    Returns
    -------
    list of dict
        Keys are "id", "status" ("waiting", "done", "failed"), "reason" (of a failure), "dimensionless" (1 for units of
        the paper, 0 for SI), the key figures (:data:`fastpin.studies.run_end.KEY_FIGURES`), "seconds", "started" (UTC),
        "host", "versions" and "input" (dicts), the varied fields, such as "contact.friction", and the outcomes that are
        known of the run. None stands for an unknown value. A run with error bars has them too, such as
        "peak_pressure_bar". A bar is inf if the coarse grid has no value to compare.

    Raises
    ------
    InputError
        If the directory holds no index, or the index can't be used.
    """
    with Index(file_path("directory", directory)) as index:
        outcomes, bars, found = index.outcomes(), index.bars(), index.rows()
        for row in found:
            row |= {name: value.value for name, value in outcomes.get(row["id"], {}).items()}
            row |= {bar_column(name): bar for name, bar in bars.get(row["id"], {}).items()}
        return found


def rows(plan: Plan, directory: str | Path) -> list[dict[str, Any]]:
    """Return one row for each point of a plan, in the order of the plan, with the keys of :func:`load`.

    The outcomes are those of the plan; None stands for a value that is not known. The row of a point that is not in the
    index has only its status "waiting", reason, id, fields and outcomes. Only values that are known have error bars.
    The key "endless" names the lives that were looked for, and did not end.

    Raises
    ------
    InputError
        If the index can't be used.
    """
    instance("plan", plan, Plan, "a Plan")
    known_rows: dict[str, dict[str, Any]] = {}
    outcomes: dict[str, dict[str, OutcomeValue]] = {}
    bars: dict[str, dict[str, float]] = {}
    if has_index(file_path("directory", directory)):
        with Index(file_path("directory", directory)) as index:
            known_rows = {row["id"]: row for row in index.rows()}
            outcomes, bars = index.outcomes(), index.bars()
    found = []
    for point in plan.points:
        row = known_rows.get(point.id, {"status": WAITING, "reason": None})
        values = outcomes.get(point.id, {}) if row["status"] == DONE else {}
        chosen = {name: value.value for name, value in values.items() if _is_of(plan, name, value)}
        fields = dict.fromkeys(plan.fields) | point.values
        known_bars = bars.get(point.id, {}) if row["status"] == DONE else {}
        shown = {bar_column(name): bar for name, bar in known_bars.items() if name in KEY_FIGURES or name in chosen}
        row["endless"] = [name for name in chosen if plan.outcomes[name].is_life and values[name][1:3] == (None, None)]
        found.append({**row, "id": point.id, **fields, **dict.fromkeys(plan.outcomes), **chosen, **shown})
    return found


def to_xarray(plan: Plan, directory: str | Path) -> xarray.Dataset:
    """Return the outcomes and key figures of a sweep as labelled arrays.

    Parameters
    ----------
    plan : Plan
    directory : path
        The folder of the sweep.

    Returns
    -------
    xarray.Dataset
        Each field of the grid is a dimension and a coordinate, under its name in the plan: ``"contact.friction"``. The
        [[list]] blocks are the dimension "run". Their fields are coordinates along it.

        Each outcome and each key figure (:data:`fastpin.studies.run_end.KEY_FIGURES`) is a variable. Values have the
        units of :func:`load`. The attribute "units" names them, "long_name" is the label of the plan or the name in
        words. A class has the attributes "flag_values" and "flag_meanings". The texts "status", "reason" and "id"
        describe each run. Numbers of runs that failed or wait are NaN.

    Raises
    ------
    InputError
        If the index can't be used, or xarray is not installed.
    """
    try:
        import xarray
    except ImportError:
        raise InputError("xarray", "is not installed: pip install 'fastpin[xarray]'") from None
    table, product = rows(plan, directory), math.prod(map(len, plan.axes.values()))
    listed = [name for name in plan.fields if name not in plan.axes]
    sizes = {LISTED: len(table) // product} if listed else {}
    sizes |= {name: len(values) for name, values in plan.axes.items()}
    shape, dimensions = tuple(sizes.values()), [*sizes]
    coordinates: dict[str, Any] = {}
    for name, values in plan.axes.items():
        coordinates[name] = [name], _coordinate(values), _field_attributes(plan, name)
    if listed:
        coordinates[LISTED] = [LISTED], np.arange(1, sizes[LISTED] + 1), {"long_name": "[[list]] block of the plan"}
        first = table[::product]
        for name in listed:
            coordinates[name] = [LISTED], _coordinate([row[name] for row in first]), _field_attributes(plan, name)
    variables: dict[str, Any] = {}
    for name in (*plan.outcomes, *KEY_FIGURES):
        known = [row.get(name) if row["status"] == DONE else None for row in table]
        numbers = [np.nan if value is None else value for value in known]
        variables[name] = dimensions, np.array(numbers, dtype=float).reshape(shape), _attributes(plan, table, name)
    for name in ("status", "reason", "id"):
        texts = np.array([row.get(name) or "" for row in table], dtype=str)
        variables[name] = dimensions, texts.reshape(shape), {"long_name": f"{name} of the run"}
    return xarray.Dataset(variables, coordinates, {"title": plan.title} if plan.title else {})


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


def _missing_outcomes(index: Index, plan: Plan, points: dict[str, Point], results: Path) -> dict[str, list[str]]:
    """Return the names of the outcomes that finished runs lack, by run."""
    if not plan.outcomes:
        return {}
    known, now = index.outcomes(), _now(index, points, results)
    done = [run for run, (state, _) in now.items() if state == DONE]
    missing = {run: [name for name in plan.outcomes if name not in known.get(run, {})] for run in done}
    return {run: names for run, names in missing.items() if names}


def _write_files(way: type[OfCases | OfJoints], index: Index, points: Iterable[str], results: Path) -> None:
    """Write the results of finished runs that are only in the index to files."""
    for run, (state, _) in _now(index, points, results).items():
        path = results / f"{run}.h5"
        content = None if state != DONE or path.exists() else index.content(run)
        if content is not None:
            way.write(path, content)


def _now(index: Index, points: Iterable[str], results: Path) -> dict[str, tuple[str, str | None]]:
    """Return status and reason of each run. A done run without its result is waiting again.

    A file stands before the result of the same run in the index, as for a reader.
    """
    files = {path.stem: _is_hdf5(path) for path in results.glob("[!.]*.h5")}  # Unfinished files begin with a dot.
    present = {run for run, whole in files.items() if whole} | (index.packed() - files.keys())
    waiting, known = (WAITING, None), index.statuses()
    stored = {run: known.get(run, waiting) for run in points}
    return {run: waiting if entry[0] == DONE and run not in present else entry for run, entry in stored.items()}


def _is_hdf5(path: Path) -> bool:
    """Whether a file begins with the signature of HDF5."""
    if not path.is_file():  # Nothing may ever be written to a pipe.
        return False
    try:
        with path.open("rb") as file:
            return file.read(len(HDF5_SIGNATURE)) == HDF5_SIGNATURE
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
    if path.exists() and not (directory / INDEX).exists() and not _holds(path, text):
        raise InputError(str(directory), f"holds another {PLAN}, but no sweep; choose another directory")


def _holds(path: Path, text: str) -> bool:
    """Whether a path is an ordinary file with this text."""
    return path.is_file() and path.read_bytes() == text.encode()


def _keep_plan(directory: Path, text: str) -> None:
    """Write the copy of the plan, unless it is there: the copy itself may have been read as the plan."""
    path = directory / PLAN
    if _holds(path, text):
        return
    with replacing(path) as temporary:
        temporary.write_text(text, encoding="utf-8")


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
    _check_parts([*([target] if (target / INDEX).exists() else []), *parts])
    _check_plan_copy(ensure_directory(target))
    with lock_directory(target), Index(target, write=True) as index:
        ensure_directory(target / FOLDER)
        for source in parts:
            with Index(source) as other:
                if other.holds_plan():
                    _absorb(index, other, target, source)
        return len(index.statuses())


def _check_parts(parts: Sequence[Path]) -> None:
    """Check, before any writing, that all parts belong to one plan and agree."""
    notes: dict[str, str | None] = {}
    done: dict[str, dict[str, Any]] = {}
    for part in parts:
        with Index(part) as index:
            if not index.holds_plan():
                continue
            words_of = {"version": "was made by another version of fastpin", "plan": "belongs to another plan"}
            for name, words in words_of.items():
                if notes.setdefault(name, index.read_note(name)) != index.read_note(name):
                    raise InputError(str(part), f"{words} than {parts[0]}")
            for row in index.rows():
                if row["status"] == DONE:
                    _check_agreement(done.setdefault(row["id"], row), row, part)


def _absorb(index: Index, other: Index, target: Path, source: Path) -> None:
    """Copy the runs of another part, with their results, if their status there is better, or they are new here."""
    rank = {WAITING: 0, FAILED: 1, DONE: 2}
    here = {run: rank[state] for run, (state, _) in index.statuses().items()}
    wanted = [run for run, (state, _) in other.statuses().items() if rank[state] > here.get(run, -1)]
    for run in wanted:
        path = source / FOLDER / f"{run}.h5"
        (target / FOLDER / path.name).unlink(missing_ok=True)  # It would stand before a result in the index.
        if path.exists():
            with replacing(target / FOLDER / path.name, result=True) as temporary:
                shutil.copyfile(path, temporary)
    index.absorb(other, wanted)
    _keep_plan(target, index.read_note("text") or "")


def _check_agreement(first_row: dict[str, Any], second_row: dict[str, Any], source: Path) -> None:
    names = "states", "nodes", "peak_pressure", "max_pressure", "contact_width"
    for name in (each for each in names if each in JOINT_FIGURES or "joint" not in first_row["input"]):
        first, second = first_row[name], second_row[name]
        if first is None or second is None:
            raise InputError(str(source), f"run {first_row['id']} is done, but has no {name}")
        if abs(first - second) > AGREEMENT * max(abs(first), abs(second)):
            raise InputError(str(source), f"run {first_row['id']} has {name} = {second:.9g}, elsewhere {first:.9g}")


LISTED = "run"
"""The dimension of the [[list]] blocks of a plan."""


def _coordinate(values: Sequence[Any]) -> np.ndarray:
    """Return the values of a field as numbers, NaN where missing; or as text, in the notation of JSON where no text."""
    if all(value is None or (isinstance(value, int | float) and not isinstance(value, bool)) for value in values):
        return np.array([np.nan if value is None else value for value in values])
    texts = ["" if value is None else value if isinstance(value, str) else json.dumps(value) for value in values]
    return np.array(texts, dtype=str)


def _field_attributes(plan: Plan, name: str) -> dict[str, Any]:
    """Unit and words of a varied field. Its values are in the units of the case file."""
    unit = units(plan.problem).get(plan.base.kind(name))
    return {"units": unit.name if unit else "", "long_name": plan.words(name)}


def _attributes(plan: Plan, rows: Sequence[Mapping[str, Any]], name: str) -> dict[str, Any]:
    """Unit and words of an outcome or a key figure, per metre of thickness as in :func:`fastpin.studies.sweep.load`."""
    names = plan.base.unit_names(plan.case(plan.points[0]))
    if len({row["dimensionless"] for row in rows if "dimensionless" in row}) > 1:
        names = {}
    number = plan.numbers[name]
    found: dict[str, Any] = {"units": number.unit_in({kind: Unit(1.0, unit) for kind, unit in names.items()}).name}
    if number.classes:
        found["flag_values"] = [float(value) for value in number.classes]
        found["flag_meanings"] = " ".join(word.replace(" ", "_") for word in number.classes.values())
    return found | {"long_name": plan.labels.get(name, name.replace("_", " "))}
