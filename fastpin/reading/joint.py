"""The displacement of the pin over the far side of the plate, and the interface of a bush."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from fastpin.bodies.compliance import basis
from fastpin.elasticity.interfaces import moved_twice
from fastpin.errors import InputError
from fastpin.model.angles import near_bottom
from fastpin.model.checks import number
from fastpin.model.grid import Grid
from fastpin.model.points import Points
from fastpin.model.problem import LEAST_HUB, MOST_GAUGE, Problem
from fastpin.model.read_only import ReadOnly
from fastpin.model.ties import top_angle
from fastpin.reading.stress import Stress

AROUND = 1440
"""Equally spaced angles of the interface of a bush. Its tractions are smooth: the contact is a wall away."""


def joint_displacement(
    problem: Problem, grid: Grid, tractions: tuple[np.ndarray, np.ndarray], load: Mapping[str, float], moved: complex,
    force: complex, hub_radius: float | None, gauge_radius: float | None,
) -> dict[str, float]:  # fmt: skip
    """The displacement of the joint, "ux" and "uy" in m; see :meth:`fastpin.State.joint_displacement`.

    `tractions` are the pressure and the shear (n,), `moved` is dx + i dy, and `force` is Q - i P of the tractions.
    """
    radius, lug, hub, gauge = problem.hole_radius, problem.plate_body.lug, None, None
    if hub_radius is not None:
        if problem.pin_load == "body":
            raise InputError("hub_radius", "the displacement of a body-loaded pin is its mean: leave the hub out")
        least = problem.pin_body.bore_radius or LEAST_HUB * radius
        hub = number("hub_radius", hub_radius, least, radius) / radius
    if gauge_radius is not None:
        if lug.edge_only:
            raise InputError("gauge_radius", lug.without_gauge(gauge_radius))
        most = min(lug.outer_radius, MOST_GAUGE * radius)
        gauge = number("gauge_radius", gauge_radius, radius, most) / radius
    own, coupling = problem.joint.displacement_compliances(hub, gauge)
    unit = problem.surfaces.beta_star
    (cos, sin), (pressure, shear) = grid.trig_moments(), tractions
    moved += unit * own * force
    moved -= unit * coupling * radius * complex(cos @ pressure - sin @ shear, sin @ pressure + cos @ shear)
    moved = problem.plate_body.over_gauge(moved, problem.joint.hole, force, gauge)
    moved = problem.plate_body.over_supports(
        moved, problem.joint.hole, lambda matrix: basis(matrix, grid)[1] @ np.r_[pressure, shear], load
    )
    return {"ux": float(moved.real), "uy": float(moved.imag)}


def counted_twice(seat: Problem, resultants: Mapping[str, float]) -> dict[str, float]:
    """Less the displacement of a bush's bore over its outer rim, m, which pin and `seat` both have."""
    moved = moved_twice(seat) * complex(resultants["Q"], -resultants["P"])
    return {"ux": float(moved.real), "uy": float(moved.imag)}


@dataclass(frozen=True, eq=False)
class BushFit(ReadOnly):
    """The tractions between bush and plate in one state, and the pressure that the press fit must supply.

    The bush is bonded in the calculation. That holds where the pressure is positive all round, and the shear below
    friction times pressure.

    Attributes
    ----------
    theta : ndarray, shape (n,)
        Angles, rad.
    pressure : ndarray, shape (n,)
        Pressure between bush and plate, the press fit included, Pa; negative where the bond is in tension.
    shear : ndarray, shape (n,)
        Shear stress s_rtheta at the interface, Pa.
    press_fit_pressure : float
        The part of the press fit, Pa.
    friction : float or None
        Coefficient of friction between bush and plate.
    """

    theta: np.ndarray
    pressure: np.ndarray
    shear: np.ndarray
    press_fit_pressure: float
    friction: float | None

    @property
    def open_margin(self) -> float:
        """Smallest pressure, Pa. Below 0 the interface would open."""
        return float(self.pressure.min())

    @property
    def open_angle(self) -> float:
        """Place of the smallest pressure, rad."""
        return self._angle_of_least(self.pressure)

    @property
    def slip_margin(self) -> float:
        """Smallest pressure beyond \\|shear\\|/friction, Pa; NaN without friction. Below 0 the interface would slip."""
        return math.nan if self.friction is None else float(self._reserve(self.friction).min())

    @property
    def slip_angle(self) -> float:
        """Place where the interface is nearest to slip, rad; NaN without friction."""
        return math.nan if self.friction is None else self._angle_of_least(self._reserve(self.friction))

    @property
    def pressure_to_close(self) -> float:
        """Press-fit pressure that just keeps the interface closed, Pa."""
        return self.press_fit_pressure - self.open_margin

    @property
    def pressure_to_stick(self) -> float:
        """Press-fit pressure that just keeps the interface from slip, Pa; NaN without friction."""
        return self.press_fit_pressure - self.slip_margin

    @property
    def least_friction(self) -> float:
        """Coefficient of friction that just keeps the interface from slip; infinite if it opens."""
        if self.open_margin <= 0.0:
            return math.inf
        return float((np.abs(self.shear) / self.pressure).max())

    def _angle_of_least(self, values: np.ndarray) -> float:
        largest = float(self.pressure.max())  # a small difference of large pressures has their rounding
        return near_bottom(float(self.theta[top_angle(largest - values, self.theta)]))

    def _reserve(self, friction: float) -> np.ndarray:
        needed = np.abs(self.shear) / friction if friction > 0.0 else np.where(self.shear == 0.0, 0.0, math.inf)
        return self.pressure - needed


def bush_fit_of_nodes(
    problem: Problem, theta: np.ndarray, pressure: np.ndarray, shear: np.ndarray, friction: float | None
) -> BushFit:
    """The interface of a bush that slips, from the tractions at its nodes (n,); see :meth:`fastpin.State.bush_fit`."""
    bush = problem.plate_body.bush
    assert bush is not None
    chosen = bush.friction if friction is None else number("friction", friction, 0.0)
    return BushFit(theta, pressure, shear, problem.press_fit_pressure, chosen)


def bush_fit(problem: Problem, stress_at: Callable[[Points], Stress], friction: float | None) -> BushFit:
    """The interface of the bush; see :meth:`fastpin.State.bush_fit`.

    `stress_at` gives the stress in the plate, with straight lines between the nodes.
    """
    body = problem.plate_body.bush
    if body is None:
        raise InputError("plate_body", "the plate has no bush: there is no interface")
    chosen = body.friction if friction is None else number("friction", friction, 0.0)
    theta = -0.5 * math.pi + math.pi * (2.0 * np.arange(AROUND) / AROUND - 1.0)
    stress = stress_at(Points.at_radius(body.outer_radius, theta))
    return BushFit(theta, -stress.radial, stress.shear, problem.press_fit_pressure, chosen)
