"""Shared material pairs and problems."""

import gc
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from fastpin.model.materials import MATERIALS, Material, MaterialPair
from fastpin.pages.content import Album, Picture
from tests.support.approx import quicken
from tests.support.drawing import outline_figures
from tests.support.processes import hear_interrupts

hear_interrupts()

pytest_plugins = ["tests.support.tiers", "tests.support.guard"]

OUTLINED = ("cli", "pages", "project", "studies")
"""Folders of tests that need the content of figures. The tests of figures draw them."""

quicken()
gc.disable()  # until all tests are collected


@pytest.hookimpl(wrapper=True, tryfirst=True)
def pytest_collection() -> Iterator[None]:
    """Leave the collected tests to the end of the process: collecting garbage among them took a third of this time."""
    try:
        return (yield)
    finally:
        gc.freeze()
        gc.enable()


@pytest.fixture(scope="session")
def similar() -> MaterialPair:
    """Two like bodies, nu = 0.3, plane strain."""
    return MaterialPair(Material(100e9, 0.3), Material(100e9, 0.3))


@pytest.fixture(scope="session")
def titanium_in_aluminium() -> MaterialPair:
    """The paper's dissimilar pair."""
    return MaterialPair(MATERIALS["Ti-6Al-4V"], MATERIALS["aluminium"])


@pytest.fixture
def drawn() -> None:
    """Figures are drawn, also in the tests of commands, pages, studies and documents."""


@pytest.fixture(autouse=True)
def _outlined_figures(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    if request.path.parent.name in OUTLINED and "drawn" not in request.fixturenames:
        outline_figures(monkeypatch)


@pytest.fixture
def undrawn(monkeypatch: pytest.MonkeyPatch) -> None:
    """Pages without figures, for tests of everything else: a figure takes some tenths of a second."""

    def picture(
        album: Album, draw: Callable[[Path], object], words: str, caption: str, bitmap: bool = False
    ) -> Picture:
        return Picture("", caption, 1)

    monkeypatch.setattr(Album, "picture", picture)
