"""Radii, walls and depths of common sizes, in mm and inches: rounding of their ratios refuses none of them."""

import itertools
from dataclasses import replace

import pytest

from fastpin import InputError, Points, Problem
from fastpin.bodies import Ring
from fastpin.cracks import Crack
from fastpin.model.checks import is_above, is_between
from fastpin.model.crack import MOST_OF_WALL, check_length
from fastpin.states.yielding import circles
from tests.support.common_sizes import PAIR, bushed, sizes


@pytest.mark.parametrize("any_outline", [True, False])
def test_every_circle_lies_in_its_body(any_outline: bool) -> None:
    for radius, outer in itertools.islice(sizes(), 0, None, 7):
        problem = bushed(radius, outer, any_outline)
        for circle in circles(problem):
            there = Points.at_depth(circle.depth * radius, [0.0]).depths(problem, circle.body)
            assert there == pytest.approx(circle.depth, rel=1e-12)
        for place, body in (
            (outer, "plate"),
            (outer, "seat"),
            (radius, "plate"),
            (radius, "pin"),
            (0.4 * radius, "pin"),
        ):
            assert Points.at_radius(place, 0.0).depths(problem, body).shape == ()


def test_the_lug_far_beyond_a_bush_is_unknown() -> None:
    for radius, outer in itertools.islice(sizes(), 0, None, 29):
        problem = bushed(radius, outer, any_outline=True)
        with pytest.raises(InputError, match="near the hole only"):
            Points.at_radius((1.0 + 1e-9) * problem.plate_body.lug.reach * outer, 0.0).depths(problem, "plate")


def test_limits_that_are_computed_can_be_reached() -> None:
    for radius, outer in itertools.islice(sizes(), 0, None, 7):
        if outer < 1.05 * radius:
            continue  # too thin for a ring
        problem = Problem(PAIR, radius, 2e-5, 0.2, plate_body=Ring(outer))
        check_length("last", problem, Crack(0.0), MOST_OF_WALL * (outer - radius))
        with pytest.raises(InputError, match="last: must end within"):
            check_length("last", problem, Crack(0.0), (MOST_OF_WALL + 1e-6) * (outer - radius))
        held = replace(problem, plate_body=Ring(3.0 * outer), rotation="fixed", hub_radius=(1.0 + 1e-12) * radius)
        assert held.hub_radius == radius
        with pytest.raises(InputError, match="hub_radius"):
            replace(held, hub_radius=(1.0 + 1e-6) * radius)


def test_comparisons_of_lengths() -> None:
    assert 0.1 + 0.2 > 0.3
    assert not is_above(0.1 + 0.2, 0.3)
    assert is_above(0.3000001, 0.3)
    assert is_between(0.1 + 0.2, 0.3, 0.3)
    assert not is_between(0.3, 0.2999, 1.0)
    assert is_above(1e-9, 0.0)
