"""Miner's rule and its variants for small cycles: levels worked by hand, and laws of random histories."""

import dataclasses
import math

import numpy as np
import pytest

import fastpin
from fastpin import InputError, damage
from fastpin.damage import plane_damage, plane_search
from fastpin.damage.counted import CountedMaterial, Spectrum
from fastpin.damage.lives import curve_with_knee, fatemi_socie_curve, smith_watson_topper_curve
from fastpin.model import FatigueAssessment, FatigueConstants
from tests.support.fatigue import uniaxial
from tests.support.refusals import refused
from tests.support.tiers import seeds

SWT, FS = "smith-watson-topper", "fatemi-socie"
E, B, STRENGTH = 70e9, -0.124, 1100e6
FLAT = FatigueConstants(STRENGTH, B, 1e-40, -0.59)
"""One power alone: SWT = sf'^2/E (2N)^(2b)."""
MATERIAL = fastpin.Material(E, 0.33, "aluminium", FLAT)
KNEE = 1e6
RULES = ("elementary", "original", "haibach")


def sum_of(values, rule, knee, order=None, material=MATERIAL):
    """The damage of a stress sxx."""
    counted = CountedMaterial.of(SWT, material, None, "plate", FatigueAssessment(small_cycles=rule, knee=knee))
    spectrum = Spectrum.of(np.arange(len(values)) if order is None else np.asarray(order))
    return float(counted.worst(uniaxial(values), spectrum)[0][0])


def by_hand(low, high, rule):
    """1/N of a cycle from Basquin's line for the amplitude sqrt(high (high - low)/2), and its part below the knee."""
    amplitude = math.sqrt(high * (high - low) / 2.0)
    at_knee = STRENGTH * (2.0 * KNEE) ** B
    k = -1.0 / B
    if amplitude >= at_knee or rule == "elementary":
        return (amplitude / at_knee) ** k / KNEE
    return 0.0 if rule == "original" else (amplitude / at_knee) ** (2.0 * k - 1.0) / KNEE


AT_KNEE = STRENGTH * (2.0 * KNEE) ** B  # 182 MPa


@pytest.mark.parametrize("rule", RULES)
@pytest.mark.parametrize("levels", [[1.3], [1.4, 0.8], [1.5, 1.1, 0.5]])
def test_levels_worked_by_hand(rule, levels):
    """One, two and three levels of reversed stress, 3, 40 and 200 cycles; the later ones lie inside the first."""
    values, order, expected = [], [], 0.0
    for place, (level, times) in enumerate(zip(levels, (3, 40, 200), strict=False)):
        values += [-level * AT_KNEE, level * AT_KNEE]
        order += [2 * place, 2 * place + 1] * times
        expected += times * by_hand(-level * AT_KNEE, level * AT_KNEE, rule)
    found = sum_of(values, rule, None if rule == "elementary" else KNEE, order)
    assert found == pytest.approx(expected, rel=1e-9)


def test_a_cycle_at_the_knee_counts_and_one_below_ends_the_curve():
    for size, original in ((1.0 + 1e-9, 1.0 / KNEE), (1.0 - 1e-9, 0.0)):
        values = [-size * AT_KNEE, size * AT_KNEE]
        assert sum_of(values, "original", KNEE) == pytest.approx(original, rel=1e-6)
        assert sum_of(values, "haibach", KNEE) == pytest.approx(1.0 / KNEE, rel=1e-6)


def test_the_slope_below_the_knee_is_that_of_the_tangent():
    """Two powers: the slope k at the knee lies between those of both, from a difference quotient of the curve."""
    curve = smith_watson_topper_curve(E, STRENGTH, B, 0.22, -0.59)
    constants = (E, STRENGTH, B, 0.22, -0.59)
    *_, limit, at, slope, _ = curve_with_knee(curve, 2, "haibach", 2e4)
    assert damage.smith_watson_topper_life(math.exp(limit), *constants) == pytest.approx(2e4, rel=1e-9)
    assert at == pytest.approx(math.log(4e4))
    up, down = (float(damage.smith_watson_topper_life(math.exp(limit + step), *constants)) for step in (1e-4, -1e-4))
    k = 2.0 * math.log(down / up) / 2e-4  # N ~ amplitude^-k, and the parameter grows with its square
    assert slope == pytest.approx((2.0 * k - 1.0) / 2.0, rel=1e-6)
    assert 2.0 / 0.714 < k < -1.0 / B


def test_the_slope_of_fatemi_and_socie():
    """The parameter grows with the amplitude itself."""
    curve = fatemi_socie_curve(26e9, 640e6, -0.1, 1e-40, -0.59)
    *_, slope, _ = curve_with_knee(curve, 1, "haibach", 1e6)
    assert slope == pytest.approx(2.0 * 10.0 - 1.0, rel=1e-9)


def test_the_knee_of_shear():
    """Reversed shear on the plane of the largest shear strain, without normal stress: tau/G against tf'/G (2N)^b0."""
    constants = FatigueConstants(
        normal_stress_factor=1e-12, yield_strength=379e6, shear_fatigue_strength=640e6, shear_strength_exponent=-0.1,
        shear_fatigue_ductility=1e-40, shear_ductility_exponent=-0.59,
    )  # fmt: skip
    stress = 0.5 * 640e6 * 2e6**-0.1
    history = np.zeros((2, 1, 4))
    history[:, 0, 3] = stress, -stress
    spectrum = Spectrum.of(np.arange(2))
    for rule, knee, expected in (
        ("elementary", None, 0.5**10 / 1e6), ("haibach", 1e6, 0.5**19 / 1e6), ("original", 1e6, 0.0),
    ):  # fmt: skip
        counted = CountedMaterial.of(FS, MATERIAL, constants, "plate", FatigueAssessment(small_cycles=rule, knee=knee))
        assert counted.worst(history, spectrum)[0][0] == pytest.approx(expected, rel=1e-6)


def test_the_counted_cycles_have_the_damage_of_the_plane():
    rng = np.random.default_rng(3)
    history = rng.uniform(-2e8, 3e8, (30, 1, 4))
    spectrum = Spectrum.of(np.arange(30))
    for rule in RULES[1:]:
        counted = CountedMaterial.of(SWT, MATERIAL, None, "plate", FatigueAssessment(small_cycles=rule, knee=1e5))
        found, plane = counted.worst(history, spectrum)
        assert found[0] > 0.0
        assert counted.cycles(history, spectrum, plane[0])[1][:, 2].sum() == pytest.approx(found[0], rel=1e-9)


BAD = {
    ("haibach", None): 'knee: must be given with small_cycles = "haibach": the cycles at the knee, such as 1e6',
    ("elementary", 1e6): 'knee: belongs to "original" and "haibach", but small_cycles is "elementary"',
    ("original", 0.5): "knee: must lie between 1 and 1e+18, not 0.5",
}


@pytest.mark.parametrize("given", BAD)
def test_bad_rules(given):
    assert str(refused(sum_of, [0.0, 1e8], *given)) == BAD[given]


def test_a_knee_on_a_curve_that_falls_too_steeply():
    steep = dataclasses.replace(MATERIAL, fatigue=dataclasses.replace(FLAT, strength_exponent=-1.2))
    with pytest.raises(InputError, match=r"where the slope k of the curve of lives is above 1, not 0\.83"):
        sum_of([0.0, 1e8], "haibach", 1e6, material=steep)


# -- laws of random histories ----------------------------------------------------------------------------------------


def laws(seed):
    """Check the laws of one random history, of all variants of the rule."""
    rng = np.random.default_rng(seed)
    size, knee = int(rng.integers(3, 60)), 10.0 ** rng.uniform(4.0, 8.0)
    constants = FatigueConstants(
        10.0 ** rng.uniform(8.5, 9.5), rng.uniform(-0.2, -0.06), 10.0 ** rng.uniform(-2, 0), -0.6
    )
    material = fastpin.Material(E, 0.3, "a metal", constants)
    history = rng.uniform(-2e8, 3e8, (size, 1, 4))
    path = np.arange(size)
    sums = {}
    for rule in RULES:
        counted = CountedMaterial.of(
            SWT,
            material,
            None,
            "plate",
            FatigueAssessment(small_cycles=rule, knee=None if rule == "elementary" else knee),
        )

        def found(order, stresses=history, counted=counted):
            return float(counted.worst(stresses, Spectrum.of(np.asarray(order)))[0][0])

        sums[rule] = whole = found(path)
        assert found(np.roll(path, int(rng.integers(size)))) == pytest.approx(whole, rel=1e-9)
        times = int(rng.integers(2, 9))
        assert found(np.tile(path, times)) == pytest.approx(times * whole, rel=1e-9)  # cut into passes, or repeated
        assert _joined(rng, counted) == pytest.approx(1.0, rel=1e-9)
    assert sums["original"] <= sums["haibach"] * (1.0 + 1e-9)
    assert sums["haibach"] <= sums["elementary"] * (1.0 + 1e-9)
    flat = dataclasses.replace(material, fatigue=dataclasses.replace(constants, fatigue_ductility=1e-40))
    counted = CountedMaterial.of(SWT, flat, None, "plate")
    one, two = (float(counted.worst(k * history, Spectrum.of(path))[0][0]) for k in (1.0, 2.0))
    if one:
        assert two / one == pytest.approx(2.0 ** (-1.0 / constants.strength_exponent), rel=1e-7)


def _joined(rng, counted):
    """The damage of two uniaxial spectra that meet at a common highest peak, in parts of the sum of both."""
    parts = [uniaxial(np.append(4e8, rng.uniform(-3e8, 3.9e8, 11))) for _ in range(2)]
    alone = sum(float(counted.worst(each, Spectrum.of(np.arange(12)))[0][0]) for each in parts)
    both = float(counted.worst(np.concatenate(parts), Spectrum.of(np.arange(24)))[0][0])
    return both / alone if alone else 1.0


def test_laws_of_random_histories():
    for seed in seeds(40):
        laws(seed)


def test_a_table_of_lives_ends_at_the_knee():
    """Damage of a plane from the table, and the same from Newton's method alone, on both sides of a knee."""
    curve = curve_with_knee(smith_watson_topper_curve(E, STRENGTH, B, 0.22, -0.59), 2, "haibach", 1e5)
    for size in np.geomspace(0.3, 3.0, 25):
        amplitude = size * math.exp(0.5 * curve[4])
        path = np.zeros((2, 6))
        path[:, 0] = path[:, 3] = -amplitude, amplitude
        out, places, values = np.empty((1, 2)), np.empty((8, 3), np.int64), np.empty((8, 3))
        given = np.arange(2), np.array([[0, 2, 1]]), plane_search.SWING_TIMES_PUSH, 0.0, curve
        plane_damage.worst_sums(path[None], *given, out)
        plane_damage.cycles_on_plane(path, 0.3, *given, places, values)
        assert out[0, 0] == pytest.approx(values[0, 2], rel=1e-9)
