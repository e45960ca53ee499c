"""Killed, stopped and starved commands lose nothing; scripts/outages.py disturbs each of them many times."""

from __future__ import annotations

from pathlib import Path

import pytest

from scripts import outages


@pytest.fixture(scope="module")
def before(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("outages")
    outages.prepare(folder)
    return folder


@pytest.mark.parametrize(
    ("command", "ways"),
    [
        ("record", ["kill", "fill", "share"]),
        ("json", ["fill"]),
        ("sweep", ["kill", "stop"]),
        ("dask", ["kill"]),
        ("compliance", ["fill"]),
        ("report", ["fill"]),
    ],
)
def test_a_disturbed_command_loses_nothing(before: Path, tmp_path: Path, command: str, ways: list[str]) -> None:
    trial = outages.Trial(command, before, tmp_path, seed=1)
    for way in ways:
        getattr(trial, way)()
    assert trial.findings == []
