"""A full disk: one sentence, and the old file. A limit of the size of files stands in for the disk."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from fastpin.model.problem import Problem
from fastpin.solver.solving import solve
from fastpin.storage import store

SAVE = """
import resource, signal, sys
from fastpin.errors import OutputError
from fastpin.storage import store

result = store.load(sys.argv[1])
store.MOST_IN_MEMORY = int(sys.argv[3])
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
for limit in map(int, sys.argv[4:]):
    resource.setrlimit(resource.RLIMIT_FSIZE, (limit, resource.RLIM_INFINITY))
    try:
        store.save(result, sys.argv[2])
    except OutputError as error:
        print(error)
"""

RECORD = """
import resource, signal, sys
from fastpin.errors import OutputError
from fastpin.storage import recording, store, writer

result = store.load(sys.argv[1])
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, (int(sys.argv[3]), resource.RLIM_INFINITY))
writer.MOST_PENDING = 4
try:
    recording.record(result.problem, result.history, sys.argv[2], nodes=31, arc=(-3.1, 0.0))
except OutputError as error:
    print(error)
"""


@pytest.fixture(scope="module")
def source(similar, tmp_path_factory) -> Path:
    problem, path = Problem.from_load_parameter(similar, 0.4, 0.5), tmp_path_factory.mktemp("source") / "source.h5"
    store.save(solve(problem, [{"P": 1.0}, *[{"Q": 0.2}, {"Q": -0.2}] * 20], nodes=31), path)
    return path


@pytest.fixture(scope="module")
def recorded_size(source, tmp_path_factory) -> int:
    """Bytes of the whole file that RECORD writes."""
    path = tmp_path_factory.mktemp("whole") / "whole.h5"
    assert output_of(RECORD, source, path, 1 << 30) == ""
    return path.stat().st_size


def output_of(program: str, *words: object) -> str:
    """What a program prints. It may print nothing on standard error."""
    command = [sys.executable, "-c", program, *map(str, words)]
    ended = subprocess.run(command, capture_output=True, text=True, timeout=60, check=True)
    assert ended.stderr == ""
    return ended.stdout


@pytest.mark.parametrize("most_in_memory", [store.MOST_IN_MEMORY, 0])
def test_a_result_that_finds_no_room_is_one_sentence(source, tmp_path, most_in_memory):
    size = source.stat().st_size
    path = tmp_path / "out.h5"
    path.write_bytes(source.read_bytes())
    limits = [0, 100, 3000, size // 3, size // 2, size - 1000]
    said = output_of(SAVE, source, path, most_in_memory, *limits).splitlines()
    assert said == [f"{path}: can't be written: File too large"] * len(limits)
    assert path.read_bytes() == source.read_bytes()
    assert [found.name for found in tmp_path.iterdir()] == ["out.h5"]


@pytest.mark.parametrize("share", [0.3, 0.5, 0.7, 0.9])
def test_a_run_that_finds_no_room_keeps_its_last_transaction(source, recorded_size, tmp_path, share):
    path = tmp_path / "out.h5"
    said = output_of(RECORD, source, path, int(share * recorded_size))
    assert said == f"{path}: can't be written: File too large\n"
    assert not path.with_name("out.h5.journal").exists()
    assert store.is_unfinished(path) or path.stat().st_size == 0
