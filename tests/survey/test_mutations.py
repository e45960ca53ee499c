"""Changed input files end in a result or in one sentence: a thousand files of each kind."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.support.tiers import seeds
from tests.survey import mutations

pytestmark = pytest.mark.survey


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Unchanged files. What reads them is in memory: this takes as long as some twenty files without it."""
    folder = tmp_path_factory.mktemp("files")
    mutations.prepare(folder)
    mutations.warm(folder)
    return folder


@pytest.mark.parametrize("kind", mutations.KINDS)
def test_changed_files_give_one_sentence(files: Path, kind: str) -> None:
    """Bytes that crash the HDF5 library, or catch it in a loop, are printed: no code of Python can prevent that."""
    found = [finding for seed in seeds(10) for finding in mutations.examine(kind, seed, files)]
    print(*found, sep="\n")
    assert [finding for finding in found if not finding.endswith(mutations.IN_LIBRARY)] == []
