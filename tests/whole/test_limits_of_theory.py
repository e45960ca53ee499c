"""Half-planes and rigid pins: from where on they are right, and how the solutions tend to them."""

import math
from functools import cache

import numpy as np
import pytest

from docs.beyond import rigid_pin
from docs.beyond.figures import FIGURES
from fastpin import Problem, solve
from fastpin.assess.outputs import Curve
from fastpin.published import catalog, half_plane
from fastpin.published.records import PaperFigure
from fastpin.verification import closed_forms
from tests.support.tiers import gate


def figure_of(name: str) -> PaperFigure:
    return FIGURES[name] if name in FIGURES else catalog.figure(name)


@cache
def computed(name: str) -> list[Curve]:
    chosen = figure_of(name)
    return chosen.compute(chosen.least_nodes)


def error_curve(quantity: str) -> Curve:
    (curve,) = (curve for curve in computed("half-plane") if curve.parameters["quantity"] == quantity)
    return curve


def order(curve: Curve, first: float, last: float) -> float:
    """Power of 1/L_p with which the error falls between two load parameters."""
    inside = (curve["L_p"] > 0.99 * first) & (curve["L_p"] < 1.01 * last) & np.isfinite(curve["error"])
    assert np.count_nonzero(inside) >= 3
    return -np.polyfit(np.log(curve["L_p"][inside]), np.log(np.abs(curve["error"][inside])), 1)[0]


# --- half-planes ---------------------------------------------------------------------------------------------


@pytest.mark.gate
@pytest.mark.parametrize(
    ("quantity", "first", "last", "expected"),
    [
        *gate(("half-width", 4.0, 50.0, 1.0)),
        ("peak pressure", 4.0, 100.0, 1.0),
        ("peak pressure, with friction", 4.0, 50.0, 1.0),
        ("stick size, +Q", 4.0, 25.0, 1.0),
        ("stick size, +Q, mu = 0.2", 20.0, 250.0, 1.0),
        ("peak shear, +Q", 20.0, 1000.0, 0.5),
        ("peak shear, -Q", 20.0, 500.0, 0.5),
        ("distribution, moved, +Q", 20.0, 2200.0, 0.5),
        ("distribution, moved, -Q", 20.0, 2200.0, 0.5),
        ("distribution, +Q, mu = 0.2", 20.0, 10000.0, 0.5),
        ("shift, balanced", 100.0, 2200.0, 0.5),
    ],
)
def test_order_of_the_error(quantity, first, last, expected):
    assert order(error_curve(quantity), first, last) == pytest.approx(expected, abs=0.15 * expected)


@pytest.mark.gate
@pytest.mark.parametrize(
    ("quantity", "five", "one"),
    [
        *gate(("half-width", 1.65, 8.54)),
        ("peak pressure", 2.34, 12.4),
        ("half-width, with friction", 1.64, 8.5),
        ("peak pressure, with friction", 1.53, 8.28),
        ("stick size, +Q", 0.763, 6.5),
        ("stick size, -Q", 10.0, None),
        ("peak shear, +Q", 9.5, 222.0),
        ("peak shear, -Q", 8.7, None),
        ("distribution, +Q", 42.7, 1100.0),
        ("distribution, -Q", 42.4, 1100.0),
        ("distribution, moved, +Q", 11.2, 260.0),
        ("peak shear, +Q, mu = 0.2", 49.0, 1240.0),
        ("distribution, +Q, mu = 0.2", 82.8, 2090.0),
        ("shift, balanced", 186.0, None),
        ("shift, uniaxial", 157.0, None),
        ("what the stress adds, balanced", 5.4, None),
        ("what the stress adds, uniaxial", 12.8, 146.0),
    ],
)
def test_right_from_this_load_parameter_on(quantity, five, one):
    found = error_curve(quantity).parameters
    assert found["right_to_5_percent_from"] == pytest.approx(five, rel=0.06)
    if one is not None:
        assert found["right_to_1_percent_from"] == pytest.approx(one, rel=0.2)


def test_threshold():
    load_parameter = np.geomspace(0.1, 1e4, 11)
    falling = -0.3 / np.sqrt(load_parameter)
    assert half_plane.threshold(load_parameter, falling, 0.05) == pytest.approx(36.0)
    falling[2] = 1e-4  # a change of sign on the way does not count
    assert half_plane.threshold(load_parameter, falling, 0.05) == pytest.approx(36.0)
    assert half_plane.threshold(load_parameter, falling, 2.0) == 0.0
    assert half_plane.threshold(load_parameter, falling, 1e-3) == math.inf


@pytest.mark.gate
def test_the_half_plane_errs_to_these_sides():
    """Too low in peak pressure and peak shear, too wide in contact."""
    assert np.all(error_curve("half-width")["error"][:8] > 0.0)
    assert np.all(error_curve("peak pressure")["error"][:8] < 0.0)
    assert np.all(error_curve("peak shear, +Q")["error"][:8] < 0.0)
    assert np.all(error_curve("peak shear, -Q")["error"][:8] < 0.0)


@pytest.mark.gate
def test_moving_the_contact_is_half_of_the_difference():
    """The other half is a part of N, not of mu N: shear that conformity makes, whatever the friction."""
    inside = slice(6, 13)
    at_bottom, moved, low = (
        error_curve(f"distribution{what}")["error"][inside] for what in (", +Q", ", moved, +Q", ", moved, +Q, mu = 0.2")
    )
    np.testing.assert_allclose(moved / at_bottom, 0.5, atol=0.06)
    np.testing.assert_allclose(half_plane.LOW_FRICTION * low, half_plane.FRICTION * moved, rtol=0.12)


@pytest.mark.parametrize(("ratio", "stick", "distribution"), [(0.3, 0.0003, 0.0450), (0.9, -0.0351, 0.0666)])
def test_other_amplitudes(ratio, stick, distribution):
    """A stick zone about to vanish is the hardest to tell; the distribution depends little on the amplitude."""
    found = {quantity: error for _, quantity, error in half_plane.like_errors(30.0, 0.5, 301, ratio)}
    assert found["stick size, +Q"] == pytest.approx(stick, abs=2e-3)
    assert found["distribution, +Q"] == pytest.approx(distribution, rel=0.02)


@pytest.mark.parametrize("stress", half_plane.REMOTE)
def test_bulk_stress_shifts_the_stick_zone(stress):
    """Tension moves it to the side to which Q pushes the pin, compression to the other, both by e."""
    problem = Problem.from_load_parameter(half_plane.SIMILAR, 1000.0, half_plane.FRICTION, "centre", "fixed")
    plus, none, minus = (half_plane.bulk_shift(problem, stress, e, 301) for e in (0.15, 0.0, -0.15))
    assert plus - none == pytest.approx(0.15, rel=0.02)
    assert minus - none == pytest.approx(-0.15, rel=0.02)


@pytest.mark.parametrize(("stress", "expected"), [("balanced", 0.0), ("uniaxial", -7.0 / 24.0)])
def test_bulk_stress_changes_the_curvature(stress, expected):
    """The clearance at the bottom grows in proportion to (R beta*/8)(7 sxx - 5 syy), and the half-width falls."""
    load_parameter = 1000.0
    problem = Problem.from_load_parameter(half_plane.SIMILAR, load_parameter, 0.5, "centre", "fixed")
    sigma = 10.0
    remote = {name: sigma * part for name, part in half_plane.REMOTE[stress].items()}
    before, after = solve(problem, [{"P": 1.0}, remote], nodes=401)
    half = [half_plane.stick_and_contact(state)[3] for state in (before, after)]
    assert half[1] / half[0] - 1.0 == pytest.approx(0.5 * expected * sigma / load_parameter, abs=1e-4)


def test_unlike_half_planes_without_coupling_are_spences():
    for ratio in (0.5, 1.0, 1.5):
        found = half_plane.unlike_half_planes(ratio * 1e-6, 1e-6)
        assert found == pytest.approx(closed_forms.spence_stick_ratio(ratio), rel=3e-5)


@pytest.mark.parametrize(
    ("ratio", "limit", "published", "tolerance"),
    [(0.5, 0.1652, 0.169, 0.025), (1.0, 0.6936, 0.679, 0.005), *gate((1.5, 0.9222, 0.918, 0.005))],
)
def test_unlike_materials_tend_to_half_planes(ratio, limit, published, tolerance):
    """Whatever the sign of beta. `published` (a half-space code) is stated to 0.01; the second is off by more."""
    beta = half_plane.BETA
    half_planes = half_plane.unlike_half_planes(ratio * beta, beta)
    assert half_planes == pytest.approx(limit, abs=1e-4)
    assert half_planes == pytest.approx(published, abs=0.015)
    for pair in half_plane.UNLIKE.values():
        problem = Problem.from_load_parameter(pair, 1e6, ratio * beta)
        _, stick, _, contact = half_plane.stick_and_contact(solve(problem, [{"P": 1.0}], nodes=401)[-1])
        assert stick / contact == pytest.approx(half_planes, rel=tolerance)


@pytest.mark.gate
def test_the_sign_of_beta_decides_how_far_unlike_half_planes_reach():
    """And so does the pin's load, of which a half-plane knows nothing."""
    softer_plate, softer_pin = (error_curve(f"mu = 1 |beta|, beta {relation} 0").parameters for relation in "><")
    assert softer_plate["right_to_5_percent_from"] == pytest.approx(2400.0, rel=0.25)
    assert math.isnan(softer_plate["right_to_1_percent_from"])  # these few nodes do not tell
    assert softer_pin["right_to_5_percent_from"] == pytest.approx(8.4, rel=0.25)
    limit = half_plane.unlike_half_planes(half_plane.BETA, half_plane.BETA)
    centre, body = (
        [error for _, _, error in half_plane.unlike_errors(100.0, 1.0, limit, 401, pin_load)]
        for pin_load in rigid_pin.LOADS
    )
    assert centre == pytest.approx([-0.19, 0.01], abs=0.015)
    assert body == pytest.approx([-0.207, 0.125], abs=0.015)


# --- rigid pins ----------------------------------------------------------------------------------------------


@pytest.mark.gate
def test_elastic_pins_tend_to_the_rigid_one_with_the_inverse_of_their_modulus():
    *tractions, differences = computed("rigid-pin")
    for name, values in differences.columns.items():
        if name != "E_pin/E_plate":
            steps = np.log10(values[:-1] / values[1:])
            assert np.all(values[:-1] > values[1:])
            assert steps[-4:] == pytest.approx(0.5, abs=2e-3)
            assert values[0] < 0.12
    centre, body = tractions[-2:]
    assert centre.parameters["pin"] == body.parameters["pin"] == "rigid"
    assert all(np.array_equal(centre[name], body[name]) for name in centre.columns)


# --- both ----------------------------------------------------------------------------------------------------


@pytest.mark.gate
@pytest.mark.parametrize(("name", "panels", "lines"), [("half-plane", 4, 23), ("rigid-pin", 4, 18)])
def test_drawn(name, panels, lines):
    figure = figure_of(name).draw(computed(name))
    figure.draw_without_rendering()
    assert len(figure.axes) == panels
    assert sum(len(line.get_xdata()) > 2 for panel in figure.axes for line in panel.lines) == lines


@pytest.mark.gate
@pytest.mark.parametrize("load_parameter", [3.0, 100.0])
def test_floors_are_above_the_errors_of_the_discretisation(load_parameter):
    """Differences between 201 and 401 nodes are below the floors for 201."""
    coarse, fine = (
        [
            *half_plane.like_errors(load_parameter, 0.5, nodes),
            *half_plane.unlike_errors(load_parameter, 1.0, 0.7, nodes),
        ]
        for nodes in (201, 401)
    )
    for (_, quantity, one), (_, other, two) in zip(coarse, fine, strict=True):
        assert quantity == other
        assert abs(one - two) < half_plane.floor(quantity, 201), quantity


@pytest.mark.gate
def test_half_plane_curves_leave_out_what_the_discretisation_hides():
    for curve in computed("half-plane"):
        least = half_plane.floor(str(curve.parameters["quantity"]), catalog.figure("half-plane").least_nodes)
        assert np.nanmin(np.abs(curve["error"])) >= least
