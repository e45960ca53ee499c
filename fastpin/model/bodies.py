"""Bodies other than a solid pin and an infinite plate: hollow pins, ring lugs, bushings and any finite plate.

A body says its shape and how its load enters or leaves it. The materials stand in the problem's pair. Lengths are in m,
or in units of R for a dimensionless problem. docs/bodies.md explains the choices.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, fields
from typing import Any, Literal

from fastpin.errors import InputError
from fastpin.model.checks import choice, instance, not_negative, number, positive
from fastpin.model.compliance import Compliance
from fastpin.model.materials import Material
from fastpin.model.synonyms import explains_keywords

TubeLoad = Literal["uniform", "normal", "shear", "held", "body"]
"""Kinds of load in the bore of a hollow pin."""

TUBE_LOADS: tuple[TubeLoad, ...] = ("uniform", "normal", "shear", "held", "body")

Support = Literal["held", "uniform", "normal", "shear", "half", "body"]
"""Kinds of support of a ring's outer rim."""

SUPPORTS: tuple[Support, ...] = ("held", "uniform", "normal", "shear", "half", "body")

THINNEST = 0.04
"""Least wall of a tube or ring, in parts of its larger radius.

A thinner wall is a shell: it bends 10,000 times as much as its surface yields, and contacts are lost between the nodes.
"""

THINNEST_LAYER = 0.01
"""Least wall of a bush, in parts of its outer radius. It is bonded and does not bend; a thinner one is a coating."""

WIDEST = 1e6
"""Largest outer radius, in parts of the hole radius. A larger body is an infinite plate."""

NEAREST = 1.05
"""Least distance of a point reaction from the centre, in parts of the hole radius."""


@dataclass(frozen=True)
class Disk:
    """A solid pin. Its load enters as the problem's ``pin_load`` says."""


@explains_keywords
@dataclass(frozen=True)
class Tube:
    """A hollow pin. The forces on the pin enter at its bore.

    Parameters
    ----------
    bore_radius : float
        Radius of the bore, m, less than the hole radius.
    load : {"uniform", "normal", "shear", "held", "body"}
        "uniform": a traction of one size and direction all round the bore. "normal": normal traction alone, like the
        cosine of the angle from the force. "shear": shear traction alone, like the sine. "held": a rigid core is bonded
        to the bore. "body": a uniform body force; the bore is free. A moment enters by a uniform shear traction.

    Raises
    ------
    InputError
        If the radius is not positive, or the load is unknown.
    """

    bore_radius: float
    load: TubeLoad = "uniform"

    def __post_init__(self) -> None:
        object.__setattr__(self, "bore_radius", positive("bore_radius", self.bore_radius))
        choice("load", self.load, TUBE_LOADS)

    @property
    def held(self) -> bool:
        """Whether a rigid core holds the bore."""
        return self.load == "held"


@explains_keywords
@dataclass(frozen=True)
class Plate:
    """An infinite plate.

    Parameters
    ----------
    reaction : (float, float), optional
        Point (x, y), m from the centre of the hole, at which a force balances P and Q, such as a bolt in the shank. By
        default the forces are balanced far away.

    Raises
    ------
    InputError
        If the point is no pair of numbers.
    """

    reaction: tuple[float, float] | None = None

    def __post_init__(self) -> None:
        if self.reaction is None:
            return
        if not isinstance(self.reaction, (tuple, list)) or len(self.reaction) != 2:
            raise InputError("reaction", "must be a point [x, y]")
        x, y = (number("reaction", value) for value in self.reaction)
        object.__setattr__(self, "reaction", (x, y))


@explains_keywords
@dataclass(frozen=True)
class Ring:
    """A ring lug: a plate with a circular outer rim round the hole.

    Parameters
    ----------
    outer_radius : float
        Radius of the outer rim, m, more than the hole radius.
    support : {"held", "uniform", "normal", "shear", "half", "body"}
        How the forces on the pin leave the ring. "held": the rim is clamped. "uniform": a traction of one size and
        direction all round the rim. "normal": normal traction alone, like the cosine of the angle from the force.
        "shear": shear traction alone, like the sine. "half": normal pressure like the cosine, on the half of the rim
        that a positive force pushes towards: below for P, on the right for Q. "body": a uniform body force. A moment
        leaves by a uniform shear traction.

    Raises
    ------
    InputError
        If the radius is not positive, or the support is unknown.
    """

    outer_radius: float
    support: Support = "held"

    def __post_init__(self) -> None:
        object.__setattr__(self, "outer_radius", positive("outer_radius", self.outer_radius))
        choice("support", self.support, SUPPORTS)

    @property
    def held(self) -> bool:
        """Whether the outer rim is clamped."""
        return self.support == "held"


@explains_keywords
@dataclass(frozen=True)
class Bushing:
    """A bush in the hole of the plate, bonded to it. The pin touches the bush.

    Parameters
    ----------
    material : Material
        The bush. The plate of the problem's pair is the body round it.
    outer_radius : float
        Outer radius of the bush, m, more than the hole radius. The hole radius is the inner radius of the bush.
    interference : float
        Radial interference of the bush in the plate before it is pressed in, m, at least 0. The press fit makes the
        clearance of the pin smaller. In a dimensionless problem the unit is F beta*, as of the clearance.
    inside : Plate or Ring
        The body round the bush.
    friction : float, optional
        Coefficient of friction between bush and plate. It changes no state; it tells whether the bush would slip.

    Raises
    ------
    InputError
        If a field is out of range or of another class.
    """

    material: Material
    outer_radius: float
    interference: float = 0.0
    inside: Plate | Ring = field(default_factory=Plate)
    friction: float | None = None

    def __post_init__(self) -> None:
        instance("material", self.material, Material, "a Material")
        if self.material.is_rigid:
            raise InputError("material", "a rigid bush is a rigid plate: leave the bush out")
        object.__setattr__(self, "outer_radius", positive("outer_radius", self.outer_radius))
        object.__setattr__(self, "interference", not_negative("interference", self.interference))
        if not isinstance(self.inside, (Plate, Ring)):
            raise InputError("inside", "must be a Plate or a Ring: a bush sits in an infinite plate or a ring")
        if self.friction is not None:
            object.__setattr__(self, "friction", not_negative("friction", self.friction))


PinBody = Disk | Tube
PlateBody = Plate | Ring | Bushing | Compliance

KINDS: dict[str, type[PinBody | PlateBody]] = {
    "disk": Disk,
    "tube": Tube,
    "plate": Plate,
    "ring": Ring,
    "bushing": Bushing,
    "compliance": Compliance,
}
"""The classes of bodies by their names in files."""


def kind_of(body: PinBody | PlateBody) -> str:
    """The name of a body's class in files, a key of :data:`KINDS`."""
    return next(kind for kind, made in KINDS.items() if made is type(body))


def body_document(body: PinBody | PlateBody, material: Callable[[Material], Any]) -> dict[str, Any]:
    """Return a body as a JSON-ready dict: its kind, and its fields by name.

    `material` turns the material of a bush into its entry. A compliance enters by the SHA-256 of its numbers.
    """
    if isinstance(body, Compliance):
        return {"kind": kind_of(body), "sha256": body.digest}
    found: dict[str, Any] = {"kind": kind_of(body)}
    for each in fields(body):
        value = getattr(body, each.name)
        if isinstance(value, Material):
            value = material(value)
        elif isinstance(value, (Plate, Ring)):
            value = body_document(value, material)
        found[each.name] = list(value) if isinstance(value, tuple) else value
    return found


def check_pin_body(body: PinBody, radius: float) -> None:
    """Check that a pin's body fits a hole of this radius, m.

    Raises
    ------
    InputError
        If the body is of another class, or the wall of a tube is too thin.
    """
    if not isinstance(body, (Disk, Tube)):
        raise InputError("pin_body", "must be a Disk or a Tube")
    if isinstance(body, Tube) and not body.bore_radius <= (1.0 - THINNEST) * radius:
        raise InputError(
            "bore_radius",
            f"must be at most {(1.0 - THINNEST) * radius:g}, {1.0 - THINNEST:g} of the hole radius, "
            f"not {body.bore_radius:g}",
        )


def check_plate_body(body: PlateBody, radius: float, dimensionless: bool = False) -> None:
    """Check that a plate's body fits round a hole of this radius, m.

    The interference of a bush is not checked in a `dimensionless` problem: it then counts in units of F beta*.

    Raises
    ------
    InputError
        If the body is of another class, or a wall is too thin.
    """
    if isinstance(body, Plate):
        _check_reaction(body, radius)
    elif isinstance(body, Ring):
        _check_outer(body.outer_radius, radius, "hole radius", THINNEST)
    elif isinstance(body, Bushing):
        _check_outer(body.outer_radius, radius, "hole radius", THINNEST_LAYER)
        if isinstance(body.inside, Ring):
            _check_outer(body.inside.outer_radius, body.outer_radius, "outer radius of the bush", THINNEST)
        else:
            _check_reaction(body.inside, body.outer_radius)
        if not dimensionless and body.interference >= body.outer_radius:
            raise InputError(
                "interference",
                f"must be smaller than the outer radius {body.outer_radius:g} of the bush, not {body.interference:g}",
            )
    elif not isinstance(body, Compliance):
        raise InputError("plate_body", "must be a Plate, a Ring, a Bushing or a Compliance")


def _check_outer(outer: float, inner: float, name: str, thinnest: float) -> None:
    least, most = inner / (1.0 - thinnest), WIDEST * inner
    if not least <= outer <= most:
        raise InputError(
            "outer_radius", f"must lie between {least:g} and {most:g} for the {name} {inner:g}, not {outer:g}"
        )


def _check_reaction(plate: Plate, radius: float) -> None:
    if plate.reaction is not None and not NEAREST * radius <= math.hypot(*plate.reaction) <= WIDEST * radius:
        raise InputError(
            "reaction",
            f"must be a point from {NEAREST * radius:g} to {WIDEST * radius:g} from the centre, "
            f"not {math.hypot(*plate.reaction):g}",
        )
