"""
Stresses below the surface
==========================

The stress inside both bodies follows from the tractions in closed form. The map shows the von Mises stress. Without
friction its maximum lies below the surface.
"""

import numpy as np

import fastpin
from fastpin.figures import plot_stress_field

pair = fastpin.MaterialPair(fastpin.MATERIALS["steel"], fastpin.MATERIALS["steel"])
problem = fastpin.Problem(pair, hole_radius=10e-3, clearance=500e-6, friction=0.0, pin_load="body")
state = fastpin.solve(problem, [{"P": 1.0e6}], nodes=201)[-1]

# %%
# On flat bodies the largest shear stress lies 0.79 half-widths below the middle of the contact (Hertz). The concave
# surface of the hole brings it nearer to the surface.

depths = np.linspace(1e-5, 3e-3, 400)
stress = state.stress(fastpin.Points.at_depth(depths, -np.pi / 2), "plate")
shear = 0.5 * np.abs(stress.syy - stress.sxx)
half_width = 0.5 * (state.contact[0][1] - state.contact[0][0]) * problem.hole_radius
deepest = depths[np.argmax(shear)] / half_width
print(f"largest shear stress {deepest:.2f} half-widths below the surface")

assert 0.6 < deepest < 0.786
figure = plot_stress_field(state, extent=1.6)
