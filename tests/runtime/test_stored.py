"""Files of machine code: written whole or not at all, whatever else is in the directory."""

from __future__ import annotations

import os
import threading
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


def name(place: stored.StoredCode) -> str:
    return place.stem + place.text + stored.NUMBA


def test_threads_and_processes_of_equal_number_write_whole_files(place: stored.StoredCode, tmp_path: Path) -> None:
    """All write the same file at once. It is always whole, and nothing is left behind."""
    codes = [bytes([k]) * 300_000 for k in range(4)]
    barrier = threading.Barrier(len(codes))

    def write(code: bytes) -> None:
        barrier.wait()
        for _ in range(5):
            place.save(code)
            content = (tmp_path / name(place)).read_bytes()
            assert content[stored.SIZE :] in codes
            assert content[: stored.SIZE] == place._digest(content[stored.SIZE :])

    with ThreadPoolExecutor(len(codes)) as pool:
        list(pool.map(write, codes))
    assert list(tmp_path.iterdir()) == [tmp_path / name(place)]


def test_links_in_the_way_of_new_files_are_not_followed(
    place: stored.StoredCode, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Neither under a name that can be guessed nor under the random one."""
    precious = tmp_path / "precious"
    precious.write_text("keep")
    monkeypatch.setattr(os, "urandom", bytes)
    for number in (str(os.getpid()), bytes(8).hex()):
        (tmp_path / f"{name(place)}.{number}.part").symlink_to(precious)
    place.save(b"code")
    assert precious.read_text() == "keep"
    assert not (tmp_path / name(place)).exists()


def test_code_that_can_not_get_its_name_leaves_nothing_behind(place: stored.StoredCode, tmp_path: Path) -> None:
    (tmp_path / name(place)).mkdir()  # nobody, not even root, can give a file the name of a directory
    place.save(b"code")
    assert [path.name for path in tmp_path.iterdir()] == [name(place)]


def test_code_of_older_texts_is_deleted_where_that_is_possible(place: stored.StoredCode, tmp_path: Path) -> None:
    left = tmp_path / f"{place.stem}00000000{stored.MACHINE}"
    left.mkdir()  # nobody, not even root, can delete a directory as a file
    (tmp_path / f"{place.stem}00000001{stored.MACHINE}").touch()
    place.save(b"code")
    assert {path.name for path in tmp_path.iterdir()} == {left.name, name(place)}
