"""Joints with hollow pins, ring lugs, bushes and compliances."""

from dataclasses import replace
from typing import Any

import numpy as np

from fastpin.bodies import Bushing, Compliance, Plate, Ring, Tube
from fastpin.model.materials import MATERIALS, Material, MaterialPair, Plane
from fastpin.model.problem import Problem
from fastpin.verification.joint_rows import BRONZE
from tests.support.checks.body_cases import ring_compliance

LIKE = MaterialPair(Material(1.0, 0.3), Material(1.0, 0.3))
UNLIKE = MaterialPair(MATERIALS["Ti-6Al-4V"], MATERIALS["aluminium"])
STEEL_ALUMINIUM = MaterialPair(Material(210e9, 0.3), Material(69e9, 0.33))

JOINTS = {
    "tube": (LIKE, {"pin_body": Tube(0.5)}),
    "held tube": (UNLIKE, {"pin_body": Tube(0.7, "held")}),
    "tube, body load": (LIKE, {"pin_body": Tube(0.6, "body")}),
    "held ring": (UNLIKE, {"plate_body": Ring(2.0)}),
    "tube in a ring": (LIKE, {"pin_body": Tube(0.8), "plate_body": Ring(1.5, "uniform")}),
    "half ring": (UNLIKE, {"plate_body": Ring(2.0, "half")}),
    "reaction": (UNLIKE, {"plate_body": Plate((0.7, 2.5))}),
    "bush": (STEEL_ALUMINIUM, {"plate_body": Bushing(BRONZE, 1.25)}),
    "tube, bush, ring": (
        UNLIKE, {"pin_body": Tube(0.5, "shear"), "plate_body": Bushing(BRONZE, 1.3, inside=Ring(2.0, "normal"))}
    ),
}  # fmt: skip
"""Materials and bodies of some joints, in units of the hole radius, by name."""


HOLDS = {
    "plain": {},
    "driven": {"drive": "ux"},
    "spring": {"rotation": "spring", "hub_stiffness": 2.0},
    "fixed": {"rotation": "fixed"},
    "ring": {"plate_body": Ring(2.0, "normal")},
}
"""Fields of problems whose matrices differ, by name."""


def joint_problem(name: str, load_parameter: float, friction: float, **options: object) -> Problem:
    """The dimensionless problem of one of the :data:`JOINTS`, or "ring, compliance": a ring by its compliance."""
    if name == "ring, compliance":
        ring = Problem.from_load_parameter(UNLIKE, load_parameter, friction, plate_body=Ring(2.0, "normal"), **options)
        return replace(ring, plate_body=ring_compliance(ring, 20))
    pair, bodies = JOINTS[name]
    return Problem.from_load_parameter(pair, load_parameter, friction, **bodies, **options)


def softer_hole(radius: float, nu: float, plane: Plane) -> Compliance:
    """A plate that widens more than the infinite one under pressure, and is round otherwise."""
    matrix = np.zeros((26, 26))
    matrix[0, 0] = 0.1
    return Compliance(nu, plane, radius, matrix)


def soft_plate(softer: float = 0.25, **given: Any) -> Compliance:
    """An aluminium plate by hand, in metres: nothing but a softer hole. Other fields may be given."""
    matrix = np.zeros((18, 18))
    matrix[0, 0] = softer
    return Compliance(**{"nu": 0.33, "plane": "strain", "hole_radius": 0.01, "matrix": matrix} | given)
