"""Lives of wear by single and by fat cycles: the promise of control, stability, limits, and contact that is lost."""

import functools
import pickle
from dataclasses import replace

import numpy as np
import pytest

import fastpin
from fastpin import Grid, LoadHistory, SolveError
from fastpin.errors import InputWarning
from fastpin.model import Profile, Wear
from fastpin.model.profile_terms import Zone
from fastpin.verification.joint_rows import step, wearing
from fastpin.verification.rows import Solving
from fastpin.wear_lives import WearResult, fat_cycles
from fastpin.wear_lives.fat_cycles import FatCycles
from tests.support.checks.wear_limits import rigid_sliding
from tests.support.checks.wear_rows import final_state, half_planes
from tests.support.refusals import refused
from tests.support.slip_cases import LIKE, UNLIKE
from tests.support.tiers import some_survey
from tests.support.wear_cases import WEAR_CASES, WearCase, lived
from tests.survey.conditions import check_states
from tests.survey.histories import generate

NODES = 41


def life(case: WearCase, cycles: int, tolerance: float, tau: float | None = None, **others: object) -> WearResult:
    """A life of a case, with the coefficient that gives its tau."""
    given = {"coefficient": (case.tau if tau is None else tau) / cycles, "grid": case.grid(NODES), **others}
    return fastpin.wear(case.problem, case.history(), cycles=cycles, tolerance=tolerance, **given)


@functools.cache
def every_cycle() -> WearResult:
    return life(WEAR_CASES["partial slip"], 300, 0.0)


@pytest.mark.gate
def test_fat_cycles_keep_their_promise_at_every_chosen_cycle():
    direct = every_cycle()
    fat = life(WEAR_CASES["partial slip"], 300, 0.05)
    assert direct[-1].solved == 300
    assert fat[-1].solved < 200
    assert [each.cycle for each in fat] == [each.cycle for each in direct]
    for one, other in zip(direct[1:], fat[1:], strict=True):
        assert np.abs(one.gap_growth - other.gap_growth).max() < 0.05 * one.depth


@pytest.mark.gate
def test_a_joint_that_shakes_down_takes_few_cycles():
    """A free pin under Q alone slips no more after nine cycles. Then rounding wears it: slip of some 1e-14 a cycle."""
    problem = fastpin.Problem.from_load_parameter(UNLIKE, 0.1, 0.4, "body")
    history = LoadHistory([{"P": 1.0}, {"Q": 0.3}]) + LoadHistory([{"Q": -0.3}, {"Q": 0.3}]).repeated(1)
    few, many = (
        fastpin.wear(problem, history, cycles=cycles, coefficient=0.1, nodes=NODES)[-1] for cycles in (20, 1e6)
    )
    assert many.solved < 300
    assert np.abs(many.gap_growth - few.gap_growth).max() < 1e6 * 0.1 * 1e-13


@pytest.mark.gate
def test_half_the_coefficient_and_twice_the_cycles_are_nearly_the_same():
    case, volumes = WEAR_CASES["partial slip"], []
    for fat in (20, 40, 80, 160):
        run, worn, _ = lived(case, NODES, fat)
        volumes.append(float(run.system.weights @ worn))
    changes = np.abs(np.diff(volumes)) / volumes[-1]
    assert changes[0] < 1e-2
    assert np.all(changes[1:] < 0.6 * changes[:-1])


def test_the_law_of_energy_is_archard_with_the_coefficient_times_friction():
    case = WEAR_CASES["partial slip"]
    energy = life(case, 10, 0.0, law="energy")
    archard = life(case, 10, 0.0, tau=0.5 * case.tau)
    assert np.abs(energy[-1].gap_growth - archard[-1].gap_growth).max() < 1e-12 * archard[-1].depth


def test_pin_and_plate_share_the_wear_by_their_coefficients():
    case = WEAR_CASES["partial slip"]
    zone = Profile.constant(0.3) + Profile((Zone(0.3, -1.5, -1.0),))
    found = life(case, 10, 0.0, coefficient=None, pin=0.1, plate=zone)
    last, theta = found[-1], found.theta
    worn = last.gap_growth > 0.0
    inside = (theta > -1.5) & (theta < -1.0)
    assert worn[inside].any()
    ratio = last.plate_depth[worn] / last.pin_depth[worn]
    assert np.allclose(ratio, np.where(inside[worn], 6.0, 3.0), rtol=1e-12)
    assert last.pin_share == pytest.approx(last.volumes[0] / last.volume)
    assert np.array_equal(found.coefficients[1], np.where(inside, 0.6, 0.3))


@pytest.mark.gate
def test_beyond_the_limit_of_stability_the_pressure_stays_smooth():
    case = WEAR_CASES["rotation"]
    explicit, implicit = (life(case, jumps, 0.0, tau=0.1)[-1] for jumps in (80, 5))
    closed = np.flatnonzero(implicit.pressure > 0.0)
    assert np.all(np.diff(closed) == 1)  # no node opens between others
    well_inside = explicit.pressure > 0.5 * explicit.pressure.max()
    assert np.abs(explicit.pressure - implicit.pressure)[well_inside].max() < 0.15 * explicit.pressure.max()
    assert implicit.volume == pytest.approx(explicit.volume, rel=0.05)


def test_an_explicit_jump_beyond_the_limit_would_open_nodes_in_turn():
    """The limit is needed: without the implicit way the same jumps make a sawtooth."""
    case = WEAR_CASES["rotation"]
    run = wearing(case.problem, case.grid(NODES))
    for loads in case.first:
        step(run, loads)
    for _ in range(4):
        for loads in case.cycle:
            rubbed, _ = step(run, loads)
            run.wear(0.02 * rubbed)
    assert np.any(np.diff(np.flatnonzero(run.now.closed)) > 1)


def test_a_cycle_without_contact_in_it_wears_on():
    problem = fastpin.Problem.from_load_parameter(LIKE, 0.1, 0.3, "body")
    history = LoadHistory([{"P": 1.0}]) + LoadHistory([{"P": -1.0, "Q": 0.1}, {"P": 1.0, "Q": 0.1}]).repeated(1)
    found = fastpin.wear(
        problem, history, cycles=12, coefficient=0.2, tolerance=0.0, at=[6], grid=Grid.circle(80, -0.5 * np.pi)
    )
    top, bottom = (np.abs(found.theta - angle).argmin() for angle in (0.5 * np.pi, -0.5 * np.pi))
    last = found[-1]
    beside = np.abs(found.theta - found.theta[top]) < 0.7
    assert last.gap_growth[beside].max() > 0.2 * last.depth > 0.0
    assert last.gap_growth[bottom] < last.depth
    assert max(max(state.residuals.values()) for each in found for state in each.states) < 1e-10


@pytest.mark.gate
def test_a_pin_that_wear_sets_loose_rests_in_the_worn_hole():
    """An interference fit holds the pin all through the first cycle. Later it floats without force."""
    problem = fastpin.Problem.from_load_parameter(UNLIKE, -0.01, 0.3, "centre", "fixed")
    turns = [{"rotation": -1.0}, {"P": 0.0}, {"P": 1.0}, {"rotation": 1.0}]
    history = LoadHistory([{"P": 1.0, "rotation": 1.0}]) + LoadHistory(turns).repeated(1)
    found = fastpin.wear(problem, history, cycles=4, coefficient=0.02, tolerance=0.0, nodes=NODES)
    assert [each.states[2].in_contact for each in found] == [True, True, False, False, False]
    for each in found:
        for conditions in check_states(each.states, [each.gap_growth] * len(each.states)):
            assert max(value for name, value in conditions.items() if name != "balance") < 1e-10


@pytest.mark.gate
def test_wear_may_take_away_the_last_contact_without_force():
    """A pin that friction holds at no load floats after the wear of the way there."""
    case = generate("wear", 164)
    found = fastpin.wear(case.problem, case.history, **case.options)
    assert not all(state.in_contact for each in found for state in each.states)
    for each in found:
        assert max(max(state.residuals.values()) for state in each.states) < 1e-10


@pytest.mark.gate
def test_much_wear_on_the_way_to_a_corner_is_applied_in_parts(monkeypatch):
    """The volume then hardly depends on the size of the parts. At the corners alone it is far off."""
    problem = fastpin.Problem.from_load_parameter(LIKE, 15.0, 0.3, "centre", "fixed")
    history = LoadHistory([{"P": 1.0}]) + LoadHistory([{"Q": 0.5}, {"Q": -0.5}]).repeated(1)

    def volume(part: float) -> float:
        monkeypatch.setattr(fat_cycles, "LARGEST_PART", part)
        return fastpin.wear(problem, history, cycles=3, coefficient=0.03, tolerance=0.0, nodes=NODES)[-1].volume

    usual, fine, coarse = (volume(part) for part in (fat_cycles.LARGEST_PART, 0.005, 10.0))
    assert usual == pytest.approx(fine, rel=0.05)
    assert abs(coarse / fine - 1.0) > 0.15


def test_wear_that_is_too_fast_is_refused_in_one_sentence():
    problem = fastpin.Problem.from_load_parameter(LIKE, 15.0, 0.3, "centre", "fixed")
    history = LoadHistory([{"P": 1.0}]) + LoadHistory([{"Q": 0.5}, {"Q": -0.5}]).repeated(1)
    with pytest.raises(
        SolveError, match=r"^cycle 1: wear is too fast: on the way to one corner it takes off [\d.]+ times"
    ):
        fastpin.wear(problem, history, cycles=3, coefficient=3.0, nodes=NODES)


def test_a_narrow_contact_wears_on_finer_nodes():
    problem = fastpin.Problem.from_load_parameter(LIKE, 1000.0, 0.3, "centre", "fixed")
    history = LoadHistory([{"P": 1.0}]) + LoadHistory([{"P": 0.05, "Q": 0.02}, {"P": 1.0, "Q": 0.5}]).repeated(1)
    given = {"cycles": 3, "coefficient": 1e-4, "tolerance": 0.0}
    found = fastpin.wear(problem, history, nodes=NODES, **given)
    assert found.grid.size in (2 * NODES - 1, 4 * NODES - 3, 8 * NODES - 7)
    with pytest.raises(SolveError, match=r"narrower than the nodes|has shrunk to"):
        fastpin.wear(problem, history, nodes=NODES, arc=(found.theta[0], found.theta[-1]), **given)


def slid(clearance: float, steps: int) -> tuple[float, float, float]:
    """Depth, peak and tilt of a held pin that has slid one way; k s = 8, mu = 0.2, 61 nodes."""
    problem = fastpin.Problem.from_load_parameter(LIKE, clearance, 0.2, "centre", "fixed")
    run = wearing(problem, Grid.arc(-0.5 * np.pi - 1.7, -0.5 * np.pi + 1.7, 61))
    # Slow wear: slip during a wear path does not count.
    cycles, coefficient, worn = FatCycles(run, Wear(1e-3), np.zeros((0, 10))), 1e-3, np.zeros(61)
    step(run, {"P": 1.0})
    for number in range(1, steps + 1):
        step(run, {"rotation": 8.0 / coefficient * number / steps})
        worn = worn + run.wear(*cycles.worn_by(run.latest.slip_tally.sums, 1)).depth
    top = int(np.argmax(worn))
    below, middle, above = worn[top - 1 : top + 2]
    spacing, bend = float(run.system.weights[top]), 2.0 * middle - below - above
    tilt = run.system.grid.theta[top] + 0.5 * np.pi + 0.5 * spacing * (above - below) / bend
    depth, peak = middle + (above - below) ** 2 / (8.0 * bend), run.now.pressure.max()
    return depth, float(peak), tilt


@pytest.mark.gate
@pytest.mark.parametrize(
    ("clearance", "depth", "peak"), some_survey([(1.0, 3e-3, 8e-3), (10.0, 4e-3, 1e-2)], (1.0, 3e-3, 8e-3))
)
def test_gross_sliding_tends_to_rigid_bodies(clearance, depth, peak):
    """Elastic bodies: d 5.252 and 6.925, N0 0.623 and 0.688, against 5.262 and 6.943, 0.625 and 0.693."""
    found, rigid = slid(clearance, 1600), rigid_sliding(clearance, 8.0, 0.2)
    assert found[0] == pytest.approx(rigid[0], rel=depth)
    assert found[1] == pytest.approx(rigid[1], rel=peak)
    assert found[2] == pytest.approx(-np.arctan(0.2), abs=1e-3)


@pytest.mark.survey
def test_implicit_jumps_of_gross_sliding_converge():
    """Explicit jumps need more than 900 steps here. Measured: 0.53, 0.144, 0.038 below the depth of small steps."""
    finest = slid(1.0, 1600)[0]
    errors = np.array([finest - slid(1.0, steps)[0] for steps in (50, 200, 800)])
    assert 0.0 < errors[2] < 0.05
    assert np.all(errors[:-1] > 3.0 * errors[1:])


@pytest.mark.gate
@pytest.mark.parametrize(
    ("load_parameter", "nodes"),
    some_survey([(2e6, (6, 12)), (2e4, (6, 12)), (2e6, (24, 48))], (2e6, (6, 12)), (2e6, (24, 48))),
)
def test_partial_slip_tends_to_the_final_state_of_the_half_plane(load_parameter, nodes):
    """First order. Measured with 6, 12, 24, 48 nodes: volume 9.1, 5.4, 3.0, 1.5 %, depth 5.0, 2.7, 1.7, 0.9 %."""
    coarse, fine = ([row.difference for row in half_planes(each, load_parameter, Solving())] for each in nodes)
    for one, other, limit in zip(coarse, fine, (0.75, 0.45, 0.04), strict=True):
        assert 0.0 < other < limit / nodes[1]
        assert other < 0.65 * one


@pytest.mark.gate
def test_the_stick_zone_carries_the_whole_load_at_last():
    """The load beside it is 2e-7. The scar ends within a node distance of the limit."""
    last, half = final_state(12, 2e6)
    x, spacing = (last.theta + 0.5 * np.pi) / half, float(last.grid.weights[1]) / half
    beside = np.abs(x) > np.sqrt(0.5)
    assert last.grid.weights[beside] @ last.pressure[beside] < 5e-7
    scar = np.abs(x[last.gap_growth > 1e-3 * last.depth])
    assert scar.min() == pytest.approx(np.sqrt(0.5), abs=spacing)
    assert scar.max() == pytest.approx(1.16919, abs=spacing)
    assert not last.gap_growth[~beside].any()


@pytest.mark.gate
def test_too_deep_wear_ends_with_one_sentence_and_keeps_what_was_found():
    problem = fastpin.Problem(UNLIKE, 0.01, 2e-5, 0.4, "centre", "fixed")
    history = LoadHistory([{"P": 2e6}]) + LoadHistory([{"rotation": 0.02}, {"rotation": -0.02}]).repeated(1)
    with pytest.raises(SolveError, match=r"cycle [\d,]+: .* is too large for small strains: it must stay") as caught:
        fastpin.wear(problem, history, cycles=100, coefficient=1e-9, at=[2], grid=Grid.circle(60))
    result = caught.value.result
    assert isinstance(result, WearResult)
    assert [each.cycle for each in result] in ([0], [0, 2])
    assert not result.complete


def test_a_pin_that_wears_and_slips_far_gives_a_warning():
    problem = fastpin.Problem(UNLIKE, 0.01, 2e-5, 0.4, "centre", "fixed")
    history = LoadHistory([{"P": 2e6}]) + LoadHistory([{"rotation": 0.05}, {"rotation": 0.0}]).repeated(1)
    with pytest.warns(InputWarning, match="pin: the pin slips by .* more than a node distance"):
        fastpin.wear(problem, history, cycles=1, pin=1e-16, arc=(-3.1, 0.0), nodes=NODES)


@pytest.mark.gate
def test_a_result_is_read_only_and_can_be_pickled():
    found = every_cycle()
    with pytest.raises(ValueError, match="read-only"):
        found[-1].pin_depth[0] = 1.0
    copy = pickle.loads(pickle.dumps(found))
    assert np.array_equal(copy[-1].plate_depth, found[-1].plate_depth)
    assert copy.numbers.tolist() == found.numbers.tolist()
    assert "300" in found.summary().splitlines()[-1]
    assert repr(found).startswith("<WearResult: ")
    assert found.tau[-1] == pytest.approx(7.0)


@pytest.mark.gate
def test_a_worn_joint_is_a_problem_of_its_own():
    """A life in two parts, each from no load, is nearly the whole life: what goes is the memory of the shear."""
    case = WEAR_CASES["partial slip"]
    whole = life(case, 200, 0.0, tau=0.5, at=[100])
    first = life(case, 100, 0.0, tau=0.25, at=[])[-1]
    assert np.array_equal(first.gap_growth, whole[1].gap_growth)
    worn = replace(case.problem, gap=first.gap)
    grown = worn.gap.values(first.theta, 1.0)[0] - case.problem.gap.values(first.theta, 1.0)[0]
    assert np.abs(grown - first.gap_growth).max() < 1e-15
    given = {"coefficient": 0.5 / 200, "grid": first.grid, "tolerance": 0.0}
    second = fastpin.wear(worn, case.history(), cycles=100, at=[], **given)[-1]
    both = first.gap_growth + second.gap_growth
    assert np.abs(both - whole[-1].gap_growth).max() < 0.02 * whole[-1].depth
    assert np.abs(second.pressure - whole[-1].pressure).max() < 0.02 * whole[-1].pressure.max()


def test_a_body_that_does_not_wear_keeps_its_profile():
    case = WEAR_CASES["lobed hole"]
    last = life(case, 4, 0.0, coefficient=None, plate=0.1)[-1]
    assert last.gap.pin == case.problem.gap.pin
    assert last.gap.hole.terms[:-1] == case.problem.gap.hole.terms
    nothing = life(case, 4, 0.0, coefficient=None, pin=0.1)[0]
    assert nothing.gap.hole == case.problem.gap.hole


@pytest.mark.gate
def test_states_lie_over_one_cycle_on_the_worn_profile():
    last = every_cycle()[-1]
    loads = [state.load["Q"] for state in last.states]
    assert loads == [0.275, -0.275, 0.275]
    steps = [state.step for state in last.states]
    assert steps == [601, 602, 603]
    energy = sum(float(last.grid.weights @ state.friction_energy) for state in last.states[1:])
    assert energy == pytest.approx(last.energy_per_cycle, rel=1e-9)


WRONG = {
    "history: must end with the cycle that wears: repeat its last block": {"history": [{"P": 1.0}]},
    "keep: has no effect on wear; of the options of a run it takes nodes and arc": {"keep": "cycles"},
    "grid: wear needs equally spaced nodes": {"grid": Grid(np.array([-3.0, -2.0, -1.6, -1.2, -1.0, 0.0]))},
    "cycles: must be at most 49,999,998: a life has at most 100,000,000 corners": {"cycles": 1e8},
    "resume: needs an output": {"resume": True},
    "overwrite: needs an output": {"overwrite": True},
}


@pytest.mark.parametrize("message", WRONG)
def test_wrong_input_is_refused_in_one_sentence(message):
    case = WEAR_CASES["partial slip"]
    given = {"history": case.history(), "cycles": 10, "coefficient": 1.0, **WRONG[message]}
    assert str(refused(fastpin.wear, case.problem, **given)) == message
