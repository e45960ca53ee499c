"""``fastpin sweep``, ``merge`` and ``tolerances``."""

from __future__ import annotations

import argparse
import re
import sys
from collections.abc import Callable, Iterator
from concurrent.futures import Executor
from contextlib import contextmanager
from pathlib import Path
from typing import Any, TypeVar

from fastpin import figures, report, studies
from fastpin.cli import terminal
from fastpin.cli.options import literal
from fastpin.cli.progress import READ_POINTS, Bar, progress_to
from fastpin.errors import InputError
from fastpin.figures.kinds import DEFAULT_KEY_FIGURE

T = TypeVar("T")

MOST_REASONS = 20
"""Most failed runs that are listed with their reasons."""

CLUSTER_SECONDS = 30
"""Longest wait for the answer of a scheduler."""


def run(options: argparse.Namespace) -> int:
    """Run all cases of a plan that are not finished, then write tables and figures."""
    shard = _shard(options.shard)
    _check_combination(options)
    for name in ("value", "x", "y", "where", "envelope"):
        if getattr(options, name) is not None and options.plot is None:
            raise InputError(f"--{name}", "says what a figure shows; --plot FILE is missing")
    plan = _read(options, studies.read_plan)
    _check_outputs(options, plan)
    directory = _directory(options)
    summary = _followed(options, plan, directory, shard)
    if summary is None:
        return terminal.EXIT_INTERRUPTED
    rows = [] if options.table is None and options.plot is None else studies.sweep.rows(plan, directory)
    if options.table not in (None, "-"):
        report.sweep.write_csv(plan, rows, Path(options.table))
    if options.plot is not None:
        _draw(options, plan, rows)
    _print_summary(options, plan, directory, summary)
    if options.table == "-":
        terminal.say(*report.sweep.text(plan, rows).split("\n"))
    return _exit_code(options, summary)


def _read(options: argparse.Namespace, read: Callable[..., T]) -> T:
    """Read a plan with a progress bar, with the outcomes of ``--outcomes``."""
    with Bar(1, READ_POINTS) as progress_bar:
        plan: Any = read(options.plan, progress_to(progress_bar))
    if options.outcomes is None:
        return plan
    of = getattr(plan, "plan", plan)  # that of a tolerance study
    found: T = plan.with_outcomes(studies.read_outcomes(options.outcomes, of.base.beside(of.fields)))
    return found


def _directory(options: argparse.Namespace) -> Path:
    """Return the directory of index and results."""
    return Path(options.plan.stem) if options.output is None else options.output


def _followed(
    options: argparse.Namespace, plan: studies.plan.Plan, directory: Path, shard: tuple[int, int] | None = None
) -> studies.sweep.Summary | None:
    """Solve the runs of a plan with a progress bar, unless only the progress is asked for; return the progress.

    After Ctrl-C print how many runs are kept, and return None.
    """
    if options.status:
        return studies.sweep.status(plan, directory, shard)
    try:
        with _executor(options.dask) as executor, Bar(len(plan.points), "run {n} of {total}") as progress_bar:
            progress = progress_to(progress_bar)
            with terminal.as_options(["workers"]):
                return studies.sweep.run(
                    plan, directory, executor, options.workers, options.retry, shard, progress, options.files
                )
    except KeyboardInterrupt:
        now = studies.sweep.status(plan, directory, shard)
        kept = f"{now.done + len(now.failed)} of {now.total} runs are finished and kept; the same command continues"
        terminal.fail(f"interrupted; {kept}", terminal.EXIT_INTERRUPTED)
        return None


def _exit_code(options: argparse.Namespace, summary: studies.sweep.Summary) -> int:
    return terminal.EXIT_FAILED if (summary.failed or summary.unread) and not options.status else terminal.EXIT_OK


@contextmanager
def _executor(address: str | None) -> Iterator[Executor | None]:
    """Yield the executor of the dask cluster at `address`; None without an address, for processes of this machine."""
    if address is None:
        yield None
        return
    try:
        from distributed import Client
    except ImportError:
        raise InputError("--dask", "needs the package distributed: pip install 'fastpin[cluster]'") from None
    try:
        client = Client(address, timeout=CLUSTER_SECONDS)
    except (OSError, ValueError) as error:
        raise InputError("--dask", f"there is no scheduler at {address}: {error}") from None
    with client:
        yield client.get_executor()


def _shard(text: str | None) -> tuple[int, int] | None:
    if text is None:
        return None
    parts = re.fullmatch(r"(\d+)/(\d+)", text)
    if not parts or not 1 <= int(parts[1]) <= int(parts[2]):
        raise InputError("--shard", f'must be I/N with I from 1 to N, such as 1/8, not "{text}"')
    return int(parts[1]), int(parts[2])


def _check_combination(options: argparse.Namespace) -> None:
    """Refuse options that would have no effect."""
    if options.workers is not None and options.dask is not None:
        raise InputError("--workers", "is for processes of this machine; the scheduler has its own workers")
    if options.status and options.retry:
        raise InputError("--retry", "runs what failed again, --status runs nothing")
    if options.status and options.files:
        raise InputError("--files", "writes the results to files, --status writes nothing")


def _check_outputs(options: argparse.Namespace, plan: studies.plan.Plan) -> None:
    """Check before the work that the table and the figure can be made and written."""
    terminal.check_outputs({"--table": options.table, "--plot": options.plot})
    plan = _shown(options, plan)
    if options.envelope and (options.x or options.y or len(_values(options, plan)) > 1):
        raise InputError("--envelope", "has axes of its own, and shows one value: leave out --x, --y and other values")
    if options.plot is not None:
        with terminal.as_options():
            for value in _values(options, plan):
                if options.envelope:
                    report.sweep.check_envelope(plan, value)
                else:
                    report.sweep.check_axes(plan, value, options.x, options.y)


def _where(options: argparse.Namespace) -> dict[str, Any]:
    """Return the fields that a figure fixes, and their values."""
    pairs = [text.partition("=") for text in options.where or []]
    for field, sign, value in pairs:
        if not (field and sign and value):
            given = f"{field}{sign}{value}"
            raise InputError("--where", f'must be FIELD=VALUE, such as contact.friction=0.3, not "{given}"')
    return {field.strip(): literal(value.strip()) for field, _, value in pairs}


def _shown(options: argparse.Namespace, plan: studies.plan.Plan) -> studies.plan.Plan:
    """Return the part of a plan that a figure shows."""
    with terminal.as_options():
        return report.sweep.restricted(plan, _where(options))


def _values(options: argparse.Namespace, plan: studies.plan.Plan) -> list[str]:
    """Return the numbers that a figure shows: by default the first outcome of the plan, or else a key figure."""
    given = str(options.value or next(iter(plan.outcomes), DEFAULT_KEY_FIGURE))
    return [name.strip() for name in given.split(",")]


def _print_summary(
    options: argparse.Namespace, plan: studies.plan.Plan, directory: Path, summary: studies.sweep.Summary
) -> None:
    """Print the progress of a plan, and its failed runs with their reasons."""
    if plan.title:
        terminal.say(plan.title)
    counts = f"{summary.done} done, {len(summary.failed)} failed, {summary.waiting} waiting"
    time = "" if options.status else f"; {summary.ended} in {summary.seconds:.1f} s"
    terminal.say(f"{summary.total} runs in {directory}: {counts}{time}")
    same = len(plan.points) - len(plan.runs)
    if same:
        terminal.say(f"{same} points of the plan have the same input as another and share its run")
    for point, reason in summary.failed[:MOST_REASONS]:
        terminal.say(f"failed: {point.id}  {studies.plan.describe_values(point.values)}: {reason}")
    if len(summary.failed) > MOST_REASONS:
        terminal.say(f"... {len(summary.failed) - MOST_REASONS} more failed")
    if summary.read:
        terminal.say(f"outcomes of {summary.read} finished runs were read from their results")
    for name in plan.outcomes:
        unread = [(point, reason) for point, unread_name, reason in summary.unread if unread_name == name]
        if unread:
            point, reason = unread[0]
            terminal.say(f"outcome {name} can't be read in {len(unread)} runs, first {point.id}: {reason}")
    if summary.failed and not options.retry:
        terminal.say("--retry runs what failed again")


def _draw(options: argparse.Namespace, whole: studies.plan.Plan, rows: list[dict[str, Any]]) -> None:
    """Draw the figure of a plan with its rows, or of the points with the values of ``--where``."""
    values, where, plan = _values(options, whole), _where(options), _shown(options, whole)
    shown = set(map(id, plan.points))
    rows = [row for point, row in zip(whole.points, rows, strict=True) if id(point) in shown]
    fixed = [figures.style.shown_label(words) for words in report.sweep.where_words(plan, rows, where)]
    title = ", ".join(filter(None, [plan.title, *fixed]))
    if options.envelope:
        found = report.sweep.envelopes(plan, rows, values[0])
        if found:
            problem = plan.problem
            figures.sweep.plot_envelope(found, options.plot, title, problem=problem, varied=plan.fields)
        missing = {"": len(rows) - sum(len(next(iter(curve.columns.values()))) for curve in found)}
    else:
        charts = [report.sweep.chart(plan, rows, value, options.x, options.y) for value in values]
        figures.plot_sweep(charts if len(charts) > 1 else charts[0], options.plot, title)
        parts = [f" of {value}" if len(charts) > 1 else "" for value in values]
        missing = {part: chart.missing for part, chart in zip(parts, charts, strict=True)}
    for part, count in missing.items():
        if count:
            terminal.say(f"note: {count} of {len(rows)} points have no value{part} in the figure", file=sys.stderr)


def merge(options: argparse.Namespace) -> int:
    """Join the directories of the parts of a sweep."""
    count = studies.sweep.merge(options.parts, options.output)
    terminal.say(f"{count} runs in {options.output}")
    return terminal.EXIT_OK


def tolerances(options: argparse.Namespace) -> int:
    """Run all points of a tolerance plan that are not finished, then write tables and figures."""
    _check_combination(options)
    if options.value is not None and options.plot is None and options.scatter is None:
        raise InputError("--value", "says what a figure shows; --plot FILE or --scatter FILE is missing")
    study = _read(options, studies.read_tolerances)
    plan, directory, shown = study.plan, _directory(options), _check_figures(options, study)
    summary = _followed(options, plan, directory)
    if summary is None:
        return terminal.EXIT_INTERRUPTED
    rows = studies.sweep.rows(plan, directory)
    drawn = shown if options.plot or options.scatter else ()
    charts = [report.tolerances.tolerance_chart(study, rows, name) for name in drawn]
    files = [
        (options.table, lambda path: report.sweep.write_csv(plan, rows, path)),
        (options.plot, lambda path: figures.plot_tornado(charts, path)),
        (options.scatter, lambda path: figures.plot_samples(charts, path)),
    ]
    code = terminal.write_outputs(files, options.json, lambda: report.tolerances.document(study, rows))
    if options.json != "-":
        _print_summary(options, plan, directory, summary)
        if summary.done:
            terminal.say("", *report.tolerances.text(study, rows).split("\n"))
    return code or _exit_code(options, summary)


def _check_figures(options: argparse.Namespace, study: studies.tolerances.Tolerances) -> list[str]:
    """Check before the work that all files can be made and written. Return the outcomes of the figures."""
    outputs = {"--table": options.table, "--json": options.json, "--plot": options.plot, "--scatter": options.scatter}
    terminal.check_outputs(outputs, ("--plot", "--scatter"))
    if options.scatter is not None and not study.samples:
        raise InputError("--scatter", "draws samples, and the plan has none; give it samples = 200")
    if options.value is None:
        return [*study.plan.outcomes][:3]  # the first ones
    shown = [name.strip() for name in str(options.value).split(",")]
    with terminal.as_options():
        report.tolerances.check_outcomes(study, shown)
    return shown
