"""
Clearance and the load parameter
================================

One number says how conforming a contact is: the load parameter (R - R_D)/(F beta*). It grows with the clearance and
falls with the force. A small number means a wide contact. The figure shows the contact angle over four decades.
"""

import matplotlib.pyplot as plt
import numpy as np

import fastpin

pair = fastpin.MaterialPair(fastpin.MATERIALS["steel"], fastpin.MATERIALS["steel"])
parameters = np.geomspace(0.01, 100.0, 13)
widths = []
for parameter in parameters:
    problem = fastpin.Problem.from_load_parameter(pair, parameter, friction=0.2)
    state = fastpin.solve(problem, [{"P": 1.0}], nodes=101)[-1]
    start, stop = state.contact[0]
    widths.append(np.degrees(stop - start))

# %%
# Hertz's formula for two cylinders holds for narrow contacts only.

hertz = 2.0 * np.degrees(1.0 / np.sqrt(np.pi * parameters))
figure, axes = plt.subplots(figsize=(6.0, 4.0), layout="constrained")
axes.loglog(parameters, widths, "o-", label="fastpin")
axes.loglog(parameters, hertz, "--", label="Hertz")
axes.set(xlabel="load parameter", ylabel="contact angle (deg)")
axes.legend()

assert np.all(np.diff(widths) < 0.0)
assert abs(widths[-1] / hertz[-1] - 1.0) < 0.01

# %%
# The load parameter of a joint in SI units:

problem = fastpin.Problem(pair, hole_radius=10e-3, clearance=20e-6, friction=0.2)
print(f"load parameter at 2 MN/m: {problem.load_parameter(2e6):.3f}")
