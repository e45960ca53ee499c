"""The pages on policies and reproducibility say what the code has: versions of formats, exit codes, attributes."""

from __future__ import annotations

import re
from pathlib import Path

import h5py
import numpy as np
import pytest

from fastpin import Problem, save, solve
from fastpin.cli import terminal
from fastpin.model import compliance
from fastpin.storage import layout
from fastpin.studies import index
from scripts import rounding

ROOT = Path(__file__).resolve().parents[2]
POLICIES, REPRODUCIBILITY = (
    (ROOT / "docs" / f"{name}.md").read_text(encoding="utf-8") for name in ("policies", "reproducibility")
)


def test_the_versions_of_formats_are_those_of_the_code() -> None:
    rows = re.findall(r"^\| ([^|]*) \| `(\w+)` \| (\d+) \| `([^`]*)` \|$", POLICIES, re.MULTILINE)
    listed = [(int(version), name, file) for _, name, version, file in rows]
    assert listed == [
        (layout.FORMAT_VERSION, "format_version", "fastpin/storage/layout.py"),
        (layout.WITH_BODIES, "format_version", "fastpin/storage/layout.py"),
        (index.FORMAT_VERSION, "user_version", "fastpin/studies/index.py"),
        (compliance.VERSION, "version", "fastpin/model/compliance.py"),
    ]


def test_the_exit_codes_are_those_of_the_command_line() -> None:
    codes = (terminal.EXIT_FAILED, terminal.EXIT_INPUT, terminal.EXIT_INTERRUPTED)
    failed, refused, interrupted = codes
    text = " ".join(POLICIES.split())
    assert (
        f"{failed} is a run or a check that failed. {refused} is input that can't be used. {interrupted} follows"
        in text
    )


def test_the_attributes_of_a_result_are_listed(titanium_in_aluminium, tmp_path: Path) -> None:
    problem = Problem.from_load_parameter(titanium_in_aluminium, 0.1, friction=0.4)
    save(solve(problem, [{"P": 1.0}], nodes=41), tmp_path / "result.h5", error="ended early")
    table = REPRODUCIBILITY[REPRODUCIBILITY.index("## What a file tells") : REPRODUCIBILITY.index("## Seeds")]
    listed = {
        name for row in re.findall(r"^\| (`[^|]*) \|", table, re.MULTILINE) for name in re.findall(r"`(\w+)`", row)
    }
    with h5py.File(tmp_path / "result.h5") as file:
        assert set(file.attrs) == listed


@pytest.mark.parametrize("script", sorted(set(re.findall(r"(?:python )((?:scripts|bench)/\w+\.py)", REPRODUCIBILITY))))
def test_named_scripts_exist(script: str) -> None:
    assert (ROOT / script).exists()


@pytest.mark.parametrize("module", sorted(set(re.findall(r"python -m (scripts\.\w+)", REPRODUCIBILITY))))
def test_named_modules_exist(module: str) -> None:
    assert (ROOT / f"{module.replace('.', '/')}.py").exists()


def test_differences_by_rounding_are_in_parts_of_the_peak_pressure(tmp_path: Path) -> None:
    first = np.array(
        [[[2.0, 4.0], [1.0, -1.0]], [[0.0, 0.0], [0.0, 0.0]]]
    )  # two states; the second one without contact
    second = first.copy()
    second[0, 1, 0] += 4e-9
    np.savez(tmp_path / "a.npz", same=first, moved=first, lost=first)
    np.savez(tmp_path / "b.npz", same=first, moved=second)
    found = rounding.differences(tmp_path / "a.npz", tmp_path / "b.npz")
    assert found == pytest.approx([0.0, 1e-9, np.inf], rel=1e-6)
