"""Closed forms of walls and layers against solutions of the raw conditions on their rims, with hundreds of digits."""

import math
from functools import partial

import mpmath
import numpy as np
import pytest

from fastpin.bodies import harmonics
from tests.support import walls
from tests.support.potentials import Potentials, first_harmonic

KINDS = ["free", "held"]
KOLOSOV = [1.0, 1.8, 3.0]
RATIOS = [0.1, 0.3, 0.5, 0.8, 0.95, 0.99, 0.995]
ORDERS = [2, 3, 5, 17, 60, 400]


def relative(found, expected):
    """Largest relative error of entries that doubles can hold."""
    pairs = zip(np.ravel(found), np.ravel(expected), strict=True)
    return max((float(abs(one / other - 1)) for one, other in pairs if abs(other) > 1e-290), default=0.0)


def monomial(m, derivative, z):
    """A derivative of z^m."""
    return math.prod(m - k for k in range(derivative)) * z ** (m - derivative)


def test_the_monomials_are_those_of_the_potentials():
    """The helper against the displacements and tractions of tests/support/potentials.py on a circle."""
    theta, radius, kappa, n = 2.0 * np.pi * np.arange(64) / 64, 1.3, 1.8, 5
    z = radius * np.exp(1j * theta)
    none = np.zeros_like
    for name, m in walls.exponents(n):
        value, slope, second = (partial(monomial, m, derivative) for derivative in range(3))
        parts = (value, slope, second, none, none) if name == "Omega" else (none, none, none, value, slope)
        one = Potentials(kappa, *parts)
        turn = np.exp(-1j * theta)
        t = np.fft.fft(one.traction(z, np.exp(1j * theta)) * turn) / 64
        u = np.fft.fft(one.displacement(z) * turn) / 64
        expected = [float(value) for value in walls.field(name, m, n, radius, kappa)]
        assert [t[n], t[-n], u[n], u[-n]] == pytest.approx(expected, abs=1e-14 * np.abs(expected).max())


# --- one wall ---------------------------------------------------------------------------------------------


@pytest.mark.parametrize("kappa", KOLOSOV)
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("side", ["tube", "ring"])
def test_walls(side, kind, kappa):
    """All ratios and harmonics, each entry relative to itself. Measured: 8e-14, for the powers q^n with n = 400."""
    worst = 0.0
    for ratio in RATIOS:
        for n in ORDERS:
            other = ratio if side == "tube" else 1.0 / ratio
            found = getattr(harmonics, side)(np.array([float(n)]), other, kappa, kind)[:, 0]
            worst = max(worst, relative(found, walls.wall_change(n, other, kappa, kind)))
    assert worst < 2e-13


@pytest.mark.parametrize("kind", KINDS)
def test_low_harmonics_of_walls_to_rounding(kind):
    """Without large powers. Measured: 1.8e-14 for thin free walls, 0.5% of the radius, and 6e-15 for held ones."""
    order = np.array([2.0, 3.0, 4.0, 7.0])
    for ratio in RATIOS:
        for side, other in (("tube", ratio), ("ring", 1.0 / ratio)):
            found = getattr(harmonics, side)(order, other, 1.8, kind)
            for column, n in zip(found.T, order, strict=True):
                assert relative(column, walls.wall_change(int(n), other, 1.8, kind)) < 5e-14


def test_no_overflow_and_no_negative_zero_harmonics():
    """A wide wall and a high harmonic: the change falls below the smallest double, and is 0."""
    order = np.array([2.0, 400.0, 4000.0])
    for kind in KINDS:
        with np.errstate(over="raise", invalid="raise", divide="raise"):
            for found in (harmonics.tube(order, 1e-3, 1.8, kind), harmonics.ring(order, 1e6, 1.8, kind)):
                assert np.isfinite(found).all()
                assert (found[:, 2] == 0.0).all()


def test_the_number_of_harmonics():
    """The numbers of docs/theory.md, section 12, are enough: the next entries are below 1e-16 of the first."""
    for ratio in (0.5, 0.9, 0.98):
        most = harmonics.harmonics_needed(ratio)
        order = np.array([2.0, most + 1.0])
        for found in (harmonics.tube(order, ratio, 1.8, "free"), harmonics.ring(order, 1.0 / ratio, 1.8, "held")):
            assert np.abs(found[:, 1]).max() < 1e-16 * np.abs(found[:, 0]).max()
    assert harmonics.harmonics_needed(0.0) == harmonics.FEWEST


# --- harmonic 0 -------------------------------------------------------------------------------------------


@pytest.mark.parametrize("kappa", KOLOSOV)
@pytest.mark.parametrize("kind", KINDS)
def test_uniform_pressure(kind, kappa):
    """Measured: 4e-15, for the wall's thickness 1 - 0.99."""
    for other in (0.1, 0.5, 0.9, 0.99, 1.01, 1.1, 2.0, 10.0, 1e6):
        expected = float(walls.uniform(other, kappa, kind))
        assert harmonics.uniform(other, kappa, kind) == pytest.approx(expected, rel=1e-14, abs=1e-16)


@pytest.mark.parametrize("kind", KINDS)
def test_uniform_pressure_in_the_limits(kind):
    kappa = 1.8
    assert harmonics.uniform(1e-9, kappa, kind) == pytest.approx(
        harmonics.uniform(0.0, kappa, kind), rel=1e-15, abs=0.0
    )
    assert harmonics.uniform(1e9, kappa, kind) == pytest.approx(
        harmonics.uniform(math.inf, kappa, kind), rel=1e-15, abs=0.0
    )
    assert (harmonics.uniform(0.0, kappa, kind), harmonics.uniform(math.inf, kappa, kind)) == (0.4, -1.0)


@pytest.mark.parametrize("kappa", KOLOSOV)
@pytest.mark.parametrize("outer", [1.02, 1.25, 3.0])
def test_uniform_pressure_on_a_layer(outer, kappa):
    """Bonded to a plate, and to a ring with either rim. Measured: 5e-16."""
    compliance, lug, lug_kappa = 0.7, 1.9, 2.1
    for far, kind in ((math.inf, "free"), (1.5, "free"), (1.5, "held")):
        whole = 0.5 * lug * harmonics.uniform(far, lug_kappa, kind)
        layers = walls.Layers(0, [(outer, kappa, compliance), (outer * far, lug_kappa, lug)], kind)
        found = harmonics.uniform_of_layer(outer, kappa, compliance, whole)
        assert found == pytest.approx(float(layers.uniform()), rel=5e-15, abs=0.0)


@pytest.mark.parametrize("inner", [0.5, 0.8, 0.98])
def test_press_fit(inner):
    """Lame's state of two rings with an interference, from its conditions. Measured: 1.1e-13 for the thin bush."""
    kappa, compliance, lug_kappa, lug = 1.7, 0.7, 2.1, 1.9
    for far, kind in ((math.inf, "free"), (1.5, "free"), (1.5, "held")):
        plate = -0.5 * lug * harmonics.uniform(far, lug_kappa, kind)
        pressure, moved = harmonics.press_fit(inner, kappa, compliance, plate)
        layers = walls.Layers(0, [(1.0 / inner, kappa, compliance), (far / inner, lug_kappa, lug)], kind)
        # an interference of 1e-3 c, c = 1/inner: the plate's displacement less the bush's
        expected = layers.uniform(contact=0, jump=1e-3 / inner)
        assert 1e-3 * moved == pytest.approx(float(expected), rel=1e-12, abs=0.0)
        outside = 2.0 * moved / ((kappa + 1.0) * compliance)  # u_r = -(kappa + 1) p R/[4G (1 - q)]
        assert outside == pytest.approx(-0.5 * pressure / (1.0 - inner**2), rel=1e-14, abs=0.0)


# --- harmonic 1 -------------------------------------------------------------------------------------------

LOADS = ["uniform", "normal", "shear", "held", "body"]


def first_fields(first, radius, theta):
    """Traction and 2G u of the first harmonic on a circle, from potentials, for t_1 = 1 and for conj t_-1 = 1."""
    z, turn, count = radius * np.exp(1j * theta), np.exp(-1j * theta), theta.size
    sizes = 1.0 + np.abs([first.A, first.D, first.L, first.b]).max(axis=0)
    for one, size in zip(first_harmonic(first), sizes, strict=True):
        t = np.fft.fft(one.traction(z, np.exp(1j * theta)) * turn) / count
        u = np.fft.fft(one.displacement(z) * turn) / count
        assert np.abs(np.delete(t, [1, count - 1])).max() < 1e-13 * size
        yield t[1], t[-1], u[1], u[-1]


THETA = 2.0 * np.pi * np.arange(16) / 16


@pytest.mark.parametrize("kappa", KOLOSOV)
@pytest.mark.parametrize("load", LOADS)
@pytest.mark.parametrize("other", [0.1, 0.5, 0.9, 0.99, 1.01, 1.1, 2.0, 10.0])
def test_the_first_harmonic_satisfies_the_conditions_on_both_rims(other, load, kappa):
    """Measured: 3e-15 of the largest amplitude; thin walls have amplitudes 1/(1 - q^2) times as large."""
    first = harmonics.first(other, kappa, load)
    size = 1.0 + max(np.abs(part).max() for part in (first.A, first.D, first.L, first.b))
    near, far = list(first_fields(first, 1.0, THETA)), list(first_fields(first, other, THETA))
    for (t, opposite, u, back), (t_far, opposite_far, u_far, back_far), given, coefficient in zip(
        near, far, ((1.0, 0.0), (0.0, 1.0)), range(2), strict=True
    ):
        assert (t, opposite) == pytest.approx(given, abs=2e-14 * size)
        if load == "held":
            assert u_far == pytest.approx(0.0, abs=2e-14 * size)
        elif load == "body":
            assert (t_far, opposite_far) == pytest.approx((0.0, 0.0), abs=2e-14 * size)
        else:
            eta = {"uniform": 0.0, "normal": 1.0, "shear": -1.0}[load]
            assert t_far == pytest.approx(eta * opposite_far, abs=2e-14 * size)
            assert opposite_far == pytest.approx(opposite / other, abs=2e-14 * size)  # the resultant
        assert first.displacement()[coefficient] == pytest.approx(u, abs=2e-14 * size)
        assert first.traction(other)[coefficient] == pytest.approx(t_far, abs=2e-14 * size)
        assert first.translation(other)[coefficient] == pytest.approx(back - back_far, abs=2e-14 * size)


@pytest.mark.parametrize("load", LOADS)
def test_the_first_harmonic_in_the_limits(load):
    """A small bore is a disk with a force at the centre, or a body load; a far rim is an infinite plate."""
    kappa = 1.8
    disk, plate = harmonics.first(0.0, kappa, load), harmonics.first(math.inf, kappa, "uniform")
    assert harmonics.first(1e-5, kappa, load).displacement() == pytest.approx(disk.displacement(), abs=1e-9)
    found = harmonics.first(1e5, kappa, load).displacement()
    assert found == pytest.approx(plate.displacement(), abs=1e-9)
    assert disk.displacement() == pytest.approx([0.5 * kappa, -0.5 if load == "body" else -1.0], rel=1e-15, abs=0.0)
    assert plate.displacement() == pytest.approx([-0.5, 0.0], abs=1e-15)


@pytest.mark.parametrize("load", ["uniform", "held", "body", "shear"])
@pytest.mark.parametrize("outer", [1.02, 1.25, 3.0])
def test_the_first_harmonic_of_a_layer(outer, load):
    """Traction on the contact rim, and one displacement on both sides of the interface. Measured: 3e-16."""
    kappa, compliance, lug_kappa, lug = 1.7, 0.7, 2.1, 1.9
    for far in (1.5, math.inf):
        whole = 0.5 * lug * harmonics.first(far, lug_kappa, load).displacement()
        layer = harmonics.first_of_layer(outer, kappa, compliance, whole)
        size = 1.0 + max(np.abs(part).max() for part in (layer.A, layer.D, layer.L))
        for (t, opposite, _, _), (t_far, opposite_far, u_far, _), given in zip(
            first_fields(layer, 1.0, THETA), first_fields(layer, outer, THETA), ((1.0, 0.0), (0.0, 1.0)), strict=True
        ):
            assert (t, opposite) == pytest.approx(given, abs=2e-14 * size)
            lug_moved = outer * (whole @ [t_far, opposite_far])
            assert 0.5 * compliance * u_far == pytest.approx(lug_moved, abs=2e-14 * size)


# --- layers -----------------------------------------------------------------------------------------------


def layer_compliance(order, outer, kappa, compliance, far):
    """The whole compliance of the contact rim of a layer round which the compliances are `far`."""
    layer = harmonics.Layer(order, outer, kappa, compliance)
    return harmonics.hole(order, kappa, compliance) + layer.contact_displacement(layer.amplitudes(far))


def lug_compliance(order, rim, kappa, compliance, kind):
    """The whole compliance of the hole in a ring or an infinite plate."""
    whole = harmonics.hole(order, kappa, compliance)
    if math.isfinite(rim):
        whole += 0.5 * compliance * harmonics.as_matrices(harmonics.ring(order, rim, kappa, kind))
    return whole


LUGS = [(math.inf, "free"), (1.5, "free"), (1.5, "held"), (1.02, "free")]
THIN = 1.02


def layer_on_a_lug(outer, lug):
    """A layer, the compliances of the lug outside it, and the exact ones of the contact rim, for some harmonics."""
    (rim, kind), (kappa, compliance, lug_kappa, lug_compliance_) = lug, (1.7, 0.7, 2.1, 1.9)
    layer = harmonics.Layer(np.array([2.0, 3.0, 5.0, 17.0, 60.0]), outer, kappa, compliance)
    rims = [(outer, kappa, compliance), (outer * rim, lug_kappa, lug_compliance_)]
    expected = [walls.Layers(int(n), rims, kind).compliance().astype(float) for n in layer.order]
    return layer, lug_compliance(layer.order, rim, lug_kappa, lug_compliance_, kind), expected


@pytest.mark.parametrize("lug", [lug for lug in LUGS if lug[0] != THIN])
@pytest.mark.parametrize("outer", [THIN, 1.25, 3.0])
def test_layers(outer, lug):
    """The whole compliance, in parts of its largest entry. Measured: 3e-15."""
    layer, far, compliances = layer_on_a_lug(outer, lug)
    found = layer_compliance(layer.order, outer, layer.kolosov, layer.compliance, far)
    for one, expected in zip(found, compliances, strict=True):
        assert one == pytest.approx(expected, abs=1e-14 * np.abs(expected).max())


@pytest.mark.parametrize("lug", LUGS)
@pytest.mark.parametrize("outer", [THIN, 1.25, 3.0])
def test_the_equations_of_layers_solved_with_many_digits(outer, lug):
    """A free ring of 2% bends easily, so the equations have a condition number of 1e5.

    Rounding of their coefficients in doubles then costs up to five digits, and other processors round differently. With
    60 digits from the same lug, the whole compliance has the accuracy of the lug's compliance and of the layer's
    matrices alone. Measured, in parts of the largest entry: 2e-13, and 1.2e-12 if the layer is as thin.
    """
    layer, far, compliances = layer_on_a_lug(outer, lug)
    tolerance = 1e-14 if lug[0] != THIN else 2e-11 if outer == THIN else 1e-12
    hole = harmonics.hole(layer.order, layer.kolosov, layer.compliance)
    with mpmath.workdps(60):
        for k, expected in enumerate(compliances):
            system, right = equations(layer, far, k)
            amplitudes = np.array((system**-1 * right).tolist(), dtype=object)
            one = harmonics.Layer(layer.order[k : k + 1], *layer[1:]).contact_displacement(amplitudes[None])[0]
            assert (one + hole[k]).astype(float) == pytest.approx(expected, abs=tolerance * np.abs(expected).max())


@pytest.mark.parametrize("lug", LUGS)
@pytest.mark.parametrize("outer", [THIN, 1.25, 3.0])
def test_amplitudes_solve_the_equations_of_layers_to_rounding(outer, lug):
    """The residual of S x = b, entry by entry, with S = G - F T and b = F t - g; see `Layer.amplitudes`.

    Let u be half a unit in the last place, and |A| the matrix of magnitudes. A product of matrices of order 2 has
    rounding 2u, and the difference one more. Gauss's elimination with pivots solves a system that differs from S by at
    most 6u |L| |U|. With pivots |L| <= 1, so no entry of |L| |U| is above three times the largest one of its column
    of S. All bounds hold for any order of the sums, and with fused products. The doubled u covers terms in u^2.
    """
    layer, far, _ = layer_on_a_lug(outer, lug)
    found = layer.amplitudes(far)
    largest = np.abs(layer.growing_displacement - far @ layer.growing_traction).max(axis=1, keepdims=True)
    F, G, T = np.abs(far), np.abs(layer.growing_displacement), np.abs(layer.growing_traction)
    sums = (3.0 * F @ T + G + 18.0 * largest) @ np.abs(found)
    sums += 3.0 * F @ np.abs(layer.decaying_traction) + np.abs(layer.decaying_displacement)
    with mpmath.workdps(60):
        for k, amplitudes in enumerate(found):
            system, right = equations(layer, far, k)
            residual = np.array((system * exact(amplitudes) - right).tolist()).astype(float)
            assert (np.abs(residual) <= np.finfo(float).eps * sums[k]).all()


def equations(layer, far, k):
    """Matrix and right side, each (2, 2) in many digits, for the amplitudes of one harmonic, from rounded parts."""
    parts = layer.growing_displacement, layer.growing_traction, layer.decaying_traction, layer.decaying_displacement
    G, T, t, g = (exact(part[k]) for part in parts)
    return G - exact(far[k]) * T, exact(far[k]) * t - g


def exact(matrix):
    return mpmath.matrix(matrix.tolist())


@pytest.mark.parametrize("outer", [1.02, 1.25, 2.0])
def test_a_load_outside_a_layer(outer):
    """Tractions on the far rim of a free ring, and a displaced hole round a bush; the contact rim carries nothing.

    Measured: 2e-12 for a wall of 2%, 8e-15 for the others.
    """
    tolerance = 1e-11 if outer == 1.02 else 5e-14
    order, kappa, compliance, lug_kappa, lug = np.array([2.0, 3.0, 10.0, 40.0]), 1.7, 0.7, 2.1, 1.9
    layer = harmonics.Layer(order, outer, kappa, compliance)
    given = np.array([[1.0, 0.0], [0.3, 1.0], [0.0, 1.0], [1.0, -2.0]])
    loaded = layer.contact_displacement(layer.loaded_outside(given))
    far = lug_compliance(order, 1.5, lug_kappa, lug, "free")
    displaced = layer.contact_displacement(layer.moved_outside(far, given))
    for k, n in enumerate(order):
        ring = walls.Layers(int(n), [(outer, kappa, compliance)])
        expected = ring.solve((0, 0), outer=given[k]).astype(float)
        assert loaded[k] == pytest.approx(expected, abs=tolerance * np.abs(expected).max())
        # The free hole of the lug is displaced by `given` c: the bush's rim follows, less the lug's answer.
        bush = walls.Layers(int(n), [(outer, kappa, compliance), (outer * 1.5, lug_kappa, lug)])
        expected = bush.solve((0, 0), jump=-outer * given[k]).astype(float)
        assert displaced[k] == pytest.approx(expected, abs=tolerance * np.abs(expected).max())
