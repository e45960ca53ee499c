"""A walk over all outputs of all commands for one case, which tests of units share."""

import contextlib
import functools
import io
import json
import math
import re
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from matplotlib.text import Text

from fastpin import figures
from fastpin.cli.main import main
from fastpin.figures.kinds import KINDS
from fastpin.model.keys import CASE as KINDS_OF_KEYS
from fastpin.model.keys import converted
from fastpin.model.unit_systems import SI
from fastpin.model.units import in_other_units, measures_of
from fastpin.studies import workers
from tests.support.drawing import OF_SOME_PLATES
from tests.support.plans import run_here

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

    def __init__(self, folder: Path, case: str, plan: str, system: str = SI) -> None:
        folder.mkdir()
        self.folder, self.system = folder, system
        self.commands: dict[str, str] = {}
        (folder / "case.toml").write_text(case)
        (folder / "plan.toml").write_text(plan)
        (folder / "limits.toml").write_text(LIMITS)

    def files(self, suffix: str) -> dict[str, str]:
        paths = sorted(self.folder.rglob(f"*{suffix}"))
        return {str(path.relative_to(self.folder)): path.read_text() for path in paths}

    def texts(self) -> dict[str, str]:
        """Printed and drawn texts, tables and pages without their scripts, by name."""
        found = self.commands | self.files(".csv") | self.files(".json") | self.files(".svg")
        for name, text in self.files(".html").items():
            if not name.startswith("record"):
                found[name] = re.sub(r"(?s)<style.*?</style>|<[^>]*>", " ", text)
        return found


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
    for kind, drawn in KINDS.items():
        allowed, sources = drawn.options, drawn.sources
        of = "a.h5" if "result" in sources else "life.h5" if "life" in sources else None
        if kind not in OF_SOME_PLATES and subject == of:
            name = f"{kind}.svg"
            states = "--states 2,3" if "states" in allowed and kind != "sketch" else ""
            lines.append(f"plot {subject} {kind} -o {name} {states} {f'--csv {kind}.csv' if 'csv' in allowed else ''}")
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


def walk(found: Walk, lines: list[str], monkeypatch: pytest.MonkeyPatch) -> None:
    """Run commands. Texts that are drawn are heard. Figures are outlined."""
    monkeypatch.chdir(found.folder)
    drawn: list[str] = []
    draw = Text.draw
    monkeypatch.setattr(
        Text, "draw", lambda self, *given, **more: drawn.append(self.get_text()) or draw(self, *given, **more)
    )
    monkeypatch.setattr(figures.stress, "field_curves", functools.partial(figures.stress.field_curves, fineness=20))
    monkeypatch.setattr(workers, "through_processes", run_here)
    for line in lines:
        drawn.clear()
        said = io.StringIO()
        with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
            assert main(line.split()) == 0, said.getvalue()
        found.commands[line] = "\n".join([said.getvalue(), *drawn])


def cases_in(text: str, system: str) -> tuple[str, str]:
    """A case file in SI units as one in a system of units, with six digits, and this one in SI units again.

    Both are read as the same numbers, to the last bit.
    """
    tables = tomllib.loads(text)
    whole = "thickness" in tables["contact"]
    changed = in_other_units(tables, KINDS_OF_KEYS, SI, system, whole)
    changed = converted(changed, KINDS_OF_KEYS, lambda kind, number: float(f"{number:.6g}"))
    return toml(in_other_units(changed, KINDS_OF_KEYS, system, SI, whole)), toml(changed)


def line_in(line: str, system: str) -> str:
    """A command whose options are in SI units, in a system of units."""
    ways = measures_of(system, True)

    def changed(found: re.Match[str]) -> str:
        return f"--{found[1]} {ways[OPTIONS[found[1]]].given(float(found[2]))!r}"

    unit = f" --unit {ways['stress intensity'].given(1e6)!r}" if "--C " in line else ""
    return re.sub(rf"--({'|'.join(OPTIONS)}) (\S+)", changed, line) + unit


OPTIONS = {"first": "length", "last": "length", "C": "crack growth", "coefficient": "wear coefficient"}
"""Kinds of the options that have units."""


def toml(tables: dict[str, Any]) -> str:
    """Tables of a case as TOML."""
    plain = {name: value for name, value in tables.items() if not _blocks(value)}
    lines = [f"{name} = {_toml(value)}" for name, value in plain.items()]
    for name, value in tables.items():
        for block in _blocks(value):
            lines.append(f"[{name}]" if isinstance(value, dict) else f"[[{name}]]")
            lines += [f"{key} = {_toml(item)}" for key, item in block.items()]
    return "\n".join(lines) + "\n"


def _blocks(value: Any) -> list[dict[str, Any]]:
    if isinstance(value, list):
        return [each for each in value if isinstance(each, dict)]
    return [value] if isinstance(value, dict) else []


def _toml(value: Any) -> str:
    if isinstance(value, dict):
        return f"{{ {', '.join(f'{key} = {_toml(item)}' for key, item in value.items())} }}"
    if isinstance(value, list):
        return f"[{', '.join(map(_toml, value))}]"
    return json.dumps(value)


def leaves(value: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[tuple[Any, ...], Any]]:
    """The numbers and texts of JSON with their places."""
    if isinstance(value, dict | list):
        for key, item in value.items() if isinstance(value, dict) else enumerate(value):
            yield from leaves(item, (*path, key))
    else:
        yield path, value


def is_times(plain: Any, thick: Any, factor: float) -> bool:
    """Whether a cell or a number is `factor` times the other one; texts must be equal."""
    try:
        return math.isclose(float(thick), factor * float(plain), rel_tol=1e-8)
    except (TypeError, ValueError):
        return bool(plain == thick)


UNIT = re.compile(r" \[(.*)\]$")
