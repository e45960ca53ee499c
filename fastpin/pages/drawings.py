"""The figures of a page. Only this file calls fastpin.figures.

Each function returns a picture, with a caption and with words for readers who can't see it.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from fastpin import figures
from fastpin.damage import Fatigue
from fastpin.figures.states import DrawnStates
from fastpin.model.case import Case
from fastpin.model.points import bodies_of
from fastpin.model.units import named_loads
from fastpin.pages.album import Album
from fastpin.pages.content import Picture
from fastpin.report.case import edge_body
from fastpin.report.stress import COMPONENTS
from fastpin.report.sweep import Chart
from fastpin.solver.result import Result
from fastpin.states.load_cycle import LoadCycle
from fastpin.states.quantities import load_point
from fastpin.states.state import State
from fastpin.studies.convergence import Convergence

MAP = "von_mises"
"""The component of the map of stresses."""


class Words(NamedTuple):
    """The texts of a picture: in its place, and below it."""

    instead: str
    caption: str


def sketch(album: Album, case: Case) -> Picture:
    """Draw the joint with the ranges of its loads."""
    words = Words(
        f"Sketch of pin and {edge_body(case.problem, 'plate')} with arrows for the loads.",
        "The joint to scale, with an exaggerated clearance, and its loads with their ranges over the history.",
    )
    return album.picture(lambda path: figures.plot_sketch(case, path), *words)


def history(album: Album, case: Case, initial: np.ndarray) -> Picture:
    """Draw the load history from the load before its first corner, shape (loads,)."""
    words = Words(
        f"Line chart of the loads over the {len(case.history):,} corners of the history.",
        "Load history. A shaded block is run through as many times as stands above it.",
    )
    return album.picture(lambda path: figures.plot_history(case.problem, case.history, path, initial=initial), *words)


def tractions(album: Album, states: Sequence[State]) -> Picture:
    """Draw pressure and shear traction, and the zones of stick and slip."""
    words = Words(
        f"Line charts of contact pressure and shear traction over the angle round the hole, at load points "
        f"{_points(states)}. Bars below show where each state sticks and slips.",
        "Pressure N and shear traction T on the pin, counter-clockwise positive; below, stick and slip of each state.",
    )
    return album.picture(lambda path: figures.plot_tractions(states, path), *words)


def stick_slip(album: Album, states: DrawnStates) -> Picture:
    """Draw the map of stick and slip. The caption says whether the states are a part of all."""
    first, last = load_point(states[0]), load_point(states[-1])
    part = (
        f"Only {len(states):,} of {states.total:,} states, load points {first:.5g} to {last:.5g}: stick"
        if len(states) < states.total
        else "Stick"
    )
    words = Words(
        f"Map of the zones that stick and slip, over angle and load point, from load point {first:.5g} to {last:.5g}.",
        f"{part} and slip over the angle round the hole and the load point. White is open.",
    )
    return album.picture(lambda path: figures.plot_stick_slip(states, path), *words)


def hoop(album: Album, states: Sequence[State]) -> Picture:
    """Draw the hoop stress round hole and pin, and of the plate at the seat of a bush."""
    seat = ", the seat of the bush" if "seat" in bodies_of(states[0].problem) else ""
    words = Words(
        f"Line charts of the hoop stress over the angle round the hole, at load points {_points(states)}.",
        f"Hoop stress round the hole{seat} and the pin. Dots mark the largest value of each state.",
    )
    return album.picture(lambda path: figures.plot_hoop_stress(states, path), *words)


def stress_map(album: Album, state: State) -> Picture:
    """Draw a map of the stress in both bodies."""
    point = f"load point {load_point(state):.4g}: {named_loads(state.problem, state.load)}"
    words = Words(
        f"Map of the {COMPONENTS[MAP]} in pin and plate at {point}.",
        f"{COMPONENTS[MAP][0].upper()}{COMPONENTS[MAP][1:]} at {point}. The thick line is the contact, white where it "
        "slips.",
    )
    return album.picture(lambda path: figures.plot_stress_field(state, path, MAP), *words, bitmap=True)


def loops(album: Album, cycle: LoadCycle) -> Picture:
    """Draw the hysteresis loops of a cycle."""
    words = Words(
        f"Loops of each load against the displacement on which it does work, corners {cycle.first:,} to "
        f"{cycle.last:,}.",
        "Hysteresis loops. The area of a loop is the work of its load.",
    )
    return album.picture(lambda path: figures.plot_loops(cycle, path), *words)


def slip(album: Album, cycle: LoadCycle) -> Picture:
    """Draw slip and friction energy over a cycle."""
    words = Words(
        f"Line charts of slip and friction energy round the hole, corners {cycle.first:,} to {cycle.last:,}.",
        "Slip of each place over the cycle, and its friction energy or the range of its shear traction.",
    )
    return album.picture(lambda path: figures.plot_slip(cycle, path), *words)


def cycles(album: Album, result: Result) -> Picture:
    """Draw the changes of each cycle of a history."""
    words = Words(
        f"Line charts of the changes that each of {len(result.cycles):,} cycles makes.",
        "Changes of the tractions over each cycle, its dissipation, and the rotation of the pin in all.",
    )
    return album.picture(lambda path: figures.plot_cycles(result, path), *words)


def fatigue(album: Album, found: Sequence[Fatigue]) -> Picture:
    """Draw the parameter of a criterion along the edges, and the life."""
    edges = " and along the edge of the ".join(edge_body(one.problem, one.body) for one in found)
    life = " and the life" if any(one.life is not None for one in found) else ""
    words = Words(
        f"Line chart of the {found[0].criterion} parameter along the edge of the {edges}.",
        f"Parameter {found[0].criterion} along the edge of the {edges}, with its hot spot{life}. Short lines are the "
        "worst planes.",
    )
    return album.picture(lambda path: figures.plot_fatigue(found, path), *words)


def convergence(album: Album, study: Convergence) -> Picture:
    """Draw a convergence study."""
    words = Words(
        "Charts of the distance of each quantity to its limit, against the number of nodes or increments.",
        "Distance to the limit at the last corner. A dash at the last count is the error bar.",
    )
    return album.picture(lambda path: figures.plot_convergence(study, path), *words)


def sweep(album: Album, chart: Chart) -> Picture:
    """Draw a map or the curves of a sweep."""
    over = chart.x.label if chart.y is None else f"{chart.x.label} and {chart.y.label}"
    missing = f" {chart.missing:,} points have no value." if chart.missing else ""
    words = Words(
        f"{'Curves' if chart.y is None else 'Map'} of {chart.label} over {over}.",
        f"{chart.label[0].upper()}{chart.label[1:]} over {over}.{missing}",
    )
    return album.picture(lambda path: figures.plot_sweep(chart, path), *words)


def _points(states: Sequence[State]) -> str:
    return ", ".join(f"{load_point(state):.4g}" for state in states)
