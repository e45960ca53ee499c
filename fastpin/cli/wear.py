"""``fastpin wear``: a load cycle many times, on a profile that wears."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

from fastpin import assess, casefile, live, solver, storage
from fastpin.cli import terminal
from fastpin.cli.options import literal
from fastpin.cli.progress import Bar, progress_to
from fastpin.errors import InputError
from fastpin.model.case import Case
from fastpin.model.keys import CASE
from fastpin.model.units import from_units
from fastpin.report.states import way_on
from fastpin.wear_lives import WearResult


def run(options: argparse.Namespace) -> int:
    """Follow a life of wear, and print and write the chosen cycles."""
    case = casefile.read_case(options.case)
    how: dict[str, Any] = {} if case.wear is None else case.wear.given
    given = {name: getattr(options, name) for name in ("cycles", "coefficient", "law", "tolerance")}
    given["at"] = None if options.at is None else [literal(part) for part in options.at.split(",")]
    given = {name: value for name, value in given.items() if value is not None}
    given = from_units(given, CASE["wear"], case.problem.unit_system)
    if "coefficient" in given:
        how |= {"pin": None, "plate": None}
    if "at" in how and isinstance(given.get("cycles"), (int, float)):
        how["at"] = [cycle for cycle in how["at"] if cycle <= given["cycles"]]  # of the file, which has more cycles
    how |= given
    for name in ("overwrite", "resume"):
        if getattr(options, name) and options.output is None:
            raise InputError(terminal.flag(name), "needs --output FILE")
    if case.wear is None and "coefficient" not in given:
        raise InputError("--coefficient", "is needed: the case file has no section [wear]")
    terminal.check_outputs(
        {terminal.flag(name): getattr(options, name) for name in ("json", "record", "output")}, result="--output"
    )
    settings: dict[str, Any] = {"nodes": options.nodes or case.options.nodes, "arc": case.options.arc}
    settings |= {"overwrite": options.overwrite, "resume": options.resume, "output": options.output}
    settings |= {"fatigue": case.fatigue}
    result: WearResult | None = None
    code, trouble = terminal.EXIT_OK, None
    with Bar(1, "{whole} of {total:,} cycles") as progress_bar:
        settings |= {"progress": progress_to(progress_bar), "title": case.title}
        try:
            with terminal.as_options((*given, "nodes", "resume")):
                result = storage.wear(case.problem, case.history, **how, **settings)
        except (solver.SolveError, solver.Interrupted) as ended:
            result, trouble = ended.result, str(ended)  # type: ignore[assignment]
            code = terminal.EXIT_FAILED if isinstance(ended, solver.SolveError) else terminal.EXIT_INTERRUPTED
    if trouble is not None:
        go_on = options.output is not None and code == terminal.EXIT_INTERRUPTED
        terminal.fail(f"{trouble}{'; continue with the same command and --resume' if go_on else ''}", code)
    return _write(result, options, case, trouble) or code


def show(stored: storage.stored.StoredResult, options: argparse.Namespace) -> int:
    """Print the chosen cycles of a stored life of wear."""
    path, error = stored.path, stored.error
    for name in ("plot", "states", "cycles", "cycle_csv"):
        if getattr(options, name) is not None:
            raise InputError(
                terminal.flag(name), f"is for the result of a run; fastpin plot {path} draws this life of wear"
            )
    terminal.check_outputs({"--json": options.json, "--record": options.record})
    life = storage.wear_files.life_of(stored)
    code = _write(life, options, stored.case, error)
    if not life.complete and options.json != "-":
        why, how = f": {error}" if error else "", way_on(path, error)
        terminal.say(f"note: the life is unfinished{why}{f'; {how}' if how else ''}")
    return code


def _write(result: WearResult | None, options: argparse.Namespace, case: Case, trouble: str | None) -> int:
    """Write the files, then print the table."""
    writers: list[tuple[Any, Callable[[Path], object]]] = []
    title, lines = case.title, list[str]()
    if result is not None:
        rows = [*result.summary().split("\n"), ""] if len(result) else []
        lines = [*([title, ""] if title else []), *rows, assess.wear.reached_line(result)]
    if result is not None and len(result):
        page = partial(live.record_life, result, title, trouble or "", case.fatigue)
        writers.append((options.record, lambda path: terminal.write_text(path, page())))
    document = partial(assess.wear.document, result, title, trouble)
    return terminal.write_outputs(writers, options.json, document, lambda: lines)
