"""The four statuses of a contact node."""

from __future__ import annotations

from enum import IntEnum


class Status(IntEnum):
    """Status of a node. Slip is the motion of the pin over the plate."""

    SLIP_NEGATIVE = -1
    """Closed, slipping clockwise."""

    STICK = 0
    """Closed, sticking."""

    SLIP_POSITIVE = 1
    """Closed, slipping counter-clockwise."""

    OPEN = 2
    """Open: without contact."""


# Compiled code and arrays of int8 take plain integers.
SLIP_NEGATIVE = int(Status.SLIP_NEGATIVE)
STICK = int(Status.STICK)
SLIP_POSITIVE = int(Status.SLIP_POSITIVE)
OPEN = int(Status.OPEN)
