"""Files with materials of the user: a section for each material, by its name."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

from fastpin.casefile.materials import read_material
from fastpin.casefile.toml_text import CaseText, Section, parse_text, read_text, written
from fastpin.errors import CaseFileError, printable
from fastpin.model.checks import any_text, as_toml, file_path, string
from fastpin.model.materials import MATERIALS, Material
from fastpin.model.synonyms import closest

FILE_KEYS = ("E", "nu", "yield_strength", "fatigue", "source")
"""Keys of a material."""


def read_materials(path: str | Path) -> dict[str, Material]:
    """Read the materials of a TOML file.

    Parameters
    ----------
    path : str or Path
        The file. Each section is a material, with the keys `E`, `nu`, and perhaps `yield_strength`, `fatigue` and
        `source`::

            [my-alloy]
            E = 71e9
            nu = 0.33
            yield_strength = 345e6
            source = "certificate 123"

    Returns
    -------
    dict of str to Material
        The materials by name.

    Raises
    ------
    CaseFileError, InputError
        See :func:`fastpin.read_case`.
    """
    path = file_path("path", path)
    return parse_text(read_text(path), str(path), "file of materials", _materials)


def known_materials(source: CaseText, folder: Path) -> Mapping[str, Material]:
    """Return all materials that a case knows by name: those of fastpin, and those of the file of its key `materials`.

    A relative path starts in `folder`. Faults of the file are reported on the line of the key.
    """
    name = source.root.checked("materials", any_text)
    if name is None:
        return MATERIALS
    try:
        return MATERIALS | _read(folder / name)
    except CaseFileError as error:
        for line, sentence in error.problems:
            source.report(f"materials: {name}{f', line {line}' if line else ''}: {sentence}", "materials")
        return MATERIALS | dict.fromkeys(_names(folder / name), MATERIALS["steel"])  # the rest is checked


def _names(path: Path) -> list[str]:
    """Return the names of the materials of a file with faults; none if it can't be read."""
    try:
        return [*CaseText(read_text(path)).root.table]
    except CaseFileError:
        return []


def _read(path: Path) -> dict[str, Material]:
    """Read materials, unless the same file was read before and has not changed since."""
    try:
        status = path.stat()
    except OSError:  # the file can't be read; the reader says why
        return read_materials(path)
    return _remembered(path, status.st_mtime_ns, status.st_size)


@functools.lru_cache(maxsize=8)  # the points of a sweep share one file
def _remembered(path: Path, changed: int, size: int) -> dict[str, Material]:
    return read_materials(path)


def _materials(source: CaseText) -> dict[str, Material]:
    found = {}
    if not source.root.table and not source.faults:
        source.report("no materials: a material is a section, such as [my-alloy], with E and nu")
    for name, table in source.root.table.items():
        if not isinstance(table, dict):
            source.report(
                f"{name}: must be a section [{name}] with E and nu, not {written(name, table) or as_toml(table)}", name
            )
            continue
        if name in MATERIALS:
            source.report(f"[{name}]: is a material of fastpin; choose another name", name)
        section = Section(source, (name,), table)
        if printable(name) != name:
            section.report(f"[{name}]: the name of a material must be one line of printable characters")
            continue
        for key in table:
            if key not in FILE_KEYS:
                hint = closest(key, FILE_KEYS) or f"; the keys are {', '.join(FILE_KEYS)}"
                section.report(f'unknown key "{key}" in [{name}]{hint}', key)
        section.checked("source", string)
        by_name = "material" in section or "rigid" in section  # such a key is reported already
        material = None if by_name else read_material(source, section, {}, may_be_rigid=False)
        if material is not None:
            found[name] = replace(material, name=name)
    return found
