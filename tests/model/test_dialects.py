"""One load history in many dialects of CSV files: rigs, spreadsheets, testers. All have the same corners to the bit."""

from decimal import Decimal
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import fastpin
from fastpin import CaseFileError, LoadHistory
from fastpin.model import LOADS, Profile
from tests.support.refusals import refused

RNG = np.random.default_rng(7)
LEVELS = [
    Decimal(int(level)).scaleb(-int(digits)) for level, digits in RNG.integers([-9_000_000, 0], [9_000_000, 5], (90, 2))
]
TRUTH = [float(level) for level in LEVELS]
PREAMBLE = ["Station Name:\tlug; 7", "Prüfkörper 3, Kraft in µN", "", "# a comment", "Data Acquisition: Timed"]


def written(rng: np.random.Generator, folder: Path) -> tuple[Path, dict[str, Any], int, str]:
    """The history in a dialect at random: the file, the columns, the lines to skip, and the dialect in words."""
    separator = str(rng.choice([",", ";", "\t", "  ", " "]))
    comma, kilo, quoted, upright = (bool(rng.random() < share) for share in (0.4, 0.5, 0.3, 0.5))
    head = str(rng.choice(["title", "title and unit", "units below", "none"]))
    before, encoding = int(rng.integers(3)), str(rng.choice(["utf-8", "utf-8-sig", "cp1252", "utf-16"]))
    quoted = quoted or (comma and separator == ",")  # a decimal comma would separate cells
    excel = rng.random() < 0.2 and bool(separator.strip(" "))
    unit, place = "kN" if kilo else "N", int(rng.integers(3))

    def row(force: str, others: list[str]) -> str:
        cells = [*others[:place], force, *others[place:]]
        return separator.join(f'"{cell}"' if quoted else cell for cell in cells)

    def number(value: Decimal) -> str:
        text = f"{value.scaleb(-3) if kilo else value:{'f' if upright else 'e'}}"
        return text.replace(".", ",") if comma else text

    heads = {
        "title": ["Force"],
        "title and unit": [f"Force [{unit}]"],
        "units below": ["Force", f"({unit})"],
        "none": [],
    }
    lines = ["7 9"] * (before == 2) + PREAMBLE * (before > 0)
    lines += [row(cell, ["Time", "Weg"]) for cell in heads[head][:1]]
    lines += [row(cell, ["s", "mm"]) for cell in heads[head][1:]]
    lines += [row(number(level), [f"0{',' if comma else '.'}{k:03d}", "12"]) for k, level in enumerate(LEVELS)]
    lines = [f"sep={separator}"] * excel + lines
    path = folder / "rig.csv"
    path.write_bytes(str(rng.choice(["\n", "\r\n"])).join([*lines, ""]).encode(encoding))
    column: dict[str, Any] = {"column": place + 1 if head == "none" else "Force"}
    if head in ("title", "none"):
        column["unit"] = unit
    skip = len(PREAMBLE) + 1 + excel if before == 2 else 0
    return (
        path,
        {"P": column},
        skip,
        f"{separator!r} {comma=} {kilo=} {quoted=} {upright=} {head=} {before=} {encoding=} {excel=}",
    )


@pytest.mark.parametrize("seed", range(60))
def test_the_same_corners_to_the_bit(seed: int, tmp_path: Path) -> None:
    path, columns, skip, words = written(np.random.default_rng(seed), tmp_path)
    assert LoadHistory.from_csv(path, columns, 1.0, skip).values()[:, 0].tolist() == TRUTH, words


def corners(folder: Path, text: str, columns: Any = None, **options: Any) -> dict[str, list[float]]:
    """The loads of a file of this text, by name; without loads that are 0 everywhere."""
    (folder / "rig.csv").write_text(text, encoding="utf-8", newline="")
    values = LoadHistory.from_csv(folder / "rig.csv", columns, **options).values()
    return {name: values[:, place].tolist() for place, name in enumerate(LOADS) if values[:, place].any()}


ONE, TWO = {"P": {"column": 1}}, {"P": {"column": 2}}


@pytest.mark.parametrize(
    ("text", "columns", "found"),
    [
        ("12\n25\n", {"P": {"column": 1, "scale": 500}}, [6000, 12500]),
        ("F [kN/m]\n12\n", ONE, [12e3]),
        ("F\nkN/m\n12\n", ONE, [12e3]),
        ("2026-01-02 03:04:05,1.5\n2026-01-02 03:04:06,2\n", TWO, [1.5, 2]),
        ("1,5 2,5\n3,5 4,5\n", ONE, [1.5, 3.5]),
        ("sep=,\n1,5\n2,5\n", ONE, [1, 2]),
        ("SEP=;\n1,5;5\n2,5;5\n", ONE, [1.5, 2.5]),
        ("level 1\nblock 2\n1\n2\n", ONE, [1, 2]),
        ("Time [s]  Axial Force [N/m]\n0  1\n", {"P": "Axial Force"}, [1]),
        ("Time [s] Force [N/m]\n0 1\n", {"P": "Force"}, [1]),
        ('P,Q\n"1,234,567.5",0\n"1,000",0\n', None, [1234567.5, 1000]),
        ('P,Q\n"1,5",0\n"1,234",0\n', None, [1.5, 1.234]),
        ('P,Q\n"1,234",0\n0.5,0\n', None, [1234, 0.5]),
        ("P;Q\r1,5;0\r", None, [1.5]),
        ("date;8\nP;Q\n1;0\n", None, [1]),
        ("16\nP;Q\n1;0\n", None, [1]),
        ("F  S\nN/m  N/m\n1  0\n", ONE, [1]),
        ("F [N/m]  S [kN/m]\n1  0\n", ONE, [1]),
    ],
)
def test_files_as_they_are(text: str, columns: Any, found: list[float], tmp_path: Path) -> None:
    assert corners(tmp_path, text, columns) == {"P": found}


def test_pairs_and_counts(tmp_path: Path) -> None:
    columns = {"P": {"column": ["max", "min"], "scale": 10}, "Q": "Q", "count": "n"}
    text = "max;min;Q;n\n3;1;7;2\n5;;8;1e0\n"
    assert corners(tmp_path, text, columns) == {"P": [30, 10, 30, 10, 50, 50], "Q": [7, 7, 7, 7, 8, 8]}
    history = LoadHistory.from_csv(tmp_path / "rig.csv", columns)
    assert [(block.count, block.cycle) for block in history.blocks] == [(2, True), (1, True)]
    assert corners(tmp_path, "3 1\n5 2\n", {"P": {"column": [1, 2]}}) == {"P": [3, 1, 5, 2]}
    del columns["Q"]
    text = "max;min;n\n3;1;2\n"
    assert corners(tmp_path, text, columns) == {"P": [30, 10, 30, 10]}
    (tmp_path / "case.toml").write_text(CASE)
    assert fastpin.read_case(tmp_path / "case.toml").history.values()[:, 0].tolist() == [30, 10, 30, 10]
    words = refused(corners, tmp_path, "P,n\n1,2\n", {"P": "P", "count": "n"})
    assert str(words) == 'count: needs a load with two columns, such as P = { column = ["max", "min"] }'


CASE = """pin.material = "steel"
plate.material = "steel"
contact = { hole_radius = 10e-3, clearance = 20e-6, friction = 0.2 }
[[load]]
csv = "rig.csv"
P = { column = ["max", "min"], scale = 10 }
count = { column = 3 }
"""


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ("skip = -1", "line 8: skip: must be a whole number of at least 0, not -1"),
        ("skip = 1", "line 5: csv: rig.csv, line 2: the first line must name the columns, and not begin with #;"),
        ("skip = 2", "line 5: csv: rig.csv: holds no load corners"),
    ],
)
def test_skip_in_a_case_file(change: str, words: str, tmp_path: Path) -> None:
    (tmp_path / "rig.csv").write_text("max;min;n\n3;1;2\n")
    (tmp_path / "case.toml").write_text(f"{CASE}{change}\n")
    with pytest.raises(CaseFileError) as caught:
        fastpin.read_case(tmp_path / "case.toml")
    assert words in str(caught.value)


@pytest.mark.parametrize(
    ("text", "columns", "words"),
    [
        ("5,0\n6,1\n", {"P": "Q"}, "line 1: the first line must name the columns, and not begin with #; columns"),
        ("5,0\n6,1\n", ONE, "line 1: the comma may separate columns or be a decimal comma; write a first line"),
        ("5;0\n6;1\n", {"P": {"column": 3}}, "line 1: P: the file has 2 columns, and no column 3"),
        ("5;0\nx;1\n", ONE, 'line 2: P: must be a number, not "x" (column 1)'),
        ("5;0\n7\n", ONE, "line 2: the line has 1 cell, the first row has 2"),
        ("run 7\nTime;Force\ns;N/m\n0;1\n", {"P": "Forze"}, 'line 2: P: the file has no column "Forze"; its '
         'columns are "Time", "Force", did you mean "Force"?'),
        ("Time Load\n0 1\n", {"P": "Laod"}, 'its columns are "Time", "Load", did you mean "Load"?'),
        ('P,Q\n"1,234",0\n', None, "line 2: the comma of each number may be a decimal comma or separate thousands;"),
        ('P,Q\n"1,234.5",0\n"1,5",0\n', None, "line 3: a number has a decimal comma, and one in line 2 a decimal"),
        ("max;min;n\n1;0;2.5\n", {"P": {"column": ["max", "min"]}, "count": "n"},
         'line 2: count: must be a whole number, not 2.5 (column "n")'),
        ("max;min;n\n1;0;\n", {"P": {"column": ["max", "min"]}, "count": "n"},
         'line 2: count: must be a number, not ""'),
        ("time,P\n1,2\n", None, 'a [[load]] block with P = "P" reads this column and no other'),
    ],
)  # fmt: skip
def test_faults_name_the_line_and_the_key(text: str, columns: Any, words: str, tmp_path: Path) -> None:
    with pytest.raises(CaseFileError) as caught:
        corners(tmp_path, text, columns)
    assert words in str(caught.value)


ROUND = {
    "plain": ("angle [deg];gap [um]\n", "{0};{1}", None),
    "units below": ("Winkel\tSpalt\n(deg)\t(um)\n", "{0}\t{1}", None),
    "preamble": ("Tester 7\nFilter;15\nangle;gap\ndeg;um\n", "{0};{1}", None),
    "columns": ("Nr;phi;R [um]\n", "7;{0};-{1}", {"angles": "phi", "values": {"column": "R", "scale": -1}}),
    "no header": ("", "{0} {1} 7", {"angles": {"column": 1}, "values": {"column": 2, "unit": "um"}}),
}


@pytest.mark.parametrize("kind", ROUND)
def test_profiles_have_the_same_dialects(kind: str, tmp_path: Path) -> None:
    head, row, columns = ROUND[kind]
    path = tmp_path / "round.csv"
    path.write_text(head + "".join(row.format(angle, 4 + angle % 4) + "\n" for angle in range(0, 360, 30)))
    degrees = np.arange(0.0, 360.0, 30.0)
    expected = Profile.samples(np.radians(degrees) - np.pi / 2, (4.0 + degrees % 4) * 1e-6)
    found = Profile.from_csv(path, columns=columns)
    assert found.at(np.arange(12.0), 1.0) == pytest.approx(expected.at(np.arange(12.0), 1.0), rel=1e-13)
    keys = (
        ""
        if columns is None
        else "".join(
            f", {name} = {{ {', '.join(f'{key} = {value!r}' for key, value in given.items())} }}"
            for name, given in ((name, {"column": g} if isinstance(g, str) else g) for name, g in columns.items())
        )
    )
    (tmp_path / "case.toml").write_text(
        f'{CASE.partition("[[")[0]}gap.hole = {{ file = "round.csv"{keys} }}\nload = [{{ P = 1e6 }}]\n'
    )
    assert fastpin.read_case(tmp_path / "case.toml").problem.gap.hole.entries() == found.entries()


def test_columns_of_a_profile_that_are_wrong(tmp_path: Path) -> None:
    for columns, words in (
        ([1, 2], "columns: must map angles and values to columns, such as"),
        ({"angle": 1}, "columns: must map angles and values to columns, such as"),
        ({"angles": "phi"}, 'values: must be a column of the CSV file, such as { column = "angle" } or { column = 1 }'),
        ({"angles": "phi", "values": {"colum": 1}}, 'values: unknown key "colum"; the keys are column, scale, unit'),
    ):
        assert words in str(refused(Profile.from_csv, tmp_path / "a.csv", columns=columns))
