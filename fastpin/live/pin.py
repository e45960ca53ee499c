"""One pin on the page: a case that is led by a :class:`fastpin.Session`."""

from __future__ import annotations

import math
from dataclasses import asdict, replace
from typing import Any

import numpy as np

from fastpin.casefile import case_text
from fastpin.errors import InputError
from fastpin.kernels.status import OPEN
from fastpin.live import protocol
from fastpin.live.contact import Answer, LiveContact
from fastpin.live.controls import ControlScales, changed_fields, load_controls, problem_controls, vector_axes
from fastpin.live.pictures import packed, picture
from fastpin.model import LOADS, Case, Problem, angles
from fastpin.model.doubts import doubts
from fastpin.model.options import ALL_ROUND, SolveOptions
from fastpin.model.profile import CALLED
from fastpin.model.unit_systems import SI
from fastpin.model.units import units
from fastpin.report.case import profile_words
from fastpin.sessions import Session
from fastpin.solver import ConvergenceError
from fastpin.states.state import State

NODES = 200
"""Nodes round the hole, by default. Peak pressures of the built-in case are then good to 1e-4, peak shears to 1e-3.

A multiple of four puts a node at the bottom, at the top and at either side. So a load in these directions has a
symmetric contact. Between two nodes, one of them would be the first to close, and would turn the pin a little.
"""

LEAST_CLOSED = 20
"""Nodes in contact under the first load. Of fewer, curves are coarse, and the peak of the shear may be anywhere."""

MOST_PLAYED = 500
"""Corners of the case's history that the page can play."""


class LivePin(LiveContact):
    """The contact of one pin, led by messages. The states have the bits of ``fastpin.solve`` on the same grid.

    Parameters
    ----------
    case : Case
    nodes : int
        Nodes round the hole.
    """

    def __init__(self, case: Case, nodes: int = NODES) -> None:
        self._case, self._scales = case, ControlScales(case.problem, case.history)
        session = Session(case.problem, nodes, arc=ALL_ROUND, undo=0)
        super().__init__(session, nodes, _named(case.history.corner(0)[0]), protocol.MOST_PICTURES)

    def _new_session(self) -> Session:
        return Session(self._problem, self._nodes, arc=ALL_ROUND, undo=0)

    @property
    def _problem(self) -> Problem:
        problem: Problem = self.session.problem
        return problem

    @property
    def _size(self) -> int:
        return 0 if self.session.grid is None else self.session.grid.size

    @property
    def _allowed(self) -> set[str]:
        return {control["name"] for control in load_controls(self._problem, self._scales)}

    def _picture(self, state: State, serial: int, gesture: int) -> Answer:
        shown = replace(state)  # what is read from a state stays in it; the session keeps its states small for undo
        return picture(shown, serial, gesture, self._grid_name(state.grid), self._case.history)

    def _obey_change(self, changes: dict[str, Any], follow: str, gesture: int) -> None:
        fields = changed_fields(self.session.problem, changes, self._scales)
        session = self.session.copy()
        session.change(replay="none", **fields)
        if session.grid is not None and follow == "load" and session.grid.size != self._nodes:
            session = Session(
                session.problem, self._nodes, arc=ALL_ROUND, undo=0
            )  # the nodes may have been too many for the new problem
        self._lead(session, follow, gesture)

    def _rows(self, follow: str) -> list[dict[str, float]]:
        history = self.session.history
        if history is None:
            return []
        given = history.blocks[0].given
        if follow == "history":
            return [_named(row) for row in given]
        present = history.values()[-1]
        return [_named(np.where(np.all(np.isnan(given), axis=0), np.nan, present))]

    def _begin(self, loads: dict[str, float], gesture: int) -> None:
        """Follow the first load, with more nodes if the contact is narrow.

        If it is too narrow for the most nodes all round, the solver chooses the nodes.
        """
        session, nodes = self.session, self._nodes
        while True:
            try:
                state = session.advance(loads)
                closed = np.count_nonzero(state.status != OPEN) or nodes
            except ConvergenceError:
                closed = 1
            if closed >= LEAST_CLOSED or nodes >= protocol.MOST_NODES:
                break
            nodes = min(4 * math.ceil(0.25 * nodes * max(2.0, LEAST_CLOSED / closed)), protocol.MOST_NODES)
            session = Session(session.problem, nodes, arc=ALL_ROUND, undo=0)
        if closed < LEAST_CLOSED:
            session = Session(session.problem, self._nodes, undo=0)
            state = session.advance(loads)
        self.session = session
        self._add(state, gesture)

    def _case_document(self) -> Answer:
        return case_document(self._case.title, self.session.problem, self._scales) | {
            "nodes": self._nodes,
            "most_nodes": protocol.MOST_NODES,
            "history": [_named(row) for row in self._case.history.values(np.full(len(LOADS), np.nan))[:MOST_PLAYED]],
        }

    def case_text(self) -> str:
        history, grid = self.session.history, self.session.grid
        if history is None or grid is None:
            raise InputError("case", "no load was followed yet")
        if "file" in self.session.problem.plate_body.keys:
            words = "a plate from a compliance file can't be saved here; save the loads (CSV), and name them in a copy"
            raise InputError("case", f"{words} of your own case file")
        arc = ALL_ROUND if grid.closed else (float(grid.theta[0]), float(grid.theta[-1]))
        options = replace(SolveOptions(), nodes=grid.size, arc=arc)
        return case_text(replace(self._case, problem=self.session.problem, history=history, options=options))


def _named(given: np.ndarray) -> dict[str, float]:
    """The loads that are given, by name."""
    return {name: float(value) for name, value in zip(LOADS, given, strict=True) if not np.isnan(value)}


def _outline(lug: Any) -> list[Answer]:
    """The edges of a plate of any outline beyond the hole: lines x, y in m, supports and loads."""
    loads = {name: load.name for load in lug.loads for name in load.parts}
    return [
        {
            "line": np.stack([lug.hole_radius * line.real, lug.hole_radius * line.imag], axis=1).tolist(),
            "hold": lug.supports.get(part.name),
            "load": loads.get(part.name),
        }
        for part, line in zip(lug.edges, lug.edge_lines, strict=True)
    ]


def case_document(title: str, problem: Problem, scales: ControlScales) -> Answer:
    """A problem as the page needs it: units, sizes and shapes of the bodies, loads and controls."""
    lug, bush = problem.plate_body.lug, problem.plate_body.bush
    around = angles.angle_at(np.arange(CALLED) * (360.0 / CALLED) - 180.0)  # from -180 degrees from the bottom on
    # A choice of prefixes for all sizes of values, by its name: a power of ten for each unit. 1 kN mm is 1 N m.
    prefixes = {"kN, mm": {"N": 3, "N/m": 3, "N m": 0, "J": 0, "J/m": 0, "m": -3, "Pa": 6}}
    return {
        "title": title,
        "units": {kind: asdict(unit) for kind, unit in units(problem).items()},
        "prefixes": prefixes if problem.unit_system == SI and not problem.dimensionless else {},
        "dimensionless": problem.dimensionless,
        "friction": problem.most_friction,
        "radius": problem.hole_radius,
        "clearance": problem.assembled_clearance,
        "yielded": scales.force * problem.surfaces.beta_star,
        "bore": problem.pin_body.bore_radius,
        "plate": problem.plate_body.kind,
        "bush": None if bush is None else bush.outer_radius,
        "rim": lug.outer_radius if math.isfinite(lug.outer_radius) else None,
        "outline": None if lug.geometry is None else _outline(lug.geometry),
        "profiles": {name: packed(each.at(around, problem.hole_radius)) for name, each in problem.profiles.items()},
        "profile_words": profile_words(problem),
        "doubts": [str(doubt) for doubt in doubts(problem, None, SolveOptions())],
        "axes": vector_axes(problem, scales),
        "loads": load_controls(problem, scales),
        "controls": problem_controls(problem, scales),
    }
