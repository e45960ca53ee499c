"""Springs that hold the pin: the rotation of its hub, or, as a rig that drives it, its prescribed displacement."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest

from fastpin import Case, CaseFileError, InputError, Problem, solve
from fastpin.casefile import EXAMPLE, case_text, parse_case
from fastpin.report import describe, state_table
from fastpin.report.summary import document
from fastpin.studies.identity import canonical
from tests.support.case_texts import IN_A_RIG
from tests.support.checks.sliding import solve_sliding
from tests.support.plans import planned
from tests.support.programs import difference
from tests.support.tiers import gate

HISTORY = [{"P": 1.0}, {"Q": 0.25}, {"Q": -0.25}, {"Q": 0.25}, {"P": 0.6, "Q": -0.2}]
TURNED = [*HISTORY[:2], {"Q": -0.25, "rotation": 0.02}, *HISTORY[3:]]
INCREMENTS = {"method": "increment", "increments": 10}


def joint(pair, rotation, hub_radius=None, stiffness=None, friction=0.4):
    return Problem.from_load_parameter(
        pair, 0.3, friction, "centre", rotation, hub_radius, hub_stiffness=stiffness
    )  # fmt: skip


def hub_rotation(state):
    """The mean rotation of the circle of the hub, (T8)."""
    problem = state.problem
    if problem.hub_radius is None:
        return state.rotation
    shear = -state.resultants["M"] / problem.hole_radius**2
    inside = problem.pair.pin_kolosov + 1.0 - (problem.hole_radius / problem.hub_radius) ** 2
    return state.rotation + inside * problem.pair.pin_compliance * shear / (4.0 * math.pi)


@pytest.mark.parametrize("options", [{}, INCREMENTS], ids=["path", "increment"])
@pytest.mark.parametrize("hub_radius", [None, 0.3])
@pytest.mark.parametrize("stiffness", [1e-3, 0.3, 10.0])
def test_the_moment_is_the_spring_s(titanium_in_aluminium, hub_radius, stiffness, options):
    problem = joint(titanium_in_aluminium, "spring", hub_radius, stiffness)
    result = solve(problem, TURNED, nodes=101, **options)
    moments = [state.resultants["M"] for state in result]
    springs = [stiffness * (state.load["rotation"] - hub_rotation(state)) for state in result]
    assert moments == pytest.approx(springs, abs=1e-12)
    assert abs(moments[1]) > 1e-6


@pytest.mark.parametrize("options", [{}, *gate(INCREMENTS)], ids=["path", "increment"])
def test_stiff_and_soft_springs(titanium_in_aluminium, options):
    """A stiff spring is a fixed hub, and a soft one a free pin; the differences fall with the first power."""
    fixed = solve(joint(titanium_in_aluminium, "fixed", 0.3), TURNED, nodes=101, **options)
    free = solve(joint(titanium_in_aluminium, "free"), HISTORY, grid=fixed.grid, **options)
    for limit, history, powers in ((fixed, TURNED, (3, 4, 14)), (free, HISTORY, (-3, -4, -14))):
        springs = [joint(titanium_in_aluminium, "spring", 0.3, 10.0**power) for power in powers]
        worst = [difference(limit, solve(spring, history, grid=fixed.grid, **options)) for spring in springs]
        assert worst[1] == pytest.approx(0.1 * worst[0], rel=0.05)
        assert worst[2] < 1e-11


def test_a_cycle_dissipates_the_work_of_the_force(titanium_in_aluminium):
    """The spring gives back what it takes: in a periodic cycle the work is the dissipation."""
    problem = joint(titanium_in_aluminium, "spring", None, 30.0)
    cycle = [{"Q": -0.25}, {"Q": 0.25}]
    result = solve(problem, [{"P": 1.0}, {"Q": 0.25}, *cycle, *cycle, *cycle], nodes=201)
    work, lost = (getattr(result[-1], name) - getattr(result[-3], name) for name in ("work", "dissipation"))
    assert lost > 1e-4
    assert work == pytest.approx(lost, rel=1e-3)


@pytest.mark.gate
def test_full_sliding(titanium_in_aluminium):
    """A spring whose far end turns on and on brings the pin into full sliding, at the moment of (58)."""
    problem = joint(titanium_in_aluminium, "spring", None, 0.2)
    state = solve(problem, [{"P": 1.0}, {"rotation": 5.0}], nodes=401)[-1]
    assert not state.stick
    found = solve_sliding(problem, {"P": 1.0}, 1)
    assert np.ravel(state.contact) == pytest.approx(found.contact, abs=1e-4)
    assert state.resultants["M"] == pytest.approx(found.moment, rel=1e-5)
    assert found.moment == pytest.approx(0.2 * (5.0 - state.rotation), rel=1e-5)


def test_without_friction_the_spring_carries_nothing(titanium_in_aluminium):
    problem = joint(titanium_in_aluminium, "spring", None, 0.2, friction=0.0)
    state = solve(problem, [{"P": 1.0}, {"rotation": 0.1}], nodes=61)[-1]
    assert (state.rotation, state.resultants["M"]) == pytest.approx((0.1, 0.0), abs=1e-12)


# --- what is asked for, and where it is shown ---------------------------------------------------------------


@pytest.mark.parametrize(
    ("rotation", "stiffness", "words"),
    [
        ("spring", None, "hub_stiffness.*needs the stiffness"),
        ("spring", 0.0, "hub_stiffness.*must be positive"),
        ("spring", -1.0, "hub_stiffness.*must be positive"),
        ("spring", math.inf, "hub_stiffness.*finite"),
        ("spring", "stiff", "hub_stiffness.*number"),
        ("fixed", 1.0, 'hub_stiffness.*only a pin with rotation = "spring"'),
        ("free", 1.0, 'hub_stiffness.*only a pin with rotation = "spring"'),
    ],
)
def test_bad_values(titanium_in_aluminium, rotation, stiffness, words):
    with pytest.raises(InputError, match=words) as caught:
        joint(titanium_in_aluminium, rotation, None, stiffness)
    assert caught.value.field == "hub_stiffness"


def test_a_moment_can_not_be_given(titanium_in_aluminium):
    with pytest.raises(InputError, match='reaction where rotation = "spring"'):
        solve(joint(titanium_in_aluminium, "spring", None, 1.0), [{"P": 1.0, "M": 0.1}])
    with pytest.raises(InputError, match="must rotate freely"):
        Problem.from_load_parameter(titanium_in_aluminium, 0.3, 0.4, "body", "spring", hub_stiffness=1.0)


SPRING = 'rotation = "spring"\nhub_stiffness = 2e5\nhub_radius = 4e-3\n#'
CASE = EXAMPLE.replace('pin_load = "body"  ', 'pin_load = "centre"').replace('rotation = "free"', SPRING)


def test_case_file_and_tables():
    case = parse_case(CASE.replace("nodes = 401", "nodes = 61"))
    assert (case.problem.rotation, case.problem.hub_stiffness) == ("spring", 2e5)
    assert "spring of stiffness 200 kN/rad at radius 4 mm" in describe(case)
    assert "of stiffness 200000 at radius 0.004" in repr(case.problem)
    result = solve(case.problem, case.history, **case.options.keywords())
    assert document(case, result)["problem"]["hub_stiffness"] == 2e5
    assert " M " in state_table(case.problem, result).splitlines()[0]
    json.dumps(canonical(case))


def test_a_case_file_without_the_stiffness():
    with pytest.raises(CaseFileError, match="needs the stiffness of the spring") as caught:
        parse_case(CASE.replace("hub_stiffness = 2e5\n", ""))
    assert len(caught.value.problems) == 1


def test_a_plan_varies_the_stiffness(tmp_path):
    plan = planned(tmp_path, CASE, "[grid]\ncontact.hub_stiffness = [1e4, 1e6]\n")
    cases = [plan.case(point) for point in plan.points]
    assert [case.problem.hub_stiffness for case in cases] == [1e4, 1e6]
    assert len({json.dumps(canonical(case)) for case in cases}) == 2
    assert "hub_stiffness" not in canonical(Case(joint(cases[0].problem.pair, "fixed"), cases[0].history))


@pytest.mark.parametrize(("rotation", "stiffness"), [("fixed", None), ("spring", 3.0)])
def test_the_load_holds_the_moment_that_turns_the_pin(titanium_in_aluminium, rotation, stiffness):
    """A free pin under the same moment turns by the same angle."""
    turned = joint(titanium_in_aluminium, rotation, None, stiffness)
    states = solve(turned, [{"P": 1.0}, {"rotation": 0.1}, {"rotation": -0.1}, {"rotation": 0.1}], nodes=41)
    assert turned.reactions == ("M",)
    assert states[0].load["M"] == 0.0  # a symmetric contact: no rounding of its shear
    for state in states:
        assert state.load["M"] == pytest.approx(state.resultants["M"], abs=1e-12)
    labels = [line.split() for line in state_table(turned, states.states).splitlines()]
    assert labels[0].count("M") == 1
    free = joint(titanium_in_aluminium, "free")
    moved = solve(free, [{"P": 1.0}, {"M": states[1].load["M"]}], grid=states[1].grid)[-1]
    assert moved.rotation == pytest.approx(states[1].rotation, rel=1e-9)
    held = solve(replace(turned, friction=0.0), [{"P": 1.0}, {"rotation": 0.1}], nodes=41)[-1]
    assert math.copysign(1.0, held.load["M"]) == 1.0
    assert held.load["M"] == 0.0


PULLED = [{"P": 1.0}, {"ux": 0.3}, {"ux": -0.3}, {"ux": 0.3}]


def driven(pair, drive="ux", **more):
    return Problem.from_load_parameter(pair, 0.3, 0.4, "centre", "fixed", 0.3, drive=drive, **more)


@pytest.mark.parametrize("stiffness", [0.05, 1.0, 30.0])
def test_the_rig_gives_way_by_its_force(titanium_in_aluminium, stiffness):
    """The hub moves as without a rig under the displacement that is left, and the work has the spring's energy."""
    result = solve(driven(titanium_in_aluminium, rig_stiffness=stiffness), PULLED, nodes=61)
    given, forces = (np.array([state.load[name] for state in result]) for name in ("ux", "Q"))
    moved = [state.displacement["ux"] for state in result]
    assert given - forces / stiffness == pytest.approx(moved, abs=1e-12)
    corners = [{"P": state.load["P"], "ux": ux} for state, ux in zip(result, moved, strict=True)]
    rigid = solve(driven(titanium_in_aluminium), corners, grid=result.grid)
    assert [state.load["Q"] for state in rigid] == pytest.approx(forces, abs=1e-11)
    assert rigid[-1].dissipation == pytest.approx(result[-1].dissipation, rel=1e-9)


def test_a_stiff_rig_is_none(titanium_in_aluminium):
    rigid = solve(driven(titanium_in_aluminium), PULLED, nodes=41)
    stiff = solve(driven(titanium_in_aluminium, rig_stiffness=1e14), PULLED, grid=rigid.grid)
    assert stiff[-1].load["Q"] == pytest.approx(rigid[-1].load["Q"], rel=1e-11)


@pytest.mark.parametrize(
    ("drive", "stiffness", "words"),
    [
        ("ux", 0.0, "must be positive, not 0"),
        ("ux", -1.0, "must be positive, not -1"),
        ("ux", "soft", "must be a number"),
        ("force", 1.0, 'only a displacement has a rig: drive = "ux" or "uy" or "both"'),
    ],
)
def test_a_wrong_stiffness_of_the_rig_is_refused(titanium_in_aluminium, drive, stiffness, words):
    with pytest.raises(InputError, match=words) as caught:
        driven(titanium_in_aluminium, drive, rig_stiffness=stiffness)
    assert caught.value.field == "rig_stiffness"


def test_the_case_file_gives_the_whole_rig_s_stiffness():
    case = parse_case(IN_A_RIG.replace("[[load]]", "thickness = 5e-3\nrig_stiffness = 3e8\n[[load]]"))
    assert case.problem.rig_stiffness == 3e8 / 5e-3
    assert "rig of stiffness 300 MN per m" in describe(case)
    assert parse_case(case_text(case)).problem == case.problem
