"""The race between cracks and wear, and its ends."""

from __future__ import annotations

from enum import IntEnum


class Race(IntEnum):
    """What wins within the cycles of a life of wear."""

    OPEN = 0
    """No crack starts, and on the first profile none would start either."""

    WEAR = 1
    """No crack starts, but on the first profile one would: wear takes the material away, or spreads the contact."""

    CRACK = 2
    """A crack starts before its material is worn off."""

    @property
    def words(self) -> str:
        """The winner in words."""
        return ("no crack in any case", "wear wins", "a crack wins")[self]
