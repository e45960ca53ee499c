"""One value gets one sentence: in Python, in a case file, in a plan and on the command line."""

import inspect
import json
import math
from typing import Any

import numpy as np
import pytest

import fastpin
from fastpin import InputError, SolveOptions, bodies, damage, model, states
from fastpin.casefile import parse_case
from fastpin.cli.main import main
from fastpin.studies import parse_plan
from tests.support.faults import faults_of
from tests.support.refusals import refused

CASE: dict[str, dict[str, Any]] = {
    "pin": {"E": 116e9, "nu": 0.32},
    "plate": {"E": 69e9, "nu": 0.33},
    "contact": {"hole_radius": 0.01, "clearance": 20e-6, "friction": 0.4, "pin_load": "centre"},
    "solve": {},
}

NAN, INF = math.nan, math.inf

OPTIONS: list[tuple[str, Any]] = [
    *(("nodes", value) for value in (4, 0, -3, 20_001, 30_000, 10**6, 10.5, 1000.0, "many", NAN, INF)),
    *(("method", value) for value in ("newton", "Path", "increments", 3, 2.5)),
    *(("increments", value) for value in (0, -1, 2.5, 100.0, "few", NAN)),
    *(
        ("arc", value)
        for value in ([0, 100], [1.0, 0.5], [0, 0], [-90, 90], [0, 1, 2], ["a", "b"], [NAN, 1.0], [0, INF], 0.5, "all")
    ),
    *(
        ("between", value)
        for value in (
            -1,
            10_001,
            1.5,
            "half",
            [0.5, 0.25],
            [0.0, 0.5],
            [0.5, 1.0],
            [0.5, 1.5],
            [0.5, 0.5],
            [NAN, 0.5],
            ["a", 0.5],
        )
    ),
    ("arc", ["a", 1]),
    *(("between", value) for value in ([0.5, 1.5], "abc")),
    *(("keep", value) for value in ("none", "every 0", "every -1", "every", "Cycles", "cycles", "corner", 5, 2.5)),
]
"""Bad values of the solver's options. "cycles" is bad because the history has none."""

FIELDS: list[tuple[str, str, Any]] = [
    *(("contact", "friction", value) for value in (-0.1, "rough", NAN, True, [0.4])),
    *(("contact", "hole_radius", value) for value in (0, -0.01, -1, "wide", INF)),
    *(("contact", "clearance", value) for value in (0.01, 0.02, -0.02, "none", NAN, INF)),
    *(("contact", "pin_load", value) for value in ("edge", "center", 1)),
    *(("contact", "rotation", value) for value in ("loose", "locked", "Free", 0)),
    *(("contact", "hub_radius", value) for value in (0.005, -1, "small")),
    *(("contact", "hub_stiffness", value) for value in (1e5, -1, "soft", NAN)),
    *(("contact", "drive", value) for value in ("uz", "dx", "Both", 1)),
    *(("contact", "gauge_radius", value) for value in (0.02, -1, "far")),
    *(("pin", "E", value) for value in (0, -1e9, "stiff", "70e9", NAN)),
    *(("pin", "nu", value) for value in (-0.1, 0.51, "soft", True, NAN)),
    ("solve", "arc", [0]),
    *(("solve", "shortcut", value) for value in (1, "yes")),
    *(("solve", "error_bars", value) for value in (0, "no")),
]
"""Bad values that only Python, case files and plans can have."""


def as_toml(value: Any) -> str:
    if isinstance(value, list):
        return f"[{', '.join(map(as_toml, value))}]"
    return json.dumps(value) if isinstance(value, (str, bool)) else repr(value)


def name_of(case: tuple) -> str:
    return " ".join(as_toml(part) for part in case)


def with_method(name: str) -> dict[str, str]:
    """Increments need the increment solver."""
    return {"method": "increment"} if name == "increments" else {}


def case_text(section: str = "solve", **values: Any) -> str:
    """The case as TOML, with other values in one section."""
    sections = CASE | {section: CASE[section] | values}
    parts = [f"[{name}]\n" + keys(table) for name, table in sections.items()]
    return "\n".join([*parts, "[[load]]\nP = 1e6\n"])


def keys(table: dict[str, Any]) -> str:
    return "".join(f"{key} = {as_toml(value)}\n" for key, value in table.items())


def build(section: str, values: dict[str, Any]) -> None:
    """Solve the case in Python, with other values in one section."""
    tables = CASE | {section: CASE[section] | values}
    pair = fastpin.MaterialPair(fastpin.Material(**tables["pin"]), fastpin.Material(**tables["plate"]))
    fastpin.solve(fastpin.Problem(pair, **tables["contact"]), [{"P": 1e6}], **tables["solve"])


def python_reason(section: str, name: str, value: Any) -> str:
    """The sentence that Python gives."""
    error = refused(build, section, {**with_method(name), name: value})
    assert error.field == name
    assert isinstance(error, ValueError)
    assert len(error.reason.split()) > 4
    return error.reason


@pytest.mark.parametrize("case", [("solve", *one) for one in OPTIONS] + FIELDS, ids=name_of)
def test_python_case_files_and_plans_say_the_same(case, tmp_path):
    section, name, value = case
    reason = python_reason(*case)
    found = faults_of(parse_case, case_text(section, **with_method(name), **{name: value}))
    assert [text for _, text in found] == [f"{name}: {reason}"]
    (tmp_path / "case.toml").write_text(case_text())
    rows = "".join(f'"solve.{key}" = {as_toml(one)}\n' for key, one in with_method(name).items())
    fields = f'case = "case.toml"\n[[list]]\n{rows}"{section}.{name}" = {as_toml(value)}\n'
    assert [text for _, text in faults_of(parse_plan, fields, folder=tmp_path)] == [f"{section}.{name}: {reason}"]


@pytest.mark.parametrize("case", OPTIONS, ids=name_of)
def test_the_command_line_says_the_same(case, tmp_path, capsys):
    name, value = case
    reason = python_reason("solve", name, value)
    path = tmp_path / "case.toml"
    path.write_text(case_text())
    text = ",".join(map(str, value)) if isinstance(value, list) else str(value)
    options = [f"--{key}={one}" for key, one in with_method(name).items()]
    assert main(["run", str(path), *options, f"--{name}={text}"]) == 2
    assert capsys.readouterr().err == f"fastpin: --{name}: {reason}\n"


def test_an_option_without_effect_is_refused_everywhere(tmp_path, capsys):
    reason = 'has no effect with method "path"; leave it out, or choose "increment"'
    assert refused(SolveOptions, increments=40).reason == reason
    assert [text for _, text in faults_of(parse_case, case_text(increments=40))] == [f"increments: {reason}"]
    path = tmp_path / "case.toml"
    path.write_text(case_text())
    found = faults_of(parse_plan, 'case = "case.toml"\n[grid]\n"solve.increments" = [40]\n', folder=tmp_path)
    assert [text for _, text in found] == [f"solve.increments: {reason}"]
    assert main(["run", str(path), "--increments", "40"]) == 2
    assert capsys.readouterr().err == f"fastpin: --increments: {reason}\n"


def test_another_method_on_the_command_line_drops_the_increments_of_the_file(tmp_path, capsys):
    path = tmp_path / "case.toml"
    path.write_text(case_text(nodes=41, method="increment", increments=5))
    assert main(["run", str(path)]) == 0
    assert "increment solver" in capsys.readouterr().out
    assert main(["run", str(path), "--method", "path"]) == 0
    assert "path solver" in capsys.readouterr().out


def test_options_of_solve_are_those_of_the_one_object():
    parameters = inspect.signature(fastpin.solve).parameters
    for name, default in SolveOptions().keywords().items():
        assert parameters[name].default == default
    assert set(parameters) - set(SolveOptions().keywords()) == {"problem", "history", "grid", "start", "progress"}


def test_a_wrong_class_is_refused(similar, tmp_path):
    problem = fastpin.Problem.from_load_parameter(similar, 0.1, 0.1)
    with pytest.raises(InputError, match="amplitude: must map load names to numbers"):
        fastpin.LoadHistory.cycles({"P": 1.0}, [{"Q": 0.1}], 10)
    with pytest.raises(TypeError, match=r"record\(\) got an unexpected keyword argument 'node', did you mean"):
        fastpin.record(problem, [{"P": 1.0}], tmp_path / "a.h5", node=61)
    assert not (tmp_path / "a.h5").exists()


RAGGED = [[1.0], [1.0, 2.0]]


@pytest.mark.parametrize(
    "call",
    [
        lambda: SolveOptions(nodes=np.array(3)),
        lambda: SolveOptions(keep=np.array("all")),
        lambda: SolveOptions(between=np.array(0.5)),
        lambda: SolveOptions(between=RAGGED),
        lambda: SolveOptions(arc=np.array(3.0)),
        lambda: SolveOptions(arc=(RAGGED, 1.0)),
        lambda: fastpin.Material(np.array([1.0, 2.0]), 0.3),
        lambda: fastpin.Material(RAGGED, 0.3),
        lambda: fastpin.Material(10**400, 0.3),
        lambda: fastpin.LoadHistory(5),
        lambda: fastpin.LoadHistory(None),
        lambda: fastpin.LoadHistory.monotonic(P="x"),
        lambda: fastpin.LoadHistory.monotonic(P=True),
        lambda: fastpin.LoadHistory.cycles(None, {"Q": 1.0}),
        lambda: fastpin.LoadHistory.cycles({"P": 1.0}, {"Q": 1.0}, start=np.array([1, 2])),
        lambda: fastpin.LoadHistory.harmonic({"P": 1.0}, {"Q": 1.0}, phase=3),
        lambda: fastpin.LoadHistory.from_array("abc"),
        lambda: fastpin.LoadHistory([{"P": 1.0}]).repeated(10**30),
        lambda: fastpin.Grid("abc"),
        lambda: fastpin.Grid([10**400]),
        lambda: fastpin.Grid(np.ones((3, 3))),
        lambda: fastpin.Grid(np.linspace(-3.0, 0.0, 20_001)),
        lambda: fastpin.Grid(np.linspace(-3.0, 0.0, 20), closed="no"),
        lambda: fastpin.Material(b"5", 0.3),
        lambda: fastpin.Material(np.True_, 0.3),
        lambda: fastpin.Material(1e9, np.complex128(0.3)),
        lambda: fastpin.Material(1e9, np.ma.masked),
        lambda: fastpin.Material(np.timedelta64(5, "s"), 0.3),
        lambda: fastpin.Material(1e9, 0.3, None),
        lambda: fastpin.Material(1e9, 0.3).kolosov("strian"),
        lambda: SolveOptions(nodes=2**63),
        lambda: SolveOptions(nodes=np.timedelta64(50, "s")),
        lambda: fastpin.LoadHistory([{(1, 2): 1.0}]),
        lambda: fastpin.LoadHistory(np.array(1.0)),
        lambda: fastpin.LoadHistory.cycles({"P": 1}, 5),
        lambda: fastpin.LoadHistory.cycles({"P": 1}, {"Q": 1}, return_to_mean=np.array([1, 2])),
        lambda: fastpin.LoadHistory.from_array([[1.0]], None),
        lambda: fastpin.LoadHistory.from_array([[True]], ["P"]),
        lambda: fastpin.LoadHistory.from_array([[b"1"]], ["P"]),
        lambda: fastpin.LoadHistory.from_csv(None),
        lambda: fastpin.LoadHistory.of_blocks([1]),
        lambda: fastpin.LoadHistory([{"P": 1.0}]).values(5),
        lambda: fastpin.LoadHistory([{"P": 1.0}]).corner(1),
        lambda: fastpin.Case(None, None),
        lambda: SolveOptions().changed(method=np.array([1, 2])),
        lambda: fastpin.load(None),
        lambda: fastpin.load("x" * 5000),
        lambda: fastpin.load("a\0b"),
        lambda: fastpin.resume(None),
        lambda: fastpin.read_case(None),
        lambda: fastpin.read_case(b"case.toml"),
        lambda: fastpin.casefile.parse_case(None),
        lambda: fastpin.casefile.parse_case(fastpin.casefile.EXAMPLE, folder=None),
        lambda: fastpin.studies.read_plan(None),
        lambda: fastpin.studies.parse_plan(b""),
        lambda: fastpin.studies.sweep.load(None),
        lambda: fastpin.studies.sweep.status(None, "a"),
        lambda: fastpin.studies.sweep.merge("part", "whole"),
        lambda: fastpin.storage.to_xarray(None),
        lambda: fastpin.storage.StoredResult(None).case,
        lambda: fastpin.storage.StoredResult(5).points,
        lambda: fastpin.report.describe(None),
        lambda: fastpin.figures.result_html(None),
        lambda: fastpin.figures.plot_convergence(None, "a.png"),
        lambda: fastpin.save(None, "a.h5"),
        lambda: fastpin.storage.to_dataframe(None),
        lambda: fastpin.plot_tractions(None),
        lambda: fastpin.plot_tractions("abc"),
        lambda: fastpin.plot_cycles(5),
    ],
)
def test_values_of_odd_classes_are_refused(call):
    assert len(str(refused(call))) < 300


STEEL = fastpin.MaterialPair(fastpin.MATERIALS["steel"], fastpin.MATERIALS["steel"])
PROBLEM = fastpin.Problem.from_load_parameter(STEEL, 0.1, 0.4)
SOLVED = fastpin.solve(PROBLEM, [{"P": 1.0}, {"Q": 0.1}], nodes=31)
STATE = SOLVED[-1]


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: STATE.hoop_stress(straight=np.ones(2)), "straight: must be true or false, not [1.0, 1.0]"),
        (lambda: fastpin.Session(PROBLEM).copy(matrices=1), "matrices: must be true or false, not 1"),
        (
            lambda: fastpin.Session(PROBLEM).change(friction=0.3, new_arc="no"),
            'new_arc: must be true or false, not "no"',
        ),
        (lambda: fastpin.Session(PROBLEM, undo=10**30), "undo: must be a whole number from 0 to 100000000, not"),
        (lambda: fastpin.casefile.case_text("x"), 'case: must be a Case, not "x"'),
        (lambda: fastpin.report.state_table(PROBLEM, [STATE], 5), "rows: must be the rows of table_rows, not 5"),
        (lambda: bodies.Compliance.from_document([1]), "content: must be a table, not [1]"),
        (lambda: model.FatigueConstants(np.ones(2)), "fatigue_strength: must be a number, not [1.0, 1.0]"),
        (lambda: model.FatigueConstants().required(["x"], "a", "b"), "names: must be "),
        (lambda: fastpin.converge(PROBLEM, [{"P": 1.0}], outcomes=np.ones(2)), "outcomes: must be "),
        (lambda: fastpin.Points("x", None, None), "radius: or depth must be given, and not both"),
        (lambda: fastpin.Points("x", 1.0, None), 'theta: must be a number, not "x"'),
        (lambda: fastpin.Points.at_depth([0.0, 0.1, 0.2], [0.0, 0.1]), "depth: has the shape (3,), which does not fit"),
        (lambda: fastpin.Points.at_depth(0.0, 1e30), "theta: must be at least -1e+06 and at most 1e+06, not 1e+30"),
        (lambda: states.LoadCycle("x"), "states: must be a sequence of fastpin.State, not "),
        (lambda: states.LoadCycle([STATE]), "states: must be two or more, not 1"),
        (lambda: damage.critical_distance(1e300, 1e-300), "threshold_range: is inf times limit_range"),
        (lambda: damage.critical_distance(1e-300, 1e300), "threshold_range: is 0 times limit_range"),
        (
            lambda: damage.smith_watson_topper_life([1.0], 2e11, 1e300, -0.1, 0.5, -0.6),
            "fatigue_strength: must give a coefficient that is a positive number, not inf",
        ),
        (lambda: fastpin.plot_tractions(SOLVED, title="x" * 2_001), "title: must have at most 2,000 characters in a"),
        (
            lambda: fastpin.plot_tractions(SOLVED, states=range(2**62)),
            "states: must be last, cycle, all or load points",
        ),
        (lambda: SOLVED.plot(states=slice(None, None, 0)), "states: must be a slice of whole numbers with a step"),
        (lambda: SOLVED.history[::0], "history: must be a slice of whole numbers with a step other than 0"),
        (lambda: SOLVED.history["x":], "history: must be a slice of whole numbers"),
    ],
)
def test_arguments_of_a_wrong_kind_give_the_sentence_of_their_field(call, message):
    assert str(refused(call)).startswith(message)


@pytest.mark.parametrize("progress", [True, "all", int, float, lambda: None, lambda done: None, lambda a, b, c: None])
def test_progress_that_takes_no_two_arguments_is_refused_before_the_work(similar, progress):
    problem = fastpin.Problem.from_load_parameter(similar, 0.1, 0.4)
    with pytest.raises(InputError, match="progress: must be a callable"):
        fastpin.solve(problem, [{"P": 1.0}], nodes=41, progress=progress)


def test_progress_of_any_callable_with_two_arguments_is_accepted(similar):
    problem = fastpin.Problem.from_load_parameter(similar, 0.1, 0.4)
    for progress in (max, print, lambda *both: None, lambda done, total, more=1: None, {}.setdefault):
        fastpin.solve(problem, [{"P": 1.0}], nodes=41, progress=progress)


@pytest.mark.parametrize("between", [[1e-300], [0.5, 0.5 + 1e-12], [1.0 - 1e-12]])
def test_fractions_of_a_step_that_are_one_load_point_are_refused_before_the_work(between):
    with pytest.raises(InputError, match=r"between: must be a whole number, or increasing fractions .* 1e-09 apart"):
        SolveOptions(between=between)


def test_numpy_numbers_are_options():
    options = SolveOptions(
        nodes=np.int64(61), between=np.array([0.25, 0.5], np.float32), arc=np.array([-3.0, -0.5]), shortcut=np.True_
    )
    assert options == SolveOptions(nodes=61, between=(0.25, 0.5), arc=(-3.0, -0.5), shortcut=True)
    assert SolveOptions(between=0.5).fractions.tolist() == [0.5, 1.0]
    assert type(options.shortcut) is bool


def test_a_grid_or_an_arc_beside_a_start_is_refused(similar):
    problem = fastpin.Problem.from_load_parameter(similar, 0.1, 0.4)
    first = fastpin.solve(problem, [{"P": 1.0}], nodes=41)
    for given in ({"arc": (-3.0, 0.0)}, {"grid": first.grid}):
        with pytest.raises(InputError, match="has no effect with start"):
            fastpin.solve(problem, [{"Q": 0.1}], start=first, **given)
