"""The stresses on the edge by the conjugate of the shear: compiled, as plain Python, and against the plain sum."""

import numpy as np
import pytest
from scipy.special import spence

from fastpin.elasticity.tractions import Tractions, cauchy_integrals
from fastpin.kernels import conjugate
from tests.support.tractions import patch, samples

KERNELS = conjugate
PARTS = {"N": 1, "H": 2, "cos": 3, "sin": 4, "cos 2": 5, "sin 2": 6}


def all_samples():
    rng = np.random.default_rng(7)
    graded = patch(rng, -2.0, -1.0, 90)
    graded[:61, 0] = -2.0 + 0.3 * np.linspace(0.0, 1.0, 61) ** 4
    graded[:61, 1:] = np.sqrt(graded[:61, :1] + 2.0) * [1.0, 0.5]
    graded[61:, 0] = np.sort(rng.uniform(-1.7, -1.0, 29))
    return samples() | {
        "graded": Tractions((graded,)),
        "in another order": Tractions((patch(rng, 0.2, 1.1, 21), patch(rng, -3.0, -1.0, 33))),
        "without shear": Tractions((patch(rng, -2.0, -1.0, 20) * [1.0, 1.0, 0.0],)),
    }


def read(tractions, theta, part):
    """srr, the hoop stress of one part, and srt."""
    field = np.zeros(7)
    field[PARTS[part]] = 1.0
    return tractions.on_edge(np.asarray(theta), *field)


def plain(tractions, theta):
    """N, T and H at an angle: Clausen's function of all nodes, with the dilogarithm of SciPy."""
    pressure = shear = conjugate_of_shear = 0.0
    for nodes in tractions.patches:
        slopes = np.diff(nodes[:, 2]) / np.diff(nodes[:, 0])
        jumps = np.diff(slopes, prepend=0.0, append=0.0)
        away = np.remainder(theta - nodes[:, 0] + np.pi, 2.0 * np.pi) - np.pi
        conjugate_of_shear -= jumps @ spence(1.0 - np.exp(1j * away)).imag / (2.0 * np.pi)
        for turned in (theta - 2.0 * np.pi, theta, theta + 2.0 * np.pi):
            if nodes[0, 0] <= turned <= nodes[-1, 0]:
                pressure, shear = (np.interp(turned, nodes[:, 0], nodes[:, k]) for k in (1, 2))
    return pressure, shear, conjugate_of_shear


def rounding(tractions):
    """Rounding of the closed form: its terms have the size of the slopes."""
    slopes = [np.diff(nodes[:, 2]) / np.diff(nodes[:, 0]) for nodes in tractions.patches]
    return 1e-14 + 2e-16 * sum(float(np.abs(slope).sum()) for slope in slopes)


@pytest.mark.parametrize("name", all_samples())
def test_stresses_against_the_plain_sum(way, name):
    """At nodes, beside them and far away."""
    rng, tractions = np.random.default_rng(5), all_samples()[name]
    nodes = np.concatenate([np.zeros((0, 3)), *tractions.patches])[::9, 0]
    theta = np.r_[rng.uniform(-4.0, 4.0, 12), nodes, nodes + 1e-9, nodes - 2.0 * np.pi + 1e-3]
    expected = np.array([plain(tractions, angle) for angle in theta]).T
    found = read(tractions, theta, "H")
    assert found == pytest.approx(expected[[0, 2, 1]] * [[-1.0], [1.0], [1.0]], abs=10.0 * rounding(tractions))
    assert np.array_equal(read(tractions, theta, "N")[1], -found[0])


@pytest.mark.parametrize("name", ["arc", "graded", "two patches"])
def test_the_conjugate_is_a_cauchy_integral(way, name):
    tractions, theta = all_samples()[name], np.linspace(-3.0, 3.0, 40)
    expected = cauchy_integrals(tractions, theta, np.zeros(40), outside=True)[:, 1].imag
    assert read(tractions, theta, "H")[1] == pytest.approx(expected, abs=20.0 * rounding(tractions))


def test_the_other_parts_are_waves(way):
    theta, nothing = np.linspace(-6.0, 6.0, 20), Tractions(())
    for part, wave in {"cos": np.cos, "sin": np.sin}.items():
        assert read(nothing, theta, part)[1] == pytest.approx(wave(theta), abs=1e-15)
        assert read(nothing, theta, f"{part} 2")[1] == pytest.approx(wave(2.0 * theta), abs=2e-15)


def test_points_do_not_depend_on_their_neighbours(way):
    tractions, theta = all_samples()["arc"], np.linspace(-4.0, 2.0, 7)
    alone = [read(tractions, theta[k : k + 1], "H")[:, 0] for k in range(7)]
    assert np.array_equal(read(tractions, theta, "H").T, alone)
