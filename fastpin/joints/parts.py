"""The plates of a joint, and the joint: its pins go through some of them."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property

from fastpin.bodies.body import PlateBody
from fastpin.bodies.kinds import INFINITE_PLATE, SOLID_PIN
from fastpin.bodies.pins import Tube
from fastpin.errors import InputError
from fastpin.joints.bending import Coherence, beam, springs
from fastpin.joints.hole import HoleInPlate
from fastpin.joints.pins import BEAM, DRIVES, Faying, JointPin, part_name, reactions_of, whole_name
from fastpin.lugs.outline import Hole, Lug, Part, PartLoad
from fastpin.model import checks, unit_systems
from fastpin.model.loads import LOADS, REMOTE
from fastpin.model.materials import PLANES, Material, MaterialPair, Plane
from fastpin.model.problem import LEAST_RADIUS, MOST_RADIUS, Problem
from fastpin.model.read_only import ReadOnlyDict

MOST_PINS, MOST_PLATES = 40, 20
"""Most pins and plates of a joint."""

MOVES = {"": (), "x": (1.0 + 0j,), "y": (1j,), "xy": (1.0 + 0j, 1j), "free": (1.0 + 0j, 1j, 0j)}
"""Directions in which a plate may move, by the word; 0 is a rotation."""

MOST_SLICES = 40
"""Most slices of a plate."""

LEAST_PITCH = 1.1
"""Least distance of the centres of two holes, in diameters. Nearer ones need more harmonics than are taken."""

REMOTE_NAMES = tuple(LOADS[place] for place in REMOTE)
"""Names of remote stresses and edge loads of a plate."""


@dataclass(frozen=True)
class JointPlate:
    """A plate of a joint.

    Parameters
    ----------
    name : str
    material : Material
    thickness : float
        m.
    outline : sequence of Part
        A closed curve, see :class:`fastpin.lugs.Lug`. An empty one is an infinite plate. All other plates of its
        joint must be free: under a net force an infinite plate moves without limit.
    supports : mapping of str to str
        What is held of a part of the outline, by its name, as in a lug.
    moves : {"", "x", "y", "xy", "free"}
        The supports of a plate may move along x or y, all together and without turning. Then the plate has the loads
        "name.x" and "name.y": the force on its supports, N. A plate that is free has no supports: it floats between its
        pins, of which it needs two.
    drive : {"force", "ux", "uy", "both"}
        Displacements of the supports that are loads in place of their forces: "name.ux" and "name.uy", m, along axes
        on which they move. The forces are reactions then.
    holes : sequence of Hole
        Holes without a pin.
    loads : sequence of PartLoad
        Tractions on parts of the outline, as in a lug. The load is called "name.sxx", "name.syy" or "name.sxy". An
        infinite plate has these three loads as remote stresses, Pa.
    slices : int
        Number of equal slices across the thickness, each with a contact of its own with every pin. They are called
        "name.1" and so on, in the order of the plates of a pin, and move together. In a plate with one pin every slice
        stretches by itself, as far as its supports. With several pins all slices stretch alike; only contacts differ.

    Raises
    ------
    InputError
        If a value can't be used. The error names the field.
    """

    name: str
    material: Material
    thickness: float
    outline: tuple[Part, ...] = ()
    supports: Mapping[str, str] = field(default_factory=dict)
    moves: str = ""
    holes: tuple[Hole, ...] = ()
    loads: tuple[PartLoad, ...] = ()
    slices: int = 1
    drive: str = "force"

    def __post_init__(self) -> None:
        checks.check_fields(self, part_name, "name")
        checks.instance("material", self.material, Material, "a Material")
        checks.check_fields(self, checks.number, "thickness", LEAST_RADIUS, MOST_RADIUS)
        checks.check_fields(self, checks.whole_number, "slices", 1, MOST_SLICES)
        checks.set_fields(self, outline=tuple(checks.instances("outline", self.outline, Part, "a list of parts")))
        checks.set_fields(self, holes=tuple(checks.instances("holes", self.holes, Hole, "a list of holes")))
        checks.set_fields(self, loads=tuple(checks.instances("loads", self.loads, PartLoad, "a list of loads")))
        if not isinstance(self.supports, Mapping):
            raise InputError("supports", f"must map names to words, not {checks.as_toml(self.supports)}")
        checks.set_fields(
            self, supports=ReadOnlyDict(self.supports), moves=checks.choice("moves", self.moves, tuple(MOVES))
        )
        if self.is_infinite:
            for key in ("supports", "moves", "holes", "loads"):
                if getattr(self, key):
                    raise InputError(key, "has no meaning for an infinite plate; give an outline")
        checks.check_fields(self, checks.choice, "drive", tuple(DRIVES))
        for axis in (axis for axis in DRIVES[self.drive] if self.floats or axis not in self.moves):
            raise InputError("drive", f"the supports of {self.name} do not move along {axis}: give moves")
        own = [*(part.name for part in self.outline), *(hole.name for hole in self.holes)]
        for name in self.supports:
            checks.known_name("supports", name, own)
        for name in (name for load in self.loads for name in load.parts):
            checks.known_name("loads", name, own)

    def __hash__(self) -> int:
        return hash((self.name, self.material, self.thickness, self.outline, self.holes, self.loads))

    @property
    def is_infinite(self) -> bool:
        """Whether the plate has no outline."""
        return not self.outline

    @cached_property
    def across(self) -> tuple[JointPlate, ...]:
        """Its slices as plates, in their order; the plate itself if it has one."""
        if self.slices == 1:
            return (self,)
        found = [replace(self, thickness=self.thickness / self.slices, slices=1) for _ in range(self.slices)]
        for number, one in enumerate(found, start=1):
            checks.set_fields(one, name=f"{self.name}.{number}")  # no plate that is given has a dot
        return tuple(found)

    @property
    def load_names(self) -> tuple[str, ...]:
        """Names of the loads that act on the plate."""
        edges = REMOTE_NAMES if self.is_infinite else tuple(sorted({load.name for load in self.loads}))
        pulled = "" if self.floats else self.moves
        driven = [f"u{axis}" for axis in DRIVES[self.drive]]
        return tuple(f"{self.name}.{name}" for name in (*pulled, *driven, *edges))

    @property
    def reactions(self) -> dict[str, str]:
        """The names of the forces that are reactions, and of the displacements in their place."""
        return reactions_of(self.name, self.drive)

    @property
    def floats(self) -> bool:
        """Whether only its pins hold the plate."""
        return self.moves == "free"

    def lug(self, pins: Mapping[str, complex], radius: float, plane: Plane) -> tuple[Lug, tuple[str, ...]]:
        """The plate as a lug round its first pinned hole, and the names of its further pinned holes.

        `pins` maps names of pins to the centres of their holes, m, and `radius` is that of the holes.
        """
        if not isinstance(pins, Mapping) or not pins:
            raise InputError("pins", f"must map names to points, not {checks.as_toml(pins)}")
        centres = {name: checks.point("pins", centre) for name, centre in pins.items()}
        own, *others = centres
        first = centres[own]
        shifted = tuple(
            Part(
                part.name, part.start - first, part.end - first, None if part.through is None else part.through - first
            )
            for part in self.outline
        )
        free = tuple(Hole(hole.name, hole.centre - first, hole.radius) for hole in self.holes)
        taken = {part.name for part in shifted} | {hole.name for hole in free}
        names = []
        for other in others:
            name = f"hole of {other}"
            while name in taken:
                name += "'"
            names.append(name)
        pinned = tuple(Hole(name, centres[other] - first, radius) for name, other in zip(names, others, strict=True))
        material = self.material
        try:
            holes = (*free, *pinned)
            made = Lug(material.nu, plane, radius, shifted, self.supports, self.loads, holes, self.floats)
        except InputError as error:
            raise InputError(f"plate.{self.name}", f"{error}; points count from its first pin") from None
        return made, tuple(names)


@dataclass(frozen=True)
class Joint:
    """Pins in plates.

    Parameters
    ----------
    plates : sequence of JointPlate
    pins : sequence of JointPin
    plane : {"stress", "strain"}
    unit_system : str
        Units of printed texts and figures, see :class:`fastpin.Problem`. Forces are those of whole plates.

    Raises
    ------
    InputError
        If a name stands twice or is unknown, holes overlap, radii differ, or a plate has no pin. The field names the
        part: "pin.A.at", "plate.skin".
    """

    plates: tuple[JointPlate, ...]
    pins: tuple[JointPin, ...]
    plane: Plane = "stress"
    unit_system: str = unit_systems.SI

    def __post_init__(self) -> None:
        checks.check_fields(self, unit_systems.checked_system, "unit_system")
        checks.set_fields(self, plates=tuple(checks.instances("plates", self.plates, JointPlate, "a list of plates")))
        checks.set_fields(self, pins=tuple(checks.instances("pins", self.pins, JointPin, "a list of pins")))
        checks.check_fields(self, checks.choice, "plane", PLANES)
        for kind, most, count in (("plates", MOST_PLATES, len(self.plates)), ("pins", MOST_PINS, len(self.pins))):
            if not 1 <= count <= most:
                raise InputError(kind, f"must be 1 to {most}, not {count}")
        names = [*(plate.name for plate in self.plates), *(pin.name for pin in self.pins)]
        if twice := [name for name in names if names.count(name) > 1]:
            raise InputError("name", f"two parts are called {checks.as_toml(twice[0])}")
        for pin in self.pins:
            for name in pin.plates:
                checks.known_name(f"pin.{pin.name}.plates", name, names[: len(self.plates)])
        for plate in self.plates:
            self._check_holes(plate)
            others = [other for other in self.plates if plate.is_infinite and other is not plate and not other.floats]
            if others:
                words = f"the plate {plate.name} is infinite, so {others[0].name} must be free"
                raise InputError(
                    f"plate.{others[0].name}.moves", f"{words}: under a net force an infinite plate moves without limit"
                )
        infinite = next((plate for plate in self.plates if plate.is_infinite), None)
        if infinite is not None and len(self.pins) > 1 and (driven := [pin for pin in self.pins if pin.reactions]):
            words = f"the infinite plate {infinite.name} has several pins, so {driven[0].name} can't be driven"
            raise InputError(f"pin.{driven[0].name}.drive", f"{words}: give the plate an outline")
        for pin, plate in self.sections:
            self.problem(pin, plate)
        for pin in self.pins:
            self._check_slices(pin)

    def _check_slices(self, pin: JointPin) -> None:
        """Check that a pin can go through the slices of its plates."""
        sliced = next((plate.name for plate in self.plates if plate.name in pin.plates and plate.slices > 1), None)
        if sliced is not None and pin.clamp is not None:
            raise InputError(f"pin.{pin.name}.clamp", f"pin {pin.name} can't clamp {sliced}, which has slices")
        least = 2 if pin.heads else 3
        if pin.flexibility == BEAM and sum(one is pin for one, _ in self.sections) < least:
            words = f"pin {pin.name} is a beam and needs {least} slices in all its plates"
            raise InputError(f"pin.{pin.name}.flexibility", f"{words}, or heads" if least == 3 else words)

    def _check_holes(self, plate: JointPlate) -> None:
        """Check that the pinned holes of a plate keep apart and lie inside it."""
        through = self.pins_of(plate)
        if not through:
            raise InputError(f"plate.{plate.name}", f"no pin goes through the plate {plate.name}")
        if plate.floats and len(through) < 2:
            words = f"the plate {plate.name} is free and has one pin: nothing keeps it from turning"
            raise InputError(f"plate.{plate.name}.moves", words)
        for pin in through:
            radii = pin.hole_radius(plate.name), self.radius_in(plate)
            if not math.isclose(*radii, rel_tol=1e-9):
                words = f"all holes of {plate.name} must have one radius: that of {pin.name} has {radii[0]:g} m"
                raise InputError(f"pin.{pin.name}.radius", f"{words}, that of {through[0].name} has {radii[1]:g} m")
        least = 2.0 * LEAST_PITCH * self.radius_in(plate)
        for one, other in itertools.combinations(through, 2):
            apart = abs(one.at - other.at)
            if checks.is_above(least, apart):
                words = f"the holes of {one.name} and {other.name} in {plate.name} are {apart:.4g} m apart"
                raise InputError(f"pin.{other.name}.at", f"{words}; they need {LEAST_PITCH:g} diameters, {least:.4g} m")
        if not plate.is_infinite:
            plate.lug({pin.name: pin.at for pin in through}, self.radius_in(plate), self.plane)

    @property
    def radius(self) -> float:
        """Radius of the first pin, m: the unit of length of the solution."""
        return self.pins[0].radius

    def radius_in(self, plate: JointPlate) -> float:
        """Radius of all pinned holes of a plate, m."""
        return self.pins_of(plate)[0].hole_radius(plate.name)

    @cached_property
    def sections(self) -> tuple[tuple[JointPin, JointPlate], ...]:
        """Every pin in each slice of each of its plates: the interfaces, pin by pin."""
        by_name = {plate.name: plate.across for plate in self.plates}
        return tuple((pin, one) for pin in self.pins for name in pin.plates for one in by_name[name])

    @cached_property
    def faying(self) -> tuple[Faying, ...]:
        """The faying surfaces that carry friction, pin by pin."""
        clamps = ((pin, pin.clamp) for pin in self.pins if pin.clamp is not None and pin.clamp.limit)
        return tuple(Faying(pin.name, clamp, *pair) for pin, clamp in clamps for pair in itertools.pairwise(pin.plates))

    def place(self, pin: str, plate: str) -> int:
        """The place of a pin in a plate, or a slice, among the sections. Unknown names raise :class:`InputError`."""
        found = self.places(pin, plate)
        if len(found) > 1:
            first, last = (self.sections[at][1].name for at in (found[0], found[-1]))
            raise InputError("plate", f"{plate} has slices: name one of {first} to {last}")
        return found[0]

    def places(self, pin: str, plate: str) -> list[int]:
        """The places of a pin in a slice, or in all slices of a plate, among the sections.

        Unknown names raise :class:`InputError`.
        """
        checks.known_name("pin", pin, [each.name for each in self.pins])
        checks.known_name("plate", whole_name(checks.string("plate", plate)), [each.name for each in self.plates])
        own = [(at, other.name) for at, (one, other) in enumerate(self.sections) if one.name == pin]
        if not (own := [(at, name) for at, name in own if whole_name(name) == whole_name(plate)]):
            raise InputError("plate", f"pin {pin} does not go through {whole_name(plate)}")
        if found := [at for at, name in own if plate in (name, whole_name(name))]:
            return found
        names = f"{own[0][1]} to {own[-1][1]}" if len(own) > 1 else "none"
        raise InputError("plate", f"the slices of {whole_name(plate)} are {names}, not {checks.as_toml(plate)}")

    def pins_of(self, plate: JointPlate) -> list[JointPin]:
        """The pins that go through a plate."""
        return [pin for pin in self.pins if whole_name(plate.name) in pin.plates]

    def coherence(self, pin: JointPin) -> Coherence:
        """What ties the sections of a pin to one another, SI."""
        of = [next(plate for plate in self.plates if plate.name == name) for name in pin.plates]
        if isinstance(pin.flexibility, str):
            return beam(pin.bar, self.edges(pin), of[0].slices, pin.heads or 0.0)
        soft = [0.0 if number else pin.flexibility for plate in of for number in range(plate.slices)]
        return springs(soft[1:])

    def edges(self, pin: JointPin) -> list[float]:
        """The faces of all slices along a pin, from its end in its first plate, m."""
        own = (plate.thickness for one, plate in self.sections if one is pin)
        return list(itertools.accumulate(own, initial=0.0))

    def lug(self, pin: str, plate: str) -> tuple[Lug, tuple[str, ...]]:
        """A plate as a lug round the hole of a pin, and the names of its further pinned holes.

        Raises
        ------
        InputError
            If a name is unknown, or the plate is infinite.
        """
        if whole_name(checks.string("plate", plate)) != plate:
            raise InputError("plate", f"{plate} is a slice: its stress is known near its holes only")
        own, _ = self.sections[self.places(pin, plate)[0]]
        of = next(each for each in self.plates if each.name == plate)
        if of.is_infinite:
            raise InputError("plate", f"{plate} is infinite: give it an outline, and its stress is known everywhere")
        others = {other.name: other.at for other in self.pins_of(of) if other is not own}
        return of.lug({own.name: own.at} | others, self.radius_in(of), self.plane)

    @cached_property
    def load_names(self) -> tuple[str, ...]:
        """Names of all loads and reactions: forces on pins and on plates that move, N, displacements in place of some
        of them, m, and stresses of plates, Pa.
        """
        of_pins = tuple(
            f"{pin.name}.{name}"
            for pin in self.pins
            for name in ("x", "y", *(f"u{axis}" for axis in DRIVES[pin.drive]))
        )
        return sum((plate.load_names for plate in self.plates), ()) + of_pins

    @cached_property
    def reactions(self) -> dict[str, str]:
        """The names of the forces that are reactions, and of the displacements in their place."""
        of = (*(plate.reactions for plate in self.plates), *(pin.reactions for pin in self.pins))
        return {name: given for each in of for name, given in each.items()}

    @cached_property
    def given_names(self) -> tuple[str, ...]:
        """Names of the loads that a history gives: all but the reactions."""
        return tuple(name for name in self.load_names if name not in self.reactions)

    def has_outline(self, plate: str) -> bool:
        """Whether a plate has an outline and no slices, so that its stress is known everywhere."""
        known = [each.name for each in self.plates if not each.is_infinite and each.slices == 1]
        return plate in known

    def load_kind(self, load: str) -> str:
        """The kind of a load: "traction", Pa, "displacement", m, or "force", N. An unknown load raises InputError."""
        checks.known_name("load", load, self.load_names)
        return kind_of_load(load)

    def problem(self, pin: JointPin, plate: JointPlate) -> Problem:
        """The contact of a pin in one plate, with its bush there, as if that plate were infinite."""
        checks.instance("pin", pin, JointPin, "a JointPin")
        checks.instance("plate", plate, JointPlate, "a JointPlate")
        pair, bush = MaterialPair(pin.material, plate.material, self.plane), pin.bush_in(plate.name)
        body: PlateBody = INFINITE_PLATE
        try:
            if bush is not None:
                body = replace(bush, inside=HoleInPlate.alone(plate.material.nu, self.plane, bush.outer_radius))
                body.check(pin.radius)
                body.check_pair(pair, pin.radius, False)
        except InputError as error:
            raise InputError(f"pin.{pin.name}.bush.{error.field}", f"in {plate.name}: {error.reason}") from None
        hollow = Tube(pin.bore_radius, "body") if pin.bore_radius else None
        try:
            return Problem(
                pair, pin.radius, pin.value_in("clearance", plate.name), pin.value_in("friction", plate.name),
                plate_body=body, thickness=plate.thickness, unit_system=self.unit_system,
                gap=pin.gap_in(plate.name),
                pin_load="centre" if hollow else "body", pin_body=hollow or SOLID_PIN,
            )  # fmt: skip
        except InputError as error:
            raise InputError(f"pin.{pin.name}.{error.field}", f"in {plate.name}: {error.reason}") from None


def kind_of_load(name: str) -> str:
    """The kind of a load of a joint by its name, see :meth:`Joint.load_kind`."""
    what = name.rpartition(".")[2]
    return "traction" if what in REMOTE_NAMES else "displacement" if what in ("ux", "uy") else "force"
