"""A load cycle in words, JSON and CSV."""

import json

import pytest

from fastpin import MATERIALS, LoadHistory, MaterialPair, Problem, solve
from fastpin.assess.cycle import CYCLE, cycle_line, nodes_curve
from fastpin.assess.outputs import document, json_ready, write_csv
from fastpin.model.units import units
from fastpin.report.states import cycle_lines
from fastpin.states import LoadCycle
from tests.support.samples import PAIR

HISTORY = LoadHistory([{"P": 2e6}]) + LoadHistory([{"Q": 5e5}, {"Q": -5e5}]).repeated(3)


@pytest.fixture(scope="module")
def cycle() -> LoadCycle:
    problem = Problem(PAIR, 0.01, 2e-5, 0.4, "centre", "fixed")
    return solve(problem, HISTORY, nodes=61, slip_sums=True, between=3).cycle()


def test_a_cycle_is_ready_for_json(cycle: LoadCycle) -> None:
    found = json.loads(json.dumps(json_ready(document(CYCLE, cycle, units(cycle.states[0].problem))), allow_nan=False))
    assert (found["first"], found["last"], found["closed"]) == (5, 7, True)
    assert found["slip_range_is_exact"]
    assert "at the kept states" not in cycle_line(cycle)
    assert found["largest_pressure_range"] == cycle.pressure_range.max()
    assert found["work"] == {name: loop.work for name, loop in cycle.loops.items()}
    assert found["nodes"]["sticks"] == (cycle.behaviour == 1).sum()


def test_a_cycle_without_slip_sums_says_what_it_knows() -> None:
    bare = solve(Problem(PAIR, 0.01, 2e-5, 0.4), HISTORY, nodes=61).cycle()
    found = json_ready(document(CYCLE, bare, units(bare.states[0].problem)))
    assert found["largest_slip_distance"] is found["largest_friction_energy"] is None
    assert not found["slip_range_is_exact"]
    assert cycle_line(bare).startswith(
        "from corner 5 to 7: partial slip (read from the kept states), slip range up to "
    )
    assert "energy" not in cycle_line(bare)
    assert "at the kept states" in cycle_line(bare)


def test_slip_that_is_rounding_is_printed_as_zero() -> None:
    problem = Problem(PAIR, 0.01, 2e-5, 0.9, "body")
    history = LoadHistory([{"P": 2e6}]) + LoadHistory([{"P": 1.99e6}, {"P": 2e6}]).repeated(3)
    still = solve(problem, history, nodes=61, slip_sums=True).cycle()
    assert 0.0 <= still.slip_range.max() < 1e-9
    assert "slip range 0, slip distance 0, friction energy 0" in cycle_line(still)


def test_the_table_names_units(cycle: LoadCycle, tmp_path) -> None:
    write_csv([nodes_curve(cycle)], tmp_path / "c.csv")
    lines = (tmp_path / "c.csv").read_text().splitlines()
    assert lines[0].startswith("angle [deg],behaviour,slip_range [m],slip_distance [m],")
    assert len(lines) == 62
    assert float(lines[31].split(",")[2]) == pytest.approx(cycle.slip_range[30], rel=1e-8)


def test_rotation_of_a_symmetric_cycle_is_rounding() -> None:
    """Its natural size tells: all cycles turn the pin by some 1e-20 rad."""
    pair = MaterialPair(MATERIALS["steel"], MATERIALS["2024-T3"])
    result = solve(Problem(pair, 0.01, 2e-5, 0.4), LoadHistory([{"P": 1e6}, {"P": 2e5}]).repeated(2), nodes=61)
    assert any(cycle.rotation_change != 0.0 for cycle in result.cycles)
    (line,) = cycle_lines(result.problem, result.cycles, result.states)
    assert line.count("turned 0 rad") == 2
