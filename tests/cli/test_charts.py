"""``fastpin charts`` on the command line."""

import csv
import json
from pathlib import Path

import pytest

from fastpin.charts import CHARTS, chart_formulas, lookup
from tests.support.commands import printed, refused, said

AT = ["--load-parameter", "0.3", "--friction", "0.25"]


def test_the_list_has_all_charts_with_bounds_and_ranges() -> None:
    out = printed("charts")
    assert all(f"  {name} " in out for name in CHARTS)
    assert "largest bound" in out
    assert "load_parameter 0 to 100" in out
    assert "cycle of Q, unlike bodies: load_parameter 0.02 to 3, friction 0.1 to 0.6" in out


def test_a_value_has_its_error() -> None:
    words = printed("charts", "kt_bearing", *AT, "--pin-load", "body", "--alpha", "-0.2", "--beta", "-0.05")
    name, value, error = words.replace("=", "").replace("+-", "").split()
    found = lookup("kt_bearing", load_parameter=0.3, friction=0.25, pin_load="body", alpha=-0.2, beta=-0.05)
    assert name == "kt_bearing"
    assert float(value) == pytest.approx(found.value, abs=found.error / 10.0)
    assert float(error) == pytest.approx(found.error, rel=0.1)
    assert printed("charts", "contact_angle", *AT).endswith(" deg\n")


def test_json_has_the_value_and_its_parameters() -> None:
    words = ["cycle_energy", *AT, "--load-ratio", "0.2", "--rotation", "fixed", "--json"]
    document = json.loads(printed("charts", *words))
    found = lookup("cycle_energy", load_parameter=0.3, friction=0.25, load_ratio=0.2, rotation="fixed")
    assert document["value"] == found.value
    assert document["error"] == found.error
    assert document["parameters"]["rotation"] == "fixed"


@pytest.mark.gate
def test_the_nodes_of_a_chart_as_csv() -> None:
    said("charts", "kt_bearing", "--csv", "kt.csv")
    rows = list(csv.DictReader(Path("kt.csv").read_text(encoding="utf-8").splitlines()))
    row = rows[len(rows) // 3]
    given = {name: float(row[name]) for name in ("load_parameter", "friction", "alpha", "beta", "kolosov")}
    found = lookup("kt_bearing", pin_load=row["pin_load"], **given)
    assert float(row["kt_bearing"]) == pytest.approx(found.value, rel=1e-6)
    assert float(row["error"]) == pytest.approx(found.error, rel=1e-6)


def test_formulas_are_printed_with_their_errors() -> None:
    lines = printed("charts", "--formulas").splitlines()
    assert all(formula.cell in lines for formula in chart_formulas())
    assert sum("error at most" in line for line in lines) == len(chart_formulas())


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["kt"], "chart: must be "),
        (
            ["kt_bearing", "--load-parameter", "200", "--friction", "0.3"],
            "--load-parameter: must lie between 0 and 100",
        ),
        (["kt_bearing", "--friction", "0.3"], "--load-parameter: is needed by the chart kt_bearing"),
        (["kt_bearing", *AT, "--friction", "much"], '--friction: must be a number, not "much"'),
        (["cycle_energy", *AT, "--load-ratio", "0.4"], "--load-ratio: must lie between 0.05 and 0.25"),
        (
            ["cycle_energy", *AT, "--load-ratio", "0.2", "--rotation", "fixed", "--pin-load", "body"],
            '--rotation: must be "free" for a body load',
        ),
        (AT, "--load-parameter: has a meaning with the name of a chart only"),
        (["--csv", "a.csv"], "--csv: has a meaning with the name of a chart only"),
    ],
)
def test_wrong_input_is_one_sentence(arguments: list[str], message: str, tmp_path: Path) -> None:
    assert message in refused("charts", *arguments)
    assert not list(tmp_path.iterdir())
