"""The file of a page, HTML or PDF by the ending of its name. Only this file imports jinja2 and typst."""

from __future__ import annotations

import importlib.util
import json
import re
from collections.abc import Callable, Sequence
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import jinja2

from fastpin.errors import InputError, ReadingError, reading
from fastpin.figures.style import FONTS
from fastpin.model.checks import as_toml, file_path
from fastpin.pages.content import Page, PageSection, SectionPart, Table, Text, shown
from fastpin.storage.files import check_writable, replacing


def check_typst(field: str) -> None:
    """Raise :class:`InputError` if the package typst is missing."""
    if importlib.util.find_spec("typst") is None:
        raise InputError(field, "a PDF needs the package typst: pip install 'fastpin[pdf]'")


def pdf_of(page: Page) -> bytes:
    """Return a page as a PDF for A4 paper. Its fonts are inside it."""
    import typst

    sections = [{"title": each.title, "parts": [_part(part) for part in each.parts]} for each in page.sections]
    about = [[name.capitalize(), value] for name, value in page.about.given().items()]
    texts = {name: getattr(page, name) for name in ("title", "lead", "head", "made")}
    whole = {**texts, "about": about, "author": page.about.author, "sections": sections}
    given = {"page": json.dumps(_plain(whole))}
    template, folder = str(FOLDER / "page.typ"), str(FOLDER)
    return bytes(typst.compile(template, root=folder, font_paths=[str(FONTS)], sys_inputs=given))


def _part(part: SectionPart) -> dict[str, Any]:
    if not isinstance(part, Table):
        return asdict(part)
    heads = [(name, unit) for name, unit, _ in part.columns]
    gaps = {str(place): words for place, words in part.gaps.items()}
    return {
        "kind": part.kind, "caption": part.caption, "heads": heads, "sides": part.sides, "rows": part.rows, "gaps": gaps
    }  # fmt: skip


def _plain(value: Any) -> Any:
    """Return a document with escapes for the characters that can't be printed."""
    if isinstance(value, dict):
        return {name: _plain(each) for name, each in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(each) for each in value]
    return shown(value) if isinstance(value, str) else value


def check_page(field: str, path: str | Path) -> Path:
    """Return the path of a page to be written.

    Raises
    ------
    InputError
        With `field`, if the name does not end as a page's, or the package for PDFs is missing. Also if the file can't
        be written.
    """
    found = file_path(field, path)
    if found.suffix.lower() not in (".html", ".htm", ".pdf"):
        words = "must be the name of a page, which ends in .html, .htm or .pdf"
        raise InputError(field, f"{words}, not {as_toml(found.name)}")
    if _is_pdf(found):
        check_typst(field)
    check_writable(found)
    return found


def write_page(page: Page, path: Path) -> None:
    """Write a page, whole or not at all.

    Raises
    ------
    InputError
        If the file can't be written.
    """
    content = pdf_of(page) if _is_pdf(path) else html_of(page).encode()
    with replacing(path) as temporary:
        temporary.write_bytes(content)


def write_sections(
    makers: Sequence[Callable[[Any], PageSection]],
    parts: Any,
    page: Page,
    path: Path,
    progress: Callable[[float, float], None] | None = None,
    file: Path | None = None,
) -> None:
    """Make the sections ``maker(parts)`` of a page, and write it.

    A section that can't be made says why. :class:`ReadingError` is raised when the page is written. `file` is that of
    the result.
    """
    report, sections, unread = progress or (lambda done, total: None), [], list[ReadingError]()
    for number, make in enumerate(makers):
        report(number, len(makers))
        name = make.__name__
        try:
            with reading(name, *({str(file)} if file is not None else ())):
                sections.append(make(parts))
        except ReadingError as error:
            unread.append(error)
            sections.append(PageSection(name, name.capitalize(), [Text(f"Not known: {error.reason}.", "missing")]))
    report(len(makers), len(makers))
    write_page(replace(page, sections=sections), path)
    if unread:
        raise unread[0]


def _is_pdf(path: Path) -> bool:
    return path.suffix.lower() == ".pdf"


FOLDER = Path(__file__).parent
"""The folder of the templates and the style sheet."""


def html_of(page: Page) -> str:
    """Return a page as HTML. All text is escaped; only the markup of pictures is written as it is."""
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(FOLDER),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        # A text is changed so that it can be printed; markup stays.
        finalize=lambda value: shown(value) if isinstance(value, str) and not hasattr(value, "__html__") else value,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    style = (FOLDER / "page.css").read_text(encoding="utf-8")
    # Strings of a style sheet: letters and digits stay; all else is escaped by its number.
    escaped = [re.sub(r"[^A-Za-z0-9 ]", lambda sign: f"\\{ord(sign[0]):06x}", shown(text)) for text in page.head]
    head = [f'"{text}"' for text in escaped]
    return environment.get_template("page.html").render(page=page, style=style, head=head) + "\n"
