"""The command line: ``fastpin example``, ``fastpin check``, ``fastpin run``, ``fastpin paper`` and sweeps.

Everything else is imported when it is needed: help and wrong options are answered without NumPy, checks without
the solver.
"""

from __future__ import annotations

import argparse
import dataclasses
import json
import os
import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fastpin import __version__, cli_sweep
from fastpin.errors import CaseFileError, FastpinError, InputError, SolveError
from fastpin.files import check_writable, replacing
from fastpin.terminal import (
    EXIT_FAILED,
    EXIT_INPUT,
    EXIT_INTERRUPTED,
    EXIT_OK,
    EXIT_PIPE,
    bar,
    check_figure,
    fail,
)

if TYPE_CHECKING:
    from fastpin.casefile import Case
    from fastpin.state import Result

LARGE_STRAIN = 0.05


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line.

    Returns
    -------
    int
        Exit code: 0; 1 when the loads could not be followed to their end or a file could not be written;
        2 for input that can't be used; 130 when interrupted.
    """
    try:
        options = _parser().parse_args(arguments)
        code = int(options.command(options))
        sys.stdout.flush()
        return code
    except CaseFileError as error:
        print(error, file=sys.stderr)  # a line for each fault, with the file's name
        return EXIT_INPUT
    except InputError as error:
        return fail(str(error), EXIT_INPUT)
    except FastpinError as error:
        return fail(str(error), EXIT_FAILED)
    except KeyboardInterrupt:
        return fail("interrupted; nothing was written", EXIT_INTERRUPTED)
    except MemoryError:
        return fail("not enough memory: use fewer nodes or store fewer states", EXIT_FAILED)
    except BrokenPipeError:  # the reader of our output has gone (fastpin run | head)
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return EXIT_PIPE
    except OSError as error:
        return fail(str(error), EXIT_FAILED)


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="fastpin",
        description="Frictional contact of an elastic pin in the hole of an elastic plate.",
        epilog="Start with: fastpin example > case.toml; fastpin run case.toml",
        allow_abbrev=False,
    )
    parser.add_argument("--version", action="version", version=f"fastpin {__version__}")
    commands = parser.add_subparsers(title="commands", required=True, metavar="COMMAND")

    example = commands.add_parser("example", help="print a commented case file", allow_abbrev=False)
    example.set_defaults(command=_example)

    check = commands.add_parser("check", help="say what a case file means, or all that is wrong", allow_abbrev=False)
    check.add_argument("case", type=Path, help="case file (TOML)")
    check.set_defaults(command=_check)

    run = commands.add_parser("run", help="solve a case and print its states", allow_abbrev=False)
    run.add_argument("case", type=Path, nargs="?", help="case file (TOML); without one: the built-in case")
    run.add_argument(
        "--json",
        metavar="FILE",
        nargs="?",
        const="-",
        help="write a summary as JSON; without FILE, or with -, to standard output instead of the table",
    )
    run.add_argument(
        "--plot",
        metavar="FILE",
        nargs="?",
        const=Path("tractions.png"),
        type=Path,
        help="write a figure of the tractions (png, pdf or svg; default tractions.png)",
    )
    run.add_argument("-o", "--output", metavar="FILE", type=Path, help="write everything to an HDF5 file")
    run.add_argument("--nodes", type=int, help="number of nodes")
    run.add_argument("--method", help="path or increment")
    run.add_argument("--increments", type=int, help="increments a corner (method increment)")
    run.add_argument(
        "--between",
        metavar="N",
        help="more states inside every step: how many, or fractions such as 0.25,0.5",
    )
    run.set_defaults(command=_run)

    figures = commands.add_parser("paper", help="compute and draw the figures of the paper", allow_abbrev=False)
    figures.add_argument(
        "--figure",
        metavar="NAME",
        action="append",
        help="a figure's number, 3 to 17, or one that the paper does not have: memory, sliding-onset, half-plane, "
        "rigid-pin (may be repeated; default: all of the paper)",
    )
    figures.add_argument("--nodes", type=int, help="number of nodes (default 400)")
    figures.add_argument(
        "-o", "--output", metavar="DIR", type=Path, default=Path(), help="directory of the files (default: this one)"
    )
    figures.set_defaults(command=_paper)
    cli_sweep.add(commands)
    return parser


def _example(_: argparse.Namespace) -> int:
    from fastpin.casefile import EXAMPLE

    print(EXAMPLE, end="")
    return EXIT_OK


def _check(options: argparse.Namespace) -> int:
    from fastpin.casefile import read_case
    from fastpin.report import describe

    print(describe(read_case(options.case)))
    return EXIT_OK


def _run(options: argparse.Namespace) -> int:
    from fastpin.casefile import builtin_case, read_case
    from fastpin.report import summary

    case = builtin_case() if options.case is None else read_case(options.case)
    case = _overridden(case, options)
    _check_outputs(options)
    result, failure = _solve(case)

    if options.json != "-":
        _print_states(case, result)
    code = EXIT_OK
    if failure is not None:
        code = fail(str(failure), EXIT_FAILED)

    error = None if failure is None else str(failure)
    writers: list[tuple[Any, Callable[[Path], None]]] = []
    document = json.dumps(summary(case, result, error), indent=2, allow_nan=False) + "\n"
    if options.json == "-":
        sys.stdout.write(document)
    elif options.json is not None:
        writers.append((options.json, lambda path: _write_text(path, document)))
    if result is not None and len(result):
        reached = result
        writers.append((options.plot, lambda path: _plot(reached, path, case.title)))
        writers.append((options.output, lambda path: _store(reached, path, error)))
    for path, write in writers:
        if path is None:
            continue
        try:
            write(Path(path))
        except (OSError, InputError) as trouble:  # the other files are written all the same
            code = fail(f"can't write {path}: {trouble}", EXIT_FAILED)
    return code


def _paper(options: argparse.Namespace) -> int:
    from fastpin import paper

    nodes = paper.NODES if options.nodes is None else options.nodes
    try:
        names = list(dict.fromkeys(paper.known(name) for name in options.figure or paper.PAPER))
        paper.check(names, options.output, nodes)
    except InputError as error:
        option = f"--{error.field}" if error.field in vars(options) else error.field
        raise InputError(option, error.reason) from None
    finished: list[str] = []
    try:
        with bar(len(names), "figure {desc}") as shown:
            for name in names:
                began = time.perf_counter()
                shown.set_description_str(name, refresh=False)
                files = paper.make(
                    name, options.output, nodes, lambda part: shown.update(len(finished) + part - shown.n)
                )
                finished.append(name)
                seconds = time.perf_counter() - began
                shown.write(f"figure {name}: {files[0]}, {files[1]}, {seconds:.1f} s", file=sys.stdout)
    except KeyboardInterrupt:
        written = f"figures that are finished: {', '.join(finished)}" if finished else "no figure was finished"
        return fail(f"interrupted; {written}", EXIT_INTERRUPTED)
    return EXIT_OK


def _overridden(case: Case, options: argparse.Namespace) -> Case:
    """The case with the solver options of the command line."""
    given: dict[str, Any] = {}
    for name in ("nodes", "method", "increments"):
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


def _check_outputs(options: argparse.Namespace) -> None:
    """Find out before the work what could not be written after it."""
    targets = {"--json": options.json, "--plot": options.plot, "--output": options.output}
    chosen = {name: Path(path) for name, path in targets.items() if path is not None and path != "-"}
    seen: dict[Path, str] = {}
    for name, path in chosen.items():
        # "fastpin run --json case.toml" takes the case file for the output.
        if path.suffix == ".toml" or (options.case is not None and path.resolve() == options.case.resolve()):
            raise InputError(name, f"won't overwrite the case file {path}; write the case file before the options")
        if name == "--plot":
            check_figure(name, path)
        check_writable(path)
        other = seen.setdefault(path.resolve(), name)
        if other != name:
            raise InputError(name, f"writes the same file as {other}: {path}")


def _solve(case: Case) -> tuple[Result | None, SolveError | None]:
    from fastpin.solver import solve

    with bar(len(case.history), "load point {n:.2f} of {total}") as shown:

        def progress(done: float, total: int) -> None:
            shown.total = total
            shown.update(done - shown.n)

        try:
            return solve(case.problem, case.history, progress=progress, **case.options.keywords()), None
        except SolveError as error:
            return error.result, error


def _print_states(case: Case, result: Result | None) -> None:
    from fastpin.report import state_table

    if case.title:
        print(case.title)
    if result is None or not len(result):
        print("no state was reached")
        return
    print(state_table(case.problem, list(result)))
    strain = case.problem.pair.beta_star * max(state.peak_pressure for state in result)
    if strain > LARGE_STRAIN and not case.problem.dimensionless:
        print(f"note: contact strains of about {strain:.2g} are beyond linear elasticity; are all values in SI units?")
    statistics = result.statistics
    names = ("events", "exchanges", "rebuilds", "repeated", "increments", "seconds")
    known = [f"{statistics[name]:.4g} {name}" for name in names if statistics.get(name)]
    print(f"{result.method} solver, {result.grid.size} nodes{''.join(f', {part}' for part in known)}")


def _write_text(path: Path, text: str) -> None:
    with replacing(path) as temporary:
        temporary.write_text(text, encoding="utf-8")


def _plot(result: Result, path: Path, title: str) -> None:
    from fastpin.plot import plot_tractions

    plot_tractions(result, path, title=title)


def _store(result: Result, path: Path, error: str | None) -> None:
    from fastpin.store import save

    save(result, path, error=error)
