"""Cells of CSV files that hold text."""

from pathlib import Path

import numpy as np
import pytest

from fastpin.assess.outputs import Curve, csv_cell, write_csv


@pytest.mark.parametrize("text", ["=1+1", "+1", "-2+3", "@SUM(1)", "\tx", "\rx"])
def test_a_text_is_no_formula(text: str, tmp_path: Path) -> None:
    assert csv_cell(text) == f"'{text}"
    write_csv([Curve({"name": text}, {"x": np.array([-1.0])})], tmp_path / "a.csv")
    with (tmp_path / "a.csv").open(newline="", encoding="utf-8") as file:
        assert f"'{text}" in file.read()


def test_numbers_and_other_texts_stay() -> None:
    assert [csv_cell(value) for value in (-1.5, None, "steel", "")] == [-1.5, None, "steel", ""]
