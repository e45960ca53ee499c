"""Tables of sweeps, and the numbers that their figures show."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fastpin import InputError, Result
from fastpin.figures import plot_sweep
from fastpin.report.sweep import chart, check_axes, restricted, text, where_words, write_csv
from fastpin.studies import parse_plan, sweep
from fastpin.studies.plan import Plan
from fastpin.studies.variation import field_words
from tests.support.plans import FRICTION, MAP, made_up_rows
from tests.support.refusals import refused


@pytest.fixture(scope="module")
def plan() -> Plan:
    return parse_plan(MAP)


@pytest.fixture
def rows(plan: Plan) -> list[dict[str, Any]]:
    return made_up_rows(plan)


def test_axes_are_chosen(plan: Plan) -> None:
    others = ["pin.material", "pin.E"]
    assert check_axes(plan, "dx", None, None) == ("contact.friction", "contact.clearance", others)
    assert check_axes(plan, "dx", "contact.clearance", None) == (
        "contact.clearance",
        None,
        ["pin.material", "pin.E", "contact.friction"],
    )
    assert check_axes(plan, "dx", None, "contact.friction") == ("contact.clearance", "contact.friction", others)
    one = parse_plan(FRICTION.replace("COUNT", "3"))
    assert check_axes(one, "seconds", None, None) == ("contact.friction", None, [])


@pytest.mark.parametrize(
    ("written", "words"),
    [
        ('[grid]\npin.material = ["steel", "aluminium"]\n', "plot: a figure needs a field with several numbers"),
        (
            f"[grid]\nsolve.nodes = [41, 51]\nplate.nu = [0.1, 0.2]\nload.2.Q = {[[k, -k] for k in range(1, 20)]}\n",
            "plot: the figure would have 19 maps, at most 12 fit; choose other axes",
        ),
    ],
)
def test_figures_that_can_not_be(written: str, words: str) -> None:
    with pytest.raises(InputError, match=words):
        check_axes(parse_plan(written), "dx", None, None)


def test_a_restricted_plan_has_the_points_with_given_values(plan: Plan, rows: list[dict[str, Any]]) -> None:
    part = restricted(plan, {"contact.friction": 0.4 * (1.0 + 1e-12), "pin.material": "steel"})
    assert {point.values["contact.friction"] for point in part.points} == {0.4}
    assert len(part.points) == 3
    kept = [row for row in rows if row["contact.friction"] == 0.4 and row["pin.material"] == "steel"]
    found = chart(part, kept, "peak_pressure")
    assert (found.x.label, found.y) == ("clearance (um)", None)
    assert found.parts[0][1] == pytest.approx([40.0, 41.0, 42.0])
    assert where_words(plan, kept, {"contact.friction": 0.4}) == ["friction coefficient = 0.4"]
    assert restricted(plan, {}) == plan


@pytest.mark.parametrize(
    ("where", "words"),
    [
        (
            {"contact.friktion": 0.4},
            'where: the plan does not vary "contact.friktion", did you mean "contact.friction"?',
        ),
        ({"contact.friction": 0.3}, "where: the plan has no contact.friction = 0.3; it has 0.2, 0.4"),
        ({"pin.material": "steel", "pin.E": 100e9}, "where: no point of the plan has all of these values"),
    ],
)
def test_a_plan_is_restricted_to_its_values_only(where: dict[str, Any], words: str, plan: Plan) -> None:
    assert str(refused(restricted, plan, where)) == words


def test_numbers_of_a_map(plan: Plan, rows: list[dict[str, Any]]) -> None:
    found = chart(plan, rows, "peak_pressure")
    assert found.label == "peak pressure (MPa)"
    assert found.missing == 2
    assert (found.x.label, found.x.log, found.x.values.tolist()) == ("friction coefficient", False, [0.2, 0.4])
    assert (found.y.label, found.y.log) == ("clearance (um)", True)
    assert found.y.values == pytest.approx([1.0, 10.0, 100.0])
    (name, numbers, failed), (other, complete, none) = found.parts
    assert (name, other) == ("material of the pin = steel", "modulus of the pin = 100 GPa")
    assert numbers == pytest.approx(np.array([[20.0, 40.0], [np.nan, 41.0], [np.nan, 42.0]]), nan_ok=True)
    assert complete == pytest.approx(np.array([[20.0, 40.0], [21.0, 41.0], [22.0, 42.0]]))
    assert failed.tolist() == [[False, False], [True, False], [False, False]]
    assert not none.any()


def test_error_bars_have_the_unit_of_their_numbers(plan: Plan, rows: list[dict[str, Any]]) -> None:
    assert chart(plan, rows, "peak_pressure").bars == []
    found = chart(plan, [row | {"peak_pressure_bar": 2e4} for row in rows], "peak_pressure")
    for (_, numbers, _), bars in zip(found.parts, found.bars, strict=True):
        np.testing.assert_allclose(bars, np.where(np.isnan(numbers), np.nan, 0.02))


def test_numbers_of_curves(plan: Plan, rows: list[dict[str, Any]]) -> None:
    found = chart(plan, rows, "contact_start", "contact.clearance")
    assert found.label == "contact start (deg)"
    assert found.y is None
    assert [name.splitlines()[-1] for name, _, _ in found.parts] == [
        "friction coefficient = 0.2",
        "friction coefficient = 0.4",
    ] * 2
    assert found.parts[3][1].tolist() == [-40.0, -41.0, -42.0]


def test_rounding_is_no_number_of_a_figure(plan: Plan, rows: list[dict[str, Any]]) -> None:
    for place, row in enumerate(rows):
        if row["status"] == "done":
            row |= {"dx": (-1) ** place * 3e-21, "dy": -2e-5, "peak_shear_angle": 4e-8, "rotation": 0.0}
    for name in ("dx", "peak_shear_angle", "rotation"):
        values = np.concatenate([numbers.ravel() for _, numbers, _ in chart(plan, rows, name).parts])
        assert set(values[np.isfinite(values)]) == {0.0}
    assert chart(plan, rows, "dx").label == "dx (m)"
    kept = chart(plan, rows, "dy").parts[1][1]
    assert kept == pytest.approx(-20.0)


@pytest.mark.parametrize(
    ("field", "words"),
    [
        ("contact.friction", "friction coefficient"),
        ("contact.hole_radius", "hole radius"),
        ("pin.nu", "Poisson's ratio of the pin"),
        ("plate_body.outer_radius", "outer radius of the plate"),
        ("plate_body.friction", "friction coefficient of the seat"),
        ("plate_body.interference", "interference of the bush"),
        ("load.2.Q", "force Q in load 2"),
        ("load.1.amplitude.sxx", "amplitude of the remote stress sxx in load 1"),
        ("load.2.rotation", "rotation of the pin in load 2"),
        ("load.3.repeat", "repeat in load 3"),
        ("solve.nodes", "number of nodes"),
    ],
)
def test_fields_have_words(field: str, words: str) -> None:
    assert field_words(field) == words


def test_runs_with_different_units_have_none_but_degrees(plan: Plan, rows: list[dict[str, Any]]) -> None:
    rows[0]["dimensionless"] = 1
    assert chart(plan, rows, "peak_pressure").label == "peak pressure"
    assert chart(plan, rows, "contact_start").label == "contact start (deg)"


def test_long_tables_are_cut_in_the_middle() -> None:
    plan = parse_plan(FRICTION.replace("COUNT", "81"))
    said = text(plan, sweep.rows(plan, Path("nowhere")))
    assert len(said.splitlines()) == 43
    assert "41 more" in said


def test_a_printed_table_scales_its_units(plan: Plan, rows: list[dict[str, Any]]) -> None:
    names, unit, first, second, *_ = (line.split() for line in text(plan, rows).splitlines())
    assert names[:6] == ["run", "pin.material", "pin.E", "contact.friction", "contact.clearance", "peak"]
    assert unit[:3] == ["GPa", "um", "MPa"]
    assert first[1:6] == ["steel", "-", "0.2", "1", "20"]
    assert second[-1] == "failed"


@pytest.fixture
def with_outcomes(plan: Plan) -> Plan:
    def mass(result: Result) -> float:
        return 1.0

    mass.unit = "$/kg_{2"  # type: ignore[attr-defined]
    walk = {"quantity": "peak_shear_angle", "take": "range"}
    return plan.with_outcomes({"mass": mass, "walk": walk, "loss": {"cycle": "dissipation"}})


def test_rounding_is_printed_as_zero(plan: Plan, rows: list[dict[str, Any]]) -> None:
    small = [{**row, "peak_pressure_angle": 1.3e-10, "rotation": -4e-19} for row in rows]
    heading, _, *lines = text(plan, small).splitlines()
    ends = {name: heading.index(f" {name} ") + len(name) + 1 for name in ("at", "rotation")}
    assert {line[: ends["at"]].split()[-1] for line in lines} == {"0"}
    assert {line[: ends["rotation"]].split()[-1] for line in lines} == {"0"}


@pytest.mark.gate
def test_outcomes_have_their_units(with_outcomes: Plan, rows: list[dict[str, Any]], tmp_path: Path) -> None:
    for place, row in enumerate(rows):
        row |= {"mass": 2e6 + place, "walk": 2e3, "loss": 0.5 * place}
    table = [line.split() for line in text(with_outcomes, rows).splitlines()]
    assert table[0][-4:] == ["mass", "walk", "loss", "status"]
    assert table[1][-3:] == ["$/kg_{2", "deg", "J/m"]  # no prefixes; the values in J/m are near 1
    assert table[-1][-4:-1] == ["2e+06", "2000", "5.5"]
    write_csv(with_outcomes, rows, tmp_path / "a.csv")
    lines = (tmp_path / "a.csv").read_text().splitlines()
    assert lines[1].startswith(
        "# units: pin.E Pa, contact.clearance m, mass $/kg_{2, walk deg, loss J/m, peak_pressure Pa"
    )
    assert lines[2].startswith("id,pin.material,pin.E,contact.friction,contact.clearance,mass,walk,loss,states,")
    found = chart(with_outcomes, rows, "mass")
    assert (found.label, found.missing) == ("mass ($/kg_{2)", 2)
    plot_sweep(found, tmp_path / "a.png")  # the unit is no formula
    assert (tmp_path / "a.png").stat().st_size > 1000


def test_a_value_that_is_unknown_names_outcomes_first(with_outcomes: Plan) -> None:
    with pytest.raises(InputError, match='value: there is no outcome or key figure "los", did you mean "loss"'):
        check_axes(with_outcomes, "los", None, None)


LABELLED = MAP.replace(
    "[grid]",
    """
[outcomes]
regime = { quantity = "regime" }
[labels]
contact.friction = "friction of the rig"
regime = "slip regime"
[grid]""",
    1,
)


def test_classes_are_words_and_labels_are_headings(tmp_path: Path) -> None:
    plan = parse_plan(LABELLED)
    assert [point.id for point in plan.points] == [point.id for point in parse_plan(MAP).points]
    rows = made_up_rows(plan)
    for row in rows:
        row["regime"] = None if row["status"] != "done" else 2.0
    lines = text(plan, rows).split("\n")
    assert "friction of the rig" in lines[0]
    assert "slip regime" in lines[0]
    assert "partial slip" in lines[-1]
    write_csv(plan, rows, tmp_path / "a.csv")
    header, first = (tmp_path / "a.csv").read_text().splitlines()[2:4]
    assert dict(zip(header.split(","), first.split(","), strict=False))["regime"] == "partial slip"
    found = chart(plan, rows, "regime")
    assert (found.label, found.classes[2]) == ("slip regime", "partial slip")
    assert "friction of the rig" in (found.x.label, found.y.label if found.y else "")
