"""The linear systems of given statuses, and their memory."""

import gc
import itertools
from dataclasses import replace

import numpy as np
import pytest

from fastpin import Grid, Problem, solve
from fastpin.elasticity.system import System
from fastpin.kernels.status import OPEN, STICK
from fastpin.solver import path, unknowns
from fastpin.solver.tableau import TableauMemory
from fastpin.solver.unknowns import DenseUnknowns, StickingRun
from tests.support.steps import as_with_many_nodes

BOTTOM = -0.5 * np.pi


@pytest.fixture
def system(titanium_in_aluminium):
    problem = Problem.from_load_parameter(titanium_in_aluminium, 0.1, 0.4, "body")
    return System.build(problem, Grid.arc(BOTTOM - 1.2, BOTTOM + 1.2, 41), 1.0)


def zones(*stuck: int) -> np.ndarray:
    status = np.full(41, OPEN, dtype=np.int8)
    status[12:30] = 1
    status[slice(*stuck)] = STICK
    return status


def test_the_same_statuses_have_the_same_unknowns(system, monkeypatch):
    monkeypatch.setattr(unknowns, "LEAST_NEIGHBOURS", 2)
    latest = TableauMemory(system)
    first = latest.solvable(system, zones(15, 25))
    assert isinstance(first, DenseUnknowns)
    run = latest.solvable(system, zones(12, 30))
    assert isinstance(run, StickingRun)
    assert latest.solvable(system, zones(15, 25)) is first
    assert latest.solvable(system, zones(12, 30)) is run
    assert latest.dense(replace(system, friction=0.5 * system.friction), zones(15, 25)) is not first
    changed = latest.dense(system, zones(14, 25))
    assert changed is not None
    assert changed.count == first.count + 1
    assert latest.dense(system, np.full(41, OPEN, dtype=np.int8)) is None


def test_a_mended_tableau_shares_its_factorisation(system, monkeypatch):
    """Whatever the drift, a configuration that is computed anew and its tableau need one factorisation."""
    made: list[bytes] = []
    build = DenseUnknowns.__init__

    def counted(self, system, status):
        if np.count_nonzero(status != OPEN) > 8:  # no trial of the first contact
            made.append(status.tobytes())
        build(self, system, status)

    as_with_many_nodes(monkeypatch)
    monkeypatch.setattr(path, "MOST_DRIFT", 0.0)
    monkeypatch.setattr(DenseUnknowns, "__init__", counted)
    result = solve(system.problem, [{"P": 1.0}, {"Q": 0.3}, {"Q": -0.3}], nodes=201, arc=(BOTTOM - 1.8, BOTTOM + 1.8))
    assert result.statistics["rebuilds"] > 4
    repeated = sum(one == two for one, two in itertools.pairwise(made))
    assert repeated == 0


def tableaus() -> set[int]:
    """The identities of all memories of tableaus that are alive."""
    return {id(one) for one in gc.get_objects() if type(one) is TableauMemory}  # not isinstance: it asks dead proxies


@pytest.mark.gate
def test_a_solved_history_leaves_no_tableau_behind(system):
    """Its memory is free at once, without a garbage collection."""
    solve(system.problem, [{"P": 1.0}], nodes=61, arc=(BOTTOM - 1.8, BOTTOM + 1.8))
    gc.collect()
    before = tableaus()  # an error that another test has raised may hold one
    gc.disable()
    try:
        solve(system.problem, [{"P": 1.0}], nodes=61, arc=(BOTTOM - 1.8, BOTTOM + 1.8))
        assert tableaus() <= before
    finally:
        gc.enable()
