"""The loads of a case file: [[load]] blocks or a CSV file."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from fastpin.casefile.toml_text import CaseText, Section
from fastpin.errors import CaseFileError, InputError
from fastpin.model import LOADS, Problem
from fastpin.model.acting import check_friction_changes, check_largest, check_loads
from fastpin.model.checks import any_text, as_toml, number, true_or_false, whole_number
from fastpin.model.history import MAX_CORNERS, MOST_POINTS, LoadHistory
from fastpin.model.recorded import turning_corners
from fastpin.tables.columns import COLUMN_KEYS, COUNT, ColumnChoice, column_choice
from fastpin.tables.files import MAX_ROWS, history_from_csv
from fastpin.tables.load_units import Basis

MOST_BLOCKS = 10_000
"""Most [[load]] blocks. A block can hold any number of corners."""

HARMONIC = ("mean", "amplitude", "phase", "points")
"""Keys of a [[load]] block with harmonic cycles, besides ``repeat``."""


def read_history(source: CaseText, folder: Path) -> LoadHistory | None:
    """Read the load history of a case file.

    Parameters
    ----------
    source : CaseText
        The text of the case file. All faults of the loads are reported to it.
    folder : Path
        Folder in which relative paths of CSV files start.

    Returns
    -------
    LoadHistory or None
        None if the history can't be used. The reason is reported.
    """
    section, contact = source.section("history"), source.root.value("contact")
    given = contact if isinstance(contact, dict) else {}
    basis = Basis("with thickness" if "thickness" in given else "per metre", source.units)
    if "load_parameter" in given:
        basis = Basis("dimensionless")
    if "load" in source.root and "csv" in section:
        source.report("[history]: give either csv or [[load]] blocks", "history", "csv")
        return None
    if "load" in source.root:
        history = _from_blocks(source, folder, basis)
    elif section.present:
        section.require("csv")
        history = _from_csv(section, folder, basis)
    else:
        source.report("no loads: [[load]] blocks or a section [history] are missing", "load")
        return None
    whole = _repeat(section, history)
    if whole is not None and len(whole) > MAX_CORNERS:
        source.report(f"the history has {len(whole):,} corners, more than {MAX_CORNERS:,}", "load")
        return None
    return whole


def report_loads(source: CaseText, problem: Problem, history: LoadHistory) -> None:
    """Report every load of the history that the problem does not allow."""
    try:
        check_loads(problem, history)
        return
    except InputError:  # only the first of the faults
        pass
    for name, value in history.largest.items():
        try:
            check_largest(problem, {name: value})
        except InputError as error:
            _report_load(source, name, str(error))
    try:
        check_friction_changes(problem, history)
    except InputError as error:
        _report_load(source, error.field, str(error))


def _report_load(source: CaseText, name: str, message: str) -> None:
    """Report a load at the first block in which it is not 0. If it is 0 everywhere, report it at its first block."""
    giving = [block for block in source.blocks("load") if name in block]
    acting = [block for block in giving if block.value(name) != 0]
    if giving:
        (acting or giving)[0].report(message, name)
    else:
        source.report(message, "history", "csv")


def _from_blocks(source: CaseText, folder: Path, basis: Basis) -> LoadHistory | None:
    given = source.root.value("load")
    blocks = source.blocks("load")
    if given is None:
        return None
    if not isinstance(given, list) or not given or len(blocks) < len(given):
        source.report("loads are [[load]] blocks, with double brackets", "load")
        return None
    if len(blocks) > MOST_BLOCKS:
        source.report(
            f"{len(blocks):,} [[load]] blocks are more than {MOST_BLOCKS:,}; take lists of loads, or csv", "load"
        )
        return None
    histories = [_from_block(block, folder, basis) for block in blocks]
    whole = [block for history in histories if history is not None for block in history.blocks]
    return LoadHistory.of_blocks(whole) if whole else None


def _from_block(block: Section, folder: Path, basis: Basis) -> LoadHistory | None:
    """The history of one block: listed corners, the corners of a CSV file, or harmonic cycles."""
    if "csv" in block:
        for name in HARMONIC:
            if name in block:
                block.report(f"{name}: can't be given together with csv", name)
        return _repeat(block, _from_csv(block, folder, basis))
    if "amplitude" in block:
        for name in LOADS:
            if name in block:
                block.report(f"{name}: can't be given together with amplitude; write mean = {{{name} = ...}}", name)
        return _harmonic(block)
    for name in (COUNT, "skip"):
        if name in block:
            block.report(f'{name}: needs a CSV file, such as csv = "rig.csv"', name)
    for name in HARMONIC:
        if name in block:
            block.report(f"{name}: needs an amplitude, such as amplitude = {{Q = 1e5}}", name)
    rows = _corners(block)
    return None if rows is None else _repeat(block, LoadHistory.from_array(rows))


def _repeat(section: Section, history: LoadHistory | None) -> LoadHistory | None:
    """The history repeated as the key ``repeat`` of its section says. Each repeat is a cycle.

    None if the result has too many corners, which is reported, or if `history` is None.
    """
    count = section.checked("repeat", whole_number, 1)
    if count is None or history is None:
        return history
    if len(history) > MAX_ROWS and len(history) * count <= MAX_CORNERS:  # beyond both limits the second is reported
        section.report(f"repeat: more than {MAX_ROWS:,} corners can't be repeated", "repeat")
        return None
    return section.made(lambda: history.repeated(count), "repeat")


def _harmonic(block: Section) -> LoadHistory | None:
    tables = {name: _loads(block, name) for name in ("mean", "amplitude", "phase")}
    points = block.checked("points", whole_number, 2, MOST_POINTS)
    count = block.checked("repeat", whole_number, 1) or 1
    mean, amplitude, phase = tables.values()
    if mean is None or amplitude is None or phase is None:
        return None
    try:
        return LoadHistory.harmonic(mean, amplitude, phase, count, points)
    except InputError as error:
        key = "repeat" if error.field == "count" else error.field
        block.report(f"{key}: {error.reason}", key)
        return None


def _loads(block: Section, name: str) -> dict[str, float] | None:
    """A table of loads like ``mean = {P = 1e6, Q = 0}``. Faults are reported, and the result is then None."""
    table = block.value(name)
    if table is None:
        return {}
    if not isinstance(table, dict):
        block.report(f"{name}: must be a table of loads, such as {name} = {{Q = 1e5}}, not {as_toml(table)}", name)
        return None
    loads = {}
    for load, value in table.items():
        try:
            loads[load] = number(f"{name}.{load}", value)
        except InputError as error:
            block.report(str(error), name)
    return loads if len(loads) == len(table) else None


def _corners(block: Section) -> np.ndarray | None:
    """The corners of one block, shape (corners, loads), NaN where left out. None if they have faults (reported)."""
    if not block.means(*LOADS, *HARMONIC):
        block.report(f"[[load]]: gives no load; the loads are {', '.join(LOADS)}")
    columns = {name: column for name in LOADS if (column := _numbers(block, name)) is not None}
    lengths = {name: len(column) for name, column in columns.items() if isinstance(column, list)}
    for name, length in lengths.items():
        first = next(iter(lengths))
        if length != lengths[first]:
            counts = f"{first} has {lengths[first]} values and {name} {length}"
            block.report(f"{name}: lists in one block must be equally long, {counts}", name)
            return None
    corners = np.full((max(lengths.values(), default=1), len(LOADS)), np.nan)
    for name, column in columns.items():
        corners[:, LOADS.index(name)] = column
    return corners


def _numbers(block: Section, name: str) -> list[float] | float | None:
    """The number or the list of numbers of one load in one block. None if it is missing or wrong (reported)."""
    value = block.value(name)
    if isinstance(value, dict) and set(value) & set(COLUMN_KEYS):
        block.report(f'{name}: a column needs the file of the block, such as csv = "rig.csv"', name)
        return None
    if not isinstance(value, list):
        return block.number(name)
    if not value:
        block.report(f"{name}: must be a number or a list of numbers, not an empty list", name)
    numbers = []
    for index, item in enumerate(value, start=1):
        try:
            numbers.append(number("", item))
        except InputError as error:
            block.report(f"value {index} of {name}: {error.reason}", name)
    return numbers if numbers and len(numbers) == len(value) else None


def _from_csv(section: Section, folder: Path, basis: Basis) -> LoadHistory | None:
    """The corners of a CSV file. The loads of the section, if it has any, are tables that name their columns."""
    name = section.checked("csv", any_text)
    choices = {load: _column(section, load) for load in (*LOADS, COUNT) if load in section}
    known = {load: choice for load, choice in choices.items() if choice is not None}
    skip = section.checked("skip", whole_number, 0) if "skip" in section else 0
    if name is None or skip is None or len(known) < len(choices):
        return None
    try:
        history = history_from_csv(folder / name, known or None, basis, skip)
        return turning_corners(history) if section.checked("turning_points", true_or_false) else history
    except CaseFileError as error:
        for line, sentence in error.problems:
            section.report(f"csv: {name}{f', line {line}' if line else ''}: {sentence}", "csv")
    except InputError as error:
        section.report(str(error), error.field)
    return None


def _column(section: Section, load: str) -> ColumnChoice | None:
    """The column that a load is read from. None if it has a fault, which is reported."""
    given = section.value(load)
    try:
        return None if given is None else column_choice(load, given)
    except InputError as error:
        section.report(str(error), *error.field.split("."))
        return None
