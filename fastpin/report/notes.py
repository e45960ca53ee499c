"""Notes on a result, and its solver, as lines of text."""

from __future__ import annotations

from pathlib import Path

from fastpin import storage
from fastpin.model.case import Case
from fastpin.solver.errors import Interrupted
from fastpin.solver.result import Result

COUNTED = {
    "jumps": "the pin snapped {count} times; work does not balance there",
    "released": "{count} times a narrow contact with next to no force was let go and lost its memory",
}
"""Notes on counts of the statistics that are not zero."""


def note_lines(case: Case, result: Result) -> list[str]:
    """Return lines of text, one for each thing that a reader of a result must know; none for most results.

    Only statistics and grid of the result are read. Doubts about its values are warnings, see
    :mod:`fastpin.model.doubts`.
    """
    counts = {name: int(result.statistics.get(name, 0)) for name in COUNTED}
    notes = [COUNTED[name].format(count=count) for name, count in counts.items() if count]
    if result.grid.size > case.options.nodes and not result.grid.uniform:
        notes.append(f"{result.grid.size} nodes instead of {case.options.nodes}, dense where the contact is narrow")
    return notes


def way_on(path: Path | None, error: str | None) -> str:
    """Return words on how an unfinished run of a file goes on; empty if it does not.

    `error` is the error that ended the run. A run goes on after Ctrl-C or a kill. After another error the same loads
    end at the same place.
    """
    if path is None or error not in (None, str(Interrupted())):
        return ""
    if storage.is_being_written(path):
        return "its run goes on"
    command = f"wear CASE -o {path} --resume" if storage.holds_wear(path) else f"resume {path}"
    return f"continue with: fastpin {command}"


def solver_line(result: Result) -> str:
    """Return a line of text: the solver, the number of nodes, and the statistics that are not zero."""
    names = ("events", "exchanges", "rebuilds", "repeated", "increments", "seconds")
    known = [f"{result.statistics[name]:.4g} {name}" for name in names if result.statistics.get(name)]
    return f"{result.method} solver, {result.grid.size} nodes{''.join(f', {part}' for part in known)}"
