"""Fresh runs at random places lie within the bounds of the charts."""

from __future__ import annotations

import pytest

from fastpin.charts.groups import GROUPS
from tests.support.tiers import seeds
from tests.survey.charts_check import worst_of

pytestmark = pytest.mark.survey


@pytest.mark.parametrize("name", GROUPS)
def test_fresh_runs_lie_within_the_bounds(name: str) -> None:
    """Three places for each seed: three thousand in all groups. ``-rP`` shows the largest ratio of each chart."""
    found = [worst for seed in seeds(1) for worst in worst_of(GROUPS[name], 3, seed)]
    for quantity in GROUPS[name].quantities:
        print(max((worst for worst in found if worst.quantity == quantity), key=lambda worst: worst.ratio))
    assert [str(worst) for worst in found if worst.ratio > 1.0] == []
