"""``fastpin crack``: the growth of a crack at the edge of the hole over the last cycle of a stored result."""

from __future__ import annotations

import argparse
import sys

from fastpin import cracks, damage, storage
from fastpin.cli.terminal import check_outputs, flag, say, write_files
from fastpin.errors import InputError
from fastpin.figures.crack_growth import crack_growth_of
from fastpin.figures.subjects import InFile, with_cycles
from fastpin.model.angles import DEGREE, angle_at, from_bottom
from fastpin.model.checks import number
from fastpin.report.crack_growth import growth_curve, growth_table
from fastpin.report.curves import write_csv
from fastpin.states.state import State


def run(options: argparse.Namespace) -> int:
    """Print the growth of a crack, at one place or where a crack grows fastest, and draw it."""
    subject = InFile(options.result)
    cycle = with_cycles(subject).cycles[-1]
    states = damage.cycle_states(subject.part(cycle), cycle)
    check_outputs({"--output": options.output, "--csv": options.csv}, figures=("--output",))
    try:
        found = _growth(options, states)
    except InputError as error:
        raise InputError(flag(error.field) if hasattr(options, error.field) else error.field, error.reason) from None
    place = from_bottom(found.crack.theta)
    say(f"crack at {place:.2f} deg from the bottom: {found.words}", "")
    say(*growth_table(found).split("\n"))
    title = storage.stored_case(options.result).title
    code = write_files(
        [
            (options.output, lambda path: crack_growth_of(found).save(path, title)),
            (options.csv, lambda path: write_csv([growth_curve(found)], path)),
        ]
    )
    if len(states) == cycle.length + 1:
        words = "K between the corners is unknown: run --between 10 keeps states there"
        say(f"note: the cycle has only its {len(states)} corners; {words}", file=sys.stderr)
    return code


def _growth(options: argparse.Namespace, states: list[State]) -> cracks.Growth:
    law = cracks.Walker(
        options.C, options.m, options.exponent, options.threshold_range,
        intrinsic_length=options.intrinsic_length, toughness=options.toughness,
    )  # fmt: skip
    angle = number("angle", options.angle) * DEGREE
    if options.at is None:
        return cracks.growth_along_edge(
            states, law, options.first, options.last, angle=angle, body=options.body
        ).fastest
    crack = cracks.Crack(angle_at(number("at", options.at)), angle, options.body)
    return cracks.growth(states, crack, law, options.first, options.last)
