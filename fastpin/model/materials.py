"""Elastic materials and the composite constants of a pin-plate pair.

Equation numbers refer to Sundaram and Farris, "Mechanics of advancing pin-loaded contacts with friction". The index I
marks the pin. Stresses are in Pa, compliances in 1/Pa.

Two sign conventions of Dundurs' parameters are in use. The *usual* convention, with the pin as body 1, is

    alpha = [(k+1)/G - (k_I+1)/G_I] / [(k+1)/G + (k_I+1)/G_I],    beta = alpha_star / (2 beta_star),

Then alpha is positive where the plate is the more compliant body. The *paper* prints both with the opposite sign.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar, Literal

import numpy as np

from fastpin.errors import InputError
from fastpin.model.checks import Library, check_fields, choice, instance, number, positive, set_fields, string
from fastpin.model.fatigue import FatigueConstants
from fastpin.model.growth import KnownLaw, known_law, law_entries
from fastpin.model.synonyms import explains_keywords

Plane = Literal["strain", "stress"]
"""Plane strain or plane stress, for type checkers."""

STRENGTHS = ("yield_strength", "ultimate_strength")
"""Strengths of a material, Pa, each of them optional."""

MATERIAL_KEYS = ("material", "E", "nu", "rigid", "fatigue", "growth", *STRENGTHS, "expansion")
"""Keys of the material of a body in case files."""

NUMBERS = (*STRENGTHS, "expansion")
"""Optional numbers of a material."""

MOST_EXPANSION = 1e-3
"""Largest coefficient of thermal expansion, 1/K. That of rubber is 2e-4."""

PLANES = ("strain", "stress")
"""Words for plane strain and plane stress."""

Convention = Literal["usual", "paper"]
"""Sign conventions of Dundurs' parameters."""

MOST_RATIO = 1e30
"""Largest ratio of the two moduli. The stiffer body is rigid to the last digit long before."""

LEAST_BETA_STAR, MOST_BETA_STAR = 1e-40, 1e40
"""Limits of a given composite compliance, 1/Pa. The moduli then keep within their own limits."""


def checked_expansion(field: str, value: object) -> float:
    """Check a coefficient of thermal expansion, 1/K, and return it as a float."""
    return number(field, value, -MOST_EXPANSION, MOST_EXPANSION)


@explains_keywords
@dataclass(frozen=True, repr=False)
class Material:
    """An isotropic elastic material.

    Parameters
    ----------
    E : float
        Young's modulus, Pa, from 1e-60 to 1e60; ``math.inf`` for a rigid body.
    nu : float
        Poisson's ratio, 0 to 0.5.
    name : str, optional
        Name in tables and plots.
    fatigue : FatigueConstants, optional
        They change no state, and serve :mod:`fastpin.damage` only.
    yield_strength : float, optional
        Pa, positive. It changes no state: fastpin warns of a contact pressure above it.
    ultimate_strength : float, optional
        Stress at which a tensile specimen breaks, Pa, positive. It changes no state.
    growth : Walker or Nasgro, optional
        Law of crack growth with its constants, see :mod:`fastpin.cracks`. It changes no state.
    expansion : float, optional
        Coefficient of thermal expansion, 1/K. A load ``temperature`` needs that of every body.

    Attributes
    ----------
    is_isotropic : bool
        False for a :class:`fastpin.model.Laminate`.

    Raises
    ------
    InputError
        If `E` is not positive or beyond its limits, `nu` is outside [0, 0.5], `name` is no text, `fatigue` is of
        another class, a strength is not positive, `growth` is no law of fastpin, or `expansion` is out of range.
    """

    is_isotropic: ClassVar[bool] = True

    E: float
    nu: float
    name: str = ""
    fatigue: FatigueConstants | None = None
    yield_strength: float | None = None
    ultimate_strength: float | None = None
    growth: KnownLaw | None = None
    expansion: float | None = None

    def __post_init__(self) -> None:
        rigid = isinstance(self.E, (float, np.floating)) and math.inf == self.E
        modulus = self.E if rigid else number("E", self.E)
        if modulus <= 0.0:
            raise InputError("E", f"Young's modulus must be positive, not {modulus:g}")
        if not rigid:
            number("E", modulus, 1e-60, 1e60)  # squares of dimensional results are then still numbers, in any units
        ratio = number("nu", self.nu)
        if not 0.0 <= ratio <= 0.5:
            raise InputError("nu", f"Poisson's ratio must lie between 0 and 0.5, not {ratio:g}")
        set_fields(self, E=float(modulus), nu=ratio)
        check_fields(self, string, "name")
        if self.fatigue is not None:
            instance("fatigue", self.fatigue, FatigueConstants, "fastpin.model.FatigueConstants")
        check_fields(self, positive, " ".join(STRENGTHS), optional=True)
        if self.growth is not None:
            known_law("growth", self.growth)
        check_fields(self, checked_expansion, "expansion", optional=True)

    def __repr__(self) -> str:
        fatigue = "" if self.fatigue is None else f", fatigue={self.fatigue!r}"
        strengths = "".join(f", {name}={value:g}" for name, value in self.numbers.items())
        growth = "" if self.growth is None else f", growth={self.growth!r}"
        return f"{self.elastic_form[:-1]}{fatigue}{strengths}{growth})"

    @property
    def elastic_form(self) -> str:
        """The short form without strengths and constants of fatigue, which do not change the contact."""
        name = f", {self.name!r}" if self.name else ""
        return f"Material({self.E:g}, {self.nu:g}{name})"

    @property
    def label(self) -> str:
        """Words that name the material; empty if it has no name."""
        return self.name

    @property
    def shown_moduli(self) -> dict[str, float]:
        """The elastic constants by the names that they have in text: moduli in Pa, and Poisson's ratio."""
        return {"E": self.E, "nu": self.nu}

    @property
    def direction_words(self) -> str:
        """Words for the direction of the material; empty for an isotropic one."""
        return ""

    def constants(self) -> dict[str, Any]:
        """The numbers that the elastic response depends on, by name. A modulus may be infinite."""
        return {"E": self.E, "nu": self.nu} | ({} if self.expansion is None else {"expansion": self.expansion})

    def entries(self) -> dict[str, Any]:
        """The elastic constants and the name as a JSON-ready dict. A modulus may be infinite."""
        return {"name": self.name, **self.constants()}

    def summary(self) -> dict[str, Any]:
        """What the JSON of a result has beside E, nu and the strengths; empty for an isotropic material."""
        return {}

    def toml(self) -> dict[str, Any]:
        """The keys and values of the section of a case file. A name that fastpin does not know is left out."""
        if self.is_rigid:
            return {"rigid": True} | ({} if self.expansion is None else {"expansion": self.expansion})
        if MATERIALS.get(self.name) == self:
            return {"material": self.name}
        fatigue = {} if self.fatigue is None else {"fatigue": self.fatigue.given()}
        growth = {} if self.growth is None else {"growth": law_entries(self.growth)}
        return {"E": self.E, "nu": self.nu, **self.numbers, **fatigue, **growth}

    @classmethod
    def rigid(cls) -> Material:
        """A rigid material: the exact limit of an infinite modulus."""
        return Material(math.inf, 0.3, "rigid")

    @property
    def is_rigid(self) -> bool:
        """Whether Young's modulus is infinite."""
        return math.isinf(self.E)

    @property
    def shear_modulus(self) -> float:
        """G = E / (2 (1 + nu)), Pa."""
        return self.E / (2.0 * (1.0 + self.nu))

    @property
    def strengths(self) -> dict[str, float]:
        """The strengths that are given, Pa, by name: `yield_strength` and `ultimate_strength`."""
        return {name: value for name in STRENGTHS if (value := getattr(self, name)) is not None}

    @property
    def numbers(self) -> dict[str, float]:
        """The optional numbers that are given, by name: the strengths and `expansion`."""
        return {name: value for name in NUMBERS if (value := getattr(self, name)) is not None}

    @property
    def known_yield_strength(self) -> float | None:
        """The yield strength, Pa: the material's own, or else the one of its fatigue constants; None if unknown."""
        if self.yield_strength is None and self.fatigue is not None:
            return self.fatigue.yield_strength
        return self.yield_strength

    def scaled(self, factor: float) -> Material:
        """The same material with another modulus, E times `factor`. It is another one: its strengths are unknown.

        A `factor` that is not positive raises :class:`InputError`.
        """
        return Material(self.E * positive("factor", factor), self.nu, self.name)

    def kolosov(self, plane: Plane) -> float:
        """Kolosov's constant: 3 - 4 nu in plane strain, (3 - nu)/(1 + nu) in plane stress.

        An unknown `plane` raises :class:`InputError`.
        """
        if choice("plane", plane, PLANES) == "strain":
            return 3.0 - 4.0 * self.nu
        return (3.0 - self.nu) / (1.0 + self.nu)


MATERIALS = Library(
    "material",
    {
        "Ti-6Al-4V": Material(116e9, 0.32, "Ti-6Al-4V", yield_strength=828e6),
        "aluminium": Material(69e9, 0.33, "aluminium"),
        "steel": Material(210e9, 0.30, "steel"),
        "nickel alloy": Material(199.9e9, 0.294, "nickel alloy"),
        "2024-T3": Material(
            70e9,
            0.33,
            "2024-T3",
            FatigueConstants(
                fatigue_strength=1100e6,
                strength_exponent=-0.124,
                fatigue_ductility=0.22,
                ductility_exponent=-0.59,
                yield_strength=379e6,
                source="Stephens et al., Metal Fatigue in Engineering, 2nd ed. (2001), appendix A, after SAE J1099",
            ),
        ),
        "SAE 1020": Material(
            203e9,
            0.30,
            "SAE 1020",
            FatigueConstants(
                fatigue_strength=896e6,
                strength_exponent=-0.12,
                fatigue_ductility=0.41,
                ductility_exponent=-0.51,
                yield_strength=262e6,
                source="Stephens et al., Metal Fatigue in Engineering, 2nd ed. (2001), appendix A, after SAE J1099",
            ),
        ),
        "7075-T6": Material(71.7e9, 0.33, "7075-T6", yield_strength=503e6),
        "A36": Material(200e9, 0.30, "A36", yield_strength=250e6),
        "4340 normalized": Material(207e9, 0.30, "4340 normalized", yield_strength=862e6),
        "304": Material(193e9, 0.30, "304", yield_strength=205e6),
        "316": Material(193e9, 0.30, "316", yield_strength=205e6),
        "17-4PH H900": Material(197e9, 0.272, "17-4PH H900", yield_strength=1170e6),
        "Inconel 718": Material(199.9e9, 0.294, "Inconel 718", yield_strength=1034e6),
        "C93200": Material(100e9, 0.35, "C93200", yield_strength=138e6),
        "PEEK": Material(4.0e9, 0.40, "PEEK", yield_strength=98e6),
    },
)
"""Named materials at room temperature.

* Ti-6Al-4V (116 GPa, 0.32) and aluminium (69 GPa, 0.33): in plane strain the pair has the Dundurs parameters 0.2507
  and 0.0595. The paper's Ti6Al4V-Al pair has -0.2503 and -0.0594, in the paper's sign convention. The yield strength of
  Ti-6Al-4V is the least one of ASTM B265, grade 5 (120 ksi).
* steel (210 GPa, 0.30): EN 1993-1-1, 3.2.6.
* nickel alloy (199.9 GPa, 0.294): INCONEL alloy 718, Special Metals data sheet SMC-045, annealed and aged, 21 C.
* 2024-T3 sheet (70 GPa) and SAE 1020 hot-rolled sheet (203 GPa) have fatigue constants. They are quoted after Stephens,
  Fatemi, Stephens and Fuchs, Metal Fatigue in Engineering, 2nd ed. (Wiley 2001), appendix A, which cites SAE J1099.
  Compare them with the print before relying on a life. Poisson's ratios (0.33, 0.30) are usual values of such alloys.
* 7075-T6: typical values of the Aluminum Association, as data sheets of ASM Aerospace Specification Metals quote them.
* A36: modulus and ratio of AISC 360 (29,000 ksi, 0.3); the least yield strength of ASTM A36 (36 ksi).
* 4340 normalized, 304 and 316: Callister and Rethwisch, Materials Science and Engineering, appendix B. 205 MPa is also
  the least yield strength of ASTM A240 for 304 and 316.
* 17-4PH H900: modulus and ratio of the data sheet of AK Steel (28.5e6 psi, 0.272); the least yield strength of ASTM
  A564 (170 ksi).
* Inconel 718: elastic constants as for nickel alloy; the least yield strength of AMS 5663 (150 ksi).
* C93200 (SAE 660 bearing bronze): modulus of the Copper Development Association (14,500 ksi); the least yield strength
  of continuous castings of ASTM B505 (20 ksi). Poisson's ratio is a usual value of bronzes.
* PEEK: Victrex 450G, data sheet of the maker, at 23 C.

The yield strengths of other products and tempers differ: give your own in a file of materials (docs/case-files.md).
"""


@explains_keywords
@dataclass(frozen=True, repr=False)
class MaterialPair:
    """The materials of pin and plate, with their composite constants.

    Parameters
    ----------
    pin, plate : Material
        At most one of the two is rigid. The plate may be a :class:`fastpin.model.Laminate`.
    plane : {"strain", "stress"}
        A laminate is in plane stress whatever the `plane`, which is then that of the pin.

    Raises
    ------
    InputError
        If both bodies are rigid, their moduli differ by more than :data:`MOST_RATIO`, or `plane` is unknown.
    """

    pin: Material
    plate: Material
    plane: Plane = "strain"

    def __post_init__(self) -> None:
        check_fields(self, choice, "plane", PLANES)
        for field, body in (("pin", self.pin), ("plate", self.plate)):
            instance(field, body, Material, 'a Material, such as MATERIALS["steel"]')
        if not self.pin.is_isotropic:
            raise InputError("pin", "must be isotropic: a laminate can only be the material of the plate")
        if self.pin.is_rigid and self.plate.is_rigid:
            raise InputError("plate", "pin and plate can't both be rigid")
        check_moduli("plate", "pin and plate", self.pin, self.plate)

    def __repr__(self) -> str:
        return f"{self.pin.elastic_form} in {self.plate.elastic_form}, plane {self.plane}"

    @classmethod
    @explains_keywords
    def from_dundurs(
        cls,
        alpha: float,
        beta: float,
        nu_pin: float,
        plane: Plane = "strain",
        convention: Convention = "usual",
        beta_star: float = 1.0,
    ) -> MaterialPair:
        """A pair with given Dundurs parameters.

        The two parameters do not determine the frictional problem, for 1/(G_I beta_star) enters too. So the pin's
        Poisson ratio and the plane state are needed.

        Parameters
        ----------
        alpha, beta : float
            Dundurs' parameters in the given sign `convention` (see the module's docstring).
        nu_pin : float
            Poisson's ratio of the pin.
        beta_star : float
            Composite compliance (32) of the pair, 1/Pa. It only sets the scale of the moduli.

        Raises
        ------
        InputError
            If a value is out of range, or no plate with 0 <= nu <= 0.5 gives these parameters.
        """
        choice("convention", convention, ("usual", "paper"))
        choice("plane", plane, PLANES)
        sign = 1.0 if convention == "usual" else -1.0
        a = sign * number("alpha", alpha, -1.0, 1.0)
        b = sign * number("beta", beta)
        scale = number("beta_star", beta_star, LEAST_BETA_STAR, MOST_BETA_STAR)
        nu_pin = number("nu_pin", nu_pin, 0.0, 0.5)
        k_pin = Material(1.0, nu_pin).kolosov(plane)
        inverse_g_pin = (1.0 - a) * scale / (k_pin + 1.0)
        plus = (1.0 + a) * scale  # (k + 1)/G of the plate
        minus = 2.0 * b * scale + (k_pin - 1.0) * inverse_g_pin  # (k - 1)/G of the plate
        inverse_g = 0.5 * (plus - minus)
        pin = Material.rigid() if a == 1.0 else _from_compliance(inverse_g_pin, nu_pin)
        if a == -1.0:
            if abs(minus) > 1e-12 * scale:
                needed = -sign * 0.5 * (k_pin - 1.0) * inverse_g_pin / scale
                raise InputError("beta", f"a rigid plate (alpha {sign * a:g}) requires beta = {needed:.6g}")
            return cls(pin, Material.rigid(), plane)
        nu = -1.0
        if inverse_g > 0.0:
            kolosov = plus / inverse_g - 1.0
            nu = (3.0 - kolosov) / 4.0 if plane == "strain" else (3.0 - kolosov) / (1.0 + kolosov)
        if not -1e-12 <= nu <= 0.5 + 1e-12:
            raise InputError(
                "beta", f"no plate with Poisson's ratio in [0, 0.5] gives alpha {sign * a:g}, beta {sign * b:g}"
            )
        return cls(pin, _from_compliance(inverse_g, min(max(nu, 0.0), 0.5)), plane)

    def scaled(self, beta_star: float) -> MaterialPair:
        """The same pair with both moduli scaled. Its composite compliance is then `beta_star`, 1/Pa.

        Fatigue constants and yield strengths are left out, because the scaled materials are others.

        A `beta_star` beyond :data:`LEAST_BETA_STAR` and :data:`MOST_BETA_STAR` raises :class:`InputError`.
        """
        factor = self.beta_star / number("beta_star", beta_star, LEAST_BETA_STAR, MOST_BETA_STAR)
        return MaterialPair(self.pin.scaled(factor), self.plate.scaled(factor), self.plane)

    @cached_property
    def dimensionless(self) -> MaterialPair:
        """The pair scaled to a composite compliance of 1."""
        return self.scaled(1.0)

    @property
    def pin_compliance(self) -> float:
        """1/G_I, 1/Pa; 0 for a rigid pin."""
        return 1.0 / self.pin.shear_modulus

    @property
    def plate_compliance(self) -> float:
        """1/G, 1/Pa; 0 for a rigid plate."""
        return 1.0 / self.plate.shear_modulus

    @property
    def pin_kolosov(self) -> float:
        """Kolosov's constant of the pin, kappa_I."""
        return self.pin.kolosov(self.plane)

    @property
    def plate_kolosov(self) -> float:
        """Kolosov's constant of the plate, kappa."""
        return self.plate.kolosov(self.plane)

    @property
    def alpha_star(self) -> float:
        """Composite constant alpha* of Eq. (32), 1/Pa."""
        return (self.plate_kolosov - 1.0) * self.plate_compliance - (self.pin_kolosov - 1.0) * self.pin_compliance

    @cached_property
    def beta_star(self) -> float:
        """Composite compliance beta* of Eq. (32), 1/Pa."""
        plate = (self.plate_kolosov + 1.0) * self.plate_compliance
        return 0.5 * (plate + (self.pin_kolosov + 1.0) * self.pin_compliance)

    @property
    def gamma(self) -> float:
        """Constant gamma of Eq. (39), for a centre load, 1/Pa."""
        return self.beta_star + 0.5 * self.alpha_star - 2.0 * self.pin_compliance

    @property
    def gamma_prime(self) -> float:
        """Constant gamma' of Eq. (39), for a centre load, 1/Pa."""
        return self.beta_star + 0.5 * self.alpha_star + 2.0 * self.pin_compliance

    @property
    def gamma_body(self) -> float:
        """Constant gamma_B of Eq. (56), for a body load, 1/Pa."""
        return self.beta_star + 0.5 * self.alpha_star - self.pin_compliance

    @property
    def gamma_body_prime(self) -> float:
        """Constant gamma'_B of Eq. (56), for a body load, 1/Pa."""
        return self.beta_star + 0.5 * self.alpha_star + self.pin_compliance

    def dundurs(self, convention: Convention = "usual") -> tuple[float, float]:
        """Dundurs' parameters (alpha, beta) in the given sign convention (see the module's docstring)."""
        sign = 1.0 if choice("convention", convention, ("usual", "paper")) == "usual" else -1.0
        plate = (self.plate_kolosov + 1.0) * self.plate_compliance
        pin = (self.pin_kolosov + 1.0) * self.pin_compliance
        return sign * (plate - pin) / (plate + pin), sign * 0.5 * self.alpha_star / self.beta_star


def check_moduli(field: str, names: str, first: Material, second: Material) -> None:
    """Check that the moduli of two bodies in contact differ by at most :data:`MOST_RATIO`, unless one is rigid.

    `names` are the two bodies in the message. :class:`InputError` is raised with this `field`.
    """
    moduli = sorted((first.E, second.E))
    if math.isfinite(moduli[1]) and moduli[1] > MOST_RATIO * moduli[0]:
        allowed = f"must not differ by more than a factor {MOST_RATIO:g}; such a stiff body is rigid"
        raise InputError(field, f"the moduli of {names} {allowed}, not {moduli[0]:g} and {moduli[1]:g}")


def _from_compliance(inverse_g: float, nu: float) -> Material:
    return Material(2.0 * (1.0 + nu) / inverse_g, nu)
