"""Shared material pairs and problems."""

from __future__ import annotations

import contextlib
import gc
import importlib
import os
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings

from fastpin.model.materials import MATERIALS, Material, MaterialPair
from fastpin.pages.album import Album
from fastpin.pages.content import Picture
from tests.support.approx import quicken
from tests.support.processes import hear_interrupts

hear_interrupts()

PROFILE = os.environ.get("FASTPIN_HYPOTHESIS", "gate")


def forget_constants() -> None:
    """Let hypothesis draw no constants of the package's files: reading them takes seconds in each worker.

    The constants also depend on what other tests have imported. Without them the examples are the same in every run.
    Older versions of hypothesis read no constants.
    """
    with contextlib.suppress(ImportError):
        providers = importlib.import_module("hypothesis.internal.conjecture.providers")
        if hasattr(providers, "_get_local_constants"):
            none = providers._local_constants
            providers._get_local_constants = lambda: none


settings.register_profile(
    "gate",
    derandomize=True,  # the same examples in every run
    database=None,
    deadline=None,
    max_examples=60,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.function_scoped_fixture],
)
settings.register_profile("long", parent=settings.get_profile("gate"), derandomize=False, max_examples=2_000)
settings.load_profile(PROFILE)
if PROFILE == "gate":
    forget_constants()

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
def undrawn(monkeypatch: pytest.MonkeyPatch) -> None:
    """Pages without figures, for tests of everything else: a figure takes some tenths of a second."""

    def picture(
        album: Album, draw: Callable[[Path], object], words: str, caption: str, bitmap: bool = False
    ) -> Picture:
        return Picture("", caption, 1)

    monkeypatch.setattr(Album, "picture", picture)
