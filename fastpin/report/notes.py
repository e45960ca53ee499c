"""Notes on a result, and its solver, as lines of text."""

from __future__ import annotations

from collections.abc import Sequence

from fastpin.model.case import Case
from fastpin.solver.result import Result
from fastpin.states.state import State

COUNTED = {
    "jumps": "the pin snapped {count} times; work does not balance there",
    "released": "{count} times a narrow contact with next to no force was let go and lost its memory",
}
"""Notes on counts of the statistics that are not zero."""

LARGE_STRAIN = 0.05
"""Contact strain above which linear elasticity fails; probably the units of the case are wrong."""

STATISTICS = ("events", "exchanges", "rebuilds", "repeated", "increments", "seconds")
"""Statistics of the solver that are named, see :class:`fastpin.Result`."""


def note_lines(case: Case, result: Result, states: Sequence[State]) -> list[str]:
    """Return lines of text, one for each thing that a reader of a result must know; none for most results.

    Parameters
    ----------
    case : Case
    result : Result
        Its statistics and its grid are read, not its states.
    states : sequence of State
        States of the result whose contact strains are judged.
    """
    notes = []
    strain = case.problem.surfaces.beta_star * max((state.peak_pressure for state in states), default=0.0)
    if strain > LARGE_STRAIN and not case.problem.dimensionless:
        notes.append(f"contact strains of about {strain:.2g} are beyond linear elasticity; are all values in SI units?")
    counts = {name: int(result.statistics.get(name, 0)) for name in COUNTED}
    notes += [COUNTED[name].format(count=count) for name, count in counts.items() if count]
    if result.grid.size > case.options.nodes and not result.grid.uniform:
        notes.append(f"{result.grid.size} nodes instead of {case.options.nodes}, dense where the contact is narrow")
    return notes


def solver_line(result: Result) -> str:
    """Return a line of text: the solver, the number of nodes, and the statistics that are not zero."""
    known = [f"{result.statistics[name]:.4g} {name}" for name in STATISTICS if result.statistics.get(name)]
    return f"{result.method} solver, {result.grid.size} nodes{''.join(f', {part}' for part in known)}"
