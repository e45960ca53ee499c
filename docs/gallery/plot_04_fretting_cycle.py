"""
A fretting cycle and its loop
=============================

A pin that cannot turn is pressed down. Then a force to the right and to the left moves it in the hole. Some of the
contact slips in each cycle. The area of the hysteresis loop is the energy that friction dissipates.
"""

import numpy as np

import fastpin
from fastpin.figures import plot_loops

pair = fastpin.MaterialPair(fastpin.MATERIALS["Ti-6Al-4V"], fastpin.MATERIALS["aluminium"])
problem = fastpin.Problem(pair, hole_radius=10e-3, clearance=20e-6, friction=0.4, pin_load="centre", rotation="fixed")
history = fastpin.LoadHistory([{"P": 2.4e6}]) + fastpin.LoadHistory([{"Q": 9e5}, {"Q": -9e5}]).repeated(4)
result = fastpin.solve(problem, history, nodes=201, between=20, slip_sums=True)

cycle = result.cycle()
print(f"friction energy of the last cycle: {result.cycles[-1].dissipation:.3f} J/m")
figure = plot_loops(cycle)

# %%
# The cycles become periodic: the last one dissipates as much as the one before.

assert np.isclose(result.cycles[-1].dissipation, result.cycles[-2].dissipation, rtol=1e-6)
