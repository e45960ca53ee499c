"""A full disk: one sentence, and the old file. A limit of the size of files stands in for the disk."""

from __future__ import annotations

from pathlib import Path

import pytest

from fastpin import Problem, solve
from fastpin.storage import store
from tests.support.processes import finished, python

SAVE = """
import resource, signal, sys
from fastpin.errors import OutputError
from fastpin.storage import store

result = store.load(sys.argv[1])
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
for most in (store.MOST_IN_MEMORY, 0):
    store.MOST_IN_MEMORY = most
    for limit in map(int, sys.argv[3:]):
        resource.setrlimit(resource.RLIMIT_FSIZE, (limit, resource.RLIM_INFINITY))
        try:
            store.save(result, sys.argv[2])
        except OutputError as error:
            print(error)
"""

RECORD = """
import os, resource, signal, sys
from fastpin.errors import OutputError
from fastpin.storage import recording, store, writer

result = store.load(sys.argv[1])
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
writer.MOST_PENDING = 4
whole, shares = sys.argv[2], dict(zip(sys.argv[3::2], sys.argv[4::2]))
recording.record(result.problem, result.history, whole, nodes=31, arc=(-3.1, 0.0))
for path, share in shares.items():
    limit = int(float(share) * os.path.getsize(whole))
    resource.setrlimit(resource.RLIMIT_FSIZE, (limit, resource.RLIM_INFINITY))
    try:
        recording.record(result.problem, result.history, path, nodes=31, arc=(-3.1, 0.0))
    except OutputError as error:
        print(error)
"""


@pytest.fixture(scope="module")
def source(similar, tmp_path_factory) -> Path:
    problem, path = Problem.from_load_parameter(similar, 0.4, 0.5), tmp_path_factory.mktemp("source") / "source.h5"
    store.save(solve(problem, [{"P": 1.0}, *[{"Q": 0.2}, {"Q": -0.2}] * 20], nodes=31), path)
    return path


def output_of(program: str, *words: object) -> str:
    """What a program prints. It may print nothing on standard error."""
    ended = finished(python(program, *words))
    assert ended.stderr == ""
    return ended.stdout


@pytest.mark.gate
def test_a_result_that_finds_no_room_is_one_sentence(source, path, tmp_path):
    """Prepared in memory, and written in place."""
    size = source.stat().st_size
    path.write_bytes(source.read_bytes())
    limits = [0, 100, 3000, size // 3, size // 2, size - 1000]
    said = output_of(SAVE, source, path, *limits).splitlines()
    assert said == [f"{path}: can't be written: File too large"] * 2 * len(limits)
    assert path.read_bytes() == source.read_bytes()
    assert [found.name for found in tmp_path.iterdir()] == ["a.h5"]


@pytest.mark.gate
def test_a_run_that_finds_no_room_keeps_its_last_transaction(source, tmp_path):
    paths = [tmp_path / f"{share}.h5" for share in (0.3, 0.5, 0.7, 0.9)]
    words = [word for path in paths for word in (path, path.stem)]
    said = output_of(RECORD, source, tmp_path / "whole.h5", *words).splitlines()
    assert said == [f"{path}: can't be written: File too large" for path in paths]
    for path in paths:
        assert not path.with_name(f"{path.name}.journal").exists()
        assert store.is_unfinished(path) or path.stat().st_size == 0
