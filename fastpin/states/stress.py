"""The stress at points of pin or plate, with its components and invariants, and the largest hoop stress."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from fastpin.elasticity.stress import pin_stress, plate_stress
from fastpin.elasticity.tractions import Tractions
from fastpin.errors import InputError
from fastpin.kernels.status import OPEN
from fastpin.model.checks import choice, instance
from fastpin.model.grid import Grid
from fastpin.model.loads import LOADS, REMOTE
from fastpin.model.materials import Material
from fastpin.model.points import BODIES, Body, Points
from fastpin.model.problem import Problem
from fastpin.states.zones import runs, unrolled


@dataclass(frozen=True, eq=False)
class Stress:
    """The stress at points, Pa; tension is positive. All arrays have the shape of the points.

    Attributes
    ----------
    theta : ndarray
        Angles of the points, rad.
    radial, hoop, shear : ndarray
        Polar components srr, stt and srt.
    axial : ndarray
        Component szz along the pin: nu (srr + stt) in plane strain, 0 in plane stress.
    """

    theta: np.ndarray
    radial: np.ndarray
    hoop: np.ndarray
    shear: np.ndarray
    axial: np.ndarray

    @property
    def sxx(self) -> np.ndarray:
        """Component along +x."""
        return self._mean + self._half_difference * np.cos(2.0 * self.theta) - self.shear * np.sin(2.0 * self.theta)

    @property
    def syy(self) -> np.ndarray:
        """Component along +y."""
        return self._mean - self._half_difference * np.cos(2.0 * self.theta) + self.shear * np.sin(2.0 * self.theta)

    @property
    def sxy(self) -> np.ndarray:
        """Shear stress in the directions x and y."""
        return self._half_difference * np.sin(2.0 * self.theta) + self.shear * np.cos(2.0 * self.theta)

    @cached_property
    def principal(self) -> np.ndarray:
        """The three principal stresses, largest first, shape (..., 3)."""
        circle = np.hypot(self._half_difference, self.shear)
        three = np.stack([self._mean + circle, self._mean - circle, self.axial], axis=-1)
        return np.sort(three, axis=-1)[..., ::-1]

    @property
    def von_mises(self) -> np.ndarray:
        """Equivalent stress of von Mises."""
        first, second, third = np.moveaxis(self.principal, -1, 0)
        return np.sqrt(0.5 * ((first - second) ** 2 + (second - third) ** 2 + (third - first) ** 2))

    @property
    def tresca(self) -> np.ndarray:
        """Equivalent stress of Tresca: the largest principal stress less the smallest."""
        return self.principal[..., 0] - self.principal[..., 2]

    @property
    def hydrostatic(self) -> np.ndarray:
        """A third of the sum of the normal stresses."""
        return (self.radial + self.hoop + self.axial) / 3.0

    @property
    def _mean(self) -> np.ndarray:
        return 0.5 * (self.radial + self.hoop)

    @property
    def _half_difference(self) -> np.ndarray:
        return 0.5 * (self.radial - self.hoop)


@dataclass(frozen=True)
class HoopPeak:
    """The largest hoop stress round the hole or the pin, and the stresses of the joint.

    Attributes
    ----------
    value : float
        Pa; tension is positive.
    angle : float
        Its place, rad; NaN without any stress.
    resolved : bool
        False if the peak is, or may be, at a place that the nodes do not resolve: at an edge or a border beside an
        earlier border, or at an earlier border itself; also if less than 40 nodes are in contact. The value may then be
        off by some 10 %.
    bearing_stress : float
        Force on the pin over the projected area, F/(2 R), Pa.
    gross_stress : float
        Principal remote stress of largest magnitude, with its sign, Pa; 0 for the pin.
    bypass : float
        Hoop stress of the open hole under the remote stress at the same place, Pa; 0 for the pin.
    """

    value: float
    angle: float
    resolved: bool
    bearing_stress: float
    gross_stress: float
    bypass: float

    @property
    def kt_gross(self) -> float:
        """The peak over the gross remote stress; NaN without remote stress."""
        return _over(self.value, self.gross_stress)

    @property
    def kt_bearing(self) -> float:
        """The peak over the bearing stress; NaN without a force on the pin."""
        return _over(self.value, self.bearing_stress)

    @property
    def kt_bypass_part(self) -> float:
        """The open hole's part of the peak over the gross remote stress; NaN without remote stress.

        peak = kt_bypass_part * gross_stress + kt_bearing_part * bearing_stress.
        """
        return _over(self.bypass, self.gross_stress)

    @property
    def kt_bearing_part(self) -> float:
        """The rest of the peak, which the pin causes, over the bearing stress; NaN without a force on the pin."""
        return _over(self.value - self.bypass, self.bearing_stress)


def _over(one: float, other: float) -> float:
    return one / other if other != 0.0 else math.nan


def tractions_of(grid: Grid, status: np.ndarray, pressure: np.ndarray, shear: np.ndarray) -> Tractions:
    """The piecewise linear tractions of nodal values, shape (n,): one patch for each run of closed nodes."""
    closed, n, patches = status != OPEN, grid.size, []
    for run in runs(grid, closed):
        all_round = run.size == n
        nodes = np.r_[run, run[0]] if all_round else np.r_[run[0] - 1, run, run[-1] + 1] % n
        values = np.column_stack([unrolled(grid, nodes), pressure[nodes], shear[nodes]])
        if not all_round:
            values[[0, -1], 1:] = 0.0
        patches.append(values)
    return Tractions(tuple(patches))


def check_body(problem: Problem, body: Body) -> Material:
    """The material of a body that has a stress.

    Raises
    ------
    InputError
        If `body` is no body, or the body is rigid.
    """
    material: Material = getattr(problem.surfaces, choice("body", body, BODIES))
    if material.is_rigid:
        raise InputError("body", f"the {body} is rigid: its stress is not determined")
    return material


def stress_at(problem: Problem, tractions: Tractions, load: Mapping[str, float], points: Points, body: Body) -> Stress:
    """The stress at points of a body; see :meth:`fastpin.State.stress`, also for the errors.

    `tractions` are in Pa. Of the `load` by name, the remote stress acts on the plate.
    """
    instance("points", points, Points, "fastpin.Points")
    material = check_body(problem, body)
    depth, theta = points.depths(problem, body).ravel(), points.theta.ravel()
    if body == "pin" and problem.pin_load == "centre" and np.any(depth == 1.0):
        raise InputError("points", "the force acts at the centre of the pin: the stress there is infinite")
    if body == "plate":
        remote = np.array([load.get(LOADS[place], 0.0) for place in REMOTE])
        components = plate_stress(problem, tractions, remote, theta, depth)
    else:
        components = pin_stress(problem, tractions, theta, depth)
    radial, hoop, shear = (component.reshape(points.shape) for component in components)
    axial = material.nu * (radial + hoop) if problem.surfaces.plane == "strain" else np.zeros(points.shape)
    return Stress(points.theta, radial, hoop, shear, axial)
