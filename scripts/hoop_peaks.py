"""How exact the largest hoop stress is: random fretting states against a reference on eight times as many intervals.

``python scripts/hoop_peaks.py [--cases 20] [--first 0] [--nodes 401]`` prints a line for each state: the peak of the
reference, the relative errors of the refined peak and of straight lines between the nodes, the error bar, and whether
both peaks are resolved. The last lines count. Twenty cases take some five minutes.
"""

from __future__ import annotations

import argparse
import math

import numpy as np
from tqdm import tqdm

from fastpin.errors import FastpinError
from fastpin.model.history import LoadHistory
from fastpin.model.materials import Material, MaterialPair
from fastpin.model.problem import Problem
from fastpin.solver.solving import solve
from fastpin.states.error_bars import bars
from fastpin.states.state import State


def random_case(seed: int) -> tuple[Problem, LoadHistory]:
    """A random problem and fretting history.

    Two cases of three have like bodies, others stiffness ratios of 0.4 or 3. L_p is 0.02 to 0.6, one case of five is an
    interference fit. Friction is 0.15 to 0.8. Q alternates, P varies by a fifth, one case of four has a remote stress.
    """
    rng = np.random.default_rng(seed)
    plate = Material(1.0, 0.3)
    pin, plane = plate, "strain"
    if seed % 3 == 0:
        pin, plate = Material(rng.choice([3.0, 0.4]), 0.3), Material(1.0, 0.33)
        plane = str(rng.choice(["strain", "stress"]))
    friction = rng.uniform(0.15, 0.8)
    load_parameter = 10.0 ** rng.uniform(-1.7, -0.2) * (-0.3 if seed % 5 == 4 else 1.0)
    pair = MaterialPair(pin, plate, "strain" if plane == "strain" else "stress")
    problem = Problem.from_load_parameter(pair, load_parameter, friction, rng.choice(["body", "centre"]))
    amplitude = friction * rng.uniform(0.2, 0.8)
    stress = rng.uniform(0.0, 0.5) if seed % 4 == 1 else 0.0
    corners: list[dict[str, float]] = [{"P": 1.0}]
    for k in range(int(rng.integers(1, 6))):
        corners.append({"Q": amplitude * (-1) ** k * rng.uniform(0.5, 1.0), "P": rng.uniform(0.8, 1.2)})
        corners[-1]["sxx"] = stress * (k % 2 == 0)
    return problem, LoadHistory(corners)


def last_states(seed: int, grids: list[int]) -> list[State] | None:
    """The last state of a case on each grid; None if a load can't be carried."""
    problem, history = random_case(seed)
    try:
        return [solve(problem, history, nodes=nodes, keep="corners")[-1] for nodes in grids]
    except FastpinError:
        return None


def main() -> None:
    """Run the command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cases", type=int, default=20)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--nodes", type=int, default=401)
    options = parser.parse_args()
    nodes, rows = options.nodes, []
    for seed in tqdm(range(options.first, options.first + options.cases)):
        states = last_states(seed, [nodes // 2 + 1, nodes, 8 * (nodes - 1) + 1])
        if states is None:
            continue
        coarse, state, reference = states
        found, exact = state.peak_hoop_stress(), reference.peak_hoop_stress()
        straight = state.hoop_stress("plate", [found.angle], straight=True)[0]
        error, bar = abs(found.value - exact.value), bars(state, coarse)["peak_hoop"]
        rows.append((error / exact.value, error <= bar, bar / exact.value, found.resolved and exact.resolved))
        place = math.degrees(exact.angle) + 90.0
        tqdm.write(
            f"{seed:4d}: {exact.value:.5f} at {place:8.3f} deg, error {found.value / exact.value - 1.0:+.1e}, "
            f"straight {straight / exact.value - 1.0:+.1e}, bar {bar / exact.value:.1e}, "
            f"resolved {'yes' if rows[-1][3] else 'no'}"
        )
    errors, holds, sizes, resolved = (np.array(column) for column in zip(*rows, strict=True))
    print(f"{errors.size} states, {int(resolved.sum())} resolved")
    print(f"errors up to 1e-3: {int(np.sum(errors <= 1e-3))}; of the resolved {int(np.sum(errors[resolved] <= 1e-3))}")
    print(f"median error {np.median(errors):.1e}, largest {errors.max():.1e}")
    print(f"largest error of the resolved {errors[resolved].max():.1e}")
    print(f"bars that hold: {int(holds.sum())} of {holds.size}; median bar {np.median(sizes):.1e}")


if __name__ == "__main__":
    main()
