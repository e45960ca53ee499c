"""Tables and figure of a stored run of the benchmarks.

    pytest bench --benchmark-json=bench/results/NAME.json
    python bench/report.py                       tables of the newest file in bench/results
    python bench/report.py FILE.json --figure docs/figures/performance.png
    python bench/report.py --write               tables into both pages docs/performance*.md, and the figure

``--write`` replaces the text between ``<!-- benchmark: NAME -->`` and ``<!-- /benchmark -->``. NAME is machine, times,
ratios, limits, others, start-up or slopes. All ratios are of times from one file. Times are of the fastest round.
"""

from __future__ import annotations

import argparse
import itertools
import json
import math
import re
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from fastpin.figures import style
from fastpin.published import records as drawing

ROOT = Path(__file__).resolve().parents[1]
RESULTS = Path(__file__).resolve().parent / "results"
DOCUMENTS = (ROOT / "docs" / "performance.md", ROOT / "docs" / "performance-history.md")
FIGURE = ROOT / "docs" / "figures" / "performance.png"

FIT_FROM = 401
"""Smallest size for the fit of slopes. At smaller sizes a call costs more than its arithmetic."""

LEAST_SHARE = 0.85
"""Fewest processors for each thread during a reference. With fewer, its time does not count."""

Stored = dict[str, Any]
"""A file of pytest-benchmark."""

Series = dict[int, float]
"""A value for each number of nodes."""


def select(stored: Stored, group: str, **parameters: Any) -> dict[int, dict[str, Any]]:
    """Return the benchmarks of a group with these parameters, by the number of nodes (0 if they have none)."""
    chosen = {}
    for entry in stored["benchmarks"]:
        given = entry["params"] or {}
        if entry["group"] == group and all(given.get(name) == value for name, value in parameters.items()):
            chosen[int(given.get("nodes", 0))] = entry
    return dict(sorted(chosen.items()))


def seconds(stored: Stored, group: str, **parameters: Any) -> Series:
    """Return the seconds of the fastest round of each size."""
    return {nodes: entry["stats"]["min"] for nodes, entry in select(stored, group, **parameters).items()}


def recorded(stored: Stored, group: str, name: str, **parameters: Any) -> Series:
    """Return a number that was stored with the times, by size."""
    entries = select(stored, group, **parameters).items()
    return {nodes: entry["extra_info"][name] for nodes, entry in entries if name in entry["extra_info"]}


def disturbed(stored: Stored, group: str, threads: int) -> list[int]:
    """Return the sizes from FIT_FROM on at which other processes took processors from the threads."""
    used = recorded(stored, group, "processors", threads=threads)
    return [nodes for nodes, value in used.items() if nodes >= FIT_FROM and value < LEAST_SHARE * threads]


def reference(stored: Stored, threads: int, group: str = "LAPACK solve") -> Series:
    """Return the times of a reference, without the disturbed sizes: a slow reference would flatter the solver."""
    times = seconds(stored, group, threads=threads)
    return {nodes: times[nodes] for nodes in times if nodes not in disturbed(stored, group, threads)}


def ratio(above: Series, below: Series) -> Series:
    """Return above / below for the sizes of both."""
    return {nodes: above[nodes] / below[nodes] for nodes in above if nodes in below}


def scaled(series: Series, factor: float) -> Series:
    """Return factor * series."""
    return {nodes: factor * value for nodes, value in series.items()}


def bandwidth(stored: Stored, group: str, memory: str) -> Series:
    """Return the rate of writing or copying, GB/s."""
    times = seconds(stored, group, memory=memory)
    return scaled(ratio(recorded(stored, group, "bytes", memory=memory), times), 1e-9)


def flop_rate(stored: Stored, group: str, threads: int) -> Series:
    """Return the rate of a reference, GFlop/s."""
    flops = recorded(stored, group, "flops", threads=threads)
    return scaled(ratio(flops, reference(stored, threads, group)), 1e-9)


def update_rate(stored: Stored, group: str = "cycle") -> Series:
    """Return the rate of the solver's exchanges, GFlop/s, at their least cost: each exchange updates one column once.

    In a step with k exchanges column i takes i updates of 2n entries. These are 2n k^2 flops. A cycle has two steps.
    """
    flops = {nodes: nodes * count**2 for nodes, count in recorded(stored, group, "exchanges").items()}
    return scaled(ratio(flops, seconds(stored, group)), 1e-9)


def number(value: float | None) -> str:
    """Return a number with three significant digits, or with all digits before the point; "" for None."""
    if value is None:
        return ""
    digits = 0 if value == 0.0 else max(0, 2 - math.floor(math.log10(abs(value))))
    return f"{value:.{digits}f}"


def table(columns: dict[str, Series]) -> str:
    """Return a Markdown table with one row for each size."""
    sizes = sorted({nodes for series in columns.values() for nodes in series})
    rows = [[f"{nodes:,}", *(number(series.get(nodes)) for series in columns.values())] for nodes in sizes]
    return markdown(["nodes", *columns], rows)


def markdown(header: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Return a Markdown table. All columns but the first are aligned to the right."""
    lines = [header, ["---"] + ["--:"] * (len(header) - 1), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def times_table(stored: Stored) -> str:
    """Return the table of the times that a user waits, and of the memory."""
    return table(
        {
            "first load, s": seconds(stored, "first load"),
            "cycle, s": seconds(stored, "cycle"),
            "memory, MB": recorded(stored, "memory", "peak_mb"),
            "above the libraries, MB": recorded(stored, "memory", "above_mb"),
        }
    )


def ratios_table(stored: Stored) -> str:
    """Return the table of times in parts of one dense solve, of its rate, and of the time to write the matrices."""
    cycle = seconds(stored, "cycle")
    fill, write = seconds(stored, "fill", grid="uniform"), seconds(stored, "write", memory="fresh")
    return table(
        {
            "cycle / solve, 1 thread": ratio(cycle, reference(stored, 1)),
            "2 threads": ratio(cycle, reference(stored, 2)),
            "share of LU rate, %": scaled(ratio(update_rate(stored), flop_rate(stored, "LAPACK solve", 1)), 100.0),
            "fill, ms": scaled(fill, 1e3),
            "fill / write": ratio(fill, write),
        }
    )


def limits_table(stored: Stored) -> str:
    """Return the table of the machine's limits: dense solves, matrix products, writing and copying."""
    columns = {}
    for threads in (1, 2):
        columns[f"solve, {threads} thread{'s' * (threads > 1)}, s"] = reference(stored, threads)
    for threads in (1, 2):
        columns[f"LU, {threads}, GFlop/s"] = flop_rate(stored, "LAPACK solve", threads)
        columns[f"product, {threads}, GFlop/s"] = flop_rate(stored, "matrix product", threads)
    columns["processors in solve, 2 threads"] = recorded(stored, "LAPACK solve", "processors", threads=2)
    for group in ("write", "copy"):
        for memory in ("fresh", "touched"):
            columns[f"{group}, {memory}, GB/s"] = bandwidth(stored, group, memory)
    return table(columns)


def others_table(stored: Stored) -> str:
    """Return the table of all other times and counts."""
    history = seconds(stored, "history")
    return table(
        {
            "variable cycle, s": ratio(history, recorded(stored, "history", "cycles")),
            "cycle in increments, s": seconds(stored, "increment cycle"),
            "fill, graded, ms": scaled(seconds(stored, "fill", grid="graded"), 1e3),
            "fill, uniform, ms": scaled(seconds(stored, "fill", grid="uniform"), 1e3),
            "residuals of (46), (47), ms": scaled(seconds(stored, "residuals"), 1e3),
            "edges and peaks, ms": scaled(seconds(stored, "readings"), 1e3),
            "events of a cycle": recorded(stored, "cycle", "events"),
            "exchanges": recorded(stored, "cycle", "exchanges"),
            "rebuilds": recorded(stored, "cycle", "rebuilds"),
        }
    )


def start_up_table(stored: Stored) -> str:
    """Return the table of the seconds of whole processes."""
    rows = [
        [entry["params"]["command"], number(entry["stats"]["min"])]
        for entry in stored["benchmarks"]
        if entry["group"] == "start-up"
    ]
    cold = seconds(stored, "start-up, nothing compiled")
    rows += [["fastpin run, nothing compiled", number(value)] for value in cold.values()]
    return markdown(["process", "seconds"], rows)


def machine_text(stored: Stored) -> str:
    """Return a paragraph about the measurement: processor, system, versions and date."""
    machine = stored["machine_info"]
    versions = ", ".join(f"{name} {version}" for name, version in machine["versions"].items())
    python = f"{machine['python_implementation']} {machine['python_version']}"
    return (
        f"{machine['cpu']}, {machine['cores']} cores; the solver leaves one thread to BLAS and makes its large "
        f"products in two. {machine['system']}, {python}, {versions}, {'; '.join(machine['blas'])}. "
        f"Measured on {stored['datetime'][:10]}."
    )


def curves(stored: Stored) -> list[tuple[str, Series]]:
    """Return the lines of the left panel of the figure, seconds."""
    return [
        ("cycle", seconds(stored, "cycle")),
        ("first load", seconds(stored, "first load")),
        ("fill", seconds(stored, "fill", grid="uniform")),
        ("LAPACK solve, 1 thread", reference(stored, 1)),
        ("LAPACK solve, 2 threads", reference(stored, 2)),
    ]


def counts(stored: Stored) -> list[tuple[str, Series]]:
    """Return the lines of the right panel of the figure, numbers of events and exchanges."""
    return [(f"{name} of a cycle", recorded(stored, "cycle", name)) for name in ("events", "exchanges")]


def slope(series: Series) -> float:
    """Return the exponent of a power of n, fitted to sizes from FIT_FROM on, or to all if there are fewer than two."""
    large = {nodes: value for nodes, value in series.items() if nodes >= FIT_FROM}
    chosen = large if len(large) > 1 else series
    if len(chosen) < 2:
        return math.nan
    return float(np.polyfit(np.log(list(chosen)), np.log(list(chosen.values())), 1)[0])


def slopes_table(stored: Stored) -> str:
    """Return the table of the exponents of n."""
    rows = [[name, f"{slope(series):.2f}"] for name, series in [*curves(stored), *counts(stored)] if series]
    return markdown(["", f"exponent of n, from {FIT_FROM} nodes"], rows)


def draw(stored: Stored) -> Any:
    """Draw times and numbers of events against the number of nodes, on logarithmic scales."""
    figure, axes = drawing.panels(1, 2, height=3.4)
    rows = []
    for panel, lines, label, styles in (
        (axes[0, 0], curves(stored), "seconds", [style.line(index, index) for index in range(5)]),
        (axes[0, 1], counts(stored), "number", [style.line(5, 0), style.line(5, 1)]),
    ):
        entries = []
        for (name, series), drawn in zip(lines, styles, strict=True):
            if series:
                panel.loglog(list(series), list(series.values()), marker="o", markersize=3.0, **drawn)
                entries.append((f"{name}: $n^{{{slope(series):.2f}}}$", drawn))
        panel.set_xlabel("nodes n")
        panel.set_ylabel(label)
        rows.append(entries)
    drawing.add_legend(figure, *rows)
    return figure


BLOCKS: dict[str, Callable[[Stored], str]] = {
    "machine": machine_text,
    "times": times_table,
    "ratios": ratios_table,
    "limits": limits_table,
    "others": others_table,
    "start-up": start_up_table,
    "slopes": slopes_table,
}
"""The marked blocks of the documents, and their contents."""


def filled(text: str, stored: Stored) -> str:
    """Return a document with new contents in its marked blocks."""

    def block(found: re.Match[str]) -> str:
        return f"{found[1]}\n{BLOCKS[found[2]](stored)}\n{found[3]}"

    return re.sub(r"(<!-- benchmark: ([\w-]+) -->)\n.*?(<!-- /benchmark -->)", block, text, flags=re.DOTALL)


def newest() -> Path:
    """Return the file of bench/results with the latest measurement."""
    files = list(RESULTS.glob("*.json"))
    if not files:
        raise SystemExit(f"no results in {RESULTS.name}; run pytest bench --benchmark-json=bench/results/NAME.json")
    return max(files, key=lambda path: str(json.loads(path.read_text(encoding="utf-8"))["datetime"]))


def save_figure(stored: Stored, path: Path) -> None:
    """Draw and save the figure."""
    drawing.save_drawing(draw, stored, path)


def main() -> None:
    """Run the command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("file", type=Path, nargs="?", help="JSON file of pytest-benchmark")
    parser.add_argument("--figure", type=Path, help="also draw the figure")
    parser.add_argument("--write", action="store_true", help="write the tables into the documents, and the figure")
    options = parser.parse_args()
    stored = json.loads((options.file or newest()).read_text(encoding="utf-8"))
    for name, text in BLOCKS.items():
        print(f"\n{name}\n\n{text(stored)}")
    for group, threads in itertools.product(("LAPACK solve", "matrix product"), (1, 2)):
        busy = ", ".join(map(str, disturbed(stored, group, threads)))
        if busy:
            print(f"\nLeft out, as the machine was busy: {group}, {threads} threads, with {busy} nodes. Measure again.")
    if options.write:
        for document in filter(Path.exists, DOCUMENTS):
            document.write_text(filled(document.read_text(encoding="utf-8"), stored), encoding="utf-8")
    picture = options.figure or (FIGURE if options.write else None)
    if picture is not None:
        save_figure(stored, picture)


if __name__ == "__main__":
    main()
