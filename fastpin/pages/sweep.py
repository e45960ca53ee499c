"""The page of a sweep, and of a tolerance study."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

from fastpin.casefile.toml_text import MOST_BYTES_OF_PLAN, read_text
from fastpin.errors import CaseFileError, InputError
from fastpin.figures.sweep import sweep_of, sweeps_of
from fastpin.figures.tolerances import samples_of, tornado_of
from fastpin.model.case import About
from fastpin.model.checks import check_callable, file_path, instance
from fastpin.pages.content import Album, Facts, Items, Listing, Page, PageSection, SectionPart, Table, Text
from fastpin.pages.source import merged, now
from fastpin.pages.writing import check_page, write_page
from fastpin.report.case import case_rows, corner_columns
from fastpin.report.sweep import brief, chart, check_axes, definition_words, run_columns
from fastpin.report.tolerances import failed_words, tables, tolerance_chart
from fastpin.storage.files import INDEX
from fastpin.studies.index import DONE, FAILED, WAITING, Index
from fastpin.studies.plan import Plan, describe_values, parse_plan, read_plan
from fastpin.studies.sweep import PLAN, rows
from fastpin.studies.tolerances import Tolerances, has_tolerances, parse_tolerances, read_tolerances
from fastpin.version import __version__

MOST_DRAWN = 8
"""Most outcomes that are drawn."""

BELOW = 2
"""Most outcomes of a figure, one below the other: more would not fit on a page of paper."""

MOST_FIELDS = 8
"""Most fields of an outcome that shares its figure."""

BESIDE = 4
"""Most charts of a figure, two in a row: more would not fit on a page of paper."""

MOST_RUNS = 500
"""Most runs in the table of a page; a table of more is left to a CSV file."""

MOST_FAILED = 200
"""Most failed runs that are listed with their reasons."""


class Parts(NamedTuple):
    """What the sections of a page share: the plan, its rows and its figures; of a tolerance study also the study."""

    plan: Plan
    runs: Sequence[dict[str, Any]]
    album: Album
    study: Tolerances | None = None


def _effects(study: Tolerances, runs: Sequence[dict[str, Any]], album: Album) -> PageSection:
    """Return the section of the effects: for each outcome a table and sentences, then tornados and samples."""
    parts: list[SectionPart] = []
    if lost := failed_words(study, runs):
        parts.append(Text(f"{lost[0].upper()}{lost[1:]}.", "note"))
    if not any(run["status"] == DONE for run in runs):
        return PageSection("effects", "Effects", [*parts, Text("No run is finished.", "missing")])
    for head, columns, sentences in tables(study, runs):
        parts += [Table(head, columns), Items([f"{each[0].upper()}{each[1:]}." for each in sentences])]
    names = [*study.plan.outcomes][:MOST_DRAWN]
    beside = BELOW if len(study.limits) <= MOST_FIELDS else 1
    for first in range(0, len(names), beside):
        charts = [tolerance_chart(study, runs, name) for name in names[first : first + beside]]
        parts.append(album.figure(tornado_of(charts)))
        if study.samples:
            parts.append(album.figure(samples_of(charts)))
    if len(study.plan.outcomes) > MOST_DRAWN:
        words = f"{len(study.plan.outcomes) - MOST_DRAWN:,} more outcomes are not drawn here"
        parts.append(Text(f"{words}. fastpin tolerances --plot FILE --value NAME draws one.", "missing"))
    return PageSection("effects", "Effects", parts)


def write_sweep_report(
    directory: str | Path,
    path: str | Path,
    *,
    plan: str | Path | None = None,
    about: About | None = None,
    progress: Callable[[float, float], None] | None = None,
) -> None:
    """Write the report of a sweep: its plan, maps or curves, a table of its runs, and failed runs.

    Parameters
    ----------
    directory : path
        The directory of the sweep. The sweep may be going on.
    path : path
        The report. Its name ends in .html, .htm or .pdf; a PDF needs the extra ``fastpin[pdf]``. An existing file is
        overwritten, whole or not at all.
    plan : path, optional
        The plan. Unless given, it is the copy in the directory. The base case of the copy is looked for from the
        directory, and from the directory round it.
    about : About, optional
        Project, author, revision and date. A field that is not given is that of the base case.
    progress : callable, optional
        Called as ``progress(done, all)`` with numbers of sections.

    Raises
    ------
    InputError
        If an argument is of another class, the directory holds no sweep or one of another version, its plan or base
        case is not found, or the page can't be written.
    CaseFileError
        If the plan has faults.
    """
    target, folder = check_page("path", path), file_path("directory", directory)
    check_callable("progress", progress)
    if about is not None:
        instance("about", about, About, "an About")
    report = progress or (lambda done, total: None)
    with Index(folder) as index:
        digest, version = index.read_note("plan"), index.read_note("version")
    if version != __version__:
        words = f"was made by fastpin {version}, which names its runs differently: write its page with that version"
        raise InputError(str(folder), words)
    found, study = _plan_of(folder, digest) if plan is None else _plan_in(file_path("plan", plan))
    page, sections = Parts(found, rows(found, folder), Album(), study), []
    for number, make in enumerate(SECTIONS):
        report(number, len(SECTIONS))
        sections.append(make(page))
    report(len(SECTIONS), len(SECTIONS))
    if found.digest != digest:
        words = "The sweep was last run with another plan than this one; runs that it lacks are waiting."
        sections[0] = PageSection("overview", "Overview", [*sections[0].parts, Text(words, "note")])
    kind = "parameter sweep" if study is None else "tolerance study"
    is_joint = found.base.form == "joint file"
    of = "a joint of several pins and plates" if is_joint else "an elastic pin in the hole of an elastic plate"
    lead = f"A {kind} of the frictional contact of {of}."
    made = f"Made by fastpin {__version__} on {now()} from {folder.resolve().name}/{INDEX}."
    named = merged(About() if is_joint else found.case(found.points[0]).about, about)
    write_page(Page(found.title or "Report of a sweep", lead, sections, made, named), target)


def _plan_in(path: Path) -> tuple[Plan, Tolerances | None]:
    """Read a plan, which may be a tolerance plan."""
    if has_tolerances(read_text(path, MOST_BYTES_OF_PLAN)):
        study = read_tolerances(path)
        return study.plan, study
    return read_plan(path), None


def _plan_of(folder: Path, digest: str | None) -> tuple[Plan, Tolerances | None]:
    """Return the plan of a sweep from its copy. Its base case lies where the plan was read, which is not known."""
    copy, fault, changed = folder / PLAN, None, False
    if not copy.is_file():
        raise InputError(str(folder), f"holds no copy of its plan, {PLAN}; name the plan")
    text = read_text(copy, MOST_BYTES_OF_PLAN)
    for base in (folder.resolve().parent, folder):
        try:
            study = parse_tolerances(text, str(copy), base) if has_tolerances(text) else None
            plan = parse_plan(text, str(copy), base) if study is None else study.plan
        except CaseFileError as error:
            fault = fault or error
            continue
        if plan.digest == digest:
            return plan, study
        changed = True
    if changed:
        raise InputError(str(folder), "its base case has changed since the sweep was run; name the plan")
    raise InputError(str(folder), f"its plan can't be read from here; name the plan. The first fault: {fault}")


def _overview(page: Parts) -> PageSection:
    plan, runs = page.plan, page.runs
    counts = Counter(run["status"] for run in runs)
    words = ", ".join(f"{counts[status]:,} {status}" for status in (DONE, FAILED, WAITING))
    seconds = sum(run.get("seconds") or 0.0 for run in runs)
    parts: list[SectionPart] = [Text(f"{len(runs):,} points: {words}. The solver took {seconds:.3g} s in all.")]
    if counts[WAITING]:
        how = "fastpin sweep with the plan continues the sweep"
        parts.append(Text(f"The sweep is not finished: {counts[WAITING]:,} points are waiting; {how}.", "note"))
    same = len(plan.points) - len(plan.runs)
    if same:
        parts.append(Text(f"{same:,} points have the same input as another one, and share its run."))
    return PageSection("overview", "Overview", parts)


def _plan(page: Parts) -> PageSection:
    plan, fields = page.plan, []
    for name, spacing in plan.fields.items():
        values = list(dict.fromkeys(brief(point.values[name]) for point in plan.points if name in point.values))
        shown = values if len(values) <= 12 else [*values[:3], "...", *values[-3:]]
        fields.append((name, f"{len(values):,}", ", ".join(shown), spacing))
    facts = Facts("Varied fields", fields, ("field", "values", "which", "spacing"))
    if page.study is not None:
        limits = page.study.limits.items()
        found = [(name, f"{each.nominal:.6g}", f"{each.low:.6g} to {each.high:.6g}") for name, each in limits]
        facts = Facts("Fields and their limits", found, ("field", "nominal", "limits, in the units of the case file"))
    outcomes = [(name, definition_words(outcome)) for name, outcome in plan.outcomes.items()]
    listed = [Facts("Outcomes", outcomes, ("name", "definition"))] if outcomes else []
    return PageSection("plan", "Plan", [facts, *listed, Listing("The plan", plan.text)])


def _first_case(page: Parts) -> PageSection:
    point = page.plan.points[0]
    case = page.plan.case(point)
    words = f"The first run, {point.id}: {describe_values(point.values)}."
    if page.plan.base.form == "joint file":
        names, points = [name for name in case.joint.load_names if any(name in at for at in case.corners)], case.corners
        loads = [(name, "", ["" if name not in at else brief(at[name]) for at in points]) for name in names]
        numbers = ("load point", "", [str(place) for place in range(1, len(points) + 1)])
        caption = "Loads in SI units; one without a number keeps its value"
        return PageSection("case", "The first joint", [Text(words), Table(caption, [numbers, *loads])])
    columns, hidden = corner_columns(case.problem, case.history)
    note = f" ({hidden:,} corners not shown here)" if hidden else ""
    facts = Facts("The problem", case_rows(case), ("subject", "in words"))
    table = Table(f"Corners of the load history{note}", columns)
    return PageSection("case", "The first case", [Text(words), facts, table])


def _charts(page: Parts) -> PageSection:
    plan, runs, album, study = page
    if study is not None:
        return _effects(study, runs, album)
    names = [*plan.outcomes] or ["peak_pressure", "contact_width", "stick_width", "dissipation"]
    parts: list[SectionPart] = []
    try:
        check_axes(plan, names[0], None, None)
    except InputError as error:
        parts.append(Text(f"There is no figure: {error.reason}.", "missing"))
        names = []
    # The page has the title.
    charts = {name: replace(chart(plan, runs, name), title="") for name in names[:MOST_DRAWN]}
    drawn = [found for found in charts.values() if found.missing < len(runs)]
    if any(len(found.parts) > 1 for found in drawn):
        parts += [album.figure(sweep_of(found)) for found in drawn]
    else:
        for first in range(0, len(drawn), BESIDE):
            some = drawn[first : first + BESIDE]
            parts.append(album.figure(sweeps_of(some) if len(some) > 1 else sweep_of(some[0])))
    missing = [name for name, found in charts.items() if found.missing == len(runs)]
    parts += [Text(f"There is no figure of {name}: no run has a value.", "missing") for name in missing]
    if len(names) > MOST_DRAWN:
        others = ", ".join(names[MOST_DRAWN:])
        parts.append(Text(f"Not drawn here: {others}. fastpin sweep --plot FILE --value NAME draws one.", "missing"))
    return PageSection("results", "Results", parts)


def _table(page: Parts) -> PageSection:
    runs = page.runs
    columns, gaps, half = run_columns(page.plan, runs), {}, MOST_RUNS // 2
    parts: list[SectionPart] = []
    if len(runs) > MOST_RUNS:
        columns = [(name, unit, [*cells[:half], *cells[-half:]]) for name, unit, cells in columns]
        gaps = {half: f"{len(runs) - MOST_RUNS:,} runs not shown here"}
        parts.append(Text("The table lacks its middle. fastpin sweep --table FILE writes all rows.", "missing"))
    return PageSection("runs", "Runs", [Table("Runs with their fields and values", columns, gaps), *parts])


def _failed(page: Parts) -> PageSection:
    failed = [(run, point) for run, point in zip(page.runs, page.plan.points, strict=True) if run["status"] == FAILED]
    if not failed:
        return PageSection("failed", "Failed runs", [Text("No run has failed.")])
    shown = failed[:MOST_FAILED]
    rows = [(run["id"], describe_values(each.values), run["reason"] or "no reason is known") for run, each in shown]
    parts: list[SectionPart] = [Facts(f"{len(failed):,} failed runs", rows, ("run", "values", "reason"))]
    if len(failed) > MOST_FAILED:
        parts.append(Text(f"{len(failed) - MOST_FAILED:,} more have failed.", "missing"))
    parts.append(Text("fastpin sweep --retry runs what failed again."))
    return PageSection("failed", "Failed runs", parts)


def _provenance(page: Parts) -> PageSection:
    runs = page.runs
    ended = [run for run in runs if run.get("versions")]
    names = sorted({", ".join(f"{name} {value}" for name, value in run["versions"].items()) for run in ended})
    started = sorted(run["started"] for run in ended if run.get("started"))
    residuals = [run["residual"] for run in ended if run.get("residual") is not None]
    found = [("solved by", version) for version in names]
    found += [("machine", host) for host in sorted({run["host"] for run in ended if run.get("host")})]
    found += [("first run begun", started[0]), ("last run begun", started[-1])] if started else []
    found += [("SHA-256 of fields and runs", page.plan.digest)]
    found += [("largest residual of all runs", f"{max(residuals):.1e}")] if residuals else []
    return PageSection("provenance", "Versions and provenance", [Facts("Origin", found, ("subject", "value"))])


SECTIONS = (_overview, _plan, _first_case, _charts, _table, _failed, _provenance)
"""All sections, in the order of the page."""
