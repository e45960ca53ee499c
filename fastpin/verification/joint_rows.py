"""Checks of interference fits, and one exact relation for each further kind of joint.

tests/support/checks has the comparisons of their accuracy: finite elements, harmonics, limits.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from fastpin.bodies import Bushing, Ring, Tube
from fastpin.cracks import Crack, stress_intensity
from fastpin.elasticity.system import System
from fastpin.kernels.status import STICK
from fastpin.model.angles import BOTTOM
from fastpin.model.grid import Grid
from fastpin.model.history import LoadHistory
from fastpin.model.laminate import Laminate
from fastpin.model.loads import LOADS, complete_load
from fastpin.model.materials import MATERIALS, Material, MaterialPair
from fastpin.model.options import SolveOptions
from fastpin.model.points import Points
from fastpin.model.problem import Problem
from fastpin.model.profile import InitialGap, Profile
from fastpin.model.profile_terms import Harmonic
from fastpin.solver.result import Result
from fastpin.solver.solving import MemoryRecorder
from fastpin.verification import closed_forms, comparisons, interference
from fastpin.verification.finite_elements import LIKE, UNLIKE
from fastpin.verification.rows import NODES, Checks, Solving, difference_check, relative_check
from fastpin.wear_lives.life import KEPT_ON_DEMAND
from fastpin.wear_lives.wear_path import WearRun

BRONZE = Material(110e9, 0.34)
"""The material of bushes."""

STUCK = Problem.from_load_parameter(
    UNLIKE, -0.1, 0.5, pin_body=Tube(0.5), plate_body=Bushing(BRONZE, 1.3, inside=Ring(2.0, "uniform"))
)
"""An interference fit of a hollow pin in a bush in a ring."""


def _stress_of_fit(problem: Problem) -> dict[str, float]:
    """Remote stresses that leave an interference fit closed, and stuck with a friction of 0.3."""
    pressure = interference.uniform_pressure(problem)
    return {"sxx": 0.1 * pressure, "syy": -0.05 * pressure, "sxy": 0.04 * pressure}


FITS: dict[str, tuple[float, Callable[[Problem], dict[str, float]]]] = {
    "P, mu = 0": (0.0, lambda problem: {"P": 0.9 * interference.frictionless_opening_load(problem)}),
    "P, mu = 0.3": (0.3, lambda problem: {"P": 0.9 * interference.first_slip_load(problem)}),
    "stress, mu = 0": (0.0, _stress_of_fit),
    "stress, mu = 0.3": (0.3, _stress_of_fit),
    "M, mu = 0.3": (0.3, lambda problem: {"M": 0.9 * interference.first_slip_moment(problem)}),
}
"""Coefficient of friction, and loads under which the contact stays closed all round and stuck, by the case."""


def all_round(pair: MaterialPair, case: str, solving: Solving) -> Checks:
    """An interference fit that stays closed all round, against its closed form."""
    friction, loads = FITS[case]
    problem = Problem.from_load_parameter(pair, -0.3, friction)
    yield difference_check("tractions", comparisons.all_round_difference(solving(problem, [loads(problem)])[-1]), "N0")


def first_slip(pair: MaterialPair, solving: Solving) -> Checks:
    """The load at which an interference fit slips first."""
    problem = Problem.from_load_parameter(pair, -0.3, 0.3)
    exact = interference.first_slip_load(problem)
    bounds = 0.9 * exact, 1.1 * exact
    load = comparisons.event_load(
        problem, "P", bounds, lambda state: bool(np.any(state.status != STICK)), NODES, solving
    )
    yield relative_check("slip begins", load, exact)


def pressed_bodies(solving: Solving) -> Checks:
    """A hollow pin pressed into a bush in a ring, loaded a little and unloaded."""
    state = solving(STUCK, [{"P": 0.01}, {"P": 0.0}])[-1]
    yield relative_check("peak N", state.peak_pressure, interference.uniform_pressure(STUCK))


def torque(solving: Solving) -> Checks:
    """A torque near the largest one that the seat holds: the pressure of the fit, times friction."""
    outer, nodes = 1.25, 128  # of the bush, over R; of the pin, and of the seat
    bush = Bushing(MATERIALS["C93200"], outer, 0.3, friction=0.1, bonded=False)
    pair = MaterialPair(MATERIALS["steel"], MATERIALS["aluminium"], "strain")
    joint = Problem.from_load_parameter(pair, -0.5, 1.0, plate_body=bush)
    (assembled,) = solving(joint, [{}], nodes=nodes)
    assert assembled.seat is not None
    most = 2.0 * math.pi * outer**2 * 0.1 * float(assembled.seat.pressure.mean())
    (turned,) = solving(joint, [{"M": (1.0 - 1e-9) * most}], nodes=nodes)
    assert turned.seat is not None
    yield relative_check("torque", turned.seat.resultants["M"], most)


MODULI = 135e9, 9e9, 5e9, 0.3
"""E1, E2, G12, Pa, and nu12 of the plies of checks."""


def open_hole_of_laminate(solving: Solving) -> Checks:
    """The stress concentration 1 + n of an open hole: Lekhnitskii."""
    E1, E2, G12, nu12 = MODULI
    pair = MaterialPair(MATERIALS["steel"], Laminate.from_moduli(*MODULI, axis=0.5 * math.pi), "stress")
    (state,) = solving(Problem.from_load_parameter(pair, 10.0, 0.2), [{"syy": 1e-3}])
    hoop = float(state.stress(Points.at_depth(0.0, 0.0)).hoop) / 1e-3
    yield relative_check("hoop stress", hoop, 1.0 + math.sqrt(2.0 * (math.sqrt(E1 / E2) - nu12) + E1 / G12))


CIRCLE = Grid.circle(120)
"""Nodes of the exact relations of gaps."""

FRETTED = [{"P": 1.0}, {"Q": 0.2}, {"Q": -0.2, "P": 0.5}]


def round_hole(term: Harmonic, solving: Solving) -> Checks:
    """A gap that is a part of the clearance, or a shift of the pin: the tractions of a round hole."""
    clearance = 0.3 if term.order else 0.3 - term.cosine
    plain = Problem.from_load_parameter(UNLIKE, 0.3, 0.4, "body")
    problem = Problem.from_load_parameter(UNLIKE, clearance, 0.4, "body", gap=InitialGap(Profile((term,))))
    ours, expected = (solving(each, FRETTED, grid=CIRCLE) for each in (problem, plain))
    yield difference_check("N, T", _difference(ours, expected), "peak N")


def oval(solving: Solving) -> Checks:
    """Without friction the half axes R + e and R - e are those of a round hole under a remote stress."""
    plain = Problem.from_load_parameter(UNLIKE, 0.3, 0.0, "centre", "fixed")
    stress = 0.1
    ellipse = InitialGap(Profile.ellipse(2.0 * stress * System.build(plain, CIRCLE, 1.0).plate))
    problem = Problem.from_load_parameter(UNLIKE, 0.3, 0.0, "centre", "fixed", gap=ellipse)
    stretched = [{"sxx": stress, "syy": -stress, **FRETTED[0]}, *FRETTED[1:]]
    ours, expected = solving(problem, FRETTED, grid=CIRCLE), solving(plain, stretched, grid=CIRCLE)
    yield difference_check("N, T", _difference(ours, expected), "peak N")


def _difference(ours: Result, expected: Result) -> float:
    """The largest difference of the tractions of two results, over the peak pressure."""
    pairs = zip(ours, expected, strict=True)
    return max(
        float(np.abs([one.pressure - two.pressure, one.shear - two.shear]).max()) / two.peak_pressure
        for one, two in pairs
    )


PUSHED = [{"P": 1.0}, {"Q": 0.2}]


def at_constant_load(solving: Solving) -> Checks:
    """In like half-planes a friction that has fallen leaves the state of a friction that was as low before."""
    half = 1.4 * float(closed_forms.hertz_half_angle(200.0))
    high, low = (Problem.from_load_parameter(LIKE, 200.0, friction, "centre", "fixed") for friction in (0.6, 0.3))
    arc: dict[str, Any] = {"arc": (BOTTOM - half, BOTTOM + half), "nodes": 61}
    ours, expected = solving(high, [*PUSHED, {"friction_change": -0.5}], **arc)[-1], solving(low, PUSHED, **arc)[-1]
    difference = np.abs([ours.pressure - expected.pressure, ours.shear - expected.shear])
    yield difference_check("N, T", float(difference.max()) / expected.peak_pressure, "peak N")


CYCLE = [{"Q": -0.275}, {"Q": 0.275}]
"""A cycle of partial slip."""


def wearing(problem: Problem, grid: Grid) -> WearRun:
    """A run without load that can wear."""
    options = SolveOptions(**KEPT_ON_DEMAND)  # type: ignore[arg-type]
    return WearRun(LoadHistory([{}]), System.build(problem, grid, 1.0), options, MemoryRecorder())


def step(run: WearRun, loads: dict[str, float]) -> tuple[np.ndarray, float]:
    """Follow one step. Returns int N |ds| of each node, shape (n,), and the dissipated energy, dimensionless."""
    given = np.array([loads.get(name, np.nan) for name in LOADS])
    run.step_to(complete_load(given, run.load), kept=False)
    latest = run.corner_log.latest
    return latest.slip_tally.sums[4], latest.dissipation


def worn_volume(solving: Solving) -> Checks:
    """The volume against the energy that friction dissipates, over fat cycles."""
    run, _, friction = fretted(61)
    coefficient, worn, dissipated = 1.4, np.zeros(61), 0.0
    for loads in 7 * CYCLE:
        rubbed, lost = step(run, loads)
        worn, dissipated = worn + run.wear(coefficient * rubbed).depth, dissipated + lost
    yield relative_check("volume", float(run.system.weights @ worn), coefficient / friction * dissipated)


def fretted(nodes: int) -> tuple[WearRun, np.ndarray, float]:
    """A run after a cycle of partial slip, int N |ds| of its last piece, and its friction."""
    friction = 0.5
    problem = Problem.from_load_parameter(LIKE, 0.5, friction, "centre", "fixed")
    run = wearing(problem, Grid.arc(BOTTOM - 1.1, BOTTOM + 1.1, nodes))
    for loads in ({"P": 1.0}, CYCLE[1], *CYCLE):
        rubbed, _ = step(run, loads)
    return run, rubbed, friction


def crack_under_pressure(solving: Solving) -> Checks:
    """A fit whose pressure is in the crack, too: a biaxial tension of the same size."""
    fit = solving(Problem.from_load_parameter(LIKE, -0.1, 0.3), [{"P": 0.01}, {"P": 0.0}])[-1]
    p, crack = fit.peak_pressure, Crack(-0.3)
    (open_state,) = solving(Problem.from_load_parameter(LIKE, 0.5, 0.3, "body"), [{"sxx": p, "syy": p}])
    inside = stress_intensity(fit, crack, [0.1], residual_stress=lambda s: p).K_I[0, 0]
    yield relative_check("K", float(inside), float(stress_intensity(open_state, crack, [0.1]).K_I[0, 0]))
