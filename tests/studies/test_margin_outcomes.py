"""Margins of safety as outcomes, and the sections that stored runs keep."""

import json

import pytest

import fastpin
from fastpin import CaseFileError, cracks, damage
from fastpin.assess.fatigue import find
from fastpin.report import summary
from fastpin.storage import StoredResult
from fastpin.storage.held import Held
from fastpin.studies import parse_plan, read_plan, read_tolerances, sweep
from fastpin.studies.outcomes import value_of
from tests.support.commands import printed
from tests.support.faults import fault_of

CASE = """\
[pin]
material = "Ti-6Al-4V"
[plate]
E = 73e9
nu = 0.33
yield_strength = 379e6
fatigue = { fatigue_strength = 1.1e9, strength_exponent = -0.124, fatigue_ductility = 0.22, ductility_exponent = -0.59 }
[contact]
hole_radius = 10e-3
clearance = 40e-6
friction = 0.4
[[load]]
P = 3e6
[[load]]
Q = [7e5, -7e5]
repeat = 2
[fatigue]
life = 1e4
[crack]
first = 0.1e-3
last = 2e-3
theta = 81
law = { law = "walker", C = 5e-11, m = 3, threshold_range = 0.5e6, toughness = 35e6 }
[solve]
nodes = 41
"""

OUTCOMES = """\
[outcomes]
least = { margin = "least" }
plate = { margin = "yield", body = "plate" }
pin = { margin = "yield", body = "pin" }
fatigue = { margin = "fatigue" }
fracture = { margin = "fracture" }
growth = { margin = "growth" }
none = { margin = "ultimate" }
"""

ONE = 'case = "case.toml"\n[grid]\ncontact.friction = [0.4]\n'
STRENGTHS = 'case = "case.toml"\n[grid]\nplate.yield_strength = [150e6, 300e6]\n'


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A folder with a case."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "case.toml").write_text(CASE, encoding="utf-8")
    return tmp_path


def swept(folder, text):
    """The rows of a plan, solved in this process's workers."""
    (folder / "plan.toml").write_text(text, encoding="utf-8")
    plan = read_plan(folder / "plan.toml")
    summary_of = sweep.run(plan, folder / "plan", workers=1)
    assert (summary_of.failed, summary_of.unread) == ([], [])
    return sweep.rows(plan, folder / "plan")


@pytest.mark.gate
def test_outcomes_are_the_margins_of_the_table(folder):
    plan = parse_plan(ONE + OUTCOMES, folder=folder)
    case = plan.case(plan.points[0])
    result = fastpin.solve(case.problem, case.history, **case.options.keywords())
    values = {name: value_of(outcome, result).value for name, outcome in plan.outcomes.items()}
    fatigue = find(case, Held(result))
    crack = cracks.planned_growth(damage.cycle_states(result, result.cycles[-1]), case.crack)
    rows = summary.document(case, result, found={"fatigue": fatigue, "crack": crack})["margins"]
    least = {}
    for row in rows:
        if row["margin"] is not None:
            least[row["name"], row["body"]] = min(row["margin"], least.get((row["name"], row["body"]), 1e9))
    assert values["least"] == next(row["margin"] for row in rows if row["smallest"])
    assert values["plate"] == least["yield", "plate"] < values["pin"] == least["yield", "pin"]
    for name in ("fatigue", "fracture", "growth"):
        assert values[name] == least[name, "plate"]
    assert values["growth"] < values["least"]  # a crack that grows does not fail
    assert values["none"] is None


@pytest.mark.gate
def test_each_strength_has_its_own_run_and_margin(folder):
    """Strengths change no state: without outcomes of margins both points are one run."""
    plain = parse_plan(STRENGTHS, folder=folder)
    assert len(plain.runs) == 1
    rows = swept(folder, STRENGTHS + '[outcomes]\nmargin = { margin = "yield", body = "plate" }\n')
    assert len({row["id"] for row in rows} | set(plain.runs)) == 3
    low, high = (row["margin"] for row in rows)
    assert (high + 1.0) / (low + 1.0) == pytest.approx(2.0, rel=1e-12)
    for row in rows:  # the stored results have their own strengths
        strength = fastpin.load(folder / f"plan/results/{row['id']}.h5").problem.pair.plate.yield_strength
        assert strength == row["plate.yield_strength"]


@pytest.mark.gate
def test_another_strength_in_the_case_is_not_mixed_up(folder):
    """The same folder and plan, after the case got another strength: the margin is new, the old run is another one."""
    text = ONE + '[outcomes]\nm = { margin = "yield", body = "plate" }\n'
    (first,) = swept(folder, text)
    (folder / "case.toml").write_text(CASE.replace("379e6", "189.5e6"), encoding="utf-8")
    (second,) = swept(folder, text)
    assert first["id"] != second["id"]
    assert (first["m"] + 1.0) / (second["m"] + 1.0) == pytest.approx(2.0, rel=1e-12)


def test_an_outcome_that_is_added_later_changes_the_ids(folder):
    plain = parse_plan(STRENGTHS, folder=folder)
    more = plain.with_outcomes({"m": {"margin": "yield"}})
    whole = parse_plan(STRENGTHS + '[outcomes]\nm = { margin = "yield" }\n', folder=folder)
    assert [point.id for point in more.points] == [point.id for point in whole.points]
    assert [more.case(point).problem.pair.plate.yield_strength for point in more.points] == [150e6, 300e6]
    again = more.with_outcomes({"peak": {"quantity": "peak_pressure"}})
    assert again.points == more.points
    other = plain.with_outcomes({"peak": {"quantity": "peak_pressure"}})
    assert other.points == plain.points


@pytest.mark.gate
def test_a_tolerance_study_has_the_swing_of_the_least_margin(folder):
    (folder / "study.toml").write_text(
        'case = "case.toml"\nsamples = 0\n[tolerances]\nplate.yield_strength = { from = 350e6, to = 400e6 }\n'
        'loads = { from = 0.9, to = 1.1 }\n[outcomes]\nleast = { margin = "least" }\n',
        encoding="utf-8",
    )
    assert len(read_tolerances(folder / "study.toml").plan.runs) == 9
    lines = printed("tolerances", "study.toml", "--workers", "1", "--plot", "tornado.png").splitlines()
    at = next(k for k, line in enumerate(lines) if line.startswith("least: nominal "))
    fields = [line.split()[0] for line in lines[at + 2 :] if line.strip()]
    assert {"loads", "plate.yield_strength"} <= set(fields[:3])
    assert (folder / "tornado.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    ("outcome", "words"),
    [
        ('{ margin = "best" }', 'margin: must be "least", "yield", '),
        ('{ margin = "yield", body = "seat" }', "body: must be"),
        ('{ margin = "yield", take = "last" }', 'unknown key "take"'),
        ('{ margin = "fatigue" }', 'margin: "fatigue" needs a section [fatigue] of the case'),
        ('{ margin = "growth" }', 'margin: "growth" needs a section [crack] of the case'),
    ],
)
def test_wrong_outcomes_have_a_sentence(folder, outcome, words):
    text = CASE[: CASE.index("[fatigue]")] + "[solve]\nnodes = 41\n"
    (folder / "case.toml").write_text(text, encoding="utf-8")
    _, message = fault_of(parse_plan, f"{STRENGTHS}[outcomes]\nm = {outcome}\n", folder=folder)
    assert message.startswith("m: ")
    assert words in message


@pytest.mark.gate
@pytest.mark.parametrize("files", [False, True])
def test_stored_runs_keep_the_sections(folder, files):
    """``fastpin show`` and ``fastpin report`` of a stored run judge it as those of the case."""
    (folder / "plan.toml").write_text(ONE, encoding="utf-8")
    plan = read_plan(folder / "plan.toml")
    sweep.run(plan, folder / "plan", workers=1, files=files)
    path = folder / f"plan/results/{plan.points[0].id}.h5"
    assert path.exists() == files
    case = plan.case(plan.points[0])
    assert (StoredResult(path).case.fatigue, StoredResult(path).case.crack) == (case.fatigue, case.crack)
    if not files:  # the result goes from the index to a file
        sweep.run(plan, folder / "plan", workers=1, files=True)
        assert path.exists()
        assert (StoredResult(path).case.fatigue, StoredResult(path).case.crack) == (case.fatigue, case.crack)
    shown = json.loads(printed("show", path, "--json", "-"))
    ran = json.loads(printed("run", folder / "case.toml", "--json", "-"))
    assert shown["margins"] == ran["margins"]
    assert shown["fatigue"] == ran["fatigue"] is not None
    assert shown["crack"] == ran["crack"] is not None


def test_an_outcome_of_fatigue_names_its_criterion(folder):
    """A case with two criteria: an outcome takes the first one, or the one that it names."""
    shear = (
        "shear_fatigue_strength = 640e6, shear_strength_exponent = -0.124, shear_fatigue_ductility = 0.38, "
        "shear_ductility_exponent = -0.59, yield_strength = 379e6, normal_stress_factor = 1.0 }"
    )
    text = CASE.replace("ductility_exponent = -0.59 }", f"ductility_exponent = -0.59, {shear}", 1)
    text = text.replace("life = 1e4", 'criterion = ["smith-watson-topper", "fatemi-socie"]')
    (folder / "case.toml").write_text(text, encoding="utf-8")
    outcomes = 'first = { fatigue = "damage" }\nshear = { fatigue = "damage", criterion = "fatemi-socie" }\n'
    plan = parse_plan(f"{ONE}[outcomes]\n{outcomes}", folder=folder)
    case = plan.case(plan.points[0])
    result = fastpin.solve(case.problem, case.history, **case.options.keywords())
    found = result.assessed_fatigue(case.fatigue)
    first, second = (next(one for one in found if one.criterion == each) for each in case.fatigue.criteria)
    values = [value_of(outcome, result).value for outcome in plan.outcomes.values()]
    assert values == [first.hot_spot.damage, second.hot_spot.damage]
    both = '[outcomes]\nboth = { fatigue = "life", criterion = ["fatemi-socie", "smith-watson-topper"] }\n'
    with pytest.raises(CaseFileError, match="both: criterion: must be one criterion, not 2"):
        parse_plan(ONE + both, folder=folder)
