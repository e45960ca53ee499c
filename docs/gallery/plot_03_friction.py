"""
Friction changes pressure and shear
===================================

The same pin is pressed into the same hole with three coefficients of friction. Shear tractions carry a part of the
force, so friction lowers the peak pressure.
"""

import matplotlib.pyplot as plt
import numpy as np

import fastpin

pair = fastpin.MaterialPair(fastpin.MATERIALS["steel"], fastpin.MATERIALS["aluminium"])
peaks = []
figure, (upper, lower) = plt.subplots(2, 1, sharex=True, figsize=(6.0, 5.0), layout="constrained")
for friction in (0.0, 0.3, 0.6):
    problem = fastpin.Problem(pair, hole_radius=10e-3, clearance=20e-6, friction=friction)
    state = fastpin.solve(problem, [{"P": 2.5e6}], nodes=201)[-1]
    angle = np.degrees(state.theta) + 90.0
    upper.plot(angle, state.pressure / 1e6, label=f"friction {friction}")
    lower.plot(angle, state.shear / 1e6)
    peaks.append(state.peak_pressure)
upper.set(ylabel="pressure (MPa)")
lower.set(xlabel="angle from the bottom (deg)", ylabel="shear on the pin (MPa)")
upper.legend()

assert peaks[0] > peaks[1] > peaks[2]
