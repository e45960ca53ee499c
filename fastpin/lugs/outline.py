"""A finite plate with a hole: its outline, further holes, supports and loads.

Points are complex numbers x + iy, in metres. The hole of the pin has its centre at 0. The outline is a closed curve of
straight and circular parts. Parts and further holes have names; supports and loads refer to the names.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from functools import cached_property
from typing import Any, Self

import numpy as np

from fastpin.bodies.compliance import COLUMNS
from fastpin.errors import InputError
from fastpin.model.checks import (
    as_toml,
    check_fields,
    choice,
    instances,
    items,
    number,
    numbers,
    point,
    positive,
    set_fields,
    string,
)
from fastpin.model.materials import PLANES, Material, Plane
from fastpin.model.problem import LEAST_RADIUS, MOST_RADIUS
from fastpin.model.read_only import ReadOnlyDict

HOLD = ("both", "x", "y", "normal")
"""Components of the displacement that a support holds."""

MOST_EXTENT = 1000.0
"""Largest coordinate of a point, in hole radii."""

MOST_PARTS = 300
"""Most parts of the outline and most further holes."""


CLOSEST = 1e-8
"""Distance from an edge below which a point is taken to lie on it, hole radii."""

ON_EDGE = 1e-7
"""Distance from an edge below which a point that was read from it is named by it, hole radii: more is no rounding."""

MOST_TURN = 0.4
"""Largest turn from side to side of a polyline, rad: 15 equal sides are a polygon, 16 stand for a circle."""

SAME_PLACE = 1e-9
"""Part of its length by which a part is longer for a ray, so that none passes between two parts."""


@dataclass(frozen=True)
class Part:
    """A straight or circular part of an outline.

    Parameters
    ----------
    name : str
    start, end : complex
        Ends, m.
    through : complex, optional
        A third point of a circular part, between the ends. Without it the part is straight.

    Raises
    ------
    InputError
        If `name` is no text, or a coordinate no finite number.
    """

    name: str
    start: complex
    end: complex
    through: complex | None = None

    def __post_init__(self) -> None:
        check_fields(self, string, "name")
        check_fields(self, point, "start end")
        check_fields(self, point, "through", optional=True)

    @cached_property
    def circle(self) -> tuple[complex, float, float, float] | None:
        """Centre, radius, first angle and swept angle (positive: counter-clockwise); None for a straight part."""
        if self.through is None:
            return None
        a, b = self.through - self.start, self.end - self.start
        across = (a.conjugate() * b).imag
        centre = self.start + 1j * (a * abs(b) ** 2 - b * abs(a) ** 2) / (2.0 * across)
        first = _angle(self.start - centre)
        sweep = (_angle(self.end - centre) - first) % (2.0 * math.pi)
        return centre, abs(self.start - centre), first, sweep if across > 0.0 else sweep - 2.0 * math.pi

    @property
    def is_flat(self) -> bool:
        """Whether the three points of a circular part lie on a line, or two points are one."""
        if self.through is None:
            return self.start == self.end
        a, b = self.through - self.start, self.end - self.start
        return abs((a.conjugate() * b).imag) <= 1e-9 * max(abs(a), abs(b)) ** 2

    @property
    def length(self) -> float:
        """Length, m."""
        if self.circle is None:
            return abs(self.end - self.start)
        return self.circle[1] * abs(self.circle[3])

    def at(self, share: np.ndarray) -> np.ndarray:
        """Points at shares (0 to 1) of the length, complex, m. Other shares raise :class:`InputError`."""
        share = numbers("share", share, 0.0, 1.0)
        if self.circle is None:
            return self.start + (self.end - self.start) * share
        centre, radius, first, sweep = self.circle
        return centre + radius * np.exp(1j * (first + sweep * share))

    def direction(self, share: np.ndarray) -> np.ndarray:
        """Unit tangents at shares (0 to 1) of the length, from start to end. Other shares raise :class:`InputError`."""
        share = numbers("share", share, 0.0, 1.0)
        if self.circle is None:
            return np.full(np.shape(share), (self.end - self.start) / abs(self.end - self.start))
        _, _, first, sweep = self.circle
        return 1j * math.copysign(1.0, sweep) * np.exp(1j * (first + sweep * share))

    def nearest(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The points of its line or circle that are nearest to points (m,), m, and the unit tangents there."""
        if self.circle is None:
            along = (self.end - self.start) / abs(self.end - self.start)
            return self.start + along * (np.conj(along) * (points - self.start)).real, np.full(points.shape, along)
        centre, radius, _, sweep = self.circle
        ray = (points - centre) / np.abs(points - centre)
        return centre + radius * ray, 1j * math.copysign(1.0, sweep) * ray

    def share(self, place: complex) -> float:
        """The share of the length at which the part, or its line or circle beyond, is nearest to a place, m."""
        if self.circle is None:
            return float(((place - self.start) / (self.end - self.start)).real)
        centre, _, first, sweep = self.circle
        return 0.5 + _angle((place - centre) * cmath.exp(-1j * (first + 0.5 * sweep))) / sweep

    def turn_round(self, z: np.ndarray) -> np.ndarray:
        """Angle by which the part goes round points z (m,), rad."""
        turn = np.angle((self.end - z) * np.conj(self.start - z))
        if self.circle is None:
            return np.asarray(turn)
        centre, radius, _, sweep = self.circle
        sign = math.copysign(1.0, sweep)
        beyond_chord = sign * (np.conj(self.end - self.start) * (z - self.start)).imag < 0.0
        turn = np.abs(turn) * np.where(beyond_chord, -sign, sign)  # also on the chord, where it is a half turn
        return np.asarray(turn + 2.0 * math.pi * sign * (beyond_chord & (np.abs(z - centre) < radius)))

    def crossing(self, start: complex, along: complex) -> float:
        """Distance from a point along a unit vector to the part, m; infinite if the ray does not meet it."""
        if self.circle is None:
            side, chord = np.conj(along) * (self.start - start), np.conj(along) * (self.end - self.start)
            if chord.imag == 0.0:
                return math.inf
            share = -side.imag / chord.imag
            places = [float((side + share * chord).real)] if -SAME_PLACE < share < 1.0 + SAME_PLACE else []
        else:
            centre, radius, first, sweep = self.circle
            middle, most = np.conj(along) * (centre - start), 0.5 * abs(sweep) + SAME_PLACE
            half, back = radius * radius - middle.imag**2, cmath.exp(-1j * (first + 0.5 * sweep))
            both = [] if half < 0.0 else [float(middle.real + sign * math.sqrt(half)) for sign in (-1.0, 1.0)]
            places = [place for place in both if abs(_angle((start + place * along - centre) * back)) < most]
        return min((place for place in places if place > 0.0), default=math.inf)

    def scaled(self, factor: float) -> Part:
        """The same part with all lengths times `factor`. One that is not positive raises :class:`InputError`."""
        factor = positive("factor", factor)
        through = None if self.through is None else self.through * factor
        return Part(self.name, self.start * factor, self.end * factor, through)

    def reversed(self) -> Part:
        """The same part from its end to its start."""
        return replace(self, start=self.end, end=self.start)


@dataclass(frozen=True)
class Hole:
    """A further hole: name, centre (complex, m) and radius (m).

    A name that is no text, a coordinate that is no finite number, or a radius that is not positive raise
    :class:`InputError`.
    """

    name: str
    centre: complex
    radius: float

    def __post_init__(self) -> None:
        check_fields(self, string, "name")
        check_fields(self, point, "centre")
        check_fields(self, positive, "radius")

    @property
    def parts(self) -> tuple[Part, ...]:
        """Its edge in four arcs, clockwise: the plate lies to the left."""
        turns = [self.centre + self.radius * 1j ** (-0.5 * k) for k in range(9)]
        return tuple(Part(self.name, turns[2 * k], turns[2 * k + 2], turns[2 * k + 1]) for k in range(4))


@dataclass(frozen=True)
class PartLoad:
    """A traction on some parts, per unit of a load.

    Parameters
    ----------
    name : {"sxx", "syy", "sxy"}
        The load of a case that this traction follows.
    parts : sequence of str
        Names of the parts.
    x, y, normal : float
        Components of the traction along x, y and the outward normal, Pa per Pa of the load.

    Raises
    ------
    InputError
        If the load is unknown, a name is no text, or a component no finite number.
    """

    name: str
    parts: tuple[str, ...]
    x: float = 0.0
    y: float = 0.0
    normal: float = 0.0

    def __post_init__(self) -> None:
        set_fields(self, name=choice("load", self.name, COLUMNS))
        names = tuple(string("parts", name) for name in items("parts", self.parts, "a list of names"))
        set_fields(self, parts=names)
        check_fields(self, number, "x y normal")


@dataclass(frozen=True)
class Lug:
    """A finite plate with a hole for a pin.

    Parameters
    ----------
    nu : float
        Poisson's ratio.
    plane : {"strain", "stress"}
    hole_radius : float
        Radius of the pin's hole, whose centre is 0, m.
    outline : sequence of Part
        A closed curve. Each part begins where the one before ends. Clockwise outlines are turned round.
    supports : mapping of str to str
        What is held, a word of :data:`HOLD`, by the name of the part or hole.
    loads : sequence of PartLoad
    holes : sequence of Hole
        Further holes.
    floats : bool
        Whether nothing holds the plate: its motion counts from the mean of its outline. It has no supports then.
    net_section : float, optional
        Width of the plate beside the pin's hole that carries its force, W - D, m, for the net-section stress.

    Raises
    ------
    InputError
        If a value is out of range, the outline is open or crosses itself, a hole is not inside, a name is unknown, or
        the supports leave a rigid motion.
    """

    nu: float
    plane: Plane
    hole_radius: float
    outline: tuple[Part, ...]
    supports: Mapping[str, str] = field(default_factory=dict)
    loads: Sequence[PartLoad] = ()
    holes: tuple[Hole, ...] = ()
    floats: bool = False
    net_section: float | None = None

    def __post_init__(self) -> None:
        check_fields(self, number, "nu", 0.0, 0.5)
        check_fields(self, choice, "plane", PLANES)
        check_fields(self, positive, "net_section", optional=True)
        check_fields(self, number, "hole_radius", LEAST_RADIUS, MOST_RADIUS)
        set_fields(self, outline=tuple(instances("outline", self.outline, Part, "a list of parts")))
        set_fields(self, loads=tuple(instances("loads", self.loads, PartLoad, "a list of loads")))
        set_fields(self, holes=tuple(instances("holes", self.holes, Hole, "a list of holes")))
        if not isinstance(self.supports, Mapping):
            raise InputError("supports", f"must map names to words, not {as_toml(self.supports)}")
        set_fields(self, supports=ReadOnlyDict(self.supports))
        _check_outline(self.outline, self.hole_radius)
        points = _polygon(self.outline)
        if np.sum((np.conj(points) * np.roll(points, -1)).imag) < 0.0:  # twice the area, negative clockwise
            set_fields(self, outline=tuple(part.reversed() for part in reversed(self.outline)))
        _check_holes(self)
        names = self.names
        for name, hold in self.supports.items():
            check_name("support", name, names)
            choice("hold", hold, HOLD)
        for load in self.loads:
            for name in load.parts:
                check_name("load", name, names)
            check_not_held(load, self.supports)
        motion = "" if self.floats else self.rigid_motion
        if self.floats and self.supports:
            raise InputError("supports", "a plate that floats has none")
        if motion:
            raise InputError("support", f"the supports leave a rigid motion: the plate can {motion}; hold more of it")

    @property
    def names(self) -> list[str]:
        """Names of all parts and further holes."""
        return [part.name for part in self.outline] + [hole.name for hole in self.holes]

    @property
    def kolosov(self) -> float:
        """Kolosov's constant of the plate."""
        return Material(1.0, self.nu).kolosov(self.plane)

    @property
    def contact_edge(self) -> tuple[Part, ...]:
        """The edge of the pin's hole in four arcs."""
        return Hole("", 0j, self.hole_radius).parts

    @property
    def edges(self) -> tuple[Part, ...]:
        """All other parts, with the plate to the left: outline, then further holes."""
        return self.outline + tuple(part for hole in self.holes for part in hole.parts)

    def surrounds(self, z: np.ndarray) -> np.ndarray:
        """Whether points (m,), m, lie within the outline, but in no further hole."""
        return encloses(self.edges, z)

    @property
    def extent(self) -> float:
        """Largest distance of a point of the outline from the hole's centre, m."""
        return max(float(np.abs(part.at(np.linspace(0.0, 1.0, 9))).max()) for part in self.outline)

    @property
    def nearest(self) -> float:
        """Distance of the nearest other edge from the hole's centre, in hole radii."""
        return min(float(distances(part, np.zeros(1))[0]) for part in self.edges) / self.hole_radius

    @property
    def edge_lines(self) -> list[np.ndarray]:
        """Points along each of :attr:`edges`, complex, in hole radii."""
        return [part.at(np.linspace(0.0, 1.0, 41)) / self.hole_radius for part in self.edges]

    @cached_property
    def polylines(self) -> set[str]:
        """Names of polylines: the stress along such a side is not that along a smooth edge."""
        return {after for _, before, after in kinks(self.outline) if before == after}

    def contains(self, points: np.ndarray) -> np.ndarray:
        """Whether points (m,), m, lie within the outline, but in no further hole; edges belong to the plate."""
        away = np.array([distances(part, points) for part in self.edges]).min(axis=0)
        return np.asarray((away <= CLOSEST * self.hole_radius) | self.surrounds(points))

    def edges_at(self, points: np.ndarray) -> list[Part | None]:
        """The part on which each of some points lies, complex, m; None elsewhere."""
        away = np.array([distances(part, points) for part in self.edges])
        is_there = away.min(axis=0) <= ON_EDGE * self.hole_radius
        return [self.edges[k] if there else None for k, there in zip(away.argmin(axis=0), is_there, strict=True)]

    def document(self) -> dict[str, Any]:
        """Return the outline, holes, supports and loads, JSON-ready. Without plane, Poisson's ratio and hole radius."""
        parts: list[dict[str, Any]] = [{"name": part.name, "to": _pair(part.end)} for part in self.outline]
        for entry, part in zip(parts, self.outline, strict=True):
            entry |= {} if part.through is None else {"through": _pair(part.through)}
        loads = [asdict(load) for load in self.loads]
        holes = [{"name": hole.name, "centre": _pair(hole.centre), "radius": hole.radius} for hole in self.holes]
        start = {"start": _pair(self.outline[0].start), "parts": parts}
        start |= {} if self.net_section is None else {"net_section": self.net_section}
        floats = {"floats": True} if self.floats else {}
        return {**start, "holes": holes, "supports": dict(self.supports), "loads": loads, **floats}

    @classmethod
    def from_document(cls, content: Mapping[str, Any], nu: float, plane: Plane, hole_radius: float) -> Self:
        """Return the plate of :meth:`document`. A missing or wrong entry raises :class:`InputError`."""
        try:
            start, parts = complex(*content["start"]), []
            for part in content["parts"]:
                through = complex(*part["through"]) if "through" in part else None
                parts.append(Part(part["name"], start, complex(*part["to"]), through))
                start = parts[-1].end
            loads = tuple(PartLoad(**{**load, "parts": tuple(load["parts"])}) for load in content["loads"])
            holes = tuple(Hole(hole["name"], complex(*hole["centre"]), hole["radius"]) for hole in content["holes"])
            width, floats = content.get("net_section"), content.get("floats", False) is True
            return cls(nu, plane, hole_radius, tuple(parts), content["supports"], loads, holes, floats, width)
        except InputError:
            raise
        except (KeyError, TypeError, ValueError, AttributeError):
            raise InputError("lug", "is no plate as fastpin compliance writes it") from None

    @property
    def rigid_motion(self) -> str:
        """The rigid motion that the supports leave, in words; empty if there is none."""
        size = self.extent
        rows = [np.zeros((1, 3))]
        for part in self.edges:
            hold = self.supports.get(part.name)
            points, tangents = part.at(np.linspace(0.0, 1.0, 9)) / size, part.direction(np.linspace(0.0, 1.0, 9))
            for along in held_directions(hold, -1j * tangents):
                rows.append(np.stack([along.real, along.imag, (np.conj(along) * 1j * points).real], axis=1))
        _, values, modes = np.linalg.svd(np.concatenate(rows), full_matrices=True)
        values = np.r_[values, np.zeros(3 - values.size)]
        free = modes[values <= 1e-9 * max(1.0, values[0])]  # rows (x, y, turn by `size`)
        if len(free) == 2:
            return "move along x and y" if np.abs(free[:, 2]).max() < 1e-9 else "move, and turn"
        if len(free) != 1:
            return "move and turn freely" if len(free) else ""
        x, y, turn = free[0]
        if abs(turn) < 1e-9:
            return f"move along ({x:.3g}, {y:.3g})"
        centre = 1j * complex(x, y) / turn * size
        return f"turn about the point [{centre.real:.4g}, {centre.imag:.4g}]"


def held_directions(hold: str | None, normals: np.ndarray) -> list[np.ndarray]:
    """Directions in which a support holds, complex unit vectors shaped like the outward normals."""
    x, y = np.ones_like(normals), np.full_like(normals, 1j)
    return {None: [], "both": [x, y], "x": [x], "y": [y], "normal": [normals]}[hold]


def rectangle(x: tuple[float, float], y: tuple[float, float]) -> tuple[Part, ...]:
    """The outline of a rectangle between two x and two y; its parts are called bottom, right, top and left."""
    corners = [complex(x[0], y[0]), complex(x[1], y[0]), complex(x[1], y[1]), complex(x[0], y[1])]
    names = ("bottom", "right", "top", "left")
    return tuple(Part(name, corners[k], corners[(k + 1) % 4]) for k, name in enumerate(names))


def _angle(z: complex) -> float:
    return math.atan2(z.imag, z.real)


def check_name(field: str, name: str, names: Sequence[str]) -> None:
    """Check that a part or further hole of this name exists."""
    if name not in names:
        known = ", ".join(map(as_toml, dict.fromkeys(names)))
        raise InputError(field, f"no part or hole is called {as_toml(name)}; the names are {known}")


def check_not_held(load: PartLoad, supports: Mapping[str, str]) -> None:
    """Check that no support takes up a component of a load."""
    lost = {"both": ("x", "y", "normal"), "x": ("x", "normal"), "y": ("y", "normal"), "normal": ("x", "y", "normal")}
    for name in load.parts:
        for component in lost.get(supports.get(name, ""), ()):
            if getattr(load, component) != 0.0:
                raise InputError(component, f"the support of {as_toml(name)} takes up this component; leave it out")


def _check_outline(outline: Sequence[Part], radius: float) -> None:
    if not 2 <= len(outline) <= MOST_PARTS:
        raise InputError("outline", f"must have 2 to {MOST_PARTS} parts, not {len(outline)}")
    same_place = 1e-9 * radius  # largest distance of two ends that count as one point
    for part in outline:
        points = [part.start, part.end] + ([part.through] if part.through is not None else [])
        for corner in points:
            if not max(abs(corner.real), abs(corner.imag)) <= MOST_EXTENT * radius:
                raise InputError(
                    "outline", f"part {as_toml(part.name)} has a point more than {MOST_EXTENT:g} hole radii away"
                )
        if part.is_flat or part.length <= same_place:
            kind = "two of its points are one" if part.through is None else "its three points lie on a line"
            raise InputError("outline", f"part {as_toml(part.name)} has no shape: {kind}")
    for part, following in zip(outline, (*outline[1:], outline[0]), strict=True):
        if abs(part.end - following.start) > same_place:
            raise InputError(
                "outline",
                f"is not closed: {as_toml(part.name)} ends at {point_text(part.end)}, and {as_toml(following.name)} "
                f"begins at {point_text(following.start)}",
            )
    place = crossing(outline)
    if place is not None:
        raise InputError("outline", f"crosses itself near {point_text(place)}")


def turn_between(before: Part, after: Part) -> float:
    """Angle by which an outline turns from one part to the next one, rad."""
    step = after.direction(np.zeros(1))[0] * np.conj(before.direction(np.ones(1))[0])
    return _angle(complex(step))


def kinks(outline: Sequence[Part]) -> list[tuple[float, str, str]]:
    """Turns, rad, from one straight part to the next one that are small, as those of polylines are, and both names."""
    pairs = [(outline[k - 1], part) for k, part in enumerate(outline)]
    straight = [pair for pair in pairs if pair[0].through is None and pair[1].through is None]
    turns = [(abs(turn_between(*pair)), pair[0].name, pair[1].name) for pair in straight]
    return [turn for turn in turns if 1e-6 < turn[0] <= MOST_TURN]


def encloses(loop: Sequence[Part], points: np.ndarray) -> np.ndarray:
    """Whether a closed curve in either direction goes round points (m,)."""
    turns = np.array([part.turn_round(points) for part in loop]).sum(axis=0)
    return np.asarray(np.abs(turns) > math.pi)


def distances(part: Part, points: np.ndarray) -> np.ndarray:
    """Distances of points from a part, m."""
    ends = np.minimum(np.abs(points - part.start), np.abs(points - part.end))
    if part.circle is None:
        along = (part.end - part.start) / abs(part.end - part.start)
        place = np.conj(along) * (points - part.start)
        return np.where((place.real > 0.0) & (place.real < part.length), np.abs(place.imag), ends)
    centre, radius, first, sweep = part.circle
    turned = np.angle((points - centre) * np.exp(-1j * (first + 0.5 * sweep)))
    return np.where(np.abs(turned) < 0.5 * abs(sweep), np.abs(np.abs(points - centre) - radius), ends)


def _pair(z: complex) -> list[float]:
    return [z.real, z.imag]


def point_text(z: complex) -> str:
    """A point in messages."""
    return f"[{z.real:.6g}, {z.imag:.6g}]"


def _polygon(outline: Sequence[Part]) -> np.ndarray:
    """Points on the outline in order, close enough for crossings and areas."""
    pieces = []
    for part in outline:
        sweep = abs(part.circle[3]) if part.circle is not None else 0.0
        count = max(1, math.ceil(96 * sweep / (2.0 * math.pi)))  # 96 chords to a full circle
        pieces.append(part.at(np.arange(count) / count))
    return np.concatenate(pieces)


def crossing(outline: Sequence[Part]) -> complex | None:
    """A place where the outline crosses or touches itself; None if it is simple."""
    a = _polygon(outline)
    b = np.roll(a, -1)
    count = len(a)
    if count < 3:
        return None
    d = b - a

    def side(k: int, points: np.ndarray) -> np.ndarray:
        return (np.conj(d[k]) * (points - a[k])).imag

    for k in range(count):
        others = np.arange(k + 2, count - (k == 0))  # without the neighbours; pairs before k are done
        if not others.size:
            continue
        one = side(k, a[others]) * side(k, b[others]) <= 0.0
        mine = (np.conj(d[others]) * (a[k] - a[others])).imag * (np.conj(d[others]) * (b[k] - a[others])).imag <= 0.0
        apart = (  # segments of one line have all four products zero, and cross only if their boxes meet
            (np.minimum(a[others].real, b[others].real) > max(a[k].real, b[k].real))
            | (np.maximum(a[others].real, b[others].real) < min(a[k].real, b[k].real))
            | (np.minimum(a[others].imag, b[others].imag) > max(a[k].imag, b[k].imag))
            | (np.maximum(a[others].imag, b[others].imag) < min(a[k].imag, b[k].imag))
        )
        hit = np.flatnonzero(one & mine & ~apart)
        if hit.size:
            return complex(0.5 * (a[k] + b[k]))
    return None


def _check_holes(lug: Lug) -> None:
    """Check that all holes lie inside the outline, apart from it and from one another."""
    if len(lug.holes) > MOST_PARTS:
        raise InputError("holes", f"must be at most {MOST_PARTS}, not {len(lug.holes)}")
    ligament = 0.01  # in hole radii: the harmonics decay too slowly below it
    least = ligament * lug.hole_radius
    circles = [("outline", "the pin's hole", 0j, lug.hole_radius)]
    for hole in lug.holes:
        words = f"the hole {as_toml(hole.name)}"
        if hole.radius < 1e-3 * lug.hole_radius:
            raise InputError("holes", f"{words} must have a radius of at least 0.001 of the pin's hole")
        circles.append(("holes", words, hole.centre, hole.radius))
    for place, (at_fault, words, centre, radius) in enumerate(circles):
        is_far = not max(abs(centre.real), abs(centre.imag)) <= MOST_EXTENT * lug.hole_radius
        if is_far or not encloses(lug.outline, np.array([centre]))[0]:
            raise InputError(at_fault, f"{words} does not lie inside the outline")
        for part in lug.outline:
            if float(distances(part, np.array([centre]))[0]) < radius + least:
                raise InputError(
                    at_fault, f"{words} must keep {ligament:g} hole radii from the part {as_toml(part.name)}"
                )
        for _, other, middle, size in circles[:place]:
            if abs(centre - middle) < radius + size + least:
                raise InputError(at_fault, f"{words} must keep {ligament:g} hole radii from {other}")
