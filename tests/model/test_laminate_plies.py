"""Plies and stacks of plies: classical lamination theory, stresses in plies, and the library of plies."""

import dataclasses
import math
import pickle
from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest

from fastpin.errors import InputError, UnknownNameError
from fastpin.model import PLIES, Laminate, Ply, PlyStrengths
from fastpin.model.laminate import ALONG_LOAD
from fastpin.model.ply import PLY_KEYS, ply_from
from tests.support.refusals import refused
from tests.support.tiers import seeds

PLY = Ply(135e9, 9e9, 5e9, 0.3, 0.125e-3)
THICK = Ply(45e9, 16e9, 6e9, 0.28, 0.3e-3, name="glass")


def mean_stiffness(stack: Sequence[tuple[Ply, float]]) -> np.ndarray:
    """The mean stiffness of a stack, Pa, by Tsai and Pagano's invariants: another way than turned matrices."""
    whole = sum(ply.thickness for ply, _ in stack)
    total = np.zeros((3, 3))
    for ply, degrees in stack:
        rest = 1.0 - ply.nu12**2 * ply.E2 / ply.E1
        q11, q22, q12, q66 = ply.E1 / rest, ply.E2 / rest, ply.nu12 * ply.E2 / rest, ply.G12
        u1 = (3.0 * q11 + 3.0 * q22 + 2.0 * q12 + 4.0 * q66) / 8.0
        u2 = (q11 - q22) / 2.0
        u3 = (q11 + q22 - 2.0 * q12 - 4.0 * q66) / 8.0
        u4 = (q11 + q22 + 6.0 * q12 - 4.0 * q66) / 8.0
        c2, c4 = math.cos(math.radians(2.0 * degrees)), math.cos(math.radians(4.0 * degrees))
        s2, s4 = math.sin(math.radians(2.0 * degrees)), math.sin(math.radians(4.0 * degrees))
        b11, b22, b12 = u1 + u2 * c2 + u3 * c4, u1 - u2 * c2 + u3 * c4, u4 - u3 * c4
        b66, b16, b26 = 0.5 * (u1 - u4) - u3 * c4, 0.5 * u2 * s2 + u3 * s4, 0.5 * u2 * s2 - u3 * s4
        total += ply.thickness / whole * np.array([[b11, b12, b16], [b12, b22, b26], [b16, b26, b66]])
    return total


def test_the_reduced_stiffness_is_that_of_jones() -> None:
    # Jones, Mechanics of Composite Materials, T300/5208: 181.8, 10.35, 2.897 and 7.17 GPa
    stiffness = PLIES["T300/5208"].stiffness
    np.testing.assert_allclose(stiffness[[0, 1, 0, 2], [0, 1, 1, 2]], [181.8e9, 10.35e9, 2.897e9, 7.17e9], rtol=5e-4)
    assert stiffness[0, 2] == stiffness[1, 2] == 0.0


def test_plus_and_minus_45_degrees_are_an_isotropic_contact() -> None:
    laminate = Laminate.from_layup("[+-45]s", PLY)
    assert laminate.delta == 0.0
    assert pytest.approx(35.7318e9, rel=1e-6) == laminate.E
    assert laminate.nu == pytest.approx(0.52453, abs=5e-6)
    assert laminate.compliance[3:5] == (0.0, 0.0)


@pytest.mark.parametrize("layup", ["[0/45/-45/90]s", "[0/60/-60]s", "[90/-45/0/45]2s", "[0/36/72/-72/-36]s"])
def test_a_quasi_isotropic_stack_is_isotropic(layup: str) -> None:
    E1, E2, G12, nu12 = Laminate.from_layup(layup, PLY).moduli
    (u1, u4, _), *_ = mean_stiffness([(PLY, 22.5 * k) for k in range(16)])  # plies in all directions
    E = (u1 - u4) * (u1 + u4) / u1
    assert (E1, E2, nu12) == pytest.approx((E, E, u4 / u1))
    assert pytest.approx(0.5 * (u1 - u4)) == G12


def test_compliances_invert_the_mean_stiffness() -> None:
    for seed in seeds(60):
        rng = np.random.default_rng(seed)
        half = [(PLY if rng.random() < 0.5 else THICK, float(rng.integers(-90, 91))) for _ in range(rng.integers(1, 8))]
        stack = half + half[::-1]
        a11, a12, a22, a16, a26, a66 = Laminate(plies=tuple(stack)).compliance
        compliance = np.array([[a11, a12, a16], [a12, a22, a26], [a16, a26, a66]])
        np.testing.assert_allclose(compliance @ mean_stiffness(stack), np.eye(3), atol=1e-11)


def test_stresses_of_plies_balance_that_of_the_whole() -> None:
    for seed in seeds(20):
        rng = np.random.default_rng(seed)
        half = [(PLY if rng.random() < 0.5 else THICK, rng.uniform(-90.0, 90.0)) for _ in range(4)]
        laminate = Laminate.from_plies(half + half[::-1], axis=rng.uniform(-3.0, 3.0))
        stress = rng.normal(size=(5, 2, 3)) * 1e8
        found = laminate.ply_stresses(stress)
        assert found.shape == (8, 5, 2, 3)
        total, strains = np.zeros((5, 2, 2, 2)), laminate.ply_strains(stress)
        whole_strain = stress @ laminate.matrix
        for k, (ply, degrees) in enumerate(laminate.plies):
            angle = laminate.axis + math.radians(degrees)
            turn = np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])
            s1, s2, t12 = np.moveaxis(found[k], -1, 0)
            tensor = np.moveaxis(np.array([[s1, t12], [t12, s2]]), (0, 1), (-2, -1))
            total += ply.thickness / laminate.thickness * (turn @ tensor @ turn.T)
            # all plies have the strains of the whole
            e1, e2, g12 = np.moveaxis(strains[k], -1, 0)
            tensor = np.moveaxis(np.array([[e1, 0.5 * g12], [0.5 * g12, e2]]), (0, 1), (-2, -1))
            in_xy = turn @ tensor @ turn.T
            np.testing.assert_allclose(in_xy[..., 0, 0], whole_strain[..., 0], atol=1e-15)
            np.testing.assert_allclose(2.0 * in_xy[..., 0, 1], whole_strain[..., 2], atol=1e-15)
            np.testing.assert_allclose(s1, (e1 + ply.nu12 * ply.E2 / ply.E1 * e2) * ply.stiffness[0, 0], rtol=1e-9)
        np.testing.assert_allclose(total[..., 0, 0], stress[..., 0], atol=1e-4)
        np.testing.assert_allclose(total[..., 0, 1], stress[..., 2], atol=1e-4)
        np.testing.assert_allclose(total[..., 1, 1], stress[..., 1], atol=1e-4)


def test_a_single_ply_has_the_stress_of_the_whole_in_its_axes() -> None:
    laminate = Laminate.from_layup("[0]4", PLY)
    assert laminate.axis == ALONG_LOAD
    assert laminate.moduli == pytest.approx((135e9, 9e9, 5e9, 0.3))
    # the load acts along -y: a stress along y is one along the fibres
    found = laminate.ply_stresses([1e6, 2e6, 3e6])
    np.testing.assert_allclose(found, np.tile([2e6, 1e6, -3e6], (4, 1)), rtol=1e-12)
    across = Laminate.from_layup([90.0], PLY).ply_stresses([1e6, 2e6, 3e6])
    np.testing.assert_allclose(across, [[1e6, 2e6, 3e6]], rtol=1e-12)


def test_the_fibres_of_a_turned_laminate_turn() -> None:
    one = Laminate.from_layup("[30]", PLY, axis=0.2)
    other = Laminate.from_layup("[0]", PLY, axis=0.2 + math.radians(30.0))
    np.testing.assert_allclose(one.matrix, other.matrix, rtol=1e-9, atol=1e-21)
    np.testing.assert_allclose(one.ply_stresses([1.0, 2.0, 3.0]), other.ply_stresses([1.0, 2.0, 3.0]), rtol=1e-12)


def test_a_laminate_without_plies_has_no_stresses_of_plies() -> None:
    laminate = Laminate.from_moduli(50e9, 50e9, 20e9, 0.3)
    assert laminate.layup == laminate.ply_names == ""
    assert math.isnan(laminate.thickness)
    with pytest.raises(InputError, match="plies: are unknown"):
        laminate.ply_stresses([1.0, 2.0, 3.0])
    with pytest.raises(InputError, match=r"stress: must have the shape \(..., 3\), not \(2,\)"):
        Laminate.from_layup("[0]", PLY).ply_stresses([1.0, 2.0])


@pytest.mark.parametrize("layup", ["[0/90]", "[+-45]", "[0/90]T", "[0/30/0/30]"])
def test_a_stack_that_bends_is_refused(layup: str) -> None:
    with pytest.raises(InputError, match=r"layup: must be symmetric about the middle: .* bends"):
        Laminate.from_layup(layup, PLY)


def test_a_stack_without_coupling_need_not_be_a_mirror_image() -> None:
    angles = [45.0, -45.0, -45.0, 45.0, -45.0, 45.0, 45.0, -45.0]  # antisymmetric, but without coupling
    laminate = Laminate.from_layup(angles, PLY)
    assert laminate.compliance == pytest.approx(Laminate.from_layup("[+-45]2s", PLY).compliance)
    with pytest.raises(InputError, match="plies: must be symmetric"):
        Laminate.from_plies([(PLY, 0.0), (THICK, 0.0)])


def test_laminates_keep_their_plies() -> None:
    laminate = Laminate.from_layup("[0/45/-45/90]2s", "AS4/3501-6", axis=0.3, name="skin")
    assert (laminate.layup, laminate.ply_names, len(laminate.plies)) == ("[0/45/-45/90]2s", "AS4/3501-6", 16)
    assert laminate.thickness == pytest.approx(2e-3)
    assert dataclasses.replace(laminate) == laminate == pickle.loads(pickle.dumps(laminate))
    assert laminate.turned(0.1).layup == laminate.layup
    assert repr(laminate).startswith("Laminate('skin', [0/45/-45/90]2s of AS4/3501-6, E1=")
    double = laminate.scaled(2.0)
    assert double.layup == laminate.layup
    assert double.plies[0][0].strengths is None
    np.testing.assert_allclose(2.0 * double.matrix, laminate.matrix, rtol=1e-12, atol=1e-25)
    with pytest.raises(InputError, match="compliance: must be left out or be that of the plies"):
        Laminate(compliance=(1e-11, 0.0, 1e-11, 0.0, 0.0, 1e-11), plies=laminate.plies)


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"E1": -1.0}, "E1: must be positive, not -1"),
        ({"E2": 1e70}, "E2: must lie between"),
        ({"nu12": 3.9}, "nu12: must lie within +-sqrt(E1/E2) = 3.87298, not 3.9"),
        ({"thickness": 0.0}, "thickness: must be positive"),
        ({"strengths": 3.0}, "strengths: must be a fastpin.model.PlyStrengths"),
        ({"name": "a\nb"}, "name: must be one line"),
    ],
)
def test_a_wrong_ply_gets_one_sentence(given: dict[str, Any], words: str) -> None:
    assert str(refused(dataclasses.replace, PLY, **given)).startswith(words)


@pytest.mark.parametrize(
    ("plies", "words"),
    [
        (3, "plies: must be pairs of a Ply and its angle in degrees, not 3"),
        ([], "plies: must be 1 to 1,000 plies, not 0"),
        ([(PLY, 0.0)] * 1_001, "plies: must be 1 to 1,000 plies, not 1,001"),
        ([PLY], "plies: must be pairs"),
        ([(PLY, 400.0)], "plies: must lie between -360 and 360, not 400"),
        ([(0.0, PLY)], "plies: must be pairs"),
    ],
)
def test_wrong_pairs_get_one_sentence(plies: Any, words: str) -> None:
    assert str(refused(Laminate.from_plies, plies)).startswith(words)


def test_the_entries_of_a_ply_give_it_back() -> None:
    for ply in (PLY, THICK, *PLIES.values()):
        assert ply_from(**ply.entries()) == ply
        assert set(ply.entries()) <= set(PLY_KEYS)
    with pytest.raises(InputError, match="Yt: is missing: the strengths of a ply are Xt, Xc, Yt, Yc, S, all or none"):
        ply_from(**PLY.entries(), Xt=1e9, Xc=1e9)
    with pytest.raises(InputError, match="thickness: is missing"):
        ply_from(E1=1e9, E2=1e9, G12=1e9, nu12=0.3)
    with pytest.raises(InputError, match="Xc: must be positive"):
        PlyStrengths(1e9, -1e9, 1e7, 1e8, 1e8)


def test_named_plies_have_a_source_and_strengths() -> None:
    for name, ply in PLIES.items():
        assert ply.name == name
        assert ply.strengths.Yt < ply.strengths.Yc < ply.strengths.Xt
        assert "quoted after" in ply.source
    with pytest.raises(UnknownNameError, match='did you mean "T300/5208"'):
        PLIES["T300-5208"]
