"""The HTML of a page."""

from __future__ import annotations

import re
from pathlib import Path

import jinja2

from fastpin.pages.content import Page, shown

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
