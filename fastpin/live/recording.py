"""Recordings in one HTML file: of the states of a finished run or joint, and of a life of wear with its cycles."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from typing import Any

import numpy as np

from fastpin.assess.outputs import json_ready
from fastpin.assess.wear import DEBRIS, damages
from fastpin.damage import WornFatigue
from fastpin.errors import InputError
from fastpin.joints import JointFile, JointResult
from fastpin.live.controls import ControlScales
from fastpin.live.joint import JointPictures, most_steps
from fastpin.live.page import recorded_page
from fastpin.live.pictures import packed, picture
from fastpin.live.pin import case_document
from fastpin.live.protocol import MOST_PICTURES
from fastpin.model import Grid, angles, points
from fastpin.model.assessment import FatigueAssessment
from fastpin.model.case import Case
from fastpin.model.checks import instance, instances, string, whole_number
from fastpin.model.history import MAX_CORNERS
from fastpin.states.state import State
from fastpin.version import __version__
from fastpin.wear_lives.wear_result import WearResult, WornCycle


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
    pictures = [picture(state, serial, state.step, "0", case.history) for serial, state in enumerate(chosen, start=1)]
    document = case_document(case.title, case.problem, ControlScales(case.problem, case.history))
    return _recorded(document, chosen[0].theta, sentence, pictures)


def record_joint_page(file: JointFile, result: JointResult, sentence: str = "") -> str:
    """The text of an HTML file that replays the states of a joint, without server and network.

    Of more than :data:`fastpin.live.protocol.MOST_OF_HOLES` pictures of holes an even choice of the states is taken.

    Parameters
    ----------
    file : JointFile
        That of the result.
    result : JointResult
        In memory or from a file.
    sentence : str
        A remark above the page, such as why the history ended early.

    Raises
    ------
    InputError
        If there is no state, or an argument is of another class.
    """
    instance("file", file, JointFile, "a JointFile")
    instance("result", result, JointResult, "a JointResult")
    string("sentence", sentence)
    if not len(result):
        raise InputError("result", "there is no state to record")
    of, states = JointPictures(file), (result[at] for at in recorded_places(len(result), most_steps(file.joint)))
    pictures = [of.picture(state, serial, state.step, lambda grid: "0") for serial, state in enumerate(states, start=1)]
    theta = Grid.circle(result.nodes, angles.BOTTOM).theta
    return _recorded(of.document(result.nodes), theta, sentence, pictures)


def record_life(
    result: WearResult, title: str = "", sentence: str = "", fatigue: FatigueAssessment | None = None
) -> str:
    """The text of an HTML file that shows a life of wear, without server and network.

    A slider moves through the stored cycles. If their states are more than
    :data:`fastpin.live.protocol.MOST_PICTURES`, an even choice of the cycles is taken. A body with constants for a life
    has its damage too.

    Parameters
    ----------
    result : WearResult
    title : str
    sentence : str
        A remark above the page, such as why the life ended early.
    fatigue : FatigueAssessment, optional
        Criteria and bodies of the damage; Smith, Watson and Topper's of all bodies unless given.

    Raises
    ------
    InputError
        If there is no stored cycle, or an argument is of another class.
    """
    instance("result", result, WearResult, "a fastpin.wear_lives.WearResult")
    string("title", title)
    string("sentence", sentence)
    if fatigue is not None:
        instance("fatigue", fatigue, FatigueAssessment, "a FatigueAssessment")
    if not len(result):
        raise InputError("result", "there is no stored cycle to record")
    places = recorded_places(len(result), MOST_PICTURES // len(result[0].states))
    document = case_document(title, result.problem, ControlScales(result.problem, result.history))
    document |= {"doubts": [*document["doubts"], *map(str, result.doubts)]}
    return _recorded(document, result.theta, sentence, [], life=_life(result, places, fatigue))


def _recorded(
    case: dict[str, Any], theta: np.ndarray, sentence: str, pictures: Sequence[dict[str, Any]], **life: Any
) -> str:
    """The page with a case, its nodes, a remark, and pictures of states or a `life`."""
    grids = {"0": packed(theta)}
    recording = {"version": __version__, "case": case, "grids": grids, "reference": None, "sentence": sentence}
    return recorded_page({**recording, "add": pictures, **life})


def _life(result: WearResult, places: list[int], fatigue: FatigueAssessment | None) -> dict[str, Any]:
    """The chosen cycles of a life as the page needs them: pictures, worn depths, numbers and damage."""
    cycles, history, serial = [result[place] for place in places], result.history, itertools.count(1)
    several = fatigue is not None and len(fatigue.criteria) > 1
    of_owners = {
        points.edge_body(found.problem, found.body) + f", {found.criterion}" * several: found
        for found in damages(result, fatigue)
        if found.body != "seat"  # it does not wear
    }
    quantities = {
        "worn volume": ("work per stress", [each.volume for each in cycles]),
        "largest depth": ("displacement", [each.depth for each in cycles]),
        "dissipated in a cycle": ("energy", [each.energy_per_cycle for each in cycles]),
        "largest pressure": ("traction", [each.largest_pressure for each in cycles]),
    } | {
        f"largest damage, {owner}": ("ratio", [found.hot_spots[place].damage for place in places])
        for owner, found in of_owners.items()
    }
    document = {
        "stored": len(result),
        "remark": DEBRIS,
        "cycles": [
            {
                "cycle": each.cycle,
                "pin_share": each.pin_share,
                "worn": _worn(each),
                "pictures": [picture(state, next(serial), k, "0", history) for k, state in enumerate(each.states)],
            }
            for each in cycles
        ],
        "quantities": [{"name": name, "kind": kind, "values": values} for name, (kind, values) in quantities.items()],
        "damage": _damage(of_owners, places),
    }
    ready: dict[str, Any] = json_ready(document)
    return ready


def _worn(cycle: WornCycle) -> dict[str, str]:
    """The worn depths of pin and hole at the nodes as a curve: degrees from the bottom, ascending."""
    degrees = np.array([angles.from_bottom(angle) for angle in cycle.theta.tolist()])
    order = np.argsort(degrees)
    columns = np.array([degrees, cycle.pin_depth, cycle.plate_depth])[:, order]
    if cycle.grid.closed:  # the curve goes on to the top from both sides
        ends = np.array([np.interp([-180.0, 180.0], columns[0], row, period=360.0) for row in columns[1:]])
        columns = np.hstack([np.vstack([[-180.0], ends[:, :1]]), columns, np.vstack([[180.0], ends[:, 1:]])])
    return dict(zip(("degrees", "pin", "hole"), map(packed, columns), strict=True))


def _damage(of_owners: dict[str, WornFatigue], places: list[int]) -> dict[str, Any]:
    """The damage of bodies after the chosen cycles as curves: the largest of all depths that are still there.

    The angles are those of all bodies, in degrees from the bottom, ascending.
    """
    words = [
        f"{points.edge_body(found.problem, found.body)}, {found.criterion}: {found.words}"
        for found in of_owners.values()
    ]
    document: dict[str, Any] = {"degrees": "", "words": words, "values": {}}
    for owner, found in of_owners.items():
        degrees = np.array([angles.from_bottom(angle) for angle in found.theta.tolist()])
        order = np.argsort(degrees)
        there = np.where(found.is_gone, 0.0, found.damage).max(axis=1)[:, order]
        document["degrees"] = packed(degrees[order])
        document["values"][owner] = [packed(there[place]) for place in places]
    return document
