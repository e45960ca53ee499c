"""The results of a sweep as a text table, a CSV file, or the numbers of a figure."""

from __future__ import annotations

import csv
import io
import json
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from pathlib import Path
from typing import Any

import numpy as np

from fastpin.assess.outputs import ROUNDING, Column, Curve, csv_cell, table
from fastpin.assess.strength import strength_words
from fastpin.damage.criteria import FATIGUE_CRITERIA
from fastpin.errors import InputError
from fastpin.model import LOADS, Case, Problem, Profile, StrengthAssessment, Wear, checks, synonyms
from fastpin.model.points import BODIES
from fastpin.model.profile_terms import TERMS
from fastpin.model.units import DEGREE, PLAIN, Unit, measures_of, units
from fastpin.storage.files import check_writable, replacing
from fastpin.studies.index import DONE, FAILED
from fastpin.studies.outcome_tables import KEYS, MOST_CLASSES
from fastpin.studies.outcomes import StudyOutcome
from fastpin.studies.plan import Plan
from fastpin.studies.run_end import KEY_FIGURES, bar_column
from fastpin.version import __version__

TableRow = dict[str, Any]
"""One point of a plan with its key figures, see :func:`fastpin.studies.sweep.rows`."""

THICKNESS = "contact.thickness"
"""The field of the thickness."""

_ROUNDING = {"deg": 1e-7, "rad": 1e-12}
"""By unit: smaller values are rounding, and the text table shows them as 0. A node is above 1e-2 deg wide."""

_SHOWN = {
    "peak_pressure": "peak N",
    "peak_pressure_angle": "at",
    "peak_shear": "peak T",
    "contact_start": "contact from",
    "contact_stop": "to",
    "stick_width": "stick",
    "rotation": "rotation",
    "dissipation": "dissipated",
    "max_pressure": "max N",
    "max_shear": "max |T|",
}
"""Key figures of the text table and their headings, unless the plan has outcomes. The CSV file has all key figures."""


def text(plan: Plan, rows: Sequence[TableRow]) -> str:
    """Return the table of :func:`run_columns` as text. A long table lacks its middle."""
    return table(run_columns(plan, rows))


def run_columns(plan: Plan, rows: Sequence[TableRow]) -> list[Column]:
    """Return the columns of the table of runs: varied fields, outcomes of the plan, status.

    A plan without outcomes has the most important key figures in their place. Error bars stand behind +-, if the runs
    have any; a ? stands for an infinite bar. The number of a class that the coarse grid finds different has a ?, too.
    `rows` come from :func:`fastpin.studies.sweep.rows`.
    """
    rows, unit = printed_rows(plan, rows)
    columns = [("run", "", [row["id"] for row in rows])]
    for name in plan.fields:
        heading = plan.labels.get(name, name)
        columns.append(_column(heading, [row[name] for row in rows], unit.get(plan.base.kind(name), PLAIN)))
    shown = dict(zip(plan.outcomes, plan.outcomes, strict=True)) or _SHOWN
    for name, heading in shown.items():
        values = [_in_words(plan, name, row.get(name)) for row in rows]
        bars = [row.get(bar_column(name)) for row in rows]
        columns.append(_column(plan.labels.get(name, heading), values, printed_unit(plan, name, unit), bars))
    columns.append(("status", "", [row["status"] for row in rows]))
    return columns


def write_csv(plan: Plan, rows: Sequence[TableRow], path: Path) -> None:
    """Write all varied fields, outcomes and key figures as CSV, with a comment line that names the units.

    Key figures that a joint lacks have no column. Classes are words. Units are SI, with the thickness of each run if
    all runs have one, or the paper's for dimensionless problems. A function of the user has its own unit. The error bar
    of NAME is in the column NAME_bar, if any run has one; an infinite bar is "inf".

    Raises
    ------
    InputError
        If the file can't be written.
    """
    check_writable(path)
    rows, unit = printed_rows(plan, rows)
    named = [(name, unit.get(plan.base.kind(name), PLAIN)) for name in plan.fields]
    numbers = (*plan.outcomes, *(name for name in KEY_FIGURES if name in plan.figures))
    named += [(name, printed_unit(plan, name, unit)) for name in numbers]
    with_bars = [
        each
        for name in numbers
        for each in (name, bar_column(name))
        if each == name or any(each in row for row in rows)
    ]
    names = ["id", *plan.fields, *with_bars, "seconds", "started", "host", "status", "reason"]
    out = io.StringIO()
    out.write(f"# fastpin {__version__}{f', {plan.title}' if plan.title else ''}\n")
    out.write(f"# units: {', '.join(f'{name} {label.name}' for name, label in named if label.name)}, seconds s\n")
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(map(csv_cell, names))
    for row in rows:
        cells = (_in_words(plan, name, row.get(name)) for name in names)
        writer.writerow([json.dumps(cell) if isinstance(cell, list) else csv_cell(cell) for cell in cells])
    with replacing(path) as temporary:
        temporary.write_text(out.getvalue(), encoding="utf-8")


@dataclass(frozen=True)
class Axis:
    """An axis of a figure.

    Attributes
    ----------
    label : str
        Words for the field, with its unit in parentheses.
    values : ndarray
        Values of the field, increasing, in the label's unit.
    log : bool
        Whether the plan spaces the values by a factor; the axis is then logarithmic.
    """

    label: str
    values: np.ndarray
    log: bool


@dataclass(frozen=True)
class Chart:
    """The numbers of a figure.

    Attributes
    ----------
    title : str
        Title of the figure.
    label : str
        Name of the outcome or key figure, with its unit in parentheses.
    x : Axis
    y : Axis or None
        None for curves.
    parts : list of (str, ndarray, ndarray of bool)
        One entry for each map or curve: its name, with a line for each field; its values; True where a run failed. Both
        arrays have the shape (len(y), len(x)) for a map, (len(x),) for a curve. Missing values are NaN. Values that are
        rounding are 0.
    missing : int
        Number of points without a value.
    problem : Problem, optional
        The joint of the first point.
    varied : tuple of str
        The fields of the plan with several values.
    classes : dict of int to str
        The words of each value, if the values are numbers of classes; else empty.
    bars : list of ndarray
        The error bars of each entry of `parts`, in the label's unit. NaN where there is none, inf where nothing is
        known. Bars of a class are 0, or larger if the coarse grid finds another class. Empty without error bars.
    endless : list of ndarray of bool
        For each entry of `parts` where a life was looked for, and did not end; empty if the number is no life.
    """

    title: str
    label: str
    x: Axis
    y: Axis | None
    parts: list[tuple[str, np.ndarray, np.ndarray]]
    missing: int
    problem: Problem | None = None
    varied: tuple[str, ...] = ()
    classes: Mapping[int, str] = field(default_factory=dict)
    bars: list[np.ndarray] = field(default_factory=list)
    endless: list[np.ndarray] = field(default_factory=list)


def check_axes(plan: Plan, value: str, x: str | None, y: str | None) -> tuple[str, str | None, list[str]]:
    """Return the field of the x axis, the field of the y axis, and the fields that distinguish the maps or curves.

    Without `x`, the axes are the first two fields that vary and have only numbers, or the only one. A figure with an x
    axis alone has curves, and None for the y axis.

    Raises
    ------
    InputError
        The field is "value", "x", "y" or "plot". The outcome, the key figure or a field is unknown, an axis has values
        that are no numbers, both axes have the same field, no field is left for the x axis, or there are too many maps
        or curves.
    """
    known = (*plan.outcomes, *KEY_FIGURES, "seconds")
    if value not in known:
        hint = synonyms.closest(value, known) or f"; there are {', '.join(known)}"
        raise InputError("value", f"there is no outcome or key figure {checks.as_toml(value)}{hint}")
    values = {name: _different([point.values.get(name) for point in plan.points]) for name in plan.fields}
    numeric = [name for name, found in values.items() if all(_is_number(item) for item in found)]
    for option, name in (("x", x), ("y", y)):
        if name is not None and name not in plan.fields:
            hint = synonyms.closest(name, tuple(plan.fields)) or f"; there are {', '.join(plan.fields)}"
            raise InputError(option, f"the plan does not vary {checks.as_toml(name)}{hint}")
        if name is not None and name not in numeric:
            raise InputError(option, f"the values of {name} are not all numbers, which an axis needs")
    if y is not None and y == x:
        raise InputError("y", f"must differ from the field of the x axis, {x}")
    free = [name for name in numeric if len(values[name]) > 1 and name not in (x, y)]
    if x is None:
        if not free:
            raise InputError("plot", "a figure needs a field with several numbers")
        x = free.pop(0)
        y = free.pop(0) if y is None and free else y
    others = [name for name, found in values.items() if len(found) > 1 and name not in (x, y)]
    parts = len(_different([[point.values.get(name) for name in others] for point in plan.points]))
    most, what = (20, "curves") if y is None else (12, "maps")
    if parts > most:
        ways = f"choose other axes, or fix a field, such as --where {others[0]}={brief(values[others[0]][0])}"
        raise InputError("plot", f"the figure would have {parts} {what}, at most {most} fit; {ways}")
    return x, y, others


def restricted(plan: Plan, where: Mapping[str, Any]) -> Plan:
    """Return a plan with the points alone at which fields have given values, in the units of the plan.

    Figures of such a plan have less maps or curves. Its rows are those of :func:`fastpin.studies.sweep.rows`.

    Raises
    ------
    InputError
        The field is "where". The plan does not vary a field, has no such value, or no point with all of the values.
    """
    points = plan.points
    for name, value in where.items():
        if name not in plan.fields:
            hint = synonyms.closest(name, tuple(plan.fields)) or f"; there are {', '.join(plan.fields)}"
            raise InputError("where", f"the plan does not vary {checks.as_toml(name)}{hint}")
        known = _different([point.values.get(name) for point in plan.points])
        if not any(_is_same(value, each) for each in known):
            listed = ", ".join(brief(each) for each in known[:6]) + ", ..." * (len(known) > 6)
            raise InputError("where", f"the plan has no {name} = {checks.as_toml(value)}; it has {listed}")
        points = [point for point in points if _is_same(value, point.values.get(name))]
    if not points:
        raise InputError("where", "no point of the plan has all of these values")
    return replace(plan, points=points)


def where_words(plan: Plan, rows: Sequence[TableRow], where: Mapping[str, Any]) -> list[str]:
    """Return words for the fields that are fixed in a restricted plan, with the units of its figures."""
    unit = printed_rows(plan, rows)[1]
    return [value_words(plan, rows, name, unit)(rows[0][name]) for name in where]


def _is_same(value: Any, known: Any) -> bool:
    """Whether two values of a field are equal, numbers up to the rounding of their text."""
    if _is_number(value) and _is_number(known):
        return math.isclose(value, known, rel_tol=1e-9)
    return bool(value == known)


def chart(plan: Plan, rows: Sequence[TableRow], value: str, x: str | None = None, y: str | None = None) -> Chart:
    """Return the numbers of a figure of one outcome or key figure over one or two fields.

    Other fields that vary make several maps or curves.

    Parameters
    ----------
    plan : Plan
    rows : sequence of dict
        From :func:`fastpin.studies.sweep.rows`.
    value : str
        An outcome of the plan, a key figure, or "seconds".
    x, y : str, optional
        Fields of the axes, see :func:`check_axes`. `x` alone gives curves.

    Raises
    ------
    InputError
        See :func:`check_axes`.
    """
    x, y, others = check_axes(plan, value, x, y)
    rows, unit = printed_rows(plan, rows)
    found = [row.get(value) for row in rows if row["status"] == DONE and row.get(value) is not None]
    classes = {} if value == "seconds" else plan.numbers[value].classes
    least = _rounding(plan, rows, value, unit)
    shown = [number for number in found if number is not None and abs(number) > least]
    factor, label = printed_unit(plan, value, unit).scale(shown)
    others_words = {other: value_words(plan, rows, other, unit) for other in others}
    axes = [_axis(plan, rows, name, unit) for name in (y, x) if name is not None]
    shape = tuple(len(axis.values) for axis, _ in axes)
    parts: dict[str, tuple[np.ndarray, ...]] = {}  # numbers, whether runs failed, bars, whether lives don't end
    for row in rows:
        name = "\n".join(others_words[other](row[other]) for other in others if row[other] is not None)
        empty = (np.full(shape, fill) for fill in (np.nan, False, np.nan, False))
        numbers, failed, bars, endless = parts.setdefault(name, tuple(empty))
        place = tuple(places[row[field]] for (_, places), field in zip(axes, (y, x) if y else (x,), strict=True))
        failed[place] = row["status"] == FAILED
        endless[place] = value in row.get("endless", ())
        if row["status"] == DONE and row.get(value) is not None:
            numbers[place] = factor * row[value] if abs(row[value]) > least else 0.0
            bars[place] = factor * row.get(bar_column(value), math.nan)
    return Chart(
        plan.title,
        axis_label(plan.labels.get(value, value.replace("_", " ")), label),
        axes[-1][0],
        axes[0][0] if y else None,
        [(name, numbers, failed) for name, (numbers, failed, *_) in parts.items()],
        len(rows) - len(found),
        plan.base.drawn(plan.case(plan.points[0])),
        tuple(name for name in plan.fields if len(_different([point.values.get(name) for point in plan.points])) > 1),
        {number: words for number, words in classes.items() if len(classes) <= MOST_CLASSES or number in found},
        [bars for *_, bars, _ in parts.values()] if any(bar_column(value) in row for row in rows) else [],
        [endless for *_, endless in parts.values()] if value in plan.outcomes and plan.outcomes[value].is_life else [],
    )


def _axis(plan: Plan, rows: Sequence[TableRow], name: str, unit: Mapping[str, Unit]) -> tuple[Axis, dict[Any, int]]:
    """Return an axis, and the index of each value on it."""
    values = sorted({row[name] for row in rows})
    factor, label = unit.get(plan.base.kind(name), PLAIN).scale(values)
    words = plan.words(name)
    axis = Axis(axis_label(words, label), factor * np.array(values, float), plan.fields[name] == "log")
    return axis, {value: place for place, value in enumerate(values)}


def _in_words(plan: Plan, name: str, value: Any) -> Any:
    """Return the word for the number of a class; another value as it is."""
    classes = plan.numbers[name].classes if name in plan.numbers and value is not None else {}
    return next((word for number, word in classes.items() if number == value), value)


def axis_label(words: str, unit: str) -> str:
    return f"{words} ({unit})" if unit else words


def value_words(plan: Plan, rows: Sequence[TableRow], field: str, unit: Mapping[str, Unit]) -> Callable[[Any], str]:
    """Return a function that gives words for a value of a field, in the unit that suits all its values."""
    words, given = plan.words(field), [row[field] for row in rows if row[field] is not None]
    if not all(map(_is_number, given)):
        return lambda value: f"{words} = {brief(value)}".replace('"', "")
    factor, label = unit.get(plan.base.kind(field), PLAIN).scale(given)
    return lambda value: f"{words} = {factor * value:.4g} {label}".strip()


def _rounding(plan: Plan, rows: Sequence[TableRow], value: str, unit: Mapping[str, Unit]) -> float:
    """Return the size below which values of a figure are rounding.

    It is a part of the largest value, and of the largest key figure of the same kind: a motion that is zero by symmetry
    is compared with the other motions.
    """
    alike = [value]
    if value in KEY_FIGURES and _kind(value):
        alike = [name for name in KEY_FIGURES if _kind(name) == _kind(value)]
    numbers = [abs(row[name]) for row in rows if row["status"] == DONE for name in alike if _is_number(row.get(name))]
    return max(_ROUNDING.get(printed_unit(plan, value, unit).name, 0.0), ROUNDING * max(numbers, default=0.0))


def _kind(figure: str) -> str:
    """Return the kind of a key figure. All angles and widths are of one kind."""
    return "angle" if KEY_FIGURES[figure].is_angle else KEY_FIGURES[figure].kind


def _column(name: str, values: Sequence[Any], unit: Unit, bars: Sequence[float | None] = ()) -> Column:
    """Return a column of the text table. Numbers get an SI prefix; a column with other values is as in the plan.

    `bars` are the error bars of the values; None where a value has none.
    """
    bars = bars or [None] * len(values)
    if not all(value is None or _is_number(value) for value in values):
        words = ["-" if value is None else brief(value).strip('"') for value in values]
        return name, unit.name, [f"{word} ?" if bar else word for word, bar in zip(words, bars, strict=True)]
    least = _ROUNDING.get(unit.name, 0.0)
    values = [0.0 if value is not None and abs(value) < least else value for value in values]
    factor, label = unit.scale([value for value in values if value is not None])
    cells = ["-" if value is None else f"{value * factor:.5g}" for value in values]
    tails = ["" if bar is None else f" +-{factor * bar:.2g}" if math.isfinite(bar) else " +-?" for bar in bars]
    return name, label, [cell + tail for cell, tail in zip(cells, tails, strict=True)]


def printed_rows(plan: Plan, rows: Sequence[TableRow]) -> tuple[Sequence[TableRow], dict[str, Unit]]:
    """Return rows with the outcomes, key figures and error bars in printed units, and the units by kind.

    Each run counts with its own thickness. There are no units if only some of the runs are dimensionless.
    """
    if len({row["dimensionless"] for row in rows if "dimensionless" in row}) > 1:
        return rows, {}
    problem = plan.problem
    printed = {kind: unit.printed for kind, unit in units(problem).items()} | {"angle": DEGREE}
    # The thickness of the points that do not vary it; None if all do. Points of equal states share a case.
    fixed = (plan.base.problem(plan.case(point)).thickness for point in plan.points if THICKNESS not in point.values)
    usual, length = next(fixed, None), measures_of(problem.unit_system, True)["length"]
    thicknesses = [usual if row.get(THICKNESS) is None else length.in_si(row[THICKNESS]) for row in rows]
    of_thickness = {each: units(replace(problem, thickness=each)) for each in {*thicknesses}}
    found = []
    for row, thickness in zip(rows, thicknesses, strict=True):
        unit = of_thickness[thickness]
        factors = {name: each.unit_in(unit).factor for name, each in plan.numbers.items() if each.kind in unit}
        factors |= {bar_column(name): factor for name, factor in factors.items()}
        known = {name: factor * row[name] for name, factor in factors.items() if row.get(name) is not None}
        found.append({**row, **known})
    return found, printed


def printed_unit(plan: Plan, value: str, unit: Mapping[str, Unit]) -> Unit:
    """Return the unit of an outcome, a key figure or "seconds" among the printed units by kind."""
    return Unit(1.0, "s") if value == "seconds" else plan.numbers[value].unit_in(unit)


def definition_words(outcome: StudyOutcome) -> str:
    """Return the definition of an outcome as a plan writes it, without the usual values of wear."""
    found = json.loads(outcome.definition)
    found |= found.pop("how", {})
    usual = {each.name: each.default for each in fields(Wear)}
    usual |= {"criterion": next(iter(FATIGUE_CRITERIA)), "body": BODIES[0]}
    first = next(key for key in KEYS if key in found)
    ordered = {first: found.pop(first), **found}
    words = {key: brief(value) for key, value in ordered.items() if usual.get(key) != value}
    for key, value in ordered.items():
        if isinstance(value, list) and value and isinstance(value[0], dict):  # the terms of a profile along the rim
            terms = (TERMS[each["kind"]](**{name: each[name] for name in each if name != "kind"}) for each in value)
            words[key] = Profile(tuple(terms)).words(brief)
    return ", ".join(f"{key} = {text}" for key, text in words.items())


def brief(value: Any) -> str:
    """Return a value as text, numbers with six significant digits."""
    if isinstance(value, list):
        return f"[{', '.join(map(brief, value))}]"
    return f"{value:.6g}" if _is_number(value) else checks.as_toml(value)


def _is_number(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def _different(values: Sequence[Any]) -> list[Any]:
    return list({json.dumps(value): value for value in values}.values())


def envelopes(plan: Plan, rows: Sequence[TableRow], value: str) -> list[Curve]:
    """Return the envelopes of a sweep: one for each combination of the fields that are no loads; none without a factor.

    The loads at the last corner are multiplied by the factor at failure. The bearing stress is the force on the pin
    over the diameter of the hole, per thickness. The bypass stress is the remote stress in the direction of this
    force, or along the y axis without a force; they are the columns, in this order. The points stand by the angle
    between both.

    Parameters
    ----------
    plan : Plan
    rows : sequence of dict
        From :func:`fastpin.studies.sweep.rows`.
    value : str
        An outcome ``{ strength = "factor" }`` of the plan.

    Raises
    ------
    InputError
        If the outcome is another one.
    """
    check_envelope(plan, value)
    printed, unit = printed_rows(plan, rows)
    varied = [name for name in plan.fields if len({json.dumps(row[name]) for row in rows}) > 1]
    others = {
        name: value_words(plan, printed, name, unit) for name in varied if name.split(".")[0] not in ("load", "loads")
    }
    found: dict[str, list[tuple[float, float]]] = {}
    for point, row in zip(plan.points, rows, strict=True):
        if row.get(value) is not None:
            words = ", ".join(words_of(row[name]) for name, words_of in others.items())
            found.setdefault(words, []).append(_stresses(plan.case(point), row[value]))
    how = StrengthAssessment(**json.loads(plan.outcomes[value].definition)["how"])
    problem = plan.problem
    fixed, stress = {"criterion": strength_words(problem, how)}, units(problem)["traction"]
    curves = []
    for words, points in found.items():
        bypass, bearing = np.array(sorted(points, key=lambda point: math.atan2(*point))).T
        columns = stress.column("bypass stress", bypass) | stress.column("bearing stress", bearing)
        curves.append(Curve(fixed | ({"case": words} if words else {}), columns))
    return curves


def check_envelope(plan: Plan, value: str) -> None:
    """Raise :class:`InputError` if an outcome of a plan is no factor at failure."""
    outcome = plan.outcomes.get(value)
    if outcome is None or json.loads(outcome.definition).get("strength") != "factor":
        raise InputError("value", f'must be an outcome {{ strength = "factor" }} for an envelope, not "{value}"')


def _stresses(case: Case, factor: float) -> tuple[float, float]:
    """Bypass and bearing stress at failure, Pa."""
    load = dict(zip(LOADS, case.history.values()[-1].tolist(), strict=True))
    force = np.array([load["Q"], -load["P"]])
    size = float(np.hypot(*force))
    along = force / size if size else np.array([0.0, -1.0])
    remote = np.array([[load["sxx"], load["sxy"]], [load["sxy"], load["syy"]]])
    return factor * float(along @ remote @ along), factor * size / (2.0 * case.problem.hole_radius)
