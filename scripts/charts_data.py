"""Make the data of the charts: solve all nodes of the tables, set the error bounds, and write the file of the package.

``python -m scripts.charts_data [--folder out/charts] [--calibration 1000] [--output fastpin/charts/charts.npz]`` keeps
what is solved in the folder, and goes on from there if it was stopped. It prints the numbers of runs and the time. The
calibration solves random points with twice the nodes. Their differences from the tables give the bounds of the cells.
"""

from __future__ import annotations

import argparse
import itertools
import json
import math
import time
import warnings
from pathlib import Path
from typing import Any

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from scipy.optimize import linprog

from fastpin.charts.groups import DATA, FEW, GROUPS, STORED, ChartGroup, ChartTable, load_parameter_at, write_tables
from fastpin.solver.errors import SolveError
from scripts.charts_runs import first_load_runs, first_load_values, pair_of, values_at

NODES = {False: 201, True: 151}
"""Nodes of the runs behind the tables: of the first load, and of a load cycle."""

FINE = {False: 401, True: 301}
"""Nodes of the runs of calibration and check."""

UNLIKE_SHARE = 2.5
"""Points of calibration of unlike bodies, in parts of the usual number: their tables have two dimensions more."""

CALIBRATION_SEED = 1
"""Seed of the points of calibration. The check has other seeds."""

SAFETY, USUAL = 4.0, 0.98
"""Bound of a region in parts of the largest error seen near it, and the part of all errors that is the least bound."""

LOCAL_SAFETY, LEAST_PART = 4.0, 1e-3
"""Bound of a cell in parts of the one that covers all errors of the calibration; its least part of its region's."""

HIDDEN = 1e-6
"""Least bound of the energy of a cycle of unlike bodies, P^2 beta*. Their contact always slips at its edges, over zones
that may be narrower than the distance of the nodes, and all nodes of a cell may miss them. Such a zone dissipated
2.4e-7 with 801 nodes, and 2e-11 with 151; :data:`SAFETY` times as much is the bound."""

JUMPING = ("peak_pressure_angle", "peak_hoop_angle", "cycle_stick_angle")
"""Quantities that jump, where another peak is the largest one, or a zone ends. All nodes round a cell may lie on one
side of a jump: then they do not tell of it. These quantities have the bounds of their regions."""

STEPS = 16
"""Steps of bounds between a bound and twice as much: few different numbers take less room in the file."""

LEAST_COUNTED = 1e-5
"""Errors below this part of the largest one do not shape the bounds: the least bounds are larger."""


def fill(group: ChartGroup, folder: Path) -> None:
    """Solve all nodes of the table of a group that are not solved, into a file of the folder."""
    path = folder / f"{group.name}.npy"
    if path.exists():
        table = np.load(path, mmap_mode="r+")
    else:
        table = np.lib.format.open_memmap(path, "w+", float, (*group.shape, len(group.quantities)))
        table[:] = math.nan
    nodes = [axis.coordinates() for axis in group.axes]
    if group.is_cycle:
        lines = list(itertools.product(*(range(n) for n in group.shape[:-1])))
    else:
        lines = list(itertools.product(*(range(n) for n in group.shape[1:])))
    done, runs, began, failed = 0, 0, time.perf_counter(), 0
    for count, line in enumerate(lines):
        where = line if group.is_cycle else (slice(None), *line)
        if np.isfinite(table[where][..., 0]).any():
            continue
        try:
            if group.is_cycle:
                for last, part in enumerate(nodes[-1]):
                    place = np.array([*(axis[i] for axis, i in zip(nodes, line, strict=False)), part])
                    values = values_at(group.parameters_at(place), NODES[True])
                    table[(*line, last)] = values[: len(group.quantities)]
                    runs += 1
            else:
                place = np.array([nodes[0][0], *(axis[i] for axis, i in zip(nodes[1:], line, strict=True))])
                one = group.parameters_at(place)
                widths = load_parameter_at(nodes[0])
                widths[-1] = 0.0  # without the rounding of the coordinate
                pair = pair_of(one["alpha"], one["beta"], one["kolosov"])
                table[where] = first_load_values(pair, one["friction"], one["pin_load"], widths.tolist(), NODES[False])
                runs += len(first_load_runs(widths.tolist()))
        except SolveError as error:
            failed += 1
            print(group.name, line, error, flush=True)
        done += 1
        if done % 20 == 0 or count + 1 == len(lines):
            table.flush()
            seconds = time.perf_counter() - began
            print(f"{group.name}: {count + 1} of {len(lines)} lines, {runs} runs, {seconds:.0f} s", flush=True)
    if runs:
        log(
            folder,
            group.name,
            runs=runs,
            states=int(np.prod(group.shape)),
            seconds=time.perf_counter() - began,
            failed=failed,
        )


def log(folder: Path, name: str, **numbers: Any) -> None:
    """Add a line to the log of the folder."""
    with (folder / "log.jsonl").open("a", encoding="utf-8") as file:
        file.write(json.dumps({"name": name, **numbers}) + "\n")


def points(group: ChartGroup, count: int, seed: int, folder: Path | None = None) -> tuple[np.ndarray, np.ndarray]:
    """Random places in a group, shape (count, axes), and their fresh values, shape (count, quantities).

    A folder keeps the values. Places are equally likely in the coordinates of the axes.
    """
    generator = np.random.default_rng([seed, list(GROUPS).index(group.name)])
    low, high = np.array([(axis.least, axis.most) for axis in group.axes]).T
    places = low + (high - low) * generator.random((count, len(group.axes)))
    path = None if folder is None else folder / f"{group.name}_{seed}.npy"
    values = np.full((count, len(group.quantities)), math.nan)
    if path is not None and path.exists():
        known = np.load(path)[:count]
        values[: len(known)] = known
    began, runs = time.perf_counter(), 0
    for k in range(count):
        if math.isnan(values[k, 0]):
            values[k] = values_at(group.parameters_at(places[k]), FINE[group.is_cycle])[: len(group.quantities)]
            runs += 1
            if path is not None and (runs % 50 == 0 or k == count - 1):
                np.save(path, values[: k + 1])
    if folder is not None and runs:
        log(folder, f"{group.name}, seed {seed}", runs=runs, states=runs, seconds=time.perf_counter() - began, failed=0)
    return places, values


def table_of(group: ChartGroup, folder: Path, count: int) -> ChartTable:
    """The table of a group from the solved nodes, with the bounds of `count` points of calibration."""
    solved = np.load(folder / f"{group.name}.npy")
    widths = np.maximum(load_parameter_at(group.axes[0].coordinates()), 0.0)
    at = widths.reshape(-1, *[1] * (len(group.axes) - 1))
    stored = [STORED[name].stored(solved[..., k], at) for k, name in enumerate(group.quantities)]
    values = np.stack(stored, axis=-1).astype(np.float32)
    share = UNLIKE_SHARE if group.name.startswith("unlike") else 1.0
    places, fresh = points(group, round(count * share), CALIBRATION_SEED, folder)
    none = np.zeros((*(count - 1 for count in group.shape), len(group.quantities)))
    trials = {order: ChartTable(group, values, [order] * len(group.quantities), none) for order in (2, 4)}
    errors = {order: deviations(table, places, fresh) for order, table in trials.items()}
    orders = [min(errors, key=lambda order: float(errors[order][:, k].max())) for k in range(len(group.quantities))]
    bounds = none.copy()
    for k, (name, order) in enumerate(zip(group.quantities, orders, strict=True)):
        most = region_bounds(trials[order], places, errors[order][:, k])
        bounds[..., k] = cell_bounds(trials[order], name, places, errors[order][:, k], most)
    return ChartTable(group, values, orders, bounds)


def deviations(table: ChartTable, places: np.ndarray, fresh: np.ndarray) -> np.ndarray:
    """Differences of a table from fresh values, in the measure of the bounds, shape (count, quantities)."""
    units, at = units_of(table.group, places)
    found = []
    for k, name in enumerate(table.group.quantities):
        value = table.value_at(name, units, at)[0]
        size = np.abs(value) if STORED[name].is_relative else 1.0
        found.append(np.abs(value - fresh[:, k]) / size)
    return np.stack(found, axis=-1)


def units_of(group: ChartGroup, places: np.ndarray) -> tuple[list[np.ndarray], np.ndarray]:
    """The places in units of the axes, and their load parameters."""
    units = [(places[:, k] - axis.least) / (axis.most - axis.least) for k, axis in enumerate(group.axes)]
    return units, np.maximum(load_parameter_at(places[:, 0]), 0.0)


def region_bounds(table: ChartTable, places: np.ndarray, errors: np.ndarray) -> np.ndarray:
    """The bound of each region: :data:`SAFETY` times the largest error in it and its neighbours, and at least the
    part :data:`USUAL` of all errors. Shape (*group.regions,).
    """
    regions, counts = np.zeros(table.group.regions), table.group.regions
    units = units_of(table.group, places)[0]
    np.maximum.at(regions, tuple(places_among(unit, count) for unit, count in zip(units, counts, strict=True)), errors)
    wide = np.pad(regions, 1, mode="edge")
    shifts = itertools.product(range(3), repeat=regions.ndim)
    near = [wide[tuple(slice(s, s + n) for s, n in zip(shift, regions.shape, strict=True))] for shift in shifts]
    return np.maximum(SAFETY * np.max(near, axis=0), np.quantile(errors, USUAL))


def cell_bounds(table: ChartTable, name: str, places: np.ndarray, errors: np.ndarray, most: np.ndarray) -> np.ndarray:
    """The bound of each cell between the nodes: by how rough the table is there, and at most that of its region.

    Beside a kink each node differs from what its neighbours tell. The bound is a constant and a sum of these
    differences, along each axis, in the cell and in its neighbours. The factors are the least ones, by linear
    programming, that cover all errors of the calibration; :data:`LOCAL_SAFETY` times as much is the bound.

    Parameters
    ----------
    table : ChartTable
    name : str
        The quantity.
    places : ndarray, shape (count, axes)
    errors : ndarray, shape (count,)
    most : ndarray, shape (*group.regions,)
        Bounds of the regions.
    """
    found = roughness(table, name)
    units = units_of(table.group, places)[0]
    cells = found.shape[1:]
    at = tuple(places_among(unit, count) for unit, count in zip(units, cells, strict=True))
    here = np.stack([*found, np.ones(cells)])[(slice(None), *at)].T
    large = np.maximum(here.max(axis=0), 1e-300)
    part = here / large
    counted = errors > LEAST_COUNTED * errors.max()
    size = 100.0 * LEAST_COUNTED * float(errors.max())  # the tolerance of the programming is some 1e-7
    weight = 1.0 / (here[:, :-1].sum(axis=1) + np.quantile(errors, 0.7) + 1e-15)
    wanted = (part * weight[:, None]).mean(axis=0) / np.median(weight)
    solved = linprog(wanted, A_ub=-part[counted] / size, b_ub=-errors[counted] / size, method="highs")
    factors = solved.x / large
    local = LOCAL_SAFETY * (np.tensordot(factors[:-1], found, 1) + factors[-1])
    if name in JUMPING:
        local = np.full(cells, np.inf)
    for axis, count in enumerate(cells):  # a cell may lie in two regions
        ends = (places_among((np.arange(count) + part) / count, most.shape[axis]) for part in (1e-9, 1.0 - 1e-9))
        most = np.maximum(*(most.take(end, axis) for end in ends))
    least = HIDDEN if name == "cycle_energy" and table.group.name.startswith("unlike") else 0.0
    bounds = np.maximum(np.clip(local, LEAST_PART * most, most), least)
    return 2.0 ** (np.ceil(STEPS * np.log2(bounds)) / STEPS)


def roughness(table: ChartTable, name: str) -> np.ndarray:
    """Differences of nodes from the cubics through their neighbours, largest in each cell, and in each cell with its
    neighbours: shape (kinds, *cells). Each axis of many nodes is a kind, and all axes of few nodes together are one.
    """
    values, stored = table.values[name], STORED[name]
    widths = np.maximum(load_parameter_at(table.group.axes[0].coordinates()), 0.0)
    at = widths.reshape(-1, *[1] * (values.ndim - 1))
    own = np.abs(stored.value(values, at))
    few, kinds = np.zeros(values.shape), []
    for axis, count in enumerate(values.shape):
        order = min(count - 1, 4)
        differences = np.abs(np.diff(values, order, axis)) / 2.0**order
        sides = [((count - differences.shape[axis]) // 2, (count - differences.shape[axis] + 1) // 2)]
        pads = [(0, 0)] * axis + sides + [(0, 0)] * (values.ndim - axis - 1)
        there = np.pad(differences, pads, mode="edge")
        if count <= FEW:
            few += there
        else:
            kinds.append(there)
    found = []
    for kind in (*kinds, few):
        moved = np.abs(stored.value(np.maximum(values, 0.0) + kind, at) - stored.value(np.maximum(values, 0.0), at))
        measure = moved / np.maximum(own, 1e-300) if stored.is_relative else moved
        found += [_largest(measure, 0), _largest(measure, 1)]
    return np.array(found)


def _largest(nodes: np.ndarray, beyond: int) -> np.ndarray:
    """The largest value at the nodes of each cell, and of so many cells beside it along each axis."""
    for axis in range(nodes.ndim):
        wide = np.pad(nodes, [(beyond, beyond) if k == axis else (0, 0) for k in range(nodes.ndim)], mode="edge")
        nodes = sliding_window_view(wide, 2 + 2 * beyond, axis=axis).max(axis=-1)
    return nodes


def places_among(unit: np.ndarray, count: int) -> np.ndarray:
    """The parts, of `count` equal ones, in which units of an axis lie."""
    return np.minimum((unit * count).astype(int), count - 1)


def main() -> None:
    """Read the options, solve, and write the file."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--folder", type=Path, default=Path("out/charts"))
    parser.add_argument("--calibration", type=int, default=1000, help="random points of each group")
    parser.add_argument("--output", type=Path, default=DATA)
    options = parser.parse_args()
    options.folder.mkdir(parents=True, exist_ok=True)
    warnings.simplefilter("ignore")
    for group in GROUPS.values():
        fill(group, options.folder)
    found = {name: table_of(group, options.folder, options.calibration) for name, group in GROUPS.items()}
    write_tables(options.output, found)
    lines = [json.loads(line) for line in (options.folder / "log.jsonl").read_text(encoding="utf-8").splitlines()]
    totals = {name: sum(line[name] for line in lines) for name in ("runs", "states", "seconds", "failed")}
    print(", ".join(f"{value:,.0f} {name}" for name, value in totals.items()))
    print(f"{options.output}: {options.output.stat().st_size / 1e6:.2f} MB")


if __name__ == "__main__":
    main()
