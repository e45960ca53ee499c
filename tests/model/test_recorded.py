"""Recorded loops in a history: their cycles, the cycle that wear repeats, and their turning points alone."""

from pathlib import Path

import numpy as np
import pytest

from fastpin import CaseFileError, InputError, LoadHistory, solve
from fastpin.casefile import parse_case
from fastpin.model.recorded import turning_corners, with_last_cycle
from tests.support.case_texts import IN_A_RIG
from tests.support.loops import joint

CASE = IN_A_RIG.replace("6000", "6e5") + '[[load]]\ncsv = "rig.csv"\nux = "way [um]"\n'


def write_loop(folder: Path, samples: int = 12, cycles: float = 3.0, noise: float = 0.0) -> Path:
    turns = np.arange(round(samples * cycles) + 1) / samples
    values = 8.0 * np.sin(2.0 * np.pi * turns) + noise * np.random.default_rng(0).normal(size=turns.size)
    path = folder / "rig.csv"
    path.write_text("way [um]\n" + "".join(f"{value:.6f}\n" for value in values))
    return path


def test_a_recorded_loop_has_cycles(tmp_path: Path) -> None:
    write_loop(tmp_path)
    history = parse_case(CASE, folder=tmp_path).history
    assert history.blocks[1].lengths == (12,)
    result = solve(joint(thickness=None), history, nodes=21)
    assert [(cycle.corner, cycle.length, cycle.number) for cycle in result.cycles] == [
        (13, 12, 1),
        (25, 12, 2),
        (37, 12, 3),
    ]
    cycle = result.cycle()
    assert (cycle.first, cycle.last, cycle.is_closed) == (26, 38, True)
    assert sum(loop.work for loop in cycle.loops.values()) == pytest.approx(result.cycles[-1].dissipation, rel=0.2)


def test_a_noisy_loop_is_closed_within_its_noise(tmp_path: Path) -> None:
    history = LoadHistory([{"P": 6e5}]) + LoadHistory.from_csv(
        write_loop(tmp_path, 24, 2.5, 0.1), {"ux": {"column": "way [um]"}}
    )
    result = solve(joint(thickness=None), history, nodes=21)
    cycle = result.cycle()
    assert cycle.is_closed
    assert cycle.states[0].load["ux"] != cycle.states[-1].load["ux"]


def test_wear_repeats_the_last_recorded_cycle(tmp_path: Path) -> None:
    history = LoadHistory([{"P": 6e5}]) + LoadHistory.from_csv(write_loop(tmp_path), {"ux": "way [um]"})
    split = with_last_cycle(history)
    assert split.blocks[-1].cycle
    assert len(split.blocks[-1].given) == 12
    assert np.array_equal(split.values(), history.values())
    assert with_last_cycle(split) is split
    listed = LoadHistory([{"P": 6e5}, {"ux": 1e-6}])
    assert with_last_cycle(listed) is listed


def test_turning_points_alone(tmp_path: Path) -> None:
    write_loop(tmp_path, 50, 3.3, 0.1)
    text = CASE + "turning_points = true\n"
    values = parse_case(text, folder=tmp_path).history.values()[:, 7]
    assert np.abs(values[2:-1]) == pytest.approx(8e-6, rel=0.05)
    assert len(values) == 2 + 6 + 1  # the last turning point lies too near to the end
    assert parse_case(text.replace("true", "false"), folder=tmp_path).history.blocks[1].lengths == (50,)
    with pytest.raises(CaseFileError, match="turning_points: must be true or false"):
        parse_case(text.replace("= true", "= 3"), folder=tmp_path)
    with pytest.raises(InputError, match="history: must be one record of samples, without repeated blocks"):
        turning_corners(LoadHistory([{"P": 1.0}, {"P": 2.0}]).repeated(2))
