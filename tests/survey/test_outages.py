"""Killed, stopped and starved commands lose nothing."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.support.tiers import seeds
from tests.survey import outages

pytestmark = pytest.mark.survey


@pytest.fixture(scope="module")
def before(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("outages")
    outages.prepare(folder)
    return folder


@pytest.mark.parametrize(
    ("command", "way"), [(command, way) for way, commands in outages.WAYS.items() for command in commands]
)
def test_a_disturbed_command_loses_nothing(before: Path, tmp_path: Path, command: str, way: str) -> None:
    trial = outages.Trial(command, before, tmp_path)
    for seed in seeds(1):
        trial.disturb(way, seed)
    print(trial.counts)
    assert trial.findings == []


def test_a_run_that_is_killed_again_and_again_loses_nothing(tmp_path: Path) -> None:
    found = outages.kill_run(tmp_path, most=100, rounds=400)
    assert found.findings == []
    assert found.hits > 20


def test_a_sweep_that_is_killed_again_and_again_loses_nothing(tmp_path: Path) -> None:
    found = outages.kill_sweep(tmp_path, most=100, runs=400)
    assert found.findings == []
    assert found.hits > 20
