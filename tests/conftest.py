"""Shared material pairs and problems."""

from __future__ import annotations

import pytest

from fastpin.model.materials import MATERIALS, Material, MaterialPair


@pytest.fixture(scope="session")
def similar() -> MaterialPair:
    """Two like bodies, nu = 0.3, plane strain."""
    return MaterialPair(Material(100e9, 0.3), Material(100e9, 0.3))


@pytest.fixture(scope="session")
def titanium_in_aluminium() -> MaterialPair:
    """The paper's dissimilar pair."""
    return MaterialPair(MATERIALS["Ti-6Al-4V"], MATERIALS["aluminium"])
