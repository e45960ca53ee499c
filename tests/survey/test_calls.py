"""Odd arguments of public names end in a value or in one sentence."""

from __future__ import annotations

import pytest

from tests.support.tiers import seeds
from tests.survey import calls

pytestmark = pytest.mark.survey


def findings(made: list[tuple[calls.Attempt, calls.Ending]]) -> list[str]:
    """The findings, each in one of its calls."""
    found = {(one.target, end.words): f"{one}: {end.words}" for one, end in made if end.kind in ("raw", "slow")}
    return list(found.values())


@pytest.fixture(scope="module")
def sample() -> list[tuple[calls.Attempt, calls.Ending]]:
    return list(calls.examine(calls.sample))


def test_an_odd_value_of_each_parameter_gives_one_sentence(sample) -> None:
    assert findings(sample) == []


def test_each_call_with_valid_arguments_is_accepted(sample) -> None:
    valid = [(attempt, ending) for attempt, ending in sample if not attempt.odd]
    assert len(valid) > 300
    assert [f"{attempt}: {ending.words}" for attempt, ending in valid if ending.kind != "accepted"] == []


def test_the_sample_has_each_parameter_of_each_public_callable(sample) -> None:
    targets = calls.public_targets()
    known = {"fastpin.solve", "fastpin.Session.advance", "fastpin.State.peak_pressure", "fastpin.damage.miner"}
    assert known <= set(targets)
    tried = {(attempt.target, name) for attempt, _ in sample for name, _ in attempt.odd}
    assert tried == {(target.name, parameter.name) for target in targets.values() for parameter in target.parameters}


def test_odd_arguments_give_one_sentence() -> None:
    """Forty thousand calls, unless other seeds are chosen."""
    chosen = list(seeds(1))
    made = list(calls.examine(lambda *given: [one for seed in chosen for one in calls.attempts(*given, seed)]))
    assert findings(made) == []
    assert len(made) == calls.COUNT * len(chosen)
