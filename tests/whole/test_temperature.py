"""Temperatures: press fits in closed form, held bodies, remote stress that widens alike, paths, bushes, bad input."""

import numpy as np
import pytest

import fastpin
from fastpin import Grid, InputError, Material, MaterialPair, Problem, solve
from fastpin.bodies import Bushing, Compliance, Ring, Tube
from fastpin.damage import stress_history
from fastpin.model import Laminate
from fastpin.model.loads import TEMPERATURE
from tests.support.tiers import seeds
from tests.survey.conditions import TOLERANCE, check_states

STEEL = Material(210e9, 0.3, expansion=12e-6)
ALUMINIUM = Material(72e9, 0.33, expansion=23.6e-6)
STIFF = Material(np.inf, 0.3, expansion=12e-6)
PAIR = MaterialPair(STEEL, ALUMINIUM, "stress")
RADIUS = 10e-3


def joint(friction=0.3, clearance=10e-6, pair=PAIR, **bodies):
    return Problem(pair, hole_radius=RADIUS, clearance=clearance, friction=friction, **bodies)


def lame(problem):
    """Coefficients (a, b) of u_r = a r + b/r, m/K, and 2G, Pa, of bush and plate: no tractions but of their supports.

    The equations are those of Lame with thermal strains, one after the other; lengths in m.
    """
    plate, bush = problem.plate_body, problem.plate_body.bush
    lug, seat = plate.lug, RADIUS if bush is None else bush.outer_radius
    walls = [] if bush is None else [(bush.material, RADIUS)]
    walls.append((problem.pair.plate, seat))
    rows, right, size = [], [], 2 * len(walls)

    def of(wall, radius):
        """Rows of u and s_rr, and the stress by the strain e; the ends of a plane strain are free."""
        material = walls[wall][0]
        kappa, shear = material.kolosov(problem.pair.plane), material.shear_modulus
        bulk = 2.0 * shear * 2.0 / (kappa - 1.0)
        u, stress = np.zeros((2, size))
        u[2 * wall : 2 * wall + 2] = radius, 1.0 / radius
        stress[2 * wall : 2 * wall + 2] = bulk, -2.0 * shear / radius**2
        return u, stress, bulk * material.expansion

    _, stress, thermal = of(0, RADIUS)
    rows, right = [stress], [thermal]
    if bush is not None:
        (one, inner, first), (other, outer, second) = of(0, seat), of(1, seat)
        rows += [one - other, inner - outer]
        right += [0.0, first - second]
    last = len(walls) - 1
    if not np.isfinite(lug.outer_radius):
        rows.append(np.eye(size)[2 * last])
        right.append(walls[last][0].expansion)
    else:
        u, stress, thermal = of(last, lug.outer_radius)
        rows.append(u if lug.support == "held" else stress)
        right.append(0.0 if lug.support == "held" else thermal)
    found = np.linalg.solve(np.array(rows), np.array(right)).reshape(-1, 2)
    return (
        found,
        [2.0 * material.shear_modulus for material, _ in walls],
        [each[2] for each in map(of, [0, last], [1, 1])],
    )


def growth(problem, state):
    """Growth of the gap, m: displacement of the hole less that of the pin, which expands freely."""
    warm, more = state.load["temperature"], state.load["pin_temperature"]
    (a, b), *_ = lame(problem)[0]
    return (a * RADIUS + b / RADIUS) * warm - RADIUS * problem.pair.pin.expansion * (warm + more)


def check(result):
    """Check all states by conditions that are recomputed without the matrices of the solver."""
    theta = result.grid.theta
    grown = [np.full(theta.size, growth(result.problem, state)) for state in result]
    for state in check_states(result.states, grown):
        del state["balance"]  # of second order in the distance of nodes
        assert max(state.values()) < TOLERANCE, state


@pytest.mark.parametrize(
    ("bodies", "pressure"),
    [
        ({}, 33.936306e6),
        ({"pin_body": Tube(5e-3)}, 29.623511e6),
        ({"plate_body": Ring(25e-3, "uniform")}, 27.309739e6),
        ({"pin_body": Tube(5e-3), "plate_body": Ring(25e-3, "uniform")}, 24.445707e6),
    ],
    ids=["solid", "hollow pin", "ring", "both"],
)
def test_a_loose_pin_that_cools_becomes_a_press_fit(bodies, pressure):
    """The pressures of Lame with the clearance -7.4 um: 10 um less 17.4 um by 150 K."""
    state = solve(joint(**bodies), [{"temperature": -150.0}], nodes=41)[-1]
    assert state.pressure == pytest.approx(pressure, rel=1e-7)
    fitted = solve(joint(clearance=-7.4e-6, **bodies), [{}], nodes=41)[-1]
    assert state.pressure == pytest.approx(fitted.pressure, rel=1e-12)


def test_the_temperature_of_the_pin_alone():
    grown = RADIUS * STEEL.expansion * 120.0
    warm = solve(joint(clearance=2e-6), [{"pin_temperature": 120.0}], nodes=41)[-1]
    assert warm.pressure == pytest.approx(solve(joint(clearance=2e-6 - grown), [{}], nodes=41)[-1].pressure, rel=1e-12)


HINDERED = {
    "held ring": {"plate_body": Ring(25e-3, "held")},
    "bonded bush": {"plate_body": Bushing(STEEL, 14e-3)},
    "bush in a ring": {"plate_body": Bushing(STEEL, 14e-3, 4e-6, Ring(30e-3, "half"))},
    "bush in a held ring": {"plate_body": Bushing(STEEL, 14e-3, 4e-6, Ring(30e-3, "held"))},
}


@pytest.mark.parametrize("plane", ["stress", "strain"])
@pytest.mark.parametrize("name", HINDERED)
def test_bodies_that_hinder_one_another_are_those_of_lame(name, plane):
    problem = joint(clearance=-10e-6, pair=MaterialPair(STEEL, ALUMINIUM, plane), **HINDERED[name])
    cold, warm = solve(problem, [{}, {"temperature": 40.0}], nodes=41)
    grown = growth(problem, warm)
    fitted = solve(joint(clearance=-10e-6 + grown, pair=problem.pair, **HINDERED[name]), [{}], nodes=41)[-1]
    assert abs(grown) > 1e-6
    assert warm.pressure == pytest.approx(fitted.pressure, rel=1e-9)
    coefficients, twice_shear, thermal = lame(problem)
    seat = problem.joint.seat_ratio * RADIUS
    for radius in (RADIUS, 13.9e-3, 14.1e-3, 24.9e-3):
        wall = -1 if radius > seat else 0
        (a, b), shear, by_strain = coefficients[wall], twice_shear[wall], thermal[wall]
        kappa = (problem.pair.plate if wall or seat == RADIUS else STEEL).kolosov(plane)
        uniform, decaying = 40.0 * (shear * 2.0 / (kappa - 1.0) * a - by_strain), 40.0 * shear * b / radius**2
        place = fastpin.Points.at_depth(radius - RADIUS, 0.3)
        found, other = warm.stress(place), fitted.stress(place)
        assert found.radial - other.radial == pytest.approx(uniform - decaying, abs=1e-6 * warm.peak_pressure)
        assert found.hoop - other.hoop == pytest.approx(uniform + decaying, abs=1e-6 * warm.peak_pressure)
    assert cold.pressure.max() != warm.pressure.max()


def test_a_held_ring_closes_when_it_is_warm():
    """Its factor for nu = 0.33 and a rim at 2.5 radii: 1 - 2 b^2/((b^2 + R^2) - nu (b^2 - R^2)) = -1.26552."""
    (a, b), *_ = lame(joint(**HINDERED["held ring"]))[0]
    assert (a + b / RADIUS**2) / ALUMINIUM.expansion == pytest.approx(-1.26552, abs=5e-6)


def test_a_bush_that_expands_as_its_plate_is_not_seen():
    alike, plain = joint(plate_body=Bushing(ALUMINIUM, 15e-3)), joint()
    history = [{"P": 1e6}, {"temperature": -120.0}, {"Q": 3e5}]
    for one, other in zip(*(solve(each, history, grid=Grid.circle(41)) for each in (alike, plain)), strict=True):
        assert one.pressure == pytest.approx(other.pressure, abs=1e-9 * other.peak_pressure)
        assert one.hoop_stress("plate", [0.3]) == pytest.approx(other.hoop_stress("plate", [0.3]), rel=1e-8)


def test_stresses_of_many_states_count_the_temperature():
    """A product with a matrix gives the stresses of many states: those of each state alone."""
    problem = joint(plate_body=Ring(25e-3, "held"))
    history = [{"P": 1e6}, *({"temperature": float(3 * k)} for k in range(-40, 0))]
    states, points = solve(problem, history, nodes=31).states, fastpin.Points.at_depth(0.0, np.linspace(-2.0, 0.0, 5))
    found = stress_history(states, points, "plate", straight=True)
    for state, each in zip(states, found, strict=True):
        assert each[:, 2] == pytest.approx(0.0)
        alone = state.stress(points, "plate", straight=True)
        assert each[:, 0] == pytest.approx(alone.sxx, abs=1e-9 * np.abs(alone.hoop).max())


def test_the_temperature_of_the_pin_needs_its_coefficient_only():
    bare = MaterialPair(STEEL, Material(72e9, 0.33), "stress")
    one, other = (
        solve(joint(pair=each), [{"P": 1e6}, {"pin_temperature": 50.0}], nodes=31)[-1] for each in (bare, PAIR)
    )
    assert np.array_equal(one.pressure, other.pressure)
    with pytest.raises(InputError, match="pin_temperature: needs the coefficient of thermal expansion of the pin"):
        solve(joint(pair=MaterialPair(Material(210e9, 0.3), ALUMINIUM)), [{"pin_temperature": 50.0}], nodes=31)


def test_a_uniform_remote_stress_widens_the_hole_alike():
    """In an infinite plate (sxx = syy = s) moves the hole outwards by 2 s R / E: any history has the same contact."""
    warm = [
        {"P": 1e6, "temperature": 0.0}, {"temperature": -50.0}, {"Q": 2e5}, {"temperature": -120.0},
        {"P": 0.0, "Q": 0.0}, {"P": 5e5, "Q": 2e5}, {"temperature": 30.0},
    ]  # fmt: skip
    factor = 0.5 * ALUMINIUM.E * (ALUMINIUM.expansion - STEEL.expansion)
    pulled = [dict(each) for each in warm]
    for each in pulled:
        if "temperature" in each:
            each["sxx"] = each["syy"] = factor * each.pop("temperature")
    grid = Grid.circle(61)
    for one, other in zip(solve(joint(), warm, grid=grid), solve(joint(), pulled, grid=grid), strict=True):
        for name in ("pressure", "shear", "gap", "slip"):
            found, expected = getattr(one, name), getattr(other, name)
            assert np.abs(found - expected).max() <= 1e-11 * np.abs(expected).max(), name
        assert np.array_equal(one.status, other.status)
        assert one.dissipation == pytest.approx(other.dissipation, rel=1e-10, abs=1e-12)


def random_history(rng, corners=5):
    """Corners with temperatures at which the joint is loose, tight or neither, under a force that never vanishes."""
    return [
        {
            "P": float(rng.uniform(2e5, 2e6)),
            "Q": float(rng.uniform(-3e5, 3e5)),
            "temperature": float(rng.uniform(-200.0, 100.0)),
            "pin_temperature": float(rng.uniform(-40.0, 60.0)),
        }
        for _ in range(corners)
    ]


def test_random_histories_meet_the_conditions_of_contact():
    bodies = [{}, HINDERED["held ring"], HINDERED["bush in a ring"], {"pin_body": Tube(4e-3)}, HINDERED["bonded bush"]]
    bodies += [{"plate_body": Ring(30e-3, "half")}, HINDERED["bush in a held ring"]]
    for seed in seeds(30):
        rng = np.random.default_rng(seed)
        problem = joint(float(rng.uniform(0.1, 0.8)), float(rng.uniform(-1e-5, 3e-5)), **bodies[seed % len(bodies)])
        check(solve(problem, random_history(rng), nodes=31, arc=(-1.5 * np.pi, 0.5 * np.pi)))


def test_without_friction_only_the_end_of_a_path_counts():
    for seed in seeds(20):
        rng = np.random.default_rng(seed)
        last, grid = {"P": 1e6, "Q": 2e5, "temperature": -40.0, "pin_temperature": 10.0}, Grid.circle(31)
        bodies = [{}, *HINDERED.values()][seed % (1 + len(HINDERED))]
        one, other = (solve(joint(0.0, **bodies), [*random_history(rng, 3), last], grid=grid)[-1] for _ in range(2))
        assert np.abs(one.pressure - other.pressure).max() < 1e-10 * one.peak_pressure


def test_energies_leave_out_what_bodies_that_expand_freely_do_not_store():
    """A press fit made by cooling stores the energy of the same press fit that was driven in."""
    cooled = solve(joint(0.0), [{"temperature": -150.0}], nodes=41)[-1]
    driven = solve(joint(0.0, -7.4e-6), [{}], nodes=41)[-1]
    assert cooled.energy == pytest.approx(driven.energy, rel=1e-10)
    assert cooled.work == pytest.approx(cooled.energy, rel=1e-10)


@pytest.mark.parametrize("bodies", [{}, HINDERED["held ring"]], ids=["free", "held ring"])
def test_work_is_energy_and_dissipation_to_second_order(bodies):
    history, lost = random_history(np.random.default_rng(4)), []
    for nodes in (31, 61):
        last = solve(joint(0.4, 1e-5, **bodies), history, nodes=nodes, arc=(-1.5 * np.pi, 0.5 * np.pi))[-1]
        lost.append(abs(last.work - last.energy - last.dissipation) / last.dissipation)
    assert lost[0] < 0.05
    assert 3.0 < lost[0] / lost[1] < 5.0


BUSH = Material(210e9, 0.3, expansion=11.7e-6)
BUSHED = Problem(
    MaterialPair(BUSH, Material(70e9, 0.33, expansion=23e-6), "stress"),
    hole_radius=7e-3,
    clearance=20e-6,
    friction=0.1,
    plate_body=Bushing(BUSH, 10e-3, 10e-6, Ring(30e-3, "half"), friction=0.15, bonded=False),
)


@pytest.mark.parametrize(("rise", "pressure"), [(-60.0, 47.8675e6), (40.0, 15.6325e6), (80.0, 2.7385e6)])
def test_a_bush_is_held_by_less_when_the_plate_expands_more(rise, pressure):
    state = solve(BUSHED, [{"temperature": rise}], nodes=25)[-1]
    assert not state.in_contact
    assert state.seat.pressure == pytest.approx(pressure, rel=2e-4)


@pytest.mark.gate
def test_a_bush_gets_loose_and_tight_again():
    """It is loose from 88.5 K on. Then it carries the pin on one side, as a bush with that clearance from the start."""
    history = [{"P": 3e5}, {"temperature": 120.0}, {"temperature": 0.0}, {"P": 0.0}]
    result = solve(BUSHED, history, nodes=61)
    assert not np.all(result[1].seat.status)
    assert np.all(result[2].seat.pressure > 0.0)
    assert max(max(state.residuals.values()) for state in result) < 1e-9
    assert result[3].seat.pressure.mean() == pytest.approx(28.5265e6, rel=1e-3)


def test_a_bush_that_nothing_holds_is_reported():
    with pytest.raises(fastpin.NoEquilibriumError, match="nothing holds the bush in its seat"):
        solve(BUSHED, [{"temperature": 120.0}], nodes=25)


def with_expansion(value):
    return MaterialPair(Material(210e9, 0.3, expansion=value), ALUMINIUM, "stress")


@pytest.mark.parametrize(
    ("problem", "words"),
    [
        (joint(pair=MaterialPair(Material(210e9, 0.3), ALUMINIUM)), "thermal expansion of the pin: its key"),
        (joint(pair=MaterialPair(STEEL, Material(72e9, 0.33))), "thermal expansion of the plate: its key"),
        (joint(pair=MaterialPair(STEEL, STIFF, "stress"), plate_body=Ring(25e-3)), "a rigid ring can't expand"),
        (joint(plate_body=Bushing(Material(210e9, 0.3), 15e-3)), "thermal expansion of the bush: its key"),
        (joint(plate_body=Compliance(0.33, "stress", RADIUS, np.zeros((10, 10)))), "has no column of the temperature"),
        (joint(pair=MaterialPair(STEEL, Laminate.from_moduli(70e9, 70e9, 26e9, 0.3), "stress")), "a laminate has no"),
        (Problem.from_load_parameter(PAIR, 0.1, 0.4), "has no meaning with load_parameter"),
        (joint(pair=with_expansion(9e-4)), "strain the pin by 0.18"),
    ],
)  # fmt: skip
def test_what_a_temperature_needs_is_said(problem, words):
    with pytest.raises(InputError, match=words) as refused:
        solve(problem, [{"P": 1.0}, {"temperature": 200.0}], nodes=31)
    assert refused.value.field == "temperature"


@pytest.mark.parametrize("value", [2e-3, float("nan"), "12e-6"])
def test_a_coefficient_of_expansion_is_checked(value):
    with pytest.raises(InputError, match="expansion"):
        Material(210e9, 0.3, expansion=value)


CASE = """
[pin]
E = 210e9
nu = 0.3
expansion = 12e-6
[plate]
E = 72e9
nu = 0.33
expansion = 23.6e-6
[contact]
plane = "stress"
hole_radius = 10e-3
clearance = 10e-6
friction = 0.3
[[load]]
P = 1e6
[[load]]
temperature = [-50, 20]
pin_temperature = 10
[solve]
nodes = 31
"""


def test_files_hold_temperatures_and_expansions(tmp_path):
    path = tmp_path / "case.toml"
    path.write_text(CASE)
    case = fastpin.read_case(path)
    assert case.problem.expansions == (12e-6, 23.6e-6)
    stored = tmp_path / "case.h5"
    fastpin.record(case.problem, case.history, stored, nodes=31)
    found = fastpin.load(stored)
    assert found.problem == case.problem
    assert [state.load["temperature"] for state in found] == [0.0, -50.0, 20.0]
    solved = solve(case.problem, case.history, nodes=31)
    assert np.array_equal(found[-1].pressure, solved[-1].pressure)


@pytest.mark.parametrize(
    ("old", "new", "line", "fault"),
    [
        ("23.6e-6", "23.6", 8, "expansion: must lie between -0.001 and 0.001, not 23.6"),
        ("72e9", '"72 GPa"', 6, 'E: must be a number, not "72 GPa"'),
        ("nu = 0.33", 'material = "brass pot"', 6, "E can't be given together with material"),
        ("expansion = 23.6e-6", "", 17, "needs the coefficient of thermal expansion of the plate"),
    ],
)
def test_a_faulty_material_has_no_fault_of_its_temperature_too(tmp_path, old, new, line, fault):
    path = tmp_path / "case.toml"
    path.write_text(CASE.strip().replace(old, new))
    with pytest.raises(fastpin.CaseFileError) as raised:
        fastpin.read_case(path)
    found = raised.value.problems
    assert found[0][0] == line
    assert fault in found[0][1]
    assert any("needs the coefficient" in words for _, words in found) == (new == "")


def test_columns_of_degrees_need_their_zero(tmp_path):
    path = tmp_path / "loads.csv"
    path.write_text("P,T [C]\n1e6,20\n1e6,-30.5\n")
    columns = {"P": {"column": "P"}, "temperature": {"column": "T", "zero": 20}}
    assert fastpin.LoadHistory.from_csv(path, columns=columns).values()[:, TEMPERATURE].tolist() == [0.0, -50.5]
    del columns["temperature"]["zero"]
    with pytest.raises(fastpin.CaseFileError, match="needs its zero, the temperature at which the clearance is given"):
        fastpin.LoadHistory.from_csv(path, columns=columns)
