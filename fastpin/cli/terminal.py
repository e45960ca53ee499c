"""Common parts of all commands: exit codes, messages, output files."""

from __future__ import annotations

import contextlib
import json
import sys
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from pathlib import Path
from typing import TextIO, TypeVar

from fastpin.errors import InputError, OutputError, ReadingError, printable, reading
from fastpin.storage.files import check_writable, no_figure, replacing

T = TypeVar("T")

EXIT_OK, EXIT_FAILED, EXIT_INPUT, EXIT_READING, EXIT_INTERRUPTED, EXIT_PIPE = 0, 1, 2, 3, 130, 141


def say(*lines: str, file: TextIO | None = None) -> None:
    """Print lines on a stream: standard output, unless another one is given.

    Texts of files and names of files may be anybody's, and some characters steer a terminal. Line ends inside a line
    and other characters that can't be printed become escapes.
    """
    for line in lines:
        print(printable(line), file=file)


def fail(message: str, code: int) -> int:
    """Print an error message, and return the exit code."""
    say(f"fastpin: {message}", file=sys.stderr)
    return code


class Readings:
    """Readings of states for an output. One that fails is named, and hides nothing else.

    Attributes
    ----------
    code : int
        Exit code.
    """

    def __init__(self) -> None:
        self.code = EXIT_OK
        self._told: set[str] = set()

    def __call__(self, name: str, read: Callable[[], T], otherwise: T) -> T:
        """What ``read()`` gives, or `otherwise` after a message that names the reading."""
        try:
            with reading(name):
                return read()
        except ReadingError as error:
            self.add(error)
            return otherwise

    def add(self, error: ReadingError) -> None:
        """Print the message of a reading that has failed, once."""
        self.code = EXIT_READING
        if str(error) not in self._told:
            self._told.add(str(error))
            fail(str(error), EXIT_READING)


def flag(name: str) -> str:
    """Return an option as it is written on the command line."""
    return f"--{name.replace('_', '-')}"


@contextlib.contextmanager
def as_options(fields: Collection[str] | None = None) -> Iterator[None]:
    """Name the option in place of the field in errors raised within, if it is one of these fields; None: any field."""
    try:
        yield
    except InputError as error:
        if fields is None or error.field in fields:
            raise InputError(flag(error.field), error.reason) from None
        raise


def check_figure(option: str, path: Path) -> None:
    """Raise :class:`InputError` with the option as its field if a file's name does not end as a figure's."""
    if path.suffix.lower() not in (".png", ".pdf", ".svg"):
        raise no_figure(option, path)


def check_outputs(
    names: Mapping[str, str | Path | None], figures: Collection[str] = ("--plot", "--cycles"), result: str = ""
) -> None:
    """Check before the work that all output files can be written. The inputs of the command have been read before.

    Parameters
    ----------
    names : mapping of option to path or None
        "-" means standard output.
    figures : collection of str
        The options that name figures.
    result : str
        The option that names a result, if there is one.

    Raises
    ------
    InputError
        If a file can't be written or must not be replaced, is a case file, has the wrong suffix of a figure or a
        recording, or is named twice.
    """
    chosen = {name: Path(path) for name, path in names.items() if path is not None and path != "-"}
    seen: dict[Path, str] = {}
    for name, path in chosen.items():
        if path.suffix == ".toml":  # "fastpin run --json case.toml" takes the case file for the output.
            raise InputError(
                name, f"won't overwrite {path}: by its name it is a case file or plan; write it before the options"
            )
        if name in figures:
            check_figure(name, path)
        if name == "--record" and path.suffix.lower() not in (".html", ".htm"):
            raise InputError(name, f'must be the name of a page, which ends in .html, not "{path.name}"')
        try:
            check_writable(path, result=name == result)
        except InputError as error:
            raise InputError(name, str(error)) from None
        other = seen.setdefault(path.resolve(), name)
        if other != name:
            raise InputError(name, f"writes the same file as {other}: {path}")


def write_files(writers: Iterable[tuple[str | Path | None, Callable[[Path], object]]]) -> int:
    """Call ``write(path)`` for each (path, write) with a path, and return the exit code.

    If one file can't be written, its message is printed, and the others are written.
    """
    code = EXIT_OK
    for path, write in writers:
        if path is None:
            continue
        try:
            write(Path(path))
        except OutputError as trouble:
            code = fail(str(trouble), EXIT_FAILED)
        except InputError as trouble:
            code = fail(f"can't write {path}: {trouble}", EXIT_FAILED)
    return code


def write_outputs(
    writers: Iterable[tuple[str | Path | None, Callable[[Path], object]]],
    to: str | Path | None,
    document: Callable[[], object],
    lines: Callable[[], Iterable[str]] = tuple,
) -> int:
    """Call :func:`write_files`, then write a JSON document to a file, or to standard output for "-".

    Standard output comes last: its reader may close it early. It gets the lines, unless it gets the document.
    """
    text = "" if to is None else json.dumps(document(), indent=2, allow_nan=False) + "\n"
    code = write_files([*writers, (None if to == "-" else to, lambda path: write_text(path, text))])
    if to == "-":
        sys.stdout.write(text)
    else:
        say(*lines())
    return code


def write_text(path: Path, text: str) -> None:
    """Write a text file, whole or not at all."""
    with replacing(path) as temporary:
        temporary.write_text(text, encoding="utf-8")
