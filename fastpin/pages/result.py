"""The report of a result."""

from __future__ import annotations

import contextlib
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

from fastpin.assess.questions import QUESTIONS
from fastpin.casefile.reader import parse_case
from fastpin.casefile.toml_text import read_text
from fastpin.errors import CaseFileError, InputError
from fastpin.joints import JointResult
from fastpin.model.case import About, beside_of
from fastpin.model.checks import check_callable, file_path, instance, string
from fastpin.pages.content import Album, Page
from fastpin.pages.joint import JointSource, write_joint
from fastpin.pages.sections import SECTIONS
from fastpin.pages.source import PageParts, Source, merged, now, with_count
from fastpin.pages.wear import WEAR_SECTIONS
from fastpin.pages.writing import check_page, write_sections
from fastpin.solver import Result
from fastpin.storage.stored import StoredResult
from fastpin.studies.convergence import Convergence
from fastpin.studies.identity import canonical
from fastpin.version import __version__
from fastpin.wear_lives import WearResult

PageProgress = Callable[[float, float], None]
"""Receives the number of finished sections and the number of all sections."""


def write_report(
    result: Result | WearResult | JointResult | str | Path,
    path: str | Path,
    *,
    title: str = "",
    about: About | None = None,
    case: str | Path | None = None,
    convergence: Convergence | None = None,
    hole: tuple[str, str] | None = None,
    progress: PageProgress | None = None,
) -> None:
    """Write the report of a result, a life of wear or a joint: one HTML page or a PDF, with all figures inside.

    It needs no other file. Of a long history the page shows the last cycle and the ends of the table. A section that
    lacks its data says how to get them.

    Parameters
    ----------
    result : Result, WearResult, JointResult or path
        A result, a life of wear, the result of a joint of several pins, or the file of one. The run of the file may be
        finished, unfinished or going on.
    path : path
        The report. Its name ends in .html, .htm or .pdf; a PDF needs the extra ``fastpin[pdf]``. An existing file is
        overwritten, whole or not at all.
    title : str
        Title of the report; that of the stored case unless given.
    about : About, optional
        Project, author, revision and date. A field that is not given is that of the stored case.
    case : path, optional
        The case file of the result. Its text is shown on the page. A result in memory is judged by its sections
        [fatigue], [crack] and [strength]; a stored one has its own. Unless given, it is the file beside a stored result
        that has its name with .toml, if that is a case file of the same problem and loads.
    convergence : Convergence, optional
        A study of the case, which is shown on the page of a result.
    hole : (str, str), optional
        Names of the pin and the plate whose contact the page of a joint shows; the hole with the largest hoop stress
        unless given.
    progress : callable, optional
        Called as ``progress(done, all)`` with numbers of sections.

    Raises
    ------
    InputError
        If an argument is of another class, the result can't be read, the case file belongs to another case, or the page
        can't be written.
    CaseFileError
        If the case file has faults.
    ReadingError
        If a section could not be made. The page is written, and its section says why.
    """
    target = check_page("path", path)
    check_callable("progress", progress)
    string("title", title)
    if about is not None:
        instance("about", about, About, "an About")
    if convergence is not None:
        instance("convergence", convergence, Convergence, "a Convergence")
    with contextlib.ExitStack() as stack:
        stored = None
        if not isinstance(result, (Result, WearResult, JointResult)):
            stored = stack.enter_context(StoredResult(file_path("result", result)))
        joint: Any = result if isinstance(result, JointResult) else None
        joint = stored if stored is not None and stored.is_joint else joint
        if joint is not None:
            if convergence is not None:
                raise InputError("convergence", "has no effect on the report of a joint of several pins")
            of_joint = replace(JointSource.of(joint, case).named(title, about), hole=hole)
            write_joint(of_joint, target, progress)
        elif hole is not None:
            raise InputError("hole", "chooses a pin in a plate of a joint; this is no joint of several pins")
        else:
            source = _source(result if stored is None else stored, title, case)
            if source.life is not None and convergence is not None:
                raise InputError("convergence", "has no effect on the report of a life of wear")
            named = replace(source.case, title=title or source.case.title, about=merged(source.case.about, about))
            write_source(replace(source, case=named), target, convergence, progress)


def _source(shown: Any, title: str, case: str | Path | None) -> Source:
    """Return a result of one pin or a life of wear, in a file or in memory, with the text of its case file."""
    if not isinstance(shown, StoredResult):
        source = Source.of_result(shown, title) if isinstance(shown, Result) else Source.of_life(shown, title)
    else:
        source = Source.of_file(shown)
        if case is None:
            with contextlib.suppress(InputError, CaseFileError):  # the file is another case, or none
                source = replace(source, case_text=_case_text(shown.path.with_suffix(".toml"), source))
    if case is not None:
        source = replace(source, case_text=_case_text(case, source))
        if source.path is None:  # a result in memory does not know how it is to be judged
            given = parse_case(source.case_text, str(case), Path(case).parent)
            source = replace(source, case=replace(source.case, **beside_of(given)))
    return source


def write_source(
    source: Source,
    path: Path,
    convergence: Convergence | None = None,
    progress: PageProgress | None = None,
) -> None:
    """Write the page of a source, see :func:`write_report`.

    A section that can't be made says why. :class:`ReadingError` is raised when the page is written.
    """
    makers = WEAR_SECTIONS
    if source.life is None:
        left_out = {name for name in QUESTIONS if getattr(source.case, name) is None}
        left_out |= {"seat"} if source.case.problem.seat is None else set()
        makers = [make for make in SECTIONS if make.__name__ not in left_out]
    what = "Frictional contact" if source.life is None else "Wear in the frictional contact"
    lead = f"{what} of an elastic pin in the hole of an elastic plate."
    made = f"Made by fastpin {__version__} on {now()}."
    title = source.case.title or ("Report of a result" if source.life is None else "Report of a life of wear")
    page = Page(title, lead, [], made, source.case.about)
    write_sections(makers, PageParts(source, Album(), convergence), page, path, progress, source.path)


def _case_text(path: str | Path, source: Source) -> str:
    """Return the text of a case file, which must have the problem and the loads of a source.

    The cycle of a life of wear may have any number of repeats in the case file.
    """
    file = file_path("case", path)
    text = read_text(file)
    case = parse_case(text, str(file), file.parent)
    if source.life is not None:
        case = replace(case, history=with_count(case.history, source.life.all_cycles))
    given, stored = (canonical(each) for each in (case, source.case))
    for name in given.keys() | stored.keys():
        if name != "solve" and given.get(name) != stored.get(name):
            raise InputError("case", f"{file} is not the case of this result: {name.replace('_', ' ')} differs")
    return text
