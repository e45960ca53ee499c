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
    """Draw one kind of figure of a stored result."""
    is_text = options.result.suffix.lower() == ".toml"
    if options.kind is None:
        options.kind = "sketch" if is_text else "scar" if storage.holds_wear(options.result) else "tractions"
    is_case = is_text and "case" in KINDS[options.kind].sources
    _check(options, is_case)
    figure = Path(f"{options.kind}.png") if options.output is None else options.output
    case = casefile.read_case(options.result) if is_case else None
    title = "" if case is None else case.title
    if case is None:
        stored = storage.stored_case(options.result)
        title = stored.title
        if options.depth is not None and options.kind != "profile":  # which takes radii
            options.depth = from_units(options.depth, "length", stored.problem.unit_system)
    if options.interface == "seat":
        title = seat_title(title)
    check_outputs({"--output": figure, "--csv": options.csv}, figures=("--output",))
    plot = _plot(options, case)
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


def _plot(options: argparse.Namespace, case: Case | None) -> figures.sheet.Plot:
    """Return the figure of a case or a stored result, and say which part of the result it shows."""
    names = [*(name for name in KINDS[options.kind].options if name != "csv"), "after"]
    given = {name: value for name in names if (value := getattr(options, name)) is not None}
    progress_bar = Bar(1.0, "damage of the spectrum")
    if case is not None:
        subject = figures.states.Subject(case)
    elif options.interface == "seat":
        subject = figures.states.Subject(load_seat(options.result))
    else:
        subject = figures.states.stored_subject(options.result, progress_to(progress_bar))
    with as_options(given), progress_bar:  # the bar moves for the damage of a spectrum only
        plot = figures.plotting.plot_of(options.kind, subject, **given)
    say(*plot.notes)
    say(*(f"note: {doubt}" for doubt in plot.doubts), file=sys.stderr)
    return plot


def seat_title(title: str) -> str:
    """Return the title of a case with words that tell the contact in the seat from the contact of the pin."""
    return f"{title}, seat of the bush" if title else "seat of the bush"


def load_seat(path: Path) -> solver.Result:
    """Return the contact of the bush in its seat, of a stored result. Without one raise :class:`InputError`."""
    seat = None if storage.holds_wear(path) else storage.load(path).seat
    if seat is None:
        raise InputError("--interface", f"{path}: the joint has no seat of a bush that slips (bonded = false)")
    return seat
