"""``fastpin example`` and ``fastpin check``."""

from __future__ import annotations

import argparse
import sys

from fastpin import casefile, report
from fastpin.cli.terminal import EXIT_OK, say
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
