"""
Comparison with Hertz, Cattaneo and Mindlin
===========================================

With much clearance or a small force the contact is narrow, as between a cylinder and a flat body. The pressure is then
that of Hertz. The shear under a tangential force is that of Cattaneo and Mindlin.
"""

import matplotlib.pyplot as plt
import numpy as np

import fastpin
from fastpin.verification import closed_forms

steel = fastpin.MATERIALS["steel"]
# A pin that is held does not roll under the tangential force.
problem = fastpin.Problem.from_load_parameter(
    fastpin.MaterialPair(steel, steel), 2000.0, friction=0.5, rotation="fixed"
)
loads = [{"P": 1.0}, {"Q": 0.25}]
state = fastpin.solve(problem, loads, nodes=401)[-1]

start, stop = state.contact[0]
half_width = 0.5 * (stop - start)
x = (state.theta - 0.5 * (start + stop)) / half_width
shear = closed_forms.cattaneo_mindlin_shear(x, 1.0, state.peak_pressure, 0.5, load_ratio=0.5)

figure, axes = plt.subplots(figsize=(6.0, 3.5), layout="constrained")
axes.plot(x, state.pressure, label="pressure")
axes.plot(x, np.abs(state.shear), label="shear")
axes.plot(x, np.abs(shear), "k--", label="Cattaneo and Mindlin")
axes.set(xlabel="place over half-width of the contact", ylabel="traction, units of F/R")
axes.legend()

hertz = closed_forms.hertz_peak_pressure(2000.0)
print(f"peak pressure over Hertz's: {state.peak_pressure / hertz:.5f}")
assert abs(state.peak_pressure / hertz - 1.0) < 0.01
assert np.mean(np.abs(np.abs(state.shear) - np.abs(shear))) < 0.01 * np.max(np.abs(shear))
