"""
Hoop stress round the hole
==========================

Cracks begin where the hoop stress of the hole is largest, often near an edge of the contact. The dots
mark these places.
"""

import numpy as np

import fastpin
from fastpin.figures import plot_hoop_stress

pair = fastpin.MaterialPair(fastpin.MATERIALS["steel"], fastpin.MATERIALS["aluminium"], plane="stress")
problem = fastpin.Problem(pair, hole_radius=10e-3, clearance=20e-6, friction=0.4)
result = fastpin.solve(problem, [{"P": 1.5e6}, {"Q": 4e5}], nodes=401)

peak = result[-1].peak_hoop_stress("plate")
start, stop = result[-1].contact[0]
print(f"{peak.value / 1e6:.0f} MPa at {np.degrees(peak.angle) + 90.0:.1f} deg from the bottom")
print(f"contact from {np.degrees(start) + 90.0:.1f} to {np.degrees(stop) + 90.0:.1f} deg")

assert min(abs(peak.angle - start), abs(peak.angle - stop)) < np.radians(10.0)
figure = plot_hoop_stress(result)
