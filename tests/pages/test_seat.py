"""The report of a joint whose bush slips: a section on its seat, and margins by its slip."""

from pathlib import Path

import pypdf
import pytest

from fastpin.pages import write_report
from fastpin.report.states import seat_lines
from fastpin.states.extremes import KeptStates, marked_extremes, marked_places
from tests.support.html import Page
from tests.support.seats import sample_seat, stored_sample


def sentence() -> str:
    """The sentence on the seat, as the page has it."""
    result = sample_seat()
    places = marked_places(marked_extremes(KeptStates(result.states)))
    line, _ = seat_lines(result.problem, [result[place] for place in places], result[-1], result[-4:])
    return f"{line[0].upper()}{line[1:]}."


@pytest.mark.survey
def test_the_page_has_a_section_on_the_seat(tmp_path: Path) -> None:
    pages = []
    for source, name in ((sample_seat(), "memory.html"), (stored_sample(tmp_path / "joint.h5"), "stored.html")):
        write_report(source, tmp_path / name)
        page = Page((tmp_path / name).read_text(encoding="utf-8"))
        assert [found["id"] for tag, found in page.attributes if tag == "section"].count("seat") == 1
        words = page.text[page.text.rindex("Seat of the bush") : page.text.rindex("Hysteresis and slip")]
        assert sentence() in words
        for part in ("Figure", "States of the seat", "All quantities, by load point", "rotation of the pin"):
            assert part in words
        assert "no limit of the slip is known" in page.text
        assert "would slip" not in page.text
        pages.append(words)
    assert pages[0] == pages[1]


@pytest.mark.gate
def test_the_pdf_has_it_too(tmp_path: Path) -> None:
    sample_seat().report(tmp_path / "joint.pdf")
    outline = pypdf.PdfReader(tmp_path / "joint.pdf").outline
    assert "9. Seat of the bush" in [str(entry.title) for entry in outline if not isinstance(entry, list)]
