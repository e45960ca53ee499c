"""Texts of anybody inside stored files: titles, names of materials, errors and hosts of results."""

import csv
import json
import sqlite3
import xml.etree.ElementTree as ET
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest

import fastpin
from fastpin import Result, storage
from fastpin.bodies import Compliance
from fastpin.casefile import parse_case
from fastpin.errors import printable
from fastpin.figures.style import caption
from fastpin.storage import packed, store
from fastpin.storage.files import INDEX
from fastpin.studies import read_plan, sweep
from fastpin.studies.index import Index
from fastpin.studies.run_end import RunEnd, key_figures
from tests.support.case_texts import PRESSED
from tests.support.commands import said

CASE = f"""{PRESSED}[[load]]
Q = [1e5, -1e5]
"""

SIGNS = "=HYPERLINK(1)\x1b[31m\x08\x07\x9b\u202e\n\r</script><script>alert(1)</script>&<b"
"""A formula, an escape sequence, control characters, a mark that turns the direction, line ends and markup."""

HOSTILE = f"{SIGNS}\ud800"
"""The same with half a character, which SQLite can't hold, but HDF5 and JSON can."""

PLACES = ("solver@title", "problem/pin@name", "problem/plate@name", "problem/plate_body@made_by", "@error", "@host")
"""Attributes of a result that hold texts."""

PLAN = 'title = "a"\n[grid]\n"contact.friction" = [0.1, 0.2]\n"solve.nodes" = [21]\n'


@pytest.fixture(scope="module")
def result() -> Result:
    """A result with all bodies that have texts."""
    plate = Compliance(0.3, "strain", 0.01, np.zeros((10, 10)), {}, "a")
    problem = parse_case(CASE).problem
    return fastpin.solve(fastpin.Problem(problem.pair, 0.01, 1e-5, 0.3, plate_body=plate), [{"P": 1e6}], nodes=41)


@pytest.fixture(params=["file", "packed"])
def path(request: pytest.FixtureRequest, result: Result, tmp_path: Path) -> Path:
    """A result with hostile texts, in a file of its own or in the index of a sweep."""
    place = tmp_path / "results" / "abc.h5"
    place.parent.mkdir()
    if request.param == "file":
        fastpin.save(result, place)
        with h5py.File(place, "r+") as file:
            set_texts(file, HOSTILE.encode("utf-8", "surrogatepass"))
        return place
    content = packed.from_bytes(store.pack(result, None, 10**6) or b"")
    set_texts(content, HOSTILE)
    with closing(sqlite3.connect(tmp_path / INDEX)) as database:
        database.execute(packed.TABLE)
        database.execute("INSERT INTO results VALUES ('abc', ?)", [packed.to_bytes(content)])
        database.commit()
    return place


def set_texts(file: Any, text: Any) -> None:
    """Write a text into all places of a result."""
    for place in PLACES:
        part, _, name = place.partition("@")
        (file[part] if part else file).attrs[name] = text


def texts_of(value: Any) -> Iterator[str]:
    """All texts of a JSON document or a row."""
    if isinstance(value, str):
        yield value
    elif isinstance(value, dict):
        for name, item in value.items():
            yield from (name, *texts_of(item))
    elif isinstance(value, list):
        for item in value:
            yield from texts_of(item)


def is_printable(value: Any) -> bool:
    """Whether all texts of a value can be printed as they are."""
    return all(printable(text) == text for text in texts_of(value))


def run(*words: object, code: int = 0) -> str:
    """Run a command. Everything that it prints can be printed."""
    shown = "".join(said(*words, code=code))
    assert is_printable(shown.split("\n"))
    assert "Traceback" not in shown
    return shown


def check_file(path: Path) -> str:
    """Check that a file harms no program which reads it, and return its text."""
    text = path.read_text(encoding="utf-8")
    assert is_printable(text.replace("\t", "").split("\n"))
    if path.suffix == ".csv":
        with path.open(newline="", encoding="utf-8") as file:
            cells = [cell for row in csv.reader(file) for cell in row]
        assert not any(cell.startswith(("=", "@", "\t", "\r")) for cell in cells)
    elif path.suffix == ".json":
        assert is_printable(json.loads(text))
    else:
        assert "<script>alert" not in text
    if path.suffix == ".svg":
        ET.fromstring(text)
    return text


@pytest.mark.gate
@pytest.mark.usefixtures("drawn")
def test_texts_of_a_result_harm_no_reader(path: Path, tmp_path: Path) -> None:
    files = {name: tmp_path / name for name in ("a.json", "a.html", "a.svg", "a.csv", "page.html")}
    run("show", path, "--json", files["a.json"], "--record", files["a.html"])
    run("plot", path, "tractions", "-o", files["a.svg"], "--csv", files["a.csv"])
    if path.exists():  # a page takes long, and shows the same texts
        del files["page.html"]
    else:
        run("report", path, "-o", files["page.html"])
    for file in files.values():
        assert ("HYPERLINK" in check_file(file)) == (file.suffix != ".csv")
    found = storage.load(path)
    values = [repr(found), repr(found.problem), storage.StoredResult(path).error, storage.StoredResult(path).origin]
    assert is_printable([*repr(values).split("\n"), dict(storage.to_xarray(path).attrs)])


@pytest.mark.gate
def test_texts_of_an_index_harm_no_reader(tmp_path: Path) -> None:
    source, folder = tmp_path / "plan.toml", tmp_path / "runs"
    source.write_text(PLAN)
    folder.mkdir()
    (folder / sweep.PLAN).write_text(PLAN)
    plan = read_plan(source)
    case = plan.case(plan.points[0])
    solved = fastpin.solve(case.problem, case.history, nodes=21)
    first, second = (point.id for point in plan.points)
    with Index(folder, write=True) as index:
        index.expect(plan, plan.points)
        content, versions = store.pack(solved, None, 10**6), {SIGNS: HOSTILE}
        index.record([
            RunEnd(first, None, key_figures(solved), 0.5, SIGNS, SIGNS, versions, content=content),
            RunEnd(second, SIGNS, {}, 0.5, SIGNS, SIGNS, versions),
        ])  # fmt: skip
    with closing(sqlite3.connect(folder / INDEX)) as database:
        database.execute("UPDATE sweep SET value = ? WHERE name IN ('title', 'text')", [SIGNS])
        database.execute('UPDATE runs SET "contact.friction" = ?', [json.dumps([HOSTILE])])
        database.execute("INSERT INTO outcomes VALUES (?, ?, ?, NULL, ?)", [first, SIGNS, SIGNS, SIGNS])
        database.commit()
    table, page = tmp_path / "a.csv", tmp_path / "a.html"
    shown = run("sweep", source, "-o", folder, "--status", "--table", table)
    assert f"failed: {second}" in shown
    assert "HYPERLINK" in shown
    run("sweep", source, "-o", folder, "--status", "--table")
    run("report", folder, "-o", page)
    run("merge", folder, "-o", tmp_path / "whole")
    for file in (table, page):
        assert "HYPERLINK" in check_file(file)
    assert is_printable(sweep.rows(plan, folder))


@pytest.mark.parametrize("name", ["made_by", "columns"])
def test_texts_of_a_compliance_harm_no_reader(name: str, tmp_path: Path) -> None:
    """The origin is any text. The name of a column is not: the fault repeats it."""
    document = Compliance(0.3, "strain", 0.01, np.zeros((10, 10)), {}).document()
    Path("lug.json").write_text(json.dumps(document | {name: {HOSTILE: 1} if name == "columns" else HOSTILE}))
    case = tmp_path / "case.toml"
    case.write_text(f'{CASE}[plate_body]\nkind = "compliance"\nfile = "lug.json"\n')
    code = 0 if name == "made_by" else 2
    assert "HYPERLINK" in run("check", case, code=code)
    said("run", case, "--nodes", "21", "--json", "a.json", code=code)
    assert code or "HYPERLINK" in check_file(tmp_path / "a.json")
    if not code:
        assert is_printable(repr(Compliance.from_file(tmp_path / "lug.json")))


def test_a_long_name_is_cut_in_figures() -> None:
    """Matplotlib needs minutes for it, and has no room left for the figure."""
    steel = fastpin.Material(2.1e11, 0.3, "x" * 100_000)
    problem = fastpin.Problem(fastpin.MaterialPair(steel, steel), 0.01, 1e-5, 0.3)
    assert len(caption(problem)) < 300


@pytest.mark.gate
def test_the_table_of_a_sweep_has_no_formulas(tmp_path: Path) -> None:
    name = "=HYPERLINK(1)"
    Path("mine.toml").write_text(f'["{name}"]\nE = 1e11\nnu = 0.3\n')
    Path("case.toml").write_text(f'materials = "mine.toml"\n{CASE}[solve]\nnodes = 41\n')
    Path("plan.toml").write_text(f'case = "case.toml"\n[grid]\npin.material = ["steel", "{name}"]\n')
    said("sweep", "plan.toml", "-o", "runs", "--workers", "1", "--table", "table.csv")
    assert f",'{name}," in check_file(Path("table.csv"))
