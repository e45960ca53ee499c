"""One hole of a plate with several pins, as a plate body: what the other pins and the loads do to it is given."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from fastpin.bodies.body import Harmonics, Remote
from fastpin.bodies.compliance import Compliance, complex_coefficients
from fastpin.model.checks import set_fields


@dataclass(frozen=True, eq=False, repr=False)
class HoleInPlate(Compliance):
    """A hole of a plate, in one state of a joint.

    Parameters
    ----------
    incoming : ndarray, shape (2 + 4 K,)
        Displacement G v/R of the hole's edge, Pa, by the pins in the other holes and the loads of the plate.
    """

    incoming: np.ndarray = field(default_factory=lambda: np.zeros(0))

    def __post_init__(self) -> None:
        super().__post_init__()
        incoming = np.array(self.incoming, dtype=float)
        incoming.setflags(write=False)
        set_fields(self, incoming=incoming)

    def __reduce__(self) -> tuple[type[HoleInPlate], tuple[Any, ...]]:
        return type(self), (*super().__reduce__()[1], self.incoming)

    @cached_property
    def digest(self) -> str:
        """SHA-256 of all numbers."""
        numbers = np.r_[self.nu, self.hole_radius, self.matrix.ravel(), self.incoming]
        return hashlib.sha256(self.plane.encode() + numbers.tobytes()).hexdigest()

    def _edge_displacement(self, tractions: Harmonics, remote: Remote) -> np.ndarray:
        moved: np.ndarray = super()._edge_displacement(tractions, remote) + complex_coefficients(self.incoming)
        return moved
