"""Fingerprints of results: has a change of the code changed a single bit of them?

``python scripts/fingerprint.py OUT.json [--histories 300] [--first 0] [--no-paper] [--no-sweep]`` solves random
histories, computes the paper's figures and runs a small sweep, and writes digests of all that was found.
``python scripts/fingerprint.py --compare OLD.json NEW.json`` says what differs between two such files.
"""

from __future__ import annotations

import argparse
import csv
import hashlib
import json
import math
import os
import struct
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterable, Mapping, Sequence
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np
from numpy.random import Generator

import fastpin
from fastpin import Grid, LoadHistory, Material, MaterialPair, Problem

ARRAYS = ("theta", "pressure", "shear", "gap", "slip", "status")
SOLVED = (*ARRAYS, "step", "fraction", "dx", "dy", "rotation", "dissipation", "work", "energy", "load", "residuals")
PEAKS = ("peak_pressure", "peak_pressure_angle", "peak_shear", "peak_shear_angle")
READ = (*PEAKS, "contact", "stick", "slip_zones", "resultants", "error_bars")
CHANGING = ("seconds", "started", "host")  # columns of a sweep's table

PLAN = """
[grid]
contact.friction = { from = 0.2, to = 1.0, count = 5 }
contact.clearance = { from = 1e-6, to = 1e-4, count = 4, spacing = "log" }
solve.nodes = [61, 101]
"""

Item = dict[str, str | int]


def encoded(value: Any) -> bytes:
    """Bytes that differ where values, types, shapes or orders differ; every NaN is the same."""
    if isinstance(value, np.ndarray):
        same = np.where(np.isnan(value), np.nan, value).astype(value.dtype.newbyteorder("<"))
        return f"a{same.dtype.str}{same.shape}".encode() + same.tobytes()
    if isinstance(value, float | np.floating):
        return b"f" + struct.pack("<d", math.nan if math.isnan(value) else value)
    if value is None or isinstance(value, str | int | np.integer | np.bool_):
        return f"{'s' if isinstance(value, str) else 'i'}{len(str(value))};{value}".encode()
    if isinstance(value, Mapping):
        return b"m" + encoded(list(value.items()))
    if isinstance(value, Sequence):
        return f"l{len(value)};".encode() + b"".join(map(encoded, value))
    raise TypeError(f"no digest of {type(value)}")


def digest(values: Iterable[Any]) -> str:
    """SHA-256 of values, one after the other."""
    return hashlib.sha256(b"".join(map(encoded, values))).hexdigest()


def one_of(rng: Generator, *choices: tuple[float, Any]) -> Any:
    """A random one of the values; each stands behind its chance, and the chances sum to 1."""
    return choices[int(rng.choice(len(choices), p=[chance for chance, _ in choices]))][1]


def random_pair(rng: Generator) -> MaterialPair:
    """Unlike, named or like bodies, or one of them rigid."""
    moduli, ratios = 10.0 ** rng.uniform(9.5, 11.8, 2), rng.uniform(0.0, 0.5, 2)
    first, second = (Material(*numbers) for numbers in zip(moduli.tolist(), ratios.tolist(), strict=True))
    named = [fastpin.MATERIALS[str(name)] for name in rng.choice(sorted(fastpin.MATERIALS), 2)]
    rigid = (0.15, (Material(math.inf, 0.3), second)), (0.05, (first, Material(math.inf, 0.3)))
    pin, plate = one_of(rng, (0.4, (first, second)), (0.15, (first, first)), (0.25, named), *rigid)
    return MaterialPair(pin, plate, one_of(rng, (0.5, "strain"), (0.5, "stress")))


def random_problem(rng: Generator) -> tuple[Problem, float]:
    """A problem with clearance, none or interference, in SI units or without units, and the unit of its forces."""
    pair, fit = random_pair(rng), one_of(rng, (0.65, 1.0), (0.15, 0.0), (0.2, -0.4))
    parameter = fit * 10.0 ** rng.uniform(-4.0, 0.4)
    friction = one_of(rng, (0.12, 0.0), (0.73, rng.uniform(0.02, 1.0)), (0.15, rng.uniform(1.0, 2.0)))
    pin_load, rotation = one_of(rng, (0.4, ("centre", "free")), (0.3, ("centre", "fixed")), (0.3, ("body", "free")))
    hub = one_of(rng, (0.5, None), (0.4, rng.uniform(0.2, 1.0)), (0.1, 1.0)) if rotation == "fixed" else None
    if rng.random() < 0.4:
        return Problem.from_load_parameter(pair, parameter, friction, pin_load, rotation, hub), 1.0
    radius = 10.0 ** rng.uniform(-3.0, -1.0)
    force = 10.0 ** rng.uniform(-4.0, -2.0) * radius / pair.beta_star
    clearance, hub = parameter * force * pair.beta_star, None if hub is None else hub * radius
    return Problem(pair, radius, clearance, friction, pin_load, rotation, hub), force


def random_draw(rng: Generator, problem: Problem, force: float) -> Callable[[], dict[str, float]]:
    """A function that draws a random corner; some moments are more than friction can carry."""
    mu, radius, free = problem.friction, problem.hole_radius, problem.rotation == "free"
    with_moment = free and problem.pin_load == "centre" and rng.random() < 0.5
    with_turn, with_stress, upwards = not free and rng.random() < 0.5, rng.random() < 0.25, rng.random() < 0.15
    stress = 0.3 * max(abs(problem.load_parameter(force)), 0.1) * force / radius

    def draw() -> dict[str, float]:
        pull = force * rng.uniform(0.2, 1.0) * (rng.choice([-1.0, 1.0]) if upwards else 1.0)
        side, turn, *remote = rng.uniform(-1.0, 1.0, 4).tolist()
        corner = {"P": pull, "Q": 1.1 * pull * (mu or 0.5) * side}
        if with_moment:
            corner["M"] = 1.3 * pull * radius * (mu or 1e-3) / math.hypot(1.0, mu) * turn
        if with_turn:
            corner["rotation"] = 0.5 * turn * force * problem.pair.beta_star / radius
        if with_stress:
            corner |= {"sxx": stress * remote[0], "syy": stress * remote[1]}
        return corner

    return draw


def random_history(rng: Generator, draw: Callable[[], dict[str, float]]) -> LoadHistory:
    """Plain corners, an unloading, or cycles: repeated, nested, about a mean, harmonic; now and then cut."""

    def corners(count: int) -> LoadHistory:
        drawn = [{name: value for name, value in draw().items() if rng.random() < 0.9} for _ in range(count)]
        return LoadHistory([draw(), *drawn][:count])

    few, times, mean, second = int(rng.integers(2, 4)), int(rng.integers(2, 10)), draw(), draw()
    swing = {name: 0.4 * value for name, value in second.items() if name != "P"}
    plain, cycles = [(0.25, "corners"), (0.15, "unloaded"), (0.1, "array")], ["nested", "mean", "harmonic"]
    whole = corners(few)
    match one_of(rng, *plain, (0.2, "repeated"), *((0.1, kind) for kind in cycles)):
        case "unloaded":
            whole += LoadHistory([dict.fromkeys(mean, 0.0), mean]) + corners(few)
        case "array":
            whole += LoadHistory.from_array(np.array([list(each.values()) for each in (mean, second)]), list(mean))
        case "repeated":
            whole += corners(few).repeated(times)
        case "nested":
            whole += (corners(2).repeated(few) + corners(1)).repeated(few) + corners(1)
        case "mean":
            whole = LoadHistory.cycles(mean, swing, times, return_to_mean=few == 2)
        case "harmonic":
            phase = {name: float(rng.uniform(-180.0, 180.0)) for name in swing}
            whole = LoadHistory.harmonic(mean, swing, phase, few, int(rng.integers(4, 9)))
    return whole[: len(whole) - 1] if rng.random() < 0.1 else whole


def random_options(rng: Generator, problem: Problem, cyclic: bool) -> dict[str, Any]:
    """Keywords of ``fastpin.solve``; an interference needs nodes on the whole circle."""
    round_it, bars = problem.clearance < 0.0, rng.random() < 0.15
    nodes = one_of(rng, (0.92, int(rng.integers(101 if bars else 41, 162))), (0.07, 301), (0.01, 601))
    middle, half = -0.5 * math.pi, math.pi if round_it else rng.uniform(0.8, 3.1)
    along, inside = half * np.linspace(-1.0, 1.0, nodes), np.sort(rng.uniform(0.05, 0.95, 3)).tolist()
    arc, circle = {"arc": (middle - half, middle + half)}, {"grid": Grid.circle(nodes, middle + half)}
    graded = circle if round_it else {"grid": Grid(middle + along * (0.7 + 0.03 * along**2))}
    options = {"nodes": nodes, **one_of(rng, (0.8, {}), (0.1, arc), (0.05, circle), (0.05, graded))}
    options["between"] = one_of(rng, (0.4, 0), (0.2, 1), (0.2, 3), (0.2, inside))
    options["keep"] = one_of(rng, (0.6, "all"), (0.2, "every 2"), (0.2, "cycles" if cyclic else "corners"))
    options |= {"shortcut": one_of(rng, (0.8, True), (0.2, False)), "error_bars": bars}
    if rng.random() < 0.12:
        options |= {"method": "increment", "increments": int(rng.integers(8, 25))}
    return options


def value_of(owner: Any, name: str) -> Any:
    """An attribute; of a load only what acts, so that versions with other loads can be compared."""
    value = getattr(owner, name, None)
    return {load: force for load, force in value.items() if force != 0.0} if name == "load" and value else value


def history_item(seed: int) -> Item:
    """Digests of a random history: of its states, of what is read, of its cycles and of how it ends."""
    rng = np.random.default_rng(seed)
    problem, force = random_problem(rng)
    history = random_history(rng, random_draw(rng, problem, force))
    result: Any
    try:
        result = fastpin.solve(problem, history, **random_options(rng, problem, history.longest_cycle > 0))
        ending: list[Any] = ["solved"]
    except fastpin.FastpinError as error:
        result, lost = getattr(error, "result", None), ("step", "fraction", "load")
        ending = [f"{type(error).__name__}: {error}", *(value_of(error, name) for name in lost)]
    results = [part for part in (result, getattr(result, "coarse", None)) if part is not None]
    states = [state for part in results for state in part]
    cycles = [[part.complete, part.method, *(cycle._asdict() for cycle in part.cycles)] for part in results]
    counts = [
        {name: count for name, count in part.statistics.items() if count and name != "seconds"} for part in results
    ]
    return {
        "states": digest([value_of(state, name) for name in SOLVED] for state in states),
        "readings": digest([getattr(state, name) for name in READ] for state in states),
        "cycles": digest([cycles, counts, ending]),
        "number of states": len(states),
        "ending": ending[0],
    }


def table_items(*arguments: str) -> dict[str, Item]:
    """Digests of the CSV files that a command of fastpin writes, without remarks and what is never the same."""
    items: dict[str, Item] = {}
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, "plan.toml").write_text(PLAN, encoding="utf-8")
        package = Path(fastpin.__file__).resolve().parents[1]  # the command is to run what is imported here
        command, paths = [sys.executable, "-m", "fastpin", *arguments], {**os.environ, "PYTHONPATH": str(package)}
        subprocess.run(command, cwd=folder, env=paths, check=True, stdout=subprocess.DEVNULL)
        for path in sorted(Path(folder).glob("*.csv")):
            lines = [line for line in path.read_text(encoding="utf-8").splitlines() if not line.startswith("#")]
            rows = [{name: row[name] for name in row if name not in CHANGING} for row in csv.DictReader(lines)]
            items[f"{arguments[0]} {path.name}"] = {"rows": digest(rows), "number of rows": len(rows)}
    return items


def compare(old: Path, new: Path) -> int:
    """Print what differs between two files; the exit code."""
    before, after = (json.loads(path.read_text(encoding="utf-8")) for path in (old, new))
    names = list(dict.fromkeys([*before, *after]))
    different = [name for name in names if before.get(name) != after.get(name)]
    for name in different:
        first, second = before.get(name, {}), after.get(name, {})
        pairs = {part: (first.get(part), second.get(part)) for part in {**first, **second}}
        print(f"{name}:", "; ".join(f"{part}: {a} -> {b}" for part, (a, b) in pairs.items() if a != b))
    histories = sum(name.startswith("history") for name in names)
    print(f"{histories} histories, {len(names) - histories - 1} tables and the versions: {len(different)} differ")
    return int(bool(different))


def main() -> int:
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("file", metavar="OUT.json", type=Path, nargs="?")
    parser.add_argument("--histories", type=int, default=300)
    parser.add_argument("--first", metavar="SEED", type=int, default=0)
    parser.add_argument("--no-paper", dest="paper", action="store_false")
    parser.add_argument("--no-sweep", dest="sweep", action="store_false")
    parser.add_argument("--compare", metavar=("OLD.json", "NEW.json"), type=Path, nargs=2)
    options = parser.parse_args()
    if options.compare is not None:
        return compare(*options.compare)
    if options.file is None:
        parser.error("OUT.json or --compare OLD.json NEW.json is needed")
    print(f"package: {Path(fastpin.__file__).resolve().parent}", file=sys.stderr)
    versions: Item = {name: version(name) for name in ("numpy", "scipy", "numba")}
    found = {"versions": {"python": sys.version.split()[0], "fastpin": fastpin.__version__, **versions}}
    for seed in range(options.first, options.first + options.histories):
        found[f"history {seed}"] = history_item(seed)
        if len(found) % 25 == 1:
            print(f"{len(found) - 1} of {options.histories} histories", file=sys.stderr)
    if options.paper:
        found |= table_items("paper", "-o", ".")
    if options.sweep:
        found |= table_items("sweep", "plan.toml", "--workers", "2", "--table", "table.csv")
    options.file.write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
