"""The options of ``fastpin identify``. Nothing heavy is imported here: help is answered at once."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from pathlib import Path
from typing import Any


def add_loop_options(identify: argparse.ArgumentParser, literal: Callable[[str], Any]) -> None:
    """Add the options of ``identify``. `literal` reads a number, or keeps the text for the checks of the value."""
    identify.add_argument("case", type=Path, help="case file (TOML) of the joint, with the loads that are constant")
    identify.add_argument("loop", metavar="CSV", type=Path, help="the samples, equally spaced in time")
    identify.add_argument("--over", metavar="LOAD", help="measured displacement: ux, uy or rotation (default: drive)")
    whose = "default: that of its name, or the only one with such a unit"
    identify.add_argument("--displacement", metavar="COLUMN", help=f"its column of the file ({whose})")
    identify.add_argument("--force", metavar="COLUMN", help=f"column of the force or moment ({whose})")
    identify.add_argument(
        "--force-factor", metavar="X", type=literal, default=1.0, help="factor of this column; -1 turns its sign"
    )
    identify.add_argument(
        "--fit", metavar="A,B", default="stiffness",
        help="fitted beside friction and offsets: stiffness (of the rig), clearance, drift, scale (of the force); "
        'default stiffness; "" for none',
    )  # fmt: skip
    identify.add_argument("--by-cycle", action="store_true", help="a friction of its own for each cycle")
    identify.add_argument(
        "--start", metavar="WHERE", default="rest",
        help="rest: the record begins at no displacement (default); cycle: it begins in a steady cycle",
    )  # fmt: skip
    identify.add_argument("--nodes", metavar="N", type=literal, default=61, help="nodes of the first fit (default 61)")
    identify.add_argument("--csv", metavar="FILE", type=Path, help="write the measured and the computed loop")
    identify.add_argument("--plot", metavar="FILE", type=Path, help="draw both loops and the energies (png, pdf, svg)")
