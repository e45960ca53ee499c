"""Commands run in a folder of their own."""

import math
from pathlib import Path

import pytest

from fastpin.cli import progress


@pytest.fixture(autouse=True)
def _inside(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(progress, "FIRST_LINE", math.inf)  # a busy machine would have lines of progress


@pytest.fixture
def case(request: pytest.FixtureRequest) -> Path:
    """The case file of a test: the text CASE of its module."""
    path = Path("case.toml")
    path.write_text(request.module.CASE)
    return path
