"""HDF5 files from anywhere: every part is judged before it is read.

A result holds plain groups, arrays and attributes. An HDF5 file can hold more: links to other files, arrays in other
files, and arrays whose size is only claimed. :class:`Group` and :class:`Array` have the part of h5py's interface that
reading needs, as those of packed.py. They refuse everything else with :class:`ValueError`. All reading of HDF5 files
goes through them.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from fastpin.errors import FastpinError, InputError, printable
from fastpin.model.checks import number
from fastpin.storage import packed

AT_ONCE = 1 << 24
"""Most bytes that are read at once, so that Ctrl-C is heard. A smaller array needs no proof of its size."""

MOST_CHUNK = 1 << 26
"""Most bytes of a chunk. A chunk of a result is a row of node values, or what h5py chooses: some 1 MB."""

LARGEST_RATIO = 1032
"""Largest ratio of the bytes of an array to its bytes in the file: deflate makes two bits of 258 bytes.

Zeros that fastpin packs reach 230. Repacked in large chunks, as by ``h5repack``, they reach 1,029.
"""

MOST_TEXTS = 1000
"""Most texts of an array or an attribute. Many of them can share their bytes in the file."""

MOST_ATTRIBUTE = 1 << 24
"""Most bytes of an attribute in the file."""


class Attributes:
    """The attributes of a group or an array."""

    def __init__(self, owner: h5py.Group | h5py.Dataset) -> None:
        self._owner = owner

    def __getitem__(self, name: str) -> Any:
        if name in self._owner.attrs:
            attribute = h5py.h5a.open(self._owner.id, name.encode())
            label = f"the attribute {name} of {self._owner.name}"
            if math.prod(attribute.shape) * attribute.dtype.itemsize > MOST_ATTRIBUTE:
                raise ValueError(f"{label} is too large")
            _check_kind(label, attribute.dtype, math.prod(attribute.shape))
        return self._owner.attrs[name]

    def __contains__(self, name: str) -> bool:
        return name in self._owner.attrs

    def __iter__(self) -> Iterator[str]:
        return iter(self._owner.attrs)

    def __len__(self) -> int:
        return len(self._owner.attrs)

    def get(self, name: str, default: Any = None) -> Any:
        """The value of an attribute, or `default` if there is none of this name."""
        return self[name] if name in self else default  # noqa: SIM401 - this is the method itself

    def items(self) -> Iterator[tuple[str, Any]]:
        """Names and values."""
        yield from ((name, self[name]) for name in self)


class Array:
    """An array of a file, with the interface of ``h5py.Dataset``.

    Raises
    ------
    ValueError
        If the array lies in another file, is packed in an unknown way, has chunks of an absurd size, or claims a size
        that is not in the file.
    """

    def __init__(self, dataset: h5py.Dataset) -> None:
        self._dataset = dataset
        self.name, self.dtype, self.shape = str(dataset.name), dataset.dtype, dataset.shape
        self.attrs = Attributes(dataset)
        label, how = self.name[1:], dataset.id.get_create_plist()
        if how.get_layout() == h5py.h5d.VIRTUAL or how.get_external_count():
            raise ValueError(f"{label} lies in another file, and a result is one file")
        filters = (h5py.h5z.FILTER_DEFLATE, h5py.h5z.FILTER_SHUFFLE, h5py.h5z.FILTER_FLETCHER32)
        if any(how.get_filter(k)[0] not in filters for k in range(how.get_nfilters())):
            raise ValueError(f"{label} is packed in an unknown way")
        if math.prod(self.chunks or ()) * self.dtype.itemsize > MOST_CHUNK:
            raise ValueError(f"{label} has chunks of the shape {self.chunks}, larger than those of any result")
        if self.shape is None:
            raise ValueError(f"{label} is empty")
        _check_kind(label, self.dtype, math.prod(self.shape))
        self._check_size()

    @property
    def ndim(self) -> int:
        """Number of dimensions."""
        return len(self.shape)

    @property
    def maxshape(self) -> tuple[int | None, ...]:
        """Largest numbers of entries in all dimensions; None without a limit."""
        return tuple(self._dataset.maxshape)

    @property
    def chunks(self) -> tuple[int, ...] | None:
        """Shape of a chunk; None without chunks."""
        return self._dataset.chunks

    def __len__(self) -> int:
        if not self.shape:
            raise ValueError(f"{self.name[1:]} is a single number")
        return int(self.shape[0])

    def __getitem__(self, key: Any) -> Any:
        """The entries of a slice of rows, of a row, or all of them for ``()``."""
        row = math.prod(self.shape[1:]) * self.dtype.itemsize
        if not self.shape or not row or not (key == () or isinstance(key, slice)):
            return self._dataset[key]
        rows = range(len(self))[slice(None) if key == () else key]
        if rows.step != 1 or len(rows) * row <= AT_ONCE:
            return self._dataset[key]
        values = np.empty((len(rows), *self.shape[1:]), self.dtype)
        size = max(AT_ONCE // row, 1)
        for first in range(0, len(rows), size):
            part = rows[first : first + size]
            self._dataset.read_direct(values, np.s_[part.start : part.stop], np.s_[first : first + len(part)])
        return values

    def asstr(self) -> Any:
        """The array as texts of Python."""
        return self._dataset.asstr()

    def _check_size(self) -> None:
        """Raise :class:`ValueError` if the entries can't be in the file."""
        size = math.prod(self.shape) * self.dtype.itemsize
        if size <= AT_ONCE:
            return
        stored = min(self._dataset.id.get_storage_size(), self._dataset.file.id.get_filesize())
        if size > LARGEST_RATIO * stored:
            raise ValueError(f"{self.name[1:]} has the shape {self.shape}, and only {stored} bytes in the file")


class Group:
    """A group of a file, with the interface of ``h5py.Group``. A part is judged once, and then kept.

    Raises
    ------
    ValueError
        If a part of the group is a link, or is no group and no array.
    """

    def __init__(self, group: h5py.Group) -> None:
        self._group = group
        self._parts: dict[str, Any] = {}
        self.name = str(group.name)
        self.attrs = Attributes(group)

    def __getitem__(self, path: str) -> Any:
        part: Any = self
        for name in path.split("/"):
            if not isinstance(part, Group):
                raise ValueError(f"{part.name[1:]} is no group")
            part = part._part(name)
        return part

    def __contains__(self, path: str) -> bool:
        name, _, rest = path.partition("/")
        if name not in self._parts and not self._group.id.links.exists(name.encode()):
            return False
        part = self._part(name) if rest else None
        return not rest or (isinstance(part, Group) and rest in part)

    def __iter__(self) -> Iterator[str]:
        return iter(self._group)

    def __len__(self) -> int:
        return len(self._group)

    def get(self, name: str, default: Any = None) -> Any:
        """A part of the group, or `default` if there is none of this name."""
        return self[name] if name in self else default  # noqa: SIM401 - this is the method itself

    def items(self) -> Iterator[tuple[str, Any]]:
        """Names and parts."""
        yield from ((name, self[name]) for name in self)

    def values(self) -> Iterator[Any]:
        """The parts."""
        yield from (self[name] for name in self)

    def _part(self, name: str) -> Any:
        if name not in self._parts:
            self._parts[name] = self._judged(name)
        return self._parts[name]

    def _judged(self, name: str) -> Any:
        label = f"{self.name}/{name}".lstrip("/")
        if name not in self:
            raise ValueError(f"there is no part {label}")
        if self._group.id.links.get_info(name.encode()).type != h5py.h5l.TYPE_HARD:
            raise ValueError(f"{label} is a link, and a result has no links")
        part = self._group[name]
        if isinstance(part, h5py.Dataset):
            return Array(part)
        if isinstance(part, h5py.Group):
            return Group(part)
        raise ValueError(f"{label} is no group and no array")


def _check_kind(label: str, dtype: np.dtype[Any], entries: int) -> None:
    """Raise :class:`ValueError` if entries are no numbers and no texts, or too many texts."""
    if dtype.hasobject and h5py.check_string_dtype(dtype) is None:
        raise ValueError(f"{label} has no numbers and no texts")
    if dtype.hasobject and entries > MOST_TEXTS:
        raise ValueError(f"{label} has {entries} texts, more than any result")


@contextmanager
def reading(path: Path, *arguments: str) -> Iterator[None]:
    """Turn every error of the block, which reads the file `path`, into one sentence.

    An error of one of the `arguments` of the caller stays as it is.

    Raises
    ------
    InputError
        If the block found damaged data, or the data do not fit into memory.
    """
    try:
        yield
    except InputError as error:
        if error.field in (str(path), *arguments):
            raise
        raise InputError(str(path), f"is damaged: {_first_line(error)}") from None
    except FastpinError:
        raise
    except MemoryError as error:
        raise InputError(str(path), f"needs more memory than there is: {_first_line(error)}") from None
    except Exception as error:  # h5py and NumPy raise errors of many kinds.
        raise InputError(str(path), f"is damaged: {_first_line(error)}") from None


def dataset_of(group: h5py.Group, name: str, dtype: type, shape: tuple[int, ...] | None = None) -> h5py.Dataset:
    """Return an array of a group. Its numbers must be of a type, and its rows of a shape.

    Parameters
    ----------
    group : h5py.Group
    name : str
    dtype : type
        Type of the numbers.
    shape : tuple of int, optional
        Shape of a row: of the array without its first dimension.

    Raises
    ------
    ValueError
        If the array is missing, of another type, or of another shape.
    """
    dataset = group.get(name)
    label = f"{group.name}/{name}".strip("/")
    if not isinstance(dataset, (h5py.Dataset, Array, packed.PackedArray)):
        raise ValueError(f"there is no array {label}")
    if dataset.dtype != np.dtype(dtype):
        raise ValueError(f"{label} has numbers of the type {dataset.dtype}, not {np.dtype(dtype)}")
    if shape is not None and (dataset.ndim != len(shape) + 1 or dataset.shape[1:] != shape):
        raise ValueError(f"{label} has shape {dataset.shape}, not (rows, {', '.join(map(str, shape))})")
    return dataset


def text_of(value: Any) -> str:
    """Return a text of a file on one line that can be printed: the file may be anybody's, or of an earlier version."""
    return printable(str(value))


def as_python(value: Any) -> Any:
    """Return a NumPy scalar as a Python number, and a text as :func:`text_of`. Any other value stays as it is."""
    plain = value.item() if isinstance(value, np.generic) else value
    return text_of(plain) if isinstance(plain, str) else plain


def numbers_of(group: h5py.Group) -> dict[str, float]:
    """Return the attributes of a group. :class:`InputError` is raised if one of them is no number."""
    values = {text_of(name): as_python(value) for name, value in group.attrs.items()}
    for name, value in values.items():
        number(name, value)
    return values


def check_finite(label: str, array: np.ndarray) -> None:
    """Raise :class:`ValueError` if an array has a number that is not finite."""
    if not np.isfinite(array).all():
        raise ValueError(f"{label} has a number that is not finite")


def check_between(label: str, array: np.ndarray, least: float, most: float) -> None:
    """Raise :class:`ValueError` if a number of an array is below `least` or above `most`."""
    if array.size and not (array.min() >= least and array.max() <= most):
        raise ValueError(f"{label} has a number outside {least:g} to {most:g}")


def check_extremes(label: str, lowest: np.ndarray, highest: np.ndarray, absent: np.ndarray) -> None:
    """Raise :class:`ValueError` if extremes are not finite, or in the wrong order. `absent`: where there are none."""
    if not np.all(absent | (np.isfinite(lowest) & np.isfinite(highest) & (lowest <= highest))):
        raise ValueError(f"{label} and the highest slip don't fit")


def _first_line(error: BaseException) -> str:
    return text_of((str(error).strip("\"'").splitlines() or [type(error).__name__])[0][:300])
