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

from fastpin.errors import printable
from fastpin.figures.kinds import DEFAULT_KEY_FIGURE, KIND_OPTIONS, KINDS, STATES_HELP
from fastpin.model.synonyms import closest, meant
from fastpin.version import __version__

EXIT_CODES = (
    "Exit codes: 0 for success; 1 if loads could not be followed to their end, a run or a check failed, or a file "
    "could not be written; 2 for wrong input; 3 if a quantity could not be read from the states; 130 after Ctrl-C."
)

BUILT_IN = "case file (TOML); without one: the built-in case"
"""Help of a case that may be left out."""

SHELLS = ("bash", "zsh", "fish", "tcsh")
"""Shells with a script of completion."""

SCHEMAS = (
    "run", "converge", "verify", "benchmarks", "compliance", "wear", "tolerances", "crack", "charts", "identify"
, "joint")  # fmt: skip
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
    for add in (
        add_case_commands, add_run, add_stored_commands, add_wear, add_plot, add_crack, add_report, add_live,
        add_converge, add_sweep, add_tolerances, add_identify, add_compliance, add_joint, add_paper, add_benchmarks,
        add_charts, add_verify,
        add_schema, add_completion,
    ):  # fmt: skip
        add(commands)
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


def _option(
    command: argparse.ArgumentParser,
    flags: str,
    metavar: str | tuple[str, ...] | None,
    words: str,
    kind: Any = None,
    **more: Any,
) -> None:
    """Add an option with a value, or an argument: flags with spaces between, the value's name, help and kind."""
    command.add_argument(*flags.split(), metavar=metavar, help=words, type=kind, **more)


def _switch(command: argparse.ArgumentParser, flag: str, words: str, **more: Any) -> None:
    """Add an option without a value."""
    command.add_argument(flag, action="store_true", help=words, **more)


def add_case_commands(commands: Any) -> None:
    """Add ``example`` and ``check``."""
    _command(commands, "example", "texts", "example", "print a commented case file")
    check = _command(commands, "check", "texts", "check", "explain a case file, or list all its faults")
    _option(check, "case", None, "case file (TOML)", Path)


def add_run(commands: Any) -> None:
    """Add ``run``."""
    run = _command(commands, "run", "run", "run", "solve a case and print its states")
    _option(run, "case", None, BUILT_IN, Path, nargs="?")
    _add_outputs(run)
    _option(run, "-o --output", "FILE", "write each kept state to an HDF5 file as soon as it is solved", Path)
    _switch(run, "--overwrite", "with -o: replace a file that exists")
    _add_solver_options(run)
    _option(run, "--start", "FILE", "continue from the end of this result, with new loads", Path)
    _option(run, "--after", "N", "with --start: continue from corner N of that result, not from its end", literal)
    words = "with -o: corners at which a restart is stored; a later run starts there without delay"
    _option(run, "--save-after", "N,N", words)


def add_stored_commands(commands: Any) -> None:
    """Add ``resume`` and ``show``."""
    resume = _command(commands, "resume", "run", "resume", "continue a run that ended early")
    _option(resume, "output", "FILE", "HDF5 file of the run (run -o FILE)", Path)
    _add_outputs(resume)
    show = _command(commands, "show", "run", "show", "print and draw a stored result")
    _option(show, "output", "FILE", "HDF5 file (run, joint or wear -o FILE); the run may still be going", Path)
    _add_interface(show)
    _add_outputs(show)
    _add_of_joint(show, "of a joint: ")


def add_wear(commands: Any) -> None:
    """Add ``wear``."""
    words = "follow a load cycle many times on a profile that wears (without debris)"
    wear = _command(commands, "wear", "wear", "run", words)
    _option(wear, "case", None, "case file or joint file (TOML), with the section [wear], or with --coefficient", Path)
    _option(wear, "--cycles", "N", "number of cycles, such as 1e5", literal)
    words = "wear coefficient of both bodies together, 1/Pa, or in the units of the case"
    _option(wear, "--coefficient", "K", words, literal)
    _option(wear, "--law", "LAW", "archard: per pressure and slip; energy: per friction energy")
    _option(wear, "--at", "N,N", "cycles after which profile and states are stored")
    words = "largest error of the worn gap by cycles that stand for many (default 0.01); 0 solves every cycle"
    _option(wear, "--tolerance", "T", words, literal)
    _option(wear, "--nodes", "N", "number of nodes, 5 to 20000", literal)
    _option(wear, "-o --output", "FILE", "write the result to an HDF5 file, as it grows", Path)
    _switch(wear, "--overwrite", "with -o: replace a file that exists")
    _switch(wear, "--resume", "with -o: continue the file of a life that ended early")
    _add_json(wear, "write the chosen cycles as JSON")
    _option(wear, "--record", "FILE", "write a page (html) with a slider of the cycles", Path)
    wear.add_argument("-v", "--verbose", action="count", default=0, help="log each grid; -vv: more")


def add_plot(commands: Any) -> None:
    """Add ``plot``."""
    plot = _command(commands, "plot", "plot", "run", "draw a stored result: stresses, slip, loops, fatigue, wear")
    words = "HDF5 file (run, wear or joint -o FILE); for sketch and gap also a case file (TOML)"
    _option(plot, "result", "FILE", words, Path)
    words = "; ".join(f"{name}: {kind.words}" if kind.words else name for name, kind in KINDS.items())
    defaults = "default: tractions; scar of a life of wear, holes of a joint, sketch of a case file"
    plot.add_argument("kind", nargs="?", choices=tuple(KINDS), help=f"{words} ({defaults})")
    words = "the figure (png, pdf or svg; default KIND.png)"
    _option(plot, "-o --output", "FIGURE", words, Path)
    _option(plot, "--csv", "FILE", "also write the numbers of the figure", Path)
    _add_interface(plot)
    _add_hole(plot)
    words = "of a life of wear: show one cycle on the profile after N cycles (default: the last one stored)"
    _option(plot, "--after", "N", words, literal)
    for name, option in KIND_OPTIONS.items():
        if option.type == "flag":
            plot.add_argument(f"--{name}", action="store_const", const=True, help=option.words)
        else:
            _option(plot, f"--{name}", option.metavar, option.words, literal if option.type == "number" else str)


_LAW_WORDS = {
    "C": "growth in a cycle under the range --unit, m",
    "m": "exponent of Paris and Walker: da/dN = C (dK (1 - R)^(g - 1))^m",
    "n": "exponent of NASGRO",
    "p": "NASGRO's exponent near the threshold",
    "q": "NASGRO's exponent near the toughness",
    "exponent": "Walker's g (default 1: Paris's law)",
    "threshold_range": "threshold of long cracks at R = 0, Pa sqrt(m) (default 0)",
    "threshold_exponent": "Walker: exponent of 1 - R in the threshold (default 1 - g)",
    "threshold_slope": "NASGRO's C_th for R >= 0 (default 0)",
    "compressive_slope": "NASGRO's C_th for R < 0 (default 0)",
    "constraint": "NASGRO's alpha, 1 to 3 (default 2)",
    "stress_level": "NASGRO's largest stress over the flow stress (default 0.3)",
    "intrinsic_length": "El Haddad's length of the threshold of short cracks, m (default 0)",
    "toughness": "K at which the plate breaks, Pa sqrt(m)",
    "unit": "range that C belongs to, Pa sqrt(m) (default 1e6; 1 in a system of units)",
}
"""Help of the constants of the laws of growth."""


def add_crack(commands: Any) -> None:
    """Add ``crack``."""
    words = "grow a crack from the hole under the loads of a result; numbers are in the units of its case"
    crack = _command(commands, "crack", "crack", "run", words)
    _option(crack, "result", "FILE", "HDF5 file (run -o FILE)", Path)
    whose = "default: [crack] of the case"
    for name, words in (
        ("first", f"first length of the crack, m ({whose})"),
        ("last", f"last length, m ({whose})"),
        ("at", "angle of its mouth from the bottom, deg (default: [crack], else where a crack grows fastest)"),
        ("angle", "its direction from the radius, counter-clockwise, deg (default: [crack], else 0)"),
    ):
        _option(crack, f"--{name}", "X", words, literal)
    _option(crack, "--place", ("X", "Y"), "in place of --at: its mouth on an edge of an outline, m", literal, nargs=2)
    crack.add_argument("--body", choices=("plate", "seat"), help="seat: the plate round a bush (default: plate)")
    _option(crack, "--case", "CASE", "case file whose [crack] replaces that of the result", Path)
    _switch(crack, "--spectrum", "count the cycles of the whole history")
    laws = "law of the constants below (default walker; without constants: [crack], else the material)"
    crack.add_argument("--law", choices=("paris", "walker", "nasgro"), help=laws)
    for name, words in _LAW_WORDS.items():
        _option(crack, f"--{name.replace('_', '-')}", "X", words, literal)
    _option(crack, "-o --output", "FIGURE", "draw the growth (png, pdf, svg)", Path)
    _option(crack, "--csv", "FILE", "write the numbers at all lengths", Path)
    _add_json(crack, "write the growth and its margins as JSON")


def _add_interface(command: argparse.ArgumentParser) -> None:
    """Add the option that chooses one of the interfaces of a joint."""
    words = "of a joint whose bush slips: the contact of the pin (default), or that of the bush in its seat"
    command.add_argument("--interface", choices=("pin", "seat"), default="pin", help=words)


def _add_hole(command: argparse.ArgumentParser) -> None:
    """Add the options that choose a pin in a plate of a joint."""
    _option(command, "--pin", "NAME", "of a joint of several pins: show the contact of this pin")
    _option(command, "--plate", "NAME", "of a joint: in this plate, or slice (default: the first of the pin)")


ABOUT = {
    "project": "project on the first page and in the head of each page",
    "author": "author, likewise",
    "revision": "revision of the report, likewise",
    "date": "date of the revision, likewise",
}


def add_report(commands: Any) -> None:
    """Add ``report``."""
    report = _command(commands, "report", "report", "run", "write a page or a PDF on a result, a case or a sweep")
    words = "HDF5 file (run, wear or joint -o FILE); case or joint file (TOML), which is solved first; or directory of "
    words += "a sweep"
    _option(report, "source", "FILE_OR_DIR", words, Path)
    _option(report, "-o --output", "PAGE", "the report (html, pdf; default: the name with .html)", Path)
    _option(report, "--title", None, "title of the page of a result (default: the title of the case)")
    for name, words in ABOUT.items():
        _option(report, f"--{name}", "TEXT", f"{words} (default: that of the case)")
    _option(report, "--case", "FILE", "case file of an HDF5 file; the page shows its text", Path)
    _option(report, "--plan", "FILE", "plan of a sweep (default: the copy in its directory)", Path)
    _add_hole(report)
    words = "with a case file: solve a second time on a grid with half the intervals, for error bars"
    _switch(report, "--error-bars", words, default=None)


def add_live(commands: Any) -> None:
    """Add ``live``."""
    live = _command(commands, "live", "live", "run", "open a page in the browser: drag the load with the mouse")
    _option(live, "case", None, BUILT_IN, Path, nargs="?")
    _option(
        live, "--nodes", "N", "number of nodes round a hole: 5 to 1600 (default 200), of a joint 16 to 720 (default 64)"
    )
    _option(live, "--port", "N", "port of the page (default: a free one)", default="0")
    words = "print the address, and open no browser"
    live.add_argument("--no-browser", dest="browser", action="store_false", help=words)


def add_converge(commands: Any) -> None:
    """Add ``converge``."""
    words = "solve a case on several grids: orders, limits, error bars"
    converge = _command(commands, "converge", "converge", "run", words)
    _option(converge, "case", None, BUILT_IN, Path, nargs="?")
    nodes = "101,201,401,801"
    _option(converge, "--nodes", "N,N,N", f"numbers of nodes (default {nodes})", default=nodes)
    words = "also run the increment solver, with these numbers of increments a step"
    _option(converge, "--increments", "N,N,N", words)
    words = "number of nodes for the increment solver (default: the first of --nodes from 201 on, or else the last)"
    _option(converge, "--increment-nodes", "N", words, literal)
    words = "corner to study (default: all corners if there are at most six, otherwise the last)"
    _option(converge, "--corner", "K", words, literal)
    _add_outcomes(converge)
    _option(converge, "--csv", "FILE", "write all values, orders, limits and error bars", Path)
    _add_json(converge, "write the study as JSON")
    _option(converge, "--plot", "FILE", "write a figure of the last corner (png, pdf, svg)", Path)


def add_sweep(commands: Any) -> None:
    """Add ``sweep`` and ``merge``."""
    sweep = _command(commands, "sweep", "sweep", "run", "solve all runs of a plan that are not finished")
    _option(sweep, "plan", None, "plan (TOML): a case, and the fields that are varied", Path)
    _add_runs(sweep)
    _option(sweep, "--shard", "I/N", "solve only the I-th of N parts; each part needs a directory of its own")
    _add_outcomes(sweep)
    words = "print the table of fields and outcomes, or write it to FILE as CSV with all key figures"
    _option(sweep, "--table", "FILE", words, nargs="?", const="-")
    _option(sweep, "--plot", "FILE", "map or curves of one value (png, pdf or svg)", Path)
    usual = f"default: the first outcome, or {DEFAULT_KEY_FIGURE}"
    _option(sweep, "--value", "NAME", f"outcome or key figure to plot, or several: a,b,c ({usual})")
    _option(sweep, "--x", "FIELD", "field along the figure's x axis")
    _option(sweep, "--y", "FIELD", "field along the figure's y axis (for a map)")
    words = "fix a field of the figure, such as contact.friction=0.3; may be given several times"
    _option(sweep, "--where", "FIELD=VALUE", words, action="append")
    words = "plot bearing over bypass stress at failure; the value is an outcome strength = factor"
    _switch(sweep, "--envelope", words, default=None)

    merge = _command(commands, "merge", "sweep", "merge", "join the directories of the parts of a sweep")
    _option(merge, "parts", "DIR", "directories of the parts", Path, nargs="+")
    _option(merge, "-o --output", "DIR", "directory of the whole", Path, required=True)


def _add_runs(command: argparse.ArgumentParser) -> None:
    """Add the options of the runs of a plan."""
    _option(command, "-o --output", "DIR", "directory of index and results (default: the plan's name)", Path)
    _switch(command, "--status", "report the progress; solve nothing")
    _switch(command, "--retry", "also solve failed runs again")
    _switch(command, "--files", "also write each result to an HDF5 file of its own")
    _option(command, "--workers", "N", "worker processes (default: one for each processor)", literal)
    _option(command, "--dask", "ADDRESS", "use the workers of a dask scheduler")


def add_tolerances(commands: Any) -> None:
    """Add ``tolerances``."""
    words = "run a case at the limits of its fields: one at a time, at all corners, and at random samples"
    tolerances = _command(commands, "tolerances", "sweep", "tolerances", words)
    _option(tolerances, "plan", None, "plan (TOML): a case, and the limits of its fields [tolerances]", Path)
    _add_runs(tolerances)
    _add_outcomes(tolerances)
    _option(tolerances, "--table", "FILE", "write all runs to FILE as CSV", Path)
    _option(tolerances, "--plot", "FILE", "tornado of the fields (png, pdf or svg)", Path)
    _option(tolerances, "--scatter", "FILE", "samples over the fields (png, pdf or svg)", Path)
    _option(tolerances, "--value", "NAME", "outcomes of the figures: a,b (default: the first ones)")
    _add_json(tolerances, "write the effects as JSON")


def add_identify(commands: Any) -> None:
    """Add ``identify``."""
    words = "fit friction, rig stiffness and offsets to a measured loop of displacement and force"
    identify = _command(commands, "identify", "identify", "run", words)
    _option(identify, "case", None, "case file (TOML) of the joint, with the loads that are constant", Path)
    _option(identify, "loop", "CSV", "the samples, equally spaced in time", Path)
    _option(identify, "--over", "LOAD", "measured displacement: ux, uy or rotation (default: drive)")
    whose = "default: that of its name, or the only one with such a unit"
    _option(identify, "--displacement", "COLUMN", f"its column of the file ({whose})")
    _option(identify, "--force", "COLUMN", f"column of the force or moment ({whose})")
    words = "factor of this column; -1 turns its sign"
    _option(identify, "--force-factor", "X", words, literal, default=1.0)
    words = "fitted beside friction and offsets: stiffness (of the rig), clearance, drift, scale (of the force); "
    words += 'default stiffness; "" for none'
    _option(identify, "--fit", "A,B", words, default="stiffness")
    _switch(identify, "--by-cycle", "a friction of its own for each cycle")
    words = "rest: the record begins at no displacement (default); cycle: it begins in a steady cycle"
    _option(identify, "--start", "WHERE", words, default="rest")
    _option(identify, "--nodes", "N", "nodes of the first fit (default 41)", literal, default=41)
    _option(identify, "--csv", "FILE", "write the measured and the computed loop", Path)
    _option(identify, "--plot", "FILE", "draw both loops and the energies (png, pdf, svg)", Path)
    _add_json(identify, "write what the loop tells as JSON")


def add_compliance(commands: Any) -> None:
    """Add ``compliance``."""
    words = "make the compliance file of a finite plate with a hole"
    compliance = _command(commands, "compliance", "compliance", "run", words)
    _option(compliance, "lug", None, "lug file (TOML): outline, supports and loads", Path, nargs="?")
    _switch(compliance, "--example", "print a commented lug file")
    _option(compliance, "-o --output", "FILE", "the compliance file (default: the lug's name with .json)", Path)
    _option(compliance, "--plot", "FILE", "draw outline, supports and loads (png, pdf, svg)", Path)


def add_joint(commands: Any) -> None:
    """Add ``joint``."""
    joint = _command(commands, "joint", "joint", "run", "solve a joint of several pins and plates")
    _option(joint, "file", None, "joint file (TOML): plates, pins and loads", Path, nargs="?")
    _switch(joint, "--example", "print a commented joint file")
    _option(joint, "--nodes", "N", "nodes of each contact (default: those of the file)", literal)
    _option(joint, "-o --output", "FILE", "write each state to an HDF5 file as soon as it is solved", Path)
    _switch(joint, "--overwrite", "with -o: replace a file that exists")
    _option(joint, "--resume", "FILE", "go on with the HDF5 file of a joint that ended early", Path)
    _option(joint, "--plot", "FILE", "draw all holes at a load point (png, pdf, svg)", Path)
    _add_of_joint(joint)
    _option(joint, "--record", "FILE", "write a page (html) that replays the states", Path)
    _add_json(joint, "write all states as JSON")


def _add_of_joint(command: argparse.ArgumentParser, whose: str = "") -> None:
    """Add the options of figures of a joint."""
    _option(command, "--at", "N", f"{whose}load point in --plot (default: the last)", literal)
    _option(command, "--shares", "FILE", f"{whose}draw the force of each pin at all load points", Path)


def add_paper(commands: Any) -> None:
    """Add ``paper``."""
    paper = _command(commands, "paper", "published", "paper", "compute and draw the figures of the paper")
    words = "a figure's number, 3 to 17, or half-plane (repeat the option for several figures; default: 3 to 17)"
    _option(paper, "--figure", "NAME", words, action="append")
    paper.add_argument("--nodes", type=literal, help="number of nodes (default 400)")
    words = "png, pdf or svg (repeat the option for several formats; default: png)"
    _option(paper, "--format", "FORMAT", words, action="append")
    _option(paper, "-o --output", "DIR", "directory of the files (default: this one)", Path, default=Path())


def add_benchmarks(commands: Any) -> None:
    """Add ``benchmarks``."""
    benchmarks = _command(commands, "benchmarks", "published", "run", "compare with problems that others publish")
    _option(benchmarks, "names", "NAME", "names of benchmarks, see --list; without one: all of them", nargs="*")
    _switch(benchmarks, "--list", "print the names and titles of the benchmarks")
    _option(benchmarks, "-o --output", "DIR", "also write the numbers as CSV to this directory", Path)
    _add_json(benchmarks, "write the numbers as JSON")


def add_charts(commands: Any) -> None:
    """Add ``charts``."""
    charts = _command(commands, "charts", "charts", "run", "look up pressures, angles and Kt in tables, with errors")
    _option(charts, "chart", "CHART", "a chart; without one: list them with their bounds", nargs="?")
    numbers = {
        "load_parameter": "L_p = (R - R_D)/(P beta*)",
        "friction": "coefficient of friction",
        "alpha": "first parameter of Dundurs, in the usual sign (default 0)",
        "beta": "second parameter of Dundurs (default 0)",
        "kolosov": "Kolosov's constant of the pin: 3 - 4 nu or, in plane stress, (3 - nu)/(1 + nu) (default 1.8)",
        "load_ratio": "Q/P: amplitude of the cycle (cycles only)",
    }
    for name, words in numbers.items():
        _option(charts, f"--{name.replace('_', '-')}", "X", words, literal)
    _option(charts, "--pin-load", "LOAD", "body or centre (default centre)")
    _option(charts, "--rotation", "HOW", "free or fixed (default free; cycles only)")
    _switch(charts, "--formulas", "print formulas for a spreadsheet, with their errors")
    _option(charts, "--csv", "FILE", "write the nodes of the chart", Path)
    _add_json(charts, "write the charts, or a value with its error, as JSON")


def add_verify(commands: Any) -> None:
    """Add ``verify``."""
    words = "check this installation against closed forms and finite elements"
    _add_json(_command(commands, "verify", "verify", "run", words), "write the checks as JSON")


def _add_outputs(command: argparse.ArgumentParser) -> None:
    """Add the options of all commands that print states."""
    _add_json(command, "write a summary as JSON")
    words = "write a figure of the tractions (png, pdf or svg; default tractions.png)"
    _option(command, "--plot", "FILE", words, Path, nargs="?", const=Path("tractions.png"))
    _option(command, "--states", "WHICH", f"states in --plot: {STATES_HELP}")
    _option(command, "--cycles", "FILE", "write a figure of the changes in each cycle", Path)
    words = "write a page (html) that replays the states; --between adds states"
    _option(command, "--record", "FILE", words, Path)
    _option(command, "--cycle-csv", "FILE", "write slip, tractions and friction energy in the last cycle", Path)
    command.add_argument("-v", "--verbose", action="count", default=0, help="log each step; -vv: more")


def _add_solver_options(run: argparse.ArgumentParser) -> None:
    """Add the options of the solver."""
    words = 'states to keep: all, corners, cycles (end of each cycle) or "every N" corners (default all)'
    _option(run, "--keep", "WHICH", words)
    _option(run, "--nodes", "N", "number of nodes, 5 to 20000")
    _option(run, "--method", None, "path or increment")
    _option(run, "--increments", "N", "increments a step (only with --method increment)")
    words = "first and last angle of the nodes, rad, such as -3.0,-0.2; the bottom is -1.5708"
    _option(run, "--arc", "A,B", words)
    words = "states inside every step: a number, or fractions of the step such as 0.25,0.5"
    _option(run, "--between", "N", words)
    words = "also solve cycles whose result is known; slower, same result"
    run.add_argument("--no-shortcut", dest="shortcut", action="store_false", default=None, help=words)
    yes_or_no: Any = {"action": argparse.BooleanOptionalAction, "default": None}
    words = "solve a second time on a grid with half the intervals, for error bars (not with both -o and --start)"
    run.add_argument("--error-bars", help=words, **yes_or_no)
    words = "count slip distance, friction energy and exact slip range of each node, also in the last cycle"
    run.add_argument("--slip-sums", help=words, **yes_or_no)


def _add_outcomes(command: argparse.ArgumentParser) -> None:
    """Add ``--outcomes FILE``."""
    words = "also read these numbers from each result: the functions of a Python file, or [outcomes] of a TOML file"
    _option(command, "--outcomes", "FILE", words, Path)


def _add_json(command: argparse.ArgumentParser, text: str) -> None:
    """Add ``--json [FILE]``."""
    _option(command, "--json", "FILE", f"{text}; without FILE, or with -: print it, and no table", nargs="?", const="-")


def add_schema(commands: Any) -> None:
    """Add ``schema``."""
    schema = _command(commands, "schema", "texts", "schema", "print the JSON schema of a document that commands write")
    words = "the command; resume and show write what run writes"
    _option(schema, "written_by", "COMMAND", words, choices=SCHEMAS)


def add_completion(commands: Any) -> None:
    """Add ``completion``."""
    words = "print a script that completes words in a shell"
    completion = _command(commands, "completion", "texts", "completion", words)
    completion.add_argument("shell", choices=SHELLS, help="the shell")
