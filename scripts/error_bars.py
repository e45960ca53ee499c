"""How often error bars hold: random cases against a reference on eight times as many intervals.

``python -m scripts.error_bars [--cases 40] [--first 0] [--nodes 201]`` prints three tables as Markdown, for
docs/convergence.md. It takes some five minutes. The first table is about the bars of two grids. The second one is about
the bars of studies of four grids, 101 to 801 nodes. The third one is about the bars of the tractions, at the nodes and
on the curves, four points an interval. With ``--classes general,narrow`` there are so many cases of each class of
``tests/survey/histories.py``, and rows by class. The reference is on the same arc. Its uncertainty is the difference to a
grid with half its intervals. *Surely held*: the bar covers the error plus this uncertainty. *Surely broken*: the bar
does not cover the error minus this uncertainty.
"""

from __future__ import annotations

import argparse
import collections
import math

import numpy as np
from tqdm import tqdm

from fastpin.errors import FastpinError
from fastpin.model.angles import angle_between
from fastpin.model.grid import Grid
from fastpin.model.history import LoadHistory
from fastpin.model.materials import Material, MaterialPair
from fastpin.model.problem import Problem
from fastpin.solver.solving import solve
from fastpin.states.curves import traction_patches, tractions_at
from fastpin.states.quantities import QUANTITIES, intervals, matching_values, size, values
from fastpin.states.state import State
from fastpin.studies.extrapolate import estimate
from tests.survey.histories import RandomCase, generate
from tests.survey.random_histories import classes

NODES = 201
TIMES = (2, 4, 8)
"""Refinements of the finer grids, in intervals. The last one is the reference."""

BESIDE = 2.0
"""Points within so many node distances of an edge, border or old border are counted apart."""

EXACT = 1e-9
"""Errors below this part of the quantity's size are rounding, and not counted."""

Found = dict[str, list[tuple[float, float, float]]]
"""By group of quantities: (error, uncertainty, bar) for pairs of grids, (error, bar, order observed) for studies."""


def random_case(seed: int) -> tuple[Problem, LoadHistory]:
    """A random problem and history.

    Materials are like in two cases of five, else with stiffness ratios 0.1 to 10. L_p is 1e-3 to 2. One case of ten has
    no friction, the others mu 0.05 to 1. There are three ways to hold the pin. Q goes up to 0.7 mu P (without friction
    0.35 P); the load is monotonic in three cases of ten, else cyclic. Some cases are partly unloaded in the end.
    """
    rng = np.random.default_rng(seed)
    plane = "strain" if rng.random() < 0.5 else "stress"
    pin = Material(1.0, rng.uniform(0.2, 0.4))
    like = rng.random() < 0.4
    plate = pin if like else Material(10.0 ** rng.uniform(-1.0, 1.0), rng.uniform(0.2, 0.45))
    load_parameter = 10.0 ** rng.uniform(-3.0, math.log10(2.0))
    friction = 0.0 if rng.random() < 0.1 else rng.uniform(0.05, 1.0)
    pin_load, rotation = (("body", "free"), ("centre", "free"), ("centre", "fixed"))[rng.integers(3)]
    problem = Problem.from_load_parameter(MaterialPair(pin, plate, plane), load_parameter, friction, pin_load, rotation)
    pull = friction or 0.5
    if rng.random() < 0.3:
        corners = [{"P": 1.0, "Q": pull * rng.uniform(-0.7, 0.7)}]
        least = 0.3 if rng.random() < 0.5 else 1.0
    else:
        amplitude = pull * rng.uniform(0.1, 0.7)
        corners = [{"P": 1.0}, {"Q": amplitude}, {"Q": -amplitude}, {"Q": amplitude}]
        least = 0.75 if rng.random() < 0.3 else 1.0
    if least < 1.0:
        corners.append({"P": rng.uniform(least, 1.0)})
    return problem, LoadHistory(corners)


def refined(grid: Grid, times: int) -> Grid:
    """Return a grid on the same arc or circle with `times` as many intervals."""
    return grid.with_nodes(times * grid.size if grid.closed else times * (grid.size - 1) + 1)


def main() -> None:
    """Run the command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cases", type=int, default=40)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--nodes", type=int, default=NODES)
    parser.add_argument("--classes", type=classes, default=[""])
    options = parser.parse_args()
    pairs: Found = collections.defaultdict(list)
    studies: Found = collections.defaultdict(list)
    points: dict[str, list[np.ndarray]] = collections.defaultdict(list)
    without: collections.Counter[str] = collections.Counter()
    states = failed = 0
    seeds = range(options.first, options.first + options.cases)
    for kind, seed in tqdm([(kind, seed) for kind in options.classes for seed in seeds], disable=None, delay=2.0):
        case = generate(kind, seed) if kind else RandomCase(*random_case(seed))
        try:
            result = solve(case.problem, case.history, nodes=options.nodes, error_bars=True)
            finer = [solve(case.problem, case.history, grid=refined(result.grid, times)) for times in TIMES]
        except FastpinError:
            failed += 1
            continue
        for state, *better in zip(result, *finer, strict=True):
            states += 1
            assert state.error_bars is not None
            grids = (state.error_bars.coarse, state, *better)
            count(state, [matching_values(state, other) for other in grids], pairs, studies, without)
            count_points(state, better, points, kind)
    cases = len(seeds) * len(options.classes) - failed
    print(f"{cases} cases, {states} states, {options.nodes} nodes; {failed} cases without equilibrium\n")
    print("| quantity | values | held, % | surely held, % | surely broken, % | bar / error, median | no bar |")
    print("|---|--:|--:|--:|--:|--:|--:|")
    for group, rows in pairs.items():
        error, unsure, bar = np.array(rows).T
        parts = [np.mean(error <= bar), np.mean(error + unsure <= bar), np.mean(error - unsure > bar)]
        shown = " | ".join(f"{100.0 * part:.1f}" for part in parts)
        print(f"| {group} | {error.size} | {shown} | {np.median(bar / error):.1f} | {without[group]} |")
    print("\n| quantity | values | order observed, % | held if observed, % | held if not, % | bar / error, median |")
    print("|---|--:|--:|--:|--:|--:|")
    for group, rows in [*studies.items(), ("all", [row for each in studies.values() for row in each])]:
        error, bar, seen = np.array(rows).T
        held, observed = error <= bar, seen == 1.0
        known = f"{100.0 * np.mean(held[observed]):.1f}" if observed.any() else "-"
        other = f"{100.0 * np.mean(held[~observed]):.1f}" if not observed.all() else "-"
        share, tight = 100.0 * np.mean(observed), np.median(bar / error)
        print(f"| {group} | {error.size} | {share:.0f} | {known} | {other} | {tight:.1f} |")
    print("\n| tractions | points | held, % | surely held, % | surely broken, % | bar / error, median |", end="")
    print(" bar / peak N, median | 95 % of bars below |\n|---|--:|--:|--:|--:|--:|--:|--:|")
    for group, found in points.items():
        error, unsure, bar = np.concatenate(found, axis=1)
        parts = [np.mean(error <= bar), np.mean(error + unsure <= bar), np.mean(error - unsure > bar)]
        shown = " | ".join(f"{100.0 * part:.1f}" for part in parts)
        most = np.quantile(bar, 0.95)
        print(
            f"| {group} | {error.size} | {shown} | {np.median(bar / error):.1f} | {np.median(bar):.5f} | {most:.4f} |"
        )


def count_points(state: State, better: list[State], points: dict[str, list[np.ndarray]], kind: str) -> None:
    """Add error, uncertainty and bar of the tractions to `points`, in parts of the peak pressure, by place and class.

    The last two of the states in `better` are the reference and the grid with half its intervals.
    """
    if not state.in_contact:
        return
    bars, grid = state.error_bars, state.grid
    assert bars is not None
    nodal = [np.array([each.pressure, each.shear]) for each in (state, *better[-2:])]
    nodal = [each[:, ::times] for each, times in zip(nodal, (1, *TIMES[-2:]), strict=True)]
    spacing = float(np.median(grid.weights))
    theta = np.concatenate([grid.theta + 0.25 * part * spacing for part in range(4)])
    curves = [tractions_at(traction_patches(each), np.degrees(theta) + 90.0) for each in (state, *better[-2:])]
    for what, angles, (mine, half, true), known in (
        ("at nodes", grid.theta, nodal, (bars.pressure, bars.shear)),
        ("of curves", theta, curves, bars.of_curves(theta)),
    ):
        error, unsure = np.abs(mine - true), np.abs(half - true)
        place = places(state, angles, spacing)
        for row, name in enumerate(("N", "T")):
            touched = (error[row] > EXACT * state.peak_pressure) & (mine[0] + true[0] > 0.0)
            numbers = np.array([error[row], unsure[row], known[row]]) / state.peak_pressure
            for group in np.unique(place[touched]):
                points[f"{name} {what}, {group}"].append(numbers[:, touched & (place == group)])
            if kind:
                points[f"{name} {what}, class {kind}"].append(numbers[:, touched])


def places(state: State, theta: np.ndarray, spacing: float) -> np.ndarray:
    """Words on the place of each angle."""
    words = np.full(theta.size, "elsewhere", dtype=object)
    old = state.theta[state.old_borders != 0] if state.old_borders is not None else []
    borders, edges = (np.ravel(intervals(state, zone)) for zone in ("stick", "contact"))
    for name, angles in (("old borders", old), ("borders", borders), ("edges", edges)):
        for angle in angles:
            words[np.abs(angle_between(theta, angle)) < BESIDE * spacing] = f"beside {name}"
    return words


def count(
    state: State,
    sequence: list[dict[str, float]],
    pairs: Found,
    studies: Found,
    without: collections.Counter[str],
) -> None:
    """Add the errors, uncertainties and bars of one state to `pairs`, `studies` and `without`.

    `sequence` has the quantities on all grids, coarsest first. `without` counts values that have no bar.
    """
    bars, true = state.error_bars, sequence[-1]
    assert bars is not None
    for name, value in values(state).items():
        group = name if name in QUANTITIES else f"{name.split('_')[0]} ends"
        rounding, error = EXACT * size(name, state), abs(value - true[name])
        unsure = abs(sequence[-2][name] - true[name])
        if math.isinf(bars[name]) or math.isnan(unsure):
            without[group] += not math.isnan(value)
        elif error > rounding:
            pairs[group].append((error, unsure, bars[name]))
        found = estimate((8.0, 4.0, 2.0, 1.0), [each[name] for each in sequence[:-1]], rounding)
        if found.verdict in ("observed", "converged", "not converged") and unsure > rounding:
            studies[group].append((unsure, found.bar, float(found.verdict == "observed")))


if __name__ == "__main__":
    main()
