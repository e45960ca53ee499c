"""Walls and layers solved from the raw conditions on their rims, with hundreds of digits.

Each monomial of the potentials is put through Kolosov's formulas by itself:

    2G (u_x + i u_y) = kappa Omega - z conj(Omega') - conj(omega),
    s_rr + i s_rtheta = 2 Re Omega' - conj(exp(2i theta) (conj(z) Omega'' + omega')).

The amplitudes are real, and so are the coefficients (t_n, conj t_-n) and (u_n, conj u_-n).
"""

import math

import mpmath
import numpy as np

FREE, HELD = "free", "held"


def exponents(n):
    """The potentials and exponents whose fields have the harmonics n and -n, growing ones first."""
    return [("Omega", n + 1), ("omega", n - 1), ("Omega", 1 - n), ("omega", -n - 1)]


def field(potential, m, n, r, kappa):
    """The coefficients t_n, t_-n, 2G u_n, 2G u_-n at the radius r of Omega = z^m or omega = z^m."""
    r, power = mpmath.mpf(r), mpmath.mpf(r) ** (m - 1)
    waves = {}  # coefficients of (traction, displacement) by harmonic

    def add(harmonic, traction, displacement):
        t, u = waves.get(harmonic, (0, 0))
        waves[harmonic] = (t + traction, u + displacement)

    if potential == "Omega":
        add(m - 1, m * power, kappa * power * r)
        add(1 - m, m * power - m * (m - 1) * power, -m * power * r)
    else:
        add(-m - 1, -m * power, -power * r)
    (t_n, u_n), (t_minus, u_minus) = waves.get(n, (0, 0)), waves.get(-n, (0, 0))
    return t_n, t_minus, u_n, u_minus


def digits(n, *ratios):
    """Digits that survive the cancellation of powers r^n."""
    return 60 + int(8 * n * sum(abs(math.log10(ratio)) for ratio in ratios))


def solved(rows, right):
    """The solution of a small system of equations."""
    return mpmath.lu_solve(mpmath.matrix(rows), mpmath.matrix(right))


def wall_change(n, other, kappa, kind):
    """a, b, d by which a wall with the other rim at `other` differs from a disk (below 1) or an infinite plate."""
    with mpmath.workdps(digits(n, other)):
        kappa, terms = mpmath.mpf(kappa), exponents(n)
        near, far = (np.array([field(*term, n, r, kappa) for term in terms]).T for r in (1, mpmath.mpf(other)))
        rows = [*near[:2], *(far[2:] if kind == HELD else far[:2])]
        found = []
        for t in ((1, 0), (0, 1)):
            amplitudes = solved([list(row) for row in rows], [*t, 0, 0])
            found.append([sum(u * a for u, a in zip(row, amplitudes, strict=True)) for row in near[2:]])
        whole = (
            [kappa / (n + 1), mpmath.mpf(1) / (n - 1)] if other < 1 else [-mpmath.mpf(1) / (n + 1), -kappa / (n - 1)]
        )
        return [found[0][0] - whole[0], found[0][1], found[1][1] - whole[1]]


def uniform(other, kappa, kind):
    """c(0) under pressure of a wall with the other rim at `other`."""
    with mpmath.workdps(60):
        kappa, terms = mpmath.mpf(kappa), [("Omega", 1), ("omega", -1)]
        near, far = (np.array([field(*term, 0, r, kappa) for term in terms]).T for r in (1, mpmath.mpf(other)))
        amplitudes = solved([list(near[0]), list(far[2] if kind == HELD else far[0])], [1, 0])
        return near[2][0] * amplitudes[0] + near[2][1] * amplitudes[1]


class Layers:
    """Bonded layers from the contact rim, radius 1, outwards, for one harmonic.

    ``layers`` are (outer radius, kolosov, 1/G). An infinite plate has an infinite radius. ``kind`` is that of the last
    rim.
    """

    def __init__(self, n, layers, kind=FREE):
        self.n, self.layers, self.kind = n, layers, kind

    def solve(self, contact, outer=(0, 0), jump=(0, 0)):
        """Displacements (u_n, conj u_-n) of the contact rim under tractions on the contact rim and the last rim.

        `jump` is the displacement of the second layer less that of the first, at their interface.
        """
        n, radii = self.n, [1.0] + [layer[0] for layer in self.layers]
        with mpmath.workdps(digits(n, *(r for r in radii if math.isfinite(r)))):
            terms = [exponents(n)[2:] if math.isinf(layer[0]) else exponents(n) for layer in self.layers]
            starts = np.cumsum([0] + [len(part) for part in terms])
            rows, right = [], []

            def at(k, radius):
                kappa, compliance = mpmath.mpf(self.layers[k][1]), mpmath.mpf(self.layers[k][2])
                part = np.array([field(*term, n, radius, kappa) for term in terms[k]]).T
                wide = np.array([[mpmath.mpf(0)] * starts[-1] for _ in range(4)])
                wide[:, starts[k] : starts[k + 1]] = part
                wide[2:] *= compliance / 2
                return wide

            rows += list(at(0, 1)[:2])
            right += list(contact)
            for k in range(len(self.layers) - 1):
                rows += list(at(k, self.layers[k][0]) - at(k + 1, self.layers[k][0]))
                right += [0, 0, *(-mpmath.mpf(value) for value in jump)] if k == 0 else [0, 0, 0, 0]
            last = self.layers[-1][0]
            if math.isfinite(last):
                rim = at(len(self.layers) - 1, last)
                rows += list(rim[2:] if self.kind == HELD else rim[:2])
                right += list(outer)
            amplitudes = solved([list(row) for row in rows], right)
            moved = at(0, 1)[2:]
            return np.array([sum(u * a for u, a in zip(row, amplitudes, strict=True)) for row in moved])

    def compliance(self):
        """The whole compliance (2, 2) of the contact rim."""
        return np.array([self.solve(t) for t in ((1, 0), (0, 1))]).T

    def uniform(self, contact=1, jump=0, outer=0):
        """u_r of the contact rim under s_rr = `contact` there, `outer` on the last rim and a radial jump, for n = 0."""
        assert self.n == 0
        with mpmath.workdps(60):
            starts = range(0, 2 * len(self.layers), 2)
            size = 2 * len(self.layers) - int(math.isinf(self.layers[-1][0]))

            def at(k, radius):
                kappa, compliance = mpmath.mpf(self.layers[k][1]), mpmath.mpf(self.layers[k][2])
                wide = np.array([[mpmath.mpf(0)] * (2 * len(self.layers)) for _ in range(2)])
                for place, term in enumerate([("omega", -1), ("Omega", 1)]):  # the growing one last
                    t, _, u, _ = field(*term, 0, radius, kappa)
                    wide[:, starts[k] + place] = t, compliance / 2 * u
                return wide

            rows, right = [at(0, 1)[0]], [contact]
            for k in range(len(self.layers) - 1):
                radius = self.layers[k][0]
                rows += list(at(k + 1, radius) - at(k, radius))
                right += [0, mpmath.mpf(jump) if k == 0 else 0]
            last = self.layers[-1][0]
            if math.isfinite(last):
                rows.append(at(len(self.layers) - 1, last)[1 if self.kind == HELD else 0])
                right.append(outer)
            amplitudes = solved([list(row[:size]) for row in rows], right)
            return sum(u * a for u, a in zip(at(0, 1)[1][:size], amplitudes, strict=True))
