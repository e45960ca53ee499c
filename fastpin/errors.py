"""Errors of the input, and the base class of all errors of fastpin.

The errors of a run stand in :mod:`fastpin.solver.errors`. They derive from :class:`FastpinError` too.
"""

from __future__ import annotations

import contextlib
from collections.abc import Iterator


class FastpinError(Exception):
    """Base class of all errors raised by fastpin."""


SPACES = frozenset(map(chr, (0xA0, 0x1680, *range(0x2000, 0x200B), 0x202F, 0x205F, 0x3000)))
"""The spaces of Unicode besides the usual one. They can be printed, although Python does not count them so."""


def printable(text: str) -> str:
    """Text on one line: line ends and other characters that can't be printed become escapes, as in Python.

    Control characters, marks that turn the direction of writing, lone surrogates and unassigned characters can't be
    printed.
    """
    if text.isprintable():
        return text
    return "".join(letter if letter.isprintable() or letter in SPACES else ascii(letter)[1:-1] for letter in text)


class FieldMessage(Exception):  # noqa: N818 - the base of errors and warnings
    """A message on a field of the input. Copies and pickles keep both.

    Attributes
    ----------
    field : str
        The field.
    reason : str
        The message without the field.
    """

    def __init__(self, field: str, message: str) -> None:
        super().__init__(printable(f"{field}: {message}"))
        self.field = field
        self.reason = printable(message)

    def __reduce__(self) -> tuple[type[FieldMessage], tuple[str, str]]:
        return type(self), (self.field, self.reason)


class InputError(FieldMessage, FastpinError, ValueError):
    """Input that can't be used. The message says what is allowed.

    Attributes
    ----------
    field : str
        The field at fault.
    reason : str
        The message without the field.
    """


class UnknownNameError(InputError, KeyError):
    """A name that a table of names does not have, such as that of a material. It is a :class:`KeyError`, too."""

    def __str__(self) -> str:
        return Exception.__str__(self)  # KeyError would show the message in quotes


class OutputError(FieldMessage, FastpinError):
    """An output file that could not be written to its end, for example because the disk is full.

    Attributes
    ----------
    field : str
        The file.
    reason : str
        The message without the file.
    """


class ReadingError(FieldMessage, FastpinError):
    """A quantity that could not be read from states. The states themselves are right, and are kept.

    Attributes
    ----------
    field : str
        The quantity, or the part of an output.
    reason : str
        The message without it.
    """


@contextlib.contextmanager
def reading(name: str, *others: str) -> Iterator[None]:
    """Turn every error of the block, which reads a quantity from states, into :class:`ReadingError` with its name.

    :class:`InputError` stays as it is if its field is one of the `others`, such as a file that is damaged.
    """
    try:
        yield
    except (ReadingError, OutputError, OSError, MemoryError):
        raise
    except Exception as error:  # NumPy raises errors of many kinds.
        if isinstance(error, InputError) and error.field in others:
            raise
        words = str(error) if isinstance(error, FastpinError) else f"{type(error).__name__}: {error}"
        raise ReadingError(name, f"can't be read: {words}") from error


class CaseFileError(InputError):
    """A case file with faults.

    Attributes
    ----------
    problems : list of (int, str)
        The line, counted from 1, and one sentence for each fault, in the order of the lines. Line 0 is the whole file.
    """

    def __init__(self, name: str, problems: list[tuple[int, str]]) -> None:
        self.problems = sorted(((line, printable(text)) for line, text in problems), key=lambda problem: problem[0])
        super().__init__(name, self.problems[0][1])
        lines = [f"{printable(name)}{f', line {line}' if line else ''}: {text}" for line, text in self.problems]
        self.args = ("\n".join(lines),)

    def __reduce__(self) -> tuple[type[CaseFileError], tuple[str, list[tuple[int, str]]]]:  # type: ignore[override]
        return type(self), (self.field, self.problems)


class InputWarning(FieldMessage, UserWarning):
    """Input that can be used, but is probably a mistake. The result is not changed by the warning.

    Attributes
    ----------
    field : str
        The field in doubt.
    reason : str
        The message without the field.
    """
