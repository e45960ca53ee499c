"""The PDF of a report: its pages, its head, its fonts, and what it refuses."""

import importlib.util
import io
import re
from pathlib import Path
from typing import Any

import numpy as np
import pypdf
import pytest
import typst
from matplotlib import image

import fastpin
from fastpin.errors import InputError
from fastpin.model import About
from fastpin.pages import write_report
from fastpin.pages.content import Facts, Items, Listing, Page, PageSection, Table, Text
from fastpin.pages.sections import SECTIONS
from fastpin.pages.writing import pdf_of
from tests.support.drawing import outline_figures
from tests.support.samples import sample_result
from tests.support.tiers import for_gate

HOSTILE = 'A <b> #[x] $y$ @z `w` "q" \\ // */ é'
"""A text with all that is markup somewhere."""

ABOUT = About("Hinge 4711", "A. Engineer", "B", "2026-03-31")


def read(path: Path) -> tuple[list[str], pypdf.PdfReader]:
    """The texts of the pages of a PDF without line ends, and the PDF."""
    pdf = pypdf.PdfReader(path)
    return [" ".join(page.extract_text().split()) for page in pdf.pages], pdf


@pytest.fixture(scope="module")
@for_gate
def compiled(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, list[bytes]]:
    """A report, and a small picture of each of its pages with a dot for each mm."""
    path, pictures = tmp_path_factory.mktemp("pdf") / "r.pdf", []

    def compile_twice(*arguments: Any, **options: Any) -> bytes:
        pictures.extend(once(*arguments, **options, format="png", ppi=25.4))
        return once(*arguments, **options)

    with pytest.MonkeyPatch.context() as patch:
        once = typst.compile
        patch.setattr(typst, "compile", compile_twice)
        outline_figures(patch)
        sample_result().report(path, title=HOSTILE, about=ABOUT)
    return path, pictures


@pytest.fixture(scope="module")
def report(compiled: tuple[Path, list[bytes]]) -> tuple[list[str], pypdf.PdfReader]:
    return read(compiled[0])


def test_pages_are_numbered_and_have_a_head(report: tuple[list[str], pypdf.PdfReader]) -> None:
    texts, pdf = report
    assert len(texts) > 3
    for number, text in enumerate(texts, 1):
        assert f"page {number} of {len(texts)}" in text
        assert f"Hinge 4711 · {HOSTILE}" in text
        assert "Revision B · 2026-03-31 · A. Engineer" in text
    for name, value in ABOUT.given().items():
        assert f"{name.capitalize()} {value}" in texts[0]
    assert (pdf.metadata.title, pdf.metadata.author) == (HOSTILE, "A. Engineer")


@pytest.mark.gate
def test_no_figure_stands_above_the_title(tmp_path: Path) -> None:
    sample_result([{"P": 1e6}], nodes=21).report(tmp_path / "r.pdf", title="Bolt")
    found: list[tuple[str, float]] = []
    first = read(tmp_path / "r.pdf")[1].pages[0]
    text = first.extract_text(visitor_text=lambda text, user, *_: found.append((text.strip(), user[5])))
    assert "the only corner of the load history was followed" in " ".join(text.split())
    _, title = (height for text, height in found if text == "Bolt")  # the first one is the head of the page
    captions = [height for text, height in found if text.endswith("their ranges over the history.")]
    assert all(height < title for height in captions)
    texts, _ = read(tmp_path / "r.pdf")
    assert sum("their ranges over the history." in text for text in texts) == 1


def test_sections_stand_on_the_pages_that_the_contents_and_the_outline_name(report):
    texts, pdf = report
    outline = [entry for entry in pdf.outline if not isinstance(entry, list)]
    assert len(outline) == len(SECTIONS) - 4  # no seat and no questions
    for number, entry in enumerate(outline, 1):
        page = pdf.get_destination_page_number(entry) + 1
        title = str(entry.title).removeprefix(f"{number}. ")
        assert re.search(rf"{number}\. {title}[ .]+{page}\b", texts[0]), title
        assert f"{number}. {title}" in texts[page - 1]


def test_figures_stand_where_the_text_says(report: tuple[list[str], pypdf.PdfReader]) -> None:
    texts, _ = report
    said = re.findall(r"Figure (\d+) stands on page (\d+)\.", " ".join(texts))
    assert len(said) > 4
    for number, page in said:
        assert re.search(rf"Figure {number}\. [A-Z]", texts[int(page) - 1])


def test_no_page_but_the_last_is_half_empty(compiled: tuple[Path, list[bytes]]) -> None:
    """On every other page text or a figure reaches into the lowest third."""
    _, pictures = compiled
    assert len(pictures) > 3
    for picture in pictures[:-1]:
        rows = image.imread(io.BytesIO(picture))[:, :, :3].min(axis=(1, 2)) < 0.8
        assert rows.size == 297
        assert np.flatnonzero(rows[:276])[-1] > 198  # the foot stands below 278 mm


def test_fonts_are_inside(report: tuple[list[str], pypdf.PdfReader]) -> None:
    _, pdf = report
    fonts = {}
    for page in pdf.pages:
        for font in page["/Resources"].get("/Font", {}).values():  # type: ignore[attr-defined]
            (inner,) = font["/DescendantFonts"]
            fonts[str(font["/BaseFont"])] = inner.get_object()["/FontDescriptor"]
    assert {name.partition("+")[2] for name in fonts} >= {"DejaVuSans", "DejaVuSans-Bold"}
    assert all("/FontFile2" in font or "/FontFile3" in font for font in fonts.values())


def test_every_kind_of_part_is_printed(tmp_path: Path) -> None:
    table = Table("numbers", [("name", "", ["a", "b"]), ("value", "m", ["1.5 +-2", "3"])], {1: "7 more", 2: "9 more"})
    parts = [
        Text(f"words {HOSTILE}"), Text("a note", "note"), Items([f"item {HOSTILE}"]),
        Facts("facts", [(HOSTILE, "x"), ("y" * 200, "z")], ("subject", "in words")), Facts("no facts", []), table,
        Table("no numbers", [("name", "", [])]), Text("\u8bf7 \u0628 \U0001f600 \u2028"), Items([]),
        Listing("file", f"line {HOSTILE}\n\ttab\x1b[31m"), Listing("empty", ""),
    ]  # fmt: skip
    path = tmp_path / "p.pdf"
    path.write_bytes(pdf_of(Page("title", "lead", [PageSection("one", "One", parts)], "made today")))
    (text,), _ = read(path)
    assert text.count(HOSTILE) == 4
    assert all(words in text for words in ("a note", "1.5 ± 2", "… 7 more …", "… 9 more …", "made today", "\\x1b[31m"))


@pytest.mark.gate
def test_a_long_history_has_a_short_report(tmp_path: Path) -> None:
    problem = sample_result().problem
    many = fastpin.solve(problem, [{"P": 1e6}, *({"Q": 1e5 * (-1) ** k * (1 + k % 7)} for k in range(70))], nodes=31)
    many.report(tmp_path / "many.pdf")
    texts, _ = read(tmp_path / "many.pdf")
    assert len(texts) <= 10
    assert "71 states are kept" in texts[0]
    assert re.search(r"… \d+ more …", " ".join(texts))


def test_without_the_package_one_sentence_says_what_to_install(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    with pytest.raises(InputError, match=r"path: a PDF needs the package typst: pip install 'fastpin\[pdf\]'"):
        write_report(sample_result(), tmp_path / "r.pdf")
    assert list(tmp_path.iterdir()) == []
