"""A joint with two interfaces: the pin in a bush, and the bush in its seat, solved together.

Each interface is a :class:`System` of its own, of ``problem.interfaces``: the pin in a ring that is free at its outer
rim, and the ring in the lug. The pin, the bush and the lug lie within one another, so every interface passes on the
same force and moment. Each has its own relative motion (c_x, c_y, omega) and its own conditions of equilibrium. Only
the bush couples gap and slip of one interface to the tractions on the other.

Nodes, motions and conditions of the pin come first, then nodes, motions and conditions of the seat. All is
dimensionless with R, F and beta* of the pin in the bush. With the radius c of the seat over R, a unit of traction of
the seat's own system is 1/c of it, and a unit of displacement beta_2/beta_1.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import pairwise
from typing import Any

import numpy as np

from fastpin.bodies import harmonics
from fastpin.elasticity.drive import Drive
from fastpin.elasticity.operator import DenseOperator
from fastpin.elasticity.system import Interface, System
from fastpin.kernels import fourier
from fastpin.model.angles import BOTTOM, angle_between
from fastpin.model.grid import Grid
from fastpin.model.loads import FRICTION_CHANGE, LOADS, PIN_TEMPERATURE, REMOTE, ROTATION, TEMPERATURE, THERMAL
from fastpin.model.problem import Problem

PIN, SEAT = 0, 1
"""Places of the two interfaces."""

TURN = 2
"""Place of the rotation among the three motions of an interface, and of its condition."""


@dataclass(frozen=True)
class Nodes:
    """The nodes of several interfaces, one after the other, as a solver asks a :class:`Grid` for them.

    Attributes
    ----------
    grids : tuple of Grid
    further : int
        Nodes behind those of the grids, such as sides of faying surfaces.
    """

    grids: tuple[Grid, ...]
    further: int = 0

    @cached_property
    def size(self) -> int:
        """Number of nodes."""
        return sum(grid.size for grid in self.grids) + self.further

    @cached_property
    def parts(self) -> tuple[slice, ...]:
        """The nodes of each interface."""
        ends = np.cumsum([0, *(grid.size for grid in self.grids)]).tolist()
        return tuple(slice(*pair) for pair in pairwise(ends))

    def rows(self, place: int) -> np.ndarray:
        """The rows of an interface among (N, T), or (h, s), of all nodes."""
        own = np.arange(self.size)[self.parts[place]]
        return np.r_[own, self.size + own]


@dataclass(frozen=True, eq=False)
class JointSystem(System):
    """The system of a joint with several interfaces.

    Attributes
    ----------
    nodes : Nodes
    alone : tuple of System
        Each interface alone, while the other one carries nothing; in the units of the whole.
    seat_radius : float
        Radius of the seat over R.
    """

    nodes: Nodes = field(kw_only=True)
    alone: tuple[System, ...] = field(kw_only=True)
    seat_radius: float = field(kw_only=True)

    @classmethod
    def join(cls, problem: Problem, grids: tuple[Grid, Grid], force: float) -> JointSystem:
        """Fill the matrices of `problem`, whose bush slips, with reference force `force`, N/m."""
        nodes, (pin_problem, seat_problem) = Nodes(grids), problem.interfaces
        radius = seat_problem.hole_radius / problem.hole_radius
        pin = _without_remote(System.build(pin_problem, grids[PIN], force))
        seat = _scaled(System.build(seat_problem, grids[SEAT], force), pin, radius)
        both, size, m, beta = (pin, seat), nodes.size, 2 * pin.motions, pin_problem.surfaces.beta_star
        matrix, motion = np.zeros((2 * size, 2 * size), order="F"), np.zeros((2 * size, m))
        loads = np.zeros((2 * size, pin.loads.shape[1]))
        equilibrium, motion_rows = np.zeros((m, 2 * size)), np.zeros((m, m))
        for place, system in enumerate(both):
            rows, own = nodes.rows(place), slice(3 * place, 3 * place + 3)
            matrix[np.ix_(rows, rows)] = system.operator.entries()
            around = grids[place], grids[1 - place]
            matrix[np.ix_(rows, nodes.rows(1 - place))] = across_ring(problem.interfaces, around, place == PIN, beta)
            motion[rows, own], loads[rows] = system.motion, system.loads
            equilibrium[own, rows], motion_rows[own, own] = system.equilibrium, system.motion_rows
        if pin_problem.held:
            # The rotations add up to that of the pin over the lug, and both interfaces carry the same moment. The
            # rotation of the seat is that of a solid pin at the paper's datum: the bush's outer rim turns by more.
            unit = motion_rows[TURN, TURN]
            motion_rows[TURN, 3 + TURN] = unit
            per_shear = rim_twist(seat_problem) / beta * grids[SEAT].weights
            equilibrium[TURN, nodes.rows(SEAT)[grids[SEAT].size :]] = unit * per_shear
            equilibrium[3 + TURN, nodes.rows(PIN)[grids[PIN].size :]] = pin.weights
        stacked: dict[str, Any] = {
            "friction": np.concatenate([each.friction for each in both]),
            "forces": np.concatenate([each.forces for each in both]),
            "initial_gap": np.concatenate([each.concentric_gap for each in both]),
            "weights": np.concatenate([pin.weights, seat.weights]),
        }
        if pin_problem.held:
            stacked["forces"][3 + TURN] = 0.0
        elif problem.held:  # the bush turns with the pin in it, until no moment is left between them
            motion_rows[3 + TURN, TURN], stacked["forces"][3 + TURN, ROTATION] = 1.0, 1.0
        return cls(
            problem=problem, grid=nodes, scales=pin.scales, rest_clearance=0.0,  # type: ignore[arg-type]
            operator=DenseOperator(matrix), motion=motion, loads=loads, equilibrium=equilibrium,
            motion_rows=motion_rows, plate=0.0, drive=Drive(motion[:, :2], loads), nodes=nodes, alone=both,
            seat_radius=radius, **stacked,
        )  # fmt: skip

    @property
    def is_toeplitz(self) -> bool:
        return False

    @cached_property
    def interfaces(self) -> tuple[Interface, ...]:
        problems, sizes = (self.problem, self.problem.interfaces[SEAT]), (1.0, self.seat_radius)
        parts = enumerate(zip(problems, self.nodes.grids, self.nodes.parts, sizes, strict=True))
        return tuple(Interface(problem, grid, nodes, 3 * place, size) for place, (problem, grid, nodes, size) in parts)

    @cached_property
    def levers(self) -> np.ndarray:
        return np.concatenate([each.levers for each in self.alone])

    @cached_property
    def ends(self) -> np.ndarray:
        return np.concatenate([each.ends for each in self.alone])

    @property
    def is_held(self) -> bool:
        """Whether the moment that holds the pin goes through the bush. It can't if the seat has no friction."""
        return self.alone[PIN].problem.held

    @cached_property
    def turning(self) -> tuple[slice, ...]:
        if self.is_held:  # the bush may slip all round while the pin sticks in it
            return (slice(0, self.nodes.size),)
        return tuple(each.nodes for each in self.interfaces if not self.motion_rows[each.motion + TURN].any())

    @cached_property
    def bore_shape(self) -> tuple[np.ndarray, np.ndarray]:
        """Angles (a,) round the bore, rad, and its radial displacement there per traction in the seat, (a, 2k)."""
        theta = Grid.circle(720).theta
        return theta, self.bore_at(theta)

    def bore_at(self, theta: np.ndarray) -> np.ndarray:
        """Radial displacement of the bore at angles (a,), rad, per traction in the seat, shape (a, 2k)."""
        around = Grid(theta, closed=True), self.nodes.grids[SEAT]
        beta = self.alone[PIN].problem.surfaces.beta_star
        return across_ring(self.problem.interfaces, around, True, beta)[: theta.size]

    def without_friction(self) -> System:
        """The same system without friction at both interfaces. Neither turns."""
        equilibrium, motion_rows, forces = self.equilibrium.copy(), self.motion_rows.copy(), self.forces.copy()
        for row in (each.motion + TURN for each in self.interfaces):
            equilibrium[row], motion_rows[row], forces[row] = 0.0, 0.0, 0.0
            motion_rows[row, row] = 1.0
        return replace(
            self, friction=np.zeros_like(self.friction), equilibrium=equilibrium, motion_rows=motion_rows, forces=forces
        )

    @property
    def is_pressed(self) -> bool:
        """Whether a press fit holds the bush in its seat before any load."""
        return self.alone[SEAT].rest_clearance < 0.0

    @cached_property
    def bonded(self) -> slice:
        return slice(0) if self.problem.bush_slips else self.nodes.parts[SEAT]

    def under(self, load: np.ndarray) -> System:
        """The system with the friction under a load (loads,). ``friction_change`` acts on the pin in the bush."""
        friction = self.alone[PIN].friction * (1.0 + float(load[FRICTION_CHANGE]))
        return self.with_friction(np.concatenate([friction, self.alone[SEAT].friction]))


def seat_grid(problem: Problem, grid: Grid) -> Grid:
    """The nodes of the seat: as many as the pin's, but at least 2 per wall thickness of the bush.

    One of them lies at a node of the pin: at the bottom, the right, the top or the left of the hole if the pin has a
    node there, so that a symmetric joint has symmetric nodes.
    """
    bush = problem.plate_body.bush
    assert bush is not None
    wall = bush.outer_radius / problem.hole_radius - 1.0
    least = math.ceil(2.0 * 2.0 * math.pi * (1.0 + wall) / wall)
    start = 0
    if not grid.closed:
        away = np.abs(angle_between(grid.theta, BOTTOM + 0.5 * math.pi * np.arange(4)[:, None]))
        axis = int(np.argmax(away.min(axis=1) < 1e-9))  # the bottom if the pin has no node on any axis
        start = int(np.argmin(away[axis]))
    return Grid.circle(max(grid.size, least), float(grid.theta[start]))


def _without_remote(system: System) -> System:
    """The system of the pin in the bush. The remote stress acts on the lug alone; temperatures act on all bodies."""
    loads = system.loads.copy()
    loads[:, REMOTE] = 0.0
    assert system.bodies is not None
    thermal = {place: each for place, each in system.bodies.columns.items() if place in THERMAL}
    bodies = replace(system.bodies, columns=thermal)  # of forces it has none
    return replace(system, loads=loads, drive=Drive(system.motion[:, :2], loads), bodies=bodies)


def _scaled(seat: System, pin: System, radius: float) -> System:
    """The system of the seat, of that `radius` over R, in the units of the system of the `pin`."""
    stretch = seat.scales.displacement / pin.scales.displacement
    # A load counts in units of the pin's system. The pin of the seat is the bush, not the pin.
    unit = np.full(len(LOADS), stretch)
    unit[[*REMOTE]] *= radius
    unit[[TEMPERATURE, PIN_TEMPERATURE]] = radius, 0.0
    loads, motion = unit * seat.loads, seat.motion.copy()
    motion[:, TURN] *= radius
    assert seat.bodies is not None
    columns = {place: unit[place] * each for place, each in seat.bodies.columns.items()}
    equilibrium, motion_rows, forces = radius * seat.equilibrium, seat.motion_rows.copy(), seat.forces.copy()
    if seat.problem.frictionless:
        equilibrium[TURN], forces[TURN] = 0.0, 0.0
    else:
        equilibrium[TURN] *= radius
    return replace(
        seat, operator=DenseOperator(stretch * radius * seat.operator.entries()), motion=motion, loads=loads,
        equilibrium=equilibrium, motion_rows=motion_rows, forces=forces, drive=Drive(motion[:, :2], loads),
        rest_clearance=stretch * seat.rest_clearance, scales=pin.scales,
        bodies=replace(seat.bodies, columns=columns), weights=radius * seat.weights, radius=radius,
    )  # fmt: skip


def across_ring(of: tuple[Problem, ...], grids: tuple[Grid, Grid], inwards: bool, beta: float) -> np.ndarray:
    """Gap and slip of one interface of a ring per traction on the other one, through the ring; shape (2n, 2k).

    They count in units of `beta` times the radius of the inner interface.

    Parameters
    ----------
    of : (Problem, Problem)
        The contacts at the bore and at the outer rim of the ring.
    grids : (Grid, Grid)
        Nodes of the interface that moves, and of that with the tractions.
    inwards : bool
        Whether the interface that moves is the inner one.
    beta : float
        1/Pa.
    """
    (pin, seat), (to, other) = of, grids
    outer, bush = seat.hole_radius / pin.hole_radius, seat.pair.pin
    order = np.arange(1.0 + harmonics.harmonics_needed(math.sqrt(1.0 / outer)))
    matrices = harmonics.across(order, outer, bush.kolosov(seat.pair.plane))
    if inwards:
        matrices = -outer * matrices.transpose(0, 2, 1)
    sense = 1.0 if inwards else -1.0  # the ring is the outer body at its bore, the inner body in its seat
    unit = -sense / (4.0 * math.pi * bush.shear_modulus * beta)
    (a, b), (c, d) = matrices.transpose(1, 2, 0)
    hats = to.theta, other.theta, *other.halves
    series = unit * np.array([a + b + c + d, a - b - c + d, a - b + c - d])
    series[1, 0] = 0.0  # shear all round turns the other rim
    gap_of_pressure, slip_of_shear, gap_of_shear = fourier.hat_columns(*hats, series)
    slip_of_pressure = fourier.hat_columns(*hats, np.array([0.0 * a, 0.0 * a, -unit * (a + b - c - d)]))[2]
    return np.block([[gap_of_pressure, gap_of_shear], [slip_of_pressure, slip_of_shear]])


def rim_twist(seat: Problem) -> float:
    """How much more the outer rim of a ring turns than a solid pin at the paper's datum, per int T dtheta, 1/Pa."""
    ring = seat.pair.pin
    return ring.kolosov(seat.pair.plane) / (4.0 * math.pi * ring.shear_modulus)


def moved_twice(seat: Problem) -> float:
    """Less the displacement of the bore of a ring over its outer rim per force, 1/Pa, under uniform tractions on both.

    The displacements at both interfaces have it.
    """
    ring, outer = seat.pair.pin, seat.hole_radius / seat.pin_body.bore_radius
    first = harmonics.first(outer, ring.kolosov(seat.pair.plane), "uniform")
    return float(first.translation(outer)[1] / (4.0 * math.pi * ring.shear_modulus))
