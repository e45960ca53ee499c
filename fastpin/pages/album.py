"""Figures as parts of a page: inline SVG, or PNG where that is smaller by far."""

from __future__ import annotations

import base64
import html
import re
import tempfile
from collections.abc import Callable
from pathlib import Path
from xml.etree import ElementTree

from fastpin.errors import OutputError
from fastpin.figures.sheet import Plot
from fastpin.pages.content import Picture

MOST_SVG = 250_000
"""Most characters of an inline SVG. Curves take some 50,000; a map of filled contours takes more as SVG than as PNG."""

WIDTH_OF_BITMAP = 340
"""Width of a bitmap on paper, points: some 120 mm."""

_LINK = re.compile(r"(?<=^#).+")
"""The id in a value of ``href``."""

_PAINT = re.compile(r"(?<=url\(#)[^)]+")
"""The id in a value of any other attribute. A colour such as #a8d8f0 is no id."""


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
