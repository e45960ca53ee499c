"""The terms of a profile along the rim: waves, flats, crowns, zones and samples.

In Python angles are in rad and count from +x. Case files, JSON and texts have degrees from the bottom of the hole.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import Any, ClassVar, Self

import numpy as np

from fastpin.errors import InputError
from fastpin.model.angles import angle_between, degrees_at, degrees_of, from_bottom
from fastpin.model.checks import check_fields, number, number_array, numbers, positive, set_fields, whole_number
from fastpin.runtime.extensions import interpolate

MOST_ORDER = 1000
"""Largest number of waves of a harmonic round the hole."""

MOST_SAMPLES = 20_000
"""Most samples of a profile: one each minute of arc. A case file holds them."""

WAVE = 16
"""Angles in a wave, or in a crown, at which its value must be looked at."""

MOST_ANGLE = 4.0 * math.pi
"""Largest angle, rad. One beyond two turns is in degrees by mistake."""

LEAST_ANGLE = 1e-9
"""Least half width of a crown, and angle between samples, rad: on a hole of 1 m a nanometre."""

MOST_SIZE = 1e100
"""Largest value of a profile, in its unit. The curvatures of larger ones would overflow."""

ValueInWords = Callable[[float], str]
"""The text of a value, with its unit if it has one."""


class Term(ABC):
    """A term of a profile. It has a value, a slope and a curvature at each angle.

    Attributes
    ----------
    kind : str
        Its name in files.
    places, spans, sizes : tuple of str
        The fields that are angles round the hole, differences of angles, rad, and values in the unit of the profile.
    jumps : bool
        Whether it jumps somewhere.
    needs_lengths : bool
        Whether its shape depends on its size in parts of the radius.
    """

    kind: ClassVar[str]
    places: ClassVar[tuple[str, ...]] = ()
    spans: ClassVar[tuple[str, ...]] = ()
    sizes: ClassVar[tuple[str, ...]] = ()
    jumps: ClassVar[bool] = False
    needs_lengths: ClassVar[bool] = False

    @property
    def wave(self) -> tuple[int, complex] | None:
        """Its number of waves n, and the amplitude A of Re A exp(i n theta); None if it is no wave round the hole."""
        return None

    def angles_of_note(self, radius: float) -> np.ndarray:
        """Angles, rad, at which its value must be looked at. `radius` is the radius of the hole, m."""
        return np.zeros(0)

    @abstractmethod
    def values(self, theta: np.ndarray, radius: float) -> np.ndarray:
        """Value, first and second derivative at the angles `theta` (...), rad, shape (3, ...).

        `radius` is the radius of the hole, m.
        """

    @abstractmethod
    def words(self, text: ValueInWords) -> str:
        """Words that describe it. `text` words a value."""

    def scaled(self, factor: float) -> Self:
        """The same term with its sizes multiplied by a factor."""
        return replace(self, **{name: np.multiply(getattr(self, name), factor) for name in self.sizes})  # type: ignore[type-var]

    def entries(self) -> dict[str, Any]:
        """The kind, and the fields by name, as ids and HDF5 files hold them: numbers, texts and lists."""
        return {"kind": self.kind, **{each.name: np.array(getattr(self, each.name)).tolist() for each in fields(self)}}  # type: ignore[arg-type]

    def toml(self) -> dict[str, Any]:
        """The keys and values of its table in a case file. Its kind is the key of its first field."""
        found = self.entries()
        found |= {name: degrees_at(found[name]) for name in self.places}
        found |= {name: degrees_of(found[name]) for name in self.spans}
        kind = found.pop("kind")
        first = next(iter(found))
        return {kind: found.pop(first), **found}

    def _check_angles(self) -> None:
        for name in (*self.places, *self.spans):
            angle = number(name, getattr(self, name))
            if abs(angle) > MOST_ANGLE:
                raise InputError(name, f"must lie within two turns: angles are in rad, not {angle:g}")
            object.__setattr__(self, name, angle)


@dataclass(frozen=True)
class Harmonic(Term):
    """A wave round the hole: cosine cos n theta + sine sin n theta.

    Parameters
    ----------
    order : int
        The number n of waves, 0 to :data:`MOST_ORDER`. Order 0 is a constant, without a sine.
    cosine, sine : float
        Amplitudes, in the unit of the profile.
    """

    order: int
    cosine: float = 0.0
    sine: float = 0.0

    kind, sizes = "harmonic", ("cosine", "sine")

    def __post_init__(self) -> None:
        check_fields(self, whole_number, "order", 0, MOST_ORDER)
        check_fields(self, _checked_size, "cosine sine")
        if self.order == 0:
            set_fields(self, sine=0.0)

    @property
    def wave(self) -> tuple[int, complex] | None:
        return self.order, complex(self.cosine, -self.sine)

    def angles_of_note(self, radius: float) -> np.ndarray:
        return np.arange(WAVE * self.order) * (2.0 * math.pi / (WAVE * max(self.order, 1))) - math.pi

    def values(self, theta: np.ndarray, radius: float) -> np.ndarray:
        n = self.order
        cos, sin = np.cos(n * theta), np.sin(n * theta)
        value = self.cosine * cos + self.sine * sin
        return np.array([value, n * (self.sine * cos - self.cosine * sin), -n * n * value])

    @classmethod
    def from_bottom(cls, order: int, cosine: float, sine: float) -> Harmonic:
        """The wave cosine cos n x + sine sin n x of the angle x from the bottom of the hole."""
        turned = ((cosine, sine), (sine, -cosine), (-cosine, -sine), (-sine, cosine))[order % 4]
        return cls(order, turned[0] + 0.0, turned[1] + 0.0)  # -0 becomes 0

    @property
    def at_bottom(self) -> tuple[float, float]:
        """The amplitudes (cosine, sine) as a wave of the angle from the bottom of the hole."""
        one, other = self.cosine, self.sine
        turned = ((one, other), (-other, one), (-one, -other), (other, -one))[self.order % 4]
        return turned[0] + 0.0, turned[1] + 0.0

    def toml(self) -> dict[str, Any]:
        if self.order == 0:
            return {"constant": self.cosine}
        cosine, sine = self.at_bottom
        return {"harmonic": self.order, "cosine": cosine, "sine": sine}

    def words(self, text: ValueInWords) -> str:
        if self.order == 0:
            return text(self.cosine)
        cosine, sine = self.at_bottom
        size, at = math.hypot(cosine, sine), round(math.degrees(math.atan2(sine, cosine)) / self.order, 9)
        if self.order == 1:
            return f"eccentricity {text(size)} at {at + 0.0:.4g} deg"
        if self.order == 2:
            return f"oval of {text(size)}, largest at {at + 0.0:.4g} deg"
        return f"{self.order} lobes of {text(size)}, one at {at + 0.0:.4g} deg"


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

    kind, places, sizes, needs_lengths = "flat", ("centre",), ("depth",), True

    def __post_init__(self) -> None:
        check_fields(self, positive, "depth")
        check_fields(self, _checked_size, "depth")
        self._check_angles()

    def values(self, theta: np.ndarray, radius: float) -> np.ndarray:
        away = angle_between(theta, self.centre)
        chord = max(radius - self.depth, 0.0)
        inside = np.cos(away) * radius > chord
        cos, tan = np.cos(np.where(inside, away, 0.0)), np.tan(np.where(inside, away, 0.0))
        secant = chord / cos
        return np.where(inside, [radius - secant, -secant * tan, -secant * (1.0 + 2.0 * tan * tan)], 0.0)

    def angles_of_note(self, radius: float) -> np.ndarray:
        half = math.acos(max(1.0 - self.depth / radius, 0.0))
        return self.centre + np.array([-half, 0.0, half])

    def words(self, text: ValueInWords) -> str:
        return f"flat {text(self.depth)} deep at {from_bottom(self.centre):.4g} deg"


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
        Angle from its middle to its foot, rad, from :data:`LEAST_ANGLE` to pi.
    """

    height: float
    centre: float
    half_width: float

    kind, places, spans, sizes = "crown", ("centre",), ("half_width",), ("height",)

    def __post_init__(self) -> None:
        check_fields(self, _checked_size, "height")
        width = positive("half_width", self.half_width)
        if not LEAST_ANGLE <= width <= math.pi:
            limits = f"must lie between {math.degrees(LEAST_ANGLE):.2g} and 180 degrees"
            raise InputError("half_width", f"{limits}, not {math.degrees(width):.6g}")
        self._check_angles()

    def values(self, theta: np.ndarray, radius: float) -> np.ndarray:
        away, wave = angle_between(theta, self.centre), math.pi / self.half_width
        inside = np.abs(away) < self.half_width
        cos, sin, half = np.cos(wave * away), np.sin(wave * away), 0.5 * self.height
        return np.where(inside, [half * (1.0 + cos), -half * wave * sin, -half * wave * wave * cos], 0.0)

    def angles_of_note(self, radius: float) -> np.ndarray:
        return self.centre + np.linspace(-self.half_width, self.half_width, WAVE + 1)

    def words(self, text: ValueInWords) -> str:
        at, wide = from_bottom(self.centre), math.degrees(self.half_width)
        return f"crown of {text(self.height)} at {at:.4g} deg, half width {wide:.4g} deg"


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

    kind, places, sizes, jumps = "zone", ("start", "stop"), ("value",), True

    def __post_init__(self) -> None:
        check_fields(self, _checked_size, "value")
        self._check_angles()
        if not 0.0 < self.stop - self.start < 2.0 * math.pi:
            raise InputError("stop", "must lie beyond the start, by less than a turn")

    def angles_of_note(self, radius: float) -> np.ndarray:
        return np.array([self.start, 0.5 * (self.start + self.stop)])

    def values(self, theta: np.ndarray, radius: float) -> np.ndarray:
        inside = np.remainder(np.asarray(theta) - self.start, 2.0 * math.pi) < self.stop - self.start
        value = np.where(inside, self.value, 0.0)
        return np.array([value, np.zeros_like(value), np.zeros_like(value)])

    def words(self, text: ValueInWords) -> str:
        first = from_bottom(self.start)
        return f"{text(self.value)} more from {first:.4g} to {first + math.degrees(self.stop - self.start):.4g} deg"


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

    kind, sizes = "samples", ("heights",)

    def __post_init__(self) -> None:
        angles, heights = _samples("angles", self.angles), _samples("heights", self.heights)
        numbers("heights", heights, -MOST_SIZE, MOST_SIZE)
        if angles.size != heights.size:
            raise InputError("heights", f"must be as many as the angles, {angles.size}, not {heights.size}")
        turn, rounding = 2.0 * math.pi, 1e-9
        if angles.size > 1 and math.isclose(angles[-1] - angles[0], turn, rel_tol=rounding):
            if abs(heights[-1] - heights[0]) > rounding * np.abs(heights).max():
                raise InputError(
                    "heights", f"must be equal at the ends of a turn, not {heights[0]:g} and {heights[-1]:g}"
                )
            angles, heights = angles[:-1], heights[:-1]
        if not 4 <= angles.size <= MOST_SAMPLES:
            raise InputError("angles", f"must be from 4 to {MOST_SAMPLES} angles within a turn, not {angles.size}")
        if np.any(np.diff(angles) <= 0.0) or angles[-1] - angles[0] >= turn:
            raise InputError("angles", "must increase, all within one turn")
        if (least := float(np.diff(angles).min())) < LEAST_ANGLE:
            words = f"neighbours are {math.degrees(least):.2g} degrees apart, less than"
            raise InputError("angles", f"{words} {math.degrees(LEAST_ANGLE):.2g}")
        widest = float(np.diff(angles, append=angles[0] + turn).max())
        # Samples on a part of the circle say nothing of the rest. Angles in the wrong unit are refused so, too.
        if widest > 2.0 * math.pi / 3.0:
            words = (
                f"must go all round the hole: neighbours are {math.degrees(widest):.4g} degrees apart, more than 120"
            )
            raise InputError("angles", words)
        set_fields(self, angles=tuple(angles.tolist()), heights=tuple(heights.tolist()))

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

    def toml(self) -> dict[str, Any]:
        return {"angles": tuple(map(degrees_at, self.angles)), "values": self.heights}

    def words(self, text: ValueInWords) -> str:
        return f"{len(self.angles):,} samples from {text(min(self.heights))} to {text(max(self.heights))}"


TERMS: dict[str, type[Term]] = {made.kind: made for made in (Harmonic, Flat, Crown, Zone, Samples)}
"""The kinds of terms by their names in files."""


def _checked_size(field: str, value: object) -> float:
    """Check a value of a profile."""
    return number(field, value, -MOST_SIZE, MOST_SIZE)


def _samples(field: str, values: object) -> np.ndarray:
    """Finite numbers in one row."""
    row = number_array(field, values)  # type: ignore[arg-type]
    if row.ndim != 1 or not np.isfinite(row).all():
        raise InputError(field, "must be finite numbers in one row")
    return row
