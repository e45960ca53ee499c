"""Figures are left undrawn in the tests of all commands, unless a test asks for drawn ones."""

from __future__ import annotations

import pytest

from tests.support.drawing import leave_undrawn


@pytest.fixture
def drawn() -> None:
    """Figures are drawn."""


@pytest.fixture(autouse=True)
def _undrawn_figures(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    if "drawn" not in request.fixturenames:
        leave_undrawn(monkeypatch)
