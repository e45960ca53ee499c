"""The loop over corners: progress, and the place at which a load is lost."""

import logging

import numpy as np
import pytest

import fastpin
from fastpin.model.grid import Grid
from fastpin.solver.errors import ArcError, NoEquilibriumError
from tests.support.tiers import gate

ARC = (-0.5 * np.pi - 0.6, -0.5 * np.pi + 0.6)
"""Too narrow for the load P = 1."""

METHODS = [{}, *gate({"method": "increment", "increments": 400})]


@pytest.fixture(scope="module")
def frictionless(similar) -> fastpin.Problem:
    return fastpin.Problem.from_load_parameter(similar, 0.1, 0.0)


@pytest.fixture(scope="module")
def held(similar) -> fastpin.Problem:
    return fastpin.Problem.from_load_parameter(similar, 0.3, 0.4, "centre", "fixed")


def lost(problem: fastpin.Problem, corners: list[dict[str, float]], **options) -> ArcError:
    with pytest.raises(ArcError) as raised:
        fastpin.solve(problem, corners, nodes=81, arc=ARC, **options)
    return raised.value


@pytest.mark.parametrize("method", METHODS, ids=["path", "increment"])
def test_the_lost_load_does_not_depend_on_corners_and_stops(frictionless, method):
    """Without friction the contact reaches the end of the arc at one load, whatever corners and stops lie before."""
    tolerance = 1e-9 if not method else 1.0 / 400
    whole = lost(frictionless, [{"P": 1.0}])
    assert 0.1 < whole.fraction < 0.9
    for corners, begin in (([{"P": 1.0}], 0.0), ([{"P": 0.02}, {"P": 1.0}], 0.02), ([{"P": 0.1}, {"P": 2.0}], 0.1)):
        for between in (0, 3):
            error = lost(frictionless, corners, between=between, **method)
            end = corners[-1]["P"]
            assert error.step == len(corners) - 1
            assert sum(state.fraction == 1.0 for state in error.result) == error.step
            assert error.load["P"] == pytest.approx(whole.load["P"], abs=2.0 * end * tolerance)
            assert error.fraction == pytest.approx((error.load["P"] - begin) / (end - begin), abs=1e-12)
            assert f"at {100.0 * error.fraction:.4g} %" in str(error)


def test_a_load_lost_after_a_reversal_is_placed_in_the_whole_step(frictionless):
    """The second piece of a step begins where the force passes through zero."""
    circle = {"nodes": 121, "arc": (-0.5 * np.pi - 0.6 - np.pi, -0.5 * np.pi + 0.6)}
    with pytest.raises(ArcError) as raised:
        fastpin.solve(frictionless, [{"P": 0.05}, {"P": -2.0}], **circle)
    error = raised.value
    assert error.load["P"] < 0.0
    assert error.fraction == pytest.approx((0.05 - error.load["P"]) / 2.05, abs=1e-12)


def test_a_moment_is_lost_at_the_same_load_with_and_without_stops(similar):
    problem = fastpin.Problem.from_load_parameter(similar, 0.1, 0.1)
    loads = []
    for between in (0, 1, 4):
        with pytest.raises(NoEquilibriumError) as raised:
            fastpin.solve(problem, [{"P": 1.0}, {"M": 1.0}], nodes=81, between=between)
        assert raised.value.fraction == pytest.approx(raised.value.load["M"], rel=1e-12)
        loads.append(raised.value.load["M"])
    assert np.ptp(loads) < 1e-9


@pytest.mark.parametrize("method", METHODS, ids=["path", "increment"])
@pytest.mark.parametrize("between", [0, 2])
def test_progress_grows_from_corner_to_corner(held, method, between):
    seen: list[float] = []

    def progress(done: float, total: int) -> None:
        assert total == 3
        seen.append(done)

    grid = fastpin.Grid.arc(-3.0, -0.14, 61)
    fastpin.solve(held, [{"P": 1.0}, {"Q": 0.2}, {"Q": -0.2}], grid=grid, between=between, progress=progress, **method)
    assert np.all(np.diff(seen) >= 0.0)
    assert seen[-1] == 3.0
    assert {1.0, 2.0} <= set(seen)
    if between:
        assert {1.0 / 3.0, 2.0 / 3.0} <= set(seen)
    if method:
        steps = np.diff([0.0, *seen])
        assert steps.max() < 0.02  # 400 increments a step, growing from the first contact


def test_a_contact_that_is_let_go_is_warned_of(similar, caplog):
    """The force turns all round while it is next to nothing: its contact is narrower than the nodes."""
    problem = fastpin.Problem.from_load_parameter(similar, 1.0, 0.4, "centre", "fixed")
    with caplog.at_level(logging.WARNING, "fastpin"):
        result = fastpin.solve(problem, [{"P": 1.0}, {"P": -1.0, "Q": 1e-6}], grid=Grid.circle(61))
    assert result.statistics["released"] == 1
    assert [record.getMessage() for record in caplog.records] == [
        "1 times a narrow contact that carried less than 0.1 % of the force was let go and lost its memory"
    ]


def test_beyond_the_arc_of_an_earlier_result_that_arc_is_to_be_wider(frictionless):
    first = fastpin.solve(frictionless, [{"P": 0.02}], nodes=81, arc=ARC)
    with pytest.raises(ArcError, match="solve that result on a wider arc") as raised:
        fastpin.solve(frictionless, [{"P": 1.0}], start=first)
    assert str(raised.value).startswith("step 1, at ")
