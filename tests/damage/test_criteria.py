"""The criteria: cases worked by hand, invariances, and slower ways to the same numbers."""

import math

import numpy as np
import pytest

from fastpin import damage
from fastpin.damage import criteria
from tests.support.refusals import refused

E, NU = 200e9, 0.3
G = E / (2.0 * (1.0 + NU))
MPA = 1e6
TURN = np.linspace(0.0, 2.0 * np.pi, 361)


def history(normal, shear, plane="stress"):
    """A history at one point, MPa: normal stress sxx, and shear stress."""
    sxx, sxy = np.broadcast_arrays(np.asarray(normal, float), np.asarray(shear, float))
    szz = NU * sxx if plane == "strain" else 0.0 * sxx
    return MPA * np.stack([sxx, 0.0 * sxx, szz, sxy], axis=-1)[:, None, :]


def turned(stresses, angle):
    """The stresses in axes turned by an angle."""
    sxx, syy, szz, sxy = np.moveaxis(stresses, -1, 0)
    mean, half = 0.5 * (sxx + syy), 0.5 * (sxx - syy)
    c, s = np.cos(2.0 * angle), np.sin(2.0 * angle)
    return np.stack([mean + half * c + sxy * s, mean - half * c - sxy * s, szz, sxy * c - half * s], axis=-1)


def random_histories(seed=4, stops=40, points=30):
    return MPA * 100.0 * np.random.default_rng(seed).normal(size=(stops, points, 4))


def every(stresses):
    """The parameters of all criteria."""
    return {
        "swt": damage.smith_watson_topper(stresses, E, NU).parameter,
        "fs": damage.fatemi_socie(stresses, G, 0.5, 400.0 * MPA).parameter,
        "findley": damage.findley(stresses, 0.3).parameter,
        "crossland": damage.crossland(stresses, 0.2),
        "dang van": damage.dang_van(stresses, 0.3),
    }


# Parameter in MPa (Smith, Watson, Topper) or rad (Fatemi, Socie), and the plane's angle from the x axis in degrees.
# Planes at equal angles on both sides of the axis are alike where the sign is left open.
WORKED = {
    "tension and compression": (history([200, -200], 0), 0.2, 0.0, 1.47139e-3, 41.886),
    "pulsating tension": (history([0, 400], 0), 0.4, 0.0, None, None),
    "plane strain": (history([200, -200], 0, "strain"), 0.182, 0.0, None, None),
    "shear": (history(0, [100, -100]), 0.065, 45.0, 1.309966e-3, None),
    "out of phase": (history(200 * np.sin(TURN), 100 * np.cos(TURN)), 0.2, 0.0, 1.625e-3, 0.0),
    "both": (history(100 + 100 * np.sin(TURN), 100 * np.sin(TURN)), 0.213898, 27.84, 1.732546e-3, -9.52),
}


@pytest.mark.parametrize("name", WORKED)
def test_planes_of_worked_cases(name):
    stresses, swt, swt_angle, fs, fs_angle = WORKED[name]
    found = damage.smith_watson_topper(stresses, E, NU)
    assert found.parameter[0] / MPA == pytest.approx(swt, abs=5e-7)
    assert abs(np.degrees(found.angle[0])) == pytest.approx(swt_angle, abs=5e-3)
    if fs is not None:
        found = damage.fatemi_socie(stresses, G, 0.5, 400.0 * MPA)
        assert found.parameter[0] == pytest.approx(fs, abs=5e-9)
    if name == "both":
        assert np.degrees(found.angle[0]) == pytest.approx(fs_angle, abs=5e-3)
    elif fs_angle is not None:
        assert abs(np.degrees(found.angle[0])) == pytest.approx(fs_angle, abs=5e-4)


def test_the_plane_in_shear_lies_beside_the_plane_of_shear():
    angle = np.degrees(damage.fatemi_socie(history(0, [100, -100]), G, 0.5, 400.0 * MPA).angle[0])
    assert min(abs(angle), 90.0 - abs(angle)) == pytest.approx(3.484, abs=5e-4)


@pytest.mark.gate
def test_crossland_and_dang_van_hold_both_limits():
    bending, torsion = history([300, -300], 0), history(0, [180, -180])
    alpha, limit = damage.crossland_limit(300.0 * MPA, 180.0 * MPA)
    assert alpha == pytest.approx(0.067949, abs=5e-7)
    assert limit == 180.0 * MPA
    assert damage.crossland(bending, 0.0)[0] / MPA == pytest.approx(173.205, abs=5e-4)
    assert alpha * 100.0 == pytest.approx(6.795, abs=5e-4)
    a, same = damage.dang_van_limit(300.0 * MPA, 180.0 * MPA)
    assert same == limit
    for stresses in (bending, torsion):
        assert damage.crossland(stresses, alpha)[0] == pytest.approx(limit, rel=1e-14)
        assert damage.dang_van(stresses, a)[0] == pytest.approx(limit, rel=1e-14)


@pytest.mark.parametrize("ratio", [0.5, 0.577, 0.6, 0.8])
def test_findley_holds_both_limits(ratio):
    k, limit = damage.findley_limit(300.0 * MPA, 300.0 * ratio * MPA)
    for stresses in (history([300, -300], 0), history(0, [300 * ratio, -300 * ratio])):
        assert damage.findley(stresses, k).parameter[0] == pytest.approx(limit, rel=1e-13)
    if ratio == 0.6:  # f/t = 2/(1 + k/sqrt(1 + k^2))
        assert 2.0 / (1.0 + k / math.sqrt(1.0 + k * k)) == pytest.approx(1.0 / 0.6, rel=1e-14)


def test_findley_by_hand():
    """Tension 0 to s: tau_a = s sin(2 phi)/4, s_n = s (1 + cos 2 phi)/2; their largest sum is by hand."""
    k = 0.3
    found = damage.findley(history([0, 400], 0), k)
    assert found.parameter[0] / MPA == pytest.approx(200.0 * (k + math.sqrt(k * k + 0.25)), rel=1e-14)
    assert math.tan(2.0 * abs(found.angle[0])) == pytest.approx(0.5 / k, rel=1e-12)


@pytest.mark.gate
def test_dang_van_takes_off_the_residual_stress():
    """A mean shear stress does nothing; a mean tension counts through the hydrostatic stress only."""
    a = 0.4
    swing = history(0, 100 * np.sin(TURN))
    assert damage.dang_van(swing + history([0], [70]), a)[0] == pytest.approx(100.0 * MPA, rel=1e-14)
    assert damage.dang_van(swing + history([90], [0]), a)[0] == pytest.approx((100.0 + a * 30.0) * MPA, rel=1e-14)


def test_out_of_plane_stress_counts_in_the_deviator():
    """Uniform compression in plane strain: s (1 - 2 nu)/sqrt 3 of the deviator's length."""
    stresses = np.array([[[0.0, 0.0, 0.0, 0.0]], [[-100.0, -100.0, -60.0, 0.0]]]) * MPA
    assert damage.crossland(stresses, 0.0)[0] / MPA == pytest.approx(0.5 * 100.0 * 0.4 / math.sqrt(3.0), rel=1e-14)


def test_the_largest_value_of_a_scan_of_planes():
    """Random paths that are not in proportion, against stress tensors turned plane by plane."""
    stresses = random_histories()
    angles = np.linspace(-0.5 * np.pi, 0.5 * np.pi, 2_001)
    swt, fs, findley = (np.zeros((len(angles), stresses.shape[1])) for _ in range(3))
    for row, angle in enumerate(angles):
        normal, across, out, shear = np.moveaxis(turned(stresses, angle), -1, 0)
        strain = (normal - NU * (across + out)) / E
        most = normal.max(axis=0)
        swt[row] = np.maximum(most, 0.0) * 0.5 * np.ptp(strain, axis=0)
        fs[row] = 0.5 * np.ptp(shear, axis=0) / G * (1.0 + 0.5 * np.maximum(most, 0.0) / (400.0 * MPA))
        findley[row] = 0.5 * np.ptp(shear, axis=0) + 0.3 * most
    found = every(stresses)
    for name, scanned in (("swt", swt), ("fs", fs), ("findley", findley)):
        assert np.all(found[name] >= scanned.max(axis=0) * (1.0 - 1e-13))
        np.testing.assert_allclose(found[name], scanned.max(axis=0), rtol=1e-5)


@pytest.mark.gate
def test_the_sphere_of_the_deviator_against_an_iteration():
    """Badoiu and Clarkson (2003): steps of 1/(k + 1) towards the farthest point, k = 1, 2, ..., close in from above."""
    stresses = random_histories(seed=9, points=2)
    radius = damage.crossland(stresses, 0.0)
    mean = stresses[..., :3].mean(axis=-1, keepdims=True)
    deviator = stresses.copy()
    deviator[..., :3] -= mean
    vectors = np.concatenate([deviator[..., :3] / math.sqrt(2.0), deviator[..., 3:]], axis=-1)
    for point in range(stresses.shape[1]):
        path, centre = vectors[:, point], vectors[0, point]
        for k in range(1, 20_001):
            far = path[np.argmax(np.linalg.norm(path - centre, axis=1))]
            centre = centre + (far - centre) / (k + 1)
        closed_in = np.linalg.norm(path - centre, axis=1).max()
        assert radius[point] <= closed_in * (1.0 + 1e-12)
        assert radius[point] == pytest.approx(closed_in, rel=1e-3)


@pytest.mark.parametrize("angle", [0.3, 1.0, math.pi / 2])
def test_turned_axes_make_no_difference(angle):
    stresses = random_histories(seed=5)
    for one, other in zip(every(stresses).values(), every(turned(stresses, angle)).values(), strict=True):
        np.testing.assert_allclose(other, one, rtol=1e-11)
    plane = damage.smith_watson_topper(stresses, E, NU).angle
    moved = damage.smith_watson_topper(turned(stresses, angle), E, NU).angle
    np.testing.assert_allclose(np.exp(2j * (moved + angle)), np.exp(2j * plane), atol=1e-8)


def test_the_order_of_the_stops_makes_no_difference():
    stresses = random_histories(seed=6)
    mixed = stresses[np.random.default_rng(0).permutation(len(stresses))]
    for one, other in zip(every(stresses).values(), every(mixed).values(), strict=True):
        np.testing.assert_allclose(other, one, rtol=1e-12)
    for one, other in zip(every(stresses).values(), every(np.concatenate([stresses] * 2)).values(), strict=True):
        np.testing.assert_allclose(other, one, rtol=1e-12)


def test_units():
    """Stresses and moduli in other units, a power of two apart."""
    stresses, scale = random_histories(seed=7), 2.0**-20
    swt = damage.smith_watson_topper(stresses, E, NU)
    assert np.array_equal(damage.smith_watson_topper(scale * stresses, scale * E, NU).parameter, scale * swt.parameter)
    fs = damage.fatemi_socie(stresses, G, 0.5, 4e8)
    np.testing.assert_array_equal(damage.fatemi_socie(scale * stresses, scale * G, 0.5, scale * 4e8).angle, fs.angle)
    np.testing.assert_array_equal(damage.crossland(scale * stresses, 0.2), scale * damage.crossland(stresses, 0.2))
    np.testing.assert_array_equal(damage.dang_van(scale * stresses, 0.2), scale * damage.dang_van(stresses, 0.2))
    np.testing.assert_allclose(damage.crossland(1e-200 * stresses, 0.2), 1e-200 * damage.crossland(stresses, 0.2))


def test_no_parameter_in_compression():
    """Every plane is always pressed: no crack opens, and no plane is the worst one."""
    stresses = random_histories(seed=8)
    stresses[..., :2] -= 2.0 * np.abs(stresses).max()
    found = damage.smith_watson_topper(stresses, E, NU)
    assert np.all(found.parameter == 0.0)
    assert np.all(np.isnan(found.angle))
    without = damage.fatemi_socie(stresses, G, 0.0, 4e8).parameter
    np.testing.assert_array_equal(damage.fatemi_socie(stresses, G, 1.0, 4e8).parameter, without)


def test_a_constant_stress_does_no_damage():
    still = np.repeat(random_histories(seed=3)[:1], 5, axis=0)
    assert np.all(damage.smith_watson_topper(still, E, NU).parameter == 0.0)
    assert np.all(damage.fatemi_socie(still, G, 1.0, 4e8).parameter == 0.0)
    assert np.all(damage.crossland(still, 0.0) == 0.0)


def test_threads_and_chunks_change_no_bit(monkeypatch):
    stresses = random_histories(seed=2, points=300)
    many = every(stresses)
    monkeypatch.setattr(criteria, "CHUNK", 1000)
    for one, other in zip(every(stresses).values(), many.values(), strict=True):
        assert np.array_equal(one, other)


NO_LIMIT = "torsion_limit: must lie between half the bending limit of 300 and this limit, not 100"

BAD = {
    "history: must have the shape (stops, points, 4), not (3,)": (damage.crossland, [1.0, 2.0, 3.0], 0.1),
    "history: must have the shape (stops, points, 4), not (0, 2, 4)": (damage.crossland, np.zeros((0, 2, 4)), 0.1),
    "history: must be a finite number, not nan": (damage.findley, np.full((2, 1, 4), np.nan), 0.1),
    "E: must be positive, not 0": (damage.smith_watson_topper, history([1, 2], 0), 0.0, 0.3),
    "nu: must lie between 0 and 0.5, not 0.7": (damage.smith_watson_topper, history([1, 2], 0), E, 0.7),
    "k: must lie between 0 and inf, not -1": (damage.fatemi_socie, history([1, 2], 0), G, -1.0, 4e8),
    "yield_strength: must be positive, not -4": (damage.fatemi_socie, history([1, 2], 0), G, 1.0, -4.0),
    'alpha: must be a number, not "a"': (damage.crossland, history([1, 2], 0), "a"),
    "torsion_limit: must be positive, not 0": (damage.crossland_limit, 1.0, 0.0),
    NO_LIMIT: (damage.findley_limit, 300.0, 100.0),
    "paths: must have the shape (stops, points, dimension), not (2,)": (damage.smallest_spheres, [1.0, 2.0]),
}


@pytest.mark.parametrize("sentence", BAD)
def test_bad_input(sentence):
    assert str(refused(*BAD[sentence])) == sentence
