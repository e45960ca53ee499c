"""Checks of single values that users give: they return the value or raise :class:`InputError` naming its field."""

from __future__ import annotations

import math

import numpy as np

from fastpin.errors import InputError


def finite(field: str, value: float) -> float:
    """Return `value` as a float, or raise :class:`InputError` naming `field`."""
    if isinstance(value, (bool, str)):
        raise InputError(field, f"must be a number, not {value!r}")
    try:
        number = float(value)
    except (TypeError, ValueError):
        raise InputError(field, f"must be a number, not {value!r}") from None
    if not math.isfinite(number):
        raise InputError(field, f"must be a finite number, not {number}")
    return number


def one_of(field: str, value: str, allowed: tuple[str, ...]) -> str:
    """Return `value` if it is one of `allowed`, or raise :class:`InputError` naming `field`."""
    if value not in allowed:
        choices = " or ".join(f'"{choice}"' for choice in allowed)
        raise InputError(field, f"must be {choices}, not {value!r}")
    return value


def whole_number(field: str, value: int, least: int) -> int:
    """Return `value` as an int if it is a whole number of at least `least`."""
    if isinstance(value, bool) or not isinstance(value, (int, np.integer)) or value < least:
        raise InputError(field, f"must be a whole number of at least {least}, not {value!r}")
    return int(value)
