"""A small result made by hand, for tests of what comes after the solver."""

from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from fastpin import MATERIALS, Grid, LoadHistory, MaterialPair, Problem, Result, State
from fastpin.kernels.status import OPEN, SLIP_NEGATIVE, SLIP_POSITIVE, STICK
from fastpin.model import LOADS
from fastpin.model.loads import named_load
from fastpin.reading.marks import Marks

PAIR = MaterialPair(MATERIALS["Ti-6Al-4V"], MATERIALS["aluminium"])

JOINT = """
pin.material = "Ti-6Al-4V"
plate.material = "aluminium"
[contact]
hole_radius = 10e-3
clearance = 20e-6
friction = 0.4"""
"""The first sections of a case file. More keys of [contact] may follow."""


def sample_result(
    corners: list[dict[str, float]] | None = None,
    nodes: int = 81,
    closed: bool = False,
    centre: float = -0.5 * np.pi,
    friction: float = 0.4,
    problem: Problem | None = None,
    complete: bool = True,
) -> Result:
    """Half-ellipses of pressure, sticking in the middle, one state for each corner."""
    problem = problem or Problem(PAIR, 0.01, 2e-5, friction, "body")
    history = LoadHistory(corners or [{"P": 2.42e6}, {"Q": 4.84e5}, {"Q": -4.84e5}])
    grid = Grid.circle(nodes) if closed else Grid.arc(-0.5 * np.pi - 1.5, -0.5 * np.pi + 1.5, nodes)
    states = []
    for step, row in enumerate(history.values()):
        load = named_load(row)
        half = 1.0 + 0.05 * step
        # Signed distance from the middle of the contact, the short way round.
        away = (grid.theta - centre + np.pi) % (2.0 * np.pi) - np.pi
        pressure = 1e8 * np.sqrt(np.maximum(1.0 - (away / half) ** 2, 0.0))
        slips = (np.abs(away) > 0.4) & (pressure > 0.0)
        shear = problem.friction * pressure * np.clip(away / 0.4, -1.0, 1.0)
        status = np.where(slips, np.where(away > 0.0, SLIP_NEGATIVE, SLIP_POSITIVE), STICK)
        status = np.where(pressure > 0.0, status, OPEN).astype(np.int8)
        states.append(
            State(
                step=step,
                fraction=1.0,
                load=load,
                theta=grid.theta,
                pressure=pressure,
                shear=shear,
                gap=1e-5 * np.maximum(np.abs(away) - half, 0.0),
                slip=-1e-6 * np.where(slips, away, 0.0),
                status=status,
                dx=1e-6 * step,
                dy=-2e-6,
                rotation=1e-4 * step,
                dissipation=0.5 * step,
                work=3.0,
                energy=2.0,
                residuals={"gap": 1e-12, "slip": 2e-13, "cone": 0.0, "equilibrium": 1e-14},
                problem=problem,
                grid=grid,
                marks=Marks(),
            )
        )
    assert set(states[0].load) == set(LOADS)
    statistics = {"events": 12, "exchanges": 20, "rebuilds": 1, "seconds": 0.25}
    return Result(states, problem, history, grid, "path", statistics, complete, None)


def with_values(state: State, **values: ArrayLike) -> State:
    """A state with other nodal values. A number stands for all nodes."""
    arrays = {name: np.full_like(getattr(state, name), value) for name, value in values.items()}
    return replace(state, **arrays)
