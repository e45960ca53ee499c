"""Regimes of slip: separation, full stick, partial slip or gross sliding, of a state and of a load cycle.

Fretting maps have the same words (O. Vingsbo and S. Söderberg, On fretting maps, Wear 126 (1988) 131-147).
"""

from __future__ import annotations

from enum import IntEnum

import numpy as np


class Regime(IntEnum):
    """How the closed nodes of a contact slip."""

    SEPARATION = 0
    """No node is closed."""

    FULL_STICK = 1
    """All closed nodes stick."""

    PARTIAL_SLIP = 2
    """Some closed nodes stick, and others slip."""

    GROSS_SLIDING = 3
    """All closed nodes slip."""

    @property
    def words(self) -> str:
        """The regime in words: "partial slip"."""
        return self.name.lower().replace("_", " ")


REGIMES = {int(regime): regime.words for regime in Regime}
"""The words of each regime, by its number."""


def regime_of(closed: np.ndarray, slips: np.ndarray) -> Regime:
    """Return the regime of nodes that are closed, or closed at some time, and of which some slip.

    Parameters
    ----------
    closed, slips : ndarray of bool, shape (n,)
        Slip of a node that is not closed does not count.
    """
    if not closed.any():
        return Regime.SEPARATION
    if not slips[closed].any():
        return Regime.FULL_STICK
    return Regime.GROSS_SLIDING if slips[closed].all() else Regime.PARTIAL_SLIP
