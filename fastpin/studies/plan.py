"""Plans of sweeps: the varied fields of a case, and the runs of all their values.

A plan is a TOML text with a base case, a ``[grid]`` and ``[[list]]`` tables. Every combination of the values in the
grid is run. The fields of a list change together. The table ``[outcomes]`` names numbers that are read from every
result, and ``[labels]`` gives words for axes and tables. All faults of a plan are reported at once, each with its line.
Every run is checked before the first run starts.
"""

from __future__ import annotations

import hashlib
import itertools
import json
import math
from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any, Literal, Protocol

import numpy as np

from fastpin import joints
from fastpin.casefile.reader import EXAMPLE, KEYS, sections_with
from fastpin.casefile.toml_text import (
    MOST_BYTES_OF_PLAN,
    CaseText,
    KeyPath,
    NamedTable,
    Section,
    parse_text,
    read_text,
    written,
)
from fastpin.errors import CaseFileError, InputError, InputWarning
from fastpin.model import checks
from fastpin.model.case import BESIDE
from fastpin.model.doubts import warn_of, wear_doubts
from fastpin.model.keys import ANY, CASE
from fastpin.model.problem import Problem
from fastpin.model.synonyms import closest
from fastpin.model.unit_systems import checked_system
from fastpin.studies.identity import canonical_json, id_of_json, run_id
from fastpin.studies.outcome_tables import Outcomes, bar_faults, has_strengths, outcomes_from, outcomes_in_text
from fastpin.studies.run_end import JOINT_FIGURES, KEY_FIGURES
from fastpin.studies.variation import BaseCase, conflict, field_fault, reads_files, varied_name

MAX_RUNS = 100_000
"""Most runs of one plan."""

MAX_FAULTS = 50
"""Most faults of runs in one message."""

MOST_CASES = 5_000
"""Most cases that a plan keeps after it has checked them: some 20 MB. Reading a case again takes 1 ms."""

Spacing = Literal["linear", "log", "list"]
"""Spacing of the values of a field. "list": the values are listed one by one."""

PlanRow = dict[str, tuple[KeyPath, Any]]
"""Fields of a [[list]] block, each with its place in the text and its value."""

SweepProgress = Callable[[int, int], None]
"""A callable ``progress(done, total)`` of numbers of points or runs."""

LONGEST_LABEL = 80
"""Most letters of a label. It stands beside an axis of a figure."""

ROOT_KEYS = {name: name for name in ("title", "units", "case")} | {
    "grid": "[grid]", "list": "[[list]]", "outcomes": "[outcomes]", "labels": "[labels]"
}  # fmt: skip
"""Keys of a plan, as they are written."""

_RANGE_KEYS = ("from", "to", "count", "spacing")


class Base(Protocol):
    """The file that a plan varies: :class:`fastpin.studies.variation.BaseCase`, which says what each method returns.

    The other kind is :class:`fastpin.joints.BaseJoint`. A `case` is what its file holds.
    """

    form: str
    name: str
    text: CaseText
    is_whole: bool

    def is_table(self, names: tuple[str, ...], is_range: bool) -> bool: ...
    def fault(self, names: tuple[str, ...]) -> str | None: ...
    def kind(self, field: str) -> str: ...
    def words(self, field: str) -> str: ...
    def vary(self, values: dict[str, Any]) -> tuple[CaseText, Any]: ...
    def locate(
        self, places: Mapping[str, KeyPath], values: Mapping[str, Any], place: KeyPath, message: str
    ) -> tuple[KeyPath, str] | None: ...
    def beside(self, varied: Collection[str] = ()) -> dict[str, Any]: ...
    def nominal(self, case: Any, name: str) -> float | None: ...
    def is_idle(self, case: Any, factor: str) -> bool: ...
    def usual(self, case: Any, swing: bool) -> dict[str, Any]: ...
    def doubts(self, case: Any) -> list[InputWarning]: ...
    def identity(self, case: Any, strengths: bool) -> dict[str, Any]: ...
    def problem(self, case: Any) -> Problem: ...
    def drawn(self, case: Any) -> Problem | None: ...
    def unit_names(self, case: Any) -> dict[str, str]: ...


@dataclass(frozen=True)
class Point:
    """One combination of values.

    Attributes
    ----------
    id : str
        Id of the run. Points with the same input share it.
    values : dict of str to value
        The varied fields of this point, and their values in the units of the TOML text.
    input : str
        The canonical input as JSON, see :func:`fastpin.studies.identity.canonical`.
    """

    id: str
    values: dict[str, Any]
    input: str


@dataclass(frozen=True, repr=False)
class Plan:
    """A plan: all points of a sweep. :func:`read_plan` and :func:`parse_plan` make it.

    Attributes
    ----------
    title : str
    text : str
        The TOML text of the plan.
    fields : dict of str to {"linear", "log", "list"}
        The varied fields, and the spacing of their values. "list": the values are listed one by one.
    axes : dict of str to list
        The fields of the grid, and their values. The other fields are those of the [[list]] blocks.
    points : list of Point
        All points in the order of the plan. The last field of the grid changes fastest, the [[list]] slowest.
    outcomes : dict of str to Outcome
        The numbers that are read from every result, by name. They change no run and no id.
    doubts : list of InputWarning
        Values that are probably a mistake. They change no run.
    labels : dict of str to str
        Words for varied fields, outcomes and key figures in tables and figures, without units. They change no run and
        no id.
    """

    title: str
    text: str
    fields: dict[str, Spacing]
    axes: dict[str, list[Any]]
    points: list[Point]
    outcomes: Outcomes
    doubts: list[InputWarning]
    labels: dict[str, str]
    _base: Base
    _cases: dict[str, Any]

    def __repr__(self) -> str:
        return f"<Plan: {len(self.points):,} points of {', '.join(self.fields)}>"

    @property
    def figures(self) -> Outcomes:
        """The key figures that its runs have, by name."""
        return JOINT_FIGURES if self._base.form == "joint file" else KEY_FIGURES

    @property
    def numbers(self) -> Outcomes:
        """The key figures and the outcomes, by name."""
        return KEY_FIGURES | self.outcomes

    @cached_property
    def runs(self) -> dict[str, Point]:
        """The runs by id: the first point of each input."""
        runs: dict[str, Point] = {}
        for point in self.points:
            runs.setdefault(point.id, point)
        return runs

    @property
    def digest(self) -> str:
        """SHA-256 of the fields and runs. Plans with the same fields and runs share it, in any spelling."""
        text = json.dumps([sorted(self.fields), sorted(self.runs)])
        return hashlib.sha256(text.encode()).hexdigest()

    def with_outcomes(self, outcomes: Mapping[str, Any]) -> Plan:
        """Return this plan with more outcomes.

        Parameters
        ----------
        outcomes : mapping of str
            Functions, tables or outcomes by name, see :func:`fastpin.studies.outcome_tables.outcomes_from`. A function
            is called in worker processes, which import it by its name.

        Raises
        ------
        InputError
            With all faults. Also if the plan has another outcome of such a name.
        """
        found = outcomes_from(outcomes, self._base.beside(self.fields))
        known = {name.lower(): outcome.definition for name, outcome in self.outcomes.items()}
        for name, outcome in found.items():
            if known.get(name.lower(), outcome.definition) != outcome.definition:
                raise InputError("outcomes", f"{name}: the plan has another outcome of this name; choose another one")
        new = {name: outcome for name, outcome in found.items() if name.lower() not in known}
        for fault in bar_faults(self.outcomes | new).values():
            raise InputError("outcomes", fault)
        more = replace(self, outcomes=self.outcomes | new)
        known_strengths = has_strengths(self.outcomes)
        return more if has_strengths(more.outcomes) == known_strengths else more._with_ids(known_strengths)

    def _with_ids(self, known: bool) -> Plan:
        """Return this plan with the ids that its outcomes ask for; its ids hold strengths if `known`."""
        points, cases = [], {}
        for point, case in ((point, self._varied(point, known)) for point in self.points):
            text = canonical_json(self._base.identity(case, has_strengths(self.outcomes)))
            points.append(Point(id_of_json(text), point.values, text))
            if point.id in self._cases:
                cases[points[-1].id] = case
        return replace(self, points=points, _cases=cases)

    def _varied(self, point: Point, strengths: bool) -> Any:
        """Return the case of a point from the text of the base case, see :meth:`case`."""
        text, case = self._base.vary(point.values)
        if case is None or text.placed or run_id(self._base.identity(case, strengths)) != point.id:
            changed = "files of its loads, bodies or materials have changed since the plan was read"
            raise InputError(f"run {point.id}", changed)
        return case

    @property
    def base(self) -> Base:
        """The base case, or joint file."""
        return self._base

    @property
    def problem(self) -> Problem:
        """The problem of the first point, whose units the outputs have."""
        return self._base.problem(self.case(self.points[0]))

    def words(self, field: str) -> str:
        """Words for a varied field: its label, if it has one."""
        return self.labels.get(checks.string("field", field)) or self._base.words(field)

    def case(self, point: Point) -> Any:
        """Return the case of one point, for :func:`fastpin.solve`; or the :class:`fastpin.joints.JointFile`.

        Raises
        ------
        InputError
            If a file of its loads, plate or materials has changed since the plan was read, or `point` is no point.
        """
        checks.instance("point", point, Point, "a Point of this plan")
        if point.id in self._cases:
            return self._cases[point.id]
        return self._varied(point, has_strengths(self.outcomes))


def read_plan(path: str | Path, progress: SweepProgress | None = None) -> Plan:
    """Read a plan file.

    Parameters
    ----------
    path : path
        The plan. A relative path of the case file starts in its folder. A relative path of a CSV file or of a
        compliance starts in the folder of the case file, or of the plan if the base case is the built-in case.
    progress : callable, optional
        Called as ``progress(done, total)`` before each point is checked. A plan of 100,000 points takes some ten
        seconds.

    Raises
    ------
    CaseFileError
        With all faults of the plan, of the base case and of the runs.
    InputError
        If `path` is no path, or `progress` can't be called.
    """
    path = checks.file_path("path", path)
    checks.check_callable("progress", progress)
    plan = _parsed(read_text(path, MOST_BYTES_OF_PLAN), str(path), path.parent, progress)
    warn_of(plan.doubts, 2)
    return plan


def parse_plan(text: str, name: str = "plan", folder: str | Path = ".") -> Plan:
    """Read a plan from `text`.

    Parameters
    ----------
    text : str
        The plan, TOML.
    name : str
        Name of the plan in error messages.
    folder : path
        Start of a relative path of the case file, or of a CSV file if the base case is the built-in case. With a case
        file, a relative path of a CSV file starts in the folder of the case file.

    Raises
    ------
    CaseFileError
        With all faults of the text, of the base case and of the runs.
    InputError
        If an argument is of the wrong kind.
    """
    plan = _parsed(text, name, folder)
    warn_of(plan.doubts, 2)
    return plan


def _parsed(text: str, name: str, folder: str | Path, progress: SweepProgress | None = None) -> Plan:
    """Read a plan from `text`, see :func:`parse_plan`. No warnings are given."""
    place = checks.file_path("folder", folder)
    return parse_text(text, name, "plan", lambda source: _plan(source, text, place, progress))


def describe_values(values: dict[str, Any]) -> str:
    """Return the values of a point as text."""
    return ", ".join(f"{name} = {checks.as_toml(value)}" for name, value in values.items())


# -- text of a plan ------------------------------------------------------------------------------------------


def _plan(source: CaseText, text: str, folder: Path, progress: SweepProgress | None) -> Plan | None:
    """Read the plan. It has no meaning if the text has faults."""
    check_root(source)
    title = source.root.checked("title", checks.string) or ""
    base = base_case(source, folder)
    places: dict[str, KeyPath] = {}
    spacings: dict[str, Spacing] = {}
    rows = _rows(source, base)
    for row in rows:
        for field_name, (place, _) in row.items():
            places.setdefault(field_name, place)
            spacings[field_name] = "list"
    axes = _axes(source, base, places, spacings)
    if not places and not source.faults:
        source.report("nothing is varied: give a [grid] of lists of values, or [[list]] blocks")
    count = max(len(rows), 1) * math.prod(len(values) for values in axes.values())
    if count > MAX_RUNS:
        source.report(f"the plan has {count:,} runs; more than {MAX_RUNS:,} are not possible in one", "grid")
    outcomes = outcomes_in_text(source, folder, {} if base is None else base.beside(places))
    if base is not None and not outcomes and not source.faults:
        outcomes = usual_outcomes(base, swing=False)
    labels = labels_in(source, (*places, *source.section("outcomes").table, *KEY_FIGURES))
    if base is None or source.faults:
        return None
    fields = {name: spacings[name] for name in places}
    plan = Plan(title, text, fields, axes, [], outcomes, [], labels, base, {})
    return with_points(plan, source, places, rows or [{}], progress)


def usual_outcomes(base: Base, swing: bool) -> Outcomes:
    """Return the outcomes of a plan without any; of numbers with a swing if asked for."""
    case = base.vary({})[1]
    return {} if case is None else outcomes_from(base.usual(case, swing), base.beside())


def labels_in(source: CaseText, known: tuple[str, ...]) -> dict[str, str]:
    """Read the words for fields, outcomes and key figures."""
    labels: dict[str, str] = {}
    for place, name, words in _leaves(source, source.section("labels").table, ("labels",)):
        if name not in known:
            hint = closest(name, known) or "; a label is for a varied field, an outcome or a key figure"
            source.report(f'labels: the plan has no "{name}"{hint}', *place)
            continue
        try:
            labels[name] = checks.string(f"labels: {name}", words)
            if not 1 <= len(words.strip()) <= LONGEST_LABEL:
                raise InputError(f"labels: {name}", f"must be text of 1 to {LONGEST_LABEL} letters")
        except InputError as error:
            source.report(str(error), *place)
    return labels


def _leaves(
    source: CaseText, table: dict[str, Any], place: KeyPath, parts: tuple[str, ...] = ()
) -> Iterator[tuple[KeyPath, str, Any]]:
    """Yield place, dotted name and value of all keys of a table, and of the tables in it."""
    for key in table:
        value = Section(source, place, table).value(key)
        if isinstance(value, dict):
            yield from _leaves(source, value, (*place, key), (*parts, str(key)))
        elif value is not None:  # A value that can't be parsed is reported already.
            yield (*place, key), ".".join((*parts, str(key))), value


def check_root(source: CaseText, keys: Mapping[str, str] = ROOT_KEYS, varied_in: str = "[grid]") -> None:
    """Report sections, and keys before the first section, that a plan does not have. `keys` are shown as written."""
    for key, value in source.root.table.items():
        if key in keys:
            continue
        section, owners = written(key, value), sections_with(key)
        *first, last = keys.values()
        hint = closest(key, tuple(keys)) or f"; a plan has {', '.join(first)} and {last}"
        if section and key in KEYS:
            hint = '; it belongs in the case file, which a plan names: case = "case.toml"'
        elif owners:
            hint = f"; a plan varies it in {varied_in}: {varied_name(owners[0], key)} = ..."
        source.report_unknown(key, hint, where="")


def base_case(source: CaseText, folder: Path) -> Base | None:
    """Read the base case, a case file or a joint file, and report its faults on the line of the plan's ``case``.

    Numbers of a plan are in the units of its key ``units``, or else in those of the case.
    """
    name, units = source.root.checked("case", checks.any_text), source.root.checked("units", checked_system)
    try:
        if name is None:
            base: Base = BaseCase(EXAMPLE, "built-in case", folder, units or "")
        else:
            text = read_text(folder / name)
            kind = joints.BaseJoint if joints.is_joint_file(text) else BaseCase
            base = kind(text, name, (folder / name).parent, units or "")
        kinds = {key: kind for name in ("wear", *BESIDE) for key, kind in CASE.get(name, {}).items()}
        source.to_si({"outcomes": {ANY: kinds}}, base.is_whole, base.text.root.table.get("units"))
        return base
    except CaseFileError as error:
        for line, message in error.problems:
            source.report(f"{error.field}{f', line {line}' if line else ''}: {message}", "case")
        return None


def _rows(source: CaseText, base: Base | None) -> list[PlanRow]:
    """Read places and values of the fields of the [[list]] blocks."""
    value = source.root.value("list")
    blocks = source.blocks("list")
    if "list" in source.root and (not isinstance(value, list) or not blocks or len(blocks) < len(value)):
        source.report("lists are [[list]] blocks, with double brackets", "list")
        return []
    rows = []
    for index, block in enumerate(blocks):
        if not block.table:
            block.report("[[list]]: gives no field")
        fields = varied_fields(source, base, block.table, ("list", index))
        rows.append({name: (place, item) for place, name, item in fields})
    return rows


def _axes(
    source: CaseText, base: Base | None, places: dict[str, KeyPath], spacings: dict[str, Spacing]
) -> dict[str, list[Any]]:
    """Read the values of each field of the grid. Add the fields to `places` and `spacings`."""
    axes = {}
    for place, name, value in varied_fields(source, base, source.section("grid").table, ("grid",)):
        if name in places:
            source.report(f"{name}: is varied already, in line {source.line(*places[name])}", *place)
            continue
        places[name] = place
        spacings[name] = "list"
        if isinstance(value, list) and value:
            axes[name] = value
        elif isinstance(value, dict):
            axes[name], spacings[name] = range_in(source, place, name, value)
        else:
            allowed, given = "a list of values, or { from = 0.1, to = 1.0, count = 10 }", checks.as_toml(value)
            source.report(f"{name}: must be {allowed}, not {'an empty list' if value == [] else given}", *place)
    return axes


def varied_fields(
    source: CaseText, base: Base | None, table: dict[str, Any], place: KeyPath, parts: tuple[str, ...] = ()
) -> Iterator[tuple[KeyPath, str, Any]]:
    """Yield place, field and value of all keys of a table.

    ``contact.friction`` may be a quoted key, or a table in a table.
    """
    for key in table:
        here, names = (*place, key), (*parts, *key.split("."))
        value = Section(source, place, table).value(key)
        if value is None:  # This fault is reported already.
            continue
        if isinstance(value, dict) and (base or BaseCase).is_table(names, set(value) <= set(_RANGE_KEYS)):
            yield from varied_fields(source, base, value, here, names)
        elif fault := base.fault(names) if base else field_fault(names, None):
            source.report(fault, *here)
        else:
            yield here, ".".join(names), value


def range_in(
    source: CaseText, place: KeyPath, name: str, table: dict[str, Any], usual: int | None = None
) -> tuple[list[Any], Spacing]:
    """Read the values of a range, and their spacing. A range with a fault has no values.

    `usual` is the number of values without ``count``; None if ``count`` must be given.
    """
    section = NamedTable(source, place, table, name)
    before = len(source.placed)
    section.check_keys(_RANGE_KEYS, " in a range", hint=lambda _: f"; there are {', '.join(_RANGE_KEYS)}")
    needed = _RANGE_KEYS[: 3 if usual is None else 2]
    for key in needed:
        if key not in table:
            section.report(f"{key} is missing; a range has {', '.join(needed[:-1])} and {needed[-1]}")
    first, last, count = section.number("from"), section.number("to"), usual
    if usual is None or "count" in table:
        count = section.checked("count", checks.whole_number, 2, MAX_RUNS)
    spacing: Any = section.checked("spacing", checks.choice, ("linear", "log")) or "linear"
    if first is None or last is None or count is None or len(source.placed) > before:
        return [], spacing
    if spacing == "log" and not first * last > 0.0:
        section.report("from and to must both be positive, or both negative, where spacing is log")
        return [], spacing
    values = (np.geomspace if spacing == "log" else np.linspace)(first, last, count)
    # With 12 digits 0.3 in a range equals 0.3 in a list.
    rounded = [first, *(float(f"{value:.12g}") for value in values[1:-1]), last]
    if isinstance(table["from"], int) and isinstance(table["to"], int) and all(value % 1 == 0 for value in rounded):
        return [int(value) for value in rounded], spacing
    return rounded, spacing


# -- runs ----------------------------------------------------------------------------------------------------


def with_points(
    plan: Plan, source: CaseText, places: dict[str, KeyPath], rows: list[PlanRow], progress: SweepProgress | None
) -> Plan:
    """Return a plan with all its points, checked, and its doubts. The rows stand slowest in the order of the points.

    A fault of a run is reported on the line of the field, or of the case. The plan keeps the first cases without files
    of their own, and one doubt of each field.
    """
    base, axes, strengths = plan._base, plan.axes, has_strengths(plan.outcomes)
    cases: dict[str, Any] = {}
    doubted: dict[str, tuple[InputWarning, list[dict[str, Any]]]] = {}
    points: list[Point] = []
    faults: dict[tuple[KeyPath, str], list[dict[str, Any]]] = {}
    count, total = 0, len(rows) * math.prod(map(len, axes.values()))
    for row, *combination in itertools.product(rows, *axes.values()):
        if progress is not None:
            progress(count, total)
        values = {name: value for name, (_, value) in row.items()} | dict(zip(axes, combination, strict=True))
        count += 1
        pair = conflict(values)
        if pair:
            sites = _sites(places, row)
            faults.setdefault((sites[pair[1]], f"{pair[1]}: can't be given together with {pair[0]}"), []).append(values)
            continue
        text, case = base.vary(values)
        sites = _sites(places, row)
        for fault in dict.fromkeys(_located(base, sites, values, *placed) for placed in text.placed):
            faults.setdefault(fault, []).append(values)
        if case is not None and not text.placed:
            for doubt in base.doubts(case):
                doubted.setdefault(doubt.field, (doubt, []))[1].append(values)
            input_text = canonical_json(base.identity(case, strengths))
            points.append(Point(id_of_json(input_text), values, input_text))
            if len(cases) < MOST_CASES and not reads_files(text.root.table):
                cases[points[-1].id] = case
    for (place, message), runs in itertools.islice(faults.items(), MAX_FAULTS):
        source.report(f"{message}{_which(runs, count)}", *place)
    if len(faults) > MAX_FAULTS:
        source.report(f"and {len(faults) - MAX_FAULTS:,} more faults in the runs")
    found = [InputWarning(name, f"{doubt.reason}{_which(runs, count)}") for name, (doubt, runs) in doubted.items()]
    wears = dict.fromkeys(each.wear for each in plan.outcomes.values() if each.wear is not None)
    case = base.vary({})[1] if wears else None
    if case is not None:
        found += [doubt for wear in wears for doubt in wear_doubts(case.problem, wear)]
    return replace(plan, points=points, doubts=found, _cases=cases)


def _located(
    base: Base, sites: Mapping[str, KeyPath], values: Mapping[str, Any], place: KeyPath, message: str
) -> tuple[KeyPath, str]:
    """The place of a run's fault in the plan, and its message: at a field of the run, or at the name of the case."""
    line = base.text.line(*place)
    of_case = ("case",), f"{base.name}{f', line {line}' if line else ''}: {message}"
    return base.locate(sites, values, place, message) or of_case


def _sites(places: dict[str, KeyPath], row: PlanRow) -> dict[str, KeyPath]:
    """The places of the fields of a run. `places` are those of the first one of every field."""
    return places | {name: place for name, (place, _) in row.items()}


def _which(runs: list[dict[str, Any]], count: int) -> str:
    """Return the end of a fault's message: the runs with this fault, unless all `count` runs have it."""
    if len(runs) == count:
        return ""
    return f" (in {f'{len(runs)} runs, first' if len(runs) > 1 else 'the run'} {describe_values(runs[0])})"
