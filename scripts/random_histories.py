"""Random histories: does the path solver return a wrong state, raise an error, or hang?

``python scripts/random_histories.py [--count 1000] [--first 0]`` solves `count` random problems with fixed seeds on
small grids. It checks every state independently of the solver's own residuals, and prints every error raised.
"""

from __future__ import annotations

import argparse
import collections
import time

import numpy as np
from tqdm import tqdm

from fastpin.errors import FastpinError
from fastpin.model.history import LoadHistory
from fastpin.model.materials import Material, MaterialPair
from fastpin.model.problem import Problem
from fastpin.solver.result import Result
from fastpin.solver.solving import solve
from fastpin.states.state import State

NODES = 81


def random_case(seed: int) -> tuple[Problem, LoadHistory]:
    """A random problem and a random history of up to six corners.

    L_p is 1e-4 to 2.5, friction 0.02 to 1.2, the stiffness ratio 1/30 to 30, nu 0 to 0.49, with both planes, both pin
    loads and both rotations. Q goes up to 1.2 mu P. Half of the free centre-loaded pins have a moment, up to the
    largest that friction at a point can carry. One case of five has remote stress, one of five returns to no load.
    """
    rng = np.random.default_rng(seed)
    ratio = 30.0 ** rng.uniform(-1.0, 1.0)
    pair = MaterialPair(
        Material(1.0, rng.uniform(0.0, 0.49)),
        Material(ratio, rng.uniform(0.0, 0.49)),
        "strain" if rng.random() < 0.5 else "stress",
    )
    load_parameter = 10.0 ** rng.uniform(-4.0, np.log10(2.5))
    friction = rng.uniform(0.02, 1.2)
    pin_load = "body" if rng.random() < 0.5 else "centre"
    rotation = "fixed" if pin_load == "centre" and rng.random() < 0.5 else "free"
    problem = Problem.from_load_parameter(pair, load_parameter, friction, pin_load, rotation)
    with_moment = pin_load == "centre" and rotation == "free" and rng.random() < 0.5
    with_stress = rng.random() < 0.2
    back_to_zero = rng.random() < 0.2
    corners = []
    for _ in range(int(rng.integers(1, 7))):
        pull = rng.uniform(0.2, 1.0)
        corner = {"P": pull, "Q": pull * friction * rng.uniform(-1.2, 1.2)}
        if with_moment:
            corner["M"] = pull * friction / np.hypot(1.0, friction) * rng.uniform(-1.0, 1.0)
        if with_stress:
            corner |= {
                "sxx": load_parameter * rng.uniform(-0.3, 0.3),
                "syy": load_parameter * rng.uniform(-0.3, 0.3),
            }
        corners.append(corner)
    if back_to_zero:
        corners[1:1] = [dict.fromkeys(corners[0], 0.0), dict(corners[0])]
    return problem, LoadHistory(corners)


def violation(state: State) -> float:
    """Return the largest relative violation of Signorini, Coulomb and equilibrium, from the fields a user reads."""
    if not state.in_contact:
        return max(
            -state.gap.min() / state.problem.clearance,
            np.abs(state.pressure).max(),
            np.abs(state.shear).max(),
        )
    peak, length = state.pressure.max(), max(np.abs(state.slip).max(), np.abs(state.gap).max())
    mu = state.problem.friction
    force = np.hypot(state.load["P"], state.load["Q"])
    balance = max(abs(state.resultants[name] - state.load[name]) for name in ("P", "Q"))
    if state.problem.rotation == "free":
        balance = max(balance, abs(state.resultants["M"] - state.load["M"]))
    return max(
        -state.pressure.min() / peak,
        float((np.abs(state.shear) - mu * state.pressure).max()) / peak,
        -state.gap.min() / length,
        float((state.gap * state.pressure).max()) / (length * peak),
        balance / force,
    )


def outcome(seed: int) -> tuple[str, float, Result | None]:
    """Solve a case. Return its ending ("solved", or the error's name and message), largest violation and result."""
    problem, history = random_case(seed)
    try:
        result, ending = solve(problem, history, nodes=NODES), "solved"
    except FastpinError as error:
        result, ending = getattr(error, "result", None), f"{type(error).__name__}: {error}"
    return ending, max((violation(state) for state in result or []), default=0.0), result


def main() -> None:
    """Run the command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=1000)
    parser.add_argument("--first", type=int, default=0)
    options = parser.parse_args()
    endings: collections.Counter[str] = collections.Counter()
    worst, slowest, states = 0.0, 0.0, 0
    for seed in tqdm(range(options.first, options.first + options.count), disable=None, delay=2.0):
        began = time.perf_counter()
        ending, violated, result = outcome(seed)
        slowest = max(slowest, time.perf_counter() - began)
        worst = max(worst, violated)
        states += len(result or [])
        endings[ending.split(":")[0]] += 1
        if ending != "solved" or violated > 1e-8:
            print(f"seed {seed}: {ending} (violation {violated:.1e})")
    print(dict(endings), f"{states} states, largest violation {worst:.1e}, slowest case {slowest:.2f} s")


if __name__ == "__main__":
    main()
