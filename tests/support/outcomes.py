"""Outcomes for tests. Worker processes import the functions of this file."""

import os
from typing import Any

import fastpin
from fastpin.solver.result import Result
from fastpin.studies.outcome_tables import outcomes_from
from fastpin.studies.outcomes import pickled, values_in_worker

FILE = '''
"""A file of outcomes as a user writes it."""
from __future__ import annotations
from dataclasses import dataclass
from math import nan

@dataclass
class Largest:
    value: float

def largest_pressure(result):
    return Largest(max(state.peak_pressure for state in result)).value

largest_pressure.unit = "Pa"

def nothing(result):
    return nan

def broken(result):
    return _divided(result)

def _divided(result):
    return 1 / 0
'''
"""The error of ``broken`` is raised in its line 20."""

CYCLES = """
[grid]
solve.nodes = [41]
contact.friction = [0.3, 0.6]
load.2.repeat = [2]
"""
"""Two runs with two cycles each, three corners a cycle."""

TABLE = """
[outcomes]
shear = { quantity = "peak_shear", take = "largest magnitude" }
swing = { quantity = "rotation", take = "range", over = "cycle" }
loss = { cycle = "dissipation" }
"""


def last_work(result: Result) -> float:
    """The work at the end, J/m."""
    return result[-1].work


last_work.unit = "J/m"  # type: ignore[attr-defined]


def deadly(result: Result) -> float:
    """End the process."""
    os._exit(9)


def value(given: Any, result: Result) -> float | None:
    """The value of an outcome as a worker reads and reports it."""
    (outcome,) = outcomes_from({"it": given}).values()
    found = values_in_worker({"it": (outcome.definition, pickled(outcome))}, result)["it"]
    assert found.reason is None
    return found.value


def solved(problem: fastpin.Problem, **options: Any) -> Result:
    """Two cycles of a force, on 51 nodes."""
    history = fastpin.LoadHistory([{"P": 1.0}]) + fastpin.LoadHistory([{"Q": 0.2}, {"Q": -0.2}]).repeated(2)
    return fastpin.solve(problem, history, nodes=51, **options)
