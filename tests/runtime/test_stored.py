"""Files of machine code: written whole or not at all, whatever else is in the directory."""

from __future__ import annotations

import os
import threading
import zlib
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from fastpin.runtime import jit, machine, stored

pytestmark = pytest.mark.skipif(jit.PLAIN or not machine.CAN_LOAD, reason="no code is stored")


@pytest.fixture
def place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> stored.StoredCode:
    """The place of a small kernel in an empty directory."""
    found = stored.place_of(jit.compiled(lambda x: x + x), "d")
    assert found is not None
    monkeypatch.setattr(stored.StoredCode, "_directories", lambda self: iter([tmp_path]))
    monkeypatch.setattr(stored.StoredCode, "_beside", lambda self: tmp_path)
    return found


def test_threads_and_processes_of_equal_number_write_whole_files(place: stored.StoredCode, tmp_path: Path) -> None:
    """All write the same file at once. It is always whole, and nothing is left behind."""
    codes = [machine.Code(bytes([k]) * 3_000_000, "wrapper", "environment", (), ()) for k in range(4)]
    barrier = threading.Barrier(len(codes))

    def write(code: machine.Code) -> None:
        barrier.wait()
        for _ in range(5):
            place.save(code)
            content = (tmp_path / place.file).read_bytes()
            assert zlib.crc32(content[4:]).to_bytes(4, "little") == content[:4]

    with ThreadPoolExecutor(len(codes)) as pool:
        list(pool.map(write, codes))
    assert list(tmp_path.iterdir()) == [tmp_path / place.file]


def test_links_in_the_way_of_new_files_are_not_followed(
    place: stored.StoredCode, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Neither under a name that can be guessed nor under the random one."""
    precious = tmp_path / "precious"
    precious.write_text("keep")
    monkeypatch.setattr(os, "urandom", bytes)
    for name in (str(os.getpid()), bytes(8).hex()):
        (tmp_path / f"{place.file}.{name}.part").symlink_to(precious)
    place.save(None)
    assert precious.read_text() == "keep"
    assert not (tmp_path / place.file).exists()


def test_code_that_can_not_get_its_name_leaves_nothing_behind(place: stored.StoredCode, tmp_path: Path) -> None:
    (tmp_path / place.file).mkdir()  # nobody, not even root, can give a file the name of a directory
    place.save(None)
    assert [path.name for path in tmp_path.iterdir()] == [place.file]


def test_code_of_older_texts_that_can_not_be_deleted_is_left(place: stored.StoredCode, tmp_path: Path) -> None:
    older = tmp_path / f"{place.stem}00000000{stored.SUFFIX}"
    older.mkdir()  # nobody, not even root, can delete a directory as a file
    place.save(None)
    assert {path.name for path in tmp_path.iterdir()} == {older.name, place.file}
