"""Stresses inside pin and plate from the tractions between them.

With s = srr + stt and D = srr - i srt, the Cauchy integrals of the tractions give all stresses of a solid pin and an
infinite plate, (T30)-(T33). Other bodies add smooth fields, (T42)-(T47). Lengths are in units of the radius R, stresses
in the units of the tractions. Tension is positive.
"""

from __future__ import annotations

import math

import numpy as np

from fastpin.elasticity import bodies
from fastpin.elasticity.tractions import Tractions, cauchy_integrals
from fastpin.elasticity.walls import LEAST_BORE, pin_wall, plate_walls, traction_harmonics
from fastpin.model.bodies import Plate
from fastpin.model.compliance import Compliance
from fastpin.model.loads import LOADS, REMOTE
from fastpin.model.points import ROUNDING, Body
from fastpin.model.problem import Problem

SERIES = 50
"""Terms of the series about the pin's centre. It is used where r < R/2."""


def plate_stress(
    problem: Problem, tractions: Tractions, remote: np.ndarray, theta: np.ndarray, depth: np.ndarray
) -> np.ndarray:
    """Stresses (srr, stt, srt) in the plate, shape (3, m). The press fit of a bush is included.

    Parameters
    ----------
    problem : Problem
    tractions : Tractions
    remote : ndarray, shape (3,)
        Remote stress (sxx, syy, sxy); the own loads of a compliance.
    theta : ndarray, shape (m,)
        Angles of the points, rad.
    depth : ndarray, shape (m,)
        Distances of the points from the edge of the hole, in units of R; at least 0. All are 0 for a compliance.
    """
    kolosov, none = problem.surfaces.plate_kolosov, np.zeros(3)
    far = remote if isinstance(problem.plate_body, Plate) else none
    walls = plate_walls(problem, tractions, tuple(float(value) for value in remote))
    if walls is None or walls.lug is None:
        found = hole_stress(kolosov, tractions, far, theta, depth)
        if walls is not None:
            found += walls.surface.polar(theta, 1.0 + depth)
        elif isinstance(problem.plate_body, Compliance):
            found[1] += _compliance_hoop(problem.plate_body, kolosov, tractions, remote, theta)
        return found
    found, beyond = np.empty((3, theta.size)), is_beyond_bush(problem, depth)
    inside = ~beyond
    found[:, inside] = hole_stress(kolosov, tractions, none, theta[inside], depth[inside])
    found[:, inside] += walls.surface.polar(theta[inside], 1.0 + depth[inside])
    below = 1.0 + depth[beyond] - (problem.joint.bush or 1.0)
    found[:, beyond] = seat_stress(problem, tractions, remote, theta[beyond], below)
    return found


def seat_stress(
    problem: Problem, tractions: Tractions, remote: np.ndarray, theta: np.ndarray, depth: np.ndarray
) -> np.ndarray:
    """Stresses (srr, stt, srt) in the plate round a bush, shape (3, m). The press fit is included.

    Parameters
    ----------
    problem, tractions, remote, theta
        See :func:`plate_stress`.
    depth : ndarray, shape (m,)
        Distances of the points from the seat of the bush, in units of R; at least 0.
    """
    joint, walls = problem.joint, plate_walls(problem, tractions, tuple(float(value) for value in remote))
    assert joint.bush is not None
    assert walls is not None
    assert walls.lug is not None
    below = depth / joint.bush
    found = walls.lug.polar(theta, 1.0 + below)
    if isinstance(joint.lug, Plate):
        found += hole_stress(joint.pair.plate_kolosov, Tractions(()), remote, theta, below)
    return found


def is_beyond_bush(problem: Problem, depth: np.ndarray) -> np.ndarray:
    """Whether points of the plate at these depths, in units of R, lie beyond the bush; False without a bush."""
    bush = problem.joint.bush
    return np.zeros(depth.shape, dtype=bool) if bush is None else 1.0 + depth > bush * (1.0 + ROUNDING)


def press_fit_hoop(problem: Problem, body: Body = "plate") -> float:
    """Hoop stress that the press fit of a bush leaves on the edge of "plate" or "seat"; 0 without a bush.

    It is in the unit of the press fit's pressure.
    """
    bush, pressure = problem.joint.bush, problem.press_fit_pressure
    if bush is None or pressure == 0.0:
        return 0.0
    if body == "seat":
        return float(seat_stress(problem, Tractions(()), np.zeros(3), np.zeros(1), np.zeros(1))[1, 0])
    return -2.0 * pressure / ((1.0 - 1.0 / bush) * (1.0 + 1.0 / bush))


def _compliance_hoop(
    body: Compliance, kolosov: float, tractions: Tractions, remote: np.ndarray, theta: np.ndarray
) -> np.ndarray:
    """Hoop stress on the edge of the hole, shape (m,), beyond that of the infinite plate, (T48)."""
    t = traction_harmonics(tractions, body.order)
    moved = body.matrix @ bodies.plate_coefficients(-(t[:, 0] + t[:, 1]), -1j * (t[:, 0] - t[:, 1]))
    for place, value in zip(REMOTE, remote, strict=True):
        moved = moved + value * body.columns_of(LOADS[place])
    order = np.arange(-body.order, body.order + 1.0)
    waves = np.exp(1j * np.multiply.outer(theta, order))
    hoop: np.ndarray = 8.0 / (kolosov + 1.0) * np.real(waves @ ((1.0 + order) * bodies.complex_coefficients(moved)))
    return hoop


def hole_stress(
    kolosov: float, tractions: Tractions, remote: np.ndarray, theta: np.ndarray, depth: np.ndarray
) -> np.ndarray:
    """Stresses (srr, stt, srt) in an infinite plate, shape (3, m). The force is balanced far away.

    Parameters
    ----------
    kolosov : float
        Kolosov's constant of the plate.
    tractions, remote, theta, depth
        See :func:`plate_stress`.
    """
    (pressure, shear), away = tractions.low_coefficients, np.log1p(depth)
    whole, of_shear, slope = cauchy_integrals(tractions, theta, away, outside=True).T
    zeta, square = np.exp(away + 1j * theta), (1.0 + depth) ** -2.0  # square: (R/r)^2
    below = depth * (2.0 + depth) * square  # 1 - (R/r)^2
    force = 2.0 * math.pi * np.conj(pressure[1] + 1j * shear[1])  # int (N - iT) exp(i xi) dxi
    share = kolosov / (2.0 * math.pi * (1.0 + kolosov))
    mean = 4.0 * np.real(whole + share * force / zeta)
    radial = 2.0 * np.real(whole) - below * (slope - 2.0 * share * force / zeta)
    radial = radial + square * (2j * of_shear - np.conj(pressure[0] - 1j * shear[0]))
    srr, srt = np.real(radial), -np.imag(radial)
    sxx, syy, sxy = remote
    cos, sin = np.cos(2.0 * theta), np.sin(2.0 * theta)
    along, across = (sxx - syy) * cos + 2.0 * sxy * sin, (sxx - syy) * sin - 2.0 * sxy * cos
    mean = mean + (sxx + syy) - 2.0 * square * along
    srr = srr + 0.5 * below * ((sxx + syy) + (1.0 - 3.0 * square) * along)
    srt = srt - 0.5 * below * (1.0 + 3.0 * square) * across
    return np.array([srr, mean - srr, srt])


def pin_stress(problem: Problem, tractions: Tractions, theta: np.ndarray, depth: np.ndarray) -> np.ndarray:
    """Stresses (srr, stt, srt) in the pin, shape (3, m).

    In a solid pin a moment acts at the centre, and so does the force if ``pin_load`` is "centre": there the stress is
    infinite.

    Parameters
    ----------
    problem : Problem
    tractions : Tractions
    theta : ndarray, shape (m,)
        Angles of the points, rad.
    depth : ndarray, shape (m,)
        Distances of the points from the edge of the pin, in units of R; 0 to less than 1.
    """
    found = disk_stress(problem.surfaces.pin_kolosov, problem.pin_load, tractions, theta, depth)
    wall = pin_wall(problem, tractions)
    if wall is not None:
        found += wall.polar(theta, np.maximum(1.0 - depth, max(problem.joint.bore, LEAST_BORE)))
    return found


def disk_stress(
    kolosov: float, pin_load: str, tractions: Tractions, theta: np.ndarray, depth: np.ndarray
) -> np.ndarray:
    """Stresses (srr, stt, srt) in a solid pin, shape (3, m).

    Parameters
    ----------
    kolosov : float
        Kolosov's constant of the pin.
    pin_load : {"centre", "body"}
    tractions, theta, depth
        See :func:`pin_stress`.
    """
    radius = 1.0 - depth
    near = radius < 0.5
    pressure, shear = tractions.coefficients(SERIES) if near.any() else tractions.low_coefficients
    if not tractions.has_moment:
        shear = np.r_[0.0, shear[1:]]
    zeta = radius * np.exp(1j * theta)
    force = 2.0 * math.pi * np.conj(pressure[1] + 1j * shear[1])
    whole, first = np.empty(theta.size, dtype=complex), np.empty(theta.size, dtype=complex)
    if near.any():
        whole[near], first[near] = _near_centre(pressure, shear, zeta[near])
    edge = ~near
    whole[edge], of_shear, slope = cauchy_integrals(tractions, theta[edge], -np.log1p(-depth[edge]), outside=False).T
    square = radius[edge] ** -2.0
    below = -depth[edge] * (2.0 - depth[edge]) * square
    first[edge] = below * slope - square * (2j * of_shear - 1j * shear[0])
    mean = -4.0 * np.real(whole) + 2.0 * pressure[0].real
    radial = -2.0 * np.real(whole) + pressure[0].real + first
    if pin_load == "centre":
        share = 1.0 / (math.pi * (1.0 + kolosov))
        mean = mean + 4.0 * share * np.real(np.conj(force) * zeta - 0.5 * force / zeta)
        radial = radial + share * force * (np.conj(zeta) - 1.0 / zeta)
        radial[near] -= np.conj(force) / (2.0 * math.pi * np.conj(zeta[near]))
    else:
        radial[near] -= np.conj(force) * zeta[near] / (2.0 * math.pi)
        outer = zeta[edge]
        radial[edge] += np.conj(force) / (2.0 * math.pi) * (1.0 / np.conj(outer) - outer)
    srr = np.real(radial)
    return np.array([srr, mean - srr, -np.imag(radial)])


def _near_centre(pressure: np.ndarray, shear: np.ndarray, zeta: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """C[p] and the terms of D beside C[p] near the pin's centre, by their Taylor series (T33)."""
    both, order = pressure - 1j * shear, np.arange(SERIES + 1)
    whole, slope = _sum(both, zeta), _sum(order * both, zeta)
    turn = np.divide(zeta, np.conj(zeta), out=np.ones_like(zeta), where=zeta != 0.0)
    rest = _sum((order * both + 2j * shear)[2:], zeta) * turn
    moment = 1j * shear[0] / np.abs(zeta) ** 2.0 if shear[0] != 0.0 else 0.0
    return whole, slope - moment - rest


def _sum(coefficients: np.ndarray, zeta: np.ndarray) -> np.ndarray:
    """The power series with these coefficients at the points zeta."""
    return np.polynomial.polynomial.polyval(zeta, coefficients)
