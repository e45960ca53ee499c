"""A joint and its loads turned by any angle: on a grid turned with them, all results turn too.

The remote stress turns as a tensor, (T16): sxx - syy + 2i sxy gains a factor exp(2i angle).
"""

import cmath
import dataclasses
import functools
import math

import numpy as np
import pytest

from fastpin.model.angles import BOTTOM
from fastpin.model.grid import Grid
from fastpin.model.history import LoadHistory
from fastpin.model.loads import LOADS
from fastpin.model.problem import Problem
from fastpin.solver.solving import solve
from tests.support.checks.sliding import solve_sliding
from tests.support.once import solve_once

HISTORY = [
    {"P": 1.0, "Q": 0.1, "sxx": 0.02},
    {"Q": 0.25, "sxy": 0.1},
    {"Q": -0.2, "sxx": 0.06, "syy": -0.05, "sxy": -0.08},
    {"P": 0.7, "Q": 0.2, "sxy": 0.05},
    {"P": 0.9, "Q": -0.15, "syy": 0.1},
]
ANGLES = [0.3, 1.0, -2.2, 0.5 * math.pi, math.pi]
KINDS = [("centre", "free"), ("centre", "fixed"), ("body", "free")]
ARC = Grid.arc(BOTTOM - 1.6, BOTTOM + 1.6, 141)


def turned(history, angle):
    """The corners of a history turned counter-clockwise. Moments and rotations stay as they are."""
    names = ("P", "Q", "sxx", "syy", "sxy")
    corners = []
    for corner, row in zip(history, LoadHistory(history).values(), strict=True):
        P, Q, sxx, syy, sxy = (float(row[LOADS.index(name)]) for name in names)
        force = complex(Q, -P) * cmath.exp(1j * angle)
        oval = complex(sxx - syy, 2.0 * sxy) * cmath.exp(2j * angle)
        mean = 0.5 * (sxx + syy)
        others = {name: value for name, value in corner.items() if name not in names}
        stress = {"sxx": mean + 0.5 * oval.real, "syy": mean - 0.5 * oval.real, "sxy": 0.5 * oval.imag}
        corners.append({"P": -force.imag, "Q": force.real, **stress, **others})
    return corners


def turned_grid(grid, angle):
    """The same nodes, turned."""
    return Grid(grid.theta + angle, grid.closed)


def assert_turned(one, two, angle, tolerance):
    """Check that the states `two` are the states `one` turned by `angle`."""
    assert len(one) == len(two)
    assert any(state.shear.any() for state in one)
    peak = max(state.peak_pressure for state in one)
    sizes = {"pressure": peak, "shear": peak}
    sizes |= {name: max(np.abs(getattr(state, name)).max() for state in one) for name in ("gap", "slip")}
    for first, second in zip(one, two, strict=True):
        for name, size in sizes.items():
            assert getattr(second, name) == pytest.approx(getattr(first, name), abs=tolerance * size)
        moved = complex(first.dx, first.dy) * cmath.exp(1j * angle)
        assert complex(second.dx, second.dy) == pytest.approx(moved, abs=tolerance * sizes["gap"])
        for name in ("rotation", "dissipation", "work", "energy"):
            assert getattr(second, name) == pytest.approx(getattr(first, name), abs=tolerance)
        for zone in ("contact", "stick"):
            turned = sorted(np.exp(1j * (np.ravel(getattr(first, zone)) + angle)), key=np.angle)
            ends = sorted(np.exp(1j * np.ravel(getattr(second, zone))), key=np.angle)
            assert ends == pytest.approx(turned, abs=1e3 * tolerance)
        # The peak at a border is read outwards from nodes inside its zone. On the arc its derivatives by the nodal
        # tractions sum up to 1,900, so rounding of the tractions shows. The same tractions have the same peak.
        unturned = dataclasses.replace(first, pressure=second.pressure, shear=second.shear)
        assert second.peak_shear == pytest.approx(unturned.peak_shear, abs=tolerance * peak)


@pytest.mark.parametrize("angle", ANGLES)
@pytest.mark.parametrize(("pin_load", "rotation"), KINDS)
def test_any_angle_on_an_arc(titanium_in_aluminium, pin_load, rotation, angle):
    problem = Problem.from_load_parameter(titanium_in_aluminium, 0.3, 0.4, pin_load, rotation)
    history = [dict(corner) for corner in HISTORY]
    if rotation == "fixed":
        history[2]["rotation"] = 0.02
    elif pin_load == "centre":
        history[1]["M"] = 0.05
    one = solve_once(problem, history, grid=ARC, between=1)
    two = solve(problem, turned(history, angle), grid=turned_grid(ARC, angle), between=1)
    assert_turned(one, two, angle, 1e-10)


@pytest.mark.parametrize("angle", ANGLES[:2])
def test_any_angle_in_increments(titanium_in_aluminium, angle):
    problem = Problem.from_load_parameter(titanium_in_aluminium, 0.3, 0.4, "centre", "fixed")
    grid, options = Grid.arc(BOTTOM - 1.6, BOTTOM + 1.6, 101), {"method": "increment", "increments": 10}
    one = solve(problem, HISTORY, grid=grid, **options)
    two = solve(problem, turned(HISTORY, angle), grid=turned_grid(grid, angle), **options)
    assert_turned(one, two, angle, 1e-10)


@functools.cache
def slid(pair, slip):
    """A problem, and its contact in full sliding."""
    problem = Problem.from_load_parameter(pair, 0.3, 0.4, "centre", "fixed")
    return problem, solve_sliding(problem, {"P": 1.0, "Q": 0.3, "sxx": 0.05, "syy": 0.02, "sxy": 0.1}, slip)


@pytest.mark.parametrize(("angle", "slip"), [*((angle, 1) for angle in ANGLES), (0.25 * math.pi, -1)])
def test_any_angle_in_full_sliding(titanium_in_aluminium, angle, slip):
    problem, one = slid(titanium_in_aluminium, slip)
    (other,) = turned([one.load], angle)
    two = solve_sliding(problem, other, slip)
    away = np.array(two.contact) - angle - one.contact
    assert away - 2.0 * math.pi * np.round(away / (2.0 * math.pi)) == pytest.approx([0.0, 0.0], abs=1e-11)
    assert (two.peak_pressure, two.moment) == pytest.approx((one.peak_pressure, one.moment), rel=1e-11)
