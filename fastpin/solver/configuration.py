"""The evolving contact in dimensionless form: the solve of given statuses, energies and residuals."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from fastpin.elasticity.system import Interface, System
from fastpin.kernels import conditions, equations
from fastpin.kernels.arrays import ContactValues
from fastpin.kernels.status import OPEN, SLIP_POSITIVE, STICK
from fastpin.model.loads import THERMAL, M, P, Q
from fastpin.reading.marks import Marks
from fastpin.solver.slip_tally import NOT_COUNTED, SlipTally
from fastpin.solver.unknowns import SINGULAR, DenseUnknowns

MAX_RESIDUAL = 1e-9
"""Largest relative violation of the contact conditions in a returned state."""

SLIGHT = 1e-9
"""Part of the largest pressure, gap, displacement or force that counts as nothing: no more is left in a state."""

ROUNDED = 1e-12
"""Part of the largest traction, moment or load that is rounding."""


NODAL = ("pressure", "shear", "gap", "slip", "status", "rest_gap", "rest_slip")
"""Arrays of a configuration with one number for each node."""

MARKS = ("marks", "seat_marks")
"""Fields of a configuration with the marks of each interface."""


@dataclass(eq=False)
class Configuration:
    """The contact at one load: everything that evolves along a history, dimensionless.

    Attributes
    ----------
    pressure, shear : ndarray, shape (n,)
        Pressure N >= 0, and shear traction T on the pin, positive along +theta.
    gap, slip : ndarray, shape (n,)
        Gap h >= 0, and slip s of the pin over the plate, positive along +theta. The slip counts from ``rest``.
    status : ndarray of int8, shape (n,)
        Status of each node, see :mod:`fastpin.kernels.status`.
    motion : ndarray, shape (m,)
        Motion of the pin, (c_x, c_y, omega). It counts from ``rest``. The reaction takes the place of c_x or c_y where
        the displacement is prescribed.
    load : ndarray, shape (loads,)
        Loads in the order of :data:`fastpin.model.loads.LOADS`.
    origin : ndarray, shape (2,)
        The first ``rest`` of the history; NaN before the pin has come to rest.
    rest : ndarray, shape (2,)
        Position of the pin's centre where the pin came to rest on the hole. It counts from the concentric position,
        without the remote stress. With two interfaces that of the bush follows, also in ``origin``.
    rest_gap : ndarray, shape (n,)
        Gap in the position ``rest``, without the remote stress.
    rest_slip : ndarray, shape (n,)
        Slip that the remote stress had caused when the pin came to rest. It is subtracted before users see the slip.
    dissipation, work : float
        Energy dissipated by friction, and work of the loads.
    seat_dissipation : float
        The part of the dissipation in the seat of a bush.
    slip_tally : SlipTally
        What each node has slipped, counted as ``dissipation``.
    """

    pressure: np.ndarray
    shear: np.ndarray
    gap: np.ndarray
    slip: np.ndarray
    status: np.ndarray
    motion: np.ndarray
    load: np.ndarray
    origin: np.ndarray
    rest: np.ndarray
    rest_gap: np.ndarray
    rest_slip: np.ndarray
    dissipation: float = 0.0
    work: float = 0.0
    slip_tally: SlipTally = NOT_COUNTED
    marks: Marks = field(default_factory=Marks)
    seat_dissipation: float = 0.0
    seat_marks: Marks = field(default_factory=Marks)

    def changed(self, **values: Any) -> Configuration:
        """A configuration with some other values. It shares all others with this one."""
        new = object.__new__(Configuration)
        vars(new).update(vars(self), **values)
        return new

    def copy(self) -> Configuration:
        """A copy. It shares ``origin``, ``rest``, ``rest_gap`` and ``rest_slip``: nothing changes them in place."""
        return self.changed(
            pressure=self.pressure.copy(), shear=self.shear.copy(), gap=self.gap.copy(), slip=self.slip.copy(),
            status=self.status.copy(), motion=self.motion.copy(), load=self.load.copy(),
            slip_tally=self.slip_tally.copy(),
        )  # fmt: skip

    def part(self, nodes: np.ndarray) -> Configuration:
        """A copy with some `nodes` only, indices of shape (k,)."""
        nodal = {name: getattr(self, name)[nodes] for name in NODAL}
        return self.changed(
            motion=self.motion.copy(), load=self.load.copy(), slip_tally=self.slip_tally.part(nodes), marks=Marks(),
            **nodal,
        )  # fmt: skip

    @property
    def closed(self) -> np.ndarray:
        """Whether each node is in contact, bool, shape (n,)."""
        return self.status != OPEN

    @property
    def tractions(self) -> np.ndarray:
        """Pressure, then shear, shape (2n,)."""
        return np.concatenate([self.pressure, self.shear])

    @property
    def values(self) -> ContactValues:
        """The arrays of the contact for kernels."""
        return ContactValues(self.pressure, self.shear, self.gap, self.slip, self.status, self.motion)


def embedded(
    system: System,
    part: Configuration,
    nodes: np.ndarray,
    rest_gap: np.ndarray,
    rest_slip: np.ndarray,
    slip_tally: SlipTally,
) -> tuple[Configuration, np.ndarray]:
    """Put the contact of some nodes on all nodes of a system. The other nodes are open.

    Parameters
    ----------
    system : System
        With n nodes.
    part : Configuration
        The contact of k nodes.
    nodes : ndarray of int, shape (k,)
        These nodes, in their order round the hole.
    rest_gap, rest_slip : ndarray, shape (n,)
        Gap and slip at rest of the other nodes.
    slip_tally : SlipTally
        The tally of the other nodes.

    Returns
    -------
    (Configuration, ndarray)
        The contact of all nodes; and their gap and slip from the matrices, shape (2n,).
    """
    n = system.grid.size
    zeros = np.zeros(n)
    fields: dict[str, Any] = {"pressure": zeros, "shear": zeros, "rest_gap": rest_gap, "rest_slip": rest_slip}
    fields["status"] = np.full(n, OPEN, dtype=np.int8)
    for name, values in fields.items():
        fields[name] = values.copy()
        fields[name][nodes] = getattr(part, name)
    tractions = np.r_[fields["pressure"], fields["shear"]]
    true = system.displacement(tractions, part.motion, part.load, fields["rest_gap"])
    fields["gap"], fields["slip"] = np.maximum(true[:n], 0.0), true[n:].copy()
    fields["gap"][nodes], fields["slip"][nodes] = part.gap, part.slip
    tally = slip_tally.with_part(nodes, part.slip_tally)
    return part.changed(**fields, slip_tally=tally, marks=part.marks.at(nodes)), true


class Correction(NamedTuple):
    """The corrected values of a configuration whose statuses hold.

    Attributes
    ----------
    corrected : Configuration
        The configuration with its solution, each value kept within the bounds of its status.
    error, drift : float
        Relative error that is left, and the one of gap and slip before the correction.
    beyond : (float, float)
        How far the solution lies beyond its bounds, by traction and by gap.
    """

    corrected: Configuration
    error: float
    drift: float
    beyond: tuple[float, float]

    @classmethod
    def of(
        cls, system: System, before: Configuration, solution: ContactValues, error: float, drift: float
    ) -> Correction:
        """The correction of the configuration `before` by the solution of its statuses."""
        corrected = snap_to_bounds(system, before, solution)
        beyond = conditions.beyond_bounds(solution, corrected.values)
        return cls(corrected, error, drift, beyond)


def snap_to_bounds(system: System, configuration: Configuration, solution: ContactValues) -> Configuration:
    """The configuration with the solution of its statuses, each value kept within the bounds of its status.

    A pressure, shear or gap beyond its bound, or almost at it, is put exactly on the bound.
    """
    new = configuration.copy()
    new.motion = solution.motion
    conditions.put_on_bounds(system.friction, solution, new.values)
    return new


def reaches_end(system: System, configuration: Configuration) -> bool:
    """Whether the contact reaches an end node of an arc. There it is cut off."""
    return bool(configuration.closed[system.ends].any())


def resting_status(system: System) -> np.ndarray:
    """Status of each node where it is closed and does not move, int8, shape (n,): slipping where it has no friction."""
    return np.where(system.friction > 0.0, STICK, SLIP_POSITIVE).astype(np.int8)


def solve_statuses(
    system: System, status: np.ndarray, stuck_slip: np.ndarray, load: np.ndarray, rest_gap: np.ndarray | float
) -> ContactValues | None:
    """Solve for tractions and motion under given statuses.

    With ``rest_gap = 0``, zero `stuck_slip` and a load rate the solution holds rates.

    Parameters
    ----------
    system : System
    status : ndarray, shape (n,)
    stuck_slip : ndarray, shape (n,)
        Slip that sticking nodes hold.
    load : ndarray, shape (loads,)
        Dimensionless.
    rest_gap : ndarray, shape (n,), or float

    Returns
    -------
    ContactValues or None
        None if the closed nodes can't hold the pin: a mechanism.
    """
    matrix, unknowns = system.operator.matrix, np.count_nonzero(status != OPEN) + np.count_nonzero(status == STICK)
    if matrix is None or unknowns > equations.MOST_UNKNOWNS:
        active = DenseUnknowns(system, status)
        return None if active.singular else solve_unknowns(system, active, stuck_slip, load, rest_gap)
    n = system.grid.size
    pressure, shear, gap, slip = np.empty((4, n))
    found = ContactValues(pressure, shear, gap, slip, status, np.empty(system.motions))
    held = rest_gap if isinstance(rest_gap, np.ndarray) else np.full(n, rest_gap)
    condition = equations.solve_few(
        matrix, system.equations, system.load_displacement(load), system.load_forces(load), held, stuck_slip,
        system.width, found,
    )  # fmt: skip
    return found if condition > SINGULAR else None


def solve_unknowns(
    system: System, active: DenseUnknowns, stuck_slip: np.ndarray, load: np.ndarray, rest_gap: np.ndarray | float
) -> ContactValues:
    """Solve for tractions and motion with the unknowns `active`, as :func:`solve_statuses` does."""
    n = system.grid.size
    known = system.load_displacement(load, active.rows)
    known[: active.normal.size] += np.broadcast_to(rest_gap, n)[active.normal]
    known[active.normal.size :] -= stuck_slip[active.tangential]
    unknowns = active.solve(np.concatenate([-known, system.load_forces(load)]))
    tractions = active.expand(unknowns)
    motion = unknowns[active.count :]
    displacement = system.displacement(tractions, motion, load, rest_gap)
    return ContactValues(tractions[:n], tractions[n:], displacement[:n], displacement[n:], active.status, motion)


def accept_solution(start: Configuration, solution: ContactValues, load: np.ndarray) -> Configuration:
    """The configuration at `load` that the solution of its statuses gives, with the energies of `start`.

    Sticking nodes keep the slip of `start`. Values beyond their bounds by rounding are put on them.
    """
    new = start.copy()
    new.status = solution.status.copy()
    new.pressure = np.where(new.closed, np.maximum(solution.pressure, 0.0), 0.0)
    new.shear = np.where(new.closed, solution.shear, 0.0)
    new.gap = np.where(new.closed, 0.0, np.maximum(solution.gap, 0.0))
    new.slip = np.where(new.status == STICK, start.slip, solution.slip)
    new.motion = solution.motion
    new.load = load.copy()
    return new


def work_between(system: System, before: Configuration, after: Configuration) -> float:
    """Work of the loads between two configurations, computed with the mean load (dimensionless)."""
    n = system.grid.size
    load = 0.5 * (before.load + after.load)
    moved = after.motion - before.motion
    change = np.r_[after.pressure - before.pressure, after.shear - before.shear]
    column = system.held_displacement(load)
    internal = float((system.weights * column[:n]) @ change[:n] + (system.weights * column[n:]) @ change[n:])
    work = internal
    for rim in system.interfaces:
        moment = -0.5 * float(system.levers[rim.nodes] @ (before.shear + after.shear)[rim.nodes])
        x, y, turned = moved[rim.motion : rim.motion + 3]
        work = float(load[Q] * x - load[P] * y + moment * turned) + work
    mean = 0.5 * (before.motion + after.motion)
    return work + system.drive.work(system.both_weights, change, mean, moved, after.load - before.load)


def dissipation_between(system: System, before: Configuration, after: Configuration) -> float:
    """Energy dissipated between two configurations, computed with the mean shear (dimensionless)."""
    slid = np.where(after.closed, after.slip - before.slip, 0.0)
    return -0.5 * float((system.weights * slid) @ (before.shear + after.shear))


def seat_dissipation_between(system: System, before: Configuration, after: Configuration) -> float:
    """The part of :func:`dissipation_between` in the seat of a bush; 0 with a single interface."""
    slid, lost = np.where(after.closed, after.slip - before.slip, 0.0), 0.0
    for nodes in (rim.nodes for rim in system.interfaces[1:]):
        lost -= 0.5 * float((system.weights[nodes] * slid[nodes]) @ (before.shear + after.shear)[nodes])
    return lost


def add_dissipation(system: System, before: Configuration, after: Configuration) -> None:
    """Give `after` the dissipation of `before` and the energy dissipated in between, computed with the mean shear."""
    after.dissipation = before.dissipation + dissipation_between(system, before, after)
    after.seat_dissipation = before.seat_dissipation + seat_dissipation_between(system, before, after)


def slip_tally_with(configuration: Configuration, tally: SlipTally | None = None) -> SlipTally:
    """The slip tally of a configuration, or another `tally`, with the slip of the configuration in its extremes."""
    tally = configuration.slip_tally if tally is None else tally
    if not tally.is_counted:
        return tally
    tally, closed = tally.copy(), configuration.closed
    slip = (configuration.slip - configuration.rest_slip)[closed]  # the slip that users see
    tally.sums[2, closed] = np.minimum(tally.sums[2, closed], slip)
    tally.sums[3, closed] = np.maximum(tally.sums[3, closed], slip)
    return tally


def slip_tally_between(before: Configuration, after: Configuration) -> SlipTally:
    """The slip tally of `before`, and the slip from there to `after` at the nodes that are closed in the second.

    The mean shear gives the friction energy, as in :func:`dissipation_between`.
    """
    tally = slip_tally_with(after, before.slip_tally)
    if tally.is_counted:
        slid = np.where(after.closed, after.slip - before.slip, 0.0)
        tally.sums[:2] += np.array([np.abs(slid), -0.5 * slid * (before.shear + after.shear)])
        tally.sums[4:] += 0.5 * np.abs(slid) * (before.pressure + after.pressure)
    return tally


class Review(NamedTuple):
    """What a configuration violates, and the elastic energy in it.

    Attributes
    ----------
    residuals : dict of str to float
        Largest relative violation of each contact condition: "gap" and "slip", relative to the largest displacement;
        "cone" (Coulomb's law and N >= 0), relative to the largest pressure; "equilibrium", relative to the sum of the
        resultants of the absolute tractions.
    imbalance : float
        The largest force or moment that the tractions leave on a body: on the pin, on a bush, on the plate. It is
        recomputed from the tractions, without the conditions of equilibrium of the solver, and relative to the sum of
        the resultants of the absolute tractions. Every interface must pass on the force on the pin, and the same
        moment: that of a free pin is M.
    energy : float
        Elastic energy, up to a function of the load alone (dimensionless).
    """

    residuals: dict[str, float]
    imbalance: float
    energy: float


def review(system: System, configuration: Configuration) -> Review:
    """Recompute from the matrices what a configuration violates, and its elastic energy."""
    load, motion, tractions, drive = configuration.load, configuration.motion, configuration.tractions, system.drive
    residuals, imbalance, energy = conditions.review(
        system.equations, system.resultants, system.weights, configuration.values,
        system.elastic(tractions), load, configuration.rest_gap, system.concentric_gap,
        drive.force(motion, load), load.item(M), system.problem.held,
    )  # fmt: skip
    named = dict(zip(("gap", "slip", "cone", "equilibrium"), residuals, strict=True))
    return Review(named, imbalance, energy + drive.energy(system.both_weights, tractions, motion))


def thermal_energy(system: System, configuration: Configuration) -> float:
    """What the temperatures add to work and elastic energy, dimensionless: tractions times their displacement.

    Both count every load times its displacement. A body that expands freely stores nothing, so users see both less it.
    The stress of a body whose expansion is hindered does no work with that of the tractions, so the same holds for it.
    """
    if not any(configuration.load.item(place) for place in THERMAL):
        return 0.0
    n = system.grid.size
    moved = system.drive.columns[:, list(THERMAL)] @ configuration.load[list(THERMAL)]
    of_shear = float((system.weights * configuration.tractions[n:]) @ moved[n:])
    return float((system.weights * configuration.pressure) @ moved[:n]) + of_shear


def marks_left(before: Configuration, now: Configuration, interface: Interface, name: str) -> Marks:
    """The marks of the last corner, the configuration `before`, over which no slip zone has passed until `now`.

    They are those of an `interface`, the field `name` of a configuration.
    """
    at = slice(2 * MARKS.index(name), 2 * MARKS.index(name) + 2)
    # Where the pin, or a bush, was released, slip counts anew.
    if now.rest is not before.rest and not np.array_equal(now.rest[at], before.rest[at]):
        return Marks()
    nodes, marks = interface.nodes, getattr(before, name)
    found: Marks = marks.left(now.status[nodes], now.slip[nodes], before.slip[nodes])
    return found


def marked(system: System, before: Configuration, now: Configuration) -> Configuration:
    """A corner with marks at its borders, beside the old borders that are left since the corner `before`."""
    found: dict[str, Any] = {}
    friction = system.under(now.load).friction
    for name, each in zip(MARKS, system.interfaces, strict=False):
        marks, nodes = marks_left(before, now, each, name), each.nodes
        if not each.problem.frictionless:
            tractions = now.pressure[nodes], now.shear[nodes]
            marks = marks.with_borders(each.problem, each.grid, friction[nodes], tractions, now.status[nodes])
        found[name] = marks
    return now.changed(**found)


def worst_residual(system: System, configuration: Configuration) -> float:
    """The largest of the residuals of :func:`review`; NaN if one is NaN."""
    return float(np.maximum.reduce([*review(system, configuration).residuals.values()]))


def moment_that_holds(system: System, configuration: Configuration) -> float:
    """The moment that holds the rotation of the pin; 0 where it is rounding of the shear (dimensionless)."""
    nodes = system.interfaces[0].nodes
    levers, shear = system.levers[nodes], configuration.shear[nodes]
    moment = -float(levers @ shear)
    return moment if abs(moment) > ROUNDED * float(levers @ np.abs(shear)) else 0.0
