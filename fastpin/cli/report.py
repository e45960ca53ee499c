"""``fastpin report``: a page or a PDF on a stored result, a case or a sweep."""

from __future__ import annotations

import argparse
import contextlib
import dataclasses
from pathlib import Path
from typing import Any

from fastpin import casefile, joints, pages, solver, storage, studies
from fastpin.casefile.toml_text import read_text
from fastpin.cli.options import ABOUT
from fastpin.cli.plot import hole_of
from fastpin.cli.progress import LOAD_POINTS, READ_POINTS, Bar, progress_to
from fastpin.cli.terminal import EXIT_FAILED, EXIT_OK, EXIT_READING, as_options, fail, flag, say
from fastpin.errors import CaseFileError, InputError, ReadingError
from fastpin.model.case import About, Case
from fastpin.pages.joint import JointSource, write_joint
from fastpin.pages.result import write_source
from fastpin.pages.source import Source, merged, origin_of
from fastpin.pages.writing import check_page

SECTIONS = "section {n:.0f} of {total:.0f}"
"""Text of the progress bar of the page."""


def run(options: argparse.Namespace) -> int:
    """Write the page."""
    kind = "sweep" if options.source.is_dir() else "case" if options.source.suffix == ".toml" else "result"
    if kind == "case" and joints.is_joint_file(read_text(options.source)):
        kind = "joint"
    words = {"result": "a stored result", "case": "a case file", "sweep": "the directory of a sweep"}
    words["joint"] = "a joint file"
    of_joint = ("result", "joint")
    effects = {"title": ("result", "case", "joint"), "case": ("result",), "plan": ("sweep",), "error_bars": ("case",)}
    effects |= {"pin": of_joint, "plate": of_joint}
    for name, kinds in effects.items():
        if getattr(options, name) is not None and kind not in kinds:
            allowed = " or ".join(words[each] for each in kinds)
            raise InputError(flag(name), f"has no effect on {words[kind]}; it is for {allowed}")
    page = Path(f"{options.source.resolve().stem}.html") if options.output is None else options.output
    check_page("--output", page)
    try:
        with as_options(("title", "case", "plan", "error_bars", *ABOUT)):
            make = {"case": _of_case, "joint": _of_joint}.get(kind, _of_stored)
            code = make(options, page)
    except ReadingError as error:  # the page says it, too
        code = fail(str(error), EXIT_READING)
    say(f"wrote {page}")
    return code


def _about(options: argparse.Namespace) -> About:
    """Return project, author, revision and date as far as options give them."""
    return About(**{name: getattr(options, name) or "" for name in ABOUT})


def _of_stored(options: argparse.Namespace, page: Path) -> int:
    """Write the page of a stored result, or of a sweep."""
    with Bar(1, SECTIONS) as bar:
        shared: dict[str, Any] = {"about": _about(options), "progress": progress_to(bar)}
        if options.source.is_dir():
            pages.write_sweep_report(options.source, page, plan=options.plan, **shared)
        else:
            shared |= {"title": options.title or "", "case": options.case}
            if options.pin is not None or options.plate is not None:
                with storage.stored.StoredResult(options.source) as stored:
                    if not stored.is_joint:
                        raise InputError("--pin", "is for the result of a joint of several pins")
                    shared["hole"] = hole_of(storage.joint_files.case_of(stored).joint, options)
            pages.write_report(options.source, page, **shared)
    return EXIT_OK


def _of_joint(options: argparse.Namespace, page: Path) -> int:
    """Solve a joint file, and write its page. A history that ends early has a page of its states."""
    case, code = joints.read_joint(options.source), EXIT_OK
    shown = options.pin is not None or options.plate is not None
    hole = hole_of(case.joint, options) if shown else None
    if hole is not None:
        case.joint.place(*hole)
    reason, how = None, dict[str, Any](nodes=case.nodes, harmonics=case.harmonics)
    with Bar(len(case.corners), LOAD_POINTS) as bar:
        try:
            result = joints.solve_joint(case.joint, case.corners, progress=progress_to(bar), **how)
        except solver.SolveError as error:
            if error.result is None or not len(error.result):
                raise
            result, reason = error.result, str(error)  # type: ignore[assignment]
            code = fail(reason, EXIT_FAILED)
    text = options.source.read_text(encoding="utf-8-sig")
    source = JointSource(case, result, origin_of(None), error=reason, case_text=text, hole=hole)
    with Bar(1, SECTIONS) as bar:
        write_joint(source.named(options.title or "", _about(options)), page, progress_to(bar))
    return code


def _case(source: Path) -> Case:
    """Read a case file. A plan is refused with the way to the page of its sweep."""
    try:
        return casefile.read_case(source)
    except CaseFileError:
        with contextlib.suppress(CaseFileError), Bar(1, READ_POINTS) as bar:
            studies.read_plan(source, progress_to(bar))
            words = f"is a plan: name the directory of its sweep, such as {source.with_suffix('')}"
            raise InputError(str(source), words) from None
        raise


def _of_case(options: argparse.Namespace, page: Path) -> int:
    """Solve a case, and write its page. A run that ends early has a page of its states."""
    case, code, reason = _case(options.source), EXIT_OK, None
    case = dataclasses.replace(case, title=options.title or case.title, about=merged(case.about, _about(options)))
    if options.error_bars:
        case = dataclasses.replace(case, options=case.options.changed(error_bars=True))
    with Bar(len(case.history), LOAD_POINTS) as bar:
        try:
            result = solver.solve(case.problem, case.history, progress=progress_to(bar), **case.options.keywords())
        except solver.SolveError as error:
            if error.result is None or not len(error.result):
                raise
            result, reason = error.result, str(error)
            code = fail(reason, EXIT_FAILED)
    source = Source.of_result(result, case=case, error=reason)
    source = dataclasses.replace(source, case_text=options.source.read_text(encoding="utf-8-sig"))
    with Bar(1, SECTIONS) as bar:
        write_source(source, page, progress=progress_to(bar))
    return code
