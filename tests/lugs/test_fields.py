"""Stress anywhere in a plate of any outline: closed forms of rings, another discretisation, equilibrium of sections."""

import json
import math
import threading
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np
import pytest

from fastpin import InputError, Points, solve
from fastpin.bodies import Compliance, Ring
from fastpin.lugs import fields
from fastpin.lugs.fields import lug_of, plate_field
from fastpin.lugs.outline import Hole, Lug, Part, PartLoad, rectangle
from fastpin.lugs.panels import Fineness
from fastpin.lugs.plates import plate_compliance
from fastpin.states.margins import part_of
from fastpin.states.yielding import place_words, von_mises_peak
from tests.support.lugs import disc, lug_with_neck, lug_with_nose, problem_with, rough_body, stress_at
from tests.support.tiers import some_survey


def stepped_lug():
    """Nose and sides at 2.2 R, fillets of 0.1 R to a step at y = 6 R, sides at 3 R, held at y = 10 R."""
    fillet = 2.3 + 5.9j + 0.1j * np.exp(0.25j * math.pi)
    right = [
        ("right", 2.2 + 5.9j, None),
        ("fillet", 2.3 + 6j, fillet),
        ("step", 3 + 6j, None),
        ("shank", 3 + 10j, None),
    ]
    left = [("shank", -3 + 6j, None), ("step", -2.3 + 6j, None), ("fillet", -2.2 + 5.9j, -np.conj(fillet))]
    parts, start = [], 2.2 + 0j
    for name, end, through in [
        *right,
        ("top", -3 + 10j, None),
        *left,
        ("left", -2.2 + 0j, None),
        ("nose", 2.2 + 0j, -2.2j),
    ]:
        parts.append(Part(name, complex(start), complex(end), None if through is None else complex(through)))
        start = end
    return Lug(0.3, "stress", 1.0, tuple(parts), {"top": "both"})


def rectangular_lug():
    return Lug(0.3, "stress", 1.0, rectangle((-2.5, 2.5), (-2.5, 6.0)), {"top": "both"})


def lug_with_bolt():
    """The lug with a nose, and a free hole at y = 4 R."""
    return lug_with_nose((Hole("bolt", 4j, 0.5),))


def strip(half_width, half_length):
    """A strip under syy = 1 at its upper end. Its lower end slides, and a bolt's hole far away holds it along x."""
    ends = rectangle((-half_width, half_width), (-half_length, half_length))
    bolt = Hole("bolt", -1j * (half_length - 2.0), 0.1)
    return Lug(
        0.3, "stress", 1.0, ends, {"bottom": "normal", "bolt": "x"}, (PartLoad("syy", ("top",), normal=1.0),), (bolt,)
    )


TABLE = {  # plate: place, component (0 to 2: sxx, syy, sxy), value. Two other discretisations agree to 2e-9.
    lug_with_nose: [
        (1.2, 0, 0.056795158), (1.2, 1, 0.383631804), (1.2, 2, 0.019360577), (2.1, 0, 0.002188644),
        (2.1, 1, 0.005400906), (2.1, 2, 0.003463525), (-1.6j, 0, 0.165189528), (-1.6j, 1, -0.123329400),
        (0.5 + 4j, 0, 0.004427502), (0.5 + 4j, 1, 0.218170805), (0.5 + 4j, 2, -0.004283039), (-1j, 0, -0.133707427),
        (1.0, 1, 0.631529819), (1j, 0, -0.456468592), (-2.2j, 0, 0.326184372), (2.2 + 1j, 1, 0.147560604),
        (2.2 + 5j, 1, 0.232199395), (2.2 + 9j, 1, 0.209992614),
    ],
    rectangular_lug: [
        (-1j, 0, -0.114429840), (1.0, 1, 0.478617546), (1j, 0, -0.378853267), (-2.5j, 0, 0.324066881),
        (2.4 - 2.5j, 0, -0.000915641), (2.5, 1, 0.011097193), (2.5 + 5.15j, 1, 0.194445297), (-2.4j, 0, 0.278424708),
        (-2.4j, 1, -0.002256117), (2.4 - 2.4j, 2, -0.000628133), (1 + 3j, 0, -0.011732579), (1 + 3j, 1, 0.197960230),
        (1 + 3j, 2, -0.000583109),
    ],
    stepped_lug: [
        (1.0, 1, 0.632129797), (2.2 + 2.95j, 1, 0.265288121), (3 + 8j, 1, 0.106621222), (2.1 + 5.5j, 0, 0.002139613),
        (2.1 + 5.5j, 1, 0.278942544), (2.1 + 5.5j, 2, 0.011432504), (2.15 + 6j, 0, 0.114625576),
        (2.15 + 6j, 1, 0.324614210), (2.15 + 6j, 2, 0.065003754),
    ],
    lug_with_bolt: [
        (1.0, 1, 0.616072553), (1j, 0, -0.410570840), (-2.2j, 0, 0.321546931), (0.6 + 4j, 0, 0.072596261),
        (0.6 + 4j, 1, 0.477977368), (0.6 + 4j, 2, -0.004062727), (1.5 + 4j, 0, 0.021023241), (1.5 + 4j, 1, 0.255627635),
        (1.5 + 4j, 2, -0.006500580),
    ],
}  # fmt: skip


@pytest.mark.gate
@pytest.mark.parametrize("make", some_survey(TABLE, lug_with_bolt, stepped_lug))
def test_stresses_under_a_pin_agree_with_other_discretisations(make):
    """Measured: 3e-8 at most."""
    body = plate_compliance(make()).compliance
    places, components, expected = zip(*TABLE[make], strict=True)
    found = stress_at(body, np.array(places))
    assert found[components, np.arange(len(places))] == pytest.approx(expected, abs=6e-8)


@pytest.mark.survey
def test_the_middle_of_a_fillet_and_its_largest_stress():
    body = plate_compliance(stepped_lug()).compliance
    angle = math.pi - np.r_[0.25 * math.pi, np.linspace(0.23, 0.24, 21) * math.pi / 2]
    found = stress_at(body, 2.3 + 5.9j + 0.1 * np.exp(1j * angle))
    hoop = found[0] + found[1]
    assert hoop[0] == pytest.approx(0.654164334, abs=1e-6)
    assert hoop[1:].max() == pytest.approx(0.795168453, abs=1e-6)


@pytest.mark.survey
def test_howland_s_strip():
    """The strip of half width 2 R: the hole's edge, the side and two points; measured 5e-7, from the strip's ends."""
    body = plate_compliance(strip(2.0, 12.0)).compliance
    places = np.array([1.0, 1j, 2.0, 1.5, 0.5 + 1.5j])
    found = stress_at(body, places, loads=(0.0, 1.0, 0.0), pulled=False)
    assert found[1, [0, 2]] == pytest.approx([4.347599102, 0.708735530], abs=2e-6)
    assert found[0, 1] == pytest.approx(-1.615075197, abs=2e-6)
    assert found[:, 3] == pytest.approx([0.253927789, 1.808912349, 0.0], abs=2e-6)
    assert found[:, 4] == pytest.approx([-0.193421697, 0.460266631, -0.299474373], abs=2e-6)
    x, weights = np.polynomial.legendre.leggauss(40)
    beside = stress_at(body, 1.5 + 0.5 * x, loads=(0.0, 1.0, 0.0), pulled=False)
    assert beside[1] @ weights == pytest.approx(4.0, abs=1e-7)  # twice half the width, half the sum of the weights


@pytest.mark.gate
@pytest.mark.parametrize("outer", [2.0, 1.5])
def test_a_ring_as_an_outline_has_the_stress_of_its_closed_form(outer):
    body = plate_compliance(Lug(0.3, "stress", 1.0, disc(outer), {"rim": "both"})).compliance
    state = solve(problem_with(Ring(outer)), [{"P": 1.0, "Q": 0.2}], nodes=101)[-1]
    other = replace(state, problem=problem_with(body))
    points = Points.at_radius(np.linspace(1.0, outer, 8)[:, None], np.linspace(-3.0, 3.0, 41))
    for component in ("radial", "hoop", "shear"):
        found, expected = (getattr(each.stress(points, straight=True), component) for each in (other, state))
        assert np.abs(found - expected).max() < 3e-8 * state.peak_pressure


@pytest.mark.gate
def test_the_stress_on_edges_is_its_limit_from_inside(monkeypatch):
    """Free edges have no traction but 3e-6, the error of the body's rough matrix."""
    body = rough_body(monkeypatch, lug_with_bolt(), 12)
    monkeypatch.setattr(fields, "FINENESS", Fineness(12, 8))
    state = solve(problem_with(body), [{"P": 1.0, "Q": 0.4}], nodes=41)[-1]
    inward = np.array([1j, -np.exp(-0.4j), -1.0, 1.0, 1.0, 1j, -1j])
    z = np.array([-2.2j, 2.2 * np.exp(-0.4j), 2.2 + 1j, -2.2 + 4.3j, 0.5 + 4j, 4.5j, 0.3 + 10j])
    there, inside = (state.stress(Points.at_xy(at.real, at.imag), straight=True) for at in (z, z + 1e-7 * inward))
    for component in ("sxx", "syy", "sxy"):
        assert getattr(there, component) == pytest.approx(getattr(inside, component), abs=5e-6)
    x = there.sxx * inward.real + there.sxy * inward.imag
    y = there.sxy * inward.real + there.syy * inward.imag
    assert np.abs(x[:-1] + 1j * y[:-1]).max() < 1e-5  # the last one is held
    assert abs(y[-1]) > 0.05


@pytest.mark.gate
def test_sections_through_a_lug_carry_the_load():
    body = plate_compliance(lug_with_nose()).compliance
    state = solve(problem_with(body), [{"P": 1.0, "Q": 0.3}], nodes=101)[-1]
    x, weights = np.polynomial.legendre.leggauss(60)
    for height in (3.0, 5.0, 8.0):
        found = state.stress(Points.at_xy(2.2 * x, np.full(60, height)), straight=True)
        assert 2.2 * weights @ found.syy == pytest.approx(1.0, abs=1e-8)
        assert 2.2 * weights @ found.sxy == pytest.approx(-0.3, abs=1e-8)
        moment = 2.2 * weights @ (2.2 * x * found.syy - height * found.sxy)
        assert moment == pytest.approx(-state.resultants["M"], abs=1e-7)


def test_points_outside_of_the_plate_have_no_stress(monkeypatch):
    body = rough_body(monkeypatch, lug_with_bolt())
    inside = np.array([1.5, 2.2, -2.2j, 2.2 * np.exp(-0.3j), 0.5 + 4j, -2.2 + 9j, 2.2 + 10j])
    outside = np.array([2.21, -2.21j, 0.49 + 4j, 2.3 + 5j, 10.01j, -1.6 - 1.6j, 30.0])
    assert body.contains(inside).all()
    assert not body.contains(outside).any()
    state = solve(problem_with(body), [{"P": 1.0}], nodes=41)[-1]
    with pytest.raises(InputError, match=r"points: must lie in the plate, and x = 0\.3 R, y = 4\.1 R does not"):
        state.stress(Points.at_xy(0.3, 4.1))


def test_a_file_holds_the_outline(monkeypatch):
    lug = lug_with_bolt()
    assert Lug.from_document(json.loads(json.dumps(lug.document())), lug.nu, lug.plane, lug.hole_radius) == lug
    body = rough_body(monkeypatch, lug)
    again = Compliance.from_document(json.loads(body.to_text()))
    assert (again, again.outline, lug_of(again)) == (body, body.outline, lug)
    assert body != replace(body, outline="")


@pytest.mark.parametrize(
    "change", [{"parts": 3}, {"parts": []}, {"start": "x"}, {"holes": [{}]}, {"loads": [{"name": "P"}]}]
)
def test_a_wrong_outline_is_refused(change):
    lug = lug_with_nose()
    with pytest.raises(InputError):
        Lug.from_document(lug.document() | change, lug.nu, lug.plane, lug.hole_radius)


def test_the_outline_of_another_plate_is_refused(monkeypatch):
    body = rough_body(monkeypatch, lug_with_nose())
    other = replace(body, outline=json.dumps(rectangular_lug().document()))
    with pytest.raises(InputError, match="lug: is not the plate of the matrix: make the file again with fastpin compl"):
        plate_field(other)
    with pytest.raises(InputError, match="outline: must be a JSON text"):
        replace(body, outline="[1")


@pytest.mark.gate
def test_largest_stresses_are_looked_for_on_all_edges(monkeypatch):
    """The largest stress is on a narrow neck. Its sharp corners and its held end are named, and left out."""
    body = rough_body(monkeypatch, lug_with_neck())
    state = solve(problem_with(body), [{"P": 1.0}], nodes=41)[-1]
    peak = von_mises_peak(state, "plate")
    assert state.stress(Points.at_xy(0.3, 6.0)).von_mises == pytest.approx(1.0 / 0.6, rel=0.01)
    assert peak.value == pytest.approx(1.0 / 0.6, rel=0.02)
    assert place_words(state.problem, peak).startswith('on the edge "neck", at x = ')
    assert abs((1.0 + peak.depth) * math.cos(peak.angle)) == pytest.approx(0.3)
    assert part_of(state.problem, "plate") == (
        "apart from 0.25 R about sharp corners and ends of supports: "
        "[0.3 R, 3 R], [0.3 R, 9 R], [-0.3 R, 9 R], [-0.3 R, 3 R]"
    )


def test_threads_wait_for_one_computation():
    """A second thread waits for the same result, not for another one. The oldest result is forgotten."""
    entered, done, calls = threading.Event(), threading.Event(), []

    @fields.once(2)
    def square(number):
        calls.append(number)
        if number == 3:
            entered.set()
            assert done.wait(10.0)
        return [number * number]

    with ThreadPoolExecutor(2) as pool:
        first = pool.submit(square, 3)
        assert entered.wait(10.0)
        second = pool.submit(square, 3)
        assert square(4) == [16]
        assert not second.done()
        done.set()
        assert first.result() is second.result()
    assert (calls, first.result()) == ([3, 4], [9])
    assert (square(5), square(6), square(3)) == ([25], [36], [9])
    assert calls == [3, 4, 5, 6, 3]
