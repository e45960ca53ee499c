"""``fastpin example`` and ``fastpin check``."""

from __future__ import annotations

import argparse

from fastpin import casefile, report
from fastpin.cli.terminal import EXIT_OK


def example(_: argparse.Namespace) -> int:
    """Print a commented case file."""
    print(casefile.EXAMPLE, end="")
    return EXIT_OK


def check(options: argparse.Namespace) -> int:
    """Read a case file, and print how it is understood."""
    print(report.describe(casefile.read_case(options.case)))
    return EXIT_OK
