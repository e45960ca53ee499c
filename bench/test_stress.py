"""Times of the stresses of a steady state: a million points in the plate, the hoop stress round the hole, its peak.

    FASTPIN_BENCH_SIZES=101,401,1601 pytest bench/test_stress.py --benchmark-columns=min,median

A copy of the state has no power laws and no tree of blocks yet. The times of the curve and the peak include them.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from typing import Any

import cases
import numpy as np
import pytest

import fastpin
from fastpin.bodies import Bushing, Plate, Ring
from fastpin.elasticity.tractions import Tractions, cauchy_integrals
from fastpin.runtime import threads as work

Timed = Callable[..., Any]

POINTS, FEW = 1_000_000, 50_000
"""Points in the plate, and those of a run without timing. Both are shared between two threads."""

SUMMED = 20_000
"""Points of the plain sum over all nodes; one thread computes them."""

WALL = 0.5
"""Walls of the ring and of the bush, in units of R."""

BODIES = {
    "plate": Plate(),
    "reaction": Plate((0.0, -4.0)),
    "ring": Ring(1.0 + WALL, "half"),
    "bush": Bushing(fastpin.Material(1.5, 0.3), 1.0 + WALL),
}
"""The plates that are timed, by name."""

ANGLES = np.linspace(-np.pi, np.pi, 720, endpoint=False)
"""Angles of a curve round the hole, rad."""


def places(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Angles, rad, and depths from 1e-6 to 2 hole radii, evenly in the logarithm."""
    rng = np.random.default_rng(cases.SEED)
    return rng.uniform(-np.pi, np.pi, count), 10.0 ** rng.uniform(-6.0, np.log10(2.0), count)


@pytest.mark.parametrize("threads", [1, 2])
@pytest.mark.benchmark(group="stress")
def test_points(benchmark: Any, request: pytest.FixtureRequest, monkeypatch: Any, nodes: int, threads: int) -> None:
    """Time the stress at many points in the plate. Both numbers of threads give the same bits."""
    state = cases.steady_state(nodes)[-1]
    theta, depth = places(FEW if request.config.getoption("benchmark_disable") else POINTS)
    points = fastpin.Points.at_depth(depth, theta)
    assert state.stress(points).hoop.size == theta.size  # makes power laws and blocks
    monkeypatch.setattr(work, "cores", lambda: threads)
    found = benchmark.pedantic(lambda: state.stress(points), rounds=3)
    benchmark.extra_info.update(nodes=nodes, points=theta.size, threads=threads)
    monkeypatch.setattr(work, "cores", lambda: 3 - threads)
    other = state.stress(points)
    for name in ("radial", "hoop", "shear"):
        assert np.array_equal(getattr(found, name), getattr(other, name))


@pytest.mark.parametrize("name", BODIES)
@pytest.mark.benchmark(group="stress of bodies")
def test_bodies(benchmark: Any, request: pytest.FixtureRequest, nodes: int, name: str) -> None:
    """Time the stress at many points of other plates, under the tractions of the steady state."""
    state = cases.steady_state(nodes)[-1]
    state = dataclasses.replace(state, problem=dataclasses.replace(state.problem, plate_body=BODIES[name]))
    theta, depth = places(FEW if request.config.getoption("benchmark_disable") else POINTS)
    points = fastpin.Points.at_depth(np.minimum(depth, 0.99) * WALL, theta)
    assert state.stress(points).hoop.size == theta.size  # makes power laws, blocks and harmonics
    found = benchmark.pedantic(lambda: state.stress(points), rounds=3)
    benchmark.extra_info.update(nodes=nodes, points=theta.size)
    assert np.isfinite(found.hoop).all()


@pytest.mark.parametrize("way", ["blocks", "all nodes"])
@pytest.mark.benchmark(group="Cauchy integrals")
def test_integrals(timed: Timed, nodes: int, way: str) -> None:
    """Time the integrals by expansions of far blocks, and by the closed form summed over all nodes."""
    blocks = cases.steady_state(nodes)[-1].refined.tractions
    plain = Tractions(blocks.patches)
    *tree, radii, moments = blocks.tree
    plain.__dict__["tree"] = (*tree, np.full_like(radii, np.inf), moments)
    theta, depth = places(SUMMED)
    chosen = blocks if way == "blocks" else plain
    found = timed(lambda: cauchy_integrals(chosen, theta, np.log1p(depth), True), nodes, threads=1, points=SUMMED)
    other = cauchy_integrals(plain if way == "blocks" else blocks, theta, np.log1p(depth), True)
    assert np.abs(found - other)[:, :2].max() < 1e-11


@pytest.mark.benchmark(group="hoop stress")
def test_hoop_curve(timed: Timed, nodes: int) -> None:
    state = cases.steady_state(nodes)[-1]
    curve = timed(
        lambda fresh: fresh.hoop_stress("plate", ANGLES), nodes, least=5, setup=lambda: dataclasses.replace(state)
    )
    assert curve.shape == ANGLES.shape


@pytest.mark.benchmark(group="peak hoop stress")
def test_peak(timed: Timed, nodes: int) -> None:
    state = cases.steady_state(nodes)[-1]
    peak = timed(lambda fresh: fresh.peak_hoop_stress(), nodes, least=5, setup=lambda: dataclasses.replace(state))
    assert peak.value > 0.5
