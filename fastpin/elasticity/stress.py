"""Stresses inside pin and plate from the tractions between them.

With s = srr + stt and D = srr - i srt, the Cauchy integrals of the tractions give all stresses of a solid pin and an
infinite plate, (T30)-(T33). Other bodies add smooth fields, (T42)-(T47). Lengths are in units of the radius R, stresses
in the units of the tractions. Tension is positive.
"""

from __future__ import annotations

import math
from functools import lru_cache, partial

import numpy as np

from fastpin.bodies import harmonics
from fastpin.bodies.walls import PlateWalls, Wall
from fastpin.elasticity.tractions import CHUNK, Tractions, cauchy_integrals
from fastpin.kernels import fourier, laurent
from fastpin.model.laminate import Laminate
from fastpin.model.points import is_beyond_bush
from fastpin.model.problem import Problem
from fastpin.runtime.threads import in_chunks

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
    remote : ndarray, shape (4,)
        Remote stress (sxx, syy, sxy), or the own loads of a compliance, and the rise of the temperature.
    theta : ndarray, shape (m,)
        Angles of the points, rad.
    depth : ndarray, shape (m,)
        Distances of the points from the edge of the hole, in units of R; at least 0.
    """
    laminate = None if problem.pair.plate.is_isotropic else problem.joint.hole.laminate
    if laminate is not None and not laminate.is_quasi_isotropic:
        return laminate_stress(laminate, tractions, remote[:3], theta, depth)
    kolosov, none = problem.surfaces.plate_kolosov, np.zeros(3)
    far = remote[:3] if problem.plate_body.is_infinite else none
    if problem.plate_body.edge_only and not depth.any():
        found, of_order = hole_stress(kolosov, tractions, none, theta, depth), partial(traction_harmonics, tractions)
        problem.plate_body.add_edge_hoop(found[1], problem.joint.hole, of_order, remote.tolist(), theta)
        return found
    walls = plate_walls(problem, tractions, tuple(float(value) for value in remote))
    if walls is None or walls.lug is None:
        found = hole_stress(kolosov, tractions, far, theta, depth)
        return found if walls is None else found + polar(walls.surface, theta, 1.0 + depth)
    found, beyond = np.empty((3, theta.size)), is_beyond_bush(problem, depth)
    inside = ~beyond
    found[:, inside] = hole_stress(kolosov, tractions, none, theta[inside], depth[inside])
    found[:, inside] += polar(walls.surface, theta[inside], 1.0 + depth[inside])
    below = 1.0 + depth[beyond] - problem.joint.seat_ratio
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
    assert walls is not None
    assert walls.lug is not None
    below = depth / joint.seat_ratio
    found = polar(walls.lug, theta, 1.0 + below)
    if joint.plate_body.lug.is_infinite:
        found += hole_stress(joint.pair.plate_kolosov, Tractions(()), remote[:3], theta, below)
    return found


def hole_stress(
    kolosov: float, tractions: Tractions, remote: np.ndarray, theta: np.ndarray, depth: np.ndarray
) -> np.ndarray:
    """Stresses (srr, stt, srt) in an infinite plate, shape (3, m). The force is balanced far away.

    Parameters
    ----------
    kolosov : float
        Kolosov's constant of the plate.
    tractions, theta, depth
        See :func:`plate_stress`.
    remote : ndarray, shape (3,)
        Remote stress (sxx, syy, sxy).
    """
    (pressure, shear), (sxx, syy, sxy), force = tractions.low_coefficients, remote.tolist(), tractions.force
    share = kolosov / (2.0 * math.pi * (1.0 + kolosov))
    if not depth.any():  # the tractions are the stresses on the edge, and Re C[N] follows from N
        mean, pull = 2.0 * float(pressure[0].real) + (sxx + syy), 4.0 * share * force
        return tractions.on_edge(theta, mean, -1.0, 4.0, pull.real, pull.imag, -2.0 * (sxx - syy), -4.0 * sxy)
    away = np.log1p(depth)
    whole, of_shear, slope = cauchy_integrals(tractions, theta, away, outside=True).T
    zeta, square = np.exp(away + 1j * theta), (1.0 + depth) ** -2.0  # square: (R/r)^2
    below = depth * (2.0 + depth) * square  # 1 - (R/r)^2
    mean = 4.0 * np.real(whole + share * force / zeta)
    radial = 2.0 * np.real(whole) - below * (slope - 2.0 * share * force / zeta)
    radial = radial + square * (2j * of_shear - np.conj(pressure[0] - 1j * shear[0]))
    srr, srt = np.real(radial), -np.imag(radial)
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
        found += polar(wall, theta, np.maximum(1.0 - depth, wall.smallest))
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
    force = tractions.force
    share = 1.0 / (math.pi * (1.0 + kolosov)) if pin_load == "centre" else 0.0
    if not depth.any():  # as in the hole
        pull = 2.0 * share * force
        return tractions.on_edge(theta, 0.0, -1.0, -4.0, pull.real, pull.imag, 0.0, 0.0)
    radius = 1.0 - depth
    near = radius < 0.5
    pressure, shear = tractions.coefficients(SERIES) if near.any() else tractions.low_coefficients
    zeta = radius * np.exp(1j * theta)
    if not tractions.has_moment:
        shear = np.r_[0.0, shear[1:]]
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


def bush_stress(
    problem: Problem, of_pin: Tractions, of_seat: Tractions, theta: np.ndarray, depth: np.ndarray
) -> np.ndarray:
    """Stresses (srr, stt, srt) in a bush that slips in its seat, shape (3, m), from the tractions on both of its rims.

    The bush under the tractions of the pin, which leave by a uniform traction on its outer rim, is a ring. Under the
    tractions of the seat, which enter by a uniform traction at its bore, it is a tube. The sum of both fields has the
    two uniform tractions too many. So the field of a bush that these alone load is taken away.

    Parameters
    ----------
    problem : Problem
    of_pin, of_seat : Tractions
        Tractions on the bore and in the seat.
    theta, depth : ndarray, shape (m,)
        Angles of the points, rad, and their distances from the bore, in units of R.
    """
    pin, seat = problem.interfaces
    outer = seat.hole_radius / pin.hole_radius
    found = plate_stress(pin, of_pin, np.zeros(3), theta, depth)
    found += pin_stress(seat, of_seat, theta, np.clip((outer - 1.0 - depth) / outer, 0.0, None))
    t, radius = traction_harmonics(of_pin, 1), 1.0 + depth
    force, amplitudes = t[1, 1], harmonics.first(outer, pin.surfaces.plate_kolosov, "uniform")
    A, D, L = (each[1] * force for each in (amplitudes.A, amplitudes.D, amplitudes.L))
    z = radius * np.exp(1j * theta)
    both = 4.0 * np.real(2.0 * A * z - np.conj(L) / z)
    forward = 2.0 * (A * radius + D * radius**-3.0 - L / radius)
    traction = forward * np.exp(1j * theta) + np.conj(force) / radius * np.exp(-1j * theta)
    radial = traction.real
    found -= np.array([radial, both - radial, traction.imag + t[0, 0].imag / radius**2])
    return found


# -- the smooth fields of bodies ------------------------------------------------------------------------------


@lru_cache(maxsize=80)  # the readings of a state ask for the same ones
def traction_harmonics(tractions: Tractions, highest: int) -> np.ndarray:
    """Harmonics (t_n, conj t_-n) of t = s_rr + i s_rtheta on the contact rim, n = 0 to `highest`; (highest + 1, 2)."""
    found = np.zeros((highest + 1, 2), dtype=complex)
    for patch in tractions.patches:
        theta, steps = patch[:, 0], np.diff(patch[:, 0])
        left, right = np.r_[0.0, steps], np.r_[steps, 0.0]
        for begin in range(0, highest + 1, fourier.BLOCK):
            order = np.arange(begin, min(begin + fourier.BLOCK, highest + 1), dtype=float)
            pressure, shear = fourier.hat_coefficients(order, theta, left, right, patch[:, 1:]).T
            found[begin : begin + order.size] -= np.array([pressure - 1j * shear, pressure + 1j * shear]).T
    return found / (2.0 * math.pi)


@lru_cache(maxsize=80)  # the readings of a state ask for the same ones
def pin_wall(problem: Problem, tractions: Tractions) -> Wall | None:
    """The field of a hollow pin beyond that of a solid pin under a force at its centre; None for a solid pin."""
    return problem.pin_body.wall(problem.joint.pin_rim, partial(traction_harmonics, tractions))


@lru_cache(maxsize=80)  # the readings of a state ask for the same ones
def plate_walls(problem: Problem, tractions: Tractions, remote: tuple[float, ...]) -> PlateWalls | None:
    """The smooth fields of a plate under tractions and loads of its own; None for an infinite plate."""
    return problem.plate_body.walls(problem.joint.hole, partial(traction_harmonics, tractions), remote)


def polar(wall: Wall, theta: np.ndarray, radius: np.ndarray) -> np.ndarray:
    """Stresses (srr, stt, srt) of a field, shape (3, m), at the angles `theta` and radii `radius`, both (m,)."""
    found = np.zeros((theta.size, 2), dtype=complex)

    def compute(part: slice) -> None:
        series = wall.growing, wall.decaying, wall.smallest, wall.largest
        laurent.add_polar(theta[part], radius[part], *series, found[part])
        for other in wall.others:
            mean, first = other(radius[part] * np.exp(1j * theta[part]))
            found[part, 0] += mean
            found[part, 1] += first

    in_chunks(theta.size, CHUNK, compute)
    mean, radial = found[:, 0].real, found[:, 1].real
    return np.array([radial, mean - radial, -found[:, 1].imag])


def laminate_stress(
    laminate: Laminate, tractions: Tractions, remote: np.ndarray, theta: np.ndarray, depth: np.ndarray
) -> np.ndarray:
    """Stresses (srr, stt, srt) in an infinite plate of a laminate, shape (3, m); (T54)-(T56).

    They are means through the thickness. The force is balanced far away. The plane is mapped twice, z_k = x + mu_k y
    with the roots mu_k of the material, and the hole of each plane on the circle |zeta_k| = 1. There the potentials are
    Cauchy integrals of the tractions. The arguments are those of :func:`plate_stress`.
    """
    roots = _apart(*laminate.roots)
    (a11, a12, a16), (_, a22, a26), _ = laminate.matrix
    mu = np.array(roots)  # stress functions are 2 Re(B f), displacements 2 Re(A f), with the matrices B and A
    forces, moves = np.array([-mu, np.ones(2)]), np.array([a11 * mu * mu + a12 - a16 * mu, a12 * mu + a22 / mu - a26])
    inverse = np.linalg.inv(forces)
    whole = np.block([[forces.real, -forces.imag], [moves.real, -moves.imag]])  # 2 Re(B c) = 1, Re(A c) = 0
    solved = np.linalg.solve(2.0 * whole, np.eye(4)[:, :2])
    share = solved[:2] + 1j * solved[2:]
    (pressure, shear), (sxx, syy, sxy) = tractions.low_coefficients, remote
    complex_force = 2.0 * math.pi * np.conj(pressure[1] + 1j * shear[1])  # int (N - iT) exp(i xi) dxi
    force = share @ np.array([complex_force.real, complex_force.imag]) / (2j * math.pi)
    open_hole = -0.5 * np.array([complex(sxx, sxy), complex(sxy, syy)])  # of the tractions that free the hole, zeta C
    s_x, s_y, s_xy = (np.full(theta.size, value) for value in (sxx, syy, sxy))
    for k, root in enumerate(roots):
        log = np.log1p(_beyond_edge(root, theta, depth))
        away, angle = np.maximum(log.real, 0.0), theta + log.imag
        zeta = np.exp(away + 1j * angle)
        both = _cauchy_xy(tractions, angle, away, zeta) + open_hole[:, None] / zeta
        slope = 1j * (inverse[k] @ both) + force[k]  # zeta_k f_k'
        slope /= 0.5 * ((1.0 - 1j * root) * zeta - (1.0 + 1j * root) / zeta)
        s_x += 2.0 * np.real(root * root * slope)
        s_y += 2.0 * np.real(slope)
        s_xy -= 2.0 * np.real(root * slope)
    cos, sin = np.cos(2.0 * theta), np.sin(2.0 * theta)
    mean, half = 0.5 * (s_x + s_y), 0.5 * (s_x - s_y)
    turned = half * cos + s_xy * sin
    return np.array([mean + turned, mean - turned, s_xy * cos - half * sin])


def _apart(one: complex, two: complex) -> tuple[complex, complex]:
    """The two roots, spread if they are equal.

    The error of the stress is the square of the spread, and the error 1e-11 of the Cauchy integrals over the spread.
    """
    spread = 2e-4
    if abs(one - two) >= spread * abs(one):
        return one, two
    middle, half = 0.5 * (one + two), 0.5 * spread
    return middle * (1.0 - half), middle * (1.0 + half)


def _beyond_edge(root: complex, theta: np.ndarray, depth: np.ndarray) -> np.ndarray:
    """zeta_k exp(-i theta) - 1 of points at these depths, without cancellation near the edge; shape (m,)."""
    turn = np.exp(1j * theta)
    a, b = (1.0 - 1j * root) * turn, (1.0 + 1j * root) / turn
    q = a * (1.0 - depth) - b * (1.0 + depth)
    width = np.sqrt(q * q + 4.0 * a * depth * (a + b))
    near = 2.0 * depth * (a + b) / np.where(np.abs(q + width) >= np.abs(q - width), q + width, q - width)
    far = b / a / (1.0 + near) - 1.0  # the other solution of the map, of which one lies outside the circle
    return np.where(np.abs(1.0 + near) >= np.abs(1.0 + far), near, far)


def _cauchy_xy(tractions: Tractions, angle: np.ndarray, away: np.ndarray, zeta: np.ndarray) -> np.ndarray:
    """The Cauchy integrals of the tractions on the plate along x and y, complex, shape (2, m)."""
    whole, of_shear, _ = cauchy_integrals(tractions, angle, away, outside=True).T
    pressure, shear = tractions.low_coefficients
    mirrored = whole + 2j * of_shear  # of N + iT
    plus = np.conj(pressure[1] + 1j * shear[1]) + zeta * whole
    minus = (mirrored - (pressure[0] + 1j * shear[0])) / zeta
    return np.array([0.5 * (plus + minus), -0.5j * (plus - minus)])
