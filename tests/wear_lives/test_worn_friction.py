"""Lives of wear whose friction a function of the user changes after chosen cycles."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import fastpin
from fastpin import Grid, InputError, NoEquilibriumError
from fastpin.drift.friction import follow_friction, followed_problem
from fastpin.model.profile import profile_of_nodes
from fastpin.wear_lives import WearResult, WornCycle
from tests.support.refusals import refused
from tests.support.tiers import gate
from tests.support.wear_cases import WEAR_CASES, step, wearing

CASE = WEAR_CASES["partial slip"]
NODES = 41
CHOSEN = [1, 2, 4]


def life(rule: Any, cycles: int = 6, **others: Any) -> WearResult:
    given = {"coefficient": 1.0, "tolerance": 0.0, "at": CHOSEN, "grid": CASE.grid(NODES), **others}
    return fastpin.wear(CASE.problem, CASE.history(), cycles=cycles, friction=rule, **given)


def lessened(cycle: WornCycle) -> np.ndarray:
    """Friction that falls a little in the middle."""
    where = np.exp(-((cycle.theta + 0.5 * np.pi) ** 2) / 0.1)
    return 0.5 - 0.05 * (1 + cycle.cycle) * where


@pytest.mark.gate
def test_a_life_with_other_friction_is_that_of_its_pieces_one_by_one() -> None:
    """The same by a run that wears and follows its friction by hand."""
    found = life(lessened, coefficient=0.05)
    run, worn = wearing(CASE.problem, CASE.grid(NODES)), np.zeros(NODES)
    for loads in CASE.first:
        rubbed, _ = step(run, loads)
        worn = worn + run.wear(0.05 * rubbed).depth
    problem = CASE.problem
    for cycle in range(6):
        if cycle in (0, *CHOSEN):
            theta = run.system.grid.theta
            friction = lessened(replace(found[0], cycle=cycle))
            problem = followed_problem(problem, profile_of_nodes(CASE.grid(NODES), friction))
            run = follow_friction(run, problem)
            assert run.system.friction == pytest.approx(friction, rel=1e-14)
            assert theta.size == NODES
        for loads in CASE.cycle:
            rubbed, _ = step(run, loads)
            worn = worn + run.wear(0.05 * rubbed).depth
    assert np.abs(found[-1].gap_growth - worn).max() < 1e-13 * worn.max()
    assert np.abs(found[-1].pressure - run.now.pressure).max() < 1e-11


@pytest.mark.gate
def test_states_have_the_friction_of_their_cycles() -> None:
    asked: list[int] = []

    def rule(cycle: WornCycle) -> np.ndarray:
        asked.append(cycle.cycle)
        assert np.allclose(cycle.states[0].friction, 0.5 if cycle.cycle == 0 else before[-1])
        before.append(lessened(cycle))
        return before[-1]

    before: list[np.ndarray] = []
    found = life(rule)
    assert asked == [0, 1, 2, 4]
    assert found[-1].states[0].friction == pytest.approx(before[-1], rel=1e-12)
    for cycle in found:
        for state in cycle.states:
            assert max(state.residuals.values()) < 1e-12
    unchanged = life(None)
    assert found[0].states[1].pressure.tolist() == unchanged[0].states[1].pressure.tolist()
    assert np.abs(found[-1].gap_growth - unchanged[-1].gap_growth).max() > 1e-3 * unchanged[-1].depth


@pytest.mark.gate
def test_nothing_changes_where_the_rule_says_so() -> None:
    one, other = life(lambda cycle: None, tolerance=0.02, cycles=40), life(None, tolerance=0.02, cycles=40)
    assert np.array_equal(one[-1].gap_growth, other[-1].gap_growth)


def test_slip_that_adds_up_raises_friction_where_the_contact_slips() -> None:
    total = np.zeros(NODES)
    last = 0

    def rule(cycle: WornCycle) -> np.ndarray:
        nonlocal total, last
        rubbed = sum(state.slip_distance for state in cycle.states[1:] if state.slip_distance is not None)
        total, last = total + (cycle.cycle - last) * rubbed, cycle.cycle
        return 0.8 - 0.3 * np.exp(-total / 0.05)

    found = life(rule, cycles=200, coefficient=1e-3, at=[10, 30, 100], tolerance=0.02)
    friction, pressure = found[-1].states[0].friction, found[-1].pressure
    slipped = (total > 0.1) & (pressure > 0.0)
    assert slipped.any()
    assert friction[slipped].min() > 0.7
    assert friction[total == 0.0] == pytest.approx(0.5)
    assert found[-1].energy_per_cycle < 0.7 * found[0].energy_per_cycle


@pytest.mark.parametrize("law", [*gate("archard"), "energy"])
def test_a_pin_that_loses_contact_keeps_its_worn_gap_and_its_friction(law: str) -> None:
    case = WEAR_CASES["unlike"]
    problem = replace(case.problem, friction=0.3)
    cycle = fastpin.LoadHistory([{"P": -1.0, "Q": 0.1}, {"P": 1.0, "Q": 0.1}]).repeated(1)
    history = fastpin.LoadHistory([{"P": 1.0}]) + cycle
    given: dict[str, Any] = {"coefficient": 0.2, "tolerance": 0.0, "law": law, "grid": Grid.circle(80, -0.5 * np.pi)}
    one, other = (
        fastpin.wear(problem, history, cycles=6, at=[3], friction=rule, **given) for rule in (lambda _: 0.3, None)
    )
    assert one[1].gap_growth.max() > 0.0
    assert np.abs(one[-1].gap_growth - other[-1].gap_growth).max() < 1e-9 * other[-1].depth


def test_wrong_friction_is_refused_in_one_sentence(tmp_path: Path) -> None:
    for rule, words in {
        (lambda cycle: -(cycle.theta**2)): "friction: must not be negative",
        (lambda cycle: 0.0): "friction: can't be followed to or from 0",
        (lambda cycle: np.ones(3)): "friction: must return an array of the shape (41,), not (3,)",
        (lambda: 0.3): "friction: must be a callable of 1 arguments",
        0.3: "friction: must be a callable, not 0.3",
    }.items():
        assert str(refused(life, rule)).startswith(words)
    with pytest.raises(InputError, match="friction: is a function of lives in memory"):
        life(lessened, output=tmp_path / "life.h5")


@pytest.mark.gate
def test_a_contact_that_is_lost_on_the_way_names_its_cycle() -> None:
    problem = fastpin.Problem.from_load_parameter(CASE.problem.pair, 0.1, 0.5)
    history = fastpin.LoadHistory([{"P": 1.0, "M": 0.3}]) + fastpin.LoadHistory([{"Q": 0.05}, {"Q": -0.05}]).repeated(1)
    with pytest.raises(NoEquilibriumError, match=r"cycle 2: at 5?\d\.\d+ % of the change of the friction") as caught:
        fastpin.wear(problem, history, cycles=4, coefficient=1e-3, at=[2], nodes=NODES,
                     friction=lambda cycle: 0.1 if cycle.cycle else None)  # fmt: skip
    assert caught.value.result is not None
    assert [each.cycle for each in caught.value.result] == [0, 2]
