"""
The moment at which a pin begins to spin
========================================

A session goes from load to load and keeps its matrices, so each step takes a few milliseconds. Here a bisection finds
the largest moment that friction can carry.
"""

import matplotlib.pyplot as plt
import numpy as np

import fastpin

pair = fastpin.MaterialPair(fastpin.MATERIALS["steel"], fastpin.MATERIALS["steel"])
problem = fastpin.Problem(pair, hole_radius=10e-3, clearance=20e-6, friction=0.3)
session = fastpin.Session(problem, nodes=201)
session.advance({"P": 1e6})

moments, sticking = [], []
carried, lost = 0.0, 1e4
while lost - carried > 1.0:
    moment = 0.5 * (carried + lost)
    try:
        state = session.advance({"M": moment})
    except fastpin.SolveError:
        lost = moment
    else:
        carried = moment
        moments.append(moment)
        sticking.append(np.degrees(sum(stop - start for start, stop in state.stick)))

# %%
# In the end the shear is friction times pressure everywhere, so the moment cannot grow.

bound = problem.friction * problem.hole_radius**2 * (state.grid.weights @ state.pressure)
print(f"the pin spins at {carried / 1e3:.2f} kN; friction can carry {bound / 1e3:.2f} kN")
assert carried <= bound < 1.05 * carried

figure, axes = plt.subplots(figsize=(6.0, 3.5), layout="constrained")
axes.plot(np.array(moments) / 1e3, sticking, "o")
axes.set(xlabel="moment (kN)", ylabel="sticking angle (deg)")
