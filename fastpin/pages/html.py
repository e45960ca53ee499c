"""The HTML of a page, and its file."""

from __future__ import annotations

from pathlib import Path

import jinja2

from fastpin.errors import InputError, printable
from fastpin.model.checks import as_toml, file_path
from fastpin.pages.content import Page
from fastpin.storage.files import check_writable, replacing

SUFFIXES = (".html", ".htm")
"""Endings of the name of a page."""

FOLDER = Path(__file__).parent
"""The folder of the template and the style sheet."""


def check_page(field: str, path: str | Path) -> Path:
    """Return the path of a page to be written.

    Raises
    ------
    InputError
        With `field`, if the name does not end as a page's. Also if the file can't be written.
    """
    found = file_path(field, path)
    if found.suffix.lower() not in SUFFIXES:
        raise InputError(
            field, f"must be the name of a page, which ends in {' or '.join(SUFFIXES)}, not {as_toml(found.name)}"
        )
    check_writable(found)
    return found


def _shown(value: object) -> object:
    """Return a text of a page with escapes for the characters that can't be printed. Lines and tabs stay."""
    if not isinstance(value, str) or hasattr(value, "__html__"):
        return value
    return "\n".join("\t".join(map(printable, line.split("\t"))) for line in value.split("\n"))


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
    return environment.get_template("page.html").render(page=page, style=style) + "\n"


def write_page(page: Page, path: Path) -> None:
    """Write a page, whole or not at all.

    Raises
    ------
    InputError
        If the file can't be written.
    """
    text = html_of(page)
    with replacing(path) as temporary:
        temporary.write_text(text, encoding="utf-8")
