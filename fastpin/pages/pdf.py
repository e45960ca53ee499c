"""The PDF of a page, made by Typst from the template page.typ. Only this file imports typst."""

from __future__ import annotations

import importlib.util
import json
from dataclasses import asdict
from typing import Any

from fastpin.errors import InputError
from fastpin.figures.style import FONTS
from fastpin.pages.content import Page, SectionPart, Table, shown
from fastpin.pages.html import FOLDER


def check_typst(field: str) -> None:
    """Raise :class:`InputError` if the package typst is missing."""
    if importlib.util.find_spec("typst") is None:
        raise InputError(field, "a PDF needs the package typst: pip install 'fastpin[pdf]'")


def pdf_of(page: Page) -> bytes:
    """Return a page as a PDF for A4 paper. Its fonts are inside it."""
    import typst

    given = {"page": json.dumps(_plain(_document(page)))}
    template, folder = str(FOLDER / "page.typ"), str(FOLDER)
    return bytes(typst.compile(template, root=folder, font_paths=[str(FONTS)], sys_inputs=given))


def _document(page: Page) -> dict[str, Any]:
    """Return a page as the template takes it."""
    sections = [{"title": each.title, "parts": [_part(part) for part in each.parts]} for each in page.sections]
    about = [[name.capitalize(), value] for name, value in page.about.given().items()]
    return {
        "title": page.title,
        "lead": page.lead,
        "head": page.head,
        "about": about,
        "author": page.about.author,
        "made": page.made,
        "sections": sections,
    }


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
