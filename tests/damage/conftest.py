"""One fretting history for the tests of this folder."""

import pytest

import fastpin
from fastpin import damage
from tests.support.fatigue import PAIR


@pytest.fixture(scope="session")
def fretting():
    """A titanium pin in an aluminium plate: P, then three cycles of Q with ten stops a step."""
    problem = fastpin.Problem(PAIR, 10e-3, 40e-6, 0.4, pin_load="body")
    history = fastpin.LoadHistory([{"P": 2.4e6}]) + fastpin.LoadHistory([{"Q": 6e5}, {"Q": -6e5}]).repeated(3)
    return fastpin.solve(problem, history, nodes=201, between=9)


@pytest.fixture(scope="session")
def cycle(fretting):
    """The states of its last cycle."""
    return damage.cycle_states(fretting, fretting.cycles[-1])
