"""Tables of states."""

from __future__ import annotations

from fastpin.report.states import state_table
from tests.support.samples import sample_result


def test_long_tables_are_cut_in_the_middle() -> None:
    corners = [{"P": 1e6 + k} for k in range(100)]
    text = state_table(sample_result().problem, list(sample_result(corners)))
    assert len(text.splitlines()) < 60
    assert "60 more" in text
