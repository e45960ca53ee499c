"""A change of the package stays cheap: scripts/rooms.py counts in how many files a noun stands."""

import gc
from pathlib import Path

import pytest

from scripts.rooms import NUMBERS, Package, entered, number_of

ROOT = Path(__file__).resolve().parents[2]

MOST = {
    "files naming gauge_radius": 5,
    "files naming slip_sums": 10,
    "files naming Ring": 5,
    "isinstance of bodies outside bodies/": 0,
    "drive is None, or not": 0,
    "classes defined twice": 0,
    "small private functions used once": 45,
    "constants of modules": 1_272,
    "hidden imports": 0,
    "lines of code": 54_120,
    "lines of code of the core": 18_528,
    "files of the core": 135,
    "functions of the core": 1_975,
    "private functions of the core used once": 124,
    "classes of the core": 191,
    "constants of the core": 385,
    "places that say unknown key": 1,
}
"""The most that each number may be. A smaller number takes its place here."""

CALLS = {
    "files of wings that a solve imports": 0,
    "files of a warm solve": 49,
    "depth of a warm solve": 22,
    "files of a warm fastpin run": 87,
    "depth of a warm fastpin run": 26,
}
"""The most for the calls."""

FILES = {
    "model/shape.py": """
from dataclasses import dataclass

LEAST = MOST = 1.0
_FEW: int = 3

class Ring: ...

Line = dict[str, int]

def checked(body, drive):
    '''A docstring
    of two lines.'''
    # a comment
    if isinstance(body, (Ring, Disk)) or drive is not None:
        return _small()
    return _used() + _used()

def _small():
    return 1

def _used():
    return 2
""",
    "states/state.py": """
import importlib
from fastpin import states

class Ring: ...

def read(state, gauge_radius):
    importlib.import_module("fastpin.reading.peaks")
    importlib.import_module(f"fastpin.{state}").peak()
    return _long(state)

def _long(state):
    state = state + 1
    state = state + 2
    state = state + 3
    state = state + 4
    return state
""",
    "bodies/ring.py": "def fits(body):\n    return isinstance(body, Ring)\n",
}


@pytest.mark.gate
def test_no_number_grows():
    package = Package(ROOT)
    gc.disable()  # collecting garbage among its trees would take half of the time
    assert package.nodes
    gc.enable()
    assert {name: number for name, most in MOST.items() if (number := number_of(NUMBERS[name](package))) > most} == {}


def test_the_numbers_of_a_small_package(tmp_path):
    for name, text in FILES.items():
        path = tmp_path / "fastpin" / name
        path.parent.mkdir(parents=True)
        path.write_text(text, encoding="utf-8")
    (tmp_path / "tests/survey").mkdir(parents=True)
    for name in ("test_a.py", "survey/test_b.py"):
        (tmp_path / "tests" / name).write_text("# a test\ndef test_it(): ...\n", encoding="utf-8")
    package = Package(tmp_path)
    expected = {
        "files naming gauge_radius": ["states/state.py"],
        "files naming slip_sums": [],
        "files naming Ring": ["bodies/ring.py", "model/shape.py", "states/state.py"],
        "isinstance of bodies outside bodies/": ["model/shape.py:15"],
        "drive is None, or not": ["model/shape.py:15"],
        "classes defined twice": ["Ring: model/shape.py, states/state.py"],
        "small private functions used once": ["model/shape.py:19 _small"],
        "constants of modules": ["model/shape.py: LEAST", "model/shape.py: MOST", "model/shape.py: _FEW"],
        "hidden imports": ["states/state.py:3", "states/state.py:8"],
        "functions of the core": [
            "bodies/ring.py:1 fits", "model/shape.py:11 checked", "model/shape.py:19 _small", "model/shape.py:22 _used",
            "states/state.py:7 read", "states/state.py:12 _long",
        ],
        "private functions of the core used once": ["model/shape.py:19 _small", "states/state.py:12 _long"],
        "mean lines of a body of the core": 2.3,
        "classes of the core": ["model/shape.py:7 Ring", "states/state.py:5 Ring"],
        "outer files": [],
        "lines of tests/ without survey": 2,
        "lines of tests/survey": 2,
        "functions of tests": 2,
    }  # fmt: skip
    assert {name: NUMBERS[name](package) for name in expected} == expected
    assert number_of(NUMBERS["lines of code of the core"](package)) == 13 + 13 + 2


@pytest.mark.gate
def test_few_files_are_entered():
    found = entered(ROOT)
    assert {name: found[name] for name, most in CALLS.items() if found[name] > most} == {}
