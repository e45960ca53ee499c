"""Some changed input files end in a result or in one sentence; tests/survey/test_mutations.py changes a thousand."""

from pathlib import Path

import pytest

from tests.support.tiers import seeds
from tests.survey import mutations


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("files")
    mutations.prepare(folder)
    return folder


@pytest.mark.gate
@pytest.mark.parametrize("kind", ["case", "csv", "index", "lug", "plan"])
def test_some_changed_files_give_one_sentence(files: Path, kind: str) -> None:
    found = [finding for seed in seeds(3) for finding in mutations.examine(kind, seed, files)]
    assert [finding for finding in found if not finding.endswith(mutations.IN_LIBRARY)] == []
