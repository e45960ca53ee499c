"""How the strength of a laminate round the hole is assessed: criterion, distance from the edge, load at failure."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from fastpin.errors import InputError
from fastpin.model.checks import check_fields, choice, is_above, not_negative, set_fields, true_or_false
from fastpin.model.ply import CRITERION_NAMES, PlyCriterion
from fastpin.model.problem import Problem
from fastpin.model.units import units

LENGTHS = ("distance", "tension", "compression")
"""The lengths, m. The first one is a circle, the other two are a curve about the pin's force."""


@dataclass(frozen=True)
class StrengthAssessment:
    """How the strength of the plate's laminate round the hole is assessed.

    Parameters
    ----------
    criterion : {"hashin", "tsai-wu", "tsai-hill", "maximum-stress", "maximum-strain", "yamada-sun"}
        Criterion of ply failure.
    distance : float, optional
        Distance of a circle from the edge of the hole, m. 0 is the edge itself.
    tension, compression : float, optional
        In place of `distance`: characteristic lengths of the curve of Chang, Scott and Springer, m, across and along
        the direction of the pin's force.
    failure : bool
        Whether the load at failure is looked for. The history is then solved several times.

    Raises
    ------
    InputError
        If a field can't be used, or neither or both kinds of lengths are given.
    """

    criterion: PlyCriterion = "hashin"
    distance: float | None = None
    tension: float | None = None
    compression: float | None = None
    failure: bool = False

    def __post_init__(self) -> None:
        check_fields(self, choice, "criterion", CRITERION_NAMES)
        given = checked_lengths(self.distance, self.tension, self.compression)
        set_fields(self, **{name: given.get(name) for name in LENGTHS})
        check_fields(self, true_or_false, "failure")

    @property
    def lengths(self) -> dict[str, float]:
        """The given lengths by name, m."""
        return {name: value for name in LENGTHS if (value := getattr(self, name)) is not None}

    def entries(self) -> dict[str, Any]:
        """The keys and values of the section [strength] of a case file."""
        return {"criterion": self.criterion} | self.lengths | ({"failure": True} if self.failure else {})


def checked_lengths(distance: float | None, tension: float | None, compression: float | None) -> dict[str, float]:
    """Check the lengths of an assessment of strength, and return the given ones by name, m.

    Raises
    ------
    InputError
        If neither or both kinds of lengths are given, or a length is negative.
    """
    if distance is not None:
        if tension is not None or compression is not None:
            raise InputError("distance", "can't be given together with tension and compression")
        return {"distance": not_negative("distance", distance)}
    if tension is None or compression is None:
        raise InputError("distance", "or tension and compression must be given: lengths from tests, m")
    return {"tension": not_negative("tension", tension), "compression": not_negative("compression", compression)}


def check_strength(problem: Problem, how: StrengthAssessment) -> None:
    """Raise :class:`InputError` if the plate is no laminate whose plies have strengths, or a length is too large."""
    plate = problem.joint.hole.laminate
    if plate is None or not plate.plies or any(ply.strengths is None for ply, _ in plate.plies):
        raise InputError("strength", "belongs to a plate that is a laminate whose plies have strengths")
    for name, value in how.lengths.items():
        # At 100 radii the pin's stress is 1 %, and measured lengths are about one radius.
        if is_above(value, 100.0 * problem.hole_radius):
            words = units(problem)["length"].text(value)
            raise InputError(name, f"must be at most 100 radii of the hole, not {words}")
