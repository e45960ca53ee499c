"""A session is led from load to load: the states of `solve` to the same bits, undo, changes, errors."""

import copy
import os
import pickle
import signal
import tracemalloc

import numpy as np
import pytest

import fastpin
from fastpin.bodies import Bushing, Ring
from fastpin.sessions.place import ROWS, Loads
from fastpin.solver.errors import ArcError
from fastpin.solver.run import Run
from fastpin.states.state import State
from fastpin.verification.joint_rows import BRONZE
from tests.support.programs import assert_same
from tests.support.refusals import refused
from tests.support.tiers import seeds

BOTTOM = -0.5 * np.pi
WALK = [
    {"P": 1.0}, {"Q": 0.2}, {"P": 1.05, "Q": 0.21}, {"Q": -0.15}, {"P": 0.4}, {"P": 0.0, "Q": 0.0}, {"P": -0.3},
    {"P": 0.9, "Q": 0.1},
]  # fmt: skip
"""Loading, small steps, reversal, complete unloading, a contact at the top, and back through it."""

DRIVEN = [{"ux": 0.05, "uy": -0.4}, {"ux": -0.04}, {"uy": -0.3, "sxy": 0.05}, {"uy": 0.0, "ux": 0.0}, {"uy": -0.2}]

CASES = {
    "friction": ({}, WALK),
    "frictionless": ({"friction": 0.0}, WALK),
    "remote stress": ({}, [{"sxx": 0.03}, {"P": 1.0, "sxy": 0.02}, {"sxx": -0.03, "Q": 0.1}, {"P": 0.5}]),
    "interference": ({"clearance": -0.1}, [{"P": 0.3}, {"Q": 0.2}, {"sxx": 0.05}, {"P": 2.0}, {"P": -1.0}]),
    "moment": ({}, [{"P": 1.0}, {"M": 0.1}, {"Q": 0.1, "M": -0.05}]),
    "spring": (
        {"rotation": "spring", "hub_stiffness": 2.0},
        [{"P": 1.0}, {"rotation": 0.02}, {"Q": 0.1}, {"rotation": -0.01}],
    ),
    "driven": ({"drive": "both", "rotation": "fixed"}, DRIVEN),
    "driven along y": ({"drive": "uy"}, [{"uy": -0.4}, {"Q": 0.1}, {"uy": -0.35}, {"Q": -0.1}]),
    "ring": ({"plate_body": Ring(2.0, "half")}, WALK[:5]),
    "bush": ({"plate_body": Bushing(BRONZE, 1.25)}, WALK[:5]),
}
"""Fields of a problem that differ from the usual ones, and loads."""


def problem_of(pair: fastpin.MaterialPair, **fields) -> fastpin.Problem:
    given = {"clearance": 0.1, "friction": 0.4, **fields}
    return fastpin.Problem.from_load_parameter(pair, given.pop("clearance"), **given)


@pytest.fixture(scope="module")
def problem(titanium_in_aluminium) -> fastpin.Problem:
    return problem_of(titanium_in_aluminium)


def assert_same_state(one: State, other: State) -> None:
    assert_same([one], [other])


def test_numpys_numbers_are_as_quick_as_pythons(problem, monkeypatch):
    """Loads that were seen before are not read as a history."""
    sessions = [fastpin.Session(problem, 41) for _ in range(2)]
    for session in sessions:
        session.advance({"P": 1.0, "Q": 0.1})
    monkeypatch.setattr("fastpin.sessions.session.check_loads", None)
    for session, kind in zip(sessions, (float, np.float64), strict=True):
        session.advance({"P": kind(1.01), "Q": kind(0.11)})
    assert_same_state(sessions[0].state, sessions[1].state)


def difference(one: State, two: State) -> float:
    """Largest difference of two states on one grid, in parts of the largest traction, gap or motion."""
    pressure, gap = two.pressure.max(), max(two.gap.max(), np.abs(two.slip).max())
    tractions = max(np.abs(getattr(one, name) - getattr(two, name)).max() for name in ("pressure", "shear"))
    lengths = max(np.abs(getattr(one, name) - getattr(two, name)).max() for name in ("gap", "slip"))
    moved = max(abs(getattr(one, name) - getattr(two, name)) for name in ("dx", "dy", "rotation"))
    return max(tractions / pressure, lengths / gap, moved / gap)


def walked(session: fastpin.Session, loads) -> list[State]:
    return [session.advance(load) for load in loads]


# --- The states of solve --------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", CASES)
def test_states_are_those_of_solve_to_the_last_bit(titanium_in_aluminium, name):
    fields, loads = CASES[name]
    problem = problem_of(titanium_in_aluminium, **fields)
    session = fastpin.Session(problem, 61, arc=(-1.5 * np.pi, 0.5 * np.pi), slip_sums=name == "friction")
    states = walked(session, loads)
    result = fastpin.solve(problem, loads, grid=session.grid, slip_sums=name == "friction")
    assert_same(states, result)
    assert all(one.grid is session.grid for one in states)
    assert np.array_equal(session.history.values(), fastpin.LoadHistory(loads).values())


def test_random_loads_on_a_found_arc(problem):
    for seed in seeds(2):
        rng = np.random.default_rng(seed)
        loads = [
            {"P": 1.0},
            *({"P": float(p), "Q": float(q)} for p, q in rng.uniform((0.2, -0.3), (1.2, 0.3), (12, 2))),
        ]
        session = fastpin.Session(problem, 81, expected=loads)
        states = walked(session, loads)
        assert all(one.grid is states[0].grid for one in states)
        assert_same(states, fastpin.solve(problem, loads, grid=session.grid))


def test_a_narrow_contact_begins_on_graded_nodes(titanium_in_aluminium):
    """Two places far apart, and narrow: no arc of these nodes resolves them."""
    loads = [{"P": 1.0}, {"P": 0.0}, {"Q": 1.0}]
    problem = problem_of(titanium_in_aluminium, clearance=3e4)
    session = fastpin.Session(problem, 101, expected=loads)
    states = walked(session, loads)
    assert not session.grid.uniform
    result = fastpin.solve(problem, loads, grid=session.grid)
    assert difference(states[-1], result[-1]) < 1e-9


def test_a_first_load_has_the_nodes_of_solve_but_for_the_spacing(problem):
    session = fastpin.Session(problem, 101)
    state = session.advance({"P": 1.0})
    other = fastpin.solve(problem, [{"P": 1.0}], nodes=101)[0]
    spacing = np.diff(other.theta)[0]
    assert np.abs(state.theta - other.theta).max() < spacing
    turn = 2.0 * np.pi / np.diff(state.theta)[0]
    assert turn == pytest.approx(round(turn), abs=1e-9)


# --- Growth ---------------------------------------------------------------------------------------------------

GROWING = {
    "pushed round": ({}, [{"P": 1.0}, *({"P": np.cos(a), "Q": np.sin(a)} for a in (0.8, 1.6, 2.4, 3.2, 4.0))]),
    "remote stress": ({}, [{"P": 0.3, "sxx": 0.01, "sxy": 0.005}, {"P": 2.0, "Q": 0.5}, {"Q": -0.7, "sxx": 0.0}]),
    "large clearance": ({"clearance": 50.0}, [{"P": 1.0}, {"P": 2.0, "Q": 0.1}, {"Q": -0.1}]),
    "driven": ({"drive": "both"}, [{"uy": -0.3}, {"ux": 0.1}, {"ux": 0.3, "uy": -0.35}, {"ux": -0.2}]),
    "ring": ({"plate_body": Ring(2.0, "half")}, [{"P": 0.5}, {"Q": 0.6}, {"P": 0.0, "Q": -0.5}]),
    # A neat fit without load touches all round, or nowhere: rounding decides. So it keeps a hundredth of its load.
    "neat fit": ({"clearance": 0.0}, [{"P": 1.0}, {"P": 0.01}, {"Q": 0.3, "P": 1.0}]),
}


@pytest.mark.parametrize("name", GROWING)
def test_a_grown_arc_has_the_states_of_solve_on_it(titanium_in_aluminium, name):
    fields, loads = GROWING[name]
    problem = problem_of(titanium_in_aluminium, **fields)
    session = fastpin.Session(problem, 61, slip_sums=True)
    states = walked(session, loads)
    first, last = states[0].grid, session.grid
    begin = int(np.argmin(np.abs(last.theta - first.theta[0])))
    assert last.size > first.size
    assert last.uniform
    assert np.array_equal(last.theta[begin : begin + first.size], first.theta)
    result = fastpin.solve(problem, loads, grid=last, slip_sums=True)
    assert difference(states[-1], result[-1]) < 1e-10  # 3e-12 was measured
    assert states[-1].work == pytest.approx(result[-1].work, rel=1e-10)
    assert states[-1].dissipation == pytest.approx(result[-1].dissipation, rel=1e-10)
    assert np.allclose(states[-1].slip_distance, result[-1].slip_distance, rtol=0.0, atol=1e-10)
    assert max(states[-1].residuals.values()) < 1e-12


def test_an_arc_grows_to_the_whole_circle(problem):
    session = fastpin.Session(problem, 61)
    walked(session, GROWING["pushed round"][1])
    assert session.grid.closed
    assert session.grid.uniform


def test_too_many_nodes_begin_a_new_arc(problem):
    """From a light load to a heavy one the contact grows by far more than 4 times: the states are those of `solve`."""
    loads = [{"P": 1e-4}, {"P": 1.0}, {"Q": 0.1}]
    session = fastpin.Session(problem, 41)
    states = walked(session, loads)
    assert session.grid.size <= 4 * 41
    assert session.grid.theta[0] < states[0].theta[0]
    result = fastpin.solve(problem, loads, grid=session.grid)
    assert_same(states[1:], result[1:])


def test_a_given_grid_grows_up_to_the_circle(problem):
    grid = fastpin.Grid.arc(BOTTOM - 1.5, BOTTOM + 1.5, 41)  # its spacing does not divide the circle
    session = fastpin.Session(problem, grid=grid)
    session.advance({"P": 1.0})
    assert session.grid is grid
    session.advance({"Q": 0.5})
    assert session.grid.size > 41
    with pytest.raises(
        ArcError, match=r"step 3, at .*the given grid can't grow that far: give Grid\.circle, or no grid"
    ):
        session.advance({"P": -1.0, "Q": 0.5})
    assert session.state.load["Q"] == 0.5
    loads = [{"P": 1.0}, {"Q": 0.5}, {"Q": 0.4}]
    assert difference(session.advance(loads[-1]), fastpin.solve(problem, loads, grid=session.grid)[-1]) < 1e-10


def test_a_pin_beyond_a_given_arc_is_an_error(titanium_in_aluminium):
    problem = problem_of(titanium_in_aluminium, clearance=0.05)
    session = fastpin.Session(problem, grid=fastpin.Grid.arc(BOTTOM - 0.6, BOTTOM + 0.6, 41))
    walked(session, [{"P": 0.05}, {"Q": 0.001}])
    with pytest.raises(ArcError, match="step 3: the pin touches the hole beyond the arc; the given grid") as raised:
        session.advance({"syy": -0.2, "sxx": 0.1})
    assert (raised.value.step, raised.value.fraction, raised.value.load["syy"]) == (2, 1.0, -0.2)
    loads = [{"P": 0.05}, {"Q": 0.001}, {"P": 0.06}]
    assert_same_state(session.advance(loads[-1]), fastpin.solve(problem, loads, grid=session.grid)[-1])


def test_a_pin_that_touches_beyond_the_arc_is_noticed(titanium_in_aluminium):
    """The remote stress presses the top of the hole on the pin, which rests at the bottom."""
    problem = problem_of(titanium_in_aluminium, clearance=0.05)
    loads = [{"P": 0.05}, {"syy": -0.2, "sxx": 0.1}]
    session = fastpin.Session(problem, 81)
    states = walked(session, loads)
    assert not states[0].grid.closed
    assert states[1].grid.closed
    result = fastpin.solve(problem, loads, grid=session.grid)
    assert difference(states[1], result[1]) < 1e-10
    assert len(states[1].contact) == 2
    again = fastpin.Session(problem, 81)
    again.advance(loads[0])
    again.change(replay="none", friction=0.2)
    walked(again, loads)
    assert again.change(friction=0.4).grid.closed
    assert difference(again.state, result[1]) < 1e-10


# --- Undo, copies, changes ------------------------------------------------------------------------------------


def test_undo_and_redo_go_through_the_places(problem):
    session = fastpin.Session(problem, 61)
    states = walked(session, WALK[:4])
    grids = [state.grid for state in states]
    assert (session.undos, session.redos) == (4, 0)
    assert session.undo() is states[2]
    assert session.undo(2) is states[0]
    assert session.grid is grids[0]
    assert session.redo(2) is states[2]
    other = session.advance({"Q": 0.0})
    assert session.redos == 0
    assert len(session.history) == 4
    assert_same_state(fastpin.Session.advance(session.copy(), {"Q": 0.1}), session.advance({"Q": 0.1}))
    assert session.undo() is other
    assert_same_state(session.undo(), states[2])
    assert_same_state(session.advance(WALK[3]), states[3])
    assert session.undo(4) is None
    assert session.history is None
    assert_same_state(session.advance(WALK[0]), states[0])


@pytest.mark.parametrize("name", ["undo", "redo"])
def test_what_is_not_remembered_is_refused(problem, name):
    session = fastpin.Session(problem, 41, undo=2)
    walked(session, WALK[:4])
    assert session.undos == 2
    with pytest.raises(fastpin.InputError, match=r"times: only \d .* not 3"):
        getattr(session, name)(3)
    with pytest.raises(fastpin.InputError, match="times: must be a whole number of at least 1, not 0"):
        getattr(session, name)(0)


def test_copies_go_on_by_themselves(problem):
    session = fastpin.Session(problem, 41)
    walked(session, WALK[:2])
    others = [session.copy(), copy.copy(session), copy.deepcopy(session), pickle.loads(pickle.dumps(session))]
    for other in others:
        other.advance({"Q": -0.1})
        assert len(session.history) == 2
    state = session.advance(WALK[2])
    for other in others:
        other.undo()
        assert_same_state(other.advance(WALK[2]), state)
        assert np.array_equal(other.history.values(), session.history.values())
        assert other.undos == 3


def test_reset_keeps_problem_and_nodes(problem):
    session = fastpin.Session(problem, 41)
    state = session.advance(WALK[0])
    session.advance(WALK[1])
    grid = session.grid
    session.reset()
    assert (session.state, session.history, session.grid, session.undos) == (None, None, grid, 0)
    if grid is state.grid:
        assert_same_state(session.advance(WALK[0]), state)


CHANGES = [
    {"friction": 0.2},
    {"clearance": 0.3},
    {"friction": 0.0},
    {"rotation": "fixed"},
    {"pair": fastpin.MaterialPair(fastpin.MATERIALS["steel"], fastpin.MATERIALS["aluminium"])},
    {"plate_body": Ring(3.0, "normal")},
]


@pytest.mark.parametrize("change", CHANGES, ids=lambda change: next(iter(change)))
def test_a_change_follows_the_same_loads_again(problem, change):
    loads = WALK[:5]
    grid = fastpin.Grid.circle(61)
    session = fastpin.Session(problem, grid=grid)
    states = walked(session, loads)
    state = session.change(**change)
    result = fastpin.solve(session.problem, loads, grid=grid)
    assert_same_state(state, result[-1])
    name, value = next(iter(change.items()))
    if name == "pair":
        pair = session.problem.pair
        assert pair.beta_star == pytest.approx(1.0)
        assert pytest.approx(pair.plate.E * 210.0 / 69.0) == pair.pin.E
    else:
        assert getattr(session.problem, name) == value
    assert np.array_equal(session.grid.theta, grid.theta)
    assert_same_state(session.advance({"P": 1.1}), fastpin.solve(session.problem, session.history, grid=grid)[-1])
    assert session.undo(2) is states[-1]
    assert session.problem is problem
    assert_same_state(session.advance(WALK[5]), fastpin.solve(problem, WALK[:6], grid=grid)[-1])


def test_friction_and_clearance_need_no_new_matrices(problem, monkeypatch):
    session = fastpin.Session(problem, 41, arc=(-1.5 * np.pi, 0.5 * np.pi))
    walked(session, WALK[:3])
    monkeypatch.setattr("fastpin.sessions.session.build_system", None)
    session.change(friction=0.1)
    session.change(clearance=0.02, friction=0.3)
    with pytest.raises(TypeError):
        session.change(rotation="fixed")


def test_a_change_can_go_straight_to_the_load_or_to_none(problem):
    session = fastpin.Session(problem, 61)
    walked(session, WALK[:4])
    state = session.change(friction=0.3, replay="load")
    assert len(session.history) == 1
    assert state.load == {**dict.fromkeys(state.load, 0.0), "P": 1.05, "Q": -0.15}
    assert_same_state(state, fastpin.solve(session.problem, [{"P": 1.05, "Q": -0.15}], grid=session.grid)[0])
    assert session.change(friction=0.2, replay="none") is None
    assert session.history is None
    assert session.undo() is state


def test_a_change_may_need_more_nodes_or_the_whole_circle(titanium_in_aluminium):
    problem = problem_of(titanium_in_aluminium, clearance=1.0)
    session = fastpin.Session(problem, 61)
    walked(session, WALK[:3])
    first = session.grid
    wider = session.change(clearance=0.05)
    assert session.grid.size > first.size
    assert difference(wider, fastpin.solve(session.problem, WALK[:3], grid=session.grid)[-1]) < 1e-10
    assert session.change(clearance=-0.02).grid.closed
    narrow = session.change(clearance=20.0, new_arc=True)
    assert narrow.theta[-1] - narrow.theta[0] < first.theta[-1] - first.theta[0]


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({}, "change: give at least one field of the problem"),
        ({"frction": 0.1}, "frction: is no field of a problem; there are pair"),
        ({"friction": -0.1}, "friction: must not be negative"),
        ({"hole_radius": 2.0}, "hole_radius: is the unit of a dimensionless problem"),
        ({"drive": "ux"}, 'Q: the force is a reaction where drive = "ux"; give ux'),
        ({"friction": 0.1, "replay": "all"}, 'replay: must be "history", "load", "none" or "follow"'),
    ],
)
def test_a_wrong_change_names_the_field(problem, change, sentence):
    session = fastpin.Session(problem, 41)
    state = walked(session, WALK[:2])[-1]
    assert str(refused(session.change, **change)).startswith(sentence)
    assert session.state is state
    assert session.problem is problem


# --- Errors ---------------------------------------------------------------------------------------------------


def test_after_a_lost_load_the_session_is_where_it_was(similar):
    problem = problem_of(similar, friction=0.1)
    session = fastpin.Session(problem, 61)
    state = walked(session, [{"P": 1.0}, {"Q": 0.05}])[-1]
    with pytest.raises(fastpin.NoEquilibriumError) as raised:
        session.advance({"M": 1.0})
    with pytest.raises(fastpin.NoEquilibriumError) as other:
        fastpin.solve(problem, [{"P": 1.0}, {"Q": 0.05}, {"M": 1.0}], grid=session.grid)
    for name in ("args", "step", "fraction", "load"):
        assert getattr(raised.value, name) == getattr(other.value, name)
    assert session.state is state
    assert len(session.history) == 2
    so_far = raised.value.result
    assert list(so_far) == [state]
    assert not so_far.complete
    ahead = session.advance({"M": 0.9 * raised.value.load["M"]})
    expected = fastpin.solve(problem, [{"M": 0.9 * raised.value.load["M"]}], start=so_far)[0]
    assert np.array_equal(expected.shear, ahead.shear)
    with pytest.raises(fastpin.NoEquilibriumError):
        session.change(friction=0.01)
    assert session.state is ahead
    assert session.problem is problem


def test_a_first_load_may_be_lost(similar):
    session = fastpin.Session(problem_of(similar), 41)
    with pytest.raises(fastpin.NoEquilibriumError) as raised:
        session.advance({"M": 1.0})
    assert raised.value.result is None
    assert session.state is None
    assert session.advance({"P": 1.0}).in_contact


@pytest.mark.parametrize(
    "loads",
    [
        {"P": np.nan}, {"P": "1"}, {"P": True}, {"R": 1.0}, {"rotation": 0.1}, {"ux": 0.1}, {"P": 1e300}, {1: 1.0},
        [("P", 1.0)], None, {"P": 1.0, "Q": np.inf},
    ],
)  # fmt: skip
def test_wrong_loads_get_the_sentence_of_solve(problem, loads):
    session = fastpin.Session(problem, 41)
    state = session.advance({"P": 1.0, "Q": 0.1})
    assert refused(session.advance, loads).args == refused(fastpin.solve, problem, [loads], nodes=41).args
    assert session.state is state


def test_loads_of_other_types_are_numbers_too(problem):
    session = fastpin.Session(problem, 41)
    one = session.advance({"P": 1, "Q": np.float64(0.1)})
    session.reset()
    assert_same_state(session.advance({"P": 1.0, "Q": 0.1}), one)


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        ({"nodes": 3}, "nodes: must be a whole number from 5 to 20000"),
        ({"undo": -1}, "undo: must be a whole number from 0 to 100000000"),
        ({"slip_sums": 1}, "slip_sums: must be true or false"),
        ({"grid": 5}, "grid: must be a Grid"),
        ({"arc": (0.0, 1.0), "grid": fastpin.Grid.circle(41)}, "arc: has no effect where a grid is given"),
        ({"expected": [{"rotation": 1.0}]}, "rotation: a rotation can be prescribed only"),
        ({"expected": 1}, "expected: must be a LoadHistory or a list of corners"),
    ],
)
def test_wrong_options_are_named(problem, options, sentence):
    assert str(refused(fastpin.Session, problem, **options)).startswith(sentence)


def test_an_interference_fit_needs_the_circle(problem):
    with pytest.raises(fastpin.InputError, match="grid: an interference fit"):
        fastpin.Session(problem_of(problem.pair, clearance=-0.1), grid=fastpin.Grid.arc(-3.0, 0.0, 41))
    with pytest.raises(fastpin.InputError, match="problem: must be a Problem"):
        fastpin.Session(1)


@pytest.mark.parametrize("when", ["in the step", "after it"])
def test_an_interrupt_leaves_a_whole_state(problem, monkeypatch, when):
    session = fastpin.Session(problem, grid=fastpin.Grid.circle(61))
    state = walked(session, WALK[:2])[-1]
    name = "report" if when == "in the step" else "_arrive"
    owner = Run if when == "in the step" else fastpin.Session
    original = getattr(owner, name)

    def stopping(self, *arguments):
        os.kill(os.getpid(), signal.SIGINT)
        return original(self, *arguments)

    with monkeypatch.context() as patched:
        patched.setattr(owner, name, stopping)
        with pytest.raises(fastpin.Interrupted) as raised:
            session.advance(WALK[2])
    assert raised.value.result[-1] is session.state
    if when == "in the step":
        assert session.state is state
        session.advance(WALK[2])
    assert_same_state(session.advance(WALK[3]), fastpin.solve(problem, WALK[:4], grid=session.grid)[3])


# --- Results, memory, short forms -----------------------------------------------------------------------------


def test_a_result_of_all_loads_can_be_saved(problem, tmp_path):
    session = fastpin.Session(problem, grid=fastpin.Grid.circle(61))
    with pytest.raises(fastpin.InputError, match="result: no load was followed yet"):
        session.result()
    states = walked(session, WALK[:3])
    result = session.result()
    assert len(result) == 3
    assert_same_state(result[-1], states[-1])
    result.save(tmp_path / "a.h5")
    stored = fastpin.load(tmp_path / "a.h5")
    assert np.array_equal(stored[-1].shear, result[-1].shear)
    ahead = fastpin.solve(problem, WALK[3:4], start=stored)[0]
    assert np.array_equal(ahead.shear, session.advance(WALK[3]).shear)
    assert len(session.result(keep="every 2")) == 2


@pytest.mark.gate
def test_memory_does_not_grow_with_a_bounded_undo(problem):
    session = fastpin.Session(problem, 21, arc=(-1.5 * np.pi, 0.5 * np.pi), undo=5)
    rng = np.random.default_rng(0)

    def go(count: int) -> int:
        for force in rng.uniform(0.9, 1.1, count):
            session.advance({"P": 1.0, "Q": 0.1 * float(force)})
        return tracemalloc.get_traced_memory()[0]

    tracemalloc.start()
    try:
        before, after = go(45), go(45)
    finally:
        tracemalloc.stop()
    # Before its blocks are full, a load takes 700 bytes; in the long run 72. A state and its contact take 7,000.
    assert (after - before) / 45 < 1500


def test_loads_share_their_blocks():
    rows = np.arange(9.0 * (2 * ROWS + 5)).reshape(-1, 9)
    loads, kept = Loads(), {}
    for k, row in enumerate(rows):
        loads = loads.with_load(row)
        kept[k + 1] = loads
    for count in (1, ROWS - 1, ROWS, ROWS + 1, 2 * ROWS + 5):
        assert np.array_equal(kept[count].rows(), rows[:count])
        other = kept[count].with_load(rows[0]).with_load(rows[1])
        assert np.array_equal(other.rows(), np.vstack([rows[:count], rows[:2]]))
        assert np.array_equal(pickle.loads(pickle.dumps(kept[count])).with_load(rows[1]).rows()[-1], rows[1])
    assert np.array_equal(loads.rows(), rows)


def test_the_short_form_says_where_the_session_is(problem):
    session = fastpin.Session(problem, 41)
    assert repr(session) == "<Session: 0 loads, now no load, no nodes yet, 0 undo, 0 redo>"
    session.advance({"P": 1.0})
    assert repr(session) == "<Session: 1 loads, now P = 1 F, 41 nodes, 1 undo, 0 redo>"
