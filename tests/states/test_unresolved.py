"""Numbers that the nodes do not resolve are marked wherever they go."""

import math
from dataclasses import replace

import numpy as np
import pytest

from fastpin import Case, LoadHistory, Problem, Result, SolveOptions, solve
from fastpin.report.states import quantity_column
from fastpin.report.summary import document
from fastpin.states import QUANTITIES
from fastpin.states.error_bars import known_bar
from fastpin.studies.outcome_tables import outcomes_from
from fastpin.studies.outcomes import bar_of, pickled, value_of, values_in_worker
from tests.support.samples import PAIR

LOADS = [{"P": 2e6}, {"P": 5e5}]


@pytest.fixture(scope="module")
def result() -> Result:
    """The nodes resolve the largest hoop stress of the first state, and not that of the second."""
    found = solve(Problem(PAIR, 0.01, 2e-5, 0.4), LOADS, nodes=61)
    assert [state.peak_hoop_stress().resolved for state in found] == [True, False]
    return found


def test_the_error_of_such_a_number_is_not_known(result: Result) -> None:
    for name in ("peak_hoop", "peak_hoop_angle", "kt_bearing"):
        assert [known_bar(name, state) for state in result] == pytest.approx([math.nan, math.inf], nan_ok=True)
    assert all(math.isnan(known_bar("peak_pressure", state)) for state in result)


def test_error_bars_have_a_bar_for_it() -> None:
    found = solve(Problem(PAIR, 0.01, 2e-5, 0.4), LOADS, nodes=101, error_bars=True)
    assert all(0.0 < known_bar("peak_hoop", state) < state.peak_hoop_stress().value for state in found)


def test_tables_of_states_mark_it(result: Result) -> None:
    for name in ("peak_hoop", "peak_hoop_angle", "kt_bearing"):
        assert [cell.endswith(" +-?") for cell in quantity_column(result.problem, result, name)[2]] == [False, True]
    assert not any("?" in cell for cell in quantity_column(result.problem, result, "peak_pressure")[2])
    assert quantity_column(result.problem, result, "kt_gross")[2] == ["nan", "nan"]  # nothing that could be resolved


@pytest.mark.parametrize(
    ("take", "is_known"), [("last", False), ("smallest", False), ("largest", True), ("range", False)]
)
def test_outcomes_of_sweeps_have_a_bar_for_it(result: Result, take: str, is_known: bool) -> None:
    outcome = outcomes_from({"hoop": {"quantity": "peak_hoop", "take": take}})["hoop"]
    value = value_of(outcome, result).value
    assert value is not None
    assert bar_of(outcome, value, result) == (None if is_known else math.inf)
    (read,) = values_in_worker({"hoop": (outcome.definition, pickled(outcome))}, result).values()
    assert read.bar == (None if is_known else math.inf)


def test_other_outcomes_have_no_bar_without_error_bars(result: Result) -> None:
    found = outcomes_from({"N": {"quantity": "peak_pressure", "take": "largest"}, "sum": lambda result: 1.0})
    assert [bar_of(outcome, 1.0, result) for outcome in found.values()] == [None, None]


def test_json_lists_it(result: Result) -> None:
    case = Case(result.problem, LoadHistory(LOADS), SolveOptions(nodes=61))
    states = document(case, result)["states"]
    of_hoop = [name for name, each in QUANTITIES.items() if each.edge == "plate" and math.isfinite(each.of(result[1]))]
    assert "kt_gross" not in of_hoop  # there is no remote stress
    assert [state["unresolved"] for state in states] == [[], of_hoop]
    assert [state["peak_hoop_resolved"] for state in states] == [True, False]


def test_a_data_frame_lists_it(result: Result) -> None:
    pytest.importorskip("pandas")
    column = result.to_dataframe()["unresolved"]
    assert ["peak_hoop" in each.split() for each in column] == [False, True]
    assert column[0] == ""


def test_a_rigid_plate_has_nothing_to_resolve(result: Result) -> None:
    from fastpin.model.materials import Material

    rigid = replace(result.problem, pair=replace(result.problem.pair, plate=Material.rigid()))
    state = solve(rigid, LOADS[:1], nodes=61)[-1]
    assert all(each.is_resolved(state) for each in QUANTITIES.values())
    assert np.isnan(QUANTITIES["peak_hoop"].of(state))
