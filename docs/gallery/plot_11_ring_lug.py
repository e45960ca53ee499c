"""
A ring lug
==========

The plate is a ring round the hole. A thin ring bends under the force of the pin. Its largest hoop stress is above
that of a thick ring.
"""

import matplotlib.pyplot as plt
import numpy as np

import fastpin
from fastpin.bodies import Ring

pair = fastpin.MaterialPair(fastpin.MATERIALS["steel"], fastpin.MATERIALS["steel"], plane="stress")
theta = np.linspace(-np.pi, np.pi, 361)
peaks = []
figure, axes = plt.subplots(figsize=(6.0, 3.5), layout="constrained")
for ratio in (1.5, 2.0, 3.0):
    ring = Ring(outer_radius=ratio * 10e-3, support="half")
    problem = fastpin.Problem(pair, hole_radius=10e-3, clearance=10e-6, friction=0.2, plate_body=ring)
    state = fastpin.solve(problem, [{"P": 1.0e6}], nodes=201)[-1]
    axes.plot(np.degrees(theta), state.hoop_stress("plate", theta) / 1e6, label=f"outer radius {ratio} R")
    peaks.append(state.peak_hoop_stress("plate").value)
axes.set(xlabel="angle from the x axis (deg)", ylabel="hoop stress of the hole (MPa)")
axes.legend()

assert peaks[0] > peaks[1] > peaks[2]
