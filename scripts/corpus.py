"""A corpus of all that fastpin writes and says: have a file, a key, an id or a sentence changed?

``python -m scripts.corpus FOLDER`` runs the commands below and keeps their texts and files in a folder. ``--files OLD``
takes the stored files of another folder, which another version has written, instead of its own. Then
``python -m scripts.corpus --compare OLD NEW`` lists the texts that differ. Times, dates and versions are left out.
"""

from __future__ import annotations

import argparse
import ast
import contextlib
import csv
import difflib
import io
import os
import re
import shutil
import sys
import warnings
from collections.abc import Iterator
from pathlib import Path
from unittest import mock

import matplotlib

import fastpin
from fastpin.casefile.reader import EXAMPLE, read_case
from fastpin.cli.main import main as fastpin_command
from fastpin.errors import FastpinError
from fastpin.studies import identity
from fastpin.studies.plan import read_plan
from scripts.fingerprint import CHANGING
from tests.survey.mutations import CASES

FRETTING = """title = "Fretting in a bushed ring"
[pin]
material = "steel"
[plate]
material = "2024-T3"
[pin_body]
bore_radius = 4e-3
load = "uniform"
[plate_body]
E = 110e9
nu = 0.34
outer_radius = 12e-3
interference = 5e-6
ring_outer_radius = 25e-3
support = "held"
[contact]
hole_radius = 10e-3
clearance = 20e-6
friction = 0.4
plane = "stress"
thickness = 5e-3
[[load]]
P = 4e3
[[load]]
repeat = 3
mean = { P = 4e3 }
amplitude = { Q = 1.5e3 }
points = 4
[solve]
nodes = 101
"""

PLAN = """title = "Friction"
[grid]
"contact.friction" = { from = 0.1, to = 0.9, count = 3 }
"solve.nodes" = [41]
[[list]]
"contact.clearance" = 1e-5
[[list]]
"contact.clearance" = 4e-5
"""

WRITING = (
    "run example.toml --nodes 61 -o example.h5",
    "run fretting.toml -o fretting.h5 --slip-sums --error-bars",
    "run fretting.toml -o corners.h5 --keep corners --method increment --increments 4",
    "run stopped.toml -o stopped.h5 --slip-sums",
    "compliance --example",
    "compliance lug.toml -o lug.compliance",
    "sweep plan.toml -o runs",
    "sweep plan.toml -o runs-files --files",
)
"""Commands that write files. A file of another version can take the place of each."""

STORED = ("example.h5", "fretting.h5", "corners.h5", "stopped.h5", "lug.compliance", "runs", "runs-files")
"""Files and folders that the commands write."""

COMMANDS = (
    "example check run resume show plot report live converge sweep tolerances merge compliance paper benchmarks charts"
    " verify schema completion"
)
"""All commands."""

READING = (
    "--help",
    *(f"{command} --help" for command in COMMANDS.split()),
    "example",
    *(f"schema {command}" for command in ["run", "converge", "verify", "benchmarks", "compliance", "charts"]),
    *(f"check {name}.toml" for name in ("example", "fretting", "bad")),
    *(f"show {name}.h5 --json" for name in ("example", "fretting", "corners", "stopped")),
    *(
        f"show {name}.h5 --states all --plot {name}-tractions.svg"
        for name in ("example", "fretting", "corners", "stopped")
    ),
    "show fretting.h5 --cycle-csv cycles.csv --cycles cycles.svg",
    *(
        f"plot fretting.h5 {kind} --csv {kind}.csv -o {kind}.svg"
        for kind in ["tractions", "stick-slip", "hoop", "profile", "map", "cycles", "slip", "loops"]
    ),
    "plot example.toml sketch -o sketch.svg",
    "sweep plan.toml -o runs --status",
    "sweep plan.toml -o runs --table table.csv",
    "sweep plan.toml -o runs-files --table table-files.csv",
    "sweep plan.toml -o runs --plot sweep.svg --value peak_pressure",
    "converge example.toml --nodes 61,81,101 --json",
    "verify",
    "resume stopped.h5",
)
"""Commands that read. The last one continues a run."""

MASKS = (
    (r"\d{4}-\d\d-\d\d[T ]\d\d:\d\d(:\d\d(\.\d+)?)?(\+\d\d:\d\d|Z)?", "DATE"),
    (r"\d{4}-\d\d-\d\d", "DATE"),
    (r"\b[\d.,]+( ?)(ms|s|min|h|seconds?)\b(?! ?\()", "TIME"),
    (r'"(seconds|started|host|machine|duration|elapsed)": [^,}\n]+', r'"\1": TIME'),
)
"""Patterns that differ between two runs of one version."""


@contextlib.contextmanager
def inside(folder: Path) -> Iterator[None]:
    """Work in a folder for a while."""
    before = Path.cwd()
    os.chdir(folder)
    try:
        yield
    finally:
        os.chdir(before)


def said(command: str) -> str:
    """Run a command in this process and return its exit code, output and errors."""
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err), warnings.catch_warnings():
        warnings.simplefilter("always")
        try:
            code: object = fastpin_command(command.split())
        except SystemExit as end:
            code = end.code
    text = f"{command}\nexit code {code}\n-- out\n{out.getvalue()}\n-- err\n{err.getvalue()}\n"
    for pattern, name in MASKS:
        text = re.sub(pattern, name, text)
    return text.replace(str(Path.cwd()), "FOLDER")


def write_inputs() -> None:
    """Write the cases and plans that the commands read."""
    Path("example.toml").write_text(EXAMPLE, encoding="utf-8")
    Path("fretting.toml").write_text(FRETTING, encoding="utf-8")
    Path("bad.toml").write_text(FRETTING.replace("0.4", '"much"').replace("nu = 0.34", "mu = 0.34"), encoding="utf-8")
    Path("stopped.toml").write_text(FRETTING + "[[load]]\nM = 1e4\n", encoding="utf-8")
    Path("plan.toml").write_text('case = "example.toml"\n' + PLAN, encoding="utf-8")
    for count, text in enumerate(CASES):
        Path(f"case{count}.toml").write_text(text, encoding="utf-8")


def ids() -> Iterator[str]:
    """Yield the canonical input and the id of each case, and of each run of the plan."""
    for path in sorted(Path().glob("*.toml")):
        try:
            case = read_case(path)
        except FastpinError as error:
            yield f"{path}: {type(error).__name__}"
            continue
        document = identity.canonical(case)
        yield f"{path}: {identity.run_id(document, '0')} {identity.canonical_json(document)}"
    for name, point in read_plan("plan.toml").runs.items():
        yield f"{name}: {point}"


def sentences() -> Iterator[str]:
    """Yield the texts of the package with at least three words, without docstrings: messages, labels, helps."""
    folder = Path(fastpin.__file__).parent
    texts = set()
    for path in folder.rglob("*.py"):
        tree = ast.parse(path.read_text("utf-8"))
        bare = {id(node.value) for node in ast.walk(tree) if isinstance(node, ast.Expr)}
        for node in ast.walk(tree):
            if not isinstance(node, ast.Constant) or not isinstance(node.value, str) or id(node) in bare:
                continue
            if len(re.findall(r"[a-z]{2,}", node.value)) >= 3:
                texts.add(repr(node.value))
    yield from sorted(texts)


def without_times(path: Path) -> str:
    """Return a table without the columns that differ between two runs of one version."""
    with path.open(encoding="utf-8", newline="") as file:
        rows = list(csv.reader(file))
    header = next((row for row in rows if set(CHANGING) & set(row)), [])
    left_out = {index for index, name in enumerate(header) if name in CHANGING}
    return "\n".join(",".join(cell for index, cell in enumerate(row) if index not in left_out) for row in rows)


def write_corpus(folder: Path, files: Path | None) -> None:
    """Run all commands in a new folder."""
    folder.mkdir(parents=True)
    with inside(folder), mock.patch.dict(os.environ, {"SOURCE_DATE_EPOCH": "0", "COLUMNS": "100"}):
        matplotlib.rcParams["svg.hashsalt"] = "corpus"
        write_inputs()
        texts = {}
        if files is None:
            texts = {command: said(command) for command in WRITING[:5]}
            lug = texts["compliance --example"].partition("-- out\n")[2].partition("\n-- err")[0]
            Path("files").mkdir()
            Path("lug.toml").write_text(lug, encoding="utf-8")
            texts |= {command: said(command) for command in WRITING[5:]}
            for name in (*STORED, "lug.toml"):
                take = shutil.copytree if Path(name).is_dir() else shutil.copy
                take(name, Path("files", name))
        else:
            shutil.copytree(files / "files", Path(), dirs_exist_ok=True)
        texts |= {command: said(command) for command in READING}
        Path("texts").mkdir()
        for command, text in texts.items():
            Path("texts", re.sub(r"[^\w.-]+", "_", command) + ".txt").write_text(text, encoding="utf-8")
        Path("texts", "ids.txt").write_text("\n".join(ids()), encoding="utf-8")
        Path("texts", "sentences.txt").write_text("\n".join(sentences()), encoding="utf-8")
        for path in Path().glob("*.svg"):
            text = re.sub(r'(url\(#|id="|href="#)[mp][0-9a-f]{10}', r"\1ID", path.read_text("utf-8"))
            Path("texts", path.name).write_text(text, encoding="utf-8")
        for path in Path().glob("*.csv"):
            Path("texts", path.name).write_text(without_times(path), encoding="utf-8")


def compare(old: Path, new: Path) -> int:
    """Print the lines of all texts that differ, and return the number of these texts."""
    names = sorted({path.name for folder in (old, new) for path in (folder / "texts").iterdir()})
    different = 0
    for name in names:
        both = [folder / "texts" / name for folder in (old, new)]
        if not all(path.exists() for path in both):
            print(f"== {name}: only in {old if both[0].exists() else new}")
            continue
        before, after = (path.read_text("utf-8").splitlines() for path in both)
        if before != after:
            different += 1
            print(f"== {name}")
            for line in difflib.unified_diff(before, after, n=0, lineterm=""):
                print(line[:300])
    print(f"{different} of {len(names)} texts differ")
    return different


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path, nargs="?", help="the folder to write")
    parser.add_argument("--files", type=Path, metavar="OLD", help="take the stored files of this folder")
    parser.add_argument("--compare", type=Path, nargs=2, metavar=("OLD", "NEW"), help="list the texts that differ")
    arguments = parser.parse_args()
    if arguments.compare:
        return int(compare(*arguments.compare) > 0)
    if arguments.folder is None:
        parser.error("name a folder, or --compare")
    write_corpus(arguments.folder.resolve(), arguments.files and arguments.files.resolve())
    return 0


if __name__ == "__main__":
    sys.exit(main())
