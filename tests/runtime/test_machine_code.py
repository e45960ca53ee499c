"""Machine code is whole or absent: whatever interrupts a compilation, and whatever lies in the store."""

from __future__ import annotations

import errno
import os
import stat
from pathlib import Path

import pytest

from fastpin.runtime import files, jit, machine, stored
from tests.support import small_kernels
from tests.support.small_kernels import TEXT, VALUES, names, read, start

pytestmark = pytest.mark.skipif(jit.PLAIN or not machine.CAN_LOAD, reason="no code is stored")

SYSTEMS = pytest.mark.parametrize("system", ["here", "elsewhere"])
SUFFIX = {"here": ".machine", "elsewhere": ".numba"}
VALUE = [repr(value) for value in VALUES]


@pytest.fixture
def site(tmp_path: Path) -> Path:
    return small_kernels.site(tmp_path)


INTERRUPTED = (
    f"VALUES = {VALUES}"
    + """
import ctypes, os, signal, sys, threading, time
from fastpin.runtime import machine
how, system = sys.argv[1:]
machine.CAN_LOAD = system == "here"
from numba.core.registry import cpu_target

class Stop(BaseException):
    pass

def stop(*_):
    raise Stop

def signalled():
    signal.pthread_kill(caller, signal.SIGUSR1)
    time.sleep(0.02)

def thrown():
    assert ctypes.pythonapi.PyThreadState_SetAsyncExc(ctypes.c_ulong(caller), ctypes.py_object(Stop)) == 1

signal.signal(signal.SIGUSR1, stop)
caller, interrupt = threading.get_ident(), {"signalled": signalled, "thrown": thrown, "raised": stop}[how]

def counted(callback):
    def call(*arguments):
        global count
        count += 1
        if count == chosen:
            interrupt()
        return callback(*arguments)
    return call

cpu_target.target_context.refresh()
engine = cpu_target.target_context.codegen()._engine._ee
engine._object_cache_notify = counted(engine._object_cache_notify)
engine._object_cache_getbuffer = counted(engine._object_cache_getbuffer)

def once(store):
    '''Compile or load, as a new process: each call once more if it is interrupted.'''
    global stopped
    os.environ["NUMBA_CACHE_DIR"] = store
    sys.modules.pop("small", None)
    import small
    for call, value in zip((small.doubled, small.wave), VALUES):
        try:
            assert call(0.5) == value
        except Stop:
            stopped += 1
        assert call(0.5) == value

count = chosen = stopped = 0
once("first")
once("first")
callbacks = count
for chosen in range(1, callbacks + 1):
    count = 0
    once(f"store{chosen}")
    once(f"store{chosen}")
print(callbacks, stopped)
"""
)

LATER = (
    f"VALUES = {VALUES}"
    + """
import os, sys
from fastpin.runtime import machine
system, callbacks = sys.argv[1:]
machine.CAN_LOAD = system == "here"
for chosen in range(1, int(callbacks) + 1):
    os.environ["NUMBA_CACHE_DIR"] = f"store{chosen}"
    sys.modules.pop("small", None)
    import small
    assert [small.doubled(0.5), small.wave(0.5)] == VALUES
print("numba" in sys.modules)
"""
)


@pytest.mark.gate
@SYSTEMS
@pytest.mark.parametrize("how", ["signalled", "thrown", "raised"])
def test_an_interrupt_at_any_callback_of_llvm_leaves_whole_code(how: str, system: str, site: Path) -> None:
    """A signal, an exception of another thread, or one inside the callback, which Python ignores there."""
    words = read(start(site, how, system, code=INTERRUPTED), quiet=how != "raised")
    callbacks, stopped = map(int, words)
    assert callbacks >= 4  # LLVM asks for the code of each of the two kernels, and hands it over
    assert stopped == (0 if how == "raised" else callbacks)
    (imported,) = read(start(site, system, str(callbacks), code=LATER))
    assert imported == str(system == "elsewhere")
    for chosen in range(1, callbacks + 1):
        assert names(site, f"store{chosen}") == ["small.doubled" + SUFFIX[system], "small.wave" + SUFFIX[system]]


KILLED = """
import os, pathlib
pathlib.Path.replace = lambda *_: os._exit(9)
"""


@pytest.mark.gate
@SYSTEMS
def test_a_process_killed_after_an_upgrade_leaves_no_code_of_older_texts(system: str, site: Path) -> None:
    assert read(start(site, system))[:2] == VALUE
    (site / "small.py").write_text(TEXT.replace("return x * y", "return x * y + 7.0"))
    killed = start(site, system, code=KILLED + small_kernels.CALLS)
    killed.communicate()
    assert killed.returncode == 9
    for _ in range(2):
        assert read(start(site, system))[0] == repr(VALUES[0] + 7.0)


@pytest.mark.gate
@SYSTEMS
def test_several_processes_write_the_store_at_once(system: str, site: Path) -> None:
    for process in [start(site, system) for _ in range(2)]:
        assert read(process)[:2] == VALUE
    assert names(site) == ["small.doubled" + SUFFIX[system], "small.wave" + SUFFIX[system]]
    assert read(start(site, system)) == [*VALUE, str(system == "elsewhere")]


FULL = """
import resource
resource.setrlimit(resource.RLIMIT_FSIZE, (1000, 1000))
"""


@pytest.mark.gate
@SYSTEMS
def test_a_full_or_locked_store_is_done_without(system: str, site: Path) -> None:
    assert read(start(site, system, code=FULL + small_kernels.CALLS)) == [*VALUE, "True"]
    assert names(site) == []
    assert read(start(site, system, store="small.py")) == [*VALUE, "True"]  # nobody can write in a file


@pytest.fixture(scope="module")
def code() -> machine.Code:
    _, code = machine.compile_kernel(jit.compiled(lambda x: x + x), (1.5,))
    assert isinstance(code, machine.Code)
    return code


@pytest.fixture
def place(tmp_path: Path, code: machine.Code, monkeypatch: pytest.MonkeyPatch) -> stored.StoredCode:
    """The place of a kernel whose code is stored."""
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    found = stored.place_of(jit.compiled(lambda x: x + x), "d")
    assert found is not None
    found.save(code)
    loaded = found.load()
    assert loaded is not None
    assert loaded(1.5) == 3.0
    return found


BYTES = {
    "nothing": lambda content: b"",
    "four zeros": lambda content: bytes(4),
    "zeros": lambda content: bytes(len(content)),
    "half": lambda content: content[: len(content) // 2],
    "no end": lambda content: content[:-1],
    "more": lambda content: content + b"\0",
    "one bit": lambda content: content[:-100] + bytes([content[-100] ^ 1]) + content[-99:],
    "another digest": lambda content: bytes(stored.SIZE) + content[stored.SIZE :],
}

WHOLE = {
    "no entry": lambda code: code._replace(entry="nosuch"),
    "no environment": lambda code: code._replace(environment="nosuch"),
    "half an object": lambda code: code._replace(machine_code=code.machine_code[: len(code.machine_code) // 2]),
    "no object": lambda code: code._replace(machine_code=b""),
    "an unknown symbol": lambda code: code._replace(foreign=("nosuch",)),
    "no names of symbols": lambda code: code._replace(entry="", environment=""),
    "too few lines": lambda code: b"one\ntwo\n",
    "no text": lambda code: b"\xff\n\xff\n\xff\n\xff\n" + code.machine_code,
}

SPECIAL = {
    "a pipe": os.mkfifo,
    "a directory": os.mkdir,
    "a link to itself": lambda path: path.symlink_to(path),
    "a device": lambda path: path.symlink_to(os.devnull),
    "a link to nothing": lambda path: path.symlink_to("nothing"),
}


def test_damaged_bytes_are_compiled_anew(place: stored.StoredCode, tmp_path: Path) -> None:
    (file,) = tmp_path.iterdir()
    content = file.read_bytes()
    for kind, change in BYTES.items():
        file.write_bytes(change(content))
        assert place.load() is None, kind


def test_foreign_content_is_compiled_anew(
    place: stored.StoredCode, tmp_path: Path, code: machine.Code, monkeypatch: pytest.MonkeyPatch
) -> None:
    """With a digest that agrees, as of another version of the program."""
    (file,) = tmp_path.iterdir()
    for kind, change in WHOLE.items():
        content = change(code)
        body = content if isinstance(content, bytes) else content.to_bytes()
        file.write_bytes(place._digest(body) + body)
        assert place.load() is None, kind
        file.with_suffix(stored.NUMBA).write_bytes(place._digest(body) + body)
        assert place.load() is None, kind
    other = stored.place_of(jit.compiled(lambda x: x + x), "q")
    assert other is not None
    place.save(code)
    file.rename(tmp_path / f"{other.stem}{other.text}{stored.MACHINE}")
    assert other.load() is None


def test_special_files_are_compiled_anew(place: stored.StoredCode, tmp_path: Path, code: machine.Code) -> None:
    (file,) = tmp_path.iterdir()
    for kind, make in SPECIAL.items():
        file.unlink()
        make(file)
        assert place.load() is None, kind
        if kind == "a directory":
            file.rmdir()
        place.save(code)
        assert place.load() is not None, kind


def test_an_error_of_the_disk_is_no_error_of_the_kernel(
    place: stored.StoredCode, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: object) -> bytes:
        raise OSError(errno.EIO, "damaged")

    monkeypatch.setattr(os, "read", fail)
    assert place.load() is None


def owned(mode: int, user: int = 1000, group: int = 1000) -> os.stat_result:
    return os.stat_result((mode, 0, 0, 0, user, group, 0, 0, 0, 0))


FOLDER, FILE, PACKAGE = stat.S_IFDIR, stat.S_IFREG, owned(stat.S_IFDIR | 0o755, 2000, 2000)
SHARED = owned(stat.S_IFDIR | 0o775, 0, 50)
TRUSTED = {
    "my own": (owned(FOLDER | 0o755), PACKAGE, True),
    "my own, with my own group": (owned(FOLDER | 0o775), PACKAGE, True),
    "of root": (owned(FILE | 0o644, 0, 0), PACKAGE, True),
    "of the owner of the package": (owned(FILE | 0o644, 2000, 2000), PACKAGE, True),
    "for all in a sticky folder": (owned(FOLDER | 0o1777, 0, 0), PACKAGE, True),
    "for those who write the package": (owned(FOLDER | 0o775, 0, 50), SHARED, True),
    "of somebody else": (owned(FILE | 0o644, 3000, 1000), PACKAGE, False),
    "of somebody else in a sticky folder": (owned(FOLDER | 0o1777, 3000, 1000), PACKAGE, False),
    "for all": (owned(FOLDER | 0o757), PACKAGE, False),
    "a file for all": (owned(FILE | 0o1666), PACKAGE, False),
    "for a group": (owned(FOLDER | 0o775, 1000, 50), PACKAGE, False),
    "for another group than the package": (owned(FOLDER | 0o775, 1000, 51), SHARED, False),
}


def test_code_that_others_can_write_is_not_trusted(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(os, "geteuid", lambda: 1000)
    monkeypatch.setattr(files, "_is_private", lambda group, user: group == user)
    for kind, (found, package, expected) in TRUSTED.items():
        assert files._is_trusted(found, package) == expected, kind


@pytest.mark.parametrize("what", ["folder", "file"])
def test_others_are_named_once_and_their_code_is_not_run(
    what: str, place: stored.StoredCode, tmp_path: Path, code: machine.Code, caplog: pytest.LogCaptureFixture
) -> None:
    files._warn.cache_clear()
    (file,) = tmp_path.iterdir()
    (tmp_path if what == "folder" else file).chmod(0o777)
    assert place.load() is None
    assert place.load() is None
    (message,) = [record.message for record in caplog.records]
    assert message.startswith(f"machine code in {tmp_path} is not used, because other users can write it")
    place.save(code)
    assert (place.load() is None) == (what == "folder")  # a file is replaced


def test_a_private_group_has_the_name_of_its_user() -> None:
    assert files._is_private(0, 0) == (files.grp.getgrgid(0).gr_name == "root")
    assert not files._is_private(0, 987_654_321)
