"""``fastpin joint``: the load shares and contacts of several pins in several plates."""

from __future__ import annotations

import argparse
import sys
from functools import partial

from fastpin import figures, joints, report
from fastpin.assess import outputs
from fastpin.cli import terminal
from fastpin.cli.progress import LOAD_POINTS, Bar, progress_to
from fastpin.errors import InputError
from fastpin.model.checks import whole_number
from fastpin.solver import Interrupted, SolveError

JUDGED = "margins, fatigue and crack"
"""Text of the progress bar after the solution."""


def run(options: argparse.Namespace) -> int:
    """Solve a joint file and print, draw and write its result; or print a commented joint file."""
    if options.example:
        sys.stdout.write(joints.JOINT_EXAMPLE)
        return terminal.EXIT_OK
    if options.file is None:
        raise InputError("file", "the joint file is missing; start with: fastpin joint --example > joint.toml")
    case = joints.read_joint(options.file)
    terminal.check_outputs(
        {"--plot": options.plot, "--shares": options.shares, "--json": options.json}, ("--plot", "--shares")
    )
    if options.at is not None:
        whole_number("--at", options.at, 1, len(case.corners))
        if options.plot is None:
            raise InputError("--at", "chooses the load point of a figure: it needs --plot FILE")
    nodes = case.nodes if options.nodes is None else options.nodes
    code = terminal.EXIT_OK
    try:
        with (
            Bar(len(case.corners), LOAD_POINTS) as bar,
            terminal.as_options(() if options.nodes is None else ("nodes",)),
        ):
            result = joints.solve_joint(
                case.joint, case.corners, nodes=nodes, harmonics=case.harmonics, progress=progress_to(bar)
            )
    except (SolveError, Interrupted) as ended:
        code = terminal.EXIT_INTERRUPTED if isinstance(ended, Interrupted) else terminal.EXIT_FAILED
        terminal.fail(str(ended) or "interrupted", code)
        result = ended.result  # type: ignore[assignment]
        if result is None or not len(result):
            return code
        terminal.say(f"note: {len(result)} of {len(case.corners)} load points were reached", file=sys.stderr)
    last = min(options.at or len(result), len(result))
    draws = {options.plot: partial(figures.plot_joint, state=last - 1), options.shares: figures.plot_shares}
    files = [(name, partial(draw, result, title=case.title)) for name, draw in draws.items()]
    with Bar(1.0, JUDGED) as bar:
        judged = report.joints.judged(result, case.fatigue, not code, progress_to(bar), case.crack)
    unit = report.joints.joint_units(result.joint)
    document = partial(outputs.whole_document, report.joints.JOINT, judged, unit, title=case.title)
    text = [*filter(None, [case.title]), *report.joints.describe(judged).split("\n")]
    written = terminal.write_outputs(files, options.json, document, lambda: text)
    return code or written
