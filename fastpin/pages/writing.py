"""The file of a page: HTML or PDF, by the ending of its name."""

from __future__ import annotations

from pathlib import Path

from fastpin.errors import InputError
from fastpin.model.checks import as_toml, file_path
from fastpin.pages.content import Page
from fastpin.pages.html import html_of
from fastpin.pages.pdf import check_typst, pdf_of
from fastpin.storage.files import check_writable, replacing


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
        raise InputError(
            field, f"must be the name of a page, which ends in .html, .htm or .pdf, not {as_toml(found.name)}"
        )
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


def _is_pdf(path: Path) -> bool:
    return path.suffix.lower() == ".pdf"
