"""``fastpin plot``: a figure of a stored result, and the numbers in it as CSV."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from fastpin import casefile, damage, figures, report, solver, storage
from fastpin.cli.options import PLOT_OPTIONS
from fastpin.cli.progress import Bar, progress_to
from fastpin.cli.terminal import check_outputs, say, write_files
from fastpin.errors import InputError
from fastpin.kernels.status import Status
from fastpin.report.curves import Curve, write_csv
from fastpin.states.choice import NO_CYCLE, chosen_cycles, span_of
from fastpin.states.cycles import Cycle
from fastpin.states.load_cycle import LoadCycle

Made = tuple[Callable[[Path], object], Callable[[Path], object]]
"""Two functions that write a file: the figure, and its numbers."""


def run(options: argparse.Namespace) -> int:
    """Draw one kind of figure of a stored result."""
    _check(options)
    film = options.kind == "animation"
    figure = Path(f"{options.kind}.{'gif' if film else 'png'}") if options.output is None else options.output
    outputs = {"--output": figure, "--csv": options.csv}
    if film:
        figures.animation.check_animation("--output", figure)
    title = "" if _is_case_file(options) else storage.stored_case(options.result).title
    check_outputs(outputs, figures=() if film else ("--output",))
    try:
        draw, write = KINDS[options.kind](options, title)
    except InputError as error:
        given = error.field in PLOT_OPTIONS[options.kind] and getattr(options, error.field) is not None
        raise InputError(f"--{error.field}" if given else error.field, error.reason) from None
    code = write_files([(figure, draw), (options.csv, write)])
    if code == 0:
        say(f"wrote {figure}" + ("" if options.csv is None else f" and {options.csv}"))
    return code


def _is_case_file(options: argparse.Namespace) -> bool:
    """Whether the joint of a sketch stands in a case file, not in a result."""
    return options.kind == "sketch" and options.result.suffix.lower() == ".toml"


def _check(options: argparse.Namespace) -> None:
    """Refuse options that have no effect on this kind of figure."""
    if options.result.suffix.lower() == ".toml" and options.kind != "sketch":
        raise InputError(
            str(options.result), f"is a case file; {options.kind} needs a result: fastpin run CASE -o FILE"
        )
    if _is_case_file(options) and options.states is not None:
        raise InputError("--states", "chooses a state of a result; a case file has none")
    known = PLOT_OPTIONS[options.kind]
    for name in sorted({name for names in PLOT_OPTIONS.values() for name in names}):
        if getattr(options, name) is not None and name not in known:
            kinds = ", ".join(kind for kind, names in PLOT_OPTIONS.items() if name in names)
            raise InputError(f"--{name}", f"has no effect on {options.kind}; it is for {kinds}")


def _given(options: argparse.Namespace, *names: str) -> dict[str, Any]:
    """The options of these names that were given."""
    return {name: value for name in names if (value := getattr(options, name)) is not None}


def _states(
    options: argparse.Namespace, usual: str | None = None, most: int = 0, whole: bool = False, hoop: str = ""
) -> figures.states.DrawnStates:
    """The states of ``--states``, or the `usual` ones. Only these are read from the file.

    With `most` a figure draws up to so many states, in a row; or as a `whole`, which joins more states. With `hoop` it
    draws the hoop stress of this body.
    """
    chosen = usual if options.states is None else options.states
    if most:
        states = figures.states.stored_states(options.result, chosen, most, in_a_row=not whole, whole=whole)
    else:
        extremes = figures.states.HOOP.get(hoop, ()) if hoop else figures.states.TRACTIONS
        states = figures.states.stored_states(options.result, chosen, extremes=extremes)
    if states.note:
        say(f"the figure shows {states.note}{states.remedy}")
    return states


def _curves(curves: Sequence[Curve]) -> Callable[[Path], object]:
    return lambda path: write_csv(curves, path)


def _drawn(
    draw: Callable[[figures.sheet.Look], figures.sheet.Sheet], title: str, **options: Any
) -> Callable[[Path], object]:
    """A function that writes the figure of a sheet. The curves of the sheet are computed once, for figure and CSV."""

    def write(path: Path) -> None:
        look = figures.sheet.Look(path, title, **options)
        look.drawn(lambda: draw(look))

    return write


def _tractions(options: argparse.Namespace, title: str) -> Made:
    states = _states(options)
    sketch, bars = options.sketch is not None, options.bars is not None
    curves = figures.tractions.traction_curves(states, bars)
    return _drawn(lambda look: figures.tractions.draw_tractions(states, look, sketch, bars), title), _curves(curves)


def _polar(options: argparse.Namespace, title: str) -> Made:
    states = _states(options)
    return _drawn(lambda look: figures.polar.draw_polar(states, look), title), _curves(
        figures.tractions.traction_curves(states)
    )


def _stick_slip(options: argparse.Namespace, title: str) -> Made:
    states = _states(options, most=figures.stick_slip.MOST_COLUMNS, whole=True)
    if len(states) > figures.stick_slip.MOST_COLUMNS:
        return _long_stick_slip(states, title)
    boxes = list(figures.stick_slip.zone_boxes(states))
    columns: dict[str, Any] = {
        "load point": np.array([box.point for box in boxes]),
        "start [deg]": np.array([box.start for box in boxes]),
        "stop [deg]": np.array([box.stop for box in boxes]),
        "status": np.array([Status(box.status).name.lower().replace("_", " ") for box in boxes]),
    }
    return _drawn(lambda look: figures.stick_slip.draw_stick_slip(states, look), title), _curves([Curve({}, columns)])


def _long_stick_slip(states: figures.states.DrawnStates, title: str) -> Made:
    """The map of many states, whose columns join some of them."""
    columns, words = figures.stick_slip.long_columns(states)
    say(f"the figure shows {len(states):,} states in {len(columns)} columns: {words}")
    frame = figures.states.Frame(states)
    boxes = list(figures.slip_extent.extent_boxes(states, columns, frame))
    look = figures.stick_slip.extent_look
    numbers: dict[str, Any] = {
        "load points after": np.array([box.left for box in boxes]),
        "to": np.array([box.right for box in boxes]),
        "start [deg]": np.array([box.start for box in boxes]),
        "stop [deg]": np.array([box.stop for box in boxes]),
        "slip": np.array([look(states[0].problem, box.extent)[2] for box in boxes]),
    }
    return _drawn(lambda sheet: figures.stick_slip.draw_stick_slip(states, sheet), title), _curves([Curve({}, numbers)])


def _sketch(options: argparse.Namespace, title: str) -> Made:
    joint: Any
    if _is_case_file(options):
        joint = casefile.read_case(options.result)
        title = joint.title
    elif options.states is None:
        joint = storage.load(options.result, states=[])
    else:
        joint = _states(options)[-1]
    return lambda path: figures.plot_sketch(joint, path, title), _curves([])


def _animation(options: argparse.Namespace, title: str) -> Made:
    usual = "cycle" if storage.load(options.result, states=[]).cycles else None
    states, given = _states(options, usual, most=figures.animation.MOST_FRAMES), _given(options, "rate")
    figures.animation.check_motion(states, given.get("rate", figures.animation.RATE))

    def write(path: Path) -> None:
        with Bar(len(states), "state {n:.0f} of {total:.0f}") as progress_bar:
            figures.animate(states, path, title, progress=progress_to(progress_bar), **given)

    return write, _curves([])


def _hoop(options: argparse.Namespace, title: str) -> Made:
    states, given = _states(options, hoop=options.body or "both"), _given(options, "body")
    curves = report.stress.hoop_curves(states, **given)
    return _drawn(lambda look: figures.stress.draw_hoop(states, curves, look), title), _curves(curves)


def _profile(options: argparse.Namespace, title: str) -> Made:
    states, given = _states(options, hoop=options.body or "plate"), _given(options, "body", "angle", "depth")
    curves = report.stress.depth_curves(states, **given)
    return _drawn(lambda look: figures.stress.draw_profile(states, curves, look), title), _curves(curves)


def _map(options: argparse.Namespace, title: str) -> Made:
    state, given = _states(options, "last")[-1], _given(options, "component", "body", "extent")
    curves, component = report.stress.field_curves(state, **given), given.get("component", "von_mises")
    draw = _drawn(
        lambda look: figures.stress.draw_field(state, curves, component, look), title, width=figures.stress.FIELD_WIDTH
    )
    return draw, _curves(curves)


def _with_cycles(path: Path) -> solver.Result:
    """The stored result without its states. It has at least one cycle."""
    result = storage.load(path, states=[])
    if not result.cycles:
        raise InputError("result", NO_CYCLE)
    return result


def _with_states(path: Path, cycle: Cycle) -> solver.Result:
    """The stored result with the states of one of its cycles."""
    return storage.load(path, states=storage.places_between(path, *span_of(cycle)))


def _result(options: argparse.Namespace) -> solver.Result:
    """The stored result with the states of its last cycle."""
    return _with_states(options.result, _with_cycles(options.result).cycles[-1])


def _cycles(options: argparse.Namespace, title: str) -> Made:
    result = _with_cycles(options.result)
    curve = report.cycle.cycles_curve(result.problem, result.cycles)
    return lambda path: figures.plot_cycles(result, path, title=title), _curves([curve])


def _slip(options: argparse.Namespace, title: str) -> Made:
    cycle = _result(options).cycle()
    return lambda path: figures.plot_slip(cycle, path, title), lambda path: report.cycle.write_csv(cycle, path)


def _loops(options: argparse.Namespace, title: str) -> Made:
    cycles = _chosen_cycles(options)
    abscissa = options.abscissa
    figures.load_cycle.check_loops(list(cycles.values()), abscissa)
    for number, cycle in cycles.items():
        say(f"cycle {number:,}: {figures.load_cycle.dissipated_words(cycle)}")
        if doubt := figures.load_cycle.area_doubt(cycle):
            say(f"note: {doubt}", file=sys.stderr)
    names = [f"cycle {number:,}" for number in cycles]
    curves = [Curve({"cycle": number}, report.cycle.loop_curve(cycle).columns) for number, cycle in cycles.items()]

    def write(path: Path) -> None:
        figures.plot_loops(list(cycles.values()), path, title, abscissa=abscissa, names=names)

    return write, _curves(curves)


def _chosen_cycles(options: argparse.Namespace) -> dict[int, LoadCycle]:
    """The cycles of ``--cycle`` by number, at most as many as a figure can show. Others than loops are left out."""
    result = _with_cycles(options.result)
    chosen = "last" if options.cycle is None else options.cycle
    places, refusal = chosen_cycles(result.cycles, chosen), None
    found: dict[int, LoadCycle] = {}
    shown = figures.style.spread(len(places), figures.style.MAX_NAMED)
    if len(shown) < len(places):
        numbers = ", ".join(f"{places[k] + 1:,}" for k in shown)
        say(f"the figure shows {len(shown)} of {len(places):,} cycles: {numbers}")
    for place in (places[k] for k in shown):
        part = _with_states(options.result, result.cycles[place])
        try:
            found[place + 1] = part.cycle(place)
        except InputError as error:
            refusal = error
            if len(places) > 1:
                say(f"note: cycle {place + 1:,} is left out: {error.reason}", file=sys.stderr)
    if refusal is not None and not found:
        raise refusal
    return found


def _fatigue(options: argparse.Namespace, title: str) -> Made:
    result = _result(options)
    cycle = damage.cycle_states(result, result.cycles[-1])
    criterion: Any = "smith-watson-topper" if options.criterion is None else options.criterion
    bodies = report.cycle.fatigue_bodies(cycle[0].problem, criterion) if options.body is None else [options.body]
    found = [damage.fatigue(cycle, criterion, body, **_given(options, "depth")) for body in bodies]
    curves = [report.fatigue.fatigue_curve(one) for one in found]
    return lambda path: figures.plot_fatigue(found, path, title), _curves(curves)


KINDS: dict[str, Callable[[argparse.Namespace, str], Made]] = {
    "tractions": _tractions,
    "polar": _polar,
    "stick-slip": _stick_slip,
    "sketch": _sketch,
    "animation": _animation,
    "hoop": _hoop,
    "profile": _profile,
    "map": _map,
    "cycles": _cycles,
    "slip": _slip,
    "loops": _loops,
    "fatigue": _fatigue,
}
"""Each kind of figure, with the function that makes its writers."""
