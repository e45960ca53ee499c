"""The first contact: the slip of its first nodes, pins that the hole grips, and holes that change while it begins."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from fastpin import MATERIALS, Grid, Material, MaterialPair, NoEquilibriumError, Problem, solve
from fastpin.elasticity.system import System
from fastpin.kernels.status import STICK
from fastpin.model import LOADS
from fastpin.model.loads import SXX, UY, M, P, Q
from fastpin.solver import ArcError, first_contact, path
from fastpin.solver.assembly import unloaded_configuration
from tests.support.steps import step_by_step
from tests.support.tiers import seeds
from tests.survey import metamorphic

BOTTOM = -0.5 * np.pi
SOFT_PIN = MaterialPair(Material(1.0, 0.1), Material(10.0, 0.3))
GRIPPED = MaterialPair(Material(10.0, 0.3), Material(6.5, 0.47), "stress")


def error_beside_the_first_node(case, load):
    """Largest error of the shear at the two nodes beside the first one, with 101 nodes, in parts of the peak shear."""
    direction = np.arctan2(-load["P"], load.get("Q", 0.0))
    arc = (direction - 1.2, direction + 1.2)
    coarse, fine = (solve(case, [load], nodes=nodes, arc=arc)[-1] for nodes in (101, 801))
    middle = int(np.argmin(np.abs(coarse.theta - direction)))
    beside = np.array([middle - 1, middle + 1])
    return np.abs(coarse.shear[beside] - fine.shear[8 * beside]).max() / np.abs(fine.shear).max()


STICKING = {"down": {"P": 1.0}, "inclined": {"P": 1.0, "Q": 0.3}}


@pytest.mark.gate
@pytest.mark.parametrize("load", STICKING.values(), ids=STICKING)
@pytest.mark.parametrize("pair", ["unlike", "soft pin"])
def test_the_first_nodes_have_no_kink(monkeypatch, titanium_in_aluminium, pair, load):
    case = {
        "unlike": Problem.from_load_parameter(titanium_in_aluminium, 0.5, 1.0, "centre", "fixed"),
        "soft pin": Problem.from_load_parameter(SOFT_PIN, 2.0, 0.6, "body"),
    }[pair]
    error = error_beside_the_first_node(case, load)
    monkeypatch.setattr(first_contact, "_with_grown_slip", lambda *_: None)
    kinked = error_beside_the_first_node(case, load)
    assert error < 2e-3
    assert kinked > 5e-3
    assert kinked > 10.0 * error


@pytest.mark.parametrize("friction", [0.0, 0.3])
@pytest.mark.parametrize("nodes", [60, 61, 101, 158, 200, 401])
def test_a_hole_grips_a_pin_without_force(nodes, friction):
    case = Problem.from_load_parameter(GRIPPED, 2.54, friction)
    state = solve(case, [{"sxx": -5.11, "syy": 7.13}], nodes=nodes)[-1]
    assert max(state.residuals.values()) < 1e-12
    assert len(state.contact) == 2
    assert state.peak_pressure == pytest.approx(5.615 if friction == 0.0 else 5.359, rel=0.02)


@pytest.mark.parametrize("start", [0.0, 0.01, 0.3])
def test_the_gripping_does_not_depend_on_where_the_nodes_begin(start):
    case = Problem.from_load_parameter(GRIPPED, 2.54, 0.3)
    state = solve(case, [{"sxx": -5.11, "syy": 7.13}], grid=Grid.circle(301, start))[-1]
    assert state.peak_pressure == pytest.approx(5.359, rel=2e-3)


def test_a_pin_gripped_at_three_nodes_begins_as_its_mirror_image():
    """Rounding chooses no node of the three: the load of the first contact, and so the dissipation, is the same."""
    for pair in metamorphic.compare("remote", 93):
        assert pair.difference < 1e-12


def test_a_hole_that_grips_outside_the_arc_is_said_to():
    case = Problem.from_load_parameter(GRIPPED, 2.54, 0.3)
    with pytest.raises(ArcError, match="outside the arc"):
        solve(case, [{"sxx": -5.11, "syy": 7.13}], grid=Grid.arc(BOTTOM - 0.5, BOTTOM + 0.5, 61))


def test_a_pin_that_stays_free_is_not_gripped():
    case = Problem.from_load_parameter(GRIPPED, 2.54, 0.3)
    state = solve(case, [{"sxx": -0.5, "syy": 0.7}], nodes=61)[-1]
    assert not state.in_contact


def test_a_corner_on_the_way_changes_no_first_contact_in_a_hole_that_changes():
    for seed in seeds(4):
        rng = np.random.default_rng(seed)
        pair = MaterialPair(Material(14.7, 0.27), Material(4.6, 0.37))
        case = Problem.from_load_parameter(pair, 9.8, 0.8, "centre", "fixed")
        end = {
            "P": 0.46,
            "Q": -0.37,
            "sxx": -37.0 * rng.uniform(0.5, 1.0),
            "syy": 2.2,
            "sxy": -16.7 * rng.uniform(0.5, 1.0),
        }
        half = {name: 0.5 * value for name, value in end.items()}
        grid = Grid.circle(201)
        whole, split = solve(case, [end], grid=grid)[-1], solve(case, [half, end], grid=grid)[-1]
        assert split.peak_pressure == pytest.approx(whole.peak_pressure, rel=1e-6)
        assert split.dx == pytest.approx(whole.dx, rel=1e-6)


def test_a_drifted_step_goes_back_to_the_last_check(monkeypatch, titanium_in_aluminium):
    """Drift that is called severe too early: the same states, from tableaus that are built anew more often."""
    case = Problem.from_load_parameter(titanium_in_aluminium, 0.1, 0.4, "body")
    history = [{"P": 1.0}, {"Q": 0.3}, {"Q": -0.3}]
    plain = solve(case, history, nodes=201)
    step_by_step(monkeypatch)
    begun = path.HeldColumns.correct
    monkeypatch.setattr(path.HeldColumns, "correct", lambda *given: begun(*given)._replace(drift=1.0))
    again = solve(case, history, grid=plain.grid)
    assert again.statistics["rebuilds"] > plain.statistics["rebuilds"]
    for one, two in zip(plain, again, strict=True):
        assert one.shear == pytest.approx(two.shear, abs=1e-12 * one.pressure.max())


def test_the_end_of_an_arc_near_the_first_node_changes_nothing():
    """The young contact is followed as far as the arc allows, and its slip is the one of a wider arc."""
    pair = MaterialPair(Material(4.3, 0.5), Material(57.0, 0.5), "stress")
    case = Problem.from_load_parameter(pair, 1249.0, 0.64, "centre", "fixed")
    circle, history = Grid.circle(2100, BOTTOM), [{"P": 0.3}, {"P": 0.84, "Q": 0.5}]
    near, far = (
        solve(case, history, grid=Grid(np.r_[circle.theta[-nodes:] - 2.0 * np.pi, circle.theta[:300]]))
        for nodes in (9, 40)
    )
    for state, other in zip(near, far, strict=True):
        assert state.shear == pytest.approx(other.shear[31:], abs=1e-8 * other.peak_pressure)
        assert state.pressure == pytest.approx(other.pressure[31:], abs=1e-8 * other.peak_pressure)


def test_a_node_without_pressure_does_not_stick_in_the_first_contact(titanium_in_aluminium):
    """It would hold the pin on one side of the first node, whichever rounding chooses."""
    case = Problem.from_load_parameter(titanium_in_aluminium, 0.1, 0.4, "body")
    system = System.build(case, Grid.circle(60, BOTTOM), 1.0)
    load = np.eye(len(LOADS))[P]
    resting = unloaded_configuration(system)
    resting.status[:2] = STICK
    resting.gap = system.rest_clearance * (1.0 + np.sin(system.grid.theta))
    resting.rest_gap = resting.gap.copy()
    found = first_contact.shearless_step(system, resting, 1e-9 * load)
    assert np.array_equal(np.flatnonzero(found.closed), [0])
    assert np.all(found.pressure[found.closed] > 0.0)


def test_both_ends_of_an_arc_leave_a_young_contact_the_same_room(titanium_in_aluminium):
    """Eight nodes away from the first node there is just room for the nodes that tell the slip."""
    case = Problem.from_load_parameter(titanium_in_aluminium, 0.1, 0.4, "centre", "fixed")
    found = []
    for before, after in ((8, 40), (40, 8)):
        system = System.build(case, Grid(BOTTOM + 0.02 * np.arange(-before, after + 1.0)), 1.0)
        patch, _ = first_contact.first_contact(
            system, unloaded_configuration(system), np.zeros(len(LOADS)), np.eye(len(LOADS))[P]
        )
        found.append(patch)
    one, other = found
    assert np.count_nonzero(one.slip[one.closed]) > 1
    assert one.slip == pytest.approx(-other.slip[::-1], abs=1e-10 * np.abs(one.slip).max())
    assert one.shear == pytest.approx(-other.shear[::-1], abs=1e-12 * one.pressure.max())


def young_patch(pair, before, after):
    """The system of an arc with nodes before and after the bottom, and three nodes that stick there."""
    case = Problem.from_load_parameter(pair, 0.1, 0.4, "centre", "fixed")
    system = System.build(case, Grid(BOTTOM + 0.02 * np.arange(-before, after + 1.0)), 1.0)
    patch = unloaded_configuration(system)
    patch.status[before - 1 : before + 2], patch.pressure[before] = STICK, 1.0
    return system, patch


@pytest.mark.parametrize(("before", "after"), [(10, 150), (80, 80), (150, 10)])
def test_a_young_contact_is_followed_on_few_nodes(titanium_in_aluminium, before, after):
    system, patch = young_patch(titanium_in_aluminium, before, after)
    around = np.arange(before - first_contact.GROWN_NODES, before + first_contact.GROWN_NODES + 1)
    assert np.array_equal(first_contact._young_nodes(system, patch), around[(around >= 0) & (around <= before + after)])


@pytest.mark.parametrize(("before", "after"), [(5, 40), (40, 5)])
def test_nodes_beyond_an_arc_tell_no_slip(monkeypatch, titanium_in_aluminium, before, after):
    """Even where a contact has grown to one side only."""
    system, patch = young_patch(titanium_in_aluminium, before, after)
    grown = replace(patch, status=np.full(system.grid.size, STICK))
    monkeypatch.setattr(first_contact, "PathStep", lambda *_: SimpleNamespace(follow=lambda _: grown))
    assert first_contact._grown_slip(system, patch, patch.load) is None


@pytest.mark.parametrize("load", [{P: 1.0}, {P: 0.6, Q: -0.8}], ids=["down", "inclined"])
def test_a_neat_fit_begins_where_the_force_points(titanium_in_aluminium, load):
    """Its gap is 0 all round."""
    case = Problem(titanium_in_aluminium, 1.0, 0.0, 0.4)
    system = System.build(case, Grid.circle(80), 1.0)
    after = np.zeros(len(LOADS))
    after[list(load)] = list(load.values())
    resting, begins = first_contact.at_rest(system, unloaded_configuration(system), np.zeros(len(LOADS)), after)
    pushed = np.argmax(after[Q] * np.cos(system.grid.theta) - after[P] * np.sin(system.grid.theta))
    assert begins == 0.0
    assert set(np.flatnonzero(resting.closed)) == {int(node) % 80 for node in pushed + np.arange(-2, 3)}


@pytest.mark.parametrize(("slippery", "limit"), [(-1.0, "0.0995"), (1.0, None)])
def test_the_friction_where_the_pin_touches_limits_a_moment(titanium_in_aluminium, slippery, limit):
    """A moment lets the pin climb to one side of the hole. There friction must carry the moment."""
    problem = Problem.from_load_parameter(titanium_in_aluminium, 0.2, 0.5)
    system = System.build(problem, Grid.circle(121), 1.0)
    side = np.cos(system.grid.theta) * slippery
    system = replace(system, friction=np.where(side > 0.0, 0.1, 0.5))
    nothing = unloaded_configuration(system)
    after = np.zeros(len(LOADS))
    after[[P, M]] = 1.0, 0.3
    if limit is not None:
        with pytest.raises(NoEquilibriumError, match=rf"more than friction can carry \({limit}\)"):
            first_contact.first_contact(system, nothing, 0.0 * after, after)
        return
    now, _ = first_contact.first_contact(system, nothing, 0.0 * after, after)
    assert np.cos(system.grid.theta[now.closed]).max() < 0.0


def test_the_first_contact_of_a_driven_pin_does_not_depend_on_the_start_of_its_step():
    """The hole may change by the same curvature while the first nodes close, however long the pin was on its way."""
    problem = Problem.from_load_parameter(
        MaterialPair(Material(1.0, 0.3), Material(1.0, 0.3), "strain"), 0.3, 0.3, "centre", drive="uy"
    )
    system = System.build(problem, Grid.arc(BOTTOM - 1.2, BOTTOM + 1.2, 41), 1.0)
    load = np.zeros(len(LOADS))
    load[[UY, SXX]] = -0.31, 1.0
    loads = []
    for begin in (0.0, 0.5):
        now, part = first_contact.first_contact(system, unloaded_configuration(system), begin * load, load)
        loads.append(begin + part * (1.0 - begin))
        assert now.load == pytest.approx(loads[-1] * load)
    assert loads[0] == pytest.approx(loads[1], rel=1e-12)


def test_a_neat_fit_that_no_arc_can_hold_is_tried_once_at_each_grid(monkeypatch):
    """In a neat fit smaller loads have the same statuses. Under compression the pin touches at both sides."""
    tried = []
    one_step = first_contact.one_step
    monkeypatch.setattr(first_contact, "one_step", lambda *given: (tried.append(given), one_step(*given))[1])
    pair = MaterialPair(MATERIALS["Ti-6Al-4V"], Material(54e9, 0.31), "stress")
    problem = Problem(pair, 3e-3, 0.0, 0.2)
    state = solve(problem, [{"P": 0.75e6, "syy": -97e6}, {"P": 1.5e6, "syy": -195e6}], nodes=61)[-1]
    assert len(tried) < 12
    assert max(state.residuals.values()) < 1e-12
