"""
Pin load and bypass load
========================

In a row of fasteners the plate carries two loads: the force of this pin, and the stress that goes on to the next row.
Here the pin is loaded first. Then the remote stress along the same direction grows.
"""

import matplotlib.pyplot as plt
import numpy as np

import fastpin

pair = fastpin.MaterialPair(fastpin.MATERIALS["steel"], fastpin.MATERIALS["aluminium"], plane="stress")
problem = fastpin.Problem(pair, hole_radius=3e-3, clearance=5e-6, friction=0.3)
loads = [{"P": 0.3e6}, {"syy": 25e6}, {"syy": 50e6}]
result = fastpin.solve(problem, loads, nodes=201)

theta = np.linspace(-np.pi, np.pi, 361)
figure, axes = plt.subplots(figsize=(6.0, 3.5), layout="constrained")
for state in result:
    hoop = state.hoop_stress("plate", theta)
    axes.plot(np.degrees(theta), hoop / 1e6, label=f"remote stress {state.load['syy'] / 1e6:.0f} MPa")
axes.set(xlabel="angle from the x axis (deg)", ylabel="hoop stress of the hole (MPa)")
axes.legend()

# %%
# The bypass load raises the largest hoop stress of the hole.

peaks = [state.peak_hoop_stress("plate").value for state in result]
print([f"{peak / 1e6:.0f} MPa" for peak in peaks])
assert peaks[0] < peaks[1] < peaks[2]
