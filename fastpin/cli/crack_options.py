"""The options of ``fastpin crack``. Nothing heavy is imported here: help is answered at once."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from pathlib import Path
from typing import Any

_LAW_WORDS = {
    "C": "growth in a cycle under the range --unit, m",
    "m": "exponent of Paris and Walker: da/dN = C (dK (1 - R)^(g - 1))^m",
    "n": "exponent of NASGRO",
    "p": "NASGRO's exponent near the threshold",
    "q": "NASGRO's exponent near the toughness",
    "exponent": "Walker's g (default 1: Paris's law)",
    "threshold_range": "threshold of long cracks at R = 0, Pa sqrt(m) (default 0)",
    "threshold_exponent": "Walker: exponent of 1 - R in the threshold (default 1 - g)",
    "threshold_slope": "NASGRO's C_th for R >= 0 (default 0)",
    "compressive_slope": "NASGRO's C_th for R < 0 (default 0)",
    "constraint": "NASGRO's alpha, 1 to 3 (default 2)",
    "stress_level": "NASGRO's largest stress over the flow stress (default 0.3)",
    "intrinsic_length": "El Haddad's length of the threshold of short cracks, m (default 0)",
    "toughness": "K at which the plate breaks, Pa sqrt(m)",
    "unit": "range that C belongs to, Pa sqrt(m) (default 1e6)",
}
"""Help of the constants of the laws of growth."""


def add_crack_options(crack: argparse.ArgumentParser, literal: Callable[[str], Any]) -> None:
    """Add the options of ``crack``. `literal` reads a number, or keeps the text for the checks of the value."""
    crack.add_argument("result", metavar="FILE", type=Path, help="HDF5 file (run -o FILE)")
    whose = "default: [crack] of the case"
    for name, words in (
        ("first", f"first length of the crack, m ({whose})"),
        ("last", f"last length, m ({whose})"),
        ("at", "angle of its mouth from the bottom, deg (default: [crack], else where a crack grows fastest)"),
        ("angle", "its direction from the radius, counter-clockwise, deg (default: [crack], else 0)"),
    ):
        crack.add_argument(f"--{name}", metavar="X", type=literal, help=words)
    crack.add_argument("--body", choices=("plate", "seat"), help="seat: the plate round a bush (default: plate)")
    crack.add_argument("--case", metavar="CASE", type=Path, help="case file whose [crack] replaces that of the result")
    crack.add_argument("--spectrum", action="store_true", help="count the cycles of the whole history")
    laws = "law of the constants below (default walker; without constants: [crack], else the material)"
    crack.add_argument("--law", choices=("paris", "walker", "nasgro"), help=laws)
    for name, words in _LAW_WORDS.items():
        crack.add_argument(f"--{name.replace('_', '-')}", metavar="X", type=literal, help=words)
    crack.add_argument("-o", "--output", metavar="FIGURE", type=Path, help="draw the growth (png, pdf, svg)")
    crack.add_argument("--csv", metavar="FILE", type=Path, help="write the numbers at all lengths")
