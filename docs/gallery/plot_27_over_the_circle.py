"""
Tractions over the circle of the hole
=====================================

Polar axes show the tractions as they lie in space. The pressure points outwards from the edge of the hole. Shear that
acts counter-clockwise on the pin stands outside the circle.
"""

import matplotlib.pyplot as plt
import numpy as np

import fastpin

pair = fastpin.MaterialPair(fastpin.MATERIALS["Ti-6Al-4V"], fastpin.MATERIALS["aluminium"])
problem = fastpin.Problem(pair, hole_radius=10e-3, clearance=20e-6, friction=0.4)
result = fastpin.solve(problem, [{"P": 2.4e6}, {"Q": 7e5}, {"Q": -7e5}], nodes=201)

figure, panels = plt.subplots(1, 2, figsize=(7.0, 3.6), subplot_kw={"projection": "polar"}, layout="constrained")
turn = np.linspace(0.0, 2.0 * np.pi, 361)
for panel, name, rings in zip(panels, ("pressure", "shear"), ([50, 100], [-30, 30]), strict=True):
    panel.plot(turn, np.zeros(turn.size), color="0.2")
    for state in result:
        panel.plot(state.theta, getattr(state, name) / 1e6, label=f"Q = {state.load['Q'] / 1e6:.1f} MN/m")
    panel.set(title=f"{name} (MPa)", rorigin=-300.0, xticklabels=[], yticks=rings)
    panel.set_rlabel_position(90.0)
panels[0].legend(loc="lower center", bbox_to_anchor=(0.5, -0.35), fontsize=7)

assert result[1].peak_pressure_angle > result[0].peak_pressure_angle > result[2].peak_pressure_angle
