"""Random histories over the whole space: the contact conditions, related cases, and the two solvers.

``-k`` chooses classes, ``FASTPIN_SEEDS=20000:21000`` the seeds. ``-rP`` shows the endings and the largest violations.
"""

from __future__ import annotations

import collections

import pytest

from tests.support.tiers import seeds
from tests.survey import metamorphic, two_roads
from tests.survey.histories import GENERATORS
from tests.survey.random_histories import Outcome, examine, examine_in_time

pytestmark = pytest.mark.survey


def assert_right(outcomes: list[Outcome]) -> None:
    """No state is wrong, and few histories are refused. A refusal is no wrong state."""
    for one in outcomes:
        if one.ending != "solved":
            print(f"{one.kind} {one.seed}: {one.ending}: {one.message}")
    print(collections.Counter(one.ending for one in outcomes), sum(one.states for one in outcomes), "states")
    for name in dict.fromkeys(name for one in outcomes for name in one.worst):
        print(f"{name}: {max(one.worst[name][0] for one in outcomes if name in one.worst):.0e}")
    assert [(one.seed, one.violations()) for one in outcomes if one.violations()] == []
    assert sum(one.ending in ("solved", "spins") for one in outcomes) >= 0.8 * len(outcomes)


@pytest.mark.parametrize("kind", GENERATORS)
def test_no_state_breaks_a_contact_condition(kind: str) -> None:
    assert_right([examine_in_time(kind, seed) for seed in seeds(3)])


@pytest.mark.parametrize("kind", GENERATORS)
def test_no_slip_goes_a_wrong_way_between_the_corners(kind: str) -> None:
    assert_right([examine_in_time(kind, seed, dense=True) for seed in seeds(1)])


@pytest.mark.parametrize("kind", metamorphic.CLASSES)
def test_related_cases_have_related_states(kind: str) -> None:
    """Turned, mirrored, scaled, split and renumbered cases. A pin that floats may lie elsewhere."""
    pairs = [pair for seed in seeds(1) for pair in metamorphic.compare_in_time(kind, seed)]
    print(collections.Counter(pair.ending for pair in pairs))
    print(*(pair for pair in pairs if pair.floating > metamorphic.TOLERANCE), sep="\n")
    assert [pair for pair in pairs if pair.difference > metamorphic.TOLERANCE] == []
    assert [pair for pair in pairs if pair.ending.startswith(("one", "hang", "refused on"))] == []


@pytest.mark.parametrize("kind", two_roads.CLASSES)
def test_increments_tend_to_the_path(kind: str) -> None:
    found = [two_roads.compare_in_time(kind, seed) for seed in seeds(1)]
    print(collections.Counter(one.verdict for one in found))
    assert [one for one in found if one.verdict == "disagree"] == []


@pytest.mark.parametrize("seed", [371, 373])
def test_a_contact_under_force_is_not_lost(seed: int) -> None:
    assert examine("scales", seed).violations() == {}


@pytest.mark.parametrize("seed", [47, 58])
def test_one_more_corner_changes_no_first_contact(seed: int) -> None:
    (pair,) = metamorphic.compare("moderate_stress", seed, ("split",))
    assert pair.difference < metamorphic.TOLERANCE
