"""Strength of laminates: criteria of ply failure against plain Python, hand calculations and printed numbers."""

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from fastpin.damage import (
    MODES,
    PLY_CRITERIA,
    PlyFailure,
    average_stress_ratio,
    characteristic_radius,
    first_ply_failure,
    hashin,
    maximum_strain,
    maximum_stress,
    ply_failure,
    point_stress_ratio,
    tsai_hill,
    tsai_wu,
    yamada_sun,
)
from fastpin.model import PLIES, Laminate, Ply, PlyStrengths
from tests.support.refusals import refused

PLY = PLIES["AS4/3501-6"]
KNOWN = PLY.strengths
CRITERIA = [name for name in PLY_CRITERIA if name != "yamada-sun"]
"""Criteria that know each strength of a ply."""

ALONE = {
    "fibre tension": (KNOWN.Xt, 0.0, 0.0),
    "fibre compression": (-KNOWN.Xc, 0.0, 0.0),
    "matrix tension": (0.0, KNOWN.Yt, 0.0),
    "matrix compression": (0.0, -KNOWN.Yc, 0.0),
    "shear": (0.0, 0.0, -KNOWN.S),
}
"""Stresses at which the ply breaks when they act alone."""


def naive(name: str, stress: tuple[float, float, float], ply: Ply) -> float:
    """The failure index of one stress in plain Python."""
    s1, s2, t = stress
    k = ply.strengths
    x, y = (k.Xt if s1 >= 0 else k.Xc), (k.Yt if s2 >= 0 else k.Yc)
    if name == "maximum-stress":
        return max(abs(s1) / x, abs(s2) / y, abs(t) / k.S)
    if name == "maximum-strain":
        e1, e2, g = s1 / ply.E1 - ply.nu12 * s2 / ply.E1, s2 / ply.E2 - ply.nu12 * s1 / ply.E1, t / ply.G12
        first = e1 / (k.Xt / ply.E1) if e1 > 0 else -e1 / (k.Xc / ply.E1)
        second = e2 / (k.Yt / ply.E2) if e2 > 0 else -e2 / (k.Yc / ply.E2)
        return max(first, second, abs(g) / (k.S / ply.G12))
    if name == "tsai-hill":
        return (s1 / x) ** 2 - s1 * s2 / x**2 + (s2 / y) ** 2 + (t / k.S) ** 2
    if name == "tsai-wu":
        f11, f22 = 1.0 / (k.Xt * k.Xc), 1.0 / (k.Yt * k.Yc)
        both = 2.0 * -0.5 * math.sqrt(f11 * f22) * s1 * s2
        linear = (1.0 / k.Xt - 1.0 / k.Xc) * s1 + (1.0 / k.Yt - 1.0 / k.Yc) * s2
        return linear + f11 * s1**2 + f22 * s2**2 + (t / k.S) ** 2 + both
    if name == "yamada-sun":
        return (s1 / x) ** 2 + (t / k.S) ** 2
    fibre = (s1 / k.Xt) ** 2 + (t / k.S) ** 2 if s1 > 0 else (s1 / k.Xc) ** 2
    return max(fibre, (s2 / y) ** 2 + (t / k.S) ** 2)


@pytest.mark.parametrize("name", CRITERIA)
@pytest.mark.parametrize("mode", MODES)
def test_a_ply_breaks_at_each_of_its_strengths(name: str, mode: str) -> None:
    found = PLY_CRITERIA[name](np.array(ALONE[mode]), PLY)
    assert found.index == pytest.approx(1.0, rel=1e-12)
    assert found.ratio == pytest.approx(1.0, rel=1e-12)
    if name != "hashin" or mode != "shear":
        assert MODES[int(found.mode)] == mode
    else:
        assert MODES[int(found.mode)] == "matrix tension"  # Hashin has no mode of shear alone


@pytest.mark.parametrize("name", PLY_CRITERIA)
def test_criteria_are_those_of_plain_python(name: str) -> None:
    rng = np.random.default_rng(5)
    stress = rng.normal(size=(40, 3)) * [1500e6, 80e6, 60e6]
    found = PLY_CRITERIA[name](stress.reshape(8, 5, 3), PLY)
    assert found.index.shape == found.ratio.shape == found.mode.shape == (8, 5)
    expected = [naive(name, tuple(row), PLY) for row in stress.tolist()]
    np.testing.assert_allclose(found.index.ravel(), expected, rtol=1e-12)
    # at the strength ratio the index is 1, and not before
    at_failure = PLY_CRITERIA[name](found.ratio[..., np.newaxis] * stress.reshape(8, 5, 3), PLY)
    np.testing.assert_allclose(at_failure.index, 1.0, rtol=1e-9)
    for part in (0.2, 0.7, 0.999):
        before = PLY_CRITERIA[name](part * found.ratio[..., np.newaxis] * stress.reshape(8, 5, 3), PLY)
        assert np.all(before.index < 1.0)
    # the ratio doubles when the stresses halve, and the mode stays
    half = PLY_CRITERIA[name](0.5 * stress.reshape(8, 5, 3), PLY)
    np.testing.assert_allclose(half.ratio, 2.0 * found.ratio, rtol=1e-12)
    np.testing.assert_array_equal(half.mode, found.mode)
    # the sign of the shear stress makes no difference
    mirrored = PLY_CRITERIA[name](stress.reshape(8, 5, 3) * [1.0, 1.0, -1.0], PLY)
    np.testing.assert_array_equal(mirrored.ratio, found.ratio)


@pytest.mark.parametrize("name", PLY_CRITERIA)
def test_without_stress_nothing_breaks_and_an_unknown_stress_stays_unknown(name: str) -> None:
    found = PLY_CRITERIA[name](np.array([[0.0, 0.0, 0.0], [math.nan, 1e6, 0.0]]), PLY)
    assert found.index[0] == 0.0
    assert found.ratio[0] == math.inf
    assert math.isnan(found.ratio[1])


@pytest.mark.parametrize(
    ("degrees", "stress", "mode"),
    [(5.0, 412.13, "fibre tension"), (10.0, 215.69, "matrix tension"), (30.0, 69.24, "matrix tension"),
     (90.0, 28.30, "matrix tension")],
)  # fmt: skip
def test_hashins_off_axis_tension(degrees: float, stress: float, mode: str) -> None:
    # Hashin (1980), figure 6, glass/epoxy, MPa
    strengths = PlyStrengths(1241.0, 600.0, 28.3, 100.0, 37.9)
    cos, sin = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    found = hashin([cos * cos, sin * sin, -sin * cos], strengths, transverse_shear=30.0)
    assert found.ratio == pytest.approx(stress, abs=0.01)
    assert MODES[int(found.mode)] == mode


def test_hashins_matrix_compression_has_a_linear_term() -> None:
    # Yc 240, St 55 and S 69 MPa: numbers of a public program for equation 19 of Hashin (1980)
    strengths = PlyStrengths(1241.0, 600.0, 28.3, 240.0, 69.0)
    found = hashin([0.0, -100.0, 40.0], strengths, transverse_shear=55.0)
    assert found.ratio == pytest.approx(1.820332, abs=1e-6)
    by_hand = (100.0 / 110.0) ** 2 - ((240.0 / 110.0) ** 2 - 1.0) * 100.0 / 240.0 + (40.0 / 69.0) ** 2
    assert found.index == pytest.approx(by_hand)
    assert by_hand == pytest.approx(-0.404294, abs=1e-6)
    assert MODES[int(found.mode)] == "matrix compression"
    assert hashin([0.0, -240.0, 0.0], strengths, 55.0).index == pytest.approx(1.0)


def test_tsai_wus_interaction() -> None:
    stress = [500e6, 20e6, 0.0]
    f11, f22 = 1.0 / (KNOWN.Xt * KNOWN.Xc), 1.0 / (KNOWN.Yt * KNOWN.Yc)
    other = tsai_wu(stress, KNOWN, interaction=0.3).index - tsai_wu(stress, KNOWN).index
    assert other == pytest.approx(2.0 * 0.8 * math.sqrt(f11 * f22) * 500e6 * 20e6)
    # von Mises for an isotropic ply
    same = PlyStrengths(100.0, 100.0, 100.0, 100.0, 100.0 / math.sqrt(3.0))
    s1, s2, t12 = 50.0, -30.0, 20.0
    mises = math.sqrt(s1**2 - s1 * s2 + s2**2 + 3.0 * t12**2)
    for criterion in (tsai_wu, tsai_hill):
        assert criterion([s1, s2, t12], same).ratio == pytest.approx(100.0 / mises)


def test_tsai_hill_may_allow_any_stress() -> None:
    # a ply that is stronger across than along: with s2 = s1 the sum of squares may be negative
    strong = PlyStrengths(1.0, 1.0, 1e3, 1e3, 1.0)
    found = tsai_hill([1.0, 1.5, 0.0], strong)
    assert found.index < 0.0
    assert found.ratio == math.inf


def test_maximum_strain_knows_poissons_ratio() -> None:
    biaxial = [KNOWN.Xt, 0.3 * KNOWN.Yt, 0.0]
    assert maximum_stress(biaxial, KNOWN).index == pytest.approx(1.0)
    by_hand = 1.0 - PLY.nu12 * 0.3 * KNOWN.Yt / KNOWN.Xt
    assert maximum_strain(biaxial, PLY).index == pytest.approx(by_hand)


def test_yamada_and_sun_leave_out_the_stress_across() -> None:
    assert yamada_sun([0.6 * KNOWN.Xt, 5.0 * KNOWN.Yt, 0.8 * KNOWN.S], KNOWN).ratio == pytest.approx(1.0)
    found = yamada_sun([[-0.5 * KNOWN.Xc, 0.0, 0.0], [0.1 * KNOWN.Xt, 0.0, KNOWN.S]], KNOWN)
    np.testing.assert_allclose(found.ratio, [2.0, 1.0 / math.sqrt(1.01)])
    assert [MODES[place] for place in found.mode] == ["fibre compression", "shear"]
    assert yamada_sun([0.0, 1e9, 0.0], KNOWN).ratio == math.inf


def test_the_first_ply_of_a_cross_ply_is_that_across_the_load() -> None:
    laminate = Laminate.from_layup("[0/90]s", PLY, axis=0.0)
    found = first_ply_failure(laminate, [100e6, 0.0, 0.0], "maximum-stress")
    assert (int(found.ply), MODES[int(found.mode)]) == (1, "matrix tension")
    # by hand: the strain of the whole, and the stress across the fibres of the ply of 90 degrees
    E1, _, _, nu12 = laminate.moduli
    rest = 1.0 - PLY.nu12**2 * PLY.E2 / PLY.E1
    strain, contraction = 100e6 / E1, -nu12 * 100e6 / E1
    across = PLY.E2 / rest * (strain + PLY.nu12 * contraction)
    assert found.ratio == pytest.approx(KNOWN.Yt / across)
    field = np.array([[100e6, 0.0, 0.0], [0.0, 100e6, 0.0], [0.0, 0.0, 50e6]])
    many = first_ply_failure(laminate, field, "tsai-wu")
    assert many.ratio.shape == (3,)
    assert many.ratio[0] == pytest.approx(many.ratio[1])
    assert many.ply.tolist()[:2] == [1, 0]


@pytest.mark.parametrize("name", PLY_CRITERIA)
def test_a_turned_joint_has_the_same_strength(name: Any) -> None:
    stress, angle = np.array([80e6, -30e6, 40e6]), 0.7
    cos, sin = math.cos(angle), math.sin(angle)
    tensor = np.array([[stress[0], stress[2]], [stress[2], stress[1]]])
    turn = np.array([[cos, -sin], [sin, cos]])
    turned = turn @ tensor @ turn.T
    laminate = Laminate.from_layup("[0/30/-60]s", PLY, axis=0.2)
    one = ply_failure(laminate, stress, name)
    other = ply_failure(laminate.turned(angle), [turned[0, 0], turned[1, 1], turned[0, 1]], name)
    assert isinstance(one, PlyFailure)
    np.testing.assert_allclose(other.ratio, one.ratio, rtol=1e-10)
    assert one.ratio.shape == (6,)
    np.testing.assert_allclose(one.ratio, one.ratio[::-1], rtol=1e-12)


def hole(radius: float, stress: float = 1.0) -> Callable[[np.ndarray], np.ndarray]:
    """Kirsch's stress across the line beside a hole in an isotropic plate under tension, by distance from the edge."""

    def profile(distance: np.ndarray) -> np.ndarray:
        part = radius / (radius + distance)
        return stress * (1.0 + 0.5 * part**2 + 1.5 * part**4)

    return profile


def test_point_stress_of_whitney_and_nuismer() -> None:
    part = 3.0 / (3.0 + 1.0)
    assert point_stress_ratio(hole(3e-3), 1.0, 1e-3) == pytest.approx(2.0 / (2.0 + part**2 + 3.0 * part**4))
    assert point_stress_ratio(hole(3e-3, 2.0), 1.0, 1e-3) == pytest.approx(1.0 / (2.0 + part**2 + 3.0 * part**4))
    assert point_stress_ratio(hole(3e-3, -1.0), 1.0, 1e-3) == math.inf


@pytest.mark.parametrize("length", [1e-5, 4e-3, 1e-1])
def test_average_stress_of_whitney_and_nuismer(length: float) -> None:
    radius = 3e-3
    end = radius + length
    # the integral of the profile by hand
    integral = length - 0.5 * radius**2 * (1.0 / end - 1.0 / radius) - 0.5 * radius**4 * (end**-3 - radius**-3)
    assert average_stress_ratio(hole(radius), 1.0, length) == pytest.approx(length / integral, rel=1e-9)
    part = radius / end
    closed = 2.0 * (1.0 - part) / (2.0 - part**2 - part**4)
    assert average_stress_ratio(hole(radius), 1.0, length) == pytest.approx(closed, rel=1e-7)


def test_the_characteristic_curve_goes_from_bearing_to_tension() -> None:
    theta = np.array([0.0, 0.25 * math.pi, 0.5 * math.pi, -0.5 * math.pi])
    found = characteristic_radius(theta, 3e-3, 0.5e-3, 2e-3)
    np.testing.assert_allclose(found, [5e-3, 3.5e-3 + 1.5e-3 / math.sqrt(2.0), 3.5e-3, 3.5e-3])


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: maximum_stress([1.0, 2.0], KNOWN), "stress: must have the shape"),
        (lambda: maximum_stress("x", KNOWN), "stress: must be a number"),
        (lambda: tsai_wu([1.0, 2.0, 3.0], PLY), "strengths: must be a fastpin.model.PlyStrengths"),
        (lambda: tsai_wu([1.0, 2.0, 3.0], KNOWN, 1.0), "interaction: must lie between -1 and 1, not 1"),
        (lambda: hashin([1.0, 2.0, 3.0], KNOWN, 0.0), "transverse_shear: must be positive"),
        (lambda: maximum_strain([1.0, 2.0, 3.0], replace(PLY, strengths=None)), "strengths: are missing: the ply AS4"),
        (lambda: maximum_strain([1.0, 2.0, 3.0], KNOWN), "ply: must be a fastpin.model.Ply"),
        (lambda: ply_failure(PLY, [1.0, 2.0, 3.0]), "laminate: must be a fastpin.model.Laminate"),
        (lambda: ply_failure(Laminate.from_layup("[0]", PLY), [1.0, 2.0, 3.0], "puck"), 'criterion: must be "maximum'),
        (lambda: first_ply_failure(Laminate.from_moduli(1e9, 1e9, 1e9, 0.1), [1.0, 2.0, 3.0]), "plies: are unknown"),
        (lambda: point_stress_ratio(3.0, 1.0, 1.0), "profile: must be a callable"),
        (lambda: point_stress_ratio(None, 1.0, 1.0), "profile: must be a callable, not None"),
        (
            lambda: average_stress_ratio(float, 1.0, 1.0),
            "profile: must take an array of distances, it raised a TypeError",
        ),
        (lambda: average_stress_ratio(lambda _: "x", 1.0, 1.0), "profile: must be a number"),
        (lambda: hashin([1.0, 2.0, 3.0], KNOWN, 1e-300), "transverse_shear: must lie between"),
        (lambda: point_stress_ratio(hole(1.0), 0.0, 1.0), "strength: must be positive"),
        (lambda: point_stress_ratio(lambda _: np.ones(2), 1.0, 1.0), "profile: must return finite numbers"),
        (lambda: average_stress_ratio(hole(1.0), 1.0, -1.0), "length: must be positive"),
        (lambda: characteristic_radius(2.0, 1.0, 1.0, 1.0), "theta: must lie within a quarter"),
        (lambda: characteristic_radius(1.0, 1.0, -1.0, 1.0), "tension: must not be negative"),
    ],
)
def test_a_wrong_argument_gets_one_sentence(call: Callable[[], object], words: str) -> None:
    assert str(refused(call)).startswith(words)
