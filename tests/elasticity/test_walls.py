"""Stresses in hollow pins, rings, bushes and plates with a reaction, and on the edge of a compliance.

Sizes of stresses are about 1 to 5. Tolerances are measured.
"""

from dataclasses import replace

import numpy as np
import pytest

from fastpin import Material, MaterialPair, Problem
from fastpin.bodies import Bushing, Plate, Ring, Tube, harmonics
from fastpin.bodies.ring import HalfCosine
from fastpin.elasticity.stress import disk_stress, hole_stress, pin_stress, plate_stress, traction_harmonics
from fastpin.elasticity.terms import body_terms
from fastpin.elasticity.tractions import Tractions
from fastpin.model.loads import SXX, SXY, SYY
from tests.support.checks.body_cases import ring_compliance

UNLIKE = MaterialPair(Material(2.1, 0.3), Material(0.7, 0.2), "stress")
BRONZE = Material(1.5, 0.34)
REMOTE, NO_LOAD = np.array([0.3, -0.2, 0.1, 0.0]), np.zeros(4)
AROUND = 2.0 * np.pi * np.arange(997) / 997
TUBES = [Tube(bore, load) for bore in (0.5, 0.9) for load in ("uniform", "normal", "shear", "held", "body")]
RINGS = [Ring(outer, load) for outer in (1.3, 2.0) for load in ("held", "uniform", "normal", "shear", "half", "body")]
FAR = Plate(reaction=(0.5, 3.0))
BUSHES = [
    Bushing(BRONZE, 1.25, inside=Plate()),
    Bushing(BRONZE, 1.25, interference=0.05, inside=FAR),
    Bushing(BRONZE, 1.1, interference=0.05, inside=Ring(2.2, "half")),
    Bushing(BRONZE, 1.25, inside=Ring(2.0, "held")),
]


def name(body):
    return repr(body).replace("Material(E=1.5, nu=0.34)", "bronze")


def case(body=None, pair=UNLIKE):
    given = {} if body is None else {"pin_body" if isinstance(body, Tube) else "plate_body": body}
    return Problem.from_load_parameter(pair, 0.05, 0.55, **given)


def some_tractions(seed=4):
    rng = np.random.default_rng(seed)
    nodes = np.sort(rng.uniform(-3.0, -0.3, 40))
    values = np.column_stack([nodes, rng.uniform(0.2, 1.0, 40), rng.uniform(-0.5, 0.6, 40)])
    values[[0, -1], 1:] = 0.0
    return Tractions((values,))


SOME = some_tractions()
_BUMP = 0.01 * np.arange(301)
BUMP = Tractions(
    (np.column_stack([_BUMP - 2.9, np.sin(np.pi * _BUMP / 3.0) ** 4, 0.3 * np.sin(np.pi * _BUMP / 1.5) ** 3]),)
)
"""Smooth tractions, whose harmonics need few angles."""


def uniform(pressure, shear=0.0):
    theta = 2.0 * np.pi * np.arange(101) / 100
    return Tractions((np.column_stack([theta, pressure + 0.0 * theta, shear + 0.0 * theta]),))


def stresses(body, theta, radius, tractions=SOME, remote=REMOTE):
    """Stresses (srr, stt, srt) of the pin or the plate with this body, at points."""
    theta, radius = (array.ravel() for array in np.broadcast_arrays(np.asarray(theta, float), radius))
    if isinstance(body, Tube):
        return pin_stress(case(body), tractions, theta, 1.0 - radius)
    return plate_stress(case(body), tractions, remote, theta, radius - 1.0)


def resultants(tractions=SOME):
    """Force Q - iP on the plate over R, and the coefficient of uniform shear."""
    pressure, shear = tractions.low_coefficients
    return 2.0 * np.pi * np.conj(pressure[1] + 1j * shear[1]), shear[0].real


def rim_of(body):
    return body.bore_radius if isinstance(body, Tube) else body.outer_radius


def complex_traction(found):
    return found[0] + 1j * found[2]


# --- the contact rim and the other rim -------------------------------------------------------------------------


@pytest.mark.parametrize("body", [*TUBES, *RINGS, *BUSHES, FAR], ids=name)
def test_tractions_on_the_contact_rim_stay(body):
    found, problem, none = stresses(body, AROUND, 1.0), case(body), 0.0 * AROUND
    if isinstance(body, Tube):
        known = disk_stress(problem.pair.pin_kolosov, "centre", SOME, AROUND, none)
    else:
        known = hole_stress(problem.surfaces.plate_kolosov, SOME, NO_LOAD[:3], AROUND, none)
    assert (found - known)[[0, 2]] == pytest.approx(0.0, abs=2e-13)
    assert np.abs(found - known)[1].max() > 0.1


def prescribed(load, force, moment, rim):
    """Traction srr + i srt on the other rim under the force Q - iP and uniform shear, both over R."""
    mean = -force / (2.0 * np.pi * rim) * np.exp(-1j * AROUND)
    half = (
        2.0
        / (np.pi * rim)
        * (-force.imag * np.maximum(0.0, -np.sin(AROUND)) + force.real * np.maximum(0.0, np.cos(AROUND)))
    )
    found = {"uniform": mean, "normal": 2.0 * mean.real, "shear": 2j * mean.imag, "body": 0.0, "half": -half}[load]
    return found + 1j * moment / rim**2


@pytest.mark.parametrize("body", [body for body in (*TUBES, *RINGS) if not body.held], ids=name)
def test_the_other_rim_carries_its_load(body):
    rim, found = rim_of(body), stresses(body, AROUND, rim_of(body))
    expected = prescribed(body.load if isinstance(body, Tube) else body.support, *resultants(), rim)
    if isinstance(body, Ring):
        expected = expected + 0.5 * (0.3 - 0.2) + 0.5 * complex(0.3 + 0.2, 0.2) * np.exp(-2j * AROUND)
    assert complex_traction(found) == pytest.approx(expected, abs=3e-13)


def test_the_rim_of_a_ring_round_a_bush_carries_its_load():
    found = stresses(BUSHES[2], AROUND, 2.2)
    expected = prescribed("half", *resultants(), 2.2)
    expected = expected + 0.5 * (0.3 - 0.2) + 0.5 * complex(0.3 + 0.2, 0.2) * np.exp(-2j * AROUND)
    assert complex_traction(found) == pytest.approx(expected, abs=3e-13)


@pytest.mark.parametrize("body", [body for body in (*TUBES, *RINGS) if body.held], ids=name)
def test_a_held_rim_does_not_move(body):
    """The hoop strain is zero there. The radial displacement is a translation.

    It is the displacement of the contact rim by (T38) plus the radial strains along the radius.
    """
    problem, rim = case(body), rim_of(body)
    pair = problem.pair
    kolosov = pair.pin_kolosov if isinstance(body, Tube) else pair.plate_kolosov
    radial, hoop, _ = stresses(body, AROUND, rim, BUMP)
    assert hoop - 0.25 * (3.0 - kolosov) * (radial + hoop) == pytest.approx(0.0, abs=3e-13)
    t, n = traction_harmonics(BUMP, 10)[2:], np.arange(2.0, 11.0)
    if isinstance(body, Tube):
        whole = harmonics.as_matrices(harmonics.tube(n, rim, kolosov, "held"))
        whole[:, 0, 0] += kolosov / (n + 1.0)
        whole[:, 1, 1] += 1.0 / (n - 1.0)
    else:
        whole = harmonics.as_matrices(harmonics.ring(n, rim, kolosov, "held")) + 2.0 * harmonics.hole(n, kolosov, 1.0)
    moved = (whole @ t[:, :, None])[..., 0]
    x, weights = np.polynomial.legendre.leggauss(40)
    orders, carried = np.array([2, 3, 5]), np.zeros(3, dtype=complex)
    for part, weight in zip(0.5 * (x + 1.0), 0.5 * weights, strict=True):
        radial, hoop, _ = stresses(body, AROUND, 1.0 + (rim - 1.0) * part, BUMP)
        strain = radial - 0.25 * (3.0 - kolosov) * (radial + hoop)
        carried += weight * (rim - 1.0) * (np.exp(-1j * np.outer(orders, AROUND)) @ strain) / AROUND.size
    at_contact = 0.5 * moved[orders - 2].sum(axis=1)  # u_r = Re u
    assert np.abs(at_contact).min() > 5e-4
    assert at_contact + carried == pytest.approx(0.0, abs=1e-10)


# --- equilibrium and compatibility ----------------------------------------------------------------------------

_STEP = 2e-3
_SHIFTS, _WEIGHTS = np.array([-2.0, -1.0, 1.0, 2.0]) * _STEP, np.array([1.0, -8.0, 8.0, -1.0]) / 12.0 / _STEP
_WEIGHTS_2 = np.array([-1.0, 16.0, 16.0, -1.0]) / 12.0 / _STEP**2


@pytest.mark.parametrize("body", [*TUBES[:5], *RINGS[6:], *BUSHES, FAR], ids=name)
def test_field_equations(body):
    """div sigma = -F and Laplace's equation of the sum of the normal stresses, by differences of fourth order."""
    rng, rim = np.random.default_rng(8), 2.0
    if isinstance(body, Tube):
        radius = rng.uniform(0.6, 0.85, 60)
    else:
        radius = np.r_[rng.uniform(1.05, 1.08, 30), rng.uniform(1.35, 1.9, 30)]
    theta = rng.uniform(0.3, 2.5, 60)  # the tractions have kinks, on the other side
    here = stresses(body, theta, radius)
    outwards = np.array([stresses(body, theta, radius + shift) for shift in _SHIFTS])
    around = np.array([stresses(body, theta + shift, radius) for shift in _SHIFTS])
    along, turned = (np.tensordot(_WEIGHTS, values, axes=1) for values in (outwards, around))
    force, _ = resultants()
    density = 0.0
    if isinstance(body, (Tube, Ring)) and "body" in name(body):
        density = force / (np.pi * (1.0 - 0.25)) if isinstance(body, Tube) else -force / (np.pi * (rim**2 - 1.0))
    pull = density * np.exp(-1j * theta)
    first = along[0] + turned[2] / radius + (here[0] - here[1]) / radius
    second = along[2] + turned[1] / radius + 2.0 * here[2] / radius
    assert first + 1j * second == pytest.approx(-pull, abs=2e-7)
    mean, means = here[0] + here[1], (outwards + 0.0)[:, 0] + outwards[:, 1]
    turns = around[:, 0] + around[:, 1]
    curved = np.tensordot(_WEIGHTS_2, means, axes=1) - 2.5 * mean / _STEP**2
    bent = np.tensordot(_WEIGHTS_2, turns, axes=1) - 2.5 * mean / _STEP**2
    laplace = curved + (along[0] + along[1]) / radius + bent / radius**2
    assert laplace == pytest.approx(0.0, abs=3e-6)


# --- closed forms ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("inside", [Plate(), Ring(2.0, "uniform"), Ring(2.0, "held")])
def test_press_fit(inside):
    body = Bushing(BRONZE, 1.25, interference=0.05, inside=inside)
    problem, nothing = case(body), Tractions(())
    p, q, radius = problem.press_fit_pressure, 1.25**-2.0, np.linspace(1.0, 1.25, 7)
    assert p > 1e-3
    found = stresses(body, 0.3, radius, nothing, NO_LOAD)
    expected = -p / (1.0 - q) * np.array([1.0 - radius**-2.0, 1.0 + radius**-2.0, 0.0 * radius])
    assert found == pytest.approx(expected, abs=1e-15)
    radius = np.linspace(1.2501, 2.0, 7)
    part = (1.25 / radius) ** 2
    if inside == Plate():
        expected = p * np.array([-part, part, 0.0 * part])
    elif not inside.held:
        least = (1.25 / 2.0) ** 2
        expected = p / (1.0 - least) * np.array([least - part, least + part, 0.0 * part])
    else:
        k, least = problem.pair.plate_kolosov, (1.25 / 2.0) ** 2
        growing = -p * least / (k - 1.0 + 2.0 * least)
        expected = np.array(
            [2.0 * growing - (p + 2.0 * growing) * part, 2.0 * growing + (p + 2.0 * growing) * part, 0 * part]
        )
    assert stresses(body, 0.3, radius, nothing, NO_LOAD) == pytest.approx(expected, abs=1e-15)


def test_a_ring_under_remote_stress_has_the_tension_of_its_rim():
    """Lame's solution for a ring under equal tension outside, and Kirsch's limit of a wide ring."""
    radius, nothing = np.linspace(1.0, 2.0, 9), Tractions(())
    found = stresses(Ring(2.0, "uniform"), 0.3, radius, nothing, np.array([1.5, 1.5, 0.0]))
    expected = 2.0 * np.array([1.0 - radius**-2.0, 1.0 + radius**-2.0, 0.0 * radius])
    assert found == pytest.approx(expected, abs=1e-14)
    assert np.array_equal(stresses(Ring(2.0), 0.3, radius, nothing), np.zeros((3, 9)))
    wide = stresses(Ring(1e4, "uniform"), AROUND, 1.5, nothing)
    assert wide == pytest.approx(stresses(Plate(), AROUND, 1.5, nothing), abs=2e-8)


# --- interface of a bush ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("body", BUSHES, ids=name)
def test_tractions_and_hoop_strain_at_the_interface(body):
    """The interference is a jump of the hoop strain by itself over the radius."""
    problem, outer = case(body), body.outer_radius
    inner, outside = (stresses(body, AROUND, outer * (1.0 + side)) for side in (0.0, 1e-12))
    assert complex_traction(outside) == pytest.approx(complex_traction(inner), abs=2e-11)
    strains = []
    for found, pair in ((inner, problem.surfaces), (outside, problem.pair)):
        strain = found[1] - 0.25 * (3.0 - pair.plate_kolosov) * (found[0] + found[1])
        strains.append(0.5 * pair.plate_compliance * strain)
    jump = strains[1] - strains[0]
    assert np.abs(inner[1] - outside[1]).max() > 0.1
    assert jump == pytest.approx(body.interference / outer, abs=2e-11)


@pytest.mark.parametrize("inside", [Plate(), FAR, Ring(2.0, "half"), Ring(2.0, "held")], ids=name)
def test_a_bush_of_the_plates_material_is_the_plate(inside):
    material = case().pair.plate
    problem = Problem.from_load_parameter(UNLIKE, 0.05, 0.55, plate_body=Bushing(UNLIKE.plate, 1.2, inside=inside))
    alone = case(inside)
    assert problem.surfaces.plate.nu == material.nu
    for radius in (1.0, 1.1, 1.2, 1.5, 2.0):
        depth = 0.0 * AROUND + radius - 1.0
        found = plate_stress(problem, SOME, REMOTE, AROUND, depth)
        assert found == pytest.approx(plate_stress(alone, SOME, REMOTE, AROUND, depth), abs=3e-13)


# --- limits ----------------------------------------------------------------------------------------------------


def test_a_tiny_bore_leaves_the_solid_pin():
    depth = 0.0 * AROUND + (1.0 - 0.8)
    solid = pin_stress(case(), SOME, AROUND, depth)
    for bore in (1e-3, 1e-6, 1e-60):
        for load in ("uniform", "held"):
            found = stresses(Tube(bore, load), AROUND, 0.8)
            assert found == pytest.approx(solid, abs=5.0 * bore**2 + 1e-14)
    loaded = replace(case(), pin_load="body")
    found, solid = stresses(Tube(1e-4, "body"), AROUND, 0.8), pin_stress(loaded, SOME, AROUND, depth)
    assert found == pytest.approx(solid, abs=1e-7)


def test_stress_at_a_tiny_bore_is_that_of_a_small_hole():
    """The hoop stress round a free bore is Kirsch's for the stress at the centre of the solid pin."""
    loaded = replace(case(), pin_load="body")
    symmetric = np.column_stack([AROUND[:100] * 0.03 - 1.0, np.hanning(100), np.zeros(100)])
    tractions = Tractions((symmetric, symmetric + np.array([np.pi, 0.0, 0.0])))  # no force
    radial, hoop, shear = pin_stress(loaded, tractions, np.zeros(1), np.array([1.0 - 1e-9]))[:, 0]
    for bore in (0.01, 1e-5):
        found = stresses(Tube(bore, "body"), AROUND, bore, tractions)
        along = (radial - hoop) * np.cos(2.0 * AROUND) + 2.0 * shear * np.sin(2.0 * AROUND)
        assert found[1] == pytest.approx(radial + hoop - 2.0 * along, abs=20.0 * bore**2 + 1e-9)


@pytest.mark.parametrize("load", ["uniform", "held", "half"])
def test_a_wide_ring_is_the_plate(load):
    plate = stresses(Plate(), AROUND, 1.4, remote=NO_LOAD)
    differences = [
        np.abs(stresses(Ring(outer, load), AROUND, 1.4, remote=NO_LOAD) - plate).max() for outer in (1e2, 1e3)
    ]
    assert differences[0] < 3e-2
    assert differences[1] < 0.12 * differences[0]


def test_a_reaction_far_away_leaves_the_plate():
    plate = stresses(Plate(), AROUND, 1.4)
    differences = [np.abs(stresses(Plate((0.0, away)), AROUND, 1.4) - plate).max() for away in (1e2, 1e3, 1e6)]
    assert differences[0] < 2e-2
    assert differences[1] == pytest.approx(0.1 * differences[0], rel=0.02)
    assert differences[2] < 2e-6


def test_the_reaction_is_a_force_at_its_point():
    """Through a small circle about the point goes the force; far away nothing is left but a moment."""
    force, _ = resultants()
    middle = complex(*FAR.reaction)
    z = middle + 1e-3 * np.exp(1j * AROUND)
    radial, hoop, shear = stresses(FAR, np.angle(z), np.abs(z), remote=NO_LOAD)
    turn = np.exp(1j * (AROUND - np.angle(z)))  # the normal in the axes r and theta
    pull = radial * turn.real + shear * turn.imag + 1j * (shear * turn.real + hoop * turn.imag)
    found = 2.0 * np.pi * 1e-3 * np.mean(pull * np.exp(1j * np.angle(z)))
    assert found == pytest.approx(force, abs=1e-11)  # a pull outwards balances the reaction -force
    far = [np.abs(stresses(FAR, AROUND, away, remote=NO_LOAD)).max() * away**2 for away in (1e3, 1e4)]
    assert far[1] == pytest.approx(far[0], rel=1e-2)


def test_half_cosine_is_the_sum_of_its_harmonics():
    half, m = HalfCosine(1.3, 0.4, 2.0), np.arange(1, 200)
    n, t = 2 * m, half.harmonics(m)
    for size in (1e-6, 0.03, 0.199, 0.201, 0.9):
        x = size * np.exp(1j * AROUND[:, None])
        value, slope = (t * x**n).sum(axis=1), (n * t * x**n).sum(axis=1)
        mean, first = half.polar(2.0 * x[:, 0])
        assert mean == pytest.approx(4.0 * value.real, abs=1e-14)
        assert first == pytest.approx(2.0 * value.real + (size**-2.0 - 1.0) * slope, abs=1e-14)


def test_half_cosine_at_its_ends():
    """Its pressure is zero there: the harmonics from 2 on leave the mean with the other sign."""
    half = HalfCosine(1.3, 0.0, 2.0)
    mean, first = half.polar(np.array([2j, -2j]))
    assert first == pytest.approx(-half.mean, rel=1e-15)
    assert mean == pytest.approx(-2.0 * half.mean, rel=1e-15)


# --- the edge --------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("body", [*RINGS, *BUSHES, FAR], ids=name)
def test_hoop_stress_of_loads_is_the_strain_of_their_columns(body):
    """8 G eps/(kappa + 1) with the strain eps of the contact rim under the remote stress, (T48)."""
    problem, unit = case(body), {SXX: REMOTE[0], SYY: REMOTE[1], SXY: REMOTE[2]}
    terms, nothing = body_terms(problem), Tractions(())
    strain = 0.0 * AROUND
    for place, value in unit.items():
        column = terms.columns.get(place, np.zeros(1))
        order = np.arange(column.size) - column.size // 2
        strain = strain + value * np.real(np.exp(1j * np.multiply.outer(AROUND, order)) @ ((1.0 + order) * column))
    pair = problem.surfaces
    expected = 8.0 * pair.beta_star / (pair.plate_compliance * (pair.plate_kolosov + 1.0)) * strain
    found = plate_stress(problem, nothing, REMOTE, AROUND, 0.0 * AROUND)[1]
    found = found - plate_stress(problem, nothing, NO_LOAD, AROUND, 0.0 * AROUND)[1]
    assert found == pytest.approx(expected, abs=2e-13)


@pytest.mark.parametrize("body", [TUBES[0], TUBES[5], RINGS[0], RINGS[7]], ids=name)
def test_hoop_stress_on_the_edge_follows_from_the_compliances(body):
    """The sum of section 3 of the theory of bodies, with the harmonics from 2 on."""
    problem, is_pin = case(body), isinstance(body, Tube)
    kolosov = problem.pair.pin_kolosov if is_pin else problem.pair.plate_kolosov
    t = traction_harmonics(SOME, 500)
    n = np.arange(2.0, 501.0)
    kind = "held" if body.held else "free"
    a, b, d = (harmonics.tube if is_pin else harmonics.ring)(n, rim_of(body), kolosov, kind)
    one, other = a * t[2:, 0] + b * t[2:, 1], b * t[2:, 0] + d * t[2:, 1]
    waves = np.exp(1j * np.multiply.outer(AROUND, n))
    expected = (
        4.0 / (kolosov + 1.0) * np.real(waves @ ((1.0 + n) * one) + np.conj(waves) @ ((1.0 - n) * np.conj(other)))
    )
    none = 0.0 * AROUND
    if is_pin:
        found = pin_stress(problem, SOME, AROUND, none) - disk_stress(kolosov, "centre", SOME, AROUND, none)
    else:
        found = plate_stress(problem, SOME, NO_LOAD, AROUND, none) - hole_stress(
            kolosov, SOME, NO_LOAD[:3], AROUND, none
        )
    spectrum = np.fft.fft(found[1] - expected) / AROUND.size
    assert spectrum[2:-1] == pytest.approx(0.0, abs=2e-13)  # beside the harmonics 0 and 1


def test_a_compliance_of_a_ring_has_the_hoop_stress_of_the_ring():
    ring = Ring(2.0, "uniform")
    found = stresses(ring_compliance(case(ring), 40), AROUND, 1.0)
    assert found == pytest.approx(stresses(ring, AROUND, 1.0), abs=1e-12)


def test_disk_and_plate_have_no_wall():
    depth = 0.0 * AROUND + 0.25
    known = hole_stress(case().pair.plate_kolosov, SOME, REMOTE[:3], AROUND, depth)
    assert np.array_equal(plate_stress(case(), SOME, REMOTE, AROUND, depth), known)
    known = disk_stress(case().pair.pin_kolosov, "centre", SOME, AROUND, depth)
    assert np.array_equal(pin_stress(case(), SOME, AROUND, depth), known)
