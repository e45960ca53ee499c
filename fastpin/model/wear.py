"""How pin and plate wear: the law, the coefficients of both bodies, the cycles, and the control of fat cycles."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from fastpin.errors import InputError
from fastpin.model.checks import (
    check_fields,
    choice,
    count,
    given_fields,
    items,
    not_negative,
    number,
    numbers,
    set_fields,
)
from fastpin.model.profile import Profile, ProfileLike

MOST_CYCLES = 10**12
"""Cycles, at most."""

COEFFICIENTS = ("coefficient", "pin", "plate")
"""The fields of :class:`Wear` that are coefficients."""


@dataclass(frozen=True)
class Wear:
    """How pin and plate wear over many cycles. Worn-off debris is not modelled: it leaves the contact at once.

    Parameters
    ----------
    coefficient : float or Profile, optional
        Wear coefficient of both bodies together, 1/Pa, at least 0. Half of it is that of each body. A profile gives the
        coefficient along the rim.
    pin, plate : float or Profile, optional
        Instead: the coefficients of the two bodies, 1/Pa. One that is left out is 0.
    cycles : int
        Number of cycles; 1e5 is one too.
    law : {"archard", "energy"}
        "archard": depth = coefficient times int p |ds|, with the pressure p and the slip s. "energy": depth =
        coefficient times the energy that friction dissipates per area, int |q| |ds| with the shear traction q.
    at : sequence of int, optional
        Cycles after which profile and states are stored. Ten a decade unless given. The last one is always stored.
    tolerance : float
        Largest error of the worn gap by fat cycles, in parts of its largest depth; 0 solves every cycle.

    Raises
    ------
    InputError
        If a field can't be used.
    """

    coefficient: ProfileLike | None = None
    pin: ProfileLike | None = None
    plate: ProfileLike | None = None
    cycles: int = 1
    law: str = "archard"
    at: Sequence[int] | None = None
    tolerance: float = 1e-2

    def __post_init__(self) -> None:
        check_fields(self, choice, "law", ("archard", "energy"))
        check_fields(self, count, "cycles", MOST_CYCLES)
        check_fields(self, number, "tolerance", 0.0, 0.1)
        if self.coefficient is None and self.pin is None and self.plate is None:
            raise InputError("coefficient", "give the wear coefficient, or those of pin and plate")
        if self.coefficient is not None and (self.pin is not None or self.plate is not None):
            raise InputError("coefficient", "is that of both bodies together; give it, or those of pin and plate")
        for name in COEFFICIENTS:
            if (given := getattr(self, name)) is not None:
                profile = Profile.of(name, given)
                four_a_degree = np.linspace(-np.pi, np.pi, 1441)
                not_negative(name, float(profile.at(four_a_degree, 1.0).min()))
                set_fields(self, **{name: profile})
        if self.at is not None:
            chosen = [count("at", each, self.cycles) for each in items("at", self.at, "a list of cycles")]
            if len(chosen) > 10_000 or chosen != sorted(set(chosen)):
                raise InputError("at", "must be at most 10,000 increasing numbers of cycles")
            set_fields(self, at=tuple(chosen))

    def coefficients(self, radius: float, theta: np.ndarray) -> np.ndarray:
        """Coefficients of pin and plate, 1/Pa, at the angles `theta` (n,), rad, shape (2, n). `radius`: of the hole, m.

        Raises
        ------
        InputError
            If they are 0 all round.
        """
        theta = numbers("theta", theta)
        if theta.ndim != 1 or not theta.size:
            raise InputError("theta", f"must be a list of angles, not of the shape {theta.shape}")
        found = np.zeros((2, theta.size))
        for place, name, share in ((0, "pin", 1.0), (1, "plate", 1.0), (slice(None), "coefficient", 0.5)):
            if isinstance(profile := getattr(self, name), Profile):
                found[place] += share * profile.at(theta, radius)
        if not found.max() > 0.0:
            raise InputError("coefficient", "must be positive somewhere on pin or plate")
        positive: np.ndarray = np.maximum(found, 0.0)  # a spline may pass below zero in between
        return positive

    def toml(self) -> dict[str, Any]:
        """The keys and values of the section [wear] of a case file."""
        return {name: value.toml() if isinstance(value, Profile) else value for name, value in self.given.items()}

    @property
    def given(self) -> dict[str, Any]:
        """The fields that are not None, by name."""
        return given_fields(self)

    @property
    def chosen(self) -> tuple[int, ...]:
        """The cycles after which profile and states are stored, in order, 0 and the last one included."""
        if self.at is not None:
            return tuple(sorted({0, *self.at, self.cycles}))
        a_decade = 10
        count = int(np.ceil(a_decade * np.log10(self.cycles))) + 1
        some = np.round(10.0 ** (np.arange(count) / a_decade)).astype(np.int64).tolist()
        return tuple(sorted({0, *(each for each in some if each < self.cycles), self.cycles}))


def cycles_text(count: float) -> str:
    """A number of cycles as text: "1 cycle", "100,000 cycles"."""
    return f"{count:,.15g} cycle{'s' * (count != 1)}"


WEAR_KEYS = tuple(field.name for field in fields(Wear))
"""The fields of :class:`Wear`, the keys of [wear] in a case file."""
