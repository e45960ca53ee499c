"""The book of charts."""

from pathlib import Path

import pytest

from docs.beyond.chart_book import write_chart_book
from fastpin.charts.lookups import CHARTS


@pytest.mark.survey
def test_the_book_is_a_pdf_with_a_page_for_each_chart(tmp_path: Path) -> None:
    pypdf = pytest.importorskip("pypdf")
    for name in ("one.pdf", "two.pdf"):
        write_chart_book(tmp_path / name)
    pages = pypdf.PdfReader(tmp_path / "one.pdf").pages
    assert len(pages) == 1 + len(CHARTS)
    assert "largest bound" in pages[0].extract_text()
    assert (tmp_path / "one.pdf").read_bytes() == (tmp_path / "two.pdf").read_bytes()
