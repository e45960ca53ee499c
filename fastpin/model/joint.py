"""The two bodies of a joint with their materials: clearance after assembly, compliances under pressure and force."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np

from fastpin.kernels import harmonics
from fastpin.kernels.harmonics import FREE, HELD, First
from fastpin.model.bodies import Bushing, PinBody, Plate, PlateBody, Ring, Tube
from fastpin.model.compliance import Compliance
from fastpin.model.materials import MaterialPair

PinLoad = Literal["centre", "body"]
"""Kinds of load of a solid pin."""


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
