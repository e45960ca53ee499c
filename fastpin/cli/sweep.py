"""The commands ``fastpin sweep`` and ``fastpin merge``."""

from __future__ import annotations

import argparse
import re
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fastpin.errors import InputError
from fastpin.files import check_writable
from fastpin.terminal import EXIT_FAILED, EXIT_INTERRUPTED, EXIT_OK, bar, check_figure, fail

if TYPE_CHECKING:
    from concurrent.futures import Executor

    from fastpin.plan import Plan
    from fastpin.sweep import Summary

MOST_REASONS = 20
"""Failed runs that are listed with their reasons."""

VALUE = "peak_pressure"
"""What is plotted without another wish."""

CLUSTER_SECONDS = 30
"""A scheduler that does not answer for so long is not there."""


def add(commands: Any) -> None:
    """Add the two commands to the parser's."""
    sweep = commands.add_parser("sweep", help="run all cases of a plan that are not finished", allow_abbrev=False)
    sweep.add_argument("plan", type=Path, help="plan (TOML): a case, and the fields that are varied")
    sweep.add_argument(
        "-o", "--output", metavar="DIR", type=Path, help="directory of index and results (default: the plan's name)"
    )
    sweep.add_argument("--status", action="store_true", help="say how far the sweep is; run nothing")
    sweep.add_argument("--retry", action="store_true", help="also run again what failed")
    sweep.add_argument("--workers", metavar="N", type=int, help="worker processes (default: one a processor)")
    sweep.add_argument("--dask", metavar="ADDRESS", help="use the workers of a dask scheduler")
    sweep.add_argument("--shard", metavar="I/N", help="only the I-th of N parts, each in a directory of its own")
    sweep.add_argument(
        "--table",
        metavar="FILE",
        nargs="?",
        const="-",
        help="parameters and key figures: as CSV, or printed where FILE is left out",
    )
    sweep.add_argument("--plot", metavar="FILE", type=Path, help="map or curves of one key figure (png, pdf or svg)")
    sweep.add_argument("--value", metavar="NAME", help=f"key figure to plot (default {VALUE})")
    sweep.add_argument("--x", metavar="FIELD", help="field along the figure's x axis")
    sweep.add_argument("--y", metavar="FIELD", help="field along the figure's y axis: a map")
    sweep.set_defaults(command=_sweep)

    merge = commands.add_parser("merge", help="join the directories of the parts of a sweep", allow_abbrev=False)
    merge.add_argument("parts", metavar="DIR", type=Path, nargs="+", help="directories of the parts")
    merge.add_argument("-o", "--output", metavar="DIR", type=Path, required=True, help="directory of the whole")
    merge.set_defaults(command=_merge)


def _sweep(options: argparse.Namespace) -> int:
    shard = _shard(options.shard)
    _check_combination(options)

    from fastpin.plan import read_plan

    plan = read_plan(options.plan)
    directory = Path(options.plan.stem) if options.output is None else options.output
    _check_outputs(options, plan)

    from fastpin import sweep
    from fastpin.sweeptable import text

    if options.status:
        summary = sweep.status(plan, directory, shard)
    else:
        try:
            summary = _run(options, plan, directory, shard)
        except KeyboardInterrupt:
            now = sweep.status(plan, directory, shard)
            kept = f"{now.done + len(now.failed)} of {now.total} runs are finished and kept; the same command goes on"
            return fail(f"interrupted; {kept}", EXIT_INTERRUPTED)
    rows = _written(options, plan, directory)
    _print_summary(plan, directory, summary, options.status, options.retry)
    if options.table == "-":
        print(text(plan, rows))
    return EXIT_FAILED if summary.failed and not options.status else EXIT_OK


def _run(options: argparse.Namespace, plan: Plan, directory: Path, shard: tuple[int, int] | None) -> Summary:
    from fastpin import sweep

    with _executor(options.dask) as executor, bar(len(plan.points), "run {n} of {total}") as shown:

        def progress(ended: int, total: int) -> None:
            shown.total = total
            shown.update(ended - shown.n)

        try:
            return sweep.run(plan, directory, executor, options.workers, options.retry, shard, progress)
        except InputError as error:
            if error.field == "workers":
                raise InputError("--workers", error.reason) from None
            raise


@contextmanager
def _executor(address: str | None) -> Iterator[Executor | None]:
    """The executor of a dask cluster; None for processes of our own."""
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
        raise InputError("--shard", f"must be I/N with I from 1 to N, such as 1/8, not {text!r}")
    return int(parts[1]), int(parts[2])


def _check_combination(options: argparse.Namespace) -> None:
    """Refuse options that would have no effect."""
    if options.workers is not None and options.dask is not None:
        raise InputError("--workers", "is for processes of this machine; the scheduler has its own workers")
    if options.status and options.retry:
        raise InputError("--retry", "runs what failed again, --status runs nothing")
    for name in ("value", "x", "y"):
        if getattr(options, name) is not None and options.plot is None:
            raise InputError(f"--{name}", "says what a figure shows; --plot FILE is missing")


def _check_outputs(options: argparse.Namespace, plan: Plan) -> None:
    """Find out before the work what could not be shown after it."""
    from fastpin.sweeptable import check_axes

    if options.table not in (None, "-"):
        if Path(options.table).suffix == ".toml":  # "fastpin sweep --table plan.toml"
            raise InputError("--table", f"won't overwrite the plan {options.table}; write the plan before the options")
        check_writable(options.table)
    if options.plot is not None:
        check_figure("--plot", options.plot)
        check_writable(options.plot)
        try:
            check_axes(plan, options.value or VALUE, options.x, options.y)
        except InputError as error:
            raise InputError(f"--{error.field}", error.reason) from None


def _print_summary(plan: Plan, directory: Path, summary: Summary, only_status: bool, retried: bool) -> None:
    from fastpin.plan import described

    if plan.title:
        print(plan.title)
    counts = f"{summary.done} done, {len(summary.failed)} failed, {summary.waiting} waiting"
    time = "" if only_status else f"; {summary.ended} in {summary.seconds:.1f} s"
    print(f"{summary.total} runs in {directory}: {counts}{time}")
    same = len(plan.points) - len(plan.runs)
    if same:
        print(f"{same} points of the plan have the same input as another and share its run")
    for point, reason in summary.failed[:MOST_REASONS]:
        print(f"failed: {point.id}  {described(point.values)}: {reason}")
    if len(summary.failed) > MOST_REASONS:
        print(f"... {len(summary.failed) - MOST_REASONS} more failed")
    if summary.failed and not retried:
        print("--retry runs what failed again")


def _written(options: argparse.Namespace, plan: Plan, directory: Path) -> list[dict[str, Any]]:
    """Write the files that are asked for; returns the rows of the plan."""
    from fastpin import sweep, sweeptable

    if options.table is None and options.plot is None:
        return []
    rows = sweep.rows(plan, directory)
    if options.table not in (None, "-"):
        sweeptable.write_csv(plan, rows, Path(options.table))
    if options.plot is not None:
        from fastpin.sweepplot import plot_sweep

        chart = sweeptable.chart(plan, rows, options.value or VALUE, options.x, options.y)
        plot_sweep(chart, options.plot)
        if chart.missing:
            print(f"note: {chart.missing} of {len(rows)} points have no value in the figure", file=sys.stderr)
    return rows


def _merge(options: argparse.Namespace) -> int:
    from fastpin import sweep

    count = sweep.merge(options.parts, options.output)
    print(f"{count} runs in {options.output}")
    return EXIT_OK
