"""All kinds of bodies. A new body is listed here, and in ``__init__.pyi``."""

from __future__ import annotations

from fastpin.bodies.body import BodyBase, PinBody, PlateBody
from fastpin.bodies.bushing import Bushing
from fastpin.bodies.compliance import Compliance
from fastpin.bodies.pins import Disk, Tube
from fastpin.bodies.plate import Plate
from fastpin.bodies.ring import Ring

PINS: dict[str, type[PinBody]] = {made.kind: made for made in (Disk, Tube)}
"""The classes of pins by their names in files."""

PLATES: dict[str, type[PlateBody]] = {made.kind: made for made in (Plate, Ring, Bushing, Compliance)}
"""The classes of plates by their names in files."""

KINDS: dict[str, type[BodyBase]] = {**PINS, **PLATES}
"""The classes of bodies by their names in files."""

SOLID_PIN, INFINITE_PLATE = Disk(), Plate()
"""The bodies that a problem has unless others are given."""
