"""The content of a page: sections of text, tables and pictures, as inline SVG, or PNG where that is far smaller.

The template page.html turns it into HTML, and the template page.typ into a PDF.
"""

from __future__ import annotations

import base64
import html
import re
import tempfile
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from xml.etree import ElementTree

from fastpin.assess.outputs import Column
from fastpin.errors import OutputError, printable
from fastpin.figures.sheet import Plot
from fastpin.model.case import About

MOST_SVG = 250_000
"""Most characters of an inline SVG. Curves take some 50,000; a map of filled contours takes more as SVG than as PNG."""

WIDTH_OF_BITMAP = 340
"""Width of a bitmap on paper, points: some 120 mm."""

_LINK = re.compile(r"(?<=^#).+")
"""The id in a value of ``href``."""

_PAINT = re.compile(r"(?<=url\(#)[^)]+")
"""The id in a value of any other attribute. A colour such as #a8d8f0 is no id."""


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


class Album:
    """The figures of one page. It numbers them, and keeps the ids of their elements apart."""

    def __init__(self) -> None:
        self._count = 0

    def figure(self, plot: Plot) -> Picture:
        """Return a figure as a part of a page, with its caption."""
        return self.picture(plot.save, plot.instead, plot.caption, plot.bitmap)

    def picture(self, draw: Callable[[Path], object], words: str, caption: str, bitmap: bool = False) -> Picture:
        """Return a figure as a part of a page.

        Parameters
        ----------
        draw : callable
            ``draw(path)`` writes the figure to a file; the suffix chooses the format.
        words : str
            The text in place of the figure, for readers who can't see it.
        caption : str
        bitmap : bool
            Draw a PNG at once: the figure would be too large as SVG.

        Raises
        ------
        InputError
            As `draw`.
        OutputError
            If the directory of temporary files has no room for the figure.
        """
        try:
            markup, svg = self._drawn(draw, words, bitmap)
        except OutputError as error:
            reason = f"a figure of the page {error.reason}; set TMPDIR to another directory"
            raise OutputError(tempfile.gettempdir(), reason) from None
        self._count += 1
        return Picture(markup, caption, self._count, svg, words)

    def _drawn(self, draw: Callable[[Path], object], words: str, bitmap: bool) -> tuple[str, str]:
        """Return the markup of a figure, and its file as SVG."""
        with tempfile.TemporaryDirectory(prefix="fastpin-") as folder:
            path = Path(folder) / "figure.svg"
            if not bitmap:
                draw(path)
                text = path.read_text(encoding="utf-8")
                if len(text) <= MOST_SVG:
                    markup = _svg(text, words, f"f{self._count + 1}-")
                    # As a file the element needs the names, the size and the style that it lacks.
                    width, height = re.findall(r'viewBox="0 0 ([\d.]+) ([\d.]+)"', markup)[0]
                    size = f'width="{width}pt" height="{height}pt" stroke-linejoin="round" stroke-linecap="butt"'
                    return markup, markup.replace("<svg ", f'<svg xmlns="http://www.w3.org/2000/svg" {size} ', 1)
            path = path.with_suffix(".png")
            draw(path)
            return _png(path.read_bytes(), words)


def _png(content: bytes, words: str) -> tuple[str, str]:
    """Return a PNG as an element ``img``, and inside an SVG of its size on paper."""
    data = f"data:image/png;base64,{base64.b64encode(content).decode('ascii')}"
    width, height = (int.from_bytes(content[k : k + 4]) for k in (16, 20))
    high = WIDTH_OF_BITMAP * height / width
    svg = (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{WIDTH_OF_BITMAP}pt" height="{high:.2f}pt" '
        f'viewBox="0 0 {width} {height}">'
        f'<image href="{data}" width="{width}" height="{height}"/></svg>'
    )
    return f'<img alt="{html.escape(words)}" src="{data}">', svg


def _svg(text: str, words: str, prefix: str) -> str:
    """Return the element ``svg`` of a file for an HTML page, with ids that begin with `prefix`.

    Only ids that are referred to are kept. Namespaces are left out: HTML knows the element.
    """
    root = ElementTree.fromstring(text)
    for element in root.iter():
        element.tag = _local(element.tag)
        element.attrib = {_local(name): value for name, value in element.attrib.items()}
        for child in list(element):
            if _local(child.tag) in ("metadata", "style"):  # Matplotlib's style sheet would hold for the whole page
                element.remove(child)
    root.attrib = {name: value for name, value in root.attrib.items() if name not in ("width", "height", "version")}
    width = root.attrib["viewBox"].split()[2]  # in points; the style sheet makes the element as wide
    root.attrib |= {"role": "img", "aria-label": words, "style": f"--width: {width}"}
    used: dict[str, str] = {}  # ids that are referred to, and their new names
    for element in root.iter():
        for name, value in element.attrib.items():
            for found in (_LINK if name == "href" else _PAINT).findall(value):
                used.setdefault(found, f"{prefix}{len(used) + 1}")
    for element in root.iter():
        identity = element.attrib.pop("id", None)
        for name, value in element.attrib.items():
            element.set(name, (_LINK if name == "href" else _PAINT).sub(lambda found: used[found[0]], value))
        if identity in used:
            element.set("id", used[identity])
    return ElementTree.tostring(root, encoding="unicode")


def _local(name: str) -> str:
    """Return a name of XML without its namespace."""
    return name.rpartition("}")[2]
