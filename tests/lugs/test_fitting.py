"""Lines and arcs that are fitted to the points of an outline."""

import math

import numpy as np
import pytest

from fastpin.lugs.drawings import polygon
from fastpin.lugs.fitting import fitted
from fastpin.lugs.outline import Part, kinks
from tests.support.lugs import mesh_edge
from tests.support.tiers import seeds

TOLERANCE = 2e-4


@pytest.mark.parametrize("chords", [8, 40, 200])
@pytest.mark.parametrize("first", [0, 5, 30])
def test_the_points_of_a_lug_become_its_four_parts(chords, first):
    outline, arcs = fitted(polygon(np.roll(mesh_edge(chords), -first).tolist()), TOLERANCE)
    assert [part.through is None for part in outline] == [True, True, False, True]
    centre, radius, start, sweep = outline[2].circle
    assert abs(centre) < 1e-12
    assert [radius, start, sweep] == pytest.approx([2.2, -math.pi, math.pi])
    assert [(arc.part, arc.points) for arc in arcs] == [(outline[2], chords + 1)]
    assert arcs[0].deviation < 1e-12
    assert kinks(outline) == []


def test_rounded_points_are_fitted_within_their_rounding():
    for seed in seeds(20):
        noise = np.random.default_rng(seed).normal(scale=2e-5, size=(112, 2)) @ [1.0, 1j]
        points = mesh_edge(40) + noise
        outline, arcs = fitted(polygon(points.tolist()), TOLERANCE)
        assert len(outline) == 4
        centre, radius, *_ = arcs[0].part.circle
        assert abs(centre) < 1e-4
        assert radius == pytest.approx(2.2, abs=1e-4)
        away = np.abs(np.abs(points[:41] - centre) - radius).max()
        assert arcs[0].deviation == pytest.approx(away, rel=1e-6)
        assert all(part.start in points for part in outline)


def test_a_fillet_between_lines_is_found():
    turn = np.linspace(-0.5 * math.pi, 0.0, 9)
    fillet = 2.0 - 2.0j + 0.1 * np.exp(1j * turn) + (-0.1 + 0.1j)
    corners = [-2 - 2j, *fillet.tolist(), 2 + 3j, -2 + 3j]
    outline, arcs = fitted(polygon(corners), TOLERANCE)
    assert len(outline) == 5
    assert [arc.points for arc in arcs] == [9]
    assert arcs[0].part.circle[:2] == pytest.approx((1.9 - 1.9j, 0.1))


@pytest.mark.parametrize("sides", [4, 8, 15])
def test_a_polygon_stays_one(sides):
    corners = 3.0 * np.exp(2j * math.pi * np.arange(sides) / sides)
    outline, arcs = fitted(polygon(corners.tolist()), TOLERANCE)
    assert (len(outline), arcs) == (sides, [])


def test_sides_without_a_fit_are_kinks():
    """An ellipse has no arcs. Without tolerance nothing is fitted, and straight sides stay cut."""
    angle = 2.0 * math.pi * np.arange(48) / 48
    ellipse = polygon((3.0 * np.cos(angle) + 5j * np.sin(angle)).tolist())
    outline, arcs = fitted(ellipse, 1e-6)
    assert (len(outline), arcs) == (48, [])
    assert len(kinks(outline)) == 48
    assert max(kinks(outline))[0] < 0.25
    assert fitted(polygon(mesh_edge(40).tolist()), 0.0)[1] == []


def test_parts_of_other_names_and_arcs_are_kept():
    arc = Part("nose", -2.0, 2.0, -2j)
    sides = [
        Part("right", 2.0, 2 + 1j),
        Part("right", 2 + 1j, 2 + 2j),
        Part("top", 2 + 2j, 0 + 2j),
        Part("pad", 2j, -2 + 2j),
    ]
    outline, _ = fitted([arc, *sides, Part("left", -2 + 2j, -2.0)], TOLERANCE)
    assert [part.name for part in outline] == ["top", "pad", "left", "nose", "right"]
    assert outline[3:] == (arc, Part("right", 2.0, 2 + 2j))
