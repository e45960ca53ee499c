"""
A fretting cycle and its loop
=============================

A pin is pressed down. Then a moment turns it to and fro. A part of the contact slips in each cycle. The area of the
hysteresis loop is the energy that friction dissipates.
"""

import numpy as np

import fastpin
from fastpin.figures import plot_loops

pair = fastpin.MaterialPair(fastpin.MATERIALS["Ti-6Al-4V"], fastpin.MATERIALS["aluminium"])
problem = fastpin.Problem(pair, hole_radius=10e-3, clearance=20e-6, friction=0.3)
history = fastpin.LoadHistory([{"P": 2.4e6}]) + fastpin.LoadHistory([{"M": 6.5e3}, {"M": -6.5e3}]).repeated(3)
result = fastpin.solve(problem, history, nodes=201, between=20)

for cycle in result.cycles:
    print(f"cycle {cycle.number}: {cycle.dissipation:.4f} J/m")
figure = plot_loops(result.cycle())

# %%
# The contact becomes periodic: the last cycle dissipates as much as the one before.

assert np.isclose(result.cycles[-1].dissipation, result.cycles[-2].dissipation, rtol=1e-6)
