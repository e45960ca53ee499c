"""``fastpin verify``: it passes here, its tolerances are close, and it fails where something is wrong."""

import json
import math
import re
from pathlib import Path

import numpy as np
import pytest

from fastpin import ConvergenceError
from fastpin.cli.main import main
from fastpin.cli.verify import check_table as table
from fastpin.elasticity import stress as formulas
from fastpin.kernels import cauchy, conjugate, influence
from fastpin.reading import stress
from fastpin.solver import solving
from fastpin.verification import checks as installation
from fastpin.verification import closed_forms, finite_elements, rows
from fastpin.verification.checks import TOPICS
from fastpin.verification.rows import Check
from tests.support.checks.topics import FURTHER
from tests.support.tiers import gate, some_gate

MOST_SLACK = 3.0
ROUNDING = {
    "mirror", "conditions", "parts", "stresses", "bodies, exact", "gaps, exact", "friction, exact", "wear, exact",
    "cracks, exact", "laminates, exact",
}  # fmt: skip
SLOW = "all round", "further bodies", "further coupled", "further seats", "further wear"
STATED = {"elements, frictionless", "elements, monotonic", "elements, fretting", "laminates, elements"}


@pytest.fixture
def only(monkeypatch: pytest.MonkeyPatch) -> object:
    """Leave out all topics but some."""

    def choose(*keys: str) -> None:
        known = FURTHER | TOPICS
        monkeypatch.setattr(installation, "TOPICS", {key: known[key] for key in keys})

    return choose


def table_lines(capsys: pytest.CaptureFixture[str]) -> list[str]:
    return capsys.readouterr().out.splitlines()


# -- it passes -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("key", some_gate([*TOPICS, *(f"further {key}" for key in FURTHER)], *SLOW))
def test_a_topic_passes_with_tolerances_that_are_used_and_not_slack(monkeypatch, key: str) -> None:
    """Tolerances of discretisation errors are at most three times the largest difference of their rows."""
    topics, key = (FURTHER, key.removeprefix("further ")) if key.startswith("further ") else (TOPICS, key)
    keys = ("parts", "seats", key) if key == "conditions" else (key,)  # these are conditions of other topics' states
    monkeypatch.setattr(installation, "TOPICS", {each: topics[each] for each in keys})
    checks = [check for check in installation.verify() if check.topic == topics[key].title]
    assert [check for check in checks if not check.passed] == []
    names = {name for check in checks for name in (check.quantity, f"{check.quantity}, {check.case}")}
    assert set(topics[key].tolerances) <= names
    largest: dict[tuple[str, float | None], float] = {}
    for check in checks:
        if check.reference is None or check.ours is None:
            assert check.ours is check.reference is None
        else:
            size = check.reference if check.unit == "relative" else 1.0
            assert check.difference == pytest.approx(abs((check.ours - check.reference) / size), rel=1e-9, abs=1e-15)
        if check.difference is not None:
            name = check.quantity, check.tolerance
            largest[name] = max(largest.get(name, 0.0), check.difference)
    if key not in ROUNDING | STATED:
        assert [name for name, difference in largest.items() if not name[1] <= MOST_SLACK * difference] == []


@pytest.mark.gate
def test_a_table_in_columns(only) -> None:
    only("parts", "laminates, exact")
    checks = installation.verify()
    lines = table(checks).splitlines()
    assert max(map(len, lines)) <= 120
    head = next(line for line in lines if "tolerance" in line)
    rows = [line for line in lines if line.endswith(" ok")]
    assert len(rows) == len(checks)
    for title in ("difference", "tolerance"):
        stop = head.index(title) + len(title)
        for row in rows:
            assert row[stop - 1] != " "
            assert row[stop : stop + 2] == "  "
    assert len({len(row) for row in rows}) == 1
    assert lines.count(TOPICS["parts"].title) == 1


@pytest.mark.survey
@pytest.mark.parametrize(("place", "topics"), [(0, TOPICS), (1, FURTHER)], ids=["installation", "further"])
def test_the_document_shows_the_whole_tables(monkeypatch, place: int, topics: dict) -> None:
    """But for what rounding may change: the values and their differences."""
    monkeypatch.setattr(installation, "TOPICS", topics)
    checks = installation.verify()
    assert {check.topic for check in checks} == {topic.title for topic in topics.values()}
    document = (Path(__file__).parents[2] / "docs" / "accuracy-tables.md").read_text(encoding="utf-8")
    shown = re.findall(r"```text\n(.*?)\n```", document, re.DOTALL)
    assert len(shown) == 2
    expected = table(checks).splitlines()
    head = next(line for line in expected if "tolerance" in line)
    values = slice(head.index("reference") - 1, head.index("tolerance"))
    lines = shown[place].splitlines()
    if topics is TOPICS:
        assert f"{len(checks)} of {len(checks)} within tolerance" in lines.pop()
        assert lines.pop() == ""
    for line, true in zip(lines, expected, strict=True):
        assert line[: values.start] == true[: values.start]
        assert line[values.stop :] == true[values.stop :]


def test_progress() -> None:
    calls: list[tuple[int, int]] = []

    def stop(done: int, total: int) -> None:
        calls.append((done, total))
        if done == 2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        installation.verify(stop)
    total = sum(len(topic.cases) for topic in TOPICS.values())
    assert calls == [(0, total), (1, total), (2, total)]


# -- it fails ------------------------------------------------------------------------------------------------


@pytest.mark.gate
def test_a_wrong_closed_form_is_seen(only, monkeypatch, capsys) -> None:
    only("like", "parts")
    exact = closed_forms.persson_pressure
    monkeypatch.setattr(closed_forms, "persson_pressure", lambda *given: exact(*given) * (1.0 + 2e-5))
    assert main(["verify"]) == 1
    lines = table_lines(capsys)
    failed = [line for line in lines if "FAILED" in line]
    assert len(failed) == 4
    assert all("peak N" in line for line in failed)
    assert lines[-1].startswith("6 of 10 within tolerance, ")


@pytest.mark.parametrize(
    ("name", "topic"), [("fill_operator", "like"), ("fill_operator", "equations"), ("fill_cauchy", "equations")]
)
def test_a_wrong_kernel_is_seen(only, monkeypatch, name: str, topic: str) -> None:
    """A ten-thousandth too large."""
    only(topic)
    exact = getattr(influence, name)

    def wrong(*given):
        returned = exact(*given)
        given[-1][...] *= 1.0001
        return returned

    monkeypatch.setattr(influence, name, wrong)
    assert not all(check.passed for check in installation.verify())
    assert main(["verify"]) == 1


def failed_cases(checks: list[Check]) -> set[tuple[str, str]]:
    return {(check.quantity, check.case) for check in checks if not check.passed}


@pytest.mark.gate
def test_a_wrong_conjugate_of_the_shear_is_seen(only, monkeypatch) -> None:
    """The hoop stress on the edge, a billionth too large."""
    only("stresses")
    exact = conjugate.edge

    def wrong(*given):
        exact(*given)
        given[-1][1] *= 1.0 + 1e-9

    monkeypatch.setattr(conjugate, "edge", wrong)
    seen = failed_cases(installation.verify())
    for case in ("free rotation, plate", "free rotation, pin", "held rotation, plate", "held rotation, pin"):
        assert ("on the edge", case) in seen


@pytest.mark.gate
def test_a_wrong_kernel_of_the_stresses_is_seen(only, monkeypatch) -> None:
    """A billionth too large. Neither an open hole nor an even pressure has Cauchy integrals in the plate."""
    only("stresses")
    exact = cauchy.cauchy

    def wrong(*given):
        exact(*given)
        given[-1][...] *= 1.0 + 1e-9

    monkeypatch.setattr(cauchy, "cauchy", wrong)
    checks = installation.verify()
    passed = {(check.quantity, check.case) for check in checks if check.passed}
    assert {("Kirsch", "open hole"), ("Lame", "interference fit, plate")} <= passed
    seen = failed_cases(checks)
    assert ("Lame", "interference fit, pin") in seen
    for case in ("free rotation, plate", "free rotation, pin", "held rotation, plate", "held rotation, pin"):
        assert {("on the edge", case), ("force", case)} <= seen


@pytest.mark.gate
@pytest.mark.parametrize(("body", "name"), [*gate(("plate", "plate_stress")), ("pin", "pin_stress")])
def test_a_wrong_share_of_the_force_is_seen_by_the_strains(only, monkeypatch, body: str, name: str) -> None:
    """A thousandth of the hoop stress of one wave. It changes neither the tractions on the edge nor the resultants."""
    only("strains")
    exact = getattr(formulas, name)

    def wrong(problem, tractions, *given):
        stresses, theta = exact(problem, tractions, *given), given[-2]
        stresses[1] += 1e-3 * np.sin(theta)
        return stresses

    monkeypatch.setattr(stress, name, wrong)
    assert not any(check.passed for check in installation.verify())


@pytest.mark.parametrize("factor", [0.99, 1.01])
def test_a_wrong_stress_of_the_half_plane_is_seen(only, monkeypatch, factor: float) -> None:
    """The peak of the hoop stress has a reference of its own."""
    only("stresses, half-plane")
    exact = closed_forms.elliptic_stress
    monkeypatch.setattr(closed_forms, "elliptic_stress", lambda *given: factor * exact(*given))
    seen = failed_cases(installation.verify())
    assert seen == {("stresses", f"{load}, {body}") for load in ("+Q", "-Q") for body in ("plate", "pin")}


@pytest.mark.gate
def test_a_wrong_sign_of_the_shear_stress_is_seen(only, monkeypatch) -> None:
    only("stresses, half-plane", "stresses")
    exact = formulas.pin_stress
    monkeypatch.setattr(stress, "pin_stress", lambda *given: exact(*given) * np.array([[1.0], [1.0], [-1.0]]))
    seen = failed_cases(installation.verify())
    assert {case.split(", ")[-1] for _, case in seen} == {"pin"}
    assert {"stresses", "on the edge", "force", "moment"} == {quantity for quantity, _ in seen}


def test_a_wrong_reference_is_seen(only, monkeypatch, capsys) -> None:
    only("elements, monotonic")
    read = finite_elements.FiniteElements.read

    def moved(name: str) -> finite_elements.FiniteElements:
        model = read(name)
        model.pressure[:] = np.roll(model.pressure, 1, axis=1)
        return model

    monkeypatch.setattr(installation.FiniteElements, "read", moved)
    assert main(["verify"]) == 1
    assert [line.split()[-1] for line in table_lines(capsys) if " int |d" in line] == ["FAILED", "ok"]


def test_a_part_that_is_off_by_rounding_is_seen(only, monkeypatch) -> None:
    only("parts")
    exact = solving.solve

    def rounded(problem, history, **options):
        if "start" in options:
            history = [{"Q": history[0]["Q"] * (1.0 + 1e-15)}, *history[1:]]
        return exact(problem, history, **options)

    monkeypatch.setattr(rows, "solve", rounded)
    checks = installation.verify()
    assert not any(check.passed for check in checks)
    assert all(check.ours is not None and check.ours > 100.0 for check in checks)


def test_what_is_no_number_does_not_pass(only, monkeypatch, capsys, tmp_path) -> None:
    only("half-plane", "conditions")
    monkeypatch.setattr(closed_forms, "cattaneo_mindlin_shear", lambda x, *_: math.nan * x)
    assert main(["verify", "--json", str(tmp_path / "checks.json")]) == 1
    assert len([line for line in table_lines(capsys) if "nan" in line and "FAILED" in line]) == 7
    document = json.loads((tmp_path / "checks.json").read_text())
    assert [one["difference"] for one in document["checks"] if one["quantity"] == "int |dT|"] == [None] * 3


def test_an_error_is_a_row_that_fails_and_the_others_are_made(only, monkeypatch, capsys) -> None:
    only("like", "conditions")
    exact = solving.solve

    def refusing(problem, *given, **options):
        if problem.clearance == 0.1:
            raise ConvergenceError("the statuses\ndo not settle")
        return exact(problem, *given, **options)

    monkeypatch.setattr(rows, "solve", refusing)
    assert main(["verify"]) == 1
    lines = table_lines(capsys)
    (failed,) = [line for line in lines if "FAILED" in line]
    assert " ".join(failed.split()) == "L_p = 0.1 FAILED: ConvergenceError: the statuses do not settle"
    assert "all 3 states" in "\n".join(lines)
    assert lines[-1].startswith("7 of 8 within tolerance, ")


def test_reference_files_that_are_not_there_are_seen(only, monkeypatch, capsys, tmp_path) -> None:
    only("elements, frictionless", "elements, monotonic")
    monkeypatch.setattr(finite_elements, "REFERENCE", tmp_path)
    assert main(["verify"]) == 1
    lines = table_lines(capsys)
    assert len([line for line in lines if "FAILED: FileNotFoundError" in line]) == 2
    assert lines[-1].startswith("0 of 2 within tolerance, ")


def test_without_any_state_the_conditions_do_not_pass(only) -> None:
    only("conditions")
    (check,) = installation.verify()
    assert not check.passed


# -- what is handed out --------------------------------------------------------------------------------------


def test_json_instead_of_the_table(only, capsys) -> None:
    only("like")
    assert main(["verify", "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert document["passed"] is True
    assert document["cores"] >= 1
    assert document["versions"]["fastpin"] == document["fastpin"]
    assert len(document["checks"]) == 8
    first = document["checks"][0]
    assert first["passed"] is True
    assert first["unit"] == "relative"
    assert first["difference"] <= first["tolerance"] == TOPICS["like"].tolerances["peak N"]


def test_json_beside_the_table(only, capsys, tmp_path) -> None:
    only("like")
    file = tmp_path / "checks.json"
    assert main(["verify", "--json", str(file)]) == 0
    assert table_lines(capsys)[-1].startswith("8 of 8 within tolerance, ")
    assert json.loads(file.read_text())["passed"] is True


def test_a_file_that_cannot_be_written_is_found_before_the_work(monkeypatch, capsys, tmp_path) -> None:
    monkeypatch.setattr(installation, "verify", None)
    assert main(["verify", "--json", str(tmp_path / "no" / "checks.json")]) == 2
    assert "does not exist" in capsys.readouterr().err


def test_a_file_that_cannot_be_written_after_it(only, monkeypatch, capsys, tmp_path) -> None:
    only("conditions")
    file = tmp_path / "checks.json"

    def full(*_: object, **__: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Path, "write_text", full)
    assert main(["verify", "--json", str(file)]) == 1
    captured = capsys.readouterr()
    assert "0 of 1 within tolerance" in captured.out
    assert "can't be written" in captured.err
    assert not file.exists()
