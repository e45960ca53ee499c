"""Progress in whole load points, and the time that is left."""

import contextlib
import io
import sys
from types import SimpleNamespace

import pytest

from fastpin.cli import progress
from fastpin.cli.progress import LOAD_POINTS, Bar


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
def test_the_time_that_is_left_is_told_in_words(length: float, words: str) -> None:
    assert progress._words(length) == words


def test_progress_counts_whole_load_points(monkeypatch: pytest.MonkeyPatch) -> None:
    terminal = io.StringIO()
    terminal.isatty = lambda: True  # type: ignore[method-assign]
    monkeypatch.setattr(sys, "stderr", terminal)
    monkeypatch.setattr(progress, "DELAY", -1.0)
    with Bar(2000, LOAD_POINTS) as bar:
        bar.update(1234.9)
        bar._shown.refresh()
    assert "| 1,234 of 2,000 load points, " in terminal.getvalue()


def lines_of(seconds: int, monkeypatch: pytest.MonkeyPatch, stored: int = 0) -> list[str]:
    """The lines on standard error of a run of 1,000 load points in so many seconds, one after the other."""
    clock = [0.0]
    monkeypatch.setattr(progress, "time", SimpleNamespace(time=lambda: clock[0]))
    monkeypatch.setattr(progress, "FIRST_LINE", 5.0)
    log = io.StringIO()
    monkeypatch.setattr(sys, "stderr", log)
    with Bar(1000 + stored, LOAD_POINTS) as bar:
        bar.update(stored)
        for _ in range(1000):
            clock[0] += seconds / 1000
            bar.update(1)
    return log.getvalue().splitlines()


def test_a_log_has_few_lines_with_the_time_left(monkeypatch: pytest.MonkeyPatch) -> None:
    assert lines_of(4, monkeypatch) == []
    assert lines_of(142, monkeypatch) == [
        "fastpin: 4%: 36 of 1,000 load points, about 2 minutes left",
        "fastpin: 7%: 73 of 1,000 load points, about 2 minutes left",
        "fastpin: 15%: 147 of 1,000 load points, about 2 minutes left",
        "fastpin: 29%: 294 of 1,000 load points, about 2 minutes left",
        "fastpin: 59%: 589 of 1,000 load points, about 59 seconds left",
        "fastpin: 100%: 1,000 of 1,000 load points, done in 2 minutes",
    ]
    assert len(lines_of(86400, monkeypatch)) == 11


def test_stored_work_does_not_make_the_time_left_short(monkeypatch: pytest.MonkeyPatch) -> None:
    assert (
        lines_of(142, monkeypatch, stored=9000)[0] == "fastpin: 90%: 9,036 of 10,000 load points, about 2 minutes left"
    )


def test_a_failure_ends_without_a_last_line(monkeypatch: pytest.MonkeyPatch) -> None:
    clock, log = [0.0], io.StringIO()
    monkeypatch.setattr(progress, "time", SimpleNamespace(time=lambda: clock[0]))
    monkeypatch.setattr(progress, "FIRST_LINE", 5.0)
    monkeypatch.setattr(sys, "stderr", log)
    with contextlib.suppress(KeyboardInterrupt), Bar(4, LOAD_POINTS) as bar:
        clock[0] = 8.0
        bar.update(1)
        raise KeyboardInterrupt
    assert log.getvalue() == "fastpin: 25%: 1 of 4 load points, about 24 seconds left\n"
