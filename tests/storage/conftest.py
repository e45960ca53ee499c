"""The file that a test writes, and a problem."""

from pathlib import Path

import pytest

from fastpin import MaterialPair, Problem


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "a.h5"


@pytest.fixture(scope="session")
def problem(similar: MaterialPair) -> Problem:
    """A pin that is held, with a large friction."""
    return Problem.from_load_parameter(similar, 0.5, 0.55, "centre", "fixed")
