"""``fastpin benchmarks`` and ``paper``: published problems and figures beside our numbers."""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Callable, Sequence
from typing import Any

from fastpin.assess.outputs import whole_document
from fastpin.cli.progress import Bar
from fastpin.cli.terminal import EXIT_INTERRUPTED, EXIT_OK, as_options, check_outputs, fail, say, write_outputs
from fastpin.published import catalog, records
from fastpin.report.schema import BENCHMARKS


def run(options: argparse.Namespace) -> int:
    """Solve the benchmarks, print their tables, and write their files."""
    if options.list:
        width = max(map(len, catalog.BENCHMARKS))
        say(*(f"{name:<{width}}  {benchmark.title}" for name, benchmark in catalog.BENCHMARKS.items()))
        return EXIT_OK
    names = list(dict.fromkeys(catalog.benchmark_name(name) for name in options.names or catalog.BENCHMARKS))
    if options.output is not None:
        with as_options():
            catalog.check_files([f"{name}.csv" for name in names], options.output)
    check_outputs({"--json": options.json})
    found: dict[str, Any] = {}

    def work(name: str, bar: Bar, progress: records.Report) -> None:
        chosen = catalog.BENCHMARKS[name]
        outcome = chosen.compute(progress)
        found[name] = outcome.rows
        if options.json != "-":
            shown = records.table(chosen.title, chosen.statement, chosen.sources, outcome.rows)
            bar.write(*f"{name}: {shown}".split("\n"), "", file=sys.stdout)
        if options.output is not None:
            to = sys.stderr if options.json == "-" else sys.stdout
            bar.write(f"{name}: {catalog.write_benchmark(name, outcome, options.output)}", "", file=to)

    code = _each(names, "benchmark", work)
    return code or write_outputs([], options.json, lambda: whole_document(BENCHMARKS, found, {}))


def _each(names: Sequence[str], word: str, work: Callable[[str, Bar, records.Report], None]) -> int:
    """Do the work of each name with a progress bar, and return the exit code. After Ctrl-C say what is finished."""
    finished: list[str] = []
    try:
        with Bar(len(names), f"{word} {{desc}}") as bar:
            for name in names:
                bar.describe(name)
                work(name, bar, lambda part: bar.update(len(finished) + part - bar.n))
                finished.append(name)
    except KeyboardInterrupt:
        kept = f"{word}s that are finished: {', '.join(finished)}" if finished else f"no {word} was finished"
        return fail(f"interrupted; {kept}", EXIT_INTERRUPTED)
    return EXIT_OK


def paper(options: argparse.Namespace) -> int:
    """Compute, draw and write figures. Print the files of each figure and its seconds."""
    nodes = catalog.NODES if options.nodes is None else options.nodes
    with as_options(vars(options)):
        names = list(dict.fromkeys(catalog.figure_name(name) for name in options.figure or catalog.PAPER))
        formats = list(dict.fromkeys(options.format or catalog.FORMATS[:1]))
        catalog.check(names, options.output, nodes, formats)

    def work(name: str, bar: Bar, progress: records.Report) -> None:
        began = time.perf_counter()
        files = catalog.make(name, options.output, nodes, progress, formats)
        named, seconds = ", ".join(map(str, files)), time.perf_counter() - began
        bar.write(f"figure {name}: {named}, {seconds:.1f} s", file=sys.stdout)

    return _each(names, "figure", work)
