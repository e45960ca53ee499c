"""``fastpin example`` and ``fastpin check``."""

from __future__ import annotations

import argparse
import sys

from fastpin import casefile, report
from fastpin.cli.terminal import EXIT_OK, say
from fastpin.model.doubts import doubts, warn_of


def example(_: argparse.Namespace) -> int:
    """Print a commented case file."""
    sys.stdout.write(casefile.EXAMPLE)
    return EXIT_OK


def check(options: argparse.Namespace) -> int:
    """Read a case file, and print how it is understood, with warnings of doubtful values."""
    case = casefile.read_case(options.case)
    say(*report.describe(case).split("\n"))
    warn_of(doubts(case.problem, case.history, case.options), 2)
    return EXIT_OK
