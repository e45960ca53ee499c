"""Marks of old borders at the nodes of a contact, and the places of these borders, which are read on demand.

At a corner only the nodes of the present borders are marked, and the nodal values are kept. That takes some
microseconds. The place of a border is read from these values when it is first asked for. So it does not depend on the
time at which it is read.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from fastpin.kernels.status import STICK
from fastpin.model.grid import Grid
from fastpin.model.problem import Problem
from fastpin.reading.exponents import Coupling
from fastpin.reading.half_line import half_line
from fastpin.reading.old_borders import BITS, UPWARD, OldBorder, is_ambiguous, present_borders, signs_of, truly_sticking
from fastpin.reading.zones import MOST_VALUES, end_place


class MarkedPlace:
    """The place of a border in node distances inwards from its outermost node; NaN where no fit is good enough.

    Parameters
    ----------
    find : callable
        It finds the place from the nodal values of a corner.
    depth : int
        Number of corners whose nodal values are kept until then.
    """

    __slots__ = ("_find", "_value", "depth")

    def __init__(self, find: Callable[[], float], depth: int) -> None:
        self._find: Callable[[], float] | None = find
        self.depth, self._value = depth, math.nan

    def read(self) -> float:
        """The place."""
        if self._find is not None:
            self._value, self._find, self.depth = self._find(), None, 0
        return self._value


class Marks:
    """The marked nodes of a contact. They are never changed.

    Parameters
    ----------
    bits : dict of int to int
        Mark of each marked node, see :data:`fastpin.reading.old_borders.BITS`.
    places : dict of int to Place or float
        Places of the borders of marked nodes, where they are known.
    """

    __slots__ = ("_bits", "_places")

    def __init__(
        self, bits: dict[int, int] | None = None, places: dict[int, MarkedPlace | float] | None = None
    ) -> None:
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
            places[node] = place.read() if isinstance(place, MarkedPlace) else place
        return marks, places

    def left(self, status: np.ndarray, slip: np.ndarray, slip_before: np.ndarray) -> Marks:
        """The marks at nodes that stick by their status (n,) and have the same slip (n,) as before (n,)."""
        if not self._bits:
            return self
        stay = [k for k in self._bits if status.item(k) == STICK and slip.item(k) == slip_before.item(k)]
        if len(stay) == len(self._bits):
            return self
        return Marks({k: self._bits[k] for k in stay}, {k: self._places[k] for k in stay if k in self._places})

    def at(self, nodes: np.ndarray) -> Marks:
        """The same marks where the nodes have other indices: `nodes` (n,)."""
        return Marks(
            {int(nodes[node]): bits for node, bits in self._bits.items()},
            {int(nodes[node]): place for node, place in self._places.items()},
        )

    def with_borders(
        self,
        problem: Problem,
        grid: Grid,
        friction: np.ndarray,
        tractions: tuple[np.ndarray, np.ndarray],
        status: np.ndarray,
    ) -> Marks:
        """Add marks at the present borders between stick and slip, and at the edges of the contact.

        `friction` (n,) is that of the nodes, `tractions` are the pressure and the shear (n,), `status` (n,) tells the
        zones.
        """
        bits, places, n = dict(self._bits), dict(self._places), status.size
        for node, inwards, sign in present_borders(status, grid.closed):
            bits[node] = bits.get(node, 0) | BITS[inwards, sign]
            places.pop(node, None)
            if sign and not is_ambiguous(bits[node]):
                # The place follows from the marks of the next nodes inwards, not from an earlier place of this border.
                near = {at: mark for at, mark in self._bits.items() if inwards * (at - node) % n < MOST_VALUES // 2}
                is_same = near.get(node, 0) & (UPWARD if inwards > 0 else ~UPWARD)
                known = {at: old for at, old in self._places.items() if at in near and not (at == node and is_same)}
                find = partial(Marks(near, known)._place, problem, grid, friction, tractions, status, node, inwards)
                unread = [old.depth for old in known.values() if isinstance(old, MarkedPlace)]
                place = MarkedPlace(find, max(unread, default=0) + 1)
                # The places of 64 corners may follow from each other. Then they are read, and their values given free.
                places[node] = place.read() if place.depth > 64 else place
        return Marks(bits, places)

    def _place(
        self,
        problem: Problem,
        grid: Grid,
        friction: np.ndarray,
        tractions: tuple[np.ndarray, np.ndarray],
        status: np.ndarray,
        node: int,
        inwards: int,
    ) -> float:
        """The place of the border at a sticking `node`; NaN if the node or the one beyond it carries no shear.

        The zone lies in the direction `inwards`, 1 or -1. The other arguments are those of :meth:`with_borders`.
        """
        (pressure, shear), n = tractions, status.size
        bound = friction * pressure
        sticking = truly_sticking(status, bound - np.abs(shear))
        sign = float(np.sign(shear[(node - inwards) % n])) if sticking[node] else 0.0
        if sign == 0.0:
            return math.nan
        nodes = node + inwards * np.arange(min(MOST_VALUES, n))
        nodes = nodes % n if grid.closed else nodes[(nodes >= 0) & (nodes < n)]
        slipping = np.flatnonzero(~sticking[nodes])
        zone = nodes[: slipping[0]] if slipping.size else nodes
        cusps = self.borders(node, min(zone.size, MOST_VALUES // 2), n, inwards)
        coupling = Coupling.of(problem, friction[[node]], grid.theta[[node]])
        line = half_line(0.5 - float(coupling.tilt[int(sign), 0]) * sign * inwards, float(coupling.beta[0]))
        return end_place(bound[zone] - sign * shear[zone], line, cusps)

    def borders(self, first: int, size: int, n: int, inwards: int = 1) -> list[OldBorder]:
        """The marked borders at `size` neighbours of `n` nodes, from the node `first` in the direction `inwards`.

        Their nodes and directions count from there too. They are in increasing order.
        """
        found = []
        for node, mark in self._bits.items():
            at = inwards * (node - first) % n
            if at < size:
                place, signs = _known(self._places.get(node, math.nan)), signs_of(mark)
                found += [OldBorder(at, direction * inwards, sign, place) for direction, sign in signs.items()]
        return sorted(found)

    def __reduce__(self) -> tuple[Any, ...]:
        """Copies and pickles hold the places as numbers."""
        places = {node: value for node, place in self._places.items() if (value := _known(place)) is not None}
        return Marks, (dict(self._bits), places)


def _known(place: MarkedPlace | float) -> float | None:
    """A place as a number; None if it is unknown."""
    value = place.read() if isinstance(place, MarkedPlace) else place
    return None if math.isnan(value) else value
