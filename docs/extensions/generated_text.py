"""Parts of pages that are generated from the package, or taken from files at the top level of the project.

A page has a line ``<!-- insert: NAME ARGUMENTS -->``. The function of that name in :data:`PARTS` returns the Markdown
that takes its place. Headings of the text work as if they stood in the page.
"""

from __future__ import annotations

import os
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

from command_line import command_line
from file_keys import case_keys, materials, plan_fields, plan_outcomes, quantities
from file_layout import file_layout, wear_layout

ROOT = Path(__file__).resolve().parents[2]
MARK = re.compile(r"^<!-- insert: (\w+)(?: (.+?))? -->$", re.MULTILINE)


def file_text(name: str) -> str:
    """The text of a file at the top level."""
    return (ROOT / name).read_text(encoding="utf-8")


def section(arguments: str) -> str:
    """One section of a Markdown file at the top level, without its heading: the file, then the heading."""
    name, heading = arguments.split(" ", 1)
    (found,) = re.findall(rf"^## {re.escape(heading)}\n(.*?)(?=^## |\Z)", file_text(name), re.DOTALL | re.MULTILINE)
    return str(found)


def folder(name: str) -> str:
    """A hidden list of contents: the pages of a folder of docs/, in the order of the links of its index."""
    index = (ROOT / "docs" / name / "index.md").read_text(encoding="utf-8")
    return "\n".join(["```{toctree}", ":hidden:", "", *re.findall(r"\]\(([\w-]+)\.md\)", index), "```"])


PARTS: dict[str, Callable[..., str]] = {
    "file": file_text,
    "section": section,
    "folder": folder,
    "case_keys": case_keys,
    "command_line": command_line,
    "file_layout": file_layout,
    "materials": materials,
    "plan_fields": plan_fields,
    "plan_outcomes": plan_outcomes,
    "quantities": quantities,
    "wear_layout": wear_layout,
}
"""Names of generated texts, and the functions that return them."""


PAGES = {
    "README.md": "docs/index.md",
    "CONTRIBUTING.md": "docs/project/contributing.md",
    "CHANGELOG.md": "docs/project/changelog.md",
    "SECURITY.md": "docs/project/security.md",
}
"""Files at the top level, and the pages of the site that show them."""

LINK = re.compile(r"\]\((?![a-z]+:|#)([^)\s#]+)")
"""The beginning of a link to a file."""


def insert(app: Any, page: str, source: list[str]) -> None:
    """Replace the marks of a page by their texts, and make its links those of the site."""
    folder = Path("docs", page).parent
    if not (ROOT / "docs" / f"{page}.md").exists():  # a page of the gallery
        return

    def seen_from_page(target: str) -> str:
        return f"]({os.path.relpath(PAGES.get(target, target), folder)}"

    def inserted(mark: re.Match[str]) -> str:
        """A text whose links start at the top level."""
        return LINK.sub(lambda link: seen_from_page(link[1]), PARTS[mark[1]](*filter(None, [mark[2]])))

    def mapped(link: re.Match[str]) -> str:
        """A link of the page. Links to files at the top level lead to their pages."""
        target = os.path.normpath(folder / link[1])
        return seen_from_page(target) if target in PAGES else link[0]

    source[0] = polished(LINK.sub(mapped, MARK.sub(inserted, source[0])))


def polished(text: str) -> str:
    """The text as the site shows it: links have the titles of pages, and numbers of equations stand at the right."""
    text = re.sub(r"\[(?:docs/)?[\w/-]+\.md\](\([^)\s]+\.md(?:#[\w-]+)?\))", r"[]\1", text)
    return re.sub(r"^```math\n.*?^```$", lambda found: _numbered(found[0]), text, flags=re.DOTALL | re.MULTILINE)


def _numbered(formula: str) -> str:
    """A formula with its number, such as (T1), as a tag. Formulas of several lines keep it in the last line."""
    if "\\\\" in formula:
        return formula
    return re.sub(r"\s*\\qquad\s*\\text\{\((\w+)\)\}\s*(?=```$)", r" \\tag{\1}\n", formula)


def setup(app: Any) -> dict[str, Any]:
    app.connect("source-read", insert)
    return {"parallel_read_safe": True}
