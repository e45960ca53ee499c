"""The stress of the assembly, before any load, and the stress of the loads."""

import math
import pickle
from collections.abc import Callable

import numpy as np
import pytest

from fastpin import Material, MaterialPair, Points, Problem, State, solve
from fastpin.bodies import Bushing, Ring, Tube
from fastpin.model import Laminate, Profile
from fastpin.model.points import elastic_bodies
from fastpin.report.states import hoop_line
from fastpin.states import QUANTITIES
from fastpin.states.quantities import values

STEEL, BRONZE, ALUMINIUM = Material(210e9, 0.3), Material(110e9, 0.34), Material(70e9, 0.33)
PAIR = MaterialPair(STEEL, ALUMINIUM, "stress")
R, SEAT, INTERFERENCE = 0.01, 0.0125, 20e-6
EDGE = Points.at_depth(0.0, np.linspace(-3.0, 3.0, 13))
NODES = 61


def bushed(clearance: float = 60e-6, **fields: object) -> Problem:
    bush = Bushing(BRONZE, SEAT, INTERFERENCE, Ring(0.03, "half"), **fields)  # type: ignore[arg-type]
    return Problem(PAIR, R, clearance, 0.3, plate_body=bush)


def interference(plate: Material = ALUMINIUM, **fields: object) -> Problem:
    return Problem(MaterialPair(STEEL, plate, "stress"), R, -INTERFERENCE, 0.5, **fields)  # type: ignore[arg-type]


def laminate() -> Material:
    """Twice as stiff along x as along y."""
    return Laminate(compliance=(1.0 / 60e9, -0.1 / 60e9, 1.0 / 30e9, 0.0, 0.0, 1.0 / 10e9))


JOINTS: dict[str, Callable[[], Problem]] = {
    "pin": interference,
    "hollow pin in a ring": lambda: interference(pin_body=Tube(0.004), plate_body=Ring(0.02), pin_load="centre"),
    "bonded bush": bushed,
    "slipping bush": lambda: bushed(bonded=False, friction=0.2),
    "pin in a slipping bush": lambda: bushed(-5e-6, bonded=False, friction=0.2),
    "pin in a laminate": lambda: interference(laminate()),
    "pin with a gap": lambda: interference(gap=Profile.lobes(2, 2e-6)),
}


def seats(state: State) -> list[State]:
    return [state] if state.seat is None else [state, state.seat]


@pytest.mark.parametrize("name", JOINTS)
def test_the_stress_of_the_assembly_is_that_of_the_joint_without_loads(name: str) -> None:
    problem = JOINTS[name]()
    loaded = solve(problem, [{"P": 2e5, "Q": 5e4}], nodes=NODES)[-1]
    unloaded = solve(problem, [{}], grid=loaded.grid)[-1]
    for state, other in zip(seats(loaded), seats(unloaded), strict=True):
        for body in elastic_bodies(state.problem):
            expected, peak = other.hoop_stress(body, EDGE.theta), state.peak_hoop_stress(body)
            size = max(np.abs(expected).max(), abs(peak.value))
            assert state.assembly_stress(EDGE, body).hoop == pytest.approx(expected, abs=1e-10 * size)
            here = other.hoop_stress(body, [peak.angle])[0]
            assert (peak.assembly, peak.loads) == pytest.approx((here, peak.value - here), abs=1e-10 * size)


@pytest.mark.parametrize("name", ["pin", "hollow pin in a ring", "pin in a slipping bush", "pin in a laminate"])
def test_kt_is_that_of_the_loads(name: str) -> None:
    """Where nothing opens or slips, it does not depend on the size of the loads."""
    states = [solve(JOINTS[name](), [{"P": size, "Q": 0.3 * size}], nodes=NODES)[-1] for size in (2e4, 1e4)]
    assert all(state.peak_pressure > 1e7 and not state.slipping.any() for state in states)
    for body in elastic_bodies(states[0].problem):
        one, half = (state.peak_hoop_stress(body) for state in states)
        assert one.kt_bearing == pytest.approx(half.kt_bearing, rel=1e-8)
        assert one.most_of_loads == pytest.approx(2.0 * half.most_of_loads, rel=1e-8)


def test_lame_of_an_interference_pin() -> None:
    """In an infinite plate the hoop stress of the hole is the pressure; in the pin it is its negative."""
    state = solve(interference(), [{"P": 2e4}], nodes=NODES)[-1]
    pressure = INTERFERENCE / R / (0.7 / 210e9 + 1.33 / 70e9)
    assert state.assembly_stress(EDGE).hoop == pytest.approx(pressure, rel=1e-12)
    assert state.assembly_stress(EDGE, "pin").hoop == pytest.approx(-pressure, rel=1e-12)
    assert state.assembly_stress(EDGE, "pin").radial == pytest.approx(-pressure, rel=1e-12)


def test_a_bonded_bush_and_one_that_slips_have_the_same_assembly() -> None:
    states = [
        solve(bushed(**fields), [{"P": 2e5}], nodes=NODES)[-1] for fields in ({}, {"bonded": False, "friction": 9.0})
    ]
    peaks = [state.peak_hoop_stress("seat") for state in states]
    assert peaks[0].assembly == pytest.approx(peaks[1].assembly, rel=1e-12)
    assert peaks[0].assembly > 1e7
    assert peaks[0].kt_bearing == pytest.approx(peaks[1].kt_bearing, rel=5e-3)
    within = states[1].seat
    assert within is not None
    assert values(within)["peak_hoop_assembly"] == peaks[1].assembly == values(states[1])["peak_hoop_seat_assembly"]
    again = pickle.loads(pickle.dumps(states[1]))
    assert again.seat.peak_hoop_stress() == peaks[1]


def test_the_seat_knows_the_pin_that_is_pressed_into_its_bush() -> None:
    state = solve(bushed(-5e-6, bonded=False, friction=0.2), [{"P": 1e4}], nodes=NODES)[-1]
    assert state.seat is not None
    assert state.seat.peak_hoop_stress().assembly == state.peak_hoop_stress("seat").assembly
    assert state.peak_hoop_stress("seat").assembly > 1.05 * state.problem.press_fit_pressure


@pytest.mark.parametrize("clearance", [0.0, 20e-6])
def test_a_joint_that_is_not_pressed_has_no_assembly(clearance: float) -> None:
    state = solve(Problem(PAIR, R, clearance, 0.3), [{"P": 2e5}], nodes=NODES)[-1]
    peak = state.peak_hoop_stress()
    assert (peak.assembly, peak.loads) == (0.0, peak.value)
    assert peak.most_of_loads == peak.value
    assert np.array_equal(state.assembly_stress(EDGE).von_mises, np.zeros(13))
    assert all(math.isnan(QUANTITIES[f"peak_hoop_{part}"].of(state)) for part in ("assembly", "loads"))
    assert "assembly" not in hoop_line(state.problem, [state])


def test_the_line_of_an_interference_pin_tells_both() -> None:
    states = solve(interference(), [{"P": 0.0}, {"P": 2e5, "syy": 1e7}], nodes=NODES)
    peak = states[-1].peak_hoop_stress()
    line = hoop_line(states[0].problem, states)
    assert f"it is {peak.assembly / 1e6:.4g} MPa of the assembly + {peak.loads / 1e6:.4g} MPa of the loads" in line
    assert f"Kt of the loads {peak.loads / peak.bearing_stress:.4g} on the bearing stress" in line
    words = line.rsplit("the part of the loads is ", 1)[1].replace("- ", "-").split()
    parts = [float(word) for word in words if word[-1].isdigit()]
    sums = parts[0] * peak.gross_stress + parts[1] * peak.bearing_stress
    assert sums == pytest.approx(peak.loads, rel=5e-3)  # each has four digits
    alone = hoop_line(states[0].problem, states[:1])
    assert alone.endswith("MPa of the assembly + 0 Pa of the loads")
