"""A load cycle in words, JSON and CSV."""

from __future__ import annotations

import json

import pytest

from fastpin.model.history import LoadHistory
from fastpin.model.problem import Problem
from fastpin.report.cycle import cycle_line, document, write_csv
from fastpin.report.summary import json_ready
from fastpin.solver.solving import solve
from fastpin.states.load_cycle import LoadCycle
from tests.support.samples import PAIR

HISTORY = LoadHistory([{"P": 2e6}]) + LoadHistory([{"Q": 5e5}, {"Q": -5e5}]).repeated(3)


@pytest.fixture(scope="module")
def cycle() -> LoadCycle:
    problem = Problem(PAIR, 0.01, 2e-5, 0.4, "centre", "fixed")
    return solve(problem, HISTORY, nodes=61, slip_sums=True, between=3).cycle()


def test_a_cycle_is_ready_for_json(cycle: LoadCycle) -> None:
    found = json.loads(json.dumps(json_ready(document(cycle)), allow_nan=False))
    assert (found["first"], found["last"], found["closed"]) == (5, 7, True)
    assert found["largest_pressure_range"] == cycle.pressure_range.max()
    assert found["work"] == {name: loop.work for name, loop in cycle.loops.items()}
    assert found["nodes"]["sticks"] == (cycle.behaviour == 1).sum()


def test_a_cycle_without_slip_sums_says_what_it_knows() -> None:
    bare = solve(Problem(PAIR, 0.01, 2e-5, 0.4), HISTORY, nodes=61).cycle()
    found = document(bare)
    assert (
        found["largest_slip_distance"] is found["largest_friction_energy"] is found["largest_slip_range_bound"] is None
    )
    assert cycle_line(bare).startswith("from corner 5 to 7: slip range up to ")
    assert "energy" not in cycle_line(bare)
    assert "at the kept states" in cycle_line(bare)


def test_the_table_names_units(cycle: LoadCycle, tmp_path) -> None:
    write_csv(cycle, tmp_path / "c.csv")
    lines = (tmp_path / "c.csv").read_text().splitlines()
    assert lines[0].startswith("angle [deg],behaviour,slip_range [m],slip_range_bound [m],slip_distance [m],")
    assert len(lines) == 62
    assert float(lines[31].split(",")[2]) == cycle.slip_range[30]
