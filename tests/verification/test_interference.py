"""Closed forms of interference fits: against the solver, against Lame's formulas, limits between bodies, refusals.

:data:`BODIES` lists the bodies that the tests of the solver run through.
"""

import math
from typing import Any

import numpy as np
import pytest

from fastpin import MATERIALS, InputError, Material, MaterialPair, Problem, State, solve
from fastpin.bodies import Bushing, Plate, Ring, Tube
from fastpin.kernels.status import OPEN, STICK
from fastpin.verification import interference
from fastpin.verification.comparisons import all_round_difference, event_load
from fastpin.verification.joint_rows import BRONZE
from tests.support.refusals import refused

LIKE = MaterialPair(Material(70e9, 0.3), Material(70e9, 0.3))
UNLIKE = MaterialPair(MATERIALS["Ti-6Al-4V"], MATERIALS["aluminium"])
STRESSED = MaterialPair(Material(210e9, 0.3), Material(69e9, 0.33), "stress")
NODES = 200

BODIES: dict[str, tuple[MaterialPair, dict[str, Any]]] = {
    "like": (LIKE, {}),
    "like, body load": (LIKE, {"pin_load": "body"}),
    "unlike": (UNLIKE, {}),
    "unlike, body load": (UNLIKE, {"pin_load": "body"}),
    "plane stress": (STRESSED, {}),
    "tube": (LIKE, {"pin_body": Tube(0.5)}),
    "held tube": (UNLIKE, {"pin_body": Tube(0.4, "held")}),
    "tube, body load": (LIKE, {"pin_body": Tube(0.6, "body")}),
    "ring": (UNLIKE, {"plate_body": Ring(2.0, "normal")}),
    "held ring, body load": (UNLIKE, {"plate_body": Ring(2.0, "held"), "pin_load": "body"}),
    "tube in ring": (STRESSED, {"pin_body": Tube(0.6, "shear"), "plate_body": Ring(3.0, "uniform")}),
    "bush": (STRESSED, {"plate_body": Bushing(BRONZE, 1.25)}),
    "bush in ring": (LIKE, {"plate_body": Bushing(BRONZE, 1.25, inside=Ring(2.5, "held"))}),
    "tube, bush, ring": (
        UNLIKE,
        {"pin_body": Tube(0.5, "shear"), "plate_body": Bushing(BRONZE, 1.3, inside=Ring(2.0, "normal"))},
    ),
}
"""Materials, and further fields of the problem, of bodies that carry the force symmetrically."""

SOLID = ("like", "like, body load", "unlike", "unlike, body load", "plane stress")
"""The solid pins in infinite plates among them, which carry a remote stress in closed form."""

every_body = pytest.mark.parametrize("name", BODIES)
every_solid = pytest.mark.parametrize("name", SOLID)


def fit(name: str, friction: float) -> Problem:
    pair, fields = BODIES[name]
    return Problem.from_load_parameter(pair, -0.3, friction, **fields)


def solved(problem: Problem, load: dict[str, float], nodes: int = NODES) -> State:
    return solve(problem, [load], nodes=nodes)[-1]


def opens(state: State) -> bool:
    return bool(np.any(state.status == OPEN))


def slips(state: State) -> bool:
    return bool(np.any(state.status != STICK))


def assert_second_order(states: list[State]) -> None:
    """The differences from the closed form, with NODES nodes and with twice as many."""
    errors = [all_round_difference(state) for state in states]
    assert errors[1] < 2e-5
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.05)


# -- the solver against the closed forms ---------------------------------------------------------------------


@every_body
@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_the_pressure_is_uniform_without_loads(name, friction):
    problem = fit(name, friction)
    state = solved(problem, {"P": 0.0})
    assert state.pressure == pytest.approx(interference.uniform_pressure(problem), rel=1e-11)
    assert np.abs(state.shear).max() < 1e-11


@every_body
def test_without_friction_a_force_adds_a_cosine_until_the_top_opens(name):
    problem = fit(name, 0.0)
    opening = interference.frictionless_opening_load(problem)
    load = {"P": 0.7 * opening, "Q": -0.6 * opening}  # 0.92 of the opening load, at an angle
    assert_second_order([solved(problem, load, nodes) for nodes in (NODES, 2 * NODES)])
    found = event_load(problem, "P", (0.9 * opening, 1.1 * opening), opens, NODES)
    assert found == pytest.approx(opening, rel=1e-4)


@every_body
def test_a_stuck_contact_under_a_force(name):
    problem = fit(name, 0.3)
    size = 0.9 * interference.first_slip_load(problem)
    load = {"P": 0.8 * size, "Q": 0.6 * size}
    states = [solved(problem, load, nodes) for nodes in (NODES, 2 * NODES)]
    assert all(np.all(state.status == STICK) for state in states)
    assert_second_order(states)


@every_body
@pytest.mark.parametrize("friction", [0.3, 0.1, 1.0])
def test_the_first_place_slips_where_the_closed_form_says(name, friction):
    problem = fit(name, friction)
    exact, ratio = interference.first_slip_load(problem), interference.stuck_ratio(problem)
    found = event_load(problem, "P", (0.9 * exact, 1.1 * exact), slips, NODES)
    assert found == pytest.approx(exact, rel=1e-4)
    state = solved(problem, {"P": 1.0001 * found}, NODES)
    place = friction * (1.0 + ratio) / math.hypot(1.0 - ratio, friction * (1.0 + ratio))
    assert np.sin(state.theta[state.status != STICK]) == pytest.approx(place, abs=0.03)


@every_body
def test_a_contact_with_much_friction_opens_like_a_bonded_one(name):
    """With mu = 10 slip still takes up to 4.5e-3 off the load (tube in ring); the grid adds up to 8e-5."""
    problem = fit(name, 10.0)
    exact = interference.bonded_opening_load(problem)
    found = event_load(problem, "P", (0.9 * exact, 1.1 * exact), opens, NODES)
    assert 0.995 * exact < found < 1.0001 * exact


@pytest.mark.parametrize("name", [name for name, (_, fields) in BODIES.items() if fields.get("pin_load") != "body"])
def test_the_whole_rim_slips_under_a_moment(name):
    problem = fit(name, 0.3)
    limit = interference.first_slip_moment(problem)
    below = solved(problem, {"M": 0.999 * limit})
    assert np.all(below.status == STICK)
    assert all_round_difference(below) < 1e-12
    held = Problem.from_load_parameter(BODIES[name][0], -0.3, 0.3, rotation="fixed", **BODIES[name][1])
    turned = solve(held, [{"rotation": 5.0}], nodes=NODES)[-1]  # a free pin would turn without end
    assert np.all(turned.status != STICK)
    assert abs(turned.resultants["M"]) == pytest.approx(limit, rel=1e-12)


@every_solid
@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_remote_stress(name, friction):
    problem = fit(name, friction)
    pressure = interference.uniform_pressure(problem)
    load = {"sxx": 0.1 * pressure, "syy": -0.05 * pressure, "sxy": 0.04 * pressure, "P": 0.1 * pressure}
    states = [solved(problem, load, nodes) for nodes in (NODES, 2 * NODES)]
    assert friction == 0.0 or all(np.all(state.status == STICK) for state in states)
    assert_second_order(states)


@every_solid
def test_equal_tension_releases_the_pin(name):
    problem = fit(name, 0.0)
    stress = interference.release_stress(problem)
    before, after = (solved(problem, {"sxx": part * stress, "syy": part * stress}) for part in (0.999, 1.001))
    assert before.pressure == pytest.approx(1e-3 * interference.uniform_pressure(problem), rel=1e-9)
    assert not after.in_contact


@pytest.mark.parametrize("clearance", [-0.05, -1.0])
def test_opening_over_the_uniform_pressure_does_not_depend_on_the_interference(clearance):
    found = {}
    for friction in (0.1, 0.5):
        problem = Problem.from_load_parameter(LIKE, clearance, friction)
        pressure = interference.uniform_pressure(problem)
        bounds = 3.0 * pressure, 3.7 * pressure
        found[friction] = event_load(problem, "P", bounds, opens, NODES)
        found[friction] /= pressure
    assert found == pytest.approx({0.1: 3.413035, 0.5: 3.639759}, abs=3e-6)


def test_the_event_comes_after_the_bounds():
    problem = fit("like", 0.0)
    assert math.isnan(event_load(problem, "P", (0.1, 0.2), opens, 50))


# -- the closed forms against other formulas -----------------------------------------------------------------


def test_numbers_of_like_bodies():
    """nu = 0.3, plane strain: the limits of the table in docs/interference.md."""
    problem = Problem.from_load_parameter(LIKE, -0.25, 0.3)
    pressure = interference.uniform_pressure(problem)
    assert pressure == pytest.approx(1.0)  # 1/2G + (kappa - 1)/4G is beta*/4 for like bodies
    assert interference.stuck_ratio(problem) == pytest.approx(2.0 / 2.8)
    assert interference.frictionless_opening_load(problem) == pytest.approx(math.pi)
    assert interference.bonded_opening_load(problem) == pytest.approx(3.66519, abs=5e-6)
    slip = [
        interference.first_slip_load(Problem.from_load_parameter(LIKE, -0.25, friction))
        for friction in (0.1, 0.3, 0.5, 1.0)
    ]
    assert slip == pytest.approx([1.88573, 3.20395, 3.47711, 3.61532], abs=6e-6)


@pytest.mark.parametrize("plane", ["strain", "stress"])
def test_uniform_pressure_of_a_tube_in_a_ring(plane):
    """Lame's thick-walled cylinders, by E and nu."""
    pin, ring = Material(210e9, 0.3), Material(69e9, 0.33)
    problem = Problem(
        MaterialPair(pin, ring, plane), 0.01, -1e-5, 0.2, pin_body=Tube(0.004), plate_body=Ring(0.025, "uniform")
    )
    moduli = [m.E / (1.0 - m.nu**2) if plane == "strain" else m.E for m in (pin, ring)]
    ratios = [m.nu / (1.0 - m.nu) if plane == "strain" else m.nu for m in (pin, ring)]
    inner = ((1.0 + 0.4**2) / (1.0 - 0.4**2) - ratios[0]) / moduli[0]
    outer = ((1.0 + 0.4**2) / (1.0 - 0.4**2) + ratios[1]) / moduli[1]
    assert interference.uniform_pressure(problem) == pytest.approx(1e-3 / (inner + outer), rel=1e-12)


@pytest.mark.parametrize("name", SOLID)
def test_other_bodies_tend_to_the_solid_pin_in_the_plate(name):
    pair, fields = BODIES[name]
    solid = Problem(pair, 0.01, -1e-5, 0.3, **fields)
    bush = Bushing(pair.plate, 0.015)
    others = [
        Problem(pair, 0.01, -1e-5, 0.3, plate_body=bush, **fields),
        Problem(pair, 0.01, -1e-5, 0.3, plate_body=Ring(100.0, "uniform"), **fields),
    ]
    load = "body" if fields else "uniform"
    others.append(Problem(pair, 0.01, -1e-5, 0.3, pin_body=Tube(1e-6, load)))
    for function in (interference.uniform_pressure, interference.stuck_ratio, interference.first_slip_load):
        assert [function(other) for other in others] == pytest.approx([function(solid)] * 3, rel=1e-7)


def test_a_bush_that_is_pressed_in_adds_to_the_interference():
    bush = Bushing(Material(110e9, 0.34), 0.0125, interference=1e-5)
    problem = Problem(UNLIKE, 0.01, 2e-6, 0.2, plate_body=bush)
    assert problem.assembled_clearance < 0.0
    loose = Problem(UNLIKE, 0.01, problem.assembled_clearance, 0.2, plate_body=Bushing(bush.material, 0.0125))
    assert interference.uniform_pressure(problem) == pytest.approx(interference.uniform_pressure(loose), rel=1e-12)


def test_a_held_ring_is_stiffer_than_a_plate_and_a_free_ring_softer():
    plates = [Ring(0.02, "held"), Plate(), Ring(0.02, "uniform")]
    pressures = [interference.uniform_pressure(Problem(LIKE, 0.01, -1e-5, 0.2, plate_body=plate)) for plate in plates]
    assert pressures[0] > 1.1 * pressures[1] > 1.2 * pressures[2]


# -- what is refused -----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("field", "load"),
    [
        ("M", {"M": 0.1}),
        ("rotation", {"rotation": 0.1}),
        ("ux", {"ux": 0.1}),
        ("theta", {}),
        ("P of load", {"P": math.inf}),
    ],
)
def test_loads_without_a_closed_form(field, load):
    problem = fit("like, body load", 0.3)
    theta = "round" if field == "theta" else 0.0
    assert refused(interference.stuck_tractions, problem, theta, load).field == field


def test_no_moment_without_friction():
    with pytest.raises(InputError, match="carries no moment"):
        interference.frictionless_pressure(fit("like", 0.0), 0.0, {"M": 0.1})


@pytest.mark.parametrize(
    ("plate", "load", "sentence"),
    [
        (Plate(reaction=(0.0, 0.05)), {"P": 1.0}, "symmetrically"),
        (Ring(0.02, "half"), {"P": 1.0}, "symmetrically"),
        (Bushing(MATERIALS["steel"], 0.015, inside=Ring(0.03, "half")), {"P": 1.0}, "symmetrically"),
        (Ring(0.02), {"sxx": 1.0}, "infinite plate only"),
    ],
)
def test_bodies_without_a_closed_form(plate, load, sentence):
    problem = Problem(LIKE, 0.01, -1e-5, 0.2, plate_body=plate)
    with pytest.raises(InputError, match=sentence):
        interference.stuck_tractions(problem, 0.0, load)


def test_fits_without_interference():
    for function in (
        interference.frictionless_opening_load, interference.bonded_opening_load, interference.first_slip_load,
        interference.first_slip_moment,
    ):  # fmt: skip
        with pytest.raises(InputError, match="must be negative after assembly"):
            function(Problem(LIKE, 0.01, 0.0, 0.2))


def test_rigid_bodies():
    rigid = Problem(MaterialPair(MATERIALS["steel"], Material.rigid()), 0.01, -1e-5, 0.2)
    assert interference.uniform_pressure(rigid) > 0.0
    with pytest.raises(InputError, match="rigid plate"):
        interference.release_stress(rigid)
    squeezed = MaterialPair(Material(1e9, 0.5), Material.rigid())
    with pytest.raises(InputError, match="changes no radius"):
        interference.uniform_pressure(Problem(squeezed, 0.01, 1e-5, 0.2))
