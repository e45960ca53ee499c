"""Extremes over all kept states equal the readings of each state, and few states are read."""

import math
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import fastpin
from fastpin import MATERIALS, InputError, LoadHistory, Material, MaterialPair, Problem, Result, State, storage
from fastpin.bodies import Bushing, Ring
from fastpin.elasticity.stress import plate_stress, seat_stress
from fastpin.elasticity.tractions import Tractions
from fastpin.model.ties import TIE
from fastpin.states import extremes, reading_bounds
from fastpin.states.extremes import MARKS, READINGS, KeptStates, marked_extremes, marked_places
from fastpin.states.reading_bounds import NUMBERS
from fastpin.states.stress_map import StressMap
from tests.support.samples import sample_result
from tests.support.tiers import gate, seeds, some_gate
from tests.survey.histories import GENERATORS, generate

STEEL, ALUMINIUM = MATERIALS["steel"], MATERIALS["aluminium"]

LUG = Bushing(MATERIALS["C93200"], 0.0125, 3e-5, inside=Ring(0.025, "half"))

JOINTS = {
    "like": Problem(MaterialPair(STEEL, STEEL), 0.01, 1e-5, 0.5),
    "unlike": Problem(MaterialPair(STEEL, ALUMINIUM), 0.01, 2e-5, 0.3, "body"),
    "fit": Problem(MaterialPair(ALUMINIUM, STEEL), 0.01, -1e-5, 0.2, rotation="fixed"),
    "frictionless": Problem(MaterialPair(STEEL, ALUMINIUM), 0.01, 2e-5, 0.0),
    "bush": Problem(MaterialPair(STEEL, MATERIALS["7075-T6"]), 0.01, 4e-5, 0.2, plate_body=LUG),
    "bush that slips": Problem(
        MaterialPair(STEEL, MATERIALS["7075-T6"]), 0.01, 4e-5, 0.2,
        plate_body=replace(LUG, friction=0.15, bonded=False),
    ),
    "rigid plate": Problem(MaterialPair(STEEL, Material.rigid()), 0.01, 2e-5, 0.2),
}  # fmt: skip


def random_history(corners: int, seed: int = 1) -> LoadHistory:
    """Forces up to 3 MN/m downwards and 0.5 MN/m sideways; every fifth corner has no load."""
    rng = np.random.default_rng(seed)
    loads = [{"P": rng.uniform(1e5, 3e6), "Q": rng.uniform(-5e5, 5e5)} for _ in range(corners)]
    return LoadHistory([{"P": 0.0, "Q": 0.0} if k % 5 == 4 else load for k, load in enumerate(loads)])


MAPPED = 8
"""Number of different states from which on these tests compute stresses by matrices."""


@pytest.fixture(autouse=True)
def _few_states_are_many(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(reading_bounds, "MAPPED", MAPPED)


@pytest.fixture(scope="module", params=some_gate(JOINTS, "bush", "bush that slips"))
def result(request: pytest.FixtureRequest) -> Result:
    return fastpin.solve(JOINTS[request.param], random_history(MAPPED + 2), nodes=41)


@pytest.fixture
def readings(monkeypatch: pytest.MonkeyPatch) -> Iterator[list[str]]:
    """The names of the quantities that are read, in order."""
    read: list[str] = []
    for name, each in READINGS.items():
        monkeypatch.setitem(
            READINGS, name, each._replace(of=lambda state, name=name, of=each.of: read.append(name) or of(state))
        )
    return read


def test_extremes_are_the_readings_of_all_states(result: Result) -> None:
    found = result.extremes()
    for name, each in READINGS.items():
        values = np.array([each.of(state) for state in result])
        if np.isnan(values).all():
            assert name not in found
            continue
        for extreme, away in zip(found[name], (values, -values), strict=True):
            least = np.nanmin(away)
            assert extreme.place == np.flatnonzero(away <= least + TIE * abs(least))[0], name
            assert values[extreme.place] == extreme.value
            assert extreme.load_point == result[extreme.place].step + 1


def check_bounds(result: Result) -> None:
    names = {name for name in READINGS if READINGS[name].exists(result.problem)} - {"seat_slip", *NUMBERS}
    bounds = reading_bounds.Bounds(result.problem, result.grid, names)
    for block in KeptStates(result.states).blocks():
        bounds.add(block, list(range(len(block.pressure))))
    for name, (low, high) in bounds.found().items():
        values = np.array([READINGS[name].of(state) for state in result])
        assert np.all((low <= values) & (values <= high) | np.isnan(values)), name


def test_readings_lie_within_their_bounds(result: Result) -> None:
    check_bounds(result)


@pytest.mark.parametrize("plate", ["steel", *gate("aluminium")])
def test_cusps_at_edges_and_borders_lie_within_the_bounds(plate: str) -> None:
    """The corners leave borders in the stick zone. Straight lines and nodes have less stress and shear there."""
    pair = MaterialPair(STEEL, MATERIALS[plate])
    problem = Problem.from_load_parameter(pair, 0.05, 0.55, "body", "free")
    forces = np.random.default_rng(2).uniform(-0.275, 0.275, 10)
    check_bounds(fastpin.solve(problem, [{"P": 1.0, "Q": force} for force in forces], nodes=101))


@pytest.mark.gate
def test_readings_of_random_states_lie_within_their_bounds(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(reading_bounds, "MAPPED", 0)
    kinds = [kind for kind in GENERATORS if kind != "wear"]
    for seed in seeds(5):
        case = generate(kinds[seed % len(kinds)], seed)
        check_bounds(fastpin.solve(case.problem, case.history, **case.options))


@pytest.mark.gate
def test_few_states_are_read(readings: list[str]) -> None:
    corners = [{"P": 3e6 if k == 17 else 1e6 + 1e4 * k} for k in range(40)]
    joint = replace(JOINTS["bush"], pair=MaterialPair(replace(STEEL, yield_strength=3e8), MATERIALS["7075-T6"]))
    found = marked_extremes(KeptStates(fastpin.solve(joint, corners, nodes=61).states))
    assert found.keys() == {pair for pair in MARKS if READINGS[pair[0]].exists(joint)}
    assert {pair[0] for pair, extreme in found.items() if extreme.place != 17} <= {"von_mises_bush"}
    assert max(readings.count(name) for name in readings) <= 3


def test_stresses_of_hat_functions_add_up(result: Result) -> None:
    if result.problem.surfaces.plate.is_rigid or result.problem.seat is not None:
        return  # the stress of a joint whose bush slips also depends on the tractions in its seat
    theta = np.linspace(-3.0, 3.0, 17)
    bushed = isinstance(result.problem.plate_body, Bushing)

    def of(tractions: list[Tractions], remote: np.ndarray) -> np.ndarray:
        found = plate_stress(result.problem, tractions[0], remote, theta, np.zeros(17))
        seat = theta[: 5 * bushed]
        return np.c_[found, seat_stress(result.problem, tractions[0], remote, seat, np.zeros(5))] if bushed else found

    stress = StressMap(result.problem, [result.grid], of)
    pressure, shear = (np.array([getattr(state, name) for state in result[:6]]) for name in ("pressure", "shear"))
    remote = np.zeros((6, 4))
    stress.learn([(pressure, shear)])
    hoop = stress.component(1, [(pressure, shear)], remote)
    known = np.array([state.hoop_stress("plate", theta, straight=True) for state in result[:6]])
    if bushed:
        known = np.c_[known, [state.hoop_stress("seat", theta[:5], straight=True) for state in result[:6]]]
    assert np.abs(hoop - known).max() < 1e-9 * max(np.abs(known).max(), pressure.max())


def test_equal_states_are_read_once(readings: list[str]) -> None:
    state = fastpin.solve(JOINTS["like"], [{"P": 1e6}], nodes=61)[0]
    copies = [replace(state, step=step, dissipation=0.1 * step) for step in range(200)]
    found = extremes.all_extremes(KeptStates(copies))
    assert found["peak_hoop"].largest.place == 0
    assert found["dissipation"].largest == (0.1 * 199, 199, 200.0)
    assert max(readings.count(name) for name in readings) == 2  # the smallest, and the largest


@pytest.mark.gate
def test_states_that_differ_in_the_seat_only_are_both_read() -> None:
    state = fastpin.solve(JOINTS["bush that slips"], [{"P": 1e6}], nodes=61)[0]
    pressed = replace(state.seat, pressure=2.0 * state.seat.pressure)
    states = [state, replace(state, step=1, seat=pressed)]
    found = extremes.all_extremes(KeptStates(states))
    for name in ("bush_open_margin", "peak_hoop_seat", "peak_hoop", "von_mises_plate"):
        values = [READINGS[name].of(each) for each in states]
        assert values[0] != values[1]
        assert (found[name].smallest.value, found[name].largest.value) == (min(values), max(values))


def test_the_seat_has_extremes_of_its_own(result: Result) -> None:
    seat = result.seat
    if seat is None:
        return
    found = seat.extremes()
    for name in ("peak_pressure", "peak_shear", "peak_hoop", "stick_width", "rotation"):
        values = [READINGS[name].of(state) for state in seat]
        assert (found[name].smallest.value, found[name].largest.value) == (min(values), max(values))


@pytest.mark.gate
def test_stored_states_of_a_bush_that_slips_have_the_same_extremes(tmp_path: Path) -> None:
    path = tmp_path / "run.h5"
    result = fastpin.solve(JOINTS["bush that slips"], random_history(6), nodes=61)
    result.save(path)
    found = marked_extremes(KeptStates(result.states))
    assert storage.StoredResult(path).extremes == found
    slips = [state.seat.peak_slip for state in result if state.seat is not None]
    assert abs(found["seat_slip", "largest magnitude"].value) == np.abs(slips).max() > 0.0


def test_the_states_of_extremes_have_words() -> None:
    corners = [{"P": 3e6 if k == 7 else 1e6} for k in range(10)]
    found = marked_extremes(KeptStates(fastpin.solve(JOINTS["like"], corners, nodes=61).states))
    assert marked_places(found) == {7: "largest pressure, largest shear, largest hoop stress"}


def test_a_result_without_states_has_no_extremes() -> None:
    assert replace(sample_result(), states=[]).extremes() == {}


def test_states_on_another_grid_are_refused() -> None:
    one, other = sample_result(), sample_result(nodes=61)
    with pytest.raises(InputError, match="grid of the result"):
        replace(one, states=[*one, *other]).extremes()


@pytest.mark.gate
def test_a_bonded_bush_has_no_margin_of_slip() -> None:
    found = fastpin.solve(JOINTS["bush"], random_history(8), nodes=61).extremes()
    assert "bush_slip_margin" not in found
    assert math.isfinite(found["bush_open_margin"].smallest.value)
    assert found["bush_least_friction"].largest.value > 0.0


def test_states_without_contact_have_extremes() -> None:
    empty = fastpin.solve(JOINTS["like"], [{"P": 0.0}], nodes=61)
    assert isinstance(empty[0], State)
    assert empty.extremes()["peak_pressure"].largest == (0.0, 0, 1.0)
