"""The matrices of one problem on one grid, in dimensionless form.

With a reference force F, tractions are in F/R, displacements in F beta*, rotations in F beta*/R. The motion of the pin
is (c_x, c_y, omega). It counts from the place at which the pin came to rest on the hole. Gap and slip are

    gap   h = rest gap + direct N + cross T  - c_x cos - c_y sin             + (loads)    Eqs. (9)-(12), (15)
    slip  s =           - cross N + direct T  - c_x sin + c_y cos + omega     + (loads)    Eqs. (9)-(12), (18)

The rest gap is the gap of the rigid pin in the undeformed hole. Some terms of the displacement kernels depend on the
resultants only: the w terms of the pin's load. They stand with the loads, for they are known as soon as P and Q are.
The remaining operator on (N, T) is symmetric.
"""

from __future__ import annotations

import math
from collections import OrderedDict
from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import Any, ClassVar, NamedTuple

import numpy as np

from fastpin.elasticity.drive import DISPLACEMENTS, Drive, make_drive
from fastpin.elasticity.operator import DenseOperator, Operator, make_operator, uniform_part
from fastpin.elasticity.terms import BodyTerms, body_terms, thermal_columns
from fastpin.kernels.arrays import Equations
from fastpin.model.grid import Grid, arc_of
from fastpin.model.loads import ACTING, FRICTION_CHANGE, LOAD_KIND, LOADS, ROTATION, SXX, SXY, SYY, TEMPERATURE, M, P, Q
from fastpin.model.problem import Problem

IN_PLACE = {"friction", "clearance", "gap"}
"""Fields of a problem that the matrices do not depend on."""


class Interface(NamedTuple):
    """One contact of a joint: the pin in the hole, or a bush in its seat.

    Attributes
    ----------
    problem : Problem
    grid : Grid
    nodes : slice
        Its nodes among all nodes.
    motion : int
        The first of its three motions (c_x, c_y, omega) among all motions.
    radius : float
        Its radius over R.
    """

    problem: Problem
    grid: Grid
    nodes: slice
    motion: int
    radius: float


@dataclass(frozen=True)
class Scales:
    """Units of the dimensionless quantities, SI."""

    force: float  # F, N/m
    traction: float  # F/R, Pa
    displacement: float  # F beta*, m
    rotation: float  # F beta*/R, rad
    energy: float  # F^2 beta*, J/m
    loads: np.ndarray  # unit of every load, in the order of LOADS

    @classmethod
    def of(cls, problem: Problem, force: float) -> Scales:
        """The units of `problem` with reference force `force`, N/m."""
        radius, beta = problem.hole_radius, problem.surfaces.beta_star
        traction, rotation = force / radius, force * beta / radius
        unit = {"force": force, "moment": force * radius, "traction": traction, "rotation": rotation}
        unit |= {"displacement": force * beta, "ratio": 1.0, "temperature": rotation}
        loads = np.array([unit[kind] for kind in LOAD_KIND.values()])
        return cls(force, traction, force * beta, rotation, force * force * beta, loads)


@dataclass(frozen=True, eq=False)
class System:
    """The collocation matrices of one problem on one grid. All quantities are dimensionless.

    The conditions of equilibrium (50), (51) are

        equilibrium @ (N, T) + motion_rows @ motion = forces @ load.

    The number m of motions, and of these conditions, is 3. For a pin whose rotation is held, the third row prescribes
    the rotation of the hub, or of the far end of the spring.

    Attributes
    ----------
    problem : Problem
    grid : Grid
        n nodes.
    scales : Scales
        The units.
    rest_clearance : float
        The clearance.
    initial_gap : ndarray, shape (n,)
        Initial gap at each node, beside the clearance.
    friction : ndarray, shape (n,)
        Coefficient of friction at each node.
    operator : Operator
        Matrix with 2n rows, stored or not. Maps (N, T) to (h, s).
    motion : ndarray, shape (2n, m)
        Maps the motion (c_x, c_y, omega) of the pin to (h, s).
    loads : ndarray, shape (2n, acting loads)
        Maps the loads to (h, s).
    equilibrium : ndarray, shape (m, 2n)
        Maps (N, T) to the conditions of equilibrium.
    motion_rows : ndarray, shape (m, m)
        Maps the motion of the pin to the conditions of equilibrium.
    forces : ndarray, shape (m, acting loads)
        Maps the loads to the conditions of equilibrium.
    weights : ndarray, shape (n,)
        Integrals of the hat functions of the nodes along the rim, over R.
    plate : float
        Size R kappa'/(2 G) of the displacement of the hole in an infinite plate per remote stress, Eq. (42).
    drive : Drive
        The forces or prescribed displacements of the pin. The reactions of the driven axes take their places in the
        motion; see :mod:`fastpin.elasticity.drive`.
    bodies : BodyTerms or None
        The smooth terms of hollow pins and finite plates. None for a solid pin in an infinite plate.
    held_as : System or None
        The system whose contacts answer alike while all closed nodes stick: it differs in loads, friction and fit
        only. None for a system of its own.
    radius : float
        Radius of the contact over the R of the units.
    needs_windows : bool
        Whether solvers work on windows of neighbouring nodes: a :class:`fastpin.narrow.LargeSystem`.
    """

    problem: Problem
    grid: Grid
    scales: Scales
    rest_clearance: float
    initial_gap: np.ndarray
    friction: np.ndarray
    operator: Operator
    motion: np.ndarray
    loads: np.ndarray
    equilibrium: np.ndarray
    motion_rows: np.ndarray
    forces: np.ndarray
    weights: np.ndarray
    plate: float
    drive: Drive
    bodies: BodyTerms | None = None
    held_as: System | None = None
    radius: float = 1.0

    needs_windows: ClassVar[bool] = False

    @classmethod
    def build(cls, problem: Problem, grid: Grid, force: float) -> System:
        """Fill the matrices of `problem` on `grid` with reference force `force`, N/m."""
        n, theta = grid.size, grid.theta
        weights = grid.weights
        bodies = body_terms(problem)

        cos, sin, one, zero = np.cos(theta), np.sin(theta), np.ones(n), np.zeros(n)
        motion = np.array([[-cos, -sin], [-sin, cos], [zero, one]]).reshape(3, 2 * n).T.copy()
        plate, loads = load_columns(problem, theta, bodies)

        cos_moment, sin_moment = grid.trig_moments()
        equilibrium = np.zeros((3, 2 * n))
        equilibrium[0] = np.concatenate([cos_moment, sin_moment])  # Q
        equilibrium[1] = np.concatenate([sin_moment, -cos_moment])  # -P
        motion_rows, forces = np.zeros((3, 3)), np.zeros((3, len(LOADS)))
        forces[0, Q], forces[1, P] = 1.0, -1.0
        if problem.rotation == "free" and not problem.frictionless:
            equilibrium[2, n:] = -weights  # M
            forces[2, M] = 1.0
        else:
            # In units of 1 + compliance of the spring: a soft spring leaves the condition of a free pin.
            unit = 1.0 if problem.hub_stiffness is None else 1.0 / (1.0 + problem.spring_compliance)
            motion_rows[2, 2] = unit
            equilibrium[2, n:] = -unit * problem.hub_compliance * weights
            forces[2, ROTATION] = unit
        drive = make_drive(problem, grid, motion, loads, motion_rows, forces)
        scales, operator = Scales.of(problem, force), cls._operator(problem, grid, bodies, drive)
        initial_gap = problem.gap_at(theta)[0] / scales.displacement
        return cls(
            problem, grid, scales, _rest_clearance(problem, scales), initial_gap,
            problem.friction_at(theta), operator, motion, loads, equilibrium, motion_rows, forces, weights, plate,
            drive, bodies,
        )  # fmt: skip

    @staticmethod
    def _operator(problem: Problem, grid: Grid, bodies: BodyTerms | None, drive: Drive) -> Operator:
        return make_operator(problem, grid, bodies, drive)

    @property
    def is_toeplitz(self) -> bool:
        """Whether entries of the operator depend on the distance of two nodes only, up to the half hats of an arc.

        Those of a solid pin in a laminate do for tractions along fixed axes, up to the expansion of the pin.
        """
        bodies = self.bodies
        if bodies is not None and (bodies.matrix.size or (bodies.anisotropy and self.problem.pin_body.bore_radius)):
            return False
        return self.grid.uniform and self.operator.by_distance and not self.drive.has_displacements

    @cached_property
    def entries_by_distance(self) -> np.ndarray:
        """Entries of a block Toeplitz operator by the distance of two nodes, shape (3, n+1).

        The rows are gap of N, slip of T and gap of T. The largest distance of an arc, and the last column, are 0.
        """
        n, end = self.grid.size, 0 if self.grid.closed else 1  # the hats at the ends of an arc are halves
        nodes, found = np.arange(end, n), np.zeros((3, n + 1))
        both = self.operator.entries(np.concatenate([nodes, n + nodes]), np.array([end, n + end]))
        found[0, : n - end], found[2, : n - end], found[1, : n - end] = *both[: n - end].T, both[n - end :, 1]
        return found

    @cached_property
    def motions(self) -> int:
        """Number m of motions, and of conditions of equilibrium."""
        return len(self.motion_rows)

    @cached_property
    def equations(self) -> Equations:
        """The arrays of the equations for kernels, all in the order of C."""
        loads = self.loads, self.both_weights[:, None] * self.drive.columns, self.forces
        matrices = self.motion, self.equilibrium, self.motion_rows, self.friction, *loads
        return Equations(*map(np.ascontiguousarray, matrices))

    @cached_property
    def held_tables(self) -> OrderedDict[bytes, Any]:
        """The latest tables of held contacts, by their closed nodes; see :func:`fastpin.solver.held.known_table`."""
        return OrderedDict()

    @cached_property
    def interfaces(self) -> tuple[Interface, ...]:
        """All contacts of the joint. That of the pin is the first one."""
        return (Interface(self.problem, self.grid, slice(0, self.grid.size), 0, self.radius),)

    @cached_property
    def width(self) -> float:
        """Typical weight of a node."""
        return float(self.weights.sum() / self.weights.size)

    @cached_property
    def levers(self) -> np.ndarray:
        """Moment of a unit of shear at each node, shape (n,): its weight times the radius of its rim."""
        return self.radius * self.weights

    @cached_property
    def both_weights(self) -> np.ndarray:
        """The weights of the pressures and then of the shears, shape (2n,)."""
        return np.concatenate([self.weights, self.weights])

    @cached_property
    def stops(self) -> np.ndarray:
        """The place after the last node of each interface, int, shape (interfaces,)."""
        return np.array([rim.nodes.stop for rim in self.interfaces])

    @cached_property
    def resultants(self) -> np.ndarray:
        """Maps (N, T) to the forces along x and y and the moment that each interface passes on, (3 interfaces, 2n)."""
        n, found = self.grid.size, np.zeros((3 * len(self.interfaces), 2 * self.grid.size))
        for rim, rows in zip(self.interfaces, np.split(found, len(self.interfaces)), strict=True):
            normal, shear = rim.nodes, slice(n + rim.nodes.start, n + rim.nodes.stop)
            cos, sin = rim.radius * np.array(rim.grid.trig_moments())
            rows[:2, normal], rows[:2, shear] = (cos, sin), (sin, -cos)
            rows[2, shear] = -(rim.radius**2) * rim.grid.weights
        return found

    @cached_property
    def ends(self) -> np.ndarray:
        """Whether a node is the end of an arc, bool, shape (n,). It must stay open."""
        found = np.zeros(self.grid.size, dtype=bool)
        if not self.grid.closed:
            found[[0, -1]] = True
        return found

    @cached_property
    def turning(self) -> tuple[slice, ...]:
        """The nodes of each body whose rotation only friction holds: one of them sticks."""
        is_free = self.has_friction and self.problem.rotation == "free"
        return tuple(each.nodes for each in self.interfaces if is_free)

    @cached_property
    def bonded(self) -> slice | np.ndarray:
        """The nodes that must stick: the seat of a bonded bush whose seat is an interface of its own."""
        return slice(0)

    @cached_property
    def fixed(self) -> np.ndarray:
        """Whether a node must keep its status, bool, shape (n,): :attr:`ends` and :attr:`bonded`."""
        found = self.ends.copy()
        found[self.bonded] = True
        return found

    @cached_property
    def concentric_gap(self) -> np.ndarray:
        """Gap of the unloaded, concentric pin at each node, shape (n,)."""
        return self.rest_clearance + self.initial_gap

    @cached_property
    def is_neat(self) -> bool:
        """Whether the pin touches all round without load. Then everything grows in proportion to the loads."""
        return not self.concentric_gap.any()

    @cached_property
    def is_nearly_neat(self) -> bool:
        """Whether the pin is neat or loose by at most 1e-6 F beta*. Its contacts vanish where all loads vanish.

        The contact feels such a clearance in the last part of an unloading only.
        """
        return bool(self.concentric_gap.min() >= 0.0 and self.concentric_gap.max() <= 1e-6)

    @cached_property
    def has_friction(self) -> bool:
        """Whether there is friction at a node."""
        return bool(self.friction.any())

    def elastic(self, tractions: np.ndarray) -> np.ndarray:
        """The elastic part of gap and slip, shape (2n,), of tractions (N, T), shape (2n,)."""
        return self.operator @ tractions

    def columns(self, *given: Any) -> Any:
        """A tableau of this kind of system; None if it is :class:`fastpin.solver.tableau.Columns`."""
        return None

    def part(self, nodes: np.ndarray) -> System:
        """The system of neighbouring `nodes`, shape (k,), in their order round the hole.

        The other nodes are left out, so they must stay open.
        """
        rows = np.concatenate([nodes, self.grid.size + nodes])
        return replace(
            self, grid=arc_of(self.grid, nodes), operator=DenseOperator(self.operator.entries(rows, rows)),
            motion=self.motion[rows], loads=self.loads[rows], equilibrium=self.equilibrium[:, rows],
            weights=self.weights[nodes], friction=self.friction[nodes],
            initial_gap=self.initial_gap[nodes], drive=self.drive.part(rows),
        )  # fmt: skip

    def without_friction(self) -> System:
        """The same system without friction (mu = 0). The rotation is held at the load's ``rotation``."""
        equilibrium, motion_rows, forces = self.equilibrium.copy(), self.motion_rows.copy(), self.forces.copy()
        unit = float(motion_rows[2, 2])
        if unit:  # pressures and loads turn a bush between the pin and what holds it
            equilibrium[2, self.grid.size :] = 0.0
            equilibrium[2], forces[2] = equilibrium[2] / unit, forces[2] / unit
        else:
            equilibrium[2], forces[2] = 0.0, 0.0
            forces[2, ROTATION] = 1.0
        motion_rows[2] = 0.0
        motion_rows[2, 2] = 1.0
        friction = np.zeros_like(self.friction)
        return replace(self, friction=friction, equilibrium=equilibrium, motion_rows=motion_rows, forces=forces)

    def changed(self, problem: Problem) -> System | None:
        """The system of another problem with the same matrices; None if they differ."""
        names = [each.name for each in fields(Problem) if each.name not in IN_PLACE]
        alike = all(getattr(self.problem, name) == getattr(problem, name) for name in names)
        if not alike or self.problem.frictionless != problem.frictionless:  # without friction nothing carries a moment
            return None
        if problem.seat is not None:  # the system of a joint holds systems of its parts
            return None
        return replace(
            self, problem=problem, friction=problem.friction_at(self.grid.theta),
            rest_clearance=_rest_clearance(problem, self.scales),
            initial_gap=problem.gap_at(self.grid.theta)[0] / self.scales.displacement, held_as=self.held_as or self,
        )  # fmt: skip

    def with_friction(self, friction: np.ndarray) -> System:
        """The same system with another friction at its nodes, shape (n,); itself if it is the same."""
        return self if np.array_equal(friction, self.friction) else replace(self, friction=friction)

    def under(self, load: np.ndarray) -> System:
        """The system with the friction under a load (loads,): its own times 1 + ``friction_change``."""
        change = float(load[FRICTION_CHANGE])
        return self.with_friction(self.friction * (1.0 + change)) if change else self

    def load_displacement(self, load: np.ndarray, rows: slice | np.ndarray = slice(None)) -> np.ndarray:
        """Gap and slip, shape (2n,) or only some `rows`, of a load (loads,) or its rate."""
        acting = self._acting
        return self.loads[rows][:, :acting] @ load[:acting]

    def held_displacement(self, load: np.ndarray) -> np.ndarray:
        """Gap and slip, shape (2n,), of a load (loads,) or its rate, without the prescribed displacements."""
        acting = self._acting
        return self.drive.columns[:, :acting] @ load[:acting]

    def load_forces(self, load: np.ndarray) -> np.ndarray:
        """Right sides of the conditions of equilibrium, shape (m,), of a load (loads,) or its rate."""
        acting = self._acting
        return self.forces[:, :acting] @ load[:acting]

    @cached_property
    def _acting(self) -> int:
        """Number of loads in products. Displacements that stand last are left out under forces: zeros cost bits."""
        columns = self.loads.shape[1]
        if columns > len(LOADS) or self.loads[:, TEMPERATURE:].any():  # wear is one more
            return columns
        stand_last = max(DISPLACEMENTS) == ACTING - 1
        return min(DISPLACEMENTS) if stand_last and not self.drive.has_displacements else ACTING

    def displacement(
        self, tractions: np.ndarray, motion: np.ndarray, load: np.ndarray, rest_gap: np.ndarray | float
    ) -> np.ndarray:
        """Gap and slip, shape (2n,), straight from the matrices.

        Parameters
        ----------
        tractions : ndarray, shape (2n,)
            Pressure N, then shear traction T.
        motion : ndarray, shape (m,)
            Motion (c_x, c_y, omega) of the pin.
        load : ndarray, shape (loads,)
        rest_gap : ndarray, shape (n,), or float
            Gap of the rigid pin in the undeformed hole.
        """
        result = self.elastic(tractions) + self.motion @ motion + self.load_displacement(load)
        result[: self.grid.size] += rest_gap
        return result


def _rest_clearance(problem: Problem, scales: Scales) -> float:
    """The clearance of the assembled pin, dimensionless; 0 where it is rounding beside the displacements.

    Up to 1e-10 it counts as none: a tenth of the error that a returned state may have.
    """
    clearance = problem.assembled_clearance / scales.displacement
    return 0.0 if abs(clearance) <= 1e-10 and not problem.gap else clearance


def load_columns(problem: Problem, theta: np.ndarray, bodies: BodyTerms | None) -> tuple[float, np.ndarray]:
    """The size R kappa'/(2 G) of the hole's displacement per remote stress, and the columns of all loads.

    The columns, shape (2n, acting loads), map forces and remote stresses to gap and slip at the angles `theta` (n,),
    dimensionless. Those of the other loads are 0. `bodies` are the :func:`fastpin.elasticity.terms.body_terms`.
    """
    pair = problem.surfaces
    cos, sin, cos_double, sin_double = np.cos(theta), np.sin(theta), np.cos(2 * theta), np.sin(2 * theta)
    share = 1.0 if problem.pin_load == "centre" else 0.5  # the number w of section 4
    point = share * pair.pin_compliance / (4.0 * math.pi * pair.beta_star) if bodies is None else bodies.force_factor
    plate = 0.5 * (1.0 - uniform_part(problem))  # R kappa'/(2 G) per beta*, Eq. (42)
    loads = np.zeros((2 * theta.size, len(LOADS)))
    loads[:, P] = point * np.concatenate([sin, cos])
    loads[:, Q] = point * np.concatenate([-cos, sin])
    if bodies is not None:
        for place, column in bodies.load_columns(theta).items():
            loads[:, place] += column
        return plate, loads
    for place, column in thermal_columns(problem).items():
        loads[: theta.size, place] = column.real
    loads[:, SXX] = plate * np.concatenate([0.5 + cos_double, sin_double])
    loads[:, SYY] = plate * np.concatenate([0.5 - cos_double, -sin_double])
    loads[:, SXY] = 2.0 * plate * np.concatenate([sin_double, -cos_double])
    return plate, loads
