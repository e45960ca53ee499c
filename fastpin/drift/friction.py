"""A change of the friction that a contact follows at a constant load."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, TypeVar

import numpy as np

from fastpin.drift.path import DriftingSystem
from fastpin.elasticity.system import System
from fastpin.errors import InputError
from fastpin.model.loads import named_load
from fastpin.model.problem import Problem
from fastpin.solver.errors import SolveError
from fastpin.solver.path_stepper import PathStepper
from fastpin.solver.repeats import Repeats
from fastpin.solver.run import Run
from fastpin.solver.step import Piece, Position

AnyRun = TypeVar("AnyRun", bound=Run)


def followed_problem(problem: Problem, friction: Any) -> Problem:
    """The problem with a friction to which a contact can be followed.

    Raises
    ------
    InputError
        If the friction can't be used, it is 0 all round before or after, or a bush slips.
    """
    changed = replace(problem, friction=friction)
    if problem.seat is not None:
        raise InputError("replay", '"follow" needs a bush that is bonded: in one that slips, no friction is followed')
    if problem.frictionless or changed.frictionless:
        raise InputError("friction", "can't be followed to or from 0: friction must stay on both sides")
    return changed


def system_with_friction(system: System, problem: Problem) -> System:
    """The system of another problem that differs in its friction."""
    return replace(system, problem=problem, friction=problem.friction_at(system.grid.theta))


def follow_friction(run: AnyRun, problem: Problem) -> AnyRun:
    """Follow the change to the friction of `problem` at the last corner of a run. Return the run that goes on there.

    `run` itself stays at its corner.

    Raises
    ------
    InputError
        If the system of the run needs windows.
    SolveError
        See :meth:`Run.follow`. The fraction is that of the change.
    """
    if run.system.needs_windows:
        raise InputError("friction", "a change can't be followed on a circle of so many unequal node distances")
    before, load = run.last_corner, run.last_corner.load
    system = system_with_friction(run.system, problem)
    begin, end = np.r_[load, 0.0], np.r_[load, 1.0]
    drifting = DriftingSystem.between(run.system.under(load), system.under(load).friction)
    stepper = PathStepper(drifting, run.statistics, run.strict)
    position, piece = Position(replace(before, load=begin), before.closed.copy()), Piece(0.0, 1.0, begin, end)
    try:
        while position.now.closed.any() and not np.array_equal(position.now.load, end):
            stepper.advance(position, piece, 1.0, run.report)
    except SolveError as error:
        error.step, error.fraction, error.load = run.corner, position.reached, named_load(run.load)
        error.args = (f"at {100.0 * error.fraction:.4g} % of the change of the friction: {error}",)
        raise
    stepper.leave(position)
    now = replace(position.now, load=load)
    start = replace(
        run.restart(shared=True), configuration=now, dissipation=run.dissipation + now.dissipation,
        work=run.work + now.work, repeats=Repeats(), slip_tally=run.slip_tally.to_corner.joined(now.slip_tally),
    )  # fmt: skip
    return type(run)(run.history, system, run.options, run.recorder, run.progress, start, run.save_after, run.strict)
