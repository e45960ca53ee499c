"""Regimes of slip of states and of load cycles."""

from dataclasses import replace

import numpy as np
import pytest

from fastpin import LoadHistory, Problem, solve
from fastpin.kernels.status import OPEN, SLIP_NEGATIVE, SLIP_POSITIVE, STICK
from fastpin.report.states import state_columns
from fastpin.report.summary import STATE, ReadState
from fastpin.states import QUANTITIES, LoadCycle, Regime
from fastpin.states.quantities import values
from fastpin.states.regimes import REGIMES, regime_of
from tests.support.samples import PAIR, sample_result, with_values


@pytest.mark.parametrize(
    ("closed", "slips", "regime"),
    [
        ([0, 0, 0], [1, 1, 1], Regime.SEPARATION),
        ([1, 1, 0], [0, 0, 1], Regime.FULL_STICK),
        ([1, 1, 0], [1, 0, 0], Regime.PARTIAL_SLIP),
        ([1, 1, 0], [1, 1, 0], Regime.GROSS_SLIDING),
    ],
)
def test_regimes_of_nodes(closed, slips, regime):
    assert regime_of(np.array(closed, bool), np.array(slips, bool)) is regime
    assert REGIMES[regime] == regime.words == regime.name.lower().replace("_", " ")


def states_of_each_regime():
    """One state of each regime, by hand."""
    state = sample_result()[1]
    closed = state.status != OPEN
    no_shear = with_values(state, shear=0.0)
    full = 0.4 * state.pressure
    return {
        Regime.SEPARATION: with_values(state, pressure=0.0, shear=0.0, status=OPEN),
        Regime.FULL_STICK: replace(no_shear, status=np.where(closed, STICK, OPEN).astype(np.int8)),
        Regime.PARTIAL_SLIP: state,
        Regime.GROSS_SLIDING: replace(state, shear=-full, status=np.where(closed, SLIP_POSITIVE, OPEN).astype(np.int8)),
    }


def test_the_regime_of_a_state_is_a_quantity_in_words():
    for regime, state in states_of_each_regime().items():
        assert state.regime is regime
        assert QUANTITIES["regime"].of(state) == float(regime)
        (output,) = (each for each in STATE if each.name == "regime")
        assert output.shown(ReadState(state, {}), {}) == regime.words
        assert "regime" not in values(state)  # a class has no error bar and no order


def test_the_table_tells_gross_sliding_from_no_contact():
    found = states_of_each_regime()
    chosen = [found[Regime.SEPARATION], found[Regime.GROSS_SLIDING]]
    cells = {name: cells for name, _, cells in state_columns(chosen[0].problem, chosen)}
    assert cells["stick"] == ["none", "gross sliding"]
    assert cells["contact"][0] == "none"


@pytest.mark.parametrize("slip_sums", [False, True])
@pytest.mark.parametrize(
    ("friction", "force", "regime"),
    [(0.4, 5e4, Regime.PARTIAL_SLIP), (1.0, 1e3, Regime.FULL_STICK), (0.1, 3e5, Regime.GROSS_SLIDING)],
)
def test_the_regime_of_a_cycle(slip_sums, friction, force, regime):
    problem = Problem(PAIR, 10e-3, 20e-6, friction, pin_load="centre", rotation="fixed")
    history = LoadHistory([{"P": 1e6}]) + LoadHistory([{"Q": force}, {"Q": -force}]).repeated(3)
    cycle = solve(problem, history, nodes=41, between=3, slip_sums=slip_sums).cycle()
    assert cycle.regime is regime


def test_the_recorded_path_shows_slip_that_the_kept_states_do_not():
    problem = Problem(PAIR, 10e-3, 20e-6, 0.1, pin_load="centre", rotation="fixed")
    history = LoadHistory([{"P": 1e6}]) + LoadHistory([{"Q": 3e5}, {"Q": -3e5}]).repeated(4)
    ends = solve(problem, history, nodes=41, keep="cycles", slip_sums=True).cycle()
    assert len(ends.states) == 2
    assert ends.regime is Regime.GROSS_SLIDING
    unknown = [replace(state, slip_distance=None, slip_lowest=None, slip_highest=None) for state in ends.states]
    assert LoadCycle(tuple(unknown)).regime is Regime.FULL_STICK


def test_a_node_at_the_limit_that_rests_does_not_slip():
    state = states_of_each_regime()[Regime.GROSS_SLIDING]
    still = replace(state, status=np.where(state.status == OPEN, OPEN, SLIP_NEGATIVE).astype(np.int8))
    assert LoadCycle((state, still)).regime is Regime.FULL_STICK
    moved = replace(still, slip=still.slip + 1e-6)
    assert LoadCycle((state, moved)).regime is Regime.GROSS_SLIDING


def test_without_friction_all_closed_nodes_slip():
    state = sample_result(friction=0.0)[0]
    assert state.regime is Regime.GROSS_SLIDING
    assert LoadCycle((state, state)).regime is Regime.GROSS_SLIDING
