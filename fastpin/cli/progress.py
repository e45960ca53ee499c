"""The progress of all commands: a bar on a terminal, and a few lines elsewhere, such as in a log."""

from __future__ import annotations

import math
import sys
import time
from collections.abc import Callable
from types import TracebackType
from typing import Any, TextIO

from fastpin.cli.terminal import say

LOAD_POINTS = "{whole} of {total:,} load points"
"""Text of the progress bar of a run."""

READ_POINTS = "checking the plan, {whole} of {total:,} points"
"""Text of the progress bar while a plan is read."""

DELAY = 2.0
"""Seconds after which a bar appears. Most runs are finished before: then tqdm, which takes 60 ms, is not imported."""

FIRST_LINE, RARER = 5.0, 2.0
"""Seconds after which a log has its first line, and the growth of the time until each next one: an hour has ten."""


def _words(seconds: float) -> str:
    """A duration in words, with one or two digits."""
    units = ("second", 1.0, 60.0), ("minute", 60.0, 90.0), ("hour", 3600.0, 36.0), ("day", 86400.0, math.inf)
    unit, length = next((unit, length) for unit, length, most in units if seconds < most * length)
    count = max(round(seconds / length), 1)
    return f"{count:,} {unit}{'' if count == 1 else 's'}"


class Bar:
    """The progress of `total` units on standard error: on a terminal a bar after two seconds, else a line now and then.

    A line has the part that is done and an estimate of the time that is left. The first one comes after five seconds,
    each next one after twice the time, so that a log stays short.

    `text` is a format with the fields of tqdm, such as ``{n} of {total}``, and ``{whole}``, the units that are done to
    the end.

    Attributes
    ----------
    n, total : float
        Units done, and all units.
    """

    def __init__(self, total: float, text: str) -> None:
        self.n: float = 0
        self.total = total
        self._text = text
        self._description = ""
        self._begin = time.time()
        self._before: float = 0
        self._next_line = FIRST_LINE
        self._shown: Any = None

    def __enter__(self) -> Bar:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._shown is not None:
            self._shown.close()
        elif self._next_line > FIRST_LINE and error is None:
            self._say(self.total, f"done in {_words(time.time() - self._begin)}")

    def update(self, more: float) -> None:
        """Move the progress by `more` units."""
        self.n += more
        passed = time.time() - self._begin
        if passed < 0.5:  # work that was done before, such as that of a stored run, tells no speed
            self._before = self.n
        if self._shown is None and passed > DELAY and sys.stderr.isatty():
            self._show()
        if self._shown is not None:
            self._shown.total = self.total
            self._shown.update(self.n - self._shown.n)
        elif passed > self._next_line and not sys.stderr.isatty():
            self._next_line = RARER * passed
            done, left = self.n - self._before, self.total - self.n
            if done > 0.0 and left > 0.0:
                self._say(self.n, f"about {_words(passed * left / done)} left")

    def _say(self, n: float, what: str) -> None:
        """Write a line with the text of the bar after `n` units."""
        whole = {"n": round(n), "whole": f"{int(n):,}", "total": round(self.total), "desc": self._description}
        say(f"fastpin: {n / self.total:.0%}: {self._text.format(**whole)}, {what}", file=sys.stderr)

    def describe(self, what: str) -> None:
        """Change ``{desc}`` in the text."""
        self._description = what
        if self._shown is not None:
            self._shown.set_description_str(what, refresh=False)

    def write(self, *lines: str, file: TextIO) -> None:
        """Print lines above the bar."""
        if self._shown is None:
            say(*lines, file=file)
        else:
            with self._shown.external_write_mode(file=file):
                say(*lines, file=file)

    def _show(self) -> None:
        from tqdm import tqdm

        class WholeUnits(tqdm):  # type: ignore[misc]
            """A bar that also knows the whole units."""

            @property
            def format_dict(self) -> dict[str, Any]:
                return {**super().format_dict, "whole": f"{int(self.n):,}"}

        form = f"{{percentage:3.0f}}% |{{bar}}| {self._text}, {{remaining}} left"
        self._shown = WholeUnits(
            total=self.total, desc=self._description, leave=False, file=sys.stderr, bar_format=form
        )  # fmt: skip
        self._shown.start_t = self._begin  # the time that remains follows from all of the time before


def progress_to(progress_bar: Bar) -> Callable[[float, float], None]:
    """Return a callable ``progress(done, total)`` that moves a bar."""

    def progress(done: float, total: float) -> None:
        progress_bar.total = total
        progress_bar.update(done - progress_bar.n)

    return progress
