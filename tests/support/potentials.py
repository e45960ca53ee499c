"""Kolosov-Muskhelishvili potentials of pin and plate, and the displacements that the paper prints."""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from fastpin.model.materials import Material, MaterialPair

PI = math.pi
RADIUS = 1.3
THETA = np.concatenate([np.linspace(-3.1, -0.06, 40), np.linspace(0.05, 3.14, 37)])
KOLOSOV = [1.0, 1.8, 2.2, 3.0]
"""Kolosov's constants of the bodies that are checked."""

Field = Callable[[np.ndarray], np.ndarray]


@dataclass
class Potentials:
    """Omega and omega with their derivatives, and a particular solution for a body force along x."""

    kappa: float
    Omega: Field
    Omega_1: Field
    Omega_2: Field
    omega: Field
    omega_1: Field
    body: float = 0.0

    def displacement(self, z):
        """2G (u_x + i u_y).

        The particular solution is the gradient of a scalar potential,
        -(kappa - 1)/(4 (kappa + 1)) body [z^2 + 2 z conj(z)]: with it (52), (53) leave the edge free.
        """
        part = -(self.kappa - 1.0) / (4.0 * (self.kappa + 1.0)) * self.body * (z * z + 2.0 * z * z.conj())
        return self.kappa * self.Omega(z) - z * np.conj(self.Omega_1(z)) - np.conj(self.omega(z)) + part

    def traction(self, z, normal):
        """t_x + i t_y on a cut with the unit normal `normal` (complex)."""
        both = 4.0 * np.real(self.Omega_1(z))
        other = 2.0 * (np.conj(z) * self.Omega_2(z) + self.omega_1(z))
        # of the particular solution: sxx + syy = 4G/(kappa - 1) (exx + eyy) = 8G/(kappa - 1) Re dD/dz and
        # syy - sxx - 2i sxy = -4G dD/d(conj z)
        quarter = -self.body / (4.0 * (self.kappa + 1.0))
        p = (self.kappa - 1.0) * quarter
        both = both + 4.0 * np.real(quarter * (2.0 * z + 2.0 * np.conj(z)))
        other = other + np.conj(-2.0 * 2.0 * p * z)
        return 0.5 * (both * normal - np.conj(other) * np.conj(normal))


def pin_normal(kappa, a=RADIUS):
    """Problem (I): -N at z = a, N at the centre; Eqs. (1), (2) with N = 1."""
    c = 1.0 / (2.0 * PI * (1.0 + kappa))
    e = c * (1.0 + kappa)
    return Potentials(
        kappa,
        lambda z: -c * np.log(z) + e * np.log(1.0 - z / a) + e * z / (2.0 * a) + c * z**2 / a**2,
        lambda z: -c / z + e / (z - a) + e / (2.0 * a) + 2.0 * c * z / a**2,
        lambda z: c / z**2 - e / (z - a) ** 2 + 2.0 * c / a**2,
        lambda z: kappa * c * np.log(z) - e * np.log(1.0 - z / a) - e * a / (z - a),
        lambda z: kappa * c / z - e / (z - a) + e * a / (z - a) ** 2,
    )


def pin_shear(kappa, a=RADIUS):
    """Problem (II): T at z = a, -T and M = -T a at the centre; Eqs. (3), (4) with T = 1."""
    c = 1.0 / (2.0 * PI * (1.0 + kappa))
    e = c * (1.0 + kappa)
    m = -a / (2.0 * PI)
    return Potentials(
        kappa,
        lambda z: 1j * (c * np.log(z) - e * np.log(1.0 - z / a) + c * z**2 / a**2 + m * z / a**2),
        lambda z: 1j * (c / z - e / (z - a) + 2.0 * c * z / a**2 + m / a**2),
        lambda z: 1j * (-c / z**2 + e / (z - a) ** 2 + 2.0 * c / a**2),
        lambda z: 1j * (kappa * c * np.log(z) - e * np.log(1.0 - z / a) + e * a / (z - a) + m / z),
        lambda z: 1j * (kappa * c / z - e / (z - a) - e * a / (z - a) ** 2 - m / z**2),
    )


def pin_body(kappa, a=RADIUS):
    """Problem (IIIa): -N at the centre against uniform body forces along +x; Eqs. (52), (53) with N = 1.

    (lambda_I + G_I)/(lambda_I + 2 G_I) is 2/(kappa_I + 1).
    """
    c = -1.0 / (2.0 * PI * (1.0 + kappa))
    density = 1.0 / (PI * a**2)
    q = c / a**2 + 2.0 / (kappa + 1.0) * density / 4.0
    return Potentials(
        kappa,
        lambda z: -c * np.log(z) + q * z**2,
        lambda z: -c / z + 2.0 * q * z,
        lambda z: c / z**2 + 2.0 * q,
        lambda z: kappa * c * np.log(z),
        lambda z: kappa * c / z,
        density,
    )


def plate(kappa, force, a=RADIUS):
    """A force `force` (complex) on the edge of the hole at z = a, carried to infinity.

    Omega has the logarithm of a force on an edge at z = a and that of the resultant at infinity;
    omega follows by continuation across the edge, omega = -conj(Omega)(a^2/z) - (a^2/z) Omega'(z). This is
    Rothman's solution.
    """
    f, k = force / (2.0 * PI), kappa

    def Omega(z):
        return -f * (np.log(1.0 - a / z) + np.log(z) / (1.0 + k))

    def Omega_1(z):
        return -f * (1.0 / (z - a) - k / ((1.0 + k) * z))

    def Omega_2(z):
        return f * (1.0 / (z - a) ** 2 - k / ((1.0 + k) * z**2))

    def omega(z):
        return np.conj(f) * (np.log(1.0 - a / z) + k / (1.0 + k) * np.log(z)) - a**2 / z * Omega_1(z)

    def omega_1(z):
        edge = np.conj(f) * (1.0 / (z - a) - 1.0 / ((1.0 + k) * z))
        return edge + a**2 / z**2 * Omega_1(z) - a**2 / z * Omega_2(z)

    return Potentials(k, Omega, Omega_1, Omega_2, omega, omega_1)


def first_harmonic(first):
    """The potentials of a first harmonic, for t_1 = 1 and for conj t_-1 = 1 on the contact rim."""
    k = first.kolosov
    for A, D, L, b in zip(first.A, first.D, first.L, first.b, strict=True):
        yield Potentials(
            k,
            lambda z, A=A, L=L: A * z**2 - L * np.log(z),
            lambda z, A=A, L=L: 2.0 * A * z - L / z,
            lambda z, A=A, L=L: 2.0 * A + L / z**2,
            lambda z, D=D, L=L: D / z**2 + k * L * np.log(z),
            lambda z, D=D, L=L: -2.0 * D / z**3 + k * L / z,
            b,
        )


def functions(theta):
    """C, S, L, A of Eqs. (5), (7), (8) for xi = 0."""
    C, S = np.cos(theta), np.sin(theta)
    return C, S, np.log(4.0 * np.sin(theta / 2.0) ** 2), theta / 2.0 - PI / 2.0 * np.sign(theta)


def printed(name, theta, kappa):
    """u_r + i u_theta times 2G of Eqs. (9)-(12), (54) and (55) for a unit load."""
    C, S, L, A = functions(theta)
    k1, k2 = (kappa + 1.0) / 2.0, kappa - 1.0
    radial, tangential = {
        "pin N": (C + k1 * (1.0 + C * L) + k2 * S * A, S - k1 * S * L + k2 * C * A),
        "pin T": (-S - k1 * S * L + k2 * C * A, C - k1 * C * L - k2 * S * A),
        "plate N": (k2 * S * A - k1 * C * L, k1 * S * L + k2 * C * A),
        "plate T": (k2 * C * A + k1 * S * L, k1 * C * L - k2 * S * A),
        "body N": (-0.5 * C, -0.5 * S),
        "body T": (0.5 * S, -0.5 * C),
    }[name]
    return (radial + 1j * tangential) / (2.0 * PI)


def rigid_part(difference, z):
    """Fit a rigid motion to a displacement field by least squares.

    Return its translation (complex), its rotation, and the largest error of the fit.
    """
    columns = np.array([np.ones_like(z), 1j * np.ones_like(z), 1j * z]).T
    system = np.concatenate([columns.real, columns.imag])
    data = np.concatenate([difference.real, difference.imag])
    x, *_ = np.linalg.lstsq(system, data, rcond=None)
    return x[0] + 1j * x[1], x[2], np.abs(system @ x - data).max()


def edge_force(problem, inside, reach=0.3):
    """Force at z = a, from the traction on the arc |z - a| = reach; the edge beside it is free."""
    half = math.asin(reach / (2.0 * RADIUS))  # where the arc meets the edge, seen from z = a
    start, stop = (PI / 2.0 + half, 1.5 * PI - half) if inside else (-PI / 2.0 - half, PI / 2.0 + half)
    point, weight = np.polynomial.legendre.leggauss(60)
    angle = start + 0.5 * (stop - start) * (1.0 + point)
    normal = np.exp(1j * angle)
    pull = problem.traction(RADIUS + reach * normal, normal)
    return -np.sum(weight * pull) * reach * 0.5 * (stop - start)


# --- kernels and composite constants ----------------------------------------------------------------------

PAIRS = [
    MaterialPair(Material(2.6, 0.3), Material(2.6, 0.3)),
    MaterialPair(Material(116.0, 0.32), Material(69.0, 0.33)),
    MaterialPair(Material(0.4, 0.49), Material(7.0, 0.1), "stress"),
    MaterialPair(Material.rigid(), Material(3.0, 0.25)),
]


def displacement_kernels(pair, w, theta):
    """4 pi K_rN, K_rT, K_tN, K_tT: (30), (31) with w = 1 for a centre load and 1/2 for a body load."""
    C, S, L, A = functions(theta)
    alpha, beta, g, k1 = pair.alpha_star, pair.beta_star, pair.pin_compliance, (pair.pin_kolosov + 1.0) / 2.0
    return (
        alpha * S * A - beta * C * L - w * g * C - k1 * g,
        alpha * C * A + beta * S * L + w * g * S,
        alpha * C * A + beta * S * L - w * g * S,
        -alpha * S * A + beta * C * L - w * g * C,
    )
