"""Full sliding: Eq. (58) solved by Jacobi polynomials, to many digits.

If the whole contact slips in one sense, T = +-mu N, and the slip drops out of (46) - d/dtheta (47). The result is (58):
one singular integro-differential equation for the pressure, on a contact with two unknown ends. It says that
h + h'' = 0 in the contact. So the gap vanishes there for one choice of the displacement of the pin.

The pressure is (1 - t)^r (1 + t)^l times a sum of Jacobi polynomials P_k^(r, l)(t), with t from -1 to 1 along the
contact. The dominant part of (58) determines the exponents, with r + l = 1. The Cauchy integrals of this form are known
in closed form. The rest of the kernel is smooth and is integrated by Gauss-Jacobi quadrature. (58) is collocated at the
zeros of P_m^(l, r). The ends follow from equilibrium (50).

An initial gap g0 adds g0 + g0'' to the right side, as a displacement of the hole does. Finite bodies add a smooth
kernel with the harmonics n of their compliances, times 1 - n^2, and columns of the loads.

With alpha* = 0 the error falls faster than any power of the number of terms. Otherwise the pressure has terms
x^(r + 1) log x at the ends, and the error falls with the fourth power of the number of terms.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import minimize_scalar, root
from scipy.special import eval_jacobi, roots_jacobi, zeta
from threadpoolctl import threadpool_limits

from fastpin import ConvergenceError, InputError, Problem
from fastpin.bodies.compliance import complex_coefficients, plate_coefficients
from fastpin.elasticity.terms import BodyTerms, body_terms
from fastpin.model import angles, checks
from fastpin.model.loads import SXX, SXY, SYY, P, Q
from fastpin.verification.interference import check_isotropic

SLIDING_LOADS = ("P", "Q", "sxx", "syy", "sxy")
"""Loads of a sliding contact, as in :data:`fastpin.model.loads.LOADS`. Its moment and rotation are results."""

TERMS = (16, 32, 64, 128)
"""Numbers of terms to try, in this order, until the last coefficients are negligible."""

NEGLIGIBLE = 1e-13
"""Largest of the last three coefficients, over the largest of all, at which no more terms are tried."""

WIDER = (1.0, 2.0, 3.0)
"""Half-widths to start from with finite bodies, in parts of Hertz's: thin walls bend, and their contact is wider.

A tube with the bore 0.8 R in a ring to 1.5 R has a contact 2.5 times as wide as Hertz's at L_p = 1.
"""


@dataclass(frozen=True, eq=False)
class Sliding:
    """The contact of a pin that slides in one sense over the whole contact.

    Attributes
    ----------
    problem : Problem
        The problem.
    load : dict of str to float
        P and Q, N/m, sxx, syy and sxy, Pa.
    slip : int
        Sense in which the pin slides over the plate. 1 is along +theta (counter-clockwise), with T = -mu N; -1 is the
        opposite.
    contact : (float, float)
        The two ends, rad; -pi/2 is the bottom of the hole. Their middle lies in (-3 pi/2, pi/2].
    exponents : (float, float)
        Powers of the distance with which the pressure falls to zero at the two ends. They add to one. Both are 1/2
        without friction or with alpha* = 0.
    moment : float
        Moment on the pin in this state, M = -R^2 int T dtheta, N, counter-clockwise. The support of a pin whose
        rotation is held provides it. A pin that rotates freely slides only under exactly this moment.
    coefficients : ndarray, shape (terms,)
        Coefficients of the Jacobi polynomials, in units of F/R, where F is the size of the force (P, Q).
    truncation : float
        Largest of the last three coefficients over the largest of all. For unlike bodies it may not be negligible. Then
        the error of N near the ends is some ten times this part of the peak. The errors of peak and moment are much
        smaller.
    """

    problem: Problem
    load: dict[str, float]
    slip: int
    contact: tuple[float, float]
    exponents: tuple[float, float]
    moment: float
    coefficients: np.ndarray = field(repr=False)
    truncation: float

    def pressure(self, theta: ArrayLike) -> np.ndarray:
        """Contact pressure N, Pa, at the angles `theta`, rad; zero outside the contact."""
        start, stop = self.contact
        angle = start + np.mod(np.asarray(theta, dtype=float) - start, 2.0 * math.pi)
        t = np.minimum((2.0 * angle - start - stop) / (stop - start), 1.0)
        left, right = self.exponents
        weight = (1.0 - t) ** right * np.maximum(1.0 + t, 0.0) ** left
        unit = math.hypot(self.load["P"], self.load["Q"]) / self.problem.hole_radius
        polynomials = eval_jacobi(np.arange(self.coefficients.size), right, left, np.asarray(t)[..., None])
        return unit * weight * (polynomials @ self.coefficients)

    def shear(self, theta: ArrayLike) -> np.ndarray:
        """Shear traction T = -slip mu N on the pin, Pa, at the angles `theta`, rad; positive along +theta."""
        return -self.slip * self.problem.uniform_friction * self.pressure(theta)

    @property
    def peak_pressure(self) -> float:
        """Largest contact pressure, Pa."""
        return self._peak[1]

    @property
    def peak_pressure_angle(self) -> float:
        """Angle of the largest contact pressure, rad, in (-3 pi/2, pi/2]."""
        return self._peak[0]

    @cached_property
    def _peak(self) -> tuple[float, float]:
        start, stop = self.contact
        fine = np.linspace(start, stop, 400)[1:-1]
        guess, step = float(fine[np.argmax(self.pressure(fine))]), float(fine[1] - fine[0])
        found = minimize_scalar(
            lambda angle: -float(self.pressure(angle)),
            bounds=(guess - step, guess + step),
            method="bounded",
            options={"xatol": 1e-12},
        )
        return angles.near_bottom(float(found.x)), -float(found.fun)


def solve_sliding(problem: Problem, load: Mapping[str, float], slip: int = 1, terms: int | None = None) -> Sliding:
    """Solve the contact in full sliding under a given load, Eq. (58) with (50).

    The sense of slip is an input. Only :func:`fastpin.solve` can say whether a history leads to this state. Without
    friction the solution is the contact itself, and `slip` has no effect.

    Parameters
    ----------
    problem : Problem
        The problem.
    load : mapping
        P and Q, N/m, not both zero, and the remote stresses sxx, syy, sxy, Pa. A missing load is zero.
    slip : {1, -1}
        Sense in which the pin slides over the plate; 1 is counter-clockwise.
    terms : int, optional
        Number of Jacobi polynomials, at least 4. By default it is doubled from 16, to at most 128, until the last
        coefficients are negligible.

    Returns
    -------
    Sliding
        Ends, pressure, shear traction and moment of the contact.

    Raises
    ------
    InputError
        If a load is unknown or not a number, no force acts, or `slip` or `terms` is out of range.
    ConvergenceError
        If no sliding contact with two ends was found. The hole may close round the pin, the contact may have several
        parts, or it is too narrow for the digits of an angle. Walls of 2% have more harmonics than 128 terms resolve.
    """
    if not isinstance(problem, Problem):
        raise InputError("problem", f"must be a Problem, not {checks.as_toml(problem)}")
    check_isotropic(problem)
    given = _checked_load(load)
    if isinstance(slip, bool) or not isinstance(slip, (int, np.integer)) or slip not in (1, -1):
        raise InputError("slip", f"must be 1 (counter-clockwise) or -1, not {checks.as_toml(slip)}")
    counts = TERMS if terms is None else (checks.whole_number("terms", terms, 4, 2_000),)  # the matrix then takes 30 MB
    case = _Case.of(problem, given, -float(slip))
    ends: tuple[float, float] | None = None
    with threadpool_limits(limits=1, user_api="blas"):
        for count in counts:
            basis = _Basis.of(case, count)
            ends = _two_ends(case, basis, ends)
            patch = _patch(case, basis, *ends)
            size = np.abs(patch.coefficients)
            truncation = float(size[-3:].max() / size.max())
            if truncation < NEGLIGIBLE:
                break
        assert ends is not None
        centre, half = ends
        moment = -case.sign * problem.uniform_friction * case.size * problem.hole_radius * patch.total
        result = Sliding(
            problem,
            given,
            int(slip),
            angles.interval_near_bottom(centre - half, centre + half),
            case.exponents,
            moment,
            patch.coefficients,
            truncation,
        )
        _check_conditions(case, result)
    return result


def _checked_load(load: Mapping[str, float]) -> dict[str, float]:
    if not isinstance(load, Mapping):
        raise InputError("load", f"must map load names to numbers, not {checks.as_toml(load)}")
    for name in load:
        if name not in SLIDING_LOADS:
            raise InputError(
                str(name), f"a sliding contact takes {', '.join(SLIDING_LOADS)}; moment and rotation are results"
            )
    given = {name: checks.number(name, load.get(name, 0.0)) for name in SLIDING_LOADS}
    if given["P"] == 0.0 and given["Q"] == 0.0:
        raise InputError("P", "P and Q can't both be zero: a force must press the pin on the hole")
    return given


@dataclass(frozen=True)
class _Case:
    """The numbers of (58) without dimensions: tractions in F/R, displacements in F beta*, F the size of the force.

    `size` is F, N/m. `force` is the direction of the force, (Q, -P)/F. `sign` is the sign in T = sign mu N. `gap_share`
    is the part of the initial gap that is there.
    """

    size: float
    clearance: float
    force: np.ndarray
    sum_stress: float
    difference_stress: float
    shear_stress: float
    sign: float
    mu: float
    alpha: float
    plate: float
    bodies: BodyTerms | None
    problem: Problem
    gap_share: float = 1.0

    @classmethod
    def of(cls, problem: Problem, load: dict[str, float], sign: float) -> _Case:
        pair, size = problem.surfaces, math.hypot(load["P"], load["Q"])
        stress = problem.hole_radius / size
        return cls(
            size,
            problem.load_parameter(size),
            np.array([load["Q"], -load["P"]]) / size,
            stress * (load["sxx"] + load["syy"]),
            stress * (load["sxx"] - load["syy"]),
            stress * load["sxy"],
            sign,
            problem.uniform_friction,
            pair.alpha_star / pair.beta_star,
            0.5 * (pair.plate_kolosov + 1.0) * pair.plate_compliance / pair.beta_star,
            body_terms(problem),
            problem,
        )

    @property
    def exponents(self) -> tuple[float, float]:
        """Exponents of the pressure at the left and the right end, cot(pi r) = +-mu alpha*/(2 beta*)."""
        turn = math.atan(0.5 * self.sign * self.mu * self.alpha) / math.pi
        return 0.5 + turn, 0.5 - turn

    def hole(self, theta: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The gap g of the hole under the loads, up to a translation, and the term H = g + g'' of (58).

        It holds the displacement v_r of the hole and the initial gap.
        """
        moved, bent = self._moved(theta)
        gap, _, curvature = self.gap_share * self.problem.gap_at(theta) / (self.size * self.problem.surfaces.beta_star)
        return moved + gap, bent + gap + curvature

    def _moved(self, theta: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """v_r of the hole under the loads, up to a translation, and v_r + v_r''."""
        if self.bodies is not None:
            loads = {
                P: -float(self.force[1]),
                Q: float(self.force[0]),
                SXX: 0.5 * (self.sum_stress + self.difference_stress),
                SYY: 0.5 * (self.sum_stress - self.difference_stress),
                SXY: self.shear_stress,
            }
            moved = np.zeros((2, theta.size))
            for load, column in self.bodies.columns.items():
                moved += np.array(_radial(loads[load] * column, theta))
            return moved[0], moved[1]
        cos, sin = np.cos(2.0 * theta), np.sin(2.0 * theta)
        mean, oval = 0.5 * self.sum_stress, self.difference_stress * cos + 2.0 * self.shear_stress * sin
        return 0.5 * self.plate * (mean + oval), 0.5 * self.plate * (mean - 3.0 * oval)

    def radial_force(self, theta: np.ndarray) -> np.ndarray:
        """Component of the force along the outward normal at `theta`."""
        return self.force[0] * np.cos(theta) + self.force[1] * np.sin(theta)

    def normal_resultants(self, centre: float) -> tuple[float, float]:
        """Integrals of N cos(xi - centre) and N sin(xi - centre) in equilibrium, (50) with T = sign mu N."""
        along = float(self.radial_force(np.array(centre)))
        across = float(self.radial_force(np.array(centre + 0.5 * math.pi)))
        mu = self.sign * self.mu
        return (along - mu * across) / (1.0 + mu * mu), (across + mu * along) / (1.0 + mu * mu)


@dataclass(frozen=True, eq=False)
class _Basis:
    """Polynomials and integrals that do not depend on the ends of the contact.

    Rows are collocation points t_i, or quadrature nodes in ``weighted``. Columns are terms k.
    """

    points: np.ndarray  # collocation points t_i
    nodes: np.ndarray  # quadrature nodes
    weighted: np.ndarray  # P_k at the quadrature nodes times the quadrature weights
    dominant: np.ndarray  # terms of the dominant part of (58)
    cauchy: np.ndarray  # polynomial part of (1/pi) PV int w P_k / (tau - t)
    local: np.ndarray  # w P_k

    @classmethod
    def of(cls, case: _Case, terms: int) -> _Basis:
        left, right = case.exponents
        k = np.arange(terms)
        nodes, weights = roots_jacobi(2 * terms, right, left)
        points = roots_jacobi(terms, left, right)[0]
        t = points[:, None]
        sine = math.sin(math.pi * right)
        return cls(
            points,
            nodes,
            weights[:, None] * eval_jacobi(k, right, left, nodes[:, None]),
            (k + 1.0) / sine * eval_jacobi(k, left, right, t),
            -2.0 / sine * eval_jacobi(k + 1, -right, -left, t),
            (1.0 - t) ** right * (1.0 + t) ** left * eval_jacobi(k, right, left, t),
        )


@dataclass(frozen=True, eq=False)
class _Piece:
    """The solution on a contact with known ends. Its clearance and transverse force may differ from the case."""

    coefficients: np.ndarray  # of the pressure
    clearance: float  # with which these ends are a solution
    unbalanced: float  # int N sin(xi - centre) minus its value in equilibrium
    total: float  # int N dtheta


def _patch(case: _Case, basis: _Basis, centre: float, half: float) -> _Piece:
    """Solve (58) times -half/(2 pi) on centre +- half, with known normal force and unknown clearance."""
    mu, terms = case.sign * case.mu, basis.points.size
    difference = half * (basis.points[:, None] - basis.nodes)
    kernel, slope = _smooth_cotangent(difference)
    matrix = np.empty((terms + 1, terms + 1))
    matrix[:-1, :-1] = (
        basis.dominant
        + 0.5 * half * (case.alpha * (1.0 + case.mu**2) * basis.local + 2.0 * mu * basis.cauchy)
        - half**2 / (2.0 * math.pi) * (case.plate + mu * kernel - slope) @ basis.weighted
    )
    theta = centre + half * basis.points
    if case.bodies is not None:
        smooth = _kernels(case.bodies, case.sign * case.mu, theta, centre + half * basis.nodes)[1]
        matrix[:-1, :-1] -= 2.0 * half**2 * smooth @ basis.weighted
    matrix[:-1, -1] = -2.0 * half
    matrix[-1, :-1] = half * np.cos(half * basis.nodes) @ basis.weighted
    matrix[-1, -1] = 0.0
    along, across = case.normal_resultants(centre)
    known = 2.0 * half * case.hole(theta)[1]
    known += half * (case.alpha + 2.0) / (2.0 * math.pi) * case.radial_force(theta)
    *coefficients, clearance = np.linalg.solve(matrix, np.r_[known, along])
    tractions = half * basis.weighted @ coefficients
    unbalanced = float(np.sin(half * basis.nodes) @ tractions) - across
    return _Piece(np.array(coefficients), float(clearance), unbalanced, float(tractions.sum()))


def _kernels(bodies: BodyTerms, mu: float, theta: np.ndarray, xi: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the gap g that finite bodies add at `theta` (m,) per pressure at `xi` (k,), and g + g''; each (m, k).

    The shear traction is `mu` times the pressure.
    """
    first, _, cross = bodies.coefficients
    order = np.arange(first.size)
    seen, acting = (np.exp(1j * np.multiply.outer(angle, order)) for angle in (theta, xi))
    both = (first - 1j * mu * cross) * np.conj(acting)
    gap, sum_gap = ((seen * part) @ both.T for part in (1.0, 1.0 - order**2.0))
    kernels = np.array([gap.real, sum_gap.real])
    if bodies.matrix.size:
        n = np.arange((len(bodies.matrix) - 2) // 4 + 1)
        waves = np.exp(-1j * np.multiply.outer(n, xi)) / math.pi
        acting = plate_coefficients(waves, mu * waves)
        moved = complex_coefficients(bodies.matrix @ acting)
        kernels += np.array(_radial(moved, theta))
    return kernels[0], kernels[1]


def _radial(column: np.ndarray, theta: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return v_r and v_r + v_r'' at `theta` (m,) from the coefficients of v_r + i v_theta, n = -K to K.

    `column` has the shape (2K + 1, ...).
    """
    order = np.arange(len(column)) - len(column) // 2
    waves = np.exp(1j * np.multiply.outer(theta, order))
    return (waves @ column).real, (waves * (1.0 - order**2.0) @ column).real


def _smooth_cotangent(x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return cot(x/2) - 2/x and its derivative, for |x| < 2 pi; by a power series for |x| < 1."""
    small = np.abs(x) < 1.0
    with np.errstate(divide="ignore", invalid="ignore"):
        value = 1.0 / np.tan(0.5 * x) - 2.0 / x
        slope = 2.0 / x**2 - 0.5 / np.sin(0.5 * x) ** 2
    n = np.arange(12)
    series = -2.0 / math.pi * zeta(2.0 * n + 2.0) / (2.0 * math.pi) ** (2.0 * n + 1.0)
    square = x[small] ** 2
    value[small] = x[small] * np.polynomial.polynomial.polyval(square, series)
    slope[small] = np.polynomial.polynomial.polyval(square, (2.0 * n + 1.0) * series)
    return value, slope


def _two_ends(case: _Case, basis: _Basis, start: tuple[float, float] | None) -> tuple[float, float]:
    """Return middle and half-width of the contact with the clearance and the direction of force of the case.

    Without a good `start` the case is approached from a loose fit (L_p = 1 at least) without remote stress. Clearance
    and stress change together, or one after the other: on some ways the contact would have several parts.
    """
    if start is not None:
        ends = _ends_near(case, basis, start)
        if ends is not None:
            return ends
    unstressed = replace(case, sum_stress=0.0, difference_stress=0.0, shear_stress=0.0, gap_share=0.0)
    loose = replace(unstressed, clearance=max(case.clearance, 1.0))
    stressed = replace(case, clearance=loose.clearance)
    tight = replace(loose, clearance=case.clearance)
    direction = math.atan2(case.force[1], case.force[0]) + math.atan(case.sign * case.mu)
    guess = min(1.0 / math.sqrt(math.pi * loose.clearance), 1.0)
    for half in [guess] if case.bodies is None else [part * guess for part in WIDER]:
        for stations in ([loose, case], [loose, stressed, case], [loose, tight, case]):
            place: tuple[float, float] | None = (direction, half)
            for before, after in pairwise(stations):
                place = place and _along(before, after, basis, place)
            if place is not None:
                return place
    raise ConvergenceError(
        "no contact with two ends was found that slides under this load: the hole may close round the pin, or the "
        "contact may have several parts"
    )


def _along(before: _Case, after: _Case, basis: _Basis, place: tuple[float, float]) -> tuple[float, float] | None:
    """Continue the contact from the case `before`, near `place`, to the case `after`. None if it fails.

    Clearance, stresses and initial gap change linearly from case to case, in steps of variable size.
    """
    done, step = 0.0, 1.0
    for _ in range(200):  # steps at most
        part = done + step
        between = replace(
            after,
            clearance=before.clearance + part * (after.clearance - before.clearance),
            sum_stress=before.sum_stress + part * (after.sum_stress - before.sum_stress),
            difference_stress=before.difference_stress + part * (after.difference_stress - before.difference_stress),
            shear_stress=before.shear_stress + part * (after.shear_stress - before.shear_stress),
            gap_share=before.gap_share + part * (after.gap_share - before.gap_share),
        )
        ends = _ends_near(between, basis, place)
        if ends is not None:
            place, done = ends, part
            if done >= 1.0:
                return place
            step = min(2.0 * step, 1.0 - done)
        else:
            step *= 0.5
            if step < 1e-3:
                break
    return None


def _ends_near(case: _Case, basis: _Basis, start: tuple[float, float]) -> tuple[float, float] | None:
    """Return middle and half-width of a case's contact near `start`, None if the iteration does not converge."""

    # A narrower contact can't be told from a point, and a wider one has no two ends.
    narrowest, widest = 1e-7, 0.995 * math.pi
    out_of_range = np.array([10.0, 10.0])

    def residuals(unknowns: np.ndarray) -> np.ndarray:
        half = 2.0 * math.atan(math.exp(min(unknowns[1], 50.0)))
        if not (narrowest < half < widest and abs(unknowns[0] - start[0]) < 1.0):
            return out_of_range
        try:
            patch = _patch(case, basis, unknowns[0], half)
        except np.linalg.LinAlgError:
            return out_of_range
        # In a loose fit the clearance varies like 1/half^2; so its residual is scaled by half^2.
        return np.array([(patch.clearance - case.clearance) * half**2, patch.unbalanced])

    first = np.array([start[0], math.log(math.tan(0.5 * start[1]))])
    solution = root(residuals, first, method="hybr", options={"xtol": 1e-14})
    if not np.abs(residuals(solution.x)).max() < 1e-10:
        return None
    return float(solution.x[0]), 2.0 * math.atan(math.exp(solution.x[1]))


def _check_conditions(case: _Case, sliding: Sliding) -> None:
    """Raise ConvergenceError unless N >= 0 in the contact and h >= 0 outside it."""
    start, stop = sliding.contact
    unit = case.size / sliding.problem.hole_radius
    inside = sliding.pressure(np.linspace(start, stop, 402)[1:-1]) / unit
    if not inside.min() >= -1e-9 * inside.max():
        raise ConvergenceError("the sliding contact would pull somewhere: it has several parts under this load")
    outside = np.linspace(stop, start + 2.0 * math.pi, 202)[1:-1]
    gap = _gap(case, sliding, outside)
    if not gap.min() >= -1e-6 * np.abs(gap).max():
        angle = math.degrees(outside[np.argmin(gap)]) + 90.0
        raise ConvergenceError(
            f"the pin would also touch the hole {angle:.4g} degrees from the bottom: the contact has several parts "
            "under this load"
        )


def _gap(case: _Case, sliding: Sliding, theta: np.ndarray) -> np.ndarray:
    """Return the gap at angles `theta` outside the contact, in F beta*, from the displacements (9)-(12)."""
    start, stop = sliding.contact
    unit = case.size / sliding.problem.hole_radius
    u, weights = np.polynomial.legendre.leggauss(200)
    u, weights = 0.5 * (u + 1.0), 0.5 * weights

    def free(angle: np.ndarray, begin: float, end: float) -> np.ndarray:
        """Elastic part of the gap from the tractions between `begin` and `end`, up to a displacement of the pin.

        The displacement includes the terms with C/G_I and S/G_I. The quadrature nodes gather at both ends, because
        pressure and kernel are singular there.
        """
        xi = begin + (end - begin) * u**2 * (3.0 - 2.0 * u)
        width = (end - begin) * 6.0 * u * (1.0 - u) * weights
        pressure = width * sliding.pressure(xi) / unit
        shear = case.sign * case.mu * pressure
        phi = angle[:, None] - xi
        C, S, L = np.cos(phi), np.sin(phi), np.log(4.0 * np.sin(0.5 * phi) ** 2)
        A = 0.5 * phi - 0.5 * math.pi * np.sign(phi)
        elastic = (case.alpha * S * A - C * L) @ pressure + (case.alpha * C * A + S * L) @ shear
        added = (elastic - (1.0 - case.plate) * pressure.sum()) / (4.0 * math.pi)
        if case.bodies is not None:
            added += _kernels(case.bodies, case.sign * case.mu, angle, xi)[0] @ pressure
        return added

    def hole(angle: np.ndarray) -> np.ndarray:
        return case.clearance + case.hole(angle)[0]

    touching = np.array([start, 0.5 * (start + stop), stop])
    panels = [[(start, stop)], [(start, touching[1]), (touching[1], stop)], [(start, stop)]]
    there = [sum(free(touching[[i]], *panel) for panel in panels[i]) for i in range(3)]
    closed = np.concatenate(there) + hole(touching)
    motion = np.linalg.lstsq(np.column_stack([np.cos(touching), np.sin(touching)]), -closed, rcond=None)[0]
    return free(theta, start, stop) + hole(theta) + motion[0] * np.cos(theta) + motion[1] * np.sin(theta)
