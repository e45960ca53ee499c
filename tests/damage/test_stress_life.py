"""Stress-life curves with scatter: equivalent stress, curves, reliability, tolerance factors, residual stress."""

import itertools
import math
import re

import numpy as np
import pytest

import fastpin
from fastpin import Material, damage
from fastpin.assess.fatigue import Assessed, document, lines
from fastpin.casefile import parse_case
from fastpin.damage import equivalent_stress, failure_probability, rainflow, tolerance_factor
from fastpin.damage.counted import CountedMaterial, Spectrum
from fastpin.damage.lives import cycles_on_curve, stress_life_curve
from fastpin.model import FatigueAssessment, FatigueConstants, stress_life_curves
from fastpin.model.assessment import USUAL
from fastpin.model.fatigue import KSI
from fastpin.studies.outcome_tables import outcomes_from
from fastpin.studies.outcomes import value_of
from tests.support.documents import page_text
from tests.support.refusals import refused
from tests.support.tiers import seeds

SHEET = "2024-T3 sheet, Kt 1"
A, B, C, M, ERROR = 11.1, 3.97, 15.8, 0.56, 0.38  # of this curve, in ksi


def material(**given: object) -> Material:
    return Material(70e9, 0.33, "sheet", FatigueConstants(**(given or {"curve": SHEET})))  # type: ignore[arg-type]


def uniaxial(levels: np.ndarray) -> np.ndarray:
    """Stresses (stops, 1, 4), Pa, from levels in ksi."""
    history = np.zeros((len(levels), 1, 4))
    history[:, 0, 0] = np.asarray(levels) * KSI
    return history


def damage_of(levels: np.ndarray, how: FatigueAssessment = USUAL, of: Material | None = None) -> float:
    """The damage of a spectrum of one stress, given in ksi."""
    counted = CountedMaterial.of("stress-life", of or material(), None, "plate", how)
    return float(counted.worst(uniaxial(levels), Spectrum.of(np.arange(len(levels))))[0][0])


def by_hand(levels: np.ndarray, shift: float | np.ndarray = 0.0) -> float | np.ndarray:
    """The damage of the cycles of a stress, in ksi, with lives shorter by 10^shift."""
    counted = rainflow(levels)
    most, least = counted.mean + 0.5 * counted.range, counted.mean - 0.5 * counted.range
    equivalent = np.where(
        most > 0.0, np.maximum(most, 1e-9) * (1.0 - least / np.where(most > 0.0, most, 1.0)) ** M, 0.0
    )
    done = np.where(equivalent > C, np.maximum(equivalent - C, 1e-9) ** B / 10.0**A, 0.0).sum()
    return done * 10.0**shift


def test_one_level() -> None:
    levels = np.array([0.0, 40.0])
    assert 1.0 / damage_of(levels) == pytest.approx(10.0 ** (A - B * math.log10(40.0 - C)), rel=1e-9)
    assert 1.0 / damage_of(levels) == pytest.approx(403_881, abs=0.5)
    assert 1.0 / damage_of(levels, FatigueAssessment("stress-life", reliability=0.99)) == pytest.approx(52_752, abs=0.5)
    assert 1.0 / damage_of(
        levels, FatigueAssessment("stress-life", reliability=0.99, confidence=0.95)
    ) == pytest.approx(35_434, abs=0.5)
    assert damage_of([0.0, 15.7]) == 0.0  # below C
    assert damage_of([0.0, 16.0]) == pytest.approx(by_hand(np.array([0.0, 16.0])), rel=1e-8)


def test_random_spectra() -> None:
    for seed in seeds(20):
        levels = np.random.default_rng(seed).uniform(-20.0, 60.0, 60)
        assert damage_of(levels) == pytest.approx(by_hand(levels), rel=1e-7)
        assert damage_of(levels, FatigueAssessment("stress-life", reliability=0.9)) == pytest.approx(
            by_hand(levels, 1.2815515655446004 * ERROR), rel=1e-7
        )


def test_lives_scatter_as_stated() -> None:
    """Each of 1e5 specimens has one shift of log life, for all levels: 99 % of them reach the stated life."""
    levels = np.array([55.0, 0.0, 40.0, -10.0, 48.0, 12.0, 35.0, 5.0])
    draws = np.random.default_rng(3).normal(0.0, ERROR, 100_000)
    lives = 1.0 / by_hand(levels, draws)
    for part in (0.5, 0.9, 0.99):
        stated = 1.0 / damage_of(levels, FatigueAssessment("stress-life", reliability=part))
        reached = np.mean(lives >= stated)
        assert reached == pytest.approx(part, abs=4.0 * math.sqrt(part * (1.0 - part) / draws.size))
        median = 1.0 / damage_of(levels)
        assert failure_probability(stated, median, ERROR) == pytest.approx(1.0 - part, abs=1e-7)


def test_tolerance_factors() -> None:
    """Those of a mean are in tables (3.981 for 10 specimens); those of curves were found by trials."""
    assert tolerance_factor(0.99, 0.95, 10, 1) == pytest.approx(3.981, abs=5e-4)
    for samples, factor in ((9, 5.356), (25, 3.441), (107, 2.781)):
        assert tolerance_factor(0.99, 0.95, samples) == pytest.approx(factor, abs=5e-4)
    for arguments, field in (((1.0, 0.9, 9), "reliability"), ((0.9, 0.0, 9), "confidence"), ((0.9, 0.9, 5), "samples")):
        assert refused(tolerance_factor, *arguments).field == field


@pytest.mark.gate
def test_a_confidence_is_reached() -> None:
    """Curves are fitted to 25 random specimens each: 95 % of the lives at 99 % are reached by 99 % of the specimens."""
    rng, reached = np.random.default_rng(8), 0
    stress = np.repeat(np.linspace(1.3, 1.8, 5), 5)
    rows = np.stack([np.ones(25), stress], axis=1)  # log10 life on a line: two constants
    factor = tolerance_factor(0.99, 0.95, 25, 2)
    for _ in range(4000):
        fitted, rest, *_ = np.linalg.lstsq(rows, 10.0 - 4.0 * stress + rng.normal(0.0, 0.3, 25), rcond=None)
        at = rng.choice(stress)
        stated = fitted @ [1.0, at] - factor * math.sqrt(rest[0] / 23.0)
        reached += stated <= 10.0 - 4.0 * at - 2.3263478740408408 * 0.3
    assert reached / 4000 == pytest.approx(0.95, abs=0.015)


def test_the_worst_plane_is_found() -> None:
    """Against a scan of planes, for random stresses."""
    history = np.random.default_rng(5).normal(0.0, 1e8, (6, 40, 4))
    found = equivalent_stress(history, M)
    angles = np.linspace(-np.pi / 2, np.pi / 2, 20_001)
    sxx, syy, _, sxy = np.moveaxis(history, -1, 0)[..., None]
    normal = 0.5 * (sxx + syy) + 0.5 * (sxx - syy) * np.cos(2 * angles) + sxy * np.sin(2 * angles)
    scanned = np.ptp(normal, axis=0) ** M * np.maximum(normal.max(axis=0), 0.0) ** (1.0 - M)
    assert np.all(found.parameter >= scanned.max(axis=1) * (1.0 - 1e-12))
    assert found.parameter == pytest.approx(scanned.max(axis=1), rel=1e-6)
    assert np.all((found.angle > -np.pi / 2) & (found.angle <= np.pi / 2))
    counted = CountedMaterial.of("stress-life", material(curve_a=40.0, curve_b=4.0, curve_m=M), None, "plate")
    pair = history[:2, equivalent_stress(history[:2], M).parameter > 0.0]
    once = counted.worst(pair, Spectrum.of(np.arange(2)))[0]
    assert once == pytest.approx(10.0 ** (4.0 * np.log10(counted.largest(pair)[0]) - 40.0), rel=1e-5)


def test_turned_stresses_have_the_same_damage() -> None:
    history = np.random.default_rng(7).normal(1e8, 1e8, (5, 20, 4))
    turned = history.copy()
    turned[..., [0, 1]], turned[..., 3] = history[..., [1, 0]], -history[..., 3]
    assert equivalent_stress(turned, 0.4).parameter == pytest.approx(
        equivalent_stress(history, 0.4).parameter, rel=1e-10
    )


def test_compression_alone_does_nothing() -> None:
    assert damage_of(np.array([-50.0, -10.0, -40.0, 0.0])) == 0.0


def test_a_notched_curve_takes_the_local_stress() -> None:
    notched, levels = material(curve="2024-T3 sheet, Kt 2"), np.array([0.0, 60.0])
    assert 1.0 / damage_of(levels, of=notched) == pytest.approx(
        10.0 ** (9.2 - 3.33 * math.log10(30.0 - 12.3)), rel=1e-9
    )


def test_rules_of_small_cycles() -> None:
    """At the knee all rules agree; below it the original one ends, and that of Haibach goes on with 2k - 1."""
    at = 10.0 ** ((A - 6.0) / B) + C
    for factor, knee in itertools.product((1.1, 0.9), (None, 1e6)):
        levels = np.array([0.0, factor * at])
        done = damage_of(levels, FatigueAssessment(small_cycles="original", knee=knee) if knee else USUAL)
        assert done == pytest.approx(0.0 if knee and factor < 1.0 else by_hand(levels), rel=1e-8)
    slope = B * at / (at - C)
    found = damage_of(np.array([0.0, 0.9 * at]), FatigueAssessment(small_cycles="haibach", knee=1e6))
    assert found == pytest.approx(1e-6 * 0.9 ** (2.0 * slope - 1.0), rel=1e-7)


def test_the_curves_of_the_package() -> None:
    """All fall with the stress, and the notched ones lie below the smooth ones of the same product."""
    curves = stress_life_curves()
    assert len(curves) == 50
    for name, given in curves.items():
        constants = FatigueConstants(curve=name)
        assert constants.given() == {"curve": name, **given}
        assert FatigueConstants(**constants.given()) == constants
        curve = stress_life_curve(*(given[f"curve_{name}"] for name in ("a", "b", "c", "kt")))
        lives = cycles_on_curve(given["curve_kt"] * np.array([4e8, 8e8, 1.2e9]), curve)
        assert lives[0] >= lives[1] > lives[2] > 0.0
        assert 0.1 < given["curve_scatter"] < 0.7
    nominal = {
        name: (10 ** ((given["curve_a"] - 5.0) / given["curve_b"]) + given["curve_c"]) for name, given in curves.items()
    }
    for product in {name.split(",")[0] for name in curves}:
        same = [(curves[name]["curve_kt"], nominal[name]) for name in curves if name.split(",")[0] == product]
        assert [stress for _, stress in sorted(same)] == sorted((stress for _, stress in same), reverse=True)


@pytest.mark.parametrize(
    ("made", "given", "words"),
    [
        (
            FatigueConstants, {"curve": "2024-T3 shet, Kt 1"},
            'curve: there is no stress-life curve "2024-T3 shet, Kt 1", did you mean "2024',
        ),
        (FatigueConstants, {"curve_c": -1.0}, "curve_c: must not be negative, not -1"),
        (FatigueConstants, {"curve_m": 1.0}, "curve_m: must lie between 0.01 and 0.99, not 1"),
        (FatigueConstants, {"curve_samples": 3}, "curve_samples: must be a whole number of at least 6, not 3"),
        (
            FatigueAssessment, {"reliability": 0.99},
            'reliability: needs criterion = "stress-life", not ["smith-watson-topper"]',
        ),
        (
            FatigueAssessment, {"criterion": "stress-life", "confidence": 0.9},
            "confidence: belongs to a reliability, such as",
        ),
        (
            FatigueAssessment, {"criterion": "stress-life", "reliability": 99},
            "reliability: must lie between 0.5 and 0.999999, not 99",
        ),
        (
            FatigueAssessment, {"residual_stress": [[0, 1e8]]},
            "residual_stress: must be a number or 2 to 1,000 pairs, not 1",
        ),
    ],
)  # fmt: skip
def test_wrong_constants_and_assessments_are_refused(made: type, given: dict, words: str) -> None:
    assert str(refused(made, **given)).startswith(words)


CASE = """pin = {{ material = "steel" }}
plate = {{ material = "2024-T3"{curve} }}
contact.plane = "stress"
contact.hole_radius = 2.5e-3
contact.clearance = 10e-6
contact.thickness = 3e-3
contact.friction = 0.2
solve = {{ nodes = 41, keep = "corners" }}
fatigue = {{ bodies = "plate", over = "cycle"{keys} }}
load = [{{ P = [2000, 200], syy = [50e6, 5e6], repeat = 3 }}]
"""


LIFE = "fatigue_strength = 1.1e9, strength_exponent = -0.124, fatigue_ductility = 0.22, ductility_exponent = -0.59"


def case_of(keys: str, constants: str = "") -> fastpin.Case:
    return parse_case(CASE.format(keys=f", {keys}" * bool(keys), curve=constants))


@pytest.fixture(scope="module")
def result() -> fastpin.Result:
    case = case_of("", f', fatigue = {{ curve = "{SHEET}", {LIFE} }}')
    return fastpin.solve(case.problem, case.history, nodes=31, keep="corners")


@pytest.fixture(scope="module")
def sure() -> FatigueAssessment:
    how = {"criterion": "stress-life", "bodies": "plate", "over": "cycle", "angles": [45.0, 60.0, 70.0]}
    return FatigueAssessment(**how, life=1e5, reliability=0.99, confidence=0.95)  # type: ignore[arg-type]


def hoop_at(result: fastpin.Result, theta: float) -> np.ndarray:
    """The hoop stress at a place of the edge over the last cycle, Pa."""
    points = fastpin.Points.at_depth(0.0, theta)
    return np.array([float(state.stress(points).hoop[()]) for state in result[-2:]])


def test_a_case_with_a_reliability(result: fastpin.Result, sure: FatigueAssessment) -> None:
    (median,) = result.assessed_fatigue(sure.changed(reliability=None, confidence=None))
    (found,) = result.assessed_fatigue(sure)
    shift = tolerance_factor(0.99, 0.95, 107) * ERROR
    assert found.shift == pytest.approx(shift, rel=1e-12)
    assert found.hot_spot.life == pytest.approx(median.hot_spot.life / 10.0**shift, rel=1e-9)
    assert found.failure_probability(1e5) == pytest.approx(median.failure_probability(1e5), rel=1e-9)
    assert median.failure_probability(median.hot_spot.life) == pytest.approx(0.5)
    hoop = hoop_at(result, found.hot_spot.theta) / KSI
    assert median.hot_spot.damage == pytest.approx(by_hand(hoop), rel=1e-5)
    (reserve,) = result.assessed_reserves(sure)
    assert 1.0 / damage_of(reserve.factor * hoop, sure) == pytest.approx(1e5, rel=1e-4)


def test_text_json_and_outcomes_say_the_same(result: fastpin.Result, sure: FatigueAssessment) -> None:
    found = result.assessed_fatigue(sure)
    spot, assessed = found[0].hot_spot, Assessed(sure, found, [])
    (body,) = document(assessed, {})["bodies"]
    failing = found[0].failure_probability(1e5)
    head, line = lines(assessed, {})
    assert head.endswith(
        "for a life of 100000 cycles, lives that 99 % of the specimens reach with a confidence of 95 %"
    )
    words = f"life {spot.life:.4g} cycles, median life {body['median_life']:.4g}, {failing:.3g} of the specimens fail"
    assert f"{words} within 100000 cycles, damage" in line
    assert (body["life"], body["failure_probability"]) == (spot.life, failing)
    assert body["median_life"] == pytest.approx(spot.life * 10.0 ** found[0].shift)
    for name in ("life", "median_life", "failure_probability"):
        outcome = outcomes_from({"it": {"fatigue": name}}, {"fatigue": sure})["it"]
        assert value_of(outcome, result).value == body[name]


def test_residual_stress_is_a_mean_stress(result: fastpin.Result) -> None:
    """The edge has one stress, so the life is that of the largest stress less 200 MPa, times the amplitude."""
    how = FatigueAssessment(bodies="plate", over="cycle", angles=[45.0, 60.0, 70.0], residual_stress=-200e6)
    (found,) = result.assessed_fatigue(how)
    hoop = hoop_at(result, found.hot_spot.theta)
    product = (hoop.max() - 200e6) * 0.5 * np.ptp(hoop) / 70e9
    by_formula = damage.smith_watson_topper_life(product, 70e9, 1.1e9, -0.124, 0.22, -0.59)
    assert found.hot_spot.life == pytest.approx(float(by_formula), rel=1e-3)
    (same,) = result.assessed_fatigue(how.changed(residual_stress=[[0.0, -200e6], [1e-3, 0.0]]))
    assert same.hot_spot.life == pytest.approx(found.hot_spot.life, rel=1e-12)
    means = how.changed(method="point", length=1e-4, angles=90.0, residual_stress=None)
    pairs = means.changed(residual_stress=[[0.0, -200e6], [1e-4, 0.0]])
    half = means.changed(residual_stress=-100e6)
    lives = [result.assessed_fatigue(each)[0].hot_spot.life for each in (pairs, half, means)]
    assert lives[0] == pytest.approx(lives[1], rel=1e-12)
    assert lives[2] < lives[0]


def test_faults_in_a_case_file() -> None:
    for keys, curve, words in (
        ('criterion = "stress-life"', "", "fatigue: stress-life needs curve_m, curve_a, curve_b,"),
        ('criterion = "stress-life", reliability = 0.9', ", fatigue = { curve_a = 40, curve_b = 4, curve_m = 0.5 }",
         "fatigue: a life at a reliability needs curve_scatter of the plate's material"),
        ('criterion = "stress-life", reliability = 0.9, confidence = 0.9',
         ', fatigue = { curve = "17-4PH H900 bar, Kt 1" }',
         "fatigue: a life at a reliability needs curve_samples of the plate's material"),
        ("", ', fatigue = { curve = "2024-T3 sheet" }', 'line 2: curve: there is no stress-life curve "2024'),
        ("reliability = 0.9", "", 'reliability: needs criterion = "stress-life"'),
    ):  # fmt: skip
        assert words in str(refused(case_of, keys, curve))


def test_notched_curves_against_the_smooth_one() -> None:
    """The table of docs/stress-life.md: Kt S of each notched curve over S of the smooth ones of its alloy, at R = 0."""
    curves = stress_life_curves()

    def stress(name: str, life: float) -> float:
        given = curves[name]
        return given["curve_kt"] * (
            10.0 ** ((given["curve_a"] - math.log10(life)) / given["curve_b"]) + given["curve_c"]
        )

    def is_smooth_of(name: str, smooth: str) -> bool:
        product, other = name.split(",")[0], smooth.split(",")[0]
        if f"{product}, Kt 1" in curves or "4130" in name or "17-4PH" in name:
            return product == other
        return product.split()[0] == other.split()[0]

    smooth = [name for name, given in curves.items() if given["curve_kt"] == 1.0]
    pairs = [(name, one) for name in curves for one in smooth if name not in smooth and is_smooth_of(name, one)]
    assert len(pairs) == 25
    shown = re.findall(
        r"^\| Kt ([\d.]+)(?: to ([\d.]+))? \| (.*) to (.*) \| (.*) to (.*) \|$",
        page_text("stress-life.md"),
        re.MULTILINE,
    )
    assert len(shown) == 5
    for least, most, *ends in shown:
        within = [pair for pair in pairs if float(least) <= curves[pair[0]]["curve_kt"] <= float(most or least)]
        for life, low, high in ((1e5, *ends[:2]), (1e6, *ends[2:])):
            ratios = [stress(name, life) / stress(one, life) for name, one in within]
            assert (f"{min(ratios):.2f}", f"{max(ratios):.2f}") == (low, high)


def test_every_constant_is_that_of_its_figure() -> None:
    """The published form of one curve, in ksi, and the names of all that are left out."""
    curve = stress_life_curves()["7075-T6 sheet, Kt 1"]
    assert curve["curve_a"] - curve["curve_b"] * math.log10(KSI) == pytest.approx(14.86, abs=1e-12)
    assert math.log10(KSI) == pytest.approx(6.83852, abs=5e-6)
    left_out = ("2.6.6.1.8(b)", "3.2.3.1.8(h)", "3.2.3.1.8(i)", "2.3.1.2.8(a)", "2.3.1.2.8(b)", "2.3.1.3.8(c)")
    assert not [given for given in stress_life_curves().values() if given["source"].endswith(left_out)]
