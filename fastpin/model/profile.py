"""A quantity along the rim as a sum of terms: the initial gap, or the coefficient of friction."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import TypeAlias

import numpy as np

from fastpin.errors import InputError
from fastpin.model.angles import angle_between
from fastpin.model.checks import instance, number, positive, whole_number
from fastpin.runtime.extensions import interpolate

MOST_ORDER = 1000
"""Largest number of waves of a harmonic round the hole."""

MOST_TERMS, MOST_SAMPLES = 100, 100_000
"""Most terms of a profile, and most samples of a term."""

WAVE = 16
"""Angles in a wave, or in a crown, at which its value must be looked at."""

CALLED = 1440
"""Samples of a function round the hole: four a degree."""

PERIODIC = 1e-9
"""Largest difference of samples a turn apart, in parts of the largest sample."""


class Term(ABC):
    """A term of a profile. It has a value, a slope and a curvature at each angle."""

    jumps = False
    needs_lengths = False

    def angles_of_note(self, radius: float) -> np.ndarray:
        """Angles, rad, at which its value must be looked at. `radius` is the radius of the hole, m."""
        return np.zeros(0)

    @abstractmethod
    def values(self, theta: np.ndarray, radius: float) -> np.ndarray:
        """Value, first and second derivative at the angles `theta` (...), rad, shape (3, ...).

        `radius` is the radius of the hole, m.
        """


@dataclass(frozen=True)
class Harmonic(Term):
    """A wave round the hole: cosine cos n theta + sine sin n theta.

    Parameters
    ----------
    order : int
        The number n of waves, 0 to :data:`MOST_ORDER`. Order 0 is a constant.
    cosine, sine : float
        Amplitudes, in the unit of the profile.
    """

    order: int
    cosine: float = 0.0
    sine: float = 0.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "order", whole_number("order", self.order, 0, MOST_ORDER))
        for name in ("cosine", "sine"):
            object.__setattr__(self, name, number(name, getattr(self, name)))

    def angles_of_note(self, radius: float) -> np.ndarray:
        return np.arange(WAVE * self.order) * (2.0 * math.pi / (WAVE * max(self.order, 1))) - math.pi

    def values(self, theta: np.ndarray, radius: float) -> np.ndarray:
        n = self.order
        cos, sin = np.cos(n * theta), np.sin(n * theta)
        value = self.cosine * cos + self.sine * sin
        return np.array([value, n * (self.sine * cos - self.cosine * sin), -n * n * value])


@dataclass(frozen=True)
class Flat(Term):
    """A flat, ground on a pin: the gap between a circle and its chord.

    Parameters
    ----------
    depth : float
        Depth of the chord below the circle, m, positive.
    centre : float
        Angle of its middle, rad.
    """

    depth: float
    centre: float

    needs_lengths = True

    def __post_init__(self) -> None:
        object.__setattr__(self, "depth", positive("depth", self.depth))
        object.__setattr__(self, "centre", number("centre", self.centre))

    def angles_of_note(self, radius: float) -> np.ndarray:
        half = math.acos(max(1.0 - self.depth / radius, 0.0))
        return self.centre + np.array([-half, 0.0, half])

    def values(self, theta: np.ndarray, radius: float) -> np.ndarray:
        away = angle_between(theta, self.centre)
        chord = max(radius - self.depth, 0.0)
        inside = np.cos(away) * radius > chord
        cos, tan = np.cos(np.where(inside, away, 0.0)), np.tan(np.where(inside, away, 0.0))
        secant = chord / cos
        return np.where(inside, [radius - secant, -secant * tan, -secant * (1.0 + 2.0 * tan * tan)], 0.0)


@dataclass(frozen=True)
class Crown(Term):
    """A smooth bump: height (1 + cos(pi phi / half_width)) / 2 at the angle phi from its middle, 0 beyond.

    Parameters
    ----------
    height : float
        Its value in the middle, in the unit of the profile. In a gap a negative height is material that stands out.
    centre : float
        Angle of its middle, rad.
    half_width : float
        Angle from its middle to its foot, rad, positive, at most pi.
    """

    height: float
    centre: float
    half_width: float

    def __post_init__(self) -> None:
        for name in ("height", "centre"):
            object.__setattr__(self, name, number(name, getattr(self, name)))
        positive("half_width", self.half_width)
        object.__setattr__(self, "half_width", number("half_width", self.half_width, 0.0, math.pi))

    def angles_of_note(self, radius: float) -> np.ndarray:
        return self.centre + np.linspace(-self.half_width, self.half_width, WAVE + 1)

    def values(self, theta: np.ndarray, radius: float) -> np.ndarray:
        away, wave = angle_between(theta, self.centre), math.pi / self.half_width
        inside = np.abs(away) < self.half_width
        cos, sin, half = np.cos(wave * away), np.sin(wave * away), 0.5 * self.height
        return np.where(inside, [half * (1.0 + cos), -half * wave * sin, -half * wave * wave * cos], 0.0)


@dataclass(frozen=True)
class Zone(Term):
    """A constant from one angle to another, counter-clockwise, and 0 elsewhere. It jumps at its ends.

    Parameters
    ----------
    value : float
        In the unit of the profile.
    start, stop : float
        Its ends, rad. The zone may pass the angle pi. It is shorter than a turn.
    """

    value: float
    start: float
    stop: float

    jumps = True

    def __post_init__(self) -> None:
        for name in ("value", "start", "stop"):
            object.__setattr__(self, name, number(name, getattr(self, name)))
        if not 0.0 < self.stop - self.start < 2.0 * math.pi:
            raise InputError("stop", f"must lie less than a turn beyond the start {self.start:g}, not at {self.stop:g}")

    def angles_of_note(self, radius: float) -> np.ndarray:
        return np.array([self.start, 0.5 * (self.start + self.stop)])

    def values(self, theta: np.ndarray, radius: float) -> np.ndarray:
        inside = np.remainder(np.asarray(theta) - self.start, 2.0 * math.pi) < self.stop - self.start
        value = np.where(inside, self.value, 0.0)
        return np.array([value, np.zeros_like(value), np.zeros_like(value)])


@dataclass(frozen=True)
class Samples(Term):
    """Values at angles round the hole, joined by a periodic cubic spline.

    Parameters
    ----------
    angles : sequence of float
        Angles, rad, increasing, at least four, within a turn. A last angle a whole turn beyond the first one repeats
        the first value.
    heights : sequence of float
        Values there, in the unit of the profile.
    """

    angles: Sequence[float] | np.ndarray
    heights: Sequence[float] | np.ndarray

    def __post_init__(self) -> None:
        angles, heights = _samples("angles", self.angles), _samples("heights", self.heights)
        if angles.size != heights.size:
            raise InputError("heights", f"must be as many as the angles, {angles.size}, not {heights.size}")
        turn = 2.0 * math.pi
        if angles.size > 1 and math.isclose(angles[-1] - angles[0], turn, rel_tol=PERIODIC):
            if abs(heights[-1] - heights[0]) > PERIODIC * np.abs(heights).max():
                raise InputError(
                    "heights", f"must be equal at the ends of a turn, not {heights[0]:g} and {heights[-1]:g}"
                )
            angles, heights = angles[:-1], heights[:-1]
        if not 4 <= angles.size <= MOST_SAMPLES:
            raise InputError("angles", f"must be from 4 to {MOST_SAMPLES} angles within a turn, not {angles.size}")
        if np.any(np.diff(angles) <= 0.0) or angles[-1] - angles[0] >= turn:
            raise InputError("angles", "must increase, all within one turn")
        object.__setattr__(self, "angles", tuple(angles.tolist()))
        object.__setattr__(self, "heights", tuple(heights.tolist()))

    @cached_property
    def _spline(self) -> Callable[..., np.ndarray]:
        angles, heights = np.array(self.angles), np.array(self.heights)
        spline: Callable[..., np.ndarray] = interpolate.CubicSpline(
            np.r_[angles, angles[0] + 2.0 * math.pi], np.r_[heights, heights[0]], bc_type="periodic"
        )
        return spline

    def angles_of_note(self, radius: float) -> np.ndarray:
        return np.array(self.angles)

    def values(self, theta: np.ndarray, radius: float) -> np.ndarray:
        return np.array([self._spline(theta, order) for order in range(3)])


TERMS: dict[str, type[Term]] = {
    "harmonic": Harmonic,
    "flat": Flat,
    "crown": Crown,
    "zone": Zone,
    "samples": Samples,
}
"""The kinds of terms by their names in files."""


@dataclass(frozen=True)
class Profile:
    """A quantity along the rim of the hole: the sum of its terms. Angles count from +x, counter-clockwise, in rad.

    Parameters
    ----------
    terms : sequence of Term
        At most :data:`MOST_TERMS`. A profile without terms is 0.
    """

    terms: tuple[Term, ...] = ()

    def __post_init__(self) -> None:
        terms = tuple(self.terms)
        for term in terms:
            instance("terms", term, Term, "a term of a profile")  # type: ignore[type-abstract]
        if len(terms) > MOST_TERMS:
            raise InputError("terms", f"must be at most {MOST_TERMS}, not {len(terms)}")
        object.__setattr__(self, "terms", terms)

    @classmethod
    def constant(cls, value: float) -> Profile:
        """The same value all round."""
        return cls((Harmonic(0, value),))

    @classmethod
    def ellipse(cls, size: float, axis: float = 0.0) -> Profile:
        """An oval: `size` cos 2(theta - axis). Its half axes are larger and smaller by `size`, the larger at `axis`."""
        return cls.lobes(2, size, axis)

    @classmethod
    def lobes(cls, count: int, size: float, axis: float = 0.0) -> Profile:
        """A rim with so many lobes: `size` cos `count` (theta - axis)."""
        size, axis = number("size", size), number("axis", axis)
        count = whole_number("count", count, 1, MOST_ORDER)
        return cls((Harmonic(count, size * math.cos(count * axis), size * math.sin(count * axis)),))

    @classmethod
    def of(cls, place: str, value: ProfileLike) -> Profile:
        """The profile that a user means by `value`: a profile, a term, a number, a function or samples.

        A function takes angles (n,), rad, and returns values (n,). It is sampled at :data:`CALLED` angles. Samples are
        a pair of angles and values. `place` names the value in the input, for the message.
        """
        if isinstance(value, Profile):
            return value
        if isinstance(value, Term):
            return cls((value,))
        if callable(value):
            theta = np.arange(CALLED) * (2.0 * math.pi / CALLED) - math.pi
            heights = np.asarray(value(theta))
            if heights.shape != theta.shape:
                shape = f"must return an array of the shape {theta.shape} of its angles, not {heights.shape}"
                raise InputError(place, shape)
            return cls((Samples(theta, heights),))
        if isinstance(value, (tuple, list)) and len(value) == 2:
            return cls((Samples(value[0], value[1]),))
        height = number(place, value)
        return cls.constant(height) if height else cls()

    def __add__(self, other: Profile) -> Profile:
        if not isinstance(other, Profile):
            return NotImplemented
        return Profile((*self.terms, *other.terms))

    @property
    def has_jumps(self) -> bool:
        """Whether the quantity jumps somewhere."""
        return any(term.jumps for term in self.terms)

    @property
    def needs_lengths(self) -> bool:
        """Whether the quantity has no meaning in a dimensionless problem, which has no lengths."""
        return any(term.needs_lengths for term in self.terms)

    @property
    def is_constant(self) -> bool:
        """Whether the quantity is the same all round, by its terms."""
        return all(isinstance(term, Harmonic) and term.order == 0 for term in self.terms)

    def angles(self, count: int, radius: float) -> np.ndarray:
        """Angles at which the profile shows itself, rad: `count` equally spaced, and those of its terms.

        `radius` is the radius of the hole, m.
        """
        theta = np.linspace(-math.pi, math.pi, count)
        return np.concatenate([theta, *(term.angles_of_note(radius) for term in self.terms)])

    def values(self, theta: np.ndarray, radius: float) -> np.ndarray:
        """Value, first and second derivative at the angles `theta` (...), rad, shape (3, ...).

        `radius` is the radius of the hole, m.
        """
        theta = np.asarray(theta, dtype=float)
        total = np.zeros((3, *theta.shape))
        for term in self.terms:
            total += term.values(theta, radius)
        return total

    def at(self, theta: np.ndarray, radius: float) -> np.ndarray:
        """Values at the angles `theta` (...), rad, shape (...); see :meth:`values`."""
        values: np.ndarray = self.values(theta, radius)[0]
        return values


ProfileLike: TypeAlias = "Profile | Term | float | Callable[[np.ndarray], np.ndarray] | tuple[np.ndarray, np.ndarray]"
"""Whatever :meth:`Profile.of` understands."""


def _samples(field: str, values: object) -> np.ndarray:
    """Finite numbers in one row, at most :data:`MOST_SAMPLES`."""
    try:
        row = np.asarray(values, dtype=float)
    except (TypeError, ValueError) as error:
        raise InputError(field, "must be numbers in one row") from error
    if row.ndim != 1 or not np.isfinite(row).all():
        raise InputError(field, "must be finite numbers in one row")
    return row


@dataclass(frozen=True)
class InitialGap:
    """The initial gap between pin and hole beside the clearance: the profiles of both, radial, m.

    A positive profile opens the gap: it is missing material, of the plate in `hole` and of the pin in `pin`. The pin
    has its profile where it is concentric and not turned.

    Parameters
    ----------
    hole, pin : Profile
        Without jumps. In a dimensionless problem, in units of F beta*. :meth:`Profile.of` says what else is understood.
    """

    hole: Profile = field(default_factory=Profile)
    pin: Profile = field(default_factory=Profile)

    def __post_init__(self) -> None:
        for name in ("hole", "pin"):
            profile = Profile.of(f"gap.{name}", getattr(self, name))
            if profile.has_jumps:
                raise InputError(f"gap.{name}", "must not jump: a zone has a step at its ends")
            object.__setattr__(self, name, profile)

    @classmethod
    def of(cls, value: InitialGap | ProfileLike) -> InitialGap:
        """The initial gap that a user means by `value`. All but an initial gap is the profile of the hole."""
        return value if isinstance(value, InitialGap) else cls(Profile.of("gap", value))

    def __bool__(self) -> bool:
        return bool(self.hole.terms or self.pin.terms)

    def angles(self, count: int, radius: float) -> np.ndarray:
        """Angles at which the gap shows itself, rad, in order; see :meth:`Profile.angles`."""
        found = np.concatenate([self.hole.angles(count, radius), self.pin.angles(0, radius)])
        return np.unique(np.remainder(found + math.pi, 2.0 * math.pi) - math.pi)

    def values(self, theta: np.ndarray, radius: float) -> np.ndarray:
        """Gap and two derivatives at the angles `theta` (...), rad, shape (3, ...); see :meth:`Profile.values`."""
        return self.hole.values(theta, radius) + self.pin.values(theta, radius)


NO_GAP = InitialGap()
"""A round pin in a round hole."""
