"""A load cycle: its largest values, its text, its nodes and its loops. Angles are in degrees from the bottom."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence

import numpy as np

from fastpin.assess.outputs import ROUNDING, UNKNOWN, WHOLE, Curve, Output, document, map_of, of_fields
from fastpin.model import Problem, angles, loads
from fastpin.model.units import PLAIN, units
from fastpin.states.cycles import CYCLE_KINDS, Cycle
from fastpin.states.load_cycle import NODE_KINDS, LoadCycle, NodeBehaviour
from fastpin.states.quantities import load_point, sizes
from fastpin.states.regimes import REGIMES


def _largest(name: str, kind: str) -> Iterator[Output]:
    """Yield the largest value of a node and its place; NaN if it is not known."""

    def known(read: Callable[[LoadCycle, np.ndarray], float]) -> Callable[[LoadCycle], float]:
        return lambda cycle: math.nan if getattr(cycle, name) is None else read(cycle, getattr(cycle, name))

    yield Output(f"largest_{name}", kind, known(lambda cycle, values: float(values.max())), optional=True)
    yield Output(f"largest_{name}_angle", "angle", known(LoadCycle.angle_of_largest), optional=True)


WORDS = {behaviour: behaviour.name.lower().replace("_", " ") for behaviour in NodeBehaviour}
"""Words for the behaviours of a node: "no contact", "sticks", "slips" and "opens"."""


CYCLE = (
    Output("first", "whole"),
    Output("last", "whole"),
    Output("closed", "truth", lambda cycle: cycle.is_closed),
    *_largest("slip_range", "displacement"),
    *_largest("slip_distance", "displacement"),
    *_largest("friction_energy", "energy density"),
    *_largest("pressure_range", "traction"),
    *_largest("shear_range", "traction"),
    Output("regime", "class", classes=REGIMES),
    Output("slip_range_is_exact", "truth", lambda cycle: cycle.has_exact_slip_range),
    Output("dissipation", "energy", optional=True),
    Output(
        "nodes", form=map_of(WHOLE, "number of nodes of each behaviour"),
        of=lambda cycle: {word: int(np.sum(cycle.behaviour == behaviour)) for behaviour, word in WORDS.items()},
    ),
    Output("work", of=lambda cycle: work_of_loads(cycle), form=map_of(UNKNOWN, "work of each load")),
)  # fmt: skip
"""Outputs of a :class:`fastpin.states.LoadCycle`."""


CHANGES = of_fields(Cycle, CYCLE_KINDS)
"""Outputs of a :class:`fastpin.states.cycles.Cycle`: how one cycle of a block changed the contact."""


def cycle_line(cycle: LoadCycle) -> str:
    """Return a line of text: the regime, and the largest slip range, slip distance and friction energy of a node.

    The places of the largest values stand beside them. Values that are rounding beside the sizes of
    :func:`natural_sizes` are 0.
    """
    natural, found = natural_sizes(cycle), document(CYCLE, cycle, {})  # in SI units
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


def work_of_loads(cycle: LoadCycle) -> dict[str, float | None]:
    """Return the work of each load; it is not known if only the ends of the cycle were kept."""
    factor, inside = units(cycle.states[0].problem)["energy"].factor, len(cycle.states) > 2
    return {name: factor * loop.work if inside else None for name, loop in cycle.loops.items()}


def natural_sizes(cycle: LoadCycle) -> dict[str, float]:
    """Return natural sizes of slip, traction and friction energy in a cycle. Much smaller values are rounding."""
    found = [sizes(state) for state in cycle.states]
    largest = {kind: max(each[kind] for each in found) for kind in ("displacement", "traction")}
    return largest | {"energy density": largest["displacement"] * largest["traction"]}


def nodes_curve(cycle: LoadCycle) -> Curve:
    """Return the values of all nodes, a row for each node. The headings name the units."""
    unit, columns = units(cycle.states[0].problem), {}
    for name, (column, _) in cycle.columns().items():
        of_name = unit.get(NODE_KINDS[name], PLAIN)
        columns[f"{name} [{of_name.name}]" if of_name.name else name] = of_name.factor * column
    (_, theta), *others = columns.items()
    angle = np.array([angles.from_bottom(each) for each in theta.tolist()])
    words = np.array([WORDS[NodeBehaviour(value)] for value in cycle.behaviour])
    return Curve({}, {"angle [deg]": angle, **dict(others), "behaviour": words})


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
        words, conjugate = CONJUGATES[loads.LOAD_KIND[name]]
        of_load, of_displacement = unit[loads.LOAD_KIND[name]], unit[conjugate]
        columns[f"{name} [{of_load.name}]"] = of_load.factor * loop.load
        columns[f"{words} of {name} [{of_displacement.name}]"] = of_displacement.factor * loop.displacement
    return Curve({}, columns)


def cycles_curve(problem: Problem, cycles: Sequence[Cycle]) -> Curve:
    """Return the changes over cycles, a row for each cycle. Cycles and corners are counted from 1, as in tables."""
    unit, columns = units(problem), {"cycle": np.arange(1.0, len(cycles) + 1.0)}
    for each in CHANGES[:-1]:  # whether it was solved is no change
        values = [each.shown(cycle, unit) + (each.name == "corner") for cycle in cycles]
        columns[each.column(unit)] = np.array(values, dtype=float)
    return Curve({}, columns)
