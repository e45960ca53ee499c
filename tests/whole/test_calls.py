"""The calls of tests/survey/test_calls.py notice raw errors, slow calls and crashes."""

import os
import time
from functools import partial

import pytest

from tests.survey import calls


@pytest.mark.survey
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
    for kind in kinds:
        monkeypatch.setitem(calls.odd_values.VALUES, kind, partial(str, kind))
    todo = [calls.Attempt(target.name, (("kind", kind),)) for kind in kinds]
    made = list(calls.examine(lambda *_: todo))
    assert [ending.kind for _, ending in made] == ["raw", "slow", "slow", "raw", "accepted"]
    assert made[0][1].words.startswith("AttributeError: shape")
    assert [ending.words for _, ending in made[1:3]] == ["no end within 0.1 s of the processor", "no end within 2 s"]
    assert "exit code 3" in made[3][1].words
