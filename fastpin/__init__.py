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

import importlib
from typing import Any

import lazy_loader

_face, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)


def __getattr__(name: str) -> Any:
    """A public name. The error of an unknown one says which folders have it."""
    try:
        return _face(name)
    except AttributeError as error:
        if name.startswith("_"):
            raise
        folders = "bodies lugs model solver states damage cracks storage assess studies figures report"
        homes = [f"fastpin.{folder}" for folder in folders.split()]
        found = [home for home in homes if name in getattr(importlib.import_module(home), "__all__", ())]
        if not found:
            raise
        raise AttributeError(f"{error}; there is {' or '.join(f'{home}.{name}' for home in found)}") from None
