"""Tolerance studies: how far the outcomes of a case move where its fields lie anywhere between their limits.

A tolerance plan is a TOML text with a base case and the limits of some of its fields. It makes the points of a sweep:
the nominal case, each field alone, all corners of the limits, and random samples between them. A sweep solves and keeps
their runs, so the parts of a study share runs, and a study continues after a stop.

    >>> from fastpin.studies import read_tolerances, sweep
    >>> study = read_tolerances("tolerances.toml")                  # doctest: +SKIP
    >>> summary = sweep.run(study.plan, "tolerances")               # doctest: +SKIP
    >>> effects = study.effects("tolerances")                       # doctest: +SKIP
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from fastpin.assess.outputs import ROUNDING
from fastpin.casefile.toml_text import MOST_BYTES_OF_PLAN, CaseText, KeyPath, parse_text, read_text
from fastpin.errors import InputError
from fastpin.model.checks import as_toml, check_callable, file_path, string, true_or_false, whole_number
from fastpin.model.doubts import warn_of
from fastpin.studies.index import DONE
from fastpin.studies.outcome_tables import outcomes_in_text
from fastpin.studies.plan import (
    MAX_RUNS,
    ROOT_KEYS,
    Base,
    Plan,
    PlanRow,
    Spacing,
    SweepProgress,
    base_case,
    check_root,
    labels_in,
    range_in,
    usual_outcomes,
    varied_fields,
    with_points,
)
from fastpin.studies.run_end import KEY_FIGURES
from fastpin.studies.sweep import rows

PERCENTS = (5, 50, 95)
"""Percentiles of the samples."""

MOST_FIELDS = 10
"""Most fields whose corners are all run: 1,024 corners."""

SAMPLES = 200
"""Samples unless given. The rank correlation of independent numbers then scatters by 0.07."""

KEYS = {name: words for name, words in ROOT_KEYS.items() if name not in ("grid", "list")} | {
    "tolerances": "[tolerances]", "corners": "corners", "samples": "samples", "seed": "seed"
}  # fmt: skip
"""Keys of a tolerance plan, as they are written."""


class Reached(NamedTuple):
    """A value of an outcome, and the place of its point in the plan."""

    value: float
    place: int


class Span(NamedTuple):
    """The smallest and the largest value of some runs."""

    smallest: Reached
    largest: Reached


@dataclass(frozen=True)
class OutcomeEffect:
    """The effect of all tolerances on one outcome. A run without a value counts nowhere and is NaN.

    Attributes
    ----------
    nominal : float
        The value of the nominal case.
    alone : dict of str to list of float
        The values where one field differs from the nominal case, in the order of its :class:`FieldLimits`.
    corners, everywhere : Span or None
        The extremes of the corners, and of all runs; None if none has a value.
    percentiles : dict of int to float
        Of the samples, see :data:`PERCENTS`; empty without samples.
    correlations : dict of str to float
        Spearman's rank correlation of each field with the outcome over the samples, -1 to 1. NaN where the outcome is
        the same in all samples, or less than three have a value.
    """

    nominal: float
    alone: dict[str, list[float]]
    corners: Span | None
    everywhere: Span | None
    percentiles: dict[int, float]
    correlations: dict[str, float]

    @property
    def swings(self) -> dict[str, float]:
        """The largest minus the smallest value of each field alone, the largest swing first. NaN without two values."""
        known = {name: [value for value in values if math.isfinite(value)] for name, values in self.alone.items()}
        found = {name: max(some) - min(some) if len(some) > 1 else math.nan for name, some in known.items()}
        return dict(sorted(found.items(), key=lambda item: -item[1] if math.isfinite(item[1]) else math.inf))

    @property
    def beyond(self) -> Span | None:
        """The extremes of all runs where they lie beyond all corners; else those of the corners. None without corners.

        An outcome that first rises and then falls with a field has its extreme between the limits.
        """
        if self.corners is None or self.everywhere is None:
            return None
        least = ROUNDING * max(abs(end.value) for end in self.everywhere)
        pairs = zip(self.corners, self.everywhere, strict=True)
        return Span(*(end if abs(end.value - corner.value) > least else corner for corner, end in pairs))


def effect_of(
    values: np.ndarray,
    inputs: Mapping[str, np.ndarray],
    alone: Mapping[str, Sequence[int]],
    corners: range,
    samples: range,
) -> OutcomeEffect:
    """Return the effect of tolerances on one outcome.

    Parameters
    ----------
    values : ndarray, shape (points,)
        The outcome at each point; NaN without a value.
    inputs : dict of str to ndarray, shape (points,)
        The fields at each point.
    alone : dict of str to list of int
        The places of the points where one field differs from the nominal case, which has place 0.
    corners, samples : range
        The places of corners and samples.
    """
    sampled, known = values[samples.start : samples.stop], np.isfinite(values[samples.start : samples.stop])
    fields = {name: column[samples.start : samples.stop][known] for name, column in inputs.items()}
    percentiles = np.percentile(sampled[known], PERCENTS).tolist() if known.any() else []
    return OutcomeEffect(
        float(values[0]),
        {name: values[list(places)].tolist() for name, places in alone.items()},
        _span(values, corners),
        _span(values, range(len(values))),
        dict(zip(PERCENTS, percentiles, strict=False)),
        {name: rank_correlation(column, sampled[known]) for name, column in fields.items()} if samples else {},
    )


def rank_correlation(first: np.ndarray, second: np.ndarray) -> float:
    """Return Spearman's rank correlation of two arrays, shape (n,). NaN if n < 3, or if all values of one are equal.

    Values that differ by less than :data:`ROUNDING` of the largest are equal. Equal values share their middle rank.
    """
    if len(first) < 3:
        return math.nan
    ranks = np.array([_ranks(first), _ranks(second)])
    if (np.ptp(ranks, axis=1) == 0.0).any():
        return math.nan
    return float(np.corrcoef(ranks)[0, 1])


def _ranks(values: np.ndarray) -> np.ndarray:
    """Return the ranks of values, shape (n,)."""
    least = ROUNDING * float(np.abs(values).max()) or 1.0
    _, inverse, counts = np.unique(np.round(values / least), return_inverse=True, return_counts=True)
    middles: np.ndarray = np.cumsum(counts) - 0.5 * (counts - 1)
    return middles[inverse]


def _span(values: np.ndarray, places: range) -> Span | None:
    known = [place for place in places if math.isfinite(values[place])]
    if not known:
        return None
    smallest, largest = (choose(known, key=values.__getitem__) for choose in (min, max))
    return Span(Reached(float(values[smallest]), smallest), Reached(float(values[largest]), largest))


class FieldLimits(NamedTuple):
    """The limits of a field, in the units of the case file.

    Attributes
    ----------
    nominal : float
        The value of the case; 1 for a factor.
    values : tuple of float
        All values that are run one at a time, increasing: both limits, the nominal value, and values between them.
    spacing : {"linear", "log"}
        How samples lie between the limits: uniform in the value, or in its logarithm.
    """

    nominal: float
    values: tuple[float, ...]
    spacing: Spacing

    @property
    def low(self) -> float:
        """The lower limit."""
        return self.values[0]

    @property
    def high(self) -> float:
        """The upper limit."""
        return self.values[-1]


@dataclass(frozen=True, repr=False)
class Tolerances:
    """A tolerance plan and its points. :func:`read_tolerances` and :func:`parse_tolerances` make it.

    Attributes
    ----------
    plan : Plan
        The points, for :func:`fastpin.studies.sweep.run`. The nominal case is the first point.
    limits : dict of str to FieldLimits
        The fields and their limits.
    alone : dict of str to list of int
        The places among the points where only this field differs from the nominal case, one for each value of its
        limits. The nominal case has place 0.
    corners, samples : range
        The places of the corners and of the samples.
    """

    plan: Plan
    limits: dict[str, FieldLimits]
    alone: dict[str, list[int]]
    corners: range
    samples: range

    def __repr__(self) -> str:
        counts = f"{len(self.corners):,} corners, {len(self.samples):,} samples"
        return f"<Tolerances of {', '.join(self.limits)}: {counts}>"

    def with_outcomes(self, outcomes: Mapping[str, Any]) -> Tolerances:
        """Return this plan with more outcomes, see :meth:`fastpin.studies.plan.Plan.with_outcomes`.

        Raises
        ------
        InputError
            Also if an outcome is a class: classes have no swing.
        """
        plan = self.plan.with_outcomes(outcomes)
        for name, outcome in plan.outcomes.items():
            if outcome.classes:
                raise InputError("outcomes", _no_swing(name))
        return replace(self, plan=plan)

    def effects(self, directory: str | Path) -> dict[str, OutcomeEffect]:
        """Return the effects of the tolerances on every outcome, from the finished runs in a directory.

        Parameters
        ----------
        directory : path
            The folder of :func:`fastpin.studies.sweep.run`.

        Returns
        -------
        dict of str to OutcomeEffect
            Values have the units of :func:`fastpin.studies.sweep.load`. Places are those of ``plan.points``.

        Raises
        ------
        InputError
            If the index can't be used.
        """
        return effects_of(self, rows(self.plan, directory))


def effects_of(study: Tolerances, found: Sequence[dict[str, Any]]) -> dict[str, OutcomeEffect]:
    """Return the effects on every outcome from rows of :func:`fastpin.studies.sweep.rows`, in any unit."""
    inputs = {name: np.array([row[name] for row in found], dtype=float) for name in study.limits}
    effects = {}
    for name, outcome in study.plan.outcomes.items():
        known = [row.get(name) if row["status"] == DONE else None for row in found]
        values = np.array([math.nan if value is None else value for value in known], dtype=float)
        if outcome.kind == "angle":  # places on a circle are compared with the nominal place
            values = values[0] + np.mod(values - values[0] + 180.0, 360.0) - 180.0
        effects[name] = effect_of(values, inputs, study.alone, study.corners, study.samples)
    return effects


def part_words(study: Tolerances, place: int) -> str:
    """Return the part of a study to which a point belongs: "a corner", "a sample", "nominal", or a field "alone"."""
    if place in study.corners:
        return "a corner"
    if place in study.samples:
        return "a sample"
    return next((f"{name} alone" for name, places in study.alone.items() if place in places and place), "nominal")


def read_tolerances(path: str | Path, progress: SweepProgress | None = None) -> Tolerances:
    """Read a tolerance plan.

    Parameters
    ----------
    path : path
        The plan. Relative paths start as in :func:`fastpin.studies.read_plan`.
    progress : callable, optional
        Called as ``progress(done, total)`` before each point is checked.

    Raises
    ------
    CaseFileError
        With all faults of the plan, of the base case and of the runs, each with its line.
    InputError
        If `path` is no path, or `progress` can't be called.
    """
    path = file_path("path", path)
    check_callable("progress", progress)
    text = read_text(path, MOST_BYTES_OF_PLAN)
    study = parse_text(text, str(path), "tolerance plan", lambda source: _study(source, text, path.parent, progress))
    warn_of(study.plan.doubts, 2)
    return study


def parse_tolerances(text: str, name: str = "tolerance plan", folder: str | Path = ".") -> Tolerances:
    """Read a tolerance plan from `text`. See :func:`fastpin.studies.parse_plan` for the arguments and errors."""
    place = file_path("folder", folder)
    study = parse_text(text, name, "tolerance plan", lambda source: _study(source, text, place, None))
    warn_of(study.plan.doubts, 2)
    return study


def has_tolerances(text: str) -> bool:
    """Whether the text of a plan is a tolerance plan."""
    return "tolerances" in CaseText(text).root


# -- text of a plan ------------------------------------------------------------------------------------------


def _study(source: CaseText, text: str, folder: Path, progress: SweepProgress | None) -> Tolerances | None:
    """Read the plan. It has no meaning if the text has faults."""
    check_root(source, KEYS, "[tolerances]")
    title = source.root.checked("title", string) or ""
    base = base_case(source, folder)
    text_of_case, case = (None, None) if base is None else base.vary({})
    if base is not None and text_of_case is not None and text_of_case.faults:
        for line, message in text_of_case.faults:
            source.report(f"{base.name}{f', line {line}' if line else ''}: {message}", "case")
        case = None
    places: dict[str, KeyPath] = {}
    limits: dict[str, FieldLimits] = {}
    for place, name, value in varied_fields(source, base, source.section("tolerances").table, ("tolerances",)):
        if name in places:
            source.report(f"{name}: has limits already, in line {source.line(*places[name])}", *place)
            continue
        places[name] = place
        found = None if base is None or case is None else _limits(source, base, case, (place, name, value))
        limits |= {} if found is None else {name: found}
    if not places and not source.faults:
        source.report("no field has limits: give [tolerances], such as contact.friction = { from = 0.1, to = 0.6 }")
    outcomes = outcomes_in_text(source, folder, {} if base is None else base.beside())
    for name, outcome in outcomes.items():
        if outcome.classes:
            source.report(_no_swing(name), "outcomes", name)
    if base is not None and not outcomes and case is not None:
        outcomes = usual_outcomes(base, swing=True)
    with_corners, count, seed = _extent(source, len(places))
    labels = labels_in(source, (*places, *outcomes, *KEY_FIGURES))
    if base is None or source.faults:
        return None
    alone, corners, samples, values = _values(limits, with_corners, _samples(limits, count, seed))
    if len(values) > MAX_RUNS:
        source.report(f"the study has {len(values):,} runs; more than {MAX_RUNS:,} are not possible in one")
        return None
    plan_rows: list[PlanRow] = [{name: (places[name], row[name]) for name in limits} for row in values]
    fields: dict[str, Spacing] = {name: each.spacing for name, each in limits.items()}
    plan = Plan(title, text, fields, {}, [], outcomes, [], labels, base, {})
    return Tolerances(with_points(plan, source, places, plan_rows, progress), limits, alone, corners, samples)


def _limits(source: CaseText, base: Base, case: Any, given: tuple[KeyPath, str, Any]) -> FieldLimits | None:
    """Read the limits of a field, given by its place, its name and its value in the text. None with a fault."""
    place, name, value = given
    before = len(source.placed)
    if name.startswith("solve."):
        source.report(f"{name}: is an option of the solver and has no tolerance; fastpin converge varies it", *place)
        return None
    if not isinstance(value, dict):
        source.report(f"{name}: must be limits such as {{ from = 0.1, to = 0.6 }}, not {as_toml(value)}", *place)
        return None
    values, spacing = range_in(source, place, name, value, 2)
    nominal = base.nominal(case, name)
    if len(source.placed) > before:
        return None
    if values[0] >= values[-1]:
        source.report(f"{name}: from must lie below to, but {values[0]:g} is not below {values[-1]:g}", *place)
    elif name.partition(".")[0] == "loads" and base.is_idle(case, name):
        source.report(f"{name}: the case has no such load, and a factor would change nothing", *place)
    elif nominal is None:
        words = f"{name}: the case has no number for it, which would be the nominal value"
        hint = "; a load with several points is varied by a factor, such as loads.P" if name.startswith("load.") else ""
        source.report(f"{words}{hint}", *place)
    elif not values[0] <= nominal <= values[-1]:
        words = f"{name}: the case has {nominal:g}, outside of the limits {values[0]:g} and {values[-1]:g}"
        source.report(words, *place)
    else:
        return FieldLimits(nominal, tuple(sorted({*values, nominal})), spacing)
    return None


def _extent(source: CaseText, fields: int) -> tuple[bool, int, int]:
    """Read whether corners are run, and the number and the seed of the samples."""
    root = source.root
    corners = root.checked("corners", true_or_false)
    samples = root.checked("samples", whole_number, 0, MAX_RUNS)
    seed = root.checked("seed", whole_number, 0, 2**32 - 1)
    if fields > MOST_FIELDS and corners is not False:
        words = f"{fields} fields have {2**fields:,} corners, and those of at most {MOST_FIELDS} fields are run: write "
        words += "corners = false, and leave the combinations to samples"
        source.report(words, "corners" if "corners" in root else "tolerances")
    return corners is not False, SAMPLES if samples is None else samples, 1 if seed is None else seed


def _no_swing(name: str) -> str:
    return f"{name}: is a class, which has no swing; an outcome of a tolerance study is a number"


# -- points --------------------------------------------------------------------------------------------------


def _samples(limits: Mapping[str, FieldLimits], count: int, seed: int) -> Iterator[dict[str, float]]:
    """Yield the samples of a Latin hypercube: each field has one value in each of `count` equal parts of its limits.

    Two lines of NumPy stand for :mod:`scipy.stats.qmc`, whose import takes two seconds.
    """
    random = np.random.default_rng(seed)
    parts = {name: (random.permutation(count) + random.random(count)) / max(count, 1) for name in limits}
    for place in range(count):
        row = {}
        for name, each in limits.items():
            part, low, high = float(parts[name][place]), each.low, each.high
            value = low * (high / low) ** part if each.spacing == "log" else low + part * (high - low)
            row[name] = float(f"{value:.12g}")
        yield row


def _values(
    limits: Mapping[str, FieldLimits], with_corners: bool, samples: Iterator[dict[str, float]]
) -> tuple[dict[str, list[int]], range, range, list[dict[str, float]]]:
    """Return the places of the values alone, of the corners and of the samples; and the fields of all points."""
    nominal = {name: each.nominal for name, each in limits.items()}
    values, alone = [nominal], dict[str, list[int]]()
    for name, each in limits.items():
        alone[name] = []
        for value in each.values:
            alone[name].append(0 if value == each.nominal else len(values))
            values += [] if value == each.nominal else [nominal | {name: value}]
    first = len(values)
    if with_corners:
        ends = itertools.product(*((each.low, each.high) for each in limits.values()))
        values += [dict(zip(limits, corner, strict=True)) for corner in ends]
    second = len(values)
    values += samples
    return alone, range(first, second), range(second, len(values)), values
