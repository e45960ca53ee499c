"""The interfaces of a joint of several pins, and the conditions of equilibrium and coherence of its bodies.

The unknown motions are, for each interface, the motion (c_x, c_y, omega) of the inner body over the outer one, and the
motions of each plate that is not held. The conditions are the equilibrium of every pin, ring and plate, and the
coherence of a pin in its plates:

    first plate of a pin    sum over its plates of t (F + e c) = force on the pin, for x and y
    each further section    what ties the sections of a pin, see :mod:`fastpin.joints.bending`, for x and y
    rotations               one moment for all plates of a pin; equal rotations
    ring                    F + e c of its outer interface less that of the inner one = 0, and so the moment
    a driven pin            D of its first section = the displacement that is given, in place of the first condition
    plate that moves        the work of all t (F + e c), of moments, of friction of faying surfaces and of its loads on
                            each of its motions = 0; or the motion = the displacement that is given

F is the force of the inner body on the outer one per thickness, t the thickness, and D = c + plate's displacement +
g F - k J the displacement of the pin's section, (T29) of docs/theory.md; with a ring c + g F - k J is the sum of both
interfaces, less the displacement of the ring's bore over its outer rim that both have. A weak spring of stiffness e
holds every pin in the middle of its holes and rings until it touches, and later where it was released: c of e c counts
from there. It changes forces by 1e-6.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from fastpin.elasticity.interfaces import TURN, Nodes, moved_twice, rim_twist
from fastpin.elasticity.system import System
from fastpin.joints.bending import Coherence
from fastpin.model.loads import LOADS
from fastpin.model.problem import Problem

CENTRING = 1e-6
"""Stiffness e of the springs that hold loose pins, times beta*. Forces change by as much. With 1e-7 a path was lost
where a loose pin touches; with 1e-12 the first matrix is singular."""


@dataclass(frozen=True, eq=False)
class PinSection:
    """An interface of a pin in one plate: its own, or that of a ring round it.

    Attributes
    ----------
    pin, plate : int
        Places of both among the pins and plates.
    hole : int
        Place of the hole among those of its plate.
    at : complex
        Its centre, counted from the first hole of the plate, over R.
    problem : Problem
        The pin in an infinite plate of this material, the pin in the ring, or the ring in an infinite plate.
    thickness : float
        Thickness of the plate, or of the slice, in units of the first plate.
    slices : int
        Number of slices of the plate.
    radius : float
        Radius of the interface over R.
    """

    pin: int
    plate: int
    hole: int
    at: complex
    problem: Problem
    thickness: float
    slices: int = 1
    radius: float = 1.0

    def compliances(self, beta: float) -> tuple[float, float]:
        """The compliances g and k of (T29) over `beta`. The gauge circle is the edge of the hole, or of the ring."""
        joint = self.problem.joint
        of_pin, unit = (
            np.array(joint.pin_body.translation(joint.pin_rim, joint.pin_load, None)),
            joint.pin_rim.compliance,
        )
        around = np.array(joint.plate_body.translation(joint.hole, None)) / (4.0 * math.pi * beta)
        own, coupling = 2.0 * of_pin / unit / (8.0 * math.pi * self.problem.pair.pin.shear_modulus * beta) + around
        return float(own), float(coupling)

    def felt(self, other: PinSection, holes: int) -> float:
        """How much of the smooth compliance of the plate this section feels of another one, or of itself.

        In a plate with several of its holes pinned all slices share their mean tractions. With one hole each slice is a
        plate by itself.
        """
        if holes == 1 or self.plate != other.plate:
            return float(self is other)
        return 1.0 / self.slices


class RingBetween(NamedTuple):
    """A ring between two interfaces.

    Attributes
    ----------
    inner, outer : int
        The places of the interfaces at its bore and at its outer rim.
    bonded : bool
        Whether its outer rim is bonded: it must neither slip nor open.
    """

    inner: int
    outer: int
    bonded: bool


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

    of_pins : ndarray of int, shape (pins, 2)
        The load that is the displacement of a pin along x or y, in place of the force; -1 for none.
    of_plates : ndarray of int, shape (moving,)
        The load that is the motion of a plate; -1 for none.

    Two more loads follow: the fit, from 0 to 1, and the springs of loose pins, which is always 1.
    """

    pins: np.ndarray
    moving: Sequence[Motion]
    plates: np.ndarray
    columns: Sequence[tuple[int, str, int]]
    of_pins: np.ndarray
    of_plates: np.ndarray


def sections_of_pins(sections: Sequence[PinSection], rings: Sequence[RingBetween]) -> list[list[int]]:
    """The places of the sections of each pin."""
    count, outer = 1 + max(each.pin for each in sections), {ring.outer for ring in rings}
    own = [(place, each.pin) for place, each in enumerate(sections) if place not in outer]
    return [[place for place, of in own if of == pin] for pin in range(count)]


def is_smooth(sections: Sequence[PinSection], members: Sequence[int]) -> bool:
    """Whether a pin with these sections has no friction in any of its plates: then nothing turns it."""
    return all(sections[place].problem.frictionless for place in members)


class _Conditions:
    """The conditions of equilibrium and coherence while they are filled, row by row.

    Attributes
    ----------
    equilibrium : ndarray, shape (m, 2n)
    rows, springs : ndarray, shape (m, m)
        The part of the motion, without that of the springs of loose pins; and that of the springs.
    forces : ndarray, shape (m, loads)
        The right sides per unit of each load.
    """

    def __init__(
        self,
        sections: Sequence[PinSection],
        alone: Sequence[System],
        nodes: Nodes,
        given: JointLoads,
        rings: Sequence[RingBetween],
    ) -> None:
        self._sections, self._alone, self._nodes, self._given = sections, alone, nodes, given
        self._beta = alone[0].scales.displacement / alone[0].scales.force
        self._around = {ring.inner: ring.outer for ring in rings}
        total = 3 * len(sections) + len(given.moving)
        self.equilibrium = np.zeros((total, 2 * nodes.size))
        self.rows, self.springs = np.zeros((total, total)), np.zeros((total, total))
        self._user = slice(len(LOADS), len(LOADS) + given.pins.shape[2])
        self.forces = np.zeros((total, self._user.stop + 2))

    def add_pin(self, pin: int, members: list[int], ties: Coherence) -> None:
        """Add the equilibrium of a pin, or where it is driven its displacement; and what ties its sections."""
        sections, head, driven = self._sections, 3 * members[0], self._given.of_pins[pin]
        self.forces[head : head + 2, self._user] = on_pin = self._given.pins[pin]
        for axis, load in enumerate(driven):
            if load >= 0:
                self.add_displacement(head + axis, members[0], axis, 1.0)
                self.forces[head + axis, self._user.start + load] = 1.0
                continue
            for place in members:
                self.add_force(head + axis, place, axis, sections[place].thickness)
        if is_smooth(sections, members):
            self.rows[head + TURN, head + TURN] = 1.0
        else:
            for place in members:
                self.add_moment(head + TURN, place, sections[place].thickness)
        for before, place in itertools.pairwise(members):
            self.add_displacement(3 * place + TURN, before, TURN, 1.0)
            self.add_displacement(3 * place + TURN, place, TURN, -1.0)
        for place, by_moved, by_forces, outside in zip(members[1:], *ties, strict=True):
            for axis in (0, 1):
                row = 3 * place + axis
                reaction = outside if driven[axis] >= 0 else 0.0  # it is what all sections pass on
                for other, moved, force in zip(members, by_moved, by_forces, strict=True):
                    self.add_displacement(row, other, axis, moved)
                    self.add_force(row, other, axis, (force - reaction) * sections[other].thickness)
                self.forces[row, self._user] += outside * on_pin[axis]

    def add_plate(self, number: int) -> None:
        """Add the work on a motion of a plate, or where it is driven its displacement."""
        row, motion = 3 * len(self._sections) + number, self._given.moving[number]
        if (load := self._given.of_plates[number]) >= 0:
            self.rows[row, row] = self.forces[row, self._user.start + load] = 1.0
            return
        for place, each in enumerate(self._sections):
            if each.plate == motion.plate and place not in self._around:
                x, y, turned = motion.at(each.at)
                self.add_force(row, place, 0, each.thickness * x)
                self.add_force(row, place, 1, each.thickness * y)
                self.add_moment(row, place, each.thickness * turned)
        self.forces[row, self._user] = -self._given.plates[number]

    def add_force(self, row: int, place: int, axis: int, factor: float) -> None:
        """Add the force at an interface, with the spring that holds its inner body while it is loose."""
        self.equilibrium[row, self._nodes.rows(place)] += (
            self._lever(place, factor) * self._alone[place].equilibrium[axis]
        )
        self.springs[row, 3 * place + axis] += factor * CENTRING

    def add_moment(self, row: int, place: int, factor: float) -> None:
        """Add the moment at an interface, with the spring."""
        shear, lever = self._shear(place), self._lever(place, self._lever(place, factor))
        self.equilibrium[row, shear] -= lever * self._alone[place].weights
        self.springs[row, 3 * place + TURN] += factor * CENTRING

    def add_displacement(self, row: int, place: int, axis: int, sign: float) -> None:
        """Add the displacement of a section, (T29), or its rotation. `place` is that of the pin's own interface."""
        while place in self._around:
            self._add_relative(row, place, axis, sign)
            self._add_ring(row, self._around[place], axis, sign)
            place = self._around[place]
        self._add_relative(row, place, axis, sign)
        for number, motion in enumerate(self._given.moving, start=3 * len(self._sections)):
            if motion.plate == self._sections[place].plate:
                self.rows[row, number] += sign * motion.at(self._sections[place].at)[axis]

    def _add_relative(self, row: int, place: int, axis: int, sign: float) -> None:
        """Add the displacement of the inner body at an interface over the outer one, or its rotation."""
        self.rows[row, 3 * place + axis] += sign
        if axis != TURN:
            g, k = self._sections[place].compliances(self._beta)
            cos, sin = self._nodes.grids[place].trig_moments()
            along = self._alone[place].equilibrium[axis]
            integral = (np.r_[cos, -sin], np.r_[sin, cos])[axis]
            self.equilibrium[row, self._nodes.rows(place)] += self._lever(place, sign) * (g * along - k * integral)

    def _add_ring(self, row: int, place: int, axis: int, sign: float) -> None:
        """Add what a ring moves or turns beside both its interfaces. `place` is that of the outer one."""
        problem = self._sections[place].problem
        if axis != TURN:
            by = sign * moved_twice(problem) / self._beta
            self.equilibrium[row, self._nodes.rows(place)] += (
                self._lever(place, by) * self._alone[place].equilibrium[axis]
            )
        else:
            twist = rim_twist(problem) / self._beta
            self.equilibrium[row, self._shear(place)] += sign * twist * self._nodes.grids[place].weights

    def _lever(self, place: int, factor: float) -> float:
        return self._sections[place].radius * factor

    def _shear(self, place: int) -> np.ndarray:
        """The rows of the shears of an interface."""
        return self._nodes.rows(place)[self._nodes.grids[place].size :]


def conditions_of(
    sections: Sequence[PinSection],
    alone: Sequence[System],
    nodes: Nodes,
    given: JointLoads,
    coherence: Sequence[Coherence],
    rings: Sequence[RingBetween],
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """The conditions of equilibrium and coherence: of the tractions, the motion, the springs in it, and the loads."""
    found = _Conditions(sections, alone, nodes, given, rings)
    for pin, (members, ties) in enumerate(zip(sections_of_pins(sections, rings), coherence, strict=True)):
        found.add_pin(pin, members, ties)
    for ring in rings:
        for place, sign in ((ring.outer, 1.0), (ring.inner, -1.0)):
            for axis in (0, 1):
                found.add_force(3 * ring.outer + axis, place, axis, sign * sections[place].thickness)
            if not is_smooth(sections, (ring.outer, ring.inner)):
                found.add_moment(3 * ring.outer + TURN, place, sign * sections[place].thickness)
        if is_smooth(sections, (ring.outer, ring.inner)):
            found.rows[3 * ring.outer + TURN, 3 * ring.outer + TURN] = 1.0
    for number in range(len(given.moving)):
        found.add_plate(number)
    return found.equilibrium, found.rows + found.springs, found.springs, found.forces
