"""What is in a folder, and changes of HDF5 files."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py


def contents(folder: Path) -> dict[str, object]:
    """The bytes of every file below a folder, or where a link leads, by name."""
    found: dict[str, object] = {}
    for path in sorted(folder.rglob("*")):
        name = str(path.relative_to(folder))
        found[name] = path.readlink() if path.is_symlink() else path.read_bytes() if path.is_file() else None
    return found


def replaced(name: str, value: Any) -> Callable[[h5py.Group], None]:
    """A change of a group: another array in the place of one."""

    def change(group: h5py.Group) -> None:
        del group[name]
        group[name] = value

    return change


def written(name: str, place: Any, value: float) -> Callable[[h5py.Group], None]:
    """A change of a group: another number in an array."""

    def change(group: h5py.Group) -> None:
        group[name][place] = value

    return change
