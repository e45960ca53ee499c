"""
Bearing and bypass of a laminate
================================

In a row of bolts the plate carries the force of this bolt, and the stress that goes past. For several ratios of both,
the load at which the first ply fails is looked for. The lines join the failures of two fits.
"""

import matplotlib.pyplot as plt

import fastpin
from fastpin.assess import failure_load
from fastpin.model import Laminate

plate = Laminate.from_layup("[0/45/-45/90]2s", "T300/914")
pair = fastpin.MaterialPair(fastpin.MATERIALS["Ti-6Al-4V"], plate, "stress")
figure, axes = plt.subplots(figsize=(6.0, 3.5), layout="constrained")
bearing = {}
for clearance in (10e-6, 40e-6):
    problem = fastpin.Problem(pair, hole_radius=3e-3, clearance=clearance, friction=0.2)
    points = []
    for stress in (-200e6, -100e6, 0.0, 100e6, 200e6, 600e6):
        load = {"P": 1.5e6, "syy": stress}
        factor = failure_load(problem, [load], "yamada-sun", distance=0.5e-3, nodes=101).factor
        points.append((factor * stress / 1e6, factor * load["P"] / 6e-3 / 1e6))
    axes.plot(*zip(*points, strict=True), marker="o", label=f"clearance {1e6 * clearance:.0f} um")
    bearing[clearance] = points[2][1]
axes.set(xlabel="bypass stress (MPa)", ylabel="bearing stress (MPa)", ylim=(0, None))
axes.legend()

# %%
# Without bypass the larger clearance takes a fifth of the bearing strength.

print({f"{1e6 * clearance:.0f} um": f"{stress:.0f} MPa" for clearance, stress in bearing.items()})
assert 0.78 < bearing[40e-6] / bearing[10e-6] < 0.84
