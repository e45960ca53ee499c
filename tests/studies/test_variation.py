"""Fields of a plan replace what contradicts them in the base case."""

from __future__ import annotations

import pytest

from fastpin.errors import CaseFileError
from fastpin.studies.plan import parse_plan
from fastpin.studies.variation import with_values


def test_the_path_solver_drops_the_increments_of_the_base_case():
    tables = {"solve": {"method": "increment", "increments": 5}}
    assert with_values(tables, {"solve.method": "path"}) == {"solve": {"method": "path"}}
    assert with_values(tables, {"solve.nodes": 41})["solve"]["increments"] == 5
    assert tables["solve"]["increments"] == 5


def test_error_bars_are_refused_in_a_sweep():
    with pytest.raises(CaseFileError, match="error_bars: are not kept by sweeps; leave them out"):
        parse_plan('[grid]\n"solve.error_bars" = [true]\n')
