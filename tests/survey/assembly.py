"""The stress of the assembly and the stress of the loads in random pressed joints."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from fastpin.errors import FastpinError
from fastpin.kernels.status import OPEN
from fastpin.model.loads import LOADS
from fastpin.model.points import Points, elastic_bodies
from fastpin.model.problem import Problem
from fastpin.solver.solving import solve
from fastpin.states.state import State
from tests.survey.histories import generate

AROUND = np.linspace(-math.pi, math.pi, 25)[1:]

NODES = 61


@dataclass
class Examined:
    """A pressed joint. Differences of stresses count in parts of the largest stress of their body.

    Attributes
    ----------
    before : float
        Largest difference of the stress of the assembly and that of the joint that is solved without loads.
    sums : float
        Largest difference of a peak and the sum of the stress without loads and the peak's part of the loads.
    halved : float
        Largest difference of twice the stresses under halved loads and those under the loads, in parts of the largest
        pressure where it is larger than the stress; NaN where the contact does not stay closed and stuck.
    """

    before: float = 0.0
    sums: float = 0.0
    halved: float = math.nan


def pressed_joint(kind: str, seed: int) -> tuple[Problem, dict[str, float]] | None:
    """The joint of a class of :mod:`tests.survey.histories`, and its first load; None if nothing is pressed."""
    case = generate(kind, seed)
    if not case.problem.is_pressed or case.problem.drive != "force":
        return None
    first = case.history.distinct()[0]
    return case.problem, {name: value for name, value in zip(LOADS, first.tolist(), strict=True) if value}


def examine(problem: Problem, load: dict[str, float]) -> Examined | None:
    """Compare the parts of the stresses of a joint; None if the load is refused."""
    found = Examined()
    try:
        loaded = solve(problem, [load], nodes=NODES)[-1]
        unloaded = solve(problem, [{}], grid=loaded.grid)[-1]
        for body in elastic_bodies(problem):
            before, peak = unloaded.hoop_stress(body, AROUND), loaded.peak_hoop_stress(body)
            size = max(float(np.abs(before).max()), abs(peak.value))
            told = loaded.assembly_stress(Points.at_depth(0.0, AROUND), body).hoop
            here = float(unloaded.hoop_stress(body, [peak.angle])[0])
            found.before = max(found.before, float(np.abs(told - before).max()) / size)
            found.sums = max(found.sums, abs(here + peak.loads - peak.value) / size)
        found.halved = _halved(problem, load)
    except FastpinError:
        return None
    return found


def _halved(problem: Problem, load: dict[str, float]) -> float:
    """See :class:`Examined`. The load is made smaller until nothing slips."""
    for size in (1.0, 0.1, 0.01, 0.001):
        whole, half = (
            solve(problem, [{name: part * size * value for name, value in load.items()}], nodes=NODES)[-1]
            for part in (1.0, 0.5)
        )
        if _is_closed(whole) and _is_closed(half):
            pairs = [[each.peak_hoop_stress(body) for each in (whole, half)] for body in elastic_bodies(problem)]
            # A state is solved to a part of its largest traction. The stress of a thin bush may be far smaller: the
            # pressures inside and outside nearly cancel there.
            pressure = max(float(each.pressure.max()) for each in _contacts(whole))
            return max(
                abs(one.most_of_loads - 2.0 * other.most_of_loads) / max(abs(one.value), abs(one.assembly), pressure)
                for one, other in pairs
            )
    return math.nan


def _contacts(state: State) -> tuple[State, ...]:
    """The interfaces of a joint."""
    return (state,) if state.seat is None else (state, state.seat)


def _is_closed(state: State) -> bool:
    """Whether all interfaces are closed all round, and nothing slips where there is friction."""
    return all(
        bool(np.all(each.status != OPEN)) and (each.problem.frictionless or not each.slipping.any())
        for each in _contacts(state)
    )
