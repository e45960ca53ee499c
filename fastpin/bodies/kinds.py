"""All kinds of bodies. A new body is listed here, and in ``__init__.pyi``."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from fastpin.bodies.body import BodyBase, PinBody, PlateBody
from fastpin.bodies.bushing import Bushing
from fastpin.bodies.compliance import Compliance
from fastpin.bodies.pins import Disk, Tube
from fastpin.bodies.plate import Plate
from fastpin.bodies.ring import Ring
from fastpin.errors import InputError
from fastpin.model.checks import choice, number
from fastpin.model.materials import Material

PINS: dict[str, type[PinBody]] = {made.kind: made for made in (Disk, Tube)}
"""The classes of pins by their names in files."""

PLATES: dict[str, type[PlateBody]] = {made.kind: made for made in (Plate, Ring, Bushing, Compliance)}
"""The classes of plates by their names in files."""

KINDS: dict[str, type[BodyBase]] = {**PINS, **PLATES}
"""The classes of bodies by their names in files."""

SOLID_PIN, INFINITE_PLATE = Disk(), Plate()
"""The bodies that a problem has unless others are given."""

TITLES = {kind: made.title for kind, made in PLATES.items() if made.title}
"""The kinds of plates that can be chosen on the live page, with their names there."""

PIN_CONTROLS = tuple(dict.fromkeys(name for made in PINS.values() for name in made.controlled))
"""Names of the controls of pins on the live page."""

PLATE_CONTROLS = tuple(dict.fromkeys(name for made in PLATES.values() for name in made.controlled))
"""Names of the controls of plates on the live page. They are names of fields."""


def changed_pin(body: PinBody, changes: Mapping[str, Any]) -> PinBody:
    """The pin after changes of the controls of the live page. A bore of the radius 0 makes it solid."""
    bore = number("pin_bore", changes.get("pin_bore", body.bore_radius))
    return Tube(bore, changes.get("bore_load", body.load or "uniform")) if bore else Disk()


def changed_plate(body: PlateBody, values: Mapping[str, Any], radius: float, material: Material) -> PlateBody:
    """The plate after changes of the controls of the live page, by the names of fields; "plate_body" is its kind.

    `radius` is that of the hole, m, and `material` that of the plate.
    """
    if body.kind not in TITLES:
        raise InputError("plate_body", f"the {body.kind} of a finite plate can't be changed on the page")
    kind = choice("plate_body", values.get("plate_body", body.kind), tuple(TITLES))
    if kind != body.kind:
        return PLATES[kind].usual(radius, material)
    return body.changed({name: value for name, value in values.items() if name != "plate_body"})
