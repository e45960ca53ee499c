"""How the fatigue of a load spectrum is assessed: criteria, bodies, distance from the edge, and small cycles."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np

from fastpin.errors import InputError
from fastpin.model.angles import angle_at
from fastpin.model.checks import (
    as_toml,
    check_fields,
    choice,
    given_fields,
    items,
    number,
    positive,
    set_fields,
    true_or_false,
)
from fastpin.model.crack import checked_residual
from fastpin.model.fatigue import LIFE_CONSTANTS, FatigueConstants
from fastpin.model.history import LoadHistory
from fastpin.model.options import SolveOptions
from fastpin.model.points import (
    BODIES,
    CRITERION,
    Body,
    elastic_bodies,
    isotropic_bodies,
    isotropic_material,
    material_of,
    owner_of,
)
from fastpin.model.problem import LEAST_RADIUS, MOST_RADIUS, Problem

MINER_RULES = ("elementary", "original", "haibach")
"""The variants of Miner's rule for small cycles: the curve of lives goes on, ends, or falls off beyond its knee."""

DISTANCES = ("edge", "point", "line", "area")
"""Places of the stresses: the edge, and the methods of the theory of critical distances."""

SPECTRA = ("history", "cycle")
"""Parts of a history that are one pass of the spectrum: all of it, or its last cycle."""

MOST_LIFE = 1e18
"""Most passes of a spectrum, and most cycles at a knee: no test has gone as far."""


@dataclass(frozen=True)
class FatigueAssessment:
    """How the fatigue of a load spectrum is assessed. The constants belong to the materials of the bodies.

    Parameters
    ----------
    criterion : str or sequence of str
        Criteria with lives: "smith-watson-topper", "fatemi-socie", "stress-life".
    bodies : str or sequence of str, optional
        Of "plate", "pin" and "seat"; unless given, all elastic bodies whose own material has the constants.
    over : {"history", "cycle"}
        One pass of the spectrum: the whole history, or its last cycle.
    method : {"edge", "point", "line", "area"}
        The stresses on the edge, or the mean stresses of a method of the theory of critical distances, see
        :func:`fastpin.damage.fatigue_at_distance`.
    length : float, optional
        The critical distance L, m; from ``threshold_range`` and ``limit_range`` of each material unless given. Only
        with a method of critical distances.
    angles : float or sequence of float, optional
        Places on the edge, degrees from the bottom of the hole. Unless given, the whole edge; a method of critical
        distances then takes the hot spot of the edge.
    small_cycles : {"elementary", "original", "haibach"}
        The variant of Miner's rule, see :func:`fastpin.damage.spectrum_damage`.
    knee : float, optional
        Cycles at the knee of the curve of lives; needed by "original" and "haibach", and only by them.
    straight : bool, optional
        Whether the tractions are straight lines between the nodes. Unless given, they are for more than 500 states.
    life : float, optional
        The life that is asked for: passes of the spectrum without a crack. It gives a margin of safety.
    reliability : float, optional
        Part of the specimens that live longer than the life that is told, such as 0.99; the median life unless given.
        For "stress-life" alone.
    confidence : float, optional
        Confidence in this life for the number of specimens behind the curve, such as 0.95. Unless given, the curve and
        its scatter are taken as exact.
    residual_stress : float or sequence of (float, float), optional
        Hoop stress that the plate has without loads round its hole, or round the seat of its bush, Pa; negative after
        cold working. One number, or pairs of a distance to the edge, m, and a stress. It is added to the stresses of
        all states.

    Raises
    ------
    InputError
        If a field can't be used.
    """

    criterion: str | Sequence[str] = "smith-watson-topper"
    bodies: str | Sequence[str] | None = None
    over: str = "history"
    method: str = "edge"
    length: float | None = None
    angles: float | Sequence[float] | None = None
    small_cycles: str = "elementary"
    knee: float | None = None
    straight: bool | None = None
    life: float | None = None
    reliability: float | None = None
    confidence: float | None = None
    residual_stress: float | Sequence[Sequence[float]] | None = None

    def __post_init__(self) -> None:
        check_fields(self, _checked_words, "criterion", tuple(LIFE_CONSTANTS))
        check_fields(self, _checked_words, "bodies", BODIES, optional=True)
        choice("over", self.over, SPECTRA)
        choice("method", self.method, DISTANCES)
        if self.length is not None:
            set_fields(self, length=checked_distance(self.length))
            if self.method == "edge":
                raise InputError("length", 'belongs to the methods "point", "line" and "area", but method is "edge"')
        if self.angles is not None:
            given = [self.angles] if isinstance(self.angles, (int, float)) else self.angles
            angles = [number("angles", each, -360.0, 360.0) for each in items("angles", given, "a list of angles")]
            if not 1 <= len(angles) <= 10_000:
                raise InputError("angles", f"must be 1 to 10,000 angles, not {len(angles):,}")
            set_fields(self, angles=tuple(angles))
        set_fields(self, knee=checked_knee(self.small_cycles, self.knee))
        check_fields(self, true_or_false, "straight", optional=True)
        check_fields(self, number, "life", 1.0, MOST_LIFE, optional=True)
        # No test has shown the tail of a scatter beyond the largest reliability and confidence.
        check_fields(self, number, "reliability confidence", 0.5, 0.999999, optional=True)
        if self.reliability is not None and self.criteria != ("stress-life",):
            raise InputError("reliability", f'needs criterion = "stress-life", not {as_toml(list(self.criteria))}')
        if self.confidence is not None and self.reliability is None:
            raise InputError("confidence", "belongs to a reliability, such as reliability = 0.99")
        check_fields(self, checked_residual, "residual_stress", optional=True)

    @property
    def criteria(self) -> tuple[str, ...]:
        """The criteria, in the given order."""
        return tuple(self.criterion)

    @property
    def scatter_needs(self) -> tuple[str, ...]:
        """The constants of the scatter that it needs of each material."""
        if self.reliability is None:
            return ()
        return ("curve_scatter",) if self.confidence is None else ("curve_scatter", "curve_samples")

    @property
    def reliability_words(self) -> str:
        """The end of a sentence on the reliability; empty for median lives."""
        if self.reliability is None:
            return ""
        sure = "" if self.confidence is None else f" with a confidence of {100.0 * self.confidence:.6g} %"
        return f", lives that {100.0 * self.reliability:.6g} % of the specimens reach{sure}"

    @property
    def passes(self) -> str:
        """The word for passes of the spectrum: "spectra" or "cycles"."""
        return "spectra" if self.over == "history" else "cycles"

    @property
    def theta(self) -> np.ndarray | None:
        """The angles, rad, counter-clockwise from the +x axis; None for the whole edge."""
        return None if self.angles is None else np.array([angle_at(each) for each in np.ravel(self.angles).tolist()])

    @property
    def given(self) -> dict[str, Any]:
        """The fields that differ from their usual values, by name. A list of one word is this word."""
        values = {each.name: getattr(self, each.name) for each in fields(self)}
        for name in ("criterion", "bodies"):
            if isinstance(values[name], tuple) and len(values[name]) == 1:
                (values[name],) = values[name]
        usual = {each.name: each.default for each in fields(self)}
        return {name: value for name, value in values.items() if value != usual[name]}

    def toml(self) -> dict[str, Any]:
        """The keys and values of the section [fatigue] of a case file."""
        return {name: _as_lists(value) for name, value in self.given.items()}

    def written(self) -> dict[str, Any]:
        """The section [fatigue] with its criterion, so that it is never empty."""
        return {"criterion": self.criteria[0] if len(self.criteria) == 1 else list(self.criteria)} | self.toml()

    def stored(self) -> dict[str, Any]:
        """All given fields, for files."""
        return given_fields(self)

    def changed(self, **given: Any) -> FatigueAssessment:
        """Return the assessment with other values of some fields.

        Raises
        ------
        InputError
            If a value can't be used.
        """
        return replace(self, **given)


def checked_distance(length: object) -> float:
    """Check a critical distance, m, which has the limits of a radius, and return it as a float."""
    return number("length", positive("length", length), LEAST_RADIUS, MOST_RADIUS)


def _checked_words(field: str, value: str | Sequence[str], allowed: tuple[str, ...]) -> tuple[str, ...]:
    """Check a word or a list of different words."""
    given = [value] if isinstance(value, str) else items(field, value, "a word or a list of words")
    words = tuple(choice(field, each, allowed) for each in given)
    if not words or len(set(words)) < len(words):
        raise InputError(field, f"must be at least one word, each one once, not {len(words)}")
    return words


def checked_knee(rule: str, knee: float | None) -> float | None:
    """Check a variant of Miner's rule with the cycles at its knee, and return these.

    Raises
    ------
    InputError
        If the rule is unknown, or its knee is missing, too much or out of range.
    """
    choice("small_cycles", rule, MINER_RULES)
    if rule == "elementary":
        if knee is not None:
            raise InputError("knee", 'belongs to "original" and "haibach", but small_cycles is "elementary"')
        return None
    if knee is None:
        raise InputError("knee", f'must be given with small_cycles = "{rule}": the cycles at the knee, such as 1e6')
    return number("knee", knee, 1.0, MOST_LIFE)


def assessed_bodies(problem: Problem, how: FatigueAssessment, criterion: str) -> tuple[Body, ...]:
    """The bodies whose fatigue is assessed by a criterion: the given ones, or all with its constants.

    Raises
    ------
    InputError
        If a given body is rigid or not there, or a material lacks constants. The message names them.
    """
    names = (*LIFE_CONSTANTS[criterion][0], *LIFE_CONSTANTS[criterion][1])
    if how.bodies is not None:
        bodies = tuple(body for body in BODIES if body in how.bodies)
        for body in bodies:
            if material_of(problem, body).is_rigid:  # type: ignore[arg-type]
                raise InputError("bodies", f"the {owner_of(problem, body)} is rigid and has no stress")
            isotropic_material("bodies", problem, body, CRITERION)  # type: ignore[arg-type]
            _check_constants(problem, body, names, criterion)  # type: ignore[arg-type]
        return bodies  # type: ignore[return-value]
    elastic = isotropic_bodies(problem)
    if not elastic and elastic_bodies(problem):
        isotropic_material("bodies", problem, elastic_bodies(problem)[0], CRITERION)
    constants = {body: material_of(problem, body).fatigue or FatigueConstants() for body in elastic}
    known = tuple(body for body in elastic if all(getattr(constants[body], name) is not None for name in names))
    if not known and elastic:
        _check_constants(problem, elastic[0], names, criterion)
    return known


def check_assessment(
    problem: Problem, how: FatigueAssessment, history: LoadHistory | None = None, options: SolveOptions | None = None
) -> None:
    """Raise :class:`InputError` if the fatigue of a problem under a history can't be assessed.

    Materials lack constants, the history has no cycle or no turning point, or corners are not kept.
    """
    for criterion in how.criteria:
        bodies = assessed_bodies(problem, how, criterion)
        if how.method != "edge" and how.length is None:
            for body in bodies:
                _check_constants(problem, body, ("threshold_range", "limit_range"), f'method "{how.method}"')
        for body in bodies:
            _check_constants(problem, body, how.scatter_needs, "a life at a reliability")
    if history is None:
        return
    if how.over == "cycle" and not history.longest_cycle:
        raise InputError("over", "the history has no cycles: none of its blocks is repeated")
    if options is not None and options.keep not in ("all", "corners"):
        raise InputError("keep", 'must be "all" or "corners": fatigue needs the states at all corners')
    stops = 1 if options is None or options.keep == "corners" else options.fractions.size
    if len(history) * stops < 2:
        raise InputError("fatigue", "needs a turning point: the history has one corner only")


def _check_constants(problem: Problem, body: Body, names: Sequence[str], purpose: str) -> None:
    given = material_of(problem, body).fatigue or FatigueConstants()
    given.required(names, purpose, owner_of(problem, body))


def _as_lists(value: Any) -> Any:
    return [_as_lists(each) for each in value] if isinstance(value, tuple) else value


USUAL = FatigueAssessment()
"""Median lives by Smith, Watson and Topper, without a knee."""
