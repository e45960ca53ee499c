"""A load cycle as text, JSON and CSV. Angles are in degrees from the bottom of the hole."""

from __future__ import annotations

import csv
import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from fastpin.assess.cycle import CYCLE
from fastpin.assess.outputs import ROUNDING
from fastpin.assess.outputs import document as document_of
from fastpin.damage import Fatigue, cycle_states, fatigue
from fastpin.damage.criteria import Criterion, criterion_title
from fastpin.damage.margins import MOST_STOPS as MOST_STOPS
from fastpin.damage.spectrum import SpectrumDamage, bodies_with_lives, spectrum_damage
from fastpin.errors import InputError
from fastpin.model.angles import from_bottom
from fastpin.model.loads import LOAD_KIND
from fastpin.model.points import EDGES, Body, edge_body, elastic_bodies, material_of, owner_of
from fastpin.model.problem import Problem
from fastpin.model.units import units
from fastpin.report.curves import Curve
from fastpin.states.choice import missing_corners
from fastpin.states.cycles import Cycle
from fastpin.states.load_cycle import LoadCycle, NodeBehaviour
from fastpin.states.margins import over_yield_words
from fastpin.states.quantities import load_point, sizes
from fastpin.states.state import State
from fastpin.storage.files import replacing

SWT: Criterion = "smith-watson-topper"
"""The criterion of printed texts and pages. It finds the hot spot without constants of the material."""

WORDS = {behaviour: behaviour.name.lower().replace("_", " ") for behaviour in NodeBehaviour}
"""Words for the behaviours of a node: "no contact", "sticks", "slips" and "opens"."""


def cycle_line(cycle: LoadCycle) -> str:
    """Return a line of text: the regime, and the largest slip range, slip distance and friction energy of a node.

    The places of the largest values stand beside them. Values that are rounding beside the sizes of
    :func:`natural_sizes` are 0.
    """
    natural, found = natural_sizes(cycle), document(cycle)
    unit = units(cycle.states[0].problem)

    def words(name: str, kind: str) -> str:
        """The largest value of a quantity with its place; 0 if it is rounding."""
        largest, label = found[f"largest_{name}"], name.replace("_", " ")
        if not largest > ROUNDING * natural[kind]:
            return f"{label} 0"
        return f"{label} up to {unit[kind].text(largest, 4)} at {found[f'largest_{name}_angle']:z.2f} deg"

    regime = cycle.regime.words + ("" if cycle.has_exact_slip_range else " (read from the kept states)")
    parts = [words("slip_range", "displacement") + ("" if cycle.has_exact_slip_range else " at the kept states")]
    if cycle.friction_energy is not None:
        parts += [words("slip_distance", "displacement"), words("friction_energy", "energy density")]
    return f"from corner {cycle.first:,} to {cycle.last:,}: {regime}, {', '.join(parts)}"


def fatigue_lines(states: Sequence[State], cycle: Cycle, over: Mapping[str, float]) -> list[str]:
    """Return lines of text: the hot spots of plate and bush by Smith, Watson and Topper, their planes and lives.

    `over` has the bodies that yield, see :func:`fastpin.states.margins.over_yield`: their lives are marked.

    A body without fatigue constants has no line. There is none if the states lack a corner of the cycle, or if the
    cycle has more than :data:`MOST_STOPS` states.
    """
    try:
        stops = cycle_states(states, cycle)
    except InputError:
        return []
    if not 2 <= len(stops) <= MOST_STOPS:
        return []
    bodies = [body for body in fatigue_bodies(stops[0].problem, SWT) if material_of(stops[0].problem, body).fatigue]
    return [hot_spot_line(fatigue(stops, SWT, body), stops, over) for body in bodies]


def spectrum_damages(states: Sequence[State], corners: int) -> list[SpectrumDamage]:
    """Return the damage of plate and bush by Smith, Watson and Topper over a whole history of so many corners.

    The history is one pass of a repeated spectrum. A body without constants of the life is left out. There is none for
    less than three corners, for corners that were not kept, or for more than :data:`MOST_STOPS` states.
    """
    if corners < 3 or not 2 <= len(states) <= MOST_STOPS or missing_corners(states, 1, corners):
        return []
    bodies = [body for body in bodies_with_lives(states[0].problem, SWT) if body in EDGES]
    return [spectrum_damage(states, SWT, body) for body in bodies]


def spectrum_line(damage: SpectrumDamage, over: Mapping[str, float]) -> str:
    """Return a line of text: the hot spot of a body over a spectrum, with its life and plane.

    `over` is that of :func:`fatigue_lines`.
    """
    spot, edge = damage.hot_spot, edge_body(damage.problem, damage.body)
    name = f"fatigue of the {edge} over the whole history as a spectrum, {criterion_title(damage.criterion)}"
    if math.isnan(spot.theta):
        return f"{name}: none, no plane has both tension and a changing strain"
    words = f"life {spot.life:.3g} spectra at {from_bottom(spot.theta):z.2f} deg"
    mark = over_yield_words(over, owner_of(damage.problem, damage.body))
    return f"{name}: {words}, normal of the plane {np.degrees(spot.plane):z.2f} deg from +x{mark}"


def fatigue_bodies(problem: Problem, criterion: str) -> list[Body]:
    """The edges of holes whose fatigue is reported by a criterion: those with constants; else the pin's hole.

    By Smith, Watson and Topper the parameter needs no constants. A laminate has no fatigue.
    """
    if not material_of(problem, "plate").is_isotropic:
        return []
    elastic = [body for body in EDGES if body in elastic_bodies(problem)]
    known = [body for body in elastic if criterion == SWT or material_of(problem, body).fatigue]
    return known or ["plate"]


def hot_spot_line(found: Fatigue, states: Sequence[State], over: Mapping[str, float]) -> str:
    """Return a line of text: the hot spot of a body over the last cycle, its plane, and its life if known.

    The criterion of `found` is "smith-watson-topper". A parameter that is rounding beside the pressures of the states
    is 0. `over` is that of :func:`fatigue_lines`.
    """
    spot, problem = found.hot_spot, found.problem
    name = f"fatigue of the {edge_body(problem, found.body)} in the last cycle, {criterion_title(found.criterion)}"
    pressure = max((state.peak_pressure for state in states), default=0.0)
    if spot.parameter <= ROUNDING * problem.surfaces.beta_star * pressure**2:
        return f"{name}: none, no plane has both tension and a changing strain"
    parts = [f"{units(problem)['stress times strain'].text(spot.parameter, 4)} at {from_bottom(spot.theta):z.2f} deg"]
    if np.isfinite(spot.plane):
        parts.append(f"normal of the plane {np.degrees(spot.plane):z.2f} deg from +x")
    if not np.isnan(spot.life):
        parts.append(f"life {spot.life:.3g} cycles" if np.isfinite(spot.life) else "infinite life")
    return f"{name}: {', '.join(parts)}{over_yield_words(over, owner_of(problem, found.body))}"


def natural_sizes(cycle: LoadCycle) -> dict[str, float]:
    """Return natural sizes of slip, traction and friction energy in a cycle. Much smaller values are rounding."""
    found = [sizes(state) for state in cycle.states]
    largest = {kind: max(each[kind] for each in found) for kind in ("displacement", "traction")}
    return largest | {"energy density": largest["displacement"] * largest["traction"]}


def document(cycle: LoadCycle) -> dict[str, Any]:
    """Return the largest values of a cycle with their places, and its energies, as a dict.

    A value that is not known is NaN. ``nodes`` counts the nodes of each behaviour. ``work`` is the work of each load;
    it is not known if only the ends of the cycle were kept.
    """
    unit, inside = units(cycle.states[0].problem), len(cycle.states) > 2
    nodes = {word: int(np.sum(cycle.behaviour == behaviour)) for behaviour, word in WORDS.items()}
    work = {name: unit["energy"].factor * loop.work if inside else None for name, loop in cycle.loops.items()}
    return document_of(CYCLE, cycle, unit) | {"nodes": nodes, "work": work}


def write_csv(cycle: LoadCycle, path: Path) -> None:
    """Write the values of all nodes as CSV, a line for each node. The header names the units.

    Raises
    ------
    InputError
        If the file can't be written.
    """
    columns = {name: column for name, column in cycle.columns().items() if name != "theta"}
    header = [f"{name} [{unit}]" if unit else name for name, (_, unit) in columns.items()]
    cells: dict[str, list[Any]] = {name: values.tolist() for name, (values, _) in columns.items()}
    cells["behaviour"] = [WORDS[NodeBehaviour(value)] for value in cells["behaviour"]]
    with replacing(path) as temporary, temporary.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["angle [deg]", *header])
        for angle, *values in zip(cycle.theta.tolist(), *cells.values(), strict=True):
            writer.writerow([from_bottom(angle), *values])


CONJUGATES = {
    "force": ("displacement", "displacement"),
    "moment": ("rotation", "rotation"),
    "traction": ("conjugate displacement", "work per stress"),
}
"""By kind of load: the name of the displacement on which it does work, and its kind of quantity."""


def loop_curve(cycle: LoadCycle) -> Curve:
    """Return the loops: a row for each state, with each load and the displacement on which it does work."""
    unit = units(cycle.states[0].problem)
    columns = {"load point": np.array([load_point(state) for state in cycle.states])}
    for name, loop in cycle.loops.items():
        words, conjugate = CONJUGATES[LOAD_KIND[name]]
        of_load, of_displacement = unit[LOAD_KIND[name]], unit[conjugate]
        columns[f"{name} [{of_load.name}]"] = of_load.factor * loop.load
        columns[f"{words} of {name} [{of_displacement.name}]"] = of_displacement.factor * loop.displacement
    return Curve({}, columns)


def cycles_curve(problem: Problem, cycles: Sequence[Cycle]) -> Curve:
    """Return the changes over cycles, a row for each cycle. Cycles and corners are counted from 1, as in tables."""
    unit = units(problem)
    kinds = {"dissipation": "energy", "rotation_change": "rotation"}
    columns = {"cycle": np.arange(1.0, len(cycles) + 1.0)}
    for name in Cycle._fields:
        values = np.array([getattr(cycle, name) for cycle in cycles], dtype=float) + (name == "corner")
        if name in kinds:
            columns[f"{name} [{unit[kinds[name]].name}]"] = unit[kinds[name]].factor * values
        elif name != "solved":
            columns[name] = values
    return Curve({}, columns)
