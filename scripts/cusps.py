"""Peaks of shear at old borders between stick and slip: 21 cases, and their errors with few nodes.

``python -m scripts.cusps`` prints the table as Markdown in some minutes. ``--nodes 401`` chooses the number of nodes,
``--reference 1601 3201`` the grids of the reference: the last one is taken, and its
difference from the one before is the doubt. ``--store FILE`` writes the references to a file, or
reads them from there.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import Any

from fastpin.model.materials import MATERIALS, Material, MaterialPair
from fastpin.model.problem import Problem
from fastpin.solver.result import Result
from fastpin.solver.solving import solve

LIKE = MaterialPair(Material(1.0, 0.3), Material(1.0, 0.3))
TITANIUM = MaterialPair(MATERIALS["Ti-6Al-4V"], MATERIALS["aluminium"])
WEAK = MaterialPair(Material(1.0, 0.3), Material(1.5, 0.3))
STEEL = MaterialPair(Material(3.0, 0.3), Material(1.0, 0.33), "stress")

Case = tuple[MaterialPair, float, float, str, str, list[dict[str, float]]]


def _shakes(first: dict[str, float], *shakes: float) -> list[dict[str, float]]:
    return [first, *({"Q": q} for q in shakes)]


P = {"P": 1.0}
CASES: dict[str, Case] = {
    "L_p 2, held, +-0.02": (LIKE, 2.0, 0.7, "centre", "fixed", _shakes(P, 0.02, -0.02, 0.02)),
    "L_p 2, held, decreasing": (LIKE, 2.0, 0.7, "centre", "fixed", _shakes(P, 0.1, -0.07, 0.04, -0.02, 0.0)),
    "L_p 2, held, to zero": (LIKE, 2.0, 0.7, "centre", "fixed", _shakes(P, 0.05, 0.0)),
    "L_p 2, held, nested": (LIKE, 2.0, 0.7, "centre", "fixed", _shakes(P, 0.1, 0.02, 0.08, 0.04, 0.06)),
    "L_p 0.5, held, decreasing": (LIKE, 0.5, 0.55, "centre", "fixed", _shakes(P, 0.3, -0.2, 0.1, 0.0)),
    "L_p 0.5, held, small": (LIKE, 0.5, 0.55, "centre", "fixed", _shakes(P, 0.05, -0.05, 0.05, 0.0)),
    "L_p 0.05, body, to zero": (LIKE, 0.05, 0.55, "body", "free", _shakes(P, 0.275, 0.0)),
    "L_p 0.05, body, decreasing": (LIKE, 0.05, 0.55, "body", "free", _shakes(P, 0.275, -0.2, 0.1, 0.0)),
    "L_p 0.05, held, small": (LIKE, 0.05, 0.8, "centre", "fixed", _shakes(P, 0.1, -0.05, 0.0)),
    "L_p 20, held, +-0.05": (LIKE, 20.0, 0.6, "centre", "fixed", _shakes(P, 0.05, -0.05, 0.05)),
    "L_p 20, held, decreasing": (LIKE, 20.0, 0.6, "centre", "fixed", _shakes(P, 0.2, -0.15, 0.1, -0.05, 0.0)),
    "L_p 5, centre, free": (LIKE, 5.0, 0.5, "centre", "free", _shakes(P, 0.2, -0.1, 0.05, 0.0)),
    "L_p 1, body, P varied": (LIKE, 1.0, 0.4, "body", "free", [P, {"Q": 0.2}, {"P": 0.8}, {"Q": -0.1}, {"P": 0.9}]),
    "L_p 1, held, P varied": (
        LIKE,
        1.0,
        0.6,
        "centre",
        "fixed",
        [P, {"Q": 0.3}, {"P": 1.2}, {"Q": 0.0}, {"P": 1.0, "Q": 0.1}],
    ),
    "L_p 0.2, held, cycles": (
        LIKE,
        0.2,
        0.5,
        "centre",
        "fixed",
        _shakes(P, *([0.2, -0.2] * 4), 0.1, -0.1, 0.05, 0.0),
    ),
    "L_p 0.2, body, low mu": (LIKE, 0.2, 0.15, "body", "free", _shakes(P, 0.1, -0.05, 0.02, 0.0)),
    "L_p 0.1, titanium in aluminium": (TITANIUM, 0.1, 0.4, "body", "free", _shakes(P, 0.2, -0.1, 0.0)),
    "L_p 1, titanium in aluminium, held": (TITANIUM, 1.0, 0.6, "centre", "fixed", _shakes(P, 0.2, -0.2, 0.1, 0.0)),
    "L_p 0.5, weakly unlike": (WEAK, 0.5, 0.5, "centre", "fixed", _shakes(P, 0.25, -0.15, 0.05)),
    "L_p 0.1, steel in aluminium, stress": (STEEL, 0.1, 0.3, "body", "free", _shakes(P, 0.15, -0.1, 0.05, 0.0)),
    "L_p 5, weakly unlike, free": (WEAK, 5.0, 0.6, "centre", "free", _shakes(P, 0.2, -0.1, 0.0)),
}
"""Bodies, load parameter, friction, kind of load, rotation and history of each case, by title."""


def solved(case: Case, nodes: int, **options: Any) -> Result:
    """Solve a case."""
    pair, load_parameter, friction, pin_load, rotation, history = case
    problem = Problem.from_load_parameter(pair, load_parameter, friction, pin_load, rotation)
    return solve(problem, history, nodes=nodes, **options)


def peak(result: Result) -> tuple[float, float]:
    """Largest shear of the last state, and its angle."""
    return result[-1].peak_shear, result[-1].peak_shear_angle


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--nodes", type=int, nargs="+", default=[101, 201, 401])
    parser.add_argument("--reference", type=int, nargs="+", default=[1601, 3201])
    parser.add_argument("--store", type=Path)
    parser.add_argument("--only")
    options = parser.parse_args()
    stored = json.loads(options.store.read_text()) if options.store and options.store.exists() else {}
    print("| case | reference | doubt |" + "".join(f" {nodes} |" for nodes in options.nodes))
    print("|---|--:|--:|" + "--:|" * len(options.nodes))
    for title, case in CASES.items():
        if options.only and options.only not in title:
            continue
        if title not in stored:
            stored[title] = [abs(peak(solved(case, nodes))[0]) for nodes in options.reference]
            if options.store:
                options.store.write_text(json.dumps(stored))
        reference = stored[title][-1]
        doubt = abs(stored[title][-2] - reference) / reference
        errors = [abs(peak(solved(case, nodes))[0]) / reference - 1.0 for nodes in options.nodes]
        print(
            f"| {title} | {reference:.6f} | {doubt:.1e} |" + "".join(f" {error:.1e} |" for error in errors), flush=True
        )


if __name__ == "__main__":
    main()
