"""Joints of several pins: a cover on a sheet, a lap, and a joint file; and what tests read of their states."""

from __future__ import annotations

from typing import Any

from fastpin import Material, MaterialPair
from fastpin.joints import Joint, JointPin, JointPlate, JointResult, tate_rosenfeld
from fastpin.lugs.outline import rectangle

ALUMINIUM, STEEL = Material(72e9, 0.33), Material(210e9, 0.30)
FORCE = 1e6
BETA = MaterialPair(STEEL, ALUMINIUM, "stress").beta_star
SHEET = JointPlate("sheet", ALUMINIUM, 1.0)

SHEETS = """
title = "two bolts"

[joint]
nodes = 24

[[plate]]
name = "sheet"
material = "aluminium"
thickness = 2e-3

[[pin]]
name = ["A", "B"]
at = [[0.0, 0.0], [20e-3, 0.0]]
material = "steel"
diameter = 5e-3
plates = ["sheet"]
clearance = 5e-6
friction = 0.2

[[load]]
"A.x" = 4e3
"B.x" = 2e3

[[load]]
"A.x" = 1e3
"""
"""A joint file: two bolts in an infinite sheet."""


def with_cover(*pins: JointPin, thickness: float = 0.5) -> Joint:
    """Pins that join a free cover to an infinite sheet."""
    cover = JointPlate("cover", ALUMINIUM, thickness, rectangle((-4.0, 16.0), (-4.0, 4.0)), moves="free")
    return Joint((SHEET, cover), pins)


def through_both(name: str, at: complex, clearance: float, **extra: Any) -> JointPin:
    """A steel pin through sheet and cover. The clearance is in units of F beta*."""
    return JointPin(
        name, at, STEEL, 1.0, ("sheet", "cover"), clearance * BETA * FORCE, extra.pop("friction", 0.3), **extra
    )


def peaks(result: JointResult, step: int) -> list[float]:
    return [float(contact.pressure.max()) / FORCE for contact in result[step].contacts]


def dissipated(result: JointResult, step: int) -> float:
    return sum(contact.dissipation for contact in result[step].contacts) / (FORCE * FORCE * BETA)


def lap(clearances: tuple[float, ...], friction: float) -> Joint:
    """A single lap of steel pins in strips: width 8, pitch 6, edge 4, 12 to the held end, all in radii."""
    half = 3.0 * (len(clearances) - 1)
    skin = JointPlate("skin", ALUMINIUM, 1.0, rectangle((-half - 12.0, half + 4.0), (-4.0, 4.0)), {"left": "both"})
    strap = JointPlate(
        "strap", ALUMINIUM, 1.0, rectangle((-half - 4.0, half + 12.0), (-4.0, 4.0)), {"right": "both"}, moves="x"
    )
    soft = tate_rosenfeld(2.0, STEEL, (ALUMINIUM, 1.0), (ALUMINIUM, 1.0))
    pins = [
        JointPin(f"p{k}", -half + 6.0 * k, STEEL, 1.0, ("skin", "strap"), each * BETA * FORCE, friction, soft)
        for k, each in enumerate(clearances)
    ]
    return Joint((skin, strap), tuple(pins))
