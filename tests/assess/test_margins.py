"""The table of margins: its values, the states that govern, and what it says where data lack."""

import math
from dataclasses import replace

import numpy as np
import pytest

from fastpin import Case, LoadHistory, Material, MaterialPair, Problem, Result, solve
from fastpin.assess.margins import (
    MOST_STOPS,
    cycle_margins,
    in_json,
    in_order,
    last_cycle_margins,
    margin_lines,
    margin_rows,
    verdict,
)
from fastpin.bodies import Bushing, Ring
from fastpin.damage import fatigue
from fastpin.model import FatigueConstants
from fastpin.model.doubts import doubts_given
from fastpin.report import summary
from fastpin.states.extremes import Found, KeptStates, marked_extremes
from fastpin.states.margins import Margin, smallest_margin, static_margins
from fastpin.states.yielding import von_mises_peak
from tests.support.bodies import softer_hole

STEEL, BRONZE = Material(210e9, 0.3), Material(103e9, 0.34, yield_strength=300e6)
LIMITS = FatigueConstants(bending_limit=150e6, torsion_limit=90e6)
ALUMINIUM = Material(71e9, 0.33, "sheet", LIMITS, yield_strength=503e6)
LUG = Bushing(BRONZE, 12.5e-3, 20e-6, inside=Ring(0.03))
OPENING = "bush: opening, press fit needed"
HISTORY = LoadHistory([{"P": 2e6}]) + LoadHistory([{"P": 3e6, "Q": 5e5}, {"P": 2e6, "Q": 0.0}]).repeated(2)


def solved(history: LoadHistory = HISTORY, pair: MaterialPair | None = None, lug: Bushing = LUG) -> Result:
    with doubts_given():
        return solve(
            Problem(pair or MaterialPair(STEEL, ALUMINIUM), 10e-3, 30e-6, 0.3, plate_body=lug), history, nodes=61
        )


def of(result: Result) -> dict[str, Margin]:
    rows = static_margins(result.problem, marked_extremes(KeptStates(result.states)), KeptStates(result.states).read)
    return {row.subject: row for row in rows}


@pytest.fixture(scope="module")
def result() -> Result:
    return solved()


@pytest.mark.gate
def test_margins_are_allowable_over_value_of_the_governing_state(result: Result) -> None:
    rows = of(result)
    for owner, strength in (("bush", 300e6), ("plate", 503e6)):
        values = [von_mises_peak(state, owner).value for state in result]
        row = rows[f"{owner}: yield, von Mises"]
        assert (row.value, row.allowable) == (max(values), strength)
        assert row.load_point == values.index(max(values)) + 1
        assert row.margin == pytest.approx(strength / max(values) - 1.0)
    fits = [state.bush_fit() for state in result]
    turning, opening = rows["bush: rotation, friction needed"], rows[OPENING]
    assert turning.value == max(fit.least_friction for fit in fits)
    assert math.isnan(turning.margin)
    least = min(fits, key=lambda fit: fit.open_margin)
    assert opening.margin == pytest.approx(least.press_fit_pressure / least.pressure_to_close - 1.0)
    assert opening.load_point == fits.index(least) + 1


def margins_of(part: str, plate: float, pin: float) -> list[Margin]:
    of_plate = Margin(
        "plate: yield, von Mises", "traction", 1e8, (1.0 + plate) * 1e8, name="yield", owner="plate", part=part
    )
    return [of_plate, Margin("pin: yield, von Mises", "traction", 1e8, (1.0 + pin) * 1e8, name="yield", owner="pin")]


@pytest.mark.parametrize(
    ("part", "plate", "pin", "verdicts"),
    [
        ("", 0.5, 7.0, ["+0.50, the smallest", "+7.00"]),
        ("near the hole only", 0.5, 7.0, ["+0.50", "+7.00"]),
        ("near the hole only", 0.5, 0.1, ["+0.50", "+0.10, the smallest known"]),
    ],
)
def test_the_margin_of_a_part_is_never_called_the_smallest(
    part: str, plate: float, pin: float, verdicts: list[str]
) -> None:
    rows = margins_of(part, plate, pin)
    problem = Problem(MaterialPair(STEEL, ALUMINIUM), 10e-3, 30e-6, 0.3)
    assert [row[3] for row in margin_rows(problem, rows)] == verdicts
    assert margin_rows(problem, rows)[0][-1] == part
    assert [row.margin.part for row in in_json(problem, rows)] == [part, ""]
    assert [row.is_smallest for row in in_json(problem, rows)] == ["smallest" in each for each in verdicts]


@pytest.mark.parametrize("bushed", [True, False])
def test_a_lug_of_any_outline_is_looked_at_on_the_edge_of_its_hole_only(bushed: bool) -> None:
    lug = softer_hole(12.5e-3 if bushed else 10e-3, ALUMINIUM.nu, "strain")
    problem = Problem(
        MaterialPair(STEEL, ALUMINIUM), 10e-3, 30e-6, 0.3, plate_body=replace(LUG, inside=lug) if bushed else lug
    )
    parts = {row.owner: row.part for row in static_margins(problem, Found(), lambda places: [])}
    assert parts == {"plate": "near the hole only", "pin": "", **({"bush": ""} if bushed else {})}


@pytest.mark.gate
def test_what_is_not_known_says_why() -> None:
    result = solved(pair=MaterialPair(STEEL, replace(ALUMINIUM, yield_strength=None)))
    rows = of(result)
    for subject, words in {
        "pin: yield, von Mises": "not known: no yield strength given",
        "plate: yield, von Mises": "not known: no yield strength given",
        "bush: rotation, friction needed": "not known: no friction between bush and plate given",
    }.items():
        assert rows[subject].remark == words
        assert math.isnan(rows[subject].margin)
    shown = {row[0]: row for row in margin_rows(result.problem, list(rows.values()))}
    assert shown["pin: yield, von Mises"][1:5] == ("-", "-", "not known", "-")
    none = {row.subject: row for row in static_margins(result.problem, Found(), lambda places: [])}
    for subject in ("bush: yield, von Mises", OPENING):
        assert none[subject].remark == "not known: there is no state"


def test_a_dimensionless_problem_has_no_margin_of_yield() -> None:
    problem = Problem.from_load_parameter(MaterialPair(STEEL, ALUMINIUM), 0.5, 0.3)
    with doubts_given():
        result = solve(problem, [{"P": 1.0}], nodes=61)
    assert of(result)["plate: yield, von Mises"].remark == "not known: the problem has no dimensions"


def test_a_bush_that_opens_has_a_negative_margin() -> None:
    rows = of(solved(LoadHistory([{"P": 9e6}]), lug=replace(LUG, interference=2e-6)))
    assert rows[OPENING].margin < 0.0
    assert rows["bush: rotation, friction needed"].remark == "the bush opens"


@pytest.mark.gate
def test_a_bush_that_slips_has_its_largest_slip() -> None:
    lug = replace(LUG, friction=0.2, bonded=False)
    result = solved(LoadHistory([{"P": 2e6}, {"Q": 1e6}, {"Q": -1e6}]), lug=lug)
    rows, slips = of(result), [state.peak_slip for state in result.seat]
    slip, opening = rows["bush: slip in its seat"], rows[OPENING]
    top = int(np.argmax(np.abs(slips)))
    assert (slip.value, slip.load_point) == (abs(slips[top]), top + 1.0)
    assert slip.value > 0.0
    assert slip.remark.startswith("no limit of the slip is known; largest at ")
    assert opening.margin >= 0.0
    assert "bush: rotation, friction needed" not in rows
    loose = of(solved(LoadHistory([{"P": 9e6}]), lug=replace(lug, interference=8e-6)))[OPENING]
    free = of(solved(LoadHistory([{"P": 2e6}]), lug=replace(lug, interference=-5e-6)))[OPENING]
    assert all(row.remark.startswith("the bush opens at ") for row in (loose, free))
    assert loose.margin == 0.0
    assert math.isnan(free.margin)


def test_fatigue_is_of_the_last_cycle_and_says_so(result: Result) -> None:
    states = result.cycle().states
    (seat,) = cycle_margins(result.problem, states)  # the bush has no limits
    findley = fatigue(states, "findley", "seat")
    assert seat.subject.startswith("last cycle only")
    assert seat.subject.endswith("Findley")
    assert seat.margin == pytest.approx(findley.limit / findley.hot_spot.parameter - 1.0)
    (known_limit,) = last_cycle_margins(result.problem, result.states, result.cycles)
    assert known_limit.margin == seat.margin
    assert cycle_margins(result.problem, (*states, *states) * MOST_STOPS) == []
    assert last_cycle_margins(result.problem, result.states[:2], result.cycles) == []  # a corner is missing
    assert last_cycle_margins(result.problem, result.states, []) == []


@pytest.mark.gate
def test_a_result_without_states_has_a_summary_without_margins(result: Result) -> None:
    none = replace(result, states=[], complete=False)
    found = summary.document(Case(result.problem, result.history), none)
    assert (found["margins"], found["states"], found["extremes"]) == ([], [], {})


@pytest.mark.gate
def test_the_summary_has_the_margins(result: Result) -> None:
    found = summary.document(Case(result.problem, result.history), result)["margins"]
    rows = of(result)
    assert [each["subject"] for each in found] == [*rows, "last cycle only: plate at the seat, fatigue, Findley"]
    (smallest,) = (each for each in found if each["smallest"])
    assert smallest["margin"] == min(each["margin"] for each in found if each["margin"] is not None)
    bush = next(each for each in found if each["subject"] == "bush: yield, von Mises")
    assert (bush["allowable"], bush["unit"]) == (300e6, "Pa")
    loads = result[int(bush["load_point"]) - 1].load
    assert bush["loads"] == {name: loads[name] for name in bush["loads"]}
    assert bush["loads"]["P"] > 0.0
    assert bush["margin"] == rows["bush: yield, von Mises"].margin
    assert next(each for each in found if each["subject"] == "pin: yield, von Mises")["margin"] is None


@pytest.mark.gate
def test_the_ultimate_strength_has_a_margin_of_its_own() -> None:
    result = solved(pair=MaterialPair(STEEL, replace(ALUMINIUM, ultimate_strength=572e6)))
    rows = of(result)
    yielding, ultimate = rows["plate: yield, von Mises"], rows["plate: ultimate, von Mises"]
    for name in ("value", "load_point", "remark"):
        assert getattr(ultimate, name) == getattr(yielding, name)
    assert (ultimate.margin + 1.0) / (yielding.margin + 1.0) == pytest.approx(572.0 / 503.0)
    assert ultimate.loads == result[int(ultimate.load_point) - 1].load
    assert "bush: ultimate, von Mises" not in rows  # its strength is not given


def test_the_margin_of_a_press_fit_is_that_of_lame() -> None:
    pair = MaterialPair(STEEL, replace(ALUMINIUM, ultimate_strength=600e6), "stress")
    with doubts_given():
        result = solve(Problem(pair, 10e-3, -20e-6, 0.3), [{"P": 1e-3}], nodes=61)  # the load is next to nothing
    rows = of(result)
    pressure = 20e-6 / 10e-3 / ((1.0 - 0.3) / 210e9 + (1.0 + 0.33) / 71e9)
    mises = math.sqrt(3.0) * pressure  # -p across the edge of the hole, and p along it
    assert rows["plate: yield, von Mises"].margin == pytest.approx(503e6 / mises - 1.0, rel=1e-6)
    assert rows["plate: ultimate, von Mises"].margin == pytest.approx(600e6 / mises - 1.0, rel=1e-6)


def test_the_smallest_margin_is_marked(result: Result) -> None:
    problem = result.problem
    rows = [
        Margin("a", "traction", 2e6, 3e6, 1.0, "at 0 deg", {"P": 1e3}),
        Margin("b", "traction", 4e6, 3e6, 2.5, "at 1 deg", {"P": 2e3}),
        Margin("c", remark="not known: no yield strength given"),
        Margin("d", "traction", 0.0, 3e6, 1.0),
    ]
    assert smallest_margin(rows) is rows[1]
    margins = [row[3] for row in margin_rows(problem, rows)]
    assert margins == ["+0.50", "-0.25, the smallest", "not known", "none needed"]
    assert smallest_margin(rows[2:]) is None
    head, *lines = margin_lines(problem, rows)
    assert head == "margins of safety over all kept states, allowable/value - 1:"
    assert [" ".join(line.split()) for line in lines] == [
        "a 2 MPa of 3 MPa +0.50 load point 1: P = 1 kN/m at 0 deg",
        "b 4 MPa of 3 MPa -0.25, the smallest load point 2.5: P = 2 kN/m at 1 deg",
    ]
    assert margin_lines(problem, rows[2:]) == []


def test_the_verdict_names_the_row_that_governs() -> None:
    problem = Problem(MaterialPair(STEEL, ALUMINIUM), 10e-3, 30e-6, 0.3)
    plate, pin = (row._replace(load_point=2.0) for row in margins_of("", 0.5, 0.2))
    unknown = Margin("bush: slip in its seat", remark="no limit of the slip is known")
    needless = Margin("bush: opening, press fit needed", "traction", 0.0, 1e7)
    assert [row.subject for row in in_order([unknown, needless, plate, pin])] == [
        pin.subject, plate.subject, needless.subject, unknown.subject
    ]  # fmt: skip
    known = "all known margins are positive; the smallest is that of pin: yield, von Mises: +0.20, load point 2"
    assert verdict([plate, pin]) == known
    assert verdict([plate, pin, unknown]) == f"{known}; not known: 1 of 3, see their remarks"
    failed = plate._replace(allowable=0.9e8, part="near the hole only")
    assert (
        verdict([failed, pin]) == "the joint fails by plate: yield, von Mises: -0.10, load point 2, near the hole only"
    )
    assert verdict([unknown]) == "no margin is known; not known: 1 of 1, see their remarks"
    growing = Margin("plate: crack, threshold", "intensity", 2.0, 1.0, 2.0, name="growth", owner="plate")
    assert verdict([growing, pin]) == (
        "all known margins but that of a crack that grows are positive; the smallest other is that of "
        "pin: yield, von Mises: +0.20, load point 2"
    )
    assert verdict([plate, pin], is_complete=False) == f"not known, the run is unfinished; up to its end {known}"
    assert len(margin_rows(problem, in_order([unknown, plate]))) == 2
