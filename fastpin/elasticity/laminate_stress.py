"""Stresses in a laminate with a hole, from the tractions on the hole and a remote stress; (T54)-(T56).

The plane is mapped twice, z_k = x + mu_k y with the roots mu_k of the material, and the hole of each plane on the
circle |zeta_k| = 1. There the potentials are Cauchy integrals of the tractions. Lengths are in units of the radius R,
stresses in the units of the tractions. Tension is positive.
"""

from __future__ import annotations

import math

import numpy as np

from fastpin.elasticity.tractions import Tractions, cauchy_integrals
from fastpin.model.laminate import Laminate


def laminate_stress(
    laminate: Laminate, tractions: Tractions, remote: np.ndarray, theta: np.ndarray, depth: np.ndarray
) -> np.ndarray:
    """Stresses (srr, stt, srt) in an infinite plate of a laminate, shape (3, m). The force is balanced far away.

    They are means through the thickness. The arguments are those of :func:`fastpin.elasticity.stress.plate_stress`.
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
