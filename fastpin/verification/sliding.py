"""Full sliding: Eq. (58) solved on its own, to many digits.

Where the whole contact slips in one sense, T = +-mu N, and the slip function drops out of (46) - d/dtheta (47).
What is left, (58), is one singular integro-differential equation for the pressure on a contact whose two ends are
unknown. It says that h + h'' = 0 in the contact, so the gap vanishes there for one choice of the pin's displacement.

The pressure is sought as (1 - t)^r (1 + t)^l times a sum of Jacobi polynomials P_k^(r, l)(t), with t from -1 to 1
along the contact and the exponents r + l = 1 that the dominant part of (58) demands. Its Cauchy integrals are known
in closed form, the rest of the kernel is smooth (Gauss-Jacobi quadrature), and (58) is collocated at the zeros of
P_m^(l, r). The ends follow from equilibrium (50). With alpha* = 0 the error falls faster than any power of the number
of terms; otherwise the pressure has terms x^(r + 1) log x at the ends, and it falls with the fourth power.
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

from fastpin.errors import InputError
from fastpin.model.checks import number, whole_number
from fastpin.model.problem import Problem
from fastpin.solver.errors import ConvergenceError

LOADS = ("P", "Q", "sxx", "syy")
"""Loads of a sliding contact, as in :data:`fastpin.loading.LOADS`; its moment and rotation are results."""

TERMS = (16, 32, 64, 128)
"""Numbers of terms that are tried until the last coefficients are negligible."""

NEGLIGIBLE = 1e-13
LEAST_TERMS = 4
_NARROWEST, _WIDEST = 1e-7, 0.995 * math.pi  # half of a contact that can be told from a point, and has two ends
_MOST_STEPS = 200
_LEAST_STEP = 1e-3
_FAR_OFF = np.array([10.0, 10.0])


@dataclass(frozen=True, eq=False)
class Sliding:
    """The contact of a pin that slides all over in one sense.

    Attributes
    ----------
    problem : Problem
    load : dict of str to float
        P and Q, N/m, sxx and syy, Pa.
    slip : int
        Sense in which the pin slides over the plate: 1 along +theta (counter-clockwise), so that T = -mu N, or -1.
    contact : (float, float)
        The two ends, rad; -pi/2 is the bottom of the hole.
    exponents : (float, float)
        The pressure falls to zero at the two ends with these powers of the distance. They add to one, and are a half
        each without friction or with alpha* = 0.
    moment : float
        M, N, counter-clockwise: the moment on the pin that goes with this state, -R^2 int T dtheta. A pin whose
        rotation is held finds it in its support; a pin that rotates freely slides only under exactly this moment.
    coefficients : ndarray, shape (terms,)
        Of the Jacobi polynomials, in units of F/R with F the size of the force (P, Q).
    truncation : float
        Largest of the last three coefficients over the largest of all. If it is not negligible (unlike bodies), N near
        the ends is off by some ten times this part of the peak, peak and moment by much less.
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
        """Contact pressure N at angles `theta`, rad, Pa; zero outside the contact."""
        start, stop = self.contact
        angle = start + np.mod(np.asarray(theta, dtype=float) - start, 2.0 * math.pi)
        t = np.minimum((2.0 * angle - start - stop) / (stop - start), 1.0)
        left, right = self.exponents
        weight = (1.0 - t) ** right * np.maximum(1.0 + t, 0.0) ** left
        unit = math.hypot(self.load["P"], self.load["Q"]) / self.problem.hole_radius
        return unit * weight * _series(self.coefficients, right, left, t)

    def shear(self, theta: ArrayLike) -> np.ndarray:
        """Shear traction T on the pin at angles `theta`, rad, Pa, positive along +theta: -slip mu N."""
        return -self.slip * self.problem.friction * self.pressure(theta)

    @property
    def peak_pressure(self) -> float:
        """Largest contact pressure, Pa."""
        return self._peak[1]

    @property
    def peak_pressure_angle(self) -> float:
        """Where the largest contact pressure acts, rad."""
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
        return float(found.x), -float(found.fun)


def solve_sliding(problem: Problem, load: Mapping[str, float], slip: int = 1, terms: int | None = None) -> Sliding:
    """The contact in full sliding under a given load, Eq. (58) with (50).

    The sense of slip is given, not found: whether a history comes to this state is for :func:`fastpin.solve` to
    say. Without friction it is the contact itself, and `slip` does not matter.

    Parameters
    ----------
    problem : Problem
    load : mapping
        P and Q, N/m, not both zero, and the remote stresses sxx and syy, Pa; what is left out is zero.
    slip : {1, -1}
        Sense in which the pin slides over the plate; 1 is counter-clockwise.
    terms : int, optional
        Number of Jacobi polynomials, at least 4. By default doubled from 16 until the last ones are negligible.

    Returns
    -------
    Sliding

    Raises
    ------
    InputError
        If a load is unknown or not number, no force acts, or `slip` or `terms` is out of range.
    ConvergenceError
        If no sliding contact with two ends was found: the hole closes round the pin, the contact has several parts,
        or it is too narrow for the digits of an angle.
    """
    if not isinstance(problem, Problem):
        raise InputError("problem", f"must be a Problem, not {problem!r}")
    given = _checked_load(load)
    if isinstance(slip, bool) or not isinstance(slip, (int, np.integer)) or slip not in (1, -1):
        raise InputError("slip", f"must be 1 (counter-clockwise) or -1, not {slip!r}")
    counts = TERMS if terms is None else (whole_number("terms", terms, LEAST_TERMS),)
    case = _Case.of(problem, given, -float(slip))
    place: tuple[float, float] | None = None
    with threadpool_limits(limits=1, user_api="blas"):
        for count in counts:
            basis = _Basis.of(case, count)
            place = _two_ends(case, basis, place)
            patch = _patch(case, basis, *place)
            size = np.abs(patch.coefficients)
            truncation = float(size[-3:].max() / size.max())
            if truncation < NEGLIGIBLE:
                break
        assert place is not None
        centre, half = place
        moment = -case.sign * problem.friction * case.size * problem.hole_radius * patch.total
        result = Sliding(
            problem,
            given,
            int(slip),
            (centre - half, centre + half),
            case.exponents,
            moment,
            patch.coefficients,
            truncation,
        )
        _check_conditions(case, result)
    return result


def _checked_load(load: Mapping[str, float]) -> dict[str, float]:
    if not isinstance(load, Mapping):
        raise InputError("load", f"must map load names to numbers, not {load!r}")
    for name in load:
        if name not in LOADS:
            raise InputError(str(name), f"a sliding contact takes {', '.join(LOADS)}; moment and rotation are results")
    given = {name: number(name, load.get(name, 0.0)) for name in LOADS}
    if given["P"] == 0.0 and given["Q"] == 0.0:
        raise InputError("P", "P and Q can't both be zero: a force must press the pin on the hole")
    return given


@dataclass(frozen=True)
class _Case:
    """(58) without dimensions: tractions in F/R, displacements in F beta*, F the size of the force.

    `size` is F, N/m, `force` the direction of the force (Q, -P), and `sign` that of T = sign mu N.
    """

    size: float
    clearance: float
    force: np.ndarray
    sum_stress: float
    difference_stress: float
    sign: float
    mu: float
    alpha: float
    plate: float

    @classmethod
    def of(cls, problem: Problem, load: dict[str, float], sign: float) -> _Case:
        pair, size = problem.pair, math.hypot(load["P"], load["Q"])
        stress = problem.hole_radius / size
        return cls(
            size,
            problem.load_parameter(size),
            np.array([load["Q"], -load["P"]]) / size,
            stress * (load["sxx"] + load["syy"]),
            stress * (load["sxx"] - load["syy"]),
            sign,
            problem.friction,
            pair.alpha_star / pair.beta_star,
            0.5 * (pair.plate_kolosov + 1.0) * pair.plate_compliance / pair.beta_star,
        )

    @property
    def exponents(self) -> tuple[float, float]:
        """Powers with which the pressure falls to zero, left and right: cot(pi r) = +-mu alpha*/(2 beta*)."""
        turn = math.atan(0.5 * self.sign * self.mu * self.alpha) / math.pi
        return 0.5 + turn, 0.5 - turn

    def remote(self, theta: np.ndarray) -> np.ndarray:
        """H of Eq. (58)."""
        return 0.5 * self.plate * (0.5 * self.sum_stress - 3.0 * self.difference_stress * np.cos(2.0 * theta))

    def radial_force(self, theta: np.ndarray) -> np.ndarray:
        """Component of the force along the outward normal at `theta`."""
        return self.force[0] * np.cos(theta) + self.force[1] * np.sin(theta)

    def normal_resultants(self, centre: float) -> tuple[float, float]:
        """int N cos(xi - centre) and int N sin(xi - centre) that balance the force, (50) with T = sign mu N."""
        along = float(self.radial_force(np.array(centre)))
        across = float(self.radial_force(np.array(centre + 0.5 * math.pi)))
        mu = self.sign * self.mu
        return (along - mu * across) / (1.0 + mu * mu), (across + mu * along) / (1.0 + mu * mu)


@dataclass(frozen=True, eq=False)
class _Basis:
    """What does not depend on where the contact is. Rows are collocation points t_i, columns terms k or nodes j."""

    points: np.ndarray
    nodes: np.ndarray
    weighted: np.ndarray  # P_k at the quadrature's nodes times its weights
    dominant: np.ndarray
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
class _Patch:
    """The pressure on a contact with given ends, the clearance that fits, and by how much the force is off."""

    coefficients: np.ndarray
    clearance: float
    unbalanced: float
    total: float  # int N dtheta


def _patch(case: _Case, basis: _Basis, centre: float, half: float) -> _Patch:
    """Solve (58) times -half/(2 pi) on centre +- half, with the normal force given and the clearance unknown."""
    mu, terms = case.sign * case.mu, basis.points.size
    difference = half * (basis.points[:, None] - basis.nodes)
    kernel, slope = _smooth_cotangent(difference)
    matrix = np.empty((terms + 1, terms + 1))
    matrix[:-1, :-1] = (
        basis.dominant
        + 0.5 * half * (case.alpha * (1.0 + case.mu**2) * basis.local + 2.0 * mu * basis.cauchy)
        - half**2 / (2.0 * math.pi) * (case.plate + mu * kernel - slope) @ basis.weighted
    )
    matrix[:-1, -1] = -2.0 * half
    matrix[-1, :-1] = half * np.cos(half * basis.nodes) @ basis.weighted
    matrix[-1, -1] = 0.0
    theta = centre + half * basis.points
    along, across = case.normal_resultants(centre)
    known = 2.0 * half * case.remote(theta)
    known += half * (case.alpha + 2.0) / (2.0 * math.pi) * case.radial_force(theta)
    *coefficients, clearance = np.linalg.solve(matrix, np.r_[known, along])
    tractions = half * basis.weighted @ coefficients
    unbalanced = float(np.sin(half * basis.nodes) @ tractions) - across
    return _Patch(np.array(coefficients), float(clearance), unbalanced, float(tractions.sum()))


def _smooth_cotangent(x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """cot(x/2) - 2/x and its derivative, for |x| < 2 pi."""
    near = np.abs(x) < 1.0
    with np.errstate(divide="ignore", invalid="ignore"):
        value = 1.0 / np.tan(0.5 * x) - 2.0 / x
        slope = 2.0 / x**2 - 0.5 / np.sin(0.5 * x) ** 2
    n = np.arange(12)
    series = -2.0 / math.pi * zeta(2.0 * n + 2.0) / (2.0 * math.pi) ** (2.0 * n + 1.0)
    square = x[near] ** 2
    value[near] = x[near] * np.polynomial.polynomial.polyval(square, series)
    slope[near] = np.polynomial.polynomial.polyval(square, (2.0 * n + 1.0) * series)
    return value, slope


def _series(coefficients: np.ndarray, right: float, left: float, t: np.ndarray) -> np.ndarray:
    k = np.arange(coefficients.size)
    return eval_jacobi(k, right, left, np.asarray(t)[..., None]) @ coefficients


def _two_ends(case: _Case, basis: _Basis, start: tuple[float, float] | None) -> tuple[float, float]:
    """Middle and half-width of the contact: the clearance and the direction of the force come out right.

    Without a good start the case is approached from a loose fit (L_p = 1 at least) without remote stress: clearance
    and stress together, or one after the other, as a contact in several parts may lie on one of the ways.
    """
    if start is not None:
        found = _ends_near(case, basis, start)
        if found is not None:
            return found
    loose = replace(case, clearance=max(case.clearance, 1.0), sum_stress=0.0, difference_stress=0.0)
    stressed = replace(case, clearance=loose.clearance)
    tight = replace(loose, clearance=case.clearance)
    direction = math.atan2(case.force[1], case.force[0]) + math.atan(case.sign * case.mu)
    first = (direction, min(1.0 / math.sqrt(math.pi * loose.clearance), 1.0))
    for stations in ([loose, case], [loose, stressed, case], [loose, tight, case]):
        place: tuple[float, float] | None = first
        for before, after in pairwise(stations):
            place = place and _along(before, after, basis, place)
        if place is not None:
            return place
    raise ConvergenceError(
        "no contact with two ends was found that slides under this load: the hole may close round the pin, or the "
        "contact may have several parts"
    )


def _along(before: _Case, after: _Case, basis: _Basis, place: tuple[float, float]) -> tuple[float, float] | None:
    """The contact of the case `after`, on the straight way from that of `before`, which lies near `place`."""
    done, step = 0.0, 1.0
    for _ in range(_MOST_STEPS):
        part = done + step
        there = replace(
            after,
            clearance=before.clearance + part * (after.clearance - before.clearance),
            sum_stress=before.sum_stress + part * (after.sum_stress - before.sum_stress),
            difference_stress=before.difference_stress + part * (after.difference_stress - before.difference_stress),
        )
        found = _ends_near(there, basis, place)
        if found is not None:
            place, done = found, part
            if done >= 1.0:
                return place
            step = min(2.0 * step, 1.0 - done)
        else:
            step *= 0.5
            if step < _LEAST_STEP:
                break
    return None


def _ends_near(case: _Case, basis: _Basis, start: tuple[float, float]) -> tuple[float, float] | None:
    """Middle and half-width of the contact of a case, near `start`; None if the iteration finds none there."""

    def off(unknowns: np.ndarray) -> np.ndarray:
        half = 2.0 * math.atan(math.exp(min(unknowns[1], 50.0)))
        if not (_NARROWEST < half < _WIDEST and abs(unknowns[0] - start[0]) < 1.0):
            return _FAR_OFF
        try:
            patch = _patch(case, basis, unknowns[0], half)
        except np.linalg.LinAlgError:
            return _FAR_OFF
        # the clearance goes as 1/half^2 in a loose fit
        return np.array([(patch.clearance - case.clearance) * half**2, patch.unbalanced])

    first = np.array([start[0], math.log(math.tan(0.5 * start[1]))])
    found = root(off, first, method="hybr", options={"xtol": 1e-14})
    if not np.abs(off(found.x)).max() < 1e-10:
        return None
    return float(found.x[0]), 2.0 * math.atan(math.exp(found.x[1]))


def _check_conditions(case: _Case, found: Sliding) -> None:
    """Raise unless N >= 0 in the contact and h >= 0 outside of it."""
    start, stop = found.contact
    unit = case.size / found.problem.hole_radius
    inside = found.pressure(np.linspace(start, stop, 402)[1:-1]) / unit
    if not inside.min() >= -1e-9 * inside.max():
        raise ConvergenceError("the sliding contact would pull somewhere: it has several parts under this load")
    outside = np.linspace(stop, start + 2.0 * math.pi, 202)[1:-1]
    gap = _gap(case, found, outside)
    if not gap.min() >= -1e-6 * np.abs(gap).max():
        angle = math.degrees(outside[np.argmin(gap)]) + 90.0
        raise ConvergenceError(
            f"the pin would also touch the hole {angle:.4g} degrees from the bottom: the contact has several parts "
            "under this load"
        )


def _gap(case: _Case, found: Sliding, theta: np.ndarray) -> np.ndarray:
    """Gap outside the contact, in F beta*, from the displacements (9)-(12)."""
    start, stop = found.contact
    unit = case.size / found.problem.hole_radius
    u, weights = np.polynomial.legendre.leggauss(200)
    u, weights = 0.5 * (u + 1.0), 0.5 * weights

    def free(angle: np.ndarray, begin: float, end: float) -> np.ndarray:
        """Elastic part of the gap due to the tractions from `begin` to `end`, up to a displacement of the pin.

        The displacement takes the terms with C/G_I and S/G_I along. The nodes gather at both ends, where pressure
        and kernel are singular.
        """
        xi = begin + (end - begin) * u**2 * (3.0 - 2.0 * u)
        width = (end - begin) * 6.0 * u * (1.0 - u) * weights
        pressure = width * found.pressure(xi) / unit
        shear = case.sign * case.mu * pressure
        phi = angle[:, None] - xi
        C, S, L = np.cos(phi), np.sin(phi), np.log(4.0 * np.sin(0.5 * phi) ** 2)
        A = 0.5 * phi - 0.5 * math.pi * np.sign(phi)
        elastic = (case.alpha * S * A - C * L) @ pressure + (case.alpha * C * A + S * L) @ shear
        return (elastic - (1.0 - case.plate) * pressure.sum()) / (4.0 * math.pi)

    def hole(angle: np.ndarray) -> np.ndarray:
        remote = 0.5 * case.sum_stress + case.difference_stress * np.cos(2.0 * angle)
        return case.clearance + 0.5 * case.plate * remote

    touching = np.array([start, 0.5 * (start + stop), stop])
    panels = [[(start, stop)], [(start, touching[1]), (touching[1], stop)], [(start, stop)]]
    there = [sum(free(touching[[i]], *panel) for panel in panels[i]) for i in range(3)]
    closed = np.concatenate(there) + hole(touching)
    motion = np.linalg.lstsq(np.column_stack([np.cos(touching), np.sin(touching)]), -closed, rcond=None)[0]
    return free(theta, start, stop) + hole(theta) + motion[0] * np.cos(theta) + motion[1] * np.sin(theta)
