"""The HTML of a page."""

from __future__ import annotations

import re
from pathlib import Path

import jinja2

from fastpin.pages.content import Page, shown

FOLDER = Path(__file__).parent
"""The folder of the templates and the style sheet."""


def _shown(value: object) -> object:
    """Return a text of a page as it can be printed. Markup stays."""
    return shown(value) if isinstance(value, str) and not hasattr(value, "__html__") else value


def _in_style(text: str) -> str:
    """Return a text as a string of a style sheet. Letters and digits stay; all else is escaped by its number."""
    return '"' + re.sub(r"[^A-Za-z0-9 ]", lambda found: f"\\{ord(found[0]):06x}", shown(text)) + '"'


def html_of(page: Page) -> str:
    """Return a page as HTML. All text is escaped; only the markup of pictures is written as it is."""
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(FOLDER),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        finalize=_shown,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    style = (FOLDER / "page.css").read_text(encoding="utf-8")
    head = [_in_style(text) for text in page.head]
    return environment.get_template("page.html").render(page=page, style=style, head=head) + "\n"
