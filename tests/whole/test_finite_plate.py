"""The contact in a finite plate, from its outline to peak pressures."""

import pytest

from fastpin import MATERIALS, Material, MaterialPair, Problem, solve
from fastpin.bodies import Ring
from fastpin.lugs import Lug, plate_compliance
from tests.support.lugs import disc, make_rough, plate
from tests.support.tiers import for_gate


def rough_compliance(lug, order):
    with pytest.MonkeyPatch.context() as patch:
        make_rough(patch)
        return plate_compliance(lug, order).compliance


@pytest.fixture(scope="module")
def compliance():
    return rough_compliance(plate(), 10)


@pytest.mark.gate
@pytest.mark.parametrize(("friction", "peak"), [(0.0, 0.563799), (0.4, 0.465304)])
def test_peaks_agree_with_finite_elements(compliance, friction, peak):
    """The peaks were computed with a matrix of 10 harmonics from finite elements of the plate."""
    like = Material(MATERIALS["steel"].E, 0.3)
    pair = MaterialPair(like, like, plane="strain")
    problem = Problem(pair, 1.0, 0.1 * pair.beta_star, friction, pin_load="body", plate_body=compliance)
    assert solve(problem, [{"P": 1.0}], nodes=401)[-1].peak_pressure == pytest.approx(peak, rel=3e-5)


@pytest.fixture(scope="module")
@for_gate
def uneven():
    """A plate that presses unevenly on a pin with interference."""
    return rough_compliance(plate((-1.6, 3.0), (-1.3, 5.0)), 24)


def interference(body, friction, **fields):
    like = Material(MATERIALS["steel"].E, 0.3)
    pair = MaterialPair(like, like, plane="strain")
    return Problem.from_load_parameter(pair, -0.2, friction, plate_body=body, **fields)


@pytest.mark.parametrize("fields", [{}, {"rotation": "fixed"}, {"drive": "both"}], ids=str)
@pytest.mark.parametrize("friction", [0.0, 0.1, 0.5])
def test_an_interference_fit_in_an_uneven_plate_is_in_equilibrium_without_load(uneven, friction, fields):
    """Pressure and shear vary round the hole. The forces vanish, unless the pin is held in the concentric position."""
    state = solve(interference(uneven, friction, **fields), [{}], nodes=121)[-1]
    assert max(state.residuals.values()) < 1e-11
    assert state.pressure.max() > 1.5 * state.pressure.min() > 0.0
    assert state.shear.any() == (friction > 0.0)
    assert (abs(state.resultants["P"]) < 1e-12) == ("drive" not in fields)


def test_the_assembly_with_friction_keeps_the_balance_of_energy(uneven):
    """The error falls like the square of the node distance: 8e-6 with 121 nodes, 7e-7 with 401."""
    for state in solve(interference(uneven, 0.3), [{}, {"P": 0.6}, {"Q": 0.2}, {"Q": -0.2}], nodes=401):
        assert state.work == pytest.approx(state.energy + state.dissipation, abs=3e-6)


def test_both_methods_follow_an_interference_fit_in_an_uneven_plate(uneven):
    corners = [{}, {"P": 0.6}, {"Q": 0.2}, {"Q": -0.2}]
    path = solve(interference(uneven, 0.3), corners, nodes=121)
    increment = solve(interference(uneven, 0.3), corners, nodes=121, method="increment")
    for one, other in zip(path, increment, strict=True):
        assert one.pressure == pytest.approx(other.pressure, abs=1e-3)
        assert one.shear == pytest.approx(other.shear, abs=1e-3)


@pytest.mark.gate
def test_an_interference_fit_in_a_held_disc_is_that_in_a_ring():
    body = rough_compliance(Lug(0.3, "strain", 1.0, disc(2.0), supports={"rim": "both"}), 12)
    found = solve(interference(body, 0.3), [{}, {"P": 0.5}], nodes=121)
    expected = solve(interference(Ring(2.0), 0.3), [{}, {"P": 0.5}], nodes=121)
    for one, other in zip(found, expected, strict=True):
        assert one.pressure == pytest.approx(other.pressure, abs=1e-7)
