"""The stress at points of pin or plate, with its components and invariants, and the largest hoop stress."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from fastpin.elasticity.stress import is_beyond_bush, pin_stress, plate_stress, press_fit_hoop
from fastpin.elasticity.tractions import Tractions
from fastpin.errors import InputError
from fastpin.kernels.status import OPEN
from fastpin.model.bodies import Disk, Plate
from fastpin.model.checks import choice, instance
from fastpin.model.grid import Grid
from fastpin.model.loads import LOADS, REMOTE
from fastpin.model.materials import Material
from fastpin.model.points import BODIES, ROUNDING, Body, Points
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
        Component szz along the pin: nu (srr + stt) in plane strain, 0 in plane stress. nu is that of the material at
        the point: beyond a bush that of the plate round it.
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
        Principal remote stress of largest magnitude, with its sign, Pa; 0 for the pin. The own loads of a compliance
        count as remote stresses.
    bypass : float
        Hoop stress of the open hole under the remote stress at the same place, Pa; 0 for the pin. The hole is that of
        the problem's plate: of a ring, of a bush, or of a compliance under its own loads.
    press_fit : float
        Hoop stress that the press fit of a bush leaves at the hole, Pa; 0 without a bush, and for the pin. It is in the
        peak, but in no concentration by parts: no load causes it.
    """

    value: float
    angle: float
    resolved: bool
    bearing_stress: float
    gross_stress: float
    bypass: float
    press_fit: float = 0.0

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

        peak = kt_bypass_part * gross_stress + kt_bearing_part * bearing_stress + press_fit.
        """
        return _over(self.bypass, self.gross_stress)

    @property
    def kt_bearing_part(self) -> float:
        """The rest of the peak, which the pin causes, over the bearing stress; NaN without a force on the pin."""
        return _over(self.value - self.bypass - self.press_fit, self.bearing_stress)


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
    """The material of a body that has a stress: of the plate the material at the hole, which may be a bush.

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
    if body == "pin" and problem.pin_load == "centre" and isinstance(problem.pin_body, Disk) and np.any(depth == 1.0):
        raise InputError("points", "the force acts at the centre of the pin: the stress there is infinite")
    ratio: float | np.ndarray = material.nu
    if body == "plate":
        ratio = _ratios_in_plate(problem, theta, depth)
        remote = np.array([load.get(LOADS[place], 0.0) for place in REMOTE])
        components = plate_stress(problem, tractions, remote, theta, depth)
    else:
        components = pin_stress(problem, tractions, theta, depth)
    radial, hoop, shear = (component.reshape(points.shape) for component in components)
    axial = np.zeros(points.shape)
    if problem.surfaces.plane == "strain":
        axial = (ratio.reshape(points.shape) if isinstance(ratio, np.ndarray) else ratio) * (radial + hoop)
    return Stress(points.theta, radial, hoop, shear, axial)


def _ratios_in_plate(problem: Problem, theta: np.ndarray, depth: np.ndarray) -> float | np.ndarray:
    """Poisson's ratio at points of the plate, or one for all.

    Raises
    ------
    InputError
        If the plate beyond a bush is rigid, or a reaction acts at a point.
    """
    joint = problem.joint
    if isinstance(joint.lug, Plate) and joint.lug.reaction is not None:
        place = complex(*joint.lug.reaction) / problem.hole_radius
        if np.any(np.abs((1.0 + depth) * np.exp(1j * theta) - place) < ROUNDING * abs(place)):
            raise InputError("points", "the reaction acts at one of the points: the stress there is infinite")
    beyond = is_beyond_bush(problem, depth)
    if not beyond.any():
        return problem.surfaces.plate.nu
    if joint.pair.plate.is_rigid:
        raise InputError("points", "the plate round the bush is rigid: its stress is not determined")
    return np.where(beyond, joint.pair.plate.nu, problem.surfaces.plate.nu)


def open_hole_hoop(problem: Problem, remote: np.ndarray, angle: float) -> float:
    """Hoop stress of the open hole under a remote stress (sxx, syy, sxy) at an angle, Pa, without a press fit."""
    if isinstance(problem.plate_body, Plate):
        sxx, syy, sxy = (float(value) for value in remote)
        return (sxx + syy) - 2.0 * ((sxx - syy) * math.cos(2.0 * angle) + 2.0 * sxy * math.sin(2.0 * angle))
    whole = plate_stress(problem, Tractions(()), remote, np.array([angle]), np.zeros(1))
    return float(whole[1, 0]) - press_fit_hoop(problem)
