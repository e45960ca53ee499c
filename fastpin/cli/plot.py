"""``fastpin plot``: a figure of a stored result, and the numbers in it as CSV."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

from fastpin import casefile, figures, joints, solver, storage
from fastpin.assess.outputs import Follow
from fastpin.casefile.toml_text import read_text
from fastpin.cli.progress import Bar, progress_to
from fastpin.cli.terminal import as_options, check_outputs, flag, say, write_files
from fastpin.errors import InputError
from fastpin.figures.kinds import KINDS, kinds_with
from fastpin.model.checks import known_name
from fastpin.model.units import from_units


def run(options: argparse.Namespace) -> int:
    """Draw one kind of figure of a stored result, of a joint or a pin in it, of a case file or of a joint file."""
    if options.result.suffix.lower() == ".toml" and joints.is_joint_file(read_text(options.result)):
        options.kind = options.kind or "plates"
        _check(options, "joint file")
        _check_of_joint(options, True)
        file = joints.read_joint(options.result)
        subject_of_file = figures.joint_sketch.JointFileSubject(file)
        return _draw(options, file.title, file.joint.unit_system, lambda progress: subject_of_file)
    if options.result.suffix.lower() == ".toml":
        options.kind = options.kind or "sketch"
        _check(options, "case")
        _check_of_joint(options, False)
        case = casefile.read_case(options.result)
        return _draw(options, case.title, case.problem.unit_system, lambda progress: figures.states.Subject(case))
    with storage.stored.StoredResult(options.result) as stored:
        is_joint = stored.is_joint
        usual = ("holes" if options.pin is None else "tractions") if is_joint else "scar" if stored.is_life else None
        options.kind = options.kind or usual or "tractions"
        _check(options, None)
        _check_of_joint(options, is_joint)
        if is_joint:
            return _draw_of_joint(options, stored)
        title = seat_title(stored.case.title) if options.interface == "seat" else stored.case.title

        def subject(progress: Follow) -> figures.states.Subject:
            if options.interface == "seat":
                return figures.states.Subject(seat_of(stored))
            return figures.states.stored_subject(stored, progress)

        return _draw(options, title, stored.case.problem.unit_system, subject)


def _draw(options: argparse.Namespace, title: str, system: str, make: Callable[[Follow], Any]) -> int:
    """Draw the figure of the subject that ``make(progress)`` returns, and say which part of the result it shows."""
    figure = Path(f"{options.kind}.png") if options.output is None else options.output
    if options.depth is not None and options.kind != "profile":  # which takes radii
        options.depth = from_units(options.depth, "length", system)
    check_outputs({"--output": figure, "--csv": options.csv}, figures=("--output",))
    names = [*(name for name in KINDS[options.kind].options if name != "csv"), "after"]
    given = {name: value for name in names if (value := getattr(options, name)) is not None}
    progress_bar = Bar(1.0, "damage of the spectrum")
    subject = make(progress_to(progress_bar))
    with as_options(given), progress_bar:  # the bar moves for the damage of a spectrum only
        plot = figures.plotting.plot_of(options.kind, subject, **given)
    say(*plot.notes)
    say(*(f"note: {doubt}" for doubt in plot.doubts), file=sys.stderr)
    numbers = [(options.csv, plot.write_numbers)] if plot.curves else []
    code = write_files([(figure, lambda path: plot.save(path, title)), *numbers])
    if code == 0:
        say(f"wrote {figure}" + ("" if options.csv is None else f" and {options.csv}"))
    return code


def _check_of_joint(options: argparse.Namespace, is_joint: bool) -> None:
    """Refuse options that have no effect on a joint of several pins, or on anything else."""
    if is_joint and options.interface != "pin":
        raise InputError("--interface", "is for a bush that slips in its seat, not for a joint of several pins")
    for name in ("pin", "plate"):
        if getattr(options, name) is not None and not is_joint:
            raise InputError(flag(name), "is for the result of a joint of several pins")
        if getattr(options, name) is not None and "joint" in KINDS[options.kind].sources:
            raise InputError(flag(name), f"has no effect on {options.kind}, which shows the whole joint")


def _draw_of_joint(options: argparse.Namespace, stored: storage.stored.StoredResult) -> int:
    """Draw the whole joint, or a pin in a plate."""
    case, result = storage.joint_files.case_of(stored), storage.joint_files.joint_of(stored)
    kind = KINDS[options.kind]
    if "joint" in kind.sources:
        return _draw(options, case.title, case.joint.unit_system, lambda _: figures.joint.JointSubject(result))
    pin, plate = hole_of(case.joint, options, f"is missing: {options.kind} shows one pin in one plate")
    with as_options(("pin", "plate")):
        held = storage.holes.HeldHole(case, result, pin, plate, kind.whole and case.joint.has_outline(plate))
    title = ", ".join(filter(None, [case.title, f"{pin} in {plate}"]))

    def subject(progress: Follow) -> figures.states.Subject:
        return figures.states.Subject(held.result, held, progress)

    return _draw(options, title, case.joint.unit_system, subject)


def hole_of(
    joint: joints.Joint, options: argparse.Namespace, missing: str = "is missing beside --plate"
) -> tuple[str, str]:
    """Return the names of the pin and the plate that options choose; of a pin alone its first plate.

    Without a pin raise :class:`InputError` with the words `missing`.
    """
    if options.pin is None:
        raise InputError("--pin", f"{missing}; the pins are {', '.join(pin.name for pin in joint.pins)}")
    known_name("--pin", options.pin, [pin.name for pin in joint.pins])
    first = next(pin.plates[0] for pin in joint.pins if pin.name == options.pin)
    return options.pin, first if options.plate is None else options.plate


def _check(options: argparse.Namespace, file: str | None) -> None:
    """Refuse options that have no effect on this kind of figure, and kinds that a TOML `file` can't have.

    `file` is "case", "joint file", or None for a result.
    """
    sources, is_case = KINDS[options.kind].sources, file == "case"
    if file == "joint file" and file not in sources:
        words = f"is a joint file, drawn by plates; {options.kind} needs its result: fastpin joint FILE -o RESULT"
        raise InputError(str(options.result), words)
    if is_case and file not in sources:
        needed = {"result": "a result: fastpin run", "life": "a life of wear: fastpin wear"}
        needed["joint"] = "the result of a joint: fastpin joint"
        words = needed[sources[0]]
        raise InputError(str(options.result), f"is a case file; {options.kind} needs {words} CASE -o FILE")
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
