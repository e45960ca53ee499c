"""Memory and time of a long history that is stored as it goes: ``python bench/long.py [--corners 100000]``.

The loads are different at every corner. A thread notes the resident memory and the number of corners twice a second.
``--write`` writes them to bench/results/long.csv and draws a figure. The numbers of docs/histories.md come from
``--nodes 201 --corners 100000``, which takes a quarter of an hour. ``--keep`` and ``--output`` are as in
``fastpin run``.
"""

from __future__ import annotations

import argparse
import csv
import json
import os
import tempfile
import threading
import time
from pathlib import Path

import cases
import numpy as np
from matplotlib.figure import Figure
from tqdm import tqdm

import fastpin
from fastpin.figures import style
from fastpin.published import records as drawing
from fastpin.storage import store, stored
from fastpin.storage.recording import record

RESULTS = Path(__file__).with_name("results")
FIGURE = Path(__file__).resolve().parents[1] / "docs" / "figures" / "long.png"
NAMES = ("seconds", "corners", "memory_mb", "file_mb")


def history(corners: int) -> fastpin.LoadHistory:
    """Return the history: P, then a random Q at every corner."""
    force = np.random.default_rng(0).uniform(-0.275, 0.275, (corners - 1, 1))
    return fastpin.LoadHistory([{"P": 1.0}]) + fastpin.LoadHistory.from_array(force, ["Q"])


class Watch(threading.Thread):
    """A thread that notes seconds, corners, resident memory and size of the file, MB, twice a second."""

    def __init__(self, path: Path) -> None:
        super().__init__(daemon=True)
        self.rows: list[tuple[float, float, float, float]] = []
        self.corners = 0.0
        self._path = path
        self._ended = threading.Event()
        self._began = time.perf_counter()

    def run(self) -> None:
        """Add a row twice a second until the end."""
        while not self._ended.wait(0.5):
            self.note()

    def note(self) -> None:
        """Add a row."""
        pages = int(Path("/proc/self/statm").read_text().split()[1])
        memory = pages * os.sysconf("SC_PAGE_SIZE") / 2.0**20
        size = self._path.stat().st_size / 2.0**20 if self._path.exists() else 0.0
        self.rows.append((time.perf_counter() - self._began, self.corners, memory, size))

    def end(self) -> None:
        """Add the last row and stop."""
        self.note()
        self._ended.set()
        self.join()


def follow(corners: int, nodes: int, keep: str, path: Path) -> list[tuple[float, float, float, float]]:
    """Run the history. Return rows of seconds, corners, memory and size of the file, MB."""
    watch = Watch(path)
    watch.start()
    with tqdm(total=corners, unit="corner", smoothing=0.0, disable=None) as bar:

        def show(done: float, steps: int) -> None:
            watch.corners = done if steps == corners else 0.0
            bar.update(int(watch.corners) - bar.n)

        record(cases.PROBLEM, history(corners), path, nodes=nodes, keep=keep, progress=show)
    watch.end()
    return watch.rows


def draw(columns: dict[str, np.ndarray]) -> Figure:
    """Draw memory, corners and size of the file against time."""
    figure, axes = drawing.panels(1, 2, height=2.6)
    minutes = columns["seconds"] / 60.0
    axes[0, 0].plot(minutes, columns["memory_mb"], **style.line(0))
    axes[0, 0].set_ylabel("resident memory  [MB]")
    axes[0, 0].set_ylim(0.0, 1.2 * columns["memory_mb"].max())
    axes[0, 1].plot(minutes, columns["corners"] / 1e3, **style.line(0))
    axes[0, 1].plot(minutes, columns["file_mb"], **style.line(1, 1))
    axes[0, 1].set_ylabel("thousand corners, MB")
    for panel in axes[0]:
        panel.set_xlabel("time  [min]")
    drawing.add_legend(figure, [("thousand corners", style.line(0)), ("size of the file, MB", style.line(1, 1))])
    return figure


def main() -> None:
    """Run the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--corners", type=int, default=100_000)
    parser.add_argument("--nodes", type=int, default=201)
    parser.add_argument("--keep", default="corners")
    parser.add_argument("--output", type=Path, help="keep the result here")
    parser.add_argument("--write", action="store_true", help="write bench/results/long.csv and the figure")
    parser.add_argument("--draw", action="store_true", help="only draw the figure of bench/results/long.csv")
    options = parser.parse_args()
    if options.draw:
        table = np.loadtxt(RESULTS / "long.csv", delimiter=",", skiprows=1)
        drawing.save_drawing(draw, dict(zip(NAMES, table.T, strict=True)), FIGURE)
        return
    cases.steady_state(61)  # compiles
    with tempfile.TemporaryDirectory() as folder:
        path = options.output or Path(folder) / "long.h5"
        began = time.process_time()
        rows = follow(options.corners, options.nodes, options.keep, path)
        processor = time.process_time() - began
        states = stored.StoredResult(path).points.size
        last = store.load(path, states=[states - 1])[0]
    columns = dict(zip(NAMES, np.array(rows).T, strict=True))
    begun = columns["corners"] > 0.01 * options.corners
    numbers = {
        "nodes": options.nodes,
        "corners": options.corners,
        "states": states,
        "seconds": rows[-1][0],
        "processor_seconds": processor,
        "milliseconds_per_corner": 1e3 * rows[-1][0] / options.corners,
        "file_mb": rows[-1][3],
        "memory_mb_after_one_percent": float(columns["memory_mb"][begun][0]),
        "memory_mb_at_the_end": rows[-1][2],
        "largest_memory_mb": float(columns["memory_mb"].max()),
        "residual_of_the_last_state": max(last.residuals.values()),
    }
    print(json.dumps(numbers, indent=2))
    if options.write:
        with (RESULTS / "long.csv").open("w", newline="") as file:
            writer = csv.writer(file)
            writer.writerow(NAMES)
            writer.writerows([f"{value:.5g}" for value in row] for row in rows)
        drawing.save_drawing(draw, columns, FIGURE)


if __name__ == "__main__":
    main()
