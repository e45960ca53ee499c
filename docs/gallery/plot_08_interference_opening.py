"""
An interference fit opens
=========================

A pin that is 20 um too thick in radius touches the hole all round. A force presses one side and relieves the other.
From some force on, a gap opens on the relieved side.
"""

import matplotlib.pyplot as plt
import numpy as np

import fastpin
from fastpin.verification import interference

pair = fastpin.MaterialPair(fastpin.MATERIALS["steel"], fastpin.MATERIALS["aluminium"], plane="stress")
problem = fastpin.Problem(pair, hole_radius=10e-3, clearance=-20e-6, friction=0.2)
print(f"pressure of the fit: {interference.uniform_pressure(problem) / 1e6:.1f} MPa")

forces = np.linspace(0.0, 5e6, 26)
result = fastpin.solve(problem, [{"P": float(force)} for force in forces], nodes=180)
angles = [np.degrees(sum(stop - start for start, stop in state.contact)) for state in result]

figure, axes = plt.subplots(figsize=(6.0, 3.5), layout="constrained")
axes.plot(forces / 1e6, angles, "o-")
axes.set(xlabel="force P (MN/m)", ylabel="contact angle (deg)")

assert np.isclose(result[0].peak_pressure, interference.uniform_pressure(problem), rtol=1e-6)
assert np.isclose(angles[0], 360.0)
assert angles[-1] < 300.0
