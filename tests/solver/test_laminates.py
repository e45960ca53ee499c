"""A pin in the hole of a laminate: reference numbers, limits and symmetries."""

import math

import numpy as np
import pytest

from fastpin import MATERIALS, Grid, InputError, Material, MaterialPair, Points, Problem, solve
from fastpin.bodies import Bushing, Plate, Ring
from fastpin.model.angles import BOTTOM
from fastpin.model.doubts import doubts
from fastpin.verification.interference import uniform_pressure
from tests.support.checks.laminate_rows import laminate
from tests.support.checks.sliding import solve_sliding
from tests.support.laminates import RIGID, ROWS, STEEL, TURNED, orthotropic
from tests.support.once import solve_once
from tests.support.tiers import some_gate

ALL_LOADS = [{"P": 1.0}, {"Q": 0.3}, {"sxx": 0.2, "sxy": -0.1}, {"Q": -0.3, "syy": 0.1}, {"P": 0.5}]

NODES = 801


@pytest.mark.parametrize("name", some_gate(ROWS, "A2", "A3", "A9", "A10", "A12", "A15", "A16", "A17", "A18", "A19"))
def test_reference_numbers(name):
    """Those of 1,601 nodes. Sticking ends of the reference were read with the exponents of an isotropic plate."""
    row = ROWS[name]
    state = solve(row.problem(), row.history, nodes=NODES)[-1]
    assert state.peak_pressure == pytest.approx(row.peak, rel=1e-5)
    assert float(state.grid.weights @ state.pressure) == pytest.approx(row.total, rel=1e-5)
    assert np.array(state.contact[0]) - BOTTOM == pytest.approx(np.array(row.contact), abs=1e-4)
    if row.stick is not None:
        allowed = 2.5e-3 if name == "A17" else 6e-4
        assert np.array(state.stick[0]) - BOTTOM == pytest.approx(np.array(row.stick), abs=allowed)
    if row.hoop is not None:
        assert state.peak_hoop_stress().value == pytest.approx(row.hoop, rel=4e-4)


def test_peaks_of_a_history_with_reversals():
    row = ROWS["A17"]
    states = solve(row.problem(), row.history, nodes=401)
    assert [state.peak_pressure for state in states] == pytest.approx(
        [0.608068, 0.606376, 0.822529, 0.608485], rel=1e-4
    )
    assert [state.rotation for state in states] == pytest.approx([0.008308, -0.032320, 0.069680, -0.034348], rel=3e-4)


@pytest.mark.parametrize("drive", ["force", "ux"])
@pytest.mark.parametrize("clearance", [0.1, -0.3])
def test_an_isotropic_laminate_is_the_material(drive, clearance):
    history = [{"P": 1.0}, {"Q": 0.3}, {"sxx": 0.2, "sxy": 0.1}, {"P": 0.3, "Q": 0.0}]
    if drive == "ux":
        history = [{"P": 1.0}, {"ux": 0.1}, {"ux": -0.1, "sxx": 0.2}]
    states = [
        solve(
            Problem.from_load_parameter(MaterialPair(STEEL, plate, "stress"), clearance, 0.3, drive=drive),
            history, grid=Grid.circle(120),
        )[-1]
        for plate in (Material(70e9, 0.3), orthotropic(1.0, 1.0 / 2.6, axis=0.7).scaled(70e9))
    ]  # fmt: skip
    one, other = states
    for name in ("pressure", "shear", "gap", "slip"):
        assert getattr(one, name) == pytest.approx(getattr(other, name), abs=1e-12)
    assert one.peak_hoop_stress().value == pytest.approx(other.peak_hoop_stress().value, rel=1e-11)
    assert one.joint_displacement(0.5, 3.0) == pytest.approx(other.joint_displacement(0.5, 3.0), rel=1e-11)


@pytest.mark.parametrize("turns", [1, 2, 3])
def test_laminate_and_loads_turned_by_quarters(turns):
    """The same numbers at turned nodes; a slip counts from the first contact, which turns as well."""
    angle = 0.5 * math.pi * turns
    turn = complex(math.cos(angle), math.sin(angle))

    def turned(corner):
        force = complex(corner.get("Q", 0.0), -corner.get("P", 0.0)) * turn
        a, b, c = (corner.get(name, 0.0) for name in ("sxx", "syy", "sxy"))
        a, b, c = (b, a, -c) if turns % 2 else (a, b, c)
        return {"Q": force.real, "P": -force.imag, "sxx": a, "syy": b, "sxy": c}

    history, whole = [], {}
    for corner in ALL_LOADS:
        whole = whole | corner
        history.append(dict(whole))
    one, other = (
        solve(
            Problem.from_load_parameter(MaterialPair(STEEL, plate, "stress"), 0.2, 0.3),
            loads, grid=Grid.circle(120),
        )[-1]
        for plate, loads in ((TURNED, history), (TURNED.turned(angle), [turned(corner) for corner in history]))
    )  # fmt: skip
    for name in ("pressure", "shear", "gap"):
        assert np.roll(getattr(other, name), -30 * turns) == pytest.approx(getattr(one, name), abs=1e-12)
    assert other.rotation == pytest.approx(one.rotation, abs=1e-13)


@pytest.mark.gate
@pytest.mark.parametrize("nodes", [101, 601, 1201])
def test_dense_stored_and_unstored_ways_agree(nodes):
    """101 nodes hold their contacts; 601 have a dense operator, 1,201 none."""
    state = solve_once(ROWS["A12"].problem(), [{"P": 1.0}, {"Q": 0.2}], nodes=nodes)[-1]
    assert state.peak_pressure == pytest.approx(0.689, rel=0.2)
    finest = solve_once(ROWS["A12"].problem(), [{"P": 1.0}, {"Q": 0.2}], nodes=1201)[-1]
    assert state.peak_pressure == pytest.approx(finest.peak_pressure, rel=20.0 / nodes**2 * 101)
    assert max(state.residuals.values()) < 1e-12


def test_a_free_pin_turns_under_a_force_alone():
    state = solve(ROWS["A12"].problem(), [{"P": 1.0}], nodes=201)[-1]
    assert abs(state.rotation) > 1e-3
    start, stop = np.array(state.contact[0]) - BOTTOM
    assert stop > -start + 0.1


def test_remote_stress_before_the_first_contact_opens_the_hole_as_its_ellipse():
    """The gap that is left and the numbers of the tensor W."""
    plate = TURNED
    problem = Problem.from_load_parameter(MaterialPair(RIGID, plate, "stress"), 1.0, 0.3)
    state = solve(problem, [{"sxx": 0.3, "sxy": 0.1}], grid=Grid.circle(60))[-1]
    laminate_ = problem.joint.hole.laminate
    mean, oval = laminate_.hole_displacement((0.3, 0.0, 0.1))
    moved = (mean + oval * np.exp(-2j * state.theta)) / problem.surfaces.beta_star
    assert state.gap == pytest.approx(1.0 + moved.real, abs=1e-14)


@pytest.mark.gate
def test_exponents_of_edges_and_borders():
    """With them 201 nodes agree with 801; in a history with reversals, at edges and borders of either sign of slip."""
    problem = Problem.from_load_parameter(MaterialPair(STEEL, TURNED, "stress"), 0.1, 0.5, "body")
    coarse, fine = (solve(problem, [{"P": 1.0}], nodes=nodes)[-1] for nodes in (201, 801))
    spacing = coarse.grid.weights[1]
    assert coarse.coupling.tilt[1] != pytest.approx(coarse.coupling.tilt[-1], abs=1e-3)
    for name in ("contact", "stick"):
        assert getattr(coarse, name)[0] == pytest.approx(getattr(fine, name)[0], abs=0.01 * spacing)
    assert coarse.peak_hoop_stress().value == pytest.approx(fine.peak_hoop_stress().value, rel=3e-4)


@pytest.mark.parametrize(
    ("field", "words", "make"),
    [
        ("plate_body", "infinite", lambda pair: Problem(pair, 0.01, 0.0, 0.3, plate_body=Ring(0.03))),
        ("plate_body", "infinite", lambda pair: Problem(pair, 0.01, 0.0, 0.3, plate_body=Plate((0.03, 0.0)))),
        (
            "plate_body", "infinite",
            lambda pair: Problem(pair, 0.01, 0.0, 0.3, plate_body=Bushing(MATERIALS["steel"], 0.012)),
        ),
        ("material", "isotropic", lambda pair: Bushing(pair.plate, 0.012)),
        ("pin", "isotropic", lambda pair: MaterialPair(pair.plate, pair.pin)),
        ("gauge_radius", "laminate", lambda pair: Problem(pair, 0.01, 0.0, 0.3, drive="ux", gauge_radius=0.02)),
        ("plate", "laminate", lambda pair: uniform_pressure(Problem(pair, 0.01, -1e-5, 0.3))),
        ("plate", "laminate", lambda pair: solve_sliding(Problem(pair, 0.01, 1e-5, 0.3), {"P": 1e5})),
    ],
)  # fmt: skip
def test_what_is_refused(field, words, make):
    pair = MaterialPair(MATERIALS["steel"], laminate((0.0,), 90.0), "stress")
    with pytest.raises(InputError, match=words) as caught:
        make(pair)
    assert caught.value.field == field


def test_friction_beyond_which_slip_is_not_unique_is_doubted():
    steel = MATERIALS["steel"]
    pair = MaterialPair(steel, Material(1e9, 0.3), "stress")
    for plate, friction, doubted in ((laminate((0.0,), 90.0), 1.0, False), (laminate((0.0,), 90.0), 1.7, True)):
        problem = Problem(MaterialPair(steel, plate, "stress"), 0.01, 1e-5, friction)
        words = [str(doubt) for doubt in doubts(problem) if doubt.field == "friction"]
        assert any("several solutions" in each for each in words) == doubted
    assert not any("several" in str(doubt) for doubt in doubts(Problem(pair, 0.01, 1e-5, 1.9)))


def test_the_plane_is_that_of_the_pin():
    """A pin in plane strain is one in plane stress with other constants."""
    strain = Material(210e9, 0.3)
    stress = Material(210e9 / (1.0 - 0.09), 0.3 / 0.7)
    one, other = (
        solve(Problem.from_load_parameter(MaterialPair(pin, TURNED, plane), 0.1, 0.3), [{"P": 1.0}], nodes=101)[-1]
        for pin, plane in ((strain, "strain"), (stress, "stress"))
    )
    assert one.pressure == pytest.approx(other.pressure, abs=1e-12)
    assert one.stress(Points.at_depth(0.1, 0.3)).axial == 0.0
