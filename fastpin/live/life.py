"""The recording of a life of wear: the page with a slider of cycles, in one HTML file."""

from __future__ import annotations

import itertools
from contextlib import suppress
from typing import Any

import numpy as np

from fastpin.damage import WornFatigue
from fastpin.errors import InputError
from fastpin.live.contact import case_document
from fastpin.live.controls import ControlScales
from fastpin.live.page import recorded_page
from fastpin.live.pictures import packed, picture
from fastpin.live.protocol import MOST_PICTURES
from fastpin.live.recording import recorded_places
from fastpin.model.angles import from_bottom
from fastpin.model.checks import instance, string
from fastpin.model.points import edge_body
from fastpin.report.summary import json_ready
from fastpin.report.wear import DEBRIS
from fastpin.solver.wear_result import WearResult, WornCycle
from fastpin.version import __version__


def record_life(result: WearResult, title: str = "", sentence: str = "") -> str:
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

    Raises
    ------
    InputError
        If there is no stored cycle, or an argument is of another class.
    """
    instance("result", result, WearResult, "a fastpin.solver.WearResult")
    string("title", title)
    string("sentence", sentence)
    if not len(result):
        raise InputError("result", "there is no stored cycle to record")
    places = recorded_places(len(result), MOST_PICTURES // len(result[0].states))
    problem, history = result.problem, result.history
    case = case_document(title, problem, ControlScales(problem, history))
    recording: dict[str, Any] = {
        "version": __version__,
        "case": case | {"doubts": [*case["doubts"], *map(str, result.doubts)]},
        "grids": {"0": packed(result.theta)},
        "reference": None,
        "sentence": sentence,
        "add": [],
        "life": _life(result, places),
    }
    return recorded_page(recording)


def _life(result: WearResult, places: list[int]) -> dict[str, Any]:
    """The chosen cycles of a life as the page needs them: pictures, worn depths, numbers and damage."""
    cycles, history, serial = [result[place] for place in places], result.history, itertools.count(1)
    damages = _damages(result)
    quantities = {
        "worn volume": ("work per stress", [each.volume for each in cycles]),
        "largest depth": ("displacement", [each.depth for each in cycles]),
        "dissipated in a cycle": ("energy", [each.energy_per_cycle for each in cycles]),
        "largest pressure": ("traction", [each.largest_pressure for each in cycles]),
    } | {
        f"largest damage, {owner}": ("ratio", [found.hot_spots[place].damage for place in places])
        for owner, found in damages.items()
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
        "damage": _damage(damages, places),
    }
    ready: dict[str, Any] = json_ready(document)
    return ready


def _worn(cycle: WornCycle) -> dict[str, str]:
    """The worn depths of pin and hole at the nodes as a curve: degrees from the bottom, ascending."""
    degrees = np.array([from_bottom(angle) for angle in cycle.theta.tolist()])
    order = np.argsort(degrees)
    columns = np.array([degrees, cycle.pin_depth, cycle.plate_depth])[:, order]
    if cycle.grid.closed:  # the curve goes on to the top from both sides
        ends = np.array([np.interp([-180.0, 180.0], columns[0], row, period=360.0) for row in columns[1:]])
        columns = np.hstack([np.vstack([[-180.0], ends[:, :1]]), columns, np.vstack([[180.0], ends[:, 1:]])])
    return dict(zip(("degrees", "pin", "hole"), map(packed, columns), strict=True))


def _damages(result: WearResult) -> dict[str, WornFatigue]:
    """The damage of the bodies in contact, by their words; without those that have no constants for a life."""
    found = {}
    for body in ("pin", "plate"):
        with suppress(InputError):
            found[edge_body(result.problem, body)] = result.fatigue(body=body)
    return found


def _damage(damages: dict[str, WornFatigue], places: list[int]) -> dict[str, Any]:
    """The damage of bodies after the chosen cycles as curves: the largest of all depths that are still there.

    The angles are those of all bodies, in degrees from the bottom, ascending.
    """
    words = [f"{owner}, {found.criterion}: {found.words}" for owner, found in damages.items()]
    document: dict[str, Any] = {"degrees": "", "words": words, "values": {}}
    for owner, found in damages.items():
        degrees = np.array([from_bottom(angle) for angle in found.theta.tolist()])
        order = np.argsort(degrees)
        there = np.where(found.is_gone, 0.0, found.damage).max(axis=1)[:, order]
        document["degrees"] = packed(degrees[order])
        document["values"][owner] = [packed(there[place]) for place in places]
    return document
