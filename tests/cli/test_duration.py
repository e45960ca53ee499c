"""Times that are expected, and progress in whole load points."""

from __future__ import annotations

import io
import sys
import time
from pathlib import Path

import numpy as np
import pytest

import fastpin
from fastpin.casefile.reader import EXAMPLE, builtin_case
from fastpin.cli import progress
from fastpin.cli.main import main
from fastpin.cli.progress import LOAD_POINTS, Bar, note_duration
from fastpin.model.options import SolveOptions
from fastpin.solver.duration import SETTLED, expected_seconds

CASE = builtin_case()
PUSH = fastpin.LoadHistory([{"P": 2.42e6}])
CYCLE = fastpin.LoadHistory([{"Q": 7e5}, {"Q": -7e5}])


def seconds(history: fastpin.LoadHistory, **options: object) -> float:
    return expected_seconds(CASE.problem, history, SolveOptions(**options))


def test_the_time_is_expected_within_a_factor_of_ten() -> None:
    """Measured on a busy machine: factors of 0.4 to 1.7. Other machines may be slower."""
    history = PUSH + CYCLE.repeated(30)
    fastpin.solve(CASE.problem, history, nodes=51)
    began = time.process_time()
    fastpin.solve(CASE.problem, history, nodes=401)
    measured = time.process_time() - began
    assert 0.1 < seconds(history, nodes=401) / measured < 10.0


def test_reversals_cost_a_step_and_straight_steps_little() -> None:
    reversals = fastpin.LoadHistory([{"Q": (-1) ** k * 1e5} for k in range(200)])
    straight = fastpin.LoadHistory([{"Q": 1e3 * k} for k in range(1, 201)])
    assert seconds(reversals) > 10.0 * seconds(straight)
    coarse, fine = (
        fastpin.LoadHistory.harmonic({"P": 2e6}, {"Q": 5e5, "sxx": 2e7}, {"sxx": 90}, 10, points) for points in (24, 48)
    )
    assert seconds(coarse) < seconds(fine) < 1.6 * seconds(coarse)


def test_cycles_that_repeat_cost_nothing() -> None:
    few, many = (PUSH + CYCLE.repeated(count) for count in (SETTLED, 1000 * SETTLED))
    assert seconds(few) == seconds(many)
    assert seconds(many, shortcut=False) == pytest.approx(1000 * seconds(few), rel=0.2)
    assert seconds(PUSH + CYCLE) < seconds(few)


def test_nodes_increments_and_error_bars_cost_time() -> None:
    history = PUSH + CYCLE
    assert 4.0 < seconds(history, nodes=1601) / seconds(history, nodes=801) < 6.5
    assert seconds(history, method="increment", increments=80) > 20.0 * seconds(history)
    assert seconds(history, error_bars=True) == 1.25 * seconds(history)
    assert seconds(history, between=1000) > 2.0


def test_a_history_without_motion_has_a_time() -> None:
    assert np.isfinite(seconds(fastpin.LoadHistory([{"P": 0.0}, {"P": 0.0}])))


@pytest.mark.parametrize(
    ("length", "words"),
    [
        (61.0, "1 minute"),
        (150.0, "2 minutes"),
        (5000.0, "83 minutes"),
        (7200.0, "2 hours"),
        (1e5, "28 hours"),
        (1e9, "11,574 days"),
    ],
)
def test_long_work_is_announced_in_words(length: float, words: str, capsys: pytest.CaptureFixture[str]) -> None:
    note_duration(60.0)
    assert capsys.readouterr().err == ""
    note_duration(length, ", with 9 nodes")
    assert capsys.readouterr().err == f"fastpin: note: this will take about {words}, with 9 nodes\n"


@pytest.mark.parametrize("command", ["run", "converge", "sweep"])
def test_each_command_announces_long_work(
    command: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(progress, "LONG", 1e-3)
    monkeypatch.chdir(tmp_path)
    (tmp_path / "case.toml").write_text(EXAMPLE)
    (tmp_path / "plan.toml").write_text('case = "case.toml"\n[grid]\nsolve.nodes = [51, 61]\n')
    arguments = {
        "run": ["run", "case.toml", "--nodes", "101"],
        "converge": ["converge", "case.toml", "--nodes", "51,61,71"],
        "sweep": ["sweep", "plan.toml", "--workers", "1"],
    }
    assert main(arguments[command]) == 0
    more = ", with 101 nodes; half as many take a fifth of the time" if command == "run" else ""
    assert capsys.readouterr().err == f"fastpin: note: this will take about 1 minute{more}\n"
    if command == "sweep":  # nothing is left to do
        assert main(arguments[command]) == 0
        assert capsys.readouterr().err == ""


def test_progress_counts_whole_load_points(monkeypatch: pytest.MonkeyPatch) -> None:
    terminal = io.StringIO()
    terminal.isatty = lambda: True  # type: ignore[method-assign]
    monkeypatch.setattr(sys, "stderr", terminal)
    monkeypatch.setattr(progress, "DELAY", -1.0)
    with Bar(2000, LOAD_POINTS) as bar:
        bar.update(1234.9)
        bar._shown.refresh()
    assert "| 1,234 of 2,000 load points, " in terminal.getvalue()
