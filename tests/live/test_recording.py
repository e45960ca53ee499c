"""Recordings: the page with the states of a run inside."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

import fastpin
from fastpin import casefile
from fastpin.cli.main import main
from fastpin.live import recording
from fastpin.live.page import recorded_page
from fastpin.live.protocol import MOST_PICTURES
from tests.support.live_pages import FREE, Page, contact, floats, recorded


def test_a_recording_holds_the_states_of_a_run() -> None:
    case = casefile.builtin_case()
    result = fastpin.solve(case.problem, case.history, nodes=21, between=1)
    found = recorded(recording.record_page(case, list(result)))
    assert [one["load"] for one in found["add"]] == [state.load for state in result]
    assert np.array_equal(floats(found["add"][-1]["shear"]), result[-1].shear.astype("<f4"))
    assert found["case"]["title"] == case.title


def test_a_recording_needs_no_network_and_runs_no_other_script() -> None:
    text = recorded_page(contact(nodes=21).recording())
    assert not re.search(r'(?:src|href)="(?!data:,")', text)
    nonces = set(re.findall(r'nonce="(\w+)"', text))
    assert len(nonces) == 1
    assert f"script-src 'nonce-{nonces.pop()}'; style-src" in text


def test_a_title_cannot_end_the_script() -> None:
    title = "</script><script>alert(1)</script><!--"
    case = casefile.builtin_case()
    case = fastpin.Case(case.problem, case.history, case.options, title)
    page = recording.record_page(case, [contact(nodes=21).session.state])
    assert "alert(1)</script>" not in page
    assert recorded(page)["case"]["title"] == title


@pytest.mark.gate
def test_a_recording_is_the_same_every_time() -> None:
    page = Page(contact(nodes=21))
    page.tell("load", loads={"Q": 1e5})
    assert recorded_page(page.live.recording()) == recorded_page(page.live.recording())


@pytest.mark.parametrize("count", [1, 2, 5, MOST_PICTURES, MOST_PICTURES + 1, 10 * MOST_PICTURES])
def test_of_many_states_an_even_choice_is_recorded(count: int) -> None:
    places = recording.recorded_places(count)
    assert len(places) == len(set(places)) == min(count, MOST_PICTURES)
    assert (places[0], places[-1]) == (0, count - 1)
    assert np.ptp(np.diff(places)) <= 1 if count > 2 else True


def test_nothing_to_record_is_refused() -> None:
    with pytest.raises(fastpin.InputError, match="states: there is no state to record"):
        recording.record_page(casefile.builtin_case(), [])


@pytest.mark.gate
def test_run_show_and_a_lost_run_write_recordings(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    page, other, stored = tmp_path / "page.html", tmp_path / "other.html", tmp_path / "run.h5"
    assert main(["run", "--nodes", "21", "--between", "1", "--record", str(page), "-o", str(stored)]) == 0
    assert len(recorded(page.read_text())["add"]) == 8
    assert main(["show", str(stored), "--record", str(other)]) == 0
    assert recorded(other.read_text()) == recorded(page.read_text())
    lost = tmp_path / "lost.toml"
    lost.write_text(f"{FREE}[[load]]\nM = 1e6\n[solve]\nnodes = 21\n")
    assert main(["run", str(lost), "--record", str(page)]) == 1
    found = recorded(page.read_text())
    assert len(found["add"]) == 1
    assert "the pin spins" in found["sentence"] or "nothing holds the pin" in found["sentence"]
    capsys.readouterr()
    assert main(["run", "--record", "page.pdf"]) == 2
    assert '--record: must be the name of a page, which ends in .html, not "page.pdf"' in capsys.readouterr().err


def test_the_recording_of_the_docs_has_the_present_page() -> None:
    """docs/live.md has the line that makes it anew."""
    file = Path(__file__).parents[2] / "docs" / "live-recording.html"
    text = file.read_text(encoding="utf-8")
    found = recorded(text)
    assert len(found["add"]) == 84
    assert recorded_page(found) == text
    assert file.stat().st_size < 1_000_000
