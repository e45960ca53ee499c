"""Results of sweeps in a few bytes: the content of an HDF5 file without HDF5.

A small HDF5 file takes longer than the solution of a small contact: 14 ms and 100 kB. A packed result has the same
groups, arrays and attributes (layout.py), and takes 0.2 ms and 19 kB. :class:`PackedGroup` and :class:`PackedArray`
have the part of h5py's interface that layout.py needs. So the same code writes and reads both.

A packed result is a head in JSON and the numbers of its arrays. It begins with a checksum of all its bytes. A sweep
keeps its packed results in a table of its index, an SQLite file.
"""

from __future__ import annotations

import json
import math
import os
import re
import shutil
import sqlite3
import stat
import struct
import tempfile
import zlib
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path
from typing import Any, Literal

import h5py
import numpy as np

from fastpin.errors import InputError
from fastpin.model.inputs import SQLITE_SIGNATURE, note_input
from fastpin.storage.files import INDEX, NO_LINK

BUSY_SECONDS = 60.0
"""Longest wait for another process that has locked a database."""

TABLES = ("runs", "sweep", "outcomes", "bars", "results")
"""The tables that an index may have."""

MOST_ROWS = 1_000_000
"""Most rows of a table that are read. Pages that lead to the same pages can feign more rows than a file can hold."""

MOST_OPERATIONS = 1_000_000
"""Most operations of SQLite that read the list of tables. A usual index needs some hundred."""

Mode = Literal["ro", "rw", "rwc"]
"""Modes of opening: to read, to write, or to write a file that may be new."""

# Plain columns: names, types and constraints in capital words. Expressions would need parentheses.
_COLUMN = r'(?>"(?:[^"]|"")*"|PRIMARY KEY \([a-z, ]+\)|[a-z]+)(?> [A-Z]+)*'
_PLAIN = re.compile(rf"CREATE TABLE \"?([a-z]+)\"? \({_COLUMN}(?:, {_COLUMN})*\)")

# The end of a journal that names a super-journal, which SQLite deletes: its length, a checksum, and these bytes.
_MAGIC = bytes.fromhex("d9d505f920a163d7")

FOLDER = "results"
"""Folder of result files in the directory of a sweep."""

TABLE = "CREATE TABLE IF NOT EXISTS results (run TEXT PRIMARY KEY, content BLOB NOT NULL)"
"""The table of packed results in the index."""

_HEAD = struct.Struct("<8sII")  # signature, checksum of everything after it, length of the JSON

_SIGNATURE = b"fpinrun1"

_KINDS = ("<f8", "<i8", "|i1", "|b1")  # types of the entries of all arrays but texts


def open_database(path: Path, mode: Mode, timeout: float = BUSY_SECONDS) -> sqlite3.Connection:
    """Open a database, and check that its tables are those of an index.

    Parameters
    ----------
    path : Path
    mode : {"ro", "rw", "rwc"}
    timeout : float
        Longest wait for another process, s.

    Raises
    ------
    InputError
        If the file or its journal is not as fastpin writes it.
    sqlite3.Error
        If SQLite can't open the file.
    """
    real = Path(os.path.realpath(path))
    note_input(real)
    if mode != "ro" and path.is_symlink():  # The link of a stranger may lead to any file.
        raise InputError(str(path), "must be an ordinary file to be written, not a link")
    _check_file(real, path)
    _check_log(real)
    _check_journal(real, path)
    try:
        return _opened(real, path, mode, timeout)
    except sqlite3.OperationalError as error:
        if mode != "ro" or error_name(error) != "SQLITE_READONLY_ROLLBACK":
            raise
    return _repaired_copy(real, path)


def error_name(error: sqlite3.Error) -> str:
    """Return SQLite's name of an error. Python's own errors have none, such as that of a text that is not UTF-8."""
    return getattr(error, "sqlite_errorname", "")


def limited(cursor: sqlite3.Cursor) -> Iterator[Any]:
    """Yield the rows of a query.

    Raises
    ------
    sqlite3.DatabaseError
        If there are more than :data:`MOST_ROWS`.
    """
    for number, row in enumerate(cursor):
        if number >= MOST_ROWS:
            raise sqlite3.DatabaseError(f"a table has more than {MOST_ROWS:,} rows")
        yield row


def _opened(real: Path, path: Path, mode: Mode, timeout: float) -> sqlite3.Connection:
    database = sqlite3.connect(f"{real.as_uri()}?mode={mode}", uri=True, timeout=timeout, isolation_level=None)
    try:
        database.set_progress_handler(lambda: 1, MOST_OPERATIONS)
        database.execute("PRAGMA trusted_schema = OFF")
        database.execute("PRAGMA cell_size_check = ON")
        for kind, name, sql in database.execute("SELECT type, name, sql FROM sqlite_master"):
            _check_part(path, kind, name, sql)
        database.set_progress_handler(None, 0)
    except BaseException:
        database.close()
        raise
    return database


def _check_part(path: Path, kind: object, name: object, sql: object) -> None:
    """Raise :class:`InputError` if a part of a database is no table of plain columns, or the index of its keys."""
    if kind == "index" and sql is None:
        return
    found = _PLAIN.fullmatch(sql) if kind == "table" and isinstance(sql, str) else None
    if found is None or found[1] != name or name not in TABLES:
        allowed = ", ".join(TABLES)
        raise InputError(str(path), f"is no index of a sweep: it holds the {kind} {name}, but may hold {allowed} only")


def _check_file(real: Path, path: Path) -> None:
    """Raise :class:`InputError` if the file is no database, or would be opened with a write-ahead log."""
    try:
        if not real.exists():
            return
        if not real.is_file():
            raise InputError(str(path), "must be an ordinary file")
        with real.open("rb") as file:
            head = file.read(20)
    except OSError as error:
        raise InputError(str(path), f"can't be read: {error.strerror}") from None
    if head.startswith(SQLITE_SIGNATURE) and head[18:] != b"\x01\x01":  # the versions of a file without such a log
        raise InputError(str(path), "is no index of a sweep: it has a write-ahead log, which fastpin never makes")


def _check_log(real: Path) -> None:
    """Raise :class:`InputError` if there is a write-ahead log beside a database.

    SQLite uses the log whatever the header says. It writes to the log, also when it reads, and follows links.
    """
    for ending in ("-wal", "-shm"):
        log = real.with_name(f"{real.name}{ending}")
        if os.path.lexists(log):
            raise InputError(str(log), "is a write-ahead log, which fastpin never makes; please remove it")


def _journal_of(real: Path) -> Path:
    """The path at which SQLite keeps the journal of a database."""
    return real.with_name(f"{real.name}-journal")


def _check_journal(real: Path, path: Path) -> None:
    """Raise :class:`InputError` if the journal of a database is a link, or names a super-journal.

    SQLite deletes the file that such a name leads to. It writes the name in transactions over several databases only.
    """
    journal = _journal_of(real)
    try:
        file = os.open(journal, os.O_RDONLY | NO_LINK | getattr(os, "O_NONBLOCK", 0))
    except FileNotFoundError:
        return
    except OSError as error:
        raise InputError(str(journal), f"must be an ordinary file, not a link: {error.strerror}") from None
    try:
        found = os.fstat(file)
        if not stat.S_ISREG(found.st_mode) or found.st_nlink > 1:
            raise InputError(str(journal), "must be an ordinary file with one name")
        if os.pread(file, len(_MAGIC), max(found.st_size - len(_MAGIC), 0)) == _MAGIC:
            words = "names another file that SQLite would delete; fastpin never writes such a journal"
            raise InputError(str(path), f"can't be used: its journal {words}")
    finally:
        os.close(file)


def _repaired_copy(real: Path, path: Path) -> sqlite3.Connection:
    """Open a private copy of a database to read, in which SQLite undoes the transaction of a killed sweep.

    The copy has no name any more when this function ends. Its bytes go when the database is closed.
    """
    journal = _journal_of(real)
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder) / real.name
        try:
            shutil.copyfile(journal, _journal_of(copy), follow_symlinks=False)
            shutil.copyfile(real, copy)
        except FileNotFoundError:  # Another process has undone the transaction meanwhile.
            return _opened(real, path, "ro", BUSY_SECONDS)
        except OSError as error:
            reason = f"was being written when its sweep was killed, and can't be copied to {folder}: {error.strerror}"
            raise InputError(str(path), reason) from None
        _check_journal(copy, path)
        _opened(copy, path, "rw", BUSY_SECONDS).close()
        return _opened(copy, path, "ro", BUSY_SECONDS)


class _Scale:
    """The dimension of an array. Packed results leave out the links to the scales: reading does not need them."""

    def attach_scale(self, scale: PackedArray) -> None:
        """Do nothing."""


class PackedArray:
    """An array of a group, with the interface of ``h5py.Dataset``."""

    def __init__(self, name: str, values: np.ndarray) -> None:
        self.name, self.values = name, values
        self.attrs: dict[str, Any] = {}
        self.dims = [_Scale()] * values.ndim

    @property
    def shape(self) -> tuple[int, ...]:
        """Numbers of entries in all dimensions."""
        return self.values.shape

    @property
    def dtype(self) -> np.dtype[Any]:
        """The type of the entries."""
        return self.values.dtype

    @property
    def ndim(self) -> int:
        """Number of dimensions."""
        return self.values.ndim

    def __len__(self) -> int:
        return len(self.values)

    def __getitem__(self, key: Any) -> Any:
        return self.values[key]

    def __setitem__(self, key: Any, values: Any) -> None:
        self.values[key] = values

    def resize(self, size: int, axis: int) -> None:
        """Change the number of rows."""
        grown = np.zeros((size, *self.shape[1:]), self.dtype)
        grown[: len(self)] = self.values[:size]
        self.values = grown

    def asstr(self) -> PackedArray:
        """The array: its texts are ``str`` already."""
        return self

    def make_scale(self, name: str) -> None:
        """Do nothing, see :class:`_Scale`."""


class PackedGroup:
    """A group with attributes, arrays and groups, with the interface of ``h5py.Group``."""

    def __init__(self, name: str = "/") -> None:
        self.name = name
        self.attrs: dict[str, Any] = {}
        self._parts: dict[str, PackedArray | PackedGroup] = {}

    def create_group(self, name: str) -> PackedGroup:
        """Add a group, and the groups around it."""
        around, last = self._around(name)
        return around._add(last, PackedGroup(around._path(last)))

    def create_dataset(
        self, name: str, shape: tuple[int, ...] | None = None, dtype: Any = None, data: Any = None, **_: Any
    ) -> PackedArray:
        """Add an array: zeros of a shape, or `data`. How HDF5 is to store the array has no effect."""
        values = np.zeros(shape or (), dtype) if data is None else np.array(data, dtype)
        return self._add(name, PackedArray(self._path(name), values))

    def __getitem__(self, name: str) -> Any:
        part: Any = self
        for each in name.split("/"):
            part = part._parts[each]
        return part

    def __setitem__(self, name: str, values: PackedArray | np.ndarray) -> None:
        group, last = self._around(name)
        group._add(
            last, values if isinstance(values, PackedArray) else PackedArray(group._path(last), np.asarray(values))
        )

    def __contains__(self, path: str) -> bool:
        name, _, rest = path.partition("/")
        part = self._parts.get(name)
        return part is not None and (not rest or (isinstance(part, PackedGroup) and rest in part))

    def __iter__(self) -> Iterator[str]:
        return iter(self._parts)

    def __len__(self) -> int:
        return len(self._parts)

    def get(self, name: str, default: Any = None) -> Any:
        """A part of the group, or `default` if there is none of this name."""
        return self[name] if name in self else default  # noqa: SIM401 - this is the method itself

    def items(self) -> Iterator[tuple[str, PackedArray | PackedGroup]]:
        """Names and parts."""
        yield from self._parts.items()

    def copy_to(self, group: h5py.Group) -> None:
        """Write everything below this group into an empty group of an HDF5 file."""
        group.attrs.update(self.attrs)
        for name, part in self.items():
            if isinstance(part, PackedGroup):
                part.copy_to(group.create_group(name))
            else:
                group.create_dataset(name, data=part.values).attrs.update(part.attrs)

    def _around(self, name: str) -> tuple[PackedGroup, str]:
        """The group around a part, which is made if it is missing, and the part's name in it."""
        path, _, last = name.rpartition("/")
        return (self if not path else self[path] if path in self else self.create_group(path)), last

    def _path(self, name: str) -> str:
        return f"{self.name.rstrip('/')}/{name}"

    def _add(self, name: str, part: Any) -> Any:
        self._parts[name] = part
        return part


def to_bytes(root: PackedGroup) -> bytes:
    """Pack a file: a group with everything below it."""
    blocks: list[bytes] = []
    head = json.dumps(_described(root, blocks), default=lambda value: value.tolist(), separators=(",", ":")).encode()
    body = b"".join([head, *blocks])
    return _HEAD.pack(_SIGNATURE, zlib.crc32(body), len(head)) + body


def from_bytes(content: bytes) -> PackedGroup:
    """Unpack a file.

    Raises
    ------
    ValueError
        If `content` is no packed file, or was changed or cut short.
    """
    if len(content) < _HEAD.size or not content.startswith(_SIGNATURE):
        raise ValueError("it is no packed result")
    _, checksum, length = _HEAD.unpack_from(content)
    body = memoryview(content)[_HEAD.size :]
    if zlib.crc32(body) != checksum:
        raise ValueError("its checksum is wrong")
    root = PackedGroup()
    _fill(root, json.loads(bytes(body[:length])), body[length:], 0)
    return root


def packed_result(path: Path) -> bytes | None:
    """Return the packed result that stands for the file DIRECTORY/results/ID.h5 of a sweep; None if there is none.

    Raises
    ------
    InputError
        If the index of the sweep can't be read.
    """
    index = path.parent.parent / INDEX
    if path.parent.name != FOLDER or path.suffix != ".h5" or path.exists() or not index.is_file():
        return None
    try:
        with closing(open_database(index, "ro")) as database:
            if not database.execute("SELECT count(*) FROM sqlite_master WHERE name = 'results'").fetchone()[0]:
                return None
            row = database.execute("SELECT content FROM results WHERE run = ?", [path.stem]).fetchone()
    except sqlite3.Error as error:
        raise InputError(str(index), f"can't be used: {error}") from None
    if row is not None and not isinstance(row[0], bytes):
        raise InputError(str(path), "is damaged: it is no packed result")
    return None if row is None else row[0]


def _described(group: PackedGroup, blocks: list[bytes]) -> dict[str, Any]:
    """A group for JSON. The numbers of its arrays are added to `blocks`: its own arrays first, then its groups'."""
    arrays: dict[str, list[Any]] = {}
    for name, part in group.items():
        if isinstance(part, PackedArray) and part.dtype == object:
            arrays[name] = ["text", part.shape, part.attrs, part.values.tolist()]
        elif isinstance(part, PackedArray):
            arrays[name] = [part.dtype.str, part.shape, part.attrs]
            blocks.append(part.values.tobytes())
    groups = {name: _described(part, blocks) for name, part in group.items() if isinstance(part, PackedGroup)}
    return {"attrs": group.attrs, "arrays": arrays, "groups": groups}


def _fill(group: PackedGroup, described: dict[str, Any], data: memoryview, at: int) -> int:
    """Fill a group with its parts, whose numbers begin at the byte `at` of `data`. Return the byte after them."""
    group.attrs.update(described["attrs"])
    for name, (kind, shape, attrs, *text) in described["arrays"].items():
        if kind == "text":
            values = np.array(text[0], dtype=h5py.string_dtype())
        else:
            dtype, size = _described_array(name, kind, shape)
            values = np.frombuffer(data, dtype, size, at).reshape(shape) if size else np.zeros(shape, dtype)
            at += size * dtype.itemsize
        group[name] = values
        group[name].attrs.update(attrs)
    for name, inner in described["groups"].items():
        at = _fill(group.create_group(name), inner, data, at)
    return at


def _described_array(name: str, kind: Any, shape: Any) -> tuple[np.dtype[Any], int]:
    """Return the type and the number of the entries of an array. The head may come from a stranger."""
    if kind not in _KINDS:
        raise ValueError(f"{name} has numbers of the type {kind}, not of {', '.join(_KINDS)}")
    if not isinstance(shape, list) or not all(type(size) is int and 0 <= size < 1 << 31 for size in shape):
        raise ValueError(f"{name} has the shape {shape}")
    return np.dtype(kind), math.prod(shape)
