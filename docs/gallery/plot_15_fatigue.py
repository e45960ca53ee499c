"""
Fatigue: the hot spot of a cycle
================================

The criterion of Smith, Watson and Topper looks for the worst plane at each point of the hole's edge. With the constants
of the material it gives the number of cycles until a crack begins.
"""

import numpy as np

import fastpin
from fastpin.figures import plot_fatigue
from fastpin.model import FatigueConstants

constants = FatigueConstants(
    fatigue_strength=1.014e9, strength_exponent=-0.11, fatigue_ductility=0.21, ductility_exponent=-0.52
)
plate = fastpin.Material(71e9, 0.33, "2024-T3", fatigue=constants)
pair = fastpin.MaterialPair(fastpin.MATERIALS["Ti-6Al-4V"], plate, plane="stress")
problem = fastpin.Problem(pair, hole_radius=3e-3, clearance=5e-6, friction=0.4)
cycle = fastpin.LoadHistory([{"P": 0.5e6, "syy": 60e6}, {"P": 0.05e6, "syy": 6e6}]).repeated(3)
result = fastpin.solve(problem, cycle, nodes=201, between=5)

found = result.fatigue("smith-watson-topper")
spot = found.hot_spot
print(f"hot spot {np.degrees(spot.theta) + 90.0:.0f} deg from the bottom: a crack after {spot.life:.2g} cycles")

# %%
# The hot spot lies near the middle of a side of the hole, where the remote stress is concentrated.

assert abs(abs(np.degrees(spot.theta) + 90.0) - 90.0) < 30.0
figure = plot_fatigue(found)
