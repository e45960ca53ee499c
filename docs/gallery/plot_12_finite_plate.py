"""
A finite plate
==============

A strip with a hole is held at its top. A small matrix, its compliance, holds all that the contact needs of the outline.
It is computed once, and serves every pin and every load.
"""

import fastpin
from fastpin.casefile import parse_lug
from fastpin.figures import plot_lug
from fastpin.lugs import plate_compliance

lug = parse_lug("""
[plate]
nu = 0.33
plane = "stress"
hole_radius = 10e-3

[outline]
shape = "rectangle"
x = [-25e-3, 25e-3]
y = [-25e-3, 60e-3]

[[support]]
parts = "top"
hold = "both"
""").lug
found = plate_compliance(lug)
print(f"estimated error of the compliance: {found.error:.1e}")

# %%
# The largest hoop stress of the strip is above that of an infinite plate.

pair = fastpin.MaterialPair(fastpin.MATERIALS["steel"], fastpin.Material(69e9, 0.33), plane="stress")
strip = fastpin.Problem(pair, hole_radius=10e-3, clearance=20e-6, friction=0.3, plate_body=found.compliance)
plate = fastpin.Problem(pair, hole_radius=10e-3, clearance=20e-6, friction=0.3)
peaks = []
for problem in (strip, plate):
    state = fastpin.solve(problem, [{"P": 1e6}], nodes=201)[-1]
    peaks.append(state.peak_hoop_stress("plate").value)
print(f"largest hoop stress: strip {peaks[0] / 1e6:.0f} MPa, infinite plate {peaks[1] / 1e6:.0f} MPa")

assert peaks[0] > peaks[1]
figure = plot_lug(lug)
