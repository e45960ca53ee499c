"""Commands that run in this process, and what they print."""

import contextlib
import io
from typing import NamedTuple

from fastpin.cli.main import main


class Said(NamedTuple):
    """What a command has printed."""

    out: str
    err: str


def said(*words: object, code: int = 0) -> Said:
    """Run ``fastpin`` with these words. It must end with this code."""
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        ended = main([str(word) for word in words])
    assert ended == code, err.getvalue()
    return Said(out.getvalue(), err.getvalue())


def printed(*words: object) -> str:
    """What a command prints that succeeds."""
    return said(*words).out


def refused(*words: object) -> str:
    """The messages of a command that refuses its input, and prints nothing else."""
    found = said(*words, code=2)
    assert found.out == ""
    return found.err


def refusal(*words: object) -> str:
    """The only message of a command that refuses its input."""
    (sentence,) = refused(*words).splitlines()
    return sentence
