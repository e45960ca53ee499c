"""Damaged files: one sentence in place of the errors of h5py and NumPy, and checks of stored arrays."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from fastpin.errors import FastpinError, InputError, printable
from fastpin.model.checks import number
from fastpin.storage import hdf5, packed


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
    if not isinstance(dataset, (h5py.Dataset, hdf5.Array, packed.PackedArray)):
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
