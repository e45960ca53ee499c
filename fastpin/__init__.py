"""fastpin: frictional contact of an elastic pin in the hole of an elastic plate.

Notation, signs and units
-------------------------
The angle theta counts from the +x axis, counter-clockwise; the bottom of the hole is theta = -pi/2. Pressure is
positive in compression. Shear is the traction **on the pin**, positive along +theta; the plate feels the opposite. Slip
is the motion of the pin over the plate, positive along +theta. P pushes the pin down (-y), Q pushes it along +x, M
turns it counter-clockwise. All loads are per unit thickness.

Input and results are in SI units (N/m, N, Pa, m, rad). ``Problem.from_load_parameter`` gives the paper's
dimensionless problem (R = F = beta* = 1). All arrays of a state have one entry per node, shape (n,).

    >>> import fastpin
    >>> pair = fastpin.MaterialPair(fastpin.MATERIALS["Ti-6Al-4V"], fastpin.MATERIALS["aluminium"])
    >>> problem = fastpin.Problem.from_load_parameter(pair, 0.1, friction=0.4, pin_load="body")
    >>> result = fastpin.solve(problem, [{"P": 1.0}], nodes=101)
    >>> round(result[-1].peak_pressure, 3)
    0.529
"""

import lazy_loader

from fastpin.moved import with_homes, with_moved

_face, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
__getattr__ = with_homes(
    with_moved(_face, lambda: _face("figures"), ("plot_convergence",)),
    (
        "bodies",
        "lugs",
        "model",
        "solver",
        "states",
        "damage",
        "cracks",
        "storage",
        "assess",
        "studies",
        "figures",
        "report",
    ),
)
