"""Lives of wear whose numbers are known, and a run that wears step by step."""

from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

import fastpin
from fastpin import Grid, LoadHistory, Problem
from fastpin.model import InitialGap, Profile
from fastpin.model.profile import NO_GAP
from fastpin.model.profile_terms import Harmonic
from fastpin.verification.joint_rows import step, wearing
from fastpin.wear_lives import WearResult
from fastpin.wear_lives.wear_path import Removal, WearRun
from tests.support.slip_cases import LIKE, UNLIKE

Loads = dict[str, float]

LOBED = InitialGap(Profile((Harmonic(2, 0.02, 0.01), Harmonic(6, -0.02, 0.0))))

BUMPED = Problem.from_load_parameter(
    LIKE, 2.0, 0.05, "centre", "fixed", gap=InitialGap(Profile.crown(-1.05, -0.5 * np.pi + 1.3, 0.3))
)
"""A pin in a wide hole with a bump 74 degrees from the bottom. Wear lets the pin sink onto it."""

BUMPED_TURNS = LoadHistory([{"P": 1.0, "rotation": 1.0}]) + LoadHistory(
    [{"rotation": -1.0}, {"rotation": 1.0}]
).repeated(1)
"""The history of this pin: it turns to and fro."""


class WearCase(NamedTuple):
    """A life of 40 equal fat cycles of 121 nodes, after one cycle without wear, and its known numbers.

    Attributes
    ----------
    half_arc : float
        Half the width of the arc, rad; 0 for the whole circle.
    tau : float
        Wear coefficient times cycles.
    volume, depth, bottom, dissipation : float
        Worn volume; its largest depth by the parabola through three nodes; pressure at the bottom; energy dissipated
        in one more cycle without wear.
    limits : tuple of (float, float)
        Limits of these four for many nodes and fat cycles, each with its uncertainty.
    """

    problem: Problem
    half_arc: float
    first: list[Loads]
    cycle: list[Loads]
    tau: float
    volume: float
    depth: float
    bottom: float
    dissipation: float
    limits: tuple[tuple[float, float], ...]

    def grid(self, nodes: int) -> Grid:
        """The nodes."""
        if not self.half_arc:
            return Grid.circle(nodes)
        return Grid.arc(-0.5 * np.pi - self.half_arc, -0.5 * np.pi + self.half_arc, nodes)

    def history(self) -> LoadHistory:
        """What leads to the cycle, and the cycle."""
        return LoadHistory(self.first) + LoadHistory(self.cycle).repeated(1)


def _free(pair: object, load_parameter: float, friction: float, gap: InitialGap = NO_GAP) -> Problem:
    return Problem.from_load_parameter(pair, load_parameter, friction, "body", gap=gap)  # type: ignore[arg-type]


def _fixed(pair: object, load_parameter: float, friction: float) -> Problem:
    return Problem.from_load_parameter(pair, load_parameter, friction, "centre", "fixed")  # type: ignore[arg-type]


WEAR_CASES = {
    "partial slip": WearCase(
        _fixed(LIKE, 0.5, 0.5), 1.1, [{"P": 1.0}, {"Q": 0.275}], [{"Q": -0.275}, {"Q": 0.275}], 7.0,
        8.586109e-03, 0.023384, 0.953130, 3.56622e-04,
        ((8.38e-3, 6e-5), (0.0228, 3e-4), (0.9530, 4e-4), (3.8e-4, 5e-5)),
    ),
    "unlike": WearCase(
        _free(UNLIKE, 0.1, 0.4), 1.75, [{"P": 1.0}, {"Q": 0.2}], [{"P": 0.5, "Q": -0.2}, {"P": 1.0, "Q": 0.2}], 60.0,
        1.148111e-03, 0.007857, 0.544414, 2.89809e-06,
        ((1.2e-3, 2e-4), (0.0082, 6e-4), (0.5445, 2e-4), (3.4e-6, 4e-7)),
    ),
    "pulsating": WearCase(
        _free(LIKE, 0.05, 0.3), 1.75, [{"P": 1.0}], [{"P": 0.3}, {"P": 1.0}], 5.0,
        2.293537e-02, 0.023579, 0.533245, 1.11081e-03,
        ((0.0230, 2e-4), (0.02358, 7e-5), (0.5336, 4e-4), (1.15e-3, 4e-5)),
    ),
    "rotation": WearCase(
        _fixed(UNLIKE, 0.1, 0.2), 1.9, [{"P": 1.0}, {"rotation": 3.0}], [{"rotation": -3.0}, {"rotation": 3.0}], 0.02,
        2.722309e-01, 0.151559, 0.638072, 2.75867e00,
        ((0.27223, 2e-5), (0.15150, 3e-5), (0.6395, 4e-4), (2.7577, 5e-4)),
    ),
    "interference": WearCase(
        _free(LIKE, -0.05, 0.2), 0.0, [{"P": 1.0}, {"Q": 0.3}], [{"Q": -0.3}, {"Q": 0.3}], 30.0,
        2.723034e-02, 0.023323, 0.491839, 1.22247e-04,
        ((0.0263, 6e-4), (0.0229, 3e-4), (0.4916, 2e-4), (1.30e-4, 9e-6)),
    ),
    "lobed hole": WearCase(
        _free(LIKE, 0.1, 0.3, LOBED), 0.0, [{"P": 1.0}, {"Q": 0.1}], [{"P": 0.4, "Q": 0.0}, {"P": 1.0, "Q": 0.1}],
        30.0, 1.337739e-02, 0.027404, 0.397027, 8.19983e-05,
        ((0.0127, 6e-4), (0.0267, 6e-4), (0.393, 4e-3), (7.9e-5, 4e-6)),
    ),
}  # fmt: skip
"""Lives of wear: numbers and limits of two independent computations."""


def lived(case: WearCase, nodes: int, fat: int, tau: float | None = None) -> tuple[WearRun, np.ndarray, float]:
    """Live so many equal fat cycles. Returns the run, the worn depth (n,), and the dissipation of all pieces."""
    run = wearing(case.problem, case.grid(nodes))
    for loads in (*case.first, *case.cycle):
        step(run, loads)
    worn, dissipation, share = np.zeros(nodes), 0.0, (case.tau if tau is None else tau) / fat
    for _ in range(fat):
        for loads in case.cycle:
            rubbed, lost = step(run, loads)
            worn = worn + run.wear(share * rubbed).depth
            dissipation += lost
    return run, worn, dissipation


def numbers_of(case: WearCase, run: WearRun, worn: np.ndarray) -> tuple[float, float, float, float]:
    """Volume, depth, pressure at the bottom, and dissipation of one more cycle. The run goes on by that cycle."""
    top = int(np.argmax(worn))
    below, middle, above = worn[top - 1 : top + 2]
    depth = middle + (above - below) ** 2 / (8.0 * (2.0 * middle - below - above))
    bottom = np.interp(-0.5 * np.pi, run.system.grid.theta, run.now.pressure)
    volume = float(run.system.weights @ worn)
    return volume, float(depth), float(bottom), sum(step(run, loads)[1] for loads in case.cycle)


def ready_to_wear(nodes: int = 61) -> tuple[WearRun, np.ndarray]:
    """A run after the first cycle of partial slip, and a depth (n,) that changes its contact much."""
    case = WEAR_CASES["partial slip"]
    run = wearing(case.problem, case.grid(nodes))
    for loads in (*case.first, *case.cycle):
        rubbed, _ = step(run, loads)
    return run, 10.0 * rubbed


def parts_of(run: WearRun, depth: np.ndarray, count: int) -> list[Removal]:
    """Wear a depth in so many equal parts."""
    return [run.wear(depth / count) for _ in range(count)]


def life(path: Path | None = None, history: LoadHistory | None = None, **others: Any) -> WearResult:
    """Live 60 cycles of unlike bodies on 31 nodes, in memory or in a file."""
    case = WEAR_CASES["unlike"]
    given = {"cycles": 60, "coefficient": 1.0, "tolerance": 0.02, "grid": case.grid(31)}
    return fastpin.wear(case.problem, history or case.history(), output=path, **{**given, **others})
