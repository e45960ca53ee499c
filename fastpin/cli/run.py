"""``fastpin run``, ``resume`` and ``show``: solve, then write the states as a table, figures and files."""

from __future__ import annotations

import argparse
import contextlib
import dataclasses
import json
import sys
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from fastpin import casefile, figures, live, report, solver, storage
from fastpin.cli.options import literal
from fastpin.cli.progress import LOAD_POINTS, Bar, note_duration, progress_to
from fastpin.cli.terminal import (
    EXIT_FAILED,
    EXIT_INTERRUPTED,
    EXIT_OK,
    check_outputs,
    fail,
    flag,
    say,
    write_files,
    write_text,
)
from fastpin.errors import InputError, InputWarning
from fastpin.model.case import Case, check_keep
from fastpin.model.doubts import pressure_doubts, warn_of
from fastpin.model.options import OPTIONS
from fastpin.model.points import EDGES
from fastpin.report.notes import note_lines, solver_line, way_on
from fastpin.report.states import TableRows, bush_line, cycle_lines, hoop_line, state_table, stored_rows, table_rows
from fastpin.states.choice import check_choice, span_of
from fastpin.states.extremes import KeptStates, marked_extremes, marked_places, yield_doubts_of

if TYPE_CHECKING:  # it imports compiled code
    from fastpin.states.load_cycle import LoadCycle

LISTS = ("arc", "between")
"""Options that take a number or a list of numbers, written with commas."""


def run(options: argparse.Namespace) -> int:
    """Solve a case, and write its states."""
    case = casefile.builtin_case() if options.case is None else casefile.read_case(options.case)
    case = _with_options(case, options)
    _check_combination(case, options)
    start = _start(options)
    _check_outputs(options)
    if start is not None and start.grid.size != case.options.nodes:
        nodes = f"the {start.grid.size} nodes of {options.start} are used, not {case.options.nodes}"
        say(f"note: {nodes}", file=sys.stderr)
    saved = _corners(len(case.history), options.save_after)
    keywords: dict[str, Any] = {**case.options.keywords(), "start": start}
    if start is not None:
        keywords["arc"] = None  # the grid is the one of the start
    solved: list[solver.Result] = []
    note_run(case)
    with Bar(len(case.history), LOAD_POINTS) as progress_bar, _as_options(options):
        keywords["progress"] = progress_to(progress_bar)
        if options.output is None:
            ended = _ending(lambda: solved.append(solver.solve(case.problem, case.history, **keywords)))
        else:
            keywords |= {"title": case.title, "about": case.about, "save_after": saved, "overwrite": options.overwrite}
            ended = _ending(lambda: storage.record(case.problem, case.history, options.output, **keywords))
    if options.output is not None:
        return _write_stored(case, options, ended)
    return _write_result(case, options, solved[0] if ended is None else ended.result, ended)


def note_run(case: Case) -> None:
    """Print a note before a run that will take more than a minute."""
    seconds = solver.expected_seconds(case.problem, case.history, case.options)
    note_duration(seconds, f", with {case.options.nodes:,} nodes; half as many take a fifth of the time")


def resume(options: argparse.Namespace) -> int:
    """Continue a run that ended early, and write its states."""
    case = storage.stored_case(options.output)
    _check_outputs(options)
    _check_cycles(case, options)
    _check_states(case, options)
    with Bar(len(case.history), LOAD_POINTS) as progress_bar:
        ended = _ending(lambda: storage.resume(options.output, progress_to(progress_bar)))
    return _write_stored(case, options, ended)


def show(options: argparse.Namespace) -> int:
    """Print and draw a stored result."""
    case = storage.stored_case(options.output)
    _check_outputs(options)
    _check_cycles(case, options)
    _check_states(case, options)
    code = _write_stored(case, options, None)
    if options.json != "-":
        _note_unfinished(case, options.output)
    return code


def _note_unfinished(case: Case, path: Path) -> None:
    """Say that a stored run has not come to its end, how far it is, and why or how to continue it."""
    last = storage.load(path, states=slice(-1, None))
    if storage.lacks_error_bars(path):
        say(f"note: no error bars: their run on the coarse grid has not ended; continue with: fastpin resume {path}")
    if last.complete:
        return
    reached = f"{last[0].step + 1:,}" if len(last) else "0"
    reason = storage.stored_error(path)
    why = f": {reason}" if reason else ""
    more = f"; {how}" if (how := way_on(path, reason)) else ""
    say(f"note: unfinished, at corner {reached} of {len(case.history):,}{why}{more}")


def _ending(work: Callable[[], object]) -> solver.SolveError | solver.Interrupted | None:
    """Do the work. Return the error that ended it early, or None."""
    try:
        work()
    except (solver.SolveError, solver.Interrupted) as ended:
        return ended
    return None


def _with_options(case: Case, options: argparse.Namespace) -> Case:
    """Return the case with the solver's options of the command line in place of its own."""
    given = {name: _value(text, name in LISTS) for name in OPTIONS if (text := getattr(options, name)) is not None}
    with _as_options(options):
        changed = case.options.changed(**given)
        check_keep(case.history, changed)
    return dataclasses.replace(case, options=changed)


def _value(text: object, may_be_list: bool) -> Any:
    """The value that an option's text stands for: a number, a list of numbers, or the text itself."""
    if not isinstance(text, str):
        return text
    if may_be_list and "," in text:
        return [literal(part.strip()) for part in text.split(",")]
    return literal(text)


@contextlib.contextmanager
def _as_options(options: argparse.Namespace) -> Iterator[None]:
    """Name the option instead of the solver's field in errors raised within, if the command line has the option."""
    try:
        yield
    except InputError as error:
        if error.field in (*OPTIONS, "start") and getattr(options, error.field) is not None:
            raise InputError(flag(error.field), error.reason) from None
        raise


def _check_combination(case: Case, options: argparse.Namespace) -> None:
    """Refuse options that would have no effect, and figures that can't be drawn."""
    for name in ("save_after", "overwrite"):
        if getattr(options, name) and options.output is None:
            raise InputError(flag(name), "needs --output FILE")
    for name in ("nodes", "arc"):
        if options.start is not None and getattr(options, name) is not None:
            raise InputError(f"--{name}", "is fixed by the result to continue from (--start)")
    _check_cycles(case, options)
    _check_states(case, options)


def _check_cycles(case: Case, options: argparse.Namespace) -> None:
    for name in ("cycles", "cycle_csv"):
        if getattr(options, name) is not None and not case.history.longest_cycle:
            raise InputError(flag(name), "the history has no cycles: none of its blocks is repeated")


def _check_states(case: Case, options: argparse.Namespace) -> None:
    if options.states is None:
        return
    if options.plot is None:
        raise InputError("--states", "chooses the states of a figure: it needs --plot FILE")
    try:
        check_choice(options.states, case.history)
    except InputError as error:
        raise InputError("--states", error.reason) from None


def _corners(corners: int, text: str | None) -> list[int]:
    """Return the corners of ``--save-after``, from 1 to `corners`."""
    try:
        numbers = [] if text is None else [int(part) for part in text.split(",")]
    except ValueError:
        numbers = [0]
    if not all(1 <= number <= corners for number in numbers):
        raise InputError("--save-after", f'must be corners from 1 to {corners}, such as 1,{corners}, not "{text}"')
    return numbers


def _start(options: argparse.Namespace) -> solver.Result | None:
    """Return the result to continue from (``--start``), or None."""
    if options.start is None:
        if options.after is not None:
            raise InputError("--after", "needs --start FILE")
        return None
    if options.output is not None and options.output.resolve() == options.start.resolve():
        raise InputError("--output", "is the file to start from; a branch needs a file of its own")
    try:
        start = storage.load(options.start, states=[], after=options.after)
    except InputError as error:
        raise InputError("--after" if error.field == "after" else error.field, error.reason) from None
    if start.restart is None:
        why = "its run has not finished: resume it, or say after which corner (--after)"
        if start.complete:
            why = "it holds no restart; the results of sweeps hold none"
        raise InputError("--start", f"{options.start}: {why}")
    return start


def _check_outputs(options: argparse.Namespace) -> None:
    """Check before the work that all output files can be written. Only ``run`` has an output that is a result."""
    names = ("json", "plot", "cycles", "cycle_csv", "record", *(("output",) if "overwrite" in options else ()))
    if options.record is not None and options.record.suffix.lower() not in (".html", ".htm"):
        raise InputError("--record", f'must be the name of a page, which ends in .html, not "{options.record.name}"')
    check_outputs({flag(name): getattr(options, name) for name in names}, result="--output")


def _write_stored(case: Case, options: argparse.Namespace, ended: solver.SolveError | solver.Interrupted | None) -> int:
    """Write the states of a stored run. Of many states, only those in the table and the figure are read."""
    if ended is not None and ended.result is None:  # a file with this name, if any, belongs to another run
        return _write_result(case, options, None, ended)
    if options.json is not None:
        return _write_result(case, options, storage.load(options.output), ended)
    points, cycles = storage.load_points(options.output), storage.load(options.output, states=[]).cycles
    peaks = marked_places(storage.marked_extremes(options.output))
    rows = stored_rows(case.problem, points, cycles, lambda places: storage.load(options.output, places).states, peaks)
    places = {*rows.printed, *peaks}
    if cycles:
        last = range(points.size)[storage.places_between(options.output, *span_of(cycles[-1]))]
        if len(last) <= report.cycle.MOST_STOPS:
            places |= set(last)  # the fatigue over the last cycle is printed
    if options.record is not None:
        places |= set(live.recorded_places(points.size))
    part = ShownPart(rows, sorted(places), list(peaks))
    return _write_result(case, options, storage.load(options.output, states=sorted(places)), ended, part)


class ShownPart(NamedTuple):
    """The part of a stored result that was read.

    Attributes
    ----------
    rows : TableRows
        The rows of the table.
    places : list of int
        The places of the states that were read, in increasing order.
    peaks : list of int
        The places of the extremes that are printed.
    """

    rows: TableRows
    places: list[int]
    peaks: list[int]


def _write_result(
    case: Case,
    options: argparse.Namespace,
    result: solver.Result | None,
    ended: solver.SolveError | solver.Interrupted | None,
    part: ShownPart | None = None,
) -> int:
    """Write the files, then print the states, and return the exit code.

    `ended` is the error that ended the run early. `part` tells which states of a file `result` has.
    """
    code, error = _report_end(case, options, result, ended)
    warn_of(pressure_doubts(case.problem, case.history, _pressures(options, result)), 2)
    warn_of(_yield_doubts(case, options, result), 2)
    cycle = _known_cycle(case, options, result, part)
    writers: list[tuple[Any, Callable[[Path], object]]] = []
    if options.json is not None:
        text = json.dumps(report.summary.document(case, result, error, cycle), indent=2, allow_nan=False) + "\n"
        if options.json != "-":
            writers.append((options.json, lambda path: write_text(path, text)))
    if result is not None and len(result):
        states = result
        writers.append((options.plot, lambda path: _plot(case, options, states, part, path)))
        writers.append((options.record, lambda path: write_text(path, live.record_page(case, states, error or ""))))
    if result is not None and result.cycles:
        with_cycles = result
        writers.append((options.cycles, lambda path: figures.plot_cycles(with_cycles, path, title=case.title)))
    elif options.cycles is not None:
        code = fail(f"can't write {options.cycles}: no cycle came to its end", EXIT_FAILED)
    writers.append((options.cycle_csv, lambda path: report.cycle.write_csv(_last_cycle(options, result, part), path)))
    code = write_files(writers) or code
    if options.json == "-":  # last: the reader of the output may close it early
        sys.stdout.write(text)
    else:
        _print_states(case, result, cycle, part)
    return code


def _pressures(options: argparse.Namespace, result: solver.Result | None) -> Iterable[np.ndarray]:
    """Return the pressures of all states, or the largest one of a stored result."""
    if result is None or options.output is None:
        return (state.pressure for state in result or ())
    return [np.array([storage.largest_pressure(options.output)])]


def _yield_doubts(case: Case, options: argparse.Namespace, result: solver.Result | None) -> list[InputWarning]:
    """Return the warnings about the largest von Mises stresses of all states."""
    if result is None or options.output is None:
        return yield_doubts_of(case.problem, case.history, () if result is None else result.states)
    return storage.stored_yield_doubts(options.output, case.problem, case.history)


def _plot(case: Case, options: argparse.Namespace, result: solver.Result, part: ShownPart | None, path: Path) -> None:
    """Draw the tractions. States that were left out of `result` are read from its file."""
    try:
        if part is not None:
            drawn = figures.states.stored_states(options.output, options.states)
        else:
            drawn = figures.states.drawn_states(result, options.states)
    except InputError as error:
        raise InputError("--states" if error.field == "states" else error.field, error.reason) from None
    figures.plot_tractions(drawn, path, title=case.title)
    if drawn.note:
        say(f"{path} shows {drawn.note}{drawn.remedy}", file=sys.stderr if options.json == "-" else sys.stdout)


def _report_end(
    case: Case,
    options: argparse.Namespace,
    result: solver.Result | None,
    ended: solver.SolveError | solver.Interrupted | None,
) -> tuple[int, str | None]:
    """Print why a run ended early, and return the exit code and the reason."""
    code, error = EXIT_OK, None
    if isinstance(ended, solver.SolveError):
        error = str(ended)
        code = fail(error, EXIT_FAILED)
    elif ended is not None:
        error = "interrupted"
        where = (
            "before the first corner"
            if result is None
            else f"after {_reached(result)} of {len(case.history):,} corners"
        )
        more = (
            f"; continue with: fastpin resume {options.output}"
            if options.output is not None and result is not None
            else ""
        )
        code = fail(f"interrupted {where}{more}", EXIT_INTERRUPTED)
    return code, error


def _last_cycle(options: argparse.Namespace, result: solver.Result | None, part: ShownPart | None) -> LoadCycle:
    """Return the last cycle of a result. :class:`InputError` says why there is none."""
    if result is None:
        raise InputError("cycle", "no state was reached")
    if part is not None and result.cycles:  # its states are in the file, but not in `result`
        places = storage.places_between(options.output, *span_of(result.cycles[-1]))
        result = storage.load(options.output, states=places)
    return result.cycle()


def _known_cycle(
    case: Case, options: argparse.Namespace, result: solver.Result | None, part: ShownPart | None
) -> LoadCycle | None:
    """Return the last cycle if its slip sums are counted, for the summary; None if there is none."""
    with contextlib.suppress(InputError):
        return _last_cycle(options, result, part) if case.options.slip_sums else None
    return None


def _reached(result: solver.Result) -> int:
    """Return the number of corners that were solved, whether their states were kept or not."""
    return 0 if result.restart is None else result.restart.corner


def _print_states(case: Case, result: solver.Result | None, cycle: LoadCycle | None, part: ShownPart | None) -> None:
    if case.title:
        say(case.title)
    if result is None or not len(result):
        say("no state was reached" if result is None or not _reached(result) else "none of the states was to be kept")
        return
    if part is None:
        found = dict(enumerate(result.states))
        places = list(marked_places(marked_extremes(KeptStates(result.states))))
        rows = table_rows(case.problem, result.states, wanted=places)
    else:
        rows, found, places = part.rows, dict(zip(part.places, result.states, strict=True)), part.peaks
    say(*state_table(case.problem, [found[place] for place in rows.printed], rows).split("\n"))
    peaks = [found[place] for place in places]
    lines = [hoop_line(case.problem, peaks, body) for body in EDGES]
    for line in (*lines, *bush_line(case.problem, peaks).splitlines()):
        if line:
            say(line)
    for line in cycle_lines(case.problem, result.cycles, peaks):
        say(line)
    if cycle is not None:
        say(report.cycle.cycle_line(cycle))
    states = result.states if cycle is None else cycle.states
    for line in report.cycle.fatigue_lines(states, result.cycles[-1]) if result.cycles else ():
        say(line)
    for note in note_lines(case, result):
        say(f"note: {note}")
    say(solver_line(result))
