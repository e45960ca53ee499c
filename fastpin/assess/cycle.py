"""A load cycle: the outputs of its largest values."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator

import numpy as np

from fastpin.assess.outputs import Output
from fastpin.states.load_cycle import LoadCycle
from fastpin.states.regimes import REGIMES


def _largest(name: str, kind: str) -> Iterator[Output]:
    """Yield the largest value of a node and its place; NaN if it is not known."""

    def known(read: Callable[[LoadCycle, np.ndarray], float]) -> Callable[[LoadCycle], float]:
        return lambda cycle: math.nan if getattr(cycle, name) is None else read(cycle, getattr(cycle, name))

    yield Output(f"largest_{name}", kind, known(lambda cycle, values: float(values.max())), optional=True)
    yield Output(f"largest_{name}_angle", "angle", known(LoadCycle.angle_of_largest), optional=True)


CYCLE = (
    Output("first", "whole", lambda cycle: cycle.first),
    Output("last", "whole", lambda cycle: cycle.last),
    Output("closed", "truth", lambda cycle: cycle.is_closed),
    *_largest("slip_range", "displacement"),
    *_largest("slip_distance", "displacement"),
    *_largest("friction_energy", "energy density"),
    *_largest("pressure_range", "traction"),
    *_largest("shear_range", "traction"),
    Output("regime", "class", lambda cycle: cycle.regime, classes=REGIMES),
    Output("slip_range_is_exact", "truth", lambda cycle: cycle.has_exact_slip_range),
    Output("dissipation", "energy", lambda cycle: cycle.dissipation, optional=True),
)
"""Outputs of a :class:`fastpin.states.LoadCycle`."""
