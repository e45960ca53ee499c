"""Checks of a pin in the hole of a laminate.

The finite-element models have a steel pin in plane strain under a body force, L_p = 0.1, in a plate out to 300 R, with
960 nodes round the hole; 1,440 with fibres along the load and friction.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial

import numpy as np

from fastpin import MATERIALS, Grid, Material, MaterialPair, Problem
from fastpin.model import Laminate
from fastpin.model.laminate import in_axes
from fastpin.verification.joint_rows import MODULI
from fastpin.verification.rows import Checks, Solving, difference_check, relative_check

ELEMENTS = {
    "[0] along P, mu = 0": ((0.0,), 90.0, 0.0, 1.060431),
    "[0] along P, mu = 0.4": ((0.0,), 90.0, 0.4, 0.651647),
    "[0] across P, mu = 0": ((0.0,), 0.0, 0.0, 0.618067),
    "[0] across P, mu = 0.2": ((0.0,), 0.0, 0.2, 0.534875),
    "[0/30], mu = 0": ((0.0, 30.0), 90.0, 0.0, 0.983950),
    "[0/30], mu = 0.3": ((0.0, 30.0), 90.0, 0.3, 0.724633),
}
"""Ply angles and axis, deg; friction; and the peak pressure of finite elements, F/R."""

CIRCLE = Grid.circle(400)
"""Nodes of the fits that stick all round."""

INTERFERENCE = -0.3
"""Load parameter of these fits."""

STICKS = 1.2
"""Friction at which these fits stick all round. Slip has one solution up to 1.5."""

COLLOCATED = 128
"""Points of the Fourier collocation."""


def laminate(angles: tuple[float, ...], axis: float) -> Laminate:
    """A stack of equal plies with these angles; `axis` is the direction of axis 1, deg from +x."""
    E1, E2, G12, nu12 = MODULI
    ply = np.array([[1.0 / E1, -nu12 / E1, 0.0], [-nu12 / E1, 1.0 / E2, 0.0], [0.0, 0.0, 1.0 / G12]])
    stiffness = [np.linalg.inv(in_axes(ply, -math.radians(angle))) for angle in angles]
    (a11, a12, a16), (_, a22, a26), (_, _, a66) = np.linalg.inv(np.mean(stiffness, axis=0))
    return Laminate(compliance=(a11, a12, a22, a16, a26, a66), axis=math.radians(axis))


def finite_elements(name: str, solving: Solving) -> Checks:
    """The peak pressure of a finite-element model."""
    angles, axis, friction, peak = ELEMENTS[name]
    pair = MaterialPair(MATERIALS["steel"], laminate(angles, axis), "strain")
    (state,) = solving(Problem.from_load_parameter(pair, 0.1, friction, "body"), [{"P": 1.0}])
    yield relative_check("peak N", state.peak_pressure, peak)


def stuck(stress: float, solving: Solving) -> Checks:
    """An interference fit that sticks all round, and then under a remote stress: the pin is in uniform stress."""
    pair = MaterialPair(MATERIALS["steel"], laminate((0.0, 30.0), 40.0), "stress")
    problem = Problem.from_load_parameter(pair, INTERFERENCE, STICKS)
    remote = np.array([[0.3, 0.2], [0.2, -0.4]]) * stress
    load = {"sxx": remote[0, 0], "syy": remote[1, 1], "sxy": remote[0, 1]}
    state = solving(problem, [load], grid=CIRCLE)[-1]
    traction = _stuck_pin(problem) + _stuck_pin(problem, remote)
    turn = np.exp(1j * CIRCLE.theta)
    normal = np.array([turn.real, turn.imag])
    pressed = traction @ normal  # on the plate
    differences = np.array([state.pressure - (normal * pressed).sum(axis=0)])
    differences = np.append(differences, state.shear + (np.array([-turn.imag, turn.real]) * pressed).sum(axis=0))
    yield difference_check("N, T", float(np.abs(differences).max()) / state.peak_pressure, "peak N")


def _stuck_pin(problem: Problem, remote: np.ndarray | None = None) -> np.ndarray:
    """The tensor M of the tractions M e_r on the plate, without remote stress, or the part that a `remote` one adds.

    It solves Lambda M + s J M J + [M - (3 - kappa)/4 tr M]/2G + W = (delta_R/R) I + omega J. kappa and G are those of
    the pin, W belongs to the remote stress, and the interference delta_R to the other part.
    """
    plate, pair, turn = problem.joint.hole.laminate, problem.pair, np.array([[0.0, -1.0], [1.0, 0.0]])
    assert plate is not None
    plate_tensor, s, share = plate.edge_tensor, plate.s, 0.25 * (3.0 - pair.pin_kolosov)

    def moved(stress: np.ndarray) -> np.ndarray:
        own = 0.5 * pair.pin_compliance * (stress - share * np.trace(stress) * np.eye(2))
        return np.asarray(plate_tensor @ stress + s * turn @ stress @ turn + own)

    units = [np.array([[1.0, 0.0], [0.0, 0.0]]), np.array([[0.0, 0.0], [0.0, 1.0]]), np.array([[0.0, 1.0], [1.0, 0.0]])]
    right = -problem.clearance / problem.hole_radius * np.eye(2)
    if remote is not None:
        mean, oval = plate.hole_displacement((remote[0, 0], remote[1, 1], remote[0, 1]))
        right = -np.array([[(mean + oval).real, (oval - mean).imag], [(oval + mean).imag, (mean - oval).real]])
    matrix = np.column_stack([*(moved(unit).ravel() for unit in units), -turn.ravel()])
    found = np.linalg.solve(matrix, right.ravel())
    return np.asarray(sum(share_ * unit for share_, unit in zip(found, units, strict=False)))


def rigid_force(solving: Solving) -> Checks:
    """A force on a rigid pin that sticks all round adds the uniform vector F/2 pi R to the tractions."""
    pair = MaterialPair(Material.rigid(), laminate((0.0, 30.0), 40.0), "stress")
    problem = Problem.from_load_parameter(pair, INTERFERENCE, STICKS)
    before, after = solving(problem, [{}, {"P": 0.3, "Q": 0.1}], grid=CIRCLE)
    added = complex(0.1, -0.3) / (2.0 * math.pi) * np.exp(-1j * CIRCLE.theta)
    found = after.pressure - before.pressure - 1j * (after.shear - before.shear)
    yield difference_check("N, T", float(np.abs(found - added).max()) / after.peak_pressure, "peak N")


def frictionless(solving: Solving) -> Checks:
    """A rigid pin in an interference fit without friction: the pressure by Fourier collocation of (T49)."""
    plate = laminate((0.0, 0.0, 45.0, -45.0), math.degrees(0.5))
    problem = Problem.from_load_parameter(MaterialPair(Material.rigid(), plate, "stress"), INTERFERENCE, 0.0)
    for load in (0.0, 0.5):
        (state,) = solving(problem, [{"P": load}], grid=CIRCLE)
        pressure = _collocated(problem, load)
        yield relative_check("peak N", float(state.pressure.max()), float(pressure.max()), f"P = {load:g}")
        yield relative_check("least N", float(state.pressure.min()), float(pressure.min()), f"P = {load:g}")


def _collocated(problem: Problem, load: float) -> np.ndarray:
    """The pressure (k,) of a rigid pin in an interference fit under a load P, at equally spaced points."""
    plate, n = problem.joint.hole.laminate, COLLOCATED
    assert plate is not None
    theta, order = 2.0 * math.pi * np.arange(n) / n, np.fft.fftfreq(n, 1.0 / n)
    normal = np.array([np.cos(theta), np.sin(theta)])
    # the displacement (T49) of t_n exp(i n theta) is (Lambda/|n| + i s sign(n) J) t_n R; none of n = 0
    size = np.divide(1.0, np.abs(order), where=order != 0.0, out=np.zeros(n))
    turn = np.array([[0.0, -1.0], [1.0, 0.0]])
    response = plate.edge_tensor[:, :, None] * size + 1j * plate.s * turn[:, :, None] * (np.sign(order) * size)
    spectra = np.fft.fft(np.eye(n)[:, None, :] * normal[None].transpose(1, 2, 0).reshape(1, 2, n), axis=-1)
    moved = np.fft.ifft(np.einsum("abk,jbk->jak", response, spectra), axis=-1).real
    radial = (moved * normal[None]).sum(axis=1).T
    weight = 2.0 * math.pi / n
    matrix = np.block([[radial, -normal.T], [weight * normal, np.zeros((2, 2))]])
    right = np.concatenate([np.full(n, -problem.clearance / problem.hole_radius), [0.0, -load]])
    return np.asarray(np.linalg.solve(matrix, right)[:n])


CASES: dict[str, Callable[[Solving], Checks]] = {
    "stuck": partial(stuck, 0.0),
    "stuck, remote stress": partial(stuck, 1.0),
    "stuck, force": rigid_force,
    "frictionless": frictionless,
}
"""The cases with exact references."""
