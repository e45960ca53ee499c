"""Changed input files end in a result or in one sentence; scripts/mutations.py changes a thousand of each kind."""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path
from types import ModuleType

import pytest

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="module")
def mutations() -> ModuleType:
    spec = importlib.util.spec_from_file_location("mutations", ROOT / "scripts" / "mutations.py")
    module = importlib.util.module_from_spec(spec)
    sys.modules["mutations"] = module  # dataclasses and pickle look there
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def files(mutations: ModuleType, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("files")
    mutations.prepare(folder)
    return folder


@pytest.fixture(scope="module")
def warm_files(mutations: ModuleType, files: Path) -> Path:
    """The same files. What reads them is in memory: this takes as long as some twenty files without it."""
    mutations.warm(files)
    return files


def findings(mutations: ModuleType, files: Path, kind: str, seeds: range) -> list[str]:
    found = [finding for seed in seeds for finding in mutations.examine(kind, seed, files)]
    return [finding for finding in found if not finding.endswith(mutations.IN_LIBRARY)]


@pytest.mark.parametrize("kind", ["case", "csv", "index", "lug", "plan"])
def test_some_changed_files_give_one_sentence(mutations, files, kind):
    assert findings(mutations, files, kind, range(3)) == []


@pytest.mark.parametrize("kind", ["case", "csv", "result", "unfinished", "index", "lug", "plan"])
def test_changed_files_give_one_sentence(mutations, warm_files, kind):
    assert findings(mutations, warm_files, kind, range(1_000, 1_015)) == []
