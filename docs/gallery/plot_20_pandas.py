"""
Results as a data frame
=======================

A result becomes a data frame of pandas, with a row for each state and a column for each quantity. Its units are in
``frame.attrs``.
"""

import matplotlib.pyplot as plt

import fastpin

pair = fastpin.MaterialPair(fastpin.MATERIALS["Ti-6Al-4V"], fastpin.MATERIALS["aluminium"])
problem = fastpin.Problem(pair, hole_radius=10e-3, clearance=20e-6, friction=0.4)
history = fastpin.LoadHistory.harmonic({"P": 2.0e6}, {"P": 4e5, "Q": 4e5}, phase={"Q": 90.0}, count=2, points=16)
result = fastpin.solve(problem, history, nodes=201)

frame = result.to_dataframe()
print(frame[["peak_pressure", "peak_shear", "dx", "dissipation"]].tail(4))
print(frame.attrs["units"]["peak_pressure"])

figure, axes = plt.subplots(figsize=(6.0, 3.5), layout="constrained")
axes.plot(1e6 * frame["dx"], 1e6 * frame["dy"], "o-")
axes.set(xlabel="motion to the right (um)", ylabel="motion upwards (um)")

assert frame["dissipation"].is_monotonic_increasing
