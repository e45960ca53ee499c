"""Outputs of a case in a system of units are those of the same case in SI units, converted.

The case is written anew with numbers that are read as the same ones, so all states have the same bits.
"""

import csv
import itertools
import json
import math
import re
from pathlib import Path
from typing import Any

import pytest

from fastpin.model.unit_systems import SI
from fastpin.model.units import measures_of
from tests.support.tiers import some_survey
from tests.support.unit_cases import CASES
from tests.support.unit_walk import MOST_ROWS, PARTS, UNIT, Walk, cases_in, leaves, line_in, walk, words

SYSTEMS = ("in, lbf, ksi", "mm, N, MPa")

SURVEYED = [*zip(CASES, itertools.cycle(SYSTEMS), strict=False)]
"""Cases in one of the systems, by turns: the gate has them in the other one."""

WALKED = "cm, kN, GPa"
"""A system of powers of ten: the states are the same ones to the last bit."""

IN_SI = {
    WALKED: re.compile(
        r"(?<![\w/=])(?<!curve )([Mkmunpµ]?Pa|[GMkmunpµ]?m|[GMmunpµ]N|[GMkmunpµ]?J)(?![\w/*=^]| =|'|\")"
    ),
    "in, lbf, ksi": re.compile(r"(?<![\w/=])(?<!curve )([GMkmunpµ]?(Pa|J|m)|[GMk]N|N m|N/m)(?![\w/*=^]| =|'|\")"),
    "mm, N, MPa": re.compile(r"(?<![\w/])([Gkmunpµ]?Pa|[GMkunpµ]m|[GMkmunpµ]N|[GMkmunpµ]?J)(?![\w/*=^]| =)"),
}
"""Units that a system of units does not have. N and T name tractions, and m an exponent."""


def factors(system: str, whole: bool) -> dict[tuple[str, str], float]:
    """The factor from each unit in SI to that of the system, by their names."""
    old, new = measures_of(SI, whole), measures_of(system, whole)
    return {(old[kind].name, new[kind].name): new[kind].per_si for kind in old}


def pair(folder: Path, system: str, case: str, plan: str = "", thick: bool = True) -> tuple[Walk, Walk]:
    force = measures_of(system, thick)["force"]
    given = re.sub(r"(?<=load\.1\.P = \[)([\d.e]+), ([\d.e]+)", lambda each: ", ".join(
        repr(force.given(float(number))) for number in each.groups()), plan)  # fmt: skip
    plain, changed = cases_in(case, system)
    return Walk(folder / "si", plain, plan), Walk(folder / "system", changed, given, system)


def run_both(walks: tuple[Walk, Walk], lines: list[str]) -> None:
    for found in walks:
        with pytest.MonkeyPatch.context() as monkeypatch:
            walk(found, [line_in(line, found.system) if found.system != SI else line for line in lines], monkeypatch)


@pytest.mark.gate
@pytest.mark.parametrize("part", some_survey(PARTS, "page", "page of a life"))
def test_every_output_is_in_the_units_of_the_case(part: str, tmp_path: Path) -> None:
    (case, plan), system = words(True), WALKED
    walks = plain, given = pair(tmp_path, system, case, plan)
    run_both(walks, [line for line in PARTS[part] if line != "compliance --example"])  # a lug file in SI units
    check(plain, given, factors(system, True))


@pytest.mark.gate
@pytest.mark.parametrize(("name", "system"), some_survey(itertools.product(CASES, SYSTEMS), *SURVEYED))
def test_cases_of_all_kinds_agree_in_all_units(name: str, system: str, tmp_path: Path) -> None:
    case, lines = CASES[name]
    walks = plain, given = pair(tmp_path, system, case)
    run_both(walks, lines)
    check(plain, given, factors(system, "thickness" in case))


def check(plain: Walk, given: Walk, by_name: dict[tuple[str, str], float]) -> None:
    wrong = {name: place[0] for name, text in given.texts().items() if (place := IN_SI[given.system].search(text))}
    assert not wrong
    tables = plain.files(".csv"), given.files(".csv")
    assert tables[0].keys() == tables[1].keys()
    for name in tables[0]:
        check_table(name, tables[0][name], tables[1][name], by_name)
    documents = plain.files(".json"), given.files(".json")
    for name in documents[0]:
        check_document(json.loads(documents[0][name]), json.loads(documents[1][name]), by_name)
    for line, text in plain.commands.items():
        check_text(text, given.commands[line_in(line, given.system)], by_name)


def check_table(name: str, text: str, other: str, by_name: dict[tuple[str, str], float]) -> None:
    """Check a table whose units stand in its header, in a comment line, or in a column."""
    lines, others = (each.splitlines()[: MOST_ROWS + 3] for each in (text, other))
    units: list[dict[str, str]] = [{}, {}]
    for k, each in enumerate((lines, others)):
        while each[0].startswith("#"):
            words = each.pop(0).removeprefix("# units: ")
            units[k] |= dict(part.split(" ", 1) for part in re.split(r", (?=\w[\w.]* )", words) if " " in part)
    (head, *rows), (other_head, *other_rows) = csv.reader(lines), csv.reader(others)
    assert len(rows) == len(other_rows)
    for place, (title, other_title) in enumerate(zip(head, other_head, strict=True)):
        assert UNIT.sub("", title) == UNIT.sub("", other_title)
        named = [found[1] if (found := UNIT.search(each)) else "" for each in (title, other_title)]
        if units[0]:
            named = [each.get(title, "") for each in units]
        size = max((abs(float(row[place])) for row in other_rows if is_number(row[place])), default=0.0)
        for row, other_row in zip(rows, other_rows, strict=True):
            if "unit" in head and title in ("value", "limit", "bar", "path"):
                named = [row[head.index("unit")], other_row[head.index("unit")]]
            factor = 1.0 if named[0] == named[1] else by_name[named[0], named[1]]
            if title != "seconds" and is_number(row[place]):
                least = 0.0 if "unit" in head else 1e-9 * size  # rounding
                assert is_close(float(row[place]), float(other_row[place]), factor, 1e-8, least), (name, title)


def is_number(cell: str) -> bool:
    try:
        return math.isfinite(float(cell))
    except ValueError:
        return False


def is_close(value: float, other: float, factor: float, tolerance: float, least: float = 0.0) -> bool:
    return abs(other - factor * value) <= tolerance * abs(other) + least


def check_document(plain: Any, given: Any, by_name: dict[tuple[str, str], float]) -> None:
    """Check that each number is the same or converted, and that all numbers of one key are alike."""
    known: dict[str, set[float]] = {}
    for (path, value), (other_path, other) in zip(leaves(plain), leaves(given), strict=True):
        assert path == other_path
        if not isinstance(value, (int, float)) or isinstance(value, bool) or "statistics" in path:
            continue
        if abs(value) < 1e-12:  # rounding
            continue
        if str(path[-1]).endswith("angle"):
            assert other == pytest.approx(value, rel=1e-11, abs=1e-9)
            continue
        ratio = next((f for f in (1.0, *by_name.values()) if is_close(value, other, f, 1e-11)), None)
        assert ratio is not None or path[-1] == "seconds", (path, value, other)
        if ratio is not None:
            known.setdefault(".".join(part for part in path if isinstance(part, str)), set()).add(ratio)
    same = {name for name, ratios in known.items() if 1.0 in ratios}
    works = {"energy", "dissipation", "work"} if by_name.get(("J/m", "N mm/mm")) == 1.0 else set()
    wrong = {name for name in same if DIMENSIONAL.search(name) and name.rpartition(".")[2] not in works}
    assert not wrong


DIMENSIONAL = re.compile(
    r"(pressure|stress|energy|dissipation|work|radius|clearance|depth|\bE|strength|beta_star|slip_range|slip_distance|traction|force)$"
)
"""Ends of the names of numbers that must not be the same in all units."""

NUMBER_WITH_UNIT = re.compile(
    r"(?<![\w.])([+-]?\d[\d,]*\.?\d*(?:e[+-]?\d+)?) ([A-Za-zµ1][\w/^]*)(?![\w/^])(?! per| m\b| mm\b| in\b)"
)


def check_text(text: str, other: str, by_name: dict[tuple[str, str], float]) -> None:
    """Check the numbers that have a unit behind them. Where both texts have as many, they belong together."""
    ends = {old: (new, factor) for (old, new), factor in by_name.items() if old}
    news = {new for new, _ in ends.values()}
    pairs = [(one, stem) for one in NUMBER_WITH_UNIT.finditer(text) if (stem := stem_of(one[2], ends))]
    others = [two for two in NUMBER_WITH_UNIT.finditer(other) if two[2] in news]
    for (one, stem), two in zip(pairs, others, strict=False) if len(pairs) == len(others) else ():
        power = {"G": 9, "M": 6, "k": 3, "m": -3, "u": -6, "µ": -6, "n": -9, "p": -12}.get(one[2].removesuffix(stem), 0)
        value, changed = (float(each[1].replace(",", "")) for each in (one, two))
        if two[2] == ends[stem][0]:
            assert is_close(value * 10.0**power, changed, ends[stem][1], 2e-2), (one[0], two[0])


def stem_of(unit: str, known: dict[str, tuple[str, float]]) -> str:
    """A unit without its prefix; empty if it is unknown."""
    return next((name for name in (unit, unit[1:]) if name in known), "")
