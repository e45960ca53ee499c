"""
The order of the loads matters
==============================

Two ways lead to the same final loads: first down and then to the right, or both at once. Friction remembers the way.
The shear tractions differ, although the forces are equal.
"""

import matplotlib.pyplot as plt
import numpy as np

import fastpin

pair = fastpin.MaterialPair(fastpin.MATERIALS["steel"], fastpin.MATERIALS["aluminium"])
problem = fastpin.Problem(pair, hole_radius=10e-3, clearance=20e-6, friction=0.4)
ways = {
    "down, then right": [{"P": 2.0e6}, {"Q": 6e5}],
    "both at once": [{"P": 2.0e6, "Q": 6e5}],
}
figure, axes = plt.subplots(figsize=(6.0, 3.5), layout="constrained")
ends = []
for name, loads in ways.items():
    state = fastpin.solve(problem, loads, nodes=201, arc=(-3.2, 0.4))[-1]
    axes.plot(np.degrees(state.theta) + 90.0, state.shear / 1e6, label=name)
    ends.append(state)
axes.set(xlabel="angle from the bottom (deg)", ylabel="shear on the pin (MPa)")
axes.legend()

assert np.isclose(ends[0].resultants["Q"], ends[1].resultants["Q"])
assert np.max(np.abs(ends[0].shear - ends[1].shear)) > 0.1 * np.max(np.abs(ends[0].shear))
