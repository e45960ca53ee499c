"""A row of pins in single shear: ``python bench/joint.py [--pins 10] [--nodes 101] [--rounds 1]``.

Two straps of finite length share a force through a row of pins. The first load, and a cycle of unloading and loading
after it, are timed as processor seconds of one thread. The compliances of the straps are computed before, and timed
apart. The largest memory of the process is told.
"""

from __future__ import annotations

import argparse
import resource
import time

from fastpin.joints import Joint, JointPin, JointPlate, solve_joint
from fastpin.lugs.outline import rectangle
from fastpin.model.materials import MATERIALS

PITCH, RADIUS, FORCE = 20e-3, 2.5e-3, 5e3


def row_of(pins: int) -> Joint:
    """The joint: `pins` pins with unequal clearances along x."""
    length = PITCH * (pins - 1)
    straps = [
        JointPlate("skin", MATERIALS["aluminium"], 2.5e-3, rectangle((-60e-3, length + 20e-3), (-PITCH, PITCH)),
                   supports={"left": "both"}),
        JointPlate("strap", MATERIALS["aluminium"], 2.5e-3, rectangle((-20e-3, length + 60e-3), (-PITCH, PITCH)),
                   supports={"right": "both"}, moves="x"),
    ]  # fmt: skip
    row = [
        JointPin(
            f"P{k}", complex(k * PITCH), MATERIALS["steel"], RADIUS, ("skin", "strap"), 5e-6 + 1e-6 * (7 * k % 5), 0.3
        )
        for k in range(pins)
    ]
    return Joint(tuple(straps), tuple(row))


def main() -> None:
    """Print the times."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--pins", type=int, default=10)
    parser.add_argument("--nodes", type=int, default=101)
    parser.add_argument("--rounds", type=int, default=1)
    options = parser.parse_args()
    joint, force = row_of(options.pins), FORCE * options.pins
    first, cycle = [{"strap.x": force}], [{"strap.x": force}, {"strap.x": 0.1 * force}, {"strap.x": force}]
    began = time.process_time()
    solve_joint(joint, [{"strap.x": 1e-3 * force}], nodes=32)
    print(f"{options.pins} pins, {options.nodes} nodes a contact; the straps' compliance: ", end="")
    print(f"{time.process_time() - began:.2f} s with a small joint")
    for _ in range(options.rounds):
        times = []
        for corners in (first, cycle):
            began = time.process_time()
            found = solve_joint(joint, corners, nodes=options.nodes)
            times.append(time.process_time() - began)
        memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6
        print(f"first load {times[0]:.2f} s, cycle {times[1] - times[0]:.2f} s, {found.snaps} snaps, {memory:.2f} GB")


if __name__ == "__main__":
    main()
