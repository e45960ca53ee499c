"""The formulas for a spreadsheet against the charts, and their text as a spreadsheet reads it."""

import math
import re

import numpy as np
import pytest

from fastpin.charts import ChartFormula, chart_formulas, lookup
from fastpin.charts.lookups import HEAD, MOST_FRICTION, MOST_LOAD_PARAMETER
from fastpin.errors import InputError


def cell_value(text: str, cells: dict[str, float]) -> float:
    """The value of a cell: the text without its name and equals sign, as a spreadsheet reads it."""
    code = text.split("=", 1)[1].replace("^", "**").replace("PI()", "pi").replace("SQRT", "sqrt")
    return float(eval(code, {"pi": math.pi, "sqrt": math.sqrt}, cells))


@pytest.mark.parametrize("formula", chart_formulas(), ids=lambda one: f"{one.quantity}-{one.pin_load}")
def test_a_formula_keeps_its_error_at_random_places(formula: ChartFormula) -> None:
    generator = np.random.default_rng(5)
    at = MOST_LOAD_PARAMETER * generator.random(4000) ** 3
    friction = MOST_FRICTION * generator.random(4000)
    chart = lookup(formula.quantity, load_parameter=at, friction=friction, pin_load=formula.pin_load)
    assert np.max(np.abs(formula.at(at, friction) / chart.value - 1.0)) <= formula.error


def test_a_formula_is_no_extrapolation() -> None:
    with pytest.raises(InputError, match="load_parameter: must be at least 0 and at most 10, not 11"):
        chart_formulas()[0].at(11.0, 0.3)
    with pytest.raises(InputError, match=r"friction: must be at least 0 and at most 0\.6, not 0.7"):
        chart_formulas()[0].at(1.0, [0.1, 0.7])


@pytest.mark.parametrize("formula", chart_formulas(), ids=lambda one: f"{one.quantity}-{one.pin_load}")
def test_the_text_is_the_formula(formula: ChartFormula) -> None:
    cells = {"Lp": 0.4, "mu": 0.2}
    for line in HEAD:
        cells[line.split()[0]] = cell_value(line, cells)
    assert not re.findall(r"--|\+-", formula.cell)
    assert cell_value(formula.cell, cells) == pytest.approx(float(formula.at(np.array(0.4), np.array(0.2))), rel=1e-12)
