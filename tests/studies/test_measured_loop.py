"""Measured loops: noise, branches and their ends, distances from curves, columns of files, and wrong input."""

from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fastpin.errors import InputError
from fastpin.studies import read_loop
from fastpin.studies.measured_loop import measured_loop
from tests.support.loops import THICKNESS, joint
from tests.support.refusals import refused

NAMES = ("ux", "Q")


def sine(samples: int = 100, cycles: float = 2.25) -> np.ndarray:
    return np.sin(2.0 * np.pi * np.arange(round(cycles * samples) + 1) / samples)


def test_the_ends_of_the_branches_are_exact_without_noise() -> None:
    loop = measured_loop(NAMES, 1e-5 * sine(97) + 3e-6, 1e3 * sine(97))
    assert len(loop.ends) == 6
    assert loop.ends[1:5, 1] == pytest.approx([1.3e-5, -7e-6, 1.3e-5, -7e-6], abs=1e-4 * 2e-5)
    assert loop.ends[[0, 5], 1] == pytest.approx([3e-6, 1.3e-5], abs=2e-7)
    assert np.bincount(loop.branch) == pytest.approx([25, 48, 49, 48, 49], abs=1)
    assert loop.ends[1:5, 0] * 218 == pytest.approx(97 * np.array([0.25, 0.75, 1.25, 1.75]), abs=0.02)


@pytest.mark.parametrize(("deviation", "samples"), [(0.01, 80), (0.03, 100), (0.03, 500)])
def test_the_ends_of_the_branches_have_no_bias(deviation: float, samples: int) -> None:
    """They err as the shares of the samples in them say."""
    errors, expected = [], []
    for seed in range(60):
        rng = np.random.default_rng(seed)
        clean = sine(samples)
        loop = measured_loop(NAMES, clean + deviation * rng.normal(size=clean.size), clean)
        errors.append(loop.ends[1:-1, 1] - np.array([1.0, -1.0, 1.0, -1.0]))
        expected.append(deviation * np.linalg.norm(loop.shares, axis=1))
    outwards = np.array(errors) * [1.0, -1.0, 1.0, -1.0]
    assert abs(outwards.mean()) < 0.12 * deviation  # the largest sample lies 1.3 deviations too far out
    assert outwards.std() == pytest.approx(np.mean(expected), rel=0.15)


def test_distances_are_along_the_normal() -> None:
    """From straight branches: |a x + b y| / |(a sx, b sy)|."""
    loop = measured_loop(NAMES, 1e-5 * sine(), 1e3 * sine())
    ends = [0.0, 1e-5, -1e-5, 1e-5, -1e-5, 1e-5]
    curves = [(x := np.linspace(a, b, 9), 2e8 * x) for a, b in pairwise(ends)]
    away, feet, forces = loop.distances(curves, loop.displacement + 1e-7, loop.force)
    size = np.hypot(loop.noise[1], 2e8 * loop.noise[0])
    assert away == pytest.approx((loop.force - 2e8 * (loop.displacement + 1e-7)) / size, rel=1e-9)
    assert forces == pytest.approx(2e8 * feet, rel=1e-9)


def test_whole_cycles_lie_between_turning_points() -> None:
    assert measured_loop(NAMES, sine(), sine()).cycles == [slice(25, 126)]
    assert measured_loop(NAMES, sine(100, 1.0), sine(100, 1.0)).cycles == [slice(0, 101)]
    assert measured_loop(NAMES, sine(100, 0.6), sine(100, 0.6)).cycles == []


@pytest.mark.parametrize(
    ("displacement", "force", "words"),
    [
        (np.arange(30.0), np.arange(30.0), "ux: runs in one direction only: a loop turns back by more than its noise"),
        (sine(8, 2.0), sine(8, 2.0), "ux: must be a list of at least 20 samples, not of the shape (17,)"),
        (sine(8, 4.0), sine(8, 4.0), "ux: has 4 samples between two turning points; 5 are the fewest"),
        (np.r_[sine(), np.nan], sine(), "ux: sample 227 is missing or no finite number"),
        (sine(), np.full(226, 3.0), "Q: is constant, 3 in all samples: a loop needs a channel that moves"),
        (np.zeros(226), sine(), "ux: is constant, 0 in all samples: a loop needs a channel that moves"),
        (sine(), sine()[:-1], "Q: has 225 samples, and ux has 226"),
        ("loop", sine(), 'ux: must be a number, not "loop"'),
        (sine().reshape(2, -1), sine(), "ux: must be a list of at least 20 samples, not of the shape (2, 113)"),
    ],
)
def test_bad_samples_are_refused_in_a_sentence(displacement: Any, force: Any, words: str) -> None:
    assert str(refused(measured_loop, NAMES, displacement, force)).startswith(words)


def test_columns_are_found_by_name_or_unit(tmp_path: Path) -> None:
    """The force has the name of its load, and one column has a unit of length."""
    path = tmp_path / "rig.csv"
    path.write_text("Time [s];Way [um];Q [kN];P [N]\n0;1;2;6000\n1;2;3;6000\n")
    found = read_loop(path, joint())
    assert found["ux"].tolist() == [1e-6, 2e-6]
    assert found["Q"].tolist() == [2000.0 / THICKNESS, 3000.0 / THICKNESS]
    turned = read_loop(path, joint(), displacement="Way", force="P [N]", force_factor=-2.0)
    assert turned["Q"].tolist() == [-12000.0 / THICKNESS] * 2
    path.write_text("angle [mrad],torque [N m],friction [N m]\n1,2,3\n")
    held = joint(drive="force", gauge_radius=None)
    assert read_loop(path, held, force="torque")["M"].tolist() == [2.0 / THICKNESS]
    assert read_loop(path, held, "rotation", force="torque")["rotation"].tolist() == [1e-3]


@pytest.mark.parametrize(
    ("head", "options", "words"),
    [
        ("a [um],b [mm],Q [N]", {}, 'ux: 2 columns of the file may hold it: "a [um]", "b [mm]"; name one of them'),
        ("a [um],b [N],c [kN]", {}, 'Q: 2 columns of the file may hold it: "b [N]", "c [kN]"; name one of them'),
        ("a,b,c", {}, 'ux: no column of the file has its name or a unit of it; name one of "a", "b", "c"'),
        ("ux,Q,c", {"force": "q"}, 'Q: the file has no column "q"; its columns are "ux", "Q", "c"'),
        ("ux [N],Q,c", {}, "ux: a length must be in m, mm, um, nm, in or mil"),
    ],
)
def test_unclear_columns_are_refused(tmp_path: Path, head: str, options: Any, words: str) -> None:
    path = tmp_path / "rig.csv"
    path.write_text(f"{head}\n1,2,3\n")
    assert words in str(refused(read_loop, path, joint(), **options))


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"over": "uz"}, 'over: must be "ux", "uy" or "rotation", not "uz"'),
        ({"force_factor": 0}, "force_factor: must not be 0"),
        ({"force_factor": "turned"}, "force_factor: must be a number"),
    ],
)
def test_wrong_options_of_a_file_are_refused(tmp_path: Path, options: Any, words: str) -> None:
    with pytest.raises(InputError, match=words):
        read_loop(tmp_path / "rig.csv", joint(), **options)
