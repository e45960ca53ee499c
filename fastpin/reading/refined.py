"""Tractions refined at contact edges and stick-slip borders, where they go like a root of the distance.

Straight lines between the nodes give the hoop stress at these places to O(sqrt(h)) only. So the tractions near them are
taken from power laws in the distance x, which are fitted to the nodes (:func:`fastpin.reading.power_laws.fit_law`):

* N beside a contact edge, with the exponents (T21);
* mu N - s T on the stick side of a border, with the exponents (T26), where T = s mu N in the slip zone;
* T beside a contact edge that sticks;
* the cusp that an earlier border or edge left in T inside a stick zone.

Nothing is fitted inside a slip zone: there T = s mu N. So a slip zone may be as narrow as a node distance.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from fastpin.elasticity.tractions import RefinedTractions, Tractions
from fastpin.kernels.half_line import least_squares
from fastpin.kernels.status import OPEN
from fastpin.reading.cusps import ShearLaw, ShearNodes
from fastpin.reading.exponents import Coupling, contact_exponents, signs_beside, stick_exponents
from fastpin.reading.half_line import half_line
from fastpin.reading.old_borders import OldBorder
from fastpin.reading.power_laws import Law, fit_law, law_of_nodes
from fastpin.reading.zones import Interval, end_angle, is_all_round, runs, unrolled

GRADED = np.linspace(0.0, 1.0, 61) ** 4
"""The ends of the linear pieces of a power law. They gather at the edge."""

BOTH_ENDS = (slice(None), slice(None, None, -1))
"""Order of the nodes of a zone, from its start and from its stop."""


class StickZone(NamedTuple):
    """A stick zone of a patch. Pairs belong to its start and its stop.

    Attributes
    ----------
    ends : (float, float)
        Angles, rad.
    nodes : ndarray of int
        Places of its nodes in the patch.
    signs : (int, int)
        Sign of T in the slip zone beside each end; 0 at the edge of the contact.
    exponents : (float, float)
        Of mu N - |T|, (T26).
    cusps : list of OldBorder
        The old borders in it.
    shear_laws : tuple of ShearLaw
        The power laws of T at those where the pressure is low: there the hoop stress may be high.
    """

    ends: tuple[float, float]
    nodes: np.ndarray
    signs: tuple[int, int]
    exponents: tuple[float, float]
    cusps: list[OldBorder]
    shear_laws: tuple[ShearLaw, ...]


@dataclass(frozen=True, eq=False)
class Patch:
    """One contact interval. Pairs belong to its start and its stop.

    Attributes
    ----------
    theta : ndarray, shape (n,)
        Angles of its nodes, rad, increasing.
    pressure, shear : ndarray, shape (n,)
        Nodal tractions.
    edges, outside : (float, float)
        The edges, and the open nodes beyond, rad. All round they are the same place.
    exponents : (float, float) or None
        Of the pressure at the edges, (T21); None all round.
    stick : tuple of StickZone
        Its stick zones, in order.
    friction : ndarray, shape (n,)
        Coefficient of friction at its nodes.
    coupling : Coupling
        How the surfaces couple pressure and shear at its nodes.
    """

    theta: np.ndarray
    pressure: np.ndarray
    shear: np.ndarray
    edges: tuple[float, float]
    outside: tuple[float, float]
    exponents: tuple[float, float] | None
    stick: tuple[StickZone, ...]
    friction: np.ndarray
    coupling: Coupling

    def cusp(self, law: Law, sign: int, theta: np.ndarray) -> np.ndarray:
        """The cusp of N at a border of unlike bodies, at some angles, rad, shape (m,); (T26), (T52).

        The `law` of mu N - s T with this `sign` s begins with c0 x^a on the stick side, for the distance x in node
        distances. The coefficients of x^a on the slip side and on the stick side of isotropic bodies are
        -+ s beta c0 sin(pi a), with the upper sign where the stick zone lies at larger angles, and 0.
        """
        node = int(np.argmin(np.abs(self.theta - law.place)))
        first, power = float(law.coefficients[0].real), law.exponent.real
        outside = -law.inwards * (sign * float(self.coupling.cusp[sign, node])) * first * math.sin(math.pi * power)
        inside = (1.0 - float(self.coupling.share[sign, node])) / float(self.friction[node]) * first
        x = law.inwards * (theta - law.place) / law.spacing
        return np.where(x < 0.0, outside, inside) * np.abs(x) ** power


class Laws(NamedTuple):
    """The power laws of a patch.

    Attributes
    ----------
    pressure : tuple of (Law or None)
        Of N at both edges; None where the nodes show no law. Empty all round.
    borders : list of (Law, int)
        Of mu N - s T at the borders, with the sign s.
    sticking : list of Law
        Of T at edges that stick.
    unresolved : list of float
        Angles of edges and borders without a law, rad.
    """

    pressure: tuple[Law | None, ...]
    borders: list[tuple[Law, int]]
    sticking: list[Law]
    unresolved: list[float]

    @property
    def all(self) -> list[Law]:
        """All laws."""
        return [*(law for law in self.pressure if law is not None), *(law for law, _ in self.borders), *self.sticking]


def refined_tractions(
    nodes: ShearNodes, status: np.ndarray, contact: list[Interval], stick: list[tuple[np.ndarray, Interval]]
) -> RefinedTractions:
    """Refine the tractions of a state at its contact edges and stick-slip borders.

    Parameters
    ----------
    nodes : ShearNodes
    status : ndarray, shape (n,)
    contact : list of (float, float)
        The contact intervals of the runs of closed nodes, rad, in the turns of the grid.
    stick : list of (ndarray, (float, float))
        The runs of sticking nodes, each with its interval.
    """
    arrays: list[np.ndarray] = []
    resolved: list[float] = []
    unresolved: list[float] = []
    for patch in _patches(nodes, status, contact, stick):
        pressure = tuple(
            law_of_nodes(edge, half_line(exponent), patch.theta[order], patch.pressure[order])
            for edge, exponent, order in zip(patch.edges, patch.exponents or (), BOTH_ENDS, strict=False)
        )
        zones = tuple(_with_hidden_slip(patch, zone, pressure) for zone in patch.stick)
        hidden = [end for zone, was in zip(zones, patch.stick, strict=True) if zone is not was for end in zone.ends]
        laws, cusps = _laws(replace(patch, stick=zones), pressure), [cusp for zone in zones for cusp in zone.shear_laws]
        arrays.append(_refined(replace(patch, pressure=_pressure_at_borders(patch, laws), stick=zones), laws, cusps))
        resolved += [*(law.place for law in laws.all), *(cusp.place for cusp in cusps)]
        unresolved += laws.unresolved + hidden
    moment = float(nodes.grid.weights @ nodes.shear)
    excess = sum(float(np.trapezoid(array[:, 2], array[:, 0])) for array in arrays) - moment
    total = sum(float(np.trapezoid(array[:, 1], array[:, 0])) for array in arrays)
    for array in arrays:  # otherwise the errors of the fits would be a moment at the pin's centre
        array[:, 2] -= excess / total * array[:, 1]
    return RefinedTractions(Tractions(tuple(arrays)), tuple(resolved), tuple(unresolved))


def _with_hidden_slip(patch: Patch, zone: StickZone, pressure: tuple[Law | None, ...]) -> StickZone:
    """A stick zone with the slip zone at an edge that is narrower than the node distance.

    There all nodes stick, and T at the edge would exceed mu N: by a tenth, as fits of T and N tell.
    """
    for k, order in enumerate(BOTH_ENDS):
        of_pressure = pressure[k] if pressure else None
        if zone.signs[k] == 0 and of_pressure is not None and not patch.coupling.beta.any():
            nodes = zone.nodes[order]
            theta, shear = patch.theta[nodes], patch.shear[nodes]
            of_shear = fit_law(of_pressure.place, of_pressure.exponent, theta, shear)
            steepest = patch.friction[nodes[0]] * of_pressure.coefficients[0].real
            if of_shear is None or abs(of_shear.coefficients[0].real) < 1.1 * steepest:
                continue
            sign = int(np.sign(of_shear.coefficients[0].real))
            reserve = patch.friction[nodes] * patch.pressure[nodes] - sign * shear
            border = end_angle(theta, reserve, half_line(zone.exponents[k]), of_pressure.place)
            one, two = (border, zone.ends[1]) if k == 0 else (zone.ends[0], border)
            first, second = (sign, zone.signs[1]) if k == 0 else (zone.signs[0], sign)
            zone = zone._replace(ends=(one, two), signs=(first, second))
    return zone


def _laws(patch: Patch, pressure: tuple[Law | None, ...]) -> Laws:
    """The laws of a patch."""
    laws = Laws(pressure, [], [], [edge for edge, law in zip(patch.edges, pressure, strict=False) if law is None])
    for zone in patch.stick:
        for k, order in enumerate(BOTH_ENDS):
            nodes, place, sign = zone.nodes[order], zone.ends[k], zone.signs[k]
            if sign != 0:
                reserve = patch.friction[nodes] * patch.pressure[nodes] - sign * patch.shear[nodes]
                line, cusps = half_line(zone.exponents[k], float(patch.coupling.beta[nodes[0]])), zone.cusps
                inside = cusps if k == 0 else [cusp.mirrored(nodes.size) for cusp in cusps]
                found = law_of_nodes(place, line, patch.theta[nodes], reserve, inside)
                if found is not None:
                    laws.borders.append((found, sign))
            elif patch.exponents is not None:
                exponent = patch.exponents[k] + 1j * math.atanh(patch.coupling.beta[nodes[0]]) / math.pi
                found = fit_law(place, exponent, patch.theta[nodes], patch.shear[nodes])
                if found is not None:
                    laws.sticking.append(found)
            else:
                continue  # it sticks all round
            if found is None:
                laws.unresolved.append(place)
    return laws


def _refined(patch: Patch, laws: Laws, cusps: list[ShearLaw]) -> np.ndarray:
    """Angle, pressure and shear of the refined patch, shape (m, 3)."""
    graded = [_graded(law) for law in laws.all]
    reach = 20.0  # node distances on the side of a cusp within which it is refined
    graded += [cusp.place + cusp.inwards * reach * cusp.spacing * GRADED for cusp in cusps]
    if not patch.coupling.is_smooth:
        graded += [2.0 * law.place - _graded(law) for law, _ in laws.borders]
    nodes, values = _with_ends(patch, laws.pressure)
    theta = _apart(np.r_[nodes, *graded])
    theta = theta[(theta >= nodes[0]) & (theta <= nodes[-1])]
    pressure, shear = np.interp(theta, nodes, values[0]), np.interp(theta, nodes, values[1])
    friction = np.interp(theta, patch.theta, patch.friction)
    for law, sign in laws.borders:
        straight = np.interp(theta, nodes, patch.cusp(law, sign, nodes))
        missed = patch.cusp(law, sign, theta) - straight
        pressure += np.where(np.abs(theta - law.place) < 2.0 * law.reach, missed, 0.0)
    for edge_law in laws.pressure:
        if edge_law is not None:
            near = edge_law.applies(theta)
            pressure[near] = edge_law.values(theta[near])
    for start, stop, sign in _slip_zones(patch):
        inside = (theta >= start) & (theta <= stop)
        shear[inside] = sign * friction[inside] * pressure[inside]
    for law, sign in laws.borders:
        near = law.applies(theta)
        shear[near] = sign * (friction[near] * pressure[near] - law.values(theta[near]))
    for law in laws.sticking:
        near = law.applies(theta)
        shear[near] = law.values(theta[near])
    for cusp in cusps:
        near = np.abs(theta - cusp.place) < reach * cusp.spacing
        missed = cusp.values(theta) - np.interp(theta, nodes, cusp.values(nodes))
        shear[near] += missed[near]
    refined_patch = np.column_stack([theta, pressure, shear])
    refined_patch[-1, 1:] = 0.0 if patch.exponents is not None else refined_patch[0, 1:]
    if patch.exponents is not None:
        refined_patch[0, 1:] = 0.0
    return refined_patch


def _apart(angles: np.ndarray) -> np.ndarray:
    """Sorted angles, each once up to rounding. The first and the last one stay.

    A piece between equal angles has no stress.
    """
    theta = np.sort(angles)
    theta = theta[np.append(True, theta[1:] > theta[:-1])]
    stays = np.ones(theta.size, dtype=bool)
    stays[1:] = theta[1:] - theta[:-1] > 4.0 * np.spacing(max(abs(theta[0]), abs(theta[-1])))
    if not stays[-1]:
        stays[-2:] = False, True
    return theta[stays]


def _graded(law: Law) -> np.ndarray:
    """Angles in the reach of a law that gather at its end, rad."""
    return law.place + law.inwards * law.reach * GRADED


def _with_ends(patch: Patch, pressure: tuple[Law | None, ...]) -> tuple[np.ndarray, np.ndarray]:
    """Angles and tractions (2, n + k) of the nodes and of the ends of the patch, where the tractions are zero.

    An end without a law is the open node beyond the edge. The fit of an edge may put it a little inside the outermost
    node, which is then left out. All round, the first node follows once more.
    """
    values = np.array([patch.pressure, patch.shear])
    if patch.exponents is None:
        return np.r_[patch.theta, patch.theta[0] + 2.0 * math.pi], np.column_stack([values, values[:, 0]])
    start, stop = (
        edge if law is not None else outside
        for edge, outside, law in zip(patch.edges, patch.outside, pressure, strict=True)
    )
    inside = (patch.theta > start) & (patch.theta < stop)
    ends = np.zeros((2, 1))
    return np.concatenate([[start], patch.theta[inside], [stop]]), np.hstack([ends, values[:, inside], ends])


def _pressure_at_borders(patch: Patch, laws: Laws) -> np.ndarray:
    """The nodal pressure of a patch, shape (n,), with better values beside the borders of unlike bodies.

    The nodal values beside a cusp of N have errors of alternating sign. So they are taken from a fit of the nodes
    beyond, at least 4 on either side: a cubic, the cusp of (T26) and its next power.
    """
    pressure, inner, outer = patch.pressure.copy(), 2.5, 9.0  # node distances between which nodes are fitted
    for law, sign in () if patch.coupling.is_smooth else laws.borders:
        x = law.inwards * (patch.theta - law.place) / law.spacing
        others = [other.place for other in laws.all if other is not law] + laws.unresolved + list(patch.edges)
        room = min(abs(place - law.place) for place in others) / law.spacing - inner
        used = (np.abs(x) > inner) & (np.abs(x) < min(room, outer))
        if min(np.count_nonzero(used & (x < 0.0)), np.count_nonzero(used & (x > 0.0))) < 4:
            continue
        beyond = np.maximum(-x, 0.0)
        cusp = patch.cusp(law, sign, patch.theta)
        columns = np.column_stack([np.vander(x / outer, 4), (beyond / outer) ** (law.exponent.real + 1.0)])
        coefficients = np.empty(columns.shape[1])
        least_squares(columns[used], (patch.pressure - cusp)[used], coefficients)
        near = np.abs(x) <= inner
        pressure[near] = columns[near] @ coefficients + cusp[near]
    return pressure


def _slip_zones(patch: Patch) -> Iterator[tuple[float, float, int]]:
    """Slip zones of a patch: start, stop and the sign of T. Zones in which T changes its sign are left out."""
    if not patch.stick:
        zones = [(*patch.edges, int(np.sign(patch.shear[0])))]
    elif is_all_round(patch.stick[0].ends[1] - patch.stick[0].ends[0]):
        zones = []
    else:
        first, last = patch.stick[0], patch.stick[-1]
        pairs = [pair for pair in pairwise(patch.stick) if pair[0].signs[1] == pair[1].signs[0]]
        zones = [
            (patch.edges[0], first.ends[0], first.signs[0]),
            *((before.ends[1], after.ends[0], before.signs[1]) for before, after in pairs),
            (last.ends[1], patch.edges[1], last.signs[1]),
        ]
    for start, stop, sign in zones:
        inside = (patch.theta >= start) & (patch.theta <= stop)
        if np.all(np.sign(patch.shear[inside]) == sign):
            yield start, stop, sign


def _patches(
    nodes: ShearNodes, status: np.ndarray, contact: list[Interval], stick: list[tuple[np.ndarray, Interval]]
) -> Iterator[Patch]:
    """The contact intervals of a state. All round, the first node is one that sticks."""
    grid = nodes.grid
    left, right = grid.halves
    for run, edges in zip(runs(grid, status != OPEN), contact, strict=True):
        whole = is_all_round(edges[1] - edges[0])
        exponents = None if whole else contact_exponents(status, nodes.coupling.tilt, run)
        if whole and stick:
            run = np.roll(run, -int(np.flatnonzero(run == stick[0][0][0])[0]))
        theta = unrolled(grid, run)
        if whole:
            edges = float(theta[0]), float(theta[0]) + 2.0 * math.pi
        outside = theta[0] - left[run[0]], theta[-1] + right[run[-1]]
        yield Patch(
            theta, nodes.pressure[run], nodes.shear[run], edges, outside, exponents,
            _zones(nodes, stick, run), nodes.friction[run], nodes.coupling.at(run),
        )  # fmt: skip


def _zones(nodes: ShearNodes, stick: list[tuple[np.ndarray, Interval]], run: np.ndarray) -> tuple[StickZone, ...]:
    """The stick zones in the contact of the nodes `run`, in their order there. They may cross the first node."""
    places = np.full(nodes.grid.size, -1)
    places[run] = np.arange(run.size)
    # At a cusp under a higher pressure the hoop stress is no peak.
    zones, most = [], 0.6 * float(nodes.pressure[run].max())
    for inside, ends in stick:
        if places[inside[0]] >= 0:
            signs, exponents = (
                signs_beside(nodes.shear, inside),
                stick_exponents(nodes.shear, nodes.coupling.tilt, inside),
            )
            shear_laws = tuple(nodes.shear_laws(inside, most))
            zones.append(StickZone(ends, places[inside], signs, exponents, nodes.old_borders(inside), shear_laws))
    return tuple(sorted(zones, key=lambda zone: int(zone.nodes[0])))
