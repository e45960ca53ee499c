"""``fastpin paper``: the figures of the paper."""

from __future__ import annotations

import argparse
import sys
import time

from fastpin.cli.progress import Bar
from fastpin.cli.terminal import EXIT_INTERRUPTED, EXIT_OK, fail
from fastpin.errors import InputError
from fastpin.published import catalog


def run(options: argparse.Namespace) -> int:
    """Compute, draw and write figures. Print the files of each figure and its seconds."""
    nodes = catalog.NODES if options.nodes is None else options.nodes
    try:
        names = list(dict.fromkeys(catalog.figure_name(name) for name in options.figure or catalog.PAPER))
        formats = list(dict.fromkeys(options.format or catalog.FORMATS[:1]))
        catalog.check(names, options.output, nodes, formats)
    except InputError as error:
        option = f"--{error.field}" if error.field in vars(options) else error.field
        raise InputError(option, error.reason) from None
    finished: list[str] = []
    try:
        with Bar(len(names), "figure {desc}") as progress_bar:
            for name in names:
                began = time.perf_counter()
                progress_bar.describe(name)

                def progress(part: float) -> None:
                    progress_bar.update(len(finished) + part - progress_bar.n)

                files = catalog.make(name, options.output, nodes, progress, formats)
                finished.append(name)
                seconds = time.perf_counter() - began
                named = ", ".join(map(str, files))
                progress_bar.write(f"figure {name}: {named}, {seconds:.1f} s", file=sys.stdout)
    except KeyboardInterrupt:
        written = f"figures that are finished: {', '.join(finished)}" if finished else "no figure was finished"
        return fail(f"interrupted; {written}", EXIT_INTERRUPTED)
    return EXIT_OK
