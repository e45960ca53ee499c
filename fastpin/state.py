"""States of the contact and the result of a solution; edges and peaks read between nodes."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, overload

import numpy as np

from fastpin.grid import Grid
from fastpin.loading import LoadHistory
from fastpin.problem import Problem

SLIP_NEGATIVE, STICK, SLIP_POSITIVE, OPEN = -1, 0, 1, 2
"""Status of a node: slipping clockwise, sticking, slipping counter-clockwise (pin over plate), open."""

Interval = tuple[float, float]


@dataclass(frozen=True, eq=False)
class State:
    """The contact at one load.

    Attributes
    ----------
    step : int
        Index of the load corner that this state belongs to (0 for the first).
    fraction : float
        How far along the step from the previous corner, 0 to 1; 1 at the corner itself.
    load : dict of str to float
        Loads by name, see :data:`fastpin.loading.LOADS`.
    theta : ndarray, shape (n,)
        Node angles, rad; -pi/2 is the bottom of the hole.
    pressure, shear : ndarray, shape (n,)
        Contact pressure N >= 0 and shear traction T on the pin, positive along +theta (counter-clockwise), Pa.
    gap, slip : ndarray, shape (n,)
        Gap h >= 0 and slip s of the pin over the plate, positive along +theta, m. Slip counts from the position
        in which the pin first rested on the hole (for an interference fit: the concentric one).
    status : ndarray of int8, shape (n,)
        OPEN, STICK, SLIP_POSITIVE or SLIP_NEGATIVE.
    dx, dy, rotation : float
        Rigid motion of the pin along +x, +y (m) and counter-clockwise (rad) from its first resting position.
        In the paper's symbols C_0x, -Delta and C_omega.
    dissipation, work, energy : float
        Energy dissipated by friction so far, work of the loads so far and elastic energy now, J/m. Work and energy
        are counted up to the same function of the load.
    residuals : dict of str to float
        Largest violation, recomputed from the matrices: "gap" and "slip" relative to the largest displacement,
        "cone" and "equilibrium" relative to the largest traction and the load.
    """

    step: int
    fraction: float
    load: dict[str, float]
    theta: np.ndarray
    pressure: np.ndarray
    shear: np.ndarray
    gap: np.ndarray
    slip: np.ndarray
    status: np.ndarray
    dx: float
    dy: float
    rotation: float
    dissipation: float
    work: float
    energy: float
    residuals: dict[str, float]
    problem: Problem = field(repr=False)
    grid: Grid = field(repr=False)

    @property
    def in_contact(self) -> bool:
        return bool(np.any(self.status != OPEN))

    @cached_property
    def contact(self) -> list[Interval]:
        """Contact intervals (start, stop), rad, read between nodes: N^2 is extrapolated to zero.

        A contact round the whole circle is one interval of length 2 pi.
        """
        raise NotImplementedError

    @cached_property
    def stick(self) -> list[Interval]:
        """Stick intervals (start, stop), rad, read between nodes: (mu N - |T|)^2 is extrapolated to zero."""
        raise NotImplementedError
