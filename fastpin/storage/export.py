"""Conversion of results to xarray and pandas."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import h5py

from fastpin.errors import InputError
from fastpin.model import checks, loads
from fastpin.model.points import has_outline
from fastpin.model.units import units_per_thickness
from fastpin.solver.result import Result
from fastpin.states.quantities import QUANTITIES, load_point
from fastpin.storage import hdf5, layout
from fastpin.storage.store import open_result

if TYPE_CHECKING:
    import pandas
    import xarray

SCALES = ("state", "theta", "load_name", "residual_name")
"""Variables that are the scale of a dimension of the same name."""

Variables = dict[str, tuple[list[str], Any, dict[str, str]]]
"""Dimensions, values and attributes of each variable of a dataset."""


def to_xarray(source: Result | str | Path) -> xarray.Dataset:
    """Return all states as an xarray.Dataset with the dimensions "state" and "theta".

    The attribute "units" of a variable names its unit. xarray also reads a finished file piece by piece, without
    fastpin: ``xarray.open_dataset(path, group="states")``. Of a joint whose bush slips, the dataset has the contact of
    the pin. The dataset of its seat is ``to_xarray(result.seat)``.

    Parameters
    ----------
    source : Result or path
        A result, or its HDF5 file.

    Returns
    -------
    xarray.Dataset
        Pressures, shear tractions, gaps and slips have the shape (states, n). Loads and residuals have the dimensions
        "load_name" and "residual_name" in place of "theta". Values are in SI units or in the units of a dimensionless
        problem, angles in rad.

    Raises
    ------
    InputError
        If the file can't be read, see :func:`fastpin.load`, or xarray is not installed.
    """
    try:
        import xarray
    except ImportError:
        raise InputError("xarray", "is not installed: pip install 'fastpin[xarray]'") from None
    variables, attributes = (
        _of_result(source) if isinstance(source, Result) else _of_file(checks.file_path("source", source))
    )
    dataset = xarray.Dataset(variables, attrs=attributes)
    return dataset.set_coords([name for name in variables if name in (*SCALES, "step", "fraction")])


def _of_file(path: Path) -> tuple[Variables, dict[str, Any]]:
    variables: Variables = {}
    with open_result(path) as file:
        group = file["states"]
        layout.check_states(file, layout.read_grid(file).size)
        for name in (*SCALES, *_own(layout.state_rows(group))):
            dataset = group[name]
            values = dataset.asstr()[()] if h5py.check_string_dtype(dataset.dtype) else dataset[()]
            unit = dataset.attrs.get("unit", "")
            label = {"units": unit if isinstance(unit, str) else ", ".join(unit)}
            variables[name] = _dimensions(name), values, label
        sizes = {name: len(variables[name][1]) for name in SCALES}
        for name, (dimensions, values, _) in variables.items():
            if values.shape != tuple(sizes[dimension] for dimension in dimensions):
                raise ValueError(f"states/{name} has the shape {values.shape}")
        return variables, {name: hdf5.as_python(value) for name, value in file.attrs.items()}


def _own(names: Iterable[str]) -> list[str]:
    """The arrays of the pin's contact. The seat of a bush has other nodes, and a dataset of its own."""
    return [name for name in names if not name.startswith(layout.SEATED[1])]


def _dimensions(name: str) -> list[str]:
    """The dimensions of a variable."""
    if name in SCALES:
        return [name]
    nodal = dict.fromkeys((*layout.NODE_FIELDS, *layout.BORDER_FIELDS, *layout.SLIP_FIELDS), "theta")
    second = (nodal | {"loads": "load_name", "residuals": "residual_name"}).get(name)
    return ["state"] if second is None else ["state", second]


def _of_result(result: Result) -> tuple[Variables, dict[str, Any]]:
    unit = units_per_thickness(result.problem)
    variables: Variables = {
        "state": (["state"], list(range(len(result))), {"units": ""}),
        "theta": (["theta"], result.grid.theta, {"units": "rad"}),
        "load_name": (["load_name"], list(loads.LOADS), {"units": ""}),
        "residual_name": (["residual_name"], list(layout.RESIDUALS), {"units": ""}),
    }
    rows = layout.rows_of(list(result))
    for name, values in ((name, rows[name]) for name in _own(rows)):
        dimensions = _dimensions(name)
        label = unit.get(layout.FIELD_KINDS.get(name, ""), "")
        if name == "loads":
            label = ", ".join(layout.load_units(result.problem))
        if len(dimensions) == 2:
            values = values.reshape(len(result), len(variables[dimensions[1]][1]))
        variables[name] = dimensions, values, {"units": label}
    return variables, {"complete": result.complete, "method": result.method}


def to_dataframe(result: Result) -> pandas.DataFrame:
    """Return the reported quantities as a pandas.DataFrame with one row for each state.

    Columns are "load_point", "step", "fraction", the loads ("load_P", "load_Q", ...) and the quantities of
    :data:`fastpin.states.QUANTITIES`. Values are in SI units or in the units of a dimensionless problem, angles in rad;
    the regime is text. "peak_hoop_outline_edge" is the name of the edge that governs on the outline, else empty.
    "unresolved" has the names of the quantities that the nodes do not resolve.
    ``frame.attrs["units"]`` names the unit of every column.

    Raises
    ------
    InputError
        If pandas is not installed, or `result` is none.
    """
    try:
        import pandas
    except ImportError:
        raise InputError("pandas", "is not installed: pip install 'fastpin[pandas]'") from None
    checks.instance("result", result, Result, "a Result")
    unit = {**units_per_thickness(result.problem), "angle": "rad", "width": "rad", "class": ""}
    named = dict(zip(loads.LOADS, layout.load_units(result.problem), strict=True))
    rows = [
        {
            "load_point": load_point(state),
            "step": state.step,
            "fraction": state.fraction,
            **{f"load_{name}": value for name, value in state.load.items()},
            **{name: each.shown(state) for name, each in QUANTITIES.items()},
            "peak_hoop_outline_edge": state.outline_peak.edge if has_outline(state.problem) else "",
            "unresolved": " ".join(name for name, each in QUANTITIES.items() if not each.is_resolved(state)),
        }
        for state in result
    ]
    columns = ["load_point", "step", "fraction", *(f"load_{name}" for name in loads.LOADS), *QUANTITIES]
    columns += ["peak_hoop_outline_edge", "unresolved"]
    frame = pandas.DataFrame(rows, columns=columns)
    frame.attrs["units"] = {
        **{f"load_{name}": label for name, label in named.items()},
        **{name: unit[each.kind] for name, each in QUANTITIES.items()},
    }
    return frame
