"""With a thickness every output is in N, N m, J and N m/rad; without one it is per metre.

One case is written twice: with forces in N and a thickness, and with the same forces per thickness. The thickness is a
power of two. So all states have the same bits, and each printed number is either the same or exactly the thickness
times the other.
"""

import csv
import json
import re
from pathlib import Path

import pytest

from fastpin import casefile
from fastpin.assess.outputs import json_ready
from fastpin.cli import options
from fastpin.live.pin import LivePin
from fastpin.live.protocol import Message
from tests.support.tiers import some_survey
from tests.support.unit_walk import MOST_ROWS, PARTS, UNIT, T, Walk, is_times, leaves, walk, words

PER_METRE = re.compile(r"(?<![\w/])[GMkmunpµ]?(N/m|J/m(?![\^²])|N/rad)(?!\w)")
"""Units per thickness. J/m^2 of the friction energy at a place is none."""

IN_ALL = re.compile(r"(?<![\w/])([GMkmunpµ]?(J(?!/m)|N m)|[GMk]N)(?![\w/])")
"""Units with a thickness. A single N is left out: it names the pressure, and is the unit of a moment per thickness."""

WITHOUT_UNITS = {
    "example": "prints a commented case file, with both kinds of units in words",
    "resume": "writes by the function of show",
    "live": "is a server; its messages are walked below",
    "merge": "joins directories, and prints their number of runs",
    "paper": "is dimensionless",
    "verify": "is dimensionless, and says so in its first line",
    "benchmarks": "has problems per thickness",
    "charts": "is dimensionless",
    "joint": "always has thicknesses; its own tests compare text and JSON",
    "completion": "prints a script",
    "identify": "fits for seconds; tests/cli/test_identify.py compares both",
    "schema": "prints the form of documents",
}
"""Commands that are not walked, with a reason each. Every other command must be in :data:`PARTS`."""


def test_every_command_is_walked() -> None:
    known = set(re.findall(r"^    (\w+)(?:  |$)", options.parser().format_help(), re.MULTILINE))
    assert {line.split()[0] for part in PARTS.values() for line in part} | WITHOUT_UNITS.keys() == known


@pytest.mark.gate
@pytest.mark.parametrize("part", some_survey(PARTS, "page", "page of a life"))
def test_every_output_is_with_the_thickness_or_per_metre(part: str, tmp_path: Path) -> None:
    plain, thick = (Walk(tmp_path / name, *words(name == "thick")) for name in ("plain", "thick"))
    for found in (plain, thick):
        with pytest.MonkeyPatch.context() as monkeypatch:
            walk(found, PARTS[part], monkeypatch)
    assert units_in(plain, IN_ALL) == {}
    assert units_in(thick, PER_METRE) == {}
    tables = plain.files(".csv"), thick.files(".csv")
    documents = plain.files(".json"), thick.files(".json")
    if part == "states":
        for name in ("run.json", "show.json"):
            check_summary(*(each[name] for each in documents))
    if part == "study":
        check_study(*(each.pop("converge.csv") for each in tables))
        studied = next(text for name, text in thick.commands.items() if name.startswith("converge"))
        assert re.search(r"corner 2: P = 4\.096 kN, Q = 1\.024 kN, M = [\d.]+ N m, sxx = 2 MPa", studied)
        assert re.search(r"\n +P +kN +4\.096 ", studied)
    if part == "studies":
        check_sweep(*(each.pop("sweep.csv") for each in tables))
        swept = next(text for name, text in thick.commands.items() if "heat.svg" in name)
        assert re.search(r" kN +[mu]J +", swept.splitlines()[2])
        assert " 4.096 " in swept
    assert changed_tables(*tables) == {"loops.csv", "cycles.csv", "wear.csv"} & tables[0].keys()


def units_in(found: Walk, wrong: re.Pattern[str]) -> dict[str, str]:
    """The first wrong unit of each output that has one."""
    return {name: place[0] for name, text in found.texts().items() if (place := wrong.search(text))}


PAIRS = {"N/m": "N", "N": "N m", "J/m": "J", "N/rad": "N m/rad", "m^2": "m^3", "N/m^2": "N per m"}
"""The unit with a thickness for each unit per thickness."""


def factor_of(plain: str, thick: str) -> float:
    """The factor between numbers in two units, which must fit together."""
    assert thick in (plain, PAIRS.get(plain))
    return T if thick != plain else 1.0


def changed_tables(plain: dict[str, str], thick: dict[str, str]) -> set[str]:
    """The tables of figures with numbers that are times the thickness. The others are equal, as the headers say."""
    factors = set()
    for name in plain:
        tables = (list(csv.reader(text[name].splitlines()[:MOST_ROWS])) for text in (plain, thick))
        (head, *rows), (other_head, *others) = tables
        for column, (title, other_title) in enumerate(zip(head, other_head, strict=True)):
            assert UNIT.sub("", title) == UNIT.sub("", other_title)
            units = [found[1] if (found := UNIT.search(each)) else "" for each in (title, other_title)]
            factors.add((name, factor := factor_of(units[0], units[1])))
            for row, other in zip(rows, others, strict=True):
                assert is_times(row[column], other[column], factor), (name, title)
    return {name for name, factor in factors if factor == T}


def check_study(plain: str, thick: str) -> None:
    kinds = set()
    for row, other in zip(csv.DictReader(plain.splitlines()), csv.DictReader(thick.splitlines()), strict=True):
        factor = factor_of(row["unit"], other["unit"])
        kinds |= {row["unit"]} if factor == T else set()
        assert all(is_times(row[name], other[name], factor) for name in ("value", "limit", "bar", "path"))
    assert kinds == {"N/m", "N", "J/m"}


def check_sweep(*texts: str) -> None:
    tables = [text.splitlines() for text in texts]
    plain, thick = (dict(part.rsplit(" ", 1) for part in lines[1][9:].split(", ")) for lines in tables)
    varied = {"heat": ("J/m", "J"), "dissipation": ("J/m", "J"), "largest_Q": ("N/m", "N")}
    assert {name: (plain[name], thick[name]) for name in varied} == varied
    for row, other in zip(*(csv.DictReader(lines[2:]) for lines in tables), strict=True):
        for name in plain.keys() - {"seconds"}:
            assert is_times(row[name], other[name], factor_of(plain[name], thick[name])), name
        assert float(other["load.1.P"]) == T * float(row["load.1.P"])


TIMES = {
    "load": ("P", "Q", "M"), "resultants": ("P", "Q", "M"), "work": ("P", "Q", "M", "sxx"),
    "": ("dissipation", "work", "energy", "pressure_integral", "shear_integral", "shear_magnitude", "hub_stiffness"),
    "error_bars": ("P", "Q", "M", "dissipation", "work", "pressure_integral", "shear_integral", "shear_magnitude"),
    "corners": (0, 1, 2), "2": ("P", "Q", "M"),
}  # fmt: skip
"""Entries of the summaries that are times the thickness, by the entry in which they stand; "" for all others."""


def check_summary(*texts: str) -> None:
    plain, thick = map(json.loads, texts)
    for each in (plain, thick):
        del each["problem"]["thickness"], each["statistics"]
    factors = {kind: factor_of(unit, thick["units"][kind]) for kind, unit in plain.pop("units").items()}
    assert {kind for kind, factor in factors.items() if factor == T} == {
        "force", "moment", "energy", "stiffness", "rig stiffness", "work per stress",
    }  # fmt: skip
    del thick["units"]
    counted = 0
    for (path, value), (other_path, other) in zip(leaves(plain), leaves(thick), strict=True):
        assert path == other_path
        if path[0] == "extremes":
            is_whole = path[-1] == "value" and path[1] in TIMES["error_bars"]  # the same quantities
        else:
            holder = next((key for key in reversed(path[:-1]) if key in TIMES), "")
            is_whole = path[-1] in TIMES[holder]
        counted += is_whole and value not in (0.0, None)
        assert is_times(value, other, T if is_whole else 1.0), path
    assert counted > 50


@pytest.mark.parametrize("thick", [True, False])
def test_the_live_page_names_units_with_their_factors(thick: bool) -> None:
    contact = LivePin(casefile.parse_case(words(thick)[0]), 31)
    contact.obey(Message("load", 1, {"loads": {"Q": 1e5}, "gesture": 1}))
    found = json_ready(contact.recording())
    wrong = PER_METRE if thick else IN_ALL
    assert not [text for _, text in leaves(found) if isinstance(text, str) and len(text) < 100 and wrong.search(text)]
    named = {path[:-1]: name for path, name in leaves(found["case"]) if path[-1] == "name" and "unit" in str(path)}
    factors = {path[:-1]: factor for path, factor in leaves(found["case"]) if path[-1] == "factor"}
    assert factors.keys() == named.keys()
    whole = PAIRS.values() if thick else ()
    assert all(factor == (T if named[path] in whole else 1.0) for path, factor in factors.items())
    assert {"force", "energy"} <= found["case"]["units"].keys()
    case = casefile.parse_case(contact.case_text())
    assert case.problem.thickness == (T if thick else None)
    assert case.history.values()[-1, 1] == 1e5
