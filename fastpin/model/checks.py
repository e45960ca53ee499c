"""The only validators of single values. Each returns the value, or raises :class:`InputError` naming its field.

Python, case files, plans and the command line all call these validators. So the same fault gets the same message.
"""

from __future__ import annotations

import contextlib
import inspect
import math
import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import fields
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from fastpin.errors import FastpinError, InputError, UnknownNameError, printable
from fastpin.model.inputs import SpecialFileError
from fastpin.model.synonyms import closest

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

T = TypeVar("T")

MOST_FRICTION = 1e6
"""Largest coefficient of friction. The pin sticks wherever it touches. Beyond, rounding makes it slip."""

MOST_PARAMETER = 1e50
"""Largest load parameter of a dimensionless problem. A larger clearance could only mean a wrong unit."""

LONGEST_TEXT = 60
"""Most characters of a value that a message repeats."""

_NUMBER_KINDS = "iuf"
"""Kinds of NumPy arrays and scalars that hold numbers: no truth values, complex numbers, times, texts or objects."""


def check_fields(
    record: object, check: Callable[..., object], names: str, *limits: object, optional: bool = False
) -> None:
    """Replace fields of a frozen dataclass that is being made by ``check(name, value, *limits)``.

    `names` are words of one text. An optional field may be None.
    """
    for name in names.split():
        value = getattr(record, name)
        if value is not None or not optional:
            object.__setattr__(record, name, check(name, value, *limits))


def set_fields(record: object, **values: object) -> None:
    """Set fields of a frozen dataclass that is being made."""
    for name, value in values.items():
        object.__setattr__(record, name, value)


def given_fields(record: Any) -> dict[str, Any]:
    """The fields of a dataclass that are not None, by name."""
    return {each.name: value for each in fields(record) if (value := getattr(record, each.name)) is not None}


def number(field: str, value: object, least: float = -math.inf, most: float = math.inf) -> float:
    """Check a finite number from `least` to `most`, and return it as a float."""
    converted = _as_float(value)
    if converted is None:
        raise InputError(field, f"must be a number, not {as_toml(value)}")
    if not math.isfinite(converted):
        raise InputError(field, f"must be a finite number, not {converted}")
    if not least <= converted <= most:
        raise InputError(field, f"must lie between {least:g} and {most:g}, not {converted:g}")
    return converted


def point(field: str, value: object) -> complex:
    """Check a point of the plane with finite coordinates, and return it as a complex number."""
    if isinstance(value, (complex, np.complexfloating)):
        return complex(number(field, float(value.real)), number(field, float(value.imag)))
    return complex(number(field, value))


def is_above(length: float, limit: float) -> bool:
    """Whether a length lies above a computed limit by more than rounding: 9 mm is not above 0.9 times 10 mm."""
    return length > limit + 1e-9 * abs(limit)  # files have few digits


def is_between(least: float, length: float, most: float) -> bool:
    """Whether a length lies between two computed limits, which may be rounded."""
    return not is_above(least, length) and not is_above(length, most)


def positive(field: str, value: object) -> float:
    """Check a finite number above 0, and return it as a float."""
    converted = number(field, value)
    if converted <= 0.0:
        raise InputError(field, f"must be positive, not {converted:g}")
    return converted


def negative(field: str, value: object) -> float:
    """Check a finite number below 0, and return it as a float."""
    converted = number(field, value)
    if converted >= 0.0:
        raise InputError(field, f"must be negative, not {converted:g}")
    return converted


def not_negative(field: str, value: object) -> float:
    """Check a finite number of at least 0, and return it as a float."""
    converted = number(field, value)
    if converted < 0.0:
        raise InputError(field, f"must not be negative, not {converted:g}")
    return converted


def whole_number(field: str, value: object, least: int, most: int | None = None) -> int:
    """Check a whole number from `least` to `most`. No `most` means no upper limit."""
    if not is_whole(value) or value < least or (most is not None and value > most):  # type: ignore[operator]
        limits = f"of at least {least}" if most is None else f"from {least} to {most}"
        raise InputError(field, f"must be a whole number {limits}, not {as_toml(value)}")
    return int(value)  # type: ignore[call-overload]


def count(field: str, value: object, most: float) -> int:
    """Check a count from 1 to `most` that may be written as 1e6, and return it."""
    found = number(field, value, 1, most)
    if found != int(found):
        raise InputError(field, f"must be a whole number, not {found:g}")
    return int(found)


def is_whole(value: object) -> bool:
    """Whether a value is a whole number of Python or NumPy, and no truth value or duration."""
    return isinstance(value, (int, np.integer)) and not isinstance(value, (bool, np.timedelta64))


def choice(field: str, value: object, allowed: Sequence[str]) -> str:
    """Check that a value is one of the words `allowed`."""
    if isinstance(value, str) and value in allowed:
        return str.__str__(value)  # a plain word, also for words of NumPy and of enumerations
    hint = closest(value, allowed) if isinstance(value, str) else ""
    raise InputError(field, f"must be {alternatives(allowed)}, not {as_toml(value)}{hint}")


def unknown_key(key: object, keys: Sequence[str], where: str = "", end: str | None = None) -> str:
    """Return the message on a key that a table does not have.

    Parameters
    ----------
    keys : sequence of str
        The keys of the table. They give the end of the message: a hint at the key that is meant, or all keys.
    where : str
        Words on the table, such as " in [pin]".
    end : str, optional
        Another end.
    """
    usual = f"; the keys are {', '.join(keys)}"
    return f"unknown key {as_toml(key)}{where}{closest(str(key)[:LONGEST_TEXT], keys) or usual if end is None else end}"


def known_name(field: str, name: object, known: Iterable[str]) -> None:
    """Check a name of a library. An unknown one raises :class:`UnknownNameError`, which says which name is meant."""
    try:
        choice(field, name, tuple(known))
    except InputError as error:
        raise UnknownNameError(error.field, error.reason) from None


class Library(dict[str, T]):
    """Things of one kind by name. An unknown name raises :class:`UnknownNameError`, which says which name is meant."""

    def __init__(self, kind: str, things: Mapping[str, T]) -> None:
        super().__init__(things)
        self._kind = kind

    def __missing__(self, name: object) -> T:
        known_name(self._kind, name, self)
        raise KeyError(name)


def alternatives(words: Sequence[str]) -> str:
    """Return words in quotes with commas, and "or" before the last one."""
    quoted = [f'"{word}"' for word in words]
    return " or ".join([", ".join(quoted[:-1]), quoted[-1]] if len(quoted) > 1 else quoted)


def true_or_false(field: str, value: object) -> bool:
    """Check a truth value."""
    if not isinstance(value, (bool, np.bool_)):
        raise InputError(field, f"must be true or false, not {as_toml(value)}")
    return bool(value)


def string(field: str, value: object) -> str:
    """Check a text on one line that can be printed anywhere, such as a name or a title: see :func:`printable`."""
    text = instance(field, value, str, "text in quotes")
    if printable(text) != text:
        first = next(letter for letter in text if printable(letter) != letter)
        raise InputError(field, f"must be one line of printable characters, without {ascii(first)[1:-1]}")
    return str.__str__(text)


def any_text(field: str, value: object) -> str:
    """Check a text of any lines that can be stored in any file: without NUL and lone surrogates."""
    text = instance(field, value, str, "text in quotes")
    if any(character == "\0" or "\ud800" <= character <= "\udfff" for character in text):
        raise InputError(field, f"must be text of Unicode characters without NUL, not {as_toml(text)}")
    return text


def file_path(field: str, value: object) -> Path:
    """Check the path of a file or directory. The file need not exist."""
    try:
        name = os.fspath(value)  # type: ignore[call-overload]
        encoded = os.fsencode(name)
    except Exception:  # Any object can be given, and its methods may fail in any way.
        name, encoded = None, b""
    if not isinstance(name, str) or not name or "\0" in name:
        raise InputError(field, f"must be the name of a file, not {as_toml(value)}")
    # Usual systems allow so many bytes of a whole path, and of the name of a file.
    if len(encoded) > 4095 or max(map(len, encoded.split(os.fsencode(os.sep)))) > 255:
        raise InputError(field, f"is too long for the name of a file: {as_toml(value)}")
    return Path(name)


def why_unreadable(error: Exception) -> str:
    """Return why a file can't be read, from the error of its opening or reading, for the message."""
    if isinstance(error, FileNotFoundError):
        return "there is no such file"
    if isinstance(error, IsADirectoryError):
        return "is a directory, a file is needed"
    if isinstance(error, SpecialFileError):
        return "must be an ordinary file, not a pipe or a device"
    if isinstance(error, UnicodeDecodeError):
        return "is not UTF-8 text; save it with this encoding"
    return f"can't be read: {getattr(error, 'strerror', None) or error}"


def instance(field: str, value: object, kind: type[T], name: str) -> T:
    """Check the class of a value. `name` is the class with its article, for the message."""
    if not isinstance(value, kind):
        raise InputError(field, f"must be {name}, not {as_toml(value)}")
    return value


def check_callable(field: str, value: object, arguments: int = 2) -> None:
    """Check that a value is None or can be called with so many arguments, as far as its signature tells."""
    if value is None:
        return
    if not callable(value):
        raise InputError(field, f"must be a callable, not {as_toml(value)}")
    try:
        fits = True
        inspect.signature(value).bind(*range(arguments))
    except TypeError:
        fits = False
    except ValueError:  # functions in C need not have a signature
        fits = not isinstance(value, type)
    if not fits:
        raise InputError(field, f"must be a callable of {arguments} arguments, not {as_toml(value)}")


def items(field: str, values: Iterable[T], name: str) -> list[T]:
    """Check that a value can be iterated, and return its items. `name` says in the message what it must be."""
    try:
        return list(values)
    except FastpinError:
        raise
    except Exception as error:  # Any object can be given, and its iteration may fail in any way.
        raise InputError(field, f"must be {name}, not {as_toml(values)}") from error


def instances(field: str, values: Iterable[T], kind: type[T], name: str) -> list[T]:
    """Check the class of all items of a value, and return them. `name` says in the message what the value must be."""
    return [instance(field, value, kind, name) for value in items(field, values, name)]


def places_of(field: str, value: slice, count: int) -> range:
    """Check a slice, and return the places that it takes of `count` items."""
    try:
        return range(*value.indices(count))
    except Exception:  # Any object can be given, and its conversion may fail in any way.
        raise InputError(field, f"must be a slice of whole numbers with a step other than 0, not {value}") from None


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
    array = number_array(field, values)
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


def in_one_shape(field: str, one: np.ndarray, other: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Check that the shapes of two float arrays fit, and return copies in their common shape."""
    try:
        shape = np.broadcast(one, other).shape
    except ValueError:
        raise InputError(field, f"has the shape {one.shape}, which does not fit the other's {other.shape}") from None
    first, second = np.empty(shape), np.empty(shape)
    first[...], second[...] = one, other
    return first, second


def number_array(field: str, values: ArrayLike) -> np.ndarray:
    """Check an array of numbers, also NaN and infinite ones, and return it as a float array of any shape."""
    with contextlib.suppress(Exception):  # Any object can be given, and its conversion may fail in any way.
        array = np.asarray(values)
        if array.dtype.kind in _NUMBER_KINDS + "O" and not _is_masked(values):
            return array.astype(float)
    raise InputError(field, f"must be a number, not {as_toml(values)}")


def triples(field: str, values: ArrayLike) -> np.ndarray:
    """Check an array of numbers with three components along its last axis, and return it as a float array."""
    array = number_array(field, values)
    if not array.ndim or array.shape[-1] != 3:
        raise InputError(field, f"must have the shape (..., 3), not {array.shape}")
    return array


def as_toml(value: object) -> str:
    """A value as text, in the notation of case files. Long values are cut short."""
    return _as_toml(value, 0)


def _as_toml(value: object, depth: int) -> str:
    if isinstance(value, (np.ndarray, np.generic)) and not _is_masked(value):
        value = value.tolist()
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, Mapping):
        return "a table"
    if isinstance(value, (list, tuple)):
        if len(value) > 6 or depth >= 3:
            return "a list"
        return f"[{', '.join(_as_toml(item, depth + 1) for item in value)}]"
    if isinstance(value, str):
        return f'"{shortened(value)}"'
    if isinstance(value, int) and abs(value) >= 10**18:
        return "a number of more than 18 digits"
    try:
        return shortened(str(value))
    except Exception:  # The class of the value may be anyone's.
        return f"a {type(value).__name__}"


def _as_float(value: Any) -> float | None:
    """A number as a float, infinite if it is too large; None for anything else."""
    if type(value) is float:
        return value
    if isinstance(value, (bool, complex, str, bytes, bytearray, Sequence, Mapping)) or _is_masked(value):
        return None
    if isinstance(value, (np.ndarray, np.generic)) and (value.dtype.kind not in _NUMBER_KINDS or value.ndim):
        return None
    try:
        return float(value)
    except OverflowError:
        return math.inf
    except Exception:  # Any object can be given, and its conversion may fail in any way.
        return None


def _is_masked(value: object) -> bool:
    """Whether a value is a masked array. Its class is not named: that would import numpy.ma in every run."""
    return isinstance(value, np.ndarray) and hasattr(value, "mask")


def shortened(words: str) -> str:
    """Words on one line that can be printed, at most :data:`LONGEST_TEXT` characters."""
    shown = printable(" ".join(words[: 2 * LONGEST_TEXT].split()))
    return shown if len(shown) < LONGEST_TEXT else f"{shown[: LONGEST_TEXT - 4]}..."
