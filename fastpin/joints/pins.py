"""The pins of a joint: clearance, friction and gap in each plate, clamp-up, bushes, and how a pin bends."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal, NamedTuple

from fastpin.bodies import Bushing
from fastpin.bodies.kinds import INFINITE_PLATE
from fastpin.errors import InputError
from fastpin.joints.bending import SHEAR, RoundBar
from fastpin.model import checks
from fastpin.model.materials import Material
from fastpin.model.problem import LEAST_RADIUS, MOST_RADIUS
from fastpin.model.profile import NO_GAP, InitialGap, ProfileLike
from fastpin.model.read_only import ReadOnlyDict

DRIVES = {"force": "", "ux": "x", "uy": "y", "both": "xy"}
"""The axes along which a displacement is given in place of a force, by the word."""

BEAM = "beam"
"""The flexibility of a pin that bends as a beam."""


@dataclass(frozen=True)
class Clamp:
    """The clamp-up of a pin: friction between its plates carries load beside the contact of the pin.

    Every pair of neighbouring plates of the pin has a faying surface round the hole. It carries at most friction times
    force, in any direction.

    Parameters
    ----------
    force : float
        Clamp force, N. It does not change with the load.
    friction : float
        Coefficient of friction of the faying surfaces.
    flexibility : float
        Displacement of one plate over the next per force of friction, m/N, before the surface slips.

    Raises
    ------
    InputError
        If a value is negative or no number. The error names the field.
    """

    force: float
    friction: float
    flexibility: float = 0.0

    def __post_init__(self) -> None:
        checks.check_fields(self, checks.not_negative, "force friction flexibility")

    @property
    def limit(self) -> float:
        """The largest force of friction at one faying surface, N."""
        return self.friction * self.force


@dataclass(frozen=True)
class JointPin:
    """A pin of a joint, through one plate or several.

    Parameters
    ----------
    name : str
    at : complex
        Its place x + iy, m.
    material : Material
    radius : float
        Radius of its holes, m: of the bore where it has a bush.
    plates : sequence of str
        Names of the plates that it goes through, in their order.
    clearance : float or mapping of str to float
        Radial clearance, m; one for each plate if they differ. Negative: an interference fit.
    friction : float or mapping of str to float
        Coefficient of friction, for each plate if they differ.
    flexibility : float or "beam"
        Displacement of the pin in one plate over that in the next, per force between them, m/N: shear and bending of
        the pin. 0 is a rigid pin. :func:`tate_rosenfeld` has a handbook formula. "beam": a Timoshenko beam through all
        slices of its plates, which lie on one another in their order.
    clamp : Clamp, optional
        The clamp-up of its plates.
    bush : Bushing or mapping of str to Bushing, optional
        A bush round the pin in each plate, or in the plates that are named; in a plate with slices one in each slice.
        The pin touches the bush, with its clearance and friction. The bush touches the plate, with its own interference
        and friction. Its outer radius is that of the hole in the plate. A bonded one needs a press fit that holds it.
        A sleeve that is shrunk on the pin is a bush, too: the clearance of the pin is negative then, and the
        interference is minus the clearance of the sleeve in the plate.
    gap : InitialGap, profile or mapping, optional
        Initial gap beside the clearance, m, as of :class:`fastpin.Problem`: of a hole or a pin that is not round, or
        worn. One for each plate if they differ; plates that a mapping leaves out are round. It is kept as a mapping. At
        a bush it is that of its bore. All slices of a plate have the same.
    bore_radius : float
        Radius of the bore of a hollow pin, m; 0 of a solid one. Its forces enter as body forces, as those of a solid
        pin, and the bore is free.
    drive : {"force", "ux", "uy", "both"}
        Displacements of the pin that are loads in place of forces on it: "name.ux" along x, "name.uy" along y, m. It is
        that of the pin in its first plate, (T29), from the middle of its undeformed hole. The force is a reaction then.
    heads : {"free", "held"} or float, optional
        Of a beam: its ends turn freely, as they do unless it is given; or do not turn, or by the angle of a moment:
        N m/rad. It is kept as a number, 0 or infinite.

    Raises
    ------
    InputError
        If a value can't be used. The error names the field.
    """

    name: str
    at: complex
    material: Material
    radius: float
    plates: tuple[str, ...]
    clearance: float | Mapping[str, float] = 0.0
    friction: float | Mapping[str, float] = 0.0
    flexibility: float | Literal["beam"] = 0.0
    clamp: Clamp | None = None
    heads: Any = None
    bush: Bushing | Mapping[str, Bushing] | None = None
    gap: InitialGap | ProfileLike | Mapping[str, InitialGap | ProfileLike] | None = None
    bore_radius: float = 0.0
    drive: str = "force"

    def __post_init__(self) -> None:
        checks.check_fields(self, part_name, "name")
        checks.check_fields(self, checks.point, "at")
        checks.instance("material", self.material, Material, "a Material")
        checks.check_fields(self, checks.number, "radius", LEAST_RADIUS, MOST_RADIUS)
        checks.check_fields(self, checks.not_negative, "bore_radius")
        names = checks.items("plates", self.plates, "a list of names")
        checks.set_fields(self, plates=tuple(checks.string("plates", name) for name in names))
        if not self.plates:
            raise InputError("plates", f"pin {self.name} goes through no plate")
        if len(set(self.plates)) < len(self.plates):
            raise InputError("plates", f"pin {self.name} goes through a plate twice")
        if isinstance(self.flexibility, str):
            checks.check_fields(self, checks.choice, "flexibility", (BEAM,))
        else:
            checks.check_fields(self, checks.not_negative, "flexibility")
        if self.heads is not None:
            checks.check_fields(self, _heads, "heads")
            if self.flexibility != BEAM:
                raise InputError("heads", f'needs a pin that bends, flexibility = "{BEAM}"')
        if self.clamp is not None:
            checks.instance("clamp", self.clamp, Clamp, "a Clamp")
            if len(self.plates) == 1:
                raise InputError("clamp", f"pin {self.name} goes through one plate: it clamps no two plates together")
        if isinstance(self.bush, Mapping):
            for plate, bush in self.bush.items():
                checks.known_name("bush", plate, self.plates)
                _check_bush(f"bush.{plate}", bush)
            checks.set_fields(self, bush=ReadOnlyDict(self.bush))
        elif self.bush is not None:
            _check_bush("bush", self.bush)
        checks.check_fields(self, checks.choice, "drive", tuple(DRIVES))
        self._check_gap()
        for name in ("clearance", "friction"):
            value = getattr(self, name)
            if isinstance(value, Mapping):
                for plate, each in value.items():
                    checks.known_name(name, plate, self.plates)
                    checks.number(f"{name}.{plate}", each)
                if missing := [plate for plate in self.plates if plate not in value]:
                    raise InputError(name, f"has no value for the plate {missing[0]}")
                checks.set_fields(self, **{name: ReadOnlyDict(value)})
            else:
                checks.check_fields(self, checks.number, name)

    def _check_gap(self) -> None:
        """Keep the initial gaps as a mapping of plates that have one."""
        given = self.gap
        if given is None:
            given = {}
        elif not isinstance(given, Mapping):
            given = dict.fromkeys(self.plates, given)
        for plate in given:
            checks.known_name("gap", plate, self.plates)
        found = {plate: InitialGap.of(each) for plate, each in given.items()}
        checks.set_fields(self, gap=ReadOnlyDict({plate: gap for plate, gap in found.items() if gap}))

    @property
    def reactions(self) -> dict[str, str]:
        """The names of the forces that are reactions, and of the displacements in their place."""
        return reactions_of(self.name, self.drive)

    def gap_in(self, plate: str) -> InitialGap:
        """The initial gap in a plate, or in a slice."""
        plate = whole_name(checks.string("plate", plate))
        checks.known_name("plate", plate, self.plates)
        return self.gap.get(plate, NO_GAP)  # type: ignore[union-attr,return-value]

    def value_in(self, name: str, plate: str) -> float:
        """The clearance or the friction in a plate, or in a slice."""
        plate = whole_name(checks.string("plate", plate))
        checks.known_name("plate", plate, self.plates)
        value = getattr(self, checks.choice("name", name, ("clearance", "friction")))
        return float(value[plate] if isinstance(value, Mapping) else value)

    def bush_in(self, plate: str) -> Bushing | None:
        """The bush in a plate, or in a slice; None without one."""
        plate = whole_name(checks.string("plate", plate))
        checks.known_name("plate", plate, self.plates)
        return self.bush.get(plate) if isinstance(self.bush, Mapping) else self.bush

    @property
    def bar(self) -> RoundBar:
        """The pin as a bar, with the radius of its holes."""
        return RoundBar(self.material, self.radius, self.bore_radius)

    def hole_radius(self, plate: str) -> float:
        """Radius of the hole in a plate, or in a slice, m: of the pin's own, or that of its bush."""
        bush = self.bush_in(plate)
        return self.radius if bush is None else bush.outer_radius


class Faying(NamedTuple):
    """Two plates that a pin clamps: the names of the pin and of both plates, in their order."""

    pin: str
    clamp: Clamp
    plate: str
    other: str

    def __str__(self) -> str:
        return f"{self.pin} {self.plate}-{self.other}"


def tate_rosenfeld(
    diameter: float, pin: Material, one: tuple[Material, float], other: tuple[Material, float], bore_radius: float = 0.0
) -> float:
    """The flexibility of a fastener by shear and bending, m/N, of Tate and Rosenfeld's formula.

    The bearing terms of the formula are left out: the contact has them. The formula is for a solid fastener. Here a
    hollow one has the area, the second moment and the coefficient of shear of its tube. Source: Tate, M. B. and
    Rosenfeld, S. J., "Preliminary investigation of the loads carried by individual bolts in bolted joints", NACA TN
    1051 (1946), as usually quoted.

    Parameters
    ----------
    diameter : float
        m.
    pin : Material
    one, other : (Material, float)
        Both plates: material, and thickness, m.
    bore_radius : float
        Radius of the bore of a hollow fastener, m.

    Raises
    ------
    InputError
        If a length is out of range, or an argument is of another class.
    """
    d = checks.number("diameter", diameter, LEAST_RADIUS, MOST_RADIUS)
    checks.instance("pin", pin, Material, "a Material")
    lengths = []
    for name, plate in (("one", one), ("other", other)):
        if not isinstance(plate, tuple) or len(plate) != 2 or not isinstance(plate[0], Material):
            raise InputError(name, f"must be a material and a thickness in m, not {checks.as_toml(plate)}")
        lengths.append(checks.number(name, plate[1], LEAST_RADIUS, MOST_RADIUS))
    a, b = lengths
    bar = RoundBar(pin, 0.5 * d, checks.number("bore_radius", bore_radius, 0.0, 0.5 * d))
    shear = 4.0 * SHEAR * (a + b) / (9.0 * bar.shear)
    bending = (a**3 + 5.0 * a * a * b + 5.0 * a * b * b + b**3) / (40.0 * bar.bending)
    return shear + bending


def whole_name(plate: str) -> str:
    """The name of a plate from its own, or from that of a slice."""
    return plate.partition(".")[0]


def _check_bush(field_: str, bush: object) -> None:
    """Check a bush, of which the joint has the plate round it."""
    found = checks.instance(field_, bush, Bushing, "a Bushing")
    if found.inside != INFINITE_PLATE:
        raise InputError(f"{field_}.inside", "the plate of the joint is round the bush: leave it out")


def _heads(field_: str, value: object) -> float:
    """Check the stiffness of heads: a word or N m/rad."""
    words = {"free": 0.0, "held": math.inf}
    if isinstance(value, str) and value in words:
        return words[value]
    if isinstance(value, float) and value == math.inf:
        return math.inf
    try:
        return checks.not_negative(field_, value)
    except InputError as error:
        raise InputError(field_, f'{error.reason}; or "free" or "held"') from None


def reactions_of(name: str, drive: str) -> dict[str, str]:
    """The names of forces on a part that are reactions, and of the displacements in their place, by its drive."""
    return {f"{name}.{axis}": f"{name}.u{axis}" for axis in DRIVES[drive]}


def part_name(field_: str, value: object) -> str:
    """Check a name: a text without a dot, which stands between a name and its load."""
    name = checks.string(field_, value)
    if "." in name:
        raise InputError(field_, f"must be a text without a dot, not {checks.as_toml(value)}")
    return name
