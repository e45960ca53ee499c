"""
A crack under a spectrum
========================

A pin carries a force P and is pushed to and fro by random forces Q. Three cracks of 0.1 mm grow from the hole, each
alone. The cycles of their stress intensities are counted at each length. The constants of growth belong to no material.
"""

import numpy as np

import fastpin
from fastpin import cracks, figures

pair = fastpin.MaterialPair(fastpin.MATERIALS["Ti-6Al-4V"], fastpin.MATERIALS["aluminium"])
problem = fastpin.Problem(pair, hole_radius=10e-3, clearance=40e-6, friction=0.4, pin_load="body")
sides = np.random.default_rng(1).uniform(-1.0, 1.0, 40)
spectrum = fastpin.solve(problem, [{"P": 6e6}, *({"Q": 1.5e6 * side} for side in sides)], nodes=201)

# %%
# No overload retards a crack, and the order of the cycles makes no difference. A life counts passes of the spectrum.

law = cracks.Walker(C=1e-10, m=3.0, exponent=0.5, threshold_range=3e6, intrinsic_length=50e-6)
grown = []
for degrees in (40.0, 55.0, 80.0):
    crack = cracks.Crack(np.radians(degrees - 90.0))
    grown.append(cracks.spectrum_growth(spectrum, crack, law, first=1e-4, last=3e-3))
    print(f"{degrees:.0f} deg from the bottom: {grown[-1].words}")

lives = [found.life for found in grown]
assert lives[1] == min(lives)
figure = figures.plot_crack_growth(grown, title="Cracks under random forces Q")
