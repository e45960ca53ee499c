"""A bush in the hole of a plate, bonded or held by friction."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import lru_cache, partial
from typing import Any, ClassVar, Self

import numpy as np

from fastpin.bodies import harmonics
from fastpin.bodies.body import (
    MOST_DRY,
    THINNEST,
    Control,
    Harmonics,
    InWords,
    PlateBody,
    Remote,
    Rim,
    Shape,
    Table,
    Uniform,
    check_outer,
)
from fastpin.bodies.compliance import Compliance
from fastpin.bodies.harmonics import First, Layer
from fastpin.bodies.pins import SeatedBush
from fastpin.bodies.plate import Plate
from fastpin.bodies.ring import Ring
from fastpin.bodies.walls import Amplitudes, Displacements, PlateWalls, first_change, force_on, pairs_of, spectrum
from fastpin.errors import InputError
from fastpin.model.checks import (
    MOST_FRICTION,
    MOST_PARAMETER,
    check_fields,
    instance,
    not_negative,
    number,
    positive,
    true_or_false,
)
from fastpin.model.loads import STRESSING, P, Q
from fastpin.model.materials import MATERIAL_KEYS, MATERIALS, Material, MaterialPair, check_moduli
from fastpin.model.synonyms import explains_keywords

STUCK = 1e3
"""Coefficient of friction in the seat of a bonded bush in a lug of any outline. Nothing slips there."""


@explains_keywords
@dataclass(frozen=True)
class Bushing(PlateBody):
    """A bush in the hole of the plate, bonded to it or held by friction. The pin touches the bush.

    A bush that is not bonded sticks, slips, opens and walks: its seat is an interface of its own. That of a bonded bush
    in a lug of any outline is one, too.

    Parameters
    ----------
    material : Material
        The bush. The plate of the problem's pair is the body round it.
    outer_radius : float
        Outer radius of the bush, m, more than the hole radius. The hole radius is the inner radius of the bush.
    interference : float
        Radial interference of the bush in the plate before it is pressed in, m. The press fit makes the clearance of
        the pin smaller. A bush that slips may be loose: a negative interference is its clearance in the plate. In a
        dimensionless problem the unit is F beta*, as of the clearance.
    inside : Plate, Ring or Compliance
        The body round the bush. A compliance belongs to a hole of the outer radius.
    friction : float, optional
        Coefficient of friction between bush and plate, of a bush that is not bonded.
    bonded : bool
        Whether the bush is bonded to the plate. In a lug of any outline, a :class:`Compliance`, the press fit must
        hold it: its interference must be positive, and no state is returned in which it would open.

    Raises
    ------
    InputError
        If a field is out of range or of another class.
    """

    kind = "bushing"
    keys: ClassVar = dict.fromkeys(MATERIAL_KEYS, "") | {
        "outer_radius": "length", "interference": "displacement", "bonded": "", "friction": "",
        "ring_outer_radius": "length", "support": "", "reaction": "length", "lug_file": "",
    }  # fmt: skip
    controlled = ("outer_radius", "interference", "seat_friction")
    title = "plate with a bush"

    material: Material
    outer_radius: float
    interference: float = 0.0
    inside: Plate | Ring | Compliance = field(default_factory=Plate)
    friction: float | None = None
    bonded: bool = True

    def __post_init__(self) -> None:
        instance("material", self.material, Material, "a Material")
        if not self.material.is_isotropic:
            raise InputError("material", "must be isotropic: a laminate can only be the material of the plate")
        if self.material.is_rigid:
            raise InputError("material", "a rigid bush is a rigid plate: leave the bush out")
        check_fields(self, positive, "outer_radius")
        check_fields(self, true_or_false, "bonded")
        check_fields(self, not_negative if self.bonded else number, "interference")
        if not isinstance(self.inside, (Plate, Ring, Compliance)):
            raise InputError("inside", "must be a Plate, a Ring or a Compliance")
        check_fields(self, not_negative, "friction", optional=True)
        check_fields(self, number, "friction", 0.0, MOST_FRICTION, optional=True)
        if self.bonded and self.friction is not None:
            raise InputError("friction", "a bonded bush does not slip: leave friction out, or set bonded = false")
        if not self.bonded and self.friction is None:
            raise InputError("friction", "a bush that is not bonded needs its friction in the plate")

    @property
    def has_seat(self) -> bool:
        """Whether its seat is an interface of its own. That of a bonded bush is one in a lug of any outline."""
        return not self.bonded or isinstance(self.inside, Compliance)

    @property
    def lug(self) -> PlateBody:
        return self.inside

    @property
    def bush(self) -> Bushing:
        return self

    # -- case files

    @classmethod
    def read(cls, table: Table) -> Self | None:
        material = table.material()
        table.require("outer_radius")
        outer = table.checked("outer_radius", positive)
        bonded = table.checked("bonded", true_or_false)
        interference = table.checked("interference", number if bonded is False else not_negative)
        friction = table.checked("friction", not_negative)
        inside: Plate | Ring | Compliance | None
        if "lug_file" in table:
            for key in ("ring_outer_radius", "support", "reaction"):
                if key in table:
                    table.report(f"{key}: can't be given together with lug_file", key)
            inside = Compliance.read(table, "lug_file")
        elif "ring_outer_radius" in table:
            if "reaction" in table:
                table.report("reaction: can't be given together with ring_outer_radius", "reaction")
            inside = Ring.read(table, "ring_outer_radius")
        else:
            if "support" in table:
                table.report("support: needs ring_outer_radius, the outer radius of the ring round the bush", "support")
            inside = Plate.read(table)
        is_wrong = any(value is None and key in table for key, value in (("friction", friction), ("bonded", bonded)))
        if material is None or outer is None or is_wrong:
            return None
        values = {"material": material, "outer_radius": outer, "inside": inside or Plate(), "friction": friction}
        values["bonded"] = bonded is not False
        key = next(key for key in ("rigid", "material", "E", "nu") if key in table)
        return table.build(cls, {**values, "interference": interference or 0.0}, {}, {"material": (table, key)})

    def fitted(self, table: Table, radius: float, dimensionless: bool, pair: MaterialPair | None) -> PlateBody | None:
        key = "material" if "material" in table else "E"
        bush = Bushing(self.material, self.outer_radius, friction=self.friction, bonded=self.bonded)
        if not table.passes(partial(bush.check, radius, dimensionless)):
            return None
        if pair is not None and not table.passes(partial(bush.check_material, pair), {"material": key}):
            return None
        within = replace(bush, inside=self.inside)
        if table.passes(partial(within.check, radius, dimensionless), {"outer_radius": "ring_outer_radius"}):
            bush = within
        pressed = replace(bush, interference=self.interference)
        return pressed if table.passes(partial(pressed.check, radius, dimensionless)) else bush

    def entries(self) -> dict[str, Any]:
        found = super().entries()
        if self.bonded:
            del found["bonded"]  # as files of earlier versions have it
        return found

    def as_json(self, material: Callable[[Material], Any]) -> dict[str, Any]:
        return super().as_json(material) | {"inside": self.inside.as_json(material)}

    @classmethod
    def from_entries(cls, entries: Mapping[str, Any]) -> Self:
        if "bonded" not in entries:  # earlier versions knew the friction of a bonded bush, which changed no state
            entries = {name: value for name, value in entries.items() if name != "friction"}
        return super().from_entries(entries)

    def toml(self) -> dict[str, Any]:
        found = super().toml()
        if self.bonded:
            del found["bonded"]
        inside, material = found.pop("inside").toml(), found.pop("material").toml()
        inside = {"ring_outer_radius" if name == "outer_radius" else name: value for name, value in inside.items()}
        return material | found | inside

    # -- checks and materials

    def check(self, radius: float, dimensionless: bool = False, name: str = "hole radius") -> None:
        # A bonded bush does not bend. Below 0.01 of its outer radius it is a coating.
        check_outer(self.outer_radius, radius, name, THINNEST if self.has_seat else 0.01)
        self.inside.check(self.outer_radius, name="outer radius of the bush")
        if not dimensionless and abs(self.interference) >= self.outer_radius:
            limit = f"must be smaller than the outer radius {self.outer_radius:g} of the bush"
            raise InputError("interference", f"{limit}, not {self.interference:g}")

    def check_material(self, pair: MaterialPair) -> None:
        """Raise :class:`InputError` if the moduli of pin and bush are too different for one contact."""
        check_moduli("material", "pin and bush", pair.pin, self.material)

    def check_pair(self, pair: MaterialPair, radius: float, dimensionless: bool) -> None:
        self.check_material(pair)
        self.inside.check_pair(pair, self.outer_radius, dimensionless)
        if self.bonded and self.has_seat and not self.interference > 0.0:
            words = "must be positive: a bonded bush in a lug of any outline is held by its press fit"
            raise InputError("interference", words)
        number("interference", self.interference, -MOST_PARAMETER, MOST_PARAMETER)

    def contacts(self, pair: MaterialPair, radius: float) -> tuple[dict[str, Any], ...]:
        if not self.has_seat:
            return ()
        seat = {
            "pair": MaterialPair(self.material, pair.plate, pair.plane), "hole_radius": self.outer_radius,
            "clearance": -self.interference, "friction": STUCK if self.bonded else self.friction,
            "pin_body": SeatedBush(radius), "plate_body": self.inside,
        }  # fmt: skip
        return {"pair": self.surface(pair), "plate_body": Ring(self.outer_radius, "uniform")}, seat

    def unknown_when_warm(self, pair: MaterialPair) -> str:
        return self.inside.unknown_when_warm(pair)

    def surface(self, pair: MaterialPair) -> MaterialPair:
        return MaterialPair(pair.pin, self.material, pair.plane)

    def without_units(self, pair: MaterialPair) -> tuple[PlateBody, MaterialPair]:
        self.check_material(pair)
        factor = self.surface(pair).beta_star
        return replace(self, material=self.material.scaled(factor)), pair.scaled(pair.beta_star / factor)

    # -- the response of the rim

    def around(self, rim: Rim) -> tuple[Rim, Rim]:
        """The bore of the bush, and the plate's own hole round it, which is the seat."""
        return rim._replace(material=self.material), rim._replace(ratio=self.outer_radius / rim.hole)

    def layer(self, rim: Rim, order: np.ndarray) -> Layer:
        """The bush, for the harmonics `order` >= 2."""
        bore, seat = self.around(rim)
        return Layer(order, seat.ratio, bore.kolosov, bore.compliance)

    def highest(self, rim: Rim) -> int:
        seat = self.around(rim)[1]
        return max(harmonics.harmonics_needed(1.0 / seat.ratio), self.inside.highest(seat))

    def pressed(self, rim: Rim) -> float:
        bore, seat = self.around(rim)
        return harmonics.uniform_of_layer(seat.ratio, bore.kolosov, bore.compliance, self.inside.pressed(seat))

    def press_fit(self, rim: Rim) -> tuple[float, float]:
        if self.interference <= 0.0:
            return 0.0, 0.0
        (bore, seat), inner = self.around(rim), rim.hole / self.outer_radius
        pressure, moved = harmonics.press_fit(inner, bore.kolosov, bore.compliance, -self.inside.pressed(seat))
        relative = self.interference / self.outer_radius
        return pressure * relative, moved * relative * rim.hole

    def first(self, rim: Rim) -> First:
        bore, seat = self.around(rim)
        far = 0.5 * rim.compliance * self.inside.first(seat).displacement()
        return harmonics.first_of_layer(seat.ratio, bore.kolosov, bore.compliance, far)

    def twist(self, rim: Rim) -> float:
        bore, seat = self.around(rim)
        part = seat.ratio**-2.0
        return -0.5 * bore.compliance * (1.0 - part) + part * self.inside.twist(seat)

    def change(self, rim: Rim, order: np.ndarray) -> np.ndarray:
        layer = self.layer(rim, order)
        moved = 2.0 * layer.contact_displacement(layer.amplitudes(self.inside.whole(self.around(rim)[1], order)))
        return np.array([moved[:, 0, 0], 0.5 * (moved[:, 0, 1] + moved[:, 1, 0]), moved[:, 1, 1]])

    def displacements(self, rim: Rim) -> Displacements:
        bore, seat = self.around(rim)
        kolosov, outer, unit, found = bore.kolosov, seat.ratio, bore.compliance, {}
        for place, column in self.inside.displacements(seat).items():  # of the lug's own free hole, n = -K to K
            highest = column.size // 2
            uniform = self._passed_inwards(rim, column[highest].real)
            first = rim.compliance / unit * self.inside.first(seat).displacement()[0]
            moved_first = (kolosov + 1.0) * column[highest + 1] / harmonics.first_stiffness(outer, kolosov, first)
            order = np.arange(2.0, highest + 1.0)
            layer = self.layer(rim, order)
            growing = layer.moved_outside(self.inside.whole(seat, order), pairs_of(column))
            rotation = 1j * column[highest].imag
            found[place] = spectrum(order, layer.contact_displacement(growing), uniform + rotation, moved_first)
        return found

    def _passed_inwards(self, rim: Rim, moved: float) -> float:
        """Radial displacement of the bore over its radius, if a load moves the lug's own free hole by `moved`."""
        bore, seat = self.around(rim)
        q, inner = seat.ratio**-2.0, 2.0 * self.inside.pressed(seat) / bore.compliance
        return 0.5 * (bore.kolosov + 1.0) * moved / (0.5 * (bore.kolosov - 1.0) + q - inner * (1.0 - q))

    def expanded(self, rim: Rim) -> np.ndarray:
        return np.array([(self.material.expansion or 0.0) + self._passed_inwards(rim, self._misfit(rim)) + 0j])

    def _misfit(self, rim: Rim) -> float:
        """How much more the lug's own free hole grows over its radius than the free bush, per rise of temperature."""
        around = self.inside.expanded(self.around(rim)[1])
        return float(around[around.size // 2].real) - (self.material.expansion or 0.0)

    def translation(self, rim: Rim, gauge: float | None) -> tuple[float, float]:
        own, seat = self.around(rim)
        outer = seat.ratio
        if gauge is None:
            gauge = self.inside.far(seat) * outer if isinstance(self.inside, Ring) else 1.0
        if gauge == 1.0:
            return 0.0, 0.0
        first = self.first(rim)
        moved = first.translation(min(gauge, outer)) * own.compliance
        if gauge > outer:
            tractions = np.array([first.traction(outer), [0.0, 1.0 / outer]])  # t_1 and conj t_-1 on the lug's hole
            beyond = self.inside.first(seat).translation(gauge / outer)
            moved = moved + beyond @ tractions * outer * rim.compliance
        return -float(moved[1]), float(moved[0])

    # -- stresses

    def assembly_stresses(self, rim: Rim, contact: float, edge: str = "hole") -> dict[str, float]:
        seat, field = self.around(rim)[1], self._assembled(rim, contact)
        edges = {"bore of the bush": 1.0, "rim of the bush": seat.ratio}
        found = {name: field.von_mises(radius, self.material.nu, rim.plane) for name, radius in edges.items()}
        return found | self.inside.assembly_stresses(seat, self.seat_pressure(rim, contact), "seat")

    def seat_pressure(self, rim: Rim, contact: float) -> float:
        return -self._assembled(rim, contact).radial(self.around(rim)[1].ratio)

    def _assembled(self, rim: Rim, contact: float) -> Uniform:
        """The stresses of the bush in its seat under the pressure `contact` at its bore, Pa."""
        own, seat = self.around(rim)
        unit = 0.5 * own.compliance
        whole = harmonics.uniform_of_layer(seat.ratio, own.kolosov, 2.0 * unit, self.inside.pressed(seat)) / unit
        mean, decaying = Uniform.of_rim(-contact, whole, own.kolosov)
        wall = (1.0 - 1.0 / seat.ratio) * (1.0 + 1.0 / seat.ratio)
        pressed = -self.press_fit(rim)[0] / wall  # of a ring under a pressure on its outer rim
        return Uniform(mean + pressed, decaying - pressed)

    def highest_inside(self, rim: Rim) -> int:
        seat = self.around(rim)[1]
        return max(harmonics.harmonics_needed(math.sqrt(1.0 / seat.ratio)), self.inside.highest_inside(seat))

    def walls(self, rim: Rim, tractions: Harmonics, remote: Remote) -> PlateWalls:
        """The field of the bush beyond a hole in the infinite plate, and the whole field of the lug round it.

        `passed` are the harmonics that the bush passes on to the lug.
        """
        (bore, seat), t = self.around(rim), tractions(self.highest_inside(rim))
        kolosov, outer, unit, highest = bore.kolosov, seat.ratio, bore.compliance, len(t) - 1
        order = np.arange(2.0, highest + 1.0)
        moved, q, found, passed = self._moved_hole(seat, t, remote), outer**-2.0, Amplitudes.zero(highest), t.copy()
        if remote[-1]:
            moved[highest] += remote[-1] * self._misfit(rim)
        amplitudes, misfit, growing_traction, decaying_traction = _matrices(self, rim, highest)
        growing = (amplitudes @ t[2:, :, None])[..., 0]
        growing = growing + np.linalg.solve(misfit, pairs_of(moved)[..., None])[..., 0]
        found.A[2:], found.C[2:] = growing.T
        A, C = growing.T * np.array([outer**-order, outer ** (2.0 - order)])
        found.B[2:], found.D[2:] = -(order + 1.0) * A - C, -order * order * A - (order - 1.0) * C
        passed[2:] = ((growing_traction @ growing[..., None]) + (decaying_traction @ t[2:, :, None]))[..., 0]
        lug, wall = self.inside.pressed(seat), (1.0 - 1.0 / outer) * (1.0 + 1.0 / outer)
        stiff = 0.5 * unit * (kolosov - 1.0 + 2.0 * q) - 2.0 * lug * wall
        uniform = (q * t[0, 0].real * (lug + 0.5 * unit) + moved[highest].real) / stiff
        uniform -= 0.5 * self.press_fit(rim)[0] / wall
        found.A[0], found.D[0], passed[0] = uniform, -2.0 * uniform, q * t[0] + 2.0 * uniform * wall
        first = rim.compliance / unit * self.inside.first(seat).displacement()[0]
        grown = 2.0 / unit * moved[highest + 1] / harmonics.first_stiffness(outer, kolosov, first)
        own = self.first(rim)
        found.first[:] = first_change(own, harmonics.first(math.inf, kolosov, "uniform"), t[1])
        found.first[:2] += grown, -grown
        passed[1, 0] = own.traction(outer) @ t[1] + 2.0 * grown * (outer - outer**-3.0)
        passed[1, 1] = t[1, 1] / outer
        lug_wall = self.inside.wall(seat, passed, remote, whole=True)
        return PlateWalls(found.wall(kolosov, 1.0, outer), lug_wall)

    def _moved_hole(self, seat: Rim, t: np.ndarray, remote: Remote) -> np.ndarray:
        """Displacement of the lug's own free hole over its radius under the loads, n = -N to N.

        `t` are the harmonics on the contact rim, (N + 1, 2), which has the force.
        """
        highest, force = len(t) - 1, force_on(t)
        found = np.zeros(2 * highest + 1, dtype=complex)
        loads = {Q: force.real, P: -force.imag, **dict(zip(STRESSING, remote, strict=True))}
        for place, column in _displacements(self.inside, seat).items():
            middle = column.size // 2
            low = min(middle, highest)
            found[highest - low : highest + low + 1] += loads[place] * column[middle - low : middle + low + 1]
        return found

    # -- words, drawing, controls

    def rows(self, length: InWords, material: InWords) -> list[tuple[str, str]]:
        size = f"outer radius {length(self.outer_radius)}"
        return [("plate body", self.inside.words(length)), ("bush", f"{material(self.material)}, {size}{self._grip()}")]

    def caption(self, length: InWords, material: InWords) -> str:
        bush = f" with bush of {material(self.material)} to radius {length(self.outer_radius)}"
        return bush + self._grip(" that") + self.inside.caption(length, material)

    def _grip(self, that: str = ",") -> str:
        """Words on a bush that slips, for texts on the bush; none on a bonded one."""
        return "" if self.bonded else f"{that} slips, friction {self.friction:g} in the plate"

    def drawing(self, rim: Rim) -> list[Shape]:
        seat = self.around(rim)[1]
        return [*self.inside.drawing(seat), Shape("circle", seat.ratio, "bush")]

    @classmethod
    def usual(cls, radius: float, material: Material) -> Self:
        return cls(MATERIALS["steel"] if material.is_rigid else material, 1.25 * radius)

    def page_controls(self, radius: float, clearance: float, dimensionless: bool) -> list[Control]:
        most = max(2.0 * abs(self.interference), abs(clearance), 1e-3 * radius * (not dimensionless))
        found = super().page_controls(radius, clearance, dimensionless)
        least = 0.0 if self.bonded else -most
        found += [
            Control("interference", self.interference, "displacement", least, most),
            Control("bush", self.material),
        ]
        return found if self.bonded else [*found, Control("seat_friction", self.friction, "ratio", 0.0, MOST_DRY)]

    def changed(self, values: Mapping[str, Any]) -> Self:
        names = {"seat_friction": "friction"}  # on the page, where the friction is that of the pin
        return super().changed({names.get(name, name): value for name, value in values.items()})


@lru_cache(maxsize=16)
def _matrices(bush: Bushing, rim: Rim, highest: int) -> tuple[np.ndarray, ...]:
    """Matrices of a bush for the harmonics from 2 to `highest`, shape (m, 2, 2) each.

    They are the growing amplitudes per traction on the contact rim, the misfit, and the traction at the outer rim per
    growing amplitude and per traction on the contact rim; see :class:`fastpin.bodies.harmonics.Layer`.
    """
    order = np.arange(2.0, highest + 1.0)
    layer, far = bush.layer(rim, order), bush.inside.whole(bush.around(rim)[1], order)
    return layer.amplitudes(far), layer.misfit(far), layer.growing_traction, layer.decaying_traction


@lru_cache(maxsize=16)
def _displacements(lug: PlateBody, seat: Rim) -> Displacements:
    return lug.displacements(seat)
