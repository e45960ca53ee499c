"""The problem: materials, geometry, friction, how the pin is loaded and whether it may rotate."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Literal

from fastpin.errors import InputError
from fastpin.model.checks import as_toml, choice, instance, number, true_or_false
from fastpin.model.materials import MaterialPair

PinLoad = Literal["centre", "body"]
"""Kinds of pin load."""

Rotation = Literal["free", "fixed", "spring"]
"""Kinds of pin rotation."""

LEAST_RADIUS, MOST_RADIUS = 1e-30, 1e30
"""Limits of the hole radius, m. Squares of dimensional results are then still numbers, in any units."""

MOST_PARAMETER = 1e50
"""Largest load parameter of a dimensionless problem. A larger clearance could only mean a wrong unit."""

MOST_FRICTION = 1e6
"""Largest coefficient of friction. The pin sticks wherever it touches. Beyond, rounding makes it slip."""

LEAST_HUB = 1e-5
"""Least hub radius, in parts of R. The pin turns by 1/r^2 per moment: a smaller hub holds it by rounding only."""

LEAST_STIFFNESS, MOST_STIFFNESS = 1e-30, 1e30
"""Limits of the stiffness of a hub's spring, in parts of R^2/beta*. At a limit the pin is free or fixed."""

MOST_GAUGE = 1e30
"""Largest gauge radius, in parts of R. The displacement grows like its logarithm: a larger circle is no plate."""

Drive = Literal["force", "ux", "uy", "both"]
"""Ways to drive the pin: by the forces P and Q, or by displacements in place of Q (ux), of P (uy) or of both."""


@dataclass(frozen=True, repr=False)
class Problem:
    """An elastic pin in the hole of an infinite elastic plate, with Coulomb friction.

    Parameters
    ----------
    pair : MaterialPair
    hole_radius : float
        R, m, from :data:`LEAST_RADIUS` to :data:`MOST_RADIUS`.
    clearance : float
        Radial clearance R - R_D, m. Zero is a neat fit, negative an interference fit.
    friction : float
        Coefficient of friction, 0 to :data:`MOST_FRICTION`.
    pin_load : {"centre", "body"}
        The pin's load acts at its centre, or as a uniform body force (section 4 of the paper).
    rotation : {"free", "fixed", "spring"}
        A free pin carries the moment M (0 unless given). A fixed pin has a prescribed rotation (0 unless given). A
        spring holds the pin at its hub; the load ``rotation`` then turns the far end of the spring. A body-loaded pin
        must be free: its potentials have a moment singularity otherwise (section 4).
    hub_radius : float, optional
        Radius, m, of the hub: the circle in the pin whose mean rotation is held, by a fixed hub or a spring, and whose
        mean displacement is prescribed. Only with one of these. Rotation and displacement of a pin under loads at its
        centre depend on where they are measured. The default is the paper's datum of the rotation,
        R / sqrt(kappa_I + 1). For the whole rim give ``hub_radius=hole_radius``. The least is :data:`LEAST_HUB` R. The
        displacement of a body-loaded pin is its mean over the pin, and takes no hub.
    dimensionless : bool
        Set by :meth:`from_load_parameter`. It lifts the check that the clearance is smaller than the hole.
    hub_stiffness : float, optional
        Stiffness of the spring, N (moment per unit thickness per rad), :data:`LEAST_STIFFNESS` to
        :data:`MOST_STIFFNESS` R^2/beta*; only with ``rotation="spring"``, and needed there. In a dimensionless problem
        its unit is R^2/beta*.
    drive : {"force", "ux", "uy", "both"}
        "force": the loads P and Q push the pin. "ux": the load ``ux`` prescribes the displacement of the hub along x.
        Q is then the reaction, and P is a force. "uy": ``uy`` prescribes the displacement along y, P is the reaction,
        and Q is a force. "both": ``ux`` and ``uy`` prescribe both. The displacement is relative to the mean
        displacement of the gauge circle, and counts from the concentric position.
    gauge_radius : float, optional
        Radius, m, of the gauge circle round the hole, in the plate, from the hole radius R, which is the default, to
        :data:`MOST_GAUGE` R. Only with a prescribed displacement. Far away the plate's displacement under a force grows
        like the logarithm of the distance. So a displacement relative to the plate needs a radius.

    Raises
    ------
    InputError
        If a field is out of range, or the theory excludes a combination. The error names the field.
    """

    pair: MaterialPair
    hole_radius: float
    clearance: float
    friction: float
    pin_load: PinLoad = "centre"
    rotation: Rotation = "free"
    hub_radius: float | None = None
    dimensionless: bool = False
    hub_stiffness: float | None = field(default=None, kw_only=True)
    drive: Drive = field(default="force", kw_only=True)
    gauge_radius: float | None = field(default=None, kw_only=True)

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
            raise InputError("clearance", f"must be smaller than the hole radius {radius:g}, not {clearance:g}")
        friction = number("friction", self.friction)
        if friction < 0.0:
            raise InputError("friction", f"must not be negative, not {friction:g}")
        number("friction", friction, 0.0, MOST_FRICTION)
        if clearance < 0.0 and self.pair.is_incompressible:
            raise InputError(
                "clearance",
                "a pin with nu = 0.5 in a rigid plate keeps its area in plane strain: it fits into no smaller hole; "
                f"must not be negative, not {clearance:g}",
            )
        choice("pin_load", self.pin_load, ("centre", "body"))
        choice("rotation", self.rotation, ("free", "fixed", "spring"))
        choice("drive", self.drive, ("force", "ux", "uy", "both"))
        if self.pin_load == "body" and self.held:
            raise InputError(
                "rotation",
                'a body-loaded pin must rotate freely (rotation = "free"): holding it takes a moment, and uniform body '
                "forces leave that moment's singularity at the centre (section 4 of the paper)",
            )
        object.__setattr__(self, "hole_radius", radius)
        self._check_hub(radius)
        self._check_drive(radius)
        object.__setattr__(self, "clearance", clearance)
        object.__setattr__(self, "friction", friction)
        object.__setattr__(self, "dimensionless", bool(self.dimensionless))

    def _check_hub(self, radius: float) -> None:
        """Check the radius and the stiffness of the hub. `radius` is the radius of the hole."""
        if self.hub_radius is not None:
            hub = number("hub_radius", self.hub_radius)
            if not self.held and self.drive == "force":
                raise InputError("hub_radius", 'only a pin with rotation = "fixed" or "spring" is held at a hub')
            if self.pin_load == "body":
                raise InputError("hub_radius", "the displacement of a body-loaded pin is its mean: leave the hub out")
            if not LEAST_HUB * radius <= (1.0 + 1e-9) * hub or hub > radius:  # LEAST_HUB * radius is rounded
                limits = f"{LEAST_HUB * radius:g} and the hole radius {radius:g}"
                raise InputError("hub_radius", f"must lie between {limits}, not {hub:g}")
            object.__setattr__(self, "hub_radius", hub)
        if self.hub_stiffness is not None:
            stiffness = number("hub_stiffness", self.hub_stiffness)
            if self.rotation != "spring":
                raise InputError("hub_stiffness", 'only a pin with rotation = "spring" is held by a spring')
            if stiffness <= 0.0:
                raise InputError("hub_stiffness", f"must be positive, not {stiffness:g}")
            natural = self.natural_loads()["moment"]
            number("hub_stiffness", stiffness, LEAST_STIFFNESS * natural, MOST_STIFFNESS * natural)
            object.__setattr__(self, "hub_stiffness", stiffness)
        elif self.rotation == "spring":
            raise InputError("hub_stiffness", 'a pin with rotation = "spring" needs the stiffness of the spring')

    def _check_drive(self, radius: float) -> None:
        """Check the radius of the gauge circle. `radius` is the radius of the hole."""
        if self.gauge_radius is not None:
            gauge = number("gauge_radius", self.gauge_radius)
            if self.drive == "force":
                raise InputError("gauge_radius", 'only a displacement has a gauge: drive = "ux" or "uy" or "both"')
            if gauge < radius:
                raise InputError("gauge_radius", f"must be at least the hole radius {radius:g}, not {gauge:g}")
            number("gauge_radius", gauge, radius, MOST_GAUGE * radius)
            object.__setattr__(self, "gauge_radius", gauge)

    def __repr__(self) -> str:
        size = f"load parameter {self.clearance:.6g} (R = F = beta* = 1)"
        if not self.dimensionless:
            size = f"hole radius {self.hole_radius:.6g} m, clearance {self.clearance:.6g} m"
        hub = "" if self.hub_stiffness is None else f" of stiffness {self.hub_stiffness:.6g}"
        hub += "" if self.hub_radius is None else f" at radius {self.hub_radius:.6g}"
        driven = "" if self.drive == "force" else f", driven by {self.drive.replace('both', 'ux and uy')}"
        driven += "" if self.gauge_radius is None else f" over radius {self.gauge_radius:.6g}"
        return (
            f"<Problem: {self.pair!r}\n {size}, friction {self.friction:.6g}\n"
            f" load at the {self.pin_load}, rotation {self.rotation}{hub}{driven}>"
        ).replace("load at the body", "body load")

    @classmethod
    def from_load_parameter(
        cls,
        pair: MaterialPair,
        load_parameter: float,
        friction: float,
        pin_load: PinLoad = "centre",
        rotation: Rotation = "free",
        hub_radius: float | None = None,
        *,
        hub_stiffness: float | None = None,
        drive: Drive = "force",
        gauge_radius: float | None = None,
    ) -> Problem:
        """The dimensionless problem of the paper: R = 1, F = 1, beta* = 1.

        With a load P = 1 the load parameter (R - R_D)/(F beta*) is `load_parameter`. The units of results are F/R for
        tractions, F beta* for displacements and F beta*/R for rotations. Remote stresses are given in F/R, and a hub's
        stiffness in R^2/beta*.
        """
        value = number("load_parameter", load_parameter, -MOST_PARAMETER, MOST_PARAMETER)
        instance("pair", pair, MaterialPair, "a MaterialPair")
        return cls(
            pair.scaled(1.0), 1.0, value, friction, pin_load, rotation, hub_radius, True,
            hub_stiffness=hub_stiffness, drive=drive, gauge_radius=gauge_radius,
        )  # fmt: skip

    @property
    def held(self) -> bool:
        """Whether the rotation of the pin is held, by a fixed hub or a spring."""
        return self.rotation != "free"

    @property
    def driven(self) -> tuple[bool, bool]:
        """Whether the displacement of the pin along x, and along y, is prescribed."""
        return self.drive in ("ux", "both"), self.drive in ("uy", "both")

    @property
    def drive_compliances(self) -> tuple[float, float]:
        """The compliances g and k of a prescribed displacement, in units of beta*; docs/theory.md (T29).

        The displacement of the hub over the gauge circle is c + g F - k (int of the tractions), where c is the mean
        displacement of the pin's rim over that of the hole, and F the force on the pin.
        """
        kolosov, pin = self.pair.pin_kolosov, self.pair.pin_compliance / (4.0 * math.pi * self.pair.beta_star)
        if self.pin_load == "body":
            own = coupling = 0.5 * pin
        else:
            part = 1.0 / math.sqrt(kolosov + 1.0) if self.hub_radius is None else self.hub_radius / self.hole_radius
            coupling = (1.0 - part**2) * pin
            own = 2.0 * (1.0 - part**2 - kolosov * math.log(part)) / (kolosov + 1.0) * pin
        if self.gauge_radius is not None:
            kolosov, plate = self.pair.plate_kolosov, self.pair.plate_compliance / (2.0 * math.pi * self.pair.beta_star)
            own += kolosov * math.log(self.gauge_radius / self.hole_radius) / (kolosov + 1.0) * plate
        return own, coupling

    @property
    def frictionless(self) -> bool:
        """Whether the coefficient of friction is zero."""
        return self.friction == 0.0

    def load_parameter(self, force: float) -> float:
        """Load parameter L_p = (R - R_D) / (F beta*) for a force F, N/m."""
        displacement = number("force", force) * self.pair.beta_star
        parameter = self.clearance / displacement if displacement else math.inf
        if not math.isfinite(parameter):
            raise InputError("force", f"is too small for a load parameter: {as_toml(force)}")
        return parameter

    def natural_loads(self) -> dict[str, float]:
        """The load of each kind that strains the bodies by about 1, SI, by the kinds of ``LOAD_KIND``."""
        radius, stress = self.hole_radius, 1.0 / self.pair.beta_star
        return {
            "force": radius * stress,
            "moment": radius * radius * stress,
            "traction": stress,
            "rotation": 1.0,
            "displacement": radius,
        }

    @property
    def hub_compliance(self) -> float:
        """Rotation of a held pin per int T dtheta, in units of beta*: C_omega = hub_compliance * int T dtheta.

        It is zero for the paper's datum, and [R^2/r^2 - (kappa_I + 1)] / (4 pi G_I beta*) for a hub of radius r. A
        spring of stiffness k adds R^2 / (k beta*).
        """
        compliance = 0.0
        if self.hub_radius is not None:
            ratio = (self.hole_radius / self.hub_radius) ** 2
            stiffness = 4.0 * math.pi * self.pair.beta_star
            compliance = (ratio - (self.pair.pin_kolosov + 1.0)) * self.pair.pin_compliance / stiffness
        return compliance + self.spring_compliance

    @property
    def spring_compliance(self) -> float:
        """The part of the hub's spring in :attr:`hub_compliance`; 0 without a spring."""
        if self.hub_stiffness is None:
            return 0.0
        return self.hole_radius**2 / (self.hub_stiffness * self.pair.beta_star)
