"""The stress at points of pin or plate, with its components and invariants, and the largest hoop stress."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from fastpin.elasticity.stress import bush_stress, pin_stress, plate_stress, seat_stress
from fastpin.elasticity.tractions import Tractions
from fastpin.errors import InputError
from fastpin.kernels.status import OPEN
from fastpin.model.checks import instance
from fastpin.model.grid import Grid
from fastpin.model.loads import LOADS, STRESSING
from fastpin.model.materials import Material
from fastpin.model.points import ROUNDING, Body, Points, is_beyond_bush, material_of, near_rim
from fastpin.model.problem import Problem
from fastpin.reading.zones import runs, unrolled


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
        the point: beyond a bush that of the plate round it. It is 0 in a laminate.
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

    @property
    def in_plane(self) -> np.ndarray:
        """The components (sxx, syy, sxy), shape (..., 3)."""
        return np.stack([self.sxx, self.syy, self.sxy], axis=-1)

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
    """The largest hoop stress round the hole, the pin or the seat of a bush, and the stresses of the joint.

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
        Force on the pin over the projected area, F/(2 R), Pa; at the seat of a bush with the radius of the seat.
    gross_stress : float
        Principal remote stress of largest magnitude, with its sign, Pa; 0 for the pin. The own loads of a compliance
        count as remote stresses.
    bypass : float
        Hoop stress of the open hole under the remote stress at the place of ``most_of_loads``, Pa; 0 for the pin. The
        hole is that of the problem's plate: of a ring, of a bush, or of a compliance under its own loads.
    most_of_loads : float
        Largest hoop stress of the loads round the edge, Pa. It is at the place of the peak if the stress of the
        assembly is the same all round, as in every joint of round, isotropic bodies.
    assembly : float
        Part of the peak that the press fits of bush and pin leave before any load, Pa, see
        :meth:`fastpin.State.assembly_stress`; 0 without one.
    net_stress : float
        Force on the pin over the net section, F/(W - D), Pa. W is the outer diameter of a ring, and D the diameter of
        the ring's own hole; a plate of any outline has the width W - D that its file states. 0 for any other plate, for
        the pin, and for the bush in a ring.

    The ratios Kt are those of ``most_of_loads``: no load causes the stress of the assembly. They belong to this state.
    Where a contact opens or slips they change with the loads: after a larger load friction holds stresses that a small
    load divides. A ratio is NaN if its nominal stress is zero or rounding.
    """

    value: float
    angle: float
    resolved: bool
    bearing_stress: float
    gross_stress: float
    bypass: float
    most_of_loads: float
    assembly: float = 0.0
    net_stress: float = 0.0

    @property
    def loads(self) -> float:
        """The part of the peak that the loads cause, Pa: value = assembly + loads."""
        return self.value - self.assembly

    @property
    def kt_gross(self) -> float:
        """The largest stress of the loads over the gross remote stress; NaN without remote stress."""
        return self._over(self.most_of_loads, self.gross_stress)

    @property
    def kt_bearing(self) -> float:
        """The largest stress of the loads over the bearing stress; NaN without a force on the pin."""
        return self._over(self.most_of_loads, self.bearing_stress)

    @property
    def kt_net(self) -> float:
        """The largest stress of the loads over the net-section stress, as handbooks of lugs have it.

        NaN without a net section or a force.
        """
        return self._over(self.most_of_loads, self.net_stress)

    @property
    def kt_bypass_part(self) -> float:
        """The open hole's part of the largest stress of the loads, over the gross remote stress; NaN without that.

        most_of_loads = kt_bypass_part * gross_stress + kt_bearing_part * bearing_stress.
        """
        return self._over(self.bypass, self.gross_stress)

    @property
    def kt_bearing_part(self) -> float:
        """The pin's part of the largest stress of the loads, over the bearing stress; NaN without a force on the pin.

        It is all that the open hole leaves.
        """
        return self._over(self.most_of_loads - self.bypass, self.bearing_stress)

    def _over(self, stress: float, nominal: float) -> float:
        """A stress over a nominal stress; NaN if the nominal stress is zero or rounding beside the peak."""
        return stress / nominal if abs(nominal) > 1e-9 * abs(self.value) else math.nan


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
    """The material at the edge of a body that has a stress.

    Raises
    ------
    InputError
        If the problem has no such body, or the body is rigid.
    """
    material = material_of(problem, body)
    if material.is_rigid:
        raise InputError(
            "body", f"the {'plate round the bush' if body == 'seat' else body} is rigid: its stress is not determined"
        )
    return material


def stress_at(
    problem: Problem, tractions: Tractions, load: Mapping[str, float], points: Points, body: Body,
    seat: Tractions | None = None,
) -> Stress:  # fmt: skip
    """The stress at points of a body; see :meth:`fastpin.State.stress`, also for the errors.

    `tractions` are in Pa, and so are those in the `seat` of a bush that slips. Of the `load` by name, the remote stress
    acts on the plate.
    """
    instance("points", points, Points, "fastpin.Points")
    material = check_body(problem, body)
    depth, theta = points.depths(problem, body).ravel(), points.theta.ravel()
    if body == "pin" and problem.pin_load == "centre" and not problem.pin_body.bore_radius and np.any(depth == 1.0):
        raise InputError("points", "the force acts at the centre of the pin: the stress there is infinite")
    ratio: float | np.ndarray = material.nu if material.is_isotropic else 0.0
    if body != "pin":
        for place in (point / problem.hole_radius for point in problem.plate_body.lug.force_points):
            away = np.abs((near_rim(problem, body) + depth) * np.exp(1j * theta) - place)
            if np.any(away < ROUNDING * abs(place)):
                raise InputError("points", "the reaction acts at one of the points: the stress there is infinite")
        ratio = _ratios_in_plate(problem, depth) if body != "seat" and material.is_isotropic else ratio
    components = stress_components(problem, tractions, load, (theta, depth), body, seat)
    radial, hoop, shear = (component.reshape(points.shape) for component in components)
    axial = np.zeros(points.shape)
    if problem.surfaces.plane == "strain":
        axial = (ratio.reshape(points.shape) if isinstance(ratio, np.ndarray) else ratio) * (radial + hoop)
    return Stress(points.theta, radial, hoop, shear, axial)


def edge_hoop(
    problem: Problem, load: Mapping[str, float], body: Body, tractions: Tractions, seat: Tractions | None = None
) -> Callable[[np.ndarray], np.ndarray]:
    """The hoop stress, Pa, on the edge of a body that :func:`check_body` admits, as a function of angles (m,), rad.

    The other arguments are those of :func:`stress_at`.
    """
    return lambda theta: stress_components(problem, tractions, load, (theta, np.zeros(theta.size)), body, seat)[1]


def stress_components(
    problem: Problem, tractions: Tractions, load: Mapping[str, float], places: tuple[np.ndarray, np.ndarray],
    body: Body, seat: Tractions | None = None,
) -> np.ndarray:  # fmt: skip
    """Stresses (srr, stt, srt), shape (3, m), in a body that :func:`check_body` admits.

    `places` are angles, rad, and depths in units of R, both (m,). The other arguments are those of :func:`stress_at`.
    """
    if body == "pin":
        return pin_stress(problem, tractions, *places)
    remote = np.array([load.get(LOADS[place], 0.0) for place in STRESSING])
    if seat is not None:
        return _of_joint(problem, (tractions, seat), remote, places, body)
    return (seat_stress if body == "seat" else plate_stress)(problem, tractions, remote, *places)


def assembly_stress(problem: Problem, assembled: Sequence[Tractions], points: Points, body: Body) -> Stress:
    """The stress at points of a body before any load; see :meth:`fastpin.State.assembly_stress`.

    `assembled` are the tractions of all interfaces, the pin first; none if nothing is pressed.
    """
    of_pin, *of_seat = assembled or (Tractions(()),)
    return stress_at(problem, of_pin, {}, points, body, *of_seat)


def _of_joint(
    problem: Problem, tractions: tuple[Tractions, Tractions], remote: np.ndarray,
    places: tuple[np.ndarray, np.ndarray], body: Body,
) -> np.ndarray:  # fmt: skip
    """Stresses (3, m) in a bush that slips, and in the plate round it. `places` are angles and depths in the body."""
    (theta, depth), seat = places, problem.interfaces[1]
    if body == "seat":
        return plate_stress(seat, tractions[1], remote, theta, depth * problem.hole_radius / seat.hole_radius)
    beyond, found = is_beyond_bush(problem, depth), np.empty((3, theta.size))
    found[:, ~beyond] = bush_stress(problem, *tractions, theta[~beyond], depth[~beyond])
    below = np.maximum((1.0 + depth[beyond]) * problem.hole_radius / seat.hole_radius - 1.0, 0.0)
    found[:, beyond] = plate_stress(seat, tractions[1], remote, theta[beyond], below)
    return found


def _ratios_in_plate(problem: Problem, depth: np.ndarray) -> float | np.ndarray:
    """Poisson's ratio at points of the plate, or one for all.

    Raises
    ------
    InputError
        If a point lies beyond a bush, and the plate there is rigid.
    """
    beyond = is_beyond_bush(problem, depth)
    if not beyond.any():
        return problem.surfaces.plate.nu
    if problem.pair.plate.is_rigid:
        raise InputError("points", "the plate round the bush is rigid: its stress is not determined")
    return np.where(beyond, problem.pair.plate.nu, problem.surfaces.plate.nu)


def open_hole_hoop(problem: Problem, remote: np.ndarray, angle: float, body: Body = "plate") -> float:
    """Hoop stress of the open hole under a remote stress (sxx, syy, sxy) at an angle, Pa, without a press fit.

    It is that on the edge of the `body` "plate" or "seat".
    """
    if problem.plate_body.is_infinite and problem.pair.plate.is_isotropic:
        sxx, syy, sxy = (float(value) for value in remote)
        return (sxx + syy) - 2.0 * ((sxx - syy) * math.cos(2.0 * angle) + 2.0 * sxy * math.sin(2.0 * angle))
    stress, place = seat_stress if body == "seat" else plate_stress, (np.array([angle]), np.zeros(1))
    loads = np.r_[remote, 0.0], np.zeros(len(STRESSING))
    pulled, pressed = (float(stress(problem, Tractions(()), each, *place)[1, 0]) for each in loads)
    return pulled - pressed
