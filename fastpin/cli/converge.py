"""``fastpin converge``: a convergence study of a case."""

from __future__ import annotations

import argparse

from fastpin import assess, casefile, figures, report, studies
from fastpin.cli import terminal
from fastpin.cli.progress import Bar
from fastpin.errors import InputError


def run(options: argparse.Namespace) -> int:
    """Study the convergence of a case on several grids, and write tables, files and a figure."""
    nodes = _numbers("--nodes", options.nodes)
    increments = [] if options.increments is None else _numbers("--increments", options.increments)

    case = casefile.builtin_case() if options.case is None else casefile.read_case(options.case)
    outcomes = {} if options.outcomes is None else studies.read_outcomes(options.outcomes)
    outputs = {"--csv": options.csv, "--json": options.json, "--plot": options.plot}
    terminal.check_outputs(outputs)
    code, trouble = terminal.EXIT_OK, ""
    fields = ("nodes", "increments", "increment_nodes", "corner", "outcomes")
    with Bar(1, "{desc}") as progress_bar, terminal.as_options(fields):

        def progress(done: float, total: float, what: str) -> None:
            progress_bar.describe(what)
            progress_bar.total = total
            progress_bar.update(done - progress_bar.n)

        try:
            study: studies.convergence.Convergence | None = studies.converge(
                case.problem, case.history, nodes, increments, options.increment_nodes, options.corner,
                case.options.arc, progress, outcomes,
            )  # fmt: skip
        except studies.convergence.StudyInterrupted as ended:
            study, code, trouble = ended.study, terminal.EXIT_INTERRUPTED, "interrupted"
        except studies.convergence.StudyLostError as lost:
            study, code, trouble = lost.study, terminal.EXIT_FAILED, str(lost)
    if study is None:
        return terminal.fail(f"{trouble}; less than three grids were finished", code)
    written = _write_study(study, options, case.title)
    for name, reason in study.unread.items():
        code = code or terminal.EXIT_FAILED
        terminal.fail(f"outcome {name} can't be read with {reason}", code)
    if not trouble:
        return written or code
    counts = [", ".join(map(str, each.counts)) for each in study.studies]
    more = f" and {counts[1]} increments" if len(counts) > 1 else ""
    kept = f"kept: corner {', '.join(map(str, study.loads))} with {counts[0]} nodes{more}"
    return terminal.fail(f"{trouble}; {kept}", written or code)


def _numbers(option: str, text: str) -> list[int]:
    try:
        return [int(part) for part in text.split(",")]
    except ValueError:
        raise InputError(option, f'must be whole numbers with commas, such as 101,201,401, not "{text}"') from None


def _write_study(study: studies.convergence.Convergence, options: argparse.Namespace, title: str) -> int:
    """Write the files, then print the tables."""
    files = [
        (options.csv, lambda path: report.convergence.write_csv(study, path)),
        (options.plot, lambda path: figures.plot_convergence(study, path, title=title)),
    ]
    return terminal.write_outputs(
        files,
        options.json,
        lambda: assess.outputs.whole_document(report.convergence.CONVERGENCE, study, {}, title=title),
        lambda: [*([title] if title else []), *report.convergence.text(study).split("\n")],
    )
