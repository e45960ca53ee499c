"""
A laminate turned under the pin
===============================

A bolt pulls at a carbon laminate with more plies of 0 and 90 degrees than of 45. The laminate is turned under the bolt.
The strength is read 0.5 mm from the edge, by the criterion of Yamada and Sun.
"""

import matplotlib.pyplot as plt
import numpy as np

import fastpin
from fastpin.damage import joint_strength
from fastpin.model import Laminate

plate = Laminate.from_layup("[0_3/45/-45/90_3]s", "T300/914")
figure, axes = plt.subplots(figsize=(6.0, 3.5), layout="constrained")
ratios = {}
for turn in (0, 15, 30, 45):
    pair = fastpin.MaterialPair(fastpin.MATERIALS["Ti-6Al-4V"], plate.turned(np.radians(turn)), "stress")
    problem = fastpin.Problem(pair, hole_radius=3e-3, clearance=20e-6, friction=0.2)
    state = fastpin.solve(problem, [{"P": 1.5e6}], nodes=101)[-1]
    found = joint_strength(state, "yamada-sun", distance=0.5e-3)
    angle = np.degrees(found.theta) + 90.0
    axes.plot(angle, found.ratio, label=f"{turn} deg")
    ratios[turn] = found.least_ratio
axes.axhline(1.0, color="0.5", linestyle=":")
axes.set(xlim=(-120, 120), ylim=(0, 5), xlabel="angle from the bottom (deg)", ylabel="strength ratio")
axes.legend(title="axis of the laminate")

# %%
# Turned by 45 degrees, few plies lie along the force. They fail at five sixths of the load.

print({turn: f"{ratio:.2f}" for turn, ratio in ratios.items()})
assert 0.8 < ratios[45] / ratios[0] < 0.86
