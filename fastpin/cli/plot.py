"""``fastpin plot``: a figure of a stored result, and the numbers in it as CSV."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from fastpin import casefile, figures, solver, storage
from fastpin.cli.progress import Bar, progress_to
from fastpin.cli.terminal import as_options, check_outputs, flag, say, write_files
from fastpin.errors import InputError
from fastpin.figures.kinds import KINDS, kinds_with
from fastpin.model.case import Case
from fastpin.model.units import from_units


def run(options: argparse.Namespace) -> int:
    """Draw one kind of figure of a stored result, or of a case file."""
    if options.result.suffix.lower() == ".toml":
        options.kind = options.kind or "sketch"
        _check(options, "case" in KINDS[options.kind].sources)
        return _draw(casefile.read_case(options.result), options)
    with storage.stored.StoredResult(options.result) as stored:
        options.kind = options.kind or ("scar" if stored.is_life else "tractions")
        _check(options, False)
        return _draw(stored, options)


def _draw(shown: Case | storage.stored.StoredResult, options: argparse.Namespace) -> int:
    """Draw the figure, and say which part of the result it shows."""
    figure = Path(f"{options.kind}.png") if options.output is None else options.output
    case = shown if isinstance(shown, Case) else shown.case
    if options.depth is not None and options.kind != "profile":  # which takes radii
        options.depth = from_units(options.depth, "length", case.problem.unit_system)
    title = seat_title(case.title) if options.interface == "seat" else case.title
    check_outputs({"--output": figure, "--csv": options.csv}, figures=("--output",))
    names = [*(name for name in KINDS[options.kind].options if name != "csv"), "after"]
    given = {name: value for name in names if (value := getattr(options, name)) is not None}
    progress_bar = Bar(1.0, "damage of the spectrum")
    if isinstance(shown, Case):
        subject = figures.states.Subject(shown)
    elif options.interface == "seat":
        subject = figures.states.Subject(seat_of(shown))
    else:
        subject = figures.states.stored_subject(shown, progress_to(progress_bar))
    with as_options(given), progress_bar:  # the bar moves for the damage of a spectrum only
        plot = figures.plotting.plot_of(options.kind, subject, **given)
    say(*plot.notes)
    say(*(f"note: {doubt}" for doubt in plot.doubts), file=sys.stderr)
    numbers = [(options.csv, plot.write_numbers)] if plot.curves else []
    code = write_files([(figure, lambda path: plot.save(path, title)), *numbers])
    if code == 0:
        say(f"wrote {figure}" + ("" if options.csv is None else f" and {options.csv}"))
    return code


def _check(options: argparse.Namespace, is_case: bool) -> None:
    """Refuse options that have no effect on this kind of figure."""
    if options.result.suffix.lower() == ".toml" and not is_case:
        needed = "a result: fastpin run" if "result" in KINDS[options.kind].sources else "a life of wear: fastpin wear"
        raise InputError(str(options.result), f"is a case file; {options.kind} needs {needed} CASE -o FILE")
    if is_case and options.states is not None:
        raise InputError("--states", "chooses a state of a result; a case file has none")
    if is_case and options.interface == "seat":
        raise InputError("--interface", "chooses a contact of a result; a case file has none")
    if is_case and options.after is not None:
        raise InputError("--after", "chooses a profile of a life of wear; a case file has none")
    known = KINDS[options.kind].options
    for name in sorted({name for kind in KINDS.values() for name in kind.options}):
        if getattr(options, name) is not None and name not in known:
            raise InputError(flag(name), f"has no effect on {options.kind}; it is for {kinds_with(name)}")


def seat_title(title: str) -> str:
    """Return the title of a case with words that tell the contact in the seat from the contact of the pin."""
    return f"{title}, seat of the bush" if title else "seat of the bush"


def seat_of(stored: storage.stored.StoredResult) -> solver.Result:
    """Return the contact of the bush in its seat, of a stored result. Without one raise :class:`InputError`."""
    seat = None if stored.is_life else stored.whole().seat
    if seat is None:
        raise InputError("--interface", f"{stored.path}: the joint has no seat of a bush that slips (bonded = false)")
    return seat
