"""The four statuses of a contact node."""

from __future__ import annotations

from enum import IntEnum


class Status(IntEnum):
    """Status of a node. The slip is that of the pin over the plate."""

    SLIP_NEGATIVE = -1
    """Closed, slipping clockwise."""

    STICK = 0
    """Closed, sticking."""

    SLIP_POSITIVE = 1
    """Closed, slipping counter-clockwise."""

    OPEN = 2
    """Without contact."""


# Plain integers: compiled code and arrays of int8 take these.
SLIP_NEGATIVE = int(Status.SLIP_NEGATIVE)
STICK = int(Status.STICK)
SLIP_POSITIVE = int(Status.SLIP_POSITIVE)
OPEN = int(Status.OPEN)
