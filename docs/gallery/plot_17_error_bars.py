"""
How accurate is it?
===================

The error of a result comes from the nodes alone, because the path of the load has no increments. A convergence study
solves the case on several grids, and estimates orders, limits and error bars.
"""

import fastpin

pair = fastpin.MaterialPair(fastpin.MATERIALS["steel"], fastpin.MATERIALS["aluminium"])
problem = fastpin.Problem(pair, hole_radius=10e-3, clearance=20e-6, friction=0.4)
loads = [{"P": 2.0e6}, {"Q": 5e5}]
study = fastpin.converge(problem, loads, nodes=[101, 201, 401, 801])

# %%
# One run can also bring its own error bars.

state = fastpin.solve(problem, loads, nodes=201, error_bars=True)[-1]
bar = state.error_bars["peak_pressure"]
print(f"peak pressure: {state.peak_pressure / 1e6:.3f} MPa, error bar {bar / 1e6:.3f} MPa")

finer = fastpin.solve(problem, loads, nodes=801)[-1]
assert abs(finer.peak_pressure - state.peak_pressure) <= bar
figure = fastpin.figures.plot_convergence(study)
