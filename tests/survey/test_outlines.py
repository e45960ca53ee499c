"""Stresses and cracks in a tapered lug with fillets, against finite elements."""

import math

import numpy as np
import pytest

from fastpin import Material, MaterialPair, Problem, solve
from fastpin.cracks import Crack, stress_intensity
from fastpin.errors import InputWarning
from fastpin.lugs.outline import Lug, Part
from fastpin.lugs.plates import plate_compliance
from tests.support.lugs import stress_at
from tests.survey.spectral_elements import SpectralPlate

pytestmark = pytest.mark.survey


def tapered_lug():
    """A head of 2.2 R, sides that lean by 20 deg, fillets of 1 R, and a shank of half width 1.3 R, held at y = 9 R."""
    tilt = math.radians(20.0)
    start, along = 2.2 * np.exp(1j * tilt), 1j * np.exp(1j * tilt)
    corner = start + along * (start.real - 1.3) / math.sin(tilt)
    low, high = corner - math.tan(0.5 * tilt) * along, corner + 1j * math.tan(0.5 * tilt)
    through = high + 1.0 + (corner - high - 1.0) / abs(corner - high - 1.0)
    right = [("taper", start, low, None), ("fillet", low, high, through), ("shank", high, 1.3 + 9j, None)]
    left = [
        (name, -np.conj(end), -np.conj(begin), None if middle is None else -np.conj(middle))
        for name, begin, end, middle in reversed(right)
    ]
    whole = [*right, ("top", 1.3 + 9j, -1.3 + 9j, None), *left, ("nose", -np.conj(start), start, -2.2j)]
    parts = [Part(name, *map(complex, ends), None if mid is None else complex(mid)) for name, *ends, mid in whole]
    return Lug(0.3, "stress", 1.0, tuple(parts), {"top": "both"})


def graded(count, start, end):
    """Shares of a part at which it is cut: `count` equal pieces, and more towards its ends."""
    piece = 1.0 / count
    low, high = ([piece * 0.3**k for k in range(1, times + 1)] for times in (start, end))
    return np.array(sorted({*np.linspace(0.0, 1.0, count + 1).tolist(), *low, *(1.0 - each for each in high)}))


def test_a_tapered_lug_agrees_with_finite_elements():
    """At 50 places inside, at 200 on its edge and at all nodes of the hole. Measured: 9e-5, 2e-4 and 2e-5."""
    lug = tapered_lug()
    half = [graded(3, 0, 2), graded(2, 2, 2), graded(4, 4, 4)]
    cuts = [*half, graded(3, 4, 4), *([1.0 - each[::-1] for each in reversed(half)]), graded(8, 0, 0)]
    layers = np.array([0.0, 0.06, 0.15, 0.3, 0.5, 0.72, 0.88, 0.96, 0.99, 1.0])
    elements = SpectralPlate(lug.outline, cuts, layers, 7, "top", 0.3)
    hole = elements.z[:, 0]
    expected = elements.stresses(-hole.imag / math.pi * hole)
    away = np.abs(elements.z[..., None] - np.array([1.3 + 9j, -1.3 + 9j])).min(axis=2) > 0.3  # from singular corners
    inside, rim = np.add(np.argwhere(away[:, 1:-1]), (0, 1)), np.flatnonzero(away[:, -1])
    random = np.random.default_rng(1)
    places = np.concatenate([
        random.permutation(inside)[:50],
        [(place, elements.share.size - 1) for place in random.permutation(rim)[:200]],
        [(place, 0) for place in range(hole.size)],
    ])  # fmt: skip
    chosen = tuple(places.T)
    found = stress_at(plate_compliance(lug).compliance, elements.z[chosen] * (1.0 + 1e-12))
    assert len(places) > 600
    assert np.abs(found - expected[:, *chosen]).max() < 1e-3


def strain_energy_rate(lug, cuts, ray, tip, from_hole, pulled):
    """K_I^2 + K_II^2 of a crack along a ray to the share `tip`, from the strain energies of two lengths."""
    energies, part, degree = [], 0.01, 7
    for end in (tip * (1.0 - part), tip * (1.0 + part)):
        near = [end + side * 0.07 * 0.3**k for k in range(5) for side in (-1.0, 1.0)]
        others = [each for each in (0.06, *np.arange(0.15, 0.9, 0.1).tolist(), 0.93, 0.98) if abs(each - end) > 0.1]
        layers = np.array(sorted({0.0, 1.0, end, *near, *others}))
        node = degree * int(np.argmin(np.abs(layers - end)))
        opened = slice(0, node) if from_hole else slice(node + 1, None)
        elements = SpectralPlate(lug.outline, cuts, layers, degree, "top", 0.3, (degree * ray, opened))
        energies.append(elements.moved(pulled(elements.z[:, 0]))[1])
    way = abs(elements.z[degree * ray, -1]) - 1.0
    return abs(energies[1] - energies[0]) / (2.0 * part * tip * way)


@pytest.mark.parametrize("place", ["hole", "fillet"])
def test_cracks_of_a_tapered_lug_agree_with_finite_elements(place):
    """Under the tractions of a pin with friction. Measured: 3e-5 at the hole, 2e-4 at the fillet."""
    lug = tapered_lug()
    problem = Problem(
        MaterialPair(Material(210e9, 0.3), Material(70e9, 0.3), "stress"), 1.0, 1e-4, 0.3, pin_load="body",
        plate_body=plate_compliance(lug).compliance,
    )  # fmt: skip
    state = solve(problem, [{"P": 1e7}], nodes=201)[-1]

    def pulled(z):
        values = (
            np.interp(np.angle(z), state.theta, each, period=2.0 * math.pi) for each in (state.pressure, state.shear)
        )
        pressure, shear = values
        return (pressure - 1j * shear) * z

    half = [graded(3, 0, 2), graded(2, 2, 2), graded(4, 4, 4)]
    mirrored = [1.0 - each[::-1] for each in reversed(half)]
    if place == "hole":
        cuts = [graded(3, 4, 2), *half[1:], graded(3, 4, 4), *mirrored, graded(8, 0, 4)]
        rate = strain_energy_rate(lug, cuts, 0, 0.35, True, pulled)
        crack, length = Crack(math.radians(20.0)), 0.35 * (2.2 - 1.0)
    else:
        near = {0.5 + side * 0.25 * 0.3**k for k in range(5) for side in (-1.0, 1.0)}
        middle = np.array(sorted({0.0, 0.5, 1.0, *near}))
        cuts = [half[0], middle, half[2], graded(3, 4, 4), *mirrored, graded(8, 0, 0)]
        ray = half[0].size - 1 + int(np.argmin(np.abs(middle - 0.5)))
        rate = strain_energy_rate(lug, cuts, ray, 0.75, False, pulled)
        fillet = lug.outline[1]
        z = complex(fillet.at(np.array([0.5]))[0])
        angle = float(np.angle(-z / (z - fillet.circle[0])))  # towards the centre of the hole, from the normal
        crack, length = Crack(place=(z.real, z.imag), angle=angle), 0.25 * (abs(z) - 1.0)
    with pytest.warns(InputWarning, match="the crack turns away"):
        found = stress_intensity(state, crack, [length], straight=True)
    assert float(found.K_I[0, 0] ** 2 + found.K_II[0, 0] ** 2) == pytest.approx(rate, rel=2e-3)
