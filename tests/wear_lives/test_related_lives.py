"""Lives of wear with a known relation: mirrored and turned, without friction, and on arcs that the wear outgrows."""

import numpy as np
import pytest

import fastpin
from fastpin import Grid, LoadHistory
from fastpin.model import InitialGap, Profile, Wear
from fastpin.solver import ArcError
from fastpin.wear_lives import WearResult
from tests.support.slip_cases import LIKE, UNLIKE
from tests.support.tiers import some_gate
from tests.support.wear_cases import BUMPED, BUMPED_TURNS, WEAR_CASES
from tests.survey import metamorphic

TURNS = LoadHistory([{"P": 1.0, "rotation": 0.5}]) + LoadHistory([{"rotation": -0.5}, {"rotation": 0.5}]).repeated(1)


@pytest.mark.parametrize("relation", ["turned", "mirrored"])
def test_a_related_life_wears_alike(relation: str) -> None:
    """Initial gap, friction and wear coefficient vary along the rim, and the remote stress turns too."""
    gap = InitialGap(Profile.ellipse(0.02, 0.3) + Profile.crown(-0.01, -1.2, 0.5), Profile.lobes(3, 0.01, 0.7))
    friction, plate = (
        Profile.constant(value) + Profile.zone(more, -1.8, -1.3) for value, more in ((0.5, -0.3), (1, 2))
    )
    problem = fastpin.Problem.from_load_parameter(UNLIKE, 0.1, friction, "centre", "fixed", gap=gap)
    corners = LoadHistory(
        [
            {"P": 1.0, "Q": 0.1, "sxx": 0.02, "sxy": 0.0, "rotation": 0.1},
            {"P": 0.7, "Q": -0.3, "sxy": 0.02, "rotation": -0.2},
            {"P": 1.0, "Q": 0.3, "sxy": 0.0, "rotation": 0.3},
        ]
    )
    grid, loads = Grid.circle(60, -2.9), corners.values()

    def life(changed: metamorphic.Changed, worn: Profile) -> WearResult:
        acting = metamorphic.acting_loads(changed.problem, changed.loads)
        history = LoadHistory.from_array(acting[:1]) + LoadHistory.from_array(acting[1:]).repeated(1)
        given = {"pin": 0.005, "plate": worn.scaled(0.01), "cycles": 4, "tolerance": 0.0, "grid": changed.grid}
        return fastpin.wear(changed.problem, history, **given)

    own = metamorphic.Changed(problem, loads, grid, np.arange(3))
    other = metamorphic.RELATIONS[relation](np.random.default_rng(3), problem, loads, grid)
    first, second = life(own, plate), life(other, metamorphic.moved_profile(plate, other.angle, relation == "mirrored"))
    order = other.order if other.order.size else slice(None)
    for one, two in zip(first, second, strict=True):
        assert np.abs(one.pin_depth - two.pin_depth[order]).max() < 1e-12 * first[-1].depth
        assert np.abs(one.plate_depth - two.plate_depth[order]).max() < 1e-12 * first[-1].depth
        fields = [[each.fields(state) for state in cycle.states] for each, cycle in ((own, one), (other, two))]
        assert metamorphic.differences(*fields, metamorphic.Sizes())[0].max() < 1e-11


def test_a_pin_without_friction_wears_by_its_pressure() -> None:
    """A turning pin slips by 4 x 0.5 in a cycle. Its wear is the limit for little friction."""
    problem = fastpin.Problem.from_load_parameter(LIKE, 0.1, 0.0, "centre", "fixed")
    given = {"cycles": 3, "tolerance": 0.0, "grid": Grid.circle(60, -0.5 * np.pi)}
    little = fastpin.wear(problem, TURNS, coefficient=1e-7, **given)
    worn = little[-1].gap_growth - little[0].gap_growth
    assert worn == pytest.approx(3 * 2.0 * 1e-7 * little[0].pressure, rel=1e-5)
    assert little[-1].dissipation == 0.0
    much, limit = (
        fastpin.wear(each, TURNS, coefficient=0.02, **given)[-1]
        for each in (problem, fastpin.Problem.from_load_parameter(LIKE, 0.1, 1e-8, "centre", "fixed"))
    )
    assert 1e-12 < np.abs(much.gap_growth - limit.gap_growth).max() < 1e-7 * much.depth


@pytest.mark.parametrize("name", some_gate(WEAR_CASES, "lobed hole"))
def test_energies_of_a_life_balance_at_second_order(name: str) -> None:
    """The elastic energy that goes with the material is a thousandth to a fifth of the work."""
    case, left = WEAR_CASES[name], []
    for nodes in (41, 81):
        given = {"coefficient": case.tau / 10, "cycles": 10, "tolerance": 0.0, "grid": case.grid(nodes)}
        last = fastpin.wear(case.problem, case.history(), **given)[-1]
        state = last.states[0]
        assert state.dissipation == last.dissipation
        left.append((state.work - state.energy - state.dissipation - last.removed) / state.work)
        assert last.removed > 0.8e-3 * state.work
    assert abs(left[0]) < 3e-3
    assert abs(left[1]) < 0.3 * abs(left[0])


@pytest.mark.gate
def test_a_pin_that_sinks_onto_a_bump_beyond_its_arc_is_noticed() -> None:
    arc, wear = (-0.5 * np.pi - 0.98, -0.5 * np.pi + 0.98), Wear(0.1, cycles=5, tolerance=0.0)
    with pytest.raises(
        ArcError, match=r"cycle 4: .* the pin touches the hole beyond the arc; give a wider one"
    ) as caught:
        fastpin.wear(BUMPED, BUMPED_TURNS, arc=arc, nodes=41, **wear.given)
    assert [each.cycle for each in caught.value.result] == [0, 1, 2]
    found = fastpin.wear(BUMPED, BUMPED_TURNS, nodes=41, **wear.given)
    assert [len(each.states[0].contact) for each in found] == [1, 1, 1, 1, 2, 2]
    whole = fastpin.wear(BUMPED, BUMPED_TURNS, grid=Grid.circle(160, -0.5 * np.pi), **wear.given)
    assert found[-1].depth == pytest.approx(whole[-1].depth, rel=5e-3)
    assert found[-1].volume == pytest.approx(whole[-1].volume, rel=5e-3)
