"""``fastpin identify``: friction, rig and offsets from a measured loop."""

from __future__ import annotations

import argparse
from functools import partial

from fastpin import assess, casefile, figures, report, studies
from fastpin.cli.progress import Bar, progress_to
from fastpin.cli.terminal import EXIT_OK, EXIT_READING, as_options, check_outputs, write_outputs


def run(options: argparse.Namespace) -> int:
    """Fit the case to the loop, print what it tells, and draw it."""
    case = casefile.read_case(options.case)
    fit = [name.strip() for name in options.fit.split(",") if name.strip()]
    with as_options(("over", "displacement", "force", "force_factor", "fit", "start", "nodes")):
        loop = studies.read_loop(
            options.loop, case.problem, options.over, options.displacement, options.force, options.force_factor
        )
        check_outputs({"--csv": options.csv, "--json": options.json, "--plot": options.plot})
        with Bar(1, "{whole} of about {total} solutions") as bar:
            found = studies.identify(
                case.problem, case.history, loop, fit, by_cycle=options.by_cycle, start=options.start,
                nodes=options.nodes, progress=progress_to(bar),
            )  # fmt: skip
    files = [
        (options.csv, lambda path: assess.outputs.write_csv([report.identify.loop_curve(found)], path)),
        (options.plot, lambda path: figures.plot_identified(found, path, case.title)),
    ]
    head = [case.title, ""] if case.title else []
    document = partial(assess.outputs.whole_document, report.identify.IDENTIFIED, found, {}, title=case.title)
    code = write_outputs(files, options.json, document, lambda: [*head, *report.identify.text(found).split("\n")])
    return code or (EXIT_OK if all(each.value > 0.0 for each in found.frictions) else EXIT_READING)
