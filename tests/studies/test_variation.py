"""Fields of a plan replace what contradicts them in the base case."""

import numpy as np
import pytest

import fastpin
from fastpin.casefile import builtin_case
from fastpin.errors import CaseFileError
from fastpin.model.loads import FRICTION_CHANGE, P
from fastpin.studies.plan import parse_plan
from fastpin.studies.variation import field_words, with_values
from tests.support.faults import fault_of


def test_the_path_solver_drops_the_increments_of_the_base_case():
    tables = {"solve": {"method": "increment", "increments": 5}}
    assert with_values(tables, {"solve.method": "path"}) == {"solve": {"method": "path"}}
    assert with_values(tables, {"solve.nodes": 41})["solve"]["increments"] == 5
    assert tables["solve"]["increments"] == 5


def test_error_bars_of_a_sweep_need_enough_nodes():
    words = "line 3: solve.nodes: must be at least 101 for error bars, not 99: a second run takes half of them"
    with pytest.raises(CaseFileError, match=words):
        parse_plan('[grid]\n"solve.error_bars" = [true]\n"solve.nodes" = [99]\n')
    assert len(parse_plan('[grid]\n"solve.error_bars" = [true, false]\n"solve.nodes" = [101]\n').runs) == 2


def test_a_factor_multiplies_the_loads_of_all_blocks():
    plan = parse_plan('[grid]\nloads = [1.0, 0.5]\n"loads.Q" = [1.0, -2.0]\n')
    whole = builtin_case().history.values()
    for point, (all_loads, of_q) in zip(plan.points, [(1.0, 1.0), (1.0, -2.0), (0.5, 1.0), (0.5, -2.0)], strict=True):
        found = plan.case(point).history.values()
        assert (found[:, 0] == all_loads * whole[:, 0]).all()
        assert (found[:, 1] == all_loads * of_q * whole[:, 1]).all()
    assert np.abs(whole[:, 1]).max() > 0.0
    assert plan.points[0].id == parse_plan('[grid]\n"contact.friction" = [0.4]\n').points[0].id
    assert (field_words("loads"), field_words("loads.P")) == ("factor of all loads", "factor of the force P")


def test_a_factor_leaves_the_friction_and_its_changes():
    history = fastpin.LoadHistory([{"P": 2.0, "friction_change": 0.5}, {"P": 4.0}])
    assert history.scaled({"P": 3.0}).values()[:, [P, FRICTION_CHANGE]].tolist() == [[6.0, 0.5], [12.0, 0.5]]
    with pytest.raises(fastpin.InputError, match="factors: unknown load"):
        history.scaled({"p": 3.0})


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("loads = [true]", "loads: must be a number, not true"),
        ("loads = [1e307]", "loads: given: must be finite"),
        ("loads = [1e300]", "loads: P: must lie between"),
        ('"loads.PP" = [1.0]', '"loads.PP": is no factor, did you mean "loads.P"?'),
        ("loads = { from = 1.0, to = 2.0 }", "loads: count is missing"),
    ],
)
def test_faults_of_factors_have_their_line(text: str, message: str):
    line, found = fault_of(parse_plan, f"[grid]\n{text}\n")
    assert line == 2
    assert found.startswith(message)
