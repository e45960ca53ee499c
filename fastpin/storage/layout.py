"""The layout of a result in an HDF5 file.

======================  ============================================================================================
``/``                   attributes: format, versions, date and machine, whether the run is complete, its error
``/problem``            attributes: geometry, friction, materials, units; bodies that are no solid pin or infinite plate
                        ``gap/hole``, ``gap/pin``, ``friction``: profiles along the rim, a group for each term
``/history``            ``corners`` (NaN: not given), ``blocks`` of corners with the number of times of each block
``/grid``               ``theta`` (n,), rad
``/solver``             attributes: method and options; ``statistics``
``/states``             one array for each quantity, one row for each state: (states,), (states, n) or (states, names)
``/cycles``             one array for each quantity, one row for each cycle; empty if the history has no cycles
``/extremes``           of a complete run with many states: the places of its extremes, see extremes.py
``/restart``            restarts to continue from: ``start``, ``latest`` and the corners of the option ``save_after``
``/coarse``             with error bars: grid, states, cycles and ``restart/latest`` of the history on the coarse grid
======================  ============================================================================================

Every array has its unit as an attribute. Dimensions are named as in netCDF, so xarray reads ``/states`` directly.
"""

from __future__ import annotations

import functools
import platform
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import fields
from datetime import UTC, datetime
from importlib import metadata
from typing import Any

import h5py
import numpy as np

from fastpin.elasticity.interfaces import seat_grid
from fastpin.errors import InputError
from fastpin.kernels.half_line import LEAST_PLACE, MOST_PLACE
from fastpin.kernels.status import Status
from fastpin.model import About, Grid, MaterialPair, Problem
from fastpin.model.case import BESIDE, read_text, stored_text
from fastpin.model.fields import FIELDS
from fastpin.model.history import Block, LoadHistory
from fastpin.model.loads import LOAD_KIND, LOADS
from fastpin.model.options import OPTIONS, SolveOptions
from fastpin.model.units import units_per_thickness
from fastpin.reading.marks import Marks
from fastpin.reading.old_borders import BITS
from fastpin.solver.result import Result
from fastpin.states.cycles import CYCLE_KINDS, Cycle
from fastpin.states.state import State
from fastpin.storage import hdf5
from fastpin.storage.bodies import read_bodies, read_material, read_profiles, write_entries
from fastpin.version import __version__

FORMAT, JOINT = "fastpin result", "fastpin joint"
"""Formats of files: the result of one pin, and that of a joint of several pins; see joint_files.py."""

FORMAT_VERSION = 2
"""Version of the format of files with a solid pin in an infinite plate."""

WITH_BODIES = 3
"""Version with other bodies. Programs that know version 2 only would not see the bodies, and must refuse the file."""

WITH_PROFILES = 4
"""Version with an initial gap, or with friction that varies along the rim, for the same reason."""

WITH_SEAT = 5
"""Version with a bush that slips in its seat, for the same reason."""

WITH_LAMINATE = 6
"""Version with a plate that is a laminate, for the same reason."""

OTHERWISE = {
    FORMAT: "holds a joint of several pins; fastpin show, joint --resume and fastpin.storage.load_joint read it",
    JOINT: "holds the result of one pin, not of a joint of several; fastpin show and fastpin.load read it",
}
"""What is wrong with a file of the other format, by the format that is needed."""

# Each dict below maps a stored field to its kind of quantity: a key of fastpin.model.units.units, or "" for a plain
# number. The other fields of State are written and read one by one. Error bars come from the states in ``/coarse``.
# A test checks that every field of State is in one of the three tables.
NODE_FIELDS = {
    "pressure": "traction",
    "shear": "traction",
    "gap": "displacement",
    "slip": "displacement",
    "status": "",
}
"""Kind of quantity of each field of a state with one value for each node, shape (n,)."""

EXTREMES = ("slip_lowest", "slip_highest")
"""Fields of the extremes of the slip. Both are NaN at a node that was not closed."""

SLIP_FIELDS = {
    "slip_distance": "displacement",
    "friction_energy": "energy density",
    **dict.fromkeys(EXTREMES, "displacement"),
}
"""Kind of quantity of each field, shape (n,), that a state has where slip is counted."""

BORDER_FIELDS = {"old_borders": "", "old_places": ""}
"""Kind of quantity of each field, shape (n,), with the old borders of a state. Files of earlier versions lack them."""

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
"""Kind of quantity of each field of a state with one number."""

OF_WHOLE = ("work", "energy")
"""Numbers that belong to a whole joint: the states of one pin in one plate lack them."""

HOLE_FIELDS = ("incoming", "edge", "rubbed", "acting")
"""Arrays of a pin in one plate, Pa, with what acts on its hole and plate beside the pin; see joint_files.py."""

FIELD_KINDS = {**NODE_FIELDS, **BORDER_FIELDS, **SLIP_FIELDS, **NUMBER_FIELDS}
"""Kind of quantity of each array of node values or numbers in ``/states``."""

SEAT_NUMBERS = ("dx", "dy", "rotation", "dissipation")
"""Fields with one number that a seat has of its own. The others are those of the pin's state."""

SEATED = ("", "seat/")
"""What stands before the names of the arrays of pin and seat."""

RESIDUALS = ("gap", "slip", "cone", "equilibrium")
"""Names of the residuals of a state, in the order of a row."""

SMALL_NUMBERS = ("status", "old_borders")
"""Fields of states that are whole numbers of one byte."""


STATUS_LIMITS = (min(Status), max(Status))
"""Smallest and largest status of a node."""

DENSE = 8
"""Rows of a slice, in parts of the picked ones, up to which the slice is read: each row alone takes some 50 us."""


Rows = dict[str, np.ndarray]
"""Arrays of some states or cycles, by quantity. The first dimension counts the states or cycles."""


def node_fields(group: h5py.Group) -> dict[str, str]:
    """Return the kind of quantity of each field with node values that ``/states`` holds, ``group``."""
    return _node_fields("slip_distance" in group, "old_borders" in group)


def node_fields_of(states: Sequence[State]) -> dict[str, str]:
    """Return the kind of quantity of each field with node values that all states have. Old borders may be empty."""
    return _node_fields(has_slip=len(states) > 0 and all(state.slip_distance is not None for state in states))


def _node_fields(has_slip: bool, has_borders: bool = True) -> dict[str, str]:
    return NODE_FIELDS | (BORDER_FIELDS if has_borders else {}) | (SLIP_FIELDS if has_slip else {})


def number_fields(group: h5py.Group) -> list[str]:
    """Return the names of the fields with one number that ``/states`` has, ``group``, also of one pin in a plate."""
    return [name for name in NUMBER_FIELDS if name not in OF_WHOLE or HOLE_FIELDS[0] not in group]


def state_rows(group: h5py.Group) -> tuple[str, ...]:
    """Return the names of the arrays of ``/states``, ``group``, with one row for each state."""
    seat = [f"{SEATED[1]}{name}" for name in (*node_fields(group), *SEAT_NUMBERS)] if "seat" in group else []
    return (*node_fields(group), *number_fields(group), "loads", "residuals", *seat)


# -- parts of fixed size: problem, history, grid, options, statistics ---------------------------------------


def write_head(file: h5py.File, problem: Problem, history: LoadHistory, grid: Grid, options: Mapping[str, Any]) -> None:
    """Write everything except the states, cycles and restarts into an empty file.

    `options` are the attributes of ``/solver``; None leaves an option out. The arrays of states and cycles begin
    without rows.
    """
    with_bodies = WITH_BODIES if problem.has_bodies else FORMAT_VERSION
    with_profiles = WITH_PROFILES if problem.profiles else with_bodies
    with_seat = with_profiles if problem.seat is None else WITH_SEAT
    write_origin(file, FORMAT, with_seat if problem.pair.plate.is_isotropic else WITH_LAMINATE)
    _write_problem(file.create_group("problem"), problem)
    _write_history(file.create_group("history"), problem, history)
    solver = file.create_group("solver")
    solver.attrs.update({name: value for name, value in options.items() if value is not None})
    solver.create_group("statistics")
    write_grid(file, problem, history, grid, _node_fields(has_slip=bool(options.get("slip_sums"))))


def write_origin(file: h5py.File, form: str, version: int) -> None:
    """Write the format of an unfinished result, and where it was made."""
    made = {"created": datetime.now(UTC).isoformat(timespec="seconds"), "platform": platform.platform()}
    file.attrs.update(format=form, format_version=version, complete=False, **made, host=platform.node())
    file.attrs.update({f"version_{name}": version for name, version in versions().items()})


def options_of(result: Result) -> dict[str, Any]:
    """Return the options that a result shows, as attributes of ``/solver`` for :func:`write_head`."""
    has_slip = "slip_distance" in node_fields_of(result.states)
    return {"method": result.method, "slip_sums": has_slip or None, "error_bars": result.coarse is not None or None}


def write_grid(file: h5py.Group, problem: Problem, history: LoadHistory, grid: Grid, fields: Mapping[str, str]) -> None:
    """Write a grid, and the arrays of states and cycles on it, without rows, into a file or its group ``/coarse``.

    `fields` are the kinds of the fields with node values, as in :func:`node_fields_of`.
    """
    file.create_group("grid").attrs["closed"] = grid.closed
    make_states(file, problem, grid, fields)
    cycles, unit = file.create_group("cycles"), units_per_thickness(problem)
    for name, kind in CYCLE_KINDS.items() if history.longest_cycle else ():
        growing(cycles, name, (), _dtype(name), unit.get(kind, ""))


@functools.cache
def versions() -> dict[str, str]:
    """Return the versions of fastpin, Python and the libraries, by name."""
    libraries = {name: metadata.version(name) for name in ("numpy", "scipy", "numba", "h5py")}
    return {"fastpin": __version__, "python": platform.python_version(), **libraries}


def _write_problem(group: h5py.Group, problem: Problem) -> None:
    bodies = {name: body.entries() for name, body in problem.given_bodies.items()}
    own = {
        "dimensionless": problem.dimensionless,
        **{each.name: getattr(problem.pair, each.name) for each in fields(MaterialPair)},
    }
    write_entries(group, {**problem.entries(), **own, **bodies})
    group.attrs["units"] = [f"{kind}: {name}" for kind, name in units_per_thickness(problem).items()]


def read_problem(file: h5py.File) -> Problem:
    """Read the problem of a result."""
    group = file["problem"]
    pair = MaterialPair(read_material(group["pin"]), read_material(group["plate"]), group.attrs["plane"])
    given = {name: hdf5.as_python(group.attrs[name]) for name in (*FIELDS, "dimensionless") if name in group.attrs}
    return Problem(pair, **given, **read_profiles(group), **read_bodies(group))


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
    """Read the load history of a result."""
    group = file["history"]
    corners = all_loads(group["corners"][()], np.nan)
    ends, lengths = group["ends"][()], group["cycle_lengths"][()].tolist()
    blocks, row, inner = [], 0, 0
    for rows, count, cycle, size, cycles in group["blocks"][()].tolist():
        inner_lengths = tuple(lengths[inner : inner + cycles])
        blocks.append(Block(corners[row : row + rows], ends[row : row + rows], inner_lengths, count, bool(cycle), size))
        row, inner = row + rows, inner + cycles
    return LoadHistory.of_blocks(blocks)


def read_grid(file: h5py.File) -> Grid:
    """Read the grid of a result."""
    return Grid(file["grid/theta"][()], bool(file["grid"].attrs["closed"]))


def option_attributes(options: SolveOptions) -> dict[str, Any]:
    """Return the options of a run as attributes of ``/solver``."""
    attributes = options.written
    del attributes["between"]
    return {**attributes, "fractions": options.fractions}


def read_options(file: h5py.File) -> SolveOptions:
    """Read the options of a result. A file of :func:`fastpin.save` has only the nodes and the method."""
    stored = {name: hdf5.as_python(value) for name, value in file["solver"].attrs.items()}
    options: dict[str, Any] = {"nodes": stored.get("nodes", len(file["grid/theta"])), "method": stored["method"]}
    if options["method"] == "increment":
        options["increments"] = stored.get("increments")
    if "fractions" in stored:
        options["between"] = stored["fractions"][:-1].tolist()
    if "arc" in stored:
        start, stop = stored["arc"].tolist()
        # Earlier versions took an arc longer than 2 pi as a circle.
        options["arc"] = (start, min(stop, start + 2.0 * np.pi))
    other_form = ("nodes", "method", "increments", "arc", "between")  # or not in every file
    options |= {name: stored[name] for name in OPTIONS if name in stored and name not in other_form}
    return SolveOptions(**options)


def read_about(file: h5py.File) -> About:
    """Read who made the case of a result, and for what."""
    stored = file["solver"].attrs
    return About(**{each.name: hdf5.text_of(stored.get(each.name, "")) for each in fields(About)})


def beside_attributes(given: Mapping[str, Any]) -> dict[str, str]:
    """Return the attributes of the solver with the sections beside the problem, by name: JSON."""
    return {name: stored_text(name, value) for name, value in given.items()}


def read_beside(file: h5py.File) -> dict[str, Any]:
    """Read the sections beside the problem that the case of a result has, by name; none in older files."""
    stored = file["solver"].attrs
    found = {name: read_text(name, hdf5.text_of(stored.get(name, ""))) for name in BESIDE}
    return {name: value for name, value in found.items() if value is not None}


def write_statistics(file: h5py.File, statistics: Mapping[str, float]) -> None:
    """Write the statistics of the solver, by name."""
    file["solver/statistics"].attrs.update(statistics)


def read_statistics(file: h5py.File) -> dict[str, float]:
    """Read the statistics of the solver, by name."""
    return hdf5.numbers_of(file["solver/statistics"])


# -- growing arrays: states, cycles -------------------------------------------------------------------------

_PACKED: dict[str, Any] = {"compression": "gzip", "compression_opts": 1, "shuffle": True}


def _dtype(name: str) -> type:
    name = name.removeprefix(SEATED[1])
    if name in SMALL_NUMBERS:
        return np.int8
    if name in ("step", "corner", "length", "number"):
        return np.int64
    return bool if name == "solved" else float


def growing(group: h5py.Group, name: str, shape: tuple[int, ...], dtype: type, unit: str | list[str]) -> h5py.Dataset:
    """Create an array that grows by rows.

    Each row of node values is a chunk, compressed, and never written again.
    """
    nodes = name in NODE_FIELDS or name in BORDER_FIELDS or name in SLIP_FIELDS or name in HOLE_FIELDS
    chunks = (1 if nodes else 128, *shape)
    dataset = group.create_dataset(
        name, (0, *shape), maxshape=(None, *shape), chunks=chunks, dtype=dtype, **(_PACKED if nodes else {})
    )
    dataset.attrs["unit"] = unit
    return dataset


def make_states(file: h5py.Group, problem: Problem, grid: Grid, fields: Mapping[str, str], hole: int = 0) -> None:
    """Create the arrays of ``/states`` without rows. `fields` are the fields with node values, with their kinds.

    `hole` is the number of coefficients of the hole of one pin in one plate of a joint.
    """
    group, unit = file.create_group("states"), units_per_thickness(problem)
    scales = {
        "state": growing(group, "state", (), np.int64, ""),
        "theta": group.create_dataset("theta", data=grid.theta),
        "load_name": group.create_dataset("load_name", data=list(LOADS), dtype=h5py.string_dtype()),
        "residual_name": group.create_dataset("residual_name", data=list(RESIDUALS), dtype=h5py.string_dtype()),
    }
    scales["theta"].attrs["unit"] = "rad"
    file["grid/theta"] = scales["theta"]
    for name, scale in scales.items():
        scale.make_scale(name)
    arrays = [(name, kind, "theta", grid.size) for name, kind in fields.items()]
    for name in HOLE_FIELDS if hole else ():
        growing(group, name, (3 if name == "acting" else hole,), float, "Pa")
    arrays += [(name, NUMBER_FIELDS[name], "", 0) for name in number_fields(group)]
    for name, kind, dimension, size in arrays:
        dataset = growing(group, name, (size,) if dimension else (), _dtype(name), unit.get(kind, ""))
        dataset.dims[0].attach_scale(scales["state"])
        if dimension:
            dataset.dims[1].attach_scale(scales[dimension])
    if problem.seat is not None:
        _make_seat(group, problem.seat, seat_grid(problem, grid), fields)
    loads = growing(group, "loads", (len(LOADS),), float, load_units(problem))
    residuals = growing(group, "residuals", (len(RESIDUALS),), float, "")
    for dataset, dimension in ((loads, "load_name"), (residuals, "residual_name")):
        dataset.dims[0].attach_scale(scales["state"])
        dataset.dims[1].attach_scale(scales[dimension])


def _make_seat(states: h5py.Group, problem: Problem, grid: Grid, fields: Mapping[str, str]) -> None:
    """Create the arrays of the seat's states in its group of ``/states``, without rows."""
    group, unit = states.create_group("seat"), units_per_thickness(problem)
    theta = group.create_dataset("theta", data=grid.theta)
    theta.attrs["unit"] = "rad"
    theta.make_scale("seat_theta")
    for name, kind in fields.items():
        dataset = growing(group, name, (grid.size,), _dtype(name), unit.get(kind, ""))
        dataset.dims[0].attach_scale(states["state"])
        dataset.dims[1].attach_scale(theta)
    for name in SEAT_NUMBERS:
        growing(group, name, (), float, unit[NUMBER_FIELDS[name]]).dims[0].attach_scale(states["state"])


def load_units(problem: Problem) -> list[str]:
    """Return the unit of each load, in the order of a load vector."""
    unit = units_per_thickness(problem)
    return [unit[LOAD_KIND[name]] for name in LOADS]


def all_loads(vectors: np.ndarray, missing: float) -> np.ndarray:
    """Add the loads that were unknown when a file was written. New loads stand at the end of a load vector.

    Parameters
    ----------
    vectors : ndarray, shape (..., loads of the file)
    missing : float
        Value of the other loads: 0, or NaN for loads that are not given.
    """
    lacking = len(LOADS) - vectors.shape[-1]
    return np.pad(vectors, [(0, 0)] * (vectors.ndim - 1) + [(0, lacking)], constant_values=missing)


def rows_of(states: Sequence[State]) -> Rows:
    """Return the rows of some states. The residuals or the old borders of a state may be missing."""
    names = [*(name for name in node_fields_of(states) if name not in BORDER_FIELDS), *NUMBER_FIELDS]
    rows: Rows = _own_rows(states, names)
    seats = [state.seat for state in states if state.seat is not None]
    if seats:
        names = [name for name in names if name not in NUMBER_FIELDS]
        rows |= {f"{SEATED[1]}{name}": array for name, array in _own_rows(seats, [*names, *SEAT_NUMBERS]).items()}
    rows["loads"] = np.array([[state.load[name] for name in LOADS] for state in states], dtype=float)
    rows["residuals"] = np.array(
        [[state.residuals.get(name, np.nan) for name in RESIDUALS] for state in states], dtype=float
    )
    return rows


def _own_rows(states: Sequence[State], names: Sequence[str]) -> Rows:
    """Return the fields `names` and the old borders of some states of pin or seat."""
    rows: Rows = {name: np.array([getattr(state, name) for state in states], dtype=_dtype(name)) for name in names}
    marks = [(state.marks or Marks()).arrays(state.grid.size) for state in states]
    for k, name in enumerate(BORDER_FIELDS):
        rows[name] = np.array([arrays[k] for arrays in marks], dtype=_dtype(name))
    return rows


def cycle_rows(cycles: Sequence[Cycle]) -> Rows:
    """Return the rows of some cycles."""
    return {name: np.array([getattr(cycle, name) for cycle in cycles], dtype=_dtype(name)) for name in CYCLE_KINDS}


def count(group: h5py.Group) -> int:
    """Return the number of rows of ``/states``, ``/cycles`` or ``/wear``."""
    first = next((group[name] for name in ("state", "corner", "cycle") if name in group), None)
    return 0 if first is None else int(first.shape[0])


def append(group: h5py.Group, rows: Rows) -> None:
    """Append rows to ``/states``, ``/cycles`` or ``/wear``."""
    size, old = len(next(iter(rows.values()))), count(group)
    if size == 0:
        return
    if "state" in group:
        rows = {"state": np.arange(old, old + size), **rows}
    for name, array in rows.items():
        dataset = group[name]
        dataset.resize(old + size, axis=0)
        dataset[old:] = array[:, : dataset.shape[1]] if name == "loads" else array  # an older file has fewer loads


def read_rows(group: h5py.Group, names: Sequence[str], picked: slice | Sequence[int]) -> Rows:
    """Read some rows of ``/states`` or ``/cycles``.

    Parameters
    ----------
    group : h5py.Group
    names : sequence of str
        Arrays of the group.
    picked : slice or sequence of int
        Places of the rows. A sequence may have any order.

    Raises
    ------
    ValueError
        If the arrays have different numbers of rows.
    """
    size = count(group)
    arrays = {name: hdf5.dataset_of(group, name, _dtype(name)) for name in names}
    for name, array in arrays.items():
        if len(array) != size:
            raise ValueError(f"{group.name[1:]}/{name} has {len(array)} rows, not {size}")
    if isinstance(picked, slice):
        return {name: array[picked] for name, array in arrays.items()}
    first, last = min(picked, default=0), max(picked, default=0)
    if first >= 0 and last < min(size, first + DENSE * len(picked)):
        within = np.asarray(picked, dtype=np.int64) - first
        return {name: array[first : last + 1][within] for name, array in arrays.items()}
    return {
        name: np.array([array[index] for index in picked], array.dtype).reshape(-1, *array.shape[1:])
        for name, array in arrays.items()
    }


def check_states(file: h5py.File, nodes: int) -> None:
    """Raise :class:`ValueError` if an array of states is missing, or its rows don't fit the nodes of the pin."""
    group = file["states"]
    for name in node_fields(group):
        hdf5.dataset_of(group, name, _dtype(name), (nodes,))
    for name in number_fields(group):
        hdf5.dataset_of(group, name, _dtype(name), ())
    if "seat" in group:
        around = (len(hdf5.dataset_of(group["seat"], "theta", float, ())),)
        for name in (*node_fields(group), *SEAT_NUMBERS):
            hdf5.dataset_of(group, f"{SEATED[1]}{name}", _dtype(name), around if name not in SEAT_NUMBERS else ())
    hdf5.dataset_of(group, "residuals", float, (len(RESIDUALS),))
    if hdf5.dataset_of(group, "loads", float).ndim != 2 or group["loads"].shape[1] > len(LOADS):
        raise ValueError(f"states/loads has the shape {group['loads'].shape}")


def check_growing(file: h5py.File, nodes: int) -> None:
    """Raise :class:`ValueError` if a run can't append to the arrays of states and cycles."""
    check_states(file, nodes)
    if read_options(file).slip_sums != ("slip_distance" in file["states"]):
        raise ValueError("states/slip_distance and the option slip_sums don't fit")
    check_appendable(file["states"], ("state", *state_rows(file["states"])))
    check_appendable(file["cycles"], CYCLE_KINDS if len(file["cycles"]) else ())


def check_appendable(group: h5py.Group, names: Iterable[str]) -> None:
    """Raise :class:`ValueError` if no row can be appended to these arrays of ``/states`` or ``/cycles``."""
    for name in names:
        dataset = hdf5.dataset_of(group, name, np.int64 if name == "state" else _dtype(name))
        check_rows(f"{group.name[1:]}/{name}", dataset, count(group))


def check_rows(label: str, dataset: h5py.Dataset, size: int) -> None:
    """Raise :class:`ValueError` if an array has not so many rows, or if nothing can be appended to it."""
    if dataset.maxshape[0] is not None or dataset.chunks is None:
        raise ValueError(f"{label} can't grow")
    if len(dataset) != size:
        raise ValueError(f"{label} has {len(dataset)} rows, not {size}")


def check_old_borders(label: str, marks: np.ndarray, places: np.ndarray) -> None:
    """Raise :class:`ValueError` if marks or places of old borders are out of range. Unknown places are NaN."""
    hdf5.check_between(f"{label}/old_borders", marks, 0, sum(BITS.values()))
    hdf5.check_between(f"{label}/old_places", places[~np.isnan(places)], LEAST_PLACE, MOST_PLACE)


def read_cycles(file: h5py.File) -> list[Cycle]:
    """Read the cycles of a result."""
    if not count(file["cycles"]):
        return []
    rows = read_rows(file["cycles"], list(CYCLE_KINDS), slice(None))
    return [Cycle(*values) for values in zip(*(rows[name].tolist() for name in CYCLE_KINDS), strict=True)]


def check_format(file: h5py.File, path: str, form: str | None = FORMAT) -> None:
    """Raise :class:`InputError` if a file is no result of a `form`, or has another version of it. None is any form."""
    stored = file.attrs.get("format")
    if stored not in (FORMAT, JOINT):
        raise InputError(path, "is an HDF5 file, but not a result of fastpin")
    if form is not None and stored != form:
        raise InputError(path, OTHERWISE[form])
    versions = {FORMAT: (FORMAT_VERSION, WITH_BODIES, WITH_PROFILES, WITH_SEAT, WITH_LAMINATE), JOINT: (1,)}
    if file.attrs.get("format_version") not in versions[stored]:
        made_by = file.attrs.get("version_fastpin")
        origin = "" if made_by is None else f"; it was written by fastpin {made_by}"
        raise InputError(path, f"has a format that this version of fastpin can't read{origin}")
