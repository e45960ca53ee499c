"""Figures of the commands, drawn coarsely."""

from __future__ import annotations

import pytest


@pytest.fixture(autouse=True)
def _rough(monkeypatch: pytest.MonkeyPatch) -> None:
    """Bitmaps of few dots: the tests of figures look at their quality, and the tests of commands at their names."""
    monkeypatch.setattr("fastpin.figures.style.number_of_dots", lambda dpi: 30.0)
