"""Loads and fields that a problem with other bodies allows, and the sentences for the others."""

import copy
import math
import pickle
from typing import Any

import numpy as np
import pytest

from fastpin import MATERIALS, InputError, LoadHistory, Material, MaterialPair, Problem, SolveOptions
from fastpin.bodies import Bushing, Compliance, Plate, Ring, Tube
from fastpin.bodies.kinds import PLATES
from fastpin.model.acting import check_arc, check_loads
from tests.support.bodies import soft_plate
from tests.support.refusals import refused

PAIR = MaterialPair(MATERIALS["steel"], MATERIALS["aluminium"])
BRONZE = Material(110e9, 0.34, "bronze")
PLATE_NAMES = [f"a {made.__name__}" for made in PLATES.values()]
SOFT = Material(1e-20, 0.3)  # softer than steel by more than any two moduli may differ
HELD, FREE = Ring(0.02), Ring(0.02, "uniform")


def problem(**given: Any) -> Problem:
    return Problem(PAIR, 0.01, 2e-5, 0.3, **given)


@pytest.mark.parametrize("body", [Plate(), FREE, Bushing(BRONZE, 0.0125), Bushing(BRONZE, 0.0125, inside=FREE)])
@pytest.mark.parametrize("name", ["sxx", "syy", "sxy"])
def test_remote_stress_acts_on_plates_and_rings_that_are_not_held(body, name):
    check_loads(problem(plate_body=body), LoadHistory([{name: 1e6}]))


@pytest.mark.parametrize("body", [HELD, Bushing(BRONZE, 0.0125, inside=HELD)])
@pytest.mark.parametrize("name", ["sxx", "syy", "sxy"])
def test_a_held_rim_takes_no_remote_stress(body, name):
    check_loads(problem(plate_body=body), LoadHistory([{"P": 1e6, name: 0.0}]))
    with pytest.raises(InputError, match="a held rim leaves no remote stress") as raised:
        check_loads(problem(plate_body=body), LoadHistory([{"P": 1e6}, {name: 1e6}]))
    assert raised.value.field == name


def test_a_compliance_takes_the_loads_of_its_columns():
    check_loads(
        problem(plate_body=soft_plate(columns={"sxx": np.ones(18)})), LoadHistory([{"sxx": 1e6, "syy": 0.0, "M": 10.0}])
    )
    with pytest.raises(InputError, match="no column of this load; its columns are: sxx") as raised:
        check_loads(problem(plate_body=soft_plate(columns={"sxx": np.ones(18)})), LoadHistory([{"syy": 1e6}]))
    assert raised.value.field == "syy"
    with pytest.raises(InputError, match="its columns are: none"):
        check_loads(problem(plate_body=soft_plate()), LoadHistory([{"sxy": 1e6}]))


@pytest.mark.parametrize("load", ["uniform", "body", "held"])
@pytest.mark.parametrize("rotation", ["free", "fixed", "spring"])
def test_a_hollow_pin_carries_a_moment_and_may_be_held(load, rotation):
    spring = {"hub_stiffness": 1e6} if rotation == "spring" else {}
    hollow = problem(pin_body=Tube(0.005, load), rotation=rotation, **spring)
    check_loads(hollow, LoadHistory([{"M": 10.0} if rotation == "free" else {"rotation": 1e-4}]))


@pytest.mark.parametrize(
    ("make", "field", "words"),
    [
        (lambda: problem(pin_body=Ring(0.02)), "pin_body", "must be a Disk or a Tube"),
        (
            lambda: problem(plate_body=Tube(0.005)),
            "plate_body",
            f"must be {', '.join(PLATE_NAMES[:-1])} or {PLATE_NAMES[-1]}",
        ),
        (lambda: problem(plate_body=Bushing(SOFT, 0.0125)), "material", "the moduli of pin and bush must not differ"),
        (lambda: Bushing(BRONZE, math.nan), "outer_radius", "must be a finite number"),
        (lambda: Plate((1.0,)), "reaction", "must be a point"),
        (lambda: Plate((1.0, math.nan)), "reaction", "must be a finite number"),
    ],
)
def test_bodies_that_only_python_can_have_are_refused_in_one_sentence(make, field, words):
    """tests/whole/test_bad_parts.py has the others."""
    error = refused(make)
    assert error.field == field
    assert words in error.reason


def test_the_pin_radius_does_not_change_with_the_press_fit():
    pair = MaterialPair(Material(210e9, 0.3), Material(71e9, 0.33))
    bush = Bushing(Material(103e9, 0.34), 12.5e-3, 30e-6)
    for body in (Plate(), bush):
        for clearance in (15e-6, 0.0, -20e-6):
            assert Problem(pair, 10e-3, clearance, 0.2, plate_body=body).pin_radius == 10e-3 - clearance
    assert math.isnan(Problem.from_load_parameter(pair, 0.1, 0.2).pin_radius)


def test_the_interference_of_a_dimensionless_bush_may_be_larger_than_its_radius():
    bush = Bushing(BRONZE, 1.25, interference=3.0)
    found = Problem.from_load_parameter(PAIR, 5.0, 0.3, plate_body=bush)
    assert found.plate_body.interference == 3.0
    assert found.assembled_clearance < found.clearance
    with pytest.raises(InputError, match="the moduli of pin and bush"):
        Problem.from_load_parameter(PAIR, 5.0, 0.3, plate_body=Bushing(SOFT, 1.25))


def test_a_press_fit_that_closes_the_gap_needs_the_whole_circle():
    pressed = problem(plate_body=Bushing(BRONZE, 0.0125, 5e-5))
    assert pressed.clearance > 0.0 > pressed.assembled_clearance
    with pytest.raises(InputError, match="an interference fit is in contact all round") as raised:
        check_arc(pressed, SolveOptions(arc=(-3.0, 0.0)))
    assert raised.value.field == "arc"


def test_a_problem_says_its_bodies():
    bodies = problem(pin_body=Tube(0.005), plate_body=Bushing(BRONZE, 0.0125, inside=FREE))
    assert "Tube(bore_radius=0.005, load='uniform')" in repr(bodies)
    assert "Bushing(" in repr(bodies)
    assert "Ring(outer_radius=0.02, support='uniform')" in repr(bodies)
    assert "Tube" not in repr(problem())


@pytest.mark.parametrize("made", [copy.deepcopy, copy.copy, lambda body: pickle.loads(pickle.dumps(body))])
def test_copies_of_a_compliance_are_equal_and_cannot_be_changed(made):
    matrix = np.diag(np.r_[np.ones(6), np.full(4, 0.1), np.full(4, 1e-3)])
    body = made(Compliance(0.3, "strain", 1.0, matrix, {"sxx": np.arange(14.0)}, "a test"))
    assert (body, body.made_by) == (Compliance(0.3, "strain", 1.0, matrix, {"sxx": np.arange(14.0)}), "a test")
    with pytest.raises(TypeError):
        body.columns["syy"] = np.zeros(14)
    for array in (body.matrix, body.columns["sxx"]):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 1.0


def test_bodies_that_keep_their_areas_fit_into_no_smaller_hole():
    soft = Material(1.0, 0.5)
    with pytest.raises(InputError, match=r"clearance: a pin with nu = 0\.5 in a body that can't widen keeps its area"):
        Problem.from_load_parameter(MaterialPair(soft, soft), -0.1, 0.3, plate_body=Ring(2.0, "held"))
    Problem.from_load_parameter(MaterialPair(soft, soft), -0.1, 0.3, plate_body=Ring(2.0, "uniform"))
