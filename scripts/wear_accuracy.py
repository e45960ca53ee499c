"""The tables of docs/wear-accuracy.md, apart from times and random lives.

``python -m scripts.wear_accuracy [lives path limits friction]`` prints all tables or some, as Markdown. They take some
five minutes on one thread.
"""

from __future__ import annotations

import argparse
from dataclasses import replace

import numpy as np

from fastpin.model.angles import BOTTOM
from fastpin.model.grid import Grid
from fastpin.model.problem import Problem
from fastpin.solver.configuration import elastic_energy
from fastpin.solver.increment import implicit_step
from fastpin.solver.solving import solve
from fastpin.verification import wear_limits
from fastpin.verification.finite_elements import LIKE, UNLIKE
from fastpin.verification.friction_rows import ROUGH
from fastpin.verification.rows import Solving
from fastpin.verification.wear_rows import half_planes, step, wearing
from tests.support.wear_cases import WEAR_CASES, lived, numbers_of, parts_of, ready_to_wear


def row(*cells: object) -> None:
    """Print a row of a table."""
    print("|", " | ".join(str(cell) for cell in cells), "|", flush=True)


def head(*cells: str) -> None:
    """Print the head of a table."""
    print()
    row(*cells)
    row(*["---", *["--:"] * (len(cells) - 1)])


def lives() -> None:
    """Volume, depth, pressure at the bottom and dissipation of lives, by nodes and fat cycles."""
    head("life", "nodes", "fat cycles", "volume", "depth", "N, bottom", "D")
    for name, case in WEAR_CASES.items():
        for nodes, fat in ((121, 40), (121, 160), (241, 160), (481, 160)):
            run, worn, _ = lived(case, nodes, fat)
            volume, depth, bottom, lost = numbers_of(case, run, worn)
            row(name, nodes, fat, f"{volume:.6e}", f"{depth:.6f}", f"{bottom:.6f}", f"{lost:.5e}")


def path() -> None:
    """The wear path of partial slip: parts, increments, and the balance of energy."""
    once, depth = ready_to_wear()
    before = once.now
    once.wear(depth)
    many = ready_to_wear()[0]
    parts_of(many, depth, 64)
    names = ("pressure", "shear", "gap", "slip")
    pairs = [(getattr(once.now, name), getattr(many.now, name)) for name in names]
    difference = max(float(np.abs(one - other).max() / np.abs(one).max()) for one, other in pairs)
    print(f"\nOne path against 64: {difference:.1e}")
    head("increments of the gap", "N", "T")
    for count in (10, 40, 160, 640):
        now = before
        for _ in range(count):
            found = implicit_step(once.system, replace(now, rest_gap=now.rest_gap + depth / count), now.load)
            assert found is not None
            now = found
        errors = (np.abs(getattr(now, name) - getattr(once.now, name)).max() for name in names[:2])
        row(count, *(f"{error:.1e}" for error in errors))
    head("nodes", "work - energy - dissipation - removed", "the same with the implicit way")
    for nodes in (61, 121, 241, 481):
        left = []
        for softness in (None, 0.2 * np.ones(nodes)):
            run, depth = ready_to_wear(nodes)
            energy, removal = elastic_energy(run.system, run.now), run.wear(depth, softness)
            grown = elastic_energy(run.system, run.now) - energy
            left.append(removal.work - grown - removal.dissipation - removal.energy)
        row(nodes, *(f"{each:.1e}" for each in left))


def limits() -> None:
    """Partial slip of half-planes, and a pin that slides one way."""
    head("L_p", "nodes in half the stick zone", "volume, %", "depth, %", "N, middle, %")
    for load_parameter in (200.0, 2e4, 2e6):
        for nodes in (6, 12, 24, 48):
            rows = half_planes(nodes, load_parameter, Solving())
            row(f"{load_parameter:g}", nodes, *(f"{100.0 * (each.ours / each.reference - 1.0):.2f}" for each in rows))  # type: ignore[operator]
    head("clearance, F beta*", "nodes", "steps", "depth", "N0", "tilt", "depth, rigid", "N0, rigid")
    for clearance in (1.0, 10.0):
        rigid = wear_limits.rigid_sliding(clearance, 8.0, 0.2)
        for nodes, steps in ((31, 800), (61, 1600), (61, 3200), (121, 3200)):
            problem = Problem.from_load_parameter(LIKE, clearance, 0.2, "centre", "fixed")
            run, worn = wearing(problem, _arc(1.7, nodes)), np.zeros(nodes)
            step(run, {"P": 1.0})
            for number in range(1, steps + 1):
                rubbed, _ = step(run, {"rotation": 8e3 * number / steps})
                worn = worn + run.wear(1e-3 * rubbed).depth
            top = int(np.argmax(worn))
            below, middle, above = worn[top - 1 : top + 2]
            shift = 0.5 * (above - below) / (2.0 * middle - below - above)
            tilt = run.system.grid.theta[top] - BOTTOM + shift * run.system.weights[top]
            found = middle + 0.25 * (above - below) * shift, run.now.pressure.max(), tilt
            row(f"{clearance:g}", nodes, steps, *(f"{each:.4f}" for each in (*found, *rigid)))


def _arc(half: float, nodes: int) -> Grid:
    return Grid.arc(BOTTOM - half, BOTTOM + half, nodes)


def friction() -> None:
    """Friction that varies along the rim, and friction that changes."""
    fretted = [{"P": 1.0}, {"Q": 0.2}, {"Q": -0.2}, {"P": 0.5}, {"P": 1.0, "Q": 0.2}]
    head("along the rim, nodes", "peak N", "int N", "int T", "dx", "work - energy - dissipation")
    for nodes in (120, 240, 480, 960):
        last = solve(ROUGH, fretted, grid=Grid.circle(nodes))[-1]
        sums = (float(last.grid.weights @ each) for each in (last.pressure, last.shear))
        left = last.work - last.energy - last.dissipation
        row(nodes, *(f"{each:.5f}" for each in (last.peak_pressure, *sums, last.dx)), f"{left:.1e}")
    falling = Problem.from_load_parameter(UNLIKE, 0.1, 0.5, "body")
    history = [{"P": 1.0}, {"Q": 0.2}, {"P": 0.8, "Q": -0.1, "friction_change": -0.6}]
    head("falling with the loads, nodes", "peak N", "rotation", "D of the step", "work - energy - dissipation")
    for nodes in (61, 121, 241):
        before, last = solve(falling, history, grid=_arc(1.6, nodes))[-2:]
        lost, left = last.dissipation - before.dissipation, last.work - last.energy - last.dissipation
        row(nodes, f"{last.peak_pressure:.5f}", f"{last.rotation:.5f}", f"{lost:.6f}", f"{left:.1e}")


PARTS = {"lives": lives, "path": path, "limits": limits, "friction": friction}


def main() -> None:
    """Run the command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("parts", nargs="*", choices=[*PARTS, []], help="tables (default: all)")
    for name in parser.parse_args().parts or PARTS:
        PARTS[name]()


if __name__ == "__main__":
    main()
