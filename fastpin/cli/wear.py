"""``fastpin wear``: a load cycle many times, on a profile that wears."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

from fastpin import assess, casefile, joints, live, report, solver, storage, wear_lives
from fastpin.assess import outputs
from fastpin.casefile.toml_text import read_text
from fastpin.cli import terminal
from fastpin.cli.options import literal
from fastpin.cli.progress import Bar, progress_to
from fastpin.errors import InputError
from fastpin.model.case import Case
from fastpin.model.keys import CASE
from fastpin.model.units import from_units
from fastpin.model.wear import Wear
from fastpin.report.states import way_on
from fastpin.wear_lives import WearResult


def run(options: argparse.Namespace) -> int:
    """Follow a life of wear, and print and write the chosen cycles."""
    if joints.is_joint_file(read_text(options.case)):
        return _run_joint(options)
    case = casefile.read_case(options.case)
    how, given = _how(options, case.wear, case.problem.unit_system)
    for name in ("overwrite", "resume"):
        if getattr(options, name) and options.output is None:
            raise InputError(terminal.flag(name), "needs --output FILE")
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


def _how(options: argparse.Namespace, of_file: Wear | None, system: str) -> tuple[dict[str, Any], dict[str, Any]]:
    """How the bodies wear by the file and the options, and the values of the options alone, SI."""
    how: dict[str, Any] = {} if of_file is None else of_file.given
    given = {name: getattr(options, name) for name in ("cycles", "coefficient", "law", "tolerance")}
    given["at"] = None if options.at is None else [literal(part) for part in options.at.split(",")]
    given = {name: value for name, value in given.items() if value is not None}
    given = from_units(given, CASE["wear"], system)
    if "coefficient" in given:
        how |= {"pin": None, "plate": None}
    if "at" in how and isinstance(given.get("cycles"), (int, float)):
        how["at"] = [cycle for cycle in how["at"] if cycle <= given["cycles"]]  # of the file, which has more cycles
    if of_file is None and "coefficient" not in given:
        raise InputError("--coefficient", "is needed: the case file has no section [wear]")
    return how | given, given


def _run_joint(options: argparse.Namespace) -> int:
    """Follow a life of wear of a joint of several pins, and print and write the chosen cycles."""
    case = joints.read_joint(options.case)
    how, given = _how(options, case.wear, case.joint.unit_system)
    for name in ("output", "overwrite", "resume", "record"):
        if getattr(options, name):
            raise InputError(terminal.flag(name), "is for a life of one pin: that of a joint stays in memory")
    terminal.check_outputs({"--json": options.json})
    settings: dict[str, Any] = {"nodes": options.nodes or case.nodes, "harmonics": case.harmonics}
    code, trouble = terminal.EXIT_OK, None
    with Bar(1, "{whole} of {total:,} cycles") as bar:
        try:
            with terminal.as_options((*given, "nodes")):
                settings["progress"] = progress_to(bar)
                result = wear_lives.wear_joint(case.joint, case.corners, Wear(**how), **settings)
        except (solver.SolveError, solver.Interrupted) as ended:
            result, trouble = ended.result, str(ended) or "interrupted"  # type: ignore[assignment]
            code = terminal.EXIT_FAILED if isinstance(ended, solver.SolveError) else terminal.EXIT_INTERRUPTED
    if trouble is not None:
        terminal.fail(trouble, code)
    unit = report.joints.joint_units(case.joint)
    document = partial(outputs.whole_document, report.joint_wear.LIFE, result, unit, title=case.title, error=trouble)
    text = [*filter(None, [case.title]), *report.joint_wear.describe(result).split("\n")]
    return terminal.write_outputs([], options.json, document, lambda: text) or code


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
