"""Times of a spectrum's damage, by its parts: python bench/spectrum.py [stops] [nodes] [points].

The loads are random. The states are solved first, and not timed. One thread computes.
"""

from __future__ import annotations

import sys
import time
import warnings

import numpy as np

import fastpin
from fastpin.damage import counted, histories
from fastpin.runtime.threads import in_one_thread

CONSTANTS = fastpin.MATERIALS["2024-T3"].fatigue


def states_of(stops: int, nodes: int) -> list[fastpin.State]:
    """The states under random P and Q."""
    pair = fastpin.MaterialPair(fastpin.MATERIALS["Ti-6Al-4V"], fastpin.MATERIALS["2024-T3"])
    problem = fastpin.Problem(pair, hole_radius=10e-3, clearance=40e-6, friction=0.4, pin_load="body")
    rng = np.random.default_rng(1)
    loads = zip(rng.uniform(1e6, 8e6, stops).tolist(), rng.uniform(-2e6, 2e6, stops).tolist(), strict=True)
    history = fastpin.LoadHistory([{"P": along, "Q": across} for along, across in loads])
    return list(fastpin.solve(problem, history, nodes=nodes))


def main(stops: int = 5000, nodes: int = 401, points: int = 720) -> None:
    """Print a line for each part."""
    warnings.simplefilter("ignore")
    states = states_of(stops, nodes)
    theta = np.linspace(-1.5 * np.pi, 0.5 * np.pi, points, endpoint=False)
    places = fastpin.Points.at_depth(0.0, theta)
    material = counted.CountedMaterial.of("smith-watson-topper", states[0].problem.pair.plate, CONSTANTS, "plate")
    few, first = fastpin.Points.at_depth(0.0, theta[:2]), counted.Spectrum.of(np.arange(50))
    for straight in (True, False):  # load the kernels
        material.worst(histories.stress_history(states[:50], few, straight=straight), first)
    print(f"{stops:,} stops, {nodes} nodes, {points} points, one thread")
    for straight in (True, False):
        begin = time.perf_counter()
        different, order = histories.different_states(states, straight)
        spectrum = counted.Spectrum.of(order)
        times = {"find equal states": time.perf_counter() - begin, "stresses": 0.0, "counts on planes": 0.0}
        begin, damage = time.perf_counter(), 0.0
        for _, history in histories.history_blocks(different, places, "plate", straight):
            read = time.perf_counter()
            damage = max(damage, float(material.worst(history, spectrum)[0].max()))
            times["stresses"] += read - begin
            begin = time.perf_counter()
            times["counts on planes"] += begin - read
        total = sum(times.values())
        how = "straight lines, by a matrix" if straight else "refined tractions, state by state"
        print(f"{how}: {total:.1f} s, damage {damage:.6g}")
        for name, seconds in times.items():
            print(f"  {name:20} {seconds:7.2f} s {100.0 * seconds / total:5.1f} %")


if __name__ == "__main__":
    with in_one_thread():
        main(*(int(each) for each in sys.argv[1:]))
