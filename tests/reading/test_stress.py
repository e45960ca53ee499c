"""Stresses inside pin and plate: closed forms, equilibrium, limits at the edge, and stored values."""

import math

import numpy as np
import pytest

from fastpin import Grid, InputError, Material, MaterialPair, Points, Problem, solve
from fastpin.elasticity.stress import pin_stress, plate_stress
from fastpin.elasticity.tractions import Tractions
from fastpin.kernels.status import OPEN
from fastpin.reading.stress import tractions_of
from fastpin.states.quantities import QUANTITIES
from tests.support.tiers import for_gate

LIKE = MaterialPair(Material(1.0, 0.3), Material(1.0, 0.3))
UNLIKE = MaterialPair(Material(2.1, 0.3), Material(0.7, 0.2), "stress")
BOTTOM = -0.5 * math.pi
ANGLES = np.radians([-90, -60, -120, -30, -150, 0, 180, 90, 45, 135])


def problem(pair=LIKE, pin_load="body"):
    return Problem.from_load_parameter(pair, 0.05, 0.55, pin_load)


def round_tractions(pressure, shear, n=1200):
    """Tractions all round from functions of the angle."""
    theta = -1.5 * np.pi + 2.0 * np.pi * np.arange(n + 1) / n
    return Tractions((np.column_stack([theta, pressure(theta) + 0.0 * theta, shear(theta) + 0.0 * theta]),))


def some_tractions(seed=4, moment=True):
    rng = np.random.default_rng(seed)
    nodes = np.sort(rng.uniform(-3.0, -0.3, 40))
    values = np.column_stack([nodes, rng.uniform(0.2, 1.0, 40), rng.uniform(-0.5, 0.6, 40)])
    values[[0, -1], 1:] = 0.0
    if not moment:
        bump = np.interp(nodes, [nodes[0], nodes[20], nodes[-1]], [0.0, 1.0, 0.0])
        values[:, 2] -= bump * np.trapezoid(values[:, 2], nodes) / np.trapezoid(bump, nodes)
    return Tractions((values,))


def cartesian(components, theta):
    """Complex normal and shear tractions on a circle turned into x and y: the force (x + iy) per radius and angle."""
    radial, _, shear = components
    return (radial + 1j * shear) * np.exp(1j * theta)


def stresses(body, case, tractions, theta, depth, remote=(0.0, 0.0, 0.0, 0.0)):
    """Radial, hoop and shear stress in a body. The remote stress acts on the plate."""
    if body == "plate":
        return plate_stress(case, tractions, np.array(remote), theta, depth)
    return pin_stress(case, tractions, theta, depth)


# --- closed forms ---------------------------------------------------------------------------------------------


def test_lame_and_uniform_shear():
    theta, depth = np.linspace(-3.0, 3.0, 15), np.linspace(0.0, 0.9, 15)
    pressed = round_tractions(lambda _: 2.0, lambda _: 0.0)
    square = (1.0 + depth) ** -2
    radial, hoop, shear = plate_stress(problem(), pressed, np.zeros(4), theta, depth)
    assert radial == pytest.approx(-2.0 * square, abs=1e-13)
    assert hoop == pytest.approx(2.0 * square, abs=1e-13)
    assert shear == pytest.approx(0.0 * square, abs=1e-13)
    for pin_load in ("body", "centre"):
        radial, hoop, shear = pin_stress(problem(pin_load=pin_load), pressed, theta, depth)
        assert np.array([radial, hoop]) == pytest.approx(-2.0, abs=1e-13)
        assert shear == pytest.approx(0.0, abs=1e-13)
    turned = round_tractions(lambda _: 0.0, lambda _: 1.0)
    assert plate_stress(problem(), turned, np.zeros(4), theta, depth)[2] == pytest.approx(square, abs=1e-13)
    found = pin_stress(problem(), turned, theta, depth)
    assert found[2] == pytest.approx((1.0 - depth) ** -2.0, rel=1e-11)
    assert found[:2] == pytest.approx(0.0, abs=1e-10)


# --- what holds for any tractions -----------------------------------------------------------------------------


@pytest.mark.parametrize("pin_load", ["centre", "body"])
def test_resultants_through_circles(pin_load):
    """Round every circle in the plate the stress carries the force of the tractions and the moment."""
    tractions, case, n = some_tractions(), problem(UNLIKE, pin_load), 4000
    theta = -np.pi + 2.0 * np.pi * np.arange(n) / n
    pressure, shear = tractions.coefficients(1)
    force = 2.0 * np.pi * np.conj(pressure[1] + 1j * shear[1])
    for radius in (1.3, 2.0, 7.0):
        found = plate_stress(case, tractions, np.array([0.4, 0.1, -0.3, 0.0]), theta, np.full(n, radius - 1.0))
        assert radius * 2.0 * np.pi * cartesian(found, theta).mean() == pytest.approx(-force, abs=1e-12)
        assert radius**2 * found[2].mean() == pytest.approx(shear[0].real, abs=1e-12)
    for radius in (1.0 / 150.0, 0.02, 0.3, 0.49, 0.51, 0.8):
        found = pin_stress(case, tractions, theta, np.full(n, 1.0 - radius))
        inside = -force * (1.0 if pin_load == "centre" else radius**2)
        assert radius * 2.0 * np.pi * cartesian(found, theta).mean() == pytest.approx(inside, abs=1e-11)
        assert radius**2 * found[2].mean() == pytest.approx(shear[0].real, abs=1e-12)


@pytest.mark.parametrize("pin_load", ["centre", "body"])
def test_the_series_near_the_centre_continues_the_closed_form(pin_load):
    case, tractions, theta = problem(UNLIKE, pin_load), some_tractions(), np.linspace(-3.0, 3.0, 20)
    inside, outside = (pin_stress(case, tractions, theta, np.full(20, 0.5 + side * 1e-12)) for side in (1.0, -1.0))
    assert inside == pytest.approx(outside, abs=1e-9)


def test_the_centre_of_a_pin_under_a_body_force_is_regular():
    case, tractions = problem(), some_tractions(moment=False)
    found = pin_stress(case, tractions, np.array([0.0, 0.3]), np.array([1.0, 1.0 - 1e-9]))
    turned = found[0, 0] + found[1, 0], found[0, 1] + found[1, 1]
    assert turned[0] == pytest.approx(turned[1], abs=1e-8)
    assert np.isfinite(found).all()


def test_a_very_narrow_contact_keeps_its_force():
    """Far away the stress is the one of a point force; the nodes are 1e-8 apart."""
    half = 1e-6
    angle = half * np.linspace(-1.0, 1.0, 201)
    hat = np.interp(angle, [-half, 0.0, half], [0.0, 1.0 / half, 0.0])
    tractions = Tractions((np.column_stack([BOTTOM + angle, hat, 0.0 * angle]),))
    wide = np.array([[BOTTOM - 1e-3, 0.0, 0.0], [BOTTOM, 1e3, 0.0], [BOTTOM + 1e-3, 0.0, 0.0]])
    theta, depth = np.linspace(-3.0, 3.0, 7), np.full(7, 0.5)
    for body in ("plate", "pin"):
        narrow, other = (stresses(body, problem(), each, theta, depth) for each in (tractions, Tractions((wide,))))
        assert narrow == pytest.approx(other, abs=1e-5)
    assert tractions.coefficients(1)[0][1] == pytest.approx(np.exp(-1j * BOTTOM) / (2.0 * np.pi), rel=1e-10)


# --- states ---------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
@for_gate
def states():
    """A pin under P, then Q to and fro: like bodies, body force, 1,601 nodes."""
    return solve(problem(), [{"P": 1.0}, {"Q": 0.275}, {"Q": -0.275}, {"Q": 0.275}], nodes=1601)


HOOP = {
    (0, "plate"): [-0.10485, -0.06089, -0.06089, 0.39358, 0.39358, 0.42938, 0.42938, -0.05471, 0.07475, 0.07475],
    (0, "pin"): [-0.10485, -0.13443, -0.13443, -0.48298, -0.48298, -0.11776, -0.11776, -0.04292, -0.05251, -0.05251],
    (1, "plate"): [-0.10951, -0.09284, 0.16631, 0.30557, 0.69796, 0.60373, 0.29883, -0.03471, 0.17668, 0.00987],
    (1, "pin"): [-0.10951, -0.16638, -0.33966, -0.57099, -0.25263, -0.15301, -0.07320, -0.03637, -0.04832, -0.04067],
    (2, "plate"): [-0.11953, 0.12764, 0.08307, 0.68569, 0.33451, 0.30164, 0.57257, -0.02951, 0.01548, 0.17759],
    (2, "pin"): [-0.11954, -0.28971, -0.42290, -0.22756, -0.63331, -0.06322, -0.10906, -0.02879, -0.03349, -0.03643],
    (3, "plate"): [-0.11918, 0.04641, 0.16514, 0.32110, 0.65872, 0.58465, 0.29951, -0.02982, 0.17817, 0.01472],
    (3, "pin"): [-0.11918, -0.37094, -0.34082, -0.61231, -0.20152, -0.12207, -0.06202, -0.02940, -0.03794, -0.03365],
}
"""Hoop stress at ANGLES in F/R, from another program with the same formulas, good to 2e-5."""

INSIDE = {
    (0, "plate"): [(-0.25711, 0.34919, -0.11329), (-0.42742, -0.02049, 0.0), (0.06721, 0.12479, 0.05001)],
    (0, "pin"): [(-0.29932, -0.41935, -0.16069), (-0.42067, -0.12095, 0.0), (-0.02263, -0.27303, 0.04200)],
    (1, "plate"): [(0.02333, 0.50398, -0.02825), (-0.44608, -0.01007, -0.01713), (0.00399, 0.13538, 0.00894)],
    (1, "pin"): [(-0.03012, -0.32434, -0.07929), (-0.43070, -0.14899, -0.04263), (-0.09676, -0.30219, 0.12027)],
    (2, "plate"): [(-0.42432, 0.29651, -0.04959), (-0.46370, -0.00809, -0.00037), (0.06528, 0.11290, 0.06335)],
    (2, "pin"): [(-0.47179, -0.56786, -0.07428), (-0.44082, -0.17586, 0.02049), (-0.01974, -0.22743, -0.04385)],
}
"""(srr, stt, srt) at depths .05, .2, .5 R and angles -150, -90, 0 degrees, good to 1e-5."""


@pytest.mark.parametrize(("step", "body"), HOOP)
def test_hoop_stress_against_stored_values(states, step, body):
    """The stored values take straight lines between the nodes, which are 2e-5 off next to an edge."""
    assert states[step].hoop_stress(body, ANGLES, straight=True) == pytest.approx(HOOP[step, body], abs=2e-5)
    assert states[step].hoop_stress(body, ANGLES) == pytest.approx(HOOP[step, body], abs=4e-5)


@pytest.mark.parametrize(("step", "body"), INSIDE)
def test_stress_inside_against_stored_values(states, step, body):
    points = Points.at_depth([0.05, 0.2, 0.5], np.radians([-150, -90, 0]))
    for straight, tolerance in ((True, 1e-5), (False, 2e-5)):
        found = states[step].stress(points, body, straight)
        components = np.column_stack([found.radial, found.hoop, found.shear])
        assert components == pytest.approx(np.array(INSIDE[step, body]), abs=tolerance)


def test_points_by_depth_radius_and_coordinates_agree(states):
    state = states[1]
    depth, theta = np.array([[0.01], [0.2]]), np.array([-1.4, 0.3, 2.0])
    by_depth = state.stress(Points.at_depth(depth, theta))
    assert by_depth.radial.shape == (2, 3)
    by_radius = state.stress(Points.at_radius(1.0 + depth, theta))
    radius = 1.0 + depth
    by_xy = state.stress(Points.at_xy(radius * np.cos(theta), radius * np.sin(theta)))
    for field in ("sxx", "syy", "sxy", "axial", "von_mises", "tresca"):
        assert getattr(by_radius, field) == pytest.approx(getattr(by_depth, field), abs=1e-12)
        assert getattr(by_xy, field) == pytest.approx(getattr(by_depth, field), abs=1e-12)


def test_invariants_are_the_ones_of_the_tensor(states):
    found = states[1].stress(Points.at_depth(np.geomspace(1e-6, 3.0, 12), np.linspace(-3.0, 3.0, 12)))
    for k in range(12):
        tensor = np.array([[found.sxx[k], found.sxy[k], 0], [found.sxy[k], found.syy[k], 0], [0, 0, found.axial[k]]])
        values = np.linalg.eigvalsh(tensor)[::-1]
        assert found.principal[k] == pytest.approx(values, abs=1e-13)
        deviator = tensor - np.eye(3) * np.trace(tensor) / 3.0
        assert found.von_mises[k] == pytest.approx(math.sqrt(1.5 * np.sum(deviator**2)), abs=1e-13)
        assert found.tresca[k] == pytest.approx(values[0] - values[2], abs=1e-13)
        assert found.hydrostatic[k] == pytest.approx(np.trace(tensor) / 3.0, abs=1e-14)
        assert found.axial[k] == pytest.approx(0.3 * (found.sxx[k] + found.syy[k]), abs=1e-13)


def test_units_are_of_the_problem():
    """In SI units the stresses are those of the dimensionless problem times F/R."""
    pair = MaterialPair(Material(70e9, 0.3), Material(70e9, 0.3))
    force, radius = 1e6, 5e-3
    clearance = 0.05 * force * pair.beta_star  # L_p = clearance/(F beta*)
    steel = Problem(pair, hole_radius=radius, clearance=clearance, friction=0.55, pin_load="body")
    plain = Problem.from_load_parameter(LIKE, steel.load_parameter(force), 0.55, "body")
    one = solve(steel, [{"P": force, "sxx": 2e7}], nodes=201)[-1]
    two = solve(plain, [{"P": 1.0, "sxx": 2e7 * radius / force}], nodes=201)[-1]
    for body in ("plate", "pin"):
        found = one.stress(Points.at_depth(0.1 * radius, ANGLES), body)
        expected = two.stress(Points.at_depth(0.1, ANGLES), body)
        assert found.sxx * radius / force == pytest.approx(expected.sxx, abs=1e-6)


def test_a_state_without_contact_has_the_stress_of_the_hole():
    state = solve(problem(), [{"P": 1.0}, {"P": 0.0, "sxx": 1.0}], nodes=101)[-1]
    if not state.in_contact:
        assert state.hoop_stress("plate", [0.0, BOTTOM]) == pytest.approx([-1.0, 3.0], abs=1e-12)
        assert np.all(state.hoop_stress("pin") == 0.0)


def test_contacts_round_the_circle_and_across_its_end():
    fit = Problem.from_load_parameter(LIKE, -0.1, 0.3, "body")
    state = solve(fit, [{"P": 0.1}], nodes=121)[-1]
    assert state.hoop_stress().shape == (121,)
    assert len(tractions_of(state.grid, state.status, state.pressure, state.shear).patches) == 1
    assert tractions_of(state.grid, state.status, state.pressure, state.shear).all_round
    across = Grid.circle(144, BOTTOM)  # the contact lies across the first node
    one = solve(problem(), [{"P": 1.0}], grid=across)[-1]
    two = solve(problem(), [{"P": 1.0}], grid=Grid.circle(144, BOTTOM - np.pi))[-1]
    assert one.hoop_stress("plate", ANGLES) == pytest.approx(two.hoop_stress("plate", ANGLES), abs=1e-11)
    assert (one.status != OPEN)[0]


@pytest.mark.parametrize(
    ("points", "body", "message"),
    [
        (Points.at_radius(0.9, 0.0), "plate", "radius: must be at least the hole's radius of 1 in the plate"),
        (Points.at_radius(1.1, 0.0), "pin", "radius: must be at most the hole's radius of 1 in the pin"),
        (Points.at_depth(1.1, 0.0), "pin", "depth: must be at most the radius of 1 in the pin"),
        (Points.at_radius(1.1, 0.0), "hub", 'body: must be "plate", "pin" or "seat"'),
        ([1.0, 2.0], "plate", "points: must be fastpin.Points"),
    ],
)
def test_points_outside_the_body_are_refused(states, points, body, message):
    with pytest.raises(InputError, match=message):
        states[0].stress(points, body)


def test_bad_points_are_refused():
    for make, field in (
        (lambda: Points.at_depth(-1.0, 0.0), "depth"),
        (lambda: Points.at_radius(math.nan, 0.0), "radius"),
        (lambda: Points.at_xy("a", 0.0), "x"),
        (lambda: Points.at_depth([0.1, 0.2], [0.0, 1.0, 2.0]), "depth"),
    ):
        with pytest.raises(InputError, match=field):
            make()


def test_infinite_and_undetermined_stresses_are_refused():
    centre = solve(problem(pin_load="centre"), [{"P": 1.0}], nodes=61)[-1]
    with pytest.raises(InputError, match="the force acts at the centre of the pin"):
        centre.stress(Points.at_radius([0.0, 0.5], 0.0), "pin")
    assert np.isfinite(solve(problem(), [{"P": 1.0}], nodes=61)[-1].stress(Points.at_xy(0.0, 0.0), "pin").sxx)
    rigid = Problem.from_load_parameter(MaterialPair(Material.rigid(), Material(1.0, 0.3)), 0.1, 0.3)
    with pytest.raises(InputError, match="the pin is rigid"):
        solve(rigid, [{"P": 1.0}], nodes=61)[-1].hoop_stress("pin")


@pytest.mark.parametrize(
    ("step", "contact", "pressure", "largest", "smallest"),
    [
        (0, (-74.0976, 74.0976), 0.979002, (0.76075, -74.1148), (-0.49372, 65.0)),
        (1, (-58.7178, 89.4704), 1.062404, (0.78681, -58.7407), (-0.6345, 73.5)),
        (2, (-89.1229, 58.3706), 1.102576, (0.79088, 58.3878), (-0.7322, -58.5)),
        (3, (-58.3935, 89.1477), 1.099672, (0.74277, -57.8378), (-0.7220, 58.0)),
    ],
)
def test_extremes_of_straight_lines_against_stored_values(states, step, contact, pressure, largest, smallest):
    """The largest hoop stress of the plate and the smallest of the pin, with straight lines between 1,601 nodes."""
    state = states[step]
    assert np.degrees(state.contact[0]) + 90.0 == pytest.approx(contact, abs=2e-3)
    assert QUANTITIES["pressure_integral"].of(state) == pytest.approx(pressure, abs=1e-6)
    value, angle = largest
    around = np.radians(angle - 90.0) + np.linspace(-2e-3, 2e-3, 4001)
    assert state.hoop_stress("plate", around, straight=True).max() == pytest.approx(value, abs=1e-5)
    grid = np.radians(np.arange(-180.0, 180.0, 0.5) - 90.0)
    hoop = state.hoop_stress("pin", grid, straight=True)
    value, angle = smallest
    assert hoop.min() == pytest.approx(value, abs=6e-5 if step else 1e-5)
    assert hoop[np.isclose(np.degrees(grid) + 90.0, angle)] == pytest.approx(value, abs=6e-5)
