"""The rows of a sweep as labelled arrays of xarray."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from fastpin.errors import InputError
from fastpin.model.units import Unit, units, units_per_thickness
from fastpin.studies.field_words import field_kind, field_words
from fastpin.studies.index import DONE
from fastpin.studies.plan import Plan
from fastpin.studies.run_end import KEY_FIGURES

if TYPE_CHECKING:
    import xarray

LISTED = "run"
"""The dimension of the [[list]] blocks of a plan."""

NamedAttributes = dict[str, Any]


def dataset(plan: Plan, rows: Sequence[Mapping[str, Any]]) -> xarray.Dataset:
    """Return the rows of all points of a plan as a dataset, see :func:`fastpin.studies.sweep.to_xarray`."""
    try:
        import xarray
    except ImportError:
        raise InputError("xarray", "is not installed: pip install 'fastpin[xarray]'") from None
    listed = [name for name in plan.fields if name not in plan.axes]
    sizes = {LISTED: len(rows) // _product(plan.axes)} if listed else {}
    sizes |= {name: len(values) for name, values in plan.axes.items()}
    shape, dimensions = tuple(sizes.values()), [*sizes]
    coordinates: dict[str, Any] = {}
    for name, values in plan.axes.items():
        coordinates[name] = [name], _coordinate(values), _field_attributes(plan, name)
    if listed:
        coordinates[LISTED] = [LISTED], np.arange(1, sizes[LISTED] + 1), {"long_name": "[[list]] block of the plan"}
        first = rows[:: _product(plan.axes)]
        for name in listed:
            coordinates[name] = [LISTED], _coordinate([row[name] for row in first]), _field_attributes(plan, name)
    variables: dict[str, Any] = {}
    for name in (*plan.outcomes, *KEY_FIGURES):
        known = [row.get(name) if row["status"] == DONE else None for row in rows]
        numbers = [np.nan if value is None else value for value in known]
        variables[name] = dimensions, np.array(numbers, dtype=float).reshape(shape), _attributes(plan, rows, name)
    for name in ("status", "reason", "id"):
        texts = np.array([row.get(name) or "" for row in rows], dtype=str)
        variables[name] = dimensions, texts.reshape(shape), {"long_name": f"{name} of the run"}
    return xarray.Dataset(variables, coordinates, {"title": plan.title} if plan.title else {})


def _product(axes: Mapping[str, Sequence[Any]]) -> int:
    """Number of points of the grid."""
    return int(np.prod([len(values) for values in axes.values()], dtype=int))


def _coordinate(values: Sequence[Any]) -> np.ndarray:
    """Return the values of a field as numbers, NaN where missing; or as text, in the notation of JSON where no text."""
    if all(value is None or (isinstance(value, int | float) and not isinstance(value, bool)) for value in values):
        return np.array([np.nan if value is None else value for value in values])
    texts = ["" if value is None else value if isinstance(value, str) else json.dumps(value) for value in values]
    return np.array(texts, dtype=str)


def _field_attributes(plan: Plan, name: str) -> NamedAttributes:
    """Unit and words of a varied field. Its values are in the units of the case file."""
    unit = units(plan.case(plan.points[0]).problem).get(field_kind(name))
    return {"units": unit.name if unit else "", "long_name": plan.labels.get(name, field_words(name))}


def _attributes(plan: Plan, rows: Sequence[Mapping[str, Any]], name: str) -> NamedAttributes:
    """Unit and words of an outcome or a key figure, per metre of thickness as in :func:`fastpin.studies.sweep.load`."""
    names = units_per_thickness(plan.case(plan.points[0]).problem) | {"angle": "deg"}
    if len({row["dimensionless"] for row in rows if "dimensionless" in row}) > 1:
        names = {}
    found: NamedAttributes = {"units": names.get(KEY_FIGURES.get(name, ""), "")}
    if name in plan.outcomes:
        outcome = plan.outcomes[name]
        found["units"] = outcome.unit_in({kind: Unit(1.0, unit) for kind, unit in names.items()}).name
        if outcome.classes:
            found["flag_values"] = [float(number) for number in outcome.classes]
            found["flag_meanings"] = " ".join(word.replace(" ", "_") for word in outcome.classes.values())
    return found | {"long_name": plan.labels.get(name, name.replace("_", " "))}
