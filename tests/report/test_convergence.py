"""Tables of convergence studies."""

from __future__ import annotations

import pytest

from fastpin.model.materials import MaterialPair
from fastpin.report.convergence import text
from fastpin.studies.convergence import Convergence
from tests.support.studies import small_problem, small_study


@pytest.fixture(scope="module")
def study(similar: MaterialPair) -> Convergence:
    return small_study(small_problem(similar))


def test_text_shows_zeros_as_zeros(study: Convergence) -> None:
    lines = [line.split() for line in text(study).splitlines()]
    assert ["rotation", "F", "beta*/R", "0", "0", "0", "to", "rounding", "-", "-"] in lines
