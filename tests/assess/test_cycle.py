"""A load cycle in words, JSON and CSV."""

import json
from dataclasses import replace

import pytest

from fastpin import MATERIALS, LoadHistory, Material, MaterialPair, Problem, Result, solve
from fastpin.assess.cycle import CYCLE, cycle_line, nodes_curve
from fastpin.assess.fatigue import MOST_STOPS, fatigue_lines, spectrum_damages, spectrum_line
from fastpin.assess.outputs import document, json_ready, write_csv
from fastpin.bodies import Bushing
from fastpin.model import FatigueConstants
from fastpin.model.angles import from_bottom
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


def in_sheet(fatigue: FatigueConstants | None, **options: object) -> Result:
    """A titanium pin in a sheet with these constants."""
    pair = MaterialPair(MATERIALS["Ti-6Al-4V"], Material(70e9, 0.33, "", fatigue))
    return solve(Problem(pair, 0.01, 2e-5, 0.4), HISTORY, nodes=61, **options)


@pytest.mark.gate
def test_the_fatigue_of_the_plate_is_told_with_plane_and_life() -> None:
    result = in_sheet(MATERIALS["2024-T3"].fatigue)
    spot = result.fatigue("smith-watson-topper").hot_spot
    (line,) = fatigue_lines(result.states, result.cycles[-1], {})
    assert line.startswith("fatigue of the plate in the last cycle, Smith-Watson-Topper: ")
    assert f"{spot.parameter / 1e3:.4g} kPa at {from_bottom(spot.theta):z.2f} deg" in line
    assert f"normal of the plane {spot.plane * 57.29577951308232:z.2f} deg from +x" in line
    assert line.endswith(f", life {spot.life:.3g} cycles")


def test_fatigue_is_told_without_a_life_if_constants_for_it_are_missing() -> None:
    result = in_sheet(FatigueConstants(yield_strength=3e8))
    assert "life" not in fatigue_lines(result.states, result.cycles[-1], {})[0]
    assert "Smith-Watson-Topper" in fatigue_lines(result.states, result.cycles[-1], {})[0]


@pytest.mark.gate
def test_fatigue_of_bush_and_plate_is_told_if_they_have_constants() -> None:
    known, bronze = MATERIALS["2024-T3"].fatigue, Material(103e9, 0.34)
    history = LoadHistory([{"P": 1e6}, {"P": 2e5}]).repeated(2)
    for bush, bodies in (
        (bronze, ["plate at the seat"]),
        (replace(bronze, fatigue=known), ["bush", "plate at the seat"]),
    ):
        pair = MaterialPair(MATERIALS["steel"], Material(70e9, 0.33, "", known))
        result = solve(Problem(pair, 0.01, 2e-5, 0.4, plate_body=Bushing(bush, 0.0125)), history, nodes=61)
        lines = fatigue_lines(result.states, result.cycles[-1], {})
        assert [line.partition(" in the last")[0] for line in lines] == [f"fatigue of the {body}" for body in bodies]
        spot = result.fatigue("smith-watson-topper", "seat").hot_spot
        assert lines[-1].endswith(f", life {spot.life:.3g} cycles")


def test_rotation_of_a_symmetric_cycle_is_rounding() -> None:
    """Its natural size tells: all cycles turn the pin by some 1e-20 rad."""
    pair = MaterialPair(MATERIALS["steel"], MATERIALS["2024-T3"])
    result = solve(Problem(pair, 0.01, 2e-5, 0.4), LoadHistory([{"P": 1e6}, {"P": 2e5}]).repeated(2), nodes=61)
    assert any(cycle.rotation_change != 0.0 for cycle in result.cycles)
    (line,) = cycle_lines(result.problem, result.cycles, result.states)
    assert line.count("turned 0 rad") == 2


def test_no_fatigue_is_told_without_constants_or_states() -> None:
    bare = in_sheet(None)
    assert fatigue_lines(bare.states, bare.cycles[-1], {}) == []
    result = in_sheet(MATERIALS["2024-T3"].fatigue, between=60)
    assert len(result.cycle().states) > MOST_STOPS
    assert fatigue_lines(result.states, result.cycles[-1], {}) == []
    corners = [state for state in result if state.fraction == 1.0]
    assert fatigue_lines(corners, result.cycles[-1], {})
    assert fatigue_lines(corners[:-1], result.cycles[-1], {}) == []


@pytest.mark.gate
def test_the_damage_of_a_history_without_cycles_is_told() -> None:
    """All corners must be there, three at least, and not too many; the material needs constants of the life."""
    history = LoadHistory([{"P": 1e6}, {"P": 2e6, "Q": 4e5}, {"P": 5e5}])
    sheet = Material(70e9, 0.33, "", MATERIALS["2024-T3"].fatigue)
    result = solve(Problem(MaterialPair(MATERIALS["Ti-6Al-4V"], sheet), 0.01, 2e-5, 0.4), history, nodes=61)
    (found,) = spectrum_damages(result.states, 3)
    line = spectrum_line(found, {})
    spot = result.spectrum_damage().hot_spot
    assert line.startswith("fatigue of the plate over the whole history as a spectrum, Smith-Watson-Topper: life ")
    assert f"life {spot.life:.3g} spectra at {from_bottom(spot.theta):.2f} deg, normal of the plane " in line
    assert spectrum_damages(result.states[1:], 3) == spectrum_damages(result.states, 4) == []
    assert spectrum_damages(result.states[:2], 2) == []
    assert spectrum_damages(result.states * MOST_STOPS, 3) == []
    bare = solve(Problem(MaterialPair(MATERIALS["steel"], MATERIALS["steel"]), 0.01, 2e-5, 0.4), history, nodes=61)
    assert spectrum_damages(bare.states, 3) == []
