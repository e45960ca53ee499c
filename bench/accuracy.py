"""The tables of accuracy in docs/: ``python -m bench.accuracy TABLE ...`` prints them as Markdown.

``--sizes 101,201`` gives other numbers of nodes, terms or increments than those of TABLES. ``--figure FILE`` draws the
errors of the reference cases. The tables of error bars solve ``--cases`` random cases from the seed ``--first`` on, or
so many of each of the ``--classes`` of ``tests/survey/histories.py``, with rows by class.

``rounding --store FILE.npz`` solves ``--cases`` histories of each of five classes with error bars, and stores them.
``rounding --compare A.npz B.npz`` prints how far rounding carries between two such files, of two versions of packages
or two kinds of BLAS. ``OPENBLAS_CORETYPE=Prescott`` chooses the BLAS code of an old processor.
"""

from __future__ import annotations

import argparse
import collections
import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from tqdm import tqdm

from fastpin.errors import FastpinError
from fastpin.figures.style import line
from fastpin.model.angles import BOTTOM, angle_between
from fastpin.model.grid import Grid
from fastpin.model.history import LoadHistory
from fastpin.model.materials import Material, MaterialPair
from fastpin.model.options import ALL_ROUND
from fastpin.model.problem import Problem
from fastpin.published.records import add_legend, panels, save_drawing
from fastpin.solver.configuration import review
from fastpin.solver.errors import SolveError
from fastpin.solver.increment import implicit_step
from fastpin.solver.result import Result
from fastpin.solver.solving import solve
from fastpin.states.curves import traction_patches, tractions_at
from fastpin.states.quantities import QUANTITIES, ZONES, intervals, matching_values, quantity, size, sizes, values
from fastpin.states.state import State
from fastpin.studies.extrapolate import estimate
from fastpin.verification import closed_forms
from fastpin.verification.comparisons import cattaneo_mindlin_differences
from fastpin.verification.finite_elements import FRETTING, LIKE, UNLIKE, FiniteElements
from fastpin.verification.joint_rows import step, wearing
from fastpin.verification.rows import Solving
from tests.support import joints
from tests.support.checks import wear_limits
from tests.support.checks.friction_rows import ROUGH
from tests.support.checks.integral_equations import residuals_away
from tests.support.checks.sliding import solve_sliding
from tests.support.checks.wear_rows import half_planes
from tests.support.wear_cases import WEAR_CASES, lived, numbers_of, parts_of, ready_to_wear
from tests.survey.histories import GENERATORS, RandomCase, generate

Options = argparse.Namespace
Row = Sequence[object]

NODES = (101, 201, 401, 801, 1601)


def show(title: str, header: str, rows: Iterable[Row], orders: bool = False) -> None:
    """Print a table, with the orders of its columns in the first one: slopes of straight lines through logarithms."""
    known = []
    print(f"\n### {title}\n\n| {header} |\n|{'---|' * (header.count(' | ') + 1)}")
    for row in rows:
        known.append(row)
        print("|", " | ".join(f"{cell:.3g}" if isinstance(cell, float) else str(cell) for cell in row), "|", flush=True)
    if orders:
        first, *others = np.log(np.abs(np.array(known, dtype=float))).T
        print("\nOrders:", ", ".join(f"{-np.polyfit(first, each, 1)[0]:.2f}" for each in others))


# -- docs/accuracy-tables.md ---------------------------------------------------------------------------------


def closed_form(options: Options) -> None:
    """Frictionless contact against Persson: root mean squares over 16 load parameters and as many arcs."""
    rng = np.random.default_rng(0)
    cases = [(10.0 ** rng.uniform(-2.0, 0.3), rng.uniform(1.08, 1.3, 2)) for _ in range(16)]

    def row(nodes: int) -> Row:
        edge, peak = [], []
        for load_parameter, wide in cases:
            exact = closed_forms.persson_half_angle(load_parameter)
            arc = (BOTTOM - wide[0] * exact, BOTTOM + wide[1] * exact)
            problem = Problem.from_load_parameter(LIKE, load_parameter, 0.0)
            state = solve(problem, [{"P": 1.0}], nodes=nodes, arc=arc)[-1]
            edge += [state.contact[0][1] - BOTTOM - exact, state.contact[0][0] - BOTTOM + exact]
            peak.append(state.peak_pressure / closed_forms.persson_pressure(0.0, exact) - 1.0)
        return [nodes, *(math.sqrt(np.mean(np.square(each))) for each in (edge, peak))]

    show("Persson", "nodes | edge, rad | peak pressure, relative", map(row, options.sizes), orders=True)


CASES: dict[str, tuple[Problem, list[dict[str, float]]]] = {
    "like bodies without friction, L_p = 0.1": (Problem.from_load_parameter(LIKE, 0.1, 0.0), [{"P": 1.0}]),
    "Ti-6Al-4V in aluminium, body load, mu = 0.4, L_p = 0.1": (
        Problem.from_load_parameter(UNLIKE, 0.1, 0.4, "body"), [{"P": 1.0}],
    ),
    "like bodies, body load, mu = 0.4, L_p = 0.1": (
        Problem.from_load_parameter(LIKE, 0.1, 0.4, "body"), [{"P": 1.0}],
    ),
    "like bodies, held, mu = 0.55, L_p = 0.5": (
        Problem.from_load_parameter(LIKE, 0.5, 0.55, "centre", "fixed"), FRETTING,
    ),
    "like bodies, free, body load, mu = 0.55, L_p = 0.05": (
        Problem.from_load_parameter(LIKE, 0.05, 0.55, "body"), FRETTING,
    ),
}  # fmt: skip
"""Problem and history of the reference cases, by title."""

LOADS = ("P", "+Q", "-Q", "+Q again")
"""Names of the corners of a history."""

SHOWN = {
    "peak_pressure": "peak N", "peak_shear": "peak T", "peak_shear_angle": "peak T at",
    "contact_1_start": "contact, left", "contact_1_stop": "contact, right", "stick_1_start": "stick, left",
    "stick_1_stop": "stick, right", "rotation": "rotation", "dx": "dx", "dy": "dy", "shear_integral": "int T",
    "shear_magnitude": "int abs T", "dissipation": "dissipated",
}  # fmt: skip
"""The quantities of the reference cases and their headings."""

ROUNDING = 1e-9
"""Errors below this part of a quantity's size are rounding. They are neither shown nor counted."""

SECOND = {"color": "0.8", "linestyle": "-", "linewidth": 2.5}
"""The line of order 2 in the figure."""


def reference_cases(options: Options) -> None:
    """Differences from twice the nodes on the same arc: of angles in rad, of all else in parts of its size."""
    found = {}
    for title, (problem, history) in CASES.items():
        coarse = solve(problem, history, nodes=options.sizes[0]).grid  # with a node where the pin first touches
        grids = (*options.sizes, 2 * options.sizes[-1] - 1)
        *results, reference = (solve(problem, history, grid=coarse.with_nodes(nodes)) for nodes in grids)
        found[title] = _differences(reference, results)
        logs = np.log(options.sizes)
        rows = (
            [load, SHOWN[name], *(f"{e:.1e}" for e in errors), f"{-np.polyfit(logs, np.log(errors), 1)[0]:.1f}"]
            for (load, name), errors in found[title].items()
        )
        show(title, f"load | quantity | {' | '.join(map(str, options.sizes))} | order", rows)
    if options.figure is not None:
        save_drawing(lambda errors: _drawn(options.sizes, errors), found, options.figure, 160.0)


def _differences(reference: Result, results: list[Result]) -> dict[tuple[str, str], list[float]]:
    """The differences of the results from the reference, by load and quantity, coarsest grid first."""
    found = {}
    for load, true, *states in zip(LOADS, reference, *results, strict=False):
        exact = matching_values(true, true)
        for name in SHOWN.keys() & exact.keys():
            scale = 1.0 if name.endswith(("angle", "start", "stop")) else size(name, true)
            errors = [abs(matching_values(true, state)[name] - exact[name]) / scale for state in states]
            if np.all(np.isfinite(errors)) and max(errors) > ROUNDING:
                found[load, name] = errors
    return dict(sorted(found.items(), key=lambda each: (LOADS.index(each[0][0]), [*SHOWN].index(each[0][1]))))


def _drawn(nodes: list[int], found: dict[str, dict[tuple[str, str], list[float]]]) -> Figure:
    """Draw the errors of peaks, edges and borders against the number of nodes, with a panel for each case."""
    names = ("peak_pressure", "peak_shear", "contact_1_stop", "stick_1_stop", "shear_magnitude")
    loads = ("P", "+Q", "+Q again")
    figure, axes = panels(2, 3, height=2.3, width=8.6)
    for panel in axes.flat[len(found) :]:
        panel.set_visible(False)
    for panel, (title, errors) in zip(axes.flat, found.items(), strict=False):
        for (load, name), numbers in errors.items():
            if name in names and load in loads:
                panel.loglog(nodes, numbers, marker=".", **line(names.index(name), loads.index(load), 1.0))
        panel.loglog(nodes, 1e-2 * (np.array(nodes) / nodes[0]) ** -2.0, zorder=0, **SECOND)
        panel.set_title(title.replace(", mu", ",\nmu").replace("friction,", "friction,\n"), fontsize=8)
        panel.set_xlabel("nodes")
        panel.set_xticks(nodes, [str(each) for each in nodes])
        panel.minorticks_off()
    for panel in axes[:, 0]:
        panel.set_ylabel("error, rad or relative")
    by_load = [(load, line(0, dashes)) for dashes, load in enumerate(loads)]
    add_legend(figure, [(SHOWN[name], line(n)) for n, name in enumerate(names)], [*by_load, ("order 2", SECOND)])
    return figure


def finite_elements(_: Options) -> None:
    """Differences from the tractions of finite elements on their nodes, in parts of int N."""

    def rows() -> Iterator[Row]:
        for name in ("frictionless", "monotonic", "fretting_fixed_rotation"):
            model = FiniteElements.read(name)
            states = solve(model.problem, model.history, grid=model.grid)
            for load, state, pressure, one in zip(
                LOADS, states, model.pressure, model.differences(states), strict=False
            ):
                peak = abs(float(state.pressure.max() / pressure.max()) - 1.0)
                yield [f"{name}, {load}", one.normal, one.normal_away, one.shear, one.shear_away, peak]

    show("Finite elements", "case, state | int dN | away | int dT | away | peak N", rows())


def increments(options: Options) -> None:
    """Increments against the path: Ti-6Al-4V in aluminium, body load, 301 nodes; increments grow linearly."""
    problem, _ = CASES["Ti-6Al-4V in aluminium, body load, mu = 0.4, L_p = 0.1"]
    given: dict[str, Any] = {"nodes": 301, "arc": (BOTTOM - 1.25, BOTTOM + 1.25)}
    exact = solve(problem, [{"P": 1.0}], **given)[-1]

    def row(count: int) -> Row:
        state = solve(problem, [{"P": 1.0}], method="increment", increments=count, **given)[-1]
        shear = float(np.abs(state.shear - exact.shear).sum() / exact.pressure.sum())
        return [count, f"{state.peak_pressure:.6f}", abs(state.peak_pressure / exact.peak_pressure - 1.0), shear]

    show(
        "Increments",
        "increments | peak N | difference, relative | int dT / int N",
        map(row, options.sizes),
        orders=True,
    )


def half_plane(options: Options) -> None:
    """Like bodies, held, mu = 0.5, Q = 0.6 mu P against Hertz, and int |dT| / int mu N against Cattaneo-Mindlin."""

    def row(parameter: float) -> Row:
        problem = Problem.from_load_parameter(LIKE, parameter, 0.5, "centre", "fixed")
        result = solve(problem, [{"P": 1.0}, {"Q": 0.3}, {"Q": -0.3}, {"Q": 0.3}], nodes=options.sizes[0])
        half, top = closed_forms.hertz_half_angle(parameter), closed_forms.hertz_peak_pressure(parameter)
        start, stop = result[1].stick[0]
        apart = cattaneo_mindlin_differences(result[1:], 0.6)
        return [parameter, result[0].peak_pressure / top - 1.0, *apart, f"{0.5 * (stop - start) / half:.5f}"]

    header = "L_p | peak N over Hertz - 1 | +Q | -Q | +Q again | c/a"
    show("Cattaneo-Mindlin", header, map(row, (2.0, 20.0, 200.0, 2000.0)), orders=True)


def sliding_terms(options: Options) -> None:
    """Eq. (58), mu = 0.4, L_p = 0.1, Q = 0.4 P: differences from twice as many terms as in the last row."""
    load = {"P": 1.0, "Q": 0.4}
    problems = [Problem.from_load_parameter(pair, 0.1, 0.4) for pair in (LIKE, UNLIKE)]
    exact = [solve_sliding(problem, load, terms=2 * options.sizes[-1]) for problem in problems]

    def row(count: int) -> Iterator[object]:
        yield count
        for problem, true in zip(problems, exact, strict=True):
            found = solve_sliding(problem, load, terms=count)
            yield abs(found.peak_pressure / true.peak_pressure - 1.0)
            yield float(np.abs(np.subtract(found.contact, true.contact)).max())

    show(
        "Full sliding",
        "terms | like: peak, relative | ends, rad | unlike: peak, relative | ends, rad",
        (list(row(n)) for n in options.sizes),
    )


def sliding(options: Options) -> None:
    """The path solver against Eq. (58): rotation held, mu = 0.3, L_p = 0.5, P and then Q = P."""

    def row(nodes: int) -> Iterator[object]:
        yield nodes
        for pair in (LIKE, UNLIKE):
            problem = Problem.from_load_parameter(pair, 0.5, 0.3, "centre", "fixed")
            true = solve_sliding(problem, {"P": 1.0, "Q": 1.0})
            state = solve(problem, [{"P": 1.0}, {"Q": 1.0}], nodes=nodes)[-1]
            yield abs(state.peak_pressure / true.peak_pressure - 1.0)
            yield abs(state.resultants["M"] / true.moment - 1.0)
            yield float(np.abs(np.subtract(state.contact[0], true.contact)).max())

    header = "nodes | like: peak | moment | ends, rad | unlike: peak | moment | ends, rad"
    show("Full sliding by the path", header, (list(row(nodes)) for nodes in options.sizes))


def singular_equations(options: Options) -> None:
    """Largest residuals of (46) and (47) in F beta*, away from edges and borders (0.085 rad)."""
    problem, history = CASES["Ti-6Al-4V in aluminium, body load, mu = 0.4, L_p = 0.1"]
    rows = ([nodes, *residuals_away(solve(problem, history, nodes=nodes)[-1], 0.085)] for nodes in options.sizes)
    show("Singular integral equations", "nodes | (46) | (47)", rows, orders=True)


# -- docs/bush.md --------------------------------------------------------------------------------------------


def seat(options: Options) -> None:
    """A bush that slips in its seat: the numbers at the end of the ten cases of another program."""
    for name, (make, corners) in joints.CASES.items():
        found = {
            nodes: joints.numbers(solve(make(), corners, nodes=nodes, arc=ALL_ROUND, slip_sums=True))
            for nodes in options.sizes
        }
        rows = ([nodes, *(f"{each:.7g}" for each in numbers.values())] for nodes, numbers in found.items())
        show(name, " | ".join(["nodes", *found[options.sizes[0]]]), rows)


# -- docs/wear-accuracy.md -----------------------------------------------------------------------------------


def lives(options: Options) -> None:
    """Volume, depth, pressure at the bottom and dissipation of lives, by nodes and fat cycles."""

    def row(name: str, nodes: int, fat: int) -> Row:
        volume, depth, bottom, lost = numbers_of(WEAR_CASES[name], *lived(WEAR_CASES[name], nodes, fat)[:2])
        return [name, nodes, fat, f"{volume:.6e}", f"{depth:.6f}", f"{bottom:.6f}", f"{lost:.5e}"]

    grids = [(options.sizes[0], 40), *((nodes, 160) for nodes in options.sizes)]
    rows = (row(name, *grid) for name in WEAR_CASES for grid in grids)
    show("Lives", "life | nodes | fat cycles | volume | depth | N, bottom | D", rows)


def path(options: Options) -> None:
    """The wear path of partial slip: parts, increments, and the balance of energy."""
    once, depth = ready_to_wear()
    before, many = once.now, ready_to_wear()[0]
    once.wear(depth)
    parts_of(many, depth, 64)
    pairs = [(getattr(once.now, name), getattr(many.now, name)) for name in ("pressure", "shear", "gap", "slip")]
    print(f"\nOne path against 64: {max(np.abs(one - other).max() / np.abs(one).max() for one, other in pairs):.1e}")

    def by_increments(count: int) -> Row:
        now = before
        for _ in range(count):
            found = implicit_step(once.system, replace(now, rest_gap=now.rest_gap + depth / count), now.load)
            assert found is not None
            now = found
        return [count, *(float(np.abs(getattr(now, n) - getattr(once.now, n)).max()) for n in ("pressure", "shear"))]

    def balance(nodes: int) -> Iterator[object]:
        yield nodes
        for softness in (None, 0.2 * np.ones(nodes)):
            run, depth = ready_to_wear(nodes)
            energy, removal = review(run.system, run.now).energy, run.wear(depth, softness)
            grown = review(run.system, run.now).energy - energy
            yield removal.work - grown - removal.dissipation - removal.energy

    show("The wear path", "increments of the gap | N | T", map(by_increments, (10, 40, 160, 640)))
    header = "nodes | work - energy - dissipation - removed | the same with the implicit way"
    show("Balance of energy", header, (list(balance(nodes)) for nodes in options.sizes))


def wear_of_half_planes(options: Options) -> None:
    """Wear in partial slip of half-planes, by nodes in half the stick zone: errors in percent."""
    rows = (
        [f"{at:g}", nodes, *(100.0 * (r.ours / r.reference - 1.0) for r in half_planes(nodes, at, Solving()))]  # type: ignore[operator]
        for at in (200.0, 2e4, 2e6)
        for nodes in options.sizes
    )
    show("Half-planes", "L_p | nodes in half the stick zone | volume, % | depth, % | N, middle, %", rows)


def wear_of_rigid_bodies(_: Options) -> None:
    """Wear by a pin that slides one way, against rigid bodies."""

    def row(clearance: float, nodes: int, steps: int) -> Row:
        problem = Problem.from_load_parameter(LIKE, clearance, 0.2, "centre", "fixed")
        run, worn = wearing(problem, Grid.arc(BOTTOM - 1.7, BOTTOM + 1.7, nodes)), np.zeros(nodes)
        step(run, {"P": 1.0})
        for number in range(1, steps + 1):
            worn = worn + run.wear(1e-3 * step(run, {"rotation": 8e3 * number / steps})[0]).depth
        top = int(np.argmax(worn))
        below, middle, above = worn[top - 1 : top + 2]
        shift = 0.5 * (above - below) / (2.0 * middle - below - above)
        tilt = run.system.grid.theta[top] - BOTTOM + shift * run.system.weights[top]
        found = middle + 0.25 * (above - below) * shift, run.now.pressure.max(), tilt
        exact = wear_limits.rigid_sliding(clearance, 8.0, 0.2)
        return [f"{clearance:g}", nodes, steps, *(f"{each:.4f}" for each in (*found, *exact))]

    cases = [(at, *grid) for at in (1.0, 10.0) for grid in ((31, 800), (61, 1600), (61, 3200), (121, 3200))]
    header = "clearance, F beta* | nodes | steps | depth | N0 | tilt | depth, rigid | N0, rigid"
    show("One way", header, (row(*case) for case in cases))


def friction(options: Options) -> None:
    """Friction that varies along the rim, and friction that falls with the loads."""
    fretted = [{"P": 1.0}, {"Q": 0.2}, {"Q": -0.2}, {"P": 0.5}, {"P": 1.0, "Q": 0.2}]
    falling = Problem.from_load_parameter(UNLIKE, 0.1, 0.5, "body")
    history = [{"P": 1.0}, {"Q": 0.2}, {"P": 0.8, "Q": -0.1, "friction_change": -0.6}]

    def along(nodes: int) -> Row:
        last = solve(ROUGH, fretted, grid=Grid.circle(nodes))[-1]
        sums = (float(last.grid.weights @ each) for each in (last.pressure, last.shear))
        left = last.work - last.energy - last.dissipation
        return [nodes, *(f"{each:.5f}" for each in (last.peak_pressure, *sums, last.dx)), left]

    def changed(nodes: int) -> Row:
        before, last = solve(falling, history, grid=Grid.arc(BOTTOM - 1.6, BOTTOM + 1.6, nodes))[-2:]
        lost, left = last.dissipation - before.dissipation, last.work - last.energy - last.dissipation
        return [nodes, f"{last.peak_pressure:.5f}", f"{last.rotation:.5f}", f"{lost:.6f}", left]

    header = "nodes | peak N | int N | int T | dx | work - energy - dissipation"
    show("Friction along the rim", header, map(along, options.sizes))
    header = "nodes | peak N | rotation | D of the step | work - energy - dissipation"
    show("Friction that falls", header, map(changed, (61, 121, 241)))


# -- docs/convergence.md -------------------------------------------------------------------------------------

TIMES = (2, 4, 8)
"""Refinements of the finer grids, in intervals. The last one is the reference, the one before tells its doubt."""

BESIDE = 2.0
"""Points within so many node distances of an edge, border or old border are counted apart."""

Found = dict[str, list[Any]]
"""Errors, doubts and bars by group of quantities, in parts of what the table says."""


def random_case(seed: int) -> RandomCase:
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
    mu = 0.0 if rng.random() < 0.1 else rng.uniform(0.05, 1.0)
    pin_load, rotation = (("body", "free"), ("centre", "free"), ("centre", "fixed"))[rng.integers(3)]
    problem = Problem.from_load_parameter(MaterialPair(pin, plate, plane), load_parameter, mu, pin_load, rotation)
    pull = mu or 0.5
    if rng.random() < 0.3:
        corners = [{"P": 1.0, "Q": pull * rng.uniform(-0.7, 0.7)}]
        least = 0.3 if rng.random() < 0.5 else 1.0
    else:
        amplitude = pull * rng.uniform(0.1, 0.7)
        corners = [{"P": 1.0}, {"Q": amplitude}, {"Q": -amplitude}, {"Q": amplitude}]
        least = 0.75 if rng.random() < 0.3 else 1.0
    if least < 1.0:
        corners.append({"P": rng.uniform(least, 1.0)})
    return RandomCase(problem, LoadHistory(corners))


def error_bars(options: Options) -> None:
    """How often error bars hold: of two grids, of studies of four grids, and of the tractions.

    *Surely held*: the bar covers the error and the doubt of the reference. *Surely broken*: it does not cover the error
    minus this doubt.
    """
    pairs, studies, points = (collections.defaultdict(list) for _ in range(3))
    known = [(kind, seed) for kind in options.classes for seed in range(options.first, options.first + options.cases)]
    failed = states = 0
    for kind, seed in tqdm(known, disable=None, delay=2.0):
        case = generate(kind, seed) if kind else random_case(seed)
        try:
            result = solve(case.problem, case.history, nodes=options.sizes[0], error_bars=True)
            finer = [solve(case.problem, case.history, grid=_refined(result.grid, times)) for times in TIMES]
        except FastpinError:
            failed += 1
            continue
        for state, *better in zip(result, *finer, strict=True):
            states += 1
            _count_quantities(state, better, pairs, studies)
            if state.in_contact:
                _count_points(state, better, points, kind)
    print(f"{len(known) - failed} cases, {states} states, {options.sizes[0]} nodes; {failed} cases without equilibrium")
    shares = "held, % | surely held, % | surely broken, % | bar / error, median"
    show("Two grids", f"quantity | values | {shares} | no bar", map(_row_of_pairs, pairs.items()))
    every = [*studies.items(), ("all", [row for each in studies.values() for row in each])]
    header = "quantity | values | order observed, % | held if observed, % | held if not, % | bar / error, median"
    show("Studies", header, map(_row_of_studies, every))
    header = f"tractions | points | {shares} | bar / peak N, median | 95 % of bars below"
    show("Tractions", header, map(_row_of_points, points.items()))


def _refined(grid: Grid, times: int) -> Grid:
    """A grid on the same arc or circle with `times` as many intervals."""
    return grid.with_nodes(times * grid.size if grid.closed else times * (grid.size - 1) + 1)


def _count_quantities(state: State, better: list[State], pairs: Found, studies: Found) -> None:
    """Add (error, doubt, bar) of each quantity to `pairs`, None without a bar; (error, bar, observed) to `studies`."""
    bars = state.error_bars
    assert bars is not None
    *sequence, true = (matching_values(state, other) for other in (bars.coarse, state, *better))
    for name, value in values(state).items():
        group = name if name in QUANTITIES else f"{name.split('_')[0]} ends"
        rounding, error, doubt = (
            ROUNDING * size(name, state),
            abs(value - true[name]),
            abs(sequence[-1][name] - true[name]),
        )
        if math.isinf(bars[name]) or math.isnan(doubt):
            if not math.isnan(value):
                pairs[group].append(None)
        elif error > rounding:
            pairs[group].append((error, doubt, bars[name]))
        found = estimate((8.0, 4.0, 2.0, 1.0), [each[name] for each in sequence], rounding)
        if found.verdict in ("observed", "converged", "not converged") and doubt > rounding:
            studies[group].append((doubt, found.bar, found.verdict == "observed"))


def _count_points(state: State, better: list[State], points: Found, kind: str) -> None:
    """Add (error, doubt, bar) of the tractions in parts of the peak pressure, shape (3, points), by place and class."""
    bars, grid = state.error_bars, state.grid
    assert bars is not None
    nodal = [
        np.array([each.pressure, each.shear])[:, ::times]
        for each, times in zip((state, *better[-2:]), (1, *TIMES[-2:]), strict=True)
    ]
    spacing = float(np.median(grid.weights))
    theta = np.concatenate([grid.theta + 0.25 * part * spacing for part in range(4)])
    curves = [tractions_at(traction_patches(each), np.degrees(theta) + 90.0) for each in (state, *better[-2:])]
    for what, angles, (mine, half, true), known in (
        ("at nodes", grid.theta, nodal, (bars.pressure, bars.shear)),
        ("of curves", theta, curves, bars.of_curves(theta)),
    ):
        error, doubt, place = np.abs(mine - true), np.abs(half - true), _places(state, angles, spacing)
        for row, name in enumerate(("N", "T")):
            touched = (error[row] > ROUNDING * state.peak_pressure) & (mine[0] + true[0] > 0.0)
            numbers = np.array([error[row], doubt[row], known[row]]) / state.peak_pressure
            for group in np.unique(place[touched]):
                points[f"{name} {what}, {group}"].append(numbers[:, touched & (place == group)])
            if kind:
                points[f"{name} {what}, class {kind}"].append(numbers[:, touched])


def _places(state: State, theta: np.ndarray, spacing: float) -> np.ndarray:
    """Words on the place of each angle."""
    words = np.full(theta.size, "elsewhere", dtype=object)
    old = state.theta[state.old_borders != 0] if state.old_borders is not None else []
    borders, edges = (np.ravel(intervals(state, zone)) for zone in ("stick", "contact"))
    for name, angles in (("old borders", old), ("borders", borders), ("edges", edges)):
        for angle in angles:
            words[np.abs(angle_between(theta, angle)) < BESIDE * spacing] = f"beside {name}"
    return words


def _shares(error: np.ndarray, doubt: np.ndarray, bar: np.ndarray) -> list[str]:
    parts = error <= bar, error + doubt <= bar, error - doubt > bar
    return [*(f"{100.0 * np.mean(part):.1f}" for part in parts), f"{np.median(bar / error):.1f}"]


def _row_of_pairs(item: tuple[str, list[Any]]) -> Row:
    group, rows = item
    counted = [row for row in rows if row is not None]
    return [group, len(counted), *_shares(*np.array(counted).reshape(-1, 3).T), len(rows) - len(counted)]


def _row_of_studies(item: tuple[str, list[Any]]) -> Row:
    group, rows = item
    error, bar, seen = np.array(rows, dtype=float).T
    parts = [(error <= bar)[seen == value] for value in (1.0, 0.0)]
    held = [f"{100.0 * np.mean(part):.1f}" if part.size else "-" for part in parts]
    return [group, error.size, f"{100.0 * np.mean(seen):.0f}", *held, f"{np.median(bar / error):.1f}"]


def _row_of_points(item: tuple[str, list[Any]]) -> Row:
    error, doubt, bar = np.concatenate(item[1], axis=1)
    return [item[0], error.size, *_shares(error, doubt, bar), f"{np.median(bar):.5f}", f"{np.quantile(bar, 0.95):.4f}"]


# -- docs/reproducibility.md ---------------------------------------------------------------------------------

CLASSES = ("general", "remote", "fits", "fixed", "moderate_stress")
"""Classes without extremes: their histories hang on no single digit."""

ENDS = tuple(f"{zone}_{k}_{end}" for zone in ZONES for k in range(1, 9) for end in ("start", "stop"))

GROUPS = {
    "peaks": ("peak_pressure", "peak_shear"), "edges": ENDS, "motion": ("dx", "dy", "rotation"),
    "dissipation": ("dissipation",),
}  # fmt: skip
"""The names of the key figures, by group."""

NAMES = tuple(name for names in GROUPS.values() for name in names)

FIGURES = "figures of "
"""Begins the names of the arrays of key figures."""


def rounding(options: Options) -> None:
    """How far rounding carries: store random histories, or compare two files of them."""
    if options.compare:
        compare_rounding(*options.compare)
    else:
        np.savez(options.store, **_stored(options.cases))


def _stored(count: int) -> dict[str, np.ndarray]:
    """Tractions, shape (states, 2, n), and key figures with bars and sizes, shape (states, names, 3), by history."""
    found = {}
    for kind, seed in ((kind, seed) for kind in CLASSES for seed in range(count)):
        case = generate(kind, seed)
        given = case.options | {"nodes": max(case.options["nodes"], 101)}  # error bars need so many
        try:
            result = solve(case.problem, case.history, **given, error_bars=True)
        except SolveError:
            continue
        found[f"{kind} {seed}"] = np.array([(state.pressure, state.shear) for state in result])
        found[f"{FIGURES}{kind} {seed}"] = np.array([_figures(state) for state in result])
    return found


def _figures(state: State) -> list[tuple[float, float, float]]:
    """Value, bar and natural size of each key figure; NaN for ends of intervals that the state does not have."""
    found, bars, natural = values(state), state.error_bars, sizes(state)
    assert bars is not None
    return [
        (found.get(name, math.nan), bars.get(name, math.nan), natural[quantity(name).kind]) for name in NAMES
    ]  # fmt: skip


def compare_rounding(old: Path, new: Path) -> None:
    """Print the differences between two files. A history that only one file has is infinitely far.

    The difference of a history's tractions is the largest one, in parts of the peak pressure of the state. Differences
    of figures and bars are in parts of the largest figure of the row in the history; of edges, of the contact's width.
    """
    tractions, parts = [], []
    with np.load(old) as before, np.load(new) as after:
        for name in sorted(name for name in {*before.files, *after.files} if not name.startswith(FIGURES)):
            if {name} <= {*before.files} & {*after.files} and before[name].shape == after[name].shape:
                peaks = before[name][:, 0].max(axis=1)
                apart = np.abs(before[name] - after[name]).max(axis=(1, 2))
                tractions.append((apart[peaks > 0.0] / peaks[peaks > 0.0]).max(initial=0.0))
                parts.append(_figure_differences(before[FIGURES + name], after[FIGURES + name]))
            else:
                tractions.append(np.inf)
    rows = [_row_of_differences("tractions", np.array(tractions))]
    for group, names in GROUPS.items():
        columns = [NAMES.index(name) for name in names]
        each = (np.concatenate([part[k][:, columns].ravel() for part in parts]) for k in range(3))
        rows.append(_row_of_differences(group, *each))
    header = " | compared | the same bits | median | largest | bars, median | bars, largest | outside their bars"
    show("Rounding", header, rows)


def _figure_differences(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Differences of figures and of bars, and whether the bars hold, shape (3, states, names); NaN without a figure."""
    largest = []
    for group, names in GROUPS.items():
        columns = one[:, [NAMES.index(name) for name in names]]
        whole = columns[:, :, 2].max(axis=0) if group == "edges" else np.nanmax(np.abs(columns[:, :, 0]))
        largest.append(np.broadcast_to(whole, len(names)))
    with np.errstate(divide="ignore", invalid="ignore"):
        apart = np.abs(one - other)[:, :, :2].transpose(2, 0, 1)
        here, there = (np.isfinite(each)[:, :, :2].transpose(2, 0, 1) for each in (one, other))
        apart = np.where(here & there, apart, np.where(here | there, np.inf, np.nan))
        bars = np.fmax(one[:, :, 1], other[:, :, 1])
        held = np.where(np.isnan(apart[0]) | np.isnan(bars), np.nan, apart[0] <= bars)
        return np.stack([*np.where(apart == 0.0, 0.0, apart / np.concatenate(largest)), held])


def _row_of_differences(name: str, apart: np.ndarray, bars: np.ndarray = np.empty(0), held: Any = ()) -> Row:  # noqa: B008
    apart, bars = apart[~np.isnan(apart)], bars[~np.isnan(bars)]
    cells = [name, f"{apart.size}", f"{np.sum(apart == 0.0)}", f"{np.median(apart):.0e}", f"{apart.max():.0e}"]
    if not bars.size:
        return [*cells, "", "", ""]
    return [*cells, f"{np.median(bars):.0e}", f"{bars.max():.0e}", f"{np.sum(held == 0.0)}"]


TABLES: dict[str, tuple[Callable[[Options], None], tuple[int, ...]]] = {
    "closed_form": (closed_form, (100, 200, 400, 800, 1600)),
    "reference_cases": (reference_cases, NODES),
    "finite_elements": (finite_elements, ()),
    "increments": (increments, (20, 40, 80, 160, 320)),
    "half_plane": (half_plane, (401,)),
    "sliding_terms": (sliding_terms, (4, 8, 12, 16, 32, 64, 128)),
    "sliding": (sliding, NODES),
    "singular_equations": (singular_equations, NODES),
    "seat": (seat, (64, 128, 256)),
    "lives": (lives, (121, 241, 481)),
    "path": (path, (61, 121, 241, 481)),
    "wear_of_half_planes": (wear_of_half_planes, (6, 12, 24, 48)),
    "wear_of_rigid_bodies": (wear_of_rigid_bodies, ()),
    "friction": (friction, (120, 240, 480, 960)),
    "error_bars": (error_bars, (201,)),
    "rounding": (rounding, ()),
}
"""The tables, each with its numbers of nodes, terms or increments."""


def main() -> None:
    """Run the command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("tables", nargs="+", choices=TABLES, metavar="TABLE", help=", ".join(TABLES))
    parser.add_argument("--sizes", type=lambda text: [int(each) for each in text.split(",")])
    parser.add_argument("--figure", type=Path, metavar="FILE")
    parser.add_argument("--cases", type=int, default=40)
    parser.add_argument("--first", type=int, default=0, metavar="SEED")
    parser.add_argument("--classes", type=lambda text: text.split(","), default=[""], help=", ".join(GENERATORS))
    parser.add_argument("--store", type=Path, metavar="FILE.npz", default=Path("rounding.npz"))
    parser.add_argument("--compare", type=Path, nargs=2, metavar="FILE.npz")
    options = parser.parse_args()
    for name in options.tables:
        function, usual = TABLES[name]
        function(Options(**{**vars(options), "sizes": options.sizes or list(usual)}))


if __name__ == "__main__":
    main()
