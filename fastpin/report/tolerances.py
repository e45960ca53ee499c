"""The effects of tolerances as text, as JSON, and as the numbers of figures."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from fastpin.assess import outputs
from fastpin.assess.outputs import NUMBER, UNKNOWN, Column, Output, list_of, map_of, table
from fastpin.errors import InputError
from fastpin.model import checks, synonyms
from fastpin.model.units import PLAIN, Unit
from fastpin.report.sweep import TableRow, axis_label, printed_rows, printed_unit
from fastpin.studies.index import DONE, FAILED
from fastpin.studies.run_end import bar_column
from fastpin.studies.tolerances import OutcomeEffect, Reached, Tolerances, effects_of, part_words

MOST_OUTCOMES = 4
"""Most outcomes of a figure."""


@dataclass(frozen=True)
class FieldBar:
    """A bar of a tornado: the effect of one field.

    Attributes
    ----------
    words : str
        The field.
    limits : (str, str)
        Its lower and its upper limit, with the unit.
    values : ndarray, shape (m,)
        The outcome at all values of the field, from the lower limit to the upper one. NaN without a value.
    """

    words: str
    limits: tuple[str, str]
    values: np.ndarray


@dataclass(frozen=True)
class Cloud:
    """The samples of one field.

    Attributes
    ----------
    label : str
        The field, with its unit in parentheses.
    values : ndarray, shape (samples,)
        Its values, in the label's unit.
    is_log : bool
        Whether they are spaced by a factor.
    correlation : float
        The rank correlation with the outcome; NaN if it is not known.
    """

    label: str
    values: np.ndarray
    is_log: bool
    correlation: float


@dataclass(frozen=True)
class ToleranceChart:
    """The numbers of the figures of one outcome. All values are in the label's unit.

    Attributes
    ----------
    title : str
        Title of the figure.
    label : str
        Name of the outcome, with its unit in parentheses.
    nominal : float
    bars : list of FieldBar
        One for each field, the largest swing first.
    corners : (float, float) or None
        The smallest and the largest value of all corners.
    percentiles : dict of int to float
        Of the samples.
    clouds : list of Cloud
        One for each field, the largest correlation first.
    samples : ndarray, shape (samples,)
        The outcome at the samples; NaN without a value.
    missing : int
        Number of points without a value.
    """

    title: str
    label: str
    nominal: float
    bars: list[FieldBar]
    corners: tuple[float, float] | None
    percentiles: dict[int, float]
    clouds: list[Cloud]
    samples: np.ndarray
    missing: int


def check_outcomes(study: Tolerances, names: Sequence[str]) -> None:
    """Check the names of the outcomes of a figure.

    Raises
    ------
    InputError
        The field is "value". An outcome is unknown, or there are more than :data:`MOST_OUTCOMES`.
    """
    known = tuple(study.plan.outcomes)
    for name in names:
        if name not in known:
            hint = synonyms.closest(name, known) or f"; there are {', '.join(known)}"
            raise InputError("value", f"there is no outcome {checks.as_toml(name)}{hint}")
    if len(names) > MOST_OUTCOMES:
        raise InputError("value", f"a figure shows at most {MOST_OUTCOMES} outcomes, not {len(names)}")


def tolerance_chart(study: Tolerances, rows: Sequence[TableRow], name: str) -> ToleranceChart:
    """Return the numbers of the figures of one outcome.

    Parameters
    ----------
    study : Tolerances
    rows : sequence of dict
        From :func:`fastpin.studies.sweep.rows`, for ``study.plan``.
    name : str
        An outcome of the plan.

    Raises
    ------
    InputError
        If there is no such outcome.
    """
    check_outcomes(study, [name])
    plan, (found, unit) = study.plan, printed_rows(study.plan, rows)
    effect = effects_of(study, found)[name]
    outcomes = np.array([_known(row, name) for row in found])
    factor, label = printed_unit(plan, name, unit).scale([value for value in outcomes.tolist() if math.isfinite(value)])
    words = {field: plan.words(field) for field in study.limits}
    bars, clouds = [], []
    for field in effect.swings:
        limits, (of_field, of_label) = study.limits[field], _field_unit(study, field, unit)
        ends = (f"{of_field * end:.4g} {of_label}".strip() for end in (limits.low, limits.high))
        first, second = ends
        bars.append(FieldBar(words[field], (first, second), factor * np.array(effect.alone[field])))
        inputs = np.array([of_field * found[place][field] for place in study.samples])
        correlation = effect.correlations.get(field, math.nan)
        clouds.append(Cloud(axis_label(words[field], of_label), inputs, limits.spacing == "log", correlation))
    clouds.sort(key=lambda cloud: -abs(cloud.correlation) if math.isfinite(cloud.correlation) else 0.0)
    return ToleranceChart(
        plan.title,
        axis_label(plan.labels.get(name, name.replace("_", " ")), label),
        factor * effect.nominal,
        bars,
        None if effect.corners is None else (factor * effect.corners[0].value, factor * effect.corners[1].value),
        {percent: factor * value for percent, value in effect.percentiles.items()},
        clouds,
        factor * outcomes[study.samples.start : study.samples.stop],
        int(np.isnan(outcomes).sum()),
    )


def text(study: Tolerances, rows: Sequence[TableRow]) -> str:
    """Return the effects on all outcomes as text: for each a table of the fields, its extremes and its percentiles."""
    parts = ["\n".join([head, table(columns), *ends]) for head, columns, ends in tables(study, rows)]
    return "\n\n".join(filter(None, [failed_words(study, rows), *parts]))


def failed_words(study: Tolerances, rows: Sequence[TableRow]) -> str:
    """Return a sentence that counts the failed runs of each part of a study; empty if none has failed."""
    failed = [place for place, row in enumerate(rows) if row["status"] == FAILED]
    parts = [("corners", study.corners), ("samples", study.samples)]
    counts = [(f"of {len(places):,} {words}", sum(place in places for place in failed)) for words, places in parts]
    for field, places in study.alone.items():
        counts.append(
            (f"of {len(places):,} values of {field} alone", sum(place in places for place in failed if place))
        )
    if 0 in failed:
        counts.append(("the nominal case", 1))
    listed = ", ".join(f"{count:,} {words}" if words[:2] == "of" else words for words, count in counts if count)
    return f"failed: {listed}; they count nowhere below" if failed else ""


def tables(study: Tolerances, rows: Sequence[TableRow]) -> list[tuple[str, list[Column], list[str]]]:
    """Return a heading, a table of the fields and sentences on the extremes for each outcome."""
    found, unit = printed_rows(study.plan, rows)
    return [_table(study, found, unit, name, effect) for name, effect in effects_of(study, found).items()]


def _table(
    study: Tolerances, rows: Sequence[TableRow], unit: Mapping[str, Unit], name: str, effect: OutcomeEffect
) -> tuple[str, list[Column], list[str]]:
    known = [value for value in (_known(row, name) for row in rows) if math.isfinite(value)]
    factor, label = printed_unit(study.plan, name, unit).scale(known)

    def shown(value: float) -> str:
        return f"{factor * value:.5g}" if math.isfinite(value) else "-"

    fields = [*effect.swings]
    units_of = [_field_unit(study, field, unit) for field in fields]
    pairs = [(by, study.limits[field]) for (by, _), field in zip(units_of, fields, strict=True)]
    columns: list[Column] = [
        ("field", "", [study.plan.labels.get(field, field) for field in fields]),
        ("from", "", [f"{by * each.low:.5g}" for by, each in pairs]),
        ("to", "", [f"{by * each.high:.5g}" for by, each in pairs]),
        ("", "", [of_label for _, of_label in units_of]),
        ("at from", label, [shown(effect.alone[field][0]) for field in fields]),
        ("at to", label, [shown(effect.alone[field][-1]) for field in fields]),
        ("swing", label, [shown(effect.swings[field]) for field in fields]),
    ]
    if effect.correlations:
        cells = [effect.correlations[field] for field in fields]
        columns.append(("rank corr.", "", [f"{cell:+.2f}" if math.isfinite(cell) else "-" for cell in cells]))
    head = f"{study.plan.labels.get(name, name)}: nominal {shown(effect.nominal)} {label}".rstrip()

    def reached(point: Reached) -> str:
        return f"{shown(point.value)} {label}".rstrip() + f" at {_point_words(study, point.place, unit)}"

    sentences = _extremes(study, effect, reached)
    if effect.percentiles:
        listed = (f"{percent} %: {shown(value)} {label}".rstrip() for percent, value in effect.percentiles.items())
        sentences.append(f"percentiles of {len(study.samples):,} samples: {', '.join(listed)}")
    lost = sum(row["status"] == DONE and not math.isfinite(_known(row, name)) for row in rows)
    sentences += [f"{lost:,} finished runs have no value"] if lost else []
    unknown = _unresolved(rows, name)
    sentences += [f"{unknown:,} runs have a value that the nodes do not resolve"] if unknown else []
    return head, columns, sentences


def _extremes(study: Tolerances, effect: OutcomeEffect, reached: Callable[[Reached], str]) -> list[str]:
    """Return sentences on the extremes of the corners, and on runs beyond them."""
    lines = []
    if effect.corners is not None and effect.beyond is not None:
        count = len(study.corners)
        lines += [f"{end} of {count:,} corners: {reached(point)}" for end, point in _named(effect.corners)]
        pairs = zip(effect.corners, _named(effect.beyond), strict=True)
        lines += [f"beyond all corners, {end}: {reached(point)}" for corner, (end, point) in pairs if point != corner]
    elif effect.everywhere is not None:
        lines += [f"{end} of all runs: {reached(point)}" for end, point in _named(effect.everywhere)]
    return lines


def _point_words(study: Tolerances, place: int, unit: Mapping[str, Unit]) -> str:
    """Return the fields of a point with their units, and its part of the study. Alone means at nominal otherwise."""
    words, values = part_words(study, place), study.plan.points[place].values
    fields = [field for field in study.limits if words == f"{field} alone"] or [*study.limits]
    listed = []
    for field in fields:
        factor, label = _field_unit(study, field, unit)
        listed.append(f"{field} = {factor * values[field]:.5g} {label}".rstrip())
    return (
        ", ".join(listed) if place in study.corners else f"{', '.join(listed)} ({words.removeprefix(f'{fields[0]} ')})"
    )


def _named(span: Sequence[Reached]) -> list[tuple[str, Reached]]:
    return list(zip(("smallest", "largest"), span, strict=True))


@dataclass(frozen=True, eq=False)
class _Effects:
    """A study with the rows of its points, in printed units, and the names of these."""

    study: Tolerances
    rows: Sequence[TableRow]
    unit: Mapping[str, Unit]

    def point(self, place: int) -> dict[str, Any]:
        """The part of the study and the fields of a point."""
        return {"part": part_words(self.study, place), "values": self.study.plan.points[place].values}

    def count(self, status: str) -> int:
        """The number of points with a status."""
        return sum(row["status"] == status for row in self.rows)

    def span(self, ends: Sequence[Reached] | None) -> dict[str, Any] | None:
        """The extremes of some runs, with their points."""
        if ends is None:
            return None
        return {end: {"value": reached.value, **self.point(reached.place)} for end, reached in _named(ends)}

    @property
    def outcomes(self) -> dict[str, tuple[_Effects, str, OutcomeEffect]]:
        """The effects on each outcome."""
        return {name: (self, name, effect) for name, effect in effects_of(self.study, self.rows).items()}


def _of_fields(found: tuple[_Effects, str, OutcomeEffect]) -> dict[str, dict[str, Any]]:
    """Return the effect of each field on an outcome, the largest swing first."""
    whole, _, effect = found
    return {
        field: {
            "values": whole.study.limits[field].values,
            "outcomes": effect.alone[field],
            "swing": swing,
            "rank_correlation": effect.correlations.get(field, math.nan),
        }
        for field, swing in effect.swings.items()
    }


_POINT = (Output("part", "text"), Output("values", form=map_of(NUMBER, "the fields")))

_SPAN = [Output(end, parts=(Output("value"), *_POINT)) for end in ("smallest", "largest")]

OUTCOME = (
    Output("unit", "text", lambda found: printed_unit(found[0].study.plan, found[1], found[0].unit).name),
    Output("nominal", of=lambda found: found[2].nominal, optional=True),
    Output(
        "fields", "map", _of_fields, "the effect of each field, the largest swing first",
        parts=(
            Output("values", form=list_of(NUMBER)), Output("outcomes", form=list_of(UNKNOWN)),
            *outputs.numbers("swing rank_correlation", optional=True),
        ),
    ),
    Output("corners", of=lambda found: found[0].span(found[2].corners), parts=_SPAN, optional=True),
    Output("all", of=lambda found: found[0].span(found[2].everywhere), parts=_SPAN, optional=True),
    Output("percentiles", of=lambda found: found[2].percentiles, form=map_of(NUMBER, "percentiles of the samples")),
    Output(
        "unresolved", "whole", lambda found: _unresolved(found[0].rows, found[1]),
        "number of runs whose value the nodes do not resolve",
    ),
)  # fmt: skip
"""Outputs of the effects on an outcome."""

TOLERANCES = (
    Output("points", "whole", lambda found: len(found.rows)),
    Output("done", "whole", lambda found: found.count(DONE)),
    Output("corners", "whole", lambda found: len(found.study.corners)),
    Output("samples", "whole", lambda found: len(found.study.samples)),
    Output(
        "failed", "list", parts=(*_POINT, Output("reason", "text")),
        of=lambda found: [
            found.point(place) | {"reason": row["reason"] or ""}
            for place, row in enumerate(found.rows) if row["status"] == FAILED
        ],
    ),
    Output(
        "fields", "map", lambda found: found.study.limits, "the limits of each field, in the units of the case file",
        parts=(
            Output("nominal"), Output("from", of=lambda each: each.low), Output("to", of=lambda each: each.high),
            Output("spacing", "text", allowed=("linear", "log")),
        ),
    ),
    Output("outcomes", "map", words="the effects on each outcome", parts=OUTCOME),
)  # fmt: skip
"""Outputs of a tolerance study."""


def document(study: Tolerances, rows: Sequence[TableRow]) -> dict[str, Any]:
    """Return the effects on all outcomes as a JSON-ready dict. NaN is None; outcomes have their printed units."""
    plan, found = study.plan, _Effects(study, *printed_rows(study.plan, rows))
    return outputs.whole_document(TOLERANCES, found, {}, title=plan.title)


def _known(row: TableRow, name: str) -> float:
    """Return the outcome of a finished run; NaN without a value."""
    value = row.get(name) if row["status"] == DONE else None
    return math.nan if value is None else float(value)


def _unresolved(rows: Sequence[TableRow], name: str) -> int:
    """Return the number of runs whose outcome has an error that is not known: the nodes do not resolve it."""
    return sum(row["status"] == DONE and math.isinf(row.get(bar_column(name)) or 0.0) for row in rows)


def _field_unit(study: Tolerances, field: str, unit: Mapping[str, Unit]) -> tuple[float, str]:
    """Return the factor and the label of the unit that suits the limits of a field."""
    return unit.get(study.plan.base.kind(field), PLAIN).scale([study.limits[field].low, study.limits[field].high])
