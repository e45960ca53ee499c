"""The two bodies of a joint with their materials: rules that tie them, clearance after assembly, compliances."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

from fastpin.bodies.body import PinBody, PinLoad, PlateBody, Rim, Uniform
from fastpin.bodies.harmonics import First
from fastpin.bodies.kinds import INFINITE_PLATE, PINS, PLATES
from fastpin.errors import InputError
from fastpin.model.materials import Material, MaterialPair


@dataclass(frozen=True)
class BodyPair:
    """Pin and plate in the hole radius `radius`, m. :class:`fastpin.Problem` has the same fields."""

    pair: MaterialPair
    radius: float
    pin_body: PinBody
    plate_body: PlateBody
    pin_load: PinLoad

    def check(self, dimensionless: bool) -> None:
        """Check that pin and plate fit the hole and their materials.

        Raises
        ------
        InputError
            If a body is of another class, does not fit, or the load can't act on the pin.
        """
        if not isinstance(self.pin_body, PinBody):
            raise InputError("pin_body", f"must be {_names(PINS)}")
        self.pin_body.check(self.radius)
        if not isinstance(self.plate_body, PlateBody):
            raise InputError("plate_body", f"must be {_names(PLATES)}")
        self.plate_body.check(self.radius, dimensionless)
        self.pin_body.check_load(self.pin_load)
        if not self.pair.plate.is_isotropic and self.plate_body != INFINITE_PLATE:
            raise InputError("plate_body", "must be an infinite plate if it is a laminate, without bush and reaction")
        self.plate_body.check_pair(self.pair, self.radius, dimensionless)

    @cached_property
    def surfaces(self) -> MaterialPair:
        """The materials of the two surfaces in contact: ``pair``, or pin and bush."""
        return self.plate_body.surface(self.pair)

    @cached_property
    def materials(self) -> Mapping[str, Material]:
        """The materials by the words for their bodies: "pin", "plate", and "bush" if there is one."""
        bush = self.plate_body.bush
        return {"pin": self.pair.pin, "plate": self.pair.plate, **({"bush": bush.material} if bush else {})}

    @cached_property
    def owners(self) -> Mapping[str, str]:
        """The words for the bodies at the edges "plate", "seat" and "pin" that have a stress, from the hole outwards.

        The hole's edge is "plate", also in a bush. A bush as the pin of its seat has no stress there: its stress is
        that of its joint.
        """
        edges = {"plate": "plate"} if self.plate_body.bush is None else {"plate": "bush", "seat": "plate"}
        return edges if self.pin_body.is_bush else {**edges, "pin": "pin"}

    @cached_property
    def pin_rim(self) -> Rim:
        """The rim of the pin, with the radius of the hole."""
        return Rim(self.radius, 1.0, self.pair.pin, self.pair.plane)

    @cached_property
    def hole(self) -> Rim:
        """The hole, in the plate's material."""
        return Rim(self.radius, 1.0, self.pair.plate, self.pair.plane)

    @property
    def seat_ratio(self) -> float:
        """Radius of the plate's own hole over R: that of the seat of a bush; 1 without a bush."""
        bush = self.plate_body.bush
        return 1.0 if bush is None else bush.outer_radius / self.radius

    @property
    def pin_first(self) -> First:
        """The first harmonic of the pin."""
        return self.pin_body.first(self.pin_rim, self.pin_load)

    @property
    def plate_first(self) -> First:
        """The first harmonic of the plate, in units of the surface's material."""
        return self.plate_body.first(self.hole)

    @property
    def uniform_compliance(self) -> float:
        """Overlap of pin and hole, over R, per uniform pressure between them, 1/Pa."""
        pin = 0.5 * self.pin_rim.compliance * self.pin_body.uniform(self.pin_rim)
        return pin - self.plate_body.pressed(self.hole)

    @cached_property
    def press_fit(self) -> tuple[float, float]:
        """Pressure between bush and plate, Pa, and displacement of the bush's inner rim, m (Lame); 0 without a bush."""
        return self.plate_body.press_fit(self.hole)

    def assembly_pressures(self, clearance: float) -> tuple[float, float]:
        """Pressures on the pin and in the seat of a bush before any load, Pa (Lame); 0 where nothing is pressed.

        `clearance` is that of the pin after a bush was pressed in, m. The joint is round.
        """
        squeeze = max(-clearance, 0.0) / self.radius
        contact = squeeze / self.uniform_compliance if squeeze else 0.0
        return contact, self.plate_body.seat_pressure(self.hole, contact)

    @property
    def is_round(self) -> bool:
        """Whether pin and hole stay round under uniform pressure: no outline, and no laminate that prevents it."""
        laminate = self.hole.laminate
        return not self.plate_body.lug.edge_only and (laminate is None or laminate.is_isotropic_contact)

    def assembly_stresses(self, clearance: float) -> dict[str, float]:
        """Von Mises stresses after the press fits, before any load, by the edges of elastic bodies, Pa (Lame).

        `clearance` is that of the pin after a bush was pressed in, m; a negative one presses pin and hole together.
        The edges are "hole", "bore of the bush", "rim of the bush", "seat", "pin" and "bore of the pin".
        """
        contact, pin, found = self.assembly_pressures(clearance)[0], self.pin_rim, {}
        if not pin.material.is_rigid:
            inside = Uniform.of_rim(-contact, self.pin_body.uniform(pin), pin.kolosov)
            found["pin"] = inside.von_mises(1.0, pin.material.nu, pin.plane)
            if self.pin_body.bore_radius:
                found["bore of the pin"] = inside.von_mises(self.pin_body.inner(pin), pin.material.nu, pin.plane)
        return found | self.plate_body.assembly_stresses(self.hole, contact)

    def displacement_compliances(self, hub: float | None, gauge: float | None) -> tuple[float, float]:
        """The compliances g and k of the hub's displacement relative to the gauge circle, in units of beta*; (T29).

        The displacement is c + g F - k J. c is the mean displacement of the pin's rim relative to the hole,
        F the force on the pin and J an integral of the tractions.

        Parameters
        ----------
        hub, gauge : float or None
            Radii in the pin and in the plate over R. None: the mean of a body-loaded pin, the bore of another hollow
            pin, the datum of the rotation of any other pin; the outer rim of a ring, the edge of the hole in any other
            plate.
        """
        own, coupling = self.pin_body.translation(self.pin_rim, self.pin_load, hub)
        own_plate, coupling_plate = self.plate_body.translation(self.hole, gauge)
        unit = 4.0 * math.pi * self.surfaces.beta_star
        return (own + own_plate) / unit, (coupling + coupling_plate) / unit


def without_units(pair: MaterialPair, plate_body: PlateBody) -> tuple[PlateBody, MaterialPair]:
    """The plate's body and the materials, scaled so that beta* of the surfaces in contact is 1."""
    return plate_body.without_units(pair) if isinstance(plate_body, PlateBody) else (plate_body, pair.dimensionless)


def _names(kinds: Mapping[str, type]) -> str:
    *names, last = (f"a {made.__name__}" for made in kinds.values())
    return f"{', '.join(names)} or {last}"
