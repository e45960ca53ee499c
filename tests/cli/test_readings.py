"""A quantity that can't be read from the states hides nothing else: not the states, nor other quantities."""

import json
from pathlib import Path

import pytest

import fastpin
from fastpin import storage
from fastpin.errors import ReadingError
from fastpin.states import extremes, quantities
from fastpin.states.extremes import READINGS
from tests.support.commands import said

CASE = """
[pin]
material = "steel"
[plate]
material = "7075-T6"
[contact]
hole_radius = 0.01
clearance = 2e-5
friction = 0.4
[[load]]
P = [1e6, 2e6]
[solve]
nodes = 31
"""
WORDS = "peak_hoop: can't be read: ValueError: no such luck"


@pytest.fixture
def broken(monkeypatch: pytest.MonkeyPatch) -> None:
    def fails(state: object) -> float:
        raise ValueError("no such luck")

    entry = READINGS["peak_hoop"]._replace(of=fails)
    monkeypatch.setitem(READINGS, "peak_hoop", entry)
    monkeypatch.setitem(quantities.QUANTITIES, "peak_hoop", entry)


@pytest.mark.gate
@pytest.mark.usefixtures("undrawn")
def test_run_and_show_print_the_states_and_name_the_reading(case, monkeypatch, request):
    whole = said("run", case, "-o", "whole.h5").out
    request.getfixturevalue("broken")
    found = [said("run", case, code=3), said("run", case, "-o", "a.h5", code=3), said("show", "whole.h5", code=3)]
    for each in found:
        assert each.err.count(WORDS) == 1
        assert each.out.splitlines()[:4] == whole.splitlines()[:4]  # the table
        assert "margins of safety" in each.out
    document = json.loads(said("show", "whole.h5", "--json", "-", code=3).out)
    assert document["unread"] == {"peak_hoop": "can't be read: ValueError: no such luck"}
    assert {state["peak_hoop"] for state in document["states"]} == {None}
    assert all(state["peak_pressure"] > 0.0 for state in document["states"])
    said("report", "whole.h5", "-o", "page.html", code=3)
    assert "Not known: can" in Path("page.html").read_text()
    with pytest.raises(ReadingError, match="peak_hoop: can't be read"):
        fastpin.load("whole.h5").extremes()
    assert set(storage.StoredResult("whole.h5").extremes.unread) == {"peak_hoop"}


def test_a_run_ends_with_its_states_where_no_stress_can_be_read(case, monkeypatch):
    monkeypatch.setattr(extremes, "von_mises_peak", lambda *given, **more: 1 / 0)
    given = fastpin.read_case(case)
    with pytest.warns(fastpin.errors.InputWarning, match="von_mises_plate: can't be read: ZeroDivisionError"):
        result = fastpin.solve(given.problem, given.history, nodes=31)
    assert result.complete
