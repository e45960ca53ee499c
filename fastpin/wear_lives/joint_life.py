"""A life of wear of a joint of several pins: the task, its recorder, and the result."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Protocol, Self

import numpy as np

from fastpin.errors import InputError
from fastpin.joints.parts import Joint
from fastpin.joints.result import JointState, check_wear, cycle_length
from fastpin.joints.solving import JointMatrices, JointTask, reference_force
from fastpin.model.checks import instance, number, true_or_false
from fastpin.model.doubts import warn_of, wear_doubts
from fastpin.model.history import LoadHistory
from fastpin.model.read_only import ReadOnly
from fastpin.model.wear import Wear
from fastpin.solver.errors import Interrupted, SolveError
from fastpin.solver.run import RunProgress
from fastpin.solver.task import deferred_interrupts, one_blas_thread
from fastpin.states.state import State
from fastpin.wear_lives.fat_cycles import FatCycles, Worn
from fastpin.wear_lives.joint_run import JointWearRun
from fastpin.wear_lives.life import lived_to
from fastpin.wear_lives.wear_result import WearResult, WornCycle


@dataclass(frozen=True, eq=False, repr=False)
class WornJoint(ReadOnly):
    """A joint after a chosen cycle.

    Attributes
    ----------
    cycle, next_jump, solved : int
        See :class:`fastpin.wear_lives.WornCycle`.
    states : tuple of JointState
        The states over one cycle on these profiles, without further wear: at its beginning, and at its corners.
    contacts : tuple of WornCycle
        The wear of each pin in each plate, in the order of ``joint.sections``, then of each bush in its plate. "pin" is
        the inner body of an interface, and "plate" the outer one: at a pin in a bush the bush. Energies and volumes are
        per thickness. The energy that goes with the material is not counted: it is NaN.
    """

    cycle: int
    next_jump: int
    solved: int
    states: tuple[JointState, ...]
    contacts: tuple[WornCycle, ...]

    def __getitem__(self, names: tuple[str, str]) -> WornCycle:
        """The wear of a pin in a plate, or a slice, by both names: ``worn["A", "skin"]``."""
        return self.contacts[self.joint.place(*names)]

    @property
    def joint(self) -> Joint:
        """The joint."""
        return self.states[0].joint

    @property
    def names(self) -> list[tuple[str, str]]:
        """Pin and plate of each of the contacts; a bush in its plate is called "bush of A"."""
        found = [(pin.name, plate.name) for pin, plate in self.joint.sections]
        return found + [(f"bush of {found[place][0]}", found[place][1]) for place in seat_places(self.states[0])]

    @property
    def depth(self) -> float:
        """Largest growth of a gap at a node, m."""
        return max(each.depth for each in self.contacts)

    @property
    def volumes(self) -> np.ndarray:
        """Volume worn off inner and outer body of each contact, over the whole thickness, m^3, (contacts, 2)."""
        return np.array([np.multiply(each.volumes, thick) for each, thick in self._thick()])

    @property
    def volume(self) -> float:
        """Volume worn off all bodies, m^3."""
        return float(self.volumes.sum())

    @property
    def energy_per_cycle(self) -> float:
        """Energy dissipated by friction in a cycle on these profiles, J, without that of faying surfaces."""
        return sum(thick * each.energy_per_cycle for each, thick in self._thick())

    @property
    def dissipation(self) -> float:
        """Energy dissipated by friction at the contacts so far, J."""
        return sum(thick * each.dissipation for each, thick in self._thick())

    @property
    def largest_pressure(self) -> float:
        """Largest pressure at a node over one cycle on these profiles, Pa."""
        return max(each.largest_pressure for each in self.contacts)

    def shares(self, plate: str) -> dict[str, float]:
        """The share of each pin in the force on a plate at the corner of the cycle where this force is largest.

        An unknown plate raises :class:`InputError`.
        """
        pins = [pin.name for pin in self.joint.pins if plate.partition(".")[0] in pin.plates]
        sizes = [float(np.abs(sum(state.force(pin, plate) for pin in pins)).max()) for state in self.states]
        return self.states[int(np.argmax(sizes))].shares(plate)

    def _thick(self) -> list[tuple[WornCycle, float]]:
        """The contacts with the thickness of their plates, m."""
        return [(each, float(each.states[0].problem.thickness or 1.0)) for each in self.contacts]

    def __repr__(self) -> str:
        return f"<WornJoint: after {self.cycle:,} cycles, depth {self.depth:.4g}, volume {self.volume:.4g}>"


@dataclass(frozen=True, eq=False, repr=False)
class JointWearResult(ReadOnly, Sequence[WornJoint]):
    """A life of wear of a joint: a sequence of :class:`WornJoint`, one for each chosen cycle that was reached.

    Attributes
    ----------
    joint : Joint
    wear : Wear
    nodes : int
        Nodes of each contact, all round.
    cycles : tuple of WornJoint
    complete : bool
        Whether all cycles were followed; False in the result that an error carries.
    statistics : dict of str to float
        "solved": the cycles that were really solved; "snaps": see :class:`fastpin.joints.JointResult`.
    """

    joint: Joint
    wear: Wear
    nodes: int
    cycles: tuple[WornJoint, ...]
    complete: bool
    statistics: dict[str, float]

    @property
    def numbers(self) -> np.ndarray:
        """The chosen cycles, shape (chosen,)."""
        return np.array([each.cycle for each in self.cycles])

    def shares(self, plate: str) -> dict[str, np.ndarray]:
        """The share of each pin in the force on a plate over the life, by name; see :meth:`WornJoint.shares`."""
        rows = [each.shares(plate) for each in self.cycles]
        return {name: np.array([row[name] for row in rows]) for name in rows[0]} if rows else {}

    def cycles_to(self, depth: float) -> float:
        """Cycles until a gap has grown by a `depth`, m; infinite if none has. Between chosen cycles it is linear.

        Raises
        ------
        InputError
            If the depth is not positive.
        """
        limit, before = number("depth", depth, 0.0), (0, 0.0)
        for each in self.cycles:
            if each.depth >= limit:
                share = (limit - before[1]) / (each.depth - before[1]) if each.depth > before[1] else 0.0
                return before[0] + share * (each.cycle - before[0])
            before = each.cycle, each.depth
        return float("inf")

    def of(self, pin: str, plate: str, seat: bool = False) -> WearResult:
        """The life of one pin in one plate, as that of a single pin: with its figures, its table and its fatigue.

        With `seat` it is that of the bush in the plate. Its history has the forces of the first cycle.

        Raises
        ------
        InputError
            If a name is unknown, there is no such bush, or no cycle was reached.
        """
        place = self.joint.place(pin, plate)
        if not self.cycles:
            raise InputError("pin", "no cycle was reached")
        if true_or_false("seat", seat):
            place = seat_places(self.cycles[0].states[0]).get(place, -1)
            if place < 0:
                raise InputError("seat", f"{pin} has no bush with a seat in {plate}")
        contacts = tuple(each.contacts[place] for each in self.cycles)
        first = contacts[0].states
        corners = [{name: state.load[name] for name in ("P", "Q")} for state in first[1:]]
        history = LoadHistory(corners) + LoadHistory(corners).repeated(self.wear.cycles + 1)
        coefficients = self.wear.coefficients(first[0].problem.hole_radius, first[0].theta)
        law, tolerance = self.wear.law, self.wear.tolerance
        return WearResult(
            first[0].problem, history, law, tolerance, coefficients, first[0].grid, contacts, self.complete,
            self.statistics,
        )  # fmt: skip

    def __repr__(self) -> str:
        whole = "complete" if self.complete else "incomplete"
        head = f"<JointWearResult: {len(self.cycles)} chosen cycles, {self.nodes} nodes a contact, {whole}"
        return f"{head}\n last: {self.cycles[-1]!r}>" if self.cycles else f"{head}>"

    def __getitem__(self, index):  # type: ignore[no-untyped-def]
        return self.cycles[index]

    def __len__(self) -> int:
        return len(self.cycles)


class JointWearRecorder(Protocol):
    """The receiver of a life of wear of a joint."""

    def add(self, worn: WornJoint, place: Worn, statistics: dict[str, float]) -> None:
        """Keep a chosen cycle, and the place from which the life goes on."""

    def reached(self, place: Worn) -> None:
        """Note a place from which the life can go on later."""


class WornInMemory:
    """A recorder of the chosen cycles of a joint in memory."""

    def __init__(self) -> None:
        self.cycles: list[WornJoint] = []
        self.statistics: dict[str, float] = {}

    def add(self, worn: WornJoint, place: Worn, statistics: dict[str, float]) -> None:
        """Keep a chosen cycle."""
        self.cycles.append(worn)
        self.statistics = statistics

    def reached(self, place: Worn) -> None:
        """Do nothing: a result in memory does not go on."""


@dataclass(frozen=True, eq=False)
class JointWearTask:
    """A life of wear of a joint to follow.

    Attributes
    ----------
    task : JointTask
        The joint under its history, at whose end the cycle stands at least twice.
    wear : Wear
    progress : callable or None
        Called as ``progress(done_cycles, all_cycles)`` now and then.
    """

    task: JointTask
    wear: Wear
    progress: RunProgress | None = None

    @classmethod
    def of(
        cls, joint: Joint, corners: Any, wear: Wear, nodes: int, harmonics: int | None, progress: RunProgress | None
    ) -> Self:
        """The task of the arguments of :func:`wear_joint`, after their check."""
        found = cls(JointTask.of(joint, corners, nodes, harmonics, progress), instance("wear", wear, Wear, "a Wear"))
        check_wear(wear, found.task.values)
        return replace(found, progress=progress)

    @property
    def length(self) -> int:
        """Corners of a cycle."""
        return cycle_length(self.task.values)

    @property
    def cycle(self) -> np.ndarray:
        """Loads at the corners of the cycle, SI, shape (corners, loads)."""
        return self.task.values[-self.length :]

    def result(self, kept: WornInMemory) -> JointWearResult:
        """The result in memory."""
        complete = bool(kept.cycles) and kept.cycles[-1].cycle == self.wear.cycles
        task = self.task
        return JointWearResult(task.joint, self.wear, task.nodes, tuple(kept.cycles), complete, kept.statistics)

    def follow(self, recorder: JointWearRecorder, place: Worn | None = None, stored: int = -1) -> None:
        """Follow the life from no load, or from a `place` of an earlier run, to the same bits.

        The recorder has the chosen cycles up to the cycle `stored`.

        Raises
        ------
        SolveError
            If a cycle can't be followed. It names the cycle.
        Interrupted
            After Ctrl-C.
        """
        task = self.task
        approach = task.values[: -self.length]
        with deferred_interrupts() as caught, one_blas_thread():

            def watch(part: float) -> None:
                if caught:
                    raise Interrupted

            force = reference_force(task.joint, task.values)
            run = JointWearRun(JointMatrices.of(task.joint, force, task, watch), watch)
            life = FatCycles(run, self.wear, self.cycle)
            if place is None:
                place = life.begin(approach)
            else:
                life.at(place, len(approach))
            for target in (each for each in self.wear.chosen if each > stored):
                place = lived_to(life, place, target, recorder, self)
                recorder.add(_worn_joint(life, place), place, {**place.restart.statistics, "solved": place.solved})


def wear_joint(
    joint: Joint,
    corners: Sequence[Mapping[str, float]],
    wear: Wear,
    *,
    nodes: int = 96,
    harmonics: int | None = None,
    progress: RunProgress | None = None,
) -> JointWearResult:
    """Follow a load cycle of a joint many times on profiles that wear, and return the joint after chosen cycles.

    What leads to the cycle is followed once, and wears, too. Then every cycle is solved, or cycles that stand for many,
    as by :func:`fastpin.wear`. The gaps of all interfaces change, and with them the shares of the pins.

    Parameters
    ----------
    joint : Joint
    corners : sequence of mappings
        See :func:`fastpin.joints.solve_joint`. The cycle is the shortest run of corners at its end that repeats the
        loads before.
    wear : Wear
        "pin" is the inner body of an interface, and "plate" the outer one. A bush is the outer body at the pin, and the
        inner one in its plate. Faying surfaces do not wear.
    nodes, harmonics
        See :func:`fastpin.joints.solve_joint`.
    progress : callable, optional
        Called as ``progress(done_cycles, all_cycles)`` now and then.

    Returns
    -------
    JointWearResult
        Also the ``result`` of an error or interrupt: the chosen cycles that were reached before.

    Raises
    ------
    InputError
        If an argument can't be used. The error names the field.
    SolveError
        If a cycle can't be followed, or a worn depth is too large for small strains. It names the cycle.
    Interrupted
        After Ctrl-C.
    """
    task, kept = JointWearTask.of(joint, corners, wear, nodes, harmonics, progress), WornInMemory()
    warn_of(wear_doubts(joint.problem(*joint.sections[0]), wear), 2)
    try:
        task.follow(kept)
    except (SolveError, Interrupted) as ended:
        ended.result = task.result(kept)  # type: ignore[assignment]
        raise
    return task.result(kept)


def seat_places(state: JointState) -> dict[int, int]:
    """The places of the seats of bushes among all interfaces, by those of their pins."""
    seats = [place for place, contact in enumerate(state.contacts) if contact.seat is not None]
    return dict(zip(seats, range(len(state.contacts), len(state.contacts) + len(seats)), strict=True))


def interface_states(states: Sequence[JointState]) -> list[tuple[State, ...]]:
    """The states of each interface: of the pins, then of the bushes in their plates."""
    found = [tuple(state.contacts[place] for state in states) for place in range(len(states[0].contacts))]
    return found + [
        tuple(state.contacts[place].seat for state in states)  # type: ignore[misc]
        for place in seat_places(states[0])
    ]


def _worn_joint(life: FatCycles, place: Worn) -> WornJoint:
    """The joint at a place of its life."""
    system = life.run.system
    scales, states = system.scales, life.states(place)
    contacts = []
    for nodes, lost, own in zip(system.nodes.parts, place.restart.dissipation, interface_states(states), strict=True):
        inner, outer = place.depth[:, nodes] * scales.displacement
        counts = place.cycle, place.jump, place.solved
        contacts.append(WornCycle(*counts, inner, outer, float(lost) * scales.energy, float("nan"), own))
    return WornJoint(place.cycle, place.jump, place.solved, states, tuple(contacts))
