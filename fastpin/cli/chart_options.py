"""The options of ``fastpin charts``. Nothing heavy is imported here: help is answered at once."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from pathlib import Path
from typing import Any

NUMBERS = {
    "load_parameter": "L_p = (R - R_D)/(P beta*)",
    "friction": "coefficient of friction",
    "alpha": "first parameter of Dundurs, in the usual sign (default 0)",
    "beta": "second parameter of Dundurs (default 0)",
    "kolosov": "Kolosov's constant of the pin: 3 - 4 nu or, in plane stress, (3 - nu)/(1 + nu) (default 1.8)",
    "load_ratio": "Q/P: amplitude of the cycle (cycles only)",
}
"""Parameters of charts that are numbers, and their help."""


def add_chart_options(charts: argparse.ArgumentParser, literal: Callable[[str], Any]) -> None:
    """Add the options of ``charts``. `literal` reads a number, or keeps the text for the checks of the value."""
    charts.add_argument("chart", metavar="CHART", nargs="?", help="a chart; without one: list them with their bounds")
    for name, words in NUMBERS.items():
        charts.add_argument(f"--{name.replace('_', '-')}", metavar="X", type=literal, help=words)
    charts.add_argument("--pin-load", metavar="LOAD", help="body or centre (default centre)")
    charts.add_argument("--rotation", metavar="HOW", help="free or fixed (default free; cycles only)")
    charts.add_argument("--formulas", action="store_true", help="print formulas for a spreadsheet, with their errors")
    charts.add_argument("--csv", metavar="FILE", type=Path, help="write the nodes of the chart")
    charts.add_argument("--book", metavar="FILE", type=Path, help="draw the book of charts (pdf)")
