"""The figures of interference fits and of the regimes of contact, on few nodes and in few cases."""

import math

import numpy as np
import pytest

from docs.beyond import interference, regimes
from docs.beyond.figures import FIGURES
from fastpin import Grid, solve
from fastpin.assess.outputs import Curve
from fastpin.published import remote_stress
from fastpin.verification.interference import release_stress
from tests.support.tiers import for_gate

NODES, RAYS = 100, 12

OPENING = {0.1: 3.41330, 0.3: 3.60284, 0.5: 3.64003, 1.0: 3.65856}
"""P/(R N0) at which like bodies with nu = 0.3 open under a centre load: extrapolated from 400 and 800 nodes."""


# -- the loads of slip and opening ---------------------------------------------------------------------------


@pytest.mark.parametrize("friction", OPENING)
def test_opening_loads(friction):
    opening, slip, exact = interference.events(friction, "centre", 200)
    assert opening == pytest.approx(OPENING[friction], abs=5e-5)
    assert slip == pytest.approx(exact, abs=2e-4)


def test_without_friction_it_opens_at_pi():
    opening, slip, exact = interference.events(0.0, "body", 200)
    assert opening == pytest.approx(math.pi, abs=1e-5)
    assert math.isnan(slip)
    assert math.isnan(exact)


@pytest.fixture(scope="module")
@for_gate
def loads() -> list[Curve]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(interference, "FRICTION", (0.0, 0.3, 1.0))
        return FIGURES["interference"].compute(101)


def test_slip_comes_before_opening_and_both_come_later_with_more_friction(loads):
    for curve in loads[:2]:
        assert np.all(curve["P_slips"][1:] < curve["P_opens"][1:])
        assert np.all(np.diff(curve["P_opens"]) > 0.0)
        assert np.all(np.diff(curve["P_slips"][1:]) > 0.0)


def test_tractions_at_the_stages(loads):
    still, slipping, opening, open_ = loads[2:]
    assert still["N"] == pytest.approx(1.0)
    assert slipping["N"].min() == pytest.approx(1.0 - 3.204 * (1.0 + 2.0 / 2.8) / (2.0 * math.pi), abs=1e-3)
    assert 0.0 <= opening["N"].min() < 0.01
    assert open_["N"][[0, -1]].tolist() == [0.0, 0.0]
    assert np.ptp(open_["angle_deg"]) == pytest.approx(259.0, abs=3.0)
    for curve in (still, slipping):
        assert curve["angle_deg"][[0, -1]] == pytest.approx([-180.0, 180.0])
        assert curve["N"][0] == curve["N"][-1]


def test_loads_are_drawn(loads):
    figure = FIGURES["interference"].draw(loads)
    figure.draw_without_rendering()
    drawn = [[one for one in panel.lines if len(one.get_xdata()) > 2] for panel in figure.axes]
    assert [len(lines) for lines in drawn] == [3, 3, 4, 4]
    above, below = ({one.get_color() for one in lines} for lines in (drawn[0] + drawn[1], drawn[2] + drawn[3]))
    assert not above & below
    labels = [panel.get_ylabel().split("  ")[0] for panel in figure.axes]
    assert labels == ["load", "load", "pressure", "shear traction"]
    assert [panel.get_title() for panel in figure.axes[:2]] == ["force at the centre of the pin", "body force"]


# -- the map of regimes --------------------------------------------------------------------------------------


@pytest.mark.parametrize("turn", [0.0, 0.4, 1.0, 1.5, 2.0, 3.0, 3.9, 4.0, 5.0, 6.3, 7.0, 7.9])
def test_directions_run_round_the_square(turn):
    point = regimes.direction(turn)
    assert np.abs(point).max() == pytest.approx(1.0)
    assert regimes._turn(*(0.3 * point)) == pytest.approx(turn)
    assert np.abs(regimes.direction(turn + 1e-6) - point).sum() == pytest.approx(1e-6)


def start(force: float, load_parameter: float, nodes: int = NODES):
    return solve(regimes.problem_of(load_parameter), [{"P": force}], grid=Grid.circle(nodes))


@pytest.mark.parametrize("stress", [(1.0, 0.0), (-1.0, 0.0), (0.2, 1.0), (1.0, -1.0)])
def test_a_loose_pin_without_force_is_gripped_where_the_hole_has_shrunk_by_the_clearance(stress):
    """The edge moves by [(sxx + syy)/2 + (sxx - syy) cos 2 theta] c/s_c."""
    begun = start(0.0, 0.75)
    target = 6.0 * release_stress(begun.problem) * -np.array(stress)  # negative for a clearance
    found = regimes.regimes_along(begun, target)
    inwards = abs(stress[0] - stress[1]) - 0.5 * sum(stress)
    assert [kind for _, kind in found] == [0, 2]
    assert found[1][0] == pytest.approx(1.0 / (6.0 * inwards), abs=2e-3)


@pytest.mark.parametrize("load_parameter", [0.75, -0.75])
def test_equal_stress_closes_the_clearance_and_releases_the_interference(load_parameter):
    """Just off the diagonal: on it, all nodes would change at once."""
    begun = start(0.0, load_parameter)
    towards = 2.0 * release_stress(begun.problem) * np.array([1.0, 0.98])
    kinds = [kind for _, kind in regimes.regimes_along(begun, towards)]
    assert kinds[0] == (0 if load_parameter > 0.0 else regimes.ALL_ROUND)
    assert kinds[-1] == (regimes.ALL_ROUND if load_parameter > 0.0 else 0)
    assert kinds[1:-1] == [2]


def test_figure_10_has_one_arc_each():
    begun = start(1.0, 0.75)
    unit = remote_stress.stress_unit("Ti/Al")
    for case in remote_stress.DASHES:
        if case != (0.0, 0.0):
            assert [kind for _, kind in regimes.regimes_along(begun, unit * np.array(case))] == [1]
    assert abs(release_stress(begun.problem)) == pytest.approx(0.75 * unit)


@pytest.fixture(scope="module")
@for_gate
def mapped() -> list[Curve]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(regimes, "RAYS", RAYS)
        patch.setattr(regimes, "HALVINGS", 1)
        return FIGURES["regimes"].compute(81)


def test_regimes_of_all_four_panels(mapped):
    kinds = {(c.parameters["P"], c.parameters["L_p"]): set(c["arcs"].astype(int).tolist()) for c in mapped}
    assert kinds == {
        (0.0, 0.75): {0, 2, regimes.ALL_ROUND},
        (0.0, -0.75): {0, 2, regimes.ALL_ROUND},
        (1.0, 0.75): {1, 2, regimes.ALL_ROUND},
        (1.0, -0.75): {1, 2, regimes.ALL_ROUND},
    }


def test_rays_are_added_where_neighbours_differ(mapped):
    for curve in mapped:
        rays = np.unique(curve["ray"])
        assert set((0.5 + np.arange(RAYS)) * 8.0 / RAYS) < set(rays.tolist())
        assert RAYS < rays.size < 2 * RAYS


def test_the_map_is_drawn_with_names_in_its_regions(mapped):
    figure = FIGURES["regimes"].draw(mapped)
    figure.draw_without_rendering()
    assert len(figure.axes) == 4
    for panel, curve in zip(figure.axes, mapped, strict=True):
        names = {text.get_text() for text in panel.texts}
        assert {regimes.REGIMES[kind].words for kind in set(curve["arcs"].astype(int).tolist())} <= names
        for text in panel.texts:
            box = text.get_window_extent()
            assert panel.bbox.x0 <= box.x0 < box.x1 <= panel.bbox.x1
            assert panel.bbox.y0 <= box.y0 < box.y1 <= panel.bbox.y1


def test_names_have_greys_that_differ():
    """Black text on each, and neighbours at least 8 % of white apart."""
    greys = []
    for _, colour in regimes.REGIMES.values():
        red, green, blue = (int(colour[k : k + 2], 16) / 255.0 for k in (1, 3, 5))
        greys.append(0.299 * red + 0.587 * green + 0.114 * blue)
    assert min(greys) > 0.5
    assert min(np.diff(sorted(greys))) > 0.08
