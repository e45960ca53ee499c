"""Plans: their runs, their ids, and their faults, all at once and each with its line."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from fastpin import CaseFileError, InputError
from fastpin.casefile import EXAMPLE, builtin_case, parse_case, reader
from fastpin.model import LOADS
from fastpin.model.checks import as_toml
from fastpin.studies import parse_plan, plan, read_plan
from fastpin.studies.identity import canonical, run_id
from tests.support.bodies import soft_plate
from tests.support.body_texts import HEAD
from tests.support.faults import fault_of
from tests.support.plans import planned
from tests.support.processes import finished, python

ROOT = Path(__file__).resolve().parents[2]
DIMENSIONLESS = """
[pin]
material = "steel"
[plate]
material = "aluminium"
[contact]
load_parameter = 0.1
friction = 0.4
[[load]]
P = 1
"""


def faults(text: str, folder: Path = ROOT) -> list[str]:
    with pytest.raises(CaseFileError) as caught:
        parse_plan(text, "plan", folder)
    return str(caught.value).splitlines()


def points(text: str, folder: Path | str = ROOT) -> list[dict[str, object]]:
    return [point.values for point in parse_plan(text, folder=folder).points]


# -- what is run ---------------------------------------------------------------------------------------------


def test_a_grid_is_every_combination_and_crossed_with_the_lists() -> None:
    found = points(
        """
        [grid]
        "contact.friction" = [0.2, 0.4]
        contact.clearance = [0.0, 1e-5]
        [[list]]
        pin.material = "steel"
        plate.material = "steel"
        [[list]]
        "pin.E" = 1e11
        """
    )
    assert len(found) == 8
    assert found[1] == {
        "pin.material": "steel",
        "plate.material": "steel",
        "contact.friction": 0.2,
        "contact.clearance": 1e-5,
    }
    assert found[-1] == {"pin.E": 1e11, "contact.friction": 0.4, "contact.clearance": 1e-5}


def test_ranges() -> None:
    plan = parse_plan(
        """
        [grid]
        contact.friction = { from = 0.1, to = 0.9, count = 9 }
        "contact.clearance" = { from = 1e-6, to = 1e-3, count = 4, spacing = "log" }
        [grid.solve]
        nodes = { from = 101, to = 301, count = 3 }
        """
    )
    assert plan.fields == {"contact.friction": "linear", "contact.clearance": "log", "solve.nodes": "linear"}
    assert len(plan.points) == 9 * 4 * 3
    assert sorted({point.values["contact.friction"] for point in plan.points}) == [k / 10 for k in range(1, 10)]
    assert sorted({point.values["contact.clearance"] for point in plan.points}) == [1e-6, 1e-5, 1e-4, 1e-3]
    nodes = [point.values["solve.nodes"] for point in plan.points[:3]]
    assert nodes == [101, 201, 301]
    assert all(isinstance(count, int) for count in nodes)


def test_fields_reach_the_case() -> None:
    plan = parse_plan(
        """
        [grid]
        "load.2.Q" = [[1e5, -1e5], 3e5]
        contact.plane = ["stress"]
        solve.between = [[0.5]]
        """
    )
    first, second = (plan.case(point) for point in plan.points)
    assert first.history.values()[:, LOADS.index("Q")].tolist() == [0.0, 1e5, -1e5]
    assert second.history.values()[:, LOADS.index("Q")].tolist() == [0.0, 3e5]
    assert first.problem.pair.plane == "stress"
    assert first.options.between == (0.5,)
    assert first.problem.friction == builtin_case().problem.friction


def test_the_base_case_lies_beside_the_plan_and_its_loads_beside_it(tmp_path: Path) -> None:
    below = tmp_path / "below"
    below.mkdir()
    for name, force in (("a", 1.0), ("b", 2.0)):
        (below / f"{name}.csv").write_text(f"P\n{force}\n")
    (below / "case.toml").write_text(DIMENSIONLESS)
    path = tmp_path / "plan.toml"
    path.write_text('case = "below/case.toml"\n[grid]\nhistory.csv = ["a.csv", "b.csv"]\n')
    plan = read_plan(path)
    assert [plan.case(point).history.values()[0, 0] for point in plan.points] == [1.0, 2.0]


def test_a_plan_reads_a_case_once_unless_there_are_too_many(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("fastpin.studies.plan.MOST_CASES", 2)
    plan = parse_plan("[grid]\ncontact.friction = [0.1, 0.2, 0.3]\n")
    first, second, third = plan.points
    assert plan.case(first) is plan.case(first)
    assert plan.case(third) is not plan.case(third)
    assert [plan.case(point).problem.friction for point in (first, second, third)] == [0.1, 0.2, 0.3]


READ = {
    "loads": ("a.csv", 'history.csv = ["a.csv", "b.csv"]', EXAMPLE, "P\n1\n", "P\n2\n"),
    "samples of a gap": (
        "a.csv",
        "contact.friction = [0.1]",
        HEAD + '[gap]\nhole = "a.csv"\n',
        "x,g\n0,0\n90,1e-6\n180,0\n270,1e-6\n",
        "x,g\n0,0\n90,2e-6\n180,0\n270,1e-6\n",
    ),
    "a compliance": (
        "a.json",
        'plate_body.file = ["a.json"]',
        HEAD,
        soft_plate().to_text(),
        soft_plate(0.125).to_text(),
    ),
}
"""A file, the axis of the plan, the case, and the text of the file before and after a change."""


@pytest.mark.parametrize("name", READ)
@pytest.mark.parametrize("gone", [False, True])
def test_a_file_that_changes_after_the_plan_was_read_is_not_run(name: str, gone: bool, tmp_path: Path) -> None:
    file_name, axis, case, before, after = READ[name]
    file = tmp_path / file_name
    for each in (file, tmp_path / "b.csv"):
        each.write_text(before)
    plan = planned(tmp_path, case, f"[grid]\n{axis}\n")
    assert plan.case(plan.points[-1])
    if gone:
        file.unlink()
    else:
        file.write_text(after)
    with pytest.raises(InputError, match="files of its loads, bodies or materials have changed"):
        plan.case(plan.points[0])


@pytest.mark.parametrize(
    ("fields", "pin", "plate"),
    [
        ('pin.material = "steel"', (210e9, 0.3), (69e9, 0.33)),
        ("pin.E = 1e11", (1e11, 0.32), (69e9, 0.33)),  # the other constant stays that of the named material
        ("pin.nu = 0.25", (116e9, 0.25), (69e9, 0.33)),
        ('plate.material = "steel"', (116e9, 0.32), (210e9, 0.3)),
        ("plate.E = 2e11", (116e9, 0.32), (2e11, 0.33)),
        ("pin.rigid = true", (np.inf, 0.3), (69e9, 0.33)),
        ("pin.rigid = false", (116e9, 0.32), (69e9, 0.33)),
    ],
)
def test_one_way_to_give_a_material_replaces_the_others(fields, pin, plate):
    plan = parse_plan(f"[[list]]\n{fields}\n")
    pair = plan.case(plan.points[0]).problem.pair
    assert (pair.pin.E, pair.pin.nu) == pin
    assert (pair.plate.E, pair.plate.nu) == plate


def test_dundurs_parameters_replace_two_materials_and_the_other_way_round(tmp_path: Path) -> None:
    plan = planned(tmp_path, DIMENSIONLESS, "[[list]]\ndundurs = {alpha = 0.2, beta = 0.1, nu_pin = 0.3}\n")
    assert plan.case(plan.points[0]).problem.pair.dundurs() == pytest.approx((0.2, 0.1))
    dundurs = DIMENSIONLESS.replace(
        '[pin]\nmaterial = "steel"\n[plate]\nmaterial = "aluminium"', "[dundurs]\nalpha = 9"
    )
    plan = planned(tmp_path, dundurs, '[[list]]\npin.material = "steel"\nplate.material = "nickel alloy"\n')
    assert plan.case(plan.points[0]).problem.pair.plate.name == "nickel alloy"


# -- ids -----------------------------------------------------------------------------------------------------


SHARED = """
[grid]
contact.friction = [0.2, 0.4]
contact.plane = ["strain", "stress"]
load.2.Q = [1e5, -0.0, 1e5]
solve.nodes = [101, 51]
contact.thickness = [0.01, 0.02]
[[list]]
pin.material = "steel"
[[list]]
pin.material = "mine"
[[list]]
pin.nu = 0
[[list]]
pin.nu = 0.0
"""


def test_a_run_is_the_same_case_alone_and_among_others(tmp_path: Path) -> None:
    """Neighbouring points share parts of their case. Each id equals that of a plan with one point."""
    case = """
    materials = "mine.toml"
    [pin]
    material = "mine"
    [plate]
    material = "aluminium"
    [contact]
    hole_radius = 0.01
    clearance = 1e-5
    friction = 0.4
    thickness = 0.01
    [[load]]
    P = 1e6
    [[load]]
    Q = 1e5
    """
    (tmp_path / "mine.toml").write_text("[mine]\nE = 1e11\nnu = 0.3\n")
    whole = planned(tmp_path, case, SHARED)
    assert (len(whole.points), len(whole.runs)) == (192, 96)
    for point in whole.points[::7]:
        rows = "\n".join(f"{name} = {as_toml(value)}" for name, value in point.values.items())
        alone = parse_plan(f'case = "case.toml"\n[[list]]\n{rows}\n', folder=tmp_path).points
        assert [(found.id, found.input) for found in alone] == [(point.id, point.input)]
        assert run_id(canonical(whole.case(point))) == point.id


@pytest.mark.parametrize("part", ["read_pair", "read_history", "_options"])
def test_parts_that_no_field_changes_are_read_once(part: str, monkeypatch: pytest.MonkeyPatch) -> None:
    calls, read = [], getattr(reader, part)

    def counted(*arguments: object) -> object:
        calls.append(1)
        return read(*arguments)

    monkeypatch.setattr(reader, part, counted)
    assert len(parse_plan("[grid]\ncontact.friction = { from = 0.1, to = 0.5, count = 50 }").points) == 50
    assert len(calls) == 1


def test_the_id_depends_on_the_input_and_on_nothing_else() -> None:
    other = '[contact]\nfriction = 0.40\npin_load = "body"\nclearance = 2e-5\nhole_radius = 0.01\n'
    other += "[plate]\nnu = 0.33\nE = 6.9e10\n[pin]\nnu = 0.32\nE = 116e9 # titanium\n"
    other += "[[load]]\nP = 2420000\nQ = -0.0\n[[load]]\nQ = 7.26e5\n[[load]]\nQ = -7.26e5\n[[load]]\nQ = 7.26e5\n"
    first = parse_case(EXAMPLE.replace("\nP = 2.42e6", "\nP = 2.42e6\nQ = 0"))
    assert run_id(canonical(first)) == run_id(canonical(parse_case(other)))
    # never given is not the same as zero
    assert run_id(canonical(first)) != run_id(canonical(builtin_case()))


def test_parts_of_blocks_are_varied(tmp_path: Path) -> None:
    harmonic = "[[load]]\nmean = { P = 1e6 }\namplitude = { Q = 1e5, sxx = 1e6 }\nrepeat = 3\n[history]\nrepeat = 2\n"
    text = "[grid]\nload.3.amplitude.Q = [1e5, 2e5]\nload.3.phase = { sxx = [0, 90] }\n"
    plan = planned(tmp_path, EXAMPLE + harmonic, text + "history.repeat = [2, 5]\nload.3.repeat = [4]\n")
    assert len(plan.points) == len(plan.runs) == 8
    for point in plan.points:
        history = plan.case(point).history
        points = 2 if point.values["load.3.phase.sxx"] == 0 else 24
        assert len(history) == point.values["history.repeat"] * (4 + 1 + 4 * points)
        assert history.values()[4, 1] == point.values["load.3.amplitude.Q"]
        assert history.values()[4, 3] == pytest.approx(1e6 if points == 2 else 0.0)


def test_blocks_that_are_cycles_are_other_input() -> None:
    once = EXAMPLE.replace("# repeat = 1000  ", "repeat = 2  ")
    spelt = EXAMPLE.replace("Q = [7.26e5, -7.26e5, 7.26e5]", "Q = [7.26e5, -7.26e5, 7.26e5, 7.26e5, -7.26e5, 7.26e5]")
    ids = [run_id(canonical(parse_case(text))) for text in (EXAMPLE, once, spelt)]
    assert len(set(ids)) == 3
    assert run_id(canonical(parse_case(once + "shortcut = false\n"))) == ids[1]
    assert run_id(canonical(parse_case(once + 'keep = "cycles"\n'))) != ids[1]


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("nodes = 401", "nodes = 402"),
        ("E  = 69e9", "E  = 69.000000000001e9"),
        ('"body" ', '"centre" '),
        ("friction = 0.4", "friction = 0.4000000000000001"),
        ("Q = [7.26e5, -7.26e5, 7.26e5]", "Q = [7.26e5, -7.26e5]"),
        ("# between = 3", "between = 3"),
    ],
)
def test_every_bit_of_the_input_counts(old: str, new: str) -> None:
    assert old in EXAMPLE
    assert run_id(canonical(parse_case(EXAMPLE.replace(old, new)))) != run_id(canonical(builtin_case()))


def test_what_is_not_used_does_not_count() -> None:
    for line in ("shortcut = false", "error_bars = false"):
        assert run_id(canonical(parse_case(f"{EXAMPLE}{line}\n"))) == run_id(canonical(builtin_case()))
    assert run_id(canonical(parse_case(f"{EXAMPLE}error_bars = true\n"))) != run_id(canonical(builtin_case()))
    with pytest.raises(CaseFileError, match="increments: has no effect"):
        parse_case(EXAMPLE.replace("# increments = 80", "increments = 90"))
    increment = EXAMPLE.replace('method = "path"', 'method = "increment"')
    ids = {run_id(canonical(parse_case(increment.replace("# increments = 80", f"increments = {n}")))) for n in (80, 90)}
    assert len(ids) == 2


def test_another_version_of_the_solver_is_another_run() -> None:
    document = canonical(builtin_case())
    assert run_id(document, "1.0") != run_id(document, "1.1")


@pytest.mark.gate
def test_ids_are_the_same_in_every_process() -> None:
    code = (
        "from fastpin.casefile import builtin_case; from fastpin.studies.identity import *; "
        "print(run_id(canonical(builtin_case()), '1'))"
    )
    found = [finished(python(code), env={"PYTHONHASHSEED": seed}).stdout for seed in ("1", "2")]
    assert found == [run_id(canonical(builtin_case()), "1") + "\n"] * 2


def test_points_with_the_same_input_are_one_run() -> None:
    plan = parse_plan(
        '[grid]\n"pin.material" = ["steel"]\n[[list]]\nplate.nu = 0.33\n[[list]]\ncontact.friction = 0.4\n'
    )
    assert len(plan.points) == 2
    assert len(plan.runs) == 1
    assert next(iter(plan.runs.values())).values == plan.points[0].values


def test_the_digest_is_that_of_fields_and_runs() -> None:
    def digest(text: str) -> str:
        return parse_plan(text).digest

    assert digest("[grid]\ncontact.friction = [0.2, 0.3]") == digest(
        'title = "x"\n[grid]\n"contact.friction" = [3e-1, 0.2] # reversed'
    )
    assert digest("[grid]\ncontact.friction = [0.2, 0.3]") != digest("[grid]\ncontact.friction = [0.2]")


# -- faults --------------------------------------------------------------------------------------------------


def test_all_faults_of_the_text_come_at_once_with_their_lines() -> None:
    text = """titel = "x"
[grid]
"contact.frition" = [0.2]
"load.5.Q" = [2]
pin.nu = { from = 1, to = 3, count = 2.5, spac = 3 }
contact.load_parameter = [1]
contact.friction = 0.3
x.y = [3]
contact.plane = []
load.Q = [1]
title = ["a"]
plate.nu = { from = -1, to = 1, count = 3, spacing = "log" }
[[list]]
contact.friction = 0.3
"""
    expected = [
        (1, 'unknown key "titel", did you mean "title"?'),
        (3, '"contact.frition": there is no key "frition" in [contact], did you mean "friction"?'),
        (4, '"load.5.Q": the case has 2 [[load]] blocks, counted from 1'),
        (5, 'pin.nu: unknown key "spac" in a range; there are from, to, count, spacing'),
        (5, "pin.nu: count: must be a whole number from 2 to 100000, not 2.5"),
        (6, "contact.load_parameter: the base case gives a hole radius and a clearance, and loads in N/m"),
        (7, "contact.friction: is varied already, in line 14"),
        (8, '"x.y": there is no section [x] in a case file'),
        (9, "contact.plane: must be a list of values, or { from = 0.1, to = 1.0, count = 10 }, not an empty list"),
        (10, '"load.Q": a load is written load.N.key'),
        (11, '"title": there is no section [title] in a case file'),
        (12, "plate.nu: from and to must both be positive, or both negative, where spacing is log"),
    ]
    found = faults(text)
    assert len(found) == len(expected)
    for line, (number, words) in zip(found, expected, strict=True):
        assert line.startswith(f"plan, line {number}: {words}"), line


def test_a_bad_value_names_field_value_and_run() -> None:
    text = """[grid]
contact.friction = [0.2, -1]
load.2.Q = [
    2, "a"]
[[list]]
pin.material = "stahl"
[[list]]
pin.E = 1e11
"""
    assert faults(text) == [
        "plan, line 2: contact.friction: must not be negative, not -1 "
        '(in 4 runs, first pin.material = "stahl", contact.friction = -1, load.2.Q = 2)',
        'plan, line 3: load.2.Q: must be a number, not "a" '
        '(in 4 runs, first pin.material = "stahl", contact.friction = 0.2, load.2.Q = "a")',
        'plan, line 6: pin.material: there is no material "stahl", did you mean "steel"? '
        '(in 4 runs, first pin.material = "stahl", contact.friction = 0.2, load.2.Q = 2)',
    ]


def test_what_a_field_breaks_elsewhere_is_told_with_the_case_s_line(tmp_path: Path) -> None:
    (tmp_path / "case.toml").write_text(EXAMPLE)
    line = EXAMPLE.splitlines().index(next(row for row in EXAMPLE.splitlines() if row.startswith("clearance"))) + 1
    text = 'case = "case.toml"\n[grid]\ncontact.hole_radius = [1e-2, 1e-5]\n'
    (found,) = faults(text, tmp_path)
    assert found.startswith(
        f"plan, line 1: case.toml, line {line}: clearance: must lie between minus and plus the hole"
    )
    assert found.endswith("(in the run contact.hole_radius = 1e-05)")


def test_sections_that_a_plan_makes_are_checked(tmp_path: Path) -> None:
    (tmp_path / "case.toml").write_text(DIMENSIONLESS)
    found = faults('case = "case.toml"\n[grid]\ndundurs.alpha = [0.2]\n', tmp_path)
    assert [line[:40] for line in found] == ["plan, line 3: dundurs.alpha: [dundurs]: "] * 2


LABELLED = "[grid]\ncontact.friction = [0.2, 0.4]\n[labels]\n"


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "nothing is varied"),
        ('case = "missing.toml"\n[grid]\nsolve.nodes = [41]', "missing.toml: there is no such file"),
        ("[list]\npin.E = 1", "line 1: lists are [[list]] blocks"),
        ("[[list]]", "line 1: [[list]]: gives no field"),
        ("grid = 3", "line 1: grid: must be a section [grid], not 3"),
        ("[grid]\nload.1.amplitude = [1]", 'line 2: "load.1.amplitude": write one load of amplitude'),
        ("[grid]\nload.1.amplitude.X = [1]", "write one load of amplitude, such as load.1.amplitude.Q"),
        ('[grid]\n"load.1.Q.X" = [1]', "only mean, amplitude and phase"),
        ('[[list]]\nload.1.P = 1\nhistory.csv = "a.csv"', "line 3: history.csv: can't be given together with load.1.P"),
        ("[grid]\ncontact.friction = [nan]", "line 2: contact.friction: must be a finite number, not nan"),
        ("[grid]\ncontact.friction = [0.2, .3]", "line 2: contact.friction: must be"),
        ("[grid]\ncontact.friction = [1979-05-27]", "line 2: contact.friction: must be a number, not 1979-05-27"),
        (
            f'{LABELLED}contact.frictoin = "mu"',
            'line 4: labels: the plan has no "contact.frictoin", did you mean "contact.friction"?',
        ),
        (
            f'{LABELLED}wear = "W"',
            'line 4: labels: the plan has no "wear"; a label is for a varied field, an outcome or a key figure',
        ),
        (f"{LABELLED}contact.friction = 3", "line 4: labels: contact.friction: must be text in quotes, not 3"),
        (f'{LABELLED}contact.friction = ""', "line 4: labels: contact.friction: must be text of 1 to 80 letters"),
    ],
)
def test_single_faults(text: str, words: str, tmp_path: Path) -> None:
    (found,) = faults(text, tmp_path)
    assert words in found


def test_units_of_the_loads_stay_those_of_the_case(tmp_path: Path) -> None:
    _, found = fault_of(planned, tmp_path, DIMENSIONLESS, "[grid]\ncontact.clearance = [1e-5]\n")
    assert "vary contact.load_parameter, or take a base case with hole_radius" in found
    plan = planned(tmp_path, DIMENSIONLESS, "[grid]\ncontact.load_parameter = [0.2, 0.5]\n")
    assert [plan.case(point).problem.clearance for point in plan.points] == [0.2, 0.5]


def test_faults_of_the_base_case_are_told_with_its_lines(tmp_path: Path) -> None:
    (tmp_path / "case.toml").write_text(EXAMPLE.replace("friction = 0.4", "friction = much").replace("0.33", "3.3"))
    text = 'case = "case.toml"\n[grid]\nsolve.nodes = [41, 51]\n'
    (found,) = faults(text, tmp_path)
    assert found.startswith("plan, line 1: case.toml, line ")
    (tmp_path / "case.toml").write_text(EXAMPLE.replace("0.33", "3.3"))
    (found,) = faults(text, tmp_path)
    assert found.startswith("plan, line 1: case.toml, line ")
    assert found.endswith("must lie between 0 and 0.5, not 3.3")  # of all runs, which need not be named


def test_a_plan_with_too_many_runs_is_refused_before_they_are_made() -> None:
    ranges = "\n".join(f"load.1.{name} = {{ from = 1.0, to = 2.0, count = 1000 }}" for name in ("P", "Q", "sxx", "syy"))
    (found,) = faults(f"[grid]\n{ranges}")
    assert "the plan has 1,000,000,000,000 runs; more than 100,000 are not possible in one" in found


def test_a_flood_of_faults_is_cut(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(plan, "MAX_FAULTS", 3)
    found = faults(f"[grid]\ncontact.friction = {[-k for k in range(1, 11)]}")
    assert len(found) == 4
    assert any("and 7 more faults in the runs" in line for line in found)


def test_labels_change_no_run() -> None:
    plain = "[grid]\ncontact.friction = [0.2, 0.4]\n"
    plan = parse_plan(f'{plain}[labels]\n"contact.friction" = "mu"\npeak_pressure = "N"\n')
    assert plan.labels == {"contact.friction": "mu", "peak_pressure": "N"}
    assert plan.digest == parse_plan(plain).digest
    assert parse_plan(plain).labels == {}
