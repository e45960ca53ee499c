"""Cracks in plates of any outline: growth against a ring, the end of the ligament, cracks together, refusals."""

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest

import fastpin
from fastpin.assess import outputs
from fastpin.assess.crack import GROWTH, growth_line
from fastpin.bodies import Compliance, Ring
from fastpin.cracks import (
    Crack,
    CrackFate,
    growth,
    growth_along_edge,
    growth_together,
    paris,
    planned_growth,
    stress_intensity,
)
from fastpin.cracks.intensity import CrackedEdge
from fastpin.errors import InputError
from fastpin.lugs import fields, images
from fastpin.lugs.outline import Lug
from fastpin.lugs.panels import Fineness
from fastpin.lugs.plates import hole_compliance, respond
from fastpin.model.crack import CrackGrowth, check_crack, check_length
from fastpin.model.units import units
from tests.support.cracks import LIKE, M, problem_of
from tests.support.lugs import lug_with_nose, outlined
from tests.support.outlines import FreeOutline
from tests.support.tiers import for_gate

LAW = paris(1e-10, 3.0)


def lug() -> Lug:
    """Nose and sides at 22 mm, round a hole of 10 mm."""
    given = lug_with_nose()
    outline = tuple(part.scaled(1e-2) for part in given.outline)
    return replace(given, nu=0.33, plane="strain", hole_radius=1e-2, outline=outline)


def states_of(body) -> list[fastpin.State]:
    problem = problem_of(LIKE, 20e-6, 0.3, plate_body=body)
    return list(fastpin.solve(problem, [{"P": 1e6}, {"P": 1e5}], nodes=61))


@pytest.fixture(scope="module")
@for_gate
def states() -> Iterator[list[fastpin.State]]:
    """Two states, on edges with few nodes: errors of 1e-3."""
    few = Fineness(5, 3)
    whole = respond(lug(), 4, few, lambda done: None).projected()
    matrix = whole - hole_compliance(4, lug().kolosov)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(fields, "FINENESS", few)
        patch.setattr(images, "FINENESS", few)
        yield states_of(Compliance(0.33, "strain", 1e-2, 0.5 * (matrix + matrix.T), outline=outlined(lug()).outline))


@pytest.mark.gate
def test_a_ring_as_an_outline_has_its_lives(monkeypatch):
    ring, crack = states_of(Ring(20e-3, "uniform")), Crack(-0.35)
    expected = growth(ring, crack, LAW, 2e-3, 6e-3)
    outline = FreeOutline(2.0)
    monkeypatch.setattr(CrackedEdge, "beyond", property(lambda self: outline))
    assert growth(ring, crack, LAW, 2e-3, 6e-3).life == pytest.approx(expected.life, rel=1e-5)


def test_a_growth_ends_with_the_ligament(states):
    found = growth(states, Crack(0.0), LAW, 10e-3, 12e-3)
    assert (found.fate, found.fracture) == (CrackFate.BREAKS, pytest.approx(0.95 * 12e-3))
    assert "to fracture at 11.4 mm, of a ligament of 12 mm, in" in found.words
    assert np.all(np.diff(found.K_max) > 0.0)
    shorter = growth(states, Crack(0.0), LAW, 10e-3, 11e-3)
    assert (shorter.fate, shorter.ligament) == (CrackFate.GROWS, pytest.approx(12e-3))
    assert shorter.life < found.life
    tough = replace(LAW, toughness=0.5 * (shorter.K_max[0] + shorter.K_max[-1]))
    assert 10e-3 < growth(states, Crack(0.0), tough, 10e-3, 12e-3).fracture < 11e-3


def test_mirrored_cracks_of_a_symmetric_lug_are_alike(states):
    """The pin is loaded along the axis of the lug: without friction its halves are alike."""
    problem = replace(states[0].problem, friction=0.0)
    state = fastpin.solve(problem, [{"P": 1e6}], nodes=61)[0]
    one = stress_intensity(state, Crack(-0.3, 0.2), [1e-3, 5e-3])
    other = stress_intensity(state, Crack(math.pi + 0.3, -0.2), [1e-3, 5e-3])
    left, right = (np.array([each.K_I, sign * each.K_II]) for each, sign in ((one, 1.0), (other, -1.0)))
    assert left == pytest.approx(right, rel=1e-5)


def test_places_of_an_edge_are_followed_one_by_one(states):
    theta = np.radians([-20.0, 0.0, 20.0])
    found = growth_along_edge(states, LAW, 5e-3, 6e-3, theta)
    lone = [growth(states, Crack(place), LAW, 5e-3, 6e-3).life for place in theta]
    assert found.life == pytest.approx(lone, rel=3e-3)
    assert found.fastest.crack.theta == theta[int(np.argmin(lone))]


def test_the_fastest_place_is_looked_for_by_the_stress_first(states):
    """Also where the ligament ends the growth. The progress comes to all places."""
    seen: list[tuple[float, float]] = []
    found = growth_along_edge(states, LAW, 8e-3, 12e-3, progress=lambda done, total: seen.append((done, total)))
    every = growth_along_edge(states, LAW, 8e-3, 12e-3, np.radians(np.arange(-180.0, 180.0, 60.0)))
    assert found.life.min() <= every.life.min() * 1.001
    assert found.theta.size == 16
    assert found.fastest.life == pytest.approx(found.life.min(), rel=0.03)  # it alone has more lengths
    assert [done for done, _ in seen] == list(range(1, len(seen) + 1))
    assert seen[-1] == (88, 88)


def test_two_cracks_grow_together(states):
    pair = Crack(0.0), Crack(math.pi)
    alone = growth(states, pair[0], LAW, 4e-3, 5e-3).life
    beside_little = growth_together(states, pair, LAW, [4e-3, 1e-7], [5e-3, 1e-3])
    assert beside_little.life == pytest.approx(alone, rel=1e-4)
    assert beside_little.error < 1e-4
    found = growth_together(states, pair, LAW, 4e-3, 5e-3)
    assert found.fate == CrackFate.GROWS
    assert found.life < alone
    K = stress_intensity(states, pair, found.length[-1:]).K_I
    assert found.K_max[-1] == pytest.approx(K.max(axis=(0, 1)), rel=1e-9)


def test_cracks_that_stop_or_break_together(states):
    pair = Crack(0.0), Crack(math.pi)
    K = stress_intensity(states, pair, [[2e-3, 2e-3]]).K_I.max(axis=(0, 1))
    quiet = replace(LAW, threshold_range=2.0 * K.max())
    none = growth_together(states, pair, quiet, 2e-3, 3e-3)
    assert (none.fate, none.life, none.words) == (CrackFate.NONE, math.inf, "no growth at 2 mm and 2 mm")
    brittle = growth_together(states, pair, replace(LAW, toughness=1.02 * K.max()), 2e-3, 3e-3)
    assert brittle.fate == CrackFate.BREAKS
    assert brittle.K_max[-1].max() == pytest.approx(1.02 * K.max(), rel=1e-6)


def test_a_crack_that_leaves_the_plate_is_refused():
    states = states_of(outlined(lug()))
    problem = states[0].problem
    leaves = r"must end within its ligament of 12 mm, not be 13 mm: the line of the crack leaves the plate at x = 22 mm"
    with pytest.raises(InputError, match="last: " + leaves):
        growth(states, Crack(0.0), LAW, 1e-3, 13e-3)
    with pytest.raises(InputError, match="last: " + leaves):
        check_crack(problem, CrackGrowth(1e-3, 13e-3, LAW, 0.0))
    with pytest.raises(InputError, match="last: " + leaves):
        growth_together(states, [Crack(0.0), Crack(1.0)], LAW, 1e-3, [13e-3, 2e-3])
    with pytest.raises(InputError, match=r"lengths: must end within 0.95 of its ligament of 12 mm, not be 11.5 mm"):
        stress_intensity(states, Crack(0.0), [1e-3, 11.5e-3])
    with pytest.raises(InputError, match=r"first: must lie within 0.95 of the ligament at 90.00 deg, 11.4 mm"):
        growth(states, Crack(0.0), LAW, 11.5e-3, 11.9e-3)
    check_crack(problem, CrackGrowth(1e-3, 13e-3, LAW))  # at its fastest place it ends with the ligament
    check_length("last", problem, Crack(0.0), 11.4e-3)


TOGETHER = {
    "cracks: must be a list of cracks that begin in one body, at one hole": (
        [Crack(0.0), Crack(1.0, body="seat")],
        1e-3,
        2e-3,
    ),
    "cracks: must be a list of Crack": (3, 1e-3, 2e-3),
    "first: must be a length, or 2 of them": ([Crack(0.0), Crack(1.0)], [1e-3, 1e-3, 1e-3], 2e-3),
    "first: must be above 0, not 0": ([Crack(0.0), Crack(1.0)], 0.0, 2e-3),
    "last: must be longer than the first length": ([Crack(0.0), Crack(1.0)], [1e-3, 3e-3], 2e-3),
}


@pytest.mark.parametrize("words", TOGETHER)
def test_refused_growth_together(small_states, words):
    cracks, first, last = TOGETHER[words]
    with pytest.raises(InputError) as refused:
        growth_together(small_states, cracks, LAW, first, last)
    assert str(refused.value).startswith(words)


@pytest.mark.gate
def test_two_cracks_of_an_infinite_plate_grow_together(small_states):
    law = replace(LAW, toughness=50.0 * M)
    found = growth_together(small_states, [Crack(-0.5), Crack(0.5)], law, 1e-3, 1.1e-3)
    assert repr(found).startswith("<GrowthTogether of 2 cracks: grow from 1 mm and 1 mm to 1.1 mm and ")


def test_a_crack_begins_at_another_edge(states):
    """At both sides of the shank, which are mirrored; at the hole the same crack is another one."""
    right, left = (Crack(angle=0.3 * sign, place=(sign * 22.1e-3, 50e-3)) for sign in (1.0, -1.0))
    one, other = (stress_intensity(states, crack, [1e-3, 8e-3]) for crack in (right, left))
    assert pytest.approx(other.K_I, rel=0.05) == one.K_I  # friction
    assert one.K_I[0, 0] == pytest.approx(1.1 * 1e6 / 44e-3 * math.sqrt(math.pi * 1e-3), rel=0.1)
    found = growth(states, Crack(place=(22e-3, 50e-3)), LAW, 1e-3, 2e-3)
    assert (found.ligament, found.fate) == (pytest.approx(44e-3), CrackFate.GROWS)
    assert repr(found).startswith('<Growth of a crack at x = 22 mm, y = 50 mm on the edge "right": grows from 1 mm')
    planned = planned_growth(states, CrackGrowth(1e-3, 2e-3, LAW, place=(22e-3, 50e-3)))
    assert planned.life == found.life
    document = outputs.document(GROWTH, found, units(found.problem))
    assert (document["edge"], document["x"], document["y"]) == ("right", pytest.approx(22e-3), pytest.approx(50e-3))
    assert growth_line(found).startswith('crack at x = 22 mm, y = 50 mm on the edge "right": grows')


PLACES = {
    "theta: is missing: give the angle of the mouth, or a place": lambda states: Crack(),
    "place: stands in place of theta: leave one of them out": lambda states: Crack(0.0, place=(1e-3, 1e-3)),
    "place: must be a pair of coordinates, x and y, not 3": lambda states: Crack(place=3),
    'place: must lie on an edge beyond the hole; the nearest one, "right", is 2 mm away': lambda states: growth(
        states, Crack(place=(20e-3, 50e-3)), LAW, 1e-3, 2e-3
    ),
    "last: must be at most 18.81 mm, not 40 mm: a longer crack comes too near": lambda states: growth(
        states, Crack(place=(22e-3, 98e-3)), LAW, 1e-3, 40e-3
    ),
    "last: must end within its ligament of 44 mm, not be 50 mm: the line of the crack leaves the plate at x = -22 mm": (
        lambda states: growth(states, Crack(place=(22e-3, 50e-3)), LAW, 1e-3, 50e-3)
    ),
    "cracks: must begin at one hole; a crack at another edge stands alone": lambda states: stress_intensity(
        states, [Crack(place=(22e-3, 50e-3)), Crack(0.0)], [1e-3]
    ),
    "cracks: must be a list of cracks that begin in one body, at one hole": lambda states: growth_together(
        states, [Crack(place=(22e-3, 50e-3))], LAW, 1e-3, 2e-3
    ),
}


@pytest.mark.parametrize("words", PLACES)
def test_refused_places(words, outlined_states):
    with pytest.raises(InputError) as refused:
        PLACES[words](outlined_states)
    assert str(refused.value).startswith(words)


@pytest.fixture(scope="module")
@for_gate
def outlined_states() -> list[fastpin.State]:
    """States of a lug whose compliance means nothing."""
    return states_of(outlined(lug()))


def test_only_plates_of_any_outline_have_other_edges(small_states):
    with pytest.raises(InputError, match="place: needs a plate of any outline"):
        growth(small_states, Crack(place=(22e-3, 50e-3)), LAW, 1e-3, 2e-3)
