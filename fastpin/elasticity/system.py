"""The matrices of one problem on one grid, and the contact's configuration in dimensionless form.

With a reference force F, tractions are in F/R, displacements in F beta*, rotations in F beta*/R. The pin's motion
(c_x, c_y, omega) counts from where it came to rest on the hole, and

    gap   h = rest gap + direct N + cross T  - c_x cos - c_y sin             + (loads)    Eqs. (9)-(12), (15)
    slip  s =           - cross N + direct T  - c_x sin + c_y cos + omega     + (loads)    Eqs. (9)-(12), (18)

where the rest gap is that of the rigid pin in the undeformed hole, and the terms of the displacement kernels that
depend on the resultants only (the w terms of the pin's load) stand with the loads: they are known once P and Q are.
What is left is symmetric.
"""

from __future__ import annotations

import copy
import math
from dataclasses import dataclass, replace

import numpy as np

from fastpin import kernels
from fastpin.basis import FactoredSet
from fastpin.grid import Grid
from fastpin.loading import LOADS
from fastpin.problem import Problem
from fastpin.state import OPEN, SLIP_POSITIVE, STICK

P, Q, M, SXX, SYY, ROTATION = range(len(LOADS))

MAX_RESIDUAL = 1e-9
"""Largest relative violation of the contact conditions in a state that is returned."""


@dataclass(frozen=True)
class Scales:
    """Units of the dimensionless quantities, SI."""

    force: float  # F, N/m
    traction: float  # F/R, Pa
    displacement: float  # F beta*, m
    rotation: float  # F beta*/R, rad
    energy: float  # F^2 beta*, J/m
    loads: np.ndarray  # unit of every load in the order of LOADS

    @classmethod
    def of(cls, problem: Problem, force: float) -> Scales:
        radius, beta = problem.hole_radius, problem.pair.beta_star
        traction, rotation = force / radius, force * beta / radius
        loads = np.array([force, force, force * radius, traction, traction, rotation])
        return cls(force, traction, force * beta, rotation, force * force * beta, loads)


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
class System:
    """The collocation matrices of one problem on one grid.

    ``operator`` (2n, 2n) maps (N, T) to (h, s), ``motion`` (2n, 3) the rigid motion and ``loads`` (2n, 6) the loads.
    ``gap0`` is the clearance, ``plate`` the radial displacement of the hole per remote stress (42). The equilibrium
    conditions (50), (51), or the prescription of a rotation that is held, are

        equilibrium @ (N, T) + motion_rows @ motion = forces @ load.
    """

    problem: Problem
    grid: Grid
    scales: Scales
    gap0: float
    friction: float
    operator: np.ndarray
    motion: np.ndarray
    loads: np.ndarray
    equilibrium: np.ndarray
    motion_rows: np.ndarray
    forces: np.ndarray
    weights: np.ndarray
    plate: float

    def reaches_end(self, configuration: Configuration) -> bool:
        """Whether the contact reaches an end node of an arc, where it is cut off."""
        return not self.grid.closed and bool(configuration.closed[[0, -1]].any())

    @property
    def resting_status(self) -> int:
        """Status of a closed node that does not move: sticking, or slipping where there is no friction."""
        return STICK if self.friction > 0.0 else SLIP_POSITIVE

    @classmethod
    def build(cls, problem: Problem, grid: Grid, force: float) -> System:
        """Fill the matrices of `problem` on `grid` with reference force `force`, N/m."""
        pair = problem.pair
        n, theta = grid.size, grid.theta
        left, right = grid.knots()
        weights = grid.weights
        ratio = pair.alpha_star / pair.beta_star
        uniform_part = (pair.pin_kolosov + 1.0) * pair.pin_compliance / (2.0 * pair.beta_star)
        operator = np.empty((2 * n, 2 * n), order="F")
        kernels.fill_operator(theta, left, right, grid.uniform, grid.closed, ratio, uniform_part, operator)

        cos, sin, one, zero = np.cos(theta), np.sin(theta), np.ones(n), np.zeros(n)
        motion = np.column_stack([np.r_[-cos, -sin], np.r_[-sin, cos], np.r_[zero, one]])
        share = 1.0 if problem.pin_load == "centre" else 0.5  # the number w of section 4
        point = share * pair.pin_compliance / (4.0 * math.pi * pair.beta_star)
        plate = 0.5 * (1.0 - uniform_part)  # R kappa'/(2 G) per beta*, Eq. (42)
        loads = np.zeros((2 * n, len(LOADS)))
        loads[:, P] = point * np.r_[sin, cos]
        loads[:, Q] = point * np.r_[-cos, sin]
        loads[:, SXX] = plate * np.r_[0.5 + np.cos(2 * theta), np.sin(2 * theta)]
        loads[:, SYY] = plate * np.r_[0.5 - np.cos(2 * theta), -np.sin(2 * theta)]

        cos_moment, sin_moment = grid.trig_moments()
        equilibrium = np.zeros((3, 2 * n))
        equilibrium[0] = np.r_[cos_moment, sin_moment]  # Q
        equilibrium[1] = np.r_[sin_moment, -cos_moment]  # -P
        motion_rows, forces = np.zeros((3, 3)), np.zeros((3, len(LOADS)))
        forces[0, Q], forces[1, P] = 1.0, -1.0
        if problem.rotation == "free" and not problem.frictionless:
            equilibrium[2, n:] = -weights  # M
            forces[2, M] = 1.0
        else:
            motion_rows[2, 2] = 1.0
            equilibrium[2, n:] = -problem.hub_compliance * weights
            forces[2, ROTATION] = 1.0
        scales = Scales.of(problem, force)
        return cls(
            problem, grid, scales, problem.clearance / scales.displacement, problem.friction,
            operator, motion, loads, equilibrium, motion_rows, forces, weights, plate,
        )  # fmt: skip

    def without_friction(self) -> System:
        """The same system for mu = 0, with the rotation held at the load's ``rotation``."""
        equilibrium, motion_rows, forces = self.equilibrium.copy(), np.zeros((3, 3)), self.forces.copy()
        equilibrium[2], forces[2] = 0.0, 0.0
        motion_rows[2, 2] = forces[2, ROTATION] = 1.0
        return replace(self, friction=0.0, equilibrium=equilibrium, motion_rows=motion_rows, forces=forces)

    def solve(
        self, status: np.ndarray, stuck_slip: np.ndarray, load: np.ndarray, rest_gap: np.ndarray | float
    ) -> Solution | None:
        """Tractions and motion for given statuses; None if the closed nodes can't hold the pin (a mechanism).

        `stuck_slip` (n,) is the slip held at sticking nodes. With ``rest_gap = 0``, zero `stuck_slip` and a load rate
        this gives rates.
        """
        active = FactoredSet(self, status)
        if active.singular:
            return None
        n = self.grid.size
        known = self.loads[active.rows] @ load
        known[: active.normal.size] += np.broadcast_to(rest_gap, n)[active.normal]
        known[active.normal.size :] -= stuck_slip[active.tangential]
        unknowns = active.solve(np.r_[-known, self.forces @ load])
        tractions = active.expand(unknowns)
        motion = unknowns[-3:]
        displacement = self.displacement(tractions, motion, load, rest_gap)
        return Solution(tractions[:n], tractions[n:], displacement[:n], displacement[n:], motion)

    def displacement(
        self, tractions: np.ndarray, motion: np.ndarray, load: np.ndarray, rest_gap: np.ndarray | float
    ) -> np.ndarray:
        """Gap and slip (2n,) of given tractions, motion and load, straight from the matrices."""
        return self.moved(self.operator @ tractions, motion, load, rest_gap)

    def moved(
        self, elastic: np.ndarray, motion: np.ndarray, load: np.ndarray, rest_gap: np.ndarray | float
    ) -> np.ndarray:
        """Gap and slip (2n,) from what the tractions make of them, ``operator @ tractions``."""
        result = elastic + self.motion @ motion + self.loads @ load
        result[: self.grid.size] += rest_gap
        return result

    def work(self, before: Configuration, after: Configuration) -> float:
        """Work of the loads between two configurations, with the mean load (dimensionless)."""
        n = self.grid.size
        load = 0.5 * (before.load + after.load)
        moved = after.motion - before.motion
        moment = -0.5 * float(self.weights @ (before.shear + after.shear))
        change = np.r_[after.pressure - before.pressure, after.shear - before.shear]
        column = self.loads @ load
        internal = float((self.weights * column[:n]) @ change[:n] + (self.weights * column[n:]) @ change[n:])
        return float(load[Q] * moved[0] - load[P] * moved[1] + moment * moved[2]) + internal

    def dissipated(self, before: Configuration, after: Configuration) -> float:
        """Energy that friction dissipates between two configurations, with the mean shear (dimensionless)."""
        slid = np.where(after.closed, after.slip - before.slip, 0.0)
        return -0.5 * float((self.weights * slid) @ (before.shear + after.shear))

    def energy(self, configuration: Configuration) -> float:
        """Elastic energy of a configuration, up to a function of the load alone (dimensionless)."""
        tractions = np.r_[configuration.pressure, configuration.shear]
        elastic = 0.5 * (self.operator @ tractions) + self.loads @ configuration.load
        return float(np.sum(np.r_[self.weights, self.weights] * tractions * elastic))

    def worst_residual(self, configuration: Configuration) -> float:
        return float(np.max(list(self.residuals(configuration).values())))

    def residuals(self, configuration: Configuration) -> dict[str, float]:
        """Largest relative violation of the contact conditions, recomputed from the matrices."""
        n, mu = self.grid.size, self.friction
        pressure, shear, status = configuration.pressure, configuration.shear, configuration.status
        tractions = np.r_[pressure, shear]
        elastic = self.operator @ tractions
        true = self.moved(elastic, configuration.motion, configuration.load, configuration.rest_gap)
        closed, stick = status != OPEN, status == STICK
        slipping = closed & ~stick
        gap_error = np.where(closed, np.abs(true[:n]), np.maximum(-true[:n], 0.0))
        slip_error = np.where(closed, np.abs(true[n:] - configuration.slip), 0.0)
        on_cone = np.where(slipping, np.abs(shear + status * mu * pressure), np.abs(shear) - mu * pressure)
        cone_error = np.where(closed, np.maximum(on_cone, -pressure), np.maximum(np.abs(pressure), np.abs(shear)))
        balance = self.equilibrium @ tractions + self.motion_rows @ configuration.motion
        balance_error = np.abs(balance - self.forces @ configuration.load)
        length = max(float(np.abs(elastic).max()), float(np.abs(configuration.motion).max()), 1e-300)
        if not closed.any():
            length = max(length, abs(self.gap0))
        traction = max(float(pressure.max()), 1e-300)
        total = max(float(np.abs(self.equilibrium) @ np.abs(tractions) @ np.ones(3)), 1e-300)
        return {
            "gap": float(gap_error.max()) / length,
            "slip": float(slip_error.max()) / length,
            "cone": float(max(cone_error.max(), 0.0)) / traction,
            "equilibrium": float(balance_error.max()) / total,
        }


@dataclass(frozen=True, eq=False)
class Solution:
    """Tractions, gap, slip and motion of one solve (or their rates)."""

    pressure: np.ndarray
    shear: np.ndarray
    gap: np.ndarray
    slip: np.ndarray
    motion: np.ndarray
