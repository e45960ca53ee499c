"""``fastpin joint`` and ``show``: the load shares and contacts of several pins in several plates."""

from __future__ import annotations

import argparse
import sys
from functools import partial
from pathlib import Path
from typing import Any

from fastpin import figures, joints, live, report, storage
from fastpin.assess import outputs
from fastpin.cli import terminal
from fastpin.cli.progress import LOAD_POINTS, Bar, progress_to
from fastpin.errors import InputError
from fastpin.model.checks import whole_number
from fastpin.solver import Interrupted, SolveError

MOST_IN_MEMORY = 10_000
"""Most corners of a history without a file. Each state of ten pins takes half a megabyte."""


def run(options: argparse.Namespace) -> int:
    """Solve a joint file and print, draw and write its result; or print a commented joint file."""
    if options.example:
        sys.stdout.write(joints.JOINT_EXAMPLE)
        return terminal.EXIT_OK
    if options.file is None and options.resume is None:
        raise InputError("file", "the joint file is missing; start with: fastpin joint --example > joint.toml")
    for name in ("output", "nodes"):
        if options.resume is not None and getattr(options, name) is not None:
            raise InputError(terminal.flag(name), "is that of the file to go on with (--resume)")
    if options.overwrite and options.output is None:
        raise InputError("--overwrite", "needs --output FILE")
    like = None if options.file is None else joints.read_joint(options.file)
    case = storage.stored_joint(options.resume) if like is None else like
    case = case if options.nodes is None else case._replace(nodes=options.nodes)
    _check(options, len(case.corners), {"--output": options.output})
    path = options.output or options.resume
    if path is None and len(case.corners) > MOST_IN_MEMORY:
        words = f"is needed: the history has {len(case.corners):,} corners, more than {MOST_IN_MEMORY:,}"
        raise InputError("--output", words)
    code, error, given = terminal.EXIT_OK, "", ["resume", *(() if options.nodes is None else ("nodes",))]
    try:
        with Bar(len(case.corners), LOAD_POINTS) as bar, terminal.as_options(given):
            progress = progress_to(bar)
            if options.resume is not None:
                result = storage.resume_joint(path, like, progress)
            elif path is not None:
                result = storage.record_joint(case, path, overwrite=options.overwrite, progress=progress)
            else:
                how: dict[str, Any] = {"nodes": case.nodes, "harmonics": case.harmonics, "progress": progress}
                result = joints.solve_joint(case.joint, case.corners, **how)
    except (SolveError, Interrupted) as ended:
        code = terminal.EXIT_INTERRUPTED if isinstance(ended, Interrupted) else terminal.EXIT_FAILED
        more = "" if path is None else f"; go on with: fastpin joint --resume {path}"
        error = str(ended) or "interrupted"
        terminal.fail(f"{error}{more if isinstance(ended, Interrupted) else ''}", code)
        if ended.result is None or not len(ended.result):
            return code
        result = ended.result  # type: ignore[assignment]
    return _write(case, result, options, error) or code


def show(stored: storage.stored.StoredResult, options: argparse.Namespace) -> int:
    """Print and draw the stored result of a joint."""
    for name in ("states", "cycles", "cycle_csv"):
        if getattr(options, name) is not None:
            raise InputError(terminal.flag(name), "is for the result of one pin, not of a joint")
    if options.interface != "pin":
        raise InputError("--interface", "is for a bush that slips in its seat, not for a joint of several pins")
    case, result = storage.joint_files.case_of(stored), storage.joint_files.joint_of(stored)
    _check(options, max(len(result), 1), {})
    if not len(result):
        terminal.say("no state was reached")
    return _write(case, result, options, stored.error or "") if len(result) else terminal.EXIT_OK


def _check(options: argparse.Namespace, corners: int, result: dict[str, Any]) -> None:
    """Check before the work that all files can be written, and the load point of a figure."""
    figure_files = {"--plot": options.plot, "--shares": options.shares}
    files = {**figure_files, "--json": options.json, "--record": options.record, **result}
    terminal.check_outputs(files, tuple(figure_files), "--output")
    if options.at is not None:
        whole_number("--at", options.at, 1, corners)
        if options.plot is None:
            raise InputError("--at", "chooses the load point of a figure: it needs --plot FILE")


def _write(case: joints.JointFile, result: joints.JointResult, options: argparse.Namespace, error: str) -> int:
    """Write the files of a result, then print it. `error` is why the history ended early."""
    is_complete = len(result) == len(case.corners)
    if not is_complete:
        terminal.say(f"note: {len(result)} of {len(case.corners)} load points were reached", file=sys.stderr)
    last = min(options.at or len(result), len(result))
    draws = {options.plot: partial(figures.plot_joint, state=last - 1), options.shares: figures.plot_shares}
    files: list[Any] = [(name, partial(draw, result, title=case.title)) for name, draw in draws.items()]

    def record(path: Path) -> None:
        terminal.write_text(path, live.record_joint_page(case, result, error))

    files.append((options.record, record))
    asked = {"margins": True, "fatigue": case.fatigue, "crack": case.crack}
    with Bar(1.0, ", ".join(name for name, how in asked.items() if how)) as bar:
        judged = report.joints.judged(result, case.fatigue, is_complete, progress_to(bar), case.crack)
    unit = report.joints.joint_units(result.joint)
    document = partial(outputs.whole_document, report.joint_document.JOINT, judged, unit, title=case.title)
    text = [*filter(None, [case.title]), *report.joints.describe(judged).split("\n")]
    return terminal.write_outputs(files, options.json, document, lambda: text)
