"""A session of a joint is led from load to load: the states of `solve_joint` to the same bits, undo, errors."""

from __future__ import annotations

import copy
import os
import pickle
import signal
from collections.abc import Iterable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from fastpin import InputError, Interrupted, SolveError, State
from fastpin.bodies import Bushing
from fastpin.joints import Clamp, Joint, JointPin, JointState, solve_joint
from fastpin.joints.solving import JointRun
from fastpin.sessions import JointSession
from tests.support.laps import BETA, FORCE, SHEET, STEEL, through_both, with_cover
from tests.support.programs import assert_same
from tests.support.refusals import refused

UNIT = BETA * FORCE
PAIR = Joint(
    (SHEET,), tuple(JointPin(f"p{k}", 5.0 * k, STEEL, 1.0, ("sheet",), (0.1 + k) * UNIT, 0.3) for k in range(2))
)
WALK: list[dict[str, float]] = [
    {"p0.x": 0.3 * FORCE}, {"p1.x": 5.0 * FORCE, "sheet.sxx": 0.1 * FORCE}, {"p0.y": -0.2 * FORCE}, {"p0.x": 0.0},
    {"p1.x": -0.1 * FORCE},
]  # fmt: skip
"""The second load is far larger than the first one, and later loads let pins go."""


def pressed(joint: Joint) -> Joint:
    """The same with interference fits."""
    return replace(joint, pins=tuple(replace(pin, clearance=-0.1 * UNIT) for pin in joint.pins))


def bushed(joint: Joint) -> Joint:
    """The same with bushes that slip."""
    bush = Bushing(STEEL, 1.3, interference=0.2 * UNIT, friction=0.2, bonded=False)
    return replace(joint, pins=tuple(replace(pin, bush=bush) for pin in joint.pins))


def clamped(joint: Joint) -> Joint:
    """The same with clamped plates."""
    return replace(joint, pins=tuple(replace(pin, clamp=Clamp(2.0 * FORCE, 0.3)) for pin in joint.pins))


COVER = with_cover(through_both("p0", 0.0, 0.1), through_both("p1", 8.0, 0.1))
ON_COVER: list[dict[str, float]] = [{"sheet.sxx": 0.1 * FORCE}, {"sheet.sxx": 1.0 * FORCE}, {"p0.y": 0.1 * FORCE}]
CASES = {
    "pair": (PAIR, WALK),
    "pressed": (pressed(PAIR), WALK),
    "bushed": (bushed(PAIR), WALK[:3]),
}


def interfaces(state: JointState) -> list[State]:
    """All contacts. The work of a joint is not known: NaN, which is not equal to itself."""
    found = [each for contact in state.contacts for each in (contact, contact.seat) if each is not None]
    return [replace(each, work=0.0, energy=0.0) for each in found]


def assert_same_states(states: Iterable[JointState], others: Iterable[JointState]) -> None:
    """Two results have the same states, to the last bit."""
    for one, other in zip(states, others, strict=True):
        assert (one.step, one.load) == (other.step, other.load)
        assert np.array_equal(one.forces, other.forces)
        assert np.array_equal(one.moved, other.moved)
        for mine, theirs in zip(one.faying, other.faying, strict=True):
            assert all(map(np.array_equal, mine, theirs))
        assert_same(interfaces(one), interfaces(other))


def walked(session: JointSession, loads: Iterable[dict[str, float]]) -> list[JointState]:
    return [session.advance(load) for load in loads]


# -- the states of solve_joint -----------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", CASES)
def test_states_are_those_of_solve_joint_to_the_last_bit(name: str) -> None:
    joint, loads = CASES[name]
    session = JointSession(joint, 16)
    states = walked(session, loads)
    assert_same_states(states, solve_joint(joint, loads, nodes=16))
    assert session.states == states
    assert session.history is not None
    assert_same_states(states[-1:], session.result()[-1:])


@pytest.mark.gate
def test_clamped_plates_have_the_bits_of_the_expected_loads() -> None:
    """The stiffness of surfaces that slip depends on the largest load."""
    joint = clamped(COVER)
    result = solve_joint(joint, ON_COVER, nodes=16, harmonics=6)
    assert_same_states(walked(JointSession(joint, 16, harmonics=6, expected=ON_COVER), ON_COVER), result)
    last = walked(JointSession(joint, 16, harmonics=6), ON_COVER)[-1]
    np.testing.assert_allclose(last.forces, result[-1].forces, rtol=0.0, atol=1e-4 * FORCE)


def test_a_load_that_is_rounding_is_none() -> None:
    session = JointSession(PAIR, 16)
    walked(session, [{"p0.x": FORCE}, {"p0.x": 1e-13 * FORCE}])
    assert session.history == [dict(zip(PAIR.load_names, (0.0, 0.0, 0.0, load, 0.0, 0.0, 0.0), strict=True))
                               for load in (FORCE, 0.0)]  # fmt: skip


# -- undo, copies ------------------------------------------------------------------------------------------------------


def test_undo_and_redo_go_through_the_places() -> None:
    session = JointSession(PAIR, 16)
    states = walked(session, WALK[:3])
    assert (session.undos, session.redos) == (3, 0)
    assert session.undo() is states[1]
    assert session.undo() is states[0]
    assert session.redo() is states[1]
    assert session.states == states[:2]
    assert_same_states(walked(session, WALK[2:]), solve_joint(PAIR, WALK, nodes=16)[2:])
    assert session.redos == 0
    assert session.undo(5) is None
    assert (session.state, session.states, session.history) == (None, [], None)
    assert_same_states([session.advance(WALK[0])], states[:1])


@pytest.mark.parametrize("name", ["undo", "redo"])
def test_what_is_not_remembered_is_refused(name: str) -> None:
    session = JointSession(PAIR, 16, undo=2)
    walked(session, WALK[:3])
    assert session.undos == 2
    with pytest.raises(InputError, match=r"times: only \d .* not 3"):
        getattr(session, name)(3)


def test_copies_go_on_by_themselves() -> None:
    session = JointSession(PAIR, 16)
    walked(session, WALK[:2])
    others = [session.copy(), copy.copy(session), session.copy(matrices=False), pickle.loads(pickle.dumps(session))]
    for other in others:
        other.advance({"p0.x": 0.1 * FORCE})
        assert len(session.history or []) == 2
    state = session.advance(WALK[2])
    for other in others:
        other.undo()
        assert_same_states([other.advance(WALK[2])], [state])


def test_reset_begins_again() -> None:
    session = JointSession(PAIR, 16)
    states = walked(session, WALK[:2])
    session.reset()
    assert (session.state, session.history, session.undos) == (None, None, 0)
    assert_same_states(walked(session, WALK[:2]), states)


def test_a_result_has_all_states() -> None:
    session = JointSession(PAIR, 16, undo=0)
    with pytest.raises(InputError, match="result: no load was followed yet"):
        session.result()
    states = walked(session, WALK[:2])
    assert session.states == states[-1:]
    assert_same_states(session.result(), states)


# -- errors ------------------------------------------------------------------------------------------------------------


def bonded() -> Joint:
    """A pin in a bush whose press fit holds light loads only."""
    bush = Bushing(STEEL, 1.3, interference=0.1 * UNIT)
    return Joint((SHEET,), (JointPin("p0", 0.0, STEEL, 1.0, ("sheet",), 0.1 * UNIT, 0.3, bush=bush),))


def test_after_a_lost_load_the_session_is_where_it_was() -> None:
    joint = bonded()
    loads = [{"p0.x": 0.1 * FORCE}, {"p0.x": 60.0 * FORCE}]
    session = JointSession(joint, 16)
    state = session.advance(loads[0])
    with pytest.raises(SolveError) as raised:
        session.advance(loads[1])
    with pytest.raises(SolveError) as other:
        solve_joint(joint, loads, nodes=16)
    for name in ("args", "step", "fraction", "load"):
        assert getattr(raised.value, name) == getattr(other.value, name)
    assert session.states == [state]
    so_far: Any = raised.value.result
    assert (list(so_far), so_far.nodes) == ([state], 16)
    ahead = {"p0.y": 0.1 * FORCE}
    assert_same_states([session.advance(ahead)], solve_joint(joint, [loads[0], ahead], nodes=16)[1:])


def test_a_first_load_may_be_lost() -> None:
    joint = bonded()
    session = JointSession(joint, 16)
    with pytest.raises(SolveError) as raised:
        session.advance({"p0.x": 60.0 * FORCE})
    assert raised.value.result is None
    assert session.state is None
    assert session.advance({"p0.x": 0.1 * FORCE}).contacts[0].in_contact


@pytest.mark.parametrize(
    "loads", [{"p0.x": np.nan}, {"p0.x": "1"}, {"p0.x": 1e300}, {"p0.z": 1.0}, {1: 1.0}, [("p0.x", 1.0)], None]
)
def test_wrong_loads_get_the_sentence_of_solve_joint(loads: Any) -> None:
    session = JointSession(PAIR, 16)
    assert refused(session.advance, loads).args == refused(solve_joint, PAIR, [loads], nodes=16).args
    assert session.state is None


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        ({"nodes": 3}, "nodes: must be a whole number from 16 to 720, not 3"),
        ({"harmonics": 1}, "harmonics: must be a whole number from 2 to 48, not 1"),
        ({"undo": -1}, "undo: must be a whole number from 0 to 100000000"),
        ({"expected": [{"p0.z": 1.0}]}, 'corner 1: must be "sheet.sxx"'),
        ({"expected": 1}, "expected: must be a list of corners"),
        ({"joint": 1}, "joint: must be a Joint"),
    ],
)
def test_wrong_options_are_named(options: dict[str, Any], sentence: str) -> None:
    assert str(refused(JointSession, **{"joint": PAIR, **options})).startswith(sentence)


@pytest.mark.parametrize("when", ["in the step", "after it"])
def test_an_interrupt_leaves_a_whole_state(monkeypatch: pytest.MonkeyPatch, when: str) -> None:
    session = JointSession(PAIR, 16)
    state = walked(session, WALK[:2])[-1]
    owner, name = (JointRun, "step_to") if when == "in the step" else (JointSession, "_leave_for")
    original = getattr(owner, name)

    def stopping(self: Any, *arguments: Any) -> Any:
        os.kill(os.getpid(), signal.SIGINT)
        for report in arguments[1:]:
            report(0.0)
        return original(self, *arguments)

    with monkeypatch.context() as patched:
        patched.setattr(owner, name, stopping)
        with pytest.raises(Interrupted) as raised:
            session.advance(WALK[2])
    assert raised.value.result is not None
    assert raised.value.result[-1] is session.state
    if when == "in the step":
        assert session.state is state
        session.advance(WALK[2])
    assert_same_states(walked(session, WALK[3:]), solve_joint(PAIR, WALK, nodes=16)[3:])


def test_the_short_form_says_where_the_session_is() -> None:
    session = JointSession(PAIR, 16)
    assert repr(session) == "<JointSession: 0 loads, now no load, 16 nodes a contact, 0 undo, 0 redo>"
    session.advance({"p0.x": FORCE})
    assert repr(session) == "<JointSession: 1 loads, now p0.x 1e+06, 16 nodes a contact, 1 undo, 0 redo>"
