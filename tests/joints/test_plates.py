"""The compliance of plates with several pinned holes."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from fastpin.bodies.compliance import complex_coefficients
from fastpin.lugs.outline import Hole, Lug, PartLoad, rectangle
from fastpin.lugs.plates import FINE, hole_compliance, respond
from fastpin.lugs.several_holes import HolesCompliance, holes_in_infinite_plate, holes_in_outline

KOLOSOV = (3.0 - 0.33) / 1.33


def edge_stress(found: HolesCompliance, hole: int, loads: dict[str, float], at: float) -> float:
    """The hoop stress on the free edge of a hole under remote stresses, at an angle; (T48)."""
    column = sum(size * found.column(name, hole) for name, size in loads.items())
    moved = complex_coefficients(np.asarray(column))
    order = np.arange(-found.order, found.order + 1.0)
    return float(8.0 / (KOLOSOV + 1.0) * np.real(np.exp(1j * order * at) @ ((1.0 + order) * moved)))


@pytest.mark.parametrize(
    ("loads", "at", "expected"),
    [
        ({"syy": 1.0}, 0.0, {1.5: 3.26409, 2.0: 3.02018}),
        ({"sxx": 1.0}, 0.5 * math.pi, {1.5: 2.62314, 3.0: 2.82504, 5.0: 2.92667}),
        ({"sxx": 1.0, "syy": 1.0}, 0.0, {1.5: 2.88750, 3.0: 2.15459, 5.0: 2.04881}),
    ],
)
def test_two_holes_have_the_stresses_of_lings_table(
    loads: dict[str, float], at: float, expected: dict[float, float]
) -> None:
    """Two equal holes, centre distance 2 lambda R: stresses at the inner edge, and beside the line of centres."""
    for half, stress in expected.items():
        found = holes_in_infinite_plate(KOLOSOV, np.array([-half, half]) + 0j, 22 if half < 2.0 else 12)
        assert edge_stress(found, 0, loads, at) == pytest.approx(stress, abs=1e-5)


def test_a_hole_alone_adds_nothing_and_has_kirschs_stress() -> None:
    found = holes_in_infinite_plate(KOLOSOV, np.array([0j]), 6)
    np.testing.assert_allclose(found.matrix, 0.0, atol=1e-14)
    assert edge_stress(found, 0, {"syy": 1.0}, 0.0) == pytest.approx(3.0, abs=1e-12)
    assert edge_stress(found, 0, {"sxy": 1.0}, 0.75 * math.pi) == pytest.approx(4.0, abs=1e-12)


def test_the_matrix_is_symmetric_before_it_is_made_so() -> None:
    """Betti: a displacement at one hole under a force at another. The order of the holes does not matter either."""
    centres = np.array([0.0, 4.0 + 1.0j, 1.0 - 5.0j])
    found = holes_in_infinite_plate(KOLOSOV, centres, 10)
    turned = holes_in_infinite_plate(KOLOSOV, centres[[2, 0, 1]], 10)
    for to, by in ((0, 1), (1, 2), (2, 2)):
        places = [1, 2, 0]
        np.testing.assert_allclose(turned.block(places[to], places[by]), found.block(to, by), atol=1e-7)


@pytest.mark.gate
def test_a_wide_plate_is_nearly_infinite() -> None:
    """Inner harmonics of two holes in a rectangle 60 radii wide, beside the series of the infinite plate."""
    lug = Lug(
        0.33, "stress", 1.0, rectangle((-60.0, 66.0), (-60.0, 60.0)),
        dict.fromkeys(("left", "right", "bottom", "top"), "both"), holes=(Hole("second", 6.0 + 0j, 1.0),),
    )  # fmt: skip
    finite, infinite = (
        holes_in_outline(lug, ["second"], 6, lambda done: None),
        holes_in_infinite_plate(KOLOSOV, np.array([0j, 6.0]), 6),
    )
    inner = np.r_[0, 6:26]  # without rotation and translation, which the supports hold
    for by in (0, 1):
        less = finite.block(0, by)[np.ix_(inner, inner)] - infinite.block(0, by)[np.ix_(inner, inner)]
        assert np.abs(less).max() < 2e-3


def lug_of(box: tuple[float, float, float, float], supports: dict[str, str], **given: Any) -> Lug:
    further = Hole("second", 2.7 + 0.5j, 1.0)
    free = (Hole("window", -2.5 + 1.0j, 0.6), further)
    return Lug(given.pop("nu", 0.33), "strain", 1.0, rectangle(box[:2], box[2:]), supports, holes=free, **given)


@pytest.mark.gate
@pytest.mark.parametrize(
    ("supports", "given"),
    [
        ({"left": "both"}, {}),
        ({"left": "normal", "bottom": "normal"}, {"loads": (PartLoad("sxx", ("right",), x=1.0),)}),
        ({}, {"floats": True, "loads": (PartLoad("sxy", ("right",), x=0.2, y=1.0),)}),
    ],
)
def test_series_of_holes_agree_with_panels_on_their_edges(supports: dict[str, str], given: dict[str, Any]) -> None:
    """Near edges, a hole without a pin, supports, loads: other unknowns and other integrals give the same numbers."""
    lug = lug_of((-5.0, 5.0, -1.8, 3.0), supports, **given)
    found = holes_in_outline(lug, ["second"], 5, lambda done: None)
    response = respond(lug, 5, FINE, lambda done: None, {"second": 5})
    whole = response.projected()
    expected = 0.5 * (whole[:, :44] + whole[:, :44].T) - np.kron(np.eye(2), hole_compliance(5, lug.kolosov))
    np.testing.assert_allclose(found.matrix, expected, atol=1e-9 * np.abs(expected).max())
    for place, name in enumerate(response.loads, start=44):
        np.testing.assert_allclose(found.columns[name], whole[:, place], atol=1e-9 * np.abs(whole[:, place]).max())
        if response.resultants is not None:
            np.testing.assert_allclose(found.resultants[name], response.resultants[:, place], atol=1e-9)


@pytest.mark.gate
def test_the_compliance_is_continuous_where_a_plate_becomes_incompressible() -> None:
    entries = []
    for nu in (0.4998, 0.4999, 0.5):
        lug = lug_of((-5.0, 6.0, -3.0, 3.0), {"left": "both"}, nu=nu)
        entries.append(holes_in_outline(lug, ["second"], 4, lambda done: None).matrix)
    np.testing.assert_allclose(entries[2], 2.0 * entries[1] - entries[0], atol=3e-5)
