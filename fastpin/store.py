"""Results in HDF5 files: all states with problem, history, grid, versions and units.

The layout is flat, so that other programs read it as well: ``/states`` holds one array for each quantity,
with one row a state; every array says its unit. A result that was read holds all that a solution returned
but the solver's inner state: ``solve(..., start=...)`` can't go on from it.
"""

from __future__ import annotations

import platform
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from fastpin import __version__
from fastpin.errors import InputError
from fastpin.files import check_writable, replacing
from fastpin.grid import Grid
from fastpin.loading import LOADS, LoadHistory, named_load
from fastpin.materials import Material, MaterialPair
from fastpin.problem import Problem
from fastpin.report import LOAD_KIND, units
from fastpin.state import Result, State

FORMAT = "fastpin result"
FORMAT_VERSION = 1

# Kind of quantity (a key of report.units, or "" for a plain number) of every field of a state that is stored
# as an array. The rest of State is treated one by one below; a test sees to it that nothing is forgotten.
NODE_FIELDS = {
    "pressure": "traction",
    "shear": "traction",
    "gap": "displacement",
    "slip": "displacement",
    "status": "",
}
NUMBER_FIELDS = {
    "step": "",
    "fraction": "",
    "dx": "displacement",
    "dy": "displacement",
    "rotation": "rotation",
    "dissipation": "energy",
    "work": "energy",
    "energy": "energy",
}
OTHER_FIELDS = ("load", "theta", "residuals", "problem", "grid")

_PROBLEM_FIELDS = (
    "hole_radius",
    "clearance",
    "friction",
    "pin_load",
    "rotation",
    "hub_radius",
    "dimensionless",
)


def save(result: Result, path: str | Path, error: str | None = None) -> None:
    """Write a result to an HDF5 file, whole or not at all.

    Parameters
    ----------
    result : Result
    path : path
        Overwritten if it exists.
    error : str, optional
        Why the result is incomplete, kept with it.

    Raises
    ------
    InputError
        If `path` can't be written.
    """
    check_writable(path)
    with replacing(path) as temporary, h5py.File(temporary, "w") as file:
        file.attrs["format"] = FORMAT
        file.attrs["format_version"] = FORMAT_VERSION
        file.attrs["complete"] = result.complete
        if error is not None:
            file.attrs["error"] = error
        for name, value in _versions().items():
            file.attrs[f"version_{name}"] = value
        _save_problem(file.create_group("problem"), result.problem)
        _save_history(file, result)
        theta = file.create_dataset("grid/theta", data=result.grid.theta)
        theta.attrs["unit"] = "rad"
        file["grid"].attrs["closed"] = result.grid.closed
        solver = file.create_group("solver")
        solver.attrs["method"] = result.method
        solver.create_group("statistics").attrs.update(result.statistics)
        _save_states(file.create_group("states"), result)


def load(path: str | Path) -> Result:
    """Read a result that :func:`save` wrote.

    Raises
    ------
    InputError
        If the file can't be read, was cut short, or is no result of fastpin.
    """
    path = Path(path)
    if not path.is_file():
        raise InputError(str(path), "there is no such file")
    try:
        file = h5py.File(path, "r")
    except OSError:
        raise InputError(str(path), "is not a whole HDF5 file: damaged, cut short, or of another kind") from None
    with file:
        if file.attrs.get("format") != FORMAT:
            raise InputError(str(path), "is an HDF5 file, but not a result of fastpin")
        made_by = file.attrs.get("version_fastpin", "unknown")
        if file.attrs.get("format_version") != FORMAT_VERSION:
            raise InputError(str(path), f"was written by fastpin {made_by} in a format that this version can't read")
        try:
            return _load_result(file)
        except (OSError, KeyError, ValueError, TypeError, IndexError, RuntimeError) as error:
            raise InputError(str(path), f"is damaged: {_first_line(error)}") from None


def _versions() -> dict[str, str]:
    libraries = {"numpy": np.__version__, "h5py": h5py.__version__}
    return {"fastpin": __version__, "python": platform.python_version(), **libraries}


def _first_line(error: Exception) -> str:
    return (str(error).strip("\"'").splitlines() or [type(error).__name__])[0]


# -- writing -------------------------------------------------------------------------------------------------


def _save_problem(group: h5py.Group, problem: Problem) -> None:
    for name in _PROBLEM_FIELDS:
        value = getattr(problem, name)
        if value is not None:
            group.attrs[name] = value
    group.attrs["plane"] = problem.pair.plane
    for name, material in (("pin", problem.pair.pin), ("plate", problem.pair.plate)):
        group.create_group(name).attrs.update(E=material.E, nu=material.nu, name=material.name)
    unit = units(problem)
    group.attrs["units"] = [f"{kind}: {name}" for kind, name in unit.items()]


def _save_history(file: h5py.File, result: Result) -> None:
    unit = units(result.problem)
    # What a corner leaves out and was never given before stays nan: "never given" is not "zero".
    values = result.history.values(initial=np.full(len(LOADS), np.nan))
    corners = file.create_dataset("history/corners", data=values)
    corners.attrs["columns"] = list(LOADS)
    corners.attrs["unit"] = [unit[LOAD_KIND[name]] for name in LOADS]


def _save_states(group: h5py.Group, result: Result) -> None:
    unit = units(result.problem)
    states = list(result)
    if any(not np.array_equal(state.theta, result.grid.theta) for state in states):
        raise InputError("result", "all states must be on the grid of the result")

    def keep(name: str, data: Any, label: str | list[str], columns: list[str] | None = None) -> None:
        array = np.asarray(data)
        packing = {"compression": "gzip", "shuffle": True} if array.size > 100 else {}
        dataset = group.create_dataset(name, data=array, **packing)
        dataset.attrs["unit"] = label
        if columns is not None:
            dataset.attrs["columns"] = columns

    count, size = len(states), result.grid.size
    for name, kind in NODE_FIELDS.items():
        kept = np.array([getattr(state, name) for state in states]).reshape(count, size)
        keep(name, kept.astype(np.int8) if name == "status" else kept, unit.get(kind, ""))
    for name, kind in NUMBER_FIELDS.items():
        dtype = int if name == "step" else float
        keep(name, np.array([getattr(state, name) for state in states], dtype=dtype), unit.get(kind, ""))
    loads = np.array([[state.load[name] for name in LOADS] for state in states]).reshape(count, len(LOADS))
    keep("load", loads, [unit[LOAD_KIND[name]] for name in LOADS], list(LOADS))
    names = sorted({name for state in states for name in state.residuals})
    residuals = [[state.residuals.get(name, np.nan) for name in names] for state in states]
    keep("residuals", np.array(residuals, dtype=float).reshape(count, len(names)), "", names)


# -- reading -------------------------------------------------------------------------------------------------


def _load_result(file: h5py.File) -> Result:
    problem = _load_problem(file["problem"])
    rows = file["history/corners"][()]
    names = list(file["history/corners"].attrs["columns"])
    given = [dict(zip(names, map(float, row), strict=True)) for row in rows]
    history = LoadHistory([{k: v for k, v in corner.items() if not np.isnan(v)} for corner in given])
    grid = Grid(file["grid/theta"][()], bool(file["grid"].attrs["closed"]))
    statistics = {str(name): _number(value) for name, value in file["solver/statistics"].attrs.items()}
    return Result(
        states=_load_states(file["states"], problem, grid),
        problem=problem,
        history=history,
        grid=grid,
        method=str(file["solver"].attrs["method"]),
        statistics=statistics,
        complete=bool(file.attrs["complete"]),
        restart=None,
    )


def _load_problem(group: h5py.Group) -> Problem:
    bodies = {}
    for name in ("pin", "plate"):
        attributes = group[name].attrs
        bodies[name] = Material(float(attributes["E"]), float(attributes["nu"]), str(attributes["name"]))
    given = {name: group.attrs[name] for name in _PROBLEM_FIELDS if name in group.attrs}
    plain = {name: value.item() if isinstance(value, np.generic) else value for name, value in given.items()}
    return Problem(MaterialPair(bodies["pin"], bodies["plate"], group.attrs["plane"]), **plain)


def _load_states(group: h5py.Group, problem: Problem, grid: Grid) -> list[State]:
    nodes = {name: group[name][()] for name in NODE_FIELDS}
    numbers = {name: group[name][()] for name in NUMBER_FIELDS}
    loads, residuals = group["load"][()], group["residuals"][()]
    names = [str(name) for name in group["residuals"].attrs["columns"]]
    count = len(loads)
    shapes = dict.fromkeys(nodes, (count, grid.size)) | dict.fromkeys(numbers, (count,))
    for name, shape in shapes.items():
        if group[name].shape != shape:
            raise ValueError(f"states/{name} has shape {group[name].shape}, not {shape}")
    states = []
    for k in range(count):
        per_node = {name: array[k] for name, array in nodes.items()}
        for array in per_node.values():
            array.setflags(write=False)
        kept = {name: float(value) for name, value in zip(names, residuals[k], strict=True) if not np.isnan(value)}
        states.append(
            State(
                **per_node,
                **{name: array[k].item() for name, array in numbers.items()},
                load=named_load(loads[k]),
                theta=grid.theta,
                residuals=kept,
                problem=problem,
                grid=grid,
            )
        )
    return states


def _number(value: Any) -> float:
    return value.item() if isinstance(value, np.generic) else value
