"""fastpin: frictional contact of an elastic pin in the hole of an elastic plate.

Notation, signs and units
-------------------------
theta is measured from the +x axis, counter-clockwise; the bottom of the hole is theta = -pi/2. On the contact,
pressure is positive in compression; shear is the traction **on the pin**, positive along +theta (the plate feels the
opposite); slip is the motion of the pin over the plate, positive along +theta. P pushes the pin down (-y), Q along
+x, M turns it counter-clockwise. All loads are per unit thickness.

SI units (N/m, N, Pa, m, rad) go in and come out. ``Problem.from_load_parameter`` gives the dimensionless problem of
the paper (R = F = beta* = 1). All arrays of a state have one entry per node, shape (n,).

    >>> import fastpin
    >>> pair = fastpin.MaterialPair(fastpin.MATERIALS["Ti-6Al-4V"], fastpin.MATERIALS["aluminium"])
    >>> problem = fastpin.Problem.from_load_parameter(pair, 0.1, friction=0.4, pin_load="body")
    >>> result = fastpin.solve(problem, [{"P": 1.0}], nodes=101)
    >>> round(result[-1].peak_pressure, 3)
    0.529
"""

from __future__ import annotations

import importlib
import importlib.util
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from fastpin.errors import (
        ArcError,
        ConvergenceError,
        FastpinError,
        InputError,
        NoEquilibriumError,
        SolveError,
    )
    from fastpin.grid import Grid
    from fastpin.loading import LoadHistory
    from fastpin.materials import MATERIALS, Material, MaterialPair
    from fastpin.problem import Problem
    from fastpin.solver import solve
    from fastpin.state import OPEN, SLIP_NEGATIVE, SLIP_POSITIVE, STICK, Result, State

__version__ = "0.1.0"

__all__ = [
    "MATERIALS",
    "OPEN",
    "SLIP_NEGATIVE",
    "SLIP_POSITIVE",
    "STICK",
    "ArcError",
    "ConvergenceError",
    "FastpinError",
    "Grid",
    "InputError",
    "LoadHistory",
    "Material",
    "MaterialPair",
    "NoEquilibriumError",
    "Problem",
    "Result",
    "SolveError",
    "State",
    "solve",
]

_MODULES = {
    "errors": ("ArcError", "ConvergenceError", "FastpinError", "InputError", "NoEquilibriumError", "SolveError"),
    "grid": ("Grid",),
    "loading": ("LoadHistory",),
    "materials": ("MATERIALS", "Material", "MaterialPair"),
    "problem": ("Problem",),
    "solver": ("solve",),
    "state": ("OPEN", "SLIP_NEGATIVE", "SLIP_POSITIVE", "STICK", "Result", "State"),
}
"""Where the names of ``__all__`` are defined."""


def __getattr__(name: str) -> Any:
    """Import a public name or a module only when it is asked for: the command line answers at once if it needs none."""
    for module, names in _MODULES.items():
        if name in names:
            value = getattr(importlib.import_module(f"fastpin.{module}"), name)
            globals()[name] = value
            return value
    if not name.startswith("_") and importlib.util.find_spec(f"fastpin.{name}") is not None:
        return importlib.import_module(f"fastpin.{name}")
    raise AttributeError(f"module 'fastpin' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
