"""``fastpin tolerances``: a case at the limits of its fields."""

from __future__ import annotations

import argparse
from pathlib import Path

from fastpin import figures, report, studies
from fastpin.cli.progress import READ_POINTS, Bar, progress_to
from fastpin.cli.sweep import check_combination, fail_interrupted, print_summary, run_plan
from fastpin.cli.terminal import EXIT_FAILED, EXIT_OK, as_options, check_outputs, say, write_outputs
from fastpin.errors import InputError


def run(options: argparse.Namespace) -> int:
    """Run all points of a tolerance plan that are not finished, then write tables and figures."""
    check_combination(options)
    if options.value is not None and options.plot is None and options.scatter is None:
        raise InputError("--value", "says what a figure shows; --plot FILE or --scatter FILE is missing")
    with Bar(1, READ_POINTS) as progress_bar:
        study = studies.read_tolerances(options.plan, progress_to(progress_bar))
    if options.outcomes is not None:
        study = study.with_outcomes(studies.read_outcomes(options.outcomes))
    directory = Path(options.plan.stem) if options.output is None else options.output
    shown = _check_outputs(options, study)
    if options.status:
        summary = studies.sweep.status(study.plan, directory)
    else:
        try:
            summary = run_plan(options, study.plan, directory, None)
        except KeyboardInterrupt:
            return fail_interrupted(study.plan, directory, None)
    code = _write(options, study, directory, shown)
    if options.json == "-":
        return code or _code(options, summary)
    print_summary(study.plan, directory, summary, options.status, options.retry)
    if summary.done:
        say("", *report.tolerances.text(study, studies.sweep.rows(study.plan, directory)).split("\n"))
    return code or _code(options, summary)


def _code(options: argparse.Namespace, summary: studies.sweep.Summary) -> int:
    return EXIT_FAILED if (summary.failed or summary.unread) and not options.status else EXIT_OK


def _check_outputs(options: argparse.Namespace, study: studies.tolerances.Tolerances) -> list[str]:
    """Check before the work that all files can be made and written. Return the outcomes of the figures."""
    outputs = {"--table": options.table, "--json": options.json, "--plot": options.plot, "--scatter": options.scatter}
    check_outputs(outputs, ("--plot", "--scatter"))
    if options.scatter is not None and not study.samples:
        raise InputError("--scatter", "draws samples, and the plan has none; give it samples = 200")
    if options.value is None:
        return [*study.plan.outcomes][:3]  # the first ones
    shown = [name.strip() for name in str(options.value).split(",")]
    with as_options():
        report.tolerances.check_outcomes(study, shown)
    return shown


def _write(options: argparse.Namespace, study: studies.tolerances.Tolerances, directory: Path, shown: list[str]) -> int:
    """Write the files that are asked for, and return the exit code."""
    outputs = (options.table, options.json, options.plot, options.scatter)
    if all(each is None for each in outputs):
        return EXIT_OK
    rows = studies.sweep.rows(study.plan, directory)
    charts = [report.tolerances.tolerance_chart(study, rows, name) for name in shown]
    files = [
        (options.table, lambda path: report.sweep.write_csv(study.plan, rows, path)),
        (options.plot, lambda path: figures.plot_tornado(charts, path)),
        (options.scatter, lambda path: figures.plot_samples(charts, path)),
    ]
    return write_outputs(files, options.json, lambda: report.tolerances.document(study, rows))
