"""The problem: materials, geometry, friction, how the pin is loaded and whether it may rotate."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, Literal

import numpy as np

from fastpin.bodies.body import BodyBase, PinBody, PinLoad, PlateBody
from fastpin.bodies.joint import BodyPair, without_units
from fastpin.bodies.kinds import INFINITE_PLATE, SOLID_PIN
from fastpin.errors import InputError
from fastpin.model.checks import (
    MOST_FRICTION,
    MOST_PARAMETER,
    as_toml,
    check_fields,
    choice,
    instance,
    is_above,
    is_between,
    not_negative,
    number,
    number_array,
    positive,
    set_fields,
    true_or_false,
    whole_number,
)
from fastpin.model.fields import FIELDS
from fastpin.model.materials import MOST_EXPANSION, MaterialPair
from fastpin.model.profile import NO_GAP, InitialGap, Profile, ProfileLike, is_pair, widest_place
from fastpin.model.profile_terms import Term
from fastpin.model.synonyms import explains_attributes, explains_keywords
from fastpin.model.unit_systems import NO_UNITS, SI, checked_system

Rotation = Literal["free", "fixed", "spring"]
"""Kinds of pin rotation."""

LEAST_RADIUS, MOST_RADIUS = 1e-30, 1e30
"""Limits of the hole radius, m. Squares of dimensional results are then still numbers, in any units."""

MOST_GAP = 0.1
"""Largest initial gap, in parts of R. A larger one is no small change of a circle."""

LOOKED_AT = 1441
"""Points round the hole at which profiles are checked."""

LEAST_HUB = 1e-5
"""Least hub radius, in parts of R. The pin turns by 1/r^2 per moment: a smaller hub holds it by rounding only."""

MOST_GAUGE = 1e30
"""Largest gauge radius, in parts of R. The displacement grows like its logarithm: a larger circle is no plate."""

NO_THICKNESS = "has no meaning in a dimensionless problem, whose loads are in units of F"
"""Why a dimensionless problem refuses a thickness."""

DriveKind = Literal["force", "ux", "uy", "both"]
"""Ways to drive the pin: by the forces P and Q, or by displacements in place of Q (ux), of P (uy) or of both."""


@explains_keywords
@explains_attributes()
@dataclass(frozen=True, repr=False)
class Problem:
    """An elastic pin in the hole of an elastic plate, with Coulomb friction.

    The pin is solid and the plate infinite, unless ``pin_body`` and ``plate_body`` say otherwise.

    Parameters
    ----------
    pair : MaterialPair
        Materials of pin and plate. The material of a bush stands in the :class:`fastpin.bodies.Bushing`.
    hole_radius : float
        R, m, from :data:`LEAST_RADIUS` to :data:`MOST_RADIUS`.
    clearance : float
        Radial clearance R - R_D, m. Zero is a neat fit, negative an interference fit.
    friction : float or Profile
        Coefficient of friction, 0 to :data:`MOST_FRICTION`. A :class:`fastpin.model.Profile` gives its value along the
        rim of the hole. A function of angles, rad, or a pair of angles and values stands for its profile.
    pin_load : {"centre", "body"}
        The load of a solid pin acts at its centre, or as a uniform body force (section 4 of the paper). The load of a
        hollow pin is a field of its :class:`fastpin.bodies.Tube`.
    rotation : {"free", "fixed", "spring"}
        A free pin carries the moment M (0 unless given). A fixed pin has a prescribed rotation (0 unless given). A
        spring holds the pin at its hub; the load ``rotation`` then turns the far end of the spring. A body-loaded pin
        must be free: its potentials have a moment singularity otherwise (section 4).
    hub_radius : float, optional
        Radius, m, of the hub: the circle in the pin whose mean rotation is held, by a fixed hub or a spring, and whose
        mean displacement is prescribed. Only with one of these. Rotation and displacement of a pin under loads at its
        centre depend on where they are measured. The default is the paper's datum of the rotation,
        R / sqrt(kappa_I + 1); of a hollow pin it is the bore. For the whole rim give
        ``hub_radius=hole_radius``. The least is :data:`LEAST_HUB` R. The displacement of a body-loaded pin is its mean
        over the pin, and takes no hub.
    dimensionless : bool
        Set by :meth:`from_load_parameter`. It lifts the check that the clearance is smaller than the hole.
    hub_stiffness : float, optional
        Stiffness of the spring, N (moment per unit thickness per rad), 1e-30 to 1e30 R^2/beta*; only with
        ``rotation="spring"``, and needed there. In a dimensionless problem its unit is R^2/beta*.
    drive : {"force", "ux", "uy", "both"}
        "force": the loads P and Q push the pin. "ux": the load ``ux`` prescribes the displacement of the hub along x.
        Q is then the reaction, and P is a force. "uy": ``uy`` prescribes the displacement along y, P is the reaction,
        and Q is a force. "both": ``ux`` and ``uy`` prescribe both. The displacement is relative to the mean
        displacement of the gauge circle, and counts from the concentric position.
    gauge_radius : float, optional
        Radius, m, of the gauge circle round the hole, in the plate, from the hole radius R, which is the default, to
        :data:`MOST_GAUGE` R. Only with a prescribed displacement. Far away the plate's displacement under a force grows
        like the logarithm of the distance. So a displacement relative to the plate needs a radius. The default of a
        ring, also round a bush, is its outer rim.
    rig_stiffness : float, optional
        Stiffness, N/m^2 (force per unit thickness), of a spring between the hub and each prescribed displacement ``ux``
        and ``uy``: the rig, rigid unless given. A dimensionless problem has it in 1/beta*. See also ``hub_stiffness``.
    pin_body : PinBody
        A solid or a hollow pin; a class of :mod:`fastpin.bodies`.
    plate_body : PlateBody
        An infinite plate, a ring lug, a bush in either of them, or any finite plate; a class of :mod:`fastpin.bodies`.
    thickness : float, optional
        Thickness of pin and plate, m. It changes no state. Loads in case files are in N and N m then, and so are
        printed texts, with energies in J. Loads and results in Python and HDF5 stay per thickness, see
        :meth:`fastpin.LoadHistory.per_thickness`. Not for a dimensionless problem.
    unit_system : str
        Units of printed texts and figures, "SI" or such as "mm, N, MPa": the key ``units`` of a case file. It changes
        no state, and numbers in Python and HDF5 are in SI units. Not for a dimensionless problem.
    gap : InitialGap
        Initial gap beside the clearance, m: the profiles of hole and pin, each at most :data:`MOST_GAP` R, as a
        :class:`fastpin.model.InitialGap`. All else that stands for a profile is the profile of the hole.

    Raises
    ------
    InputError
        If a field is out of range, or the theory excludes a combination. The error names the field.
    """

    pair: MaterialPair
    hole_radius: float
    clearance: float
    friction: float | Profile
    pin_load: PinLoad = "centre"
    rotation: Rotation = "free"
    hub_radius: float | None = None
    dimensionless: bool = False
    hub_stiffness: float | None = field(default=None, kw_only=True)
    drive: DriveKind = field(default="force", kw_only=True)
    gauge_radius: float | None = field(default=None, kw_only=True)
    rig_stiffness: float | None = field(default=None, kw_only=True)
    pin_body: PinBody = field(default=SOLID_PIN, kw_only=True)
    plate_body: PlateBody = field(default=INFINITE_PLATE, kw_only=True)
    thickness: float | None = field(default=None, kw_only=True)
    unit_system: str = field(default=SI, kw_only=True)
    gap: InitialGap = field(default=NO_GAP, kw_only=True)

    def __post_init__(self) -> None:
        instance("pair", self.pair, MaterialPair, "a MaterialPair")
        true_or_false("dimensionless", self.dimensionless)
        radius = number("hole_radius", self.hole_radius)
        if radius <= 0.0:
            raise InputError("hole_radius", f"must be positive, not {radius:g}")
        number("hole_radius", radius, LEAST_RADIUS, MOST_RADIUS)
        clearance = number("clearance", self.clearance)
        if self.dimensionless:
            number("clearance", clearance, -MOST_PARAMETER, MOST_PARAMETER)
        elif abs(clearance) >= radius:
            limits = f"must lie between minus and plus the hole radius {radius:g}"
            raise InputError("clearance", f"{limits}, not {clearance:g}")
        friction = self._checked_friction(radius)
        set_fields(self, hole_radius=radius)
        self.joint.check(self.dimensionless)
        if clearance + self.joint.press_fit[1] < 0.0 and self.is_incompressible:
            incompressible = "a pin with nu = 0.5 in a rigid plate keeps its area"
            if self.has_bodies:
                incompressible = "a pin with nu = 0.5 in a body that can't widen keeps its area"
            raise InputError(
                "clearance",
                f"{incompressible} in plane strain: it fits into no smaller hole; "
                f"must not be negative, not {clearance + self.joint.press_fit[1]:g}",
            )
        for name, each in FIELDS.items():
            if each.choices:
                check_fields(self, choice, name, each.choices)
        if self.pin_load == "body" and self.held:
            raise InputError(
                "rotation",
                'a pin with pin_load = "body" must rotate freely, rotation = "free": uniform body forces can\'t bear '
                'the moment that holds it; choose pin_load = "centre"',
            )
        self._check_hub(radius)
        self._check_drive(radius)
        if self.thickness is not None:
            check_fields(self, checked_thickness, "thickness")
            if self.dimensionless:
                raise InputError("thickness", NO_THICKNESS)
        if self.unit_system != SI:
            check_fields(self, checked_system, "unit_system")
            if self.dimensionless:
                raise InputError("unit_system", NO_UNITS)
        set_fields(self, clearance=clearance, friction=friction, dimensionless=bool(self.dimensionless))
        set_fields(self, gap=checked_gap(self.gap, radius, self.dimensionless))
        pin, *seats = self.interfaces  # each contact of the joint is checked as a problem of its own
        if pin.is_gripped and any(not seat.is_gripped for seat in seats) and not self.plate_body.lug.in_joint:
            words = "must be positive where the pin has an interference fit: only a pressed bush carries such a pin"
            raise InputError("interference", f"{words}; a joint of one pin may have a loose one")

    def _checked_friction(self, radius: float) -> float | Profile:
        """The coefficient of friction: a number, or a profile if it varies. `radius` is the radius of the hole."""
        given = self.friction
        if not (isinstance(given, (Profile, Term)) or callable(given) or is_pair(given)):
            friction = not_negative("friction", given)
            return number("friction", friction, 0.0, MOST_FRICTION)
        profile = Profile.of("friction", given)
        if profile.needs_lengths:
            raise InputError("friction", "must not have a flat, which is a shape of a pin")
        values = profile.at(profile.angles(LOOKED_AT, radius), radius)
        not_negative("friction", float(values.min()))
        number("friction", float(values.max()), 0.0, MOST_FRICTION)
        return float(values[0]) if profile.is_constant else profile

    def _check_hub(self, radius: float) -> None:
        """Check the radius and the stiffness of the hub. `radius` is the radius of the hole."""
        if self.hub_radius is not None:
            hub = number("hub_radius", self.hub_radius)
            if not self.held and self.drive == "force":
                raise InputError("hub_radius", 'only a pin with rotation = "fixed" or "spring" is held at a hub')
            if self.pin_load == "body":
                raise InputError("hub_radius", "the displacement of a body-loaded pin is its mean: leave the hub out")
            if not is_between(LEAST_HUB * radius, hub, radius):
                limits = f"{LEAST_HUB * radius:g} and the hole radius {radius:g}"
                raise InputError("hub_radius", f"must lie between {limits}, not {hub:g}")
            self.pin_body.check_hub(hub)
            set_fields(self, hub_radius=min(hub, radius))
        if self.hub_stiffness is not None:
            stiffness = number("hub_stiffness", self.hub_stiffness)
            if self.rotation != "spring":
                raise InputError("hub_stiffness", 'only a pin with rotation = "spring" is held by a spring')
            if stiffness <= 0.0:
                raise InputError("hub_stiffness", f"must be positive, not {stiffness:g}")
            natural = self.natural_loads()["moment"]
            number("hub_stiffness", stiffness, 1e-30 * natural, 1e30 * natural)  # there the pin is free or fixed
            set_fields(self, hub_stiffness=stiffness)
        elif self.rotation == "spring":
            raise InputError("hub_stiffness", 'a pin with rotation = "spring" needs the stiffness of the spring')

    def _check_drive(self, radius: float) -> None:
        """Check the drive and the radius of the gauge circle. `radius` is the radius of the hole."""
        if self.drive != "force" and self.plate_body.contacts(self.pair, radius):
            words = 'must be "force" in a bush that slips, or in a lug of any outline; a joint of one pin can be driven'
            raise InputError("drive", words)
        if self.gauge_radius is not None:
            gauge = number("gauge_radius", self.gauge_radius)
            if self.drive == "force":
                raise InputError("gauge_radius", 'only a displacement has a gauge: drive = "ux" or "uy" or "both"')
            if is_above(radius, gauge):
                raise InputError("gauge_radius", f"must be at least the hole radius {radius:g}, not {gauge:g}")
            gauge = number("gauge_radius", max(gauge, radius), radius, MOST_GAUGE * radius)
            if why := self.plate_body.lug.without_gauge(gauge):
                raise InputError("gauge_radius", why)
            if not self.pair.plate.is_isotropic:
                if is_above(gauge, radius):
                    raise InputError("gauge_radius", f"must be the hole radius {radius:g} in a laminate, not {gauge:g}")
                gauge = radius
            set_fields(self, gauge_radius=gauge)
        if self.rig_stiffness is not None:
            if self.drive == "force":
                raise InputError("rig_stiffness", 'only a displacement has a rig: drive = "ux" or "uy" or "both"')
            natural, stiffness = 1.0 / self.surfaces.beta_star, positive("rig_stiffness", self.rig_stiffness)
            set_fields(self, rig_stiffness=number("rig_stiffness", stiffness, 1e-30 * natural, 1e30 * natural))

    def __repr__(self) -> str:
        size = f"load parameter {self.clearance:.6g} (R = F = beta* = 1)"
        if not self.dimensionless:
            size = f"hole radius {self.hole_radius:.6g} m, clearance {self.clearance:.6g} m"
        hub = "" if self.hub_stiffness is None else f" of stiffness {self.hub_stiffness:.6g}"
        hub += "" if self.hub_radius is None else f" at radius {self.hub_radius:.6g}"
        driven = "" if self.drive == "force" else f", driven by {self.drive.replace('both', 'ux and uy')}"
        driven += "" if self.gauge_radius is None else f" over radius {self.gauge_radius:.6g}"
        driven += "" if self.rig_stiffness is None else f" by a rig of stiffness {self.rig_stiffness:.6g}"
        load = {"centre": "load at the centre", "body": "body load"}[self.pin_load]
        load = load if self.pin_body == SOLID_PIN else repr(self.pin_body)
        plate = "" if self.plate_body == INFINITE_PLATE else f"\n {self.plate_body!r}"
        gap = "".join(f"\n {name} profile {profile!r}" for name, profile in self.gap.given.items())
        return (
            f"<Problem: {self.pair!r}\n {size}, friction {self.friction_words()}\n"
            f" {load}, rotation {self.rotation}{hub}{driven}{plate}{gap}>"
        )

    @classmethod
    @explains_keywords
    def from_load_parameter(
        cls,
        pair: MaterialPair,
        load_parameter: float,
        friction: float | Profile,
        pin_load: PinLoad = "centre",
        rotation: Rotation = "free",
        hub_radius: float | None = None,
        *,
        hub_stiffness: float | None = None,
        drive: DriveKind = "force",
        gauge_radius: float | None = None,
        rig_stiffness: float | None = None,
        pin_body: PinBody = SOLID_PIN,
        plate_body: PlateBody = INFINITE_PLATE,
        gap: InitialGap = NO_GAP,
    ) -> Problem:
        """The dimensionless problem of the paper: R = 1, F = 1, beta* = 1.

        With a load P = 1 the load parameter (R - R_D)/(F beta*) is `load_parameter`. The units of results are F/R for
        tractions, F beta* for displacements and F beta*/R for rotations. Remote stresses are given in F/R, and a hub's
        stiffness in R^2/beta*, that of a rig in 1/beta*. Radii of bodies are in units of R, and the interference of a
        bush in F beta*. beta* is that of the two surfaces in contact: of pin and bush if there is a bush.
        """
        value = number("load_parameter", load_parameter, -MOST_PARAMETER, MOST_PARAMETER)
        instance("pair", pair, MaterialPair, "a MaterialPair")
        plate_body, pair = without_units(pair, plate_body)
        return cls(
            pair, 1.0, value, friction, pin_load, rotation, hub_radius, True,
            hub_stiffness=hub_stiffness, drive=drive, gauge_radius=gauge_radius, rig_stiffness=rig_stiffness,
            pin_body=pin_body, plate_body=plate_body, gap=gap,
        )  # fmt: skip

    @cached_property
    def joint(self) -> BodyPair:
        """Pin and plate with their materials."""
        return BodyPair(self.pair, self.hole_radius, self.pin_body, self.plate_body, self.pin_load)

    @cached_property
    def surfaces(self) -> MaterialPair:
        """The materials of the two surfaces in contact: ``pair``, or pin and bush."""
        return self.joint.surfaces

    @property
    def has_bodies(self) -> bool:
        """Whether the pin is hollow or the plate is no infinite plate."""
        return bool(self.given_bodies)

    @property
    def given_bodies(self) -> dict[str, BodyBase]:
        """The bodies by their fields, without a solid pin and an infinite plate."""
        bodies = {"pin_body": self.pin_body, "plate_body": self.plate_body}
        return {name: body for name, body in bodies.items() if body not in (SOLID_PIN, INFINITE_PLATE)}

    @cached_property
    def interfaces(self) -> tuple[Problem, ...]:
        """The contacts of the joint, each as a problem of its own: pin in hole, then a bush that slips in its seat.

        In the first one a bush that slips is a ring, free at its outer rim. In the second one it is a hollow pin, free
        at its bore. Without friction in its seat the bush passes no moment on: then the pin is free in it. With a
        single contact it is this problem.
        """
        contacts = self.plate_body.contacts(self.pair, self.hole_radius)
        if not contacts:
            return (self,)
        of_pin, of_seat = contacts
        free: dict[str, Any] = {"rotation": "free", "hub_radius": None, "hub_stiffness": None}
        seat = replace(self, pin_load="centre", **free, gap=NO_GAP, **of_seat)
        return replace(self, **(free if seat.frictionless else {}), **of_pin), seat

    @property
    def seat(self) -> Problem | None:
        """The contact of a bush that slips in its seat; None without one."""
        return self.interfaces[1] if len(self.interfaces) > 1 else None

    @property
    def pin_radius(self) -> float:
        """Radius of the free pin, m: hole radius less clearance, both before a bush is pressed in.

        NaN in a dimensionless problem: its clearance has another unit than its radius.
        """
        return math.nan if self.dimensionless else self.hole_radius - self.clearance

    @property
    def assembled_clearance(self) -> float:
        """Radial clearance, m, after the bush was pressed in; the given clearance without a bush."""
        return self.clearance + self.joint.press_fit[1]

    @property
    def press_fit_pressure(self) -> float:
        """Pressure between bush and plate after the bush was pressed in, Pa; 0 without a bush."""
        return self.joint.press_fit[0]

    @property
    def is_incompressible(self) -> bool:
        """Whether uniform pressure changes neither the pin nor the hole."""
        return self.joint.uniform_compliance <= 1e-11 * self.surfaces.beta_star  # a smaller one is rounding

    @property
    def held(self) -> bool:
        """Whether the rotation of the pin is held, by a fixed hub or a spring."""
        return self.rotation != "free"

    @property
    def driven(self) -> tuple[bool, bool]:
        """Whether the displacement of the pin along x, and along y, is prescribed."""
        return self.drive in ("ux", "both"), self.drive in ("uy", "both")

    @property
    def reactions(self) -> tuple[str, ...]:
        """Names of the loads that are reactions: Q and P to prescribed displacements, M to a held rotation."""
        prescribed = {"Q": self.driven[0], "P": self.driven[1], "M": self.held}
        return tuple(name for name, is_reaction in prescribed.items() if is_reaction)

    @property
    def drive_compliances(self) -> tuple[float, float]:
        """The compliances g and k of a prescribed displacement, in units of beta*; docs/theory.md (T29).

        The displacement of the hub relative to the gauge circle is c + g F - k (int of the tractions). c is the mean
        displacement of the pin's rim relative to the hole, and F the force on the pin.
        """
        radii = (None if r is None else r / self.hole_radius for r in (self.hub_radius, self.gauge_radius))
        return self.joint.displacement_compliances(*radii)

    @property
    def frictionless(self) -> bool:
        """Whether the coefficient of friction is zero all round."""
        return self.most_friction == 0.0

    @property
    def most_friction(self) -> float:
        """The largest coefficient of friction round the hole."""
        return self._friction_limits[1]

    @property
    def least_friction(self) -> float:
        """The smallest coefficient of friction round the hole."""
        return self._friction_limits[0]

    @cached_property
    def _friction_limits(self) -> tuple[float, float]:
        if not isinstance(self.friction, Profile):
            return self.friction, self.friction
        values = self.friction_at(self.friction.angles(LOOKED_AT, self.hole_radius))
        return float(values.min()), float(values.max())

    def friction_words(self, digits: int = 6) -> str:
        """The coefficient of friction as text, to so many significant digits: its range if it varies."""
        least, most = self._friction_limits
        whole_number("digits", digits, 1, 17)
        if not isinstance(self.friction, Profile):
            return f"{most:.{digits}g}"
        return f"{least:.{digits}g} to {most:.{digits}g} along the rim"

    @property
    def profiles(self) -> dict[str, Profile]:
        """The profiles along the rim that are given, by their names in case files: section and key."""
        found = {f"gap.{name}": profile for name, profile in self.gap.given.items()}
        return found | ({"contact.friction": self.friction} if isinstance(self.friction, Profile) else {})

    def entries(self) -> dict[str, Any]:
        """The fields of :data:`fastpin.model.fields.FIELDS` by name, as ids and HDF5 files hold them.

        A profile is its list of terms. An initial gap is the profiles of "hole" and "pin"; none is left out.
        """
        found = {name: getattr(self, name) for name in FIELDS if name != "gap" or self.gap}
        if isinstance(self.friction, Profile):
            found["friction"] = self.friction.entries()
        if self.gap:
            found["gap"] = {name: profile.entries() for name, profile in self.gap.given.items()}
        return found

    @property
    def uniform_friction(self) -> float:
        """The coefficient of friction, for methods that take one number only. Raises InputError if it varies."""
        if isinstance(self.friction, Profile):
            raise InputError("friction", "must be one number here: this method knows no friction that varies")
        return self.friction

    def friction_at(self, theta: np.ndarray) -> np.ndarray:
        """Coefficient of friction at the angles `theta` (...), rad, shape (...)."""
        if not isinstance(self.friction, Profile):
            return np.full(number_array("theta", theta).shape, self.friction)
        return np.maximum(self.friction.at(theta, self.hole_radius), 0.0)  # a spline may pass below zero in between

    @property
    def expansions(self) -> tuple[float | None, float | None]:
        """Coefficients of thermal expansion of the pin, and of the body round it, 1/K; None if it is not known."""
        return self.pair.pin.expansion, self.surfaces.plate.expansion

    def gap_at(self, theta: np.ndarray) -> np.ndarray:
        """Initial gap beside the clearance and two derivatives at the angles `theta` (...), rad, m, shape (3, ...)."""
        return self.gap.values(theta, self.hole_radius)

    @cached_property
    def gap_angles(self) -> np.ndarray:
        """Angles at which the initial gap shows itself, rad, in order."""
        return self.gap.angles(LOOKED_AT, self.hole_radius)

    @cached_property
    def clearances(self) -> tuple[float, float]:
        """The least and the largest gap round the unloaded, concentric pin, m. They are equal in a round hole."""
        clearance = self.assembled_clearance
        if not self.gap:
            return clearance, clearance
        gap = self.gap_at(self.gap_angles)[0]
        return clearance + float(gap.min()), clearance + float(gap.max())

    @cached_property
    def is_gripped(self) -> bool:
        """Whether the hole grips the unloaded pin: an interference fit, or a gap too narrow for a rigid pin.

        A prescribed displacement holds the pin at 0 before any load.
        """
        clearance = self.assembled_clearance
        if not self.gap:
            return clearance < 0.0
        gap = clearance + self.gap_at(self.gap_angles)[0]
        room = widest_place(self.gap_angles, gap, self.driven)[0]
        return room < -1e-9 * float(np.abs(gap).max())  # digits of the linear programme

    @property
    def is_round(self) -> bool:
        """Whether pin, bush and hole stay round as they are pressed together."""
        return not self.gap and self.joint.is_round

    @property
    def is_pressed(self) -> bool:
        """Whether pin, bush and plate press each other before any load."""
        return self.is_gripped or self.press_fit_pressure > 0.0

    @property
    def bush_slips(self) -> bool:
        """Whether a bush may slip in its seat."""
        bush = self.plate_body.bush
        return bush is not None and not bush.bonded

    @property
    def needs_circle(self) -> str:
        """Why the nodes of the pin must go all round; an empty string if they may lie on an arc."""
        if self.is_gripped:
            return "an interference fit is in contact all round"
        if self.seat is not None and self.gap:
            return "a pin with an initial gap may touch a bush that slips anywhere"
        return ""

    def load_parameter(self, force: float) -> float:
        """Load parameter L_p = (R - R_D) / (F beta*) for a force F, N/m."""
        displacement = number("force", force) * self.surfaces.beta_star
        parameter = self.assembled_clearance / displacement if displacement else math.inf
        if not math.isfinite(parameter):
            raise InputError("force", f"is too small for a load parameter: {as_toml(force)}")
        return parameter

    def natural_loads(self) -> dict[str, float]:
        """The load of each kind that strains the bodies by about 1, SI, by the kinds of ``LOAD_KIND``."""
        radius, stress = self.hole_radius, 1.0 / self.surfaces.beta_star
        return {
            "force": radius * stress,
            "moment": radius * radius * stress,
            "traction": stress,
            "rotation": 1.0,
            "displacement": radius,
            "ratio": 1.0,
            "temperature": 1.0 / MOST_EXPANSION,
        }

    @property
    def hub_compliance(self) -> float:
        """Rotation of a held pin per int T dtheta, in units of beta*: C_omega = hub_compliance * int T dtheta.

        It is zero for the paper's datum of a solid pin, and [R^2/r^2 - (kappa_I + 1)] / (4 pi G_I beta*) for a hub of
        radius r. The hub of a hollow pin is its bore by default. A spring of stiffness k adds R^2 / (k beta*).
        """
        compliance, hub = 0.0, self.hub_radius or self.pin_body.bore_radius
        if hub and self.held:
            ratio = (self.hole_radius / hub) ** 2
            stiffness = 4.0 * math.pi * self.surfaces.beta_star
            compliance = (ratio - (self.pair.pin_kolosov + 1.0)) * self.pair.pin_compliance / stiffness
        return compliance + self.spring_compliance

    @property
    def spring_compliance(self) -> float:
        """The part of the hub's spring in :attr:`hub_compliance`; 0 without a spring."""
        if self.hub_stiffness is None:
            return 0.0
        return self.hole_radius**2 / (self.hub_stiffness * self.surfaces.beta_star)


def checked_thickness(field: str, value: object) -> float:
    """Check a thickness, m, from :data:`LEAST_RADIUS` to :data:`MOST_RADIUS`, and return it as a float."""
    return number(field, positive(field, value), LEAST_RADIUS, MOST_RADIUS)


def checked_gap(given: InitialGap | ProfileLike, radius: float, dimensionless: bool) -> InitialGap:
    """Check an initial gap, m, or in units of F beta*, for a hole of this radius, m. A profile of zeros is left out."""
    gap, kept = InitialGap.of(given), {}
    most = MOST_PARAMETER if dimensionless else MOST_GAP * radius
    for name, profile in gap.given.items():
        if dimensionless and profile.needs_lengths:
            raise InputError(
                f"gap.{name}", "a flat has no meaning in a dimensionless problem: its shape needs lengths in m"
            )
        largest = float(np.abs(profile.at(profile.angles(LOOKED_AT, radius), radius)).max())
        if not largest <= most:
            limits = f"must lie within {most:g}, a tenth of the hole radius" if not dimensionless else f"{most:g}"
            raise InputError(f"gap.{name}", f"is too large for small strains: {limits}, not {largest:g}")
        if largest:
            kept[name] = profile
    return InitialGap(**kept) if kept else NO_GAP
