"""Friction, rig and offsets from loops whose truth is known."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from fastpin.model.history import LoadHistory
from fastpin.studies.identification import FITTED, Identified, held_loads, identify
from fastpin.studies.loop_fit import curvature_factor
from tests.support.loops import PRESSED, THICKNESS, Measured, joint
from tests.support.refusals import refused

RIG = 250e6 / THICKNESS
WIDE = Measured(80e-6, 60, 0.005)


def fitted(measured: Measured, seed: int = 0, **options: Any) -> Identified:
    return identify(measured.guess(), [PRESSED], measured.loop(measured.clean(), seed), **options)


def assert_inside(found: Identified, **truth: float) -> None:
    """Each true value lies in its interval, widened to 99.9 %."""
    for name, true in truth.items():
        value, low, high = found.estimates[name]
        ends = np.sort(1.0 / np.array([high, low])) if name in ("friction", "stiffness") else (low, high)
        middle, at = (1.0 / value, 1.0 / true) if name in ("friction", "stiffness") else (value, true)
        assert middle - 1.7 * (middle - ends[0]) <= at <= middle + 1.7 * (ends[1] - middle), name


@pytest.mark.gate
def test_a_loop_gives_friction_rig_and_offsets() -> None:
    found = fitted(WIDE)
    size = np.ptp(found.loop.force) / 2.0
    assert_inside(found, friction=0.68, stiffness=RIG, displacement_offset=0.2 * 80e-6, force_offset=0.03 * size)
    assert found.frictions[0].high / found.frictions[0].low < 1.3
    assert 0.8 < found.scatter < 1.2
    assert found.problem == replace(
        WIDE.joint(), friction=found.frictions[0].value, rig_stiffness=found.estimates["stiffness"].value
    )
    ((measured, deviation, computed),) = found.energies
    assert abs(measured - computed) < 3.0 * deviation
    assert found.notes == ()


@pytest.mark.gate
def test_drift_is_fitted() -> None:
    found = fitted(replace(WIDE, drift=0.05), fit=["stiffness", "drift"], nodes=25)
    size = np.ptp(WIDE.clean()[1]) / 2.0
    assert_inside(found, friction=0.68, stiffness=RIG, displacement_drift=4e-6, force_drift=0.05 * size)


@pytest.mark.gate
def test_scale_is_fitted_with_a_known_rig() -> None:
    known = replace(WIDE.joint(), friction=0.5)
    found = identify(known, [PRESSED], WIDE.loop(WIDE.clean(), 1), ["scale"], nodes=41)
    assert_inside(found, friction=0.68, scale=1.0)
    assert found.problem.rig_stiffness == RIG


@pytest.mark.gate
@pytest.mark.parametrize(
    ("measured", "options"),
    [
        (replace(WIDE, begins=1.1, cycles=1.5), {"start": "cycle"}),
        (Measured(6e-3, 60, 0.005, rig=30e3 / THICKNESS, names=("rotation", "M")), {"nodes": 25}),
        (replace(WIDE, samples=100, cycles=0.7), {}),
    ],
    ids=["in a cycle", "rotation", "one turning point"],
)
def test_other_loops(measured: Measured, options: dict[str, Any]) -> None:
    assert_inside(fitted(measured, **options), friction=0.68, stiffness=measured.rig)


@pytest.mark.gate
def test_each_cycle_has_its_friction() -> None:
    found = fitted(replace(WIDE, samples=40, changes=(0.0, 0.15), nodes=61), by_cycle=True, nodes=25)
    assert [name for name in found.estimates if name.startswith("friction")] == ["friction 1", "friction 2"]
    for each, true in zip(found.frictions, (0.68, 0.782), strict=True):
        assert each.low * 0.97 < true < each.high * 1.03


@pytest.mark.gate
def test_a_stuck_loop_tells_no_friction() -> None:
    found = fitted(Measured(2e-6, 40, 0.005, cycles=1.25))
    (friction,) = found.frictions
    assert np.isnan(friction.value)
    assert friction.low < 0.68 < 2.5 < friction.high
    assert found.notes[0].startswith("friction: the loop does not tell it; ")
    assert_inside(found, stiffness=RIG)


TURNS = np.linspace(0.0, 2.0, 60)
LOOP = {"ux": 1e-5 * np.sin(2.0 * np.pi * TURNS), "Q": 1e5 * np.sin(2.0 * np.pi * TURNS)}


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"loop": {"ux": [1.0]}}, 'loop: must map "ux" and "Q", "uy" and "P" or "rotation" and "M" to samples'),
        ({"loop": {"ux": [1.0], "P": [1.0]}}, "loop: must map"),
        ({"loop": {"uy": [1.0], "P": [1.0]}}, "uy: a displacement can be prescribed only where"),
        ({"fit": ["friction"]}, "fit: must be"),
        ({"fit": 3}, "fit: must be a list of names, not 3"),
        ({"start": "now"}, 'start: must be "rest" or "cycle", not "now"'),
        ({"nodes": 2}, "nodes: must be a whole number from 5 to 20000"),
        ({"by_cycle": 1}, "by_cycle: must be true or false"),
        ({"progress": 3}, "progress: must be a callable"),
        ({"problem": joint(0.0)}, "friction: must be positive: it is the first guess"),
        ({"problem": joint(lambda angle: 0.3 + 0.1 * np.cos(angle))}, "friction: must be a number: a profile"),
        ({"problem": 3}, "problem: must be a Problem, not 3"),
        ({"history": [{"P": 1e5}, {"P": 2e5}, {"P": 3e5}]}, "P: must be constant: only the measured load changes"),
        ({"history": []}, "history: must have at least one load corner"),
        (
            {"problem": joint(rotation="free")},
            'rotation: must be "fixed" or "spring": a free pin rolls under ux, and tells no friction',
        ),
        ({"loop": LOOP | {"Q": -LOOP["Q"]}}, "Q: falls where ux rises: turn its sign"),
    ],
)
def test_wrong_arguments_are_refused(change: dict[str, Any], words: str) -> None:
    given: dict[str, Any] = {"problem": joint(), "history": [PRESSED], "loop": LOOP} | change
    error = refused(identify, given.pop("problem"), given.pop("history"), given.pop("loop"), **given)
    assert str(error).startswith(words)


def test_constant_loads_are_the_middle_of_the_history() -> None:
    rows = [{"P": 1e5}, *({"P": 1e5 * (1.0 + 0.004 * k), "ux": 1e-6 * k} for k in (1, -1, 0, 2, -2))]
    assert held_loads(LoadHistory(rows), ("ux", "Q")) == {"P": 1e5}
    assert held_loads(LoadHistory([{"P": 1e5, "sxx": 2e6}]), ("ux", "Q")) == {"P": 1e5, "sxx": 2e6}


@pytest.mark.parametrize("radius", [3.0, 6.0])
def test_a_curved_fit_has_a_wider_interval(radius: float) -> None:
    """Noise of two samples beside a circle: the sum of squares at the truth, less that of the nearest point."""
    angles = np.array([-1.96, 0.0, 1.96]) / radius
    points = radius * np.column_stack([np.cos(angles), np.sin(angles)])
    noise = np.random.default_rng(1).normal(size=(200_000, 2))
    more = (noise**2).sum(axis=1) - (np.linalg.norm(points[1] + noise, axis=1) - radius) ** 2
    reach = 1.96 * curvature_factor(*points)
    assert 0.95 <= np.mean(more < reach**2) < 0.975
    assert reach > 1.96 + 0.3 / radius


def test_a_straight_fit_has_the_usual_interval() -> None:
    line = np.outer([-1.0, 0.0, 2.0], [0.6, 0.8, 0.0])
    assert curvature_factor(*line) == pytest.approx(1.0, abs=1e-6)


def test_what_is_fitted_is_named() -> None:
    assert FITTED == ("stiffness", "clearance", "drift", "scale")
