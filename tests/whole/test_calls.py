"""Odd arguments of public names end in a value or in one sentence; scripts/calls.py makes forty thousand calls."""

from __future__ import annotations

import os
import time

import pytest

from scripts import calls


def findings(made: list[tuple[calls.Attempt, calls.Ending]]) -> list[str]:
    return [f"{attempt}: {ending.words}" for attempt, ending in made if ending.kind in ("raw", "slow")]


@pytest.fixture(scope="module")
def sample() -> list[tuple[calls.Attempt, calls.Ending]]:
    return list(calls.examine((), calls.sample))


def test_some_odd_arguments_give_one_sentence(sample):
    assert findings(sample) == []


def test_each_call_with_valid_arguments_is_accepted(sample):
    valid = [(attempt, ending) for attempt, ending in sample if not attempt.odd]
    assert len(valid) > 300
    assert [f"{attempt}: {ending.words}" for attempt, ending in valid if ending.kind != "accepted"] == []


def test_the_sample_has_each_parameter_of_each_public_callable(sample):
    targets = calls.public_targets()
    assert {"fastpin.solve", "fastpin.Session.advance", "fastpin.State.peak_pressure", "fastpin.damage.miner"} <= set(
        targets
    )
    tried = {(attempt.target, name) for attempt, _ in sample for name, _ in attempt.odd}
    assert tried == {(target.name, parameter.name) for target in targets.values() for parameter in target.parameters}


def test_a_raw_error_a_slow_call_and_a_crash_are_findings(monkeypatch):
    monkeypatch.setattr(calls, "LONGEST", 0.1)
    monkeypatch.setattr(calls, "LONGEST_WAIT", 2.0)

    def call(kind: str) -> None:
        if kind == "raw":
            raise AttributeError("shape")
        if kind == "slow":
            while True:
                pass
        if kind == "asleep":
            time.sleep(60.0)
        if kind == "crash":
            os._exit(3)

    kinds = ("raw", "slow", "asleep", "crash", "fine")
    target = calls.Target("fastpin.call", None, call, (calls.Parameter("kind", "str", False, True),))
    monkeypatch.setattr(calls, "public_targets", lambda: {target.name: target})
    monkeypatch.setitem(calls.odd_values.VALUES, "raw", lambda: "raw")
    monkeypatch.setitem(calls.odd_values.VALUES, "slow", lambda: "slow")
    monkeypatch.setitem(calls.odd_values.VALUES, "asleep", lambda: "asleep")
    monkeypatch.setitem(calls.odd_values.VALUES, "crash", lambda: "crash")
    monkeypatch.setitem(calls.odd_values.VALUES, "fine", lambda: "fine")
    todo = [calls.Attempt(target.name, (("kind", kind),)) for kind in kinds]
    made = list(calls.examine((), lambda *_: todo))
    assert [ending.kind for _, ending in made] == ["raw", "slow", "slow", "raw", "accepted"]
    assert made[0][1].words.startswith("AttributeError: shape")
    assert [ending.words for _, ending in made[1:3]] == [
        "no end within 0.1 s of the processor",
        "no end within 2 s",
    ]
    assert "exit code 3" in made[3][1].words


@pytest.mark.parametrize("seed", [1_000, 1_001])
def test_odd_arguments_give_one_sentence(seed):
    made = list(calls.examine((), lambda targets, values: calls.attempts(targets, values, 2_000, seed)))
    assert findings(made) == []
    assert len(made) == 2_000
