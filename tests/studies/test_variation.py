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


def test_error_bars_of_a_sweep_need_enough_nodes():
    words = "line 3: solve.nodes: must be at least 101 for error bars, not 99: a second run takes half of them"
    with pytest.raises(CaseFileError, match=words):
        parse_plan('[grid]\n"solve.error_bars" = [true]\n"solve.nodes" = [99]\n')
    assert len(parse_plan('[grid]\n"solve.error_bars" = [true, false]\n"solve.nodes" = [101]\n').runs) == 2
