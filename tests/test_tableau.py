"""The path solver's compiled core: against plain Python, and against a naive solver that factors at every event."""

from __future__ import annotations

import os
import subprocess
import sys

import numpy as np
import pytest

from fastpin import OPEN, STICK, Grid, Problem
from fastpin.collocation import System
from fastpin.contact import first_contact, unloaded
from fastpin.path import PathStep, build_tableau
from fastpin.tableau import _add_column, _add_row, _change_status, _exchange

BOTTOM = -0.5 * np.pi


def python(function):
    return getattr(function, "py_func", function)


@pytest.fixture(scope="module")
def system(titanium_in_aluminium):
    problem = Problem.from_load_parameter(titanium_in_aluminium, 0.1, 0.4, "body")
    return System.build(problem, Grid.arc(BOTTOM - 1.6, BOTTOM + 1.55, 41), 1.0)


def loads(**values):
    names = ("P", "Q", "M", "sxx", "syy", "rotation")
    return np.array([values.get(name, 0.0) for name in names])


# --- exchange steps -----------------------------------------------------------------------------------------


@pytest.mark.parametrize("version", [lambda f: f, python], ids=["compiled", "python"])
def test_exchange_solves_for_the_other_member_of_the_pair(version):
    rng = np.random.default_rng(1)
    m, n, p = 9, 6, 2
    matrix, rates = np.asfortranarray(rng.normal(size=(m, n))), rng.normal(size=m)
    left, right = np.zeros((m, 4), order="F"), np.zeros((n, 4), order="F")
    new_rates = rates.copy()
    pivot = version(_exchange)(matrix, left, right, 0, new_rates, p)
    new = matrix + left[:, :1] @ right[:, :1].T

    # y = M z + r; the roles of y_p and z_p change.
    z = rng.normal(size=n)
    y = matrix @ z + rates
    swapped_z, swapped_y = z.copy(), y.copy()
    swapped_z[p], swapped_y[p] = y[p], z[p]
    assert np.allclose(new @ swapped_z + new_rates, swapped_y, atol=1e-12)
    assert pivot == matrix[p, p]


@pytest.mark.parametrize("version", [lambda f: f, python], ids=["compiled", "python"])
def test_row_and_column_operations_with_pending_updates(version):
    rng = np.random.default_rng(2)
    matrix, rates = np.asfortranarray(rng.normal(size=(7, 5))), rng.normal(size=7)
    left, right = np.asfortranarray(rng.normal(size=(7, 4))), np.asfortranarray(rng.normal(size=(5, 4)))
    true, new_rates = matrix + left[:, :2] @ right[:, :2].T, rates.copy()
    version(_add_row)(matrix, left, right, 2, new_rates, 4, 1, 0.7)
    version(_add_column)(matrix, left, right, 3, 3, 0, -0.2)
    true[4] += 0.7 * true[1]
    true[:, 3] -= 0.2 * true[:, 0]
    rates[4] += 0.7 * rates[1]
    assert np.allclose(matrix + left @ right.T, true, atol=1e-13)
    assert np.array_equal(rates, new_rates)


@pytest.mark.parametrize("version", [lambda f: f, python], ids=["compiled", "python"])
def test_every_change_of_status_gives_the_tableau_of_the_new_statuses(system, version):
    status = np.full(41, OPEN, dtype=np.int8)
    status[12:30] = STICK
    status[12:16], status[26:30] = 1, -1
    rate = loads(P=1.0, Q=0.3)
    matrix, rates = build_tableau(system, status, rate)
    left, right = np.zeros((85, 8), order="F"), np.zeros((82, 8), order="F")
    for node, new in ((20, 1), (13, 0), (30, -1), (12, OPEN)):
        changed, new_rates = status.copy(), rates.copy()
        appended, _ = version(_change_status)(matrix, left, right, 0, new_rates, changed, 0.4, node, new)
        updated = matrix + left[:, :appended] @ right[:, :appended].T
        expected, expected_rates = build_tableau(system, changed, rate)
        assert changed[node] == new
        assert np.abs(updated - expected).max() < 1e-9 * np.abs(expected).max()
        assert np.abs(new_rates - expected_rates).max() < 1e-9 * np.abs(expected_rates).max()


def test_the_operator_is_symmetric(titanium_in_aluminium):
    """Weighted by the hats, without the terms that depend on resultants only; half hats at the ends aside."""
    problem = Problem.from_load_parameter(titanium_in_aluminium, 0.1, 0.4, "body")
    system = System.build(problem, Grid.arc(BOTTOM - 1.0, BOTTOM + 1.0, 61), 1.0)
    weights = np.r_[system.weights, system.weights]
    product = weights[:, None] * system.operator
    inner = np.delete(np.delete(product, [0, 60, 61, 121], axis=0), [0, 60, 61, 121], axis=1)
    assert np.abs(inner - inner.T).max() < 1e-12 * np.abs(product).max()


# --- the whole event loop -----------------------------------------------------------------------------------


def naive_path(system, start, after):
    """Follow a step with one dense solve per change of status: the same rules, written with whole arrays."""
    now, before, mu = start.copy(), start.load.copy(), system.friction
    rate, time, n = after - before, 0.0, system.grid.size

    def rates():
        solution = system.solve(now.status, np.zeros(n), rate, 0.0)
        assert solution is not None
        return solution

    def violators(r):
        slipping, stick = np.abs(now.status) == 1, now.status == STICK
        tol = 1e-10
        back = slipping & (now.status * r.slip < -tol)
        direction = np.where(now.pressure > 0.0, np.sign(now.shear), np.sign(r.shear))
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

    for _ in range(2000):
        r = rates()
        while (new := violators(r)) is not None:
            now.status = new
            r = rates()
        closed, stick = now.status != OPEN, now.status == STICK
        with np.errstate(divide="ignore", invalid="ignore"):
            steps = [
                np.where(~closed & (r.gap < -1e-10) & (now.gap > 1e-14), now.gap / -r.gap, np.inf),
                np.where(
                    closed & (r.pressure < -1e-10) & (now.pressure > 1e-14),
                    now.pressure / -r.pressure,
                    np.inf,
                ),
            ]
            for side in (-1.0, 1.0):
                room, shrink = mu * now.pressure - side * now.shear, side * r.shear - mu * r.pressure
                inside = stick & (room > 1e-13) & (shrink > 1e-10)
                steps.append(np.where(inside, room / shrink, np.inf))
        step = min(np.min(steps), 1.0 - time)
        for name in ("pressure", "shear", "gap", "slip"):
            setattr(now, name, getattr(now, name) + step * getattr(r, name))
        now.gap[closed | (now.gap < 1e-15)] = 0.0
        now.pressure[~closed | (now.pressure < 1e-15)] = 0.0
        now.shear[now.pressure == 0.0] = 0.0
        time += step
        if time >= 1.0 - 1e-15:
            return now
    raise AssertionError("the naive solver did not end")


def test_path_agrees_with_the_naive_solver(system):
    first, _ = first_contact(system, unloaded(system), np.zeros(6), loads(P=1.0))
    fast = naive = first
    for target in (loads(P=1.0), loads(P=1.0, Q=0.35), loads(P=1.0, Q=-0.35)):
        step = PathStep(system, fast, target)
        naive = naive_path(system, naive, target)
        fast = step.follow(1.0)
        assert step.events > 5
        naive.load = target.copy()
        assert np.array_equal(fast.status, naive.status)
        for name in ("pressure", "shear", "gap", "slip"):
            assert np.abs(getattr(fast, name) - getattr(naive, name)).max() < 1e-9


PLAIN = """
import numpy as np
from fastpin import MATERIALS, MaterialPair, Problem, solve
pair = MaterialPair(MATERIALS["Ti-6Al-4V"], MATERIALS["aluminium"])
problem = Problem.from_load_parameter(pair, 0.1, 0.4, "body")
result = solve(problem, [{"P": 1.0}, {"Q": 0.3}, {"Q": -0.3}], nodes=31, arc=(-3.2, 0.1))
for state in result:
    print(*[f"{value:.12e}" for value in (*state.pressure, *state.shear, state.rotation, state.dissipation)])
"""


def test_compiled_and_plain_python_give_the_same_states():
    def run(disabled):
        environment = {**os.environ, "NUMBA_DISABLE_JIT": disabled}
        done = subprocess.run(
            [sys.executable, "-c", PLAIN], env=environment, capture_output=True, text=True, check=True
        )
        return np.array([line.split() for line in done.stdout.splitlines()], dtype=float)

    compiled, plain = run("0"), run("1")
    assert compiled.shape == (3, 64)
    assert np.abs(compiled - plain).max() < 1e-10
