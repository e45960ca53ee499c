"""
A map of stick and slip
=======================

The map shows which part of the contact sticks and which part slips while the load changes. The load goes along the
horizontal axis. States inside each step show how the zones grow.
"""

import fastpin
from fastpin.figures import plot_stick_slip

pair = fastpin.MaterialPair(fastpin.MATERIALS["steel"], fastpin.MATERIALS["aluminium"])
problem = fastpin.Problem(pair, hole_radius=10e-3, clearance=20e-6, friction=0.4)
result = fastpin.solve(problem, [{"P": 2.4e6}, {"Q": 7e5}, {"Q": -7e5}, {"Q": 7e5}], nodes=201, between=15)

figure = plot_stick_slip(result)

# %%
# Just after each reversal nearly all of the contact sticks.

reversal = next(state for state in result if state.step == 2)
slipping = sum(stop - start for start, stop, _ in reversal.slip_zones)
closed = sum(stop - start for start, stop in reversal.contact)
print(f"slipping part after the first reversal: {slipping / closed:.1%}")
assert slipping < 0.2 * closed
