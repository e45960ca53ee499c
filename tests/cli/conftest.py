"""Commands run in a folder of their own."""

import math
from pathlib import Path

import pytest

from fastpin.cli import progress


@pytest.fixture(autouse=True)
def _inside(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(progress, "FIRST_LINE", math.inf)  # a busy machine would have lines of progress
