"""Wear as one more load of the path solver."""

from dataclasses import replace

import numpy as np
import pytest

from fastpin import Grid, SolveOptions, solve
from fastpin.elasticity.operator import DenseOperator
from fastpin.elasticity.system import System
from fastpin.model import LOADS, Profile
from fastpin.model.profile_terms import Zone
from fastpin.solver import first_contact
from fastpin.solver.configuration import review, worst_residual
from fastpin.solver.increment import implicit_step
from fastpin.verification.joint_rows import step, wearing
from fastpin.wear_lives.wear_path import SoftOperator, system_with_wear
from tests.support.tiers import some_survey
from tests.support.wear_cases import WEAR_CASES, lived, numbers_of, parts_of, ready_to_wear

FIRST_PATCH = 0.038726937776372955
"""Part of the load at which the first patch of the lobed hole ends in the program of the table."""


@pytest.mark.parametrize("name", WEAR_CASES)
def test_lives_of_forty_fat_cycles_have_the_known_numbers(name, monkeypatch):
    case = WEAR_CASES[name]
    if name == "lobed hole":  # its two contacts slide at first, so the volume depends on the load of the first patch
        monkeypatch.setattr(first_contact, "_hertz_part", lambda *_: FIRST_PATCH)
    run, worn, dissipation = lived(case, 121, 40)
    volume, depth, bottom, lost = numbers_of(case, run, worn)
    assert volume == pytest.approx(case.volume, rel=1e-6)
    # Material and friction energy are the same sums.
    assert volume == pytest.approx(case.tau / 40 / run.system.friction[0] * dissipation, rel=1e-14)
    assert depth == pytest.approx(case.depth, abs=6e-7)
    assert bottom == pytest.approx(case.bottom, abs=6e-7)
    assert lost == pytest.approx(case.dissipation, rel=5e-6)
    assert worst_residual(run.system, run.now) < 1e-14


@pytest.mark.gate
@pytest.mark.parametrize("name", some_survey(WEAR_CASES, "unlike", "pulsating", "rotation"))
def test_lives_tend_to_the_known_limits(name):
    """The uncertainties are those of the stated limits. docs/wear-accuracy.md has the numbers of 121 to 481 nodes."""
    case = WEAR_CASES[name]
    run, worn, _ = lived(case, 241, 160)
    assert worst_residual(run.system, run.now) < 1e-14
    for found, (limit, uncertainty) in zip(numbers_of(case, run, worn), case.limits, strict=True):
        assert found == pytest.approx(limit, abs=uncertainty)


@pytest.mark.parametrize(("size", "grows"), [(1.0, False), (2.6, True)])
def test_a_sawtooth_grows_beyond_the_limit_of_explicit_jumps(size, grows):
    """Jumps of k J s = size times C, the compliance of a sawtooth. The limit is 2 C; from 1.8 C on it grows slowly."""
    case = WEAR_CASES["rotation"]
    run, signs = wearing(case.problem, case.grid(41)), (-1.0) ** np.arange(41)
    for loads in case.first:
        step(run, loads)
    run.wear(np.where(signs > 0.0, 1e-5, 0.0))
    for loads in 6 * case.cycle:
        rubbed, _ = step(run, loads)
        most = run.latest.slip_tally.sums[0].max()
        run.wear(size * run.system.weights[20] / (2.0 * np.pi) / most * rubbed)
    sawtooth = abs((signs[1:-1] * np.diff(run.now.pressure, 2))[16:25].mean())
    assert sawtooth > 0.1 if grows else sawtooth < 1e-3


def test_one_wear_path_is_sixty_four():
    once, depth = ready_to_wear()
    often, _ = ready_to_wear()
    whole, parts = once.wear(depth), parts_of(often, depth, 64)
    assert np.count_nonzero(once.now.status != ready_to_wear()[0].now.status) > 5
    for name in ("pressure", "shear", "gap", "slip"):
        one, other = getattr(once.now, name), getattr(often.now, name)
        assert np.abs(one - other).max() < 2e-13 * np.abs(one).max()
    assert sum(part.dissipation for part in parts) == pytest.approx(whole.dissipation, rel=1e-9)
    assert sum(part.energy for part in parts) == pytest.approx(whole.energy, rel=1e-9)


def test_sticking_nodes_keep_their_slip_and_their_shear_adapts():
    run, depth = ready_to_wear()
    before = run.now
    run.wear(depth)
    stuck = (before.status == 0) & (run.now.status == 0)
    assert stuck.sum() > 10
    assert np.array_equal(before.slip[stuck], run.now.slip[stuck])
    assert np.abs(before.shear - run.now.shear)[stuck].max() > 1e-3


def test_implicit_increments_of_the_gap_tend_to_the_path():
    run, depth = ready_to_wear()
    before = run.now
    run.wear(depth)
    errors = []
    for count in (10, 40, 160):
        now = before
        for _ in range(count):
            found = implicit_step(run.system, replace(now, rest_gap=now.rest_gap + depth / count), now.load)
            assert found is not None
            now = found
        errors.append(np.abs(now.shear - run.now.shear).max())
    assert errors[0] < 1e-2
    assert errors[2] < 0.4 * errors[1] < 0.25 * errors[0]


def test_the_energy_that_goes_with_the_material_closes_the_balance():
    errors = []
    for nodes in (31, 61, 121):
        run, depth = ready_to_wear(nodes)
        before, removal = run.now, run.wear(depth)
        grown = review(run.system, run.now).energy - review(run.system, before).energy
        errors.append(abs(removal.work - grown - removal.dissipation - removal.energy) / removal.energy)
    assert errors[0] < 1e-2
    assert np.all(np.diff(np.log2(errors)) < -1.8)


def test_the_energy_of_the_implicit_way_closes_the_balance():
    run, depth = ready_to_wear(121)
    before = run.now
    removal = run.wear(depth, 0.2 * np.ones(121))
    grown = review(run.system, run.now).energy - review(run.system, before).energy
    left = removal.work - grown - removal.dissipation - removal.energy
    assert abs(left) < 1e-3 * removal.energy


def test_the_implicit_way_wears_with_the_pressure():
    run, depth = ready_to_wear()
    softness = np.linspace(0.1, 0.3, 61)
    before, removal = run.now, run.wear(depth, softness)
    grown = softness * (run.now.pressure - before.pressure)
    assert np.abs(removal.depth - depth - grown).max() < 1e-15
    assert np.abs(grown).max() > 0.1 * depth.max()
    assert worst_residual(run.system, run.now) < 1e-14


def test_a_floating_pin_is_worn_too():
    case = WEAR_CASES["unlike"]
    run = wearing(case.problem, case.grid(41))
    gap = run.now.gap
    removal = run.wear(np.full(41, 0.01))
    assert np.allclose(run.now.gap, gap + 0.01)
    assert removal.energy == 0.0


def test_the_tally_of_wear_is_friction_energy_over_friction():
    case = WEAR_CASES["rotation"]
    run = wearing(case.problem, case.grid(61))
    for loads in (*case.first, *case.cycle):
        step(run, loads)
        sums = run.latest.slip_tally.sums
        assert np.allclose(0.2 * sums[4], sums[1], rtol=1e-14, atol=0.0)
    assert sums[4].max() > 0.1


@pytest.mark.gate
def test_nodes_without_friction_have_a_tally_of_their_own():
    friction = Profile.constant(0.3) + Profile((Zone(-0.3, -1.4, -1.0),))
    case = WEAR_CASES["pulsating"]
    problem, grid = replace(case.problem, friction=friction), Grid.arc(-3.2, 0.06, 61)
    run = wearing(problem, grid)
    step(run, {"P": 1.0})
    rubbed, _ = step(run, {"P": 0.3})
    smooth = run.system.friction == 0.0
    # A sum over many states inside the same step.
    states = solve(problem, [{"P": 1.0}, {"P": 0.3}], grid=grid, between=400)
    inside = [state for state in states if state.step == 1 or state.fraction == 1.0]
    pressure, slip = (np.array([getattr(state, name) for state in inside]) for name in ("pressure", "slip"))
    mean, slid = 0.5 * (pressure[1:] + pressure[:-1]), np.abs(np.diff(slip, axis=0))
    counted = np.where((pressure[1:] > 0.0) & (pressure[:-1] > 0.0), mean * slid, 0.0).sum(axis=0)
    assert rubbed[smooth].max() > 0.001
    assert np.abs(rubbed - counted).max() < 1e-4 * rubbed.max()


def test_softness_is_a_diagonal_of_the_gap_rows():
    rng = np.random.default_rng(1)
    matrix, softness = rng.normal(size=(10, 10)), rng.random(5)
    soft = SoftOperator(DenseOperator(matrix), softness)
    whole = matrix + np.diag(np.r_[softness, np.zeros(5)])
    assert np.array_equal(np.asarray(soft), whole)
    assert np.allclose(soft @ np.eye(10), whole)
    rows, columns = np.array([7, 2, 0]), np.array([2, 7])
    assert np.array_equal(soft.entries(rows, columns), whole[np.ix_(rows, columns)])
    assert np.array_equal(soft.diagonal(), np.diag(whole))


def test_wear_is_the_last_load():
    system = System.build(WEAR_CASES["unlike"].problem, Grid.arc(-3.0, -0.1, 31), 1.0)
    depth = np.linspace(0.0, 1.0, 31)
    worn = system_with_wear(system, depth)
    load = np.r_[np.zeros(len(LOADS)), 2.0]
    assert np.array_equal(worn.load_displacement(load), np.r_[2.0 * depth, np.zeros(31)])
    assert not worn.load_forces(load).any()
    assert np.array_equal(worn.loads[:, :-1], system.loads)
    assert worn.held_as is system
    assert worn.is_toeplitz
    assert not system_with_wear(system, depth, depth).is_toeplitz


def test_a_run_that_wears_recalls_nothing():
    case = WEAR_CASES["unlike"]
    run = wearing(case.problem, case.grid(41))
    for _ in range(3):
        for loads in (*case.first, *case.cycle):
            step(run, loads)
    assert not list(run.repeats)
    assert SolveOptions().shortcut
