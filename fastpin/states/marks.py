"""Marks of old borders at the nodes of a contact, and the places of these borders, which are read on demand.

At a corner only the nodes of the present borders are marked, and the nodal values beside them are kept. That takes some
microseconds. The place of a border is read from these values when it is first asked for. So it does not depend on the
time at which it is read.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from fastpin.kernels.status import STICK
from fastpin.model.grid import Grid
from fastpin.model.problem import Problem
from fastpin.states.ends import MOST_VALUES, end_place
from fastpin.states.half_line import half_line
from fastpin.states.old_borders import BITS, OldBorder, is_ambiguous, present_borders, truly_sticking

DEEPEST = 8
"""Largest number of unread places that follow from each other. The next one is read at once: it keeps no more memory.

A place is read with the places of older borders nearby.
"""


class Cusp(NamedTuple):
    """An older border near a border: its outermost node, counted from the border, and the rest as for an OldBorder."""

    at: int
    inwards: int
    sign: int
    place: Place | float


class Place:
    """The place of a border in node distances inwards from its outermost node; NaN where no fit is good enough.

    Parameters
    ----------
    reserve : ndarray, shape (k,)
        mu N - |T| from the outermost node inwards.
    exponent, coupling : float
        Those of the half line, see :func:`fastpin.states.half_line.half_line`.
    cusps : list of Cusp
        The older borders nearby.
    """

    __slots__ = ("_beside", "_value", "depth")

    def __init__(self, reserve: np.ndarray, exponent: float, coupling: float, cusps: list[Cusp]) -> None:
        self._beside: tuple[np.ndarray, float, float, list[Cusp]] | None = reserve, exponent, coupling, cusps
        self._value = math.nan
        self.depth: int = 1 + max((cusp.place.depth for cusp in cusps if isinstance(cusp.place, Place)), default=0)
        if self.depth > DEEPEST:
            self.read()

    def read(self) -> float:
        """The place."""
        if self._beside is not None:
            reserve, exponent, coupling, cusps = self._beside
            found = [OldBorder(at, inwards, sign, _known(place)) for at, inwards, sign, place in cusps]
            self._value = end_place(reserve, half_line(exponent, coupling), found)
            self._beside, self.depth = None, 0
        return self._value


class Marks:
    """The marked nodes of a contact. They are never changed.

    Parameters
    ----------
    bits : dict of int to int
        Mark of each marked node, see :data:`fastpin.states.old_borders.BITS`.
    places : dict of int to Place or float
        Places of the borders of marked nodes, where they are known.
    """

    __slots__ = ("_bits", "_places")

    def __init__(self, bits: dict[int, int] | None = None, places: dict[int, Place | float] | None = None) -> None:
        self._bits, self._places = bits or {}, places or {}

    @classmethod
    def stored(cls, marks: np.ndarray, places: np.ndarray) -> Marks:
        """The marks (n,) and places (n,) of :meth:`arrays`."""
        nodes = np.flatnonzero(marks).tolist()
        known = np.flatnonzero(~np.isnan(places)).tolist()
        return cls({node: int(marks[node]) for node in nodes}, {node: float(places[node]) for node in known})

    def arrays(self, nodes: int) -> tuple[np.ndarray, np.ndarray]:
        """The marks, int8, and places of a contact of so many nodes, shape (n,) each. Unknown places are NaN."""
        marks, places = np.zeros(nodes, dtype=np.int8), np.full(nodes, np.nan)
        for node, bits in self._bits.items():
            marks[node] = bits
        for node, place in self._places.items():
            value = _known(place)
            places[node] = math.nan if value is None else value
        return marks, places

    def left(self, status: np.ndarray, slip: np.ndarray, slip_before: np.ndarray) -> Marks:
        """The marks at nodes that stick by their status (n,) and have the same slip (n,) as before (n,)."""
        if not self._bits:
            return self
        nodes = np.fromiter(self._bits, np.intp, len(self._bits))
        stay = (status[nodes] == STICK) & (slip[nodes] == slip_before[nodes])
        if stay.all():
            return self
        bits = {node: self._bits[node] for node in nodes[stay].tolist()}
        return Marks(bits, {node: place for node, place in self._places.items() if node in bits})

    def at(self, nodes: np.ndarray) -> Marks:
        """The same marks where the nodes have other indices: `nodes` (n,)."""
        return Marks(
            {int(nodes[node]): bits for node, bits in self._bits.items()},
            {int(nodes[node]): place for node, place in self._places.items()},
        )

    def with_borders(
        self, problem: Problem, grid: Grid, tractions: tuple[np.ndarray, np.ndarray], status: np.ndarray
    ) -> Marks:
        """These marks and those of the present borders between stick and slip, and of the edges of the contact.

        `tractions` are the pressure and the shear (n,), `status` (n,) tells the zones.
        """
        fresh: dict[int, int] = {}
        places: dict[int, Place | float] = {}
        beside: _Beside | None = None
        for node, inwards, sign in present_borders(status, grid.closed):
            fresh[node] = fresh.get(node, 0) | BITS[inwards, sign]
            if sign:
                beside = beside or _Beside.of(problem, grid, tractions, status)
                place = beside.place(node, inwards, self)
                if place is not None:
                    places[node] = place
        if not fresh:
            return self
        bits = self._bits | {node: mark | self._bits.get(node, 0) for node, mark in fresh.items()}
        places = {node: place for node, place in self._places.items() if node not in fresh} | places
        return Marks(bits, {node: place for node, place in places.items() if not is_ambiguous(bits[node])})

    def near(self, nodes: list[int], inwards: int) -> list[Cusp]:
        """The marked borders at some neighbouring `nodes`, which lie `inwards` from the first one, in their order.

        Their directions count from there too.
        """
        found = []
        for at, node in enumerate(nodes):
            bits = self._bits.get(node)
            if bits is None:
                continue
            place, directions = self._places.get(node, math.nan), set()
            for (direction, sign), bit in BITS.items():
                if bits & bit and direction not in directions:
                    directions.add(direction)
                    found.append(Cusp(at, direction * inwards, sign, place))
        return found

    def __reduce__(self) -> tuple[Any, ...]:
        """Copies and pickles hold the places as numbers."""
        places = {node: value for node, place in self._places.items() if (value := _known(place)) is not None}
        return Marks, (dict(self._bits), places)


def _known(place: Place | float) -> float | None:
    """A place as a number; None if it is unknown."""
    value = place.read() if isinstance(place, Place) else place
    return None if math.isnan(value) else value


class _Beside(NamedTuple):
    """The nodal values beside the borders at a corner."""

    closed: bool
    bound: np.ndarray
    shear: np.ndarray
    sticking: np.ndarray
    tilt: float
    coupling: float

    @classmethod
    def of(cls, problem: Problem, grid: Grid, tractions: tuple[np.ndarray, np.ndarray], status: np.ndarray) -> _Beside:
        """The values of a problem with the pressure and shear `tractions` (n,) and the status (n,)."""
        pressure, shear = tractions
        bound, coupling = problem.friction * pressure, problem.surfaces.dundurs()[1]
        tilt = math.atan(problem.friction * coupling) / math.pi
        return cls(grid.closed, bound, shear, truly_sticking(status, bound - np.abs(shear)), tilt, coupling)

    def place(self, node: int, inwards: int, older: Marks) -> Place | None:
        """The place of the border at a sticking `node`; None if the node or the one beyond it carries no shear."""
        n = self.shear.size
        outside, sign = (node - inwards) % n, 0.0
        if self.sticking[node]:
            sign = float(np.sign(self.shear[outside]))
        if sign == 0.0:
            return None
        nodes = node + inwards * np.arange(min(MOST_VALUES, n))
        nodes = nodes % n if self.closed else nodes[(nodes >= 0) & (nodes < n)]
        slipping = np.flatnonzero(~self.sticking[nodes])
        zone = nodes[: slipping[0]] if slipping.size else nodes
        reserve = self.bound[zone] - sign * self.shear[zone]
        cusps = older.near(zone[: MOST_VALUES // 2].tolist(), inwards)
        return Place(reserve, 0.5 - self.tilt * sign * inwards, self.coupling, cusps)
