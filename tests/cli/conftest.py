"""Rough figures for the tests of all commands."""

from __future__ import annotations

import pytest

from tests.support.drawing import draw_roughly


@pytest.fixture(autouse=True)
def _rough_figures(monkeypatch: pytest.MonkeyPatch) -> None:
    draw_roughly(monkeypatch)
