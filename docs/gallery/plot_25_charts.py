"""
Charts beside handbook formulas
===============================

Handbooks give one number for the pressure of a pin in a hole, 4/pi of the bearing stress, and Hertz's formula for loose
fits. The charts have both, and all fits and frictions between them, with a bound of their error.
"""

import math

import matplotlib.pyplot as plt
import numpy as np

from fastpin.charts import lookup

at = np.geomspace(1e-3, 100.0, 200)
figure, (left, right) = plt.subplots(1, 2, figsize=(7.0, 3.4), layout="constrained")
styles = {0.0: "solid", 0.3: (0, (5.0, 1.6)), 0.6: (0, (1.2, 1.2))}
for friction, dashes in styles.items():
    for panel, name in ((left, "peak_pressure"), (right, "kt_bearing")):
        found = lookup(name, load_parameter=at, friction=friction, pin_load="body")
        panel.plot(at, found.value, linestyle=dashes, label=f"chart, friction {friction:g}")
        panel.fill_between(at, found.value - found.error, found.value + found.error, alpha=0.25)
hertz = 4.0 * np.sqrt(at / math.pi)
left.plot(at, hertz, color="0.5", linewidth=3.0, alpha=0.5, zorder=0, label="Hertz")
left.axhline(4.0 / math.pi, color="0.5", linestyle=(0, (8.0, 2.0)), label="cosine, 4/pi")
left.set(yscale="log", ylim=(0.6, 30.0), ylabel="largest pressure over P/(2 R)")
right.set(ylabel="Kt on the bearing stress")
for panel in (left, right):
    panel.set(xscale="log", xlabel="load parameter")
left.legend(fontsize=7)

# %%
# At the load parameter 1/pi both formulas are equal, and 26 % too low without friction.

found = lookup("peak_pressure", load_parameter=1.0 / math.pi, friction=0.0)
print(f"chart {found.value:.3f} +- {found.error:.3f}, both formulas {4.0 / math.pi:.3f}")
assert 1.33 < found.value / (4.0 / math.pi) < 1.36
