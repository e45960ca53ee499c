"""The report of the benchmarks, on made-up times."""

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from bench import compare, report

BENCH = Path(__file__).resolve().parents[2] / "bench"
SIZES = (101, 401, 801, 1601)


def entry(group: str, seconds: float, extra: dict[str, Any] | None = None, **parameters: Any) -> dict[str, Any]:
    return {"group": group, "params": parameters, "extra_info": extra or {}, "stats": {"min": seconds}}


@pytest.fixture
def stored() -> dict[str, Any]:
    """Times that are powers of n: cycle n^2.5, solve n^3 with two threads twice as fast, fill n^2, events n."""
    entries = []
    for n in SIZES:
        counts = {"events": 2 * n, "exchanges": 4 * n, "rebuilds": 0, "threads": 1}
        entries += [
            entry("cycle", 1e-6 * n**2.5, counts, nodes=n),
            entry("first load", 5e-7 * n**2.5, nodes=n),
            entry("history", 4e-6 * n**2.5, {"cycles": 4}, nodes=n),
            entry("fill", 6e-9 * n**2, nodes=n, grid="uniform"),
            entry("fill", 1e-6 * n**2, nodes=n, grid="graded"),
            entry("memory", 1.0, {"peak_mb": 200.0, "above_mb": 50.0}, nodes=n),
        ]
        for threads in (1, 2):
            extra = {"flops": 2.0 / 3.0 * (2 * n) ** 3, "processors": 0.98 * threads}
            entries.append(entry("LAPACK solve", 1e-9 * n**3 / threads, extra, nodes=n, threads=threads))
        for group in ("write", "copy"):
            extra = {"bytes": 32 * n**2}
            entries.append(entry(group, 2e-9 * n**2, extra, nodes=n, memory="fresh"))
            entries.append(entry(group, 1e-9 * n**2, extra, nodes=n, memory="touched"))
    entries.append(entry("start-up", 0.125, command="import fastpin"))
    entries.append(entry("start-up, nothing compiled", 9.0))
    machine = {
        "cpu": "A processor", "cores": 2, "system": "Linux", "python_implementation": "CPython",
        "python_version": "3.11", "versions": {"numpy": "2"}, "blas": ["openblas 0.3"],
    }  # fmt: skip
    return {"benchmarks": entries, "machine_info": machine, "datetime": "2030-01-02T03:04:05"}


def cells(table: str, nodes: int) -> dict[str, str]:
    lines = [[cell.strip() for cell in line.strip("|").split("|")] for line in table.splitlines()]
    row = next(line for line in lines if line[0] == f"{nodes:,}")
    return dict(zip(lines[0], row, strict=True))


def test_ratios_are_of_times_of_the_same_size(stored: dict[str, Any]) -> None:
    row = cells(report.ratios_table(stored), 401)
    assert float(row["cycle / solve, 1 thread"]) == pytest.approx(1e3 * 401**-0.5, rel=5e-3)
    assert float(row["2 threads"]) == pytest.approx(2e3 * 401**-0.5, rel=5e-3)
    assert float(row["fill / write"]) == pytest.approx(3.0)
    assert cells(report.times_table(stored), 401)["memory, MB"] == "200"


def test_share_of_the_rate_counts_every_exchanged_column_once(stored: dict[str, Any]) -> None:
    achieved = 401 * (4 * 401) ** 2 / (1e-6 * 401**2.5)
    possible = 2.0 / 3.0 * 8.0 / 1e-9
    row = cells(report.ratios_table(stored), 401)
    assert float(row["share of LU rate, %"]) == pytest.approx(100.0 * achieved / possible, rel=5e-3)


def test_limits(stored: dict[str, Any]) -> None:
    row = cells(report.limits_table(stored), 1601)
    assert float(row["LU, 1, GFlop/s"]) == pytest.approx(16.0 / 3.0, rel=5e-3)
    assert float(row["LU, 2, GFlop/s"]) == pytest.approx(32.0 / 3.0, rel=5e-3)
    assert float(row["write, fresh, GB/s"]) == pytest.approx(16.0)
    assert float(row["copy, touched, GB/s"]) == pytest.approx(32.0)


def test_a_cycle_of_the_history_is_a_part_of_it(stored: dict[str, Any]) -> None:
    row = cells(report.others_table(stored), 801)
    assert float(row["variable cycle, s"]) == pytest.approx(1e-6 * 801**2.5, rel=5e-3)


def test_slopes(stored: dict[str, Any]) -> None:
    table = report.slopes_table(stored)
    assert "| cycle | 2.50 |" in table
    assert "| fill | 2.00 |" in table
    assert "| LAPACK solve, 2 threads | 3.00 |" in table
    assert "| events of a cycle | 1.00 |" in table


def test_slope_of_large_sizes_only() -> None:
    assert report.slope({10: 5.0, 401: 1.0, 802: 8.0}) == pytest.approx(3.0)
    assert report.slope({10: 1.0, 20: 4.0, 401: 1604.01}) == pytest.approx(2.0, abs=1e-2)
    assert math.isnan(report.slope({401: 1.0}))


def test_two_threads_without_two_processors_are_left_out(stored: dict[str, Any]) -> None:
    assert report.disturbed(stored, "LAPACK solve", 2) == []
    for one in stored["benchmarks"]:
        if one["group"] == "LAPACK solve" and one["params"]["nodes"] in (101, 801):
            one["extra_info"]["processors"] = 1.0
    assert report.disturbed(stored, "LAPACK solve", 1) == []
    assert report.disturbed(stored, "LAPACK solve", 2) == [801]
    assert cells(report.ratios_table(stored), 801)["2 threads"] == ""
    assert cells(report.ratios_table(stored), 801)["cycle / solve, 1 thread"] != ""


def test_missing_benchmarks_leave_cells_empty(stored: dict[str, Any]) -> None:
    stored["benchmarks"] = [one for one in stored["benchmarks"] if one["group"] == "cycle"]
    row = cells(report.times_table(stored), 101)
    assert float(row["cycle, s"]) > 0.0
    assert row["first load, s"] == row["memory, MB"] == ""


def test_marked_blocks_are_replaced_and_nothing_else(stored: dict[str, Any]) -> None:
    text = (
        "a\n<!-- benchmark: machine -->\nold\n<!-- /benchmark -->\nb\n<!-- benchmark: slopes -->\n<!-- /benchmark -->\n"
    )
    once = report.filled(text, stored)
    assert once.startswith(
        "a\n<!-- benchmark: machine -->\nA processor, 2 cores; the solver leaves one thread to BLAS "
    )
    assert "old" not in once
    assert "\nb\n<!-- benchmark: slopes -->\n| " in once
    assert report.filled(once, stored) == once


@pytest.mark.parametrize("value", [None, 0.0, 0.00123456, 12.3456, 98765.4])
def test_numbers(value: float | None) -> None:
    expected = {None: "", 0.0: "0", 0.00123456: "0.00123", 12.3456: "12.3", 98765.4: "98765"}
    assert report.number(value) == expected[value]


def test_newest_result(tmp_path, monkeypatch, stored):
    monkeypatch.setattr(report, "RESULTS", tmp_path)
    with pytest.raises(SystemExit, match="no results"):
        report.newest()
    for name, year in (("a", 2031), ("b", 2030)):
        (tmp_path / f"{name}.json").write_text(json.dumps({**stored, "datetime": f"{year}-01-02"}))
    assert report.newest().name == "a.json"


@pytest.mark.gate
def test_figure(tmp_path: Path, stored: dict[str, Any]) -> None:
    report.save_figure(stored, tmp_path / "performance.png")
    assert (tmp_path / "performance.png").read_bytes().startswith(b"\x89PNG")


def test_stored_results_name_no_machine() -> None:
    for path in (BENCH / "results").glob("*.json"):
        stored = json.loads(path.read_text(encoding="utf-8"))
        assert "node" not in stored["machine_info"]
        assert all("data" not in one["stats"] for one in stored["benchmarks"])
        assert path.stat().st_size < 500_000


def test_variable_cycles_are_fixed_and_all_different() -> None:
    cases = compare.cases
    corners = cases.variable_cycles(1000).values()[:, 1]
    assert corners.size == 2000
    amplitudes = corners[::2]
    assert np.array_equal(corners[1::2], -amplitudes)
    assert np.unique(amplitudes).size == 1000
    assert 0.1 * cases.AMPLITUDE <= amplitudes.min() < amplitudes.max() <= cases.AMPLITUDE
    assert np.array_equal(cases.variable_cycles(4).values()[:, 1], corners[:8])


def test_sufficient_number_holds_from_there_on() -> None:
    assert compare.sufficient((1, 2, 3, 4), (0.1, 9.0, 0.2, 0.1), 0.5) == 3
    assert compare.sufficient((1, 2), (0.1, 0.9), 0.5) is None


def test_errors_are_relative_to_the_pressure() -> None:
    exact = np.array([[0.5, 0.2, 0.0, 0.3], [0.4, 0.2, 0.0, 0.3]])
    found = exact + np.array([[0.0, 0.04, 0.0, 0.0], [-0.004, 0.0, 0.0, 0.2]])
    assert compare.errors(found, exact, 2.0) == pytest.approx([0.01, 0.1, 0.0, 0.1])


def test_what_the_reference_may_be_off_by() -> None:
    mesh = np.array([[0.1, 0.4], [0.1, 0.1]])
    assert compare.reference_errors((100, 200), mesh, 400) == pytest.approx([0.05, 0.1])
