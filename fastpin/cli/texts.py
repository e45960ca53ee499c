"""``fastpin example``, ``check``, ``schema`` and ``completion``: commands that print a text."""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path

from fastpin import casefile, report
from fastpin.cli.options import parser
from fastpin.cli.terminal import EXIT_OK, say
from fastpin.errors import InputError
from fastpin.model.doubts import doubts, warn_of, wear_doubts


def example(_: argparse.Namespace) -> int:
    """Print a commented case file."""
    sys.stdout.write(casefile.EXAMPLE)
    return EXIT_OK


def check(options: argparse.Namespace) -> int:
    """Read a case file, and print how it is understood, with warnings of doubtful values."""
    case = casefile.read_case(options.case)
    say(*report.describe(case).split("\n"))
    of_wear = [] if case.wear is None else wear_doubts(case.problem, case.wear)
    warn_of([*doubts(case.problem, case.history, case.options), *of_wear], 2)
    return EXIT_OK


def schema(options: argparse.Namespace) -> int:
    """Print the schema."""
    sys.stdout.write(json.dumps(report.json_schema(options.written_by), indent=2) + "\n")
    return EXIT_OK


def completion(options: argparse.Namespace) -> int:
    """Print the script of a shell. Nothing of fastpin runs when a word is completed."""
    try:
        import shtab
    except ImportError:
        raise InputError("completion", "needs the package shtab: pip install 'fastpin[completion]'") from None
    root = parser()
    for action in _all_actions(root):
        if action.type is Path:
            action.complete = shtab.FILE  # type: ignore[attr-defined]
    sys.stdout.write(f"{shtab.complete(root, options.shell)}\n")
    return EXIT_OK


def _all_actions(command: argparse.ArgumentParser) -> list[argparse.Action]:
    """Return the options and arguments of a parser and of its commands. argparse has no public list of them."""
    found = list(command._actions)
    for action in command._actions:
        if isinstance(action.choices, dict):
            found += [inner for choice in action.choices.values() for inner in _all_actions(choice)]
    return found
