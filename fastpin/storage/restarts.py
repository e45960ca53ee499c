"""Restarts in an HDF5 file: the groups of ``/restart`` in a result, and checkpoints."""

from __future__ import annotations

import dataclasses
from typing import Any

import h5py
import numpy as np

from fastpin.model import checks, loads
from fastpin.reading.marks import Marks
from fastpin.solver.configuration import MARKS, Configuration
from fastpin.solver.repeats import CycleEnd, KnownConfiguration, Repeats
from fastpin.solver.result import Restart
from fastpin.solver.slip_tally import NOT_COUNTED, SlipTally
from fastpin.storage.hdf5 import as_python, check_between, check_extremes, check_finite, dataset_of, numbers_of
from fastpin.storage.layout import BORDER_FIELDS, SEATED, SMALL_NUMBERS, STATUS_LIMITS, all_loads, check_old_borders

LEAST_FORCE = 1e-145
"""Least reference force in a file, N/m; the largest is its inverse. The limits of units and loads imply it."""

# Sums begin anew at a corner. Marks have arrays of another form.
ARRAYS = [
    field.name
    for field in dataclasses.fields(Configuration)
    if field.name not in ("dissipation", "work", "seat_dissipation", "slip_tally", *MARKS)
]


def write_restart(group: h5py.Group, restart: Restart) -> None:
    """Write a restart into an empty group.

    Configurations are dimensionless: tractions in F/R, displacements in F beta*.
    """
    known, marks = list(restart.repeats), list(restart.marks.items())
    configurations: list[Configuration] = []
    indices: dict[int, int] = {}

    def index_of(configuration: Configuration) -> int:
        """Return the index of a configuration. Configurations that share their arrays are stored once."""
        index = indices.setdefault(id(configuration.slip), len(configurations))
        if index == len(configurations):
            configurations.append(configuration)
        return index

    group.attrs.update(corner=restart.corner, force=restart.force, dissipation=restart.dissipation, work=restart.work)
    group.attrs["configuration"] = index_of(restart.configuration)
    group["load"] = restart.load
    sums = restart.slip_tally.sums
    if np.isfinite(sums).all(axis=0).any():  # a node was closed since the latest kept state
        group["slip_tally"] = sums
    group["met"] = np.array(
        [(index_of(item.configuration), item.ends_cycle, item.last, item.period, item.since) for item in known],
        dtype=np.int64,
    ).reshape(-1, 5)
    group["marks"] = np.array(
        [(*key, index_of(mark.configuration), mark.corner, mark.number) for key, mark in marks], dtype=np.int64
    ).reshape(-1, 5)
    group["marks_dissipation"] = np.array([mark.dissipation for _, mark in marks])
    for name in ARRAYS:
        group[f"configurations/{name}"] = np.array([getattr(item, name) for item in configurations])
    for place, marks_field in enumerate(MARKS[: restart.configuration.motion.size // 3]):
        parts = [getattr(item, marks_field).arrays(item.status.size) for item in configurations]
        for name, values in zip(BORDER_FIELDS, zip(*parts, strict=True), strict=True):
            group[f"configurations/{SEATED[place]}{name}"] = np.array(values)
    if restart.seat_dissipation:
        group.attrs["seat_dissipation"] = restart.seat_dissipation
    group.create_group("statistics").attrs.update(restart.statistics)


def read_restart(group: h5py.Group, nodes: int) -> Restart:
    """Read a restart, with so many nodes of pin and seat, from a group of :func:`write_restart`.

    Raises
    ------
    ValueError
        If a number is not finite or out of range, or the arrays don't fit each other.
    """
    seated = SEATED if f"{SEATED[1]}old_borders" in group["configurations"] else SEATED[:1]
    borders = [f"{before}{name}" for before in seated for name in BORDER_FIELDS]
    arrays = {
        name: _read_configurations(group["configurations"], name, nodes, 3 * len(seated))
        for name in (*ARRAYS, *borders)
    }
    size = len(arrays["load"])
    if any(len(array) != size for array in arrays.values()):
        raise ValueError(f"{group.name[1:]}/configurations has arrays of different lengths")
    all_marks: list[dict[str, Any]] = [{} for _ in range(size)]
    for field, before in zip(MARKS, seated, strict=False):
        pairs = [arrays[f"{before}{name}"] for name in BORDER_FIELDS]
        check_old_borders(f"configurations/{before}".rstrip("/"), *pairs)
        for marks_of, *pair in zip(all_marks, *pairs, strict=True):
            marks_of[field] = Marks.stored(*pair)
    configurations = [Configuration(**{name: arrays[name][k] for name in ARRAYS}, **all_marks[k]) for k in range(size)]
    met, marks = (dataset_of(group, name, np.int64, (5,))[()] for name in ("met", "marks"))
    dissipations = dataset_of(group, "marks_dissipation", float, ())[()]
    check_between("met", met[:, 0], 0, size - 1)
    check_between("marks", marks[:, 2], 0, size - 1)
    check_finite("marks_dissipation", dissipations)
    load = all_loads(group["load"][()], 0.0)
    if load.shape != (len(loads.LOADS),):
        raise ValueError(f"the load of {group.name[1:]} has the shape {load.shape}")
    check_finite("load", load)
    return Restart(
        corner=checks.whole_number("corner", as_python(group.attrs["corner"]), 0),
        load=load,
        force=checks.number("force", group.attrs["force"], LEAST_FORCE, 1.0 / LEAST_FORCE),
        configuration=configurations[checks.whole_number("configuration", as_python(group.attrs["configuration"]), 0)],
        dissipation=checks.number("dissipation", group.attrs["dissipation"]),
        work=checks.number("work", group.attrs["work"]),
        repeats=Repeats(
            [
                KnownConfiguration(configurations[index], bool(ends), last, period, since)
                for index, ends, last, period, since in met.tolist()
            ]
        ),
        marks={
            (block, inner): CycleEnd(corner, times, configurations[index], dissipation)
            for (block, inner, index, corner, times), dissipation in zip(
                marks.tolist(), dissipations.tolist(), strict=True
            )
        },
        statistics=numbers_of(group["statistics"]),
        slip_tally=_read_slip_tally(group, nodes),
        seat_dissipation=checks.number("seat_dissipation", group.attrs.get("seat_dissipation", 0.0)),
    )


def _read_slip_tally(group: h5py.Group, nodes: int) -> SlipTally:
    """Read the slip tally of a restart on a grid of so many nodes."""
    if "slip_tally" not in group:
        return NOT_COUNTED
    tally: np.ndarray = dataset_of(group, "slip_tally", float, (nodes,))[()]
    if len(tally) != 4:
        raise ValueError(f"slip_tally has the shape {tally.shape}")
    check_finite("slip_tally", tally[:2])
    check_extremes("slip_tally", tally[2], tally[3], (tally[2] == np.inf) & (tally[3] == -np.inf))
    return SlipTally(tally)


def _read_configurations(group: h5py.Group, name: str, nodes: int, motions: int) -> np.ndarray:
    """Read one array of all configurations of a restart, shape (configurations, ...)."""
    size = {"motion": motions, "origin": 2 * motions // 3, "rest": 2 * motions // 3}.get(name, nodes)
    if name in BORDER_FIELDS and name not in group:  # a file of an earlier version
        value, dtype = (0, np.int8) if name == "old_borders" else (np.nan, float)
        return np.full((len(group["status"]), nodes), value, dtype=dtype)
    if name != "load":
        return read_array(group, name, size)
    array = all_loads(dataset_of(group, name, float)[()], 0.0)
    if array.shape[1:] != (len(loads.LOADS),):
        raise ValueError(f"configurations/load has the shape {array.shape}")
    check_finite("configurations/load", array)
    return array


def read_array(group: h5py.Group, name: str, size: int) -> np.ndarray:
    """Read and check one array of configurations, shape (configurations, size)."""
    dtype, label = np.int8 if name.removeprefix(SEATED[1]) in SMALL_NUMBERS else float, f"configurations/{name}"
    array: np.ndarray = dataset_of(group, name, dtype, (size,))[()]
    if name == "status":
        check_between(label, array, *STATUS_LIMITS)
    elif name not in ("origin", "old_places", "seat/old_places"):  # The origin is NaN before the pin has come to rest.
        check_finite(label, array)
    return array
