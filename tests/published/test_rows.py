"""Rows of benchmarks: their verdicts, and the words for them."""

import math

import pytest

from fastpin.assess.outputs import document
from fastpin.published import records
from fastpin.published.records import AGREES, Row
from fastpin.report.schema import BENCHMARK_ROW


@pytest.mark.parametrize(
    ("published", "ours", "last_digit", "agrees"),
    [
        ("0.87", 0.8799, None, True),
        ("0.87", 0.8801, None, False),
        ("0.87", 0.8600, None, True),
        ("60", 59.1, None, True),
        ("60", 58.9, None, False),
        ("3.0000", 3.0001, None, True),
        ("3.0000", 2.9998, None, False),
        ("178.13", 178.40, None, False),
        ("178.13", 178.40, 0.3125, True),
        ("178.13", 178.45, 0.3125, False),
    ],
)
def test_a_number_agrees_within_one_unit_of_the_last_digit(
    published: str, ours: float, last_digit: float | None, agrees: bool
) -> None:
    row = Row("q", "", published, ours, "differs: because", last_digit)
    assert row.agrees is agrees
    assert row.verdict == (AGREES if agrees else "differs: because")
    assert row.difference == pytest.approx(ours - float(published))


def test_a_number_that_nobody_printed_is_compared_with_nothing() -> None:
    row = Row("q", "MPa", "", 105.352, "comparison only")
    assert row.difference is None
    assert not row.agrees
    assert row.verdict == "comparison only"
    assert "-   105.35" in records.table("T", "words", [], [row]).splitlines()[-1]


def test_the_table_prints_one_digit_more_than_its_source() -> None:
    lines = records.table("Title", "A statement.", ["a book"], [Row("q", "bar", "178.13", 181.5768)]).splitlines()
    assert lines[:3] == ["Title", "  A statement.", "  source: a book"]
    assert lines[3].split() == ["quantity", "unit", "published", "fastpin", "difference", "verdict"]
    assert lines[4].split() == ["q", "bar", "178.13", "181.577", "+3.447", "differs"]


def test_rows_become_lines_of_a_csv_file_and_of_json() -> None:
    rows = [Row("q", "bar", "178.13", 178.0), Row("r", "", "", 2.0, "comparison only")]
    one, two = records.row_curves(rows)
    assert one.parameters == {"quantity": "q", "unit": "bar", "published": "178.13", "verdict": "differs"}
    assert one["difference"][0] == pytest.approx(-0.13)
    assert math.isnan(two["difference"][0])
    assert document(BENCHMARK_ROW, rows[1], {}) == {
        "quantity": "r", "unit": "", "published": None, "fastpin": 2.0, "difference": None, "agrees": False,
        "verdict": "comparison only",
    }  # fmt: skip
