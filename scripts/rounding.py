"""How far rounding carries: random histories under two versions of packages, or two kinds of BLAS.

``python -m scripts.rounding FILE.npz [--count 12]`` solves `count` histories of each of five classes of
``tests/survey/histories.py`` with error bars. It stores pressure, shear, key figures and their bars.
``python -m scripts.rounding --compare A.npz B.npz`` prints the differences between two such files as Markdown. The
difference of a history's tractions is the largest one of all nodes and states, in parts of the peak pressure of the
state. Differences of figures and of their bars are in parts of the largest figure of the group in the history, for
edges of the contact's largest width. A bar holds if it covers the difference of its figure.
``OPENBLAS_CORETYPE=Prescott`` chooses the BLAS code of an old processor.
"""

from __future__ import annotations

import argparse
import math
from pathlib import Path

import numpy as np

from fastpin.solver.errors import SolveError
from fastpin.solver.solving import solve
from fastpin.states.quantities import ZONES, quantity, sizes, values
from fastpin.states.state import State
from tests.survey.histories import generate

CLASSES = ("general", "remote", "fits", "fixed", "moderate_stress")
"""Classes without extremes: their histories hang on no single digit."""

LEAST_NODES = 101
"""Error bars need so many. Classes have fewer."""

MOST_INTERVALS = 8
"""Intervals of each zone whose ends are compared."""

GROUPS = {
    "peaks": ("peak_pressure", "peak_shear"),
    "edges": tuple(
        f"{zone}_{k}_{end}" for zone in ZONES for k in range(1, MOST_INTERVALS + 1) for end in ("start", "stop")
    ),
    "motion": ("dx", "dy", "rotation"),
    "dissipation": ("dissipation",),
}
"""The names of the key figures, by group."""

NAMES = tuple(name for names in GROUPS.values() for name in names)

FIGURES = "figures of "
"""Begins the names of the arrays of key figures."""


def stored(count: int) -> dict[str, np.ndarray]:
    """Tractions of all corners, shape (states, 2, n), and figures, shape (states, names, 3), by name of the history.

    Histories without a solution are left out. Other errors are not caught, so no class is left out unseen.
    """
    found = {}
    for kind in CLASSES:
        for seed in range(count):
            case = generate(kind, seed)
            options = case.options | {"nodes": max(case.options["nodes"], LEAST_NODES)}
            try:
                result = solve(case.problem, case.history, **options, error_bars=True)
            except SolveError:
                continue
            found[f"{kind} {seed}"] = np.array([(state.pressure, state.shear) for state in result])
            found[f"{FIGURES}{kind} {seed}"] = np.array([figures(state) for state in result])
    return found


def figures(state: State) -> list[tuple[float, float, float]]:
    """Value, error bar and natural size of each key figure; NaN for ends of intervals that the state does not have."""
    assert state.error_bars is not None
    found, natural = values(state), sizes(state)
    return [
        (found.get(name, math.nan), state.error_bars.get(name, math.nan), natural[quantity(name).kind])
        for name in NAMES
    ]


def traction_difference(one: np.ndarray, other: np.ndarray) -> float:
    """The largest difference of a history's tractions in parts of the peak pressure of the state."""
    peaks = one[:, 0].max(axis=1)
    apart = np.abs(one - other).max(axis=(1, 2))
    return float((apart[peaks > 0.0] / peaks[peaks > 0.0]).max(initial=0.0))


def figure_differences(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """The differences of a history's figures and of their bars, and whether the bars hold, shape (3, states, names).

    NaN where both histories have no such figure, or no bar. Infinite where only one has it.
    """
    size = np.concatenate([_sizes(one, group) for group in GROUPS])
    with np.errstate(invalid="ignore"):
        apart, between = np.abs(one - other)[:, :, :2].transpose(2, 0, 1)
    for difference, column in ((apart, 0), (between, 1)):
        here, there = np.isfinite(one[:, :, column]), np.isfinite(other[:, :, column])
        difference[~here & ~there] = np.nan
        difference[here != there] = np.inf
    bars = np.fmax(one[:, :, 1], other[:, :, 1])
    held = np.where(np.isnan(apart) | np.isnan(bars), np.nan, apart <= bars)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.stack(
            [np.where(apart == 0.0, 0.0, apart / size), np.where(between == 0.0, 0.0, between / size), held]
        )


def _sizes(history: np.ndarray, group: str) -> np.ndarray:
    """The sizes of the figures of a group in a history: the largest one of all, but the width of contact for edges."""
    columns = history[:, [NAMES.index(name) for name in GROUPS[group]]]
    if group == "edges":
        return np.asarray(columns[:, :, 2].max(axis=0))
    return np.full(columns.shape[1], np.nanmax(np.abs(columns[:, :, 0])))


def table(old: Path, new: Path) -> str:
    """The differences between two files as a Markdown table. A history that only one file has is infinitely far."""
    tractions, parts, missing = [], [], 0
    with np.load(old) as before, np.load(new) as after:
        for name in sorted(name for name in {*before.files, *after.files} if not name.startswith(FIGURES)):
            both = name in before.files and name in after.files
            if not both or before[name].shape != after[name].shape:
                missing += 1
                continue
            tractions.append(traction_difference(before[name], after[name]))
            parts.append(figure_differences(before[FIGURES + name], after[FIGURES + name]))
    lines = [
        "| | compared | the same bits | median | largest | bars, median | bars, largest | outside their bars |",
        "|---|--:|--:|--:|--:|--:|--:|--:|",
        _row("tractions", np.array(tractions + [np.inf] * missing)),
    ]
    for group, names in GROUPS.items():
        columns = [NAMES.index(name) for name in names]
        apart, between, held = (np.concatenate([part[k][:, columns].ravel() for part in parts]) for k in range(3))
        lines.append(_row(group, apart, between, held))
    return "\n".join(lines)


def _row(name: str, apart: np.ndarray, between: np.ndarray | None = None, held: np.ndarray | None = None) -> str:
    apart = apart[~np.isnan(apart)]
    cells = [name, f"{apart.size}", f"{np.sum(apart == 0.0)}", f"{np.median(apart):.0e}", f"{apart.max():.0e}"]
    if between is None or held is None:
        return f"| {' | '.join([*cells, '', '', ''])} |"
    between = between[~np.isnan(between)]
    cells += [f"{np.median(between):.0e}", f"{between.max():.0e}", f"{np.sum(held == 0.0)}"]
    return f"| {' | '.join(cells)} |"


def main() -> None:
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("files", nargs="+", type=Path, metavar="FILE")
    parser.add_argument("--count", type=int, default=12, help="histories of each class")
    parser.add_argument("--compare", action="store_true", help="compare two files")
    options = parser.parse_args()
    if options.compare:
        print(table(*options.files))
    else:
        np.savez(options.files[0], **stored(options.count))


if __name__ == "__main__":
    main()
