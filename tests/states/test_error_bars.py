"""The quantities that are reported, how those of two grids are compared, and error bars of states."""

import json
import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fastpin.casefile.reader import EXAMPLE
from fastpin.cli.main import main
from fastpin.errors import InputError
from fastpin.model.grid import Grid, halved
from fastpin.model.history import LoadHistory
from fastpin.model.materials import MaterialPair
from fastpin.model.problem import Problem
from fastpin.solver import solving
from fastpin.solver.errors import Interrupted, NoEquilibriumError
from fastpin.solver.result import Result
from fastpin.solver.solving import solve
from fastpin.states.error_bars import LEAST_COARSE, bars
from fastpin.states.quantities import QUANTITIES, matching_values, quantity, size, values
from fastpin.states.state import ErrorBars, State
from fastpin.storage.store import load, save
from fastpin.studies.run_end import KEY_FIGURES, key_figures
from fastpin.verification import closed_forms

BOTTOM = -0.5 * math.pi
CORNERS: list[dict[str, float]] = [{"P": 1.0}, {"Q": 0.2}, {"Q": -0.2}]

WITH_BARS = {name for name, each in QUANTITIES.items() if not each.classes}
"""Quantities with error bars; a class has none."""


@pytest.fixture(scope="module")
def problem(similar: MaterialPair) -> Problem:
    return Problem.from_load_parameter(similar, 0.5, 0.5, "centre")


@pytest.fixture
def case(tmp_path: Path) -> Path:
    path = tmp_path / "case.toml"
    path.write_text(EXAMPLE)
    return path


# -- quantities ----------------------------------------------------------------------------------------------


def test_every_quantity_has_a_kind_and_a_size(problem: Problem) -> None:
    state = solve(problem, CORNERS, nodes=51)[-1]
    for name, value in values(state).items():
        assert quantity(name).of(state) == pytest.approx(value, rel=0.0, nan_ok=True)
        assert 0.0 < size(name, state) < math.inf
    assert {"contact_1_start", "stick_1_stop", "shear_magnitude"} <= set(values(state))
    assert values(state)["P"] == pytest.approx(1.0)


def test_key_figures_say_the_same(problem: Problem) -> None:
    result = solve(problem, CORNERS, nodes=51)
    figures, mine = key_figures(result), values(result[-1])
    for name in set(KEY_FIGURES) & set(QUANTITIES):
        scale = math.degrees(1.0) if quantity(name).kind in ("angle", "width") else 1.0
        shift = 90.0 if quantity(name).kind == "angle" else 0.0
        assert figures[name] == pytest.approx(scale * mine[name] + shift)


def test_angles_are_compared_across_the_seam_and_shears_across_their_sign(problem: Problem) -> None:
    state = solve(problem, CORNERS[:1], grid=Grid.circle(120, BOTTOM))[-1]
    other = solve(problem, CORNERS[:1], grid=Grid.circle(120, BOTTOM + math.pi))[-1]
    theirs = matching_values(state, other)
    for name, value in values(state).items():
        assert theirs[name] == pytest.approx(value, abs=1e-9, nan_ok=True)
    mirrored = replace(state, shear=-state.shear)
    assert matching_values(state, mirrored)["peak_shear"] == state.peak_shear
    assert math.isnan(matching_values(state, mirrored)["peak_shear_angle"])


def test_zones_that_are_not_as_many_are_not_compared(problem: Problem) -> None:
    partial, sliding = solve(problem, CORNERS, nodes=101)[1:]
    none = replace(sliding, status=np.where(sliding.status == 2, 2, 1).astype(np.int8))
    theirs = matching_values(partial, none)
    assert math.isnan(theirs["stick_1_start"])
    assert theirs["stick_width"] == 0.0
    assert math.isfinite(theirs["contact_1_start"])
    assert "stick_1_start" not in matching_values(none, partial)
    assert bars(partial, none)["stick_1_start"] == math.inf


# -- error bars ----------------------------------------------------------------------------------------------


def test_error_bars_leave_the_states_as_they_are(problem: Problem) -> None:
    plain, barred = (solve(problem, CORNERS, nodes=101, between=1, error_bars=bars) for bars in (False, True))
    assert barred.coarse.grid.size < 60
    for one, two in zip(plain, barred, strict=True):
        assert np.array_equal(one.pressure, two.pressure)
        assert one.error_bars is None
        assert set(two.error_bars) == set(values(two))
        assert (two.error_bars.coarse.step, two.error_bars.coarse.fraction) == (two.step, two.fraction)


def test_error_bars_hold_against_the_closed_form(similar: MaterialPair) -> None:
    for parameter in (0.05, 0.3, 1.0):
        smooth = Problem.from_load_parameter(similar, parameter, 0.0)
        state = solve(smooth, [{"P": 1.0}], nodes=101, error_bars=True)[-1]
        half = closed_forms.persson_half_angle(parameter)
        error = abs(state.peak_pressure - closed_forms.persson_pressure(0.0, half))
        assert error <= state.error_bars["peak_pressure"] < 1e-2 * state.peak_pressure
        assert abs(state.contact[0][1] - BOTTOM - half) <= state.error_bars["contact_1_stop"] < 0.1 * half
        assert state.error_bars["P"] < 1e-9
        assert math.isnan(state.error_bars["peak_shear_angle"])  # there is no shear


@pytest.mark.parametrize("nodes", [101, 102, 103, 104])
@pytest.mark.parametrize("place", [40, 41])
def test_a_coarse_grid_has_twice_the_spacing_and_the_node_of_the_force(nodes: int, place: int) -> None:
    fine = Grid.arc(-3.0, 0.0, nodes)
    coarse = halved(fine, float(fine.theta[place]))
    assert np.diff(coarse.theta) == pytest.approx(2.0 * (fine.theta[1] - fine.theta[0]))
    assert np.abs(coarse.theta - fine.theta[place]).min() < 1e-12
    assert coarse.theta[0] <= fine.theta[0]
    assert coarse.theta[-1] >= fine.theta[-1]
    circle = Grid.circle(nodes)
    half = halved(circle, float(circle.theta[place]))
    assert half.closed
    assert half.size == (nodes + 1) // 2
    assert half.uniform
    nearly = Grid.arc(0.0, 2.0 * math.pi - 0.05, nodes)
    assert halved(nearly, None).size >= nodes // 2


def test_a_graded_grid_is_halved_node_by_node(problem: Problem) -> None:
    x = np.linspace(-1.0, 1.0, 121)
    grid = Grid(BOTTOM + 1.2 * np.sin(0.5 * math.pi * x))
    assert np.array_equal(halved(grid, BOTTOM).theta, grid.theta[::2])
    assert halved(Grid(grid.theta[:-1]), None).theta[-1] == grid.theta[-2]
    state = solve(problem, CORNERS, grid=grid, error_bars=True)[-1]
    assert 0.0 < state.error_bars["work"] < 1e-3


@pytest.mark.gate
@pytest.mark.parametrize("options", [{"keep": "cycles"}, {"keep": "every 7"}, {"shortcut": False}], ids=str)
def test_long_histories_have_error_bars(options: dict[str, Any], problem: Problem) -> None:
    history = LoadHistory([{"P": 1.0}]) + LoadHistory([{"Q": 0.2}, {"Q": -0.2}]).repeated(15)
    result = solve(problem, history, nodes=101, error_bars=True, **options)
    assert len(result) > 3
    for state in result:
        assert (state.error_bars["dissipation"] > 0.0) == (state.dissipation > 0.0)


def test_the_increment_solver_has_error_bars(problem: Problem) -> None:
    state = solve(problem, CORNERS, nodes=101, method="increment", increments=4, error_bars=True)[-1]
    assert 0.0 < state.error_bars["peak_pressure"] < 0.1


def test_a_branch_has_error_bars_if_its_trunk_has(problem: Problem) -> None:
    arc = (BOTTOM - 1.3, BOTTOM + 1.3)
    trunk, bare = (solve(problem, CORNERS[:2], nodes=101, arc=arc, error_bars=bars) for bars in (True, False))
    branch = solve(problem, CORNERS[2:], start=trunk, error_bars=True)
    whole = solve(problem, CORNERS, grid=trunk.grid, error_bars=True)
    assert branch[-1].error_bars == whole[-1].error_bars
    assert solve(problem, CORNERS[2:], start=trunk)[-1].error_bars is None
    with pytest.raises(InputError, match="error_bars: the result to continue from was solved without them"):
        solve(problem, CORNERS[2:], start=bare, error_bars=True)


def test_error_bars_show_their_numbers(problem: Problem) -> None:
    bars = solve(problem, CORNERS, nodes=101, error_bars=True)[-1].error_bars
    shown = repr(bars)
    assert isinstance(bars, ErrorBars)
    assert shown.startswith(f"<ErrorBars from {bars.coarse.grid.size} nodes: peak_pressure ")
    for name, bar in bars.items():
        assert (f" {name} {bar:.2g}" in shown) == (not math.isnan(bar))


def test_too_few_nodes_for_error_bars(problem: Problem) -> None:
    least = 2 * LEAST_COARSE - 1
    for options in ({"nodes": least - 1}, {"grid": Grid.arc(-3.0, 0.0, least - 1)}):
        with pytest.raises(InputError, match=f"nodes: must be at least {least} for error bars"):
            solve(problem, CORNERS, error_bars=True, **options)
    assert solve(problem, CORNERS, nodes=least, error_bars=True)[-1].error_bars


def test_a_coarse_grid_that_loses_the_load_leaves_the_result(problem: Problem, monkeypatch: pytest.MonkeyPatch) -> None:
    original, grids = solving._follow_task, []

    def lost(task: Any, start: Result | None) -> Result:
        grids.append(task.grid)
        if len(grids) == 2:
            raise NoEquilibriumError("the pin slides away") if stop is None else stop
        return original(task, start)

    monkeypatch.setattr(solving, "_follow_task", lost)
    stop: BaseException | None = None
    with pytest.raises(NoEquilibriumError, match=r"slides away \(on the coarse grid of \d+ nodes") as ended:
        solve(problem, CORNERS, nodes=101, error_bars=True)
    assert len(ended.value.result) == 3
    grids, stop = [], Interrupted()
    with pytest.raises(Interrupted) as interrupted:
        solve(problem, CORNERS, nodes=101, error_bars=True)
    assert interrupted.value.result[-1].error_bars is None


def test_a_peak_that_may_be_elsewhere_has_a_wide_angle(problem: Problem) -> None:
    """After a little force to one side the shear is nearly as high on the left as on the right."""
    states = solve(problem, [{"P": 1.0}, {"Q": 1e-4}], nodes=101, error_bars=True)
    for state, is_wide in zip(states, (False, True), strict=True):
        apart = 2.0 * abs(state.peak_shear_angle - BOTTOM)
        bar = state.error_bars["peak_shear_angle"]
        assert bar == pytest.approx(apart, rel=0.1) if is_wide else bar < 0.1 * apart
        assert state.error_bars["peak_pressure_angle"] < 0.1 * apart


@pytest.mark.gate
def test_saved_results_keep_their_error_bars(problem: Problem, tmp_path: Path) -> None:
    result = solve(problem, CORNERS, nodes=101, between=1, error_bars=True)
    save(result, tmp_path / "a.h5")
    found = load(tmp_path / "a.h5")
    for state, expected in zip(found, result, strict=True):
        assert dict(state.error_bars) == to_rounding(expected)
        assert state.error_bars.shear == pytest.approx(expected.error_bars.shear, rel=1e-9, abs=1e-12)
    assert dict(load(tmp_path / "a.h5", states=[2])[0].error_bars) == to_rounding(result[2])
    branches = [solve(problem, [{"Q": 0.1}], start=start, error_bars=True)[-1] for start in (found, result)]
    assert dict(branches[0].error_bars) == to_rounding(branches[1])
    save(replace(result, coarse=None), tmp_path / "a.h5")
    assert load(tmp_path / "a.h5")[-1].error_bars is None


def to_rounding(state: State) -> Any:
    """The bars of a state, to rounding: the sums of some BLAS kernels depend on the place of an array in memory."""
    return pytest.approx(dict(state.error_bars), rel=1e-9, abs=1e-12, nan_ok=True)


@pytest.mark.gate
def test_runs_and_their_files_show_error_bars(case: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path, document = (str(case.parent / name) for name in ("a.h5", "a.json"))
    assert main(["run", str(case), "--nodes", "101", "--error-bars", "-o", path, "--json", document]) == 0
    table = capsys.readouterr().out.splitlines()[:-1]
    assert table[3].count("+-") == 8
    state = json.loads(Path(document).read_text())["states"][-1]
    assert 0.0 < state["error_bars"]["contact_1_start"] < 3.0  # degrees
    assert set(state["error_bars"]) > WITH_BARS
    assert set(QUANTITIES) - {"P", "Q", "M"} <= set(state)
    assert main(["show", path]) == 0
    assert capsys.readouterr().out.splitlines()[:-1] == table
    assert main(["run", str(case), "--error-bars", "--nodes", "99", "-o", path, "--overwrite"]) == 2
    assert "nodes: must be at least 101 for error bars, not 99" in capsys.readouterr().err
    branch = str(case.parent / "b.h5")
    assert main(["run", str(case), "--start", path, "--error-bars", "-o", branch]) == 2
    assert "--error-bars: a run that continues another one has none in a file" in capsys.readouterr().err
    assert main(["run", str(case), "--start", path, "--error-bars"]) == 0
    assert "+-" in capsys.readouterr().out


def test_a_contact_that_is_gone_has_error_bars(problem: Problem) -> None:
    state = solve(problem, [{"P": 1.0}, {"P": 0.0}], nodes=101, error_bars=True)[-1]
    assert not state.in_contact
    assert state.error_bars["peak_pressure"] == state.error_bars["contact_width"] == 0.0
    assert math.isnan(state.error_bars["peak_pressure_angle"])
    assert not state.error_bars.pressure.any()
    assert not state.error_bars.shear.any()


def test_a_contact_all_round_has_no_ends(titanium_in_aluminium: MaterialPair) -> None:
    fit = Problem(titanium_in_aluminium, 0.01, -1e-5, 0.4, "body")
    state = solve(fit, [{"P": 1e5}], nodes=120, error_bars=True)[-1]
    assert state.error_bars["contact_width"] == 0.0
    assert set(state.error_bars) == WITH_BARS
    assert 0.0 < state.error_bars["peak_pressure"] < 1e-3 * state.peak_pressure
