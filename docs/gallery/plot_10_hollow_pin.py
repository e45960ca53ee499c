"""
A hollow pin
============

A hollow pin is lighter and more compliant than a solid one. It flattens under the force, so its contact is wider.
"""

import matplotlib.pyplot as plt
import numpy as np

import fastpin
from fastpin.bodies import Disk, Tube

pair = fastpin.MaterialPair(fastpin.MATERIALS["steel"], fastpin.MATERIALS["aluminium"])
pins = {"solid": Disk(), "bore of 5 mm": Tube(bore_radius=5e-3), "bore of 8 mm": Tube(bore_radius=8e-3)}
figure, axes = plt.subplots(figsize=(6.0, 3.5), layout="constrained")
widths = []
for name, pin in pins.items():
    problem = fastpin.Problem(pair, hole_radius=10e-3, clearance=20e-6, friction=0.2, pin_body=pin)
    state = fastpin.solve(problem, [{"P": 1.5e6}], nodes=201)[-1]
    axes.plot(np.degrees(state.theta) + 90.0, state.pressure / 1e6, label=name)
    start, stop = state.contact[0]
    widths.append(stop - start)
axes.set(xlabel="angle from the bottom (deg)", ylabel="pressure (MPa)")
axes.legend()

assert widths[0] < widths[2]
