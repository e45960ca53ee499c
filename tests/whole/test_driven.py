"""Prescribed displacements of the pin in place of forces: the same states, read from the other side."""

import cmath
import json
import math

import numpy as np
import pytest

import fastpin
from fastpin.casefile.reader import EXAMPLE, parse_case
from fastpin.errors import CaseFileError, InputError
from fastpin.model.angles import BOTTOM
from fastpin.model.grid import Grid
from fastpin.model.history import LoadHistory
from fastpin.model.materials import Material, MaterialPair
from fastpin.model.problem import Problem
from fastpin.report.case import describe
from fastpin.report.states import state_table
from fastpin.report.summary import document
from fastpin.solver.errors import NoEquilibriumError
from fastpin.solver.solving import solve
from fastpin.studies.identity import canonical
from tests.support.checks.integral_equations import residuals_away
from tests.support.checks.sliding import solve_sliding
from tests.support.once import solve_once
from tests.support.plans import planned
from tests.support.programs import difference
from tests.support.refusals import refused
from tests.support.samples import JOINT

KINDS = [("centre", "free"), ("centre", "fixed"), ("body", "free")]
FRETTING = [{"P": 1.0}, {"Q": 0.3}, {"Q": -0.3}, {"Q": 0.3}, {"P": 0.7}, {"Q": -0.1}]
DRIVES = ["ux", "uy", "both"]


def joint(pair, parameter, kind, drive="force", friction=0.4, **options):
    return Problem.from_load_parameter(pair, parameter, friction, *kind, drive=drive, **options)


def driven_corners(problem, states, lift=0.0, names=("sxx", "syy", "sxy")):
    """Corners that prescribe the displacements of the states of another problem; `lift` is added to uy."""
    corners = []
    for state in states:
        moved = state.displacement
        corner = {name: state.load[name] for name in names}
        corner |= {"ux": moved["ux"]} if problem.driven[0] else {"Q": state.load["Q"]}
        corner |= {"uy": moved["uy"] + lift} if problem.driven[1] else {"P": state.load["P"]}
        corners.append(corner)
    return corners


def imbalance(states):
    """Largest difference of work and energy plus dissipation, over the largest energy."""
    size = max(abs(state.energy) for state in states)
    return max(abs(state.work - state.energy - state.dissipation) for state in states) / size


# --- the same states as under forces ------------------------------------------------------------------------


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("parameter", [0.3, 0.0, -0.1], ids=["loose", "neat", "interference"])
def test_ux_in_place_of_q(titanium_in_aluminium, parameter, kind):
    """Steps under P or Q alone have the same path as steps under P or ux alone, if ux is kept while P acts."""
    pushed = joint(titanium_in_aluminium, parameter, kind)
    history = FRETTING[:4] if parameter >= 0.0 else [{"P": 1.0, "Q": 0.0}, *FRETTING[1:4]]
    force = solve(pushed, history, nodes=101, between=2)
    driven = joint(titanium_in_aluminium, parameter, kind, "ux")
    corner_states = [state for state in force if state.fraction == 1.0]
    corners = driven_corners(driven, corner_states)
    result = solve(driven, corners, grid=force.grid)
    assert difference(corner_states, result, "slip") < 1e-9
    assert [state.load["Q"] for state in result] == pytest.approx([s.load["Q"] for s in corner_states], abs=1e-11)
    assert [state.load["ux"] for state in result] == [corner["ux"] for corner in corners]
    assert [state.dx for state in result] == pytest.approx([state.dx for state in corner_states], abs=1e-11)
    assert [state.dissipation for state in result] == pytest.approx([s.dissipation for s in corner_states], abs=1e-12)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("drive", DRIVES)
def test_every_drive_of_an_interference_fit(titanium_in_aluminium, drive, kind):
    """No first contact, and no change of status but slip: all displacements follow the forces without bends."""
    pushed = joint(titanium_in_aluminium, -0.1, kind, friction=0.9)
    force = solve_once(pushed, FRETTING, nodes=96)
    driven = joint(titanium_in_aluminium, -0.1, kind, drive, friction=0.9)
    result = solve(driven, driven_corners(driven, force), grid=force.grid)
    assert difference(force, result, "slip") < 1e-9
    for name in ("P", "Q"):
        assert [s.load[name] for s in result] == pytest.approx([s.load[name] for s in force], abs=1e-10)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("drive", ["uy", "both"])
def test_prescribed_uy_of_a_loose_pin(titanium_in_aluminium, drive, kind):
    """The first contact spans a few nodes without shear, under another load than under forces: an error of O(h)."""
    worst = []
    for nodes in (101, 301):
        history, arc = [{"P": 0.5}, {"P": 1.0}], (BOTTOM - 1.2, BOTTOM + 1.2)
        force = solve_once(joint(titanium_in_aluminium, 0.3, kind), history, nodes=nodes, arc=arc)
        driven = joint(titanium_in_aluminium, 0.3, kind, drive)
        result = solve(driven, driven_corners(driven, force, lift=-0.3), grid=force.grid)
        worst.append(difference(force, result))
        assert (result[-1].load["P"], result[-1].load["Q"]) == pytest.approx((1.0, 0.0), abs=1e-6)
    assert worst[0] < 1e-3
    assert worst[1] < 0.7 * worst[0]


@pytest.mark.parametrize("kind", KINDS)
def test_reactions_given_as_forces(titanium_in_aluminium, kind):
    """The other way round: partial slip and gross sliding under ux, then the reactions as Q."""
    hub = {"hub_radius": 0.4} if kind[1] == "fixed" else {}
    driven = joint(titanium_in_aluminium, 0.3, kind, "ux", **hub)
    corners = [{"P": 1.0, "ux": 0.0}, {"ux": 0.08}, {"ux": -0.05}, {"P": 0.8}]
    result = solve(driven, corners, nodes=101)
    reactions = [{"P": state.load["P"], "Q": state.load["Q"]} for state in result[:3]]
    force = solve(joint(titanium_in_aluminium, 0.3, kind, **hub), reactions, grid=result.grid)
    assert difference(force, result[:3], "slip") < 1e-9
    assert any(state.stick for state in result)
    assert result[-1].load["Q"] != pytest.approx(result[-2].load["Q"], abs=1e-3)  # P alone changes the reaction


@pytest.mark.parametrize("drive", DRIVES)
def test_the_gauge_is_a_compliance_in_series(titanium_in_aluminium, drive):
    near = joint(titanium_in_aluminium, -0.1, KINDS[1], drive)
    far = joint(titanium_in_aluminium, -0.1, KINDS[1], drive, gauge_radius=5.0)
    added = far.drive_compliances[0] - near.drive_compliances[0]
    kolosov, plate = near.pair.plate_kolosov, near.pair.plate_compliance
    assert added == pytest.approx(kolosov * math.log(5.0) * plate / (2.0 * math.pi * (kolosov + 1.0)))
    corners = {"ux": [{"P": 1.0}, {"ux": 0.1}], "uy": [{"uy": -0.2}, {"Q": 0.2}], "both": [{"uy": -0.2}, {"ux": 0.1}]}
    one = solve(near, corners[drive], nodes=96)
    moved = []
    for state, corner in zip(one, LoadHistory(corners[drive]).values(), strict=True):
        load = dict(zip(fastpin.model.LOADS, corner, strict=True))
        given = {"ux": load["ux"] + added * state.load["Q"], "uy": load["uy"] - added * state.load["P"]}
        names = {"ux": ("P", "ux"), "uy": ("Q", "uy"), "both": ("ux", "uy")}[drive]
        moved.append({name: given.get(name, load[name]) for name in names})
    two = solve(far, moved, grid=one.grid)
    assert difference(one, two) < (1e-9 if drive == "ux" else 3e-2)  # one load alone changes in a step under ux only
    for name in ("ux", "uy") if drive == "both" else (drive,):
        assert [s.displacement[name] for s in two] == pytest.approx([s.load[name] for s in two], abs=1e-12)


# --- energy -------------------------------------------------------------------------------------------------


def test_the_loop_of_q_over_ux_is_the_dissipation(titanium_in_aluminium):
    """In a periodic cycle of a held pin. The hub is small enough for the work of Q over ux to be the work, (T29)."""
    driven = joint(titanium_in_aluminium, 0.3, KINDS[1], "ux", friction=0.3, hub_radius=0.4)
    cycle = [{"ux": -0.1}, {"ux": 0.1}]
    result = solve(driven, [{"P": 1.0}, {"ux": 0.1}, *cycle, *cycle], nodes=201, between=50)
    last = [state for state in result if state.step >= 4 or (state.step == 3 and state.fraction == 1.0)]
    ux, Q = (np.array([state.load[name] for state in last]) for name in ("ux", "Q"))
    area = float(np.sum(0.5 * (Q[1:] + Q[:-1]) * np.diff(ux)))
    lost = last[-1].dissipation - last[0].dissipation
    assert lost > 1e-3
    assert area == pytest.approx(lost, rel=5e-3)


def test_the_work_of_a_body_force_is_that_over_its_displacement(titanium_in_aluminium):
    """The mean displacement of the pin is the one on which a body force works; the work leaves out g F^2/2, (T29)."""
    driven = joint(titanium_in_aluminium, 0.3, KINDS[2], "both", gauge_radius=2.0)
    result = solve(driven, [{"uy": -0.5}, {"ux": 0.1}, {"ux": -0.1, "uy": -0.45}], nodes=201, between=100)
    touched = [state for state in result if state.in_contact]
    ux, uy, P, Q = (np.array([state.load[name] for state in touched]) for name in ("ux", "uy", "P", "Q"))
    work = 0.5 * np.sum((Q[1:] + Q[:-1]) * np.diff(ux)) - 0.5 * np.sum((P[1:] + P[:-1]) * np.diff(uy))
    work -= 0.5 * driven.drive_compliances[0] * (P[-1] ** 2 + Q[-1] ** 2 - P[0] ** 2 - Q[0] ** 2)
    assert touched[-1].dissipation > 1e-3
    assert touched[-1].work - touched[0].work == pytest.approx(work, rel=1e-3)


# --- gross sliding, first contact, loss of contact -----------------------------------------------------------


@pytest.mark.gate
def test_gross_sliding(titanium_in_aluminium):
    """Under ux the held pin slides along the wall; the state is that of (58) under the reaction."""
    driven = joint(titanium_in_aluminium, 0.5, KINDS[1], "ux", friction=0.3)
    state = solve(driven, [{"P": 1.0}, {"ux": 0.4}], nodes=401)[-1]
    assert not state.stick
    found = solve_sliding(driven, {"P": 1.0, "Q": state.load["Q"]}, 1)
    assert np.ravel(state.contact) == pytest.approx(found.contact, abs=2e-4)
    assert state.resultants["M"] == pytest.approx(found.moment, rel=1e-5)
    assert residuals_away(state, 0.1)[1] < 1e-4


def test_a_moment_beyond_friction(titanium_in_aluminium):
    """No state carries it, whatever drives the pin."""
    driven = joint(titanium_in_aluminium, 0.3, KINDS[0], "ux", friction=0.3)
    with pytest.raises(NoEquilibriumError):
        solve(driven, [{"P": 1.0}, {"M": 0.5}], nodes=61)
    driven = joint(titanium_in_aluminium, 0.3, KINDS[0], "both", friction=0.3)
    with pytest.raises(NoEquilibriumError, match="not in contact"):
        solve(driven, [{"M": 0.1}, {"uy": -0.4}], nodes=61)


@pytest.mark.parametrize("options", [{}, {"method": "increment", "increments": 16}], ids=["path", "increment"])
def test_across_the_clearance(titanium_in_aluminium, options):
    """A pin driven to and fro touches both sides of the hole, and floats between them."""
    driven = joint(titanium_in_aluminium, 0.2, KINDS[0], "both")
    corners = [{"uy": -0.1}, {"uy": -0.3}, {"uy": 0.0}, {"uy": 0.3}, {"uy": -0.3}, {"ux": 0.3, "uy": 0.0}]
    result = solve(driven, corners, nodes=120, arc=(0.0, 2.0 * math.pi), **options)
    assert [state.in_contact for state in result] == [False, True, False, True, True, True]
    for k in (0, 2):
        assert (result[k].load["P"], result[k].load["Q"]) == pytest.approx((0.0, 0.0), abs=1e-12)
        assert result[k].energy == pytest.approx(0.0, abs=1e-12)
        assert (result[k].dx, result[k].dy) == (0.0, corners[k]["uy"])
        assert result[k].gap == pytest.approx(0.2 - result[k].dy * np.sin(result[k].theta), abs=1e-12)
    down, up, again = (result[k] for k in (1, 3, 4))
    tolerance = 1e-2 if options else 1e-9
    assert up.load["P"] == pytest.approx(-down.load["P"], rel=tolerance)
    assert again.load["P"] == pytest.approx(down.load["P"], rel=tolerance)
    assert imbalance(result) < (0.1 if options else 1e-2)


@pytest.mark.parametrize("stress", [0.0, 0.1])
@pytest.mark.parametrize("kind", KINDS)
def test_without_force_the_pin_finds_its_place(titanium_in_aluminium, kind, stress):
    """With P = 0 and ux beyond the clearance the pin rests at the side. Remote shear moves this place."""
    driven = joint(titanium_in_aluminium, 0.2, kind, "ux", friction=0.0)
    state = solve(driven, [{"ux": 0.0, "sxy": stress}, {"ux": 0.35}], nodes=180)[-1]
    assert state.load["P"] == 0.0
    assert state.load["Q"] > 0.05
    assert state.resultants["P"] == pytest.approx(0.0, abs=1e-12)
    (contact,) = state.contact
    middle = 0.5 * sum(contact)
    assert math.cos(middle) > 0.9
    if stress == 0.0:
        assert math.sin(middle) == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize("kind", KINDS)
def test_a_pin_beside_the_middle(titanium_in_aluminium, kind):
    """ux is given before P: the pin comes to rest where the wall is at ux. Its reaction has the angle of the wall."""
    driven = joint(titanium_in_aluminium, 0.4, kind, "ux", friction=0.0)
    state = solve(driven, [{"ux": 0.2}, {"P": 1e-4}], nodes=801, arc=(BOTTOM + 0.3, BOTTOM + 0.7))[-1]
    angle = math.atan2(-state.load["P"], state.load["Q"])
    assert math.cos(angle) == pytest.approx(0.5, abs=2e-3)
    assert np.mean(state.contact) == pytest.approx(angle, abs=1e-4)


@pytest.mark.parametrize("angle", [0.7, -2.0])
def test_a_turned_drive(titanium_in_aluminium, angle):
    """Both displacements prescribed, and everything turned."""
    driven = joint(titanium_in_aluminium, 0.2, KINDS[0], "both", gauge_radius=3.0)
    corners = [(0.05, -0.4, 0.05), (0.15, -0.35, 0.0), (0.0, -0.45, 0.05), (-0.1, 0.0, 0.0), (0.1, -0.45, 0.0)]

    def run(turn):
        history = []
        for x, y, stress in corners:
            moved, oval = complex(x, y) * cmath.exp(1j * turn), stress * cmath.exp(2j * turn)
            history.append(
                {"ux": moved.real, "uy": moved.imag, "sxx": stress + oval.real, "syy": stress - oval.real}
                | {"sxy": oval.imag}
            )
        grid = Grid.arc(BOTTOM - 1.7 + turn, BOTTOM + 1.7 + turn, 121)
        return solve(driven, history, grid=grid, between=1)

    one, two = run(0.0), run(angle)
    assert difference(one, two, "gap") < 1e-8
    assert sum(state.in_contact for state in one) < len(one)
    for first, second in zip(one, two, strict=True):
        force = complex(first.load["Q"], -first.load["P"]) * cmath.exp(1j * angle)
        assert complex(second.load["Q"], -second.load["P"]) == pytest.approx(force, abs=1e-9)


def test_uy_is_ux_turned(titanium_in_aluminium):
    """A pin pushed by Q and driven by uy is the pin pushed by P and driven by ux, turned by a quarter."""
    one = solve(
        joint(titanium_in_aluminium, 0.3, KINDS[2], "ux"),
        [{"P": 1.0}, {"ux": 0.07}, {"ux": -0.07}],
        grid=Grid.arc(BOTTOM - 1.6, BOTTOM + 1.6, 101),
    )
    two = solve(
        joint(titanium_in_aluminium, 0.3, KINDS[2], "uy"),
        [{"Q": 1.0}, {"uy": 0.07}, {"uy": -0.07}],
        grid=Grid.arc(-1.6, 1.6, 101),
    )
    assert difference(one, two) < 1e-10
    assert [state.load["P"] for state in two] == pytest.approx([-state.load["Q"] for state in one], abs=1e-11)


def test_a_rigid_pin_and_a_rigid_plate():
    for pair in (
        MaterialPair(Material.rigid(), Material(1.0, 0.3)),
        MaterialPair(Material(1.0, 0.3), Material.rigid(), "stress"),
    ):
        driven = joint(pair, 0.2, KINDS[1], "ux", gauge_radius=2.0)
        force = solve(joint(pair, 0.2, KINDS[1]), [{"P": 1.0}, {"Q": 0.2}], nodes=61)
        ux = force[-1].displacement["ux"]
        ux += (driven.drive_compliances[0] - joint(pair, 0.2, KINDS[1], "ux").drive_compliances[0]) * 0.2
        result = solve(driven, [{"P": 1.0}, {"ux": ux}], grid=force.grid)
        assert result[-1].load["Q"] == pytest.approx(0.2, abs=1e-10)


# --- what is asked for, files, tables -----------------------------------------------------------------------


@pytest.mark.parametrize(
    ("drive", "corner", "field", "words"),
    [
        ("ux", {"P": 1.0, "Q": 0.1}, "Q", 'reaction where drive = "ux"; give ux'),
        ("both", {"P": 1.0, "ux": 0.1}, "P", 'reaction where drive = "both"; give uy'),
        ("uy", {"uy": 1.0, "ux": 0.1}, "ux", 'only where drive = "ux" or "both"; give Q'),
        ("force", {"P": 1.0, "uy": 0.1}, "uy", 'only where drive = "uy" or "both"; give P'),
    ],
)
def test_loads_that_the_drive_refuses(titanium_in_aluminium, drive, corner, field, words):
    with pytest.raises(InputError, match=words) as caught:
        solve(joint(titanium_in_aluminium, 0.3, KINDS[0], drive), [corner])
    assert caught.value.field == field


@pytest.mark.parametrize(
    ("kind", "options", "field"),
    [
        (KINDS[0], {"drive": "ux", "gauge_radius": 0.9}, "gauge_radius"),
        (KINDS[0], {"drive": "ux", "gauge_radius": math.inf}, "gauge_radius"),
        (KINDS[2], {"drive": "ux", "hub_radius": 0.5}, "hub_radius"),
        (KINDS[0], {"drive": "ux", "hub_radius": 1.5}, "hub_radius"),
    ],
)
def test_bad_values(titanium_in_aluminium, kind, options, field):
    assert refused(joint, titanium_in_aluminium, 0.3, kind, **options).field == field


def test_si_units(titanium_in_aluminium):
    radius, force, beta = 10e-3, 1e6, titanium_in_aluminium.beta_star
    unit = force * beta
    small = solve(joint(titanium_in_aluminium, 0.3, KINDS[2], "ux"), [{"P": 1.0}, {"ux": 0.1}], nodes=61)
    large = Problem(titanium_in_aluminium, radius, 0.3 * unit, 0.4, "body", drive="ux")
    result = solve(large, [{"P": force}, {"ux": 0.1 * unit}], nodes=61)
    assert result[-1].load["Q"] == pytest.approx(small[-1].load["Q"] * force, rel=1e-10)
    assert result[-1].displacement["ux"] == pytest.approx(0.1 * unit, rel=1e-10)


CASE = (
    JOINT
    + """
drive = "ux"
gauge_radius = 15e-3
hub_radius = 4e-3
[[load]]
P = 1e6
[[load]]
ux = [10e-6, -10e-6]
repeat = 3
[[load]]
csv = "rig.csv"
[solve]
nodes = 61
"""
)


@pytest.fixture
def case(tmp_path):
    (tmp_path / "rig.csv").write_text("ux, P\n1e-6, \n-1e-6, 9e5\n")
    return parse_case(CASE, folder=tmp_path)


@pytest.mark.gate
def test_case_file_and_tables(case):
    assert (case.problem.drive, case.problem.gauge_radius, case.problem.hub_radius) == ("ux", 15e-3, 4e-3)
    assert "ux in place of Q over radius 15 mm, hub of radius 4 mm" in describe(case)
    assert "driven by ux over radius 0.015" in repr(case.problem)
    result = solve(case.problem, case.history, **case.options.keywords())
    head = state_table(case.problem, result).splitlines()[0]
    assert " Q " in head
    assert " ux " in head
    found = document(case, result)
    assert (found["problem"]["drive"], found["problem"]["gauge_radius"]) == ("ux", 15e-3)
    assert found["states"][-1]["load"]["ux"] == -1e-6
    assert found["states"][-1]["load"]["Q"] == pytest.approx(result[-1].resultants["Q"])


def test_error_bars(case):
    result = solve(case.problem, case.history[:3], nodes=121, error_bars=True)
    assert 0.0 < result[-1].error_bars["Q"] < 0.01 * result[-1].load["P"]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (CASE.replace("ux = [10e-6, -10e-6]", "Q = [1e5, -1e5]"), 'Q: the force is a reaction where drive = "ux"'),
        (CASE.replace("gauge_radius = 15e-3", "gauge_radius = 5e-3"), "gauge_radius: must be at least the hole radius"),
        (CASE.replace('drive = "ux"\ngauge_radius = 15e-3\nhub_radius = 4e-3', ""), "ux: a displacement can be"),
    ],
)
def test_faults_of_case_files(text, words):
    text = text.replace('csv = "rig.csv"', "P = 1e6")
    with pytest.raises(CaseFileError, match=words) as caught:
        parse_case(text)
    assert len(str(caught.value).splitlines()) == 1


def test_a_plan_varies_drive_and_gauge(tmp_path):
    text = "[grid]\ncontact.gauge_radius = [1e-2, 2e-2]\nload.2.ux = [1e-6, 2e-6]\n"
    plan = planned(tmp_path, CASE.replace('csv = "rig.csv"', "P = 1e6"), text)
    cases = [plan.case(point) for point in plan.points]
    assert len({json.dumps(canonical(case)) for case in cases}) == 4
    assert cases[0].problem.gauge_radius == 1e-2
    assert not {"drive", "gauge_radius"} & set(canonical(parse_case(EXAMPLE)))
