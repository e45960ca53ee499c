"""Checks of wear."""

from __future__ import annotations

import math

import numpy as np

from fastpin import Grid, LoadHistory, Problem, SolveOptions
from fastpin.model import InitialGap, Profile, Wear
from fastpin.model.angles import BOTTOM
from fastpin.model.profile_terms import Harmonic
from fastpin.solver.configuration import review
from fastpin.verification import interference
from fastpin.verification.finite_elements import LIKE, UNLIKE
from fastpin.verification.joint_rows import fretted, step, wearing
from fastpin.verification.rows import Checks, Solving, difference_check, relative_check
from fastpin.wear_lives import WornCycle
from fastpin.wear_lives.life import CyclesInMemory, WearTask
from fastpin.wear_lives.wear_path import WearRun
from tests.support.checks import wear_limits
from tests.support.checks.gap_rows import WAVES

FIT_NODES = Grid.circle(201)
"""Nodes of an interference fit that wears."""

WORN_FIT = Problem.from_load_parameter(
    UNLIKE, -0.3, 1.0, gap=InitialGap(Profile((Harmonic(0, 0.04), *WAVES.hole.terms)))
)
"""The fit after its wear, which is nowhere below 0."""

LOAD_RATIO = 0.5
"""Q/(mu P) of partial slip in half-planes."""


def fit(friction: float, solving: Solving) -> Checks:
    """An interference fit that wears to waves, against harmonics."""
    run, theta = _worn_fit(friction)[0], FIT_NODES.theta
    if friction:
        pressure, shear = interference.stuck_tractions(WORN_FIT, theta, {})
    else:
        pressure, shear = interference.frictionless_pressure(WORN_FIT, theta, {}), np.zeros_like(theta)
    yield difference_check("tractions", _difference(run, pressure, shear), "N0")


def same_fit(solving: Solving) -> Checks:
    """The worn fit against the same fit assembled with its waves, and the energy that its material takes along."""
    run, taken, expected = _worn_fit(1.0)
    (state,) = solving(WORN_FIT, [{"P": 0.0}], grid=FIT_NODES)
    yield difference_check("N, T", _difference(run, state.pressure, state.shear), "N0")
    yield relative_check("energy taken", taken, expected)


def _worn_fit(friction: float) -> tuple[WearRun, float, float]:
    """A worn fit, the energy that its material took along, and the same from the pressure before and after."""
    run = wearing(Problem.from_load_parameter(UNLIKE, -0.3, friction), FIT_NODES)
    step(run, {"P": 0.0})
    before, depth = run.now.pressure, WORN_FIT.gap.values(FIT_NODES.theta, 1.0)[0]
    removal = run.wear(depth)  # the pressure falls in proportion to the wear
    return run, removal.energy, float(FIT_NODES.weights @ (0.5 * (before + run.now.pressure) * depth))


def _difference(run: WearRun, pressure: np.ndarray, shear: np.ndarray) -> float:
    """The largest difference of the tractions of the worn fit, over its mean pressure."""
    difference = np.abs([run.now.pressure - pressure, run.now.shear - shear])
    return float(difference.max()) / interference.uniform_pressure(WORN_FIT)


def sliding(solving: Solving) -> Checks:
    """A held pin that slides one way in many small steps, against rigid bodies."""
    clearance, friction, path, steps = 1.0, 0.2, 2.0, 160
    coefficient = 1e-3  # small: slip during a wear path does not wear
    problem = Problem.from_load_parameter(LIKE, clearance, friction, "centre", "fixed")
    run, worn = wearing(problem, Grid.arc(BOTTOM - 1.4, BOTTOM + 1.4, 31)), np.zeros(31)
    step(run, {"P": 1.0})
    for number in range(1, steps + 1):
        rubbed, _ = step(run, {"rotation": path / coefficient * number / steps})
        worn += run.wear(coefficient * rubbed).depth
    depth, pressure = wear_limits.rigid_sliding(clearance, path, friction)
    yield relative_check("depth", float(worn.max()), depth)
    yield relative_check("peak N", float(run.now.pressure.max()), pressure)


def half_planes(nodes: int, load_parameter: float, solving: Solving) -> Checks:
    """The final state of partial slip in half-planes; see :func:`final_state`."""
    last, half = final_state(nodes, load_parameter)
    solving.note(last.states)
    volume, depth, _ = wear_limits.final_volume(LOAD_RATIO)
    middle = float(last.pressure[last.theta.size // 2]) * math.pi * half / 2.0
    yield relative_check("volume", last.volume / (load_parameter * half**3), volume)
    yield relative_check("depth", last.depth / (load_parameter * half**2), depth)
    yield relative_check("N, middle", middle, float(wear_limits.final_pressure(np.zeros(1), LOAD_RATIO)[0]))


def final_state(nodes: int, load_parameter: float) -> tuple[WornCycle, float]:
    """The contact after very many cycles of partial slip, and half its width by Hertz.

    The stick zone has so many `nodes` on either side of the middle. Its edge lies midway between two nodes.
    """
    tau, cycles = 1000.0, 100_000
    half = math.sqrt(1.0 / (math.pi * load_parameter))
    spacing = half * math.sqrt(1.0 - LOAD_RATIO) / (nodes + 0.5)
    side = math.ceil(1.35 * half / spacing)
    grid = Grid(BOTTOM + spacing * np.arange(-side, side + 1))
    friction, push = 0.5, 0.5 * LOAD_RATIO
    problem = Problem.from_load_parameter(LIKE, load_parameter, friction, "centre", "fixed")
    history = LoadHistory([{"P": 1.0}, {"Q": push}]) + LoadHistory([{"Q": -push}, {"Q": push}]).repeated(1)
    wear = Wear(tau * half / cycles, cycles=cycles, at=[cycles], tolerance=0.1)
    recorder = CyclesInMemory()
    WearTask(problem, history, wear, SolveOptions(), grid).follow(recorder)
    return recorder.cycles[-1], half


def energy(solving: Solving) -> Checks:
    """The work of the loads along a wear path, against energy, dissipation and the material that goes."""
    run, depth, _ = fretted(121)
    before = review(run.system, run.now).energy
    removal = run.wear(20.0 * depth)
    given = before + removal.work
    yield relative_check("energy", review(run.system, run.now).energy + removal.dissipation + removal.energy, given)
