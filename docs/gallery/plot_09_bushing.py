"""
A bush between pin and plate
============================

A bronze bush is pressed into an aluminium lug. The pin touches the bush. The press fit reduces the clearance of the
pin. fastpin also tells whether the press fit holds the bush.
"""

import fastpin
from fastpin.bodies import Bushing, Ring
from fastpin.figures import plot_sketch

steel, aluminium = fastpin.MATERIALS["steel"], fastpin.MATERIALS["aluminium"]
bronze = fastpin.Material(110e9, 0.34, "bronze")
bush = Bushing(bronze, outer_radius=12.5e-3, interference=15e-6, inside=Ring(25e-3, support="half"), friction=0.2)
pair = fastpin.MaterialPair(steel, aluminium, plane="stress")
problem = fastpin.Problem(pair, hole_radius=10e-3, clearance=30e-6, friction=0.2, plate_body=bush)

print(f"clearance after pressing in: {problem.assembled_clearance * 1e6:.1f} um")
print(f"press fit: {problem.press_fit_pressure / 1e6:.1f} MPa")
result = fastpin.solve(problem, [{"P": 1.0e6}], nodes=201)
state = result[-1]
print(f"peak pressure: {state.peak_pressure / 1e6:.1f} MPa")
fit = state.bush_fit()
print(f"least pressure between bush and lug: {fit.pressure.min() / 1e6:.1f} MPa")

# %%
# The pressure is positive all round, so the bush stays in the lug.

assert fit.pressure.min() > 0.0
assert problem.assembled_clearance < problem.clearance
figure = plot_sketch(result)
