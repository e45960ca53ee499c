"""Compare fastpin with Tamaas in the contact of Cattaneo and Mindlin: ``python bench/tamaas_compare.py``.

A cylinder is pressed on a half-plane by P, then loaded tangentially by Q = mu P / 2. The closed form has the pressure
of Hertz, and the shear is mu times this pressure less the pressure of a narrower contact.

* fastpin solves a pin with a contact of 3e-4 of the hole's radius: a large load parameter. There the hole is a
  half-plane but for some 4e-4. It follows both loads, with no assumption about the tractions.
* Tamaas solves a periodic half-plane with the period 32 half-widths. Its solvers with friction (``Condat`` and others)
  have an associated law: slip opens the contact. So they do not have this closed form as their limit, and their row
  shows it. The row ``superposed`` are two contacts without friction, whose difference is the shear. This needs the
  theorem of Ciavarella and Jaeger, which holds for like bodies and one monotonic tangential load.

The error is the integral of the difference over the integral of the closed form. Times are of the processor, without
imports, the median of interleaved rounds. The last lines compare times, also at an equal error of the shear. Tamaas
may be installed elsewhere: ``--python PATH`` names the interpreter that imports it. Without Tamaas one line says so.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import statistics
import subprocess
import sys
import time
import warnings
from collections.abc import Callable
from typing import Any

os.environ.setdefault("OMP_NUM_THREADS", "1")  # both run on one thread

import numpy as np

FRICTION, SHARE = 0.4, 0.5  # coefficient of friction; Q over mu P
POINTS, PERIOD = 4096, 32.0  # of Tamaas; the period is in half-widths of the contact
FRICTION_POINTS, FRICTION_PERIOD, MOST_ITERATIONS = 2048, 16.0, 20_000  # 4,096 unknowns; most iterations
TOLERANCE = 1e-6  # of Tamaas; 1e-12 changes its errors by less than a fifth
SIZES = (61, 101, 121, 141, 161, 201, 401, 801, 2048)  # nodes of fastpin; 2,048 nodes have 4,096 unknowns
NARROWNESS = 3e-4  # half-width of the contact over the radius of the hole
ARC = 1.5  # half of fastpin's arc over the half-width of the contact

Row = dict[str, Any]


def closed_form(x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Pressure and shear over the largest pressure, at x in half-widths of the contact."""
    stick = math.sqrt(1.0 - SHARE)
    pressure = np.sqrt(np.maximum(1.0 - x**2, 0.0))
    return pressure, FRICTION * (pressure - np.sqrt(np.maximum(stick**2 - x**2, 0.0)))


def errors(x: np.ndarray, pressure: np.ndarray, shear: np.ndarray) -> dict[str, float]:
    """Errors of pressure and shear, which are over the largest pressure. Their sign may be any."""
    true_pressure, true_shear = closed_form(x)
    found = np.sign(shear.sum()) * shear
    return {
        "pressure": float(np.abs(pressure - true_pressure).sum() / true_pressure.sum()),
        "shear": float(np.abs(found - true_shear).sum() / true_shear.sum()),
    }


def timed(solve: Callable[[], Any]) -> tuple[Any, float]:
    """The value of a call, and its processor time, s."""
    began = time.process_time()
    value = solve()
    return value, time.process_time() - began


def solve_pin(nodes: int) -> Row:
    """The row of fastpin."""
    import fastpin

    modulus, poisson, radius, clearance = 70e9, 0.3, 10e-3, 1e-4
    steel = fastpin.Material(modulus, poisson)
    problem = fastpin.Problem(
        fastpin.MaterialPair(steel, steel), hole_radius=radius, clearance=clearance, friction=FRICTION,
        pin_load="centre", rotation="fixed",
    )  # fmt: skip
    half, curvature = NARROWNESS * radius, clearance / radius**2
    stiffness = modulus / (2.0 * (1.0 - poisson**2))
    force = 0.25 * math.pi * stiffness * curvature * half**2
    bottom, wide = -0.5 * math.pi, ARC * NARROWNESS
    history = [{"P": force}, {"Q": SHARE * FRICTION * force}]
    with warnings.catch_warnings():  # the force is small on purpose: fastpin takes it for newtons
        warnings.simplefilter("ignore", fastpin.errors.InputWarning)
        result, seconds = timed(
            lambda: fastpin.solve(problem, history, nodes=nodes, arc=(bottom - wide, bottom + wide))
        )
    state, largest = result[-1], 0.5 * stiffness * curvature * half
    x = (state.theta - bottom) / NARROWNESS
    return {
        "method": "fastpin", "unknowns": 2 * nodes, "seconds": seconds,
        **errors(x, state.pressure / largest, state.shear / largest),
    }  # fmt: skip


def solve_half_plane(method: str) -> Row:
    """A row of Tamaas. Lengths are in half-widths of the contact, the modulus and the curvature are 1 and 0.01."""
    import tamaas as tm

    tm.set_log_level(tm.LogLevel.error)
    count, period = (POINTS, PERIOD) if method == "superposed" else (FRICTION_POINTS, FRICTION_PERIOD)
    x = (np.arange(count) - count // 2) * period / count
    kind = tm.model_type.basic_1d if method == "superposed" else tm.model_type.surface_1d
    model = tm.Model(kind, [period], [count])
    model.E, model.nu = 1.0, 0.0
    surface = -0.005 * x**2
    mean = 0.0025 * math.pi * model.E_star / period
    largest = 0.005 * model.E_star
    if method == "superposed":

        def press(part: float) -> np.ndarray:
            solver = tm.PolonskyKeerRey(model, surface, TOLERANCE)
            solver.max_iter = MOST_ITERATIONS
            solver.solve(part * mean)
            return np.ravel(model.traction).copy()

        (whole, narrow), seconds = timed(lambda: (press(1.0), press(1.0 - SHARE)))
        found = whole, FRICTION * (whole - narrow)
    else:
        solver = getattr(tm, method)(model, surface, TOLERANCE * 1e-3, FRICTION)
        solver.max_iter = MOST_ITERATIONS
        _, seconds = timed(lambda: solver.solve([SHARE * FRICTION * mean, mean]))
        found = model.traction[..., 1], model.traction[..., 0]
    unknowns = count if method == "superposed" else 2 * count
    return {
        "method": f"Tamaas {method}", "unknowns": unknowns, "seconds": seconds,
        **errors(x, found[0] / largest, found[1] / largest),
    }  # fmt: skip


def run_tamaas(python: str) -> list[Row]:
    """Both rows of Tamaas, from its own interpreter; none if it is not installed there."""
    found = subprocess.run([python, "-c", "import tamaas"], capture_output=True, check=False)
    if found.returncode != 0:
        return []
    done = subprocess.run([python, __file__, "--tamaas-rows"], capture_output=True, text=True, check=True)
    rows: list[Row] = json.loads(done.stdout.splitlines()[-1])
    return rows


def median_rows(rounds: list[list[Row]]) -> list[Row]:
    """The rows with the medians of their times."""
    return [
        {**rows[0], "seconds": statistics.median(row["seconds"] for row in rows)} for rows in zip(*rounds, strict=True)
    ]


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--python", default=sys.executable, help="interpreter that can import tamaas")
    parser.add_argument("--rounds", type=int, default=3, help="rounds of all solvers (default 3)")
    parser.add_argument("--tamaas-rows", action="store_true", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.tamaas_rows:
        solve_half_plane("superposed")  # loads the libraries
        print(json.dumps([solve_half_plane(method) for method in ("superposed", "Condat")]))
        return
    solve_pin(SIZES[0])  # compiles
    rounds: list[list[Row]] = []
    for _ in range(options.rounds):
        rounds.append([*(solve_pin(nodes) for nodes in SIZES), *run_tamaas(options.python)])
    rows = median_rows(rounds)
    print(f"{'method':20s} {'unknowns':>9s} {'seconds':>9s} {'pressure':>10s} {'shear':>10s}")
    for row in rows:
        print("{method:20s} {unknowns:9d} {seconds:9.4f} {pressure:10.1e} {shear:10.1e}".format(**row))
    if len(rows) == len(SIZES):
        print("Tamaas is not installed in this interpreter: its rows are left out")
        return
    superposed, direct = rows[len(SIZES) :]
    equal = [row for row in rows[: len(SIZES)] if row["shear"] <= superposed["shear"]]
    if equal:
        ratio, unknowns = superposed["seconds"] / equal[0]["seconds"], equal[0]["unknowns"]
        print(f"equal error of the shear, {unknowns} unknowns of fastpin: Tamaas superposed / fastpin = {ratio:.2g}")
    largest = rows[len(SIZES) - 1]
    print(f"4,096 unknowns: Tamaas superposed / fastpin = {superposed['seconds'] / largest['seconds']:.2g}")
    print(f"4,096 unknowns: Tamaas Condat / fastpin = {direct['seconds'] / largest['seconds']:.2g}")


if __name__ == "__main__":
    main()
