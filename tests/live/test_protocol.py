"""Messages from the page are read, or refused with one sentence."""

from __future__ import annotations

import contextlib
import json

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fastpin.errors import InputError
from fastpin.live.protocol import FIELDS, Message, read_message
from tests.support.refusals import refused

LOAD = {"kind": "load", "id": 7, "loads": {"P": 1}, "gesture": 3}
LEAF = st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=8)
JSON = (
    LEAF
    | st.lists(LEAF, max_size=3)
    | st.dictionaries(st.text(max_size=8), LEAF | st.lists(LEAF, max_size=3), max_size=3)
)


def test_a_message_is_read() -> None:
    message = read_message(json.dumps(LOAD))
    assert message == Message("load", 7, {"loads": {"P": 1.0}, "gesture": 3})


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("", "message: is no JSON"),
        ("[" * 10_000, "message: is no JSON"),
        ("9" * 10_000, "message: is no JSON"),
        ("[1]", "message: must be an object, not [1]"),
        ("{}", 'kind: must be "hello", "load"'),
        ('{"kind": "load"}', "id: must be a whole number"),
        ('{"kind": "undo", "id": 1, "more": 2}', 'message: has an unknown field "more"'),
        ('{"kind": "undo", "id": -1}', "id: must be a whole number"),
        (json.dumps(LOAD | {"loads": {}}), "loads: must be an object with at least one entry"),
        (json.dumps(LOAD | {"loads": {"P": "1"}}), "P: must be a number"),
        (json.dumps(LOAD | {"loads": {"P": float("nan")}}), "P: must be a finite number"),
        (json.dumps({"kind": "keep", "id": 1, "on": 1}), "on: must be true or false"),
        (json.dumps({"kind": "nodes", "id": 1, "nodes": 10**6, "follow": "load", "gesture": 1}), "nodes: must be"),
        (json.dumps({"kind": "change", "id": 1, "changes": {"a": 1}, "follow": "x", "gesture": 1}), "follow: must be"),
    ],
)
def test_what_is_no_message_is_refused(text: str, sentence: str) -> None:
    assert str(refused(read_message, text)).startswith(sentence)


@pytest.mark.gate
@given(JSON, st.sampled_from([None, *FIELDS]))
def test_any_json_is_a_message_or_one_refusal(value: object, kind: str | None) -> None:
    if kind is not None and isinstance(value, dict):
        value = {"kind": kind, "id": 1, **value}
    with contextlib.suppress(InputError):  # no other error
        assert read_message(json.dumps(value)).kind in FIELDS
