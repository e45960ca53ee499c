"""Initial gaps: exact relations, the table of reference, several contacts, grips, resumed runs and sessions."""

import functools
import math
import pickle

import numpy as np
import pytest

import fastpin
from fastpin import Grid, InputError, Material, Problem, solve
from fastpin.bodies import Bushing, Ring
from fastpin.elasticity.system import System
from fastpin.kernels.status import STICK
from fastpin.model import LOADS, InitialGap, Profile
from fastpin.model.angles import BOTTOM
from fastpin.model.profile_terms import Crown, Flat, Harmonic, Samples
from fastpin.solver import ArcError
from fastpin.solver.driven import can_float
from fastpin.solver.rest import hole_gap, rest_position
from fastpin.verification import interference
from fastpin.verification.comparisons import all_round_difference
from fastpin.verification.finite_elements import LIKE, UNLIKE
from tests.support.checks.integral_equations import residuals_away
from tests.support.once import solve_once
from tests.support.programs import assert_same_bits

CIRCLE = Grid.circle(120)
FRETTED = [{"P": 1.0}, {"Q": 0.2}, {"Q": -0.2, "P": 0.5}, {"P": 0.9}]


def gap(*terms, pin=()):
    return InitialGap(Profile(terms), Profile(pin))


def most_different(ones, others):
    """Largest difference of the tractions of two results, over the peak pressure."""
    return max(
        float(np.abs([one.pressure - other.pressure, one.shear - other.shear]).max()) / one.peak_pressure
        for one, other in zip(ones, others, strict=True)
    )


# --- exact relations ---------------------------------------------------------------------------------------------


def test_the_closed_form_of_other_bodies_holds_in_a_bush():
    bodies = {"plate_body": Bushing(Material(0.5, 0.3), 1.4, inside=Ring(3.0))}
    problem = Problem.from_load_parameter(UNLIKE, -0.3, 1e6, gap=gap(Harmonic(2, 0.02, 0.01)), **bodies)
    (state,) = solve(problem, [{"P": 0.0}], grid=CIRCLE)
    assert np.all(state.status == STICK)
    assert all_round_difference(state) < 7e-5


@pytest.mark.parametrize("order", [2, 3])
def test_the_closed_forms_are_those_of_a_solid_pin_in_an_infinite_plate(order):
    """g+ = [k_I/G_I + 1/G]/(n + 1) and g- = [1/G_I + k/G]/(n - 1); T_n = -a (g+ - g-)/(R g+ g-)."""
    problem = Problem.from_load_parameter(LIKE, -0.3, 0.5, gap=gap(Harmonic(order, 0.02)))
    both = problem.pair.pin_compliance * (problem.pair.pin_kolosov + 1.0)
    first, last = both / (order + 1.0), both / (order - 1.0)
    theta, even = np.linspace(-3.0, 3.0, 7), interference.uniform_pressure(problem)
    pressure, shear = interference.stuck_tractions(problem, theta, {})
    stuck = -0.02 * (first + last) / (first * last), -0.02 * (first - last) / (first * last)
    assert pressure == pytest.approx(even + stuck[0] * np.cos(order * theta), rel=1e-12)
    assert shear == pytest.approx(stuck[1] * np.sin(order * theta), abs=1e-12 * even)
    smooth = interference.frictionless_pressure(problem, theta, {})
    assert smooth == pytest.approx(even - 0.08 / (first + last) * np.cos(order * theta), rel=1e-12)


def test_no_closed_form_for_the_first_slip_of_an_uneven_fit():
    problem = Problem.from_load_parameter(LIKE, -0.3, 0.5, gap=gap(Harmonic(2, 0.02)))
    with pytest.raises(InputError, match="gap: must be the same all round") as caught:
        interference.first_slip_load(problem)
    assert pickle.loads(pickle.dumps(caught.value)).args == caught.value.args
    with pytest.raises(InputError, match="gap: must be a sum of harmonics"):
        interference.uniform_pressure(Problem.from_load_parameter(LIKE, -0.3, 0.5, gap=gap(Crown(0.1, 0.0, 1.0))))


ROUND = Problem.from_load_parameter(UNLIKE, 0.3, 0.4, "body")


def test_a_constant_is_an_interference_too():
    """The uniform pressure is -clearance over the uniform compliance."""
    one = Problem.from_load_parameter(UNLIKE, -0.2, 0.4)
    two = Problem.from_load_parameter(UNLIKE, 0.1, 0.4, gap=gap(pin=(Harmonic(0, -0.3),)))
    states = [solve(problem, FRETTED, grid=CIRCLE) for problem in (one, two)]
    assert two.is_gripped
    assert most_different(*states) < 1e-12


# --- the table of reference --------------------------------------------------------------------------------------

G = {
    "G1": (
        Problem.from_load_parameter(LIKE, 0.1, 0.3, "body", gap=gap(Harmonic(6, -0.03))),
        [{"P": 0.02}, {"P": 0.2}, {"P": 1.0}, {"Q": 0.2}, {"Q": -0.2}],
        [(0, "contacts", 2, 0), (1, "contacts", 2, 0), (1, "peak", 0.3763, 6e-4), (1, "width", 0.69, 8e-3),
         (2, "peak", 0.8696, 5e-4),
         (2, "bottom", 0.1922, 5e-4), (4, "peak", 0.9590, 5e-4), (4, "bottom", 0.2100, 5e-4), (4, "sum", 1.09076, 3e-5),
         (4, "dx", -0.04866, 1e-5)],
    ),
    "G2": (
        Problem.from_load_parameter(
            UNLIKE, 0.1, 0.4, "centre", "fixed", gap=gap(Harmonic(2, 0.02, 0.03), Harmonic(3, 0.02))
        ),
        [{"P": 0.02}, {"P": 0.2}, {"P": 1.0}, {"Q": 0.2}, {"Q": -0.2}],
        [(0, "contacts", 2, 0), (1, "contacts", 1, 0), (4, "peak", 0.6757, 6e-5), (4, "bottom", 0.6456, 1.5e-4),
         (4, "sum", 1.1698, 1e-4), (4, "shear", 0.0133, 5e-4), (4, "dx", -0.0896 + 0.09908, 6e-5)],
    ),
    "G3": (
        Problem.from_load_parameter(LIKE, -0.05, 0.3, "body", gap=gap(pin=(Harmonic(2, 0.03),))),
        [{"P": 0.2}, {"P": 1.0}, {"Q": 0.2}],
        [(0, "bottom", 0.36480, 6e-5), (1, "bottom", 0.56029, 6e-5), (2, "bottom", 0.56825, 6e-5),
         (2, "peak", 0.56975, 6e-5), (2, "sum", 1.30527, 1e-5), (2, "dx", 0.00399, 1e-5),
         (2, "rotation", -0.00223, 1e-5)],
    ),
}  # fmt: skip
"""Problem, history, and readings of the table: state, name, value with 960 nodes, largest difference with 240."""


def reading(state, name):
    return {
        "contacts": len(state.contact),
        "width": sum(stop - start for start, stop in state.contact),
        "peak": state.peak_pressure,
        "bottom": state.pressure[np.argmin(np.abs(state.theta - BOTTOM))],
        "sum": state.grid.weights @ state.pressure,
        "shear": state.grid.weights @ state.shear,
        "dx": state.dx,
        "rotation": state.rotation,
    }[name]


@pytest.mark.parametrize("name", G)
def test_the_table_of_reference(name):
    """G1 has nodes of its own choice: on a circle of 240 nodes its first contacts have two nodes each."""
    problem, history, expected = G[name]
    states = solve(problem, history, **({"nodes": 161} if name == "G1" else {"grid": Grid.circle(240)}))
    for place, quantity, value, most in expected:
        assert reading(states[place], quantity) == pytest.approx(value, abs=most), (place, quantity)


# --- several contacts --------------------------------------------------------------------------------------------

LOBES = {
    "2, gripped": (UNLIKE, ("centre", "fixed"), 0.1, Harmonic(2, 0.2, 0.05), [2, 1, 1, 2]),
    "2": (LIKE, ("body", "free"), 0.1, Harmonic(2, -0.048, -0.015), [2, 1, 1, 1]),
    "3": (UNLIKE, ("centre", "fixed"), 0.1, Harmonic(3, 0.028, 0.009), [2, 1, 1, 1]),
    "6": (LIKE, ("body", "free"), 0.1, Harmonic(6, -0.019, -0.006), [2, 1, 1, 1]),
    "20": (UNLIKE, ("centre", "fixed"), 0.05, Harmonic(20, 0.019, 0.006), None),
}


@pytest.mark.parametrize("name", LOBES)
def test_several_contacts_work_and_merge(name):
    """The conditions hold to rounding: measured 5e-15."""
    pair, support, clearance, wave, contacts = LOBES[name]
    problem = Problem.from_load_parameter(pair, clearance, 0.3, *support, gap=gap(wave))
    states = solve_once(problem, [{"P": 0.05}, {"P": 1.0}, {"Q": 0.2}, {"Q": -0.2, "P": 0.6}], nodes=160)
    assert problem.is_gripped == name.endswith("gripped")
    found = [len(state.contact) for state in states]
    assert found == contacts if contacts else min(found) > 4
    assert max(max(state.residuals.values()) for state in states) < 1e-13
    work, energy = states[-1].work, states[-1].energy + states[-1].dissipation
    assert work == pytest.approx(energy, rel=3e-3)


@pytest.mark.parametrize("friction", [0.5, 0.7])
def test_places_that_touch_together_close_as_mirror_images(friction):
    """With less friction than the slope of the hole, tan 29 degrees = 0.55, both contacts slide at first."""
    problem = Problem.from_load_parameter(LIKE, 0.1, friction, "body", gap=gap(Harmonic(6, -0.03)))
    states = solve(problem, [{"P": 0.05}, {"P": 0.2}, {"P": 1.0}], grid=Grid.circle(240, BOTTOM))
    mirror = -np.arange(240) % 240
    for state in states:
        assert state.pressure == pytest.approx(state.pressure[mirror], abs=1e-11 * state.peak_pressure)
        assert state.shear == pytest.approx(-state.shear[mirror], abs=1e-11 * state.peak_pressure)
        assert abs(state.rotation) < 1e-12


def test_a_fit_may_touch_in_some_places_only():
    """The pressure of a frictionless fit is the least energy of pressures that only push, with any shift of the pin."""
    problem = Problem.from_load_parameter(UNLIKE, -0.02, 0.0, gap=gap(Harmonic(2, 0.2, 0.1), Harmonic(3, 0.02)))
    (state,) = solve(problem, [{"P": 0.0}], grid=CIRCLE)
    assert len(state.contact) == 2
    system = System.build(problem, CIRCLE, 1.0)
    n = CIRCLE.size
    compliance, shift = system.operator.entries(np.arange(n), np.arange(n)), system.motion[:n, :2]
    closed = state.pressure > 0.0
    known = np.r_[-system.concentric_gap[closed], np.zeros(2)]
    matrix = np.block([[compliance[np.ix_(closed, closed)], shift[closed]], [shift[closed].T, np.zeros((2, 2))]])
    solved = np.linalg.solve(matrix, known)
    opened = system.concentric_gap + compliance[:, closed] @ solved[:-2] + shift @ solved[-2:]
    assert np.all(solved[:-2] > 0.0)
    assert np.all(opened[~closed] > 0.0)
    assert state.pressure[closed] == pytest.approx(solved[:-2], rel=1e-11)


# --- where the pin rests -----------------------------------------------------------------------------------------


def resting(problem, angle=BOTTOM):
    system = System.build(problem, CIRCLE, 1.0)
    return system, rest_position(system, np.zeros(len(LOADS)), angle)


def test_a_pin_rests_on_two_places_to_the_last_digits():
    problem = Problem.from_load_parameter(LIKE, 0.1, 0.3, gap=gap(Harmonic(6, -0.03)))
    system, (position, rest_gap) = resting(problem)
    fine = np.linspace(-math.pi, math.pi, 200_001)
    left = hole_gap(system, np.zeros(len(LOADS)), fine)[0] - position[0] * np.cos(fine) - position[1] * np.sin(fine)
    assert abs(position[0]) < 1e-15
    for side in (fine < BOTTOM, fine > BOTTOM):
        assert left[side].min() == pytest.approx(0.0, abs=1e-9)  # the angles are 3e-5 rad apart
    there = np.interp(CIRCLE.theta, fine, left, period=2.0 * math.pi)
    assert rest_gap == pytest.approx(there, abs=1e-9)


def test_a_pin_that_fits_beside_the_middle_floats():
    """It may touch nothing although it would overlap the hole in the middle."""
    problem = Problem.from_load_parameter(LIKE, 0.3, 0.3, gap=gap(Harmonic(1, 0.5, -0.2)))
    assert not problem.is_gripped
    assert problem.clearances[0] < 0.0
    first, pushed, floating, again = solve(problem, [{"P": 0.0}, {"P": 1.0}, {"P": 0.0}, {"P": 1.0}], grid=CIRCLE)
    assert not first.in_contact
    assert not floating.in_contact
    assert floating.gap.min() >= 0.0
    assert again.pressure == pytest.approx(pushed.pressure, abs=1e-12)


@pytest.mark.parametrize(("size", "gripped"), [(0.09, False), (0.1, False), (0.11, True)])
def test_an_oval_hole_grips_where_its_short_axis_is_too_short(size, gripped):
    problem = Problem.from_load_parameter(LIKE, 0.1, 0.3, gap=InitialGap(Profile.ellipse(size, 0.3)))
    assert problem.is_gripped == gripped
    assert solve(problem, [{"P": 0.0}], grid=CIRCLE)[0].in_contact == gripped


def test_a_held_displacement_grips_beside_the_room():
    """Driven along x the pin can't move into the room that a first wave leaves there."""
    wave = gap(Harmonic(1, 0.5))
    assert not Problem.from_load_parameter(LIKE, 0.3, 0.3, "centre", "fixed", gap=wave, drive="uy").is_gripped
    driven = Problem.from_load_parameter(LIKE, 0.3, 0.3, "centre", "fixed", gap=wave, drive="ux")
    assert driven.is_gripped
    gripped, free = solve(driven, [{"ux": 0.0}, {"ux": 0.5}], grid=CIRCLE)
    assert gripped.in_contact
    assert not free.in_contact
    assert can_float(System.build(driven, CIRCLE, 1.0), np.where(np.array(LOADS) == "ux", 0.5, 0.0))


@pytest.mark.gate
@pytest.mark.parametrize("drive", ["ux", "uy", "both"])
def test_driven_pins_meet_an_oval_hole_where_they_touch_it(drive):
    """The prescribed displacement is that of the hub. A contact begins where the gap of the rigid pin is used up."""
    problem = Problem.from_load_parameter(
        UNLIKE, 0.1, 0.3, "centre", "fixed", drive=drive, gap=gap(Harmonic(2, 0.02, 0.03), Harmonic(5, 0.005))
    )
    way = {"ux": {"ux": 0.4}, "uy": {"uy": -0.4}, "both": {"ux": 0.2, "uy": -0.3}}[drive]
    back = dict.fromkeys(way, 0.0)
    other = {} if drive == "both" else {"P" if drive == "ux" else "Q": 0.01}
    states = solve(problem, [way | other, back | dict.fromkeys(other, 0.0), way], nodes=101)
    assert [state.in_contact for state in states] == [True, False, True]
    assert max(max(state.residuals.values()) for state in states) < 1e-12


# --- arcs, grids, resumed runs and sessions ----------------------------------------------------------------------

CROWNED = Problem.from_load_parameter(
    UNLIKE, 0.4, 0.4, gap=gap(Crown(-0.05, -1.2, 0.8), pin=(Harmonic(2, 0.01, 0.02),))
)


def test_an_arc_is_chosen_where_a_coarse_run_proves_one():
    found = solve_once(CROWNED, FRETTED, nodes=101)
    assert not found.grid.closed
    whole = solve(CROWNED, FRETTED, grid=Grid.circle(160, BOTTOM))
    for one, other in zip(found, whole, strict=True):
        assert one.peak_pressure == pytest.approx(other.peak_pressure, rel=1e-3)
        assert one.contact[0] == pytest.approx(other.contact[0], abs=2e-3)


def test_a_place_beyond_an_arc_is_found():
    """The pin rests on two places, of which the arc has one."""
    problem = G["G1"][0]
    with pytest.raises(ArcError, match="give a wider one, or none"):
        solve(problem, [{"P": 0.05}], nodes=101, arc=(-2.6, -1.4))


def test_a_gripped_pin_needs_the_whole_circle():
    problem = Problem.from_load_parameter(LIKE, 0.1, 0.3, gap=InitialGap(Profile.ellipse(0.2)))
    with pytest.raises(InputError, match="arc: an interference fit is in contact all round"):
        solve(problem, [{"P": 1.0}], nodes=101, arc=(-3.0, 0.0))


@pytest.mark.parametrize("order", [2, 3])
def test_narrow_contacts_have_a_graded_grid(order):
    """L_p = 2000: two places, or one place aside, of a thousandth of the hole."""
    wave = Harmonic(order, -100.0, 20.0)
    problem = Problem.from_load_parameter(UNLIKE, 2000.0, 0.3, "centre", "fixed", gap=gap(wave))
    first, *_, last = solve(problem, [{"P": 0.05}, {"P": 1.0}, {"Q": 0.2}], nodes=81)
    assert last.grid.size >= 81
    assert 0.0 < last.contact[0][1] - last.contact[0][0] < 0.1
    assert max(max(state.residuals.values()) for state in (first, last)) < 1e-9


def test_a_resumed_run_has_the_same_bits():
    whole = solve_once(CROWNED, FRETTED, nodes=101)
    first = solve(CROWNED, FRETTED[:2], grid=whole.grid)
    second = solve(CROWNED, FRETTED[2:], start=first)
    assert_same_bits(whole, [*first, *second])
    other = Problem.from_load_parameter(UNLIKE, 0.4, 0.4, gap=gap(Harmonic(2, 0.01)))
    with pytest.raises(InputError, match="not the same: gap"):
        solve(other, FRETTED[2:], start=first)


def test_a_session_changes_the_gap_and_takes_it_back():
    """The gap needs no new matrices. The states are those of the whole history on the same nodes."""
    session = fastpin.Session(ROUND, nodes=81)
    for corner in FRETTED:
        session.advance(corner)
    plain = session.state
    worn = gap(Harmonic(3, 0.02, 0.03))
    changed = session.change(gap=worn)
    expected = solve(session.problem, FRETTED, grid=changed.grid)
    assert changed.grid.size == plain.grid.size
    assert np.array_equal(changed.pressure, expected[-1].pressure)
    assert np.array_equal(session.undo().pressure, plain.pressure)
    assert np.array_equal(session.redo().shear, expected[-1].shear)


def test_a_session_on_an_arc_grows_to_a_place_beyond_it():
    """A moment's push to the other side of an uneven hole."""
    problem = Problem.from_load_parameter(LIKE, 0.1, 0.7, "body", gap=gap(Harmonic(6, -0.03)))
    session = fastpin.Session(problem, nodes=121)
    session.advance({"P": 0.2})
    state = session.advance({"P": 0.1, "Q": 0.3})
    assert state.in_contact
    assert max(state.residuals.values()) < 1e-12
    whole = solve(problem, [{"P": 0.2}, {"P": 0.1, "Q": 0.3}], grid=state.grid)
    assert state.peak_pressure == pytest.approx(whole[-1].peak_pressure, rel=1e-9)


def test_error_bars_hold_the_error():
    """Against more than twice the nodes; measured: bars of 1.3e-3."""
    problem = Problem.from_load_parameter(LIKE, 0.1, 0.3, "body", gap=gap(Harmonic(2, 0.02, 0.01), Harmonic(3, 0.01)))
    history = [{"P": 1.0}, {"Q": 0.2}]
    coarse = solve(problem, history, grid=Grid.circle(102, BOTTOM), error_bars=True)
    fine = solve(problem, history, grid=Grid.circle(240, BOTTOM))
    for one, other in zip(coarse, fine, strict=True):
        assert abs(one.peak_pressure - other.peak_pressure) <= one.error_bars["peak_pressure"] < 2e-3


def test_cycles_with_a_gap_repeat():
    cycle = [{"Q": 0.1}, {"Q": -0.1}]
    result = solve(CROWNED, [{"P": 1.0}, *cycle * 6], nodes=81)
    whole = solve(CROWNED, [{"P": 1.0}, *cycle * 6], grid=result.grid, shortcut=False)
    assert np.array_equal(result[-1].pressure, whole[-1].pressure)


# --- other methods, and bad input --------------------------------------------------------------------------------

SMOOTH = {
    "waves": gap(Harmonic(2, 0.01, 0.02), Harmonic(3, 0.005)),
    "samples": gap(Samples(np.linspace(-3.0, 3.0, 12), 0.01 * np.cos(3.0 * np.linspace(-3.0, 3.0, 12)))),
}


@functools.cache
def pushed(name, nodes):
    (state,) = solve(Problem.from_load_parameter(UNLIKE, 0.1, 0.4, "body", gap=SMOOTH[name]), [{"P": 1.0}], nodes=nodes)
    return state


@pytest.mark.parametrize("name", SMOOTH)
def test_the_integral_equations_hold_with_a_gap(name):
    """Measured with 101, 201 and 401 nodes: (46) 7.5e-5, 2.1e-5, 5.6e-6, (47) 1.7e-5, 2.4e-6, 4.6e-7."""
    coarse, fine = (residuals_away(pushed(name, nodes), 0.12) for nodes in (101, 201))
    assert max(coarse[0], 3.0 * fine[0]) < 1e-4
    assert max(coarse[1], 5.0 * fine[1]) < 3e-5


def test_a_flat_needs_lengths():
    with pytest.raises(InputError, match="a flat has no meaning in a dimensionless problem"):
        Problem.from_load_parameter(LIKE, 0.1, 0.3, gap=gap(Flat(0.01, 0.0)))


def test_a_pin_rests_on_the_edges_of_its_flat():
    """Steel, R = 10 mm, a flat of 20 um at the bottom: its chord is 2 sqrt(2 R depth) = 1.26 mm long."""
    pair = fastpin.MaterialPair(Material(210e9, 0.3), Material(210e9, 0.3))
    problem = Problem(pair, 0.01, 20e-6, 0.3, gap=gap(pin=(Flat(20e-6, BOTTOM),)))
    (state,) = solve(problem, [{"P": 1e5}], nodes=201)
    half = math.acos(1.0 - 20e-6 / 0.01)
    assert len(state.contact) == 2
    for (start, stop), edge in zip(sorted(state.contact), (BOTTOM - half, BOTTOM + half), strict=True):
        assert start - 0.01 < edge < stop + 0.01


@pytest.mark.gate
def test_a_neat_fit_beside_the_middle_is_a_neat_fit():
    """Complete unloading too. Measured: 2e-14."""
    neat, shifted = (
        Problem.from_load_parameter(UNLIKE, 0.0, 0.3, "body", gap=wave) for wave in (gap(), gap(Harmonic(1, 0.3, -0.2)))
    )
    assert not shifted.is_gripped
    history = [{"P": 1.0, "Q": 0.2}, {"P": 0.0, "Q": 0.0}, {"P": 0.5}]
    one, other = (solve(problem, history, grid=CIRCLE) for problem in (neat, shifted))
    for place in (0, 2):
        assert most_different([one[place]], [other[place]]) < 2e-13
    assert not other[1].in_contact
