"""Cusps of the shear traction at present and old borders, read with the solutions of the half-line problem.

The outermost sticking node of each border is known: from the statuses, or from the marks of old borders. So a cusp is
read by linear fits (:mod:`fastpin.reading.half_line`), also where borders and contact edges lie a few nodes apart.

Near a slip zone the fitted quantity is mu N - s T, where s T = mu N in the slip zone. It is zero there, so the edge of
the contact just beyond does not matter. N itself is fitted from the edge of the contact inwards.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cache, cached_property
from typing import NamedTuple

import numpy as np

from fastpin.model.grid import Grid
from fastpin.reading.exponents import Coupling, reserve_beside, stick_exponents
from fastpin.reading.half_line import End, Fit, HalfLine, Tries, Try, half_line
from fastpin.reading.marks import Marks
from fastpin.reading.old_borders import OldBorder
from fastpin.reading.zones import CUSP_TERMS, Interval, end_place, interval_of, runs, unrolled, whole_turn

DEGREES = (3, 4, 5)
"""Degrees of the polynomial to try where no end of the zone is in the window."""

END_TERMS = (4, 5)
"""Terms to try at an end of the zone."""

GOOD_ENOUGH = 5e-5
"""Relative standard error of a value from which on no wider window is tried.

The standard error of a wide window misses a part of its error: its terms are too few for all places in it.
"""


class Cusp(NamedTuple):
    """A cusp of the shear traction.

    Attributes
    ----------
    value, error : float
        |T| there, and its standard error.
    angle : float
        rad.
    node : int
        The node with the largest shear beside it.
    """

    value: float
    error: float
    angle: float
    node: int


class ShearLaw(NamedTuple):
    """The power law of T at an old border: T gains height * x^exponent in the zone that ended there.

    Attributes
    ----------
    place : float
        Angle, rad.
    inwards : int
        1 if the zone lies at larger angles, otherwise -1.
    exponent, height : float
        For the distance x from the place in node distances.
    spacing : float
        Node distance, rad.
    """

    place: float
    inwards: int
    exponent: float
    height: float
    spacing: float

    def values(self, theta: np.ndarray) -> np.ndarray:
        """The part of T that the law adds, shape (m,)."""
        inside = np.maximum(self.inwards * (theta - self.place), 0.0) / self.spacing
        return np.asarray(self.height * inside**self.exponent)


class _Window(NamedTuple):
    """Neighbouring nodes of a zone whose values are fitted.

    Attributes
    ----------
    first : int
        The first node, counted in the zone.
    sign : int
        The values are the reserve beside a slip zone with this sign, or a traction itself if it is 0.
    values : ndarray, shape (nodes,)
    shapes : list of (tuple of End, int)
        Ends to try, and degrees of the polynomial.
    is_last : bool
        Whether the window is left out if an earlier one has a fit.
    """

    first: int
    sign: int
    values: np.ndarray
    shapes: list[tuple[tuple[End, ...], int]]
    is_last: bool = False


@dataclass(frozen=True, eq=False)
class _Patch:
    """A contact: neighbouring closed nodes.

    Attributes
    ----------
    nodes : ndarray of int, shape (n,)
    integral : ndarray, shape (n,)
        Integral of the shear over the angle from the first node.
    margins : (float, float)
        Integrals of the shear from the first and the last node to the ends of the contact.
    cusps : list of End
        The cusps of the pressure of unlike bodies, as parts of a fit of all nodes.
    """

    nodes: np.ndarray
    integral: np.ndarray
    margins: tuple[float, float]
    cusps: list[End]

    def turned(self, first: int, last: int) -> np.ndarray:
        """The integral of the shear over the angle at the nodes first : last, shape (last - first,).

        Where the shear has a cusp, the pressure less this integral is smooth: on the curved surface the two turn into
        each other. The integral begins at the end of the contact, if one of the nodes is there, for the difference must
        be zero there. It is left out between two ends.
        """
        part, size = self.integral[first:last], self.nodes.size
        if last - first == size:
            return np.zeros(size)
        if last == size:
            return part - (part[-1] + self.margins[1])
        return part - (part[0] if first > 0 else -self.margins[0])


@dataclass(frozen=True, eq=False)
class ShearNodes:
    """Nodal tractions of a state, and the marks of its borders.

    Attributes
    ----------
    grid : Grid
    pressure, shear : ndarray, shape (n,)
    sticking : ndarray of bool, shape (n,)
    marks : Marks
        Old borders.
    friction : ndarray, shape (n,)
        mu.
    coupling : Coupling
    """

    grid: Grid
    pressure: np.ndarray
    shear: np.ndarray
    sticking: np.ndarray
    marks: Marks
    friction: np.ndarray
    coupling: Coupling
    # Places of borders that were read, by the outermost node and the direction inwards; their half lines and parts in
    # the fitted quantity, by the node, the border's own sign, the direction and the sign of :meth:`_end`.
    _border_places: dict[tuple[int, int], float] = field(default_factory=dict)
    _solutions: dict[tuple[int, int, int, int], tuple[HalfLine, tuple[float, float]]] = field(default_factory=dict)

    @cached_property
    def _patches(self) -> list[_Patch]:
        found = []
        for nodes in runs(self.grid, self.pressure > 0.0):
            theta, shear, margins = unrolled(self.grid, nodes), self.shear[nodes], (0.0, 0.0)
            steps = theta[1:] - theta[:-1]
            if nodes.size > 1:
                margins = 0.5 * float(shear[0] * steps[0]), 0.5 * float(shear[-1] * steps[-1])
            cusps = []
            for node, border in self._coupled_borders:
                at = (node - int(nodes[0])) % self.grid.size
                if at < nodes.size:
                    end = self._end(border._replace(at=at), node, 0, CUSP_TERMS, border.sign)
                    share = float(self.coupling.share[border.sign, node])
                    cusps.append(end._replace(parts=(1.0, -share)))
            areas = 0.5 * (shear[1:] + shear[:-1]) * steps
            found.append(_Patch(nodes, np.concatenate([[0.0], np.cumsum(areas)]), margins, cusps))
        return found

    def stick_intervals(self, closed: np.ndarray, contact: list[Interval]) -> list[Interval]:
        """The stick intervals of the runs of sticking nodes, in their order; inside the contact.

        A stick zone ends where mu N - |T| falls to zero, or with the contact. It ends with the contact if it reaches
        the outermost closed node: a slip zone has at least one node.

        Parameters
        ----------
        closed : ndarray of bool, shape (n,)
            Nodes in contact.
        contact : list of (float, float)
            Contact intervals of their runs, rad.

        Returns
        -------
        list of (float, float)
            Start and stop, rad. A zone round the whole circle is one interval of length 2 pi.
        """
        grid, zones = self.grid, []
        if self.sticking.all() and grid.closed:
            return [whole_turn(grid)]
        sticking = runs(grid, self.sticking)
        reserve = reserve_beside(sticking, self.friction, self.pressure, self.shear)
        outer = [] if closed.all() and grid.closed else list(zip(runs(grid, closed), contact, strict=True))
        starts, stops = ({int(nodes[end]) for nodes, _ in outer} for end in (0, -1))
        for run in sticking:
            before, after = stick_exponents(self.shear, self.coupling.tilt, run)
            first_beta, last_beta = self.coupling.beta[run[[0, -1]]].tolist()
            lines = half_line(before, first_beta), half_line(after, last_beta)
            is_read = int(run[0]) not in starts, int(run[-1]) not in stops
            start, stop = interval_of(grid, run, tuple(reserve), lines, self.old_borders(run), is_read)
            for nodes, (first, last) in outer:
                if run[0] in nodes:
                    turn = 2.0 * math.pi * round((0.5 * (first + last) - 0.5 * (start + stop)) / (2.0 * math.pi))
                    start = first if run[0] == nodes[0] else max(start + turn, first)
                    stop = last if run[-1] == nodes[-1] else min(stop + turn, last)
                    break
            zones.append((float(start), float(stop)))
        return zones

    def old_cusps(self, least: float) -> Iterator[Cusp]:
        """Read the cusps at old borders beside which a node has the shear `least` or more."""
        size = np.abs(self.shear)
        for run in runs(self.grid, self.sticking):
            borders = self.old_borders(run)
            for border in borders:
                beside = run[max(border.at - 2, 0) : border.at + 3]
                if border.sign == 0 or border.is_end(run.size) or size[beside].max() < least:
                    continue
                if np.sign(self.shear[run[border.at]]) != border.sign:
                    continue  # this cusp points towards T = 0
                highest = int(beside[np.argmax(size[beside])])
                best = self._best_at(run, border, borders, GOOD_ENOUGH * float(size[highest]))
                cusp = None if best is None else self._read(*best, int(run[border.at]), border, highest)
                if cusp is not None:
                    yield cusp

    def _border_place(self, run: np.ndarray, inwards: int) -> float:
        """Place of the border at an end of the stick zone of the nodes `run`; NaN if no fit is good enough."""
        nodes = run[::inwards]
        key = int(nodes[0]), inwards
        if key not in self._border_places:
            sign, borders = self._end_sign(run, inwards), self.old_borders(run)
            inside = borders if inwards > 0 else [border.mirrored(run.size) for border in borders]
            reserve = self.friction[nodes] * self.pressure[nodes] - sign * self.shear[nodes]
            line = half_line(self._exponent(key[0], sign, inwards), float(self.coupling.beta[key[0]]))
            self._border_places[key] = end_place(reserve, line, inside)
        return self._border_places[key]

    def border_cusp(self, nodes: np.ndarray, outwards: int, angle: float) -> Cusp | None:
        """mu N at an end of the stick zone of some `nodes`, which begin there, at an `angle`, rad.

        None if the solutions of the half line do not show the border at this angle.
        """
        node = int(nodes[0])
        away = math.remainder(angle - float(self.grid.theta[node]), 2.0 * math.pi)
        offset = away / float(self.grid.halves[away > 0.0][node])
        place = self._border_place(nodes[::-outwards], -outwards)
        if not abs(-outwards * place - offset) <= 0.01:  # else the two readings of the border do not agree
            return None
        offsets = offset + outwards * _beyond(self.coupling.is_smooth)
        read = self._pressure_at(node, offsets, -outwards)
        if read is None:
            return None
        top = _top(read[0])
        angle += self._angle(node, float(offsets[top])) - self._angle(node, offset)
        friction = float(self.friction[node])
        return Cusp(friction * float(read[0][top]), friction * read[1], angle, node)

    @cached_property
    def _coupled_borders(self) -> list[tuple[int, OldBorder]]:
        """The node and the rest of all borders of unlike bodies, old ones and present ones: N has a cusp at each."""
        found = []
        for run in runs(self.grid, self.sticking) if not self.coupling.is_smooth else []:
            inside = [border for border in self.old_borders(run) if border.sign and not border.is_end(run.size)]
            found += [(int(run[border.at]), border) for border in inside]
            for inwards, at in ((1, 0), (-1, run.size - 1)):
                sign = self._end_sign(run, inwards)
                place = self._border_place(run, inwards) if sign else math.nan
                if not math.isnan(place):
                    found.append((int(run[at]), OldBorder(at, inwards, sign, place)))
        return found

    def old_borders(self, run: np.ndarray) -> list[OldBorder]:
        """The marked borders in the stick zone of the nodes `run`."""
        return self.marks.borders(int(run[0]), run.size, self.grid.size)

    def _end_sign(self, run: np.ndarray, inwards: int) -> int:
        """Sign of the shear in the slip zone at an end of a stick zone; 0 if the contact ends there."""
        outside = int(run[0] - 1) if inwards > 0 else int((run[-1] + 1) % self.grid.size)
        return int(np.sign(self.shear[outside]))

    def _best_at(
        self, run: np.ndarray, border: OldBorder, borders: list[OldBorder], enough: float
    ) -> tuple[Fit, float, _Window] | None:
        """The best fit at an old border in the stick zone of the nodes `run`, see :func:`_best`."""
        windows = []
        for first, last in _spans(border.at, run.size):
            nodes = run[first:last]
            signs = [self._end_sign(run, side) for side in _met(first, last, run.size)]
            sign = signs[0] if len(signs) == 1 else 0
            values = self.shear[nodes]
            if sign:
                values = self.friction[nodes] * self.pressure[nodes] - sign * values
            shapes = list(self._shapes(run, border, borders, first, last, sign))
            windows.append(_Window(first, sign, values, shapes, nodes.size == run.size))
        return _best(windows, None, enough)

    def shear_laws(self, run: np.ndarray, most_pressure: float) -> Iterator[ShearLaw]:
        """The power laws of T at the old borders in the stick zone of the nodes `run`, up to a nodal pressure.

        Among crowded borders the least squares may take a sum of huge laws that cancel each other at the nodes. A law
        that alone breaks Coulomb's law is none: T changes from -mu N to mu N at most, here within a node distance.
        """
        borders, largest = self.old_borders(run), float(np.abs(self.shear).max())
        for border in borders:
            node = int(run[border.at])
            if border.is_end(run.size) or self.pressure[node] > most_pressure:
                continue
            best = self._best_at(run, border, borders, GOOD_ENOUGH * largest)
            if best is None or math.isnan(place := best[0].place(0)):
                continue
            (series, error), window = best[0].series(0), best[2]
            if error <= 0.01 * abs(series[0]):
                end = self._end(border, node, window.first, CUSP_TERMS, window.sign)
                height = sum(end.parts) * float(series[0]) * (-window.sign or 1)
                angle = self._angle(node, place + window.first - border.at)
                beside = run[max(border.at - 2, 0) : border.at + 3]
                if abs(height) <= 2.0 * float((self.friction[beside] * self.pressure[beside]).max()):
                    spacing = float(self.grid.weights[node])
                    yield ShearLaw(angle, border.inwards, end.half_line.exponent, height, spacing)

    def _read(self, fit: Fit, error: float, window: _Window, node: int, border: OldBorder, highest: int) -> Cusp | None:
        """Read the cusp at an old border, whose outermost node is `node`, from the best fit beside it."""
        places = fit.place(0) - border.inwards * _beyond(not border.sign or self.coupling.is_smooth)
        offsets = places + window.first - border.at
        values = fit.values(places)
        if window.sign:
            read = self._pressure_at(node, offsets, border.inwards)
            if read is None:
                return None
            friction = float(self.friction[node])
            values, error = friction * read[0] - values, error + friction * read[1]
        values = np.abs(values)
        top = _top(values)
        return Cusp(float(values[top]), error, self._angle(node, float(offsets[top])), highest)

    def _shapes(
        self, run: np.ndarray, border: OldBorder, borders: list[OldBorder], first: int, last: int, sign: int
    ) -> Iterator[tuple[tuple[End, ...], int]]:
        """Ends and degrees to try for the nodes first : last of a zone. The border itself is the first end."""
        others = [other for other in borders if first <= other.at < last and other[:2] != border[:2]]
        cusps = [border, *(other for other in others if not other.is_end(run.size))]
        met = _met(first, last, run.size)
        least = len(met) * END_TERMS[0] if met else DEGREES[0] + 1
        if last - first - least - sum(CUSP_TERMS - (cusp.place is not None) for cusp in cusps) < 2:
            return  # too few nodes for all of these fits
        own, *inside = [self._end(cusp, int(run[cusp.at]), first, CUSP_TERMS, sign) for cusp in cusps]
        if not met:
            yield from (((own, *inside), degree) for degree in DEGREES)
        for terms in END_TERMS if met else ():
            outer = []
            for side in met:
                at = 0 if side > 0 else run.size - 1
                own_sign = self._end_sign(run, side)
                outer.append(self._end(OldBorder(at, side, own_sign), int(run[at]), first, terms, own_sign))
            yield (own, *inside, *outer), -1

    def _end(self, border: OldBorder, node: int, first: int, terms: int, sign: int) -> End:
        """A border as a part of a fit: of the reserve beside slip with the `sign`, or of the shear if this is 0.

        Its outermost node is the `node` of the grid.
        """
        own, inwards = border.sign, border.inwards
        if (key := (node, own, inwards, sign)) not in self._solutions:
            line = half_line(self._exponent(node, own, inwards), float(self.coupling.beta[node]) if own else None)
            parts, share = (1.0, 0.0), float(self.coupling.share[own, node])
            if not self.coupling.is_smooth and own not in (0, sign):
                parts = (1.0, -2.0 * share) if sign else (0.0, share)
            self._solutions[key] = line, parts
        line, parts = self._solutions[key]
        return End(line, border.at - first, inwards, terms, border.place, parts)

    def _pressure_at(self, node: int, offsets: np.ndarray, inwards: int) -> tuple[np.ndarray, float] | None:
        """The pressure beside a border, and its standard error at the first place.

        The `offsets` (k,) are node distances from the outermost `node` of the border.
        """
        for patch in self._patches:
            at, size, windows = (node - int(patch.nodes[0])) % self.grid.size, patch.nodes.size, []
            if at >= size:
                continue
            for first, last in _spans(at, size):
                values = self.pressure[patch.nodes[first:last]] - patch.turned(first, last)
                windows.append(_Window(first, 0, values, _pressure_shapes(patch, first, last)))
            # The pressure is smoother than the shear, and its error comes on top of the error of the shear.
            enough = 0.1 * GOOD_ENOUGH * float(self.pressure[node])
            best = _best(windows, at + float(offsets[0]), enough)
            if best is None:
                return None
            (fit, error, window), first = best, best[2].first
            smooth = fit.values(at - first + offsets)
            return smooth + self._turned_until(patch, first, first + window.values.size, at, inwards, offsets), error
        return None

    def _turned_until(
        self, patch: _Patch, first: int, last: int, at: int, inwards: int, offsets: np.ndarray
    ) -> np.ndarray:
        """The integral of the shear up to a border, from the node beyond it, where the shear is smooth.

        The integral begins among the nodes first : last of a contact.
        """
        turned, outer, before = patch.turned(first, last), at - inwards, at - 2 * inwards
        if last - first == patch.nodes.size or not first <= outer < last:
            return np.full(offsets.size, turned[at - first])
        shear = float(self.shear[patch.nodes[outer]])
        change = shear - float(self.shear[patch.nodes[before]]) if first <= before < last else 0.0
        steps, spacing = inwards * offsets + 1.0, float(self.grid.weights[patch.nodes[outer]])
        return np.asarray(turned[outer - first] + inwards * spacing * (shear * steps + 0.5 * change * steps**2))

    def _exponent(self, node: int, sign: int, inwards: int) -> float:
        """Exponent (T26) of the reserve at a border with its outermost `node`, and shear of this `sign` beyond."""
        return 0.5 - float(self.coupling.tilt[sign, node]) * sign * inwards

    def _angle(self, node: int, offset: float) -> float:
        """Angle of a place `offset` node distances from a node, rad."""
        return float(self.grid.theta[node]) + offset * float(self.grid.halves[offset > 0.0][node])


@cache
def _beyond(is_smooth: bool) -> np.ndarray:
    """Distances from a border, outwards, at which the largest shear may lie, in node distances.

    Of unlike bodies it lies a little beyond the border. The places gather at the border.
    """
    return np.zeros(1) if is_smooth else 6.0 * np.linspace(0.0, 1.0, 81) ** 2


def _spans(at: int, size: int) -> list[tuple[int, int]]:
    """The windows to try about the node number `at` of a zone of `size` nodes: first node, and node after the last."""
    return list(dict.fromkeys((max(at - half, 0), min(at + half + 1, size)) for half in (5, 7, 10, 14, 20)))


def _met(first: int, last: int, size: int) -> list[int]:
    """The ends of a zone of `size` nodes in the window first : last: 1 for the start, -1 for the stop."""
    return [side for side, is_met in ((1, first == 0), (-1, last == size)) if is_met]


def _pressure_shapes(patch: _Patch, first: int, last: int) -> list[tuple[tuple[End, ...], int]]:
    """Ends and degrees to try for the pressure at the nodes first : last of a contact."""
    cusps = [end._replace(node=end.node - first) for end in patch.cusps if first <= end.node < last]
    met = _met(first, last, patch.nodes.size)
    if not met:
        return [(tuple(cusps), degree) for degree in DEGREES]
    line = half_line(0.5)
    return [
        ((*(End(line, 0 if side > 0 else last - first - 1, side, terms) for side in met), *cusps), -1)
        for terms in END_TERMS
    ]


def _best(windows: list[_Window], at: float | None, enough: float) -> tuple[Fit, float, _Window] | None:
    """The fit with the smallest standard error at the place `at` of the zone, this error, and its window.

    Without `at` it is the error at the first end of the fit.
    No wider window counts after a fit with an error that is small `enough`. None if there is no fit.
    """
    tries, places, owners, start = [], [], [], 0
    for window in windows:
        for ends, degree in window.shapes:
            fit = Try(start, window.values.size, degree, ends)
            if fit.spare >= 2:
                tries.append(fit)
                owners.append(window)
                places.append(math.nan if at is None else at - window.first)
        start += window.values.size
    if not tries:
        return None
    errors = Tries(tries).value_errors(np.concatenate([window.values for window in windows]), np.array(places))
    best, least = None, math.inf
    for number, (error, window) in enumerate(zip(errors.tolist(), owners, strict=True)):
        if best is not None and window is not owners[best] and (least <= enough or window.is_last):
            break
        if error < least:
            best, least = number, error
    if best is None:
        return None
    window, fit = owners[best], tries[best]
    return Fit(window.values, fit.ends, fit.degree), least, window


def _top(values: np.ndarray) -> int:
    """Place of the largest of some values; the first one if they rise to the last one."""
    top = int(np.argmax(values))
    return top if top < values.size - 1 else 0
