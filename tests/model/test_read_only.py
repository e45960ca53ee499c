"""Records that can't be changed: their arrays and dicts are read-only, also in copies."""

import copy
import json
import pickle
from collections.abc import Callable, Mapping
from dataclasses import fields, is_dataclass, replace
from typing import Any

import numpy as np
import pytest

import fastpin
from fastpin.model import Points
from fastpin.model.read_only import ReadOnlyDict
from tests.support import lugs, samples

COPIES: dict[str, Callable[[Any], Any]] = {
    "itself": lambda value: value,
    "copy": copy.copy,
    "deep copy": copy.deepcopy,
    "pickle": lambda value: pickle.loads(pickle.dumps(value)),
}


@pytest.fixture(scope="module")
def records() -> dict[str, Any]:
    pair = fastpin.MaterialPair(fastpin.MATERIALS["2024-T3"], fastpin.MATERIALS["2024-T3"])
    problem = fastpin.Problem.from_load_parameter(pair, 0.1, 0.4)
    history = fastpin.LoadHistory([{"P": 1.0}]) + fastpin.LoadHistory([{"Q": 0.2}, {"Q": -0.2}]).repeated(2)
    result = fastpin.solve(problem, history, nodes=31, slip_sums=True)
    return {
        "state": result[-1],
        "restart": result.restart,
        "loop": result.cycle().loops["Q"],
        "fatigue": result.fatigue("smith-watson-topper"),
        "points": Points.at_depth([0.0, 0.1], -1.5),
        "own state": samples.sample_result()[0],
        "lug": lugs.plate(),
    }


NAMES = ("state", "restart", "loop", "fatigue", "points", "own state", "lug")


@pytest.mark.parametrize("way", COPIES)
@pytest.mark.parametrize("name", NAMES)
def test_no_array_and_no_dict_of_a_record_can_be_changed(records, name, way):
    record = COPIES[way](records[name])
    assert is_dataclass(record)
    values = {field.name: getattr(record, field.name) for field in fields(record)}
    arrays = [value for value in values.values() if isinstance(value, np.ndarray)]
    tables = [value for value in values.values() if isinstance(value, Mapping) and not hasattr(value, "coarse")]
    assert arrays or tables
    for array in arrays:
        assert not array.flags.writeable
    for table in tables:
        before = dict(table)
        with pytest.raises(TypeError):
            table["P"] = 7.0  # type: ignore[index]
        assert table == before
    for key, value in values.items():
        if isinstance(value, Mapping):
            assert list(value) == list(getattr(records[name], key))


CHANGES: dict[str, Callable[[Any], Any]] = {
    "set": lambda table: table.__setitem__("a", 2.0),
    "delete": lambda table: table.__delitem__("a"),
    "update": lambda table: table.update(a=2.0),
    "|=": lambda table: table.__ior__({"a": 2.0}),
    "setdefault": lambda table: table.setdefault("b", 2.0),
    "pop": lambda table: table.pop("a"),
    "popitem": lambda table: table.popitem(),
    "clear": lambda table: table.clear(),
}


@pytest.mark.parametrize("way", CHANGES)
def test_a_read_only_dict_refuses_each_change(way):
    table = ReadOnlyDict({"a": 1.0})
    with pytest.raises(TypeError, match="read-only"):
        CHANGES[way](table)
    assert table == {"a": 1.0}


def test_a_read_only_dict_is_a_dict_for_its_readers():
    table = ReadOnlyDict({"a": 1.0})
    assert json.dumps(table) == '{"a": 1.0}'
    assert table | {"b": 2.0} == {"a": 1.0, "b": 2.0}
    mine = table.copy()
    mine["a"] = 2.0
    assert table == {"a": 1.0}
    assert type(pickle.loads(pickle.dumps(table))) is ReadOnlyDict


def test_the_owner_of_an_array_can_still_write_to_it():
    angles = np.array([-1.5, -1.0])
    Points.at_depth(0.0, angles)
    angles[0] = 0.0
    state = samples.sample_result()[0]
    pressure = state.pressure.copy()
    again = replace(state, pressure=pressure)
    pressure[0] = 5.0
    assert not again.pressure.flags.writeable
