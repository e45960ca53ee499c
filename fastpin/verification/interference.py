"""Closed forms of interference fits that are in contact all round.

A contact all round is a linear problem, and the harmonics of the tractions do not mix. Uniform pressure is harmonic 0,
a force on the pin harmonic 1, and a remote stress harmonics 0 and 2. So the tractions of any bodies that are symmetric
about the axis follow from three compliances: that of uniform pressure, and the two of harmonic 1. Let t_1 and t_-1 be
the amplitudes of s_rr + i s_rtheta on the contact circle. The rims of pin and plate move against one another by

    u_1 = (R/2) (g11 t_1 + g12 conj t_-1).

The force gives t_-1 = -(Q - i P)/(2 pi R). Where all sticks u_1 = 0, so t_1 = m conj t_-1 with m = -g12/g11. Without
friction the tractions are radial, so t_1 = conj t_-1. docs/interference.md shows the formulas.

An initial gap of harmonics, g0 = Re A exp(i n theta), adds tractions of the same harmonics. For n >= 2 let
(t_n, conj t_-n) be their amplitudes; (u_n, conj u_-n) = (R/2) g (t_n, conj t_-n) with a symmetric matrix g. A solid pin
in an infinite plate has g++ = [kappa_I/G_I + 1/G]/(n+1), g-- = [1/G_I + kappa/G]/(n-1), and g+- = 0. Where all sticks
u_n = conj u_-n = A/2. Without friction t_n = conj t_-n, and only the sum is given: u_n + conj u_-n = A. For n = 1 the
gap is a shift of the pin. Without friction it presses nothing; where all sticks t_1 = A/(R g11).

Units are SI, or those of the dimensionless problem. Signs are those of :class:`fastpin.State`: pressure N >= 0, shear T
on the pin, positive along +theta; angles from the +x axis. The bodies are those of a problem: the pin solid or hollow,
the plate infinite, a ring or with a bush. Forces must enter and leave symmetrically: a reaction at a point, the support
"half" of a ring and a compliance from elsewhere have further harmonics and are refused.

Sources: docs/theory.md (T3), (T14), (T16); G. Lame for uniform pressure.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
from numpy.typing import ArrayLike

from fastpin.errors import InputError
from fastpin.model.acting import check_loads
from fastpin.model.checks import instance, numbers
from fastpin.model.history import LoadHistory
from fastpin.model.loads import check_corner
from fastpin.model.problem import Problem

HARMONIC_LOADS = ("P", "Q", "M", "sxx", "syy", "sxy")
"""Loads whose tractions have a closed form. That of a remote stress is for a solid pin in an infinite plate."""


def uniform_pressure(problem: Problem, sxx: float = 0.0, syy: float = 0.0) -> float:
    """The uniform part N0 of the pressure, Pa (Lame).

    N0 = 2 (delta/R)/g0 with the interference delta = -clearance after assembly. For a solid pin in an infinite plate
    2/g0 = 1/[1/(2 G) + (kappa_I - 1)/(4 G_I)]. A remote stress widens the hole: it takes (kappa + 1)(sxx + syy)/(8 G)
    off delta/R. An initial gap that is the same all round takes its height off delta.

    Parameters
    ----------
    problem : Problem
    sxx, syy : float
        Remote stresses, Pa; only for a solid pin in an infinite plate.

    Returns
    -------
    float
        N0, Pa. It is negative if there is no interference left.

    Raises
    ------
    InputError
        If the bodies have no closed form under the loads, or uniform pressure changes no radius.
    """
    given = _checked_loads(problem, {"sxx": sxx, "syy": syy})
    if problem.is_incompressible:
        raise InputError("problem", "uniform pressure changes no radius of these bodies")
    widened = 0.125 * (problem.pair.plate_kolosov + 1.0) * problem.pair.plate_compliance * (given["sxx"] + given["syy"])
    clearance = problem.assembled_clearance + problem.gap.waves().get(0, 0j).real
    strain = -clearance / problem.hole_radius - widened
    return strain / problem.joint.uniform_compliance


def stuck_ratio(problem: Problem) -> float:
    """The ratio m = t_1/conj t_-1 = -g12/g11 of a contact that sticks all round.

    For a solid pin in an infinite plate m = 2 w/(kappa_I + G_I/G), with w = 1 for a load at the centre and 1/2 for a
    body load.

    Parameters
    ----------
    problem : Problem

    Returns
    -------
    float
        m, dimensionless. Like bodies with kappa = 1.8 have 0.7143 (centre) and 0.3571 (body).

    Raises
    ------
    InputError
        If the bodies have no closed form.
    """
    _checked_loads(problem, {})
    of_traction, of_force = _first_compliances(problem)
    return -of_force / of_traction


def _first_compliances(problem: Problem) -> tuple[float, float]:
    """The compliances g11 and g12, 1/Pa."""
    joint = problem.joint
    plate = joint.plate_first.displacement() * problem.surfaces.plate_compliance
    of_traction, of_force = joint.pin_first.displacement() * problem.pair.pin_compliance - plate
    return float(of_traction), float(of_force)


def _compliances(problem: Problem, order: int) -> tuple[float, float, float]:
    """The compliances g++, g+- and g-- of the harmonic `order`, at least 2, 1/Pa."""
    joint, pair = problem.joint, problem.surfaces
    n = np.array([float(order)])
    change = joint.pin_body.change(joint.pin_rim, n) - joint.plate_body.change(joint.hole, n)
    first, cross, last = change[:, 0].tolist()
    first += (pair.pin_kolosov * pair.pin_compliance + pair.plate_compliance) / (order + 1.0)
    last += (pair.pin_compliance + pair.plate_kolosov * pair.plate_compliance) / (order - 1.0)
    return first, cross, last


def _gap_tractions(problem: Problem, angle: np.ndarray, stuck: bool) -> np.ndarray:
    """N and T, Pa, shape (2, ...), of the harmonics n >= 1 of the initial gap."""
    found = np.zeros((2, *angle.shape))
    for order, amplitude in problem.gap.waves().items():
        if order == 0 or (order == 1 and not stuck):
            continue
        if order == 1:
            plus, minus = amplitude / _first_compliances(problem)[0], 0j
        else:
            first, cross, last = _compliances(problem, order)
            if stuck:
                plus, minus = amplitude * np.linalg.solve([[first, cross], [cross, last]], [1.0, 1.0])
            else:
                plus = minus = 2.0 * amplitude / (first + last + 2.0 * cross)
        # s_rr + i s_rtheta = t_n exp(i n theta) + t_-n exp(-i n theta); minus is conj t_-n.
        turn = np.exp(1j * order * angle)
        whole = (plus * turn + np.conj(minus * turn)) / problem.hole_radius
        found += [-whole.real, whole.imag]
    return found


def frictionless_pressure(problem: Problem, theta: ArrayLike, load: Mapping[str, float]) -> np.ndarray:
    """Pressure N without friction.

    N = N0 + (Q cos theta - P sin theta)/(pi R) + Re N_2 exp(-2 i theta) with
    N_2 = -3 (kappa + 1)(D/G)/[(3 kappa + 1)/G + (kappa_I + 3)/G_I] and D = sxx - syy + 2 i sxy. The part of the force
    is the same for all bodies: the first harmonic of a radial displacement is a translation.

    Parameters
    ----------
    problem : Problem
        Its friction is not used.
    theta : array_like
        Angles, rad.
    load : mapping of str to float
        P, Q, sxx, syy, sxy, SI. A load that is left out is 0.

    Returns
    -------
    ndarray, shape of `theta`
        N, Pa. It holds if it is positive all round.

    Raises
    ------
    InputError
        If a load or the bodies have no closed form.
    """
    loads, angle = _checked_loads(problem, load), numbers("theta", theta)
    if loads["M"] != 0.0:
        raise InputError("M", "a pin without friction carries no moment")
    pair = problem.pair
    stiffness = (3.0 * pair.plate_kolosov + 1.0) * pair.plate_compliance
    stiffness += (pair.pin_kolosov + 3.0) * pair.pin_compliance
    second = -3.0 * (pair.plate_kolosov + 1.0) * pair.plate_compliance * _deviator(loads) / stiffness
    force = (loads["Q"] * np.cos(angle) - loads["P"] * np.sin(angle)) / (math.pi * problem.hole_radius)
    even = uniform_pressure(problem, loads["sxx"], loads["syy"])
    found: np.ndarray = even + force + (second * np.exp(-2j * angle)).real
    return found + _gap_tractions(problem, angle, stuck=False)[0]


def stuck_tractions(problem: Problem, theta: ArrayLike, load: Mapping[str, float]) -> np.ndarray:
    """Pressure N and shear T of a contact that sticks all round since assembly.

    With t_-1 = -(Q - i P)/(2 pi R), t_1 = m conj t_-1, t_-2 = (kappa + 1)(D/2 G)/(1/G_I + kappa/G) and
    D = sxx - syy + 2 i sxy

        N - i T = N0 + i M/(2 pi R^2) - t_1 exp(i theta) - t_-1 exp(-i theta) - t_-2 exp(-2 i theta).

    For P alone, with tau = P/(2 pi R): N = N0 - tau (1 + m) sin theta and T = tau (1 - m) cos theta.

    Parameters
    ----------
    problem : Problem
        Its friction is not used.
    theta : array_like
        Angles, rad.
    load : mapping of str to float
        P, Q, M, sxx, syy, sxy, SI. A load that is left out is 0.

    Returns
    -------
    ndarray, shape (2, ...) with the shape of `theta`
        N and T, Pa. They hold if |T| <= mu N all round, on the whole way to the load.

    Raises
    ------
    InputError
        If a load or the bodies have no closed form.
    """
    loads, angle = _checked_loads(problem, load), numbers("theta", theta)
    pair, radius = problem.pair, problem.hole_radius
    minus = -complex(loads["Q"], -loads["P"]) / (2.0 * math.pi * radius)
    plus = stuck_ratio(problem) * minus.conjugate()
    second = 0.5 * (pair.plate_kolosov + 1.0) * pair.plate_compliance * _deviator(loads)
    second /= pair.pin_compliance + pair.plate_kolosov * pair.plate_compliance
    even = complex(uniform_pressure(problem, loads["sxx"], loads["syy"]), 0.5 * loads["M"] / (math.pi * radius**2))
    turn = np.exp(1j * angle)
    whole = even - plus * turn - minus / turn - second / turn**2
    return np.array([whole.real, -whole.imag]) + _gap_tractions(problem, angle, stuck=True)


def frictionless_opening_load(problem: Problem) -> float:
    """The load P at which a contact without friction opens at the top: pi R N0.

    Returns
    -------
    float
        P, N/m.

    Raises
    ------
    InputError
        If the fit has no interference, or the bodies have no closed form.
    """
    pressure = _fitted(problem)
    return math.pi * problem.hole_radius * pressure


def bonded_opening_load(problem: Problem) -> float:
    """The load P at which a contact that can't slip would open at the top: 2 pi R N0/(1 + m).

    It is the limit for much friction.

    Returns
    -------
    float
        P, N/m; infinite if the pressure at the top does not fall.

    Raises
    ------
    InputError
        If the fit has no interference, or the bodies have no closed form.
    """
    fall = 1.0 + stuck_ratio(problem)
    return 2.0 * math.pi * problem.hole_radius * _fitted(problem) / fall if fall > 0.0 else math.inf


def first_slip_load(problem: Problem) -> float:
    """The load P at which the first point slips: 2 pi R mu N0/sqrt[(1 - m)^2 + mu^2 (1 + m)^2].

    It lies at sin theta = mu |1 + m|/sqrt[(1 - m)^2 + mu^2 (1 + m)^2], on both sides.

    Returns
    -------
    float
        P, N/m; 0 without friction.

    Raises
    ------
    InputError
        If the fit has no interference, or the bodies have no closed form.
    """
    ratio, friction = stuck_ratio(problem), problem.uniform_friction
    largest = math.hypot(1.0 - ratio, friction * (1.0 + ratio))
    return 2.0 * math.pi * problem.hole_radius * _fitted(problem) * friction / largest


def first_slip_moment(problem: Problem) -> float:
    """The moment M at which the whole rim slips at once: 2 pi R^2 mu N0, where T = -M/(2 pi R^2) = -mu N0.

    Returns
    -------
    float
        M, N.

    Raises
    ------
    InputError
        If the pin can't carry a moment, the fit has no interference, or the bodies have no closed form.
    """
    _checked_loads(problem, {"M": 1.0})
    return 2.0 * math.pi * problem.hole_radius**2 * problem.uniform_friction * _fitted(problem)


def release_stress(problem: Problem) -> float:
    """The remote stress sxx = syy that takes up the interference: 4 G (delta/R)/(kappa + 1).

    Without other loads the whole contact opens at once.

    Returns
    -------
    float
        sxx = syy, Pa. It is negative for a clearance: then this compression closes the contact all round.

    Raises
    ------
    InputError
        If the bodies have no closed form under remote stress, or the plate is rigid.
    """
    _checked_loads(problem, {"sxx": 1.0})
    if problem.pair.plate.is_rigid:
        raise InputError("problem", "remote stress does not widen the hole of a rigid plate")
    strain = -(problem.clearance + problem.gap.waves().get(0, 0j).real) / problem.hole_radius
    return 4.0 * strain / ((problem.pair.plate_kolosov + 1.0) * problem.pair.plate_compliance)


def _fitted(problem: Problem) -> float:
    """N0 of a fit with interference."""
    pressure = uniform_pressure(problem)
    if any(order > 0 for order in problem.gap.waves()):
        raise InputError("gap", "must be the same all round: this load is known for a uniform pressure only")
    if pressure <= 0.0:
        raise InputError("clearance", f"must be negative after assembly, not {problem.assembled_clearance:g}")
    return pressure


def _deviator(loads: Mapping[str, float]) -> complex:
    """D = sxx - syy + 2 i sxy of (T16)."""
    return complex(loads["sxx"] - loads["syy"], 2.0 * loads["sxy"])


def check_isotropic(problem: Problem) -> None:
    """Raise :class:`InputError` for a laminate, for which there is no closed form."""
    if not problem.pair.plate.is_isotropic:
        raise InputError("plate", "has no closed form: it must be isotropic, not a laminate")


def _checked_loads(problem: Problem, load: Mapping[str, float]) -> dict[str, float]:
    """All of :data:`HARMONIC_LOADS`, or an error where they or the bodies have no closed form."""
    instance("problem", problem, Problem, "a Problem")
    given = check_corner("load", load)
    for name in given:
        if name not in HARMONIC_LOADS:
            raise InputError(name, f"has no closed form; the loads are {', '.join(HARMONIC_LOADS)}")
        if name in ("sxx", "syy", "sxy") and given[name] != 0.0 and problem.has_bodies:
            raise InputError(name, "has a closed form for a solid pin in an infinite plate only")
    if given:
        check_loads(problem, LoadHistory([given]))
    check_isotropic(problem)
    if not problem.plate_body.lug.is_symmetric:
        raise InputError("plate_body", "has no closed form: it must carry the force symmetrically about the axis")
    return {**dict.fromkeys(HARMONIC_LOADS, 0.0), **given}
