"""Stress intensities of straight cracks at the edge of a free hole, from the tractions that load their lines.

Lengths are in units of the hole's radius R, and stress intensities in the unit of the tractions times sqrt(R). A crack
is a row of dislocations. Each one leaves the edge of the hole free, and with its image also the edges beyond. The
densities follow from the singular integral equation of the tractions by Gauss's rule in v, with s = a (1 - y^2) and
y = (15 v - 10 v^3 + 3 v^5)/8. This map crowds the points at the mouth, where the density is not smooth. The equation
holds at the zeros of the Legendre function Q_n, where the rule is exact for the pole.

The intensities are sums of the tractions at these points with weights. The weights do not know the load, nor in an
infinite plate and in a ring the place of the mouth. They are kept. Muskhelishvili (1953) has the potentials;
docs/cracks.md has the accuracy.
"""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass
from functools import lru_cache
from typing import ClassVar, NamedTuple, Protocol

import numpy as np

FEW, MANY, MOST = 40, 80, 160
"""Gauss points over both halves of a crack. A radial crack in an infinite plate has errors of 2e-6 with the few.

With many an inclined one has 7e-7 at 30 deg and 6e-5 at 60 deg, and one through 0.9 of a ring 4e-7. With most two
cracks have 1e-4 of the K of a lone one if they are as near as 0.2 of the shorter one.
"""

CLOSE = 0.9
"""Part of the ligament from which a crack needs most points: with many it has 2e-7 there, and 1e-5 at 0.95."""

OBLIQUE = math.radians(10.0)
"""Inclination from which a crack needs many points: its density is less smooth at the mouth."""

DIGITS = 30.0
"""Logarithm of the part of a harmonic of the outer rim that is left out."""


class CrackLine(NamedTuple):
    """A crack at the rim r = 1.

    `mouth` is the angle of its mouth, and `angle` its direction from the radius, counter-clockwise, rad. `length` is in
    units of R.
    """

    mouth: float
    angle: float
    length: float


class Beyond(Protocol):
    """The edges beyond the hole.

    `is_round` says whether all places of the mouth are alike. :meth:`deepest` is the largest part of its ligament that
    a crack takes; 0 in an infinite plate. :meth:`influence` gives the coefficients of g and of conj(g) in the tractions
    of images at distances `s` from the mouths, of dislocations at distances `t`, both (cracks, p). The coefficients
    have the shape (cracks p, cracks p).
    """

    @property
    def is_round(self) -> bool: ...

    def __hash__(self) -> int: ...

    def deepest(self, lines: tuple[CrackLine, ...]) -> float: ...

    def influence(
        self, lines: tuple[CrackLine, ...], s: np.ndarray, t: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]: ...


@dataclass(frozen=True)
class FreeRim:
    """The free outer rim of a ring of the radius `far`; infinite for an infinite plate.

    A tip closer to the rim needs more harmonics.
    """

    far: float

    is_round: ClassVar[bool] = True

    def deepest(self, lines: tuple[CrackLine, ...]) -> float:
        """See :class:`Beyond`."""
        depths = [abs(1.0 + line.length * cmath.exp(1j * line.angle)) - 1.0 for line in lines]
        return max(depths) / (self.far - 1.0)

    def influence(self, lines: tuple[CrackLine, ...], s: np.ndarray, t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """See :class:`Beyond`."""
        if math.isinf(self.far):
            return np.zeros((s.size, t.size)), np.zeros((s.size, t.size))
        starts, along = (np.repeat(each, s.shape[1]) for each in _starts(lines))
        return _rim_influence((starts + s.ravel() * along, along), (starts + t.ravel() * along, along), self.far)


def _starts(lines: tuple[CrackLine, ...]) -> tuple[list[complex], list[complex]]:
    """Mouths and directions of cracks."""
    return [cmath.exp(1j * line.mouth) for line in lines], [cmath.exp(1j * (line.mouth + line.angle)) for line in lines]


class Rule(NamedTuple):
    """Gauss's rule along a crack of length 1, from the tip to the mouth; n/2 sources, n/2 points of collocation.

    Attributes
    ----------
    source, place : ndarray, shape (n/2,)
        Distances s = 1 - y^2 of the sources and of the points of collocation from the mouth.
    weight : ndarray, shape (n/2,)
        2 w y' of the sources.
    tip : ndarray, shape (n/2,)
        The density G at the tip is the sum of `tip` times G at the sources.
    """

    source: np.ndarray
    weight: np.ndarray
    place: np.ndarray
    tip: np.ndarray


@lru_cache(maxsize=8)
def rule(n: int) -> Rule:
    """Return the rule of n points over both halves, n even."""
    nodes, weights = np.polynomial.legendre.leggauss(n)
    v, w = nodes[n // 2 :], weights[n // 2 :]
    zeros = _zeros_of_second_kind(n, v)
    slope = 15.0 / 8.0 * (1.0 - v * v) ** 2
    legendre = np.polynomial.legendre.legvander(v, n - 2)[:, ::2]
    at_zero = np.polynomial.legendre.legvander(np.zeros(1), n - 2)[0, ::2]
    series = legendre @ ((4.0 * np.arange(n // 2) + 1.0) * at_zero)
    return Rule(_distance(v), 2.0 * w * slope, _distance(zeros), 8.0 / 15.0 * w * slope * series)


def _distance(v: np.ndarray) -> np.ndarray:
    """1 - y^2, without loss of digits at v = 1."""
    rest = (1.0 - v) ** 3 * (8.0 + 9.0 * v + 3.0 * v * v) / 8.0
    return np.asarray(rest * (2.0 - rest))


def _zeros_of_second_kind(n: int, v: np.ndarray) -> np.ndarray:
    """The positive zeros of Q_n: one between neighbours of the positive nodes v, and one beyond the last."""

    def of_second_kind(at: np.ndarray) -> np.ndarray:
        before, now = np.arctanh(at), at * np.arctanh(at) - 1.0
        for k in range(1, n):
            before, now = now, ((2 * k + 1) * at * now - k * before) / (k + 1)
        return now

    low, high = v.copy(), np.append(v[1:], 1.0 - 1e-16)
    sign = np.sign(of_second_kind(low))
    for _ in range(60):
        middle = 0.5 * (low + high)
        same = np.sign(of_second_kind(middle)) == sign
        low, high = np.where(same, middle, low), np.where(same, high, middle)
    return 0.5 * (low + high)


def needed_points(lines: tuple[CrackLine, ...], beyond: Beyond) -> int:
    """Return the number n of points for these cracks in a plate with edges beyond the hole."""
    deepest = beyond.deepest(lines)
    if len(lines) > 1 or deepest > CLOSE * (1.0 + 1e-9):
        return MOST
    return MANY if deepest > 0.0 or any(abs(line.angle) > OBLIQUE for line in lines) else FEW


def places(line: CrackLine, n: int) -> tuple[np.ndarray, np.ndarray]:
    """Depths below the edge and angles from the mouth of the points of collocation, both (n/2,)."""
    s = line.length * rule(n).place
    z = 1.0 + s * cmath.exp(1j * line.angle)
    return s * (2.0 * math.cos(line.angle) + s) / (1.0 + np.abs(z)), np.angle(z)


@lru_cache(maxsize=4096)
def weights(lines: tuple[CrackLine, ...], beyond: Beyond, n: int) -> np.ndarray:
    """Weights of the tractions on the lines of cracks, shape (cracks, 2, cracks, n/2, 2).

    The stress intensities (K_I, K_II) of each crack are the sums of the weights times (s_nn, s_tn) at the points of
    collocation of all cracks. The normal n lies 90 deg to the left of the growth.

    Parameters
    ----------
    lines : tuple of CrackLine
        They do not touch one another. Where all places are alike, only the differences of their mouths count.
    beyond : Beyond
    n : int
        Number of points, even; see :func:`needed_points`.
    """
    along, size = rule(n), n // 2 * len(lines)
    starts, directions = (np.repeat(each, n // 2) for each in _starts(lines))
    lengths = np.repeat([line.length for line in lines], n // 2)
    turns = np.repeat([cmath.exp(1j * line.angle) for line in lines], n // 2)
    s, t = (lengths * np.tile(one, len(lines)) for one in (along.place, along.source))
    z, z0 = starts + s * directions, starts + t * directions
    number = np.arange(size) // (n // 2)
    own = number[:, None] == number[None, :]
    of_gamma, of_conjugate = _influence((z, s, turns, directions), (z0, t, turns), own)
    # gamma = conj(g) direction/2, and g has its own pole g/(s - t).
    pole = np.divide(1.0, s[:, None] - t[None, :], out=np.zeros((size, size)), where=own)
    straight = pole + 0.5 * of_conjugate * directions.conj()
    mirrored = 0.5 * of_gamma * directions
    by_images = beyond.influence(lines, s.reshape(len(lines), -1), t.reshape(len(lines), -1))
    straight, mirrored = straight + by_images[0], mirrored + by_images[1]
    scale = lengths * np.tile(along.weight, len(lines))
    straight, mirrored = straight * scale, mirrored * scale
    one, other = straight + mirrored, straight - mirrored
    matrix = np.block([[one.real, -other.imag], [one.imag, other.real]])
    ends = np.zeros((2 * size, len(lines), 2))
    for k, line in enumerate(lines):
        tip = math.pi * math.sqrt(2.0 * math.pi * line.length) * along.tip
        ends[n // 2 * k :][: n // 2, k, 0] = tip
        ends[size + n // 2 * k :][: n // 2, k, 1] = tip
    solved = -np.linalg.solve(matrix.T, ends.reshape(2 * size, -1))
    found = solved.reshape(2, len(lines), n // 2, len(lines), 2).transpose(3, 4, 1, 2, 0)
    found = np.ascontiguousarray(found)
    found.setflags(write=False)
    return found


def _influence(
    receiver: tuple[np.ndarray, ...], source: tuple[np.ndarray, ...], own: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """The coefficients A and B of the tractions gamma A + conj(gamma) B beside a free hole, each (m, m).

    `receiver` holds z, s, exp(i beta) and the direction; `source` holds z0, t and exp(i beta). `own` tells the pairs on
    one crack: their pole is left out, and w = 1 - z conj(z0) is written without loss of digits.
    """
    z, s, turn, direction = (each[:, None] for each in receiver)
    z0, t, source_turn = (each[None, :] for each in source)
    e2, back = direction**2, z0.conj()
    w = np.where(own, -(s * turn + t * source_turn.conj() + s * t), 1.0 - z * back)
    q = 2.0 * t * source_turn.real + t * t
    P = (2.0 * s * turn.real + s * s) / z
    f1, f2 = back / w, q / (back * w * w)
    d1, d2 = f1 * f1, 2.0 * q / w**3
    A = f1 + f2.conj() + e2 * (P * d1 + f1 / z**2 - 1.0 / (z * z * z0))
    B = f2 + f1.conj() + e2 * (P * d2 + (z / w + f2) / z**2 - 1.0 / z)
    away = np.where(own, 1.0, z - z0)
    A += np.where(own, 0.0, 1.0 / away - e2 * away.conj() / away**2)
    B += np.where(own, 0.0, 1.0 / away.conj() + e2 / away)
    even = np.where(source_turn.real < 0.0, -q * (1.0 + e2 / z**2), 0.0)  # inside a circle: its centre is regular
    return A + even / z0, B + even / back


def _rim_influence(
    receiver: tuple[np.ndarray, np.ndarray], source: tuple[np.ndarray, np.ndarray], far: float
) -> tuple[np.ndarray, np.ndarray]:
    """The coefficients of g and of conj(g) in the tractions of the fields that free the outer rim, each (m, m)."""
    (z, direction), (z0, source_direction) = receiver, source
    nearest = math.log(far / float(np.abs(z0).max()))
    count = 2 ** math.ceil(math.log2(max(DIGITS / nearest, 32.0)))
    rim = far * np.exp(2j * math.pi * np.arange(2 * count) / (2 * count))
    answers = []
    for g in (1.0, 1j):
        gamma = 0.5 * np.conj(g) * source_direction
        traction = _rim_traction(rim, z0[:, None], gamma[:, None])
        answers.append(_freed(np.fft.fft(-traction, axis=1) / (2 * count), count, far, z, direction))
    normal, tangential = answers
    return 0.5 * (normal - 1j * tangential), 0.5 * (normal + 1j * tangential)


def _rim_traction(z: np.ndarray, z0: np.ndarray, gamma: np.ndarray) -> np.ndarray:
    """s_rr - i s_rt at points z away from a dislocation at z0 beside a free hole."""
    back, w = z0.conj(), 1.0 - z * z0.conj()
    q = np.abs(z0) ** 2 - 1.0

    def phi(at: np.ndarray) -> np.ndarray:
        w = 1.0 - at * back
        return np.asarray(gamma / (at - z0) + gamma * back / w + gamma.conj() * q / (back * w * w))

    slope = -gamma / (z - z0) ** 2 + gamma * (back / w) ** 2 + 2.0 * gamma.conj() * q / w**3
    here = phi(z)
    psi = (phi(1.0 / z.conj()).conj() + here) / z**2 - slope / z
    turn = z / z.conj()
    return 2.0 * here.real - turn * (z.conj() * slope + psi)


def _freed(t: np.ndarray, count: int, far: float, z: np.ndarray, direction: np.ndarray) -> np.ndarray:
    """s_nn + i s_tn at z of the ring whose rim carries tractions with the Fourier coefficients t, (sources, 2 count).

    The potentials are Phi = sum A_n z^n and Psi = sum B_n z^n. X and Y are A_n and conj(A_-n) times far^n.
    """
    square = far * far
    n = np.arange(2.0, count)
    decay = far ** (-2.0 * n)
    right = square * np.stack([t[:, 2:count], t[:, -2:-count:-1].conj()])
    top = (1.0 - n) * (square - 1.0), square * decay - 1.0
    bottom = square - decay, (1.0 + n) * (square - 1.0) * decay
    determinant = top[0] * bottom[1] - top[1] * bottom[0]
    X = (right[0] * bottom[1] - top[1] * right[1]) / determinant
    Y = (top[0] * right[1] - bottom[0] * right[0]) / determinant
    A_0 = (0.5 * t[:, 0] * square / (square - 1.0)).real
    A_1 = t[:, -1].conj() * far**3 / (square * square - 1.0)
    grown = (z[:, None] / far) ** n
    fallen = (1.0 / (far * z[:, None])) ** n
    phi = A_0 + np.outer(z, A_1) + grown @ X.T + fallen @ Y.conj().T
    slope = A_1 + (n * grown / z[:, None]) @ X.T - (n * fallen / z[:, None]) @ Y.conj().T
    # B_(n-2) = (1 - n) A_n + conj(A_-n), for n of both signs: the hole stays free.
    psi = 2.0 * A_0 + grown @ ((1.0 - n) * X + Y).T + fallen @ ((1.0 + n) * Y.conj() + X.conj()).T
    psi = psi / z[:, None] ** 2 + np.outer(z**-3.0, A_1.conj())
    return 2.0 * phi.real + direction[:, None] ** 2 * (z.conj()[:, None] * slope + psi)
