"""The loads of a case file: [[load]] blocks or a CSV file."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np

from fastpin import loading
from fastpin.caselines import CaseText, Section, number, string, whole
from fastpin.errors import InputError
from fastpin.loading import LOADS, LoadHistory
from fastpin.problem import Problem

MAX_CORNERS = 1_000_000


def read_history(source: CaseText, folder: Path) -> LoadHistory | None:
    """The load history; None when it can't be used, which is reported. A CSV file is looked for from `folder` on."""
    if "load" in source.root and "history" in source.root:
        source.report("[history]: give either [history] or [[load]] blocks", "history")
        return None
    if "history" in source.root:
        return _from_csv(source.section("history"), folder)
    if "load" in source.root:
        return _from_blocks(source)
    source.report("no loads: [[load]] blocks or a section [history] are missing", "load")
    return None


def check_loads(source: CaseText, problem: Problem, history: LoadHistory) -> None:
    """Report every load that does not go with the problem."""
    # What a corner leaves out is taken from the one before; what was never given stays away.
    columns = history.values(initial=np.full(len(LOADS), np.nan)).T
    for name, column in zip(LOADS, columns, strict=True):
        values = np.unique(column[~np.isnan(column)])
        if len(values):
            try:
                loading.check_loads(problem, LoadHistory({name: value} for value in values))
            except InputError as error:
                _report_load(source, name, str(error))


def _report_load(source: CaseText, name: str, message: str) -> None:
    """Report a load where it acts first, or where it is given as nothing but 0."""
    giving = [block for block in source.blocks("load") if name in block]
    acting = [block for block in giving if block.value(name) != 0]
    if giving:
        (acting or giving)[0].report(message, name)
    else:
        source.report(message, "history", "csv")


def _from_blocks(source: CaseText) -> LoadHistory | None:
    given = source.root.value("load")
    blocks = source.blocks("load")
    if given is None:
        return None
    if not isinstance(given, list) or not given or len(blocks) < len(given):
        source.report("loads are [[load]] blocks, with double brackets", "load")
        return None
    corners: list[dict[str, float]] = []
    for block in blocks:
        rows = _corners(block)
        repeat = block.checked("repeat", whole, 1) or 1
        if len(corners) + len(rows) * repeat > MAX_CORNERS:
            key = "repeat" if "repeat" in block else "load"
            block.report(f"{key}: the history has more than {MAX_CORNERS} corners", key)
            return None
        corners.extend(rows * repeat)
    return LoadHistory(corners) if corners else None


def _corners(block: Section) -> list[dict[str, float]]:
    """The corners of one block."""
    if not set(block.table) - {"repeat"}:
        block.report(f"[[load]]: gives no load; the loads are {', '.join(LOADS)}")
    columns = {name: column for name in LOADS if (column := _numbers(block, name)) is not None}
    lengths = {name: len(column) for name, column in columns.items() if isinstance(column, list)}
    for name, length in lengths.items():
        first = next(iter(lengths))
        if length != lengths[first]:
            counts = f"{first} has {lengths[first]} values and {name} {length}"
            block.report(f"{name}: lists in one block must be equally long, {counts}", name)
            return []
    return [
        {name: column[index] if isinstance(column, list) else column for name, column in columns.items()}
        for index in range(max(lengths.values(), default=1))
    ]


def _numbers(block: Section, name: str) -> list[float] | float | None:
    """The number or numbers of one load in one block."""
    value = block.value(name)
    if not isinstance(value, list):
        return block.number(name)
    if not value:
        block.report(f"{name}: must be a number or a list of numbers, not an empty list", name)
    numbers = []
    for index, item in enumerate(value, start=1):
        try:
            numbers.append(number(f"value {index} of {name}", item))
        except InputError as error:
            block.report(str(error), name)
    return numbers if numbers and len(numbers) == len(value) else None


def _from_csv(section: Section, folder: Path) -> LoadHistory | None:
    if not section.present:
        return None
    repeat = section.checked("repeat", whole, 1) or 1
    section.require("csv")
    name = section.checked("csv", string)
    if name is None:
        return None
    try:
        history = LoadHistory.from_csv(folder / name)
    except InputError as error:
        section.report(f"csv: {error.reason}", "csv")
        return None
    except (csv.Error, ValueError) as error:
        section.report(f"csv: can't read {name!r}: {error}", "csv")
        return None
    if len(history) * repeat > MAX_CORNERS:
        section.report(f"repeat: the history has more than {MAX_CORNERS} corners", "repeat")
        return None
    return history.repeated(repeat)
