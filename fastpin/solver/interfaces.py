"""The pin in a bush that slips: its contact while the bush holds still in its seat.

A pin that comes to rest, touches first or is released is the matter of one interface. A :class:`PinView` gives it a
system of its own. There the bore has the shape that the tractions in the seat give it, and the bush sticks in its seat
wherever the two are closed. The contact that is found is put back among all nodes and solved with them.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from fastpin.elasticity.drive import Drive
from fastpin.elasticity.interfaces import PIN, SEAT, TURN, JointSystem
from fastpin.elasticity.operator import DenseOperator
from fastpin.elasticity.terms import BodyTerms
from fastpin.kernels.status import OPEN
from fastpin.model.loads import REMOTE, THERMAL, M, P, Q
from fastpin.model.profile import InitialGap, Profile
from fastpin.solver.configuration import (
    MARKS,
    MAX_RESIDUAL,
    NODAL,
    ROUNDED,
    Configuration,
    accept_solution,
    add_dissipation,
    resting_status,
    review,
    solve_statuses,
    worst_residual,
)
from fastpin.solver.errors import NARROW, ConvergenceError, NoEquilibriumError, ResolutionError
from fastpin.solver.increment import implicit_step
from fastpin.solver.path import PathStep, StepLostError
from fastpin.solver.settling import FiniteStep
from fastpin.solver.unknowns import DenseUnknowns


class PinView:
    """The contact of the pin while the bush sticks in its seat.

    Parameters
    ----------
    joint : JointSystem
    now : Configuration
        The configuration of all interfaces. It is not changed.

    Attributes
    ----------
    system : System
        The system of the pin alone, n nodes.
    """

    def __init__(self, joint: JointSystem, now: Configuration) -> None:
        self._joint, self._now = joint, now
        pin, unit = joint.alone[PIN], joint.scales.displacement
        self._nodes, self._seat = (np.arange(joint.grid.size)[rim.nodes] for rim in joint.interfaces)
        to_pin = joint.operator.entries(joint.nodes.rows(PIN), joint.nodes.rows(SEAT))
        (of_pin, turned_of_pin), (of_load, turned_of_load) = self._held()
        tractions = now.tractions[joint.nodes.rows(SEAT)]
        residual = tractions - of_load @ now.load[: of_load.shape[1]]
        gap, slip = np.split(to_pin @ residual, 2)
        angles, bore = joint.bore_shape
        shape = bore @ residual
        mean = float(shape.mean())
        is_round = float(np.abs(shape - mean).max()) <= ROUNDED * float(np.abs(residual).max(initial=0.0))
        profile = pin.problem.gap
        if not is_round:
            around = np.r_[angles, angles[0] + 2.0 * np.pi], unit * (np.r_[shape, shape[0]] - mean)
            profile = InitialGap(profile.hole + Profile.samples(*around), profile.pin)
        problem = replace(pin.problem, clearance=pin.problem.clearance + unit * mean, gap=profile)
        loads = pin.loads + to_pin @ of_load
        equilibrium, forces, self._turned = pin.equilibrium, pin.forces, 0.0
        if joint.is_held:  # the rotation of the pin over the lug is prescribed, and the bush turns in between
            unit = float(pin.motion_rows[TURN, TURN])
            turned = now.motion[3 + TURN] + joint.equilibrium[TURN, joint.nodes.rows(SEAT)] / unit @ tractions
            self._turned = float(turned - turned_of_load @ now.load[: of_load.shape[1]])
            equilibrium, forces = equilibrium.copy(), forces.copy()
            equilibrium[TURN] += unit * turned_of_pin
            forces[TURN] -= unit * turned_of_load
        self._gap, self._slip = np.full(gap.size, mean) if is_round else gap, slip - self._turned
        self.system = replace(
            pin, problem=problem, loads=loads, drive=Drive(pin.motion[:, :2], loads),
            friction=joint.friction[self._nodes], operator=DenseOperator(pin.operator.entries() + to_pin @ of_pin),
            equilibrium=equilibrium, forces=forces,
            rest_clearance=pin.rest_clearance + mean, initial_gap=pin.initial_gap + self._gap - mean,
            bodies=_moved_bore(pin.bodies, bore @ of_load),
        )  # fmt: skip

    def _held(self) -> tuple[tuple[np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray]]:
        """Tractions in the seat, (2k, 2n) and (2k, loads), and rotation of the bush, where the bush sticks.

        They are per traction on the pin and per load.
        """
        joint, seat = self._joint, self._joint.alone[SEAT]
        held = DenseUnknowns(seat, self._resting_seat())
        rows, columns = joint.nodes.rows(SEAT), joint.nodes.rows(PIN)
        to_seat = joint.operator.entries(rows[held.rows], columns)
        n = columns.size
        right = np.zeros((held.size, n + seat.loads.shape[1]), order="F")
        right[: held.count] = -np.hstack([to_seat, seat.loads[held.rows]])
        right[held.count :, n:] = seat.forces
        if joint.is_held:  # the moment that holds the pin acts on the bush
            right[held.count + TURN, :n] = -joint.equilibrium[3 + TURN, columns]
        found = held.solve(right)
        tractions, turned = held.expand(found), found[held.count + TURN]
        if joint.is_held:
            turned = turned + joint.equilibrium[TURN, rows] / joint.motion_rows[TURN, TURN] @ tractions
        return (tractions[:, :n], turned[:n]), (tractions[:, n:], turned[n:])

    def _resting_seat(self) -> np.ndarray:
        """The statuses of the seat, (k,), if nothing moves there."""
        seat, status = self._joint.alone[SEAT], self._now.status[self._seat]
        return np.where(status == OPEN, OPEN, resting_status(seat)).astype(np.int8)

    @property
    def pin(self) -> Configuration:
        """The contact of the pin."""
        part = part_of(self._joint, self._now, PIN)
        motion = part.motion.copy()
        motion[TURN] += self._turned
        return part.changed(
            motion=motion, slip=part.slip - self._slip, rest_gap=part.rest_gap + self._gap,
            rest_slip=part.rest_slip - self._slip,
        )  # fmt: skip

    def whole(self, pin: Configuration) -> Configuration:
        """The configuration of all interfaces with another contact of the pin, at its load.

        Raises
        ------
        NoEquilibriumError
            If nothing holds the bush in its seat.
        ResolutionError
            If the pin touches at a single node.
        ConvergenceError
            If no tractions in the seat were found for it.
        """
        joint, now = self._joint, self._now
        motion = pin.motion.copy()
        motion[TURN] -= self._turned
        part = pin.changed(
            motion=motion, slip=pin.slip + self._slip, rest_gap=pin.rest_gap - self._gap,
            rest_slip=pin.rest_slip + self._slip,
        )  # fmt: skip
        start = with_part(joint, now, PIN, part)
        resting = start.copy()
        resting.status[self._seat] = self._resting_seat()
        if not pin.closed.any():
            found = self._without_pin(start)
        else:
            found = None if joint.is_pressed else _begun_together(joint, start)
            found = found or _solved(joint, start, resting)
        if found is None:
            if pin.closed.sum() == 1:
                raise ResolutionError(NARROW)
            raise ConvergenceError("the tractions between bush and plate were not found; use more nodes")
        done = review(joint, found).energy - review(joint, now).energy
        found.work = now.work + done + found.dissipation - now.dissipation
        return found

    def _without_pin(self, start: Configuration) -> Configuration | None:
        """The configuration `start`, whose pin floats, with the tractions that are then left in the seat."""
        seat, own = self._joint.alone[SEAT], part_of(self._joint, start, SEAT)
        unloaded = without_force(start.load)
        solution = solve_statuses(seat, own.status, own.slip, unloaded, own.rest_gap)
        found = None if solution is None else accept_solution(own, solution, unloaded)
        if found is None or worst_residual(seat, found) > MAX_RESIDUAL:
            found = implicit_step(seat, own, unloaded)
            if found is None or worst_residual(seat, found) > MAX_RESIDUAL:
                return None
            add_dissipation(seat, own, found)
        turned = _turned_freely(self._joint, start)
        motion = found.motion + np.array([0.0, 0.0, turned])
        found = found.changed(load=start.load, motion=motion, slip=found.slip + seat.radius * turned)
        return with_part(self._joint, start, SEAT, found)


def _turned_freely(joint: JointSystem, start: Configuration) -> float:
    """The rotation of a bush without friction in its seat, as a held pin turns in it; 0 with friction."""
    if not joint.alone[SEAT].problem.frictionless:
        return 0.0
    row = 3 + TURN
    return float(joint.load_forces(start.load)[row] - joint.motion_rows[row, TURN] * start.motion[TURN])


def without_force(load: np.ndarray) -> np.ndarray:
    """The load (loads,) without force and moment on the pin."""
    left = load.copy()
    left[[P, Q, M]] = 0.0
    return left


def part_of(joint: JointSystem, configuration: Configuration, place: int) -> Configuration:
    """The contact of the interface `place`, of a configuration of all interfaces."""
    own, at = joint.interfaces[place], slice(2 * place, 2 * place + 2)
    part = configuration.part(np.arange(joint.grid.size)[own.nodes])
    return part.changed(
        motion=configuration.motion[own.motion : own.motion + 3], rest=configuration.rest[at],
        origin=configuration.origin[at], marks=getattr(configuration, MARKS[place]),
    )  # fmt: skip


def with_part(joint: JointSystem, configuration: Configuration, place: int, part: Configuration) -> Configuration:
    """Replace the contact of one interface by `part`; load, work and dissipation come from it."""
    own, at, whole = joint.interfaces[place], slice(2 * place, 2 * place + 2), configuration.copy()
    for name in NODAL:
        values = getattr(whole, name).copy()
        values[own.nodes] = getattr(part, name)
        setattr(whole, name, values)
    whole.motion[own.motion : own.motion + 3] = part.motion
    for name in ("rest", "origin"):
        values = getattr(whole, name).copy()
        values[at] = getattr(part, name)
        setattr(whole, name, values)
    lost = part.dissipation - whole.dissipation if place == SEAT else 0.0
    tally = whole.slip_tally.with_part(np.arange(joint.grid.size)[own.nodes], part.slip_tally)
    return whole.changed(
        load=part.load.copy(), dissipation=part.dissipation, work=part.work, slip_tally=tally,
        seat_dissipation=whole.seat_dissipation + lost,
    )  # fmt: skip


def _solved(joint: JointSystem, start: Configuration, resting: Configuration) -> Configuration | None:
    """The configuration `start` with its tractions: `resting`, where the seat sticks, or with a seat that slips.

    Where the bush does not stick, its seat follows the tractions of the pin, which grow in proportion, along its path.
    An implicit increment then finds both together.
    """
    found = _of_statuses(joint, resting)
    if found is not None:
        return found
    followed = _with_followed_seat(joint, start)
    for begun in (start,) if followed is None else (followed, start):
        found = _of_statuses(joint, begun) or implicit_step(joint, begun, begun.load)
        found = found or FiniteStep(joint, begun).to(begun.load)
        if found is not None and worst_residual(joint, found) <= MAX_RESIDUAL:
            add_dissipation(joint, begun, found)
            return found
    if followed is None:
        raise NoEquilibriumError("nothing holds the bush in its seat: it spins or loses contact")
    return None


def _begun_together(joint: JointSystem, start: Configuration) -> Configuration | None:
    """The configuration `start` with two contacts that begin at once, without shear; their closed nodes then stick.

    None if a moment acts on a free pin, or if no such contacts were found.
    """
    if start.load[M] != 0.0:
        return None
    smooth, begun = joint.without_friction(), start.copy()
    begun.status[begun.closed] = resting_status(smooth)[begun.closed]
    found = implicit_step(smooth, begun, start.load)
    if found is None:
        return None
    turns = start.motion.copy()
    if joint.is_held:  # without shear nothing twists
        unit = joint.motion_rows[TURN, TURN]
        turns[TURN] = joint.load_forces(start.load)[TURN] / unit - turns[3 + TURN]
    elif joint.alone[SEAT].problem.frictionless:
        turns[3 + TURN] = _turned_freely(joint, start)
    for each in joint.interfaces:
        turned = turns[each.motion + TURN]
        found.motion[each.motion + TURN] = turned
        found.slip[each.nodes] += each.radius * turned
        pressure = found.pressure[each.nodes]
        pressed = found.closed[each.nodes] & (pressure > ROUNDED * pressure.max())
        found.status[each.nodes] = np.where(pressed, resting_status(joint)[each.nodes], OPEN)
    return found if worst_residual(joint, found) <= MAX_RESIDUAL else None


def _of_statuses(joint: JointSystem, start: Configuration) -> Configuration | None:
    """The configuration `start` with the tractions of its statuses; None if they do not hold."""
    solution = solve_statuses(joint, start.status, start.slip, start.load, start.rest_gap)
    if solution is None:
        return None
    found = accept_solution(start, solution, start.load)
    return found if worst_residual(joint, found) <= MAX_RESIDUAL else None


def _with_followed_seat(joint: JointSystem, start: Configuration) -> Configuration | None:
    """The configuration `start` with its seat followed while the tractions of the pin grow from nothing.

    None if the seat can't follow them.
    """
    pin = joint.interfaces[PIN].nodes
    tractions = np.r_[start.pressure[pin], start.shear[pin]]
    column = joint.operator.entries(joint.nodes.rows(SEAT), joint.nodes.rows(PIN)) @ tractions
    force = np.zeros(3)
    if joint.is_held:  # the moment that holds the pin is no load
        force[TURN] = -float(joint.alone[PIN].levers @ start.shear[pin])
    alone = joint.alone[SEAT]
    loads = np.column_stack([alone.loads, column])
    grown = replace(
        alone, loads=loads, forces=np.column_stack([alone.forces, force]), drive=Drive(alone.motion[:, :2], loads)
    )
    own = part_of(joint, start, SEAT)
    begin, end = np.r_[without_force(start.load), 0.0], np.r_[start.load, 1.0]
    try:
        followed = PathStep(grown, own.changed(load=begin), end).follow(1.0)
    except StepLostError:
        return None
    return with_part(joint, start, SEAT, followed.changed(load=start.load, work=start.work))


def _moved_bore(bodies: BodyTerms | None, columns: np.ndarray) -> BodyTerms | None:
    """The terms of the bodies with the bore's radial displacement `columns` (angles, loads) under loads in the seat."""
    assert bodies is not None
    angles = len(columns)
    start = np.exp(1.5j * np.pi * np.arange(angles // 2))
    moved = {}
    for place in (*REMOTE, *THERMAL):
        series = np.fft.rfft(columns[:, place])[: angles // 2] / angles * start
        moved[place] = np.r_[series[:0:-1].conj(), series]
        if place in bodies.columns:
            moved[place][series.size - 1] += bodies.columns[place][0]
    return replace(bodies, columns=moved)
