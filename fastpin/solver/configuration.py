"""The evolving contact in dimensionless form, its residuals and energies."""

from __future__ import annotations

import copy
from dataclasses import dataclass

import numpy as np

from fastpin.elasticity.system import System
from fastpin.kernels.status import OPEN, SLIP_POSITIVE, STICK
from fastpin.model.loads import P, Q
from fastpin.solver.unknowns import DenseUnknowns

MAX_RESIDUAL = 1e-9
"""Largest relative violation of the contact conditions in a state that is returned."""


@dataclass(eq=False)
class Configuration:
    """Everything that evolves: tractions, gap, slip, motion and status at one load (dimensionless).

    ``rest`` (2,) is the position of the pin's centre, from the concentric one, where it came to rest on the hole, and
    ``rest_gap`` (n,) the gap there, both without the remote stress. ``motion`` and ``slip`` count from there;
    ``origin`` is the first such position (NaN before there was one).
    ``rest_slip`` is what the remote stress had made of the slip by then, and is taken off before users see it.
    """

    pressure: np.ndarray
    shear: np.ndarray
    gap: np.ndarray
    slip: np.ndarray
    status: np.ndarray
    motion: np.ndarray
    load: np.ndarray
    origin: np.ndarray
    rest: np.ndarray
    rest_gap: np.ndarray
    rest_slip: np.ndarray
    dissipation: float = 0.0
    work: float = 0.0

    def copy(self) -> Configuration:
        """A copy that shares no array with this one."""
        return copy.deepcopy(self)

    @property
    def closed(self) -> np.ndarray:
        return self.status != OPEN


@dataclass(frozen=True, eq=False)
class Solution:
    """Tractions, gap, slip and motion of one solve (or their rates)."""

    pressure: np.ndarray
    shear: np.ndarray
    gap: np.ndarray
    slip: np.ndarray
    motion: np.ndarray


def reaches_end(system: System, configuration: Configuration) -> bool:
    """Whether the contact reaches an end node of an arc, where it is cut off."""
    return not system.grid.closed and bool(configuration.closed[[0, -1]].any())


def resting_status(system: System) -> int:
    """Status of a closed node that does not move: sticking, or slipping where there is no friction."""
    return STICK if system.friction > 0.0 else SLIP_POSITIVE


def solve_statuses(
    system: System, status: np.ndarray, stuck_slip: np.ndarray, load: np.ndarray, rest_gap: np.ndarray | float
) -> Solution | None:
    """Tractions and motion for given statuses; None if the closed nodes can't hold the pin (a mechanism).

    `stuck_slip` (n,) is the slip held at sticking nodes. With ``rest_gap = 0``, zero `stuck_slip` and a load rate
    this gives rates.
    """
    active = DenseUnknowns(system, status)
    if active.singular:
        return None
    n = system.grid.size
    known = system.loads[active.rows] @ load
    known[: active.normal.size] += np.broadcast_to(rest_gap, n)[active.normal]
    known[active.normal.size :] -= stuck_slip[active.tangential]
    unknowns = active.solve(np.r_[-known, system.forces @ load])
    tractions = active.expand(unknowns)
    motion = unknowns[-3:]
    displacement = system.displacement(tractions, motion, load, rest_gap)
    return Solution(tractions[:n], tractions[n:], displacement[:n], displacement[n:], motion)


def work_between(system: System, before: Configuration, after: Configuration) -> float:
    """Work of the loads between two configurations, with the mean load (dimensionless)."""
    n = system.grid.size
    load = 0.5 * (before.load + after.load)
    moved = after.motion - before.motion
    moment = -0.5 * float(system.weights @ (before.shear + after.shear))
    change = np.r_[after.pressure - before.pressure, after.shear - before.shear]
    column = system.loads @ load
    internal = float((system.weights * column[:n]) @ change[:n] + (system.weights * column[n:]) @ change[n:])
    return float(load[Q] * moved[0] - load[P] * moved[1] + moment * moved[2]) + internal


def dissipation_between(system: System, before: Configuration, after: Configuration) -> float:
    """Energy that friction dissipates between two configurations, with the mean shear (dimensionless)."""
    slid = np.where(after.closed, after.slip - before.slip, 0.0)
    return -0.5 * float((system.weights * slid) @ (before.shear + after.shear))


def elastic_energy(system: System, configuration: Configuration) -> float:
    """Elastic energy of a configuration, up to a function of the load alone (dimensionless)."""
    tractions = np.r_[configuration.pressure, configuration.shear]
    elastic = 0.5 * (system.operator @ tractions) + system.loads @ configuration.load
    return float(np.sum(np.r_[system.weights, system.weights] * tractions * elastic))


def worst_residual(system: System, configuration: Configuration) -> float:
    """Largest of all residuals."""
    return float(np.max(list(contact_residuals(system, configuration).values())))


def contact_residuals(system: System, configuration: Configuration) -> dict[str, float]:
    """Largest relative violation of the contact conditions, recomputed from the matrices."""
    n, mu = system.grid.size, system.friction
    pressure, shear, status = configuration.pressure, configuration.shear, configuration.status
    tractions = np.r_[pressure, shear]
    elastic = system.operator @ tractions
    true = system.total_displacement(elastic, configuration.motion, configuration.load, configuration.rest_gap)
    closed, stick = status != OPEN, status == STICK
    slipping = closed & ~stick
    gap_error = np.where(closed, np.abs(true[:n]), np.maximum(-true[:n], 0.0))
    slip_error = np.where(closed, np.abs(true[n:] - configuration.slip), 0.0)
    on_cone = np.where(slipping, np.abs(shear + status * mu * pressure), np.abs(shear) - mu * pressure)
    cone_error = np.where(closed, np.maximum(on_cone, -pressure), np.maximum(np.abs(pressure), np.abs(shear)))
    balance = system.equilibrium @ tractions + system.motion_rows @ configuration.motion
    balance_error = np.abs(balance - system.forces @ configuration.load)
    length = max(float(np.abs(elastic).max()), float(np.abs(configuration.motion).max()), 1e-300)
    if not closed.any():
        length = max(length, abs(system.rest_clearance))
    traction = max(float(pressure.max()), 1e-300)
    total = max(float(np.abs(system.equilibrium) @ np.abs(tractions) @ np.ones(3)), 1e-300)
    return {
        "gap": float(gap_error.max()) / length,
        "slip": float(slip_error.max()) / length,
        "cone": float(max(cone_error.max(), 0.0)) / traction,
        "equilibrium": float(balance_error.max()) / total,
    }
