"""All commands and their options. Nothing heavy is imported here: help is answered at once.

Each command names a file of this folder, and the function of that file that carries it out.
"""

from __future__ import annotations

import argparse
import contextlib
import functools
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NoReturn

from fastpin.cli.chart_options import add_chart_options
from fastpin.cli.crack_options import add_crack_options
from fastpin.cli.loop_options import add_loop_options
from fastpin.errors import printable
from fastpin.figures.kinds import DEFAULT_KEY_FIGURE, KIND_OPTIONS, KINDS, STATES_HELP
from fastpin.model.synonyms import closest, meant
from fastpin.version import __version__

EXIT_CODES = (
    "Exit codes: 0 for success; 1 if loads could not be followed to their end, a run or a check failed, or a file "
    "could not be written; 2 for wrong input; 3 if a quantity could not be read from the states; 130 after Ctrl-C."
)

SHELLS = ("bash", "zsh", "fish", "tcsh")
"""Shells with a script of completion."""

SCHEMAS = (
    "run", "converge", "verify", "benchmarks", "compliance", "wear", "tolerances", "crack", "charts", "identify"
)  # fmt: skip
"""Commands whose JSON has a schema of its own. The JSON of resume and show is that of run."""


class Parser(argparse.ArgumentParser):
    """A parser that names the meant word if a word is not allowed."""

    def error(self, message: str) -> NoReturn:
        """Print the usage and a message, and end the program."""
        found = re.fullmatch(r"argument (.+): invalid choice: '(.*)' \(choose from (.*)\)", message)
        if found:
            words = re.findall(r"[\w.-]+", found[3])
            allowed = f"{', '.join(words[:-1])} or {words[-1]}"
            message = f'{found[1]}: must be {allowed}, not "{found[2]}"{closest(found[2], words)}'
        super().error(printable(message))  # it may repeat the name of a file


def parser() -> argparse.ArgumentParser:
    """Return the parser of the command line. ``command`` of its result is a pair of names: (file, function)."""
    return _parsers()[0]


@functools.cache
def _parsers() -> tuple[argparse.ArgumentParser, Mapping[str, argparse.ArgumentParser]]:
    """The parser of the command line, and the parsers of the commands by name."""
    root = Parser(
        prog="fastpin",
        description="Frictional contact of an elastic pin in the hole of an elastic plate.",
        epilog=f"Start with: fastpin example > case.toml; fastpin run case.toml. {EXIT_CODES}",
        allow_abbrev=False,
    )
    root.add_argument("--version", action="version", version=f"fastpin {__version__}")
    commands = root.add_subparsers(title="commands", required=True, metavar="COMMAND")
    add_case_commands(commands)
    add_run(commands)
    add_stored_commands(commands)
    add_wear(commands)
    add_plot(commands)
    add_crack(commands)
    add_report(commands)
    add_live(commands)
    add_converge(commands)
    add_sweep(commands)
    add_tolerances(commands)
    add_identify(commands)
    add_compliance(commands)
    add_joint(commands)
    add_paper(commands)
    add_benchmarks(commands)
    add_charts(commands)
    add_verify(commands)
    add_schema(commands)
    add_completion(commands)
    return root, commands.choices


def read_options(arguments: list[str]) -> argparse.Namespace:
    """Read the command line. An unknown option ends the program with a hint at the option that is meant."""
    root, commands = _parsers()
    options, unknown = root.parse_known_args(join_words(arguments))
    if unknown:
        hints = (_option_hint(commands, arguments[0], word) for word in unknown if word.startswith("--"))
        root.error(f"unrecognized arguments: {' '.join(unknown)}{next(filter(None, hints), '')}")
    return options


def _option_hint(commands: Mapping[str, argparse.ArgumentParser], command: str, word: str) -> str:
    """A hint at the option of a command, or the key of a case file, that an unknown option means."""
    name = word.partition("=")[0].lstrip("-").replace("-", "_")
    usage = commands[command].format_usage() if command in commands else ""
    options = [option.replace("-", "_") for option in re.findall(r"--([a-z-]+)", usage)]
    keys = [] if (hint := closest(name, options)) else meant(name)
    if keys:
        return f"; {keys[0]} is a key of the case file"
    return re.sub(r'"(\w+)"', lambda found: f"--{found[1].replace('_', '-')}", hint)


def join_words(arguments: list[str]) -> list[str]:
    """Return the arguments with ``--keep every N`` and ``--arc -2.5,-0.6`` joined for argparse.

    They become ``--keep "every N"`` and ``--arc=-2.5,-0.6``. argparse takes a list that begins with a minus sign for an
    option.
    """
    joined: list[str] = []
    for word in arguments:
        if joined[-2:] == ["--keep", "every"]:
            joined[-1] = f"every {word}"
        elif joined[-1:] == ["--arc"] and re.match(r"-[\d.]", word):
            joined[-1] = f"--arc={word}"
        else:
            joined.append(word)
    return joined


def literal(text: str) -> int | float | str:
    """The number that a text stands for, or the text. The checks of the value come later, as for case files."""
    for kind in (int, float):
        with contextlib.suppress(ValueError):
            return kind(text)
    return text


def _command(commands: Any, name: str, file: str, function: str, text: str) -> argparse.ArgumentParser:
    """Add a command that `function` of `file` carries out. `text` is its help, and the first line of its own help."""
    command: argparse.ArgumentParser = commands.add_parser(
        name, help=text, description=f"{text[0].upper()}{text[1:]}.", allow_abbrev=False
    )
    command.set_defaults(command=(file, function))
    return command


def add_case_commands(commands: Any) -> None:
    """Add ``example`` and ``check``."""
    _command(commands, "example", "case", "example", "print a commented case file")
    check = _command(commands, "check", "case", "check", "explain a case file, or list all its faults")
    check.add_argument("case", type=Path, help="case file (TOML)")


def add_run(commands: Any) -> None:
    """Add ``run``."""
    run = _command(commands, "run", "run", "run", "solve a case and print its states")
    run.add_argument("case", type=Path, nargs="?", help="case file (TOML); without one: the built-in case")
    _add_outputs(run)
    words = "write each kept state to an HDF5 file as soon as it is solved"
    run.add_argument("-o", "--output", metavar="FILE", type=Path, help=words)
    run.add_argument("--overwrite", action="store_true", help="with -o: replace a file that exists")
    _add_solver_options(run)
    run.add_argument("--start", metavar="FILE", type=Path, help="continue from the end of this result, with new loads")
    run.add_argument(
        "--after",
        metavar="N",
        type=literal,
        help="with --start: continue from corner N of that result, not from its end",
    )
    run.add_argument(
        "--save-after",
        metavar="N,N",
        help="with -o: corners at which a restart is stored; a later run starts there without delay",
    )


def add_stored_commands(commands: Any) -> None:
    """Add ``resume`` and ``show``."""
    resume = _command(commands, "resume", "run", "resume", "continue a run that ended early")
    resume.add_argument("output", metavar="FILE", type=Path, help="HDF5 file of the run (run -o FILE)")
    _add_outputs(resume)
    show = _command(commands, "show", "run", "show", "print and draw a stored result")
    show.add_argument(
        "output", metavar="FILE", type=Path, help="HDF5 file (run or wear -o FILE); the run may still be going"
    )
    _add_interface(show)
    _add_outputs(show)


def add_wear(commands: Any) -> None:
    """Add ``wear``."""
    wear = _command(
        commands, "wear", "wear", "run", "follow a load cycle many times on a profile that wears (without debris)"
    )
    wear.add_argument("case", type=Path, help="case file (TOML), with the section [wear], or with --coefficient")
    wear.add_argument("--cycles", metavar="N", type=literal, help="number of cycles, such as 1e5")
    wear.add_argument("--coefficient", metavar="K", type=literal, help="wear coefficient of both bodies together, 1/Pa")
    wear.add_argument("--law", metavar="LAW", help="archard: per pressure and slip; energy: per friction energy")
    wear.add_argument("--at", metavar="N,N", help="cycles after which profile and states are stored")
    wear.add_argument(
        "--tolerance",
        metavar="T",
        type=literal,
        help="largest error of the worn gap by cycles that stand for many (default 0.01); 0 solves every cycle",
    )
    wear.add_argument("--nodes", metavar="N", type=literal, help="number of nodes, 5 to 20000")
    wear.add_argument("-o", "--output", metavar="FILE", type=Path, help="write the result to an HDF5 file, as it grows")
    wear.add_argument("--overwrite", action="store_true", help="with -o: replace a file that exists")
    wear.add_argument("--resume", action="store_true", help="with -o: continue the file of a life that ended early")
    _add_json(wear, "write the chosen cycles as JSON")
    wear.add_argument("--record", metavar="FILE", type=Path, help="write a page (html) with a slider of the cycles")
    wear.add_argument("-v", "--verbose", action="count", default=0, help="log each grid; -vv: more")


def add_plot(commands: Any) -> None:
    """Add ``plot``."""
    plot = _command(commands, "plot", "plot", "run", "draw a stored result: stresses, slip, loops, fatigue, wear")
    plot.add_argument(
        "result",
        metavar="FILE",
        type=Path,
        help="HDF5 file (run or wear -o FILE); for sketch and gap also a case file (TOML)",
    )
    words = "; ".join(f"{name}: {kind.words}" if kind.words else name for name, kind in KINDS.items())
    defaults = "default: tractions; scar of a life of wear, sketch of a case file"
    plot.add_argument("kind", nargs="?", choices=tuple(KINDS), help=f"{words} ({defaults})")
    plot.add_argument(
        "-o",
        "--output",
        metavar="FIGURE",
        type=Path,
        help="the figure (png, pdf or svg; default KIND.png), or the animation (gif, or mp4 by ffmpeg)",
    )
    plot.add_argument("--csv", metavar="FILE", type=Path, help="also write the numbers of the figure")
    _add_interface(plot)
    plot.add_argument(
        "--after",
        metavar="N",
        type=literal,
        help="of a life of wear: show one cycle on the profile after N cycles (default: the last one stored)",
    )
    for name, option in KIND_OPTIONS.items():
        if option.type == "flag":
            plot.add_argument(f"--{name}", action="store_const", const=True, help=option.words)
        else:
            read = literal if option.type == "number" else str
            plot.add_argument(f"--{name}", metavar=option.metavar, type=read, help=option.words)


def add_crack(commands: Any) -> None:
    """Add ``crack``."""
    crack = _command(commands, "crack", "crack", "run", "grow a crack from the hole under the loads of a result")
    add_crack_options(crack, literal)
    _add_json(crack, "write the growth and its margins as JSON")


def _add_interface(command: argparse.ArgumentParser) -> None:
    """Add the option that chooses one of the interfaces of a joint."""
    words = "of a joint whose bush slips: the contact of the pin (default), or that of the bush in its seat"
    command.add_argument("--interface", choices=("pin", "seat"), default="pin", help=words)


ABOUT = {
    "project": "project on the first page and in the head of each page",
    "author": "author, likewise",
    "revision": "revision of the report, likewise",
    "date": "date of the revision, likewise",
}


def add_report(commands: Any) -> None:
    """Add ``report``."""
    report = _command(commands, "report", "report", "run", "write a page or a PDF on a result, a case or a sweep")
    report.add_argument(
        "source",
        metavar="FILE_OR_DIR",
        type=Path,
        help="HDF5 file (run or wear -o FILE); case file (TOML), which is solved first; or directory of a sweep",
    )
    words = "the report (html, pdf; default: the name with .html)"
    report.add_argument("-o", "--output", metavar="PAGE", type=Path, help=words)
    report.add_argument("--title", help="title of the page of a result (default: the title of the case)")
    for name, words in ABOUT.items():
        report.add_argument(f"--{name}", metavar="TEXT", help=f"{words} (default: that of the case)")
    report.add_argument("--case", metavar="FILE", type=Path, help="case file of an HDF5 file; the page shows its text")
    report.add_argument(
        "--plan", metavar="FILE", type=Path, help="plan of a sweep (default: the copy in its directory)"
    )
    report.add_argument(
        "--error-bars",
        action="store_true",
        default=None,
        help="with a case file: solve a second time on a grid with half the intervals, for error bars",
    )


def add_live(commands: Any) -> None:
    """Add ``live``."""
    live = _command(commands, "live", "live", "run", "open a page in the browser: drag the load with the mouse")
    live.add_argument("case", type=Path, nargs="?", help="case file (TOML); without one: the built-in case")
    live.add_argument("--nodes", metavar="N", help="number of nodes round the hole, 5 to 1600 (default 200)")
    live.add_argument(
        "--host",
        metavar="ADDRESS",
        help="share the page with a class at this address of the machine, such as 192.168.1.20; "
        "everyone who reaches it and has the page's address can use the page (5 to 400 nodes, default 100)",
    )
    live.add_argument("--port", metavar="N", default="0", help="port of the page (default: a free one)")
    live.add_argument(
        "--no-browser", dest="browser", action="store_false", help="print the address, and open no browser"
    )


def add_converge(commands: Any) -> None:
    """Add ``converge``."""
    converge = _command(
        commands, "converge", "converge", "run", "solve a case on several grids: orders, limits, error bars"
    )
    converge.add_argument("case", type=Path, nargs="?", help="case file (TOML); without one: the built-in case")
    converge.add_argument(
        "--nodes", metavar="N,N,N", default="101,201,401,801", help="numbers of nodes (default 101,201,401,801)"
    )
    converge.add_argument(
        "--increments", metavar="N,N,N", help="also run the increment solver, with these numbers of increments a step"
    )
    converge.add_argument(
        "--increment-nodes",
        metavar="N",
        type=literal,
        help="number of nodes for the increment solver (default: the first of --nodes from 201 on, or else the last)",
    )
    converge.add_argument(
        "--corner",
        metavar="K",
        type=literal,
        help="corner to study (default: all corners if there are at most six, otherwise the last)",
    )
    _add_outcomes(converge)
    converge.add_argument("--csv", metavar="FILE", type=Path, help="write all values, orders, limits and error bars")
    _add_json(converge, "write the study as JSON")
    converge.add_argument("--plot", metavar="FILE", type=Path, help="write a figure of the last corner (png, pdf, svg)")


def add_sweep(commands: Any) -> None:
    """Add ``sweep`` and ``merge``."""
    sweep = _command(commands, "sweep", "sweep", "run", "solve all runs of a plan that are not finished")
    sweep.add_argument("plan", type=Path, help="plan (TOML): a case, and the fields that are varied")
    _add_runs(sweep)
    sweep.add_argument(
        "--shard", metavar="I/N", help="solve only the I-th of N parts; each part needs a directory of its own"
    )
    _add_outcomes(sweep)
    sweep.add_argument(
        "--table",
        metavar="FILE",
        nargs="?",
        const="-",
        help="print the table of fields and outcomes, or write it to FILE as CSV with all key figures",
    )
    sweep.add_argument("--plot", metavar="FILE", type=Path, help="map or curves of one value (png, pdf or svg)")
    sweep.add_argument(
        "--value",
        metavar="NAME",
        help=f"outcome or key figure to plot, or several: a,b,c (default: the first outcome, or {DEFAULT_KEY_FIGURE})",
    )
    sweep.add_argument("--x", metavar="FIELD", help="field along the figure's x axis")
    sweep.add_argument("--y", metavar="FIELD", help="field along the figure's y axis (for a map)")
    words = "fix a field of the figure, such as contact.friction=0.3; may be given several times"
    sweep.add_argument("--where", metavar="FIELD=VALUE", action="append", help=words)
    words = "plot bearing over bypass stress at failure; the value is an outcome strength = factor"
    sweep.add_argument("--envelope", action="store_true", default=None, help=words)

    merge = _command(commands, "merge", "sweep", "merge", "join the directories of the parts of a sweep")
    merge.add_argument("parts", metavar="DIR", type=Path, nargs="+", help="directories of the parts")
    merge.add_argument("-o", "--output", metavar="DIR", type=Path, required=True, help="directory of the whole")


def _add_runs(command: argparse.ArgumentParser) -> None:
    """Add the options of the runs of a plan."""
    command.add_argument(
        "-o", "--output", metavar="DIR", type=Path, help="directory of index and results (default: the plan's name)"
    )
    command.add_argument("--status", action="store_true", help="report the progress; solve nothing")
    command.add_argument("--retry", action="store_true", help="also solve failed runs again")
    command.add_argument("--files", action="store_true", help="also write each result to an HDF5 file of its own")
    command.add_argument(
        "--workers", metavar="N", type=literal, help="worker processes (default: one for each processor)"
    )
    command.add_argument("--dask", metavar="ADDRESS", help="use the workers of a dask scheduler")


def add_tolerances(commands: Any) -> None:
    """Add ``tolerances``."""
    words = "run a case at the limits of its fields: one at a time, at all corners, and at random samples"
    tolerances = _command(commands, "tolerances", "tolerances", "run", words)
    tolerances.add_argument("plan", type=Path, help="plan (TOML): a case, and the limits of its fields [tolerances]")
    _add_runs(tolerances)
    _add_outcomes(tolerances)
    tolerances.add_argument("--table", metavar="FILE", type=Path, help="write all runs to FILE as CSV")
    tolerances.add_argument("--plot", metavar="FILE", type=Path, help="tornado of the fields (png, pdf or svg)")
    tolerances.add_argument("--scatter", metavar="FILE", type=Path, help="samples over the fields (png, pdf or svg)")
    tolerances.add_argument("--value", metavar="NAME", help="outcomes of the figures: a,b (default: the first ones)")
    _add_json(tolerances, "write the effects as JSON")


def add_identify(commands: Any) -> None:
    """Add ``identify``."""
    words = "fit friction, rig stiffness and offsets to a measured loop of displacement and force"
    identify = _command(commands, "identify", "identify", "run", words)
    add_loop_options(identify, literal)
    _add_json(identify, "write what the loop tells as JSON")


def add_compliance(commands: Any) -> None:
    """Add ``compliance``."""
    compliance = _command(
        commands, "compliance", "compliance", "run", "make the compliance file of a finite plate with a hole"
    )
    compliance.add_argument("lug", type=Path, nargs="?", help="lug file (TOML): outline, supports and loads")
    compliance.add_argument("--example", action="store_true", help="print a commented lug file")
    compliance.add_argument(
        "-o", "--output", metavar="FILE", type=Path, help="the compliance file (default: the lug's name with .json)"
    )
    compliance.add_argument(
        "--plot", metavar="FILE", type=Path, help="draw outline, supports and loads (png, pdf, svg)"
    )


def add_joint(commands: Any) -> None:
    """Add ``joint``."""
    joint = _command(commands, "joint", "joint", "run", "solve a joint of several pins and plates")
    joint.add_argument("file", type=Path, nargs="?", help="joint file (TOML): plates, pins and loads")
    joint.add_argument("--example", action="store_true", help="print a commented joint file")
    joint.add_argument("--nodes", metavar="N", type=literal, help="nodes of each contact (default: those of the file)")
    joint.add_argument("--plot", metavar="FILE", type=Path, help="draw all holes at the last load point")
    joint.add_argument("--shares", metavar="FILE", type=Path, help="draw the force of each pin at all load points")
    _add_json(joint, "write all states as JSON")


def add_paper(commands: Any) -> None:
    """Add ``paper``."""
    paper = _command(commands, "paper", "paper", "run", "compute and draw the figures of the paper")
    paper.add_argument(
        "--figure",
        metavar="NAME",
        action="append",
        help="a figure's number, 3 to 17, or one of ten more: memory, sliding-onset, half-plane, rigid-pin, rings, "
        "supports, hollow-pins, rectangular-lug, interference, regimes "
        "(repeat the option for several figures; default: figures 3 to 17)",
    )
    paper.add_argument("--nodes", type=literal, help="number of nodes (default 400)")
    paper.add_argument(
        "--format",
        metavar="FORMAT",
        action="append",
        help="png, pdf or svg (repeat the option for several formats; default: png)",
    )
    paper.add_argument(
        "-o", "--output", metavar="DIR", type=Path, default=Path(), help="directory of the files (default: this one)"
    )


def add_benchmarks(commands: Any) -> None:
    """Add ``benchmarks``."""
    benchmarks = _command(commands, "benchmarks", "benchmarks", "run", "compare with problems that others publish")
    benchmarks.add_argument(
        "names", metavar="NAME", nargs="*", help="names of benchmarks, see --list; without one: all of them"
    )
    benchmarks.add_argument("--list", action="store_true", help="print the names and titles of the benchmarks")
    benchmarks.add_argument(
        "-o", "--output", metavar="DIR", type=Path, help="also write the numbers as CSV, and figures, to this directory"
    )
    benchmarks.add_argument(
        "--format",
        metavar="FORMAT",
        action="append",
        help="with -o: png, pdf or svg (repeat the option for several formats; default: png)",
    )
    _add_json(benchmarks, "write the numbers as JSON")


def add_charts(commands: Any) -> None:
    """Add ``charts``."""
    charts = _command(commands, "charts", "charts", "run", "look up pressures, angles and Kt in tables, with errors")
    add_chart_options(charts, literal)
    _add_json(charts, "write the charts, or a value with its error, as JSON")


def add_verify(commands: Any) -> None:
    """Add ``verify``."""
    verify = _command(
        commands, "verify", "verify", "run", "check this installation against closed forms and finite elements"
    )
    _add_json(verify, "write the checks as JSON")


def _add_outputs(command: argparse.ArgumentParser) -> None:
    """Add the options of all commands that print states."""
    _add_json(command, "write a summary as JSON")
    command.add_argument(
        "--plot",
        metavar="FILE",
        nargs="?",
        const=Path("tractions.png"),
        type=Path,
        help="write a figure of the tractions (png, pdf or svg; default tractions.png)",
    )
    command.add_argument("--states", metavar="WHICH", help=f"states in --plot: {STATES_HELP}")
    command.add_argument("--cycles", metavar="FILE", type=Path, help="write a figure of the changes in each cycle")
    command.add_argument(
        "--record", metavar="FILE", type=Path, help="write a page (html) that replays the states; --between adds states"
    )
    command.add_argument(
        "--cycle-csv", metavar="FILE", type=Path, help="write slip, tractions and friction energy in the last cycle"
    )
    command.add_argument("-v", "--verbose", action="count", default=0, help="log each step; -vv: more")


def _add_solver_options(run: argparse.ArgumentParser) -> None:
    """Add the options of the solver."""
    run.add_argument(
        "--keep",
        metavar="WHICH",
        help='states to keep: all, corners, cycles (end of each cycle) or "every N" corners (default all)',
    )
    run.add_argument("--nodes", metavar="N", help="number of nodes, 5 to 20000")
    run.add_argument("--method", help="path or increment")
    run.add_argument("--increments", metavar="N", help="increments a step (only with --method increment)")
    run.add_argument(
        "--arc", metavar="A,B", help="first and last angle of the nodes, rad, such as -3.0,-0.2; the bottom is -1.5708"
    )
    run.add_argument(
        "--between", metavar="N", help="states inside every step: a number, or fractions of the step such as 0.25,0.5"
    )
    run.add_argument(
        "--no-shortcut",
        dest="shortcut",
        action="store_false",
        default=None,
        help="also solve cycles whose result is known; slower, same result",
    )
    run.add_argument(
        "--error-bars",
        action=argparse.BooleanOptionalAction,
        default=None,
        help="solve a second time on a grid with half the intervals, for error bars (not with both -o and --start)",
    )
    run.add_argument(
        "--slip-sums",
        action=argparse.BooleanOptionalAction,
        default=None,
        help="count slip distance, friction energy and exact slip range of each node, also in the last cycle",
    )


def _add_outcomes(command: argparse.ArgumentParser) -> None:
    """Add ``--outcomes FILE``."""
    command.add_argument(
        "--outcomes",
        metavar="FILE",
        type=Path,
        help="also read these numbers from each result: the functions of a Python file, or [outcomes] of a TOML file",
    )


def _add_json(command: argparse.ArgumentParser, text: str) -> None:
    """Add ``--json [FILE]``."""
    command.add_argument(
        "--json",
        metavar="FILE",
        nargs="?",
        const="-",
        help=f"{text}; without FILE, or with -: print it, and no table",
    )


def add_schema(commands: Any) -> None:
    """Add ``schema``."""
    schema = _command(commands, "schema", "schema", "run", "print the JSON schema of a document that commands write")
    schema.add_argument(
        "written_by", metavar="COMMAND", choices=SCHEMAS, help="the command; resume and show write what run writes"
    )


def add_completion(commands: Any) -> None:
    """Add ``completion``."""
    completion = _command(commands, "completion", "completion", "run", "print a script that completes words in a shell")
    completion.add_argument("shell", choices=SHELLS, help="the shell")
