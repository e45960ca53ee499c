"""Interrupts at a given place of a history."""

import contextlib
import os
import signal
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fastpin import Interrupted, LoadHistory, Problem, record, resume


class StopAt:
    """Progress that asks to stop where a history has come to a corner, as Ctrl-C would."""

    def __init__(self, corner: float) -> None:
        self.corner = corner

    def __call__(self, done: float, total: int) -> None:
        if total > 1 and done >= self.corner:
            self.corner = np.inf
            os.kill(os.getpid(), signal.SIGINT)


def record_in_parts(problem: Problem, history: LoadHistory, path: Path, stops: float, **options: Any) -> None:
    """Record a history whose run is interrupted after three corners, and after each `stops` more."""
    corner = 3.0
    with pytest.raises(Interrupted):
        record(problem, history, path, progress=StopAt(corner), **options)
    while True:
        corner += stops
        with contextlib.suppress(Interrupted):
            resume(path, StopAt(corner))
            return
