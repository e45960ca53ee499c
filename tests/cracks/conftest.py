"""Load cycles of the tests of cracks. Their stress intensities were computed by another program first."""

import warnings
from collections.abc import Callable

import pytest

import fastpin
from fastpin.bodies import Ring
from fastpin.damage import cycle_states
from tests.support.cracks import LIKE, problem_of


@pytest.fixture(autouse=True)
def without_doubts():
    """Doubts are tested by name."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", fastpin.errors.InputWarning)
        yield


def _transverse(force: float) -> list[fastpin.State]:
    history = fastpin.LoadHistory([{"P": 6e6}]) + fastpin.LoadHistory([{"Q": force}, {"Q": -force}]).repeated(3)
    return _cycle(problem_of(fastpin.MATERIALS["Ti-6Al-4V"], 40e-6, 0.4), history)


def _cycle(problem: fastpin.Problem, history: fastpin.LoadHistory) -> list[fastpin.State]:
    result = fastpin.solve(problem, history, nodes=801, between=1)
    return cycle_states(result, result.cycles[-1])


def _bulk() -> list[fastpin.State]:
    history = fastpin.LoadHistory([{"P": 1e6}]) + fastpin.LoadHistory([{"sxx": 60e6}, {"sxx": -60e6}]).repeated(3)
    return _cycle(problem_of(LIKE, 50e-6, 0.5), history)


def _lug(**fields) -> list[fastpin.State]:
    history = fastpin.LoadHistory([{"P": 3e6}, {"P": 3e5}]).repeated(3)
    return _cycle(problem_of(fastpin.Material(210e9, 0.3), 20e-6, 0.3, **fields), history)


CASES: dict[str, Callable[[], list[fastpin.State]]] = {
    "bulk": _bulk,
    "lug": _lug,
    "Q": lambda: _transverse(1.5e6),
    "small": lambda: _transverse(0.25e6),
    "ring": lambda: _lug(plate_body=Ring(20e-3, "uniform")),
}


@pytest.fixture(scope="session")
def cycle() -> Callable[[str], list[fastpin.State]]:
    """The stops of the last cycle of a case, by its name. A case is solved once."""
    solved: dict[str, list[fastpin.State]] = {}

    def of(name: str) -> list[fastpin.State]:
        if name not in solved:
            solved[name] = CASES[name]()
        return solved[name]

    return of


@pytest.fixture(scope="session")
def small_states() -> list[fastpin.State]:
    """Two states on few nodes, for tests of input."""
    problem = problem_of(LIKE, 20e-6, 0.3)
    return list(fastpin.solve(problem, [{"P": 1e6}, {"P": 1e5}], nodes=61))
