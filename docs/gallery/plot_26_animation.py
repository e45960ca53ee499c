"""
An animation of a cycle
=======================

Each picture shows a state that was solved; ``between`` adds states inside the steps. The figure below is the last
picture. ``fastpin run --record cycle.html`` replays a run on a page, without a script.
"""

import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.animation import FuncAnimation, PillowWriter

import fastpin

pair = fastpin.MaterialPair(fastpin.MATERIALS["Ti-6Al-4V"], fastpin.MATERIALS["aluminium"])
problem = fastpin.Problem(pair, hole_radius=10e-3, clearance=20e-6, friction=0.4)
history = fastpin.LoadHistory.cycles({"P": 2.4e6}, {"Q": 7e5}, 1)
states = fastpin.solve(problem, history, nodes=101, between=3)

figure, axes = plt.subplots(figsize=(6.0, 3.5), layout="constrained")
angle = np.degrees(states[0].theta) + 90.0
(pressure,) = axes.plot(angle, states[-1].pressure / 1e6, label="pressure")
(shear,) = axes.plot(angle, states[-1].shear / 1e6, label="shear on the pin")
axes.set(xlabel="angle from the bottom (deg)", ylabel="traction (MPa)", ylim=(-80, 160))
axes.legend(loc="upper right")


def show(state):
    pressure.set_ydata(state.pressure / 1e6)
    shear.set_ydata(state.shear / 1e6)
    axes.set_title(f"P = {state.load['P'] / 1e6:.2f} MN/m, Q = {state.load['Q'] / 1e6:+.2f} MN/m")


with tempfile.TemporaryDirectory() as folder:
    path = Path(folder) / "cycle.gif"
    FuncAnimation(figure, show, states.states, init_func=lambda: None).save(path, PillowWriter(fps=4), dpi=80)
    assert path.read_bytes().startswith(b"GIF89a")
