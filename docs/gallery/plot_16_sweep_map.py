"""
A map over friction and force
=============================

A double loop solves a case for many values. Large studies use plans and ``fastpin sweep``: they use all cores, survive
interrupts, and skip runs that are already done.
"""

import matplotlib.pyplot as plt
import numpy as np

import fastpin

pair = fastpin.MaterialPair(fastpin.MATERIALS["steel"], fastpin.MATERIALS["aluminium"])
frictions, forces = np.linspace(0.1, 0.8, 8), np.linspace(2e5, 2e6, 8)
sticking = np.empty((len(frictions), len(forces)))
for row, friction in enumerate(frictions):
    problem = fastpin.Problem(pair, hole_radius=10e-3, clearance=20e-6, friction=float(friction))
    for column, force in enumerate(forces):
        state = fastpin.solve(problem, [{"P": float(force)}], nodes=101)[-1]
        stick = sum(stop - start for start, stop in state.stick)
        sticking[row, column] = stick / sum(stop - start for start, stop in state.contact)

figure, axes = plt.subplots(figsize=(6.0, 4.0), layout="constrained")
filled = axes.contourf(forces / 1e6, frictions, sticking, levels=np.linspace(0.0, 1.0, 11))
figure.colorbar(filled, label="sticking part of the contact")
axes.set(xlabel="force P (MN/m)", ylabel="coefficient of friction")

# %%
# More friction makes more of the contact stick, until all of it sticks.

assert np.all(np.diff(sticking, axis=0) >= 0.0)
