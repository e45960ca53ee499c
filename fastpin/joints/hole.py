"""A hole of a plate with several pins, as the plate body of the contact in it."""

from __future__ import annotations

import hashlib
import math
from dataclasses import dataclass, field, fields, replace
from functools import cached_property
from typing import Any

import numpy as np

from fastpin.bodies.body import Harmonics, Remote, Rim
from fastpin.bodies.compliance import LEAST_ORDER, Compliance, complex_coefficients, translation_rows
from fastpin.bodies.walls import PlateWalls
from fastpin.model.checks import set_fields
from fastpin.model.materials import Plane
from fastpin.states.state import State

ACTING = ("incoming", "others", "loads", "rubbed")
"""Fields of a hole that differ from state to state."""


@dataclass(frozen=True, eq=False, repr=False)
class HoleInPlate(Compliance):
    """A hole of a plate as a plate body, in one state of a joint: what the other pins and the loads do to it is given.

    Parameters
    ----------
    incoming : ndarray, shape (2 + 4 K,)
        Displacement G v/R of the hole's edge, Pa, by the pins in the other holes, the loads of the plate, and all
        friction of faying surfaces.
    others : ndarray, shape (holes, 2 + 4 K)
        Coefficients of the tractions on the other holes with a pin, Pa.
    loads : ndarray, shape (3,)
        The loads sxx, syy and sxy of the plate, Pa.
    pinned : tuple of str
        Names of the other holes in the outline, if that is known.
    rubbed : ndarray, shape (2 + 4 K,)
        Coefficients of the uniform traction by friction of faying surfaces on this hole, Pa.
    """

    in_joint = True

    incoming: np.ndarray = field(default_factory=lambda: np.zeros(0))
    others: np.ndarray = field(default_factory=lambda: np.zeros((0, 0)))
    loads: np.ndarray = field(default_factory=lambda: np.zeros(3))
    pinned: tuple[str, ...] = ()
    rubbed: np.ndarray = field(default_factory=lambda: np.zeros(2))

    def __post_init__(self) -> None:
        super().__post_init__()
        self._set_acting(**{name: getattr(self, name) for name in ACTING})

    def __reduce__(self) -> tuple[type[HoleInPlate], tuple[Any, ...]]:
        own = self.incoming, self.others, self.loads, self.pinned, self.rubbed
        return type(self), (*super().__reduce__()[1], *own)

    @classmethod
    def alone(cls, nu: float, plane: Plane, radius: float) -> HoleInPlate:
        """The hole of an infinite plate in which no other pin acts."""
        return cls(nu, plane, radius, np.zeros((2 + 4 * LEAST_ORDER,) * 2))

    def under(self, **acting: np.ndarray) -> HoleInPlate:
        """The same hole with other ``incoming``, ``others``, ``loads`` and ``rubbed``. Both share the matrix."""
        found = object.__new__(type(self))
        set_fields(found, **{each.name: getattr(self, each.name) for each in fields(self)})
        found._set_acting(**acting)
        return found

    @property
    def at_rest(self) -> HoleInPlate:
        """The same hole in which no other pin and no load acts."""
        return self.under(**{name: np.zeros_like(getattr(self, name)) for name in ACTING})

    def _set_acting(self, **acting: np.ndarray) -> None:
        for name, values in acting.items():
            given = np.array(values, dtype=float)
            given.setflags(write=False)
            set_fields(self, **{name: given})

    @cached_property
    def digest(self) -> str:
        """SHA-256 of all numbers."""
        acting = self.incoming, self.others.ravel(), self.loads, self.rubbed
        numbers = np.r_[self.nu, self.hole_radius, self.matrix.ravel(), *acting]
        return hashlib.sha256((self.plane + self.outline).encode() + numbers.tobytes()).hexdigest()

    @cached_property
    def without_others(self) -> Compliance:
        return Compliance(self.nu, self.plane, self.hole_radius, self.matrix, outline=self.outline)

    @property
    def geometry(self) -> Any:
        return self.without_others.geometry if self.outline else None

    @property
    def other_edges(self) -> Any:
        return self.without_others.other_edges

    @property
    def _inside(self) -> Any:
        return self._lugs.plate_field(self.without_others, self.pinned)

    def with_others(self, columns: np.ndarray) -> np.ndarray:
        own, acting = np.split(columns.copy(), [-self.loads.size - 1], axis=-1)  # the last one is the temperature
        own[..., : self.rubbed.size] += self.rubbed
        others = np.broadcast_to(self.others.ravel(), (*columns.shape[:-1], self.others.size))
        return np.concatenate([own, others, acting + np.r_[self.loads, 0.0]], axis=-1)

    def _moved_by(self, column: np.ndarray) -> np.ndarray:
        return np.asarray(super()._moved_by(column) + complex_coefficients(self.incoming))

    @property
    def _rubbed_by(self) -> complex:
        """The uniform traction x + iy of the faying surfaces on the hole, Pa."""
        x, y = math.sqrt(0.5) * (translation_rows(self.rubbed.size) @ self.rubbed)
        return complex(x, y)

    def walls(self, rim: Rim, tractions: Harmonics, remote: Remote) -> PlateWalls:
        """The smooth field, with that of friction on this hole in an infinite plate: a first harmonic, (T42)."""
        found, log = super().walls(rim, tractions, remote), np.conj(self._rubbed_by) / (1.0 + rim.kolosov)
        found.surface.growing[2, 1] += rim.kolosov * log / found.surface.largest
        found.surface.decaying[:, 1] += np.conj(log) * np.array([-1.0, 1.0, -2.0])
        return found

    def add_edge_hoop(self, hoop: np.ndarray, rim: Rim, tractions: Harmonics, remote: Remote, at: np.ndarray) -> None:
        super().add_edge_hoop(hoop, rim, tractions, remote, at)
        hoop += (1.0 - 4.0 / (1.0 + rim.kolosov)) * np.real(self._rubbed_by * np.exp(-1j * at))


def in_hole(state: State, hole: HoleInPlate) -> State:
    """The state of a pin, and of its bush, in another hole."""
    bush = state.problem.plate_body.bush
    problem, at_rest = (
        replace(state.problem, plate_body=each if bush is None else replace(bush, inside=each))
        for each in (hole, hole.at_rest)
    )
    seat = None if state.seat is None else replace(state.seat, problem=problem.interfaces[1])
    found = replace(state, problem=problem, seat=seat)
    for each in filter(None, (found, seat)):  # one joint before any load for all states
        each.__dict__["_joint"] = at_rest, state.grid
    return found
