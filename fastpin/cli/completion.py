"""``fastpin completion``: a script that completes commands, options and files in a shell."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from fastpin.cli.options import parser
from fastpin.cli.terminal import EXIT_OK
from fastpin.errors import InputError


def run(options: argparse.Namespace) -> int:
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
