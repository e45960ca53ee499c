"""Steps that begin with all closed nodes held: their tables against factorisations, and whole histories both ways."""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np
import pytest

from fastpin import Grid, Problem, SolveError, solve
from fastpin.elasticity.system import System
from fastpin.kernels import conditions, exchange
from fastpin.kernels import held as held_kernels
from fastpin.kernels.arrays import Contact
from fastpin.kernels.status import OPEN, STICK
from fastpin.model import LOADS
from fastpin.solver import held
from fastpin.solver.assembly import unloaded_configuration
from fastpin.solver.configuration import solve_statuses
from fastpin.solver.held import HeldColumns, held_table, known_table
from fastpin.solver.slip_tally import SlipTally
from fastpin.solver.tableau import Columns, TableauMemory
from fastpin.solver.unknowns import DenseUnknowns
from tests.support.bodies import HOLDS
from tests.support.kernels import python, run_as_python
from tests.support.programs import assert_same_bits
from tests.support.steps import as_with_many_nodes
from tests.support.tiers import gate, some_gate
from tests.survey.histories import generate

BOTTOM = -0.5 * np.pi
GRIDS = {
    "arc": Grid.arc(BOTTOM - 1.6, BOTTOM + 1.6, 61),
    "circle": Grid.circle(61),
    "graded": Grid.graded([(BOTTOM, 0.5), (0.4, 1.0)], 61),
}


def system_of(pair, case="plain", grid="arc"):
    options = {"rotation": "free", **HOLDS[case]}
    return System.build(Problem.from_load_parameter(pair, 0.1, 0.4, "centre", **options), GRIDS[grid], 1.0)


def zones(*runs, n=61):
    closed = np.zeros(n, dtype=bool)
    for first, last in runs:
        closed[first:last] = True
    return closed


def contact_of(closed, slipping=()):
    """A contact of sticking nodes, some of which slip. Its values do not matter."""
    n, rng = closed.size, np.random.default_rng(4)
    status = np.where(closed, STICK, OPEN).astype(np.int8)
    for node, sense in slipping:
        status[node] = sense
    shear = rng.normal(size=n) * closed
    zeros = [np.zeros(n) for _ in range(2)]
    return Contact(
        np.abs(rng.normal(size=n)) * closed, shear, *zeros, status, np.zeros(n, dtype=np.int8), np.zeros(n, dtype=bool),
        np.zeros(3), np.zeros(n), SlipTally.empty(n).sums,
    )  # fmt: skip


def rate():
    return np.array([{"P": 1.0, "Q": 0.3}.get(name, 0.0) for name in LOADS])


def begun(system, table, contact, memory):
    """The columns of a held contact whose step has begun, and has not left its start."""
    columns = HeldColumns(system, table, contact, np.zeros(len(LOADS)), rate(), np.zeros(contact.status.size), memory)
    displaced, forces = system.load_displacement(rate()), system.load_forces(rate())
    held_kernels.begin(table.matrix, table.stack, contact, system.friction, displaced, forces, columns.tableau)
    return columns


def response(columns, given, updates=0):
    """The product of the tableau and `given`, as the corrections of a held contact compute it."""
    values = np.empty_like(given)
    python(conditions._respond)(columns.tableau, updates, given, values)
    return values


CONTACTS = [zones((15, 45)), zones((10, 20), (30, 50)), zones((28, 32))]


@pytest.mark.parametrize("grid", some_gate(GRIDS, "arc"))
@pytest.mark.parametrize("case", some_gate(HOLDS, "plain", "driven"))
def test_a_held_contact_begins_with_the_tableau_of_a_factorisation(titanium_in_aluminium, case, grid):
    system = system_of(titanium_in_aluminium, case, grid)
    memory = TableauMemory(system)
    for closed in CONTACTS:
        table = held_table(system, closed)
        assert table is not None
        contact, other = contact_of(closed), contact_of(closed)
        columns = begun(system, table, contact, memory)
        expected = Columns(system, DenseUnknowns(system, other.status), other, rate(), TableauMemory(system))
        assert np.array_equal(contact.tie, other.tie)
        size = np.abs(expected.tableau.rates).max()
        assert np.abs(columns.tableau.rates - expected.tableau.rates).max() < 1e-11 * size
        given = np.random.default_rng(5).normal(size=125)
        found, wanted = response(columns, given), expected.response(given, 0)
        # the hats at the ends of an arc are halves, and their columns stand for whole ones: these nodes never close
        if not system.grid.closed:
            given[[0, 60, 61, 121]] = 0.0
            found, wanted = response(columns, given), expected.response(given, 0)
        assert np.abs(found - wanted).max() < 1e-11 * np.abs(wanted).max()


@pytest.mark.parametrize("way", ["compiled", "python"])
def test_columns_and_updates_of_a_held_contact_are_those_of_the_naive_way(titanium_in_aluminium, way, monkeypatch):
    if way == "python":
        run_as_python(exchange, monkeypatch)
    system = system_of(titanium_in_aluminium)
    closed = zones((15, 45))
    contact = contact_of(closed)
    columns = begun(system, held_table(system, closed), contact, TableauMemory(system))
    tableau = columns.tableau
    rng = np.random.default_rng(6)
    updates, units = 9, np.eye(125)
    tableau.left[:, :updates] = rng.normal(size=(125, updates))
    tableau.source[:updates], tableau.slot[:updates] = rng.integers(-1, 122, updates), rng.integers(-1, 122, updates)
    tableau.delta[:updates] = rng.normal(size=updates)
    naive = np.column_stack([response(columns, unit) for unit in units])
    for k in range(updates):
        row = np.zeros(125)
        if tableau.source[k] >= 0:
            row += naive[tableau.source[k]]
        if tableau.slot[k] >= 0:
            row[tableau.slot[k]] += tableau.delta[k]
        naive += np.outer(tableau.left[:, k], row)
    given = rng.normal(size=125)
    assert np.allclose(response(columns, given, updates), naive @ given, rtol=0.0, atol=1e-9 * np.abs(naive).max())
    if way == "python":  # inner kernels can be called as plain Python only
        for p in (20, 10, 61 + 20, 61 + 50):
            column = np.zeros(125)
            exchange._column(tableau, updates, p, column)
            assert np.allclose(column, naive[:, p], rtol=0.0, atol=1e-9 * np.abs(naive).max())


@pytest.mark.parametrize("way", [*gate("compiled"), "python"])
@pytest.mark.parametrize("grid", GRIDS)
def test_corrections_of_a_held_contact_are_those_of_whole_arrays(titanium_in_aluminium, way, grid, monkeypatch):
    """A solution that lacks some digits is corrected to all of them, and put on its bounds."""
    if way == "python":
        run_as_python(conditions, monkeypatch)
    system, closed = system_of(titanium_in_aluminium, grid=grid), zones((15, 45))
    now = unloaded_configuration(system)
    now.load, now.status[closed] = rate(), STICK
    exact = solve_statuses(system, now.status, now.slip, now.load, now.rest_gap)
    assert exact is not None
    rng, size = np.random.default_rng(7), np.abs(exact.pressure).max()
    now.pressure[:] = np.where(closed, exact.pressure + 1e-7 * size * rng.normal(size=61), 0.0)
    now.shear[:] = np.where(closed, exact.shear, 0.0)
    now.gap[:], now.motion[:] = np.where(closed, 0.0, exact.gap), exact.motion
    contact = contact_of(closed)._replace(**now.values._asdict())
    columns = begun(system, held_table(system, closed), contact, TableauMemory(system))
    wanted = Columns(system, DenseUnknowns(system, now.status), contact, rate(), TableauMemory(system)).correct(now)
    sides = system.load_displacement(now.load), system.load_forces(now.load), now.rest_gap
    settled = now.copy()
    for name in ("pressure", "shear", "gap", "slip", "status", "motion"):
        getattr(settled, name)[:] = 7
    operator = np.asfortranarray(np.asarray(system.operator))
    error, drift, *beyond = conditions.correct_held(
        columns.tableau, 0, operator, system.equations, contact, *sides, settled.values
    )
    assert error < 1e-14
    assert drift == pytest.approx(wanted.drift, rel=1e-6)
    assert drift > 1e-8
    assert np.array_equal(settled.status, contact.status)
    for name in ("pressure", "shear", "gap", "slip", "motion"):
        values, expected = getattr(settled, name), getattr(wanted.corrected, name)
        assert np.abs(values - expected).max() < 1e-12 * max(size, np.abs(expected).max())
    assert beyond == pytest.approx(wanted.beyond, abs=1e-12 * size)
    assert beyond[0] > 0.0  # some nodes are pulled


def test_nodes_that_hardly_hold_the_pin_have_no_table(titanium_in_aluminium):
    system = system_of(titanium_in_aluminium)
    assert held_table(system, zones()) is None
    assert known_table(system, zones((30, 31))) is None  # one node: the pin turns about it


def test_nodes_that_leave_a_motion_free_have_no_table(titanium_in_aluminium):
    """A motion that moves no node: the equations of the three motions have no inverse."""
    system = system_of(titanium_in_aluminium)
    assert held_table(replace(system, motion=system.motion * [1.0, 1.0, 0.0]), zones((15, 45))) is None


@pytest.mark.parametrize("kind", ["general", "fits", "remote", *gate("fixed"), "rough"])
def test_histories_have_the_states_of_the_way_by_factorisations(kind, monkeypatch):
    """Measured: the largest difference is 4e-11 of the largest pressure."""
    compared = 0
    for seed in range(40, 44):
        case = generate(kind, seed)
        options = {**case.options, "nodes": 61}
        found = solve_or_none(case, options)
        with monkeypatch.context() as patch:
            as_with_many_nodes(patch)
            expected = solve_or_none(case, options)
        assert (found is None) == (expected is None)
        if found is None or found.grid.size > held.FEW_NODES:
            continue
        for one, other in zip(found, expected, strict=True):
            peak = max(float(other.pressure.max()), 1e-300)
            assert np.abs(one.pressure - other.pressure).max() < 1e-9 * peak
            assert np.abs(one.shear - other.shear).max() < 1e-9 * peak
            compared += 1
    assert compared > 3


def solve_or_none(case, options):
    try:
        return solve(case.problem, case.history, **options)
    except SolveError:
        return None


HISTORY = [{"P": 1.0}, {"Q": 0.2}, {"Q": -0.2}, {"Q": 0.1}, {"P": 0.6}, {"Q": -0.1}]


def test_known_tables_leave_the_bits_of_a_history(titanium_in_aluminium, monkeypatch):
    problem = Problem.from_load_parameter(titanium_in_aluminium, 0.1, 0.4, "body")
    first = solve(problem, HISTORY, nodes=61)
    again = solve(problem, HISTORY, grid=first.grid)  # the system of the first run, with all its tables
    monkeypatch.setattr(held, "MOST_NUMBERS", 0)  # one table at a time
    last = solve(problem, HISTORY, grid=Grid(first.grid.theta.copy()))
    assert_same_bits(first, again)
    assert_same_bits(first, last)


def test_threads_share_the_tables_of_a_system(titanium_in_aluminium):
    problem = Problem.from_load_parameter(titanium_in_aluminium, 0.1, 0.4, "body")
    grid = solve(problem, HISTORY, nodes=61).grid
    alone = solve(problem, HISTORY, grid=grid)
    with ThreadPoolExecutor(4) as pool:
        results = list(pool.map(lambda _: solve(problem, HISTORY, grid=grid), range(8)))
    for result in results:
        assert np.array_equal(result[-1].shear, alone[-1].shear)
