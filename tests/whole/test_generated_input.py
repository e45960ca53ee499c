"""Generated input: valid input is accepted and comes back unchanged, and odd input gets one sentence."""

import copy
import dataclasses
import pickle
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import fastpin
from fastpin import Case, CaseFileError, FastpinError, InputError, LoadHistory, SolveError, SolveOptions
from fastpin.casefile import parse_case
from fastpin.errors import printable
from fastpin.model.acting import check_arc, check_loads
from fastpin.model.loads import Corner
from fastpin.model.profile import is_pair
from fastpin.storage import StoredResult
from fastpin.studies import parse_plan
from tests.support import strategies
from tests.support.faults import faults_of
from tests.support.plans import planned
from tests.support.strategies import Tables, as_toml, tables_of, text_of

pytestmark = pytest.mark.gate

STEEL = fastpin.MaterialPair(fastpin.MATERIALS["steel"], fastpin.MATERIALS["steel"])

LONGEST = 400
"""Most characters of a message."""


def assert_same_history(one: LoadHistory, other: LoadHistory) -> None:
    assert len(one) == len(other)
    assert np.array_equal(one.values(), other.values())
    assert one.longest_cycle == other.longest_cycle


def assert_same_case(one: Case, other: Case) -> None:
    assert (one.options, one.title, one.wear) == (other.options, other.title, other.wear)
    assert dataclasses.replace(one.problem, pair=STEEL) == dataclasses.replace(other.problem, pair=STEEL)
    pair, other_pair = one.problem.pair, other.problem.pair
    for body, other_body in ((pair.pin, other_pair.pin), (pair.plate, other_pair.plate)):
        # A dimensionless problem scales its moduli, also those that were scaled before.
        assert pytest.approx(other_body.E, rel=1e-14 if one.problem.dimensionless else 0.0) == body.E
        assert (body.nu, body.name) == (other_body.nu, other_body.name)
    assert pair.plane == other_pair.plane
    assert_same_history(one.history, other.history)


def error_of(call: Callable[[], Any]) -> InputError | None:
    """The error with which a call refuses its input, or None."""
    try:
        call()
    except InputError as error:
        return error
    return None


def assert_one_sentence(error: FastpinError) -> None:
    assert str(error).strip()
    assert "\n" not in str(error)
    assert len(str(error)) < LONGEST
    assert printable(str(error)) == str(error)


# -- valid input ---------------------------------------------------------------------------------------------


@given(strategies.problems(), st.data())
def test_valid_input_survives_copies_and_pickle(problem, data):
    history, options = data.draw(strategies.histories(problem)), data.draw(strategies.options())
    for again in (copy.deepcopy, lambda value: pickle.loads(pickle.dumps(value))):
        assert again(problem) == problem
        assert again(options) == options
        assert_same_history(again(history), history)
    assert SolveOptions(**options.keywords()) == options
    for value in (problem, problem.pair, options, history):
        assert 0 < len(repr(value)) < 1000
    check_loads(problem, history)


@given(strategies.problems(), st.data())
def test_parts_of_a_history_are_those_of_the_whole(problem, data):
    history = data.draw(strategies.histories(problem))
    place = data.draw(st.integers(1, max(len(history) - 1, 1)))
    if place < len(history):
        assert_same_values = np.array_equal((history[:place] + history[place:]).values(), history.values())
        assert assert_same_values


def repeatable(case: Case) -> bool:
    """Whether every repeated block gives the same loads at all corners, so that a case file can hold it."""
    blocks = [np.isnan(block.given) for block in case.history.blocks if block.cycle]
    return all((given == given[0]).all() for given in blocks)


def is_valid_together(case: Case) -> bool:
    try:
        check_arc(case.problem, case.options)
    except InputError:
        return False
    return repeatable(case)


@pytest.mark.survey
@given(strategies.cases().filter(is_valid_together))
def test_a_case_written_as_a_file_is_read_again(case):
    assert_same_case(parse_case(text_of(case)), case)


@pytest.mark.survey
@given(case=strategies.cases().filter(is_valid_together), friction=st.floats(0.0, 1.5))
def test_a_plan_makes_the_case_that_its_file_would_make(case, friction, tmp_path_factory):
    assume(friction > 0.0 or "friction_change" not in case.history.largest)
    folder = tmp_path_factory.mktemp("plan")
    tables = tables_of(case)
    tables["solve"]["error_bars"] = False  # sweeps refuse them
    plan = planned(folder, text_of(case, tables), f'[grid]\n"contact.friction" = [{as_toml(friction)}]\n')
    tables["contact"] |= {"friction": friction}
    assert_same_case(plan.case(plan.points[0]), parse_case(text_of(case, tables)))


@settings(max_examples=15)
@given(problem=strategies.problems(), data=st.data())
def test_valid_input_is_solved_or_lost_with_a_reason(problem, data, tmp_path_factory):
    assert_solved_or_lost(problem, data.draw(strategies.corners(problem, 2)), tmp_path_factory.mktemp("result"))


@pytest.mark.survey
@settings(max_examples=20)
@given(problem=strategies.problems(), data=st.data())
def test_more_valid_input_is_solved_or_lost_with_a_reason(problem, data, tmp_path_factory):
    assert_solved_or_lost(problem, data.draw(strategies.corners(problem, 3)), tmp_path_factory.mktemp("result"))


def assert_solved_or_lost(problem: fastpin.Problem, rows: list[Corner], folder: Path) -> None:
    """Record a history. Its result can be loaded, or one sentence says why it was lost."""
    path = folder / "result.h5"
    try:
        fastpin.record(problem, rows, path, nodes=21, title="generated")
    except (SolveError, InputError) as error:
        assert_one_sentence(error)
    if path.exists():
        result = fastpin.load(path)
        assert result.problem == problem
        assert StoredResult(path).case.problem == problem
        for state in result:
            numbers = [state.dx, state.dy, state.rotation, state.dissipation, state.work, state.energy]
            assert all(
                np.isfinite(each).all() for each in (state.pressure, state.shear, state.gap, state.slip, numbers)
            )


# -- odd input -----------------------------------------------------------------------------------------------

CALLS: list[tuple[Any, dict[str, Any]]] = [
    (fastpin.Material, {"E": 1e9, "nu": 0.3, "name": "x"}),
    (fastpin.MaterialPair, {"pin": STEEL.pin, "plate": STEEL.plate, "plane": "strain"}),
    (
        fastpin.MaterialPair.from_dundurs,
        {"alpha": 0.1, "beta": 0.0, "nu_pin": 0.3, "plane": "strain", "convention": "usual", "beta_star": 1.0},
    ),
    (
        fastpin.Problem,
        {"pair": STEEL, "hole_radius": 0.01, "clearance": 1e-5, "friction": 0.4, "pin_load": "centre",
         "rotation": "fixed", "hub_radius": 0.005, "dimensionless": False},
    ),
    (fastpin.Problem.from_load_parameter, {"pair": STEEL, "load_parameter": 0.1, "friction": 0.4}),
    (fastpin.LoadHistory, {"corners": [{"P": 1.0}]}),
    (lambda value: fastpin.LoadHistory([{"P": value}]), {"value": 1.0}),
    (fastpin.LoadHistory.monotonic, {"steps": 2, "P": 1.0}),
    (
        fastpin.LoadHistory.cycles,
        {"mean": {"P": 1.0}, "amplitude": {"Q": 0.1}, "count": 2, "start": 1, "return_to_mean": True},
    ),
    (
        fastpin.LoadHistory.harmonic,
        {"mean": {"P": 1.0}, "amplitude": {"Q": 0.1}, "phase": {"Q": 90.0}, "count": 2, "points": 5},
    ),
    (fastpin.LoadHistory.from_array, {"corners": [[1.0]], "loads": ["P"]}),
    (fastpin.LoadHistory.from_csv, {"path": "none.csv"}),
    (fastpin.Grid, {"theta": np.linspace(-3.0, 0.0, 9), "closed": False}),
    (fastpin.Grid.arc, {"start": -3.0, "stop": 0.0, "nodes": 9}),
    (fastpin.Grid.circle, {"nodes": 9, "start": 0.0}),
    (SolveOptions, SolveOptions().keywords()),
    (SolveOptions, SolveOptions(method="increment", increments=5).keywords()),
    (fastpin.Case, {"problem": None, "history": None, "options": None, "title": ""}),
    (fastpin.load, {"path": "none.h5"}),
    (fastpin.read_case, {"path": "none.toml"}),
    (parse_case, {"text": "", "name": "case", "folder": "."}),
    (parse_plan, {"text": "", "name": "plan", "folder": "."}),
]  # fmt: skip
"""Public functions and good arguments."""


@settings(max_examples=200)
@given(st.data())
def test_odd_arguments_are_accepted_or_refused_with_one_sentence(data):
    function, good = data.draw(st.sampled_from(CALLS))
    name = data.draw(st.sampled_from(sorted(good)))
    value = data.draw(strategies.odd_values)
    error = error_of(lambda: function(**good | {name: value}))
    if isinstance(error, CaseFileError):
        assert all(printable(text) == text and len(text) < LONGEST for _, text in error.problems)
    elif error is not None:
        assert_one_sentence(error)
        assert error.field


PLAIN = fastpin.Case(fastpin.Problem(STEEL, 0.01, 1e-5, 0.3), LoadHistory([{"P": 1e5}]), SolveOptions(nodes=61))

KEYS = [(section, key) for section, table in tables_of(PLAIN).items() for key in table]


def build(tables: Tables) -> Case:
    """The case of some tables, in Python."""
    bodies = [fastpin.Material(**tables[name]) for name in ("pin", "plate")]
    contact = dict(tables["contact"])
    pair = fastpin.MaterialPair(*bodies, contact.pop("plane"))
    case = Case(fastpin.Problem(pair, **contact), PLAIN.history, SolveOptions(**tables["solve"]))
    check_loads(case.problem, case.history)
    check_arc(case.problem, case.options)
    return case


def is_a_profile(value: Any) -> bool:
    """Whether Python or a file takes a value as a profile: samples, tables or the name of a file."""
    parts = value if isinstance(value, list) else [value]
    return is_pair(value) or any(isinstance(part, dict) or (isinstance(part, str) and "." in part) for part in parts)


@settings(max_examples=300)
@given(st.sampled_from(KEYS), strategies.toml_values)
def test_python_and_the_file_say_the_same(place, value):
    section, key = place
    tables = {name: dict(table) for name, table in tables_of(PLAIN).items()}
    tables[section][key] = value
    if key == "E" and value == np.inf:
        return  # A file says "rigid = true" instead.
    if key == "friction" and is_a_profile(value):
        return  # A file writes profiles in another way.
    error = error_of(lambda: build(tables))
    if error is None:
        assert_same_case(parse_case(text_of(PLAIN, tables)), build(tables))
        return
    assert_one_sentence(error)
    assert str(error) in [text for _, text in faults_of(parse_case, text_of(PLAIN, tables))]


@settings(max_examples=150)
@given(st.sampled_from(KEYS), strategies.toml_values, strategies.toml_values)
def test_plans_accept_values_or_name_the_field(place, first, second):
    field = ".".join(place)
    text = f'[grid]\n"{field}" = {as_toml([first, second])}\n"solve.shortcut" = [true]\n'
    error = error_of(lambda: parse_plan(text))
    if error is None:
        plan = parse_plan(text)
        assert all(plan.case(point).title for point in plan.points)
    else:
        assert isinstance(error, CaseFileError)
        assert all(printable(message) == message for _, message in error.problems)
