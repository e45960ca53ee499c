"""The pages on policies and reproducibility say what the code has: versions of formats, exit codes, attributes."""

import re
from pathlib import Path

import h5py
import numpy as np

from bench import accuracy
from fastpin import Problem, save, solve
from fastpin.bodies import compliance
from fastpin.cli import terminal
from fastpin.storage import layout
from fastpin.studies import index
from tests.support.documents import page_text

POLICIES, REPRODUCIBILITY = map(page_text, ("policies.md", "reproducibility.md"))


def test_the_versions_of_formats_are_those_of_the_code() -> None:
    rows = re.findall(r"^\| ([^|]*) \| `(\w+)` \| (\d+) \| `([^`]*)` \|$", POLICIES, re.MULTILINE)
    listed = [(int(version), name, file) for _, name, version, file in rows]
    assert listed == [
        (layout.FORMAT_VERSION, "format_version", "fastpin/storage/layout.py"),
        (layout.WITH_BODIES, "format_version", "fastpin/storage/layout.py"),
        (layout.WITH_PROFILES, "format_version", "fastpin/storage/layout.py"),
        (layout.WITH_SEAT, "format_version", "fastpin/storage/layout.py"),
        (layout.WITH_LAMINATE, "format_version", "fastpin/storage/layout.py"),
        (index.FORMAT_VERSION, "user_version", "fastpin/studies/index.py"),
        (compliance.VERSION, "version", "fastpin/bodies/compliance.py"),
    ]


def test_the_exit_codes_are_those_of_the_command_line() -> None:
    failed, refused, unread = terminal.EXIT_FAILED, terminal.EXIT_INPUT, terminal.EXIT_READING
    words = f"{failed} is a run or a check that failed. {refused} is input that can't be used. {unread} is a quantity"
    assert f" {terminal.EXIT_INTERRUPTED} follows Ctrl-C" in " ".join(POLICIES.split())
    assert words in " ".join(POLICIES.split())


def test_the_attributes_of_a_result_are_listed(titanium_in_aluminium, tmp_path: Path) -> None:
    problem = Problem.from_load_parameter(titanium_in_aluminium, 0.1, friction=0.4)
    save(solve(problem, [{"P": 1.0}], nodes=41), tmp_path / "result.h5", error="ended early")
    table = REPRODUCIBILITY[REPRODUCIBILITY.index("## What a file tells") : REPRODUCIBILITY.index("## Seeds")]
    cells = re.findall(r"^\| (`[^|]*) \|", table, re.MULTILINE)
    listed = set(re.findall(r"`(\w+)`", " ".join(cells)))
    with h5py.File(tmp_path / "result.h5") as file:
        assert set(file.attrs) == listed


def test_named_tables_exist() -> None:
    tables = re.findall(r"python -m bench\.accuracy ([a-z_ ]+)", REPRODUCIBILITY)
    assert {name for names in tables for name in names.split()} <= accuracy.TABLES.keys()


def figures_of(values: dict[str, float], bar: float, size: float) -> list[tuple[float, float, float]]:
    return [(values[name], bar, size) if name in values else (np.nan, np.nan, size) for name in accuracy.NAMES]


def test_differences_by_rounding_are_in_parts_of_peaks_and_beside_their_bars(tmp_path: Path, capsys) -> None:
    tractions = np.array(
        [[[2.0, 4.0], [1.0, -1.0]], [[0.0, 0.0], [0.0, 0.0]]]
    )  # two states; the second one without contact
    moved = tractions.copy()
    moved[0, 1, 0] += 4e-9
    names = ("peak_pressure", "peak_shear", "dx", "dy", "rotation", "dissipation")
    values = dict(zip(names, (4.0, -1.0, 5.0, 0.0, 0.5, 3.0), strict=True))
    ends = {"contact_1_start": -2.0, "contact_1_stop": -1.0}
    first = np.array([figures_of(values | ends, 0.01, 1.0), figures_of(dict.fromkeys(names, 0.0), np.inf, 1.0)])
    # the peak moves within its bar, the motion beyond it; the contact is lost; the bar of the dissipation is halved
    second = np.array([figures_of(values | {"peak_pressure": 4.004, "dy": 0.05}, 0.01, 1.0), first[1]])
    second[0, accuracy.NAMES.index("dissipation"), 1] = 0.005
    figures = accuracy.FIGURES
    before = {"same": tractions, "moved": tractions, "lost": tractions}
    np.savez(tmp_path / "a.npz", **before, **{figures + name: first for name in before})
    after = {"same": tractions, "moved": moved}
    np.savez(tmp_path / "b.npz", **after, **{figures + "same": first, figures + "moved": second})
    accuracy.compare_rounding(tmp_path / "a.npz", tmp_path / "b.npz")
    lines = capsys.readouterr().out.splitlines()
    rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in lines[5:]]
    assert rows == [
        ["tractions", "3", "1", "1e-09", "inf", "", "", ""],
        ["peaks", "8", "7", "0e+00", "1e-03", "0e+00", "0e+00", "0"],
        ["edges", "4", "2", "inf", "inf", "inf", "inf", "2"],
        ["motion", "12", "11", "0e+00", "1e-02", "0e+00", "0e+00", "1"],
        ["dissipation", "4", "4", "0e+00", "0e+00", "8e-04", "2e-03", "0"],
    ]
