"""
The moment at which a pin begins to spin
========================================

A session goes from load to load and keeps its matrices, so each step takes a few milliseconds. Here ever smaller steps
lead to the largest moment that friction can carry.
"""

import matplotlib.pyplot as plt
import numpy as np

import fastpin

pair = fastpin.MaterialPair(fastpin.MATERIALS["steel"], fastpin.MATERIALS["steel"])
problem = fastpin.Problem(pair, hole_radius=10e-3, clearance=20e-6, friction=0.3)
session = fastpin.Session(problem, nodes=201)
session.advance({"P": 1e6})

carried, step = 0.0, 200.0
moments, sticking = [], []
while step > 0.5:
    try:
        state = session.advance({"M": carried + step})
    except fastpin.NoEquilibriumError:
        step *= 0.5
    else:
        carried += step
        moments.append(carried / 1e3)
        sticking.append(np.degrees(sum(stop - start for start, stop in state.stick)))

# %%
# In the end the shear is friction times pressure everywhere, so the moment cannot grow.

bound = problem.friction * problem.hole_radius**2 * (state.grid.weights @ state.pressure)
print(f"the pin spins at {carried / 1e3:.2f} kN; friction can carry {bound / 1e3:.2f} kN")
assert carried <= bound < 1.05 * carried

figure, axes = plt.subplots(figsize=(6.0, 3.5), layout="constrained")
axes.plot(moments, sticking, "o-")
axes.set(xlabel="moment (kN)", ylabel="sticking angle (deg)")
