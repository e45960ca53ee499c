"""How a result lies in an HDF5 file.

======================  ============================================================================================
``/``                   attributes: format, versions, when and where it was made, whether it is complete, what failed
``/problem``            attributes: geometry, friction, materials, units
``/history``            ``corners`` (NaN: not given), ``blocks`` of them and how often each is run through
``/grid``               ``theta`` (n,), rad
``/solver``             attributes: method and options; ``statistics``
``/states``             one array a quantity, one row a state: (states,), (states, n) or (states, names)
``/cycles``             one array a quantity, one row a cycle; empty where the history has none
``/restart``            to go on from: ``start``, ``latest`` and the corners that were asked for
======================  ============================================================================================

Every array says its unit. Dimensions are named in the way of netCDF, so that xarray reads ``/states`` as it is.
"""

from __future__ import annotations

import dataclasses
import functools
import platform
from collections.abc import Mapping, Sequence
from datetime import UTC, datetime
from importlib import metadata
from typing import Any

import h5py
import numpy as np

from fastpin.errors import InputError
from fastpin.model.grid import Grid
from fastpin.model.history import Block, LoadHistory
from fastpin.model.loads import LOAD_KIND, LOADS, named_load
from fastpin.model.materials import Material, MaterialPair
from fastpin.model.options import SolveOptions
from fastpin.model.problem import Problem
from fastpin.model.units import units
from fastpin.solver.configuration import Configuration
from fastpin.solver.repeats import CycleEnd, KnownConfiguration, Repeats
from fastpin.solver.result import Restart
from fastpin.states.cycles import Cycle
from fastpin.states.state import State
from fastpin.version import __version__

FORMAT = "fastpin result"
FORMAT_VERSION = 2

# Kind of quantity (a key of report.units, or "" for a plain number) of every field of a state that is stored
# as an array. The rest of State is treated one by one below; coarse states, of which error bars are made, are not
# stored. A test sees to it that nothing is forgotten.
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

OTHER_FIELDS = ("load", "theta", "residuals", "problem", "grid", "error_bars")
FIELD_KINDS = {**NODE_FIELDS, **NUMBER_FIELDS}
"""Kind of quantity of each array that has a unit."""

STATE_ROWS = (*NODE_FIELDS, *NUMBER_FIELDS, "loads", "residuals")
"""Arrays that have a row for every state."""

RESIDUALS = ("gap", "slip", "cone", "equilibrium")
CYCLE_FIELDS = {
    "corner": "",
    "length": "",
    "number": "",
    "pressure_change": "",
    "shear_change": "",
    "dissipation": "energy",
    "rotation_change": "rotation",
    "solved": "",
}

WHOLE_NUMBERS = ("step", "corner", "length", "number")

_PROBLEM_FIELDS = (
    "hole_radius",
    "clearance",
    "friction",
    "pin_load",
    "rotation",
    "hub_radius",
    "dimensionless",
)

_ROWS = 128  # of numbers, in a chunk

Rows = dict[str, np.ndarray]
"""Some states or cycles: for each quantity an array whose first dimension counts them."""


# -- what does not grow --------------------------------------------------------------------------------------


def write_head(file: h5py.File, problem: Problem, history: LoadHistory, grid: Grid, options: Mapping[str, Any]) -> None:
    """Write everything but states, cycles and restarts into an empty file; `options` of the solver are attributes."""
    file.attrs["format"] = FORMAT
    file.attrs["format_version"] = FORMAT_VERSION
    file.attrs["complete"] = False
    file.attrs["created"] = datetime.now(UTC).isoformat(timespec="seconds")
    file.attrs["platform"] = platform.platform()
    file.attrs["host"] = platform.node()
    for name, version in versions().items():
        file.attrs[f"version_{name}"] = version
    _write_problem(file.create_group("problem"), problem)
    _write_history(file.create_group("history"), problem, history)
    file.create_group("grid").attrs["closed"] = grid.closed
    solver = file.create_group("solver")
    solver.attrs.update({name: value for name, value in options.items() if value is not None})
    solver.create_group("statistics")
    _make_states(file, problem, grid)
    cycles, unit = file.create_group("cycles"), units(problem)
    for name, kind in CYCLE_FIELDS.items() if history.longest_cycle else ():
        _growing(cycles, name, (), _dtype(name), unit.get(kind, ""))


@functools.cache
def versions() -> dict[str, str]:
    """Versions of fastpin, Python and the libraries."""
    libraries = {name: metadata.version(name) for name in ("numpy", "scipy", "numba", "h5py")}
    return {"fastpin": __version__, "python": platform.python_version(), **libraries}


def _write_problem(group: h5py.Group, problem: Problem) -> None:
    for name in _PROBLEM_FIELDS:
        value = getattr(problem, name)
        if value is not None:
            group.attrs[name] = value
    group.attrs["plane"] = problem.pair.plane
    for name, material in (("pin", problem.pair.pin), ("plate", problem.pair.plate)):
        group.create_group(name).attrs.update(E=material.E, nu=material.nu, name=material.name)
    group.attrs["units"] = [f"{kind}: {name}" for kind, name in units(problem).items()]


def read_problem(file: h5py.File) -> Problem:
    """The problem of a result."""
    group, bodies = file["problem"], {}
    for name in ("pin", "plate"):
        attributes = group[name].attrs
        bodies[name] = Material(float(attributes["E"]), float(attributes["nu"]), str(attributes["name"]))
    given = {name: as_python(group.attrs[name]) for name in _PROBLEM_FIELDS if name in group.attrs}
    return Problem(MaterialPair(bodies["pin"], bodies["plate"], group.attrs["plane"]), **given)


def _write_history(group: h5py.Group, problem: Problem, history: LoadHistory) -> None:
    corners = group.create_dataset("corners", data=np.vstack([block.given for block in history.blocks]), **_PACKED)
    corners.attrs["columns"] = list(LOADS)
    corners.attrs["unit"] = load_units(problem)
    group.create_dataset("ends", data=np.concatenate([block.ends for block in history.blocks]), **_PACKED)
    blocks = [(len(block.given), block.count, block.cycle, block.size, len(block.lengths)) for block in history.blocks]
    group["blocks"] = np.array(blocks, dtype=np.int64)
    group["blocks"].attrs["columns"] = ["corners", "count", "each time is a cycle", "corners if cut", "cycles inside"]
    group["cycle_lengths"] = np.array([length for block in history.blocks for length in block.lengths], dtype=np.int64)


def read_history(file: h5py.File) -> LoadHistory:
    """The load history of a result."""
    group = file["history"]
    corners, ends, lengths = group["corners"][()], group["ends"][()], group["cycle_lengths"][()].tolist()
    blocks, row, inner = [], 0, 0
    for rows, count, cycle, size, cycles in group["blocks"][()].tolist():
        own = tuple(lengths[inner : inner + cycles])
        blocks.append(Block(corners[row : row + rows], ends[row : row + rows], own, count, bool(cycle), size))
        row, inner = row + rows, inner + cycles
    return LoadHistory.of_blocks(blocks)


def read_grid(file: h5py.File) -> Grid:
    """The nodes of a result."""
    return Grid(file["grid/theta"][()], bool(file["grid"].attrs["closed"]))


def option_attributes(options: SolveOptions) -> dict[str, Any]:
    """The options of a run as attributes of ``/solver``."""
    kept = options.keywords()
    del kept["between"], kept["error_bars"]
    return {**kept, "fractions": options.fractions}


def read_options(file: h5py.File) -> SolveOptions:
    """The options of a result; of one that :func:`fastpin.save` wrote only the nodes and the method are known."""
    stored = {name: as_python(value) for name, value in file["solver"].attrs.items()}
    options: dict[str, Any] = {"nodes": stored.get("nodes", len(file["grid/theta"])), "method": stored["method"]}
    if options["method"] == "increment":
        options["increments"] = stored.get("increments")
    if "fractions" in stored:
        options["between"] = stored["fractions"][:-1].tolist()
    if "arc" in stored:
        start, stop = stored["arc"].tolist()
        options["arc"] = (start, min(stop, start + 2.0 * np.pi))  # earlier versions took longer arcs for a circle
    options |= {name: stored[name] for name in ("keep", "shortcut") if name in stored}
    return SolveOptions(**options)


def write_statistics(file: h5py.File, statistics: Mapping[str, float]) -> None:
    """Write what the solver counted."""
    file["solver/statistics"].attrs.update(statistics)


def read_statistics(file: h5py.File) -> dict[str, float]:
    """What the solver counted."""
    return {str(name): as_python(value) for name, value in file["solver/statistics"].attrs.items()}


# -- what grows ----------------------------------------------------------------------------------------------

_PACKED: dict[str, Any] = {"compression": "gzip", "compression_opts": 1, "shuffle": True}


def _dtype(name: str) -> type:
    return np.int64 if name in WHOLE_NUMBERS else bool if name == "solved" else np.int8 if name == "status" else float


def _growing(group: h5py.Group, name: str, shape: tuple[int, ...], dtype: type, unit: str | list[str]) -> h5py.Dataset:
    """An array that grows by rows: those of nodes are packed one by one, and never written again."""
    nodes = name in NODE_FIELDS
    chunks = (1 if nodes else _ROWS, *shape)
    dataset = group.create_dataset(
        name, (0, *shape), maxshape=(None, *shape), chunks=chunks, dtype=dtype, **(_PACKED if nodes else {})
    )
    dataset.attrs["unit"] = unit
    return dataset


def _make_states(file: h5py.File, problem: Problem, grid: Grid) -> None:
    group, unit = file.create_group("states"), units(problem)
    scales = {
        "state": _growing(group, "state", (), np.int64, ""),
        "theta": group.create_dataset("theta", data=grid.theta),
        "load_name": group.create_dataset("load_name", data=list(LOADS), dtype=h5py.string_dtype()),
        "residual_name": group.create_dataset("residual_name", data=list(RESIDUALS), dtype=h5py.string_dtype()),
    }
    scales["theta"].attrs["unit"] = "rad"
    file["grid/theta"] = scales["theta"]
    for name, scale in scales.items():
        scale.make_scale(name)
    arrays = [(name, kind, "theta", grid.size) for name, kind in NODE_FIELDS.items()]
    arrays += [(name, kind, "", 0) for name, kind in NUMBER_FIELDS.items()]
    for name, kind, dimension, size in arrays:
        dataset = _growing(group, name, (size,) if dimension else (), _dtype(name), unit.get(kind, ""))
        dataset.dims[0].attach_scale(scales["state"])
        if dimension:
            dataset.dims[1].attach_scale(scales[dimension])
    loads = _growing(group, "loads", (len(LOADS),), float, load_units(problem))
    residuals = _growing(group, "residuals", (len(RESIDUALS),), float, "")
    for dataset, dimension in ((loads, "load_name"), (residuals, "residual_name")):
        dataset.dims[0].attach_scale(scales["state"])
        dataset.dims[1].attach_scale(scales[dimension])


def load_units(problem: Problem) -> list[str]:
    """The unit of each load, in the order of a load vector."""
    unit = units(problem)
    return [unit[LOAD_KIND[name]] for name in LOADS]


def rows_of(states: Sequence[State]) -> Rows:
    """States as rows."""
    names = [*NODE_FIELDS, *NUMBER_FIELDS]
    rows: Rows = {name: np.array([getattr(state, name) for state in states], dtype=_dtype(name)) for name in names}
    rows["loads"] = np.array([[state.load[name] for name in LOADS] for state in states], dtype=float)
    rows["residuals"] = np.array(
        [[state.residuals.get(name, np.nan) for name in RESIDUALS] for state in states], dtype=float
    )
    return rows


def cycle_rows(cycles: Sequence[Cycle]) -> Rows:
    """Cycles as rows."""
    return {name: np.array([getattr(cycle, name) for cycle in cycles], dtype=_dtype(name)) for name in CYCLE_FIELDS}


def count(group: h5py.Group) -> int:
    """Number of rows of ``/states`` or ``/cycles``."""
    first = next((group[name] for name in ("state", "corner") if name in group), None)
    return 0 if first is None else int(first.shape[0])


def append(group: h5py.Group, rows: Rows) -> None:
    """Add rows to ``/states`` or ``/cycles``."""
    size, old = len(next(iter(rows.values()))), count(group)
    if size == 0:
        return
    if "state" in group:
        rows = {"state": np.arange(old, old + size), **rows}
    for name, array in rows.items():
        dataset = group[name]
        dataset.resize(old + size, axis=0)
        dataset[old:] = array


def read_rows(group: h5py.Group, names: Sequence[str], picked: slice | Sequence[int]) -> Rows:
    """Some rows of ``/states`` or ``/cycles``."""
    size = count(group)
    for name in names:
        if group[name].shape[0] != size:
            raise ValueError(f"{group.name[1:]}/{name} has {group[name].shape[0]} rows, not {size}")
    if isinstance(picked, slice):
        return {name: group[name][picked] for name in names}
    return {name: np.array([group[name][index] for index in picked]) for name in names}


def read_states(file: h5py.File, problem: Problem, grid: Grid, picked: slice | Sequence[int]) -> list[State]:
    """Some states of a result."""
    group = file["states"]
    for name in NODE_FIELDS:
        if group[name].shape[1:] != (grid.size,):
            raise ValueError(f"states/{name} has shape {group[name].shape}, there are {grid.size} nodes")
    rows = read_rows(group, STATE_ROWS, picked)
    states = []
    for k in range(len(rows["step"])):
        per_node = {name: rows[name][k] for name in NODE_FIELDS}
        for array in per_node.values():
            array.setflags(write=False)
        residuals = zip(RESIDUALS, rows["residuals"][k].tolist(), strict=True)
        states.append(
            State(
                **per_node,
                **{name: rows[name][k].item() for name in NUMBER_FIELDS},
                load=named_load(rows["loads"][k]),
                theta=grid.theta,
                residuals={name: value for name, value in residuals if not np.isnan(value)},
                problem=problem,
                grid=grid,
            )
        )
    return states


def read_cycles(file: h5py.File) -> list[Cycle]:
    """The cycles of a result."""
    if not count(file["cycles"]):
        return []
    rows = read_rows(file["cycles"], list(CYCLE_FIELDS), slice(None))
    return [Cycle(*values) for values in zip(*(rows[name].tolist() for name in CYCLE_FIELDS), strict=True)]


def check_format(file: h5py.File, path: str) -> None:
    """Raise :class:`InputError` if a file is no result, or of another version."""
    if file.attrs.get("format") != FORMAT:
        raise InputError(path, "is an HDF5 file, but not a result of fastpin")
    made_by = file.attrs.get("version_fastpin", "unknown")
    if file.attrs.get("format_version") != FORMAT_VERSION:
        raise InputError(path, f"was written by fastpin {made_by} in a format that this version can't read")


def as_python(value: Any) -> Any:
    """An attribute as a Python value."""
    return value.item() if isinstance(value, np.generic) else value


_ARRAYS = [field.name for field in dataclasses.fields(Configuration) if field.name not in ("dissipation", "work")]


def write_restart(group: h5py.Group, restart: Restart) -> None:
    """Write a restart into an empty group, without units: tractions in F/R, displacements in F beta*."""
    met, marks = list(restart.repeats), list(restart.marks.items())
    configurations: list[Configuration] = []
    places: dict[int, int] = {}

    def place(configuration: Configuration) -> int:
        """Where a configuration is stored; those that share their arrays are stored once."""
        known = places.setdefault(id(configuration.slip), len(configurations))
        if known == len(configurations):
            configurations.append(configuration)
        return known

    group.attrs.update(corner=restart.corner, force=restart.force, dissipation=restart.dissipation, work=restart.work)
    group.attrs["configuration"] = place(restart.configuration)
    group["load"] = restart.load
    group["met"] = np.array(
        [(place(one.configuration), one.ends_cycle, one.last, one.period, one.since) for one in met], dtype=np.int64
    ).reshape(-1, 5)
    group["marks"] = np.array(
        [(*key, place(mark.configuration), mark.corner, mark.number) for key, mark in marks], dtype=np.int64
    ).reshape(-1, 5)
    group["marks_dissipation"] = np.array([mark.dissipation for _, mark in marks])
    for name in _ARRAYS:
        group[f"configurations/{name}"] = np.array([getattr(one, name) for one in configurations])
    group.create_group("statistics").attrs.update(restart.statistics)


def read_restart(group: h5py.Group) -> Restart:
    """Read what :func:`write_restart` wrote."""
    arrays = {name: group[f"configurations/{name}"][()] for name in _ARRAYS}
    count = len(arrays["load"])
    all_of_them = [Configuration(**{name: arrays[name][k] for name in _ARRAYS}) for k in range(count)]
    met = [
        KnownConfiguration(all_of_them[place], bool(ends), int(last), int(period), int(since))
        for place, ends, last, period, since in group["met"][()]
    ]
    marks = {
        (int(block), int(inner)): CycleEnd(int(corner), int(number), all_of_them[place], float(dissipation))
        for (block, inner, place, corner, number), dissipation in zip(
            group["marks"][()], group["marks_dissipation"][()], strict=True
        )
    }
    return Restart(
        corner=int(group.attrs["corner"]),
        load=group["load"][()],
        force=float(group.attrs["force"]),
        configuration=all_of_them[int(group.attrs["configuration"])],
        dissipation=float(group.attrs["dissipation"]),
        work=float(group.attrs["work"]),
        repeats=Repeats(met),
        marks=marks,
        statistics={str(name): float(value) for name, value in group["statistics"].attrs.items()},
    )
