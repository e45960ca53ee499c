"""The matrices of a joint of several pins and plates.

An interface is a pin in the hole of one plate. Each is a :class:`fastpin.elasticity.system.System` of its own, of a pin
in an infinite plate; a plate couples the interfaces of its holes through few harmonics, see
:class:`fastpin.joints.ports.Ports`. The unknown motions are, for each interface, the motion (c_x, c_y, omega) of
the pin over the plate, and the motions of each plate that is not held. The conditions are the equilibrium of every pin
and plate, and the coherence of a pin in its plates:

    first plate of a pin    sum over its plates of t (F + e c) = force on the pin, for x and y
    each further section    what ties the sections of a pin, see :mod:`fastpin.joints.bending`, for x and y
    rotations               one moment for all plates of a pin; equal rotations
    plate that moves        the work of all t (F + e c), of moments, of friction of faying surfaces and of its loads on
                            each of its motions = 0

F is the force of the pin on the plate per thickness, t the thickness, and D = c + plate's displacement + g F - k J the
displacement of the pin's section, (T29) of docs/theory.md. A weak spring of stiffness e holds every pin in the middle
of its holes until it touches, and later where it was released: c of e c counts from there. It changes forces by 1e-6.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from fastpin.bodies.compliance import basis
from fastpin.elasticity.drive import Drive
from fastpin.elasticity.interfaces import TURN, Nodes
from fastpin.elasticity.operator import LARGEST_DENSE, DenseOperator
from fastpin.elasticity.system import Interface, System
from fastpin.joints.bending import Coherence
from fastpin.joints.faying import SIDES, SPREAD, FayingSurface, rim_basis, rows_of
from fastpin.joints.ports import PortColumns, Ports
from fastpin.lugs.several_holes import HolesCompliance
from fastpin.model.grid import Grid
from fastpin.model.loads import LOADS, P, Q
from fastpin.model.problem import Problem

CENTRING = 1e-6
"""Stiffness e of the springs that hold loose pins, times beta*. Forces change by as much. With 1e-7 a path was lost
where a loose pin touches; with 1e-12 the first matrix is singular."""

FAR = 1e-12
"""Least displacement of a hole by the other ones that counts, in parts of its own compliance."""


@dataclass(frozen=True, eq=False)
class PinSection:
    """A pin in one plate.

    Attributes
    ----------
    pin, plate : int
        Places of both among the pins and plates.
    hole : int
        Place of the hole among those of its plate.
    at : complex
        Its centre, counted from the first hole of the plate, over R.
    problem : Problem
        The pin in an infinite plate of this material.
    thickness : float
        Thickness of the plate, or of the slice, in units of the first plate.
    slices : int
        Number of slices of the plate.
    """

    pin: int
    plate: int
    hole: int
    at: complex
    problem: Problem
    thickness: float
    slices: int = 1

    def felt(self, other: PinSection, holes: int) -> float:
        """How much of the smooth compliance of the plate this section feels of another one, or of itself.

        In a plate with several of its holes pinned all slices share their mean tractions. With one hole each slice is a
        plate by itself.
        """
        if holes == 1 or self.plate != other.plate:
            return float(self is other)
        return 1.0 / self.slices


class Motion(NamedTuple):
    """A motion of a plate: a displacement everywhere, a unit vector, or a rotation about its first hole.

    Attributes
    ----------
    plate : int
    way : complex
        0 for a rotation.
    """

    plate: int
    way: complex

    def at(self, place: complex) -> tuple[float, float, float]:
        """Displacement along x and y and rotation at a place of the plate, counted from its first hole."""
        way = self.way or 1j * place
        return way.real, way.imag, 0.0 if self.way else 1.0


@dataclass(frozen=True, eq=False)
class JointLoads:
    """What the loads of a joint do, dimensionless and in their order.

    Attributes
    ----------
    pins : ndarray, shape (pins, 2, loads)
        Force on each pin along x and y per unit of each load.
    moving : sequence of Motion
        Motions of the plates that are not held.
    plates : ndarray, shape (moving, loads)
        Work of each load on these motions.
    columns : sequence of (int, str, int)
        Loads within plates: the plate, the name of its column, the place of the load.
    fit : ndarray, shape (sections,)
        How far the fit opens the gap of each section, over R.

    Two more loads follow: the fit, from 0 to 1, and the springs of loose pins, which is always 1.
    """

    pins: np.ndarray
    moving: Sequence[Motion]
    plates: np.ndarray
    columns: Sequence[tuple[int, str, int]]
    fit: np.ndarray


@dataclass(frozen=True, eq=False)
class PinsSystem(System):
    """The system of several pins in several plates. The loads of the joint stand behind those of a single pin.

    The load vector ends with the fit and with the springs, see :class:`JointLoads`.

    Attributes
    ----------
    nodes : Nodes
    sections : tuple of PinSection
        The interfaces, pin by pin and through the thickness.
    given : JointLoads
    integrals : tuple of ndarray, shape (2 + 4 K, 2n)
        Coefficients of the traction of each section in the basis of a compliance, per traction at its nodes.
    springs : ndarray, shape (m, m)
        The part of ``motion_rows`` that the springs of loose pins give.
    faying : tuple of FayingSurface
        Their sides stand behind the nodes of the contacts.
    ports : Ports or None
        What passes between the interfaces; None with faying surfaces.
    """

    nodes: Nodes = field(kw_only=True)
    sections: tuple[PinSection, ...] = field(kw_only=True)
    given: JointLoads = field(kw_only=True)
    integrals: tuple[np.ndarray, ...] = field(kw_only=True)
    springs: np.ndarray = field(kw_only=True)
    faying: tuple[FayingSurface, ...] = field(kw_only=True)
    ports: Ports | None = field(kw_only=True)

    @property
    def is_toeplitz(self) -> bool:
        return False

    @property
    def _acting(self) -> int:
        return self.loads.shape[1]

    @cached_property
    def interfaces(self) -> tuple[Interface, ...]:
        parts = enumerate(zip(self.sections, self.nodes.grids, self.nodes.parts, strict=True))
        return tuple(Interface(each.problem, grid, nodes, 3 * place, 1.0) for place, (each, grid, nodes) in parts)

    @cached_property
    def sides(self) -> list[slice]:
        """The nodes of the sides of each faying surface."""
        return rows_of(self.faying, self.nodes.parts[-1].stop)

    @cached_property
    def ends(self) -> np.ndarray:
        return np.zeros(self.nodes.size, dtype=bool)

    @cached_property
    def pins(self) -> list[list[int]]:
        """The sections of each pin."""
        return _sections_of_pins(self.sections)

    def is_smooth(self, pin: int) -> bool:
        """Whether nothing turns a pin."""
        return _is_smooth(self.sections, self.pins[pin])

    @cached_property
    def turning(self) -> tuple[slice, ...]:
        parts = self.nodes.parts
        return tuple(
            slice(parts[of[0]].start, parts[of[-1]].stop) for pin, of in enumerate(self.pins) if not self.is_smooth(pin)
        )

    @cached_property
    def of_pins(self) -> np.ndarray:
        """Whether a condition is the equilibrium of a pin, bool, shape (m,). It stands with the pin's first section."""
        found = np.zeros(self.motions, dtype=bool)
        for members in self.pins:
            found[3 * members[0] : 3 * members[0] + 3] = True
        return found

    def columns(self, *given: Any) -> PortColumns | None:
        return None if self.ports is None else PortColumns(self, self.ports, *given)

    def resting(self, rest: np.ndarray) -> PinsSystem:
        """The same system with springs that are slack at the motion `rest` (m,)."""
        forces = self.forces.copy()
        forces[:, -1] = self.springs @ rest
        return replace(self, forces=forces, held_as=self.held_as or self)

    def passed(self, tractions: np.ndarray) -> np.ndarray:
        """Force along x and y and moment of each section on its plate per thickness, shape (sections, 3)."""
        found: np.ndarray = (self.resultants @ tractions).reshape(-1, 3)
        return found

    def rubbed(self, tractions: np.ndarray) -> np.ndarray:
        """Force of friction of each faying surface on its first plate, shape (surfaces, 2)."""
        shears = tractions[self.nodes.size + self.nodes.parts[-1].stop :]
        return shears.reshape(-1, SIDES) @ SPREAD.T


def _sections_of_pins(sections: Sequence[PinSection]) -> list[list[int]]:
    """The places of the sections of each pin."""
    count = 1 + max(each.pin for each in sections)
    return [[place for place, each in enumerate(sections) if each.pin == pin] for pin in range(count)]


def _is_smooth(sections: Sequence[PinSection], members: Sequence[int]) -> bool:
    """Whether a pin with these sections has no friction in any of its plates: then nothing turns it."""
    return all(sections[place].problem.frictionless for place in members)


def build(
    sections: Sequence[PinSection],
    plates: Sequence[HolesCompliance],
    given: JointLoads,
    grids: Sequence[Grid],
    force: float,
    coherence: Sequence[Coherence],
    faying: Sequence[FayingSurface] = (),
) -> PinsSystem:
    """Fill the matrices of a joint with reference force `force`, N/m.

    Parameters
    ----------
    sections : sequence of PinSection
        Pin by pin, and through the thickness.
    plates : sequence of HolesCompliance
    given : JointLoads
    grids : sequence of Grid
        The nodes of each section, all round.
    force : float
    coherence : sequence of Coherence
        What ties the sections of each pin.
    faying : sequence of FayingSurface
    """
    nodes = Nodes(tuple(grids), SIDES * len(faying))
    alone = [System.build(each.problem, grid, force) for each, grid in zip(sections, grids, strict=True)]
    scales, size = alone[0].scales, nodes.size
    stretch = [system.scales.displacement / scales.displacement for system in alone]
    matrix = np.zeros((2 * size, 2 * size), order="F")
    motion = np.zeros((2 * size, 3 * len(sections) + len(given.moving)))
    loads = np.zeros((2 * size, len(LOADS) + given.pins.shape[2] + 2))
    for a, (one, system) in enumerate(zip(sections, alone, strict=True)):
        own = nodes.rows(a)
        local = system.operator.entries()  # the forces of the pins are no loads here: their columns join the operator
        local += system.loads[:, [Q, P]] @ (system.equilibrium[:2] * [[1.0], [-1.0]])
        matrix[np.ix_(own, own)] = stretch[a] * local
        motion[own, 3 * a : 3 * a + 3] = system.motion
        loads[own[: own.size // 2], -2] = given.fit[a] * one.problem.hole_radius / scales.displacement
    bases = [basis(plates[each.plate].block(0, 0), grid) for each, grid in zip(sections, grids, strict=True)]
    rims = [(each, nodes.rows(a), *bases[a]) for a, each in enumerate(sections)]
    beta = scales.displacement / force
    equilibrium, rows, springs, forces = _conditions(sections, alone, nodes, given, coherence, beta)
    rims += _faying_rims(faying, sections, plates, given, nodes, matrix, motion, loads)
    has_ports = not faying and all(each.slices == 1 for each in sections)
    is_stored = not has_ports or size <= LARGEST_DENSE
    equilibrium[:, size + nodes.parts[-1].stop :] = motion[size + nodes.parts[-1].stop :].T  # work on moving plates
    for one, own, out, _ in rims:
        plate, unit = plates[one.plate], force / (one.problem.pair.plate.shear_modulus * scales.displacement)
        for other, columns, _, into in rims:
            if (felt := one.felt(other, plate.holes)) and (is_stored or other is one):
                matrix[np.ix_(own, columns)] += unit * (out @ (felt * plate.block(one.hole, other.hole) @ into))
        for _, name, place in (column for column in given.columns if column[0] == one.plate):
            loads[own, len(LOADS) + place] += unit * (out @ plate.column(name, one.hole))
    ports = _ports(sections, plates, nodes, matrix, motion, equilibrium, bases, beta) if has_ports else None
    loose = [np.maximum(s * each.concentric_gap, 0.0) for s, each in zip(stretch, alone, strict=True)]
    return PinsSystem(
        problem=sections[0].problem, grid=nodes, scales=scales, rest_clearance=0.0,  # type: ignore[arg-type]
        operator=DenseOperator(matrix) if ports is None or is_stored else ports, ports=ports,
        motion=motion, loads=loads, equilibrium=equilibrium, motion_rows=rows,
        forces=forces, plate=0.0, drive=Drive(motion[:, :2], loads), nodes=nodes, sections=tuple(sections), given=given,
        integrals=tuple(each[1] for each in bases), springs=springs, faying=tuple(faying),
        friction=np.concatenate([*(each.friction for each in alone), np.repeat([s.limit for s in faying], SIDES)]),
        initial_gap=np.concatenate([*loose, np.zeros(nodes.further)]),
        weights=np.concatenate([*(each.weights for each in alone), np.ones(nodes.further)]),
    )  # fmt: skip


def _faying_rims(
    faying: Sequence[FayingSurface],
    sections: Sequence[PinSection],
    plates: Sequence[HolesCompliance],
    given: JointLoads,
    nodes: Nodes,
    matrix: np.ndarray,
    motion: np.ndarray,
    loads: np.ndarray,
) -> list[tuple[PinSection, np.ndarray, np.ndarray, np.ndarray]]:
    """Fill in what faying surfaces do without the compliance of the plates. Returns the rims on which they act.

    A rim is a section, the rows of its nodes, and its basis in the harmonics of the hole.
    """
    rims = []
    for surface, sides in zip(faying, rows_of(faying, nodes.parts[-1].stop), strict=True):
        normal = np.arange(sides.start, sides.stop)
        shear = nodes.size + normal
        matrix[normal, normal], loads[normal, -1] = 1.0, -1.0  # their pressure is 1 with the load of the springs
        matrix[np.ix_(shear, shear)] = surface.compliance()
        for place, sign in surface.signs:
            one = sections[place]
            rims.append((one, shear, *rim_basis(len(plates[one.plate].block(0, 0)), sign, one.thickness)))
            for number, moving in enumerate(given.moving, start=3 * len(sections)):
                if moving.plate == one.plate:
                    motion[shear, number] += sign * (moving.at(one.at)[:2] @ SPREAD)
    return rims


def _far_harmonics(sections: Sequence[PinSection], plates: Sequence[HolesCompliance]) -> list[np.ndarray]:
    """What the other holes of a plate feel of each section, and what it feels of them: orthonormal, (2 + 4 K, r)."""
    found, sizes = [], []
    for each in sections:
        plate = plates[each.plate]
        blocks = [plate.block(each.hole, other) for other in range(plate.holes) if other != each.hole]
        vectors, values, _ = np.linalg.svd(np.hstack([np.zeros_like(plate.block(0, 0)), *blocks]), full_matrices=False)
        found.append(vectors)
        sizes.append(int(np.count_nonzero(values > FAR)))
    most = max(sizes)
    return [np.pad(vectors[:, :size], ((0, 0), (0, most - size))) for vectors, size in zip(found, sizes, strict=True)]


def _ports(
    sections: Sequence[PinSection],
    plates: Sequence[HolesCompliance],
    nodes: Nodes,
    matrix: np.ndarray,
    motion: np.ndarray,
    equilibrium: np.ndarray,
    bases: Sequence[tuple[np.ndarray, np.ndarray]],
    beta: float,
) -> Ports:
    """The ports of the sections: five integrals of the tractions, three motions, and the far harmonics."""
    far = _far_harmonics(sections, plates)
    count, modes, motions = len(sections), far[0].shape[1], motion.shape[1]
    rows = np.array([nodes.rows(place) for place in range(count)])
    size, sums = rows.shape[1], min(5, motions)
    tables = np.zeros((count, size + sums + modes, size + 3 + modes))
    places = np.arange(count)[:, None]
    inputs = np.hstack([3 * places + np.arange(3), motions + modes * places + np.arange(modes)])
    couplings = np.zeros((motions + count * modes, count, sums + modes))
    for a, (one, (waves, integrals)) in enumerate(zip(sections, bases, strict=True)):
        factors, sizes, passed = np.linalg.svd(equilibrium[:, rows[a]], full_matrices=False)
        tables[a, :size, :size] = matrix[np.ix_(rows[a], rows[a])]
        tables[a, :size, size : size + 3] = motion[rows[a], 3 * a : 3 * a + 3]
        tables[a, :size, size + 3 :] = waves @ far[a] / (one.problem.pair.plate.shear_modulus * beta)
        tables[a, size : size + sums, :size] = passed[:sums]
        tables[a, size + sums :, :size] = far[a].T @ integrals
        couplings[:motions, a, :sums] = factors[:, :sums] * sizes[:sums]
        for b, other in enumerate(sections):
            if other.plate == one.plate and b != a:
                felt = slice(motions + b * modes, motions + (b + 1) * modes)
                block = plates[one.plate].block(other.hole, one.hole)
                couplings[felt, a, sums:] = -far[b].T @ block @ far[a]
    of_plates = [[place for place, each in enumerate(sections) if each.plate == plate] for plate in range(len(plates))]
    return Ports(rows, tables, motions, inputs, couplings.reshape(len(couplings), -1), of_plates)


class _Conditions:
    """The conditions of equilibrium and coherence while they are filled, row by row.

    Attributes
    ----------
    equilibrium : ndarray, shape (m, 2n)
    rows, springs : ndarray, shape (m, m)
        The part of the motion, without that of the springs of loose pins; and that of the springs.
    """

    def __init__(
        self, sections: Sequence[PinSection], alone: Sequence[System], nodes: Nodes, given: JointLoads, beta: float
    ) -> None:
        self._sections, self._alone, self._nodes, self._given, self._beta = sections, alone, nodes, given, beta
        total = 3 * len(sections) + len(given.moving)
        self.equilibrium = np.zeros((total, 2 * nodes.size))
        self.rows, self.springs = np.zeros((total, total)), np.zeros((total, total))

    def add_force(self, row: int, place: int, axis: int, factor: float) -> None:
        """Add the force of a pin on a plate, with the spring that holds it while it is loose."""
        self.equilibrium[row, self._nodes.rows(place)] += factor * self._alone[place].equilibrium[axis]
        self.springs[row, 3 * place + axis] += factor * CENTRING

    def add_moment(self, row: int, place: int, factor: float) -> None:
        """Add the moment of a pin on a plate, with the spring."""
        shear = self._nodes.rows(place)[self._nodes.grids[place].size :]
        self.equilibrium[row, shear] -= factor * self._alone[place].weights
        self.springs[row, 3 * place + TURN] += factor * CENTRING

    def add_displacement(self, row: int, place: int, axis: int, sign: float) -> None:
        """Add the displacement of a section, (T29), or its rotation."""
        self.rows[row, 3 * place + axis] += sign
        for number, motion in enumerate(self._given.moving, start=3 * len(self._sections)):
            if motion.plate == self._sections[place].plate:
                self.rows[row, number] += sign * motion.at(self._sections[place].at)[axis]
        if axis != TURN:
            modulus = self._sections[place].problem.pair.pin.shear_modulus
            g = k = 1.0 / (8.0 * math.pi * modulus * self._beta)
            cos, sin = self._nodes.grids[place].trig_moments()
            along = self._alone[place].equilibrium[axis]
            integral = (np.r_[cos, -sin], np.r_[sin, cos])[axis]
            self.equilibrium[row, self._nodes.rows(place)] += sign * (g * along - k * integral)


def _conditions(
    sections: Sequence[PinSection],
    alone: Sequence[System],
    nodes: Nodes,
    given: JointLoads,
    coherence: Sequence[Coherence],
    beta: float,
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """The conditions of equilibrium and coherence: of the tractions, the motion, the springs in it, and the loads."""
    found, count = _Conditions(sections, alone, nodes, given, beta), 3 * len(sections)
    user = slice(len(LOADS), len(LOADS) + given.pins.shape[2])
    forces = np.zeros((len(found.rows), user.stop + 2))
    for members, on_pin, ties in zip(_sections_of_pins(sections), given.pins, coherence, strict=True):
        head = 3 * members[0]
        forces[head : head + 2, user] = on_pin
        for place in members:
            for axis in (0, 1):
                found.add_force(head + axis, place, axis, sections[place].thickness)
        if _is_smooth(sections, members):
            found.rows[head + TURN, head + TURN] = 1.0
        else:
            for place in members:
                found.add_moment(head + TURN, place, sections[place].thickness)
        for before, place in itertools.pairwise(members):
            found.add_displacement(3 * place + TURN, before, TURN, 1.0)
            found.add_displacement(3 * place + TURN, place, TURN, -1.0)
        for place, by_moved, by_forces, outside in zip(members[1:], *ties, strict=True):
            for axis in (0, 1):
                row = 3 * place + axis
                for other, moved, force in zip(members, by_moved, by_forces, strict=True):
                    found.add_displacement(row, other, axis, moved)
                    found.add_force(row, other, axis, force * sections[other].thickness)
                forces[row, user] += outside * on_pin[axis]
    for row, motion in enumerate(given.moving, start=count):
        for place, each in enumerate(sections):
            if each.plate == motion.plate:
                x, y, turned = motion.at(each.at)
                found.add_force(row, place, 0, each.thickness * x)
                found.add_force(row, place, 1, each.thickness * y)
                found.add_moment(row, place, each.thickness * turned)
        forces[row, user] = -given.plates[row - count]
    return found.equilibrium, found.rows + found.springs, found.springs, forces
