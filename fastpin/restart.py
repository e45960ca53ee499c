"""Restarts in HDF5: everything that a run needs to go on from a corner, to the last bit."""

from __future__ import annotations

import dataclasses

import h5py
import numpy as np

from fastpin.collocation import Configuration
from fastpin.past import Mark
from fastpin.repeats import Met, Repeats
from fastpin.run import Restart

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
        Met(all_of_them[place], bool(ends), int(last), int(period), int(since))
        for place, ends, last, period, since in group["met"][()]
    ]
    marks = {
        (int(block), int(inner)): Mark(int(corner), int(number), all_of_them[place], float(dissipation))
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
