"""The words on axes and in captions."""

import numpy as np
import pytest

from fastpin import MATERIALS, LoadHistory, Material, MaterialPair, Problem, figures
from fastpin.bodies import Bushing, Plate, Ring, Tube
from fastpin.figures.style import (
    caption,
    load_text,
    loads_by_change,
    loads_text,
    quantity,
    short,
    without_rounding,
    wrapped,
    wrapped_parts,
)
from fastpin.model.units import Unit
from tests.support.drawing import plain
from tests.support.samples import sample_result

PAIR = MaterialPair(MATERIALS["steel"], MATERIALS["aluminium"], "stress")


@pytest.mark.parametrize(
    ("words", "unit", "expected"),
    [
        ("pressure N", "MPa", "pressure N (MPa)"),
        ("slip", "um", "slip (µm)"),
        ("rotation", "F beta*/R", "rotation (F β*/R)"),
        ("energy", "J/m^2", "energy (J/m²)"),
        ("friction coefficient", "", "friction coefficient"),
    ],
)
def test_axes_have_a_unit_in_parentheses(words, unit, expected):
    assert quantity(words, unit) == expected


METRE = Unit(1.0, "m")


def test_numbers_are_rounded_and_keep_their_units_on_the_line():
    assert plain(short(0.0123456, METRE)) == "12.3 mm"
    assert plain(short(-2e-6, METRE)) == "−2 µm"
    assert " " not in short(0.0123456, METRE)
    rows = wrapped(" ".join([short(0.0123456, METRE)] * 9), 1.2)
    assert len(rows) > 2
    assert {word for row in rows for word in row.split(" ")} == {short(0.0123456, METRE)}


@pytest.mark.parametrize(
    ("problem", "parts"),
    [
        (Problem(PAIR, 0.01, 2e-5, 0.2444), ["plane stress", "friction coefficient 0.244", "hole radius 10 mm"]),
        (Problem(PAIR, 0.01, 0.0, 0.3), ["neat fit", "pin: steel, force at the centre", "plate: aluminium"]),
        (Problem(PAIR, 0.01, -2e-5, 0.3), ["interference 20 µm"]),
        (Problem(PAIR, 0.01, 2e-5, 0.3, pin_body=Tube(3e-3)), ["pin: steel, bore radius 3 mm"]),
        (Problem(PAIR, 0.01, 2e-5, 0.3, plate_body=Ring(3e-2)), ["plate: aluminium, ring to radius 30 mm"]),
        (
            Problem(PAIR, 0.01, 2e-5, 0.3, plate_body=Bushing(MATERIALS["2024-T3"], 12e-3, 1e-5)),
            ["plate: aluminium with bush of 2024-T3 to radius 12 mm"],
        ),
        (Problem(PAIR, 0.01, 2e-5, 0.3, plate_body=Plate((0.0, 0.06))), ["forces balanced at (0 m, 60 mm)"]),
        (
            Problem.from_load_parameter(MaterialPair(Material.rigid(), Material(1.0, 0.3)), 0.1, 0.3),
            ["pin: rigid", "ν = 0.3", "/β*"],
        ),
    ],
)
def test_captions_name_all_parameters(problem, parts):
    text = plain(caption(problem))
    for part in parts:
        assert part in text


def test_the_load_parameter_is_that_of_the_states():
    result = sample_result([{"P": 1e6}, {"P": 2e6}, {"P": 0.0}])
    low, high = (result.problem.load_parameter(force) for force in (2e6, 1e6))
    assert caption(result.problem, result).endswith(f"load parameter {low:.3g} to {high:.3g}")
    assert caption(result.problem, result[:1]).endswith(f"load parameter {high:.3g}")


def test_rounding_is_zero():
    values = np.array([1.0, -2e-9, 5e-10, np.nan])
    assert np.array_equal(without_rounding(values), [1.0, -2e-9, 0.0, np.nan], equal_nan=True)
    assert not without_rounding(values, 1e10)[:3].any()
    states = sample_result([{"P": 1e6, "Q": 1e-5}, {"P": 1e6, "Q": 2e5}])
    assert load_text(states, 0, "Q") == "Q = 0"
    assert loads_by_change(states) == (["P"], ["Q"])


def test_forces_of_a_thick_plate_are_in_newtons():
    problem = Problem(PAIR, 0.01, 2e-5, 0.3, thickness=5e-3)
    result = sample_result(problem=problem)
    assert load_text(result, 1, "Q") == "Q = +2.42 kN"
    assert plain(loads_text(problem, result[1].load)) == "P = 12.1 kN, Q = 2.42 kN"
    assert "thickness 5 mm" in plain(caption(problem))
    history = figures.plot_history(problem, LoadHistory([{"P": 1e6}]))
    assert history.axes[0].get_ylabel() == "force P (kN)"
    words = [text.get_text() for text in figures.plot_sketch(result[1]).axes[0].texts]
    assert list(map(plain, words)) == ["P = 12.1 kN", "Q = 2.42 kN"]


def test_lines_of_a_caption_end_after_commas():
    rows = wrapped_parts("pin: steel; plate: E = 69 GPa, ν = 0.33; friction coefficient 0.4, hole radius 10 mm", 1.9)
    assert rows == ["pin: steel; plate: E = 69 GPa,", "ν = 0.33; friction coefficient 0.4,", "hole radius 10 mm"]
    words = "a very long part that has no comma in it at all"
    assert wrapped_parts(words, 1.0) == wrapped(words, 1.0)
