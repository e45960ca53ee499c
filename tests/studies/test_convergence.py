"""Convergence studies: what they say of cases whose answer is known, and what they refuse."""

import math
from typing import Any

import numpy as np
import pytest

from fastpin import Grid, InputError, LoadHistory, MaterialPair, Problem, Result, converge, solve
from fastpin.report.convergence import reported_series
from fastpin.solver import ArcError
from fastpin.studies import convergence
from fastpin.studies.convergence import Convergence, QuantitySeries, StudyInterrupted, StudyLostError
from fastpin.verification import closed_forms
from tests.support.studies import CORNERS, GRIDS, small_problem, small_study
from tests.support.tiers import for_gate

BOTTOM = -0.5 * math.pi


@pytest.fixture(scope="module")
def problem(similar: MaterialPair) -> Problem:
    return small_problem(similar)


@pytest.fixture(scope="module")
@for_gate
def study(problem: Problem) -> Convergence:
    return small_study(problem)


def series(study: Convergence, name: str, corner: int = 3, method: int = 0) -> QuantitySeries:
    return next(each for each in study.studies[method].series if (each.name, each.corner) == (name, corner))


def test_a_smooth_peak_is_of_second_order(similar: MaterialPair) -> None:
    frictionless = Problem.from_load_parameter(similar, 0.1, 0.0)
    half = closed_forms.persson_half_angle(0.1)
    exact = closed_forms.persson_pressure(0.0, half)
    found = converge(frictionless, [{"P": 1.0}], (101, 201, 401, 801), arc=(BOTTOM - 1.2 * half, BOTTOM + 1.2 * half))
    peak = series(found, "peak_pressure", 1).estimate
    assert peak.verdict == "observed"
    assert peak.order == pytest.approx(2.0, abs=0.3)
    assert abs(peak.limit - exact) < abs(series(found, "peak_pressure", 1).values[-1] - exact)
    for each in found.studies[0].series:
        true = {"peak_pressure": exact, "contact_1_stop": BOTTOM + half, "contact_width": 2.0 * half}.get(each.name)
        if true is not None:
            assert abs(each.values[-1] - true) <= each.estimate.bar


def test_what_balance_and_symmetry_make_exact_has_no_order(study: Convergence) -> None:
    for name, corner in (("P", 1), ("Q", 3), ("M", 2), ("rotation", 1), ("dx", 1), ("shear_integral", 1)):
        assert series(study, name, corner).estimate.verdict == "to rounding", name
    assert series(study, "work").estimate.verdict != "to rounding"


def test_differences_are_relative_to_the_value_and_for_places_to_the_contact(study: Convergence) -> None:
    peak, place, motion = (series(study, name) for name in ("peak_pressure", "peak_shear_angle", "contact_1_start"))
    width = series(study, "contact_width").values[-1]
    assert peak.reference == abs(peak.values[-1])
    assert place.reference == motion.reference == pytest.approx(width)
    for each in (peak, place, motion):
        assert each.estimate.scatter == pytest.approx(np.ptp(each.values[-3:]) / each.reference)
    zero = series(study, "dx", 1)  # by symmetry
    assert zero.reference == convergence.LEAST_REFERENCE * zero.size > abs(zero.values[-1])


def test_all_grids_have_one_arc_and_a_node_under_the_first_force(study: Convergence, problem: Problem) -> None:
    assert study.complete
    assert list(study.loads) == [1, 2, 3]
    assert study.loads[3]["Q"] == -0.2
    assert np.abs(study.grid.theta - BOTTOM).min() < 1e-12
    assert np.abs(study.grid.theta[::4] - BOTTOM).min() < 1e-12  # on the coarsest one, too
    for count, value in zip(GRIDS, series(study, "dissipation").values, strict=True):
        grid = Grid.arc(float(study.grid.theta[0]), float(study.grid.theta[-1]), count)
        assert solve(problem, CORNERS, grid=grid)[-1].dissipation == value


def test_increments_tend_to_the_path_on_the_same_grid(study: Convergence, problem: Problem) -> None:
    path, increment = study.studies
    assert (path.method, path.counts, increment.method, increment.counts) == (
        "path", GRIDS, "increment", (5, 10, 20),
    )  # fmt: skip
    assert increment.nodes == 51
    work = series(study, "work", 3, 1)
    assert work.path == series(study, "work").values[0]
    errors = np.abs(np.subtract(work.values, work.path))
    assert errors[2] < 0.5 * errors[0]
    assert math.isnan(series(study, "work").path)


@pytest.mark.gate
def test_a_long_history_shows_its_last_corner_or_the_one_asked_for(problem: Problem) -> None:
    history = LoadHistory([{"P": 1.0}]) + LoadHistory([{"Q": 0.2}, {"Q": -0.2}]).repeated(20)
    last = converge(problem, history, GRIDS)
    assert list(last.loads) == [41]
    assert {each.corner for each in last.studies[0].series} == {41}
    second = converge(problem, history, GRIDS, corner=2)
    assert list(second.loads) == [2]
    assert second.loads[2]["Q"] == 0.2


@pytest.mark.gate
def test_other_ratios_and_the_whole_circle(problem: Problem) -> None:
    found = converge(problem, CORNERS[:2], (60, 75, 110), arc=(0.0, 2.0 * math.pi))
    assert found.grid.closed
    assert found.grid.size == 110
    assert np.abs(np.sin(0.5 * (found.grid.theta - BOTTOM))).min() < 1e-12
    assert series(found, "P", 2).estimate.verdict == "to rounding"
    uneven = converge(problem, CORNERS[:2], (60, 75, 110), corner=1)
    assert series(uneven, "peak_pressure", 1).values[-1] == pytest.approx(
        series(found, "peak_pressure", 1).values[-1], rel=1e-2
    )


def test_an_arc_too_narrow_for_the_fine_grid_is_widened_for_all(problem, monkeypatch):
    spans = []

    def narrow(*arguments: Any, grid: Grid, **options: Any) -> Result:
        spans.append((grid.size, grid.theta[-1] - grid.theta[0]))
        if grid.size == 101 and len(spans) < 3:
            raise ArcError("the contact reaches an end")
        return solve(*arguments, grid=grid, **options)

    monkeypatch.setattr(convergence, "solve", narrow)
    converge(problem, CORNERS[:1], GRIDS)
    assert [size for size, _ in spans] == [51, 101, 51, 101, 201]
    assert spans[2][1] > 1.2 * spans[0][1]


@pytest.mark.parametrize(
    ("options", "field", "words"),
    [
        ({"nodes": (101, 201)}, "nodes", "at least 3 numbers"),
        ({"nodes": (101, 201, 201)}, "nodes", "must increase from one to the next, but 201 follows 201"),
        ({"nodes": (50, 101, 201)}, "nodes", "whole number from 51 to 20000, not 50"),
        ({"nodes": (101, 201, 30_000)}, "nodes", "whole number from 51 to 20000, not 30000"),
        ({"nodes": (101.5, 201, 401)}, "nodes", "whole number"),
        ({"nodes": "101"}, "nodes", "at least 3 numbers"),
        ({"nodes": (101, 105, 201)}, "nodes", "grow by a tenth at least to show an order, but 105 follows 101"),
        ({"increments": 20}, "increments", "must be at least 3 numbers, from which an order follows, not 20"),
        ({"increments": (20, 40)}, "increments", "at least 3 numbers"),
        ({"increments": (20, 10, 40)}, "increments", "but 10 follows 20"),
        ({"increments": (0, 10, 40)}, "increments", "at least 1, not 0"),
        ({"increment_nodes": 101}, "increment_nodes", "give increments"),
        ({"increments": (5, 10, 20), "increment_nodes": 20}, "increment_nodes", "from 51 to 20000, not 20"),
        ({"corner": 4}, "corner", "1 to 3, not 4"),
        ({"corner": 0}, "corner", "at least 1"),
        ({"arc": (1.0, 0.0)}, "arc", "from a smaller to a larger angle"),
    ],
    ids=str,
)
def test_input_is_checked_before_anything_is_solved(options, field, words, problem, monkeypatch):
    monkeypatch.setattr(convergence, "solve", None)
    with pytest.raises(InputError, match=words) as refused:
        converge(problem, CORNERS, **options)
    assert refused.value.field == field


@pytest.mark.gate
def test_loads_that_a_grid_cannot_carry_name_it(problem: Problem) -> None:
    with pytest.raises(StudyLostError, match=r"^with 51 nodes: step 2, at 47") as lost:
        converge(problem, [{"P": 1.0}, {"M": 1.0}], GRIDS, (5, 10, 20))
    study = lost.value.study
    assert list(study.loads) == [1]
    assert [found.counts for found in study.studies] == [GRIDS, (5, 10, 20)]
    assert not study.complete
    with pytest.raises(StudyLostError, match=r"^with 51 nodes: ") as at_once:
        converge(problem, [{"P": 1.0}, {"M": 1.0}], GRIDS, corner=2)
    assert at_once.value.study is None


@pytest.mark.gate
def test_a_grid_that_does_not_fit_in_memory_leaves_the_others(problem, monkeypatch):
    def limited(*arguments: Any, grid: Grid, **options: Any) -> Result:
        if grid.size > 201:
            raise MemoryError
        return solve(*arguments, grid=grid, **options)

    monkeypatch.setattr(convergence, "solve", limited)
    with pytest.raises(StudyLostError, match="with 301 nodes: not enough memory") as lost:
        converge(problem, CORNERS, (51, 101, 201, 301))
    assert lost.value.study.studies[0].counts == (51, 101, 201)


@pytest.mark.gate
def test_a_corner_is_studied_on_the_arc_of_the_whole_history(problem: Problem) -> None:
    whole, one = converge(problem, CORNERS, GRIDS), converge(problem, CORNERS, GRIDS, corner=2)
    assert np.array_equal(whole.grid.theta, one.grid.theta)
    assert list(one.loads) == [2]
    assert [each for each in whole.studies[0].series if each.corner == 2] == list(one.studies[0].series)


def test_a_study_prints_shortly(problem: Problem) -> None:
    assert repr(converge(problem, CORNERS[:1], GRIDS)) == "<Convergence: path: 51-101-201; corners 1>"


def test_a_contact_of_few_nodes_is_refused(problem: Problem) -> None:
    with pytest.raises(InputError, match="51 put only 5 in the contact at corner 1") as refused:
        converge(problem, [{"P": 1e-2}], GRIDS, arc=(BOTTOM - 1.0, BOTTOM + 1.0))
    assert refused.value.field == "nodes"


@pytest.mark.gate
@pytest.mark.parametrize(("at", "grids", "studies"), [("201", 0, 0), ("301", 3, 1), ("20 inc", 4, 1)])
def test_an_interrupt_keeps_three_grids(at: str, grids: int, studies: int, problem: Problem) -> None:
    def progress(done: float, total: float, what: str) -> None:
        assert 0.0 <= done <= total
        if what.startswith(at):
            raise KeyboardInterrupt

    with pytest.raises(StudyInterrupted) as stopped:
        converge(problem, CORNERS, (51, 101, 201, 301), (5, 10, 20), 51, progress=progress)
    kept = stopped.value.study
    assert (kept is None) == (not grids)
    if kept is not None:
        assert not kept.complete
        assert len(kept.studies) == studies
        assert len(kept.studies[0].counts) == grids


# -- outcomes --------------------------------------------------------------------------------------------------

REPEATED = LoadHistory([{"P": 1.0}]) + LoadHistory([{"Q": 0.2}, {"Q": -0.2}]).repeated(4)
"""Nine corners, of which the last is studied."""


@pytest.mark.gate
def test_an_outcome_at_the_end_has_the_estimate_of_its_quantity(problem: Problem) -> None:
    given = {"end_work": {"quantity": "work"}, "own": lambda result: result[-1].work}
    study = converge(problem, CORNERS, GRIDS, (5, 10, 20), 51, outcomes=given)
    for method in (0, 1):
        work, end_work, own = (series(study, name, method=method) for name in ("work", "end_work", "own"))
        assert end_work.values == own.values == work.values
        assert end_work.estimate == work.estimate == own.estimate
        assert end_work.size == work.size
        assert end_work.path == own.path == work.path or method == 0
    assert [each.corner for each in study.studies[0].series if each.outcome] == [3, 3]
    assert study.unread == {}


@pytest.mark.gate
def test_outcomes_of_the_history_and_of_its_last_cycle(problem: Problem) -> None:
    given = {
        "loss": {"cycle": "dissipation"},
        "shear": {"quantity": "peak_shear", "take": "largest magnitude"},
        "walk": {"quantity": "peak_pressure_angle", "take": "range", "over": "cycle"},
        "place": {"quantity": "peak_pressure_angle", "take": "largest"},
    }
    study = converge(problem, REPEATED, GRIDS, outcomes=given)
    assert list(study.loads) == [9]
    for count, loss, shear, walk in zip(
        GRIDS, *(series(study, name, 9).values for name in ("loss", "shear", "walk")), strict=True
    ):
        result = solve(problem, REPEATED, grid=study.grid.with_nodes(count))
        assert loss == result.cycles[-1].dissipation
        assert shear == max(abs(state.peak_shear) for state in result)
        places = [state.peak_pressure_angle for state in result][-3:]
        assert walk == pytest.approx(max(places) - min(places))
    reported = {row.name: row for row in reported_series(study.studies[0], problem, 9)}
    units = [reported[name].unit.name for name in ("walk", "place", "loss")]
    assert units == ["deg", "deg", "F^2 beta*"]
    assert reported["walk"].values[-1] == pytest.approx(math.degrees(series(study, "walk", 9).values[-1]))
    assert reported["place"].values[-1] == pytest.approx(math.degrees(series(study, "place", 9).values[-1]) + 90.0)
    without = converge(problem, REPEATED, GRIDS)
    assert [each for each in study.studies[0].series if not each.outcome] == list(without.studies[0].series)


def test_an_outcome_that_fails_on_one_grid_is_not_comparable(problem: Problem) -> None:
    def fine(result: Result) -> float:
        if result.grid.size == 101:
            raise ValueError("not here")
        return result[-1].work

    study = converge(problem, CORNERS, GRIDS, outcomes={"fine": fine})
    found = series(study, "fine")
    assert found.estimate.verdict == "not comparable"
    assert [math.isnan(value) for value in found.values] == [False, True, False]
    assert study.unread["fine"].startswith("101 nodes: ValueError: not here (test_convergence.py, line ")


def test_a_lost_study_has_no_outcomes(problem: Problem) -> None:
    with pytest.raises(StudyLostError) as lost:
        converge(problem, [{"P": 1.0}, {"M": 1.0}], GRIDS, outcomes={"own": lambda result: result[-1].work})
    assert not any(each.outcome for each in lost.value.study.studies[0].series)


@pytest.mark.parametrize("name", ["work", "contact_1_start", "stick_12_stop"])
def test_an_outcome_must_not_have_the_name_of_a_quantity(name: str, problem: Problem) -> None:
    with pytest.raises(InputError, match=f"outcomes: {name}: is a quantity that every study has"):
        converge(problem, CORNERS, GRIDS, outcomes={name: {"cycle": "dissipation"}})
