"""The choice of the arc of nodes: the quick coarse run finds the arc of the careful ones, within one of their nodes."""

import math

import numpy as np
import pytest

from fastpin import Grid, LoadHistory, Problem
from fastpin.model import LOADS
from fastpin.model.loads import REMOTE
from fastpin.solver import ArcError, arc
from fastpin.solver.errors import ResolutionError
from fastpin.solver.run import Run
from fastpin.solver.task import reference_force
from tests.support.slip_cases import LIKE
from tests.support.tiers import seeds
from tests.survey.histories import random_case


def touched_arc(problem: Problem, history: LoadHistory) -> tuple[float, float] | None:
    values = history.distinct()
    return arc._touched_arc(problem, values, reference_force(problem, values), 101, None)


def is_simple(seed: int) -> bool:
    problem, history = random_case(seed)
    values = history.distinct()
    return not values[:, REMOTE].any() and arc._estimated_arc(problem, values) is not None


def test_the_quick_run_finds_the_arc_of_the_careful_ones(monkeypatch: pytest.MonkeyPatch) -> None:
    for seed in filter(is_simple, seeds(12)):
        problem, history = random_case(seed)
        estimated = arc._estimated_arc(problem, history.distinct())
        quick = touched_arc(problem, history)
        with monkeypatch.context() as patch:
            patch.setattr(arc, "_quick_arc", lambda *_: None)
            careful = touched_arc(problem, history)
        assert estimated is not None
        assert quick is not None
        assert careful is not None
        spacing = (estimated[1] - estimated[0]) / (arc.COARSE_NODES - 1)
        assert quick == pytest.approx(careful, abs=1.001 * spacing)


@pytest.mark.parametrize(
    ("corners", "wider"),
    [([{"P": 1.0}, {"P": 1.0, "sxx": 0.01}], 0.0), ([{"P": 1e-3}], 1.0)],
    ids=["remote stress", "little contact"],
)
def test_the_quick_run_leaves_the_others_to_the_careful_ones(corners: list[dict[str, float]], wider: float) -> None:
    problem, values = Problem.from_load_parameter(LIKE, 0.1, 0.3), LoadHistory(corners).distinct()
    estimated = arc._estimated_arc(problem, values)
    assert estimated is not None
    wide = estimated[0] - wider, estimated[1] + wider
    assert arc._quick_arc(problem, values, wide, reference_force(problem, values), None) is None


def test_the_estimate_of_a_close_fit_tends_to_the_one_of_a_neat_fit() -> None:
    load, close = np.eye(len(LOADS))[:1], Problem.from_load_parameter(LIKE, 1e-6, 0.3)
    neat = Problem(LIKE, 1.0, 0.0, 0.3)
    assert arc._estimated_arc(close, load) == pytest.approx(arc._estimated_arc(neat, load))


@pytest.mark.parametrize("start", [-6.0, -1.5, 0.0, 3.0, 6.0])
def test_the_arc_of_a_circle_is_in_the_turn_around_the_bottom(start: float) -> None:
    grid, margin = Grid.circle(100, start=start), 3
    bottom, step = -0.5 * math.pi, 0.02 * math.pi
    touched = np.flatnonzero(np.cos(grid.theta - bottom) > 0.8)
    found = arc._arc_of_circle(grid, touched, margin)
    assert found is not None
    half = 0.5 * (touched.size - 1 + 2 * margin) * step
    assert found == pytest.approx((bottom - half, bottom + half), abs=0.51 * step)


def test_grids_grow_to_the_whole_circle() -> None:
    """Each arc is wider than the one before and shorter than a whole one. The circle is the last grid."""
    problem = Problem.from_load_parameter(LIKE, 0.1, 0.3)
    values = LoadHistory([{"P": 1.0}]).distinct()
    *arcs, last = arc.candidate_grids(problem, values, reference_force(problem, values), 61)
    assert last.closed
    lengths = [float(np.ptp(grid.theta)) for grid in arcs]
    assert len(lengths) > 2
    assert lengths == sorted(lengths)
    assert lengths[-1] < arc.WHOLE < 1.25 * lengths[-1]


def test_a_search_to_and_fro_ends(monkeypatch: pytest.MonkeyPatch) -> None:
    """A narrow contact is lost on wide arcs, and a wide one reaches the ends of narrow arcs: twelve coarse runs."""
    lengths = []

    def follow(run: Run) -> None:
        lengths.append(float(np.ptp(run.system.grid.theta)))
        if lengths[-1] < 0.5:
            raise ArcError("wide")
        run.touched[60:62] = True
        raise ResolutionError("narrow")

    monkeypatch.setattr(Run, "follow", follow)
    monkeypatch.setattr(arc, "_quick_arc", lambda *_: None)
    monkeypatch.setattr(arc, "_touched_in_whole_steps", lambda *_: None)
    assert touched_arc(Problem.from_load_parameter(LIKE, 0.1, 0.3), LoadHistory([{"P": 1.0}])) is not None
    assert len(lengths) == 12
    assert min(lengths) < 0.5 < max(lengths)


def test_coarse_runs_follow_no_change_of_the_load_twice() -> None:
    up, down, twice = {"Q": 0.1}, {"Q": -0.1}, {"P": 2.0}
    corners = LoadHistory([{"P": 1.0}, up, down, up, down, twice, up, down, up]).distinct()
    left = arc._without_repetition(corners)
    assert np.array_equal(left, corners[:7])  # with P = 2 the change of Q is another one
    assert np.array_equal(arc._without_repetition(corners[:5]), corners[:3])
    assert np.array_equal(arc._without_repetition(corners[:1]), corners[:1])


def test_the_arc_of_cycles_is_wide_enough_after_their_first_change(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of 120 random contacts, one had another arc after all cycles, by one node of the coarse run."""
    for seed in seeds(4):
        rng = np.random.default_rng(seed)
        problem = Problem.from_load_parameter(LIKE, 10.0 ** rng.uniform(-2.0, 1.0), rng.uniform(0.1, 0.9), "centre")
        force = rng.uniform(0.1, 0.9) * problem.friction_at(np.zeros(1))[0]
        history = LoadHistory([{"P": 1.0}, *4 * [{"Q": force}, {"P": rng.uniform(0.4, 1.0), "Q": -force}]])
        first = touched_arc(problem, history)
        monkeypatch.setattr(arc, "_without_repetition", lambda values: values)
        assert touched_arc(problem, history) == first
