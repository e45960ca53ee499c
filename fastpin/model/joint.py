"""The two bodies of a joint with their materials: clearance after assembly, compliances under pressure and force."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Literal, NamedTuple

import numpy as np

from fastpin.kernels import harmonics
from fastpin.kernels.harmonics import FREE, HELD, First
from fastpin.model.bodies import Bushing, PinBody, Plate, PlateBody, Ring, Tube
from fastpin.model.compliance import Compliance
from fastpin.model.materials import MaterialPair, Plane

PinLoad = Literal["centre", "body"]
"""Kinds of load of a solid pin."""


class Uniform(NamedTuple):
    """Stresses under pressure all round (Lame): s_rr = mean + decaying/r^2, s_tt = mean - decaying/r^2, Pa.

    The radius counts in units of the radius at which the pressure is given.
    """

    mean: float
    decaying: float

    @classmethod
    def of_rim(cls, radial: float, compliance: float, kolosov: float) -> Uniform:
        """The stresses under s_rr = `radial` at r = 1, where 2G u_r/r is `compliance` times as large."""
        mean = 2.0 * radial * (1.0 + compliance) / (kolosov + 1.0)
        return cls(mean, radial - mean)

    @classmethod
    def of_press_fit(cls, pressure: float, outer: float) -> Uniform:
        """The stresses of a ring, 1 <= r <= `outer`, under a pressure on its outer rim."""
        mean = -pressure / ((1.0 - 1.0 / outer) * (1.0 + 1.0 / outer))
        return cls(mean, -mean)

    def __add__(self, other: object) -> Uniform:
        assert isinstance(other, Uniform)
        return Uniform(self.mean + other.mean, self.decaying + other.decaying)

    def radial(self, radius: float) -> float:
        """s_rr at a radius."""
        return self.mean + self.decaying / radius**2

    def von_mises(self, radius: float, nu: float, plane: Plane) -> float:
        """The von Mises stress at a radius."""
        one, other = self.radial(radius), self.mean - self.decaying / radius**2
        third = nu * (one + other) if plane == "strain" else 0.0
        return math.sqrt(0.5 * ((one - other) ** 2 + (other - third) ** 2 + (third - one) ** 2))


@dataclass(frozen=True)
class Joint:
    """Pin and plate in the hole radius `radius`, m. The fields are those of :class:`fastpin.model.Problem`."""

    pair: MaterialPair
    radius: float
    pin_body: PinBody
    plate_body: PlateBody
    pin_load: PinLoad

    @cached_property
    def surfaces(self) -> MaterialPair:
        """The materials of the two surfaces in contact: those of ``pair``, or pin and bush."""
        if isinstance(self.plate_body, Bushing):
            return MaterialPair(self.pair.pin, self.plate_body.material, self.pair.plane)
        return self.pair

    @property
    def bore(self) -> float:
        """Bore of the pin over R; 0 of a solid pin."""
        return self.pin_body.bore_radius / self.radius if isinstance(self.pin_body, Tube) else 0.0

    @property
    def bore_kind(self) -> str:
        """Whether the bore is held."""
        return HELD if isinstance(self.pin_body, Tube) and self.pin_body.held else FREE

    @property
    def pin_first(self) -> First:
        """The first harmonic of the pin."""
        load = self.pin_body.load if isinstance(self.pin_body, Tube) else self.pin_load
        return harmonics.first(self.bore, self.pair.pin_kolosov, load)

    @property
    def bush(self) -> float | None:
        """Outer radius of the bush over R; None without a bush."""
        return self.plate_body.outer_radius / self.radius if isinstance(self.plate_body, Bushing) else None

    @property
    def lug(self) -> Plate | Ring | Compliance:
        """The plate's body; the body round the bush if there is a bush."""
        return self.plate_body.inside if isinstance(self.plate_body, Bushing) else self.plate_body

    @property
    def lug_rim(self) -> float:
        """Outer radius of the lug over the radius of its own hole; infinite if it has no rim."""
        lug = self.lug
        return lug.outer_radius / (self.radius * (self.bush or 1.0)) if isinstance(lug, Ring) else math.inf

    @property
    def lug_kind(self) -> str:
        """Whether the rim of the lug is held."""
        return HELD if isinstance(self.lug, Ring) and self.lug.held else FREE

    @property
    def lug_first(self) -> First:
        """The first harmonic of the lug, on its own hole."""
        load = self.lug.support if isinstance(self.lug, Ring) else "uniform"
        return harmonics.first(self.lug_rim, self.pair.plate_kolosov, load)

    @property
    def bush_first(self) -> First:
        """The first harmonic of the bush on its inner rim."""
        assert self.bush is not None
        far = 0.5 * self.pair.plate_compliance * self.lug_first.displacement()
        surfaces = self.surfaces
        return harmonics.first_of_layer(self.bush, surfaces.plate_kolosov, surfaces.plate_compliance, far)

    @property
    def lug_uniform(self) -> float:
        """Whole compliance of the lug's own hole under pressure, 1/Pa; negative, as the hole widens under pressure."""
        rim = harmonics.uniform(self.lug_rim, self.pair.plate_kolosov, self.lug_kind)
        return 0.5 * self.pair.plate_compliance * rim

    @property
    def uniform_compliance(self) -> float:
        """Overlap of pin and hole, over R, per uniform pressure between them, 1/Pa."""
        pin = harmonics.uniform(self.bore, self.pair.pin_kolosov, self.bore_kind)
        found = 0.5 * self.pair.pin_compliance * pin
        if isinstance(self.plate_body, Compliance):
            return found + self.pair.plate_compliance * (0.5 + float(self.plate_body.matrix[0, 0]))
        whole = self.lug_uniform
        if self.bush is not None:
            bush = self.surfaces
            whole = harmonics.uniform_of_layer(self.bush, bush.plate_kolosov, bush.plate_compliance, whole)
        return found - whole

    @cached_property
    def press_fit(self) -> tuple[float, float]:
        """Pressure between bush and plate, Pa, and displacement of the bush's inner rim, m (Lame); 0 without a bush."""
        body = self.plate_body
        if not isinstance(body, Bushing) or body.interference == 0.0:
            return 0.0, 0.0
        bush, inner = self.surfaces, self.radius / body.outer_radius
        pressure, moved = harmonics.press_fit(inner, bush.plate_kolosov, bush.plate_compliance, -self.lug_uniform)
        relative = body.interference / body.outer_radius
        return pressure * relative, moved * relative * self.radius

    def assembly_stresses(self, clearance: float) -> dict[str, float]:
        """Von Mises stresses after the press fits, before any load, by the edges of elastic bodies, Pa (Lame).

        `clearance` is that of the pin after a bush was pressed in, m; a negative one presses pin and hole together.
        The edges are "hole", "bore of the bush", "rim of the bush", "seat", "pin" and "bore of the pin".
        """
        squeeze = max(-clearance, 0.0) / self.radius
        contact = squeeze / self.uniform_compliance if squeeze else 0.0
        found: dict[str, float] = {}
        pin, plate = self.pair.pin, self.pair.plate
        if not pin.is_rigid:
            rim = harmonics.uniform(self.bore, self.pair.pin_kolosov, self.bore_kind)
            inside = Uniform.of_rim(-contact, rim, self.pair.pin_kolosov)
            found["pin"] = inside.von_mises(1.0, pin.nu, self.pair.plane)
            if self.bore:
                found["bore of the pin"] = inside.von_mises(self.bore, pin.nu, self.pair.plane)
        passed = contact
        if self.bush is not None:
            bush, unit = self.surfaces.plate, 0.5 * self.surfaces.plate_compliance
            kolosov = self.surfaces.plate_kolosov
            whole = harmonics.uniform_of_layer(self.bush, kolosov, 2.0 * unit, self.lug_uniform) / unit
            inside = Uniform.of_rim(-contact, whole, kolosov) + Uniform.of_press_fit(self.press_fit[0], self.bush)
            found["bore of the bush"] = inside.von_mises(1.0, bush.nu, self.pair.plane)
            found["rim of the bush"] = inside.von_mises(self.bush, bush.nu, self.pair.plane)
            passed = -inside.radial(self.bush)
        if not plate.is_rigid:
            unit = 0.5 * self.pair.plate_compliance
            if isinstance(self.plate_body, Compliance):
                whole = -1.0 - 2.0 * float(self.plate_body.matrix[0, 0])
            else:
                whole = self.lug_uniform / unit
            around = Uniform.of_rim(-passed, whole, self.pair.plate_kolosov)
            found["hole" if self.bush is None else "seat"] = around.von_mises(1.0, plate.nu, self.pair.plane)
        return found

    def displacement_compliances(self, hub: float | None, gauge: float | None) -> tuple[float, float]:
        """The compliances g and k of the hub's displacement relative to the gauge circle, in units of beta*; (T29).

        The displacement is c + g F - k J. c is the mean displacement of the pin's rim relative to the hole,
        F the force on the pin and J an integral of the tractions.

        Parameters
        ----------
        hub, gauge : float or None
            Radii in the pin and in the plate over R. None: the bore of a hollow pin, the mean of a body-loaded solid
            pin, the datum of the rotation of any other pin; the outer rim of a ring, the edge of the hole in any other
            plate.
        """
        own, coupling = self._of_pin(hub)
        own_plate, coupling_plate = self._of_plate(gauge)
        unit = 4.0 * math.pi * self.surfaces.beta_star
        return (own + own_plate) / unit, (coupling + coupling_plate) / unit

    def _of_pin(self, hub: float | None) -> tuple[float, float]:
        kolosov, compliance = self.pair.pin_kolosov, self.pair.pin_compliance
        if isinstance(self.pin_body, Tube):
            of_traction, of_force = self.pin_first.translation(self.bore if hub is None else hub)
            return of_force * compliance, -of_traction * compliance
        if self.pin_load == "body":
            return 0.5 * compliance, 0.5 * compliance
        part = 1.0 / math.sqrt(kolosov + 1.0) if hub is None else hub
        coupling = (1.0 - part**2) * compliance
        own = 2.0 * (1.0 - part**2 - kolosov * math.log(part)) / (kolosov + 1.0) * compliance
        return own, coupling

    def _of_plate(self, gauge: float | None) -> tuple[float, float]:
        """The plate's part of g and k."""
        rim = 1.0 if self.bush is None else self.bush
        if gauge is None:
            gauge = self.lug_rim * rim if isinstance(self.lug, Ring) else 1.0
        if gauge == 1.0:
            return 0.0, 0.0
        if self.bush is None:
            of_traction, of_force = self.lug_first.translation(gauge)
            return -of_force * self.pair.plate_compliance, of_traction * self.pair.plate_compliance
        bush = self.bush_first
        moved = bush.translation(min(gauge, rim)) * self.surfaces.plate_compliance
        if gauge > rim:
            tractions = np.array([bush.traction(rim), [0.0, 1.0 / rim]])  # t_1 and conj t_-1 on the lug's hole
            moved = moved + self.lug_first.translation(gauge / rim) @ tractions * rim * self.pair.plate_compliance
        return -float(moved[1]), float(moved[0])
