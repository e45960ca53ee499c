"""``fastpin run``, ``resume`` and ``show``: solve, and hand out what was found as table, figures and files."""

from __future__ import annotations

import argparse
import dataclasses
import json
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fastpin.errors import InputError, Interrupted, SolveError
from fastpin.terminal import (
    EXIT_FAILED,
    EXIT_INTERRUPTED,
    EXIT_OK,
    bar,
    check_outputs,
    fail,
    write_files,
    write_text,
)

if TYPE_CHECKING:
    from fastpin.casefile import Case
    from fastpin.run import Progress
    from fastpin.state import Result

LARGE_STRAIN = 0.05


def run(options: argparse.Namespace) -> int:
    """Solve a case."""
    from fastpin.casefile import builtin_case, read_case

    case = builtin_case() if options.case is None else read_case(options.case)
    case = _overridden(case, options)
    _check_outputs(options)
    _check_combination(case, options)
    start = _start(options)
    keywords = {**case.options.keywords(), **({} if start is None else {"start": start})}
    if options.error_bars:
        keywords["error_bars"] = True
    with bar(len(case.history), "load point {n:.2f} of {total}") as shown:
        progress = _progress(shown)
        if options.output is not None:
            from fastpin.record import record

            saved = _whole_numbers(len(case.history), options.save_after)
            ended = _ended(
                lambda: record(
                    case.problem, case.history, options.output, progress=progress, save_after=saved,
                    overwrite=options.overwrite, title=case.title, **keywords,
                )
            )  # fmt: skip
            return _hand_out_stored(case, options, ended)
        from fastpin.solver import solve

        found: list[Result] = []
        ended = _ended(lambda: found.append(solve(case.problem, case.history, progress=progress, **keywords)))
    return _hand_out(case, options, found[0] if ended is None else ended.result, ended)


def resume(options: argparse.Namespace) -> int:
    """Go on with a run that has ended early."""
    from fastpin.record import resume as go_on
    from fastpin.record import stored_case

    case = stored_case(options.output)
    _check_outputs(options)
    _check_cycles(case, options)
    with bar(len(case.history), "load point {n:.2f} of {total}") as shown:
        ended = _ended(lambda: go_on(options.output, _progress(shown)))
    return _hand_out_stored(case, options, ended)


def show(options: argparse.Namespace) -> int:
    """Print and draw a result that is in a file."""
    from fastpin.record import stored_case

    case = stored_case(options.output)
    _check_outputs(options)
    _check_cycles(case, options)
    return _hand_out_stored(case, options, None)


def _ended(work: Callable[[], object]) -> SolveError | Interrupted | None:
    """Do it, and return how it ended early, if it did."""
    try:
        work()
    except (SolveError, Interrupted) as ended:
        return ended
    return None


def _progress(shown: Any) -> Progress:
    def progress(done: float, total: int) -> None:
        shown.total = total
        shown.update(done - shown.n)

    return progress


# -- options -------------------------------------------------------------------------------------------------


def _overridden(case: Case, options: argparse.Namespace) -> Case:
    """The case with the solver options of the command line."""
    given: dict[str, Any] = {}
    for name in ("nodes", "method", "increments", "keep", "shortcut"):
        if getattr(options, name) is not None:
            given[name] = getattr(options, name)
    if options.between is not None:
        given["between"] = _between(options.between)
    try:
        return dataclasses.replace(case, options=dataclasses.replace(case.options, **given))
    except InputError as error:
        raise InputError(f"--{error.field}", error.reason) from None


def _between(text: str) -> int | tuple[float, ...]:
    from fastpin.casefile import checked_between

    try:
        value: object = int(text) if text.strip().lstrip("+-").isdigit() else [float(part) for part in text.split(",")]
    except ValueError:
        value = text
    try:
        return checked_between(value)
    except InputError as error:
        raise InputError("--between", error.reason) from None


def _check_combination(case: Case, options: argparse.Namespace) -> None:
    """Refuse options that would have no effect, and what can't be drawn."""
    for name in ("save_after", "overwrite"):
        if getattr(options, name) and options.output is None:
            raise InputError(f"--{name.replace('_', '-')}", "needs --output FILE")
    for name in ("output", "start"):
        if options.error_bars and getattr(options, name) is not None:
            raise InputError("--error-bars", f"are not kept in files: can't be combined with --{name}")
    if options.start is not None and options.nodes is not None:
        raise InputError("--nodes", "is that of the result to go on from (--start)")
    if case.options.keep == "cycles" and not case.history.longest_cycle:
        raise InputError("--keep", "the history has no cycles: none of its blocks is repeated")
    _check_cycles(case, options)


def _check_cycles(case: Case, options: argparse.Namespace) -> None:
    if options.cycles is not None and not case.history.longest_cycle:
        raise InputError("--cycles", "the history has no cycles: none of its blocks is repeated")


def _whole_numbers(corners: int, text: str | None) -> list[int]:
    """The corners after which a restart is kept."""
    try:
        numbers = [] if text is None else [int(part) for part in text.split(",")]
    except ValueError:
        numbers = [0]
    if not all(1 <= number <= corners for number in numbers):
        raise InputError("--save-after", f"must be corners from 1 to {corners}, such as 1,{corners}, not {text!r}")
    return numbers


def _start(options: argparse.Namespace) -> Result | None:
    """The result to go on from."""
    if options.start is None:
        if options.after is not None:
            raise InputError("--after", "needs --start FILE")
        return None
    from fastpin.store import load

    if options.output is not None and options.output.resolve() == options.start.resolve():
        raise InputError("--output", "is the file to start from; a branch needs a file of its own")
    try:
        start = load(options.start, states=[], after=options.after)
    except InputError as error:
        raise InputError("--after" if error.field == "after" else error.field, error.reason) from None
    if start.restart is None:
        why = "its run has not finished: resume it, or say after which corner (--after)"
        if start.complete:
            why = "it holds nothing to go on from, as the results of sweeps do"
        raise InputError("--start", f"{options.start}: {why}")
    return start


def _check_outputs(options: argparse.Namespace) -> None:
    """Find out before the work what could not be written after it."""
    names = {"--json": options.json, "--plot": options.plot, "--cycles": options.cycles, "--output": options.output}
    check_outputs(names, getattr(options, "case", None))


# -- what was found ------------------------------------------------------------------------------------------


def _hand_out_stored(case: Case, options: argparse.Namespace, ended: SolveError | Interrupted | None) -> int:
    """Print and draw what is in the file of a run; of many states no more than that takes is read."""
    from fastpin.plot import MAX_LINES, spread
    from fastpin.report import shown_rows
    from fastpin.store import load, size

    if ended is not None and ended.result is None:  # the file, if there is one, is not of this run
        return _hand_out(case, options, None, ended)
    count = size(options.output)
    if options.json is not None:
        return _hand_out(case, options, load(options.output), ended)
    picked = set(shown_rows(count))
    if options.plot is not None:
        picked |= set(spread(count, MAX_LINES))
    result = load(options.output, states=sorted(picked))
    return _hand_out(case, options, result, ended, hidden=count - len(picked))


def _hand_out(
    case: Case,
    options: argparse.Namespace,
    result: Result | None,
    ended: SolveError | Interrupted | None,
    hidden: int = 0,
) -> int:
    """Print the states and write the files that were asked for; `hidden` states in the middle are left out."""
    from fastpin.report import summary

    code, error = EXIT_OK, None
    if isinstance(ended, SolveError):
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
            f"; go on with: fastpin resume {options.output}"
            if options.output is not None and result is not None
            else ""
        )
        code = fail(f"interrupted {where}{more}", EXIT_INTERRUPTED)

    writers: list[tuple[Any, Callable[[Path], None]]] = []
    if options.json is not None:
        document = json.dumps(summary(case, result, error), indent=2, allow_nan=False) + "\n"
        if options.json != "-":
            writers.append((options.json, lambda path: write_text(path, document)))
    if result is not None and len(result):
        reached = result
        writers.append((options.plot, lambda path: _plot(reached, path, case.title)))
    if result is not None and result.cycles:
        with_cycles = result
        writers.append((options.cycles, lambda path: _plot_cycles(with_cycles, path, case.title)))
    elif options.cycles is not None:
        code = fail(f"can't write {options.cycles}: no cycle came to its end", EXIT_FAILED)
    code = write_files(writers) or code
    if options.json == "-":  # last, for whoever reads our output may leave
        sys.stdout.write(document)
    else:
        _print_states(case, result, hidden)
    return code


def _reached(result: Result) -> int:
    """Corners that were solved, kept or not."""
    return 0 if result.restart is None else result.restart.corner


def _print_states(case: Case, result: Result | None, hidden: int) -> None:
    from fastpin.report import cycle_lines, state_table

    if case.title:
        print(case.title)
    if result is None or not len(result):
        print("no state was reached" if result is None or not _reached(result) else "none of the states was to be kept")
        return
    print(state_table(case.problem, list(result), hidden))
    strain = case.problem.pair.beta_star * max(state.peak_pressure for state in result)
    if strain > LARGE_STRAIN and not case.problem.dimensionless:
        print(f"note: contact strains of about {strain:.2g} are beyond linear elasticity; are all values in SI units?")
    for line in cycle_lines(case.problem, result.cycles):
        print(line)
    statistics = result.statistics
    names = ("events", "exchanges", "rebuilds", "repeated", "increments", "seconds")
    known = [f"{statistics[name]:.4g} {name}" for name in names if statistics.get(name)]
    print(f"{result.method} solver, {result.grid.size} nodes{''.join(f', {part}' for part in known)}")


def _plot(states: Sequence[Any], path: Path, title: str) -> None:
    from fastpin.plot import plot_tractions

    plot_tractions(states, path, title=title)


def _plot_cycles(result: Result, path: Path, title: str) -> None:
    from fastpin.plot import plot_cycles

    plot_cycles(result, path, title=title)
