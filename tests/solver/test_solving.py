"""Bad input that only Python can have, and the constants of materials. tests/whole/test_bad_input.py has the rest."""

import math

import pytest

from fastpin import MATERIALS, FastpinError, InputError, LoadHistory, Material, MaterialPair, Problem, solve
from tests.support.refusals import refused

STEEL = Material(210e9, 0.3)
PAIR = MaterialPair(STEEL, STEEL)


def problem(**changes):
    given = {"pair": PAIR, "hole_radius": 0.01, "clearance": 1e-5, "friction": 0.3, **changes}
    return Problem(**given)


def plain(**changes):
    return Problem.from_load_parameter(PAIR, 0.1, 0.3, **changes)


@pytest.mark.parametrize(
    ("make", "field"),
    [
        (lambda: MaterialPair(Material.rigid(), Material.rigid()), "plate"),
        (lambda: MaterialPair(STEEL, STEEL, "planar"), "plane"),
        (lambda: MaterialPair(STEEL, 70e9), "plate"),
        (lambda: MaterialPair.from_dundurs(1.2, 0.0, 0.3), "alpha"),
        (lambda: MaterialPair.from_dundurs(0.3, 0.5, 0.3), "beta"),
        (lambda: problem(pin_load="body", rotation="fixed"), "rotation"),
        (lambda: problem(rotation="fixed", hub_radius=0.02), "hub_radius"),
        (lambda: problem(pair="steel"), "pair"),
        (lambda: LoadHistory([]), "history"),
        (lambda: LoadHistory([{"P": math.nan}]), "P of corner 1"),
        (lambda: LoadHistory([{"P": 1.0}, {"F": 1.0}]), "corner 2"),
        (lambda: LoadHistory([1.0]), "history"),
        (lambda: LoadHistory.monotonic(0, P=1.0), "steps"),
        (lambda: LoadHistory.cycles({"P": 1.0}, {"Q": 1.0}, 0), "count"),
        (lambda: LoadHistory.cycles({"P": 1.0}, {"Q": 1.0}, start=0), "start"),
        (lambda: LoadHistory([{"P": 1.0}]).repeated(0), "count"),
        (lambda: solve(plain(), []), "history"),
        (lambda: solve(plain(), 5), "history"),
        (lambda: solve(plain(), [{"P": 1.0}], grid=5), "grid"),
        (lambda: solve(plain(), [{"P": 1.0}], start=5), "start"),
        (lambda: solve("problem", [{"P": 1.0}]), "problem"),
        (lambda: solve(plain(pin_load="body"), [{"P": 1.0, "M": 0.1}]), "M"),
        (lambda: solve(plain(rotation="fixed"), [{"P": 1.0, "M": 0.1}]), "M"),
        (lambda: solve(plain(), [{"P": 1.0, "rotation": 0.1}]), "rotation"),
        (lambda: solve(problem(clearance=-1e-5), [{"P": 1.0}], arc=(-2.5, -0.5)), "arc"),
    ],
)
def test_bad_input_names_its_field(make, field):
    error = refused(make)
    assert error.field == field
    assert isinstance(error, FastpinError)
    assert isinstance(error, ValueError)
    assert len(error.reason.split()) > 4


def test_the_papers_restriction_is_explained():
    with pytest.raises(InputError, match="uniform body forces can't bear the moment"):
        problem(pin_load="body", rotation="fixed")
    with pytest.raises(InputError, match="section 4 of the paper"):
        solve(plain(pin_load="body"), [{"P": 1.0, "M": 0.1}])


def test_a_result_of_another_problem_can_not_be_gone_on_from():
    result = solve(plain(), [{"P": 1.0}], nodes=31)
    sentence = "another problem; not the same: pin_load; only the loads and options of the solver may differ"
    with pytest.raises(InputError, match=sentence):
        solve(plain(pin_load="body"), [{"Q": 0.1}], start=result)


# --- materials ----------------------------------------------------------------------------------------------


def test_composite_constants_of_the_papers_pair():
    pair = MaterialPair(MATERIALS["Ti-6Al-4V"], MATERIALS["aluminium"])
    assert pair.dundurs("paper") == pytest.approx((-0.2507, -0.0595), abs=1e-4)
    assert pair.dundurs("usual") == pytest.approx((0.2507, 0.0595), abs=1e-4)
    G, G_I = 69e9 / 2.66, 116e9 / 2.64
    k, k_I = 3.0 - 4.0 * 0.33, 3.0 - 4.0 * 0.32
    assert pair.alpha_star == pytest.approx((k - 1.0) / G - (k_I - 1.0) / G_I)
    assert pair.beta_star == pytest.approx((k + 1.0) / (2.0 * G) + (k_I + 1.0) / (2.0 * G_I))
    assert pair.gamma == pytest.approx(pair.beta_star + 0.5 * pair.alpha_star - 2.0 / G_I)
    assert pair.gamma_prime - pair.gamma == pytest.approx(4.0 / G_I)
    assert pair.gamma_body + pair.gamma_body_prime == pytest.approx(pair.gamma + pair.gamma_prime)
    # 1/(G_I beta*) = (1 + alpha^D)/(kappa_I + 1) * 2 / 2 in the paper's sign
    assert pair.pin_compliance / pair.beta_star == pytest.approx((1.0 + pair.dundurs("paper")[0]) / (k_I + 1.0))


@pytest.mark.parametrize("plane", ["strain", "stress"])
@pytest.mark.parametrize("convention", ["usual", "paper"])
def test_dundurs_round_trip(plane, convention):
    pair = MaterialPair(Material(200e9, 0.28), Material(70e9, 0.34), plane)
    again = MaterialPair.from_dundurs(*pair.dundurs(convention), 0.28, plane, convention, pair.beta_star)
    assert pytest.approx(200e9) == again.pin.E
    assert pytest.approx(70e9) == again.plate.E
    assert again.plate.nu == pytest.approx(0.34)


def test_rigid_limits_of_dundurs_pairs():
    pair = MaterialPair(Material.rigid(), Material(70e9, 0.3))
    alpha, beta = pair.dundurs()
    assert alpha == 1.0
    again = MaterialPair.from_dundurs(alpha, beta, 0.3, beta_star=pair.beta_star)
    assert again.pin.is_rigid
    assert again.plate.nu == pytest.approx(0.3)
    plate = MaterialPair(Material(70e9, 0.3), Material.rigid())
    back = MaterialPair.from_dundurs(*plate.dundurs(), 0.3, beta_star=plate.beta_star)
    assert back.plate.is_rigid
    assert pytest.approx(70e9) == back.pin.E
