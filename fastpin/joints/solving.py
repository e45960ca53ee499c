"""From a joint and its loads to a result."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Protocol, Self

import numpy as np

from fastpin.elasticity.interfaces import seat_grid
from fastpin.errors import InputError
from fastpin.joints.conditions import JointLoads, Motion, PinSection, RingBetween
from fastpin.joints.faying import FayingSurface
from fastpin.joints.hole import HoleInPlate
from fastpin.joints.parts import MOVES, Joint, JointPlate
from fastpin.joints.path import follow, refined, unloaded
from fastpin.joints.pins import whole_name
from fastpin.joints.result import JointResult, JointState, JointStates
from fastpin.joints.states import Since, StateMaker, residuals_of
from fastpin.joints.system import FIT, PinsSystem, build
from fastpin.lugs.plates import harmonic_sizes
from fastpin.lugs.several_holes import HolesCompliance, holes_in_infinite_plate, holes_in_outline
from fastpin.model.angles import BOTTOM
from fastpin.model.checks import as_toml, check_callable, instance, items, known_name, number, whole_number
from fastpin.model.grid import Grid
from fastpin.model.loads import LOADS
from fastpin.solver.configuration import MAX_RESIDUAL, ROUNDED, Configuration
from fastpin.solver.errors import Interrupted, SolveError
from fastpin.solver.run import RunProgress
from fastpin.solver.slip_tally import SlipTally
from fastpin.solver.tableau import TableauMemory
from fastpin.solver.task import deferred_interrupts, one_blas_thread

LEAST_NODES, MOST_NODES = 16, 720
"""Nodes of a contact, all round."""

MOST_HARMONICS = 48
"""Harmonics of a hole, at most. Holes with a pitch of 1.25 diameters need 33."""

FIRST_TRIED = 16
"""Harmonics that are tried first for a plate with an outline."""

DECAYED = 1e-7
"""Size of the last harmonic at which no more are taken, in parts of the largest one."""


MOST_LOAD = 1e50
"""Limit of every load, N, Pa or m. Squares of all results are numbers."""

MOST_KEPT = 16
"""Compliances of plates with an outline that are kept."""

_KEPT: dict[Any, HolesCompliance] = {}


def solve_joint(
    joint: Joint,
    corners: Sequence[Mapping[str, float]],
    *,
    nodes: int = 96,
    harmonics: int | None = None,
    progress: RunProgress | None = None,
) -> JointResult:
    """Follow a load history of a joint and return the states at its corners.

    All pins begin concentric in their holes. A loose pin stays in the middle of its holes until it touches: with
    friction, the first touch decides where. Pins with interference are driven in together, before the first load.

    Parameters
    ----------
    joint : Joint
    corners : sequence of mappings
        Loads at the corners by the names of ``joint.given_names``: forces in N, stresses in Pa, displacements in m. A
        load that is left out keeps its value. Between corners the loads are linear. A load below 1e-12 of its largest
        size is rounding, as at a zero of a sine: it is taken as zero.
    nodes : int
        Nodes of each contact, all round.
    harmonics : int, optional
        Highest harmonic of the holes, by which the pins of a plate act on one another. Chosen unless given.
    progress : callable, optional
        Called as ``progress(done_steps, all_steps)`` now and then.

    Returns
    -------
    JointResult
        Every state meets the contact conditions and the equilibrium of all pins and plates to 1e-9.

    Raises
    ------
    InputError
        If an input can't be used. The error names the field.
    NoEquilibriumError, ConvergenceError
        If the joint can't carry a load, or no state was found. The ``result`` of the error is the result so far.
    Interrupted
        After Ctrl-C. It is a KeyboardInterrupt with the ``result`` so far.
    """
    task, kept = JointTask.of(joint, corners, nodes, harmonics, progress), StatesInMemory()
    try:
        task.follow(kept)
    except (SolveError, Interrupted) as ended:
        ended.result = task.result(kept)  # type: ignore[assignment]
        raise
    return task.result(kept)


@dataclass(frozen=True, eq=False)
class JointRestart:
    """Everything from which a joint goes on at a corner, to the same bits.

    Attributes
    ----------
    corner : int
        Number of corners that were followed.
    configuration : Configuration
    since : Since
    snaps : int
        Times that a pin was released, or snapped to a new place.
    seconds : float
        Time of the solution.
    """

    corner: int
    configuration: Configuration
    since: Since
    snaps: int
    seconds: float


class JointRecorder(Protocol):
    """Takes the states of a joint while they are found."""

    def begin(self, holes: Sequence[HoleInPlate]) -> None:
        """Begin with the holes of all sections, without loads."""

    def add(self, state: JointState) -> None:
        """Take the next state."""

    def corner_reached(self, restart: JointRestart) -> None:
        """Take the place from which the joint goes on."""


class StatesInMemory:
    """The recorder of :func:`solve_joint`.

    Attributes
    ----------
    states : list of JointState
    orders : tuple of int
        Highest harmonic of the hole of each section.
    restart : JointRestart or None
    """

    def __init__(self) -> None:
        self.states: list[JointState] = []
        self.orders: tuple[int, ...] = ()
        self.restart: JointRestart | None = None

    def begin(self, holes: Sequence[HoleInPlate]) -> None:
        """Keep the harmonics."""
        self.orders = tuple(hole.order for hole in holes)

    def add(self, state: JointState) -> None:
        """Keep the state."""
        self.states.append(state)

    def corner_reached(self, restart: JointRestart) -> None:
        """Keep the latest one."""
        self.restart = restart


@dataclass(frozen=True, eq=False)
class JointTask:
    """A joint under a load history, and how it is followed.

    Attributes
    ----------
    joint : Joint
    values : ndarray, shape (corners, loads)
        Loads at the corners, in the order of ``joint.load_names``.
    nodes : int
    harmonics : int or None
    progress : callable or None
    """

    joint: Joint
    values: np.ndarray
    nodes: int
    harmonics: int | None
    progress: RunProgress | None

    @classmethod
    def of(cls, joint: Joint, corners: Any, nodes: int, harmonics: int | None, progress: RunProgress | None) -> Self:
        """The task of the arguments of :func:`solve_joint`, after their check."""
        instance("joint", joint, Joint, "a Joint")
        nodes = whole_number("nodes", nodes, LEAST_NODES, MOST_NODES)
        if harmonics is not None:
            harmonics = whole_number("harmonics", harmonics, 2, MOST_HARMONICS)
        check_callable("progress", progress)
        return cls(joint, load_values(joint, corners), nodes, harmonics, progress)

    def result(self, kept: StatesInMemory) -> JointResult:
        """The result in memory."""
        of = {
            whole_name(plate.name): order for (_, plate), order in zip(self.joint.sections, kept.orders, strict=False)
        }
        last = kept.restart
        snaps, seconds = (0, 0.0) if last is None else (last.snaps, last.seconds)
        orders = tuple(of.get(plate.name, 0) for plate in self.joint.plates)
        return JointResult(self.joint, JointStates(kept.states), self.nodes, orders, snaps, seconds)

    def follow(self, recorder: JointRecorder, start: JointRestart | None = None) -> None:
        """Give a recorder all states, or the later ones of a restart.

        Raises
        ------
        SolveError, Interrupted
            See :func:`solve_joint`.
        """
        values, began = self.values, time.perf_counter()
        first, before = (0, 0.0) if start is None else (start.corner, start.seconds)
        step = first
        with deferred_interrupts() as caught, one_blas_thread():

            def report(part: float) -> None:
                if caught:
                    raise Interrupted
                if self.progress is not None:
                    self.progress(step + part, len(values))

            run = JointRun(JointMatrices.of(self.joint, reference_force(self.joint, values), self, report))
            recorder.begin(run.holes)
            if start is not None:
                run.go_to(start, values[first - 1])
            for step in range(first, len(values)):
                recorder.add(run.step_to(values[step], report))
                recorder.corner_reached(replace(run.restart, seconds=before + time.perf_counter() - began))
                report(1.0)


@dataclass(frozen=True, eq=False)
class JointMatrices:
    """The matrices of a joint, from which it is followed. They never change, and several runs may share them.

    Attributes
    ----------
    joint : Joint
    plates : list of HolesCompliance
    force : float
        The reference force of all that has no dimensions, N/m: a power of two.
    system : PinsSystem
    """

    joint: Joint
    plates: list[HolesCompliance]
    force: float
    system: PinsSystem

    @classmethod
    def of(cls, joint: Joint, force: float, how: JointTask, report: Callable[[float], None]) -> Self:
        """Fill the matrices. `how` has the nodes and the harmonics."""
        plates = [plate_compliance(joint, plate, how.harmonics, report) for plate in joint.plates]
        return cls(joint, plates, force, joint_system(joint, plates, force, how.nodes))

    @property
    def unit(self) -> np.ndarray:
        """The unit of each load, SI, shape (loads,), in the order of ``joint.load_names``."""
        return self.force * load_units(self.joint)


class JointRun:
    """A joint that is led from load to load. It begins without load, and before any fit.

    Parameters
    ----------
    matrices : JointMatrices

    Attributes
    ----------
    matrices : JointMatrices
    restart : JointRestart
        Where the joint is. Its contents never change.
    loads : ndarray, shape (loads,)
        The loads there, SI, in the order of ``joint.load_names``.
    """

    def __init__(self, matrices: JointMatrices) -> None:
        joint, system = matrices.joint, matrices.system
        self.matrices, self.loads, self._unit = matrices, np.zeros(len(joint.load_names)), matrices.unit
        self._maker, self._memory = StateMaker(joint, system, matrices.plates), TableauMemory(system)
        since = Since.start(len(system.sections), len(system.faying))
        self.restart = JointRestart(0, unloaded(system), since, 0, 0.0)

    @property
    def holes(self) -> list[HoleInPlate]:
        """The hole of each section of the joint, without loads."""
        return self._maker.holes

    def go_to(self, restart: JointRestart, loads: np.ndarray) -> None:
        """Go to a place that a run with equal matrices has reached under these `loads`."""
        self.restart, self.loads = restart, loads

    def step_to(self, loads: np.ndarray, report: Callable[[float], None]) -> JointState:
        """Follow a straight step to these loads (loads,), SI, and return the state there.

        `report` is called now and then with the part of the step that is done. After an error the run is where it was.

        Raises
        ------
        SolveError
            ``step``, ``fraction`` and ``load`` say where the joint was lost.
        """
        joint, here = self.matrices.joint, self.restart
        since, acting = here.since.copy(), dict(zip(joint.load_names, loads.tolist(), strict=True))
        try:
            now, snaps, residuals = self.followed(loads, report)
            state = self._maker.state(now, since, residuals, here.corner, acting)
        except SolveError as error:
            _say_where(error, joint, here.corner, self.loads, loads)
            raise
        self.restart, self.loads = JointRestart(here.corner + 1, now, since, snaps, here.seconds), loads
        return state

    def followed(
        self, loads: np.ndarray, report: Callable[[float], None], wears: bool = False
    ) -> tuple[Configuration, int, dict[str, float]]:
        """Follow a straight step to these loads (loads,), SI, without going there.

        Returns the configuration there, all snaps since the start, and the residuals. With `wears` the slip tally
        counts int N |ds|.

        Raises
        ------
        SolveError
            If the load can't be carried, or no state was found.
        """
        system, here = self.matrices.system, self.restart
        now, snaps = here.configuration, here.snaps
        if not here.corner and system.loads[:, FIT].any():
            now, snaps = follow(system, now, np.r_[now.load[:-2], 1.0, 1.0], self._memory, lambda part: report(0.0))
        load = np.r_[np.zeros(len(LOADS)), loads / self._unit, now.load[-2:]]
        begun = replace(now, dissipation=0.0, slip_tally=SlipTally.empty(system.grid.size, wears))
        now, more = follow(system, begun, load, self._memory, report)
        residuals = residuals_of(system, now)
        if max(residuals.values()) > MAX_RESIDUAL:
            now = refined(system, now)
            residuals = residuals_of(system, now)
        return now, snaps + more, residuals


def _say_where(error: SolveError, joint: Joint, step: int, before: np.ndarray, after: np.ndarray) -> None:
    """Give an error the step, the fraction and the load at which the joint was lost, between two loads (loads,)."""
    part = 1.0 if error.fraction is None or not math.isfinite(error.fraction) else error.fraction
    load = dict(zip(joint.load_names, (before + part * (after - before)).tolist(), strict=True))
    error.step, error.fraction, error.load = step, part, load
    acting = ", ".join(f"{name} = {value:g}" for name, value in load.items() if value) or "no load"
    error.args = (f"step {step + 1}, at {100.0 * part:.4g} % ({acting}): {error}",)


def load_values(joint: Joint, corners: Sequence[Mapping[str, float]]) -> np.ndarray:
    """The loads at the corners, shape (corners, loads), in the order of ``joint.load_names``.

    Raises
    ------
    InputError
        If there is no corner, a name is unknown, or a value is no finite number.
    """
    given = items("corners", corners, "a list of corners")
    if not given:
        raise InputError("corners", "must have at least one corner")
    values = np.zeros((len(given), len(joint.load_names)))
    for place, corner in enumerate(given):
        values[place] = next_loads(joint, corner, place, values[place - 1])
    values[np.abs(values) <= ROUNDED * np.abs(values).max(axis=0)] = 0.0
    return values


def next_loads(joint: Joint, corner: Any, place: int, before: np.ndarray) -> np.ndarray:
    """The loads at the corner with the number `place`, from 0, after those `before` (loads,), SI.

    Raises
    ------
    InputError
        If a name is unknown, or a value is no number or above :data:`MOST_LOAD`.
    """
    if not isinstance(corner, Mapping):
        raise InputError("corners", f"corner {place + 1} must map loads to numbers, not {as_toml(corner)}")
    found = before.copy()
    for name, value in corner.items():
        if name in joint.reactions:
            raise InputError(f"corner {place + 1}", f"{name} {reaction_words(joint, name)}")
        known_name(f"corner {place + 1}", name, joint.given_names)
        found[joint.load_names.index(name)] = number(name, value, -MOST_LOAD, MOST_LOAD)
    return found


def reaction_words(joint: Joint, name: str) -> str:
    """Why a load can't be given: it is a reaction."""
    return f"is the reaction to {joint.reactions[name]}: drive gives the displacement in its place"


def plate_compliance(
    joint: Joint, plate: JointPlate, harmonics: int | None, report: Callable[[float], None]
) -> HolesCompliance:
    """The compliance of the pinned holes of a plate. That of an outline takes seconds, and is kept for equal plates."""
    pins, radius = joint.pins_of(plate), joint.radius_in(plate)
    report(0.0)
    if plate.is_infinite:
        places, kolosov = np.array([pin.at for pin in pins]) / radius, plate.material.kolosov(joint.plane)
        return holes_in_infinite_plate(kolosov, places, harmonics or harmonics_needed(places))
    key = (
        replace(plate, name="plate", thickness=1.0, slices=1),
        tuple(pin.at for pin in pins),
        radius,
        joint.plane,
        harmonics,
    )
    if key in _KEPT:
        return _KEPT[key]
    lug, pinned = joint.lug(pins[0].name, plate.name)
    order, found = harmonics or FIRST_TRIED, None
    while found is None:
        found = holes_in_outline(lug, pinned, order, lambda done: report(0.0))
        last = max(float(harmonic_sizes(found.block(hole, hole))[-1]) for hole in range(found.holes))
        if not harmonics and order < MOST_HARMONICS and last > DECAYED:
            order, found = min(2 * order, MOST_HARMONICS), None
    if len(_KEPT) == MOST_KEPT:
        _KEPT.clear()
    _KEPT[key] = found
    return found


def harmonics_needed(centres: np.ndarray) -> int:
    """Harmonics of holes of radius 1 in an infinite plate that decay to 1e-7 of the hole's compliance."""
    apart = np.abs(centres[:, None] - centres) + np.diag(np.full(centres.size, np.inf))
    nearest = float(apart.min())
    if not math.isfinite(nearest):
        return 4
    least = 4.0 - math.log(DECAYED) / (2.0 * math.log(nearest - 1.0)) if nearest > 2.0 else math.inf
    return int(min(max(least, 4.0), MOST_HARMONICS))


def _interfaces(joint: Joint, nodes: int) -> tuple[list[PinSection], list[RingBetween], list[Grid]]:
    """The interfaces of all pins and then those round bushes, the bushes, and the nodes of each interface."""
    thick, radius, through = joint.plates[0].thickness, joint.radius, [joint.pins_of(plate) for plate in joint.plates]
    names, grids = [plate.name for plate in joint.plates], [Grid.circle(nodes, BOTTOM)] * len(joint.sections)
    sections, around, rings = list[PinSection](), list[PinSection](), list[RingBetween]()
    for inner, (pin, plate) in enumerate(joint.sections):
        place, problem = names.index(whole_name(plate.name)), joint.problem(pin, plate)
        at = (pin.at - through[place][0].at) / radius
        own, *seats = (
            PinSection(
                joint.pins.index(pin), place, through[place].index(pin), at, each, plate.thickness / thick,
                joint.plates[place].slices, each.hole_radius / radius,
            )
            for each in problem.interfaces
        )  # fmt: skip
        sections.append(own)
        if seats:
            rings.append(RingBetween(inner, len(grids), not problem.bush_slips))
            grids, around = [*grids, seat_grid(problem, grids[inner])], [*around, *seats]
    return sections + around, rings, grids


def load_units(joint: Joint) -> np.ndarray:
    """The unit of each load per N/m of the reference force, SI, shape (loads,)."""
    beta = joint.problem(*joint.sections[0]).surfaces.beta_star
    units = {"traction": 1.0 / joint.radius, "force": joint.plates[0].thickness, "displacement": beta}
    return np.array([units[joint.load_kind(name)] for name in joint.load_names])


def reference_force(joint: Joint, values: np.ndarray) -> float:
    """The reference force of a joint under loads (corners, loads), N/m: a power of two near the largest one.

    Tractions, gaps and motions without dimensions are exact multiples of those with another power of two.
    """
    beta = joint.problem(*joint.sections[0]).surfaces.beta_star
    clearances = [each.clearance for section in joint.sections for each in joint.problem(*section).interfaces]
    sizes = np.abs(values).max(axis=0) / load_units(joint)
    return 2.0 ** math.ceil(math.log2(float(sizes.max()) or float(np.abs(clearances).max()) / beta or 1.0))


def _given_loads(joint: Joint, plates: list[HolesCompliance]) -> JointLoads:
    """What the loads of a joint do."""
    names, thick, radius = joint.load_names, joint.plates[0].thickness, joint.radius
    places = {plate.name: k for k, plate in enumerate(joint.plates)}
    pins = {pin.name: k for k, pin in enumerate(joint.pins)}
    moving = [Motion(places[plate.name], way) for plate in joint.plates for way in MOVES[plate.moves]]
    on_pins, on_plates = np.zeros((len(pins), 2, len(names))), np.zeros((len(moving), len(names)))
    of_pins, of_plates = np.full((len(pins), 2), -1), np.full(len(moving), -1)
    columns = []
    for place, name in enumerate(names):
        (part, what), kind = name.rsplit(".", 1), joint.load_kind(name)
        axis = "xy".find(what[-1])
        if kind == "traction":
            columns.append((places[part], what, place))
            for row, motion in enumerate(moving):
                if motion.plate == places[part] and what in plates[motion.plate].resultants:
                    plate = joint.plates[motion.plate]
                    share, size = plate.thickness / thick, joint.radius_in(plate) / radius
                    resultants = plates[motion.plate].resultants[what] * [size, size, size * size]
                    on_plates[row, place] = share * (motion.at(0j) @ resultants)
        elif part in pins and kind == "displacement":
            of_pins[pins[part], axis] = place
        elif part in pins:
            on_pins[pins[part], axis, place] = name not in joint.reactions
        elif kind == "displacement":
            of_plates[moving.index(Motion(places[part], (1.0, 1j)[axis]))] = place
        else:
            on_plates[moving.index(Motion(places[part], (1.0, 1j)[axis])), place] = name not in joint.reactions
    return JointLoads(on_pins, moving, on_plates, columns, of_pins, of_plates)


def joint_system(joint: Joint, plates: list[HolesCompliance], force: float, nodes: int) -> PinsSystem:
    """The system of a joint with a reference force, N/m."""
    thick, beta = joint.plates[0].thickness, joint.problem(*joint.sections[0]).surfaces.beta_star
    sections, rings, grids = _interfaces(joint, nodes)
    clearances = np.array([each.problem.clearance for each in sections])
    faying, outer = [], {ring.inner: ring.outer for ring in rings}
    for pin_name, clamp, *pair in joint.faying:
        ends = [joint.place(pin_name, plate) for plate in pair]
        one, other = (outer.get(end, end) for end in ends)
        play = sum(max(clearances[end], 0.0) for end in {*ends, one, other}) / (force * beta)
        limit, soft = clamp.limit / (force * thick), clamp.flexibility * thick / beta
        faying.append(FayingSurface((one, other), limit, soft, float(play)))
    coherence = [joint.coherence(pin).scaled(thick / beta) for pin in joint.pins]
    return build(sections, plates, _given_loads(joint, plates), grids, force, coherence, faying, rings)
