"""Quantities over a load cycle, against states, sums and energies."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from fastpin import MATERIALS, InputError, LoadHistory, Material, MaterialPair, Problem, Result, load, record, solve
from fastpin.kernels.status import OPEN, SLIP_POSITIVE, STICK
from fastpin.states import LoadCycle, NodeBehaviour
from fastpin.storage import StoredResult
from tests.support.joints import joint

UNLIKE = MaterialPair(MATERIALS["Ti-6Al-4V"], MATERIALS["aluminium"])
LIKE = MaterialPair(Material(100e9, 0.3), Material(100e9, 0.3))
JOINT = Problem(UNLIKE, 0.01, 2e-5, 0.4, "centre", "fixed")
HELD = Problem.from_load_parameter(UNLIKE, 0.1, 0.4, "centre", "fixed")
FRETTING = LoadHistory([{"P": 1.0}]) + LoadHistory([{"Q": 0.3}, {"Q": -0.3}]).repeated(6)
STRESSED = LoadHistory([{"P": 1.0}]) + LoadHistory(
    [{"Q": 0.3, "sxx": 0.2}, {"Q": -0.1, "sxy": 0.1}, {"Q": -0.3, "P": 0.9, "sxx": 0.0}, {"P": 1.0, "sxy": -0.1}]
).repeated(6)
DRIVEN = Problem.from_load_parameter(UNLIKE, 0.1, 0.4, "centre", "fixed", drive="ux")
PUSHED = LoadHistory([{"P": 1.0}]) + LoadHistory([{"ux": 0.3}, {"ux": -0.3}]).repeated(6)
SPRUNG = Problem.from_load_parameter(UNLIKE, 0.1, 0.4, "centre", "spring", hub_stiffness=0.5)
TURNED = LoadHistory([{"P": 1.0}]) + LoadHistory([{"rotation": 0.5}, {"rotation": -0.5, "Q": 0.1}]).repeated(6)
CYCLES = {
    "forces": (HELD, FRETTING),
    "remote stress": (HELD, STRESSED),
    "displacements": (DRIVEN, PUSHED),
    "rotations": (SPRUNG, TURNED),
    "body": (Problem.from_load_parameter(UNLIKE, 0.1, 0.4, "body"), FRETTING),
}


def solved(name: str = "forces", cycles: int = 6, **options: Any) -> Result:
    """The first cycles of a history, solved: few cycles are enough where many states are kept."""
    problem, history = CYCLES[name]
    history = history[: 1 + cycles * history.longest_cycle]
    nodes = {} if "grid" in options else {"nodes": 81}
    return solve(problem, history, **{**nodes, "slip_sums": True, **options})


def again(found: Result, *stops: int) -> list[LoadCycle]:
    """The last cycle of a result, solved again with each of these numbers of stops inside its steps."""
    history = found.history
    first = len(history) - history.longest_cycle - 1  # the cycle begins at the end of this step
    begun = solve(found.problem, history[:first], grid=found.grid, slip_sums=True)
    options: dict[str, Any] = {"start": begun, "slip_sums": True}
    results = [solve(found.problem, history[first:], between=between, **options) for between in stops]
    return [result.cycle(first=1, last=len(history) - first) for result in results]


@pytest.fixture(scope="module")
def result() -> Result:
    return solved(between=3)


# -- which part ----------------------------------------------------------------------------------------------


def test_the_last_cycle_is_the_default(result: Result) -> None:
    cycle = result.cycle()
    assert (cycle.first, cycle.last, len(cycle.states), cycle.is_closed) == (11, 13, 9, True)
    assert repr(cycle) == "<LoadCycle: corners 11 to 13, closed, 9 states>"
    assert cycle.states[-1] is result[-1]
    assert (result.cycle(1).first, result.cycle(-2).first, result.cycle(-2).last) == (3, 9, 11)
    assert result.cycle(first=11, last=13).states == cycle.states


def test_what_is_no_closed_cycle_is_refused_unless_its_corners_are_given(result: Result) -> None:
    with pytest.raises(InputError, match=r"^cycle: the cycle to corner 3 is not closed: Q differs .* first=1, last=3"):
        result.cycle(0)
    part = result.cycle(first=1, last=3)
    assert not part.is_closed
    assert part.differing_loads == ["Q"]
    assert part.friction_energy is not None
    assert part.slip_range.max() > 0.0


def test_an_end_that_was_not_kept_is_named() -> None:
    with pytest.raises(InputError, match=r"the state at corner 9 was not kept"):
        solved(keep="every 4").cycle(first=9, last=12)
    with pytest.raises(InputError, match=r"the state at corner 11 was not kept"):
        solved(keep="every 4").cycle()
    assert len(solved(keep="cycles").cycle().states) == 2


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"place": 6}, "place: must be a whole number from -6 to 5"),
        ({"first": 3}, "first: and last go together"),
        ({"first": 0, "last": 2}, "first: must be a whole number from 1 to 12"),
        ({"first": 3, "last": 3}, "last: must be a whole number from 4 to 13"),
        ({"first": 3, "last": 14}, "last: must be a whole number from 4 to 13"),
    ],
)
def test_wrong_arguments_are_named(result: Result, arguments: dict[str, Any], words: str) -> None:
    with pytest.raises(InputError, match=words):
        result.cycle(**arguments)


def test_histories_without_an_ended_cycle() -> None:
    plain = solve(HELD, [{"P": 1.0}, {"Q": 0.1}], nodes=41)
    with pytest.raises(InputError, match="no cycle of the history has ended"):
        plain.cycle()
    first = solve(HELD, LoadHistory([{"P": 1.0}, {"P": 0.5}]).repeated(2), nodes=41)
    with pytest.raises(InputError, match="the cycle to corner 2 begins without load"):
        first.cycle(0)


# -- energies and loops --------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", list(CYCLES))
@pytest.mark.parametrize("options", [{"between": 3}, {"keep": "cycles"}], ids=["all", "cycles"])
def test_the_friction_energy_is_the_dissipation(name: str, options: dict[str, Any]) -> None:
    cycle = solved(name, **options).cycle()
    energy = float(cycle.states[0].grid.weights @ cycle.friction_energy)
    assert energy == pytest.approx(cycle.dissipation, rel=1e-12, abs=1e-12 * cycle.states[-1].dissipation)


@pytest.mark.gate
@pytest.mark.parametrize("name", CYCLES)
def test_the_loops_enclose_the_work_of_the_loads(name: str) -> None:
    """The polygon through the states converges to the work of the solver, with the square of their number."""
    errors, size = [], 0.0
    for between in (7, 255):
        found = solved(name, cycles=1, between=between)
        cycle = found.cycle(first=1, last=len(found.history))
        work = sum(loop.work for loop in cycle.loops.values())
        exact = cycle.states[-1].work - cycle.states[0].work
        size = sum(abs(loop.work) for loop in cycle.loops.values())
        errors.append(abs(work - exact) / size)
    assert errors[1] < 4e-5
    assert errors[1] < 0.02 * errors[0] or errors[0] < 1e-6


SEATED = {
    "forces": ("free", [{"P": 1.0}, {"Q": 0.4}, {"Q": -0.4}, {"Q": 0.4}]),
    "moment": ("free", [{"P": 1.0}, {"M": 0.05}, {"M": -0.05}, {"M": 0.05}]),
    "rotation": ("fixed", [{"P": 1.0}, {"rotation": 0.2}, {"rotation": -0.2}, {"rotation": 0.2}]),
    "remote stress": ("free", [{"P": 1.0}, {"sxx": 0.2, "Q": 0.1}, {"sxx": -0.2, "Q": -0.1}, {"sxx": 0.2, "Q": 0.1}]),
}


@pytest.mark.gate
@pytest.mark.parametrize("name", SEATED)
def test_loops_reach_across_a_bush_that_slips(name: str) -> None:
    """The work is that of pin and seat together: without the seat some loops have a negative area."""
    rotation, corners = SEATED[name]
    problem = replace(joint(0.28, 0.26, pin_load="centre"), rotation=rotation)
    cycle = solve(problem, corners, nodes=96, between=40).cycle(first=2, last=4)
    work = sum(loop.work for loop in cycle.loops.values())
    assert work == pytest.approx(cycle.states[-1].work - cycle.states[0].work, rel=2e-3)


def test_a_loop_is_exact_where_no_status_changes() -> None:
    """Friction is so large that all nodes stick, and the contact is the whole circle."""
    problem = Problem.from_load_parameter(UNLIKE, -0.2, 2.0, "centre", "fixed")
    found = solve(problem, [{"P": 0.5}, {"Q": 0.2, "sxx": 0.05}, {"Q": -0.1}], nodes=80)
    assert all(np.all(state.status == STICK) for state in found)
    cycle = found.cycle(first=1, last=3)
    work = sum(loop.work for loop in cycle.loops.values())
    assert work == pytest.approx(found[2].work - found[0].work, rel=1e-11)


@pytest.mark.gate
@pytest.mark.parametrize("name", ["forces", "remote stress", "displacements"])
def test_closed_loops_enclose_the_dissipation_up_to_the_discretisation(name: str) -> None:
    """The contact under remote stress has not settled quite: its elastic energy still changes."""
    errors = []
    for nodes in (81, 161):
        cycle = solved(name, nodes=nodes).cycle()
        before, after = cycle.states[0], cycle.states[-1]
        stored = after.energy - before.energy
        errors.append(abs((after.work - before.work - stored) / cycle.dissipation - 1.0))
    assert errors[1] < 0.3 * errors[0]
    (fine,) = again(solved(name), 255)
    assert sum(loop.work for loop in fine.loops.values()) == pytest.approx(fine.dissipation, rel=2e-3)


def test_the_displacement_of_a_small_hub_does_the_work_of_the_force() -> None:
    """Betti's theorem: the hub's displacement of (T29) is the loop's, up to terms of the loads alone."""
    problem = Problem.from_load_parameter(UNLIKE, 0.1, 0.4, "centre", "fixed", hub_radius=1e-3)
    cycle = solve(problem, FRETTING, nodes=161, between=3).cycle()
    for name, component, sense in (("Q", "ux", 1.0), ("P", "uy", -1.0)):
        loop = cycle.loops[name]
        own = problem.drive_compliances[0] * problem.pair.beta_star
        hub = np.array([sense * state.displacement[component] for state in cycle.states]) - own * loop.load
        assert np.diff(hub) == pytest.approx(np.diff(loop.displacement), abs=2e-4 * np.ptp(hub))


# -- slip and statuses ---------------------------------------------------------------------------------------


def test_ranges_are_over_the_states_in_contact() -> None:
    cycle = solved(between=3, slip_sums=False).cycle()
    for node in range(0, 81, 5):
        slips = [state.slip[node] for state in cycle.states if state.status[node] != OPEN]
        assert cycle.slip_range[node] == (max(slips) - min(slips) if slips else 0.0)
    assert np.array_equal(cycle.pressure_range, np.ptp([state.pressure for state in cycle.states], axis=0))
    assert np.array_equal(cycle.shear_range, np.ptp([state.shear for state in cycle.states], axis=0))
    place = int(np.argmax(cycle.slip_range))
    assert cycle.largest_slip_range == cycle.slip_range[place]
    assert cycle.largest_slip_range_angle == cycle.theta[place]


def bare(cycle: LoadCycle) -> LoadCycle:
    """The cycle as it is without slip sums."""
    lost: dict[str, Any] = dict.fromkeys(("slip_distance", "friction_energy", "slip_lowest", "slip_highest"))
    return LoadCycle(tuple(replace(state, **lost) for state in cycle.states))


@pytest.mark.gate
@pytest.mark.parametrize("name", CYCLES)
def test_the_slip_range_is_exact_whatever_is_kept(name: str) -> None:
    """The range from two states against the ranges read from more and more states."""
    cycles = 6 if name == "body" else 2  # by the sixth cycle the nodes of the pin with body loads stick
    found = solved(name, cycles=cycles, keep="cycles")
    exact, size = found.cycle(), max(float(np.abs(state.slip).max()) for state in found)
    assert exact.has_exact_slip_range
    assert len(exact.states) == 2
    missed = []
    for fine in again(found, 3, 31, 255):
        assert np.abs(fine.slip_range - exact.slip_range).max() <= 1e-13 * size
        read = bare(fine)
        assert not read.has_exact_slip_range
        spread = np.nan_to_num(fine.slip_extremes[1] - fine.slip_extremes[0])
        assert fine.slip_range == pytest.approx(np.minimum(spread, fine.slip_distance), abs=0.0)
        assert np.all(read.slip_range <= spread)
        missed.append(np.abs(read.slip_range - spread).max() / size)
    if name == "body":  # the nodes stick; their slip is some 1e-9
        assert missed == pytest.approx([0.0] * 3, abs=1e-8)
        return
    assert missed[1] < 0.3 * missed[0]
    assert missed[2] < 0.3 * missed[1]
    assert missed[2] < 4e-3


@pytest.mark.gate
def test_moving_contact_edges_leave_no_staircase() -> None:
    """Nodes that open between the states: the range along the arc is as smooth as read from very many states."""
    history = LoadHistory([{"P": 1.0}]) + LoadHistory([{"P": 0.4, "Q": 0.1}, {"P": 1.0, "Q": 0.0}]).repeated(3)

    def bends(cycle: LoadCycle) -> np.ndarray:
        """Second differences of the range at the nodes that open, with both neighbours."""
        opens = exact.behaviour == NodeBehaviour.OPENS
        inner = opens[:-2] & opens[1:-1] & opens[2:]
        return np.diff(cycle.slip_range, 2)[inner] / exact.largest_slip_range

    found = solve(HELD, history, nodes=201, arc=(-3.0, -0.14), slip_sums=True)
    exact, (few, many) = found.cycle(), again(found, 7, 511)
    assert bends(exact).size > 20
    assert np.abs(bends(exact) - bends(bare(many))).max() < 5e-3
    assert np.abs(bends(bare(few)) - bends(bare(many))).max() > 5e-2
    assert np.abs(bends(exact)).max() < 1.1 * np.abs(bends(bare(many))).max()
    assert np.abs(bends(bare(few))).max() > 2.0 * np.abs(bends(exact)).max()


def test_a_slip_range_covers_the_first_corner() -> None:
    """The pin slips one way from the first corner on: the range is the whole change."""
    problem = Problem.from_load_parameter(LIKE, 0.2, 0.0, "centre", "fixed")
    cycle = solve(problem, [{"P": 1.0}, {"P": 0.9}], nodes=81, slip_sums=True).cycle(first=1, last=2)
    before, after = cycle.states
    closed = after.status != OPEN
    change = np.abs(after.slip - before.slip)
    assert cycle.slip_range[closed] == pytest.approx(change[closed], rel=1e-12, abs=1e-12 * change.max())
    assert np.all(np.isnan(cycle.slip_extremes[0]) == ((before.status == OPEN) & ~closed))


def test_behaviours(result: Result) -> None:
    cycle = result.cycle()
    assert cycle.status.shape == (9, 81)
    for node, behaviour in enumerate(cycle.behaviour):
        closed = cycle.status[:, node] != OPEN
        assert (behaviour == NodeBehaviour.NO_CONTACT) == (not closed.any())
        assert (behaviour == NodeBehaviour.OPENS) == (closed.any() and not closed.all())
        if behaviour == NodeBehaviour.STICKS:
            assert np.all(cycle.status[1:, node] == STICK)
            assert cycle.slip_distance[node] <= 1e-12 * cycle.slip_distance.max()
            assert cycle.slip_range[node] <= 1e-12 * cycle.largest_slip_range
    assert set(cycle.behaviour) == set(NodeBehaviour)


def test_contact_between_the_states_is_seen() -> None:
    """A node that is open at the ends of the cycle closes between them: only its extremes show this."""
    plain, summed = (solved(keep="cycles", slip_sums=sums).cycle() for sums in (False, True))
    assert np.sum(plain.behaviour == NodeBehaviour.OPENS) < np.sum(summed.behaviour == NodeBehaviour.OPENS)
    assert np.sum(plain.behaviour == NodeBehaviour.STICKS) >= np.sum(summed.behaviour == NodeBehaviour.STICKS)


def test_without_slip_sums_the_rest_is_there() -> None:
    cycle = solved(slip_sums=False).cycle()
    assert cycle.slip_distance is cycle.friction_energy is None
    assert cycle.largest_slip_range > 0.0
    assert "friction_energy" not in cycle.columns()


def test_columns_hold_the_extremes_of_the_nodes(result: Result) -> None:
    cycle = result.cycle()
    columns = cycle.columns()
    for name in ("pressure", "shear"):
        values = np.array([getattr(state, name) for state in cycle.states])
        low, high = (columns[f"{name}_{end}"][0] for end in ("min", "max"))
        assert np.all(low <= values.min(axis=0))
        assert np.all(high >= values.max(axis=0))
        assert np.any(low < high)


def test_frictionless_cycles() -> None:
    problem = Problem.from_load_parameter(LIKE, 0.2, 0.0, "centre", "fixed")
    history = LoadHistory([{"P": 1.0}]) + LoadHistory([{"P": 0.5}, {"P": 1.0}]).repeated(2)
    cycle = solve(problem, history, nodes=81, slip_sums=True).cycle()
    assert not cycle.friction_energy.any()
    assert set(cycle.behaviour) <= {NodeBehaviour.NO_CONTACT, NodeBehaviour.SLIPS, NodeBehaviour.OPENS}
    assert np.all(cycle.status[cycle.status != OPEN] == SLIP_POSITIVE)


def test_contacts_without_slip_have_no_angle() -> None:
    problem = Problem.from_load_parameter(UNLIKE, -0.2, 2.0, "centre", "fixed")
    cycle = solve(problem, [{"P": 0.5}, {"P": 0.6}], nodes=80, slip_sums=True).cycle(first=1, last=2)
    assert cycle.slip_range.max() == 0.0
    assert math.isnan(cycle.largest_slip_range_angle)


# -- files and tables ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("keep", ["all", "cycles"])
def test_a_loaded_result_has_the_same_cycle(tmp_path, keep: str) -> None:
    expected = solved(keep=keep).cycle()
    record(*CYCLES["forces"], tmp_path / "a.h5", nodes=81, keep=keep, slip_sums=True)
    whole = load(tmp_path / "a.h5")
    part = StoredResult(tmp_path / "a.h5").part(11, 13)
    for found in (whole.cycle(), part.cycle()):
        for name, (values, unit) in expected.columns().items():
            assert np.array_equal(found.columns()[name][0], values), name
            assert found.columns()[name][1] == unit
    gaps = LoadCycle(tuple(load(tmp_path / "a.h5", states=[0, -1])))
    assert gaps.slip_distance is None


def test_a_data_frame_has_a_row_for_each_node() -> None:
    result = solve(JOINT, LoadHistory([{"P": 2e6}]) + LoadHistory([{"Q": 5e5}, {"Q": -5e5}]).repeated(2), nodes=61)
    frame = result.cycle().to_dataframe()
    assert len(frame) == 61
    assert frame["slip_range"].max() == result.cycle().largest_slip_range
    assert frame.attrs["units"]["pressure_max"] == "Pa"


def test_the_range_of_a_node_that_opens_is_at_most_its_way() -> None:
    """A node at a moving edge closes again at another slip. The way in between is no sliding."""
    problem = Problem.from_load_parameter(UNLIKE, 0.1, 0.4)
    history = LoadHistory([{"P": 1.0}]) + LoadHistory([{"Q": 0.35}, {"Q": -0.35}]).repeated(3)
    cycle = solve(problem, history, nodes=201, slip_sums=True).cycle()
    lowest, highest = cycle.slip_extremes
    assert np.nanmax(highest - lowest) > 4.0 * cycle.slip_distance.max()
    assert cycle.largest_slip_range <= cycle.slip_distance.max()
    always = cycle.behaviour == NodeBehaviour.SLIPS
    assert cycle.slip_range[always] == pytest.approx((highest - lowest)[always])
