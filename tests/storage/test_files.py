"""Files are written whole or not at all."""

import errno
import os
import pickle
import stat
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from fastpin.errors import InputError, OutputError
from fastpin.model.inputs import note_input, remembered_inputs
from fastpin.storage.files import INDEX, check_exists, check_writable, forget_temporaries, replacing


def test_replacing_follows_links_and_keeps_ordinary_permissions(tmp_path: Path) -> None:
    real, link = tmp_path / "real.txt", tmp_path / "link.txt"
    real.write_text("old")
    link.symlink_to(real)
    with replacing(link) as temporary:
        temporary.write_text("new")
    assert link.is_symlink()
    assert real.read_text() == "new"
    umask = os.umask(0)
    os.umask(umask)
    assert stat.S_IMODE(real.stat().st_mode) == 0o666 & ~umask


def test_replacing_never_replaces_a_device(tmp_path: Path) -> None:
    with replacing(os.devnull) as temporary:
        temporary.write_text("gone")
    assert not Path(os.devnull).is_file()


def test_a_full_disk_is_one_sentence_and_keeps_the_old_file(tmp_path: Path) -> None:
    path = tmp_path / "a.txt"
    path.write_text("old")
    with pytest.raises(OutputError) as caught, replacing(path):
        raise OSError(errno.ENOSPC, "No space left on device")
    assert str(caught.value) == f"{path}: can't be written: No space left on device"
    assert str(pickle.loads(pickle.dumps(caught.value))) == str(caught.value)
    assert (path.read_text(), list(tmp_path.iterdir())) == ("old", [path])


def test_a_link_under_the_name_of_a_temporary_file_is_not_followed(tmp_path, monkeypatch):
    victim = tmp_path / "precious.txt"
    victim.write_text("keep")
    monkeypatch.setattr("os.urandom", lambda _: b"\x01\x23")
    for name in (".o.0123.txt", f".o.{os.getpid()}.txt"):
        (tmp_path / name).symlink_to(victim)
    with pytest.raises(OutputError, match="can't be written: File exists"), replacing(tmp_path / "o.txt") as temporary:
        temporary.write_text("new")
    assert victim.read_text() == "keep"


def test_a_temporary_file_that_was_exchanged_is_not_taken(tmp_path: Path) -> None:
    path, victim = tmp_path / "a.txt", tmp_path / "precious.txt"
    victim.write_text("keep")

    def exchange() -> None:
        with replacing(path) as temporary:
            temporary.unlink()
            temporary.symlink_to(victim)

    with pytest.raises(OutputError, match="another process has exchanged its temporary file"):
        exchange()
    assert not path.exists()
    assert victim.read_text() == "keep"


def test_threads_may_write_one_file_at_the_same_time(tmp_path: Path) -> None:
    path = tmp_path / "a.txt"

    def write(text: str) -> None:
        for _ in range(50):
            with replacing(path) as temporary:
                temporary.write_text(text)

    with ThreadPoolExecutor(4) as threads:
        list(threads.map(write, [str(number) * 1000 for number in range(4)]))
    assert len(set(path.read_text())) == 1
    assert list(tmp_path.iterdir()) == [path]


def test_a_file_that_becomes_a_result_meanwhile_is_kept(tmp_path: Path) -> None:
    path, head = tmp_path / "a.txt", b"\x89HDF\r\n\x1a\n"

    def write() -> None:
        with replacing(path) as temporary:
            temporary.write_text("table")
            path.write_bytes(head)

    with pytest.raises(InputError, match="is a stored result"):
        write()
    assert path.read_bytes() == head


def test_a_directory_is_no_name_of_an_output(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="is a directory, a file name is needed"):
        check_writable(tmp_path)


def test_the_directory_of_a_sweep_is_for_other_commands(tmp_path: Path) -> None:
    (tmp_path / INDEX).touch()
    with pytest.raises(InputError, match="is the directory of a sweep: fastpin report writes its page"):
        check_exists(tmp_path)


@pytest.mark.parametrize("name", ["a.h5.journal", "a.h5.checkpoint", "lock", f"{INDEX}-journal"])
def test_what_a_run_or_a_sweep_needs_is_not_replaced(name: str, tmp_path: Path) -> None:
    for other in ("a.h5", INDEX, name):
        (tmp_path / other).write_bytes(b"")
    with pytest.raises(InputError, match="belongs to a run or a sweep"):
        check_writable(tmp_path / name)
    (tmp_path / "b.journal").write_bytes(b"")
    check_writable(tmp_path / "b.journal")


@pytest.mark.parametrize("name", [Path.symlink_to, Path.hardlink_to], ids=["symlink", "hard link"])
def test_an_input_is_known_under_every_name(name: Callable[[Path, Path], None], tmp_path: Path) -> None:
    path, other = tmp_path / "a.csv", tmp_path / "b.csv"
    path.write_text("P\n1\n")
    name(other, path)
    with remembered_inputs():
        note_input(path)
        for each in (path, other):
            with pytest.raises(InputError, match="is an input of this command"):
                check_writable(each)
    check_writable(other)


def test_only_temporary_files_of_the_output_are_forgotten(tmp_path: Path) -> None:
    keep = [".a.notes.h5", ".b.0123456789abcdef.h5", ".a.0123456789abcdef.txt", "a.0123456789abcdef.h5"]
    for name in (*keep, ".a.0123456789abcdef.h5", ".a.4711.h5"):
        (tmp_path / name).write_text("x")
    (tmp_path / ".a.0123.h5").symlink_to(tmp_path / keep[0])
    forget_temporaries(tmp_path, ["a.h5"])
    assert {path.name for path in tmp_path.iterdir()} == {*keep, ".a.0123.h5"}
