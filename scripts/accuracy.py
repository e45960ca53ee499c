"""The tables of docs/accuracy-tables.md and the figure of docs/accuracy.md.

The errors are against finer grids, closed forms, finite elements and increments.

``python scripts/accuracy.py`` prints the tables as Markdown. It takes some minutes. ``--figure FILE`` draws the errors
of the reference cases, ``--quick`` uses small grids, ``--only NAME`` makes one part.
"""

from __future__ import annotations

import argparse
import math
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from fastpin.figures.style import add_legend, line, panels, save_drawing
from fastpin.model.angles import BOTTOM
from fastpin.model.problem import Problem
from fastpin.solver.result import Result
from fastpin.solver.solving import solve
from fastpin.states.quantities import matching_values, size
from fastpin.verification import closed_forms
from fastpin.verification.comparisons import cattaneo_mindlin_differences, residuals_away
from fastpin.verification.finite_elements import FRETTING, LIKE, UNLIKE, FiniteElements
from fastpin.verification.sliding import solve_sliding


def order(sizes: list[int], errors: list[float]) -> float:
    """Return the observed order: the slope of a straight line through the logarithms."""
    return float(-np.polyfit(np.log(sizes), np.log(errors), 1)[0])


def table(header: list[str], rows: list[list[object]]) -> None:
    """Print a Markdown table."""
    print("\n| " + " | ".join(header) + " |")
    print("|" + "---|" * len(header))
    for row in rows:
        print("| " + " | ".join(f"{v:.3g}" if isinstance(v, float) else str(v) for v in row) + " |")


def closed_form(sizes: list[int]) -> None:
    """Print the errors of frictionless contact against Persson's closed form."""
    print("\n## Frictionless: Persson's closed form")
    print("\nRoot mean square over 16 load parameters between 0.01 and 2 and as many arcs, both edges.")
    rng = np.random.default_rng(0)
    cases = [(10.0 ** rng.uniform(-2.0, 0.3), rng.uniform(1.08, 1.3, 2)) for _ in range(16)]
    edges, peaks = [], []
    for nodes in sizes:
        edge, peak = [], []
        for load_parameter, wide in cases:
            exact = closed_forms.persson_half_angle(load_parameter)
            arc = (BOTTOM - wide[0] * exact, BOTTOM + wide[1] * exact)
            problem = Problem.from_load_parameter(LIKE, load_parameter, 0.0)
            state = solve(problem, [{"P": 1.0}], nodes=nodes, arc=arc)[-1]
            edge += [state.contact[0][1] - BOTTOM - exact, state.contact[0][0] - BOTTOM + exact]
            peak.append(state.peak_pressure / closed_forms.persson_pressure(0.0, exact) - 1.0)
        edges.append(math.sqrt(np.mean(np.square(edge))))
        peaks.append(math.sqrt(np.mean(np.square(peak))))
    rows = [[n, e, p] for n, e, p in zip(sizes, edges, peaks, strict=True)]
    table(["nodes", "edge, rad", "peak pressure, relative"], rows)
    print(f"\nOrders: edge {order(sizes, edges):.2f}, peak pressure {order(sizes, peaks):.2f}.")


CASES = {
    "like bodies without friction, L_p = 0.1": (Problem.from_load_parameter(LIKE, 0.1, 0.0), [{"P": 1.0}]),
    "Ti-6Al-4V in aluminium, body load, mu = 0.4, L_p = 0.1": (
        Problem.from_load_parameter(UNLIKE, 0.1, 0.4, "body"),
        [{"P": 1.0}],
    ),
    "like bodies, body load, mu = 0.4, L_p = 0.1": (
        Problem.from_load_parameter(LIKE, 0.1, 0.4, "body"),
        [{"P": 1.0}],
    ),
    "like bodies, held, mu = 0.55, L_p = 0.5": (
        Problem.from_load_parameter(LIKE, 0.5, 0.55, "centre", "fixed"),
        FRETTING,
    ),
    "like bodies, free, body load, mu = 0.55, L_p = 0.05": (
        Problem.from_load_parameter(LIKE, 0.05, 0.55, "body"),
        FRETTING,
    ),
}
"""Title, problem and history of the reference cases."""
LOADS = ("P", "+Q", "-Q", "+Q again")
"""Names of the corners of a history."""
SHOWN = {
    "peak_pressure": "peak N",
    "peak_shear": "peak T",
    "peak_shear_angle": "peak T at",
    "contact_1_start": "contact, left",
    "contact_1_stop": "contact, right",
    "stick_1_start": "stick, left",
    "stick_1_stop": "stick, right",
    "rotation": "rotation",
    "dx": "dx",
    "dy": "dy",
    "shear_integral": "int T",
    "shear_magnitude": "int abs T",
    "dissipation": "dissipated",
}
"""The quantities in the tables and their headings."""
ROUNDING = 1e-9
"""A quantity with errors below this part of its size on all grids is exact. It is not shown."""

SECOND = {"color": "0.8", "linestyle": "-", "linewidth": 2.5}
"""The line of order 2 in the figure."""

Errors = dict[str, dict[tuple[str, str], list[float]]]
"""Errors by title of the case, and by load and quantity: one for each grid."""


def reference_cases(sizes: list[int], finest: int, figure: Path | None) -> None:
    """Print, and draw, the differences of the reference cases from a grid with `finest` nodes."""
    print("\n## The reference cases")
    print(f"\nDifferences from {finest} nodes on the same arc; of angles in rad, of all else in parts of its size: the")
    print("peak pressure, int N, and strains and energies made of these. The order is the slope of a straight line")
    print("through the logarithms.")
    found: Errors = {}
    for title, (problem, history) in CASES.items():
        coarse = solve(problem, history, nodes=sizes[0]).grid  # with a node where the pin first touches
        *results, reference = (solve(problem, history, grid=coarse.with_nodes(nodes)) for nodes in (*sizes, finest))
        print(f"\n### {title[0].upper()}{title[1:]}")
        found[title] = _differences(reference, results)
        rows: list[list[object]] = []
        for (load, name), errors in found[title].items():
            rows.append([load, SHOWN[name], *(f"{error:.1e}" for error in errors), f"{order(sizes, errors):.1f}"])
        table(["load", "quantity", *(str(nodes) for nodes in sizes), "order"], rows)
    if figure is not None:
        save_drawing(lambda errors: _drawn(sizes, errors), found, figure, 160.0)


def _differences(reference: Result, results: list[Result]) -> dict[tuple[str, str], list[float]]:
    """Return the differences of the results from the reference, by load and quantity, coarsest grid first."""
    found = {}
    for load, true, *states in zip(LOADS, reference, *results, strict=False):
        exact = matching_values(true, true)
        for name in SHOWN:
            if name not in exact:
                continue
            scale = 1.0 if name.endswith(("angle", "start", "stop")) else size(name, true)
            errors = [abs(matching_values(true, state)[name] - exact[name]) / scale for state in states]
            if np.all(np.isfinite(errors)) and max(errors) > ROUNDING:
                found[load, name] = errors
    return found


def _drawn(sizes: list[int], found: Errors) -> Figure:
    """Draw the errors of peaks, edges and borders against the number of nodes, with a panel for each case."""
    names = ("peak_pressure", "peak_shear", "contact_1_stop", "stick_1_stop", "shear_magnitude")
    figure, axes = panels(2, 3, height=2.3, width=8.6)
    for panel in axes.flat[len(found) :]:
        panel.set_visible(False)
    for panel, (title, errors) in zip(axes.flat, found.items(), strict=False):
        for (load, name), values in errors.items():
            if name in names and load in (LOADS[0], LOADS[1], LOADS[3]):
                dashes = (LOADS[0], LOADS[1], LOADS[3]).index(load)
                panel.loglog(sizes, values, marker=".", **line(names.index(name), dashes, 1.0))
        panel.loglog(sizes, 1e-2 * (np.array(sizes) / sizes[0]) ** -2.0, zorder=0, **SECOND)
        panel.set_title(title.replace(", mu", ",\nmu").replace("friction,", "friction,\n"), fontsize=8)
        panel.set_xlabel("nodes")
        panel.set_xticks(sizes, [str(nodes) for nodes in sizes])
        panel.minorticks_off()
    axes[0, 0].set_ylabel("error, rad or relative")
    axes[1, 0].set_ylabel("error, rad or relative")
    add_legend(
        figure,
        [(SHOWN[name], line(colour)) for colour, name in enumerate(names)],
        [*((load, line(0, dashes)) for dashes, load in enumerate(("P", "+Q", "+Q again"))), ("order 2", SECOND)],
    )
    return figure


def finite_elements() -> None:
    """Print the differences from the stored tractions of finite elements."""
    print("\n## Finite-element tractions")
    print(
        "\nOn the finite elements' own nodes; integrals in parts of int N. *Away*: without six nodes on either side of"
    )
    print("each contact edge, and of each border between stick and slip, old or new.")
    rows: list[list[object]] = []
    for name in ("frictionless", "monotonic", "fretting_fixed_rotation"):
        model = FiniteElements.read(name)
        states = solve(model.problem, model.history, grid=model.grid)
        for label, state, pressure, one in zip(
            ("P", "plusQ", "minusQ", "plusQ2"), states, model.pressure, model.differences(states), strict=False
        ):
            peak = abs(float(state.pressure.max() / pressure.max()) - 1.0)
            rows.append([f"{name}, {label}", one.normal, one.normal_away, one.shear, one.shear_away, peak])
    table(["case, state", "int dN", "away", "int dT", "away", "peak N"], rows)


def increments(counts: list[int]) -> None:
    """Print the differences of the increment solver from the path solver."""
    print("\n## Increments against the path")
    print("\nTi-6Al-4V in aluminium, body load, mu = 0.4, L_p = 0.1, 301 nodes; increments that grow linearly.")
    problem = Problem.from_load_parameter(UNLIKE, 0.1, 0.4, "body")
    arc = (BOTTOM - 1.25, BOTTOM + 1.25)
    exact = solve(problem, [{"P": 1.0}], nodes=301, arc=arc)[-1]
    rows, errors = [], []
    for count in counts:
        state = solve(problem, [{"P": 1.0}], nodes=301, arc=arc, method="increment", increments=count)[-1]
        errors.append(abs(state.peak_pressure / exact.peak_pressure - 1.0))
        shear = float(np.abs(state.shear - exact.shear).sum() / exact.pressure.sum())
        rows.append([count, f"{state.peak_pressure:.6f}", errors[-1], shear])
    table(["increments", "peak N", "difference, relative", "int dT / int N"], rows)
    print(f"\nPath: {exact.peak_pressure:.6f}. Order: {order(counts, errors):.2f}.")


def half_plane(nodes: int) -> None:
    """Print the differences from Hertz and Cattaneo-Mindlin against L_p."""
    print("\n## Cattaneo-Mindlin")
    print(f"\nSimilar materials, held, mu = 0.5, Q = 0.6 mu P, {nodes} nodes; int |dT| / int mu N against L_p.")
    rows, parameters, loading = [], [2.0, 20.0, 200.0, 2000.0], []
    for parameter in parameters:
        problem = Problem.from_load_parameter(LIKE, parameter, 0.5, "centre", "fixed")
        result = solve(problem, [{"P": 1.0}, {"Q": 0.3}, {"Q": -0.3}, {"Q": 0.3}], nodes=nodes)
        half, top = closed_forms.hertz_half_angle(parameter), closed_forms.hertz_peak_pressure(parameter)
        row: list[object] = [f"{parameter:g}", result[0].peak_pressure / top - 1.0]
        row += cattaneo_mindlin_differences(result[1:], 0.6)
        loading.append(row[2])
        start, stop = result[1].stick[0]
        rows.append([*row, f"{0.5 * (stop - start) / half:.5f}"])
    table(["L_p", "peak N over Hertz - 1", "+Q", "-Q", "+Q again", "c/a"], rows)
    print(f"\nFalls as L_p^-{order([int(p) for p in parameters], loading):.2f}; c/a tends to {math.sqrt(0.4):.5f}.")


def full_sliding(terms: list[int], sizes: list[int]) -> None:
    """Print the convergence of full sliding by Eq. (58), and the differences of the path solver from it."""
    print("\n## Full sliding")
    print("\nEq. (58) on its own, mu = 0.4, L_p = 0.1, Q = 0.4 P; differences from twice as many terms as in the last")
    print("row. Like bodies, and Ti-6Al-4V in aluminium.")
    load = {"P": 1.0, "Q": 0.4}
    problems = [Problem.from_load_parameter(pair, 0.1, 0.4) for pair in (LIKE, UNLIKE)]
    exact = [solve_sliding(problem, load, terms=2 * terms[-1]) for problem in problems]
    rows: list[list[object]] = []
    for count in terms:
        row: list[object] = [count]
        for problem, true in zip(problems, exact, strict=True):
            found = solve_sliding(problem, load, terms=count)
            row.append(abs(found.peak_pressure / true.peak_pressure - 1.0))
            row.append(float(np.abs(np.subtract(found.contact, true.contact)).max()))
        rows.append(row)
    table(["terms", "like: peak, relative", "ends, rad", "unlike: peak, relative", "ends, rad"], rows)
    print("\nThe path solver against it, rotation held, mu = 0.3, L_p = 0.5, P and then Q = P, which slides.")
    rows = []
    for nodes in sizes:
        row = [nodes]
        for pair in (LIKE, UNLIKE):
            problem = Problem.from_load_parameter(pair, 0.5, 0.3, "centre", "fixed")
            true = solve_sliding(problem, {"P": 1.0, "Q": 1.0})
            state = solve(problem, [{"P": 1.0}, {"Q": 1.0}], nodes=nodes)[-1]
            row.append(abs(state.peak_pressure / true.peak_pressure - 1.0))
            row.append(abs(state.resultants["M"] / true.moment - 1.0))
            row.append(float(np.abs(np.subtract(state.contact[0], true.contact)).max()))
        rows.append(row)
    table(["nodes", "like: peak", "moment", "ends, rad", "unlike: peak", "moment", "ends, rad"], rows)


def singular_equations(sizes: list[int]) -> None:
    """Print the residuals of the singular integral equations (46), (47)."""
    print("\n## The singular integral equations (46), (47)")
    print("\nLargest residual, in units of F beta*, of Ti-6Al-4V in aluminium as above, with Cauchy matrices built on")
    print("their own, inside the contact and away from edges and borders (0.085 rad).")
    problem = Problem.from_load_parameter(UNLIKE, 0.1, 0.4, "body")
    rows, first, second = [], [], []
    for nodes in sizes:
        state = solve(problem, [{"P": 1.0}], nodes=nodes)[-1]
        for largest, one in zip((first, second), residuals_away(state, 0.085), strict=True):
            largest.append(one)
        rows.append([nodes, first[-1], second[-1]])
    table(["nodes", "(46)", "(47)"], rows)
    print(f"\nOrders: {order(sizes, first):.2f} and {order(sizes, second):.2f}.")


def main() -> None:
    """Run the command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="small grids")
    parser.add_argument("--figure", type=Path, metavar="FILE", help="draw the errors of the reference cases")
    parser.add_argument("--only", metavar="NAME", help="one part, by the name of its function")
    options = parser.parse_args()
    quick = options.quick
    sizes = [101, 201] if quick else [101, 201, 401, 801, 1601]
    terms = [4, 8, 12, 16] if quick else [4, 8, 12, 16, 32, 64, 128]
    parts = {
        "closed_form": lambda: closed_form([50, 100, 200] if quick else [100, 200, 400, 800, 1600]),
        "reference_cases": lambda: reference_cases(sizes, 401 if quick else 3201, options.figure),
        "finite_elements": finite_elements,
        "increments": lambda: increments([20, 40] if quick else [20, 40, 80, 160, 320]),
        "half_plane": lambda: half_plane(101 if quick else 401),
        "full_sliding": lambda: full_sliding(terms, sizes),
        "singular_equations": lambda: singular_equations(sizes),
    }
    if options.only is not None and options.only not in parts:
        parser.error(f"--only: one of {', '.join(parts)}")
    for name, part in parts.items():
        if options.only in (None, name):
            part()


if __name__ == "__main__":
    main()
