"""Check the charts against fresh runs at random places that no bound has seen.

``python -m scripts.charts_check [--count 3000] [--seed 8] [--folder out/charts]`` solves `count` places with twice the
nodes of the tables, an equal share in each group. It prints the largest error of each chart, in parts of its bound, and
the parameters there. A ratio above 1 breaks a bound, and ends with the exit code 1. A folder keeps what is solved.
"""

from __future__ import annotations

import argparse
import math
import sys
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

from fastpin.charts import lookup
from fastpin.charts.groups import GROUPS, ChartGroup
from scripts.charts_data import points


class Worst(NamedTuple):
    """The largest error of a chart in a group, in parts of its bound."""

    group: str
    quantity: str
    count: int
    ratio: float
    error: float
    value: float
    parameters: dict[str, Any]

    def __str__(self) -> str:
        at = ", ".join(f"{name} {value:.4g}" for name, value in self.parameters.items() if isinstance(value, float))
        of_bound = f"error {self.error:.2e} of {self.value:.5g} is {self.ratio:.2f} of the bound"
        return f"{self.group:<13} {self.quantity:<19} {self.count:>4} places: {of_bound} ({at})"


def worst_of(group: ChartGroup, count: int, seed: int, folder: Path | None = None) -> Iterator[Worst]:
    """Yield the largest error of each chart of a group at `count` random places."""
    places, fresh = points(group, count, seed, folder)
    for k, quantity in enumerate(group.quantities):
        found = []
        for place, values in zip(places, fresh, strict=True):
            given = group.parameters_at(place)
            chart = lookup(quantity, **given)
            error = abs(chart.value - float(values[k]))
            ratio = error / chart.error if chart.error else math.inf
            found.append(Worst(group.name, quantity, count, ratio, error, float(values[k]), given))
        yield max(found, key=lambda worst: worst.ratio)


def main() -> int:
    """Read the options, solve and compare."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=3000)
    parser.add_argument("--seed", type=int, default=8)
    parser.add_argument("--folder", type=Path)
    options = parser.parse_args()
    warnings.simplefilter("ignore")
    share, broken = math.ceil(options.count / len(GROUPS)), 0
    for group in GROUPS.values():
        for worst in worst_of(group, share, options.seed, options.folder):
            print(worst, flush=True)
            broken += worst.ratio > 1.0
    print(f"{share * len(GROUPS):,} places, {broken} charts beyond their bound")
    return 1 if broken else 0


if __name__ == "__main__":
    sys.exit(main())
