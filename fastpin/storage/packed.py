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
import sqlite3
import struct
import zlib
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from fastpin.errors import InputError
from fastpin.storage.database import open_database
from fastpin.storage.files import INDEX

FOLDER = "results"
"""Folder of result files in the directory of a sweep."""

TABLE = "CREATE TABLE IF NOT EXISTS results (run TEXT PRIMARY KEY, content BLOB NOT NULL)"
"""The table of packed results in the index."""

_HEAD = struct.Struct("<8sII")  # signature, checksum of everything after it, length of the JSON
_SIGNATURE = b"fpinrun1"
_KINDS = ("<f8", "<i8", "|i1", "|b1")  # types of the entries of all arrays but texts


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
        """Add a group."""
        return self._add(name, PackedGroup(self._path(name)))

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
        path, _, last = name.rpartition("/")
        group = self[path] if path else self
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
