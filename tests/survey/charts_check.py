"""Check the charts against fresh runs at random places that no bound has seen, with twice the nodes of the tables."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any, NamedTuple

from fastpin.charts import lookup
from fastpin.charts.groups import ChartGroup
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


def worst_of(group: ChartGroup, count: int, seed: int) -> Iterator[Worst]:
    """Yield the largest error of each chart of a group at `count` random places."""
    places, fresh = points(group, count, seed)
    for k, quantity in enumerate(group.quantities):
        found = []
        for place, values in zip(places, fresh, strict=True):
            given = group.parameters_at(place)
            chart = lookup(quantity, **given)
            error = abs(chart.value - float(values[k]))
            ratio = error / chart.error if chart.error else math.inf
            found.append(Worst(group.name, quantity, count, ratio, error, float(values[k]), given))
        yield max(found, key=lambda worst: worst.ratio)
