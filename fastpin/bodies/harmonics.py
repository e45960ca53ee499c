"""Closed-form compliances of tubes, rings and bonded layers, harmonic by harmonic.

On a rim of radius r let t = s_rr + i s_rtheta and u = u_r + i u_theta, each a sum of t_n exp(i n theta). A body that is
symmetric about the axis couples the harmonics n and -n only:

    [u_n, conj u_-n] = (r/2G) c(n) [t_n, conj t_-n],      c(n) real and symmetric.

The contact rim has the radius 1. The other rim of a wall has the radius c: c < 1 in a tube (a pin), c > 1 in a ring (a
plate). docs/theory.md, section 12, derives all formulas from the potentials

    Omega = A z^(n+1) + B z^(1-n),      omega = C z^(n-1) + D z^(-n-1).

Compliances named `c` are in units of 1/2G. Compliances named `whole` are u/r per traction, in 1/Pa.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

HELD, FREE = "held", "free"
"""The two kinds of the other rim."""

FEWEST = 4
"""Least number of harmonics."""


def harmonics_needed(ratio: float) -> int:
    """The highest harmonic that matters, for a wall with the ratio of its smaller to its larger radius, below 1."""
    square, order = ratio * ratio, FEWEST
    while order * order * square ** (order - 1) > 3e-17:  # in parts of the first harmonics
        order = int(1.05 * order) + 1
    return order


# -- one wall: harmonics from 2 on ----------------------------------------------------------------------------


def tube(order: np.ndarray, bore: float, kolosov: float, kind: str) -> np.ndarray:
    """Change a, b, d of c(n) from a disk to a tube of this bore (below 1), shape (3, m), for harmonics `order` >= 2."""
    n, q = order, bore * bore
    s = kolosov if kind == HELD else -1.0
    wall = (1.0 - bore) * (1.0 + bore)
    factor = (kolosov + 1.0) * q ** (n - 1.0) / _determinant(n, bore, s, n - 1.0, n + 1.0)
    a = -factor * (s * q ** (n + 1.0) + s * s * q * q + (n * n - 1.0) * wall * wall) / (n + 1.0)
    return np.array([a, -factor * wall, -factor * (1.0 + s * q ** (n + 1.0)) / (n - 1.0)])


def ring(order: np.ndarray, outer: float, kolosov: float, kind: str) -> np.ndarray:
    """Change a, b, d of c(n) from the infinite plate to a ring of this outer radius (above 1), shape (3, m)."""
    n, ratio = order, 1.0 / outer
    q = ratio * ratio
    s = kolosov if kind == HELD else -1.0
    wall = (1.0 - ratio) * (1.0 + ratio)
    factor = (kolosov + 1.0) * q ** (n - 1.0) / _determinant(n, ratio, s, n + 1.0, n - 1.0)
    a = factor * q * q * (1.0 + s * q ** (n - 1.0)) / (n + 1.0)
    d = factor * (s * q ** (n + 1.0) + s * s + (n * n - 1.0) * wall * wall) / (n - 1.0)
    return np.array([a, factor * q * wall, d])


def _determinant(n: np.ndarray, ratio: float, s: float, first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """The determinant E of the wall's equations, without cancellation in thin walls with a free rim."""
    q, wall = ratio * ratio, (1.0 - ratio) * (1.0 + ratio)
    if s != -1.0:
        return (s + q**first) * (1.0 + s * q**second) + (n * n - 1.0) * wall * wall * q ** (n - 1.0)
    length = -math.log(ratio)
    small = n * length < 2.0  # there sinh(nL) - n sinh(L) is summed by its series
    scale = np.exp(-n * length)
    of_n, of_one = -0.5 * np.expm1(-2.0 * n * length), scale * math.sinh(length)
    excess = of_n - n * of_one
    m = n[small]
    excess[small], term = 0.0, m * length
    for k in range(1, 16):
        term = term * (m * length) ** 2 / (2 * k * (2 * k + 1))
        excess[small] += scale[small] * term * (1.0 - m ** (-2.0 * k))
    return -4.0 * excess * (of_n + n * of_one)


# -- harmonics 0 ----------------------------------------------------------------------------------------------


def uniform(other: float, kolosov: float, kind: str) -> float:
    """c(0) for pressure on a wall whose other rim has the radius `other`; 0 is a disk, infinity a plate."""
    if other == 0.0:
        return 0.5 * (kolosov - 1.0)
    if math.isinf(other):
        return -1.0
    inverse = 1.0 / other**2  # without overflow for a wide ring
    if kind == FREE:
        return (0.5 * (kolosov - 1.0) * inverse + 1.0) / (inverse - 1.0)
    return 0.5 * (kolosov - 1.0) * (inverse - 1.0) / (inverse + 0.5 * (kolosov - 1.0))


def uniform_of_layer(outer: float, kolosov: float, compliance: float, far: float) -> float:
    """Radial compliance under pressure of a layer that is bonded at `outer` to a body of compliance `far`."""
    q, k = outer**-2.0, kolosov
    # s_rr = t - b + b/x^2 and 2G u/x = (k - 1)/2 (t - b) - b/x^2
    inner = 2.0 * far / compliance
    decaying = (0.5 * (k - 1.0) - inner) / ((0.5 * (k - 1.0) - inner) * (1.0 - q) + 0.5 * (k + 1.0) * q)
    return 0.5 * compliance * (0.5 * (k - 1.0) - 0.5 * (k + 1.0) * decaying)


def press_fit(inner: float, kolosov: float, compliance: float, plate: float) -> tuple[float, float]:
    """Pressure, and displacement of the inner rim over its radius, of a bush that is pressed into a plate.

    Both are per relative interference delta/c. The bush has the outer radius c and the inner radius `inner` c. Its
    1/G is `compliance`. `plate` is the whole compliance of the hole at c under pressure, positive.
    """
    bush = 0.5 * compliance * uniform(inner, kolosov, FREE)
    wall = (1.0 - inner) * (1.0 + inner)
    pressure = 1.0 / (plate + bush)
    return pressure, -0.25 * compliance * (kolosov + 1.0) * pressure / wall


# -- harmonic 1 -----------------------------------------------------------------------------------------------


class First(NamedTuple):
    """Amplitudes of the first harmonic in a wall, linear in (t_1, conj t_-1) on the contact rim.

    Omega = A z^2 - L ln z, omega = D z^-2 + k L ln z, and a body force b. Each is an array of two coefficients.
    """

    kolosov: float
    A: np.ndarray
    D: np.ndarray
    L: np.ndarray
    b: np.ndarray

    def displacement(self) -> np.ndarray:
        """2G u_1 on the contact rim: the coefficients c11 and c12."""
        k = self.kolosov
        return k * self.A - self.D + self.L - (k - 1.0) / (4.0 * (k + 1.0)) * self.b

    def traction(self, radius: float) -> np.ndarray:
        """t_1 at `radius`."""
        found: np.ndarray = 2.0 * (self.A * radius + self.D * radius**-3.0 - self.L / radius)
        return found - self.b * radius / (self.kolosov + 1.0)

    def translation(self, radius: float) -> np.ndarray:
        """2G times the conjugate of u_-1 on the contact rim less u_-1 at `radius`: mean displacement of one circle over
        the other."""
        k, change = self.kolosov, 1.0 - radius * radius
        body = (k - 1.0) / (2.0 * (k + 1.0)) * self.b
        return -change * (2.0 * self.A + body) + 2.0 * k * math.log(radius) * self.L

    def mean_translation(self, radius: float) -> np.ndarray:
        """The same over the mean displacement of the area between the contact rim and `radius`, below 1."""
        k, q = self.kolosov, radius * radius
        body = (k - 1.0) / (2.0 * (k + 1.0)) * self.b
        log = -0.5 - q * math.log(radius) / (1.0 - q)  # the mean of ln r
        return -0.5 * (1.0 - q) * (2.0 * self.A + body) + 2.0 * k * log * self.L


def first(other: float, kolosov: float, load: str) -> First:
    """The first harmonic of a wall whose other rim is held, carries the force as `load` says, or is free ("body").

    `other` is below 1 in a tube, and above 1 in a ring. 0 is a disk, and infinity a plate.
    """
    k = kolosov
    t, m, none = np.array([1.0, 0.0]), np.array([0.0, 1.0]), np.zeros(2)
    L = -m / (1.0 + k)
    if load == "body":
        return _first_of_body(other, k, t, m)
    if other == 0.0:  # a force at the centre
        return First(k, 0.5 * t + L, none, L, none)
    if math.isinf(other):
        return First(k, none, 0.5 * t + L, L, none)
    both = 0.5 * t + L  # A + D
    q = other * other
    if load == HELD:
        if other < 1.0:
            D = q * (L + k * q * both) / (1.0 + k * q * q)
            return First(k, both - D, D, L, none)
        A = (both / q - L) / (q * (k + 1.0 / q / q))
        return First(k, A, both - A, L, none)
    ratio = {"uniform": 0.0, "normal": 1.0, "half": 1.0, "shear": -1.0}[load]  # t_1/conj t_-1 on the other rim
    far = 0.5 * (ratio * m + 2.0 * L)
    if other < 1.0:
        D = q * (far - q * both) / (1.0 - q * q)
        return First(k, both - D, D, L, none)
    A = (far - both / q) / (q * (1.0 - 1.0 / q / q))
    return First(k, A, both - A, L, none)


def _first_of_body(other: float, k: float, t: np.ndarray, m: np.ndarray) -> First:
    """The first harmonic of a wall under a uniform body force, its other rim free."""
    if math.isinf(other):
        return First(k, np.zeros(2), 0.5 * t - m / (1.0 + k), -m / (1.0 + k), np.zeros(2))
    q = other * other
    if other < 1.0:
        b, L = -2.0 * m / (1.0 - q), q / (1.0 - q) * m / (1.0 + k)
        both = 0.5 * t + L + 0.5 * b / (k + 1.0)
        A = both / (1.0 - q * q)
        return First(k, A, -A * q * q, L, b)
    b, L = 2.0 * m / q / (1.0 - 1.0 / q), -m / (1.0 - 1.0 / q) / (1.0 + k)
    both = 0.5 * t + L + 0.5 * b / (k + 1.0)
    D = both / (1.0 - 1.0 / q / q)
    return First(k, -D / q / q, D, L, b)


def first_of_layer(outer: float, kolosov: float, compliance: float, far: np.ndarray) -> First:
    """The first harmonic of a layer that is bonded at its outer rim to a body with these whole compliances.

    `far`, shape (2,), maps (t_1, conj t_-1) at the outer rim to u_1/c there. The layer has 1/G = `compliance` > 0.
    """
    k, c = kolosov, outer
    t, m = np.array([1.0, 0.0]), np.array([0.0, 1.0])
    L = -m / (1.0 + k)
    both = 0.5 * t + L
    inner, cross = 2.0 * far[0] / compliance, 2.0 * far[1] / compliance  # in units of 1/2G of the layer
    right = cross * m / c + inner * (2.0 * both * c**-3.0 - 2.0 * L / c) + both * c**-3.0 - L / c
    A = right / first_stiffness(c, k, inner)
    return First(k, A, both - A, L, np.zeros(2))


def first_stiffness(outer: float, kolosov: float, inner: float) -> float:
    """2G u_1/c of a layer less that of the body outside, per amplitude A of a field that leaves the contact rim free.

    `inner` is c11 of the body outside, in units of 1/2G of the layer.
    """
    return kolosov * outer + outer**-3.0 - 2.0 * inner * (outer - outer**-3.0)


# -- half a rim -----------------------------------------------------------------------------------------------


def half_cosine(force: float, middle: float, rim: float, m: np.ndarray) -> tuple[float, np.ndarray]:
    """Mean s_rr, and t_n for n = 2 m, of a half cosine of pressure about the angle `middle` on a rim of this radius.

    The pressure has the resultant `force`. t_-n is the conjugate of t_n.
    """
    mean = -2.0 * force / (math.pi**2 * rim)
    return mean, mean * (-1.0) ** (m + 1) / (4.0 * m * m - 1.0) * np.exp(-2j * m * middle)


# -- bonded layers: harmonics from 2 on -----------------------------------------------------------------------


class Layer(NamedTuple):
    """A layer from the contact rim, radius 1, to an outer rim of radius c, for the harmonics `order` >= 2, shape (m,).

    The field is that of the hole in the infinite plate, which decays, and a growing field with amplitudes (A, C) that
    leaves the contact rim free of traction. The amplitudes are scaled at the outer rim: A c^n and C c^(n-2).
    """

    order: np.ndarray
    outer: float
    kolosov: float
    compliance: float

    @property
    def growing_traction(self) -> np.ndarray:
        """Traction (t_n, conj t_-n) at the outer rim per growing amplitude, shape (m, 2, 2)."""
        n, q = self.order, self.outer**-2.0
        matrix = np.empty((n.size, 2, 2))
        matrix[:, 0, 0] = (n + 1.0) * (1.0 + (n * n - 1.0) * q**n - n * n * q ** (n + 1.0))
        matrix[:, 0, 1] = (n + 1.0) * (n - 1.0) * q ** (n - 1.0) * (1.0 - q)
        matrix[:, 1, 0] = (1.0 - n) * (n + 1.0) * -np.expm1(n * math.log(q))
        matrix[:, 1, 1] = (1.0 - n) * -np.expm1((n - 1.0) * math.log(q))
        return matrix

    @property
    def growing_displacement(self) -> np.ndarray:
        """Displacement (u_n, conj u_-n)/c at the outer rim per growing amplitude, shape (m, 2, 2)."""
        n, q, k = self.order, self.outer**-2.0, self.kolosov
        matrix = self.growing_traction
        matrix[:, 0] /= -(n + 1.0)[:, None]
        matrix[:, 1] /= (n - 1.0)[:, None]
        matrix[:, 0, 0] += k + 1.0
        matrix[:, 1, 0] -= (k + 1.0) * (n + 1.0) * q**n
        matrix[:, 1, 1] -= (k + 1.0) * q ** (n - 1.0)
        return 0.5 * self.compliance * matrix

    @property
    def decaying_traction(self) -> np.ndarray:
        """Traction at the outer rim per traction on the contact rim, in the infinite plate, shape (m, 2, 2)."""
        n, p = self.order, 1.0 / self.outer
        matrix = np.zeros((n.size, 2, 2))
        matrix[:, 0, 0] = p ** (n + 2.0)
        matrix[:, 0, 1] = p**n * (n + 1.0) * (1.0 - p) * (1.0 + p)
        matrix[:, 1, 1] = p**n
        return matrix

    @property
    def decaying_displacement(self) -> np.ndarray:
        """Displacement over c at the outer rim per traction on the contact rim, in the infinite plate."""
        n, matrix = self.order, self.decaying_traction
        matrix[:, 0] /= -(n + 1.0)[:, None]
        matrix[:, 1] *= -self.kolosov / (n - 1.0)[:, None]
        return 0.5 * self.compliance * matrix

    def contact_displacement(self, growing: np.ndarray) -> np.ndarray:
        """Displacement (u_n, conj u_-n) of the contact rim from growing amplitudes, both (m, 2, ...)."""
        n, p = self.order, 1.0 / self.outer
        shape = (n.size,) + (1,) * (growing.ndim - 2)
        A, C = growing[:, 0] * (p**n).reshape(shape), growing[:, 1] * (p ** (n - 2.0)).reshape(shape)
        rest = -((n + 1.0).reshape(shape) * A + C)
        found: np.ndarray = 0.5 * self.compliance * (self.kolosov + 1.0) * np.stack([A, rest], axis=1)
        return found

    def misfit(self, far: np.ndarray) -> np.ndarray:
        """Displacement at the outer rim per growing amplitude, beyond that of the body outside, shape (m, 2, 2)."""
        return self.growing_displacement - far @ self.growing_traction

    def amplitudes(self, far: np.ndarray) -> np.ndarray:
        """Growing amplitudes per traction on the contact rim; `far`, (m, 2, 2), is the whole compliance outside."""
        return np.linalg.solve(self.misfit(far), far @ self.decaying_traction - self.decaying_displacement)

    def moved_outside(self, far: np.ndarray, displacement: np.ndarray) -> np.ndarray:
        """Growing amplitudes (m, 2) when the free hole of the body outside is displaced by `displacement` (m, 2) c."""
        return np.linalg.solve(self.misfit(far), displacement[..., None])[..., 0]

    def loaded_outside(self, traction: np.ndarray) -> np.ndarray:
        """Growing amplitudes (m, 2) under tractions (t_n, conj t_-n) at the outer rim, shape (m, 2)."""
        return np.linalg.solve(self.growing_traction.astype(traction.dtype), traction[..., None])[..., 0]


def hole(order: np.ndarray, kolosov: float, compliance: float) -> np.ndarray:
    """Whole compliances of the hole in the infinite plate, shape (m, 2, 2), for harmonics `order` >= 2."""
    whole = np.zeros((order.size, 2, 2))
    whole[:, 0, 0], whole[:, 1, 1] = -1.0 / (order + 1.0), -kolosov / (order - 1.0)
    return 0.5 * compliance * whole


def as_matrices(entries: np.ndarray) -> np.ndarray:
    """The symmetric matrices, shape (m, 2, 2), of entries a, b, d, shape (3, m)."""
    a, b, d = entries
    return np.array([[a, b], [b, d]]).transpose(2, 0, 1)


# -- a ring between two loaded rims: what one rim feels of the other -------------------------------------------


def across(order: np.ndarray, outer: float, kolosov: float) -> np.ndarray:
    """2G (u_n, conj u_-n) of a ring's outer rim per traction (t_n, conj t_-n) on its inner rim, shape (m, 2, 2).

    The ring lies in 1 <= r <= `outer`, and its outer rim is free. `order` has the harmonics, 0 or more. In harmonic 0
    shear moves nothing but the whole rim, and in harmonic 1 the force moves the whole ring: both are left out. The
    transposed matrices times -`outer` are those of the inner rim per traction on the outer one.
    """
    n, c, k = order, outer, kolosov
    found, q = np.zeros((n.size, 2, 2)), c**-2.0
    found[n == 0, 0, 0] = -0.5 * (k + 1.0) / (c * (1.0 - q))
    found[n == 1, 0, 0] = -0.5 * (k + 1.0) / (c * c - q)
    high = n >= 2
    m, wall = n[high], (1.0 - 1.0 / c) * (1.0 + 1.0 / c)
    first, second = -np.expm1((m - 1.0) * math.log(q)), -np.expm1((m + 1.0) * math.log(q))
    factor = (k + 1.0) * c * q ** (0.5 * m) / _determinant(m, 1.0 / c, -1.0, m + 1.0, m - 1.0)
    found[high, 0, 0], found[high, 0, 1] = factor * q * first / (m + 1.0), factor * wall
    found[high, 1, 0], found[high, 1, 1] = factor * q**m * wall, factor * second / (m - 1.0)
    return found
