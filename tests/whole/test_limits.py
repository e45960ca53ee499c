"""The limits: contacts of any size, lost and found again, interference, remote stress, no equilibrium."""

import math

import numpy as np
import pytest

from fastpin import ConvergenceError, Grid, InputError, NoEquilibriumError, Problem, solve
from fastpin.kernels.status import OPEN
from fastpin.solver import ArcError
from fastpin.verification import closed_forms
from tests.support.tiers import some_gate

BOTTOM = -0.5 * math.pi


# --- any size -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("half", [0.01, 0.05, 0.3])
def test_small_contacts_are_found_and_resolved(similar, half):
    """Hertz: the half-angle tends to 1/sqrt(pi L_p)."""
    load_parameter = 1.0 / (math.pi * half**2)
    problem = Problem.from_load_parameter(similar, load_parameter, 0.4, "centre", "fixed")
    result = solve(problem, [{"P": 1.0}, {"Q": 0.2}, {"Q": -0.2}], nodes=201)
    assert 0.5 * np.ptp(result[0].contact[0]) == pytest.approx(half, rel=0.2 * half + 2e-3)
    assert result[0].peak_pressure == pytest.approx(
        closed_forms.hertz_peak_pressure(load_parameter), rel=half**2 + 1e-4
    )
    for state in result:
        assert np.count_nonzero(state.status != OPEN) > 80


def test_neat_fit_is_reached_smoothly(similar, titanium_in_aluminium):
    for pair in (similar, titanium_in_aluminium):
        tight, neat = (
            solve(Problem.from_load_parameter(pair, value, 0.4, "body"), [{"P": 1.0}, {"Q": 0.2}], nodes=121)
            for value in (1e-7, 0.0)
        )
        for one, two in zip(tight, neat, strict=True):
            assert one.peak_pressure == pytest.approx(two.peak_pressure, rel=1e-4)
            assert one.dissipation == pytest.approx(two.dissipation, rel=1e-3)
            assert one.work == pytest.approx(two.work, rel=1e-3)
    frictionless = solve(Problem.from_load_parameter(similar, 0.0, 0.0), [{"P": 1.0}], nodes=401)[-1]
    assert 0.5 * np.ptp(frictionless.contact[0]) == pytest.approx(math.radians(84.8279456), abs=1e-3)


def test_contact_all_round_under_compression(similar):
    """A plate squeezed on a pin: uniform pressure on the whole circle, whatever the clearance was."""
    problem = Problem.from_load_parameter(similar, 0.1, 0.3, "centre")
    state = solve(problem, [{"sxx": -1.0, "syy": -1.0}], nodes=101)[-1]
    assert len(state.contact) == 1
    assert state.contact[0][1] - state.contact[0][0] == pytest.approx(2.0 * math.pi)
    assert np.ptp(state.pressure) < 1e-9
    assert np.abs(state.shear).max() < 1e-9
    # hole: v_r = (1 - k) / 2 * A / 2 and the pair's compliance under uniform pressure, from (9)-(12)
    share = 0.5  # (kappa_I + 1)/(2 G_I beta*) of like bodies
    remote = 0.5 * (1.0 - share) * 0.5 * -2.0
    # int K_rN = [alpha* int S A - beta* int C L - 2 pi k] / 4 pi with int C L = -2 pi, int S A = -pi (alpha* = 0 here)
    compliance = (2.0 * math.pi - 2.0 * math.pi * share) / (4.0 * math.pi)
    assert state.pressure.mean() == pytest.approx(-(0.1 + remote) / compliance, rel=1e-3)


def test_oval_hole_pinches_the_pin_at_two_places(similar):
    problem = Problem.from_load_parameter(similar, 0.1, 0.4, "centre")
    result = solve(problem, [{"sxx": -0.5, "syy": 0.5}, {"P": 0.3}, {"P": 0.0}, {"sxx": 0.0, "syy": 0.0}], nodes=201)
    assert [len(state.contact) for state in result] == [2, 2, 2, 0]
    assert result[1].resultants["P"] == pytest.approx(0.3, abs=1e-10)
    assert np.all(result[-1].pressure == 0.0)


# --- lost and found -----------------------------------------------------------------------------------------


def test_load_ratio_zero(titanium_in_aluminium):
    """Unloaded completely the contact is gone and its memory too: the next load is a first load again."""
    problem = Problem.from_load_parameter(titanium_in_aluminium, 0.1, 0.4, "body")
    result = solve(problem, [{"P": 1.0}, {"P": 0.0}, {"P": 1.0}, {"P": 0.0}, {"P": 1.0}], nodes=151)
    assert [state.in_contact for state in result] == [True, False, True, False, True]
    lost = result[1]
    assert np.all(lost.shear == 0.0)
    assert lost.gap.min() >= 0.0
    assert (lost.peak_pressure, lost.peak_shear) == (0.0, 0.0)
    assert np.isnan([lost.peak_pressure_angle, lost.peak_shear_angle]).all()
    assert lost.contact == lost.stick == lost.slip_zones == []
    for state in result[2::2]:
        assert np.abs(state.shear - result[0].shear).max() < 1e-10
    assert result[4].dissipation > result[2].dissipation > result[0].dissipation


def test_almost_complete_unloading_keeps_the_memory(titanium_in_aluminium):
    problem = Problem.from_load_parameter(titanium_in_aluminium, 0.1, 0.4, "body")
    result = solve(problem, [{"P": 1.0}, {"P": 1e-4}, {"P": 1.0}], nodes=401)
    assert result[1].in_contact
    assert result[1].resultants["P"] == pytest.approx(1e-4, rel=1e-9)
    assert result[2].peak_pressure == pytest.approx(result[0].peak_pressure, rel=1e-3)


def test_reversed_load_crosses_the_clearance(similar):
    problem = Problem.from_load_parameter(similar, 0.1, 0.4, "body")
    down, up = solve(problem, [{"P": 1.0}, {"P": -1.0}], nodes=161)
    assert up.dy == pytest.approx(0.2 - down.dy, abs=1e-3)
    assert np.mean(up.contact[0]) % (2.0 * math.pi) == pytest.approx(0.5 * math.pi, abs=1e-3)
    assert up.peak_pressure == pytest.approx(down.peak_pressure, rel=1e-4)


def test_force_that_turns_round_takes_the_contact_along(similar):
    problem = Problem.from_load_parameter(similar, 0.2, 0.4, "body")
    result = solve(problem, [{"P": 1.0}, {"P": 0.0, "Q": 1.0}, {"P": -1.0, "Q": 0.0}, {"P": 0.0, "Q": -1.0}], nodes=241)
    middles = [float(np.mean(state.contact[0])) for state in result]
    turned = np.unwrap([m - middles[0] for m in middles])
    assert turned == pytest.approx([0.0, 0.5 * math.pi, math.pi, 1.5 * math.pi], abs=0.25)
    for state in result:
        assert state.resultants["P"] == pytest.approx(state.load["P"], abs=1e-9)
        assert state.resultants["Q"] == pytest.approx(state.load["Q"], abs=1e-9)


def test_interference_fit(similar):
    problem = Problem.from_load_parameter(similar, -0.1, 0.4, "centre")
    result = solve(problem, [{"P": 0.05}, {"Q": 0.02}, {"P": 2.0}, {"P": 0.0, "Q": 0.0}], nodes=121)
    assert all(state.contact[0][1] - state.contact[0][0] == pytest.approx(2.0 * math.pi) for state in result[:2])
    assert len(result[2].contact) == 1
    assert result[2].contact[0][1] - result[2].contact[0][0] < 2.0 * math.pi
    # 4 pi / (2 pi) * 0.1 / (1 - k): the press-fit pressure, and round again when the load is gone
    assert result[-1].pressure.mean() == pytest.approx(0.4, rel=2e-2)


# --- no equilibrium -----------------------------------------------------------------------------------------


def test_a_moment_beyond_friction_is_lost_where_statics_says(similar):
    """A small contact carries |M| = P R mu / sqrt(1 + mu^2): the pin climbs the hole and then spins."""
    problem = Problem.from_load_parameter(similar, 200.0, 0.3, "centre", "free")
    with pytest.raises(NoEquilibriumError) as caught:
        solve(problem, [{"P": 1.0}, {"M": 0.1}, {"M": 0.6}], nodes=301)
    error = caught.value
    assert error.step == 2
    assert error.load["M"] == pytest.approx(0.3 / math.hypot(1.0, 0.3), rel=2e-3)
    assert error.load["M"] == pytest.approx(0.1 + error.fraction * 0.5)
    assert len(error.result) == 2
    assert not error.result.complete
    assert error.result[-1].resultants["M"] == pytest.approx(0.1)
    assert "M = " in str(error)


@pytest.mark.gate
def test_increments_lose_the_same_load(similar):
    problem = Problem.from_load_parameter(similar, 2.0, 0.3, "centre", "free")
    lost = []
    for solver in ({"method": "path"}, {"method": "increment", "increments": 60}):
        with pytest.raises((NoEquilibriumError, ConvergenceError)) as caught:
            solve(problem, [{"P": 1.0}, {"M": 0.6}], nodes=81, **solver)
        lost.append(caught.value.load["M"])
        assert len(caught.value.result) == 1
    assert lost[1] == pytest.approx(lost[0], rel=0.02)


@pytest.mark.parametrize(
    ("friction", "history", "step"),
    [
        (0.3, [{"M": 0.1}], 0),
        (0.3, [{"P": 1.0}, {"P": 0.0}, {"M": 0.1}], 2),
        (0.3, [{"P": 1.0, "M": 0.5}], 0),
        (0.0, [{"P": 1.0}, {"M": 0.1}], 1),
    ],
)
def test_a_moment_that_nothing_holds(similar, friction, history, step):
    problem = Problem.from_load_parameter(similar, 0.5, friction, "centre", "free")
    with pytest.raises(NoEquilibriumError) as caught:
        solve(problem, history, nodes=61)
    assert caught.value.step == step
    assert len(caught.value.result) == step


def test_loads_that_do_nothing(similar):
    problem = Problem.from_load_parameter(similar, 0.1, 0.4, "body")
    result = solve(problem, [{}, {"P": 1.0}, {"P": 1.0}, {"Q": 0.0}], nodes=61)
    assert [state.in_contact for state in result] == [False, True, True, True]
    assert np.array_equal(result[1].shear, result[3].shear)


def test_prescribed_rotation_slides_the_pin(similar):
    """Enough rotation brings full slip: |T| = mu N everywhere, against the rotation."""
    problem = Problem.from_load_parameter(similar, 0.5, 0.2, "centre", "fixed")
    state = solve(problem, [{"P": 1.0}, {"rotation": 2.0}], nodes=121)[-1]
    assert state.rotation == pytest.approx(2.0)
    assert state.stick == []
    assert np.allclose(state.shear, -0.2 * state.pressure, atol=1e-12)
    assert state.resultants["M"] > 0.0


def test_grids_can_be_given(similar):
    problem = Problem.from_load_parameter(similar, 0.5, 0.3, "body")
    grid = Grid.arc(BOTTOM - 1.0, BOTTOM + 1.0, 77)
    assert solve(problem, [{"P": 1.0}], grid=grid).grid is grid
    assert solve(problem, [{"P": 1.0}], nodes=77, arc=(-3.0, 2.0 * math.pi - 3.0)).grid.closed
    for arc in ((-3.0, 4.0), (-100.0, -80.0)):
        with pytest.raises(InputError, match="arc: must run from a smaller to a larger angle, at most a full turn"):
            solve(problem, [{"P": 1.0}], nodes=77, arc=arc)
    with pytest.raises(InputError, match="arc: has no effect where a grid is given"):
        solve(problem, [{"P": 1.0}], grid=grid, arc=(-3.0, 0.0))


# --- what is easily lost ------------------------------------------------------------------------------------


@pytest.mark.parametrize("method", some_gate(["path", "increment"], "increment", "path"))
@pytest.mark.parametrize("load_parameter", [0.1, 0.0])
def test_energy_balance_through_unloading_and_reloading(titanium_in_aluminium, method, load_parameter):
    problem = Problem.from_load_parameter(titanium_in_aluminium, load_parameter, 0.4, "body")
    history = [{"P": 1.0}, {"P": 0.0}, {"P": 1.0}, {"P": 0.0}]
    result = solve(problem, history, nodes=121, method=method)
    dissipated = np.diff([0.0, *[state.dissipation for state in result]])
    assert np.all(dissipated > 0.0)
    assert dissipated[2] == pytest.approx(dissipated[0], rel=0.02)
    for state in result:
        balance = state.work - state.energy - state.dissipation
        assert balance == pytest.approx(0.0, abs=(5e-4 if method == "path" else 1.5e-3) * result[0].energy)


def test_dissipation_of_unloading_does_not_depend_on_the_states_between(titanium_in_aluminium):
    problem = Problem.from_load_parameter(titanium_in_aluminium, 0.1, 0.4, "body")
    plain = solve(problem, [{"P": 1.0}, {"P": 0.0}], nodes=101)
    dense = solve(problem, [{"P": 1.0}, {"P": 0.0}], nodes=101, between=20)
    assert len(dense) == 42
    assert plain[-1].dissipation == pytest.approx(dense[-1].dissipation, rel=1e-6)
    assert plain[-1].work == pytest.approx(dense[-1].work, rel=1e-4)


def test_states_between_corners_survive_a_loss_of_contact(titanium_in_aluminium):
    problem = Problem.from_load_parameter(titanium_in_aluminium, 0.1, 0.4)
    result = solve(problem, [{"P": 1.0}, {"sxx": 1.0}, {"P": 0.0}, {"sxx": 0.0}], nodes=100, between=20)
    assert len(result) == 84
    assert not result[-1].in_contact


@pytest.mark.parametrize(("load_parameter", "arc"), [(0.1, (-2.5, -1.55)), (0.0, (-1.6, -1.5)), (0.1, (0.0, 1.0))])
def test_arcs_that_cut_the_contact_are_refused(titanium_in_aluminium, load_parameter, arc):
    problem = Problem.from_load_parameter(titanium_in_aluminium, load_parameter, 0.4)
    with pytest.raises(ArcError):
        solve(problem, [{"P": 1.0}], nodes=101, arc=arc)


def test_the_arc_follows_a_pin_that_climbs_under_a_moment(titanium_in_aluminium):
    problem = Problem.from_load_parameter(titanium_in_aluminium, 50.0, 0.5)
    state = solve(problem, [{"P": 1.0, "M": 0.3}], nodes=121)[-1]
    assert np.mean(state.contact[0]) - BOTTOM == pytest.approx(-math.asin(0.3), abs=0.01)
    assert state.resultants["M"] == pytest.approx(0.3, abs=1e-10)


@pytest.mark.parametrize("nodes", [100, 101, 201])
@pytest.mark.parametrize("load_parameter", [0.1, 0.0])
def test_pinching_begins_on_any_grid(titanium_in_aluminium, nodes, load_parameter):
    problem = Problem.from_load_parameter(titanium_in_aluminium, load_parameter, 0.4)
    state = solve(problem, [{"sxx": 1.0}], nodes=nodes)[-1]
    assert len(state.contact) == 2
    top, bottom = (state.pressure[np.sin(state.theta) * side > 0.0].max() for side in (1.0, -1.0))
    assert top == pytest.approx(bottom, rel=2e-2)


def test_rotation_may_change_without_contact(titanium_in_aluminium):
    problem = Problem.from_load_parameter(titanium_in_aluminium, 0.1, 0.4, "centre", "fixed")
    plain = solve(problem, [{"P": 1.0}], nodes=81)[-1]
    turned = solve(problem, [{"rotation": 0.01}, {"P": 1.0}], nodes=81)
    assert turned[0].rotation == pytest.approx(0.01)
    assert np.abs(turned[1].shear - plain.shear).max() < 1e-9
    back = solve(problem, [{"P": 1.0, "rotation": 0.3}, {"P": 0.0, "rotation": 0.0}], nodes=81)[-1]
    assert back.rotation == 0.0
    assert not back.in_contact


@pytest.mark.gate
@pytest.mark.parametrize("side", [1e-3, 1e-4, 1e-5])
def test_a_held_pin_crosses_the_clearance_with_a_little_side_force(titanium_in_aluminium, side):
    """It slides round the hole under next to no force. Friction lets the new contact lag behind, for any side force."""
    problem = Problem.from_load_parameter(titanium_in_aluminium, 0.1, 0.4, "centre", "fixed")
    first, last = solve(problem, [{"P": 1.0, "Q": side}, {"P": -1.0}], nodes=101)
    assert last.resultants["P"] == pytest.approx(-1.0)
    assert first.peak_pressure == pytest.approx(0.5531, rel=5e-4)
    assert last.peak_pressure == pytest.approx(0.5507 + 1.3 * side, rel=5e-4)
    ((start, stop),) = last.contact
    assert 0.5 * (start + stop) - 0.5 * math.pi == pytest.approx(-0.0905 - 11.0 * side, abs=3e-3)


def test_interference_fit_opens_evenly_under_one_sided_stress(titanium_in_aluminium):
    problem = Problem(titanium_in_aluminium, 0.01, -1e-5, 0.4)
    for nodes in (101, 201):
        state = solve(problem, [{"sxx": 5e8}], nodes=nodes)[-1]
        assert len(state.contact) == 2
        assert state.work - state.energy - state.dissipation == pytest.approx(0.0, abs=1e-3 * abs(state.energy))


@pytest.mark.gate
def test_a_contact_narrower_than_the_nodes_gets_nodes_where_it_is(titanium_in_aluminium):
    problem = Problem.from_load_parameter(titanium_in_aluminium, 0.1, 0.4, "body")
    corners = [{"P": 1e-4}, {"P": 1.0}]
    first = solve(problem, corners[:1], nodes=401)[-1]
    last = solve(problem, corners[1:], nodes=401)[-1]
    result = solve(problem, corners, nodes=101)
    assert result[0].peak_pressure == pytest.approx(first.peak_pressure, rel=0.01)
    assert result[1].peak_pressure == pytest.approx(last.peak_pressure, rel=0.01)
    with pytest.raises(ConvergenceError, match="more nodes"):
        solve(problem, corners, grid=Grid.arc(-0.5 * np.pi - 1.3, -0.5 * np.pi + 1.3, 101))


def test_results_do_not_depend_on_the_number_of_threads(titanium_in_aluminium):
    from threadpoolctl import threadpool_limits

    problem = Problem.from_load_parameter(titanium_in_aluminium, 0.1, 0.4, "body")
    states = []
    for threads in (1, 2):
        with threadpool_limits(limits=threads, user_api="blas"):
            states.append(solve(problem, [{"P": 1.0}, {"Q": 0.3}], nodes=201)[-1])
    assert np.array_equal(states[0].shear, states[1].shear)
    assert np.array_equal(states[0].slip, states[1].slip)
