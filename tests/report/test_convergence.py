"""Tables of convergence studies."""

import math
from dataclasses import replace

import pytest

from fastpin.model.materials import MaterialPair
from fastpin.model.units import Unit
from fastpin.report.convergence import one_digit, reported_series, series_columns, text
from fastpin.studies.convergence import Convergence, converge
from tests.support.studies import CORNERS, small_problem


@pytest.fixture(scope="module")
def study(similar: MaterialPair) -> Convergence:
    return converge(small_problem(similar), CORNERS[:1], (51, 61, 81))


def test_text_shows_zeros_as_zeros(study: Convergence) -> None:
    lines = [line.split() for line in text(study).splitlines()]
    assert ["rotation", "F", "beta*/R", "0", "0", "0", "converged", "to", "rounding", "-", "-"] in lines


def test_every_verdict_has_words(study: Convergence) -> None:
    row = reported_series(study.studies[0], study.problem, 1)[0]
    words = {
        ("observed", 1.5, 1e-6): "order 1.50",
        ("converged", math.nan, 1.4e-6): "converged, scatter 1e-6",
        ("converged", math.nan, 0.0): "converged, scatter 0",
        ("not converged", math.nan, 0.0234): "not converged, scatter 0.02",
        ("not converged", math.nan, math.inf): "not converged, scatter inf",
        ("to rounding", math.nan, 1e-16): "converged to rounding",
        ("not comparable", math.nan, math.nan): "not comparable",
    }
    for (verdict, order, scatter), expected in words.items():
        assert replace(row, verdict=verdict, order=order, scatter=scatter).words == expected


def test_small_values_have_the_digits_of_their_bar(study: Convergence) -> None:
    row = reported_series(study.studies[0], study.problem, 1)[0]
    values = (1.23456789e-20,) * len(row.values)
    row = replace(row, unit=Unit(1.0, "m"), values=values, verdict="observed", limit=1.23456789e-20, bar=1e-26)
    cells = {name: column[0] for name, _, column in series_columns(study.studies[0], [row])}
    assert cells["unit"] == "pm"
    assert cells["limit"] == "1.2345679e-08"


def test_values_that_agree_to_some_digits_have_converged(study: Convergence) -> None:
    """No value that agrees to three digits is said to lack something."""
    rows = [row for corner in study.loads for row in reported_series(study.studies[0], study.problem, corner)]
    found = {row.verdict for row in rows}
    assert found <= {"observed", "converged", "not converged", "to rounding", "not comparable"}
    table = text(study)
    assert "not observed" not in table
    for row in rows:
        if row.verdict == "converged":
            assert row.scatter <= 1e-3
            assert f"converged, scatter {one_digit(row.scatter)}" in table
