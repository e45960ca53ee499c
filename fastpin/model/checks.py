"""The only validators of single values. Each returns the value, or raises :class:`InputError` naming its field.

Python, case files, plans and the command line all call these validators. So the same fault gets the same message.
"""

from __future__ import annotations

import difflib
import math
from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import ArrayLike

from fastpin.errors import InputError

LONGEST_TEXT = 60
"""Most characters of a value that a message repeats."""


def number(field: str, value: object, least: float = -math.inf, most: float = math.inf) -> float:
    """Check a finite number from `least` to `most`, and return it as a float."""
    if isinstance(value, (bool, np.bool_, str, bytes, Sequence, Mapping)) or bool(getattr(value, "ndim", False)):
        raise InputError(field, f"must be a number, not {as_toml(value)}")
    try:
        converted = float(value)  # type: ignore[arg-type]
    except OverflowError:
        converted = math.inf
    except (TypeError, ValueError):
        raise InputError(field, f"must be a number, not {as_toml(value)}") from None
    if not math.isfinite(converted):
        raise InputError(field, f"must be a finite number, not {converted}")
    if not least <= converted <= most:
        raise InputError(field, f"must lie between {least:g} and {most:g}, not {converted:g}")
    return converted


def whole_number(field: str, value: object, least: int, most: int | None = None) -> int:
    """Check a whole number from `least` to `most`. No `most` means no upper limit."""
    is_whole = isinstance(value, (int, np.integer)) and not isinstance(value, bool)
    if not is_whole or value < least or (most is not None and value > most):  # type: ignore[operator]
        limits = f"of at least {least}" if most is None else f"from {least} to {most}"
        raise InputError(field, f"must be a whole number {limits}, not {as_toml(value)}")
    return int(value)  # type: ignore[call-overload]


def choice(field: str, value: object, allowed: Sequence[str]) -> str:
    """Check that a value is one of the words `allowed`."""
    if isinstance(value, str) and value in allowed:
        return value
    hint = closest(value, allowed) if isinstance(value, str) else ""
    choices = " or ".join(f'"{word}"' for word in allowed)
    raise InputError(field, f"must be {choices}, not {as_toml(value)}{hint}")


def true_or_false(field: str, value: object) -> bool:
    """Check a truth value."""
    if not isinstance(value, (bool, np.bool_)):
        raise InputError(field, f"must be true or false, not {as_toml(value)}")
    return bool(value)


def string(field: str, value: object) -> str:
    """Check a string."""
    if not isinstance(value, str):
        raise InputError(field, f"must be text in quotes, not {as_toml(value)}")
    return value


def numbers(
    field: str,
    values: ArrayLike,
    low: float = -math.inf,
    high: float = math.inf,
    *,
    open_low: bool = False,
    open_high: bool = False,
) -> np.ndarray:
    """Check finite numbers from `low` to `high`, and return them as a float array. An open end is itself excluded."""
    try:
        array = np.asarray(values, dtype=float)
    except (TypeError, ValueError, OverflowError):
        raise InputError(field, f"must be a number, not {as_toml(values)}") from None
    bad = ~np.isfinite(array)
    bad |= array <= low if open_low else array < low
    bad |= array >= high if open_high else array > high
    if np.any(bad):
        first = array[bad].flat[0]
        if not math.isfinite(first):
            raise InputError(field, f"must be a finite number, not {first}")
        below = "above" if open_low else "at least"
        beyond = "below" if open_high else "at most"
        bounds = [f"{below} {low:g}"] * (low > -math.inf) + [f"{beyond} {high:g}"] * (high < math.inf)
        raise InputError(field, f"must be {' and '.join(bounds)}, not {first:g}")
    return array


def as_toml(value: object) -> str:
    """A value as text, in the notation of case files. Long values are cut short."""
    if isinstance(value, (np.ndarray, np.generic)):
        value = value.tolist()
    if isinstance(value, (bool, np.bool_)):
        return str(value).lower()
    if isinstance(value, Mapping):
        return "a table"
    if isinstance(value, (list, tuple)):
        return "a list" if len(value) > 6 else f"[{', '.join(as_toml(item) for item in value)}]"
    if isinstance(value, str):
        return f'"{_cut(value)}"'
    if isinstance(value, int) and abs(value) >= 10**18:
        return "a number of more than 18 digits"
    return _cut(str(value))


def _cut(words: str) -> str:
    return words if len(words) < LONGEST_TEXT else f"{words[: LONGEST_TEXT - 4]}..."


def closest(word: str, known: Sequence[str]) -> str:
    """A hint at the known word closest to `word`; empty if no word is close."""
    lower = {name.lower(): name for name in known}
    close = difflib.get_close_matches(word.lower(), lower, n=1)
    return f', did you mean "{lower[close[0]]}"?' if close else ""
