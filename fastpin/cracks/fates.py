"""What becomes of a crack."""

from __future__ import annotations

from enum import IntEnum


class CrackFate(IntEnum):
    """What becomes of a crack between its first and its last length."""

    NONE = 0
    """It does not start: at the first length the range is at most the threshold."""

    STOPS = 1
    """It grows, and stops before the last length."""

    GROWS = 2
    """It grows to the last length."""

    BREAKS = 3
    """It grows until the largest K_I reaches the toughness."""

    @property
    def words(self) -> str:
        """The fate in words."""
        return ("does not start", "stops", "grows", "breaks")[self]


CRACK_FATES = {int(fate): fate.words for fate in CrackFate}
"""The words of each fate, by its number."""
