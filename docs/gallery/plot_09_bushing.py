"""
A bush between pin and plate
============================

A bronze bush is pressed into an aluminium lug. The pin touches the bush. The press fit reduces the clearance of the
pin. The bush is not bonded: the lug holds it by pressure and friction. fastpin tells whether it slips in its seat.
"""

import fastpin
from fastpin.bodies import Bushing, Ring
from fastpin.figures import plot_sketch

steel, aluminium = fastpin.MATERIALS["steel"], fastpin.MATERIALS["aluminium"]
bronze = fastpin.Material(110e9, 0.34, "bronze")
lug = Ring(25e-3, support="half")
bush = Bushing(bronze, outer_radius=12.5e-3, interference=15e-6, inside=lug, friction=0.2, bonded=False)
pair = fastpin.MaterialPair(steel, aluminium, plane="stress")
problem = fastpin.Problem(pair, hole_radius=10e-3, clearance=30e-6, friction=0.2, plate_body=bush)

print(f"clearance after pressing in: {problem.assembled_clearance * 1e6:.1f} um")
print(f"press fit: {problem.press_fit_pressure / 1e6:.1f} MPa")
result = fastpin.solve(problem, [{"P": 1.0e6}], nodes=201)
state = result[-1]
print(f"peak pressure: {state.peak_pressure / 1e6:.1f} MPa")
seat = state.seat
print(f"least pressure between bush and lug: {seat.pressure.min() / 1e6:.1f} MPa")
print(f"largest slip in the seat: {abs(seat.peak_slip) * 1e6:.2f} um")

# %%
# The pressure is positive all round, so the bush does not come loose. It sticks below the pin, and slips at its sides.

assert seat.pressure.min() > 0.0
assert problem.assembled_clearance < problem.clearance
figure = plot_sketch(result)

# %%
# The tractions in the seat are those of a state of its own.

figure = result.seat.plot()
