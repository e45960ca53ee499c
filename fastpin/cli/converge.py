"""The command ``fastpin converge``."""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fastpin.errors import InputError
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
    from fastpin.convergence import Convergence


def add(commands: Any) -> None:
    """Add the command to the parser's."""
    converge = commands.add_parser(
        "converge", help="solve a case on several grids: orders, limits, error bars", allow_abbrev=False
    )
    converge.add_argument("case", type=Path, nargs="?", help="case file (TOML); without one: the built-in case")
    converge.add_argument(
        "--nodes", metavar="N,N,N", default="101,201,401,801", help="numbers of nodes (default 101,201,401,801)"
    )
    converge.add_argument(
        "--increments", metavar="N,N,N", help="also run the increment solver, with so many increments a step"
    )
    converge.add_argument(
        "--increment-nodes", metavar="N", type=int, help="its number of nodes (default: the first of 201 or more)"
    )
    converge.add_argument(
        "--corner", metavar="K", type=int, help="corner to study (default: all of up to six, else the last one)"
    )
    converge.add_argument("--csv", metavar="FILE", type=Path, help="write all values, orders, limits and error bars")
    converge.add_argument(
        "--json", metavar="FILE", nargs="?", const="-", help="the same as JSON; without FILE to standard output instead"
    )
    converge.add_argument("--plot", metavar="FILE", type=Path, help="write a figure of the last corner (png, pdf, svg)")
    converge.set_defaults(command=run)


def run(options: argparse.Namespace) -> int:
    """Solve a case on several grids."""
    nodes = _numbers("--nodes", options.nodes)
    increments = [] if options.increments is None else _numbers("--increments", options.increments)

    from fastpin.casefile import builtin_case, read_case

    case = builtin_case() if options.case is None else read_case(options.case)
    outputs = {"--csv": options.csv, "--json": options.json, "--plot": options.plot}
    check_outputs(outputs, options.case)

    from fastpin.convergence import StudyInterrupted, StudyLostError, converge

    code, trouble = EXIT_OK, ""
    with bar(1, "{desc}") as shown:

        def progress(done: float, total: float, what: str) -> None:
            shown.set_description_str(what, refresh=False)
            shown.total = total
            shown.update(done - shown.n)

        try:
            study: Convergence | None = converge(
                case.problem, case.history, nodes, increments, options.increment_nodes, options.corner,
                case.options.arc, progress,
            )  # fmt: skip
        except StudyInterrupted as ended:
            study, code, trouble = ended.study, EXIT_INTERRUPTED, "interrupted"
        except StudyLostError as lost:
            study, code, trouble = lost.study, EXIT_FAILED, str(lost)
        except InputError as error:
            option = error.field.replace("_", "-")
            known = option in ("nodes", "increments", "increment-nodes", "corner")
            raise InputError(f"--{option}" if known else error.field, error.reason) from None
    if study is None:
        return fail(f"{trouble}; less than three grids were finished", code)
    return _hand_out(study, options, case.title) or (code and fail(f"{trouble}; {_kept(study)}", code))


def _kept(study: Convergence) -> str:
    corners = ", ".join(map(str, study.loads))
    return f"kept: corner {corners} with {', '.join(map(str, study.studies[0].counts))} nodes" + (
        "" if len(study.studies) == 1 else f" and {', '.join(map(str, study.studies[1].counts))} increments"
    )


def _numbers(option: str, text: str) -> list[int]:
    try:
        return [int(part) for part in text.split(",")]
    except ValueError:
        raise InputError(option, f"must be whole numbers with commas, such as 101,201,401, not {text!r}") from None


def _hand_out(study: Convergence, options: argparse.Namespace, title: str) -> int:
    """Write the files that were asked for and print the tables, which a reader of our output may leave."""
    from fastpin import convergetable

    document = json.dumps(convergetable.document(study, title), indent=2, allow_nan=False) + "\n"

    def plot(path: Path) -> None:
        from fastpin.convergeplot import plot_convergence

        plot_convergence(study, path, title=title)

    code = write_files(
        [
            (options.csv, lambda path: convergetable.write_csv(study, path)),
            (None if options.json == "-" else options.json, lambda path: write_text(path, document)),
            (options.plot, plot),
        ]
    )
    if options.json == "-":
        sys.stdout.write(document)
    else:
        print("\n".join([title, ""] if title else []) + convergetable.text(study))
    return code
