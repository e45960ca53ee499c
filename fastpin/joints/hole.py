"""A hole of a plate with several pins, as the plate body of the contact in it."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from fastpin.bodies.compliance import Compliance, complex_coefficients
from fastpin.model.checks import set_fields


@dataclass(frozen=True, eq=False, repr=False)
class HoleInPlate(Compliance):
    """A hole of a plate as a plate body, in one state of a joint: what the other pins and the loads do to it is given.

    Parameters
    ----------
    incoming : ndarray, shape (2 + 4 K,)
        Displacement G v/R of the hole's edge, Pa, by the pins in the other holes and the loads of the plate.
    others : ndarray, shape (holes, 2 + 4 K)
        Coefficients of the tractions on the other holes with a pin, Pa.
    loads : ndarray, shape (3,)
        The loads sxx, syy and sxy of the plate, Pa.
    pinned : tuple of str
        Names of the other holes in the outline, if that is known.
    """

    incoming: np.ndarray = field(default_factory=lambda: np.zeros(0))
    others: np.ndarray = field(default_factory=lambda: np.zeros((0, 0)))
    loads: np.ndarray = field(default_factory=lambda: np.zeros(3))
    pinned: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        super().__post_init__()
        for name in ("incoming", "others", "loads"):
            given = np.array(getattr(self, name), dtype=float)
            given.setflags(write=False)
            set_fields(self, **{name: given})

    def __reduce__(self) -> tuple[type[HoleInPlate], tuple[Any, ...]]:
        return type(self), (*super().__reduce__()[1], self.incoming, self.others, self.loads, self.pinned)

    @cached_property
    def digest(self) -> str:
        """SHA-256 of all numbers."""
        numbers = np.r_[self.nu, self.hole_radius, self.matrix.ravel(), self.incoming, self.others.ravel(), self.loads]
        return hashlib.sha256((self.plane + self.outline).encode() + numbers.tobytes()).hexdigest()

    @cached_property
    def without_others(self) -> Compliance:
        return Compliance(self.nu, self.plane, self.hole_radius, self.matrix, outline=self.outline)

    @property
    def geometry(self) -> Any:
        return self.without_others.geometry

    @property
    def other_edges(self) -> Any:
        return self.without_others.other_edges

    @property
    def _inside(self) -> Any:
        return self._lugs.plate_field(self.without_others, self.pinned)

    def with_others(self, columns: np.ndarray) -> np.ndarray:
        own, acting = np.split(columns, [-self.loads.size - 1], axis=-1)  # the last one is the temperature
        others = np.broadcast_to(self.others.ravel(), (*columns.shape[:-1], self.others.size))
        return np.concatenate([own, others, acting + np.r_[self.loads, 0.0]], axis=-1)

    def _moved_by(self, column: np.ndarray) -> np.ndarray:
        return np.asarray(super()._moved_by(column) + complex_coefficients(self.incoming))
