"""``fastpin run``, ``resume`` and ``show``: solve, then write the states as a table, figures and files."""

from __future__ import annotations

import argparse
import contextlib
import dataclasses
import sys
from collections.abc import Callable, Mapping
from functools import cache, partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fastpin import assess, casefile, figures, live, report, solver, storage
from fastpin.assess.margins import MOST_STOPS, margin_lines
from fastpin.cli import joint, terminal, wear
from fastpin.cli.options import literal
from fastpin.cli.plot import seat_of, seat_title
from fastpin.cli.progress import LOAD_POINTS, Bar, progress_to
from fastpin.errors import InputError, ReadingError
from fastpin.kernels import first
from fastpin.model.acting import check_keep
from fastpin.model.case import BESIDE, Case, beside_of
from fastpin.model.doubts import warn_of
from fastpin.model.options import OPTIONS
from fastpin.report.states import (
    bush_line,
    cycle_lines,
    hoop_lines,
    note_lines,
    seat_lines,
    solver_line,
    state_table,
    stored_rows,
    way_on,
)
from fastpin.runtime import beside
from fastpin.states import choice
from fastpin.states.margins import Margin, over_yield
from fastpin.storage.held import Held

if TYPE_CHECKING:  # they import compiled code
    from fastpin.states.load_cycle import LoadCycle
    from fastpin.states.state import State


def run(options: argparse.Namespace) -> int:
    """Solve a case, and write its states."""
    case = casefile.builtin_case() if options.case is None else casefile.read_case(options.case)
    case = _with_options(case, options)
    _check_combination(case, options)
    start = _start(options)
    _check_outputs(options)
    if start is not None and start.grid.size != case.options.nodes:
        nodes = f"the {start.grid.size} nodes of {options.start} are used, not {case.options.nodes}"
        terminal.say(f"note: {nodes}", file=sys.stderr)
    saved = _corners(len(case.history), options.save_after)
    keywords: dict[str, Any] = {**case.options.keywords(), "start": start}
    if start is not None:
        keywords["arc"] = None  # the grid is the one of the start
    solved: list[solver.Result] = []
    beside.module = first.MODULE  # compiles in a second process during a first run
    with Bar(len(case.history), LOAD_POINTS) as progress_bar, terminal.as_options(_given(options)):
        keywords["progress"] = progress_to(progress_bar)
        if options.output is None:
            ended = _ending(lambda: solved.append(solver.solve(case.problem, case.history, **keywords)))
        else:
            keywords |= {"title": case.title, "about": case.about, **beside_of(case)}
            keywords |= {"save_after": saved, "overwrite": options.overwrite}
            ended = _ending(lambda: storage.record(case.problem, case.history, options.output, **keywords))
    if options.output is not None:
        return _write_stored(case, options, ended)
    result = solved[0] if ended is None else ended.result
    return RunReport(case, None if result is None else Held(result), ended, is_looked_at=ended is None).write(options)


def resume(options: argparse.Namespace) -> int:
    """Continue a run that ended early, and write its states."""
    case = storage.StoredResult(options.output).case
    _check_outputs(options)
    _check_shown(case, options)
    with Bar(len(case.history), LOAD_POINTS) as progress_bar:
        ended = _ending(lambda: storage.resume(options.output, progress_to(progress_bar)))
    return _write_stored(case, options, ended)


def show(options: argparse.Namespace) -> int:
    """Print and draw a stored result of one pin or of a joint, or print a stored life of wear."""
    with storage.stored.StoredResult(options.output) as stored:
        if stored.is_joint:
            return joint.show(stored, options)
        terminal.check_outputs({"--shares": options.shares}, ("--shares",))
        for name in ("at", "shares"):
            if getattr(options, name) is not None:
                raise InputError(terminal.flag(name), "is for the result of a joint of several pins")
        return wear.show(stored, options) if stored.is_life else _show(stored, options)


def _show(stored: storage.stored.StoredResult, options: argparse.Namespace) -> int:
    """Print and draw the result of one pin."""
    shown: Case = stored.case
    held: Held = stored
    _check_outputs(options)
    _check_shown(shown, options)
    if options.interface == "seat":
        held = Held(seat_of(stored))
        problem, title = held.result.problem, seat_title(shown.title)
        shown = dataclasses.replace(shown, problem=problem, title=title, fatigue=None)
    code = RunReport(shown, held, None).write(options)
    if options.json != "-":
        _note_unfinished(stored)
    return code


def _note_unfinished(stored: storage.stored.StoredResult) -> None:
    """Say that a stored run has not come to its end, how far it is, and why or how to continue it."""
    if stored.lacks_error_bars:
        words = "no error bars: their run on the coarse grid has not ended"
        terminal.say(f"note: {words}; continue with: fastpin resume {stored.path}")
    if stored.result.complete:
        return
    reached = f"{stored.read([stored.points.size - 1])[0].step + 1:,}" if stored.points.size else "0"
    why = f": {stored.error}" if stored.error else ""
    more = f"; {how}" if (how := way_on(stored.path, stored.error)) else ""
    terminal.say(f"note: unfinished, at corner {reached} of {len(stored.case.history):,}{why}{more}")


def _ending(work: Callable[[], object]) -> solver.SolveError | solver.Interrupted | None:
    """Do the work. Return the error that ended it early, or None."""
    try:
        work()
    except (solver.SolveError, solver.Interrupted) as ended:
        return ended
    return None


def _with_options(case: Case, options: argparse.Namespace) -> Case:
    """Return the case with the solver's options of the command line in place of its own."""
    texts = {name: text for name in OPTIONS if (text := getattr(options, name)) is not None}
    given = {name: _value(text, name in ("arc", "between")) for name, text in texts.items()}  # these may be lists
    with terminal.as_options(_given(options)):
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


def _given(options: argparse.Namespace) -> list[str]:
    """The fields of the solver that the command line has."""
    return [name for name in (*OPTIONS, "start") if getattr(options, name) is not None]


def _check_combination(case: Case, options: argparse.Namespace) -> None:
    """Refuse options that would have no effect, and figures that can't be drawn."""
    for name in ("save_after", "overwrite"):
        if getattr(options, name) and options.output is None:
            raise InputError(terminal.flag(name), "needs --output FILE")
    for name in ("nodes", "arc"):
        if options.start is not None and getattr(options, name) is not None:
            raise InputError(f"--{name}", "is fixed by the result to continue from (--start)")
    _check_shown(case, options)


def _check_shown(case: Case, options: argparse.Namespace) -> None:
    """Refuse figures and files of cycles that the history lacks, and a wrong choice of states."""
    for name in ("cycles", "cycle_csv"):
        if getattr(options, name) is not None and not case.history.longest_cycle:
            raise InputError(terminal.flag(name), "the history has no cycles: none of its blocks is repeated")
    if options.states is None:
        return
    if options.plot is None:
        raise InputError("--states", "chooses the states of a figure: it needs --plot FILE")
    with terminal.as_options(["states"]):
        choice.check_choice(options.states, case.history)


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
    with terminal.as_options(["after"]):
        start = storage.load(options.start, states=[], after=options.after)
    if start.restart is None:
        why = "its run has not finished: resume it, or say after which corner (--after)"
        if start.complete:
            why = "it holds no restart; the results of sweeps hold none"
        raise InputError("--start", f"{options.start}: {why}")
    return start


def _check_outputs(options: argparse.Namespace) -> None:
    """Check before the work that all output files can be written. Only ``run`` has an output that is a result."""
    names = ("json", "plot", "cycles", "cycle_csv", "record", *(("output",) if "overwrite" in options else ()))
    terminal.check_outputs({terminal.flag(name): getattr(options, name) for name in names}, result="--output")


def _write_stored(case: Case, options: argparse.Namespace, ended: solver.SolveError | solver.Interrupted | None) -> int:
    """Write the states of a stored run. Without a state, a file with this name belongs to another run."""
    if ended is not None and ended.result is None:
        return RunReport(case, None, ended).write(options)
    with storage.stored.StoredResult(options.output) as held:
        return RunReport(case, held, ended, is_looked_at=ended is None).write(options)


@dataclasses.dataclass(frozen=True, eq=False)
class RunReport:
    """The report of a run: why it ended early, its files, and its table. Of many states, only some are read.

    Attributes
    ----------
    case : Case
    held : Held or None
        The result. None if no state was reached.
    ended : SolveError, Interrupted or None
        The error that ended the run early.
    is_looked_at : bool
        Whether the run itself gave the warnings of its states: it does so at its end.
    """

    case: Case
    held: Held | None
    ended: solver.SolveError | solver.Interrupted | None
    is_looked_at: bool = False

    def write(self, options: argparse.Namespace) -> int:
        """Write the files, then print the states, and return the exit code."""
        case, held = self.case, self.held
        code, error = self._report_end()
        read = terminal.Readings()
        if held is not None and not self.is_looked_at:
            read("warnings", lambda: warn_of(held.doubts(), 2), None)
        cycle, found = None, {}
        with contextlib.suppress(InputError):
            cycle = self._last_cycle() if case.options.slip_sums else None
        for name in beside_of(case):
            found[name] = read(name, partial(self._found, name), None)
        why = "" if held is None or not held.result.complete or "fatigue" not in found else found["fatigue"].reason
        code = terminal.fail(f"fatigue: {why}", terminal.EXIT_FAILED) if why else code
        document = None
        if options.json is not None:
            document = report.summary.document(case, None if held is None else held.whole(), error, cycle, found)
        writers: list[tuple[Any, Callable[[Path], object]]] = []
        if held is not None and held.points.size:
            writers.append((options.plot, lambda path: self._plot(held, options, path)))

            def record(path: Path) -> None:
                states = held.read(live.recorded_places(held.points.size))
                terminal.write_text(path, live.record_page(case, states, error or ""))

            writers.append((options.record, record))
        if held is not None and held.result.cycles:
            writers.append((options.cycles, partial(figures.plot_cycles, held.result, title=case.title)))
        elif options.cycles is not None:
            code = terminal.fail(f"can't write {options.cycles}: no cycle came to its end", terminal.EXIT_FAILED)

        def write_cycle(path: Path) -> None:
            assess.outputs.write_csv([assess.cycle.nodes_curve(self._last_cycle())], path)

        writers.append((options.cycle_csv, write_cycle))
        code = terminal.write_outputs(writers, options.json, lambda: document) or code
        if options.json != "-":
            self._print_states(read, cycle, found)
        if document is not None:
            for name, reason in document["unread"].items():
                read.add(ReadingError(name, reason))
        return code or read.code

    def _found(self, name: str) -> Any:
        """What is found for a question of the case. A note says why nothing is found."""
        if name == "crack" and self.ended is not None:  # a run that was stopped is not to go on for long
            return None
        question = assess.questions.QUESTIONS[name]
        try:
            with Bar(1, question.bar) as bar:
                return question.find(self.case, self.held, progress_to(bar))
        except InputError as error:
            terminal.say(f"fastpin: note: {question.failed}: {error}", file=sys.stderr)
            return None

    def _report_end(self) -> tuple[int, str | None]:
        """Print why the run ended early, and return the exit code and the reason."""
        if self.ended is None:
            return terminal.EXIT_OK, None
        if isinstance(self.ended, solver.SolveError):
            return terminal.fail(str(self.ended), terminal.EXIT_FAILED), str(self.ended)
        if self.held is None:
            return terminal.fail("interrupted before the first corner", terminal.EXIT_INTERRUPTED), "interrupted"
        where = f"after {_reached(self.held.result)} of {len(self.case.history):,} corners"
        more = "" if self.held.path is None else f"; continue with: fastpin resume {self.held.path}"
        return terminal.fail(f"interrupted {where}{more}", terminal.EXIT_INTERRUPTED), "interrupted"

    def _last_cycle(self) -> LoadCycle:
        """Return the last cycle. :class:`InputError` says why there is none."""
        if self.held is None:
            raise InputError("cycle", "no state was reached")
        result = self.held.result
        if not result.cycles:
            return result.cycle()
        return self.held.part(*choice.span_of(result.cycles[-1])).cycle()

    def _plot(self, held: Held, options: argparse.Namespace, path: Path) -> None:
        """Draw the tractions."""
        with terminal.as_options(["states"]):
            drawn = figures.states.drawn_states(held, options.states)
        figures.plot_tractions(drawn, path, title=self.case.title)
        if drawn.note:
            to = sys.stderr if options.json == "-" else sys.stdout
            terminal.say(f"{path} shows {drawn.note}{drawn.remedy}", file=to)

    def _print_states(self, read: terminal.Readings, cycle: LoadCycle | None, found: Mapping[str, Any]) -> None:
        case, held = self.case, self.held
        if case.title:
            terminal.say(case.title)
        if held is None or not held.points.size:
            reached = held is not None and _reached(held.result)
            terminal.say("none of the states was to be kept" if reached else "no state was reached")
            return
        rows = stored_rows(case.problem, held.points, held.result.cycles, held.read, held.marks)
        terminal.say(*state_table(case.problem, held.read(rows.printed), rows).split("\n"))
        for error in held.extremes.unread.values():
            read.add(error)
        for name, lines in self._paragraphs(held, cycle, found).items():
            told: list[str] = read(name, lines, [])
            terminal.say(*(line for line in told if line))
        terminal.say(*(f"note: {note}" for note in note_lines(case, held.result)))
        terminal.say(solver_line(held.result))

    def _turning(self, held: Held) -> list[State]:
        """The states of the last cycle. None of too many, unless a seat needs them."""
        if not held.result.cycles:
            return []
        first, last = choice.span_of(held.result.cycles[-1])
        size = np.count_nonzero((held.points >= first) & (held.points <= last))
        return held.between(first, last) if size <= MOST_STOPS or self.case.problem.seat is not None else []

    def _paragraphs(
        self, held: Held, cycle: LoadCycle | None, found: Mapping[str, Any]
    ) -> dict[str, Callable[[], list[str]]]:
        """The lines below the table, each with the name of what is read for them."""
        problem, cycles = self.case.problem, held.result.cycles
        peaks, states = held.peaks, self._turning(held) if cycle is None else cycle.states

        def seat() -> list[str]:
            if problem.seat is None:
                return []
            (last,) = held.read([held.points.size - 1])
            return seat_lines(problem, peaks, last, choice.last_cycle_states(states, cycles))

        @cache
        def margins() -> list[Margin]:
            rows = held.static_margins
            if cycles or any(each is not None for each in found.values()):
                rows = assess.questions.result_margins(problem, rows, states, cycles, found)
            return rows

        def of_question(name: str) -> list[str]:
            known = found.get(name)
            return [] if known is None else [*assess.questions.QUESTIONS[name].lines(known, over_yield(margins()))]

        return {
            "largest hoop stress": lambda: hoop_lines(problem, peaks),
            "bush": lambda: bush_line(problem, peaks).splitlines(),
            "seat": seat,
            "cycles": lambda: cycle_lines(problem, cycles, peaks),
            "last cycle": lambda: [] if cycle is None else [assess.cycle.cycle_line(cycle)],
            "margins": lambda: margin_lines(problem, margins()),
            **{name: partial(of_question, name) for name in BESIDE},
        }


def _reached(result: solver.Result) -> int:
    """Return the number of corners that were solved, whether their states were kept or not."""
    return 0 if result.restart is None else result.restart.corner
