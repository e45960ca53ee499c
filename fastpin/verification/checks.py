"""The checks of an installation: the solver against closed forms, other methods and exact properties.

:func:`verify` takes seconds. docs/accuracy-tables.md explains each check and the source of its tolerance. Each kind of
joint, of load and of damage has one exact relation here. tests/support/checks has the checks of their accuracy.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial
from typing import NamedTuple

import numpy as np

from fastpin.model.angles import BOTTOM
from fastpin.model.checks import check_callable
from fastpin.model.materials import MaterialPair
from fastpin.model.points import Body, Points
from fastpin.model.problem import Problem
from fastpin.model.profile_terms import Harmonic
from fastpin.states.state import State
from fastpin.verification import closed_forms, comparisons, joint_rows
from fastpin.verification.finite_elements import FRETTING, LIKE, UNLIKE, FiniteElements
from fastpin.verification.rows import Check, Checks, Solving, angle_check, difference_check, half_width, relative_check

STATED = 1.2
"""Factor on the stated errors of the finite-element models, which are given as "about"."""

BACK = 0.4
"""Part of Q to which the half-plane contact is unloaded at last.

The largest shear then stays where the border was at full Q.
"""


def verify(progress: Callable[[int, int], None] | None = None) -> list[Check]:
    """Compare the solver of this installation with its references.

    Parameters
    ----------
    progress : callable, optional
        Called as ``progress(done, total)`` before each case.

    Returns
    -------
    list of Check
        The checks in the order of the topics. A case that ends in an error gives a check that has not passed; the other
        cases still run.

    Raises
    ------
    InputError
        If `progress` can't be called.
    """
    check_callable("progress", progress)
    solving = Solving()
    checks: list[Check] = []
    cases = [(topic, name, checks_of) for topic in TOPICS.values() for name, checks_of in topic.cases.items()]
    for done, (topic, name, checks_of) in enumerate(cases):
        if progress is not None:
            progress(done, len(cases))
        try:
            for check in checks_of(solving):
                case = check.case or name
                tolerance = topic.tolerances.get(f"{check.quantity}, {case}", topic.tolerances[check.quantity])
                checks.append(replace(check, topic=topic.title, case=case, tolerance=tolerance))
        except Exception as error:  # an error of any kind is a result of the check
            checks.append(Check(topic.title, name, message=" ".join(f"{type(error).__name__}: {error}".split())))
    return checks


def _frictionless(pair: MaterialPair, load_parameter: float, mismatch: float, solving: Solving) -> Checks:
    (state,) = solving(Problem.from_load_parameter(pair, load_parameter, 0.0), [{"P": 1.0}])
    half = float(closed_forms.persson_half_angle(load_parameter, mismatch))
    yield relative_check("peak N", state.peak_pressure, float(closed_forms.persson_pressure(0.0, half)))
    yield angle_check("half-angle", half_width(state.contact[0]), half)


def _finite_elements(name: str, solving: Solving) -> Checks:
    model = FiniteElements.read(name)
    states = solving(model.problem, model.history, grid=model.grid)
    cases = ("P", "+Q", "-Q", "+Q again")[: len(states)]
    differences = model.differences(states)
    for case, state, pressure, difference in zip(cases, states, model.pressure, differences, strict=True):
        yield difference_check("int |dN|", difference.normal, "int N", case)
        if not model.problem.frictionless:
            yield difference_check("int |dT|", difference.shear, "int N", case)
        yield relative_check("peak N", float(state.pressure.max()), float(pressure.max()), case)


def _half_plane(solving: Solving) -> Checks:
    load_parameter, friction, ratio = 2e5, 0.5, 0.6
    half = float(closed_forms.hertz_half_angle(load_parameter))
    pushed, *fretted = solving(
        Problem.from_load_parameter(LIKE, load_parameter, friction, "centre", "fixed"),
        [{"P": 1.0}, *({"Q": part * ratio * friction} for part in (1.0, -1.0, 1.0, BACK))],
        arc=(BOTTOM - 1.2 * half, BOTTOM + 1.2 * half),
    )
    yield relative_check("peak N", pushed.peak_pressure, float(closed_forms.hertz_peak_pressure(load_parameter)), "P")
    differences = comparisons.cattaneo_mindlin_differences(fretted[:3], ratio)
    exact = float(closed_forms.cattaneo_mindlin_stick_ratio(ratio))
    for case, state, difference in zip(("+Q", "-Q", "+Q again"), fretted[:3], differences, strict=True):
        yield difference_check("int |dT|", difference, "int mu N", case)
        stick = half_width(state.stick[0]) / half_width(state.contact[0])
        yield relative_check("stick ratio", stick, exact, case)
        yield relative_check("peak T", abs(state.peak_shear), _peak_shear(state, ratio, 1.0), case)
    yield relative_check("peak T", abs(fretted[3].peak_shear), _peak_shear(fretted[3], ratio, BACK), "back to 0.4 Q")


def _peak_shear(state: State, ratio: float, part: float) -> float:
    """Return the largest shear of Cattaneo and Mindlin after unloading from Q to `part` times Q.

    It acts at the angle of the border at +Q.
    """
    half = float(closed_forms.hertz_half_angle(state.problem.load_parameter(state.load["P"])))
    border = half * float(closed_forms.cattaneo_mindlin_stick_ratio(ratio))
    branch: closed_forms.Branch = "unloading" if part < 1.0 else "loading"
    return abs(float(comparisons.cattaneo_mindlin(state, border, part * ratio, ratio, branch)))


FREE = Problem.from_load_parameter(UNLIKE, 0.05, 0.5, "body")
HELD = Problem.from_load_parameter(UNLIKE, 0.5, 0.55, "centre", "fixed")


def _mirror(problem: Problem, half_arc: float, solving: Solving) -> Checks:
    """Reversing the sign of Q mirrors the state: theta becomes -pi - theta, shear and slip change sign."""
    turned = [{name: -value if name == "Q" else value for name, value in corner.items()} for corner in FRETTING]
    arc = (BOTTOM - half_arc, BOTTOM + half_arc)
    states, mirrored = (solving(problem, history, arc=arc) for history in (FRETTING, turned))
    peak = max(state.peak_pressure for state in states)
    slip = max(float(np.abs(state.slip).max()) for state in states)

    def worst(difference: Callable[[State, State], np.ndarray]) -> float:
        return float(np.max([np.abs(difference(here, there)) for here, there in zip(states, mirrored, strict=True)]))

    yield difference_check("N", worst(lambda here, there: here.pressure - there.pressure[::-1]) / peak, "peak N")
    yield difference_check("T", worst(lambda here, there: here.shear + there.shear[::-1]) / peak, "peak N")
    yield difference_check("slip", worst(lambda here, there: here.slip + there.slip[::-1]) / slip, "largest slip")


BODIES: tuple[Body, Body] = ("plate", "pin")


def _open_hole(solving: Solving) -> Checks:
    """Remote stress, and a pin that touches nothing."""
    remote = {"sxx": 0.1, "syy": -0.05, "sxy": 0.03}
    (state,) = solving(Problem.from_load_parameter(LIKE, 0.5, 0.3, "body"), [remote])
    radius, theta = 1.0 + np.geomspace(1e-6, 20.0, 30)[:, None], np.linspace(-3.0, 3.0, 37)
    expected = closed_forms.kirsch_stress(radius, theta, **remote)
    yield difference_check("Kirsch", _stress_difference(state, "plate", radius, theta, expected) / remote["sxx"], "sxx")


def _interference_fit(solving: Solving) -> Checks:
    """An oversized pin, loaded a little and unloaded."""
    problem = Problem.from_load_parameter(UNLIKE, -0.1, 0.3)
    state = solving(problem, [{"P": 0.01}, {"P": 0.0}])[-1]
    pressure = -problem.clearance / problem.joint.uniform_compliance
    yield relative_check("peak N", state.peak_pressure, pressure)
    theta = np.linspace(-3.0, 3.0, 37)
    radii = 1.0 + np.geomspace(1e-6, 10.0, 20), np.linspace(0.05, 1.0, 20)
    for body, radius in zip(BODIES, radii, strict=True):
        fall = pressure * np.maximum(radius, 1.0)[:, None] ** -2.0 + 0.0 * theta
        expected = np.array([-fall, fall if body == "plate" else -fall, 0.0 * fall])
        difference = _stress_difference(state, body, radius[:, None], theta, expected)
        yield difference_check("Lame", difference / pressure, "p", f"interference fit, {body}")


def _stress_difference(state: State, body: Body, radius: np.ndarray, theta: np.ndarray, expected: np.ndarray) -> float:
    """Return the largest difference of a polar component from the expected ones, shape (3, ...)."""
    stress = state.stress(Points.at_radius(radius, theta), body)
    return float(np.abs(np.array([stress.radial, stress.hoop, stress.shear]) - expected).max())


def _edges_and_circles(name: str, problem: Problem, solving: Solving) -> Checks:
    """Stresses on the edge, beside a point below it, against those on the edge alone; on circles against the loads."""
    states = solving(problem, FRETTING)
    for body in BODIES:
        edge, force, moment = [], [], []
        for state in states:
            depth, theta = np.r_[np.zeros(state.theta.size), 0.1 * problem.hole_radius], np.r_[state.theta, BOTTOM]
            stress = state.stress(Points.at_depth(depth, theta), body, straight=True)
            known = -state.pressure, state.hoop_stress(body, straight=True), state.shear  # other formulas
            difference = np.array([stress.radial, stress.hoop, stress.shear])[:, :-1] - known
            edge.append(float(np.abs(difference).max()) / state.peak_pressure)
            for radius in (1.2, 3.0) if body == "plate" else (0.3, 0.8):
                carried, turned = comparisons.stress_resultant(state, body, radius)
                part = radius**2 if body == "pin" and problem.pin_load == "body" else 1.0
                force.append(abs(carried - part * complex(state.load["Q"], -state.load["P"])))
                moment.append(abs(turned - state.resultants["M"]))
        yield difference_check("on the edge", float(np.max(edge)), "peak N", f"{name}, {body}")
        yield difference_check("force", float(np.max(force)), "F", f"{name}, {body}")
        yield difference_check("moment", float(np.max(moment)), "F R", f"{name}, {body}")


def _energy(problem: Problem, solving: Solving) -> Checks:
    """Work of the loads against stored plus dissipated energy, for the state with the largest difference."""
    states = solving(problem, [*FRETTING, {"P": 0.5, "Q": 0.1}])
    work, energy = np.array([(state.work, state.energy + state.dissipation) for state in states]).T
    worst = int(np.argmax(np.abs(work / energy - 1.0)))  # NaN counts as the largest
    yield relative_check("work", float(work[worst]), float(energy[worst]))


def _split(problem: Problem, solving: Solving) -> Checks:
    """A history in two parts, the second continuing from the first, against the whole history."""
    whole = solving(problem, FRETTING)
    first = solving(problem, FRETTING[:2], grid=whole.grid)
    second = solving(problem, FRETTING[2:], start=first)
    differing = sum(
        int(np.count_nonzero(expected != actual))
        for here, there in zip(whole, [*first, *second], strict=True)
        for expected, actual in zip(_numbers(here), _numbers(there), strict=True)
    )
    yield Check("", "", "differing numbers", 0.0, float(differing), float(differing))


def _numbers(state: State) -> list[np.ndarray]:
    arrays = [state.pressure, state.shear, state.gap, state.slip, state.status]
    values = [state.dx, state.dy, state.rotation, state.dissipation, state.work, state.energy]
    return [*arrays, np.array(values)]


def _conditions(solving: Solving) -> Checks:
    """Conditions of Signorini, Coulomb and equilibrium for all states of the cases above, from the matrices."""
    largest, case = solving.largest if solving.states else math.nan, f"all {solving.states} states"
    yield difference_check("largest residual", largest, "relative", case)
    if solving.largest_with_seat > 0.0:
        yield difference_check("with a seat", solving.largest_with_seat, "relative", case)


Cases = Mapping[str, Callable[[Solving], Checks]]

_FITTED = {"like": LIKE, "Ti-6Al-4V in Al": UNLIKE}


class Topic(NamedTuple):
    """A topic of the checks.

    Attributes
    ----------
    title : str
    cases : dict of str to callable
        The checks of each case, by its name.
    tolerances : dict of str to float
        Largest differences that pass, by quantity. A key "quantity, case" holds for that case only.
    """

    title: str
    cases: Cases
    tolerances: dict[str, float]


TOPICS = {
    "like": Topic(
        "Without friction, like bodies: Persson",
        {f"L_p = {value:g}": partial(_frictionless, LIKE, value, 0.0) for value in (0.01, 0.1, 0.5, 2.0)},
        {"peak N": 1e-5, "half-angle": 2e-6},
    ),
    "alpha* = 0": Topic(
        "Without friction, unlike bodies with alpha* = 0: Ciavarella and Decuzzi",
        {
            f"L_p = {value:g}, alpha = {alpha:g}": partial(
                _frictionless, MaterialPair.from_dundurs(alpha, 0.0, nu_pin=0.3), value, -alpha
            )
            for alpha in (-0.2, 0.5)
            for value in (0.05, 0.5)
        },
        {"peak N": 8e-6, "half-angle": 2.5e-6},
    ),
    "elements, frictionless": Topic(
        "Finite elements, without friction, L_p = 0.05",
        {"P": partial(_finite_elements, "frictionless")},
        {"int |dN|": STATED * 5e-4, "peak N": 2e-5},
    ),
    "elements, monotonic": Topic(
        "Finite elements, first load, mu = 0.4, L_p = 0.1",
        {"P": partial(_finite_elements, "monotonic")},
        {"int |dN|": STATED * 1e-4, "int |dT|": STATED * 1e-3, "peak N": STATED * 5e-5},
    ),
    "elements, fretting": Topic(
        "Finite elements, fretting with held rotation, mu = 0.55, L_p = 0.5",
        {"P, Q": partial(_finite_elements, "fretting_fixed_rotation")},
        {
            "int |dN|": STATED * 5e-4,
            "int |dN|, -Q": 9e-4,  # measured, not stated: two or three nodes at the contact edges
            "int |dT|": STATED * 2e-3,
            "peak N": STATED * 1.5e-4,
        },
    ),
    "half-plane": Topic(
        "Half-planes, L_p = 2e5: Hertz, Cattaneo, Mindlin",
        {"P, Q": _half_plane},
        {
            "peak N": 5e-6,
            "peak T": 9.5e-4,
            "peak T, back to 0.4 Q": 2.2e-3,
            "int |dT|": 2e-3,
            "stick ratio": 1e-7,
        },
    ),
    "stresses": Topic(
        "Stresses: Kirsch, Lame, tractions on the edges, loads through circles",
        {
            "open hole": _open_hole,
            "interference fit": _interference_fit,
            "free rotation": partial(_edges_and_circles, "free rotation", FREE),
            "held rotation": partial(_edges_and_circles, "held rotation", HELD),
        },
        {
            "Kirsch": 3e-15,
            "peak N": 1.5e-13,
            "Lame": 6e-13,  # 2.8e-13 with the BLAS kernels of older processors
            "on the edge": 1.6e-14,
            "force": 8e-15,
            "moment": 1.8e-15,
        },
    ),
    "all round": Topic(
        "Interference fits in contact all round: harmonics 0, 1 and 2",
        {
            f"{case}, {name}": partial(joint_rows.all_round, pair, case)
            for name, pair in _FITTED.items()
            for case in joint_rows.FITS
        }
        | {f"first slip, {name}": partial(joint_rows.first_slip, pair) for name, pair in _FITTED.items()},
        {"tractions": 2e-5, "slip begins": 3e-5},
    ),
    "bodies, exact": Topic(
        "Hollow pins, rings and bushes: exact relations",
        {"interference fit": joint_rows.pressed_bodies},
        {"peak N": 4e-14},
    ),
    "seats": Topic(
        "A bush that slips in its seat: the largest torque", {"torque": joint_rows.torque}, {"torque": 1.5e-9}
    ),
    "laminates, exact": Topic(
        "Laminates: Lekhnitskii", {"open hole": joint_rows.open_hole_of_laminate}, {"hoop stress": 4e-15}
    ),
    "gaps, exact": Topic(
        "Initial gaps: exact relations to a round hole",
        {
            "clearance": partial(joint_rows.round_hole, Harmonic(0, 0.2)),
            "shift of the pin": partial(joint_rows.round_hole, Harmonic(1, 0.5, -0.2)),
            "ellipse, remote stress": joint_rows.oval,
        },
        {"N, T": 3e-13},  # rounding: 4 times the largest of five processors
    ),
    "friction, exact": Topic(
        "Friction that falls at constant load, half-planes, L_p = 200",
        {"as low from the start": joint_rows.at_constant_load},
        {"N, T": 3e-13},
    ),
    "wear, exact": Topic("Wear: exact relations", {"fat cycles": joint_rows.worn_volume}, {"volume": 1e-15}),
    "cracks, exact": Topic(
        "A crack under the pressure of a fit: a biaxial tension",
        {"pressure": joint_rows.crack_under_pressure},
        {"K": 5e-14},
    ),
    "mirror": Topic(
        "A history with -Q in place of Q: the mirror image",
        {"free rotation": partial(_mirror, FREE, 1.75), "held rotation": partial(_mirror, HELD, 1.2)},
        {"N": 1.5e-12, "T": 1.5e-12, "slip": 1.5e-14},
    ),
    "energy": Topic(
        "Work of the loads: energy stored and dissipated",
        {"free rotation": partial(_energy, FREE), "held rotation": partial(_energy, HELD)},
        {"work": 1.5e-5},
    ),
    "parts": Topic(
        "A history in two parts: the same bits as in one",
        {"free rotation": partial(_split, FREE), "held rotation": partial(_split, HELD)},
        {"differing numbers": 0.0},
    ),
    "conditions": Topic(
        "Contact conditions and equilibrium",
        {"all states": _conditions},
        {"largest residual": 1.4e-14, "with a seat": 1.6e-13},
    ),
}
"""The topics in their order."""
