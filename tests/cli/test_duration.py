"""Notes of long work, and progress in whole load points."""

import io
import sys
from pathlib import Path

import pytest

from fastpin.casefile.reader import EXAMPLE
from fastpin.cli import progress
from fastpin.cli.progress import LOAD_POINTS, Bar, note_duration
from tests.support.commands import said


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


@pytest.mark.gate
@pytest.mark.parametrize(
    "command",
    ["run case.toml --nodes 101", "converge case.toml --nodes 51,61,71", "sweep plan.toml --workers 1"],
)
def test_each_command_announces_long_work(command, monkeypatch):
    monkeypatch.setattr(progress, "LONG", 1e-3)
    Path("case.toml").write_text(EXAMPLE)
    Path("plan.toml").write_text('case = "case.toml"\n[grid]\nsolve.nodes = [51, 61]\n')
    more = ", with 101 nodes; half as many take a fifth of the time" if "run" in command else ""
    assert said(*command.split()).err == f"fastpin: note: this will take about 1 minute{more}\n"
    if "sweep" in command:  # nothing is left to do
        assert said(*command.split()).err == ""


def test_progress_counts_whole_load_points(monkeypatch: pytest.MonkeyPatch) -> None:
    terminal = io.StringIO()
    terminal.isatty = lambda: True  # type: ignore[method-assign]
    monkeypatch.setattr(sys, "stderr", terminal)
    monkeypatch.setattr(progress, "DELAY", -1.0)
    with Bar(2000, LOAD_POINTS) as bar:
        bar.update(1234.9)
        bar._shown.refresh()
    assert "| 1,234 of 2,000 load points, " in terminal.getvalue()
