"""The way of a joint from one load to the next: exact paths, and creep where the contact of a pin snaps.

Which pin touches first, and when, is an ordinary event of the path. A pin that is nearly unloaded may lose its last
nodes, or be pinched between two holes and slip out. No state is near then. Such a pin is released, and stays where it
is until it touches again. Others creep to the next state, as a pin that snaps does; see :mod:`fastpin.solver.snap`.
"""

from __future__ import annotations

from collections.abc import Callable, Set
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from fastpin.joints.conditions import CENTRING
from fastpin.joints.system import PinsSystem
from fastpin.kernels import exchange
from fastpin.kernels.arrays import ContactValues
from fastpin.kernels.status import OPEN, STICK
from fastpin.solver.configuration import (
    MAX_RESIDUAL,
    Configuration,
    accept_solution,
    resting_status,
    solve_statuses,
    worst_residual,
)
from fastpin.solver.errors import OPENED, ConvergenceError, NoEquilibriumError, SolveError
from fastpin.solver.increment import accepted, implicit_step
from fastpin.solver.path import PathStep, StepLostError
from fastpin.solver.slip_tally import SlipTally
from fastpin.solver.snap import creep, finite_step
from fastpin.solver.tableau import TableauMemory
from fastpin.solver.unknowns import DenseUnknowns

JUMPS = (1e-8, 1e-6, 1e-4, 1e-3, 1e-2)
"""Parts of a step at which a state beyond a snap is looked for; the first one only where pins let go one by one, or a
ring closes all round."""

NEGLIGIBLE, OF_SPRINGS = 1e-2, 10.0
"""Force of a contact that may be released, in parts of the largest one, and of that of the springs of loose pins."""

NOTHING = 1e-8
"""Force of a contact that may let go where all loads vanish, in parts of the largest load of the history.

Neat pins in double shear lost their path at 2e-9.
"""

BACK = (0.0, 1e-3, 1e-2, 1e-1, 1.0)
"""Parts of its way from the middle by which a released pin goes back: the edge that it touched may follow it."""

AJAR = 1e-5
"""Gap with which neat interfaces begin, in parts of the displacement by the loads, to find their first contact."""

MOST_SNAPS = 200
"""Snaps of one step, at most."""


def unloaded(system: PinsSystem) -> Configuration:
    """The joint before any load and fit: all pins concentric, open or without pressure."""
    n, zeros, load = system.grid.size, np.zeros(system.grid.size), np.zeros(system.loads.shape[1])
    load[-1] = 1.0
    gap, clamped = np.maximum(system.initial_gap, 0.0), np.arange(n) >= system.nodes.parts[-1].stop
    stuck = clamped | system.bonded
    return Configuration(
        pressure=1.0 * clamped, shear=zeros.copy(), gap=gap, slip=zeros.copy(),
        status=np.where(stuck, STICK, OPEN).astype(np.int8),
        motion=np.zeros(system.motions), load=load, origin=np.zeros(2), rest=np.zeros(system.motions),
        rest_gap=gap.copy(), rest_slip=zeros.copy(), slip_tally=SlipTally.empty(n),
    )  # fmt: skip


def follow(
    system: PinsSystem,
    start: Configuration,
    load: np.ndarray,
    memory: TableauMemory,
    report: Callable[[float], None],
) -> tuple[Configuration, int]:
    """Follow a straight step to `load` (loads,), dimensionless. Returns the configuration there, and the snaps.

    `report` is called now and then, with the fraction that was reached. The sums of the configuration count from the
    start of the step.

    Raises
    ------
    SolveError
        If the load can't be carried, or no state was found. ``fraction`` says where.
    """
    before, done, snaps = start.load, 0.0, 0
    now, pins = start, slice(system.nodes.parts[-1].stop)
    if not (now.closed & ~system.bonded)[pins].any() and np.any((now.gap[pins] == 0.0) & (system.friction[pins] > 0.0)):
        now, done = _first_of_neat(system, now, load)
    while done < 1.0:
        begin, step = done, None
        try:
            step = PathStep(system.resting(now.rest), now, load, memory)
            now = step.follow(1.0, lambda part, begin=begin: report(begin + part * (1.0 - begin)))  # type: ignore[misc]
            now.load = load.copy()
            return now, snaps
        except StepLostError as lost:
            now = now if step is None else step.now
            done = begin + lost.fraction * (1.0 - begin)
            snaps += 1
            is_lost = lost.code == exchange.UNBONDED or snaps > MOST_SNAPS
            beyond = None if is_lost else _beyond(system, now, before, load, done)
            if beyond is None:
                raise _error(system, lost, done) from None
            now, done = beyond
    return now, snaps


def refined(system: PinsSystem, now: Configuration) -> Configuration:
    """The configuration under the same statuses, with more digits of its tractions.

    Under loads far below earlier ones, the rounding of clearance and motion is large beside the tractions. The
    residuals of the conditions are known to all digits, and two corrections solve for them.
    """
    held, n = system.resting(now.rest), system.grid.size
    active = DenseUnknowns(held, now.status)
    tractions, motion = now.tractions, now.motion
    for _ in range(0 if active.singular else 2):
        left = held.displacement(tractions, motion, now.load, now.rest_gap)
        left[n:] -= now.slip
        balance = held.load_forces(now.load) - held.equilibrium @ tractions - held.motion_rows @ motion
        more = active.solve(np.r_[-left[active.rows], balance])
        tractions, motion = tractions + active.expand(more), motion + more[active.count :]
    gap, slip = np.split(held.displacement(tractions, motion, now.load, now.rest_gap), 2)
    found = ContactValues(tractions[:n], tractions[n:], gap, slip, now.status, motion)
    return accept_solution(now, found, now.load)


def _error(system: PinsSystem, lost: StepLostError, done: float) -> SolveError:
    if lost.code == exchange.NO_SUPPORT:
        bodies = "a pin, a bush or a plate" if system.rings else "a pin or a plate"
        error: SolveError = NoEquilibriumError(f"nothing holds {bodies}: the joint is a mechanism")
    elif lost.code == exchange.UNBONDED:
        error = NoEquilibriumError(OPENED)
    else:
        error = ConvergenceError("the stick and slip zones did not settle")
    error.fraction = done
    return error


def _first_of_neat(system: PinsSystem, start: Configuration, load: np.ndarray) -> tuple[Configuration, float]:
    """The first contact of neat pins. All grows in proportion, so that one implicit increment is exact.

    It begins with all nodes without a gap sticking, and then with the statuses to which they come if they begin a
    little ajar. Where other pins are loose, or plates are clamped, only a small part of the step is taken.
    """
    neat = start.gap == 0.0
    begun = replace(start, status=np.where(neat, resting_status(system), OPEN).astype(np.int8))
    parts = (1.0, 1e-1, 1e-2, 1e-3, 1e-4) if neat.all() and not system.faying else (1e-4, 1e-5, 1e-6)
    for part in parts:
        reached = start.load + part * (load - start.load)
        found = accepted(system, start, implicit_step(system, begun, reached, patient=False))
        if found is None and (status := _closed_from_ajar(system, start, reached)) is not None:
            guess = replace(start, status=status)
            found = accepted(system, start, implicit_step(system, guess, reached, patient=False))
        if found is not None:
            return found, part
    return start, 0.0


def _closed_from_ajar(system: PinsSystem, start: Configuration, load: np.ndarray) -> np.ndarray | None:
    """The statuses (n,) at `load` if the neat interfaces of the unloaded joint `start` begin ajar; None if lost."""
    gap = AJAR * float(np.abs(system.loads @ (load - start.load)).max())
    neat = (start.gap == 0.0) & ~start.closed
    ajar = replace(system, initial_gap=system.initial_gap + np.where(neat, gap, 0.0))
    try:
        return PathStep(ajar, unloaded(ajar), load, TableauMemory(ajar)).follow(1.0).status
    except StepLostError:
        return None


def _beyond(
    system: PinsSystem, now: Configuration, before: np.ndarray, after: np.ndarray, done: float
) -> tuple[Configuration, float] | None:
    """A state a little beyond a snap, and the fraction of the step at which it lies; None if none was found.

    Pins let go along a path, then by increments: all together, together with the loose ones, then one by one; first
    with few iterations, then with many. Lemke's method takes most of the time, so it comes last.
    """
    is_bare = float(np.abs(system.passed(now.tractions)).max()) <= NOTHING
    near, ways = (partial(finite_step, by_lemke=False), JUMPS[1:]), list[Any]([(_closing, JUMPS)])
    pins = range(len(system.pins))
    fewer = [set(pins), *({pin} for pin in pins)]
    paths = [(partial(_unloaded_along, pins=each), JUMPS[1:2]) for each in (None, *fewer)]
    ways += [] if is_bare else [near, *paths]
    for patient in (False, True):
        release = partial(_released, patient=patient)
        ways += [(partial(release, back=back), JUMPS[1:]) for back in BACK]
        ways += [(partial(release, back=0.0, pins=each), JUMPS) for each in fewer]
    ways += [near] if is_bare else []
    for way, jumps in (*ways, (partial(creep, on_springs=_on_springs), JUMPS[1:])):
        for jump in jumps:
            reached = min(done + jump, 1.0)
            found = way(system.resting(now.rest), now, before + reached * (after - before))
            if found is not None and (found.status[system.bonded] == STICK).all():
                return found, reached
            if reached == 1.0:
                break
    return None


def _closing(system: PinsSystem, start: Configuration, load: np.ndarray) -> Configuration | None:
    """A finite step to `load` if an interface may close all round, as a ring that grows into its hole; else None.

    It begins with all nodes of such interfaces closed: their gaps are less than the loads move anything.
    """
    near = start.gap <= float(np.abs(system.loads @ (load - start.load)).max())
    closing = [part for part in system.nodes.parts if near[part].all() and not start.closed[part].all()]
    begun = start.copy()
    for part in closing:
        begun.status[part] = np.where(start.closed[part], start.status[part], resting_status(system)[part])
    return accepted(system, start, implicit_step(system, begun, load, patient=False)) if closing else None


def _loosened(system: PinsSystem, start: Configuration, back: float, pins: Set[int] | None) -> Configuration | None:
    """The configuration `start` without the tractions of contacts that carry next to nothing; None if there are none.

    All let go, or those of some `pins`. Their pins rest where they are, or a part `back` of their way from the middle
    back.
    """
    forces = np.abs(system.passed(start.tractions)[:, :2]).max(axis=1)
    springs = CENTRING * float(np.abs((start.motion - start.rest)[: 3 * forces.size]).max())
    is_light = forces <= max(NEGLIGIBLE * forces.max(), OF_SPRINGS * springs, NOTHING)
    let_go: Set[int] = {system.sections[place].pin for place in np.flatnonzero(is_light & (forces > 0.0))}
    if not let_go:
        return None
    let_go = let_go if pins is None else pins
    loose, rest = start.copy(), start.rest.copy()
    for place in np.flatnonzero(is_light):
        if system.sections[place].pin not in let_go:  # it is loose, and stays so
            continue
        own, nodes = slice(3 * place, 3 * place + 3), system.nodes.parts[place]
        rest[own], loose.status[nodes] = (1.0 - back) * start.motion[own], OPEN
        loose.pressure[nodes] = loose.shear[nodes] = 0.0
    return replace(loose, rest=rest)


def _unloaded_along(
    system: PinsSystem, start: Configuration, load: np.ndarray, pins: Set[int] | None
) -> Configuration | None:
    """A state at `load` in which contacts that carried next to nothing have let go, along a path.

    Their tractions become a load, which vanishes along the path. No status chatters as in an implicit increment.
    """
    loose = _loosened(system, start, 0.0, pins)
    if loose is None:
        return None
    held = system.resting(loose.rest)
    column = held.operator @ (start.tractions - loose.tractions)
    balance = held.equilibrium @ loose.tractions + held.motion_rows @ loose.motion - held.load_forces(loose.load)
    vanishing = _with_load(held, column, balance)
    try:
        found = PathStep(vanishing, replace(loose, load=np.r_[loose.load, 1.0]), np.r_[load, 0.0]).follow(1.0)
    except StepLostError:
        return None
    found.load = load.copy()
    return found if worst_residual(held, found) <= MAX_RESIDUAL else None


def _released(
    system: PinsSystem, start: Configuration, load: np.ndarray, back: float, patient: bool, pins: Set[int] | None = None
) -> Configuration | None:
    """A state at `load` in which contacts that carried next to nothing have let go, by one increment.

    See :func:`_loosened`.
    """
    loose = _loosened(system, start, back, pins)
    if loose is None:
        return None
    held = system.resting(loose.rest)
    if loose.closed.any():
        return accepted(held, loose, implicit_step(held, loose, load, patient))
    apart = solve_statuses(held, loose.status, loose.slip, load, loose.rest_gap)
    return None if apart is None else accepted(held, loose, accept_solution(loose, apart, load))


def _with_load(system: PinsSystem, column: np.ndarray, force: np.ndarray) -> PinsSystem:
    """The system with one more load: its gap and slip (2n,), and its part of the conditions (m,)."""
    columns, forces = np.column_stack([system.loads, column]), np.column_stack([system.forces, force])
    drive = replace(system.drive, columns=columns)
    return replace(system, forces=forces, loads=columns, drive=drive, held_as=None)


def _on_springs(system: PinsSystem, start: Configuration, load: np.ndarray, stiffness: float) -> Configuration | None:
    """A finite step of the pins on springs that are slack at `start`: a load of their own that acts with the size 1."""
    springs = np.where(system.of_pins, stiffness, 0.0)
    held = _with_load(system, np.zeros(len(system.loads)), springs * start.motion)
    held = replace(held, motion_rows=system.motion_rows + np.diag(springs))
    after = finite_step(held, replace(start, load=np.r_[start.load, 0.0]), np.r_[load, 1.0])
    return None if after is None else replace(after, load=load.copy())
