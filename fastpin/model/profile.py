"""A quantity along the rim as a sum of terms: the initial gap, or the coefficient of friction.

In Python angles are in rad and count from +x. Case files, JSON and texts have degrees from the bottom of the hole.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal, TypeAlias

import numpy as np

from fastpin.errors import InputError
from fastpin.model.angles import angle_at, distinct
from fastpin.model.checks import (
    as_toml,
    check_callable,
    instances,
    number,
    number_array,
    positive,
    set_fields,
    shortened,
    string,
    whole_number,
)
from fastpin.model.grid import Grid
from fastpin.model.profile_terms import (
    MOST_ANGLE,
    MOST_ORDER,
    MOST_SAMPLES,
    Crown,
    Flat,
    Harmonic,
    Samples,
    Term,
    ValueInWords,
    Zone,
)
from fastpin.model.synonyms import explains_keywords
from fastpin.runtime.extensions import optimize

ProfileKind = Literal["gap", "friction", "wear"]
"""What the values of a profile in a file are."""

MOST_TERMS = 512
"""Most terms of a profile."""

CALLED = 1440
"""Samples of a function round the hole: four a degree."""


@dataclass(frozen=True, repr=False)
class Profile:
    """A quantity along the rim of the hole: the sum of its terms. Angles count from +x, counter-clockwise, in rad.

    A profile is made by the methods :meth:`ellipse`, :meth:`lobes`, :meth:`harmonic`, :meth:`flat`, :meth:`crown`,
    :meth:`zone`, :meth:`constant`, :meth:`samples` and :meth:`from_csv`. Profiles are added by ``+``.

    Parameters
    ----------
    terms : sequence of Term
        At most :data:`MOST_TERMS`. A profile without terms is 0.
    """

    terms: tuple[Term, ...] = ()

    def __post_init__(self) -> None:
        terms = tuple(instances("terms", self.terms, Term, "terms of a profile"))  # type: ignore[type-abstract]
        if len(terms) > MOST_TERMS:
            raise InputError("terms", f"must be at most {MOST_TERMS}, not {len(terms)}")
        samples = sum(len(term.angles) for term in terms if isinstance(term, Samples))
        if samples > MOST_SAMPLES:
            raise InputError("terms", f"must have at most {MOST_SAMPLES:,} samples in all, not {samples:,}")
        set_fields(self, terms=terms)

    def __repr__(self) -> str:
        return f"<Profile: {self.words(lambda value: f'{value:.6g}')}>"

    @classmethod
    def constant(cls, value: float) -> Profile:
        """The same value all round."""
        return cls((Harmonic(0, number("value", value)),))

    @classmethod
    def ellipse(cls, size: float, axis: float = 0.0) -> Profile:
        """An oval: `size` cos 2(theta - axis). Its half axes are larger and smaller by `size`.

        At `axis` a hole has its larger half axis, and a pin its smaller one: the gap opens there.
        """
        return cls.lobes(2, size, axis)

    @classmethod
    def lobes(cls, count: int, size: float, axis: float = 0.0) -> Profile:
        """A rim with so many lobes: `size` cos `count` (theta - axis)."""
        size, axis = number("size", size), number("axis", axis)
        if abs(axis) > MOST_ANGLE:
            raise InputError("axis", f"must lie within two turns: angles are in rad, not {axis:g}")
        count = whole_number("count", count, 1, MOST_ORDER)
        return cls((Harmonic(count, size * math.cos(count * axis), size * math.sin(count * axis)),))

    @classmethod
    def harmonic(cls, order: int, cosine: float = 0.0, sine: float = 0.0) -> Profile:
        """A wave round the hole: `cosine` cos n theta + `sine` sin n theta, with n = `order` from 0 to 1000."""
        return cls((Harmonic(order, cosine, sine),))

    @classmethod
    def flat(cls, depth: float, centre: float) -> Profile:
        """A flat, ground on a pin: a chord, m, `depth` below the circle at the angle `centre`. For gaps only."""
        return cls((Flat(depth, centre),))

    @classmethod
    def crown(cls, height: float, centre: float, half_width: float) -> Profile:
        """A smooth bump of a `height` at the angle `centre`, and 0 at `half_width` from it and beyond.

        It is height (1 + cos(pi phi / half_width)) / 2 at the angle phi from its middle. In a gap a negative height is
        material that stands out.
        """
        return cls((Crown(height, centre, half_width),))

    @classmethod
    def zone(cls, value: float, start: float, stop: float) -> Profile:
        """A `value` from the angle `start` counter-clockwise to `stop`, and 0 elsewhere. For friction and wear only."""
        return cls((Zone(value, start, stop),))

    @classmethod
    def samples(
        cls,
        angles: Sequence[float] | np.ndarray,
        values: Sequence[float] | np.ndarray,
        harmonics: int | None = None,
    ) -> Profile:
        """Values at increasing angles within a turn, shape (n,), joined by a periodic cubic spline.

        Neighbours are at most 120 degrees apart. A last angle a turn beyond the first one repeats the first value. With
        `harmonics` only so many waves round the hole are kept, see :meth:`filtered`.
        """
        try:
            found = cls((Samples(angles, values),))
        except InputError as error:
            raise InputError("values" if error.field == "heights" else error.field, error.reason) from None
        return found if harmonics is None else found.filtered(harmonics)

    @classmethod
    def from_csv(
        cls,
        path: str | Path,
        quantity: str = "gap",
        harmonics: int | None = None,
        columns: Mapping[str, Any] | None = None,
        skip: int = 0,
    ) -> Profile:
        """Samples from a CSV file with two columns: the angle from the bottom of the hole, and the value there.

        A header names the columns, each perhaps with a unit: ``angle [deg]``, ``gap [um]``. Without units angles are in
        degrees and gaps in m.

        Parameters
        ----------
        path : str or Path
        quantity : {"gap", "friction", "wear"}
            What the values are. Friction has no unit. Wear coefficients are in 1/Pa.
        harmonics : int, optional
            The waves round the hole that are kept, see :meth:`filtered`. Without it all of them are kept.
        columns : mapping, optional
            The columns ``"angles"`` and ``"values"`` of a file with more of them, or without a header:
            ``{"angles": {"column": 1}, "values": {"column": "R", "scale": -1, "unit": "um"}}``.
        skip : int
            Lines at the beginning that are not read. A preamble without numbers needs no `skip`.

        Raises
        ------
        CaseFileError
            If the file can't be read or has faults. It lists them with their lines.
        InputError
            If the samples do not go round the hole, see :meth:`samples`, or an argument can't be used.
        """
        from fastpin.tables import read_samples

        return cls.samples(*read_samples(path, quantity, columns=columns, skip=skip), harmonics)  # type: ignore[arg-type]

    @classmethod
    def of(cls, place: str, value: ProfileLike) -> Profile:
        """The profile that a user means by `value`: a profile, a term, a number, a function or samples.

        A function takes angles (n,), rad, and returns values (n,). It is sampled at :data:`CALLED` angles. Samples are
        a pair of angles and values. `place` names the value in the input, for the message.
        """
        string("place", place)
        if isinstance(value, Profile):
            return value
        if isinstance(value, Term):
            return cls((value,))
        if callable(value):
            check_callable(place, value, 1)
            theta = angle_at(np.arange(CALLED + 1) * (360.0 / CALLED) - 90.0)
            try:
                heights = number_array(place, value(theta))
            except InputError:
                raise
            except Exception as error:  # The function is anyone's. Often it takes one angle only.
                raise InputError(place, f"failed for an array of angles: {shortened(str(error))}") from error
            if heights.shape != theta.shape:
                shape = f"must return an array of the shape {theta.shape} of its angles, not {heights.shape}"
                raise InputError(place, shape)
            value = theta, heights
        if is_pair(value):
            try:
                return cls.samples(*value)  # type: ignore[misc]
            except InputError as error:
                raise InputError(place, f"{error.field}: {error.reason}") from None
        given: object = value
        if isinstance(given, (str, Path)) and Path(given).suffix.lower() == ".csv":
            raise InputError(place, f"is the name of a file: Profile.from_csv({as_toml(str(given))}) reads it")
        height = number(place, value)
        return cls.constant(height) if height else cls()

    def entries(self) -> list[dict[str, Any]]:
        """The entries of its terms, as ids and HDF5 files hold them. Angles are in rad from +x."""
        return [term.entries() for term in self.terms]

    def toml(self) -> list[dict[str, Any]]:
        """The tables of its terms, as case files and JSON hold them. Angles are in degrees from the bottom."""
        return [term.toml() for term in self.terms]

    def words(self, text: ValueInWords) -> str:
        """Words that describe it. `text` words a value."""
        check_callable("text", text, 1)
        orders = [term.wave[0] for term in self.terms if term.wave is not None]
        if len(orders) == len(self.terms) > 4:
            return f"{len(orders):,} waves, with up to {max(orders)} round the hole"
        described = [term.words(text) for term in self.terms[:4]]
        if len(self.terms) > 4:
            described.append(f"and {len(self.terms) - 4} more terms")
        return "; ".join(described) or text(0.0)

    def __add__(self, other: Profile) -> Profile:
        if not isinstance(other, Profile):
            return NotImplemented
        return Profile((*self.terms, *other.terms))

    def scaled(self, factor: float) -> Profile:
        """The same profile with its values multiplied by a factor. A flat takes a positive one."""
        factor = number("factor", factor)
        return Profile(tuple(term.scaled(factor) for term in self.terms))

    def filtered(self, harmonics: int) -> Profile:
        """The sum of the waves of this profile with at most `harmonics` round the hole, 1 to 500.

        The finest filter of roundness testers keeps 500 waves.
        A roundness tester gives the form of a hole by 15 waves, and by more with the roughness.

        Raises
        ------
        InputError
            If `harmonics` is out of range, or the profile has a flat.
        """
        most = whole_number("harmonics", harmonics, 1, 500)
        if self.needs_lengths:
            raise InputError("harmonics", "can't filter a flat: its shape depends on the radius")
        found = self.amplitudes(1.0)[: most + 1].tolist()
        return Profile(tuple(Harmonic(n, A.real, -A.imag if n else 0.0) for n, A in enumerate(found)))

    def amplitudes(self, radius: float) -> np.ndarray:
        """The amplitudes A of its waves Re A exp(i n theta), n = 0, 1, 2 and so on; `radius` of the hole, m."""
        samples = max((len(term.angles) for term in self.terms if isinstance(term, Samples)), default=0)
        count = max(8192, 4 * samples)  # of a function too, which has many waves
        found = np.fft.rfft(self.at(np.arange(count) * (2.0 * math.pi / count), radius)) * (2.0 / count)
        found[0] *= 0.5
        return np.asarray(found)

    @property
    def has_jumps(self) -> bool:
        """Whether the quantity jumps somewhere."""
        return any(term.jumps for term in self.terms)

    @property
    def needs_lengths(self) -> bool:
        """Whether the shape of a term depends on its size in parts of the radius."""
        return any(term.needs_lengths for term in self.terms)

    @property
    def is_constant(self) -> bool:
        """Whether the quantity is the same all round, by its terms."""
        return all(isinstance(term, Harmonic) and term.order == 0 for term in self.terms)

    def angles(self, count: int, radius: float) -> np.ndarray:
        """Angles at which the profile shows itself, rad: `count` equally spaced, and those of its terms.

        `radius` is the radius of the hole, m.
        """
        theta = np.linspace(-math.pi, math.pi, whole_number("count", count, 0, MOST_SAMPLES))
        radius = positive("radius", radius)
        return np.concatenate([theta, *(term.angles_of_note(radius) for term in self.terms)])

    def values(self, theta: np.ndarray, radius: float) -> np.ndarray:
        """Value, first and second derivative at the angles `theta` (...), rad, shape (3, ...).

        `radius` is the radius of the hole, m.
        """
        theta, radius = number_array("theta", theta), positive("radius", radius)
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


def profile_of_nodes(grid: Grid, values: np.ndarray) -> Profile:
    """The profile of values (n,) at the nodes of a grid, joined by a periodic cubic spline; linear beyond an arc."""
    theta = grid.theta
    if not grid.closed:
        first, last = (theta[0] + 2.0 * math.pi, values[0]), (theta[-1], values[-1])
        beyond = np.linspace(last, first, 10)[1:-1]  # 8 angles join the ends of the arc
        theta, values = np.r_[theta, beyond[:, 0]], np.r_[values, beyond[:, 1]]
    return Profile((Samples(theta, values),))


def is_pair(value: object) -> bool:
    """Whether a value is a pair of angles and values."""
    rows = (list, tuple, np.ndarray)
    return isinstance(value, (list, tuple)) and len(value) == 2 and all(isinstance(each, rows) for each in value)


@explains_keywords
@dataclass(frozen=True)
class InitialGap:
    """The initial gap between pin and hole beside the clearance: the profiles of both, radial, m.

    A positive profile opens the gap: it is missing material, of the plate in `hole` and of the pin in `pin`. The pin
    has its profile where it is concentric and not turned.

    Parameters
    ----------
    hole, pin : Profile
        Without jumps. In a dimensionless problem, in units of F beta*. A number, a function of angles, rad, or a pair
        of angles and values stands for its profile.
    """

    hole: Profile = field(default_factory=Profile)
    pin: Profile = field(default_factory=Profile)

    def __post_init__(self) -> None:
        for name in ("hole", "pin"):
            profile = Profile.of(f"gap.{name}", getattr(self, name))
            if profile.has_jumps:
                raise InputError(f"gap.{name}", "must not jump: a zone has a step at its ends")
            set_fields(self, **{name: profile})

    @classmethod
    def of(cls, value: InitialGap | ProfileLike) -> InitialGap:
        """The initial gap that a user means by `value`. All but an initial gap is the profile of the hole."""
        return value if isinstance(value, InitialGap) else cls(value)  # type: ignore[arg-type]

    @property
    def given(self) -> dict[str, Profile]:
        """The profiles with terms, by "hole" and "pin"."""
        return {name: profile for name in ("hole", "pin") if (profile := getattr(self, name)).terms}

    def __bool__(self) -> bool:
        return bool(self.hole.terms or self.pin.terms)

    def angles(self, count: int, radius: float) -> np.ndarray:
        """Angles at which the gap shows itself, rad, in order; see :meth:`Profile.angles`."""
        found = np.concatenate([self.hole.angles(count, radius), self.pin.angles(0, radius)])
        return distinct(np.remainder(found + math.pi, 2.0 * math.pi) - math.pi)

    def waves(self) -> dict[int, complex]:
        """The amplitudes A of the waves Re A exp(i n theta) of the gap, by n. They are its harmonics.

        Raises
        ------
        InputError
            If a term is no harmonic.
        """
        found: dict[int, complex] = {}
        for term in (*self.hole.terms, *self.pin.terms):
            if term.wave is None:
                raise InputError("gap", "must be a sum of harmonics here")
            order, amplitude = term.wave
            found[order] = found.get(order, 0j) + amplitude
        return found

    def values(self, theta: np.ndarray, radius: float) -> np.ndarray:
        """Gap and two derivatives at the angles `theta` (...), rad, shape (3, ...); see :meth:`Profile.values`."""
        return self.hole.values(theta, radius) + self.pin.values(theta, radius)


NO_GAP = InitialGap()
"""A round pin in a round hole."""


def widest_place(theta: np.ndarray, gap: np.ndarray, fixed: tuple[bool, bool]) -> tuple[float, np.ndarray]:
    """The place at which the narrowest gap round a rigid pin is widest: a linear programme.

    Parameters
    ----------
    theta : ndarray, shape (n,)
        Angles round the hole, rad.
    gap : ndarray, shape (n,)
        Gap there when the pin is concentric. Negative where pin and hole overlap.
    fixed : (bool, bool)
        Whether the pin can't move along x, and along y.

    Returns
    -------
    (float, ndarray)
        The narrowest gap at this place, and the place, shape (2,), in the unit of `gap`. A negative gap says that the
        pin fits nowhere.
    """
    size = max(float(np.abs(gap).max()), 1e-300)
    bounds = [(None, None), *((0.0, 0.0) if held else (None, None) for held in fixed)]
    cos, sin = np.cos(theta), np.sin(theta)
    rows = np.column_stack([np.ones_like(theta), cos, sin])
    place = size * optimize.linprog([-1.0, 0.0, 0.0], rows, gap / size, bounds=bounds).x[1:]
    return float((gap - place[0] * cos - place[1] * sin).min()), place
