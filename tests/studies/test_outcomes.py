"""Outcomes: the numbers that they read, and the faults of their tables, all at once and each with its line."""

import functools
import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fastpin import CaseFileError, InputError, MaterialPair, Result
from fastpin.assess.outputs import Output
from fastpin.kernels.status import OPEN
from fastpin.model.angles import from_bottom
from fastpin.model.units import Unit
from fastpin.states import QUANTITIES
from fastpin.studies import outcomes, parse_plan, read_outcomes, sweep
from fastpin.studies.outcome_tables import outcomes_from
from fastpin.studies.outcomes import CYCLE_QUANTITIES, check_loadable, pickled, value_of, values_in_worker
from fastpin.studies.run_end import RUN_COLUMNS
from tests.support.faults import fault_of, faults_of
from tests.support.outcomes import FILE, TABLE, last_work, solved, value
from tests.support.samples import with_values
from tests.support.studies import small_problem


@pytest.fixture(scope="module")
def result(similar: MaterialPair) -> Result:
    return solved(small_problem(similar))


# -- values ----------------------------------------------------------------------------------------------------


def test_a_quantity_is_taken_from_the_kept_states(result: Result) -> None:
    shear = np.array([state.peak_shear for state in result])
    assert shear.min() < 0.0 < shear.max()
    expected = {
        "last": shear[-1],
        "largest": shear.max(),
        "smallest": shear.min(),
        "largest magnitude": np.abs(shear).max(),
        "range": shear.max() - shear.min(),
    }
    assert tuple(expected) == outcomes.TAKES
    for take, number in expected.items():
        assert value({"quantity": "peak_shear", "take": take}, result) == number, take
    assert value({"quantity": "peak_shear"}, result) == shear[-1]


def test_the_last_cycle_is_from_its_beginning_to_its_end(result: Result) -> None:
    lost = [state.dissipation for state in result]
    assert len(lost) == 5
    assert lost == sorted(set(lost))  # it grows at every corner
    given = {"quantity": "dissipation", "over": "cycle"}
    assert value(given | {"take": "smallest"}, result) == lost[2]
    assert value(given | {"take": "largest"}, result) == lost[4]
    assert value(given | {"take": "range"}, result) == lost[4] - lost[2]


@pytest.mark.parametrize("name", ["dissipation", "rotation_change", "pressure_change", "shear_change"])
def test_quantities_of_the_last_cycle(name: str, result: Result) -> None:
    assert value({"cycle": name}, result) == getattr(result.cycles[-1], name)


def test_every_quantity_can_be_an_outcome(result: Result) -> None:
    for name, quantity in QUANTITIES.items():
        number, raw = value({"quantity": name}, result), quantity.of(result[-1])
        if math.isnan(raw):
            assert number is None, name
            # neither remote stress nor a ring, an outline or a bush, and nothing is pressed
            seat = ("peak_hoop_seat", "peak_hoop_seat_angle", "bush_open_margin", "bush_slip_margin")
            assert name in ("kt_gross", "kt_net", "peak_hoop_outline", *seat) or quantity.is_part
            continue
        expected = from_bottom(raw) if quantity.kind == "angle" else raw
        assert number == (math.degrees(raw) if quantity.kind == "width" else expected), name


def test_a_new_cycle_quantity_takes_one_line(result: Result, monkeypatch: pytest.MonkeyPatch) -> None:
    entry = Output("swept_arc", "width", lambda result: 0.5 * math.pi)
    monkeypatch.setitem(CYCLE_QUANTITIES, "swept_arc", entry)
    assert value({"cycle": "swept_arc"}, result) == 90.0


@pytest.mark.parametrize(
    ("places", "arc"), [([170.0, -170.0, 175.0], 20.0), ([-90.0, 90.0, 10.0], 180.0), ([30.0, 30.0], 0.0)]
)
def test_the_range_of_a_place_is_the_smallest_arc(places, arc, result, monkeypatch):
    left = iter(places)
    changed = QUANTITIES["peak_shear_angle"]._replace(of=lambda state: math.radians(next(left) - 90.0))
    monkeypatch.setitem(QUANTITIES, "peak_shear_angle", changed)
    some = replace(result, states=result.states[: len(places)])
    assert value({"quantity": "peak_shear_angle", "take": "range"}, some) == pytest.approx(arc, abs=1e-9)


def test_states_without_a_value_do_not_count(result: Result) -> None:
    open_state = with_values(result[0], pressure=0.0, shear=0.0, status=OPEN)
    assert math.isnan(open_state.peak_pressure_angle)
    mixed = replace(result, states=[open_state, result[-1]])
    largest = value({"quantity": "peak_pressure_angle", "take": "largest"}, mixed)
    assert largest == pytest.approx(from_bottom(result[-1].peak_pressure_angle))
    assert value({"quantity": "peak_pressure_angle", "take": "largest"}, replace(result, states=[open_state])) is None


def test_a_number_that_the_history_does_not_have_has_a_reason(similar: MaterialPair, result: Result) -> None:
    swing = outcomes_from({"it": {"quantity": "dx", "take": "range", "over": "cycle"}})["it"]
    assert value_of(swing, replace(result, cycles=())).reason == "the history has no cycle"
    ends = solved(small_problem(similar), keep="cycles")
    assert value_of(swing, ends).reason == 'not all corners of the last cycle are kept; keep = "corners" keeps them'
    assert value_of(outcomes_from({"it": {"cycle": "dissipation"}})["it"], ends).reason is None


@pytest.mark.parametrize(
    ("function", "expected", "reason"),
    [
        (lambda _: None, None, None),
        (lambda _: np.float64("nan"), None, None),
        (lambda _: np.float32(0.5), 0.5, None),
        (lambda _: 3, 3.0, None),
        (lambda _: math.inf, None, "its value: must be a finite number, not inf"),
        (lambda _: "high", None, 'its value: must be a number, not "high"'),
        (lambda _: np.zeros(3), None, "its value: must be a number, not [0.0, 0.0, 0.0]"),
        (lambda result: result[99], None, "IndexError: list index out of range (test_outcomes.py, line "),
        (lambda _: exit(3), None, "SystemExit: 3 (test_outcomes.py, line "),
    ],
)
def test_a_function_may_give_and_raise_anything(
    function: Callable[[Result], Any], expected: float | None, reason: str | None, result: Result
) -> None:
    found = value_of(outcomes_from({"it": function})["it"], result)
    assert found.value == expected
    assert (found.reason or "").startswith(reason or "")
    assert (found.reason is None) == (reason is None)


def test_an_interrupt_is_no_fault_of_a_function(result: Result) -> None:
    def interrupted(result: Result) -> float:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        value_of(outcomes_from({"it": interrupted})["it"], result)


# -- functions -------------------------------------------------------------------------------------------------


def test_the_functions_of_a_file(result: Result, tmp_path: Path) -> None:
    path = tmp_path / "mine.py"
    path.write_text(FILE)
    found = read_outcomes(path)
    assert list(found) == ["largest_pressure", "nothing", "broken"]
    path.unlink()  # workers don't need it
    read = values_in_worker({name: (each.definition, pickled(each)) for name, each in found.items()}, result)
    assert read["largest_pressure"].value == max(state.peak_pressure for state in result)
    assert (read["nothing"].value, read["nothing"].reason) == (None, None)
    assert read["broken"].reason == "ZeroDivisionError: division by zero (mine.py, line 20)"
    assert [outcome.unit_in({}) for outcome in found.values()] == [Unit(1.0, "Pa"), Unit(1.0, ""), Unit(1.0, "")]


def test_the_definition_of_a_function_changes_with_its_file(tmp_path: Path) -> None:
    path = tmp_path / "mine.py"
    definitions = []
    for text in (FILE, FILE, FILE.replace("1 / 0", "1 / 2")):
        path.write_text(text)
        definitions.append(read_outcomes(path)["broken"].definition)
    assert definitions[0] == definitions[1] != definitions[2]
    table = '[outcomes]\nit = { function = "mine.py:broken" }\n'
    path.with_suffix(".toml").write_text(table)
    assert read_outcomes(path.with_suffix(".toml"))["it"].definition == definitions[2]


def test_the_definition_of_a_callable_has_its_arguments() -> None:
    cubes, squares = (
        outcomes_from({"it": functools.partial(pow, exponent)})["it"].definition for exponent in (3.0, 2.0)
    )
    assert cubes != squares
    assert outcomes_from({"it": last_work})["it"].definition == outcomes_from({"other": last_work})["other"].definition


def test_a_function_that_a_worker_does_not_find_is_a_missing_value(result: Result) -> None:
    content = pickled(outcomes_from({"it": last_work})["it"])
    lost = content.replace(b"last_work", b"lost_work")
    found = values_in_worker({"it": ("a definition", lost), "other": ("another", content)}, result)
    assert found["it"][:2] == ("a definition", None)
    assert (found["it"].reason or "").startswith("the worker does not find the function: AttributeError")
    assert found["other"].value == result[-1].work


# -- faults ----------------------------------------------------------------------------------------------------


def faults(text: str, folder: Path) -> list[tuple[int, str]]:
    return faults_of(parse_plan, f"[grid]\nsolve.nodes = [41]\n[outcomes]\n{text}", folder=folder)


ONE_KEY = (
    "must have one of the keys quantity, cycle, wear, fatigue, crack, strength, margin, joint, function, such as {"
)


def test_all_faults_of_the_table_come_at_once_with_their_lines(tmp_path: Path) -> None:
    (tmp_path / "mine.py").write_text(FILE)
    (tmp_path / "bad.py").write_text("x = 1\ndef f(:\n")
    (tmp_path / "units.py").write_text("def f(result): return 1.0\nf.unit = 3\n")
    text = """titel = "x"
[grid]
contact.friction = 0.3
[outcomes]
a = { quantity = "peak_sheer" }
b = { quantity = "dx", take = "biggest", over = "cycles" }
c = { cycle = "disipation" }
d = { quantity = "dx", tak = "last", of = 3 }
e = { cycle = "dissipation", over = "cycle" }
f = { take = "largest" }
g = { quantity = "dx", cycle = "dissipation" }
h = "peak_shear"
peak_pressure = { quantity = "peak_pressure" }
"i-j" = { quantity = "dx" }
A = { quantity = "dx" }
k = { quantity = "peak_shear_angle", take = "largest magnitude" }
l = { quantity = "dx", over = "cycle" }
m = { function = "mine.py" }
n = { function = "mine.py:largest_presure" }
o = { function = "none.py:f" }
p = { function = "bad.py:f" }
q = { function = "units.py:f" }
r = { function = 3 }
t = { function = "../mine.py:broken" }
u = { function = "/mine.py:broken" }
[outcomes.s]
quantity = "dx"
take = "most"
"""
    expected = [
        (1, 'unknown key "titel"'),
        (3, "contact.friction: must be a list of values"),
        (5, 'a: quantity: must be "peak_pressure", '),
        (6, 'b: take: must be "last", "largest", "smallest", "largest magnitude" or "range", not "biggest"'),
        (6, 'b: over: must be "history" or "cycle", not "cycles"'),
        (7, 'c: cycle: must be "dissipation", '),
        (8, 'd: unknown key "tak", did you mean "take"?'),
        (8, 'd: unknown key "of"; beside quantity there may be take and over'),
        (9, 'e: unknown key "over"; beside cycle there may be interface'),
        (10, f"f: {ONE_KEY}"),
        (11, f"g: {ONE_KEY}"),
        (12, 'h: must be a table such as { quantity = "peak_shear", take = "largest" }'),
        (13, "peak_pressure: is a column of every sweep; choose another name"),
        (14, '"i-j": the name of an outcome is a letter, then letters, digits and underscores, at most 64'),
        (16, 'k: take: a place on the hole has no magnitude; take "largest" or "smallest"'),
        (17, "l: over: the last state is that of the history, too"),
        (18, 'm: function: must be FILE.py:NAME, such as "my.py:wear", not "mine.py"'),
        (19, 'n: there is no function "largest_presure" in mine.py, did you mean "largest_pressure"?'),
        (20, "o: none.py: there is no such file"),
        (21, "p: bad.py, line 2: is not Python: "),
        (
            22,
            "q: units.py, line 2: f: the attribute unit must be text in quotes, as the file is read without being run",
        ),
        (23, 'r: function: must be FILE.py:NAME, such as "my.py:wear", not 3'),
        (24, "t: ../mine.py: must lie beside the plan, or in a folder below"),
        (25, "u: /mine.py: must lie beside the plan, or in a folder below"),
        (28, 's: take: must be "last", "largest",'),
    ]
    found = faults_of(parse_plan, text, folder=tmp_path)
    starts = [(line, words[: len(start)]) for (line, words), (_, start) in zip(found, expected, strict=True)]
    assert starts == expected
    assert 'not "peak_sheer", did you mean "peak_shear"?' in found[2][1]
    assert 'did you mean "dissipation"?' in found[5][1]


def test_capital_letters_make_no_difference(tmp_path: Path) -> None:
    words = "A: there is a already; capital letters make no difference"
    assert faults('a = { quantity = "dx" }\nA = { quantity = "dy" }\n', tmp_path) == [(5, words)]


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ([last_work], "outcomes: must be a dict of functions and tables by name"),
        ({"it": None}, "outcomes: it: must be a table"),
        ({3: last_work}, "outcomes: 3: the name of an outcome is a letter"),
        ({"seconds": last_work}, "outcomes: seconds: is a column of every sweep"),
        ({"it": {"quantity": "dz"}}, "outcomes: it: quantity: must be "),
        ({"it": {"quantity": ["dx"]}}, "outcomes: it: quantity: must be "),
    ],
)
def test_faults_in_python_name_the_outcome(given: Any, words: str) -> None:
    with pytest.raises(InputError, match=words) as caught:
        outcomes_from(given)
    assert caught.value.field == "outcomes"


def test_a_unit_is_text() -> None:
    def weighed(result: Result) -> float:
        return 1.0

    weighed.unit = 3  # type: ignore[attr-defined]
    with pytest.raises(InputError, match="weighed: the attribute unit: must be text in quotes, not 3"):
        outcomes_from({"weighed": weighed})


def test_no_column_of_the_index_can_be_an_outcome() -> None:
    for name in RUN_COLUMNS:
        with pytest.raises(InputError, match="is a column of every sweep"):
            outcomes_from({name.upper(): last_work})


@pytest.mark.parametrize(
    ("name", "text", "words"),
    [
        ("a.txt", "", "a.txt: must end in .py or .toml to be a file of outcomes"),
        ("a.py", "x = 1\n", "defines no function whose name begins with a letter"),
        ("a.py", "def f(r):\n  return 1\nf.unit = g()\n", "line 3: f: the attribute unit must be text in quotes"),
        ("a.py", "def f(r):\n  return 1\ndef seconds(r):\n  return 1\n", "seconds: is a column of every sweep"),
        ("a.toml", "[grid]\n", r"the section \[outcomes\] is missing"),
        ("a.toml", "[outcomes]\nx = 3\n", "line 2: x: must be a table"),
        ("a.toml", "[outcomes]\nx = {\n", "a.toml"),
    ],
)
def test_faults_of_files(name: str, text: str, words: str, tmp_path: Path) -> None:
    (tmp_path / name).write_text(text)
    with pytest.raises(InputError, match=words):
        read_outcomes(tmp_path / name)


def test_outcomes_change_no_run(tmp_path: Path) -> None:
    text = "[grid]\nsolve.nodes = [41, 51]\n"
    bare, full = parse_plan(text), parse_plan(text + TABLE)
    assert list(bare.runs) == list(full.runs)
    assert bare.digest == full.digest
    assert list(full.outcomes) == ["shear", "swing", "loss"]
    more = full.with_outcomes({"work": last_work, "Loss": {"cycle": "dissipation"}})
    assert list(more.outcomes) == ["shear", "swing", "loss", "work"]
    with pytest.raises(InputError, match="loss: the plan has another outcome of this name"):
        full.with_outcomes({"loss": {"cycle": "rotation_change"}})


def test_another_body_of_a_function_is_another_definition() -> None:
    """Also where the text is not known, as in a notebook."""
    texts = ("lambda result: 1.0", "lambda result: 2.0", "lambda result: len(result)")
    assert len({outcomes_from({"mine": eval(text)})["mine"].definition for text in texts}) == 3


TRAP = """
from pathlib import Path

Path({marker!r}).touch()


def loss(result):
    return 1.0


loss.unit = "J"
if True:
    other = lambda result: 2.0


class Scale:
    pass


Scale.unit = "m"
"""


def test_a_file_of_functions_is_read_without_being_run(tmp_path: Path) -> None:
    marker = tmp_path / "ran"
    (tmp_path / "mine.py").write_text(TRAP.format(marker=str(marker)))
    plan = parse_plan('[grid]\nsolve.nodes = [41]\n[outcomes]\nw = { function = "mine.py:loss" }\n', "p", tmp_path)
    found = read_outcomes(tmp_path / "mine.py")
    assert (plan.outcomes["w"].unit, [*found]) == ("J", ["loss", "other"])
    assert not marker.exists()
    check_loadable(found)
    assert marker.exists()


@pytest.mark.parametrize("link", ["file", "folder"])
def test_a_link_does_not_lead_out_of_the_folder_of_the_plan(link: str, tmp_path: Path) -> None:
    (tmp_path / "outside").mkdir()
    (tmp_path / "outside/mine.py").write_text(FILE)
    folder = tmp_path / "plans"
    folder.mkdir()
    if link == "file":
        (folder / "link.py").symlink_to("../outside/mine.py")
    else:
        (folder / "sub").symlink_to("../outside")
    name = "link.py" if link == "file" else "sub/mine.py"
    words = f"w: {name}: is a link that leads out of the folder of the plan"
    assert faults(f'w = {{ function = "{name}:broken" }}\n', folder) == [(4, words)]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("import nowhere_at_all\ndef f(r): return 1.0\n", "a.py: can't be imported: ModuleNotFoundError: No "),
        ("def f(r): return 1.0\nraise SystemExit('no')\n", r"a.py: can't be imported: SystemExit: no \(a.py, line 2\)"),
        ("def f(r): return 1.0\ndel f\n", "a.py: can't be imported: AttributeError: "),
    ],
)
def test_a_file_that_can_not_be_run_is_found_before_the_work(text: str, words: str, tmp_path: Path) -> None:
    (tmp_path / "a.py").write_text(text)
    plan = parse_plan("[grid]\nsolve.nodes = [41]\n").with_outcomes(read_outcomes(tmp_path / "a.py"))
    with pytest.raises(InputError, match=f"outcomes: f: {words}"):
        sweep.run(plan, tmp_path / "out", workers=1)
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("file", "fault"),
    [
        ("folder.py", "w: folder.py: is a directory, a file is needed"),
        ("loop.py", "w: loop.py: "),
        (r"\u0000.py", "w: function: must be FILE.py:NAME"),
        (r"\u001b[31m.py", "w: function: must be FILE.py:NAME"),
    ],
)
def test_a_function_of_no_ordinary_file_is_a_fault(tmp_path: Path, file: str, fault: str) -> None:
    (tmp_path / "folder.py").mkdir()
    (tmp_path / "loop.py").symlink_to("loop.py")
    ((_, found),) = faults(f'w = {{ function = "{file}:f" }}\n', tmp_path)
    assert fault in found


# -- classes ---------------------------------------------------------------------------------------------------


def test_the_regime_is_an_outcome(result: Result) -> None:
    cycle = result.cycle()
    assert value({"cycle": "regime"}, result) == float(cycle.regime)
    assert value({"quantity": "regime", "take": "largest"}, result) == max(float(state.regime) for state in result)
    (outcome,) = outcomes_from({"it": {"cycle": "regime"}}).values()
    assert outcome.classes[int(cycle.regime)] == cycle.regime.words


def with_classes(folder: Path, classes: str) -> dict[str, Any]:
    """The outcomes of a plan whose function returns 1."""
    (folder / "kinds.py").write_text("def kind(result):\n    return 1\n", encoding="utf-8")
    (folder / "kinds.toml").write_text(
        f'[outcomes]\nkind = {{ function = "kinds.py:kind", classes = {classes} }}\n', encoding="utf-8"
    )
    return dict(read_outcomes(folder / "kinds.toml"))


def test_the_classes_of_a_function_have_words(tmp_path: Path, result: Result) -> None:
    outcome = with_classes(tmp_path, '{ 2 = "bad", 1 = "good" }')["kind"]
    assert outcome.classes == {1: "good", 2: "bad"}
    assert value_of(outcome, result).value == 1.0
    renamed = with_classes(tmp_path, '{ 1 = "fine", 2 = "bad" }')["kind"]
    assert renamed.definition == outcome.definition  # the words change no value
    other = value_of(with_classes(tmp_path, '{ 0 = "good", 2 = "bad" }')["kind"], result)
    assert (other.value, other.reason) == (None, "its value must be the number of a class, 0, 2, not 1")


@pytest.mark.parametrize(
    ("classes", "message"),
    [
        ("3", "kind: classes: must be a table of 2 to 8 numbers with words"),
        ('{ 0 = "a" }', "kind: classes: must be a table of 2 to 8 numbers with words"),
        ('{ a = "a", 1 = "b" }', 'kind: classes: each class has a whole number, such as 0 = "stick", not "a"'),
        ('{ 0 = "a", 1 = "a" }', 'kind: classes: the numbers and words of classes must differ, but there is "a" twice'),
        ('{ 0 = "a", 1 = "" }', "kind: classes: 1: must be text of 1 to 40 letters"),
        ("{ 0 = 1, 1 = 2 }", "kind: classes: 0: must be text in quotes, not 1"),
    ],
)
def test_faults_of_classes(tmp_path: Path, classes: str, message: str) -> None:
    assert message in fault_of(with_classes, tmp_path, classes)[1]


def test_a_class_has_no_range() -> None:
    with pytest.raises(CaseFileError, match='regime is a class: take "last", "largest" or "smallest"'):
        outcomes_from({"it": {"quantity": "regime", "take": "range"}})
