"""CSV files as test rigs and spreadsheets write them: columns of any name, units, signs, separators and commas."""

import re
from pathlib import Path
from typing import Any

import pytest

from fastpin import CaseFileError, InputError, LoadHistory
from fastpin.model import LOADS
from fastpin.tables.load_units import INCH, POUND
from tests.support.faults import faults_of
from tests.support.times import growth


def loads(
    folder: Path, text: str, columns: dict[str, Any] | None, thickness: float | None = None, encoding: str = "utf-8"
) -> dict[str, list[float]]:
    """The loads of a file of this text, by name; without loads that are 0 everywhere."""
    path = folder / "rig.csv"
    path.write_bytes(text.encode(encoding))
    values = LoadHistory.from_csv(path, columns, thickness).values()
    return {name: values[:, place].tolist() for place, name in enumerate(LOADS) if values[:, place].any()}


@pytest.mark.parametrize(
    ("text", "columns", "thickness", "found"),
    [
        ("Time [s],Force [N]\n0,10\n1,20\n", {"P": "Force [N]"}, 0.5, {"P": [20, 40]}),
        ("Force [N]\n10\n", {"P": "Force"}, 1.0, {"P": [10]}),
        ("Force (kN)\n-1.005\n", {"P": {"column": "Force", "scale": -1.0}}, 1.0, {"P": [1005]}),
        ("Force / kN\n1.5e1\n", {"P": "Force"}, 1.0, {"P": [15000]}),
        ("Load cell\n2\n", {"P": {"column": "Load cell", "unit": "[kN/m]"}}, None, {"P": [2000]}),
        ("Kraft (Messzelle 2)\n2\n", {"P": {"column": "Kraft", "unit": "N"}}, 1.0, {"P": [2]}),
        ("F\n3\n", {"P": "F", "Q": {"column": "F", "scale": 0.5}}, None, {"P": [3], "Q": [1.5]}),
        ("P [kN/m],Q\n1,2\n,3\n", None, None, {"P": [1000, 1000], "Q": [2, 3]}),
        ("P [lbf]\n1\n", None, 1.0, {"P": [POUND]}),
        ("P [lbf/in]\n1\n", None, None, {"P": [POUND / INCH]}),
        ("M [N·m],sxx [N/mm²]\n1,2\n", None, 1.0, {"M": [1], "sxx": [2e6]}),
        ("M [Nmm]\n7\n", None, 1.0, {"M": [0.007]}),
        ("M [N]\n7\n", None, None, {"M": [7]}),
        ("ux [µm],rotation [mrad]\n7,7\n", None, None, {"ux": [7e-6], "rotation": [7e-3]}),
        ("uy [mm],rotation [°]\n0.1,180\n", None, None, {"uy": [0.1e-3], "rotation": [3.141592653589793]}),
        # spreadsheets: semicolons or tabs, decimal commas, a row of units, separators at the end of a line and a file
        ("Force [N];t\n1,5;0,1\n2;0,2\n", {"P": "Force"}, 1.0, {"P": [1.5, 2]}),
        ("Force [N];t\n1,500;0\n2,125;0\n", {"P": "Force"}, 1.0, {"P": [1.5, 2.125]}),
        ("Force\tt\n1,5\t0,1\n", {"P": "Force"}, None, {"P": [1.5]}),
        ("Force\tt\n1,234\t0\n0,125\t0\n", {"P": "Force"}, None, {"P": [1.234, 0.125]}),
        ("P;Q\n1.5;2.5\n", None, None, {"P": [1.5], "Q": [2.5]}),
        ("Time,Force\ns,kN\n0,2\n", {"P": "Force"}, 1.0, {"P": [2000]}),
        ("Time;Force\n[s];[kN]\n0;2,5\n", {"P": "Force"}, 1.0, {"P": [2500]}),
        ("P,Q\n(kN/m),-\n1,2\n", None, None, {"P": [1000], "Q": [2]}),
        ("P,Q,\n1,2,\n3,4,,\n,,\n,,\n\n", None, None, {"P": [1, 3], "Q": [2, 4]}),
        ("P,Q\n1,2\n,\n3,4\n", None, None, {"P": [1, 1, 3], "Q": [2, 2, 4]}),
        ('"Force, cell 1",Q\n"1",2\n', {"P": "Force, cell 1"}, None, {"P": [1]}),
    ],
)
def test_columns_units_and_signs(text, columns, thickness, found, tmp_path):
    for encoding in ("utf-8", "utf-8-sig"):
        for end in ("\n", "\r\n"):
            assert loads(tmp_path, text.replace("\n", end), columns, thickness, encoding) == found


@pytest.mark.parametrize(
    ("text", "columns", "thickness", "line", "words"),
    [
        ("# rig 3\nTime [s],Force [N]\n0,1\n", {"P": "Forze [N]"}, 1.0, 2,
         'P: the file has no column "Forze [N]"; its columns are "Time [s]", "Force [N]", did you mean "Force [N]"?'),
        ("F,F\n0,1\n", {"P": "F"}, None, 1, 'P: 2 columns of the file are "F"; its columns are "F", "F"'),
        ("Force [N]\n1\n", None, None, 1,
         'column 1: unknown load "Force [N]"; the loads are P, Q, M, sxx, syy, rotation, sxy, ux, uy, '
         'friction_change, temperature, pin_temperature; a [[load]] block reads it with P = { column = "Force [N]" }'),
        ("P [MPa]\n1\n", None, 1.0, 1,
         'P: a force must be in N, kN, MN, daN, kgf, lbf or kip, not "MPa" (column "P [MPa]")'),
        ("P [kN]\n1\n", None, None, 1,
         'P: a force must be in N/m, kN/m, MN/m, N/mm, kN/mm or lbf/in, not "kN"; give the thickness for loads in N '
         'and N m (column "P [kN]")'),
        ("P [kN/m]\n1\n", None, 1.0, 1,
         'P: a force must be in N, kN, MN, daN, kgf, lbf or kip, not "kN/m"; with a thickness loads are in N '
         'and N m (column "P [kN/m]")'),
        ("P\n1\n", {"P": {"column": "P", "unit": "KN"}}, 1.0, 1, 'lbf or kip, not "KN", did you mean "kN"?'),
        ("F [N]\n1\n", {"P": {"column": "F", "unit": "kN"}}, 1.0, 1, "P: the unit is kN, and the header says N; give"),
        ("F [N]\nkN\n1\n", {"P": "F"}, 1.0, 2, "P: the unit is N, and the line below the header says kN; give"),
        ("P,Q\nMPa,N\n1,2\n", None, 1.0, 2, 'P: a force must be in N, kN, MN, daN, kgf, lbf or kip, not "MPa"'),
        ("Force [N]\n1\nx\n", {"P": "Force"}, 1.0, 3, 'P: must be a number, not "x" (column "Force [N]")'),
        ("P\tQ;M\n1\t2;3\n", None, None, 1, "the header has tabs and semicolons; separate the cells by one of them"),
        ("P,Q\n1,5,2,5\n", None, None, 2,
         "the line has 4 cells, the header has 2; with decimal commas the cells must be separated by semicolons or"),
        ("P;Q\n1,5;2\n1;2.5\n", None, None, 3,
         "a number has a decimal point, and one in line 2 a decimal comma; write one of them in the whole file"),
        ("P\tQ\n1,500\t2\n1\t-2,500\n", None, None, 2,
         "the comma of each number may be a decimal comma or separate thousands; write decimal points"),
        ("P;Q\n1.234,5;2\n", None, None, 2, 'P: thousands must not be separated: write 1234.5, not "1.234,5"'),
        ("P;Q\n1,234,567;2\n", None, None, 2, 'P: thousands must not be separated: write 1234.5, not "1,234,567"'),
        ("# P,Q\n1,2\n", None, None, 2, "the first line must name the columns, and not begin with #"),
        ("P\n,\n\n", None, None, 0, "holds no load corners"),
    ],
)  # fmt: skip
def test_faults_name_line_column_and_what_is_allowed(text, columns, thickness, line, words, tmp_path):
    ((place, sentence),) = faults_of(loads, tmp_path, text, columns, thickness)
    assert place == line
    assert words in sentence


def test_bytes_that_are_no_text_get_a_remedy(tmp_path: Path) -> None:
    (tmp_path / "rig.csv").write_bytes(b"ux [\x81m]\n1\n")
    with pytest.raises(CaseFileError, match="is not UTF-8 text; save it with this encoding"):
        LoadHistory.from_csv(tmp_path / "rig.csv")


@pytest.mark.parametrize(
    ("columns", "field", "words"),
    [
        ({}, "columns", "must map loads to columns"),
        ("Force", "columns", "must map loads to columns"),
        ({"F": "Force"}, "columns", 'unknown load "F"; the loads are P, Q, M'),
        ({"P": 3}, "P", 'must be a column of the CSV file, such as P = { column = "Force [N]"'),
        (
            {"P": {"colum": "F"}},
            "P",
            'the keys are column, scale, unit, zero, did you mean "column"?',
        ),
        ({"P": {"scale": 2.0}}, "P", "column is missing"),
        ({"P": {"column": "F", "scale": 0}}, "P.scale", "must not be 0"),
        ({"P": {"column": "F", "scale": "x"}}, "P.scale", "must be a number"),
        (
            {"P": {"column": 0}},
            "P.column",
            "must be the text of a header, a number counted from 1, or a list of two of",
        ),
        ({"P": {"column": [1, 2, 3]}}, "P.column", "must be the text of a header, a number counted from 1, or"),
        ({"P": {"column": "F", "unit": 3}}, "P.unit", "must be text in quotes"),
    ],
)
def test_wrong_columns_are_refused(columns: Any, field: str, words: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=re.escape(words)) as caught:
        loads(tmp_path, "F\n1\n", columns)
    assert caught.value.field == field


def test_a_wrong_thickness_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="thickness: must be positive"):
        loads(tmp_path, "P\n1\n", None, 0.0)


HEADERS = {
    "columns": lambda size: ",".join(["Force [N]"] * size),
    "spaces": lambda size: "Force" + " " * (30 * size) + "N",
    "brackets": lambda size: "[" * (30 * size),
}


@pytest.mark.parametrize("header", HEADERS.values(), ids=list(HEADERS))
@pytest.mark.parametrize("column", ["Forze", "F" * 900_000, ""])
def test_a_hostile_header_of_twice_the_size_takes_twice_the_time(header, column, tmp_path):
    def refused(size: int) -> None:
        with pytest.raises(CaseFileError, match=r"the file has no column|unknown load") as caught:
            loads(tmp_path, f"{header(size)}\n1\n", {"P": column} if column else None)
        assert len(str(caught.value)) < 2000

    assert growth(refused, 2_000) < 3.0
