"""The parts of an HTML page, for tests of pages."""

from html.parser import HTMLParser
from pathlib import Path
from typing import Any

from fastpin.joints import JointResult
from fastpin.pages import write_report
from fastpin.solver.result import Result
from fastpin.wear_lives.wear_result import WearResult

VOID = ("meta", "link", "br", "img", "hr", "input")
"""Elements of HTML without an end tag."""


class Page(HTMLParser):
    """A page that is well formed: an element that is not closed, or closed twice, is an AssertionError.

    Attributes
    ----------
    ids, tags, links, sources : list of str
        Ids, names of elements, values of ``href``, and values of ``src``.
    attributes : list of (str, dict)
        Name and attributes of each element.
    text : str
        All text, without the style sheet.
    """

    def __init__(self, text: str) -> None:
        super().__init__()
        self.ids: list[str] = []
        self.tags: list[str] = []
        self.links: list[str] = []
        self.sources: list[str] = []
        self.attributes: list[tuple[str, dict[str, str]]] = []
        self.text = ""
        self._open: list[str] = []
        self.feed(text)
        self.close()
        assert self._open == []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.handle_startendtag(tag, attrs)
        if tag not in VOID:
            self._open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        found = {name: value or "" for name, value in attrs}
        self.tags.append(tag)
        self.attributes.append((tag, found))
        self.ids += [found["id"]] if "id" in found else []
        self.links += [found["href"]] if "href" in found else []
        self.sources += [found["src"]] if "src" in found else []

    def handle_endtag(self, tag: str) -> None:
        assert self._open.pop() == tag

    def handle_data(self, data: str) -> None:
        if self._open[-1:] != ["style"]:
            self.text += data


def words_of(source: Result | WearResult | JointResult | Path, path: Path, **options: Any) -> str:
    """Write the page of a result or a life of wear, and return its words."""
    write_report(source, path, **options)
    return Page(path.read_text(encoding="utf-8")).text
