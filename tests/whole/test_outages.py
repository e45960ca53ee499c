"""Disturbed commands lose nothing; tests/survey/test_outages.py disturbs each of them a hundred times."""

from pathlib import Path

import pytest

from tests.support.tiers import some_survey
from tests.survey import outages

pytestmark = pytest.mark.gate


@pytest.fixture(scope="module")
def before(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("outages")
    outages.prepare(folder)
    return folder


@pytest.mark.parametrize(
    ("command", "way"), some_survey([("record", "share"), ("sweep", "kill"), ("report", "fill")], ("record", "share"))
)
def test_a_disturbed_command_loses_nothing(before: Path, tmp_path: Path, command: str, way: str) -> None:
    trial = outages.Trial(command, before, tmp_path)
    trial.disturb(way, 1)
    assert trial.findings == []


def test_a_killed_run_has_lost_nothing(tmp_path: Path) -> None:
    """SIGKILL, at random moments."""
    found = outages.kill_run(tmp_path, most=2, rounds=8, longest=0.3)
    assert found.findings == []
    assert found.hits > 0
