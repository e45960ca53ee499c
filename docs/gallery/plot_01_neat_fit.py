"""
A neat-fit pin
==============

A steel pin of the same size as the hole is pressed down into an aluminium plate. The contact keeps its width, whatever
the force. So pressures grow in proportion to the force.
"""

import numpy as np

import fastpin

pair = fastpin.MaterialPair(fastpin.MATERIALS["steel"], fastpin.MATERIALS["aluminium"], plane="stress")
problem = fastpin.Problem(pair, hole_radius=5e-3, clearance=0.0, friction=0.3)
result = fastpin.solve(problem, [{"P": 0.5e6}, {"P": 1.0e6}, {"P": 2.0e6}], nodes=201)

for state in result:
    start, stop = np.degrees(state.contact[0])
    print(f"P = {state.load['P'] / 1e6:.1f} MN/m: contact {stop - start:.1f} deg, {state.peak_pressure / 1e6:.1f} MPa")

# %%
# Twice the force gives twice the peak pressure, on the same arc.

assert np.isclose(result[2].peak_pressure, 2.0 * result[1].peak_pressure)
assert np.allclose(result[2].contact, result[1].contact)

figure = result.plot()
