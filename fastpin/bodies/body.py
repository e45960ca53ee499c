"""What every body answers: checks, the response to tractions and loads, stresses, words, files, drawing, controls.

A body says its shape and how its load enters or leaves it. The materials stand in the problem's pair. Lengths are in m,
or in units of R for a dimensionless problem. docs/bodies.md explains the choices. The answers here are those of a body
without the feature that is asked for. A body is a file of this folder; :mod:`fastpin.bodies.kinds` lists them. Only
the package asks: users have the fields of a body.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from typing import Any, ClassVar, Literal, NamedTuple, Self

import numpy as np

from fastpin.bodies import harmonics
from fastpin.bodies.harmonics import FREE, HELD, First
from fastpin.bodies.walls import Amplitudes, Displacements, Other, PlateWalls, Wall, first_amplitudes
from fastpin.errors import InputError
from fastpin.model.checks import given_fields, is_between
from fastpin.model.laminate import Laminate
from fastpin.model.materials import Material, MaterialPair, Plane

PinLoad = Literal["centre", "body"]
"""Kinds of load of a solid pin."""

THINNEST = 0.04
"""Least wall of a tube or ring, in parts of its larger radius. A thinner wall is a shell: it bends 10,000 times as much
as its surface yields, and contacts are lost between the nodes."""

WIDEST = 1e6
"""Largest outer radius, in parts of the hole radius. A larger body is an infinite plate."""

Harmonics = Callable[[int], np.ndarray]
"""Harmonics (t_n, conj t_-n) of t = s_rr + i s_rtheta on the contact rim up to an order N, shape (N + 1, 2)."""

InWords = Callable[[Any], str]
"""The text of a value: a length with its unit, or a material."""

Remote = Sequence[float]
"""A remote stress (sxx, syy, sxy), or the own loads of a compliance, and a rise of the temperature."""

Projected = Callable[[np.ndarray], np.ndarray]
"""The coefficients of the tractions, Pa, in the basis of a matrix of a compliance."""

Table = Any
"""The section of a body in a case file: a :class:`fastpin.casefile.bodies.BodySection`."""


class Rim(NamedTuple):
    """A rim, and the material of the body behind it.

    `hole` is the radius R of the pin's hole, m. `ratio` is the radius of the rim over R: 1 at the contact, and more at
    the seat of a bush.
    """

    hole: float
    ratio: float
    material: Material
    plane: Plane

    @property
    def radius(self) -> float:
        """Radius of the rim, m."""
        return self.hole * self.ratio

    @property
    def kolosov(self) -> float:
        """Kolosov's constant of the material."""
        return self.material.kolosov(self.plane)

    @property
    def compliance(self) -> float:
        """1/G of the material, 1/Pa; 0 if it is rigid."""
        return 1.0 / self.material.shear_modulus

    @property
    def laminate(self) -> Laminate | None:
        """The material if it is a laminate; else None."""
        return self.material if isinstance(self.material, Laminate) else None


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

    def radial(self, radius: float) -> float:
        """s_rr at a radius."""
        return self.mean + self.decaying / radius**2

    def von_mises(self, radius: float, nu: float, plane: Plane) -> float:
        """The von Mises stress at a radius."""
        one, other = self.radial(radius), self.mean - self.decaying / radius**2
        third = nu * (one + other) if plane == "strain" else 0.0
        return math.sqrt(0.5 * ((one - other) ** 2 + (other - third) ** 2 + (third - one) ** 2))


class Shape(NamedTuple):
    """A part of the drawing of a body: a filled circle, square or outline, or strokes round a rim.

    `kind` is "circle", "square", "outline", "strokes" or "leaning strokes". `size` is the radius, or half the side,
    over R, and of an outline that of its hole. `part` tells the colours: "lug", "bush" or "bore". An outline has its
    `plate`, a :class:`fastpin.lugs.Lug`.
    """

    kind: str
    size: float
    part: str
    plate: Any = None


MOST_DRY = 1.2
"""Right end of the sliders of friction: dry metals hardly have more. The field beside a slider takes any friction."""


class Control(NamedTuple):
    """A control of the live page: a slider from `least` to `most`, a chooser among `choices`, or those of a material.

    `kind` is the kind of the unit of a slider, a key of ``units``; "" for a chooser.
    """

    name: str
    value: Any
    kind: str = ""
    least: float = 0.0
    most: float = 0.0
    choices: tuple[str, ...] = ()


@dataclass(frozen=True)
class BodyBase:
    """A pin or a plate.

    Attributes
    ----------
    kind : str
        The name of the class in files.
    keys : dict of str to str
        The keys of its section in case files, each with the kind of its number, a key of ``units``; "" without a unit.
    arrays, named_arrays, texts : tuple of str
        The fields that are arrays, arrays by name, and long texts.
    controlled : tuple of str
        The names of its controls on the live page. Those of a material are not among them.
    """

    kind: ClassVar[str]
    keys: ClassVar[Mapping[str, str]] = {}
    arrays: ClassVar[tuple[str, ...]] = ()
    named_arrays: ClassVar[tuple[str, ...]] = ()
    texts: ClassVar[tuple[str, ...]] = ()
    controlled: ClassVar[tuple[str, ...]] = ()

    @classmethod
    def read(cls, table: Table) -> Self | None:
        """Read the body from its section of a case file. None if it is wrong; all faults are reported."""
        return cls()

    def toml(self) -> dict[str, Any]:
        """The keys and values of its section in a case file. Without any, the section is left out."""
        return given_fields(self)

    def entries(self) -> dict[str, Any]:
        """The kind, and the fields by name, as HDF5 files hold them: texts in bytes. A body inside has its own."""
        values = {each.name: getattr(self, each.name) for each in fields(self)}
        inner = {name: value.entries() if isinstance(value, BodyBase) else value for name, value in values.items()}
        inner |= {name: values[name].encode() or None for name in self.texts}
        return {"kind": self.kind, **inner}

    @classmethod
    def from_entries(cls, entries: Mapping[str, Any]) -> Self:
        """The body of :meth:`entries`, without the kind."""
        return cls(**entries)

    def as_json(self, material: Callable[[Material], Any]) -> dict[str, Any]:
        """The kind, and the fields by name, JSON-ready. `material` turns a material into its entry."""

        def plain(value: Any) -> Any:
            if isinstance(value, dict):
                return {name: plain(each) for name, each in value.items()}
            value = list(value) if isinstance(value, tuple) else value
            return material(value) if isinstance(value, Material) else value

        found: dict[str, Any] = plain(self.entries())
        return found

    def summary(self) -> dict[str, Any]:
        """Entries of its summary that :meth:`as_json` lacks."""
        return {}

    def rows(self, length: InWords, material: InWords) -> list[tuple[str, str]]:
        """Rows (subject, text) that describe it. None describe a solid pin and an infinite plate."""
        return []

    def drawing(self, rim: Rim) -> list[Shape]:
        """The shapes that show it, the largest first. A pin has no shape for its outline."""
        return []


class PinBody(BodyBase):
    """A pin. Its answers take the rim of the pin and the load of a solid pin. Those here are of a solid pin.

    Attributes
    ----------
    bore_radius : float
        Radius of the bore, m; 0 of a solid pin.
    load : str
        How the load enters at the bore; "" for a solid pin, whose load is one of :data:`PinLoad`.
    is_bush : bool
        Whether it is a bush in its seat, a part of a joint whose pin loads its bore.
    """

    is_bush: ClassVar[bool] = False

    bore_radius: float
    load: str = ""

    @property
    def bore_kind(self) -> str:
        """Whether the bore is held."""
        return HELD if self.load == "held" else FREE

    def check(self, radius: float) -> None:
        """Raise :class:`InputError` if the body does not fit into a hole of this radius, m."""

    def check_load(self, pin_load: PinLoad) -> None:
        """Raise :class:`InputError` if a load of solid pins can't act on the body."""

    def check_hub(self, radius: float) -> None:
        """Raise :class:`InputError` if the body has no hub of this radius, m."""

    def inner(self, rim: Rim) -> float:
        """Radius of the bore over that of the pin."""
        return self.bore_radius / rim.radius

    def highest(self, rim: Rim) -> int:
        """The highest harmonic that matters."""
        return harmonics.harmonics_needed(self.inner(rim))

    def uniform(self, rim: Rim) -> float:
        """Compliance c(0) under pressure, in units of 1/2G."""
        return harmonics.uniform(self.inner(rim), rim.kolosov, self.bore_kind)

    def first(self, rim: Rim, pin_load: PinLoad) -> First:
        """The first harmonic."""
        return harmonics.first(self.inner(rim), rim.kolosov, self.load or pin_load)

    def change(self, rim: Rim, order: np.ndarray) -> np.ndarray:
        """a, b, d minus the values of a disk, in 1/Pa, shape (3, m), for the harmonics `order` >= 2; (T38)."""
        return np.zeros((3, order.size))

    def wall(self, rim: Rim, tractions: Harmonics) -> Wall | None:
        """The field of stress beyond that of a solid pin under a force at its centre; None for a solid pin."""
        return None

    def translation(self, rim: Rim, pin_load: PinLoad, hub: float | None) -> tuple[float, float]:
        """The pin's part of the compliances g and k of (T29), in 1/(4 pi G), for a hub of radius `hub` R."""
        kolosov, compliance = rim.kolosov, rim.compliance
        if pin_load == "body":
            return 0.5 * compliance, 0.5 * compliance
        part = 1.0 / math.sqrt(kolosov + 1.0) if hub is None else hub
        coupling = (1.0 - part**2) * compliance
        own = 2.0 * (1.0 - part**2 - kolosov * math.log(part)) / (kolosov + 1.0) * compliance
        return own, coupling

    def load_words(self, pin_load: PinLoad) -> str:
        """Words for the way in which its load enters."""
        return {"centre": "force at the centre", "body": "uniform body force"}[pin_load]

    def caption(self, pin_load: PinLoad, length: InWords) -> str:
        """Words for the caption of a figure, which follow those for its material."""
        return {"body": ", body force", "centre": ", force at the centre"}[pin_load]

    def page_controls(self, radius: float) -> list[Control]:
        """The controls of its shape and load on the live page, for a hole of this radius, m."""
        return [Control("pin_bore", self.bore_radius, "length", 0.0, 0.9 * radius)]


class PlateBody(BodyBase):
    """A plate. Its answers take the rim of its own hole. Those here are of a plate that is symmetric about the axis.

    Attributes
    ----------
    title : str
        Its name on the live page; "" if it can't be chosen there.
    is_infinite : bool
        Whether a remote stress has Kirsch's field in it.
    outer_radius : float
        Radius of the outer rim, m; infinite without one. A bush has its own: ask the ``lug`` for the plate's.
    support : str
        The distribution of the force on the outer rim, see :func:`fastpin.bodies.harmonics.first`.
    edge_only : bool
        Whether displacements are known at the edge of the hole only, and stresses up to :attr:`reach`.
    in_joint : bool
        Whether it is a hole of a joint of several pins, which is followed from before all fits.
    """

    title: ClassVar[str] = ""
    is_infinite: ClassVar[bool] = False
    edge_only: ClassVar[bool] = False
    in_joint: ClassVar[bool] = False

    outer_radius: float
    support: str = "uniform"

    @property
    def outer_kind(self) -> str:
        """Whether the outer rim is held."""
        return HELD if self.support == "held" else FREE

    @property
    def near_only(self) -> str:
        """Why the stress is known up to :attr:`reach` only; empty if it is known in the whole body."""
        return ""

    @property
    def reach(self) -> float:
        """Largest radius at which the stress is known all round, in radii of its own hole."""
        return math.inf

    def contains(self, z: np.ndarray) -> np.ndarray:
        """Whether the stress is known at points outside the hole, complex (m,), in radii of its own hole."""
        return np.abs(z) <= self.reach * (1.0 + 1e-14)

    @property
    def rims(self) -> tuple[np.ndarray, list[str]]:
        """Points on the edges of a plate of any outline, in radii of its own hole, and the names of these edges."""
        return np.zeros(0, dtype=complex), []

    def net_section(self, radius: float) -> float:
        """Width W - D that carries the force of the pin beside a hole of this radius, m; infinite if there is none."""
        return 2.0 * (self.outer_radius - radius)

    @property
    def geometry(self) -> Any:
        """Outline, holes, supports and loads of a plate of any outline, :class:`fastpin.lugs.Lug`; None of others."""
        return None

    @property
    def along_edges(self) -> Any:
        """The hoop stress along the edges of a plate of any outline, :class:`fastpin.lugs.EdgeHoop`; None of others."""
        return None

    def looked_at(self, radius: float, length: InWords) -> str:
        """Where alone a largest stress is looked for, in words; empty if everywhere. The hole has this `radius`, m."""
        return ""

    @property
    def other_edges(self) -> Any:
        """The edges beyond the hole as cracks see them, :class:`fastpin.lugs.OtherEdges`; None of other plates."""
        return None

    @property
    def lug(self) -> PlateBody:
        """The body round a bush; the plate itself without one."""
        return self

    @property
    def bush(self) -> Any:
        """The :class:`fastpin.bodies.Bushing` in its hole; None without one."""
        return None

    @property
    def is_symmetric(self) -> bool:
        """Whether it carries a force symmetrically about the axis, so that there are closed forms."""
        return not (self.force_points or self.edge_only or self.support == "half")

    @property
    def force_points(self) -> tuple[complex, ...]:
        """Points x + iy, m, at which forces act: the stress there is infinite."""
        return ()

    # -- checks

    def check(self, radius: float, dimensionless: bool = False, name: str = "hole radius") -> None:
        """Raise :class:`InputError` if the body does not fit round a hole of this radius, m, that is called `name`.

        The interference of a bush is not checked in a `dimensionless` problem: it then counts in units of F beta*.
        """

    def check_pair(self, pair: MaterialPair, radius: float, dimensionless: bool) -> None:
        """Raise :class:`InputError` if the body does not fit to the materials, or to a hole of this radius, m."""

    def without_gauge(self, radius: float) -> str:
        """Why no displacement relative to a gauge circle of this radius, m, is known; empty if it is."""
        return ""

    def check_remote(self, name: str) -> None:
        """Raise :class:`InputError` if the remote stress of this name can't act."""

    def unknown_when_warm(self, pair: MaterialPair) -> str:
        """Why it is not known how the body expands when it gets warm; empty if it is."""
        return ""

    def fitted(self, table: Table, radius: float, dimensionless: bool, pair: MaterialPair | None) -> PlateBody | None:
        """Return the part of the body that fits round the hole, for a case file. Other parts are reported."""
        return self if table.passes(lambda: self.check(radius, dimensionless)) else None

    def contacts(self, pair: MaterialPair, radius: float) -> tuple[dict[str, Any], ...]:
        """The fields that differ at pin and seat of a bush that slips, in a hole of `radius`, m; none without one."""
        return ()

    # -- materials

    def surface(self, pair: MaterialPair) -> MaterialPair:
        """The materials of the two surfaces in contact."""
        return pair

    def without_units(self, pair: MaterialPair) -> tuple[PlateBody, MaterialPair]:
        """The body and the materials, scaled so that beta* of the surfaces is 1."""
        return self, pair.dimensionless

    # -- the response of the rim

    def far(self, rim: Rim) -> float:
        """Radius of the outer rim over that of the hole; infinite without one."""
        return self.outer_radius / rim.radius

    def highest(self, rim: Rim) -> int:
        """The highest harmonic that matters at the contact."""
        return harmonics.harmonics_needed(1.0 / (self.far(rim) * rim.ratio))

    def pressed(self, rim: Rim) -> float:
        """Whole compliance under pressure, 1/Pa; negative, as the hole widens under pressure."""
        return 0.5 * rim.compliance * harmonics.uniform(self.far(rim), rim.kolosov, self.outer_kind)

    def pressed_share(self, rim: Rim) -> float:
        """:meth:`pressed` in units of 1/2G."""
        return self.pressed(rim) / (0.5 * rim.compliance)

    def press_fit(self, rim: Rim) -> tuple[float, float]:
        """Pressure of a press fit, Pa, and displacement of the contact rim by it, m."""
        return 0.0, 0.0

    def first(self, rim: Rim) -> First:
        """The first harmonic, in units of the surface's material."""
        return harmonics.first(self.far(rim), rim.kolosov, self.support)

    def twist(self, rim: Rim) -> float:
        """Rotation of the rim per shear stress, 1/Pa: u_theta/r over s_rtheta, against the far rim."""
        return -0.5 * rim.compliance * (1.0 - self.far(rim) ** -2.0)

    def change(self, rim: Rim, order: np.ndarray) -> np.ndarray:
        """a, b, d minus those of an infinite plate of the surface's material, in 1/Pa, (3, m), `order` >= 2; (T38)."""
        return np.zeros((3, order.size))

    def whole(self, rim: Rim, order: np.ndarray) -> np.ndarray:
        """Whole compliances of the hole, shape (m, 2, 2), 1/Pa, for the harmonics `order` >= 2."""
        return harmonics.hole(order, rim.kolosov, rim.compliance) + 0.5 * harmonics.as_matrices(self.change(rim, order))

    def displacements(self, rim: Rim) -> Displacements:
        """Displacements per unit load, over the radius of the hole: of forces beyond their first harmonic; (T39)."""
        return {}

    def expanded(self, rim: Rim) -> np.ndarray:
        """Fourier coefficients of v_r + i v_theta of the hole over its radius, n = -K to K, per rise of temperature."""
        return np.array([(rim.material.expansion or 0.0) + 0j])

    def load_columns(self, rim: Rim, beta: float) -> Displacements:
        """As ``displacements``, in units of beta*."""
        unit = 1.0 / beta
        return {place: unit * column for place, column in self.displacements(rim).items()}

    def matrix_in(self, rim: Rim, beta: float) -> np.ndarray:
        """The matrix of a compliance, without resultant and translation, in units of beta*; else (0, 0); (T41)."""
        return np.zeros((0, 0))

    def pressed_by_matrix(self, rim: Rim) -> float:
        """The part of twice the compliance under pressure that :meth:`matrix_in` holds, 1/Pa."""
        return 0.0

    def translation(self, rim: Rim, gauge: float | None) -> tuple[float, float]:
        """The plate's part of the compliances g and k of (T29), in 1/(4 pi G), for a gauge of radius `gauge` R.

        The usual gauge is the outer rim, or the edge of the hole without one.
        """
        if gauge is None:
            gauge = self.far(rim) if math.isfinite(self.outer_radius) else 1.0
        if gauge == 1.0:
            return 0.0, 0.0
        of_traction, of_force = self.first(rim).translation(gauge)
        return -of_force * rim.compliance, of_traction * rim.compliance

    def over_gauge(self, moved: complex, rim: Rim, force: complex, gauge: float | None) -> complex:
        """The displacement `moved` of the pin over the hole, m, as one over a gauge of radius `gauge` R.

        It adds the part that :meth:`translation` lacks, of the `force` Q - iP on the pin, N/m.
        """
        return moved

    def over_supports(self, moved: complex, rim: Rim, projected: Projected, load: Mapping[str, float]) -> complex:
        """The displacement `moved` of the pin over the hole, m, as one over the supports."""
        return moved

    # -- stresses

    def assembly_stresses(self, rim: Rim, contact: float, edge: str = "hole") -> dict[str, float]:
        """Von Mises stresses under the pressure `contact`, Pa, and press fits, by edges; a rigid body has none."""
        if rim.material.is_rigid or not rim.material.is_isotropic:
            return {}
        around = Uniform.of_rim(-contact, self.pressed_share(rim), rim.kolosov)
        return {edge: around.von_mises(1.0, rim.material.nu, rim.plane)}

    def seat_pressure(self, rim: Rim, contact: float) -> float:
        """Pressure in the seat of a bush before any load, Pa, under the pressure `contact` at its bore; else 0."""
        return 0.0

    @property
    def without_others(self) -> PlateBody:
        """The plate without what other pins do to its hole in one state of a joint; itself where nothing does."""
        return self

    def with_others(self, columns: np.ndarray) -> np.ndarray:
        """Columns of :func:`fastpin.bodies.compliance.state_columns` for a plate's field: with those of other pins."""
        return columns

    def highest_inside(self, rim: Rim) -> int:
        """The highest harmonic that matters in the plate, up to its outer rim."""
        return harmonics.harmonics_needed(math.sqrt(1.0 / self.far(rim)))

    def walls(self, rim: Rim, tractions: Harmonics, remote: Remote) -> PlateWalls | None:
        """The smooth fields under tractions and a remote stress (sxx, syy, sxy); None for an infinite plate."""
        if not (self.force_points or math.isfinite(self.outer_radius)):
            return None
        return PlateWalls(self.wall(rim, tractions(self.highest_inside(rim)), remote, whole=False), None)

    def wall(self, rim: Rim, t: np.ndarray, remote: Remote, whole: bool) -> Wall:
        """The field under the harmonics `t` on its own hole, beyond the hole in the infinite plate or `whole`.

        The remote stress counts where it is a traction on an outer rim.
        """
        n, found = np.arange(2.0, len(t)), Amplitudes.zero(len(t) - 1)
        known = first_amplitudes(harmonics.first(math.inf, rim.kolosov, "uniform"), t[1])
        found.first[:] = first_amplitudes(self.first(rim), t[1]) - (0.0 if whole else known)
        if whole:
            found.B[2:], found.D[2:] = t[2:, 1] / (1.0 - n), t[2:, 0] / (n + 1.0) - t[2:, 1]
            found.D[0] = t[0, 0]
        others = self.add_fields(rim, t, remote, found)
        return found.wall(rim.kolosov, 1.0, self.far(rim) if math.isfinite(self.outer_radius) else 1.0, others)

    def add_fields(self, rim: Rim, t: np.ndarray, remote: Remote, amplitudes: Amplitudes) -> tuple[Other, ...]:
        """Add the harmonics other than the first, beyond the infinite plate, and return fields in closed form."""
        return ()

    def add_edge_hoop(self, hoop: np.ndarray, rim: Rim, tractions: Harmonics, remote: Remote, at: np.ndarray) -> None:
        """Add the hoop stress on the edge of the hole beyond the infinite plate at the angles `at`, shape (m,)."""

    # -- words, drawing, controls

    def words(self, length: InWords) -> str:
        """Words that describe it."""
        raise NotImplementedError

    def rows(self, length: InWords, material: InWords) -> list[tuple[str, str]]:
        return [("plate body", self.words(length))]

    def drawing(self, rim: Rim) -> list[Shape]:
        return [Shape("square", max(2.5, 1.6 * rim.ratio), "lug")]

    def caption(self, length: InWords, material: InWords) -> str:
        """Words for the caption of a figure, which follow those for its material."""
        return ""

    @classmethod
    def usual(cls, radius: float, material: Material) -> Self:
        """The body that the live page begins with, round a hole of this radius, m, in a plate of this material."""
        return cls()

    def page_controls(self, radius: float, clearance: float, dimensionless: bool) -> list[Control]:
        """The controls of its shape on the live page, for a hole of this radius and a clearance, both in m."""
        outer = Control("outer_radius", self.outer_radius, "length", 1.05 * radius, 4.0 * radius)
        return [outer] if math.isfinite(self.outer_radius) else []

    def changed(self, values: Mapping[str, Any]) -> Self:
        """A copy with other values of the fields that the live page controls."""
        wrong = values.keys() - vars(self).keys()
        if wrong:
            raise InputError(min(wrong), f"is no field of a {self.title}")
        return replace(self, **values)


def check_outer(outer: float, inner: float, name: str, thinnest: float) -> None:
    """Check the outer radius of a body round a circle of radius `inner`, m, that is called `name`."""
    least, most = inner / (1.0 - thinnest), WIDEST * inner
    if not is_between(least, outer, most):
        limits = f"must lie between {least:g} and {most:g} for the {name} {inner:g}"
        raise InputError("outer_radius", f"{limits}, not {outer:g}")
