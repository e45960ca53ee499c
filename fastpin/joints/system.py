"""The matrices of a joint of several pins and plates.

An interface is a pin in the hole of one plate, a pin in a ring, or a ring in the hole. Each is a
:class:`fastpin.elasticity.system.System` of its own, with a radius of its own, of a pin in an infinite plate or in a
ring; a plate couples the interfaces of its holes through few harmonics, see :class:`fastpin.joints.ports.Ports`, and a
ring those on its two rims. :mod:`fastpin.joints.conditions` has the motions and the conditions.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from fastpin.bodies.compliance import basis
from fastpin.elasticity.drive import Drive
from fastpin.elasticity.interfaces import Nodes, across_ring
from fastpin.elasticity.operator import LARGEST_DENSE, DenseOperator
from fastpin.elasticity.system import Interface, System
from fastpin.joints.bending import Coherence
from fastpin.joints.conditions import JointLoads, PinSection, RingBetween, conditions_of, is_smooth, sections_of_pins
from fastpin.joints.faying import SIDES, SPREAD, FayingSurface, rim_basis, rows_of
from fastpin.joints.ports import PortColumns, Ports
from fastpin.lugs.several_holes import HolesCompliance
from fastpin.model.grid import Grid
from fastpin.model.loads import LOADS, P, Q

PinnedEdge = tuple[PinSection, np.ndarray, np.ndarray, np.ndarray]
"""The edge of a hole: a section, the rows of its nodes, and its basis in the harmonics of the hole."""

FIT = -2
"""Place of the fit in a load vector: how far it opens the gaps."""

FAR = 1e-9
"""Least displacement of a hole by the other ones that counts, in parts of its own compliance."""


@dataclass(frozen=True, eq=False)
class PinsSystem(System):
    """The system of several pins in several plates. The loads of the joint stand behind those of a single pin.

    The load vector ends with the fit and with the springs, see :class:`JointLoads`.

    Attributes
    ----------
    nodes : Nodes
    sections : tuple of PinSection
        The interfaces of the pins, pin by pin and through the thickness, and then those round rings.
    rings : tuple of RingBetween
    given : JointLoads
    integrals : dict of int to ndarray, shape (2 + 4 K, 2n)
        Coefficients of the traction on a plate in the basis of a compliance, per traction at the nodes of an interface,
        by the place of the interface.
    springs : ndarray, shape (m, m)
        The part of ``motion_rows`` that the springs of loose pins give.
    faying : tuple of FayingSurface
        Their sides stand behind the nodes of the contacts.
    ports : Ports or None
        What passes between the interfaces; None with faying surfaces, slices or rings.
    """

    nodes: Nodes = field(kw_only=True)
    sections: tuple[PinSection, ...] = field(kw_only=True)
    rings: tuple[RingBetween, ...] = field(kw_only=True)
    given: JointLoads = field(kw_only=True)
    integrals: Mapping[int, np.ndarray] = field(kw_only=True)
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
        return tuple(
            Interface(each.problem, grid, nodes, 3 * place, each.radius) for place, (each, grid, nodes) in parts
        )

    @cached_property
    def levers(self) -> np.ndarray:
        found = self.weights.copy()
        for each, nodes in zip(self.sections, self.nodes.parts, strict=True):
            found[nodes] *= each.radius
        return found

    @cached_property
    def sides(self) -> list[slice]:
        """The nodes of the sides of each faying surface."""
        return rows_of(self.faying, self.nodes.parts[-1].stop)

    @cached_property
    def ends(self) -> np.ndarray:
        return np.zeros(self.nodes.size, dtype=bool)

    @cached_property
    def bonded(self) -> np.ndarray:
        found = np.zeros(self.nodes.size, dtype=bool)
        for ring in self.rings:
            found[self.nodes.parts[ring.outer]] = ring.bonded
        return found

    @cached_property
    def pins(self) -> list[list[int]]:
        """The sections of each pin."""
        return sections_of_pins(self.sections, self.rings)

    def is_smooth(self, pin: int) -> bool:
        """Whether nothing turns a pin."""
        return is_smooth(self.sections, self.pins[pin])

    @cached_property
    def turning(self) -> tuple[slice, ...]:
        parts = self.nodes.parts
        bodies = [of for pin, of in enumerate(self.pins) if not self.is_smooth(pin)]
        bodies += [[ring.outer] for ring in self.rings if not self.sections[ring.outer].problem.frictionless]
        return tuple(slice(parts[of[0]].start, parts[of[-1]].stop) for of in bodies)

    @cached_property
    def driven(self) -> np.ndarray:
        """The load that a condition prescribes as a displacement, int, shape (m,); -1 if it is no such condition."""
        count, given = 3 * len(self.sections), self.given
        found = np.r_[np.full(count, -1), given.of_plates]
        for members, loads in zip(self.pins, given.of_pins, strict=True):
            found[3 * members[0] : 3 * members[0] + 2] = loads
        return found

    @cached_property
    def of_pins(self) -> np.ndarray:
        """Whether a condition is the equilibrium of a pin or a ring, bool, shape (m,).

        It stands with the first section of the pin, and with the outer interface of the ring.
        """
        found = np.zeros(self.motions, dtype=bool)
        for place in (*(members[0] for members in self.pins), *(ring.outer for ring in self.rings)):
            found[3 * place : 3 * place + 3] = True
        return found & (self.driven < 0)

    def columns(self, *given: Any) -> PortColumns | None:
        return None if self.ports is None else PortColumns(self, self.ports, *given)

    def resting(self, rest: np.ndarray) -> PinsSystem:
        """The same system with springs that are slack at the motion `rest` (m,)."""
        forces = self.forces.copy()
        forces[:, -1] = self.springs @ rest
        return replace(self, forces=forces, held_as=self.held_as or self)

    def passed(self, tractions: np.ndarray) -> np.ndarray:
        """Force along x and y and moment of each interface on its outer body per thickness, shape (sections, 3)."""
        found: np.ndarray = (self.resultants @ tractions).reshape(-1, 3)
        return found

    def rubbed(self, tractions: np.ndarray) -> np.ndarray:
        """Force of friction of each faying surface on its first plate, shape (surfaces, 2)."""
        shears = tractions[self.nodes.size + self.nodes.parts[-1].stop :]
        return shears.reshape(-1, SIDES) @ SPREAD.T


def build(
    sections: Sequence[PinSection],
    plates: Sequence[HolesCompliance],
    given: JointLoads,
    grids: Sequence[Grid],
    force: float,
    coherence: Sequence[Coherence],
    faying: Sequence[FayingSurface] = (),
    rings: Sequence[RingBetween] = (),
) -> PinsSystem:
    """Fill the matrices of a joint with reference force `force`, N/m.

    Parameters
    ----------
    sections : sequence of PinSection
        Pin by pin, and through the thickness; then those round rings.
    plates : sequence of HolesCompliance
    given : JointLoads
    grids : sequence of Grid
        The nodes of each section, all round.
    force : float
    coherence : sequence of Coherence
        What ties the sections of each pin.
    faying : sequence of FayingSurface
    rings : sequence of RingBetween
    """
    nodes = Nodes(tuple(grids), SIDES * len(faying))
    alone = [System.build(each.problem, grid, force) for each, grid in zip(sections, grids, strict=True)]
    scales, size, behind = alone[0].scales, nodes.size, nodes.size + nodes.parts[-1].stop
    stretch = [system.scales.displacement / scales.displacement for system in alone]
    matrix = np.zeros((2 * size, 2 * size), order="F")
    motion = np.zeros((2 * size, 3 * len(sections) + len(given.moving)))
    loads = np.zeros((2 * size, len(LOADS) + given.pins.shape[2] + 2))
    for a, (one, system) in enumerate(zip(sections, alone, strict=True)):
        own = nodes.rows(a)
        local = system.operator.entries()  # the forces of the pins are no loads here: their columns join the operator
        local += system.loads[:, [Q, P]] @ (system.equilibrium[:2] * [[1.0], [-1.0]])
        matrix[np.ix_(own, own)] = stretch[a] * one.radius * local
        motion[own, 3 * a : 3 * a + 3] = system.motion * [1.0, 1.0, one.radius]
        loads[own[: own.size // 2], FIT] = stretch[a] * np.minimum(system.concentric_gap, 0.0)
    beta, within = scales.displacement / force, {ring.inner for ring in rings}
    _couple(rings, sections, nodes, beta, matrix)
    in_plates = [a for a in range(len(sections)) if a not in within]
    bases = {a: basis(plates[sections[a].plate].block(0, 0), grids[a]) for a in in_plates}
    rims = [(sections[a], nodes.rows(a), *bases[a]) for a in in_plates]
    equilibrium, rows, springs, forces = conditions_of(sections, alone, nodes, given, coherence, rings)
    rims += _faying_rims(faying, sections, plates, given, nodes, matrix, motion, loads)
    has_ports = not faying and not rings and all(each.slices == 1 for each in sections)
    is_stored = not has_ports or size <= LARGEST_DENSE
    equilibrium[:, behind:] = np.where(equilibrium.any(axis=1), motion[behind:], 0.0).T  # work on plates, unless driven
    for rim in rims:
        unit = rim[0].radius * force / (rim[0].problem.pair.plate.shear_modulus * scales.displacement)
        _add_plate(plates[rim[0].plate], rim, rims if is_stored else [rim], given, unit, matrix, loads)
    ports = _ports(sections, plates, nodes, matrix, motion, equilibrium, bases, beta) if has_ports else None
    loose = [np.maximum(s * each.concentric_gap, 0.0) for s, each in zip(stretch, alone, strict=True)]
    sized = [each.radius * system.weights for each, system in zip(sections, alone, strict=True)]
    return PinsSystem(
        problem=sections[0].problem, grid=nodes, scales=scales, rest_clearance=0.0,  # type: ignore[arg-type]
        operator=DenseOperator(matrix) if ports is None or is_stored else ports, ports=ports,
        motion=motion, loads=loads, equilibrium=equilibrium, motion_rows=rows,
        forces=forces, plate=0.0, drive=Drive(motion[:, :2], loads), nodes=nodes, sections=tuple(sections), given=given,
        rings=tuple(rings), integrals={a: each[1] for a, each in bases.items()}, springs=springs, faying=tuple(faying),
        friction=np.concatenate([*(each.friction for each in alone), np.repeat([s.limit for s in faying], SIDES)]),
        initial_gap=np.concatenate([*loose, np.zeros(nodes.further)]),
        weights=np.concatenate([*sized, np.ones(nodes.further)]),
    )  # fmt: skip


def _couple(
    rings: Sequence[RingBetween], sections: Sequence[PinSection], nodes: Nodes, beta: float, matrix: np.ndarray
) -> None:
    """Fill in what each interface of a ring feels of the other one."""
    for ring in rings:
        pair, of = (ring.inner, ring.outer), (sections[ring.inner].problem, sections[ring.outer].problem)
        for to, by in (pair, pair[::-1]):
            block = across_ring(of, (nodes.grids[to], nodes.grids[by]), to == ring.inner, beta)
            matrix[np.ix_(nodes.rows(to), nodes.rows(by))] = sections[ring.inner].radius * block


def _add_plate(
    plate: HolesCompliance,
    rim: PinnedEdge,
    rims: Sequence[PinnedEdge],
    given: JointLoads,
    unit: float,
    matrix: np.ndarray,
    loads: np.ndarray,
) -> None:
    """Add what a rim feels of its plate: of the tractions on some `rims`, and of the loads."""
    one, own, out, _ = rim
    for other, columns, _, into in rims:
        if felt := one.felt(other, plate.holes):
            matrix[np.ix_(own, columns)] += unit * (out @ (felt * plate.block(one.hole, other.hole) @ into))
    for _, name, place in (column for column in given.columns if column[0] == one.plate):
        loads[own, len(LOADS) + place] += unit * (out @ plate.column(name, one.hole))


def _faying_rims(
    faying: Sequence[FayingSurface],
    sections: Sequence[PinSection],
    plates: Sequence[HolesCompliance],
    given: JointLoads,
    nodes: Nodes,
    matrix: np.ndarray,
    motion: np.ndarray,
    loads: np.ndarray,
) -> list[PinnedEdge]:
    """Fill in what faying surfaces do without the compliance of the plates. Returns the rims on which they act."""
    rims = []
    for surface, sides in zip(faying, rows_of(faying, nodes.parts[-1].stop), strict=True):
        normal = np.arange(sides.start, sides.stop)
        shear = nodes.size + normal
        matrix[normal, normal], loads[normal, -1] = 1.0, -1.0  # their pressure is 1 with the load of the springs
        matrix[np.ix_(shear, shear)] = surface.compliance()
        for place, sign in surface.signs:
            one = sections[place]
            size = len(plates[one.plate].block(0, 0))
            rims.append((one, shear, *rim_basis(size, sign, one.thickness * one.radius)))
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
    bases: Mapping[int, tuple[np.ndarray, np.ndarray]],
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
    for a, one in enumerate(sections):
        waves, integrals = bases[a]
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
