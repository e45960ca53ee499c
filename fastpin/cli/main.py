"""The command line: ``fastpin example``, ``check``, ``run``, ``resume``, ``show``, ``paper`` and others.

Everything else is imported when it is needed: help and wrong options are answered without NumPy, checks without
the solver.
"""

from __future__ import annotations

import argparse
import logging
import os
import signal
import sys
import threading
import time
from collections.abc import Sequence
from pathlib import Path

from fastpin import __version__, cli_converge, cli_sweep, cli_verify
from fastpin.errors import CaseFileError, FastpinError, InputError
from fastpin.terminal import EXIT_FAILED, EXIT_INPUT, EXIT_INTERRUPTED, EXIT_OK, EXIT_PIPE, bar, fail


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line.

    Returns
    -------
    int
        Exit code: 0; 1 when the loads could not be followed to their end, a check of the installation has failed or
        a file could not be written; 2 for input that can't be used; 130 when interrupted.
    """
    try:
        options = _parser().parse_args(_joined(sys.argv[1:] if arguments is None else list(arguments)))
        _log(getattr(options, "verbose", 0))
        if threading.current_thread() is threading.main_thread():
            signal.signal(signal.SIGTERM, signal.default_int_handler)  # batch systems ask in this way
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
        return fail("interrupted", EXIT_INTERRUPTED)
    except MemoryError:
        return fail("not enough memory: use fewer nodes or store fewer states", EXIT_FAILED)
    except BrokenPipeError:  # the reader of our output has gone (fastpin run | head)
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return EXIT_PIPE
    except OSError as error:
        return fail(str(error), EXIT_FAILED)


def _joined(arguments: list[str]) -> list[str]:
    """The arguments with ``--keep every N`` in one word, as ``--keep "every N"``."""
    for k in range(len(arguments) - 2):
        if arguments[k : k + 2] == ["--keep", "every"]:
            return [*arguments[: k + 1], f"every {arguments[k + 2]}", *arguments[k + 3 :]]
    return arguments


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
    _add_outputs(run)
    run.add_argument("-o", "--output", metavar="FILE", type=Path, help="write all states to an HDF5 file as they come")
    run.add_argument("--overwrite", action="store_true", help="with -o: replace a file that exists")
    run.add_argument(
        "--keep", metavar="WHICH", help="states to keep: all, corners, cycles or every N corners (default all)"
    )
    run.add_argument("--nodes", type=int, help="number of nodes")
    run.add_argument("--method", help="path or increment")
    run.add_argument("--increments", type=int, help="increments a corner (method increment)")
    run.add_argument(
        "--between",
        metavar="N",
        help="more states inside every step: how many, or fractions such as 0.25,0.5",
    )
    run.add_argument(
        "--no-shortcut", dest="shortcut", action="store_false", default=None, help="solve cycles that repeat again"
    )
    run.add_argument(
        "--error-bars", action="store_true", help="also solve on half as many intervals, for error bars (not with -o)"
    )
    run.add_argument("--start", metavar="FILE", type=Path, help="go on from the end of this result, with these loads")
    run.add_argument("--after", metavar="N", type=int, help="with --start: from its corner N instead")
    run.add_argument(
        "--save-after", metavar="N,N", help="with -o: corners from which other runs will start, to have them at hand"
    )
    run.set_defaults(command=_run)

    resume = commands.add_parser("resume", help="go on with a run that has ended early", allow_abbrev=False)
    resume.add_argument("output", metavar="FILE", type=Path, help="its HDF5 file (run -o FILE)")
    _add_outputs(resume)
    resume.set_defaults(command=_resume)

    show = commands.add_parser("show", help="print and draw a result that is in a file", allow_abbrev=False)
    show.add_argument("output", metavar="FILE", type=Path, help="HDF5 file (run -o FILE), also of a run that goes on")
    _add_outputs(show)
    show.set_defaults(command=_show)

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

    cli_converge.add(commands)
    cli_sweep.add(commands)
    cli_verify.add(commands)
    return parser


def _add_outputs(command: argparse.ArgumentParser) -> None:
    """Options of all commands that solve a case."""
    command.add_argument(
        "--json",
        metavar="FILE",
        nargs="?",
        const="-",
        help="write a summary as JSON; without FILE, or with -, to standard output instead of the table",
    )
    command.add_argument(
        "--plot",
        metavar="FILE",
        nargs="?",
        const=Path("tractions.png"),
        type=Path,
        help="write a figure of the tractions (png, pdf or svg; default tractions.png)",
    )
    command.add_argument("--cycles", metavar="FILE", type=Path, help="write a figure of what each cycle has changed")
    command.add_argument("-v", "--verbose", action="count", default=0, help="say what is being done; -vv: more")


def _log(verbose: int) -> None:
    """Send the package's messages to standard error: warnings only, unless asked for more."""
    handler = logging.StreamHandler()
    handler.setFormatter(logging.Formatter("fastpin: %(message)s"))
    logger = logging.getLogger("fastpin")
    logger.handlers = [handler]
    logger.setLevel((logging.WARNING, logging.INFO, logging.DEBUG)[min(verbose, 2)])


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
    from fastpin import cli_run

    return cli_run.run(options)


def _resume(options: argparse.Namespace) -> int:
    from fastpin import cli_run

    return cli_run.resume(options)


def _show(options: argparse.Namespace) -> int:
    from fastpin import cli_run

    return cli_run.show(options)


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
