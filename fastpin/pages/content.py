"""The content of a page: sections of text, tables and pictures.

The template page.html turns it into HTML, and the template page.typ into a PDF.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from fastpin.assess.table import Column
from fastpin.errors import printable
from fastpin.model.case import About


def shown(text: str) -> str:
    """Return a text with escapes for the characters that can't be printed. Lines and tabs stay."""
    return "\n".join("\t".join(map(printable, line.split("\t"))) for line in text.split("\n"))


@dataclass(frozen=True)
class Text:
    """A paragraph.

    Attributes
    ----------
    words : str
    tone : str
        "plain"; "note" for what a reader must know; "missing" for what the result does not hold, and how to get it.
    """

    words: str
    tone: str = "plain"
    kind: str = field(default="text", init=False)


@dataclass(frozen=True)
class Items:
    """A list of sentences."""

    sentences: Sequence[str]
    kind: str = field(default="items", init=False)


@dataclass(frozen=True)
class Facts:
    """A table of names and values.

    Attributes
    ----------
    caption : str
    rows : sequence of (str, str) or (str, str, str)
        Name, value, and perhaps a remark.
    heads : sequence of str
        The headings of the columns.
    tall : bool
        Whether the rows leave room to write.
    """

    caption: str
    rows: Sequence[tuple[str, ...]]
    heads: Sequence[str] = ("", "")
    tall: bool = False
    kind: str = field(default="facts", init=False)


@dataclass(frozen=True)
class Table:
    """A table of columns. The first column names the rows.

    Attributes
    ----------
    caption : str
    columns : sequence of Column
    gaps : mapping of int to str
        Words on rows that are left out before a row, by the place of that row.
    """

    caption: str
    columns: Sequence[Column]
    gaps: Mapping[int, str] = field(default_factory=dict)
    kind: str = field(default="table", init=False)

    @property
    def rows(self) -> list[list[str]]:
        """The cells, row by row. Error bars stand behind the sign that a page can show."""
        rows = zip(*(cells for _, _, cells in self.columns), strict=True)
        return [[re.sub(r" \+-(?=[\d?])", " ± ", cell) for cell in row] for row in rows]

    @property
    def sides(self) -> list[str]:
        """The side to which the cells of each column are aligned: "right" for a column with numbers, else "left"."""
        return [
            "right" if any(re.match(r"[-+]?\d", cell) for cell in cells) else "left" for _, _, cells in self.columns
        ]


@dataclass(frozen=True)
class Picture:
    """A figure inside the page.

    Attributes
    ----------
    markup : str
        An ``svg`` element, or an ``img`` element with its data. It is written to an HTML page as it is.
    caption : str
    number : int
        From 1.
    svg : str
        The file of the figure, SVG, for a PDF.
    words : str
        The text in place of the figure, for readers who can't see it.
    """

    markup: str
    caption: str
    number: int
    svg: str = ""
    words: str = ""
    kind: str = field(default="picture", init=False)


@dataclass(frozen=True)
class Listing:
    """A text file. On the screen it scrolls.

    Attributes
    ----------
    caption : str
    text : str
    """

    caption: str
    text: str
    kind: str = field(default="listing", init=False)


SectionPart = Text | Items | Facts | Table | Picture | Listing
"""A part of a section."""


@dataclass(frozen=True)
class PageSection:
    """A section with a heading and an entry in the contents.

    Attributes
    ----------
    name : str
        The section's id: letters and hyphens.
    title : str
    parts : sequence of Part
    """

    name: str
    title: str
    parts: Sequence[SectionPart]


@dataclass(frozen=True)
class Page:
    """A page.

    Attributes
    ----------
    title : str
    lead : str
        One sentence below the title.
    sections : sequence of Section
    made : str
        When and by which version the page was made.
    about : About
        Project, author, revision and date.
    """

    title: str
    lead: str
    sections: Sequence[PageSection]
    made: str
    about: About = field(default_factory=About)

    @property
    def head(self) -> tuple[str, str]:
        """The head of each page of paper: project and title on the left; revision, date and author on the right."""
        given = self.about.given()
        if "revision" in given:
            given["revision"] = f"Revision {given['revision']}"
        left, right = ("project",), ("revision", "date", "author")
        project, others = ([given[name] for name in names if name in given] for names in (left, right))
        return " · ".join([*project, self.title]), " · ".join(others)
