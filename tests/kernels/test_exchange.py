"""The path solver's compiled core: against plain Python, and against a naive solver that factors at every event."""

import functools
import os
from dataclasses import replace

import numba
import numpy as np
import pytest

from fastpin import Grid, Problem, solve
from fastpin.elasticity.system import System
from fastpin.kernels import exchange
from fastpin.kernels.arrays import Contact, Tableau
from fastpin.kernels.exchange import CHUNK, WIDTH
from fastpin.kernels.status import OPEN, STICK
from fastpin.model import LOADS
from fastpin.model.loads import Q
from fastpin.solver import unknowns as solver_unknowns
from fastpin.solver.assembly import unloaded_configuration
from fastpin.solver.configuration import solve_statuses, worst_residual
from fastpin.solver.first_contact import first_contact
from fastpin.solver.path import PathStep
from fastpin.solver.slip_tally import SlipTally
from fastpin.solver.tableau import Columns, TableauMemory
from fastpin.solver.unknowns import DenseUnknowns
from tests.support import processes
from tests.support.kernels import in_python, python
from tests.support.steps import as_with_many_nodes
from tests.support.tiers import gate

KERNELS = exchange
BOTTOM = -0.5 * np.pi

CODES = "REACHED", "STALE", "REBUILD", "ALL_AT_ONCE", "NO_SUPPORT", "CYCLING", "ARC_END", "ENDLESS", "UNBONDED"
SLOTS = "UPDATES", "QUEUED", "NEXT", "ROUND", "EVENTS", "EXCHANGES", "NEEDED_COLUMN", "SETTLED"


@pytest.fixture
def kernel(way):
    """Kernels by name, compiled or as plain Python with all that they call."""
    return compiled_kernel if way == "compiled" else lambda name: getattr(exchange, name)


@functools.cache
def compiled_kernel(name):
    """An inner kernel can be called by compiled code only."""
    inner = getattr(exchange, name)
    return numba.njit(lambda *arguments: inner(*arguments))


@pytest.fixture(scope="module")
def system(titanium_in_aluminium):
    problem = Problem.from_load_parameter(titanium_in_aluminium, 0.1, 0.4, "body")
    return System.build(problem, Grid.arc(BOTTOM - 1.6, BOTTOM + 1.55, 41), 1.0)


def loads(**values):
    return np.array([values.get(name, 0.0) for name in LOADS])


def test_the_slipping_node_that_stops_first_holds_the_pin():
    """Only slipping nodes with friction can stop the motion, and only those that it drives backwards."""
    relief = python(exchange._relief)
    status = np.array([1, STICK, OPEN, 1, -1, 1, -1], dtype=np.int8)
    friction = np.array([0.3, 0.3, 0.3, 0.0, 0.3, 0.3, 0.3])
    motion = np.r_[np.zeros(7), -np.ones(7), 0.0]
    rates = np.r_[np.zeros(7), 0.1, 0.1, 0.1, 0.1, 0.1, 0.4, -0.3]
    assert relief(motion, status, friction, rates, 0, 1.0) == 5
    assert relief(motion, status, friction, rates, 5, 1.0) == 0
    assert relief(motion, status, friction, rates, 0, -1.0) == 4
    assert relief(motion, status, friction, rates, 4, -1.0) == 6
    assert relief(motion, status, 0.0 * friction, rates, 0, 1.0) == -1


# --- exchange steps -----------------------------------------------------------------------------------------


def empty_tableau(matrix, rates):
    rows, columns = matrix.shape
    room = 3 * CHUNK
    return Tableau(
        matrix=np.asfortranarray(matrix),
        fresh=np.zeros(-(-columns // WIDTH), dtype=np.int64),
        left=np.zeros((rows, room), order="F"),
        source=np.zeros(room, dtype=np.int64),
        slot=np.zeros(room, dtype=np.int64),
        delta=np.zeros(room),
        factors=np.zeros(4),
        rates=rates.copy(),
        order=np.zeros(0, dtype=np.int64),
        tied=np.zeros(0),
        drag=np.zeros(0),
        chunk=CHUNK,
        width=WIDTH,
    )


def dense(matrix, tableau, updates):
    """The whole matrix after so many updates, one after the other, naively."""
    matrix = matrix.copy()
    for k in range(updates):
        row = matrix[tableau.source[k]].copy() if tableau.source[k] >= 0 else np.zeros(matrix.shape[1])
        if tableau.slot[k] >= 0:
            row[tableau.slot[k]] += tableau.delta[k]
        matrix += np.outer(tableau.left[:, k], row)
    return matrix


@pytest.mark.gate
def test_exchange_solves_for_the_other_member_of_the_pair(kernel):
    rng = np.random.default_rng(1)
    m, n, p = 9, 6, 2
    matrix, rates = rng.normal(size=(m, n)), rng.normal(size=m)
    tableau = empty_tableau(matrix, rates)
    kernel("_column")(tableau, 0, p, tableau.left[:, 0])
    kernel("_exchange")(tableau, 0, p)
    new = dense(matrix, tableau, 1)

    # y = M z + r; the roles of y_p and z_p change.
    z = rng.normal(size=n)
    y = matrix @ z + rates
    swapped_z, swapped_y = z.copy(), y.copy()
    swapped_z[p], swapped_y[p] = y[p], z[p]
    assert np.allclose(new @ swapped_z + tableau.rates, swapped_y, atol=1e-12)


@pytest.mark.gate
def test_row_and_column_operations_and_columns_brought_up_to_date(kernel):
    rng = np.random.default_rng(2)
    matrix, rates = rng.normal(size=(7, 5)), rng.normal(size=7)
    tableau = empty_tableau(matrix, rates)
    kernel("_column")(tableau, 0, 1, tableau.left[:, 0])
    kernel("_exchange")(tableau, 0, 1)
    true = dense(matrix, tableau, 1)
    after = tableau.rates.copy()
    kernel("_add_row")(tableau, 1, 4, 1, 0.7)
    true[4] += 0.7 * true[1]
    after[4] += 0.7 * after[1]
    kernel("_add_column")(tableau, 2, 3, 0, -0.2)
    true[:, 3] -= 0.2 * true[:, 0]
    assert np.allclose(dense(matrix, tableau, 3), true, atol=1e-13)
    assert np.array_equal(tableau.rates, after)
    for p in range(5):
        column = np.zeros(7)
        kernel("_column")(tableau, 3, p, column)
        assert np.allclose(column, true[:, p], atol=1e-13)


def at_rest_on(system, status):
    """A contact with given statuses; its values do not matter."""
    n = status.size
    zeros = [np.zeros(n) for _ in range(4)]
    tie, touched = np.zeros(n, dtype=np.int8), np.zeros(n, dtype=bool)
    return Contact(*zeros, status.copy(), tie, touched, np.zeros(3), np.zeros(n), SlipTally.empty(n).sums)


def whole(columns):
    for slot in range(0, columns.tableau.matrix.shape[1], WIDTH):
        columns.refresh(slot, 0)
    return columns.tableau.matrix.copy()


def untied(matrix, contact, friction):
    """The tableau of T instead of tau = T + tie mu N, at nodes that do not slip."""
    n = contact.status.size
    matrix, coupling = matrix.copy(), contact.tie * friction
    stuck, gaping = contact.status == STICK, contact.status == OPEN
    matrix[n : 2 * n][stuck] -= coupling[stuck, None] * matrix[:n][stuck]
    matrix[:, :n][:, gaping] += coupling[gaping] * matrix[:, n:][:, gaping]
    return matrix


def zones(n=41):
    status = np.full(n, OPEN, dtype=np.int8)
    status[12:30] = STICK
    status[12:16], status[26:30] = 1, -1
    return status


@pytest.mark.parametrize("tied", gate(True, False), ids=["as foreseen", "otherwise"])
def test_every_change_of_status_gives_the_tableau_of_the_new_statuses(system, kernel, tied):
    rate, typical = loads(P=1.0, Q=0.3), float(np.median(np.diagonal(system.operator)))
    for node, new in ((20, 1), (20, -1), (13, 0), (30, -1), (30, 1), (12, OPEN)):
        contact = at_rest_on(system, zones())
        memory = TableauMemory(system)
        basis = memory.solvable(system, contact.status)
        columns = Columns(system, basis, contact, rate, memory)
        if (contact.tie[node] == new) != tied and new in (1, -1):
            continue
        matrix, tableau = whole(columns), columns.tableau
        updates, size = kernel("_change_status")(tableau, 0, contact, system.friction, typical, node, new)
        assert size > 1e-3
        assert contact.status[node] == new
        other = at_rest_on(system, contact.status)
        expected = Columns(
            system, TableauMemory(system).solvable(system, other.status), other, rate, TableauMemory(system)
        )
        found = untied(dense(matrix, tableau, updates), contact, 0.4)
        wanted = untied(whole(expected), other, 0.4)
        assert np.abs(found - wanted).max() < 1e-9 * np.abs(wanted).max()
        rates, others = tableau.rates, expected.tableau.rates
        shear = contact.status == STICK
        tie = (contact.tie - other.tie)[shear] * 0.4
        assert np.abs(rates[41:82][shear] - tie * rates[:41][shear] - others[41:82][shear]).max() < 1e-9
        kept = np.r_[np.ones(41, dtype=bool), ~shear, np.ones(3, dtype=bool)]
        assert np.abs((rates - others)[kept]).max() < 1e-9 * np.abs(others).max()


@pytest.mark.parametrize("largest", [1e-3, 1.0, 1e3])
def test_values_close_to_their_bounds_reach_them(system, largest):
    """Close means relative to the largest gap and the largest pressure: to 1e-13 and 1e-10."""
    status = np.array([OPEN, OPEN, OPEN, 1, 1, 1], dtype=np.int8)
    contact, rates = at_rest_on(system, status), np.zeros(15)
    contact.gap[:3] = largest * np.array([1.0, 0.5e-13, 2e-13])
    contact.pressure[3:] = largest * np.array([1.0, 0.5e-10, 2e-10])
    in_python(exchange)._advance(contact, rates, np.full(6, 0.3), np.ones(6), 0.0, 6)
    assert (contact.gap[:3] > 0.0).tolist() == [True, False, True]
    assert (contact.pressure[3:] > 0.0).tolist() == [True, False, True]


@pytest.mark.gate
@pytest.mark.parametrize("sets", [*gate("stuck"), "zones"])
def test_columns_by_chunks_are_those_one_by_one(system, sets, monkeypatch):
    """Hundreds of updates: products by chunks, single columns, the naive way, and products with the whole tableau."""
    monkeypatch.setattr(solver_unknowns, "LEAST_NEIGHBOURS", 2)
    status = zones()
    if sets == "stuck":
        status[status != OPEN] = STICK
    contact = at_rest_on(system, status)
    columns = Columns(
        system, TableauMemory(system).solvable(system, status), contact, loads(P=1.0, Q=0.3), TableauMemory(system)
    )
    matrix, tableau, updates = whole(columns), columns.tableau, 0
    change, fetch = compiled_kernel("_change_status"), compiled_kernel("_column")
    rng = np.random.default_rng(3)
    while updates < 2 * CHUNK + 10:
        node = int(rng.integers(14, 28))
        new = int(rng.choice([1, -1])) if contact.status[node] == STICK else STICK
        if new != STICK and np.count_nonzero(contact.status == STICK) < 4:
            continue
        updates, _ = change(tableau, updates, contact, system.friction, 0.1, node, new)
    expected = dense(matrix, tableau, updates)
    size = np.abs(expected).max()
    column = np.zeros(85)
    fetch(tableau, updates, 60, column)
    assert np.abs(column - expected[:, 60]).max() < 1e-10 * size
    columns.refresh(60, updates)
    assert tableau.fresh[60 // WIDTH] == 2 * CHUNK
    fetch(tableau, updates, 60, column)
    assert np.abs(column - expected[:, 60]).max() < 1e-10 * size

    given = np.r_[rng.normal(size=82), np.zeros(3)]
    given[[0, 40, 41, 81]] = 0.0  # the ends of an arc never close, and their columns stand for whole hats
    assert np.abs(columns.response(given, updates) - expected @ given[:82]).max() < 1e-9 * size
    contact.tie[contact.status == STICK] = 0  # compare T
    forces = np.r_[np.zeros(82), 1.0, -2.0, 0.5]
    unknowns = DenseUnknowns(system, contact.status)
    motion = unknowns.solve(np.r_[np.zeros(unknowns.count), forces[82:]])[-3:]
    assert np.abs(columns.response(forces, updates)[82:] - motion).max() < 1e-9 * np.abs(motion).max()


def test_a_tableau_that_has_drifted_is_built_anew(titanium_in_aluminium, monkeypatch):
    problem = Problem.from_load_parameter(titanium_in_aluminium, 0.1, 0.4, "body")
    system = System.build(problem, Grid.arc(BOTTOM - 1.6, BOTTOM + 1.55, 201), 1.0)
    first, _ = first_contact(system, unloaded_configuration(system), loads(), loads(P=1.0))
    expected = PathStep(system, first, loads(P=1.0)).follow(1.0)
    original = Columns.refresh

    def spoilt(self, asked, updates):
        original(self, asked, updates)
        if updates < CHUNK:
            self.tableau.matrix[50:150, asked] *= 1.0 + 1e-7

    monkeypatch.setattr(Columns, "refresh", spoilt)
    as_with_many_nodes(monkeypatch)
    step = PathStep(system, first, loads(P=1.0))
    found = step.follow(1.0)
    assert step.rebuilds > 0
    assert worst_residual(system, found) < 1e-12
    assert np.array_equal(found.status, expected.status)
    assert np.abs(found.pressure - expected.pressure).max() < 1e-6


# --- the whole event loop -----------------------------------------------------------------------------------


def naive_path(system, start, after):
    """Follow a step with one dense solve per change of status: the same rules, written with whole arrays.

    Returns the configuration at the end, with its work, and the number of events.
    """
    now, before, mu = start.copy(), start.load.copy(), system.friction
    rate, time, n = after - before, 0.0, system.grid.size

    def rates():
        solution = solve_statuses(system, now.status, np.zeros(n), rate, 0.0)
        assert solution is not None
        return solution

    def violators(r):
        slipping, stick = np.abs(now.status) == 1, now.status == STICK
        tol = 1e-10
        back = slipping & (now.status * r.slip < -tol)
        direction = np.where(mu * now.pressure > 0.0, np.sign(now.shear), np.sign(r.shear))
        at_bound = stick & (np.abs(now.shear) >= mu * now.pressure * (1.0 - 1e-12))
        away = at_bound & (direction * r.shear - mu * r.pressure > tol)
        new = now.status.copy()
        new[back], new[away] = STICK, -direction[away]
        if (back | away).any():
            return new
        closing = (now.status == OPEN) & (now.gap <= 1e-14) & (r.gap < -tol)
        new[closing] = np.where(r.slip[closing] < 0.0, -1, 1)
        if closing.any():
            return new
        opening = (now.status != OPEN) & (now.pressure <= 1e-14) & (r.pressure < -tol)
        new[opening] = OPEN
        return new if opening.any() else None

    def power(r, shear, time):
        """The work per unit of time: the loads act on the motion, and against the tractions that they free."""
        load = before + time * rate
        freed = np.tile(system.weights, 2) * system.held_displacement(load) @ np.r_[r.pressure, r.shear]
        return freed + system.load_forces(load)[:2] @ r.motion[:2] - system.weights @ shear * r.motion[2]

    for events in range(2000):
        r = rates()
        while (new := violators(r)) is not None:
            now.status = new
            r = rates()
        closed, stick = now.status != OPEN, now.status == STICK
        with np.errstate(divide="ignore", invalid="ignore"):
            steps = [
                np.where(~closed & (r.gap < -1e-10) & (now.gap > 1e-14), now.gap / -r.gap, np.inf),
                np.where(closed & (r.pressure < -1e-10) & (now.pressure > 1e-14), now.pressure / -r.pressure, np.inf),
            ]
            for side in (-1.0, 1.0):
                room, shrink = mu * now.pressure - side * now.shear, side * r.shear - mu * r.pressure
                inside = stick & (room > 1e-13) & (shrink > 1e-10)
                steps.append(np.where(inside, room / shrink, np.inf))
        step = min(np.min(steps), 1.0 - time)
        old, begin = now.shear.copy(), now.slip.copy()
        for name in ("pressure", "shear", "gap", "slip"):
            setattr(now, name, getattr(now, name) + step * getattr(r, name))
        slid = np.where(closed & ~stick, step * r.slip, 0.0)
        distance, energy, lowest, highest = now.slip_tally.sums
        ends = np.array([begin, now.slip]) - now.rest_slip
        lowest = np.where(closed, np.minimum(lowest, ends.min(axis=0)), lowest)
        highest = np.where(closed, np.maximum(highest, ends.max(axis=0)), highest)
        energy = energy - 0.5 * (old + now.shear) * slid
        now.slip_tally = SlipTally(np.array([distance + np.abs(slid), energy, lowest, highest]))
        now.work += step * power(r, now.shear - 0.5 * step * r.shear, time + 0.5 * step)
        now.gap[closed | (now.gap < 1e-15)] = 0.0
        now.pressure[~closed | (now.pressure < 1e-15)] = 0.0
        now.shear[now.pressure == 0.0] = 0.0
        time += step
        if time >= 1.0 - 1e-15:
            return now, events
    raise AssertionError("the naive solver did not end")


def test_path_agrees_with_the_naive_solver(system):
    first, _ = first_contact(system, unloaded_configuration(system), loads(), loads(P=1.0))
    fast = naive = replace(first, rest_slip=np.linspace(-0.1, 0.2, 41), slip_tally=SlipTally.empty(41))
    for target in (loads(P=1.0), loads(P=1.0, Q=0.35), loads(P=1.0, Q=-0.35)):
        step = PathStep(system, fast, target)
        naive, events = naive_path(system, naive, target)
        fast = step.follow(1.0)
        assert step.events == events > 5
        assert fast.work == pytest.approx(naive.work, rel=1e-9)
        naive.load = target.copy()
        assert np.array_equal(fast.status, naive.status)
        for name in ("pressure", "shear", "gap", "slip"):
            assert np.abs(getattr(fast, name) - getattr(naive, name)).max() < 1e-9
        sums, naive_sums = fast.slip_tally.sums, naive.slip_tally.sums
        assert np.abs(sums[:2] - naive_sums[:2]).max() < 1e-9 * naive_sums[:2].max()
        met = np.isfinite(naive_sums[2])
        assert np.array_equal(np.isfinite(sums[2:]), [met, met])
        assert np.abs(sums[2:, met] - naive_sums[2:, met]).max() < 1e-9
    assert np.all(naive_sums[:2].max(axis=1) > 0.005)
    assert np.ptp(naive_sums[2:, met], axis=0).max() > 0.005
    assert system.weights @ sums[1] == pytest.approx(fast.dissipation - first.dissipation, rel=1e-13)


ALONG = np.linspace(-1.0, 1.0, 41)
VARIED = {
    "two zones": np.where(ALONG < -0.05, 0.5, 0.2),
    "smooth": 0.35 + 0.2 * np.sin(9.0 * ALONG),
    "bare spots": np.where(np.isin(np.arange(41), (15, 18, 19, 24)), 0.0, 0.4),
    "bare half": np.where(ALONG < 0.0, 0.0, 0.4),
}
"""Coefficients of friction that vary along the rim, shape (41,)."""


@pytest.mark.parametrize("road", ["held", "columns"])
@pytest.mark.parametrize("kind", VARIED)
def test_friction_that_varies_along_the_rim(system, monkeypatch, kind, road):
    """The naive solver lets nodes without friction stick and slip like all others; their shear is 0 all the same."""
    if road == "columns":
        as_with_many_nodes(monkeypatch)
    rough = replace(system, friction=VARIED[kind])
    first, _ = first_contact(rough, unloaded_configuration(rough), loads(), loads(P=1.0))
    now = naive = replace(first, slip_tally=SlipTally.empty(41))
    known, events = rough.friction > 0.0, 0
    for target in (loads(P=1.0), loads(P=1.0, Q=0.2), loads(P=1.0, Q=-0.2), loads(P=0.6, Q=0.1)):
        step = PathStep(rough, now, target)
        naive, counted = naive_path(rough, naive, target)
        now, naive.load, events = step.follow(1.0), target.copy(), events + counted
        assert step.events == counted
        assert worst_residual(rough, now) < 1e-12
        assert np.array_equal(now.status[known], naive.status[known])
        assert np.array_equal(now.closed, naive.closed)
        for name in ("pressure", "shear", "gap", "slip"):
            assert np.abs(getattr(now, name) - getattr(naive, name)).max() < 1e-11
        assert not now.shear[~known].any()
    assert events > 40
    assert np.count_nonzero(now.closed & ~known) == np.count_nonzero(now.closed[~known])


def pushed_to_and_fro(system):
    """The configuration after P, and Q to both sides."""
    now, _ = first_contact(system, unloaded_configuration(system), loads(), loads(P=1.0))
    for target in (loads(P=1.0), loads(P=1.0, Q=0.2), loads(P=1.0, Q=-0.2)):
        now = PathStep(system, now, target).follow(1.0)
    return now


@pytest.mark.parametrize("road", ["held", "columns", "sticking"])
def test_the_arrays_have_the_number_of_motions(system, monkeypatch, road):
    """A fourth motion, which follows the load Q along x, is a displacement of the load."""
    if road != "held":
        as_with_many_nodes(monkeypatch)
        monkeypatch.setattr(solver_unknowns, "LEAST_NEIGHBOURS", 2 if road == "sticking" else 1000)
    part, x = 0.1, system.motion[:, 0]
    moved, rows, forces = system.loads.copy(), np.zeros((4, 4)), np.zeros((4, len(LOADS)))
    moved[:, Q] += part * x
    rows[:3, :3], rows[3, 3], forces[:3], forces[3, Q] = system.motion_rows, 1.0, system.forces, part
    fourth = replace(
        system, motion=np.column_stack([system.motion, x]), motion_rows=rows, forces=forces,
        equilibrium=np.vstack([system.equilibrium, np.zeros(82)]),
    )  # fmt: skip
    ends = []
    for alike in (replace(system, loads=moved), fourth):
        now = pushed_to_and_fro(alike)
        assert worst_residual(alike, now) < 1e-12
        ends.append(now)
    three, four = ends
    assert four.motion == pytest.approx([*three.motion, -0.2 * part], abs=1e-12)
    assert np.array_equal(four.status, three.status)
    for name in ("pressure", "shear", "gap", "slip"):
        assert getattr(four, name) == pytest.approx(getattr(three, name), abs=1e-12)


def test_little_friction_tends_to_none(system):
    """Nodes whose friction tends to 0 tend to nodes without friction, at first order."""
    ends = []
    for small in (0.0, 1e-9, 1e-8):
        rough = replace(system, friction=np.where(VARIED["bare half"] > 0.0, 0.4, small))
        now = pushed_to_and_fro(rough)
        ends.append(np.r_[now.pressure, now.shear])
    one, two = (np.abs(end - ends[0]).max() for end in ends[1:])
    assert 0.0 < one < 1e-8
    assert two == pytest.approx(10.0 * one, rel=0.01)


PLAIN = """
import numpy as np
from fastpin import MATERIALS, MaterialPair, Problem, solve
pair = MaterialPair(MATERIALS["Ti-6Al-4V"], MATERIALS["aluminium"])
problem = Problem.from_load_parameter(pair, 0.1, 0.4, "body")
result = solve(problem, [{"P": 1.0}, {"Q": 0.3}, {"Q": -0.3}], nodes=21, arc=(-3.2, 0.1), slip_sums=True)
for state in result:
    extremes = np.nan_to_num(state.slip_lowest), np.nan_to_num(state.slip_highest)
    values = *state.pressure, *state.shear, *state.slip_distance, *state.friction_energy, *extremes[0], *extremes[1]
    print(*[f"{value:.12e}" for value in (*values, state.rotation, state.dissipation)])
"""


@pytest.mark.survey
def test_compiled_and_plain_python_give_the_same_states():
    def run(disabled):
        done = processes.finished(processes.python(PLAIN), env={**os.environ, "NUMBA_DISABLE_JIT": disabled})
        return np.array([line.split() for line in done.stdout.splitlines()], dtype=float)

    compiled, plain = run("0"), run("1")
    assert compiled.shape == (3, 128)
    assert np.abs(compiled - plain).max() < 1e-10


def test_a_full_tableau_is_built_anew(titanium_in_aluminium, monkeypatch):
    problem = Problem.from_load_parameter(titanium_in_aluminium, 0.1, 0.4, "body")
    history, arc = [{"P": 1.0}, {"Q": 0.3}, {"Q": -0.3}], (BOTTOM - 1.6, BOTTOM + 1.55)
    as_with_many_nodes(monkeypatch)
    plenty = solve(problem, history, nodes=101, arc=arc)
    monkeypatch.setattr("fastpin.solver.tableau.ROOM", 0)
    little = solve(problem, history, nodes=101, arc=arc)
    assert little.statistics["rebuilds"] > plenty.statistics["rebuilds"]
    for one, two in zip(little, plenty, strict=True):
        assert np.array_equal(one.status, two.status)
        assert np.abs(one.pressure - two.pressure).max() < 1e-12
        assert np.abs(one.shear - two.shear).max() < 1e-11


@pytest.mark.parametrize("names", [CODES, SLOTS], ids=["codes", "slots"])
def test_codes_and_slots_are_told_apart(names):
    assert sorted(getattr(exchange, name) for name in names) == list(range(len(names)))
