"""The displacement of the pin over the far side of the plate, and the interface of a bush."""

from __future__ import annotations

import math

import numpy as np

from fastpin.elasticity.bodies import basis, translation_rows
from fastpin.errors import InputError
from fastpin.model.bodies import Bushing, Ring, Tube
from fastpin.model.checks import number
from fastpin.model.compliance import Compliance
from fastpin.model.loads import LOADS
from fastpin.model.points import Points
from fastpin.model.problem import LEAST_HUB, MOST_GAUGE, Problem
from fastpin.reading.bush import BushFit
from fastpin.states.state import State

AROUND = 1440
"""Equally spaced angles of the interface of a bush. Its tractions are smooth: the contact is a wall away."""


def joint_displacement(state: State, hub_radius: float | None, gauge_radius: float | None) -> dict[str, float]:
    """The displacement of the joint, "ux" and "uy" in m; see :meth:`fastpin.State.joint_displacement`."""
    problem = state.problem
    radius, hub, gauge = problem.hole_radius, None, None
    if hub_radius is not None:
        hub = _checked_hub(problem, hub_radius) / radius
    if gauge_radius is not None:
        gauge = _checked_gauge(problem, gauge_radius) / radius
    own, coupling = problem.joint.displacement_compliances(hub, gauge)
    unit = problem.surfaces.beta_star
    (cos, sin), force = state.grid.trig_moments(), state.resultants
    first = complex(cos @ state.pressure - sin @ state.shear, sin @ state.pressure + cos @ state.shear)
    moved = complex(state.dx, state.dy) + unit * own * complex(force["Q"], -force["P"])
    moved -= unit * coupling * radius * first
    if isinstance(problem.plate_body, Compliance):
        moved += _over_supports(state, problem.plate_body)
    return {"ux": float(moved.real), "uy": float(moved.imag)}


def _over_supports(state: State, body: Compliance) -> complex:
    """Mean displacement of the hole over the supports of a compliance, m."""
    tractions = basis(body.matrix, state.grid)[1] @ np.r_[state.pressure, state.shear]
    displacement = body.matrix @ tractions
    for name in set(body.columns) & set(LOADS):
        displacement = displacement + state.load[name] * body.columns[name]
    x, y = (
        math.sqrt(0.5)
        * state.problem.hole_radius
        * state.problem.pair.plate_compliance
        * (translation_rows(body) @ displacement)
    )
    return complex(x, y)


def _checked_hub(problem: Problem, hub_radius: float) -> float:
    """A radius in the pin, m."""
    if isinstance(problem.pin_body, Tube):
        return number("hub_radius", hub_radius, problem.pin_body.bore_radius, problem.hole_radius)
    if problem.pin_load == "body":
        raise InputError("hub_radius", "the displacement of a body-loaded pin is its mean: leave the hub out")
    return number("hub_radius", hub_radius, LEAST_HUB * problem.hole_radius, problem.hole_radius)


def _checked_gauge(problem: Problem, gauge_radius: float) -> float:
    """A radius in the plate, m."""
    lug = problem.joint.lug
    if isinstance(lug, Compliance):
        raise InputError("gauge_radius", "a compliance knows the edge of the hole only: leave the gauge out")
    most = lug.outer_radius if isinstance(lug, Ring) else MOST_GAUGE * problem.hole_radius
    return number("gauge_radius", gauge_radius, problem.hole_radius, most)


def bush_fit(state: State, friction: float | None) -> BushFit:
    """The interface of the bush; see :meth:`fastpin.State.bush_fit`."""
    body = state.problem.plate_body
    if not isinstance(body, Bushing):
        raise InputError("plate_body", "the plate has no bush: there is no interface")
    if friction is not None:
        friction = number("friction", friction, 0.0)
    theta = -0.5 * math.pi + math.pi * (2.0 * np.arange(AROUND) / AROUND - 1.0)
    stress = state.stress(Points.at_radius(body.outer_radius, theta), straight=True)
    chosen = body.friction if friction is None else friction
    return BushFit(theta, -stress.radial, stress.shear, state.problem.press_fit_pressure, chosen)
