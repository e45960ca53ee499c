"""Checks of a bush that slips in its seat."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from fastpin import MATERIALS, MaterialPair, Problem
from fastpin.bodies import Bushing, Disk
from fastpin.bodies.body import PlateBody
from fastpin.verification.rows import Checks, Solving, difference_check, relative_check

PAIR = MaterialPair(MATERIALS["steel"], MATERIALS["aluminium"], "strain")

BRONZE = MATERIALS["C93200"]

OUTER = 1.25
"""Outer radius of the bush, over R."""

NODES = 128
"""Nodes of the pin, and of the seat."""


def solid_pin(solving: Solving) -> Checks:
    """A pin that sticks in a bush of its own material: together they are a solid pin in the hole of the seat."""
    bush = Bushing(BRONZE, OUTER, 1e-3, friction=0.05, bonded=False)
    pair = MaterialPair(BRONZE, PAIR.plate, PAIR.plane)
    joint = Problem.from_load_parameter(pair, -0.25, 5.0, plate_body=bush)
    corners = [{"P": 1.0}, {"Q": 0.4}, {"Q": -0.4}, {"P": 0.3}]
    assembled, *states = solving(joint, [{}, *corners], nodes=NODES)
    seat = joint.interfaces[1]
    assert assembled.seat is not None
    pressure = float(assembled.seat.pressure.mean())
    solid = replace(seat, pin_body=Disk(), clearance=-1.0)
    solid = replace(solid, clearance=-pressure * solid.joint.uniform_compliance * seat.hole_radius)
    expected = solving(solid, corners, nodes=NODES)
    seats = [state.seat for state in states if state.seat is not None]
    size = max(state.peak_pressure for state in expected)
    differences = [
        max(float(np.abs(getattr(one, name) - getattr(other, name)).max()) for name in ("pressure", "shear"))
        for one, other in zip(seats, expected, strict=True)
    ]
    yield difference_check("N, T", max(differences) / size, "peak N")
    yield difference_check("dissipated", abs(seats[-1].dissipation / expected[-1].dissipation - 1.0), "relative")


def bonded(inside: PlateBody, solving: Solving) -> Checks:
    """A bush of much friction in its seat, against the bonded bush."""
    slipping = Bushing(BRONZE, OUTER, 0.26, inside, 1e3, bonded=False)  # type: ignore[arg-type]
    bodies = slipping, replace(slipping, friction=None, bonded=True)
    problems = (Problem.from_load_parameter(PAIR, 0.28, 0.2, plate_body=body) for body in bodies)
    ours, expected = (solving(each, [{"P": 1.0}, {"Q": 0.3}], nodes=NODES)[-1] for each in problems)
    yield relative_check("peak N", ours.peak_pressure, expected.peak_pressure)
    for name in ("ux", "uy"):
        moved = ours.joint_displacement(0.5, 2.0)[name], expected.joint_displacement(0.5, 2.0)[name]
        yield difference_check(name, abs(moved[0] - moved[1]), "F beta*")
