"""With a thickness every output is in N, N m, J and N m/rad; without one it is per metre.

One case is written twice: with forces in N and a thickness, and with the same forces per thickness. The thickness is a
power of two. So all states have the same bits, and each printed number is either the same or exactly the thickness
times the other.
"""

import contextlib
import csv
import functools
import io
import json
import math
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from matplotlib.text import Text

from fastpin import casefile, figures
from fastpin.assess.outputs import json_ready
from fastpin.cli import options
from fastpin.cli.main import main
from fastpin.figures.kinds import KINDS
from fastpin.live.contact import LiveContact
from fastpin.live.protocol import Message
from fastpin.studies import workers
from tests.support.plans import run_here
from tests.support.tiers import some_survey

T = 2.0**-7

CASE = """
[pin]
material = "steel"
[plate]
E = 70e9
nu = 0.33
fatigue = { fatigue_strength = 1.1e9, strength_exponent = -0.124, fatigue_ductility = 0.22, ductility_exponent = -0.59 }
[contact]
hole_radius = 0.01
clearance = 2e-5
friction = 0.4
pin_load = "centre"
rotation = "spring"
%s
[gap]
hole = { ellipse = 1e-6 }
[[load]]
P = [%r]
sxx = 2e6
[[load]]
Q = [%r, %r]
repeat = 2
[solve]
nodes = 21
arc = [-3.1, 0.1]
between = 1
slip_sums = true
"""

PLAN = """
case = "case.toml"
[grid]
contact.friction = [0.3, 0.4]
load.1.P = [%r, %r]
[outcomes]
heat = { cycle = "dissipation" }
largest_Q = { quantity = "Q", take = "largest" }
"""

LIMITS = """
case = "case.toml"
samples = 4
[tolerances]
contact.friction = { from = 0.3, to = 0.5 }
loads = { from = 0.9, to = 1.1 }
[outcomes]
heat = { cycle = "dissipation" }
"""

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


def words(thick: bool) -> tuple[str, str]:
    """The text of the case and of its plan."""
    forces = [2.0**12, 2.0**10, -(2.0**10), 3.0 * 2.0**10]
    p, right, left, other = forces if thick else [force / T for force in forces]
    spring = f"hub_stiffness = {1e4 if thick else 1e4 / T!r}" + (f"\nthickness = {T!r}" if thick else "")
    return CASE % (spring, p, right, left), PLAN % (p, other)


MOST_ROWS = 500
"""Rows of a table that are compared: a map has thousands."""


class Walk:
    """All outputs of all commands for one case: printed and drawn texts by command, and files."""

    def __init__(self, folder: Path, thick: bool) -> None:
        folder.mkdir()
        self.folder = folder
        self.commands: dict[str, str] = {}
        case, plan = words(thick)
        (folder / "case.toml").write_text(case)
        (folder / "plan.toml").write_text(plan)
        (folder / "limits.toml").write_text(LIMITS)

    def files(self, suffix: str) -> dict[str, str]:
        paths = sorted(self.folder.rglob(f"*{suffix}"))
        return {str(path.relative_to(self.folder)): path.read_text() for path in paths}


STATES = """
check case.toml
run case.toml --nodes 101 --error-bars --json run.json --cycle-csv run.csv
run case.toml -o a.h5 --plot b.svg --record record.html --cycles a.svg
show a.h5 --json show.json
"""

STUDY = """
converge case.toml --nodes 51,71,91 --corner 2 --csv converge.csv --json converge.json --plot c.svg
compliance --example
"""

RESULT = "run case.toml -o a.h5"
LIFE = "wear case.toml --cycles 2 --coefficient 1e-13 -o life.h5 --json wear.json --record record-life.html"

LAW = "--first 1e-4 --last 1e-3 --C 1e-10 --m 3 --at 80"

STUDIES = """
sweep plan.toml --table --plot heat.svg --value heat
sweep plan.toml --table sweep.csv --plot curves.svg --value dissipation
report plan --plan plan.toml -o sweep.html
tolerances limits.toml --plot tornado.svg --scatter samples.svg --json limits.json
report limits -o limits.html
"""


def plots(subject: str) -> list[str]:
    """The commands that draw every kind of figure of a result, or the kinds that only a life of wear has."""
    lines = []
    for kind, (_, _, allowed, sources, of_laminates) in KINDS.items():
        if not of_laminates and subject == ("a.h5" if "result" in sources else "life.h5"):
            states = "--states 2,3" if "states" in allowed and kind != "sketch" else ""
            lines.append(
                f"plot {subject} {kind} -o {kind}.svg {states} {f'--csv {kind}.csv' if 'csv' in allowed else ''}"
            )
    return lines


PARTS = {
    "states": STATES.strip().splitlines(),
    "study": STUDY.strip().splitlines(),
    **{f"figures {k}": [RESULT, *plots("a.h5")[k::5]] for k in range(5)},
    "crack": [RESULT, f"crack a.h5 {LAW} -o crack.svg --csv crack.csv"],
    "page": [RESULT, "report a.h5 -o report.html"],
    "life": [LIFE, *plots("life.h5")],
    "page of a life": [LIFE, "report life.h5 -o report-life.html"],
    "studies": STUDIES.strip().splitlines(),
}
"""Commands by part. Together they give every output."""


def walk(found: Walk, part: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Run the commands of a part. Texts that are drawn are heard. Figures are outlined."""
    monkeypatch.chdir(found.folder)
    drawn: list[str] = []
    draw = Text.draw
    monkeypatch.setattr(
        Text, "draw", lambda self, *given, **more: drawn.append(self.get_text()) or draw(self, *given, **more)
    )
    monkeypatch.setattr(figures.stress, "field_curves", functools.partial(figures.stress.field_curves, fineness=20))
    monkeypatch.setattr(workers, "through_processes", run_here)
    for line in PARTS[part]:
        drawn.clear()
        said = io.StringIO()
        with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
            assert main(line.split()) == 0, said.getvalue()
        found.commands[line] = "\n".join([said.getvalue(), *drawn])


def test_every_command_is_walked() -> None:
    known = set(re.findall(r"^    (\w+)(?:  |$)", options.parser().format_help(), re.MULTILINE))
    assert {line.split()[0] for part in PARTS.values() for line in part} | WITHOUT_UNITS.keys() == known


@pytest.mark.gate
@pytest.mark.parametrize("part", some_survey(PARTS, "page", "page of a life"))
def test_every_output_is_with_the_thickness_or_per_metre(part: str, tmp_path: Path) -> None:
    plain, thick = (Walk(tmp_path / name, name == "thick") for name in ("plain", "thick"))
    for found in (plain, thick):
        with pytest.MonkeyPatch.context() as monkeypatch:
            walk(found, part, monkeypatch)
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
    texts = found.commands | found.files(".csv") | found.files(".json") | found.files(".svg")
    pages = found.files(".html").items()
    texts |= {
        name: re.sub(r"(?s)<style.*?</style>|<[^>]*>", " ", text)
        for name, text in pages
        if not name.startswith("record")
    }
    return {name: place[0] for name, text in texts.items() if (place := wrong.search(text))}


UNIT = re.compile(r" \[(.*)\]$")
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


def is_times(plain: Any, thick: Any, factor: float) -> bool:
    """Whether a cell or a number is `factor` times the other one; texts must be equal."""
    try:
        return math.isclose(float(thick), factor * float(plain), rel_tol=1e-8)
    except (TypeError, ValueError):
        return bool(plain == thick)


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


def leaves(value: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[tuple[Any, ...], Any]]:
    """The numbers and texts of JSON with their places."""
    if isinstance(value, dict | list):
        for key, item in value.items() if isinstance(value, dict) else enumerate(value):
            yield from leaves(item, (*path, key))
    else:
        yield path, value


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
    contact = LiveContact(casefile.parse_case(words(thick)[0]), 31)
    contact.obey(Message("load", 1, {"loads": {"Q": 1e5}, "gesture": 1, "drag": False}))
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
