"""Friction that changes along a step: exact events, limits, and checks by increments and by parts of the step."""

import math
from itertools import cycle
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from fastpin.casefile.reader import parse_case
from fastpin.drift.path import DriftPath, Moment, _dip
from fastpin.elasticity.system import System
from fastpin.errors import InputError
from fastpin.kernels import exchange
from fastpin.kernels.status import SLIP_POSITIVE, STICK
from fastpin.model.grid import Grid
from fastpin.model.history import LoadHistory
from fastpin.model.loads import FRICTION_CHANGE, Corner
from fastpin.model.materials import Material, MaterialPair
from fastpin.model.options import SolveOptions
from fastpin.model.problem import Problem
from fastpin.report.summary import printed_loads
from fastpin.sessions.session import Session
from fastpin.solver.configuration import Configuration, worst_residual
from fastpin.solver.errors import NoEquilibriumError
from fastpin.solver.increment import implicit_step
from fastpin.solver.path import PathStep, StepLostError
from fastpin.solver.result import Result
from fastpin.solver.run import Run
from fastpin.solver.settling import settle
from fastpin.solver.solving import solve
from fastpin.states.state import State
from tests.support.programs import assert_same_bits
from tests.support.refusals import refused
from tests.support.tiers import some_gate, some_survey

UNLIKE = MaterialPair(Material(116e9, 0.32), Material(69e9, 0.33))
LIKE = MaterialPair(Material(1.0, 0.3), Material(1.0, 0.3))
ARC = (-0.5 * math.pi - 1.6, -0.5 * math.pi + 1.6)
T1 = Problem.from_load_parameter(UNLIKE, 0.1, 0.5, "body", "free")
FIRST: list[Corner] = [{"P": 1.0}, {"Q": 0.2}]
LAST: Corner = {"P": 0.8, "Q": -0.1, "friction_change": -0.6}


def t1(nodes: int = 61, **options: Any) -> Result:
    return solve(T1, [*FIRST, LAST], nodes=nodes, arc=ARC, **options)


@pytest.fixture(scope="module")
def whole() -> Result:
    return t1()


def difference(one: State, other: State) -> float:
    """Largest difference of the tractions of two states, in parts of the largest pressure."""
    peak = max(one.pressure.max(), other.pressure.max())
    tractions = [np.r_[state.pressure, state.shear] for state in (one, other)]
    return float(np.abs(tractions[0] - tractions[1]).max() / peak)


def configuration_after(system: System, corners: list[Corner]) -> Configuration:
    run = Run(LoadHistory(corners), system, SolveOptions())
    run.follow()
    return run.now


def last_path() -> DriftPath:
    """The path of the last step of T1, on 31 nodes."""
    system = System.build(T1, Grid.arc(*ARC, 31), 1.0)
    start, end = (configuration_after(system, corners) for corners in (FIRST, [*FIRST, LAST]))
    return DriftPath(system, start, end.load, system.under(end.load).friction)


# Nodes, peak pressure, rotation and int T of two cases, from another program.
REFERENCE = [(61, 0.50786, 0.02135, -0.10402), (121, 0.50783, 0.02138, -0.10390), (241, 0.50780, 0.02136, -0.10385)]


@pytest.mark.gate
@pytest.mark.parametrize(("nodes", "peak", "rotation", "shear"), some_survey(REFERENCE, *REFERENCE[1:]))
def test_the_table_of_reference(nodes: int, peak: float, rotation: float, shear: float) -> None:
    """Loads and friction that change together, and friction that falls at constant load."""
    states = t1(nodes)
    last = states[-1]
    assert last.peak_pressure == pytest.approx(peak, abs=1e-5)
    assert last.rotation == pytest.approx(rotation, abs=5e-6)
    assert last.dissipation - states[-2].dissipation == pytest.approx(0.002289, abs=2.1e-6)
    assert max(max(state.residuals.values()) for state in states) < 1e-13
    problem = Problem.from_load_parameter(LIKE, 0.2, 0.6, "centre", "fixed")
    fallen = solve(problem, [*FIRST, {"friction_change": 0.25 / 0.6 - 1.0}], nodes=nodes, arc=ARC)[-1]
    assert float(fallen.grid.weights @ fallen.shear) == pytest.approx(shear, abs=5e-6)


@pytest.mark.gate
def test_a_step_in_parts_is_the_same_step(whole: Result) -> None:
    corners = [{name: (1.0 - k / 7) * before + k / 7 * LAST[name] for name, before in
                (("P", 1.0), ("Q", 0.2), ("friction_change", 0.0))} for k in range(1, 8)]  # fmt: skip
    parts = solve(T1, [*FIRST, *corners], nodes=61, arc=ARC)
    assert difference(whole[-1], parts[-1]) < 3e-13
    assert parts[-1].dissipation == pytest.approx(whole[-1].dissipation, rel=1e-9)


# Nodes, and the largest error of T by the number of increments.
INCREMENTS = [(31, {50: 2e-3, 400: 2e-4}), (61, {160: 3.3e-4, 640: 2.6e-5, 2560: 5e-6})]


@pytest.mark.parametrize(("nodes", "largest"), some_gate(INCREMENTS, INCREMENTS[1]))
def test_implicit_increments_tend_to_it_at_first_order(nodes: int, largest: dict[int, float]) -> None:
    system = System.build(T1, Grid.arc(*ARC, nodes), 1.0)
    start, exact = (configuration_after(system, corners) for corners in (FIRST, [*FIRST, LAST]))
    errors = []
    for count in largest:
        now = start
        for part in np.arange(1, count + 1) / count:
            load = start.load + part * (exact.load - start.load)
            found = implicit_step(system.under(load), now, load)
            assert found is not None
            now = found
        errors.append(float(np.abs(now.shear - exact.shear).max()))
    assert np.all(np.array(errors) < list(largest.values()))
    assert np.all(np.array(errors[:-1]) > 4.0 * np.array(errors[1:]))
    assert worst_residual(system.under(exact.load), exact) < 1e-13


@pytest.mark.parametrize("after", [{"P": 0.8, "Q": -0.1}, {"P": 1.2, "Q": 0.5}, {"P": 0.3, "Q": 0.1}])
def test_constant_friction_gives_the_states_of_the_usual_path(after: Corner) -> None:
    system = System.build(T1, Grid.arc(*ARC, 61), 1.0)
    start, end = (configuration_after(system, corners) for corners in (FIRST, [*FIRST, after]))
    found = DriftPath(system, start, end.load, system.friction).follow(1.0)
    usual = PathStep(system, start, end.load).follow(1.0)
    for name in ("pressure", "shear", "gap", "slip", "motion"):
        assert np.abs(getattr(found, name) - getattr(usual, name)).max() < 5e-13, name
    assert np.array_equal(found.status, usual.status)
    assert found.dissipation == pytest.approx(usual.dissipation, rel=1e-12)
    assert found.work == pytest.approx(usual.work, rel=1e-12)


def test_growing_friction_changes_nothing_and_all_nodes_stick() -> None:
    grown = solve(T1, [*FIRST, {"friction_change": 0.7}], nodes=61, arc=ARC)
    assert difference(grown[-2], grown[-1]) < 1e-12
    assert grown[-1].dissipation == grown[-2].dissipation
    assert np.all(grown[-1].status[grown[-1].pressure > 0.0] == STICK)


@pytest.mark.gate
def test_a_pin_that_friction_no_longer_holds_is_reported_where_it_is_lost() -> None:
    problem = Problem.from_load_parameter(UNLIKE, 0.1, 0.4)
    with pytest.raises(NoEquilibriumError, match=r"step 3, at 62\.\d+ % .*friction_change = -0\.56") as caught:
        solve(problem, [{"P": 1.0}, {"M": 0.2}, {"friction_change": -0.9}], nodes=61)
    error = caught.value
    assert error.result is not None
    assert len(error.result) == 2
    assert error.load["friction_change"] == pytest.approx(-0.9 * error.fraction, rel=1e-9)
    friction = 0.4 * (1.0 + error.load["friction_change"])
    assert friction / math.hypot(1.0, friction) < 0.2  # at a point it would have been lost before


@pytest.mark.gate
@pytest.mark.parametrize(("parameter", "corners"), [
    (0.1, [{"P": 1.0, "Q": 0.3, "friction_change": -0.5}, {"P": 0.0, "Q": 0.0, "friction_change": 0.2}, FIRST[0]]),
    (0.0, [{"P": 1.0, "Q": 0.3, "friction_change": -0.5}, {"Q": -0.3, "friction_change": 0.5}]),
    (-0.05, [{"P": 1.0, "Q": 0.3, "friction_change": -0.5}, {"P": 0.0, "Q": 0.0, "friction_change": 0.2}]),
])  # fmt: skip
def test_first_contacts_neat_fits_and_interference(parameter: float, corners: list[Corner]) -> None:
    problem = Problem.from_load_parameter(UNLIKE, parameter, 0.4, "centre", "fixed")
    result = solve(problem, corners, nodes=41, between=2)
    assert max(max(state.residuals.values()) for state in result) < 1e-12
    for state in result:
        bound = state.friction * state.pressure
        assert np.all(np.abs(state.shear) <= bound + 1e-12 * bound.max())
        slips = (np.abs(state.status) == 1) & (bound > 0.0)
        assert np.abs(state.shear)[slips] == pytest.approx(bound[slips], rel=1e-9)


def test_states_inside_a_step_have_the_friction_of_their_moment() -> None:
    states = t1(31, between=3)[-4:]
    assert [state.most_friction for state in states] == pytest.approx([0.425, 0.35, 0.275, 0.2], rel=1e-12)
    for state in states:
        assert state.friction == pytest.approx(state.most_friction, rel=1e-15)
        assert abs(state.peak_shear) <= state.most_friction * state.peak_pressure * (1.0 + 1e-12)


@pytest.mark.gate
def test_a_history_continues_inside_changes_with_the_same_bits() -> None:
    corners: list[Corner] = [*FIRST, LAST, {"Q": 0.15}, {"friction_change": 0.1, "Q": -0.1}]
    grid = Grid.arc(*ARC, 31)
    whole = solve(T1, corners, grid=grid)
    for cut in (2, 3, 4):
        first = solve(T1, corners[:cut], grid=grid)
        assert_same_bits(solve(T1, corners[cut:], start=first), whole[cut:])


@pytest.mark.gate
def test_cycles_of_friction_settle_and_repeat() -> None:
    cycle = LoadHistory([{"Q": 0.2, "friction_change": -0.3}, {"Q": -0.2, "friction_change": 0.0}]).repeated(300)
    problem = Problem.from_load_parameter(UNLIKE, 0.1, 0.4, "centre", "fixed")
    result = solve(problem, LoadHistory([{"P": 1.0}]) + cycle, nodes=21, keep="cycles")
    assert result.statistics["repeated"] > 400
    assert result.cycles[-1].pressure_change == 0.0


@pytest.mark.parametrize(("corners", "words"), [
    ([{"P": 1.0, "friction_change": -1.0}], "must be more than -1, which would leave no friction, not -1"),
    ([{"P": 1.0, "friction_change": -1.5}, {"friction_change": 3.0}], "must be more than -1"),
    ([{"P": 1.0, "friction_change": 1e7}], "1e+07 makes the coefficient of friction 5e+06; it must be at most 1e+06"),
])  # fmt: skip
def test_a_change_that_leaves_no_friction_or_too_much_is_refused(corners: list[Corner], words: str) -> None:
    error = refused(solve, T1, corners, nodes=31)
    assert error.field == "friction_change"
    assert words in str(error)


def test_a_change_without_friction_is_refused() -> None:
    smooth = Problem.from_load_parameter(UNLIKE, 0.1, 0.0)
    assert solve(smooth, [{"P": 1.0, "friction_change": 0.0}], nodes=31).complete
    with pytest.raises(InputError, match=r"friction_change: there is no friction that could change: friction = 0"):
        solve(smooth, [{"P": 1.0, "friction_change": 0.1}], nodes=31)


def test_case_files_give_a_change_and_name_a_wrong_one() -> None:
    text = '[contact]\nload_parameter = 0.1\nfriction = 0.5\n[pin]\nmaterial = "steel"\n[plate]\nmaterial = "steel"\n'
    case = parse_case(f"{text}[[load]]\nP = 1\n[[load]]\nfriction_change = [-0.4, 0.2]\nQ = 0.1\n")
    assert case.history.values()[:, FRICTION_CHANGE].tolist() == [0.0, -0.4, 0.2]
    with pytest.raises(InputError, match=r"friction_change: must be more than -1"):
        parse_case(f"{text}[[load]]\nP = 1\n[[load]]\nfriction_change = [-1.2, 2]\n")


def test_json_has_a_change_only_where_there_is_one(whole: Result) -> None:
    assert printed_loads(T1, whole[-1].load)["friction_change"] == -0.6
    assert "friction_change" not in printed_loads(T1, whole[0].load)


def test_the_rates_of_a_moment_are_its_derivatives() -> None:
    path = last_path()
    path.follow(0.4)
    before, here, after = (Moment(path, 0.4 + part, path.now.status, path.now.slip) for part in (-1e-4, 0.0, 1e-4))
    for values, rates in (("solution", "rates"), ("rates", "bends")):
        for name in ("pressure", "shear", "gap", "slip", "motion"):
            slope = (getattr(getattr(after, values), name) - getattr(getattr(before, values), name)) / 2e-4
            found = getattr(getattr(here, rates), name)
            assert np.abs(slope - found).max() < 1e-6 * np.abs(found).max(), (rates, name)


@pytest.mark.gate
def test_lemkes_method_lets_nodes_slip_where_their_limit_falls() -> None:
    system = System.build(T1, Grid.arc(*ARC, 31), 1.0)
    start = configuration_after(system, FIRST)
    at_limit = np.abs(start.status) == 1
    held, falling = (settle(system, start, np.zeros_like(start.load), rate * system.friction) for rate in (1.0, -1.0))
    assert held is not None
    assert falling is not None
    assert np.all(held[start.closed] == STICK)
    assert np.array_equal(falling[at_limit], start.status[at_limit])


def test_a_first_contact_has_the_friction_of_its_load() -> None:
    corners: list[Corner] = [{"friction_change": -0.8}, {"P": 1.0, "M": 0.3}]
    problem = Problem.from_load_parameter(UNLIKE, 0.1, 0.5)
    assert solve(problem, [{"P": 1.0, "M": 0.3}], nodes=31).complete
    with pytest.raises(NoEquilibriumError, match=r"more than friction can carry \(0\.0995\)"):
        solve(problem, corners, nodes=31)


@pytest.mark.gate
def test_a_neat_fit_is_followed_while_the_friction_changes() -> None:
    problem = Problem.from_load_parameter(UNLIKE, 0.0, 0.4, "centre", "fixed")
    whole = solve(problem, [{"P": 1.0, "Q": 0.3, "friction_change": -0.8}], grid=Grid.circle(61))
    parts = [{"P": k / 8, "Q": 0.3 * k / 8, "friction_change": -0.1 * k} for k in range(1, 9)]
    assert difference(whole[-1], solve(problem, parts, grid=Grid.circle(61))[-1]) < 1e-4
    assert whole.statistics["events"] > 5


@pytest.mark.gate
def test_energies_between_far_events_are_exact() -> None:
    problem = Problem.from_load_parameter(LIKE, 0.2, 0.6, "centre", "fixed")
    first, last = {"P": 1.0, "Q": 0.9}, {"P": 1.0, "Q": 1.2, "friction_change": 1.0}
    found = []
    for count in (1, 32):
        corners = [{name: first[name] + k / count * (last[name] - first[name]) for name in first} | {
            "friction_change": k / count} for k in range(1, count + 1)]  # fmt: skip
        found.append(solve(problem, [first, *corners], grid=Grid.circle(41))[-1])
    assert found[0].dissipation == pytest.approx(found[1].dissipation, rel=1e-9)
    assert found[0].work == pytest.approx(found[1].work, rel=1e-9)


@pytest.mark.gate
def test_a_stretch_is_halved_until_cubics_describe_it(monkeypatch: pytest.MonkeyPatch) -> None:
    counts = []
    for most in (1e-3, 1e-9):
        monkeypatch.setattr("fastpin.drift.path.MOST_BEND", most)
        path = last_path()
        path.follow(1.0)
        counts.append(path.rebuilds)
    assert counts[0] < 0.9 * counts[1]


def test_two_zeros_between_two_moments_are_noticed() -> None:
    def moment(time: float, value: float, rate: float) -> Moment:
        ones = np.ones((4, 1))
        parts = {"time": time, "functions": (value * ones, rate * ones), "sizes": (ones, ones)}
        return cast("Moment", SimpleNamespace(**parts))

    begin = moment(0.0, 0.1, -1.0)
    assert _dip(begin, moment(1.0, 0.1, 1.0), 0.0) == pytest.approx(0.5, abs=0.05)  # falls to -0.15
    assert _dip(begin, moment(0.1, 0.1, 1.0), 0.0) is None  # falls to 0.075
    assert _dip(begin, moment(0.1, 0.1, 1.0), 0.08) == pytest.approx(0.05, abs=0.01)  # a wide margin
    assert _dip(begin, moment(1.0, 0.1, -1.0), 0.0) is None  # it does not turn


def test_statuses_that_come_back_end_the_path_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    path = last_path()
    path.follow(0.4)
    moments = cycle([SimpleNamespace(status=np.full(31, status, dtype=np.int8)) for status in (SLIP_POSITIVE, STICK)])
    ends = np.ones((4, 31), dtype=bool)
    monkeypatch.setattr(path, "_stretch", lambda here, stop: (here, ends))
    monkeypatch.setattr(path, "_settled", lambda moment, broken: next(moments))
    before = path.events
    with pytest.raises(StepLostError) as lost:
        path.follow(1.0)
    assert (lost.value.code, lost.value.fraction) == (exchange.CYCLING, 0.4)
    assert path.events - before == 3


# -- sessions: any friction at the nodes, followed at constant load ----------------------------------------------------


@pytest.mark.gate
def test_a_session_follows_a_change_as_a_history_does() -> None:
    session = Session(T1, nodes=31, arc=ARC, slip_sums=True)
    session.advance(FIRST[0])
    before = session.advance(FIRST[1])
    followed = session.change(friction=0.2, replay="follow")
    assert followed is not None
    same = solve(T1, [*FIRST, {"friction_change": -0.6}], grid=session.grid, slip_sums=True)[-1]
    assert difference(followed, same) < 1e-13
    assert followed.dissipation == pytest.approx(same.dissipation, rel=1e-12)
    assert followed.friction_energy == pytest.approx(same.friction_energy, rel=1e-10, abs=1e-15)
    assert (followed.most_friction, followed.step) == (0.2, 2)
    onward = session.advance({"Q": -0.1})
    assert (
        difference(onward, solve(T1, [*FIRST, {"friction_change": -0.6}, {"Q": -0.1}], grid=session.grid)[-1]) < 1e-13
    )
    assert session.undo(2) is before
    assert session.problem.friction == 0.5
    again = session.change(friction=0.2, replay="follow")
    assert again is not None
    assert np.array_equal(again.shear, followed.shear)


def test_a_friction_from_the_accumulated_slip_is_followed_cycle_by_cycle() -> None:
    session = Session(T1, grid=Grid.circle(61), slip_sums=True)
    session.advance({"P": 1.0, "Q": 0.2})
    slip = np.zeros(61)
    for _ in range(3):
        for push in (-0.2, 0.2):
            state = session.advance({"Q": push})
            assert state.slip_distance is not None
            slip += state.slip_distance
        friction = 0.2 + 0.3 * np.exp(-slip / 0.02)
        followed = session.change(friction=(state.theta, friction), replay="follow")
        assert followed is not None
        assert followed.friction == pytest.approx(friction, rel=1e-12)
        assert max(followed.residuals.values()) < 1e-13


@pytest.mark.gate
def test_a_session_that_loses_the_pin_on_the_way_stays_where_it_was() -> None:
    session = Session(Problem.from_load_parameter(UNLIKE, 0.1, 0.5), nodes=41)
    before = session.advance({"P": 1.0, "M": 0.3})
    with pytest.raises(NoEquilibriumError, match=r"at 5\d\.\d+ % of the change of the friction: nothing holds"):
        session.change(friction=0.1, replay="follow")
    assert session.state is before
    assert session.problem.friction == 0.5
    assert session.advance({"M": 0.1}).step == 1


def test_only_friction_can_be_followed() -> None:
    session = Session(T1, nodes=31)
    session.advance(FIRST[0])
    for changes, words in [
        ({"friction": 0.0}, "friction: can't be followed to or from 0"),
        ({"friction": 0.2, "clearance": 0.2}, 'replay: "follow" is for a change of the friction alone'),
    ]:
        assert words in str(refused(session.change, replay="follow", **changes))
    session.change(friction=0.2, replay="follow")
    with pytest.raises(InputError, match=r"result: a change of the friction was followed"):
        session.result()
