"""The recording of a finished run: the page with the states of a result, in one HTML file."""

from __future__ import annotations

from collections.abc import Sequence

from fastpin.errors import InputError
from fastpin.live.contact import case_document
from fastpin.live.controls import ControlScales
from fastpin.live.page import recorded_page
from fastpin.live.pictures import packed, picture
from fastpin.live.protocol import MOST_PICTURES
from fastpin.model.case import Case
from fastpin.model.checks import instance, instances, string, whole_number
from fastpin.model.history import MAX_CORNERS
from fastpin.states.state import State
from fastpin.version import __version__


def recorded_places(count: int, most: int = MOST_PICTURES) -> list[int]:
    """The places of the states that a recording shows, out of `count`: an even choice with the first and the last.

    There are at most `most` of them, and two at least.
    """
    chosen = min(whole_number("count", count, 0, MAX_CORNERS), max(whole_number("most", most, 0, MAX_CORNERS), 2))
    return [round(k * (count - 1) / max(chosen - 1, 1)) for k in range(chosen)]


def record_page(case: Case, states: Sequence[State], sentence: str = "") -> str:
    """The text of an HTML file that replays states, without server and network.

    Of more than :data:`fastpin.live.protocol.MOST_PICTURES` states an even choice is taken.

    Parameters
    ----------
    case : Case
        The case of the states.
    states : sequence of State
        In the order of the history, on one grid.
    sentence : str
        A remark above the page, such as why the run ended early.

    Raises
    ------
    InputError
        If there is no state, or an argument is of another class.
    """
    instance("case", case, Case, "a Case")
    string("sentence", sentence)
    states = instances("states", states, State, "a sequence of fastpin.State")
    if not states:
        raise InputError("states", "there is no state to record")
    chosen = [states[place] for place in recorded_places(len(states))]
    recording = {
        "version": __version__,
        "case": case_document(case.title, case.problem, ControlScales(case.problem, case.history)),
        "grids": {"0": packed(chosen[0].theta)},
        "reference": None,
        "sentence": sentence,
        "add": [picture(state, serial, state.step, "0", case.history) for serial, state in enumerate(chosen, start=1)],
    }
    return recorded_page(recording)
