"""``fastpin crack``: a crack that grows under the last cycle of a stored result."""

from __future__ import annotations

import csv
import math
from pathlib import Path

import pytest

import fastpin
from fastpin import cracks, damage
from fastpin.cli.main import main

LAW = ["--first", "1e-4", "--last", "3e-3", "--C", "1e-10", "--m", "3"]


@pytest.fixture(scope="module")
def stored(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A result with two cycles of P and three states in each step."""
    path = tmp_path_factory.mktemp("crack") / "joint.h5"
    pair = fastpin.MaterialPair(fastpin.MATERIALS["steel"], fastpin.Material(70e9, 0.33))
    problem = fastpin.Problem(pair, 10e-3, 20e-6, 0.3)
    history = fastpin.LoadHistory([{"P": 3e6}, {"P": 3e5}]).repeated(2)
    fastpin.save(fastpin.solve(problem, history, nodes=101, between=2), path)
    return path


def test_a_crack_at_a_place(stored, tmp_path, capsys):
    numbers, figure = tmp_path / "a.csv", tmp_path / "a.svg"
    outputs = ["-o", str(figure), "--csv", str(numbers)]
    assert main(["crack", str(stored), *LAW, "--at", "66", "--angle", "5", "--exponent", "0.5", *outputs]) == 0
    result = fastpin.load(stored)
    states = damage.cycle_states(result, result.cycles[-1])
    crack = cracks.Crack(math.radians(-24.0), math.radians(5.0))
    found = cracks.growth(states, crack, cracks.Walker(1e-10, 3.0, 0.5), 1e-4, 3e-3)
    lines = capsys.readouterr().out.splitlines()
    assert lines[0] == f"crack at 66.00 deg from the bottom: {found.words}"
    assert " ".join(lines[2].split()) == "length K_I largest smallest K_II range threshold growth cycles"
    assert lines[3].split() == ["mm", *["MPa", "sqrt(m)"] * 5, "nm/cycle"]
    assert lines[4].split()[:2] == ["0.1", f"{found.K_max[0] / 1e6:.4g}"]
    assert lines[-1].split()[-1] == f"{found.life:.4g}"
    assert len(lines) == 4 + 13
    rows = list(csv.DictReader(numbers.read_text().splitlines()))
    assert len(rows) == found.length.size
    assert float(rows[-1]["cycles"]) == pytest.approx(found.life)
    assert "<svg" in figure.read_text()


def test_the_fastest_crack(stored, capsys):
    assert main(["crack", str(stored), *LAW, "--threshold-range", "1e6", "--intrinsic-length", "5e-5"]) == 0
    place = float(capsys.readouterr().out.split()[2])
    assert 30.0 < abs(place) < 100.0


def test_a_crack_that_never_grows(stored, capsys):
    assert main(["crack", str(stored), *LAW, "--at", "66", "--threshold-range", "1e9"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].endswith("no growth at 100 um")
    assert lines[-1].split()[-1] == "never"


def test_a_cycle_of_corners_alone_is_noted(tmp_path, capsys):
    path = tmp_path / "joint.h5"
    pair = fastpin.MaterialPair(fastpin.MATERIALS["steel"], fastpin.Material(70e9, 0.33))
    history = fastpin.LoadHistory([{"P": 3e6}, {"P": 3e5}]).repeated(2)
    fastpin.save(fastpin.solve(fastpin.Problem(pair, 10e-3, 20e-6, 0.3), history, nodes=61), path)
    assert main(["crack", str(path), *LAW, "--at", "66"]) == 0
    assert "note: the cycle has only its 3 corners; K between the corners is unknown" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--at", "north"], '--at: must be a number, not "north"'),
        (["--at", "0", "--angle", "90"], "--angle: must lie between"),
        (["--at", "0", "--m", "0"], "--m: must be positive, not 0"),
        (["--at", "0", "--last", "1e-5"], "--last: must be longer than the first length"),
        (["--at", "0", "--threshold-range", "-1"], "--threshold-range: must not be negative"),
        (["--at", "0", "--body", "seat"], '--body: "seat" is the edge of the plate round a bush'),
        (["--at", "0", "-o", "a.txt"], "--output: must"),
    ],
)
def test_refusals(stored, capsys, arguments, words):
    assert main(["crack", str(stored), *LAW, *arguments]) == 2
    assert words in capsys.readouterr().err


def test_a_result_without_a_cycle(tmp_path, capsys):
    path = tmp_path / "joint.h5"
    pair = fastpin.MaterialPair(fastpin.MATERIALS["steel"], fastpin.MATERIALS["steel"])
    fastpin.save(fastpin.solve(fastpin.Problem(pair, 10e-3, 20e-6, 0.3), [{"P": 3e6}], nodes=61), path)
    assert main(["crack", str(path), *LAW]) == 2
    assert "no cycle of the history has ended" in capsys.readouterr().err
