"""Laminates: the material of an anisotropic plate in plane stress, and its constants at the edge of a round hole.

At the edge of a round hole a symmetric tensor Lambda and a number s hold the whole elastic response, docs/theory.md
(T49). The contact is that of an isotropic plate with the same lambda0 = tr Lambda / 2 and s, and of one term with the
rest of Lambda, the number delta.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, ClassVar

import numpy as np

from fastpin.errors import InputError
from fastpin.model.angles import degrees_at, from_bottom
from fastpin.model.checks import (
    check_fields,
    instance,
    number,
    number_array,
    positive,
    set_fields,
    string,
    triples,
    whole_number,
)
from fastpin.model.layup import (
    Stack,
    checked_angles,
    checked_stack,
    layup_text,
    ply_strains,
    ply_stresses,
    stress_turn,
    whole_compliance,
)
from fastpin.model.materials import Material, Plane
from fastpin.model.ply import LEAST_MODULUS, MOST_MODULUS, PLIES, Ply, checked_modulus, checked_ratio, ply_from
from fastpin.model.synonyms import explains_keywords

ALONG_LOAD = -0.5 * math.pi
"""The axis of a laminate unless it is given: the direction of the load P, rad."""

ROUND = 1e-12
"""Parts of lambda0, and of the sum and the product of the roots, that are rounding: the response is isotropic."""

MODULI = ("E1", "E2", "G12", "nu12")
"""Names of the moduli of the whole and of Poisson's ratio, in their order."""

LAMINATE_KEYS = ("layup", "ply", *MODULI, "compliance", "axis")
"""Keys of a laminate in [plate] of a case file, beside those of an isotropic material."""

ORDER = ("a11", "a12", "a22", "a16", "a26", "a66")
"""Names of the compliances, in their order."""


@explains_keywords
@dataclass(frozen=True, repr=False, kw_only=True)
class Laminate(Material):
    """A symmetric laminate in plane stress, as the material of a plate.

    The membrane response alone matters: (e_x, e_y, g_xy) = a (s_x, s_y, s_xy) with the compliances a of the whole, and
    stresses as means through the thickness. There is no bending and no delamination.

    Parameters
    ----------
    compliance : sequence of 6 floats
        a11, a12, a22, a16, a26 and a66, 1/Pa, in the axes of the laminate. They may be left out if `plies` are given.
    plies : sequence of (Ply, float), optional
        The whole stack from the lowest ply to the uppermost: each ply with the angle of its fibres, deg, from axis 1
        of the laminate, counter-clockwise. See :meth:`from_layup` for a shorter notation.
    axis : float
        Direction of axis 1 of the laminate, rad from +x. The default is the direction of the load P.
    name : str, optional
        Name in tables and plots.

    Attributes
    ----------
    E, nu : float
        Constants of the isotropic plate with the same lambda0 and s, in plane stress: Pa, and -1 to 1. The contact is
        that of such a plate if `delta` is 0. The stresses away from the edge are others.

    Raises
    ------
    InputError
        If a value is no number or beyond its limits, the compliances are not positive definite or not those of the
        plies, or the stack bends when it is stretched: it is not symmetric.
    """

    is_isotropic: ClassVar[bool] = False

    E: float = field(init=False)
    nu: float = field(init=False)
    compliance: tuple[float, ...] = ()
    axis: float = ALONG_LOAD
    plies: Stack = ()

    def __post_init__(self) -> None:
        if not isinstance(self.plies, tuple) or self.plies:
            set_fields(self, plies=checked_stack("plies", self.plies))
            known = whole_compliance(self.plies)
            if not isinstance(self.compliance, tuple) or self.compliance:
                given = number_array("compliance", self.compliance)
                size = 1e-9 * max(map(abs, known))  # a smaller difference is rounding
                if given.shape != (len(ORDER),) or not np.all(np.abs(given - known) <= size):
                    raise InputError("compliance", "must be left out or be that of the plies, if these are given")
            set_fields(self, compliance=known)
        values = number_array("compliance", self.compliance)
        if values.shape != (len(ORDER),):
            raise InputError("compliance", f"must be six numbers, {', '.join(ORDER)}, or be left out with plies")
        # Limits of moduli in Pa are limits of compliances in 1/Pa, too.
        compliance = tuple(number("compliance", value, -MOST_MODULUS, MOST_MODULUS) for value in values.tolist())
        for place in (0, 2, 5):
            if compliance[place] <= 0.0:
                raise InputError("compliance", f"{ORDER[place]} must be positive, not {compliance[place]:g}")
            number("compliance", compliance[place], LEAST_MODULUS, MOST_MODULUS)
        set_fields(self, compliance=compliance)
        check_fields(self, number, "axis")
        check_fields(self, string, "name")
        own = _matrix(compliance)
        scale = 1.0 / np.sqrt(np.diag(own))
        if np.linalg.eigvalsh(own * np.outer(scale, scale))[0] < 1e-9:  # a smaller one is rounding
            raise InputError("compliance", "must be positive definite: no stable material has these values")
        lambda0, s = self.lambda0, self.s
        set_fields(self, E=2.0 / lambda0, nu=1.0 - 2.0 * s / lambda0)
        for name in ("fatigue", "yield_strength", "ultimate_strength", "growth", "expansion"):
            if getattr(self, name) is not None:
                raise InputError(name, "has no meaning for a laminate")

    @classmethod
    @explains_keywords
    def from_layup(
        cls, layup: str | Sequence[float], ply: Ply | str, axis: float = ALONG_LOAD, name: str = ""
    ) -> Laminate:
        """A laminate of equal plies.

        Parameters
        ----------
        layup : str or sequence of float
            The angles of all plies, deg, as a text such as "[0/45/-45/90]2s" or one by one, see
            :mod:`fastpin.model.layup`.
        ply : Ply or str
            The ply, or its name in :data:`fastpin.model.PLIES`.
        axis, name
            See :class:`Laminate`.

        Raises
        ------
        InputError
            If the layup or the ply can't be used, or the stack is not symmetric.
        """
        angles = checked_angles("layup", layup)
        each = PLIES[ply] if isinstance(ply, str) else instance("ply", ply, Ply, "a fastpin.model.Ply or its name")
        try:
            return cls(plies=tuple((each, angle) for angle in angles), axis=axis, name=name)
        except InputError as error:
            raise InputError("layup" if error.field == "plies" else error.field, error.reason) from None

    @classmethod
    @explains_keywords
    def from_plies(cls, plies: Iterable[tuple[Ply, float]], axis: float = ALONG_LOAD, name: str = "") -> Laminate:
        """A laminate of any plies.

        Parameters
        ----------
        plies : iterable of (Ply, float)
            Each ply with its angle, deg, from the lowest to the uppermost.
        axis, name
            See :class:`Laminate`.

        Raises
        ------
        InputError
            If there is no ply, one can't be used, or the stack is not symmetric.
        """
        return cls(plies=checked_stack("plies", plies), axis=axis, name=name)

    @classmethod
    @explains_keywords
    def from_moduli(
        cls, E1: float, E2: float, G12: float, nu12: float, axis: float = ALONG_LOAD, name: str = ""
    ) -> Laminate:
        """A laminate with given moduli of the whole, orthotropic in its axes.

        Parameters
        ----------
        E1, E2, G12 : float
            Young's moduli along axis 1 and axis 2, and the shear modulus, Pa.
        nu12 : float
            Poisson's ratio of a stress along axis 1.
        axis, name
            See :class:`Laminate`.

        Raises
        ------
        InputError
            If a modulus is not positive, or no stable material has these constants.
        """
        first, second, shear = checked_modulus("E1", E1), checked_modulus("E2", E2), checked_modulus("G12", G12)
        ratio = checked_ratio(first, second, nu12)
        return cls(compliance=(1 / first, -ratio / first, 1 / second, 0.0, 0.0, 1 / shear), axis=axis, name=name)

    @property
    def elastic_form(self) -> str:
        name = f"{self.name!r}, " if self.name else ""
        name += f"{self.layup} of {self.ply_names}, " if self.plies else ""
        moduli = ", ".join(f"{field}={value:g}" for field, value in self.shown_moduli.items())
        return f"Laminate({name}{moduli}, axis={self.axis:g})"

    def scaled(self, factor: float) -> Laminate:
        """The same laminate with all moduli times `factor`. The strengths of its plies are then unknown.

        A `factor` that is not positive raises InputError.
        """
        softer = 1.0 / positive("factor", factor)
        if self.plies:
            scaled = {ply: ply.scaled(factor) for ply in dict.fromkeys(ply for ply, _ in self.plies)}
            plies = tuple((scaled[ply], angle) for ply, angle in self.plies)
            return Laminate(plies=plies, axis=self.axis, name=self.name)
        return Laminate(compliance=tuple(softer * value for value in self.compliance), axis=self.axis, name=self.name)

    def turned(self, angle: float) -> Laminate:
        """The same laminate, turned counter-clockwise by `angle`, rad. No finite number raises InputError."""
        return replace(self, axis=self.axis + number("angle", angle))

    def kolosov(self, plane: Plane) -> float:
        """Kolosov's constant of the isotropic plate with the same lambda0 and s: in plane stress, for any `plane`."""
        return (self.lambda0 + self.s) / (self.lambda0 - self.s)

    @property
    def shear_modulus(self) -> float:
        """G of the isotropic plate with the same lambda0 and s, Pa."""
        return 0.5 / (self.lambda0 - self.s)

    @property
    def moduli(self) -> tuple[float, float, float, float]:
        """E1, E2 and G12 of the whole, Pa, and nu12, in the axes of the laminate."""
        a11, a12, a22, _, _, a66 = self.compliance
        return 1.0 / a11, 1.0 / a22, 1.0 / a66, -a12 / a11

    @property
    def label(self) -> str:
        """The name, the layup and the names of the plies, as far as they are known; else "laminate"."""
        layup = f"{self.layup} of {self.ply_names}" if self.plies else "laminate"
        return f"{self.name}, {layup}" if self.name else layup

    @property
    def shown_moduli(self) -> dict[str, float]:
        """E1, E2 and G12 of the whole, Pa, and nu12, by name."""
        return dict(zip(MODULI, self.moduli, strict=True))

    @property
    def direction_words(self) -> str:
        """The direction of axis 1, deg from the bottom of the hole: 0 lies along the load P."""
        return f"axis 1 at {from_bottom(self.axis):.4g} deg from the bottom"

    def constants(self) -> dict[str, Any]:
        """The axis, and the compliances or the plies without their names: all that stresses depend on."""
        return self._described(lambda ply: ply.constants())

    def entries(self) -> dict[str, Any]:
        """The laminate as a JSON-ready dict. :func:`laminate_from` reads it back.

        Different plies are listed once, under `plies`. The stack has the places of its plies in this list under
        `which`, and their angles, deg, under `angles`.
        """
        return {"name": self.name, **self._described(lambda ply: ply.entries())}

    def _described(self, entries: Callable[[Ply], dict[str, Any]]) -> dict[str, Any]:
        if not self.plies:
            return {"axis": self.axis, "compliance": list(self.compliance)}
        known = list(dict.fromkeys(ply for ply, _ in self.plies))
        return {
            "axis": self.axis,
            "angles": [angle for _, angle in self.plies],
            "which": [known.index(ply) for ply, _ in self.plies],
            "plies": [entries(ply) for ply in known],
        }

    def summary(self) -> dict[str, Any]:
        """The entry `laminate` of the JSON of a result. The axis is in deg from the bottom of the hole."""
        given = {"layup": None, "ply": None, **self.toml()}
        return {
            "laminate": {
                "layup": given["layup"],
                "ply": given["ply"],
                "axis": given["axis"],
                "moduli": self.shown_moduli,
                "compliance": list(self.compliance),
                "is_isotropic_contact": self.is_isotropic_contact,
            }
        }

    def toml(self) -> dict[str, Any]:
        """The keys and values of [plate] in a case file: a layup with its plies, or the compliances, and the axis."""
        axis = {"axis": degrees_at(self.axis)}
        if not self.plies:
            return {"compliance": list(self.compliance), **axis}
        each = [ply for ply, _ in self.plies]
        are_named = all(PLIES.get(ply.name) == ply for ply in each)
        plies = [ply.name if are_named else ply.entries() for ply in each]
        return {"layup": self.layup, "ply": plies if len(set(each)) > 1 else plies[0], **axis}

    @property
    def layup(self) -> str:
        """The angles of the plies as a text, such as "[0/45/-45/90]2s"; empty without plies."""
        return layup_text([angle for _, angle in self.plies]) if self.plies else ""

    @property
    def ply_names(self) -> str:
        """The names of the plies, each one once; "plies" stands for plies without a name."""
        return ", ".join(dict.fromkeys(ply.name or "plies" for ply, _ in self.plies))

    @property
    def thickness(self) -> float:
        """Thickness of the stack, m; NaN without plies."""
        return sum(ply.thickness for ply, _ in self.plies) if self.plies else math.nan

    def ply_strains(self, stress: Any) -> np.ndarray:
        """The strains of all plies in their own axes, from the stress of the whole: see :meth:`ply_stresses`."""
        return ply_strains(self._stack(), self._own_strain(stress))

    def ply_stresses(self, stress: Any) -> np.ndarray:
        """The stresses of all plies in their own axes, from the stress of the whole.

        Parameters
        ----------
        stress : array, shape (..., 3)
            (s_x, s_y, s_xy) of the whole, Pa: means through the thickness.

        Returns
        -------
        array, shape (plies, ..., 3)
            (s_1, s_2, t_12) along and across the fibres of each ply, Pa.

        Raises
        ------
        InputError
            If the laminate has no plies, or `stress` is of another shape.
        """
        return ply_stresses(self._stack(), self._own_strain(stress))

    def _stack(self) -> Stack:
        if not self.plies:
            raise InputError("plies", "are unknown: the laminate was given by its compliances or moduli")
        return self.plies

    def _own_strain(self, stress: Any) -> np.ndarray:
        """The strains of the whole in its own axes, shape (..., 3)."""
        own: np.ndarray = triples("stress", stress) @ stress_turn(self.axis).T @ _matrix(self.compliance)
        return own

    @cached_property
    def matrix(self) -> np.ndarray:
        """Compliances a of the whole in x and y, 1/Pa, shape (3, 3): strains (e_x, e_y, g_xy) per stress."""
        return in_axes(_matrix(self.compliance), -self.axis)

    @cached_property
    def roots(self) -> tuple[complex, complex]:
        """The roots mu1 and mu2, with positive imaginary parts, of Lekhnitskii's equation in x and y."""
        return stroh_roots(self.matrix)

    @property
    def is_quasi_isotropic(self) -> bool:
        """Whether the membrane response is that of an isotropic plate: both roots are i."""
        one, two = self.roots
        return max(abs(one + two - 2j), abs(one * two + 1.0)) < ROUND

    @cached_property
    def _edge(self) -> tuple[np.ndarray, float]:
        """Lambda in the axes of the laminate, and s, (T50)."""
        own = _matrix(self.compliance)
        one, two = stroh_roots(own)
        a11, a12, a22 = own[0, 0], own[0, 1], own[1, 1]
        across = a11 * (one * two).imag
        tensor = np.array([[a11 * (one + two).imag, across], [across, -a22 * (1.0 / one + 1.0 / two).imag]])
        return tensor, a12 - a11 * (one * two).real

    @property
    def lambda0(self) -> float:
        """Half the trace of Lambda, 1/Pa: (kappa + 1)/4G of an isotropic plate."""
        return 0.5 * float(np.trace(self._edge[0]))

    @property
    def s(self) -> float:
        """The number s, 1/Pa: (kappa - 1)/4G of an isotropic plate."""
        return float(self._edge[1])

    @cached_property
    def delta(self) -> complex:
        """The rest of Lambda, 1/Pa: (Lambda_xx - Lambda_yy)/2 + i Lambda_xy; 0 for an isotropic plate.

        It turns with the laminate: half its argument is the direction of the larger eigenvalue of Lambda.
        """
        tensor = self._edge[0]
        own = complex(0.5 * (tensor[0, 0] - tensor[1, 1]), tensor[0, 1])
        return 0j if abs(own) <= ROUND * self.lambda0 else own * cmath.exp(2j * self.axis)

    @property
    def is_isotropic_contact(self) -> bool:
        """Whether the contact is that of an isotropic plate for all directions of the load."""
        return self.delta == 0.0

    @cached_property
    def edge_tensor(self) -> np.ndarray:
        """Lambda in x and y, 1/Pa, shape (2, 2)."""
        return self.lambda0 * np.eye(2) + np.array(
            [[self.delta.real, self.delta.imag], [self.delta.imag, -self.delta.real]]
        )

    @cached_property
    def gauge_tensor(self) -> np.ndarray:
        """The tensor H of (T57) in x and y, 1/Pa, shape (2, 2).

        A force F on the hole moves the mean of the hole over that of a circle r in the plate by H F ln(r/R)/(2 pi).
        """
        tensor = self.edge_tensor
        return tensor * (1.0 - self.s**2 / float(np.linalg.det(tensor)))

    def hole_displacement(self, remote: Any) -> tuple[complex, complex]:
        """The coefficients c0 and c2 of v/R = c0 + c2 exp(-2i theta) at the hole under a remote stress, (T53).

        v = v_r + i v_theta is the displacement of the edge relative to the far plate, which does not turn. `remote` is
        (sxx, syy, sxy), shape (3,), Pa; anything else raises InputError.
        """
        values = triples("remote", remote)
        if values.shape != (3,):
            raise InputError("remote", f"must have the shape (3,), not {values.shape}")
        sxx, syy, sxy = values.tolist()
        e_xx, e_yy, g_xy = self.matrix @ np.array([sxx, syy, sxy])
        strain, stress = (np.array([[a, b], [b, c]]) for a, b, c in ((e_xx, 0.5 * g_xy, e_yy), (sxx, sxy, syy)))
        turn = np.array([[0.0, -1.0], [1.0, 0.0]])
        w = strain + self.edge_tensor @ stress + self.s * turn @ stress @ turn
        mean = 0.5 * complex(w[0, 0] + w[1, 1], w[1, 0] - w[0, 1])
        return mean, 0.5 * complex(w[0, 0] - w[1, 1], w[1, 0] + w[0, 1])


def laminate_from(**given: Any) -> Laminate:
    """Return the laminate of such entries, see :meth:`Laminate.entries`.

    Raises
    ------
    InputError
        If an entry can't be used.
    """
    if "plies" not in given:
        return Laminate(**given)
    known, which, angles = (given.pop(name) for name in ("plies", "which", "angles"))
    plies = [ply_from(**each) for each in known]
    places = [whole_number("which", place, 0, len(plies) - 1) for place in which]
    return Laminate.from_plies([(plies[place], angle) for place, angle in zip(places, angles, strict=True)], **given)


def _matrix(values: tuple[float, ...]) -> np.ndarray:
    """The compliance matrix (3, 3) of a11, a12, a22, a16, a26 and a66."""
    a11, a12, a22, a16, a26, a66 = values
    return np.array([[a11, a12, a16], [a12, a22, a26], [a16, a26, a66]])


def in_axes(compliance: np.ndarray, angle: np.ndarray | float) -> np.ndarray:
    """A compliance matrix (..., 3, 3) in axes that are turned counter-clockwise by `angle` (...), rad.

    The shear strain is the engineering one.
    """
    back = stress_turn(-np.asarray(angle))  # stresses in the old axes from those in the new ones
    turned: np.ndarray = np.swapaxes(back, -1, -2) @ compliance @ back
    return turned


def stroh_roots(compliance: np.ndarray) -> tuple[complex, complex]:
    """The roots with positive imaginary parts of a11 m^4 - 2 a16 m^3 + (2 a12 + a66) m^2 - 2 a26 m + a22 = 0.

    `compliance` is the matrix of (e_x, e_y, g_xy), shape (3, 3).
    """
    (a11, a12, a16), (_, a22, a26), (_, _, a66) = compliance
    upper = [root for root in np.roots([a11, -2.0 * a16, 2.0 * a12 + a66, -2.0 * a26, a22]) if root.imag > 0.0]
    one, two = sorted(upper, key=lambda root: (root.imag, root.real))
    return complex(one), complex(two)
