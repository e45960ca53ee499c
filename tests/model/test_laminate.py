"""Laminates given by compliances or moduli: their constants at the edge of a round hole, and refusals."""

import math
import pickle
from typing import Any

import numpy as np
import pytest

import fastpin
from fastpin.errors import InputError
from fastpin.model import Laminate, Material, MaterialPair
from fastpin.model.laminate import ORDER, in_axes, stroh_roots
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


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({}, "compliance: must be six numbers"),
        ({"compliance": (1.0, 2.0)}, "compliance: must be six numbers"),
        ({"compliance": "six"}, "compliance: must be a number"),
        ({"compliance": (1e-11, 0.0, 1e-11, 0.0, 0.0, -1e-11)}, "compliance: a66 must be positive"),
        ({"compliance": (1e-11, 2e-11, 1e-11, 0.0, 0.0, 1e-11)}, "compliance: must be positive definite"),
        ({"compliance": (1e-11, 0.0, 1e-11, 0.0, 0.0, 1e70)}, "compliance: must lie between"),
        ({"compliance": (1e-11, 0.0, 1e-11, 0.0, 0.0, math.nan)}, "compliance: must be a finite number"),
        ({"compliance": (1e-11, 0.0, 1e-11, 0.0, 0.0, 1e-11), "axis": "x"}, "axis: must be a number"),
        ({"compliance": (1e-11, 0.0, 1e-11, 0.0, 0.0, 1e-11), "yield_strength": 1e8}, "yield_strength: has no meaning"),
        (
            {"compliance": (1e-11, 0.0, 1e-11, 0.0, 0.0, 1e-11), "fatigue": fastpin.model.FatigueConstants()},
            "fatigue: ",
        ),
    ],
)
def test_a_wrong_laminate_gets_one_sentence(given: dict[str, Any], words: str) -> None:
    assert str(refused(Laminate, **given)).startswith(words)


@pytest.mark.parametrize(
    ("moduli", "words"),
    [
        ((0.0, 1e9, 1e9, 0.3), "E1: must be positive"),
        ((1e9, 1e9, 1e61, 0.3), "G12: must lie between"),
        ((1e9, 4e9, 1e9, 0.5), r"nu12: must lie within +-sqrt(E1/E2) = 0.5, not 0.5"),
    ],
)
def test_wrong_moduli_get_one_sentence(moduli: tuple[float, float, float, float], words: str) -> None:
    assert str(refused(Laminate.from_moduli, *moduli)).startswith(words)


def test_only_the_plate_is_a_laminate() -> None:
    laminate, steel = Laminate.from_moduli(50e9, 50e9, 20e9, 0.3), fastpin.MATERIALS["steel"]
    pair = MaterialPair(steel, laminate, "stress")
    assert pair.beta_star == pytest.approx(2.0 * (laminate.lambda0 + 0.5 * 4.0 / (1.3 * 2.0 * steel.shear_modulus)))
    with pytest.raises(InputError, match="pin: must be isotropic"):
        MaterialPair(laminate, steel)


def test_a_scaled_laminate_has_other_moduli_and_the_same_axes() -> None:
    laminate = Laminate.from_moduli(50e9, 20e9, 10e9, 0.3, axis=0.4, name="wood")
    double = laminate.scaled(2.0)
    assert double.moduli == pytest.approx((100e9, 40e9, 20e9, 0.3))
    assert (double.axis, double.name) == (0.4, "wood")
    assert double.delta == pytest.approx(0.5 * laminate.delta)
    assert pickle.loads(pickle.dumps(double)) == double
    assert repr(double) == "Laminate('wood', E1=1e+11, E2=4e+10, G12=2e+10, nu12=0.3, axis=0.4)"


@pytest.mark.parametrize("remote", [3.0, [1.0, 2.0], [[1.0, 2.0, 3.0]], "x"])
def test_a_wrong_remote_stress_gets_one_sentence(remote: Any) -> None:
    with pytest.raises(InputError, match=r"^remote: must "):
        Laminate.from_moduli(50e9, 50e9, 20e9, 0.3).hole_displacement(remote)
