"""Checks of stresses: hoop strains against slip, and the stresses of half-planes."""

from __future__ import annotations

import math

import numpy as np
from scipy.optimize import minimize_scalar

from fastpin import Points, Problem, State
from fastpin.model.angles import BOTTOM
from fastpin.model.points import Body
from fastpin.verification import closed_forms
from fastpin.verification.checks import BODIES
from fastpin.verification.finite_elements import FRETTING, LIKE
from fastpin.verification.rows import Checks, Solving, difference_check, relative_check


def strains(problem: Problem, half_arc: float, solving: Solving) -> Checks:
    """Hoop strains on the edges against gap and slip of the solver, for the worst state."""
    arc = (BOTTOM - half_arc, BOTTOM + half_arc)
    states = solving(problem, [*FRETTING, {"sxx": 0.2, "sxy": 0.1}], arc=arc)
    yield difference_check("slip", float(np.max([strain_slip_difference(state) for state in states])), "largest slip")


NARROW = 1e-3
"""Half-angle of the narrow contacts whose stresses are compared with the half-plane's, rad."""


NARROW_ARC = (BOTTOM - 1.2 * NARROW, BOTTOM + 1.2 * NARROW)


def hertz_stress(solving: Solving) -> Checks:
    """The largest shear below a contact without friction: at z/a = sqrt(g) with g = (sqrt(5) - 1)/2, z/a (1 - g) p0."""
    load_parameter, golden = 1.0 / (math.pi * NARROW**2), 0.5 * (math.sqrt(5.0) - 1.0)
    problem = Problem.from_load_parameter(LIKE, load_parameter, 0.0)
    (state,) = solving(problem, [{"P": 1.0}], arc=NARROW_ARC)
    peak = float(closed_forms.hertz_peak_pressure(load_parameter))
    for body in BODIES:

        def shear(depth: float, body: Body = body) -> float:
            stress = state.stress(Points.at_depth(NARROW * depth, BOTTOM), body)
            return -0.5 * float(np.hypot(stress.radial - stress.hoop, 2.0 * stress.shear)) / peak

        largest = minimize_scalar(shear, bounds=(0.5, 1.1), method="bounded", options={"xatol": 1e-6})
        yield relative_check("largest shear", -largest.fun, math.sqrt(golden) * (1.0 - golden), f"P, {body}")
        yield relative_check("its depth", largest.x, math.sqrt(golden), f"P, {body}")


def cattaneo_mindlin_stress(solving: Solving) -> Checks:
    """Stresses in partial slip below the surface, and the largest hoop stress on it, 2 p0 sqrt(mu Q/P)."""
    load_parameter, friction, ratio = 1.0 / (math.pi * NARROW**2), 0.5, 0.6
    problem = Problem.from_load_parameter(LIKE, load_parameter, friction, "centre", "fixed")
    history = [{"P": 1.0}, {"Q": ratio * friction}, {"Q": -ratio * friction}]
    _, first, back = solving(problem, history, arc=NARROW_ARC)
    peak = 2.0 * friction * math.sqrt(ratio) * float(closed_forms.hertz_peak_pressure(load_parameter))
    branches: tuple[tuple[str, State, float, closed_forms.Branch], ...] = (
        ("+Q", first, ratio, "loading"), ("-Q", back, -ratio, "unloading"),
    )  # fmt: skip
    for name, state, now, branch in branches:
        for body in BODIES:
            difference = half_plane_stress_difference(state, body, now, ratio, branch)
            yield difference_check("stresses", difference, "p0", f"{name}, {body}")
            largest = state.peak_hoop_stress(body)
            trailing = -1.0 if (now > 0.0) == (body == "plate") else 1.0
            yield relative_check("peak hoop stress", largest.value, peak, f"{name}, {body}")
            yield relative_check("its place", (largest.angle - BOTTOM) / NARROW, trailing, f"{name}, {body}")


def half_plane_stress_difference(
    state: State, body: Body, now: float, most: float, branch: closed_forms.Branch
) -> float:
    """Largest difference of a stress component from Cattaneo and Mindlin's half-plane, in parts of the peak pressure.

    The points lie up to two half-widths from the middle of the contact, at depths of 0.02 to 2 half-widths.

    Parameters
    ----------
    state : State
        See :func:`fastpin.verification.comparisons.cattaneo_mindlin`.
    body : {"plate", "pin"}
    now, most, branch
        See :func:`fastpin.verification.comparisons.cattaneo_mindlin`.
    """
    half = float(closed_forms.hertz_half_angle(state.problem.load_parameter(state.load["P"])))
    x, depth = np.linspace(-2.0, 2.0, 41), np.linspace(0.02, 2.0, 21)[:, None]
    stress = state.stress(Points.at_depth(half * depth, BOTTOM + half * x), body)
    # The pin pushes the plate along +x on the loading branch, and the plate pushes the pin along -x. The depth is
    # +r in the plate and -r in the pin: in the pin x and srt change their signs.
    side = 1.0 if body == "plate" else -1.0
    expected = closed_forms.cattaneo_mindlin_stress(
        side * x, depth, 1.0, 1.0, state.problem.uniform_friction, now, most, branch
    )
    peak = float(closed_forms.hertz_peak_pressure(state.problem.load_parameter(state.load["P"])))
    return float(np.abs(np.array([stress.hoop, stress.radial, stress.shear]) / peak - expected).max())


def strain_slip_difference(state: State) -> float:
    """Largest difference of the slip from the integral of the hoop strains along the nodes, over the largest slip.

    On the edge the hoop strain of a body is u_r + dv/dtheta for the displacements u_r and v. The rigid motion drops
    out. So the strains of plate less pin are the change of the gap less the derivative of the slip. The displacements
    have kernels of their own: the stresses are not used in the solver.

    Parameters
    ----------
    state : State
        Its pin first rested at the bottom of the hole, where slip and gap count from.
    """
    theta, clearance = state.theta, state.problem.assembled_clearance
    points, weights = np.polynomial.legendre.leggauss(4)
    steps = np.diff(theta)
    between = theta[:-1, None] + 0.5 * steps[:, None] * (points + 1.0)
    strains = _hoop_strain(state, "plate", between) - _hoop_strain(state, "pin", between)
    opened = np.interp(between, theta, state.gap) - clearance * (1.0 - np.cos(between - BOTTOM))
    slip = np.append(0.0, np.cumsum(0.5 * steps * ((opened - strains) @ weights)))
    return float(np.abs(slip - (state.slip - state.slip[0])).max() / np.abs(state.slip).max())


def _hoop_strain(state: State, body: Body, theta: np.ndarray) -> np.ndarray:
    pair = state.problem.surfaces
    material, kolosov = (pair.plate, pair.plate_kolosov) if body == "plate" else (pair.pin, pair.pin_kolosov)
    points = Points.at_depth(0.0, theta)
    stress = state.stress(points, body, straight=True)
    # the assembly is over before slip and gap count
    hoop = stress.hoop - (state.assembly_stress(points, body).hoop if state.problem.is_pressed else 0.0)
    return (hoop - 0.25 * (3.0 - kolosov) * (hoop + stress.radial)) / (2.0 * material.shear_modulus)
