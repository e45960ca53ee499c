"""Pages without figures, for tests of everything else: a figure takes some tenths of a second."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from fastpin.pages.album import Album
from fastpin.pages.content import Picture


@pytest.fixture
def undrawn(monkeypatch: pytest.MonkeyPatch) -> None:
    """Pictures are captions only."""

    def picture(
        album: Album, draw: Callable[[Path], object], words: str, caption: str, bitmap: bool = False
    ) -> Picture:
        return Picture("", caption, 1)

    monkeypatch.setattr(Album, "picture", picture)
