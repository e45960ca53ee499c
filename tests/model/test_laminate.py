"""Laminates: their constants at the edge of a round hole, plies and stacks of plies, and refusals."""

import dataclasses
import math
import pickle
from collections.abc import Callable, Sequence

import numpy as np
import pytest

import fastpin
from fastpin.errors import InputError, UnknownNameError
from fastpin.model import PLIES, Laminate, Material, MaterialPair, Ply, PlyStrengths
from fastpin.model.laminate import ALONG_LOAD, ORDER, in_axes, stroh_roots
from fastpin.model.ply import PLY_KEYS, ply_from
from tests.support.refusals import refused
from tests.support.tiers import seeds

TURN = np.array([[0.0, -1.0], [1.0, 0.0]])


def orthotropic(rng: np.random.Generator) -> tuple[float, float, float, float]:
    """Random moduli E1, E2, G12, Pa, and nu12 of a stable plate."""
    first, second = 10.0 ** rng.uniform(9.0, 11.5, 2)
    shear = math.sqrt(first * second) * 10.0 ** rng.uniform(-1.5, 0.5)
    return first, second, shear, rng.uniform(-0.9, 0.9) * math.sqrt(first / second)


def stable(rng: np.random.Generator) -> np.ndarray:
    """A random compliance matrix of a stable plate, 1/Pa, shape (3, 3)."""
    root = rng.normal(size=(3, 3))
    return (root @ root.T + 0.05 * np.eye(3)) * 1e-11


def laminate_of(matrix: np.ndarray, axis: float = 0.0) -> Laminate:
    places = {"1": 0, "2": 1, "6": 2}
    return Laminate(compliance=tuple(matrix[places[name[1]], places[name[2]]] for name in ORDER), axis=axis)


def test_constants_of_orthotropic_laminates_have_closed_forms() -> None:
    for seed in seeds(200):
        rng = np.random.default_rng(seed)
        Ex, Ey, G, nu = orthotropic(rng)
        laminate = Laminate.from_moduli(Ex, Ey, G, nu, axis=0.0)
        k = math.sqrt(Ex / Ey)
        n = math.sqrt(2.0 * (k - nu) + Ex / G)
        expected = np.diag([n / Ex, n / math.sqrt(Ex * Ey)])
        size = expected.max()
        np.testing.assert_allclose(laminate.edge_tensor, expected, atol=1e-12 * size)
        assert laminate.s == pytest.approx(1.0 / math.sqrt(Ex * Ey) - nu / Ex, abs=1e-7 * size)
        assert laminate.moduli == pytest.approx((Ex, Ey, G, nu), rel=1e-14)


def test_constants_are_those_of_strohs_matrices() -> None:
    for seed in seeds(200):
        laminate = laminate_of(stable(np.random.default_rng(seed)))
        (a11, a12, a16), (_, a22, a26), _ = laminate.matrix
        mu = np.array(stroh_roots(laminate.matrix))
        motions = np.array([a11 * mu**2 + a12 - a16 * mu, a12 * mu + a22 / mu - a26])
        forces = np.array([-mu, np.ones(2)])
        both = motions @ np.linalg.inv(forces)
        expected = -1j * laminate.edge_tensor - laminate.s * TURN
        np.testing.assert_allclose(both, expected, atol=1e-9 * abs(both).max())


def test_lambda_turns_as_a_tensor_and_s_stays() -> None:
    for seed in seeds(50):
        rng = np.random.default_rng(seed)
        laminate, angle = laminate_of(stable(rng), rng.uniform(-3.0, 3.0)), rng.uniform(-3.0, 3.0)
        turned = laminate.turned(angle)
        cos, sin = math.cos(angle), math.sin(angle)
        rotation = np.array([[cos, -sin], [sin, cos]])
        size = laminate.lambda0
        np.testing.assert_allclose(turned.edge_tensor, rotation @ laminate.edge_tensor @ rotation.T, atol=1e-12 * size)
        assert turned.s == laminate.s
        assert turned.lambda0 == laminate.lambda0
        # the same constants from the compliances in x and y
        again = laminate_of(turned.matrix)
        np.testing.assert_allclose(again.edge_tensor, turned.edge_tensor, atol=1e-8 * size)
        assert again.s == pytest.approx(turned.s, abs=1e-8 * size)


def test_compliances_in_turned_axes_keep_the_energy() -> None:
    for seed in seeds(20):
        rng = np.random.default_rng(seed)
        own, angle = stable(rng), rng.uniform(-3.0, 3.0)
        sxx, syy, sxy = stress = rng.normal(size=3)
        cos, sin = math.cos(angle), math.sin(angle)
        rotation = np.array([[cos, sin], [-sin, cos]])
        new = rotation @ np.array([[sxx, sxy], [sxy, syy]]) @ rotation.T
        in_new = np.array([new[0, 0], new[1, 1], new[0, 1]])
        assert in_new @ in_axes(own, angle) @ in_new == pytest.approx(stress @ own @ stress, rel=1e-12)


def test_an_isotropic_laminate_is_the_isotropic_plate() -> None:
    E, nu = 70e9, 0.33
    laminate = Laminate.from_moduli(E, E, E / (2.0 * (1.0 + nu)), nu, axis=0.7)
    assert laminate.is_isotropic_contact
    assert pytest.approx(E, rel=1e-7) == laminate.E
    assert laminate.nu == pytest.approx(nu, rel=1e-6)
    assert laminate.shear_modulus == pytest.approx(Material(E, nu).shear_modulus, rel=1e-7)
    for plane in ("strain", "stress"):
        assert laminate.kolosov(plane) == pytest.approx(Material(E, nu).kolosov("stress"), rel=1e-6)
    sxx, syy, sxy = remote = (3e7, -1e7, 2e7)
    mean, second = laminate.hole_displacement(remote)
    assert mean == pytest.approx((sxx + syy) / E, abs=1e-10)
    assert second == pytest.approx(2.0 * complex(sxx - syy, 2.0 * sxy) / E, abs=1e-9)


def test_remote_tension_moves_the_hole_by_the_hoop_strains_of_lekhnitskii() -> None:
    for seed in seeds(20):
        rng = np.random.default_rng(seed)
        Ex, Ey, G, nu = orthotropic(rng)
        laminate = Laminate.from_moduli(Ex, Ey, G, nu, axis=0.0)
        k = math.sqrt(Ex / Ey)
        n = math.sqrt(2.0 * (k - nu) + Ex / G)
        mean, second = laminate.hole_displacement((1.0, 0.0, 0.0))
        for theta in np.linspace(0.0, 2.0 * math.pi, 17):
            # R e_tt = v_r + dv_theta/dtheta
            turn = second * complex(math.cos(2.0 * theta), -math.sin(2.0 * theta))
            strain = mean.real + turn.real + (-2j * turn).imag
            c2, s2 = math.cos(theta) ** 2, math.sin(theta) ** 2
            along = s2 * s2 / Ex + (1.0 / G - 2.0 * nu / Ex) * s2 * c2 + c2 * c2 / Ey
            hoop = (1.0 / along / Ex) * (-k * c2 + (1.0 + n) * s2)
            assert strain == pytest.approx(hoop * along, abs=1e-7 * (1.0 + n) / min(Ex, Ey))


def test_a_cross_ply_at_any_angle_has_an_isotropic_contact() -> None:
    laminate = Laminate.from_moduli(70e9, 70e9, 5e9, 0.05, axis=0.3)
    assert laminate.delta == 0.0
    assert not Laminate.from_moduli(70e9, 71e9, 5e9, 0.05).is_isotropic_contact


def test_only_the_plate_is_a_laminate() -> None:
    laminate, steel = Laminate.from_moduli(50e9, 50e9, 20e9, 0.3), fastpin.MATERIALS["steel"]
    pair = MaterialPair(steel, laminate, "stress")
    assert pair.beta_star == pytest.approx(2.0 * (laminate.lambda0 + 0.5 * 4.0 / (1.3 * 2.0 * steel.shear_modulus)))


def test_a_scaled_laminate_has_other_moduli_and_the_same_axes() -> None:
    laminate = Laminate.from_moduli(50e9, 20e9, 10e9, 0.3, axis=0.4, name="wood")
    double = laminate.scaled(2.0)
    assert double.moduli == pytest.approx((100e9, 40e9, 20e9, 0.3))
    assert (double.axis, double.name) == (0.4, "wood")
    assert double.delta == pytest.approx(0.5 * laminate.delta)
    assert pickle.loads(pickle.dumps(double)) == double
    assert repr(double) == "Laminate('wood', E1=1e+11, E2=4e+10, G12=2e+10, nu12=0.3, axis=0.4)"


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


def test_a_laminate_without_plies_names_none() -> None:
    laminate = Laminate.from_moduli(50e9, 50e9, 20e9, 0.3)
    assert laminate.layup == laminate.ply_names == ""
    assert math.isnan(laminate.thickness)


@pytest.mark.parametrize("layup", ["[0/90]", "[+-45]", "[0/90]T", "[0/30/0/30]"])
def test_a_stack_that_bends_is_refused(layup: str) -> None:
    with pytest.raises(InputError, match=r"layup: must be symmetric about the middle: .* bends"):
        Laminate.from_layup(layup, PLY)


def test_a_stack_without_coupling_need_not_be_a_mirror_image() -> None:
    angles = [45.0, -45.0, -45.0, 45.0, -45.0, 45.0, 45.0, -45.0]  # antisymmetric, but without coupling
    laminate = Laminate.from_layup(angles, PLY)
    assert laminate.compliance == pytest.approx(Laminate.from_layup("[+-45]2s", PLY).compliance)


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


MODULI = 50e9, 50e9, 20e9, 0.3
SIX = 1e-11, 0.0, 1e-11, 0.0, 0.0, 1e-11


@pytest.mark.parametrize(
    ("make", "sentence"),
    [
        (lambda: Laminate(), "compliance: must be six numbers"),
        (lambda: Laminate(compliance=(1.0, 2.0)), "compliance: must be six numbers"),
        (lambda: Laminate(compliance="six"), "compliance: must be a number"),
        (lambda: Laminate(compliance=(*SIX[:5], -1e-11)), "compliance: a66 must be positive"),
        (lambda: Laminate(compliance=(1e-11, 2e-11, *SIX[2:])), "compliance: must be positive definite"),
        (lambda: Laminate(compliance=(*SIX[:5], 1e70)), "compliance: must lie between"),
        (lambda: Laminate(compliance=(*SIX[:5], math.nan)), "compliance: must be a finite number"),
        (lambda: Laminate(compliance=SIX, axis="x"), "axis: must be a number"),
        (lambda: Laminate(compliance=SIX, yield_strength=1e8), "yield_strength: has no meaning"),
        (lambda: Laminate(compliance=SIX, fatigue=fastpin.model.FatigueConstants()), "fatigue: "),
        (lambda: Laminate.from_moduli(0.0, 1e9, 1e9, 0.3), "E1: must be positive"),
        (lambda: Laminate.from_moduli(1e9, 1e9, 1e61, 0.3), "G12: must lie between"),
        (
            lambda: Laminate.from_moduli(1e9, 4e9, 1e9, 0.5),
            "nu12: must lie within +-sqrt(E1/E2) = 0.5, not 0.5",
        ),
        (lambda: MaterialPair(Laminate.from_moduli(*MODULI), fastpin.MATERIALS["steel"]), "pin: must be isotropic"),
        *(
            (lambda remote=remote: Laminate.from_moduli(*MODULI).hole_displacement(remote), "remote: must ")
            for remote in (3.0, [1.0, 2.0], [[1.0, 2.0, 3.0]], "x")
        ),
        (lambda: dataclasses.replace(PLY, E1=-1.0), "E1: must be positive, not -1"),
        (lambda: dataclasses.replace(PLY, E2=1e70), "E2: must lie between"),
        (lambda: dataclasses.replace(PLY, nu12=3.9), "nu12: must lie within +-sqrt(E1/E2) = 3.87298, not 3.9"),
        (lambda: dataclasses.replace(PLY, thickness=0.0), "thickness: must be positive"),
        (lambda: dataclasses.replace(PLY, strengths=3.0), "strengths: must be a fastpin.model.PlyStrengths"),
        (lambda: dataclasses.replace(PLY, name="a\nb"), "name: must be one line"),
        (lambda: Laminate.from_plies(3), "plies: must be pairs of a Ply and its angle in degrees, not 3"),
        (lambda: Laminate.from_plies([]), "plies: must be 1 to 1,000 plies, not 0"),
        (lambda: Laminate.from_plies([(PLY, 0.0)] * 1_001), "plies: must be 1 to 1,000 plies, not 1,001"),
        (lambda: Laminate.from_plies([PLY]), "plies: must be pairs"),
        (lambda: Laminate.from_plies([(PLY, 400.0)]), "plies: must lie between -360 and 360, not 400"),
        (lambda: Laminate.from_plies([(0.0, PLY)]), "plies: must be pairs"),
        (lambda: Laminate.from_plies([(PLY, 0.0), (THICK, 0.0)]), "plies: must be symmetric"),
        (lambda: Laminate.from_moduli(*MODULI).ply_stresses([1.0, 2.0, 3.0]), "plies: are unknown"),
        (
            lambda: Laminate.from_layup("[0]", PLY).ply_stresses([1.0, 2.0]),
            "stress: must have the shape (..., 3), not (2,)",
        ),
        (
            lambda: Laminate(compliance=SIX, plies=Laminate.from_layup("[0/90]s", PLY).plies),
            "compliance: must be left out or be that of the plies",
        ),
        (
            lambda: ply_from(**PLY.entries(), Xt=1e9, Xc=1e9),
            "Yt: is missing: the strengths of a ply are Xt, Xc, Yt, Yc, S, all or none",
        ),
        (lambda: ply_from(E1=1e9, E2=1e9, G12=1e9, nu12=0.3), "thickness: is missing"),
        (lambda: PlyStrengths(1e9, -1e9, 1e7, 1e8, 1e8), "Xc: must be positive"),
    ],
)
def test_a_wrong_laminate_or_ply_gets_one_sentence(make: Callable[[], object], sentence: str) -> None:
    assert str(refused(make)).startswith(sentence)


def test_the_entries_of_a_ply_give_it_back() -> None:
    for ply in (PLY, THICK, *PLIES.values()):
        assert ply_from(**ply.entries()) == ply
        assert set(ply.entries()) <= set(PLY_KEYS)


def test_named_plies_have_a_source_and_strengths() -> None:
    for name, ply in PLIES.items():
        assert ply.name == name
        assert ply.strengths.Yt < ply.strengths.Yc < ply.strengths.Xt
        assert "quoted after" in ply.source
    with pytest.raises(UnknownNameError, match='did you mean "T300/5208"'):
        PLIES["T300-5208"]
