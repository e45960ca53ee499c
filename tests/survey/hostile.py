"""Hostile parts of files, for mutations.py: what a stranger could put into a result, an index or a plan.

Each operator takes a generator of random numbers, the path of a file, and a folder of things outside that nobody may
touch: ``precious.txt``, ``other.h5`` and ``outside.py``. It changes the file, or puts something beside it.
"""

from __future__ import annotations

import contextlib
import json
import os
import sqlite3
import struct
import zlib
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np

Operator = Callable[[np.random.Generator, Path, Path], None]

HUGE = (300_000_000, 2**40, 2**62)
"""Rows of arrays without content."""

MARKER = (
    "import pathlib\npathlib.Path(__file__).with_name('ran').write_text('ran')\n\n\ndef f(result):\n    return 1.0\n"
)
"""A file of functions that shows that it was run."""


def prepare_outside(folder: Path) -> None:
    """Write the things outside that nobody may touch."""
    folder.mkdir()
    (folder / "precious.txt").write_text("keep")
    (folder / "outside.py").write_text(MARKER)
    with h5py.File(folder / "other.h5", "w") as file:
        file["secret"] = np.arange(1000.0)
        file.create_group("group")


# -- results -------------------------------------------------------------------------------------------------


def _chosen(rng: np.random.Generator, file: h5py.File, kind: type) -> str:
    """The name of a random array, or of a random group."""
    names: list[str] = []
    file.visititems(lambda name, item: names.append(name) if isinstance(item, kind) else None)
    return str(rng.choice(names))


def huge_arrays(rng: np.random.Generator, path: Path, _: Path) -> None:
    """Claim rows that are not there."""
    with h5py.File(path, "r+") as file:
        rows = int(rng.choice(HUGE))
        group = file[str(rng.choice(["states", "cycles", "history"]))]
        for item in group.values():
            if isinstance(item, h5py.Dataset) and item.maxshape and item.maxshape[0] is None and rng.random() < 0.9:
                item.resize(rows, axis=0)


def huge_new_array(rng: np.random.Generator, path: Path, _: Path) -> None:
    """Replace an array by one of absurd chunks, or of a size that is only claimed."""
    with h5py.File(path, "r+") as file:
        name = _chosen(rng, file, h5py.Dataset)
        old = file[name]
        dtype, shape = old.dtype, old.shape
        del file[name]
        shape = (int(rng.choice(HUGE)), *shape[1:])
        if rng.random() < 0.5 and dtype.kind != "O":
            plan = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
            plan.set_layout(h5py.h5d.CHUNKED)
            plan.set_chunk((1 << 28, *shape[1:]))
            space = h5py.h5s.create_simple(shape)
            with contextlib.suppress(ValueError, OSError):
                h5py.h5d.create(file.id, name.encode(), h5py.h5t.py_create(dtype), space, plan)
        else:
            file.create_dataset(name, shape, dtype, chunks=(1, *shape[1:]), fillvalue=None)


def soft_link(rng: np.random.Generator, path: Path, _: Path) -> None:
    """Replace a part by a soft link: to another part, to itself, to its parent or to nothing."""
    with h5py.File(path, "r+") as file:
        name = _chosen(rng, file, h5py.Dataset if rng.random() < 0.6 else h5py.Group)
        target = str(rng.choice(["/", f"/{name}", "/nothing", f"/{_chosen(rng, file, h5py.Dataset)}"]))
        del file[name]
        file[name] = h5py.SoftLink(target)


def hard_link(rng: np.random.Generator, path: Path, _: Path) -> None:
    """Replace a part by a second name of another part, also of a group around it."""
    with h5py.File(path, "r+") as file:
        name = _chosen(rng, file, h5py.Dataset if rng.random() < 0.6 else h5py.Group)
        other = str(rng.choice(["/", _chosen(rng, file, h5py.Group), _chosen(rng, file, h5py.Dataset)]))
        target = file[other]
        del file[name]
        file[name] = target


def external_link(rng: np.random.Generator, path: Path, outside: Path) -> None:
    """Replace a part by a link to another file."""
    with h5py.File(path, "r+") as file:
        name = _chosen(rng, file, h5py.Dataset if rng.random() < 0.6 else h5py.Group)
        target = str(rng.choice([str(outside / "other.h5"), str(outside / "precious.txt"), path.name, "/dev/zero"]))
        del file[name]
        file[name] = h5py.ExternalLink(target, str(rng.choice(["/", "/secret", "/group"])))


def external_storage(rng: np.random.Generator, path: Path, outside: Path) -> None:
    """Let the numbers of an array lie in another file."""
    with h5py.File(path, "r+") as file:
        name = _chosen(rng, file, h5py.Dataset)
        old = file[name]
        shape, dtype = old.shape or (1,), old.dtype if old.dtype.kind != "O" else np.dtype("f8")
        del file[name]
        target = str(rng.choice([str(outside / "precious.txt"), str(outside / "new.bin"), "/dev/zero"]))
        file.create_dataset(name, shape, dtype, external=[(target, 0, h5py.h5f.UNLIMITED)])


def virtual_array(rng: np.random.Generator, path: Path, outside: Path) -> None:
    """Replace an array by a view of another file."""
    with h5py.File(path, "r+") as file:
        name = _chosen(rng, file, h5py.Dataset)
        shape = file[name].shape or (1,)
        del file[name]
        layout = h5py.VirtualLayout(shape, "f8")
        source = h5py.VirtualSource(str(outside / "other.h5"), "secret", (1000,))
        size = min(1000, shape[0]) if len(shape) == 1 else 0
        if size:
            layout[:size] = source[:size]
        file.create_virtual_dataset(name, layout)


def odd_type(rng: np.random.Generator, path: Path, _: Path) -> None:
    """Replace an array by references, ragged rows, records, opaque bytes, a type or many shared texts."""
    with h5py.File(path, "r+") as file:
        name = _chosen(rng, file, h5py.Dataset)
        shape = file[name].shape
        del file[name]
        way = int(rng.integers(5))
        if way == 0:
            file.create_dataset(name, shape, h5py.ref_dtype)
        elif way == 1:
            file.create_dataset(name, shape, h5py.vlen_dtype(np.dtype("f8")))
        elif way == 2:
            file.create_dataset(name, shape, np.dtype([("a", "f8"), ("b", "S3")]))
        elif way == 3:
            file[name] = np.dtype("f8")
        else:
            file.create_dataset(name, (100_000,), h5py.string_dtype(), data=np.array(["x"] * 100_000, dtype=object))


def hostile_attribute(rng: np.random.Generator, path: Path, _: Path) -> None:
    """Put a large array, a reference, or a text with escapes into an attribute."""
    with h5py.File(path, "r+", track_order=True) as file:
        item = file[_chosen(rng, file, h5py.Group)] if rng.random() < 0.6 else file
        names = list(item.attrs) or ["title"]
        name = str(rng.choice(names))
        way = int(rng.integers(4))
        if way == 0:
            item.attrs[name] = "\x1b[31mred\x1b]0;title\x07" * int(rng.integers(1, 50))
        elif way == 1:
            item.attrs[name] = file.ref
        elif way == 2:
            item.attrs[name] = "x" * 60_000
        else:
            item.attrs[name] = np.full(7_000, 1e308)


def beside_result(rng: np.random.Generator, path: Path, outside: Path) -> None:
    """Put a link, a pipe, a directory or hostile records beside a result, as its journal or checkpoint."""
    beside = path.with_name(path.name + str(rng.choice([".journal", ".journal", ".checkpoint"])))
    if beside.exists() or beside.is_symlink():
        beside.unlink()
    way = int(rng.integers(8))
    if way == 0:
        beside.symlink_to(outside / str(rng.choice(["precious.txt", "other.h5", "new.txt"])))
    elif way == 1:
        os.link(outside / "precious.txt", beside)
    elif way == 2:
        os.mkfifo(beside)
    elif way == 3:
        beside.mkdir()
    elif way == 4:
        beside.symlink_to("/dev/zero")
    elif way == 5:
        with beside.open("wb") as file:
            file.truncate(int(rng.choice([1 << 20, 1 << 31, 1 << 40])))
    elif way == 6:
        beside.write_bytes(_records(rng, path.stat().st_size))
    else:
        with h5py.File(beside, "w") as h5:
            h5.attrs["run"] = "x"
            h5["restart"] = h5py.ExternalLink(str(outside / "other.h5"), "/group")


def _records(rng: np.random.Generator, size: int) -> bytes:
    """Records of a journal with right checksums: they say that a transaction has overwritten random parts."""

    def record(place: int, old: bytes) -> bytes:
        return struct.pack("<QIII", place, len(old), zlib.crc32(old, place & 0xFFFFFFFF), 0) + old

    begin = int(rng.choice([0, 8, size // 2, size, size + 1, 2**62]))
    places = rng.integers(0, max(min(begin, 2 * size), 1), int(rng.choice([1, 5, 3000])))
    return record(begin, b"") + b"".join(record(int(place), rng.bytes(int(rng.integers(1, 40)))) for place in places)


RESULT: dict[str, Operator] = {
    "huge arrays": huge_arrays,
    "huge new array": huge_new_array,
    "soft link": soft_link,
    "hard link": hard_link,
    "external link": external_link,
    "external storage": external_storage,
    "virtual array": virtual_array,
    "odd type": odd_type,
    "attribute": hostile_attribute,
    "beside": beside_result,
}
"""Operators on results."""


# -- indices of sweeps -----------------------------------------------------------------------------------------


def hot_journal(rng: np.random.Generator, path: Path, outside: Path) -> None:
    """Put a journal beside an index that names a super-journal: SQLite would delete the file of this name."""
    data = path.read_bytes()
    page, magic = struct.unpack(">H", data[16:18])[0], bytes.fromhex("d9d505f920a163d7")
    name = str(outside / "precious.txt").encode()
    records = int(rng.choice([0, 1, 0xFFFFFFFF]))
    head = (magic + struct.pack(">5I", records, 1, len(data) // page, 512, page)).ljust(512, b"\0")
    end = struct.pack(">I", 0x40000000 // page + 1) + name + struct.pack(">II", len(name), sum(name)) + magic
    if rng.random() < 0.3:
        end = end[: int(rng.integers(len(end)))]
    path.with_name("index.sqlite-journal").write_bytes(head + end)


def journal_of_index(rng: np.random.Generator, path: Path, outside: Path) -> None:
    """Put a link, a pipe, a directory or random bytes beside an index, as its journal, log or lock."""
    name = str(rng.choice(["index.sqlite-journal", "index.sqlite-wal", "index.sqlite-shm", "lock"]))
    beside = path.with_name(name)
    beside.unlink(missing_ok=True)
    way = int(rng.integers(5))
    if way == 0:
        beside.symlink_to(outside / str(rng.choice(["precious.txt", "new.txt"])))
    elif way == 1:
        os.link(outside / "precious.txt", beside)
    elif way == 2:
        os.mkfifo(beside)
    elif way == 3:
        beside.mkdir()
    else:
        beside.write_bytes(bytes.fromhex("d9d505f920a163d7") + rng.bytes(2000))


def write_ahead(_: np.random.Generator, path: Path, __: Path) -> None:
    """Say in the header that the index has a write-ahead log."""
    data = bytearray(path.read_bytes())
    data[18:20] = b"\x02\x02"
    path.write_bytes(data)


def linked_index(rng: np.random.Generator, path: Path, outside: Path) -> None:
    """Replace the index by a link to another file, or to a pipe."""
    path.unlink()
    if rng.random() < 0.3:
        os.mkfifo(path)
    else:
        path.symlink_to(outside / str(rng.choice(["precious.txt", "other.h5", "new.txt"])))


def program(rng: np.random.Generator, path: Path, outside: Path) -> None:
    """Add a view, a trigger, a generated column, an index on an expression, a virtual table or a table without end."""
    endless = "WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n)"
    table = str(rng.choice(["runs", "sweep", "results"]))
    programs = (
        f"ALTER TABLE {table} RENAME TO r0; CREATE VIEW {table} AS {endless} SELECT r0.* FROM r0, n",
        f"CREATE VIEW extra AS {endless} SELECT i FROM n",
        f"CREATE TRIGGER t AFTER UPDATE ON {table} BEGIN DELETE FROM runs; END",
        f"CREATE TRIGGER t BEFORE INSERT ON {table} BEGIN INSERT INTO sweep {endless} SELECT i, i FROM n; END",
        f"ALTER TABLE {table} ADD COLUMN g AS (randomblob(1000000000))",
        f"CREATE INDEX e ON {table} (hex(zeroblob(1000)))",
        f"CREATE INDEX plain ON {table} (rowid)",
        "CREATE VIRTUAL TABLE v USING fts5(x)",
        f"CREATE TABLE c (x CHECK (x IN ({endless} SELECT i FROM n)))",
        f"ALTER TABLE {table} ADD COLUMN d DEFAULT (zeroblob(1000000000))",
        f"CREATE TEMP TABLE x AS SELECT 1; UPDATE runs SET rowid = rowid + {2**61}",
    )
    database = sqlite3.connect(path, isolation_level=None)
    with contextlib.closing(database), contextlib.suppress(sqlite3.Error):
        database.executescript(str(rng.choice(np.array(programs, dtype=object))))


def schema(rng: np.random.Generator, path: Path, _: Path) -> None:
    """Change the words of the schema themselves, and let tables share their pages."""
    words = ("CREATE TABLE runs (id)", "CREATE VIEW runs AS SELECT 1", "x", None, "CREATE TABLE a (" * 1000)
    row, page = int(rng.integers(1, 5)), int(rng.integers(0, 9))
    changes = (
        ("UPDATE sqlite_master SET sql = ? WHERE rowid = ?", (words[int(rng.integers(5))], row)),
        ("UPDATE sqlite_master SET rootpage = ? WHERE rowid = ?", (page, row)),
        ("UPDATE sqlite_master SET name = ?, tbl_name = ?", ("runs", "runs")),
    )
    statement, values = changes[int(rng.integers(len(changes)))]
    database = sqlite3.connect(path, isolation_level=None)
    with contextlib.closing(database), contextlib.suppress(sqlite3.Error):
        database.execute("PRAGMA writable_schema = ON")
        database.execute(statement, values)


def huge_values(rng: np.random.Generator, path: Path, _: Path) -> None:
    """Put large or deep JSON, large blobs, texts with escapes, or ids with parts of paths into an index."""
    values = (
        "[" * 200_000, json.dumps(list(range(300_000))), "9" * 1_000_000, "{" + '"a":{' * 5_000, b"\0" * 5_000_000,
        "\x1b[31mred", "../../outside/precious", "/etc/passwd", "..", "a/b", "a\0b", "x" * 5_000, "NaN", "1e999",
    )  # fmt: skip
    value = values[int(rng.integers(len(values)))]
    with contextlib.closing(sqlite3.connect(path, isolation_level=None)) as database:
        columns = [row[1] for row in database.execute("PRAGMA table_info(runs)")]
        column = str(rng.choice(["id", *columns])).replace('"', '""')
        statements = (
            (f'UPDATE runs SET "{column}" = ? WHERE rowid = ?', (value, int(rng.integers(1, 5)))),
            ("UPDATE sweep SET value = ? WHERE rowid = ?", (value, int(rng.integers(1, 9)))),
            ("UPDATE results SET content = ? WHERE rowid = ?", (value, int(rng.integers(1, 5)))),
            ("UPDATE results SET run = ? WHERE rowid = ?", (value, int(rng.integers(1, 5)))),
        )
        statement, bound = statements[int(rng.integers(len(statements)))]
        with contextlib.suppress(sqlite3.Error):
            database.execute(statement, bound)


INDEX: dict[str, Operator] = {
    "hot journal": hot_journal,
    "beside": journal_of_index,
    "write-ahead log": write_ahead,
    "linked index": linked_index,
    "program": program,
    "schema": schema,
    "values": huge_values,
}
"""Operators on indices of sweeps."""


# -- plans -----------------------------------------------------------------------------------------------------

FUNCTIONS = (
    "evil.py:f", "../outside/outside.py:f", "link.py:f", "linked/outside.py:f", "OUTSIDE/outside.py:f", "evil:f",
    "evil.py", "evil.py:", "os.system:f", "os:system", "evil.py:missing", "./evil.py:f", "case0.toml:f", ":f",
    "evil.py:f.__globals__", "/dev/zero:f", "pipe.py:f", "directory.py:f", "evil.py:__import__", "\\u0000.py:f",
    "loop.py:f",
)  # fmt: skip
"""Names of functions in a plan. OUTSIDE is the folder outside."""


def function_of_plan(rng: np.random.Generator, path: Path, outside: Path) -> None:
    """Name a function in a plan: in a file beside it, in a link, outside, or in no file."""
    folder = path.parent
    (folder / "evil.py").write_text(MARKER)
    (folder / "link.py").symlink_to(outside / "outside.py")
    (folder / "loop.py").symlink_to("loop.py")
    (folder / "linked").symlink_to(outside)
    (folder / "directory.py").mkdir()
    os.mkfifo(folder / "pipe.py")
    function = str(rng.choice(FUNCTIONS)).replace("OUTSIDE", str(outside))
    path.write_text(f'{path.read_text()}\n[outcomes]\nw = {{function = "{function}"}}\n')


PLAN: dict[str, Operator] = {"function": function_of_plan}
"""Operators on plans."""
