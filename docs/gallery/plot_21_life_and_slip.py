"""
Life against slip, with wear
============================

A pin under a force P turns to and fro. While it sticks, more rotation means more shear and a shorter life. Once it
slides, the shear has its limit, and wear takes the damaged material away: the life rises again. The wear coefficient
is assumed.
"""

import matplotlib.pyplot as plt
import numpy as np

import fastpin

R = 5e-3
pair = fastpin.MaterialPair(fastpin.MATERIALS["Ti-6Al-4V"], fastpin.MATERIALS["2024-T3"])
problem = fastpin.Problem(
    pair, hole_radius=R, clearance=50e-6, friction=0.6, pin_load="centre", rotation="fixed", hub_radius=R
)
amplitudes = np.array([20.0, 25.0, 29.0, 31.0, 34.0, 38.0, 42.0, 48.0])  # um, of the rim of the pin
edge = np.radians(np.arange(50.0, 80.0, 0.25) - 90.0)  # the right edge of the contact; the left one is its mirror
depths = np.r_[0.0, np.geomspace(1e-9, 3e-5, 14)]
lives, unworn, sliding = [], [], []
for amplitude in 1e-6 * amplitudes:
    turns = fastpin.LoadHistory([{"rotation": -amplitude / R}, {"rotation": amplitude / R}]).repeated(2)
    history = fastpin.LoadHistory([{"P": 1e6}, {"rotation": amplitude / R}]) + turns
    result = fastpin.solve(problem, history, nodes=61, slip_sums=True)
    found = result.fatigue("smith-watson-topper", points=fastpin.Points.at_depth(0.0, edge))
    unworn.append(found.hot_spot.life)
    sliding.append(result.cycle().regime.words == "gross sliding")
    last = int(min(10.0 * unworn[-1], 4e7))
    chosen = np.geomspace(1e-3 * last, last, 25).astype(int).tolist()
    worn = fastpin.wear(problem, history, cycles=last, plate=3e-16, at=chosen, tolerance=0.05, nodes=61)
    found = worn.fatigue("smith-watson-topper", theta=edge, depth=depths)
    lives.append(found.life)
    print(f"{1e6 * amplitude:.0f} um: {found.race.words}; {found.words}")

# %%
# Without wear the life falls to a constant value. With wear it has a minimum where sliding begins. Farther on wear
# wins: no crack starts within ten times the life without wear.

lives, unworn, sliding = np.array(lives), np.array(unworn), np.array(sliding)
worst = int(np.argmin(lives))
assert np.all(np.diff(unworn) < 0.02 * unworn[:-1])
assert 0 < worst < len(lives) - 1
assert sliding[worst]
assert np.isinf(lives[-1])

figure, axes = plt.subplots(figsize=(6.0, 4.0), layout="constrained")
axes.axvspan(amplitudes[sliding].min() - 1.0, amplitudes.max() + 1.0, color="0.93")
axes.semilogy(amplitudes, unworn, "s--", color="0.5", label="without wear")
axes.semilogy(amplitudes, lives, "o-", color="tab:blue", label="with wear")
safe = np.isinf(lives)
axes.plot(amplitudes[safe], 10.0 * unworn[safe], "^", color="tab:blue", label="with wear, longer than this")
axes.text(amplitudes.max() + 0.7, 3e7, "gross sliding", ha="right")
axes.set(xlabel="amplitude of the rim of the pin (µm)", ylabel="life (cycles)", ylim=(2e5, 5e7))
axes.legend(loc="lower left")
