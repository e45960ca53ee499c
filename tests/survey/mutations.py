"""Change input files at random: does fastpin answer with a result or one sentence, and leave the files alone?

:func:`examine` changes a case file, a CSV history, a result, an unfinished result with its journal, the index of a
sweep, a plan, a lug or a joint file. Some changes are random, and some are hostile (hostile.py). It reads the changed
file through Python and the command line, in a process of its own. A finding is a raw error of Python, a traceback, a
crash, a run without an end, too much memory, a long or empty message, or a file that was changed without a right to it.
Reading may change, make or remove no file at all, also not in the folder beside. Changed bytes can crash the HDF5
library itself, or catch it in a loop. Such cases are counted apart: no code of Python can prevent them.
"""

from __future__ import annotations

import contextlib
import faulthandler
import hashlib
import io
import json
import logging
import math
import os
import re
import resource
import shutil
import signal
import sqlite3
import stat
import tempfile
import time
import traceback
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple
from unittest import mock

import h5py
import numpy as np

import fastpin
from fastpin.casefile.lug import LUG_EXAMPLE, read_lug
from fastpin.casefile.reader import EXAMPLE
from fastpin.cli.main import main as fastpin_command
from fastpin.errors import FastpinError, InputWarning
from fastpin.joints import JOINT_EXAMPLE, read_joint
from fastpin.storage import export, recording, store, stored
from fastpin.storage.journal import JournaledFile
from fastpin.studies import plan as plans
from fastpin.studies import sweep, workers
from fastpin.studies.outcome_tables import read_outcomes
from scripts.inline import Inline
from tests.survey import hostile

NODES = 31
"""Nodes of all results."""

LONGEST = 15.0
"""Seconds of the processor for all attempts with one changed file."""

LONGEST_WAIT = 90.0
"""Seconds of the clock for the same. The machine may be busy with other work."""

MOST_MEMORY = 2 << 30
"""Bytes of address space that the attempts with one changed file may take, beyond the process before."""

LONGEST_LINE = 600
"""Most characters in a line of a message."""

MOST_LINES = 60
"""Most lines of a message: a case file can have many faults, a line each."""

MOST_DIGESTED = 1 << 26
"""Most bytes of a file that is compared by its content. A larger one is compared by its size and time."""

HOSTILE = 0.6
"""Share of hostile changes."""

IN_LIBRARY = "the HDF5 library crashed, or did not end"
"""Finding that is counted apart."""

LARGEST_RUN = 40
"""Most corners of a changed case that is solved."""

CSV = "P, Q, M\n# the first corner\n1.0, 0, 0\n1.0, 0.2,\n, -0.2,\n, 0.1, 0.05\n0.5, 0, 0\n"

CASES = (
    EXAMPLE,
    """title = "By Dundurs' parameters"
[dundurs]
alpha = 0.25
beta = 0.06
nu_pin = 0.32
convention = "usual"
[contact]
plane = "stress"
load_parameter = 0.1
friction = 0.4
rotation = "fixed"
hub_radius = 0.5
[[load]]
P = [0.5, 1.0]
[[load]]
mean = {P = 1.0}
amplitude = {Q = 0.2, sxx = 0.01}
phase = {sxx = 90.0}
points = 4
repeat = 3
[solve]
nodes = 31
method = "increment"
increments = 5
arc = [-3.0, -0.1]
between = [0.25, 0.5]
keep = "corners"
shortcut = true
error_bars = false
""",
    """[pin]
rigid = true
[plate]
E = 69e9
nu = 0.33
[contact]
hole_radius = 10e-3
clearance = -2e-6
friction = 0.3
[history]
csv = "loads.csv"
repeat = 2
[solve]
nodes = 31
""",
)

PLAN = """title = "Friction"
[grid]
"contact.friction" = [0.2, 0.4]
"solve.nodes" = [31]
[[list]]
"load.2.Q" = 1e5
[[list]]
"load.2.Q" = [1e5, 2e5]
"""

WORDS = (
    "nan", "inf", "-inf", "1e400", "-1", "0", "1e308", "5e-324", "1e-200", "true", "false", '""', '"x"', "[]", "{}",
    "[1, 2]", "{P = 1}", "1979-05-27", "0x10", "99999999999999999999", '"a\\u0000b"', "'", '"""', "#", "=", "[[load]]",
    "[pin]", "\u00e9", "\x00", "1_000", "+1.5", '"every 3"', '"loads.csv"', '"/dev/zero"', '"."', "0.5", "7", "100000",
)  # fmt: skip
"""Values that replace a value of a text."""

VALUES: tuple[Any, ...] = (
    math.nan, math.inf, -math.inf, 0, -1, 1, 7, 2**62, -(2**62), 1e308, 5e-324, 0.5, True, "", "x", "path", "all",
    b"bytes", [1, 2, 3], [], [[1.0, 2.0]], ["a", "b"],
)  # fmt: skip
"""Values that replace a value of a result or of an index."""


# -- the files before any change -----------------------------------------------------------------------------


def prepare(folder: Path) -> None:
    """Write the files of all kinds into a folder."""
    for number, text in enumerate(CASES):
        (folder / f"case{number}.toml").write_text(text)
    (folder / "loads.csv").write_text(CSV)
    (folder / "lug.toml").write_text(LUG_EXAMPLE)
    (folder / "joint.toml").write_text(JOINT_EXAMPLE)
    pair = fastpin.MaterialPair(fastpin.MATERIALS["steel"], fastpin.MATERIALS["aluminium"])
    problem = fastpin.Problem.from_load_parameter(pair, 0.1, 0.4)
    history = fastpin.LoadHistory([{"P": 1.0}]) + fastpin.LoadHistory([{"Q": 0.2}, {"Q": -0.2}]).repeated(4)
    recording.record(problem, history, folder / "result.h5", nodes=NODES, between=1, save_after=[2], title="recorded")
    store.save(fastpin.solve(problem, history, nodes=NODES), folder / "saved.h5")
    _write_unfinished(problem, history, folder)
    plan = plans.parse_plan(PLAN)
    sweep.run(plan, folder / "sweep", executor=Inline())
    shutil.copytree(folder / "sweep", folder / "part")
    (folder / "plan.toml").write_text(PLAN)


def _write_unfinished(problem: fastpin.Problem, history: fastpin.LoadHistory, folder: Path) -> None:
    """Write a result whose run has stopped half-way, with a journal of a transaction that was not committed."""
    path = folder / "unfinished.h5"

    def stop(done: float, total: int) -> None:
        if done >= 5.0:
            raise KeyboardInterrupt

    with contextlib.suppress(KeyboardInterrupt):
        recording.record(problem, history, path, nodes=NODES, arc=(-3.1, 0.0), shortcut=False, progress=stop)
    journaled = JournaledFile(path, new=False)
    before = journaled.read(64)
    journaled.seek(0)
    journaled.write(memoryview(before))
    journaled.release()


# -- changes -------------------------------------------------------------------------------------------------


def change_bytes(rng: np.random.Generator, data: bytes) -> bytes:
    """Flip, cut, double, remove, swap or insert some bytes."""
    if not data:
        return bytes(rng.integers(0, 256, 5, dtype=np.uint8))
    changed = bytearray(data)
    way = rng.integers(6)
    first, last = sorted(int(place) for place in rng.integers(0, len(data) + 1, 2))
    if way == 0:
        for place in rng.integers(0, len(data), int(rng.integers(1, 20))):
            changed[place] ^= 1 << int(rng.integers(8))
    elif way == 1:
        del changed[first:]
    elif way == 2:
        changed[last:last] = changed[first:last]
    elif way == 3:
        del changed[first : min(last, first + 200)]
    elif way == 4:
        changed[first:first] = rng.integers(0, 256, int(rng.integers(1, 40)), dtype=np.uint8).tobytes()
    else:
        changed[first:last] = bytes(last - first)
    return bytes(changed)


def change_text(rng: np.random.Generator, text: str) -> str:
    """Rename keys, replace values, remove, double or move lines and sections of a TOML or CSV text."""
    lines = text.split("\n")
    for _ in range(int(rng.integers(1, 4))):
        place = int(rng.integers(len(lines)))
        word = str(rng.choice(np.array(WORDS, dtype=object)))
        way = rng.integers(9)
        if way <= 2:
            lines[place] = re.sub(r"=.*", lambda _, word=word: f"= {word}", lines[place], count=1)
        elif way == 3:
            lines[place] = re.sub(r"^\s*\w+", lambda found: found[0] + "x", lines[place])
        elif way == 4:
            del lines[place]
        elif way == 5:
            lines.insert(place, lines[int(rng.integers(len(lines)))])
        elif way == 6:
            lines[place] = re.sub(r"-?\d[\d.e+-]*", lambda _, word=word: word, lines[place], count=1)
        elif way == 7:
            sections = [k for k, line in enumerate(lines) if line.startswith("[")]
            if sections:
                start = sections[int(rng.integers(len(sections)))]
                stop = min([k for k in sections if k > start], default=len(lines))
                del lines[start:stop]
        else:
            lines.insert(place, f"{word}{lines[place]}" if rng.random() < 0.5 else word)
        lines = lines or [""]
    return "\n".join(lines)


def change_result(rng: np.random.Generator, path: Path) -> None:
    """Change attributes and datasets of an HDF5 file: their values, types and shapes, or remove or rename them."""
    with h5py.File(path, "r+") as file:
        names: list[str] = ["/"]
        file.visit(names.append)
        for _ in range(int(rng.integers(1, 4))):
            name = names[int(rng.integers(len(names)))]
            if name not in file:
                continue
            item = file[name]
            value = VALUES[int(rng.integers(len(VALUES)))]
            attributes = list(item.attrs)
            with contextlib.suppress(TypeError, OSError, ValueError, RuntimeError, KeyError, OverflowError):
                if attributes and rng.random() < 0.5:
                    chosen = attributes[int(rng.integers(len(attributes)))]
                    if rng.random() < 0.25:
                        del item.attrs[chosen]
                    else:
                        item.attrs[chosen] = value
                elif name == "/":
                    item.attrs["more"] = value
                elif rng.random() < 0.2:
                    del file[name]
                elif rng.random() < 0.2:
                    file.move(name, f"{name}x")
                elif isinstance(item, h5py.Dataset):
                    _change_dataset(rng, file, name, value)


def _change_dataset(rng: np.random.Generator, file: h5py.File, name: str, value: Any) -> None:
    dataset = file[name]
    way = rng.integers(5)
    if way == 0 and dataset.size:
        flat = dataset[()].ravel()
        flat[int(rng.integers(flat.size))] = value
        dataset[...] = flat.reshape(dataset.shape)
    elif way == 1 and dataset.maxshape and dataset.maxshape[0] is None:
        dataset.resize(int(rng.choice([0, 1, len(dataset) + 1, len(dataset) + 1000])), axis=0)
    else:
        old = dataset[()]
        attributes = dict(dataset.attrs)
        del file[name]
        if way == 2:
            with np.errstate(invalid="ignore"):
                file[name] = np.asarray(old).astype(rng.choice(["f4", "i8", "S5", "?", "c16"]))
        elif way == 3:
            file[name] = np.asarray(old).reshape(-1)[: max(1, np.size(old) // 2)]
        else:
            file[name] = value
        for key in ("unit", "columns"):
            if key in attributes:
                file[name].attrs[key] = attributes[key]


def change_index(rng: np.random.Generator, path: Path) -> None:
    """Change rows, columns and tables of the index of a sweep."""
    with contextlib.closing(sqlite3.connect(path, isolation_level=None)) as database:
        columns = [row[1] for row in database.execute("PRAGMA table_info(runs)")]
        for _ in range(int(rng.integers(1, 4))):
            column = str(rng.choice(columns)).replace('"', '""')
            value = VALUES[int(rng.integers(len(VALUES)))]
            value = json.dumps(value) if isinstance(value, (list, bool)) else value
            statements = (
                (f'UPDATE runs SET "{column}" = ? WHERE rowid = ?', (value, int(rng.integers(1, 5)))),
                (f'UPDATE runs SET "{column}" = ?', (value,)),
                ("UPDATE sweep SET value = ? WHERE name = ?", (value, str(rng.choice(["version", "plan", "fields"])))),
                (
                    "DELETE FROM sweep WHERE name = ?",
                    (str(rng.choice(["version", "plan", "text", "fields", "title"])),),
                ),
                ("DELETE FROM runs WHERE rowid = ?", (int(rng.integers(1, 5)),)),
                ("UPDATE results SET content = ? WHERE rowid = ?", (value, int(rng.integers(1, 5)))),
                ("UPDATE results SET content = substr(content, 1, ?)", (int(rng.integers(20_000)),)),
                (f'ALTER TABLE runs RENAME COLUMN "{column}" TO "other"', ()),
                (f'ALTER TABLE runs DROP COLUMN "{column}"', ()),
                (f"DROP TABLE {rng.choice(['runs', 'sweep', 'results'])}", ()),
                (f"PRAGMA user_version = {int(rng.integers(5))}", ()),
                (f"PRAGMA application_id = {int(rng.integers(5))}", ()),
                ("UPDATE sweep SET value = ? WHERE name = 'fields'", (str(rng.choice(["[]", "{", '{"a": 1}', "5"])),)),
                (f'ALTER TABLE runs ADD COLUMN "{column}x"', ()),
            )
            statement, values = statements[int(rng.integers(len(statements)))]
            with contextlib.suppress(sqlite3.Error, OverflowError):
                database.execute(statement, values)


# -- attempts ------------------------------------------------------------------------------------------------


class Examination:
    """Attempts with one changed file.

    Parameters
    ----------
    folder : Path
        The folder of the files.

    Attributes
    ----------
    outside : Path
        A folder beside it that nothing may touch.
    operator : str
        Name of the change.
    findings : list of str
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.outside = folder.with_name("outside")
        self.operator = "random"
        self.findings: list[str] = []

    def python(self, name: str, call: Callable[[], Any], may_change: tuple[str, ...] = ()) -> Any:
        """Call a function. A :class:`FastpinError` with one short sentence is allowed."""
        before = digests(self.folder)
        value = None
        try:
            value = call()
        except FastpinError as error:
            self._check_message(name, str(error))
        except KeyboardInterrupt:
            pass
        except BaseException as error:
            self._report_raw(name, error)
        self._compare(name, before, may_change)
        return value

    def command(self, *words: str | Path, may_change: tuple[str, ...] = ()) -> None:
        """Run a command. Its exit code must be 0, 1 or 2; an error needs a message."""
        name = f"fastpin {' '.join(str(word).rpartition('/')[2] for word in words)}"
        before = digests(self.folder)
        output, errors = io.StringIO(), io.StringIO()
        try:
            with contextlib.redirect_stdout(output), contextlib.redirect_stderr(errors):
                code = fastpin_command([str(word) for word in words])
            if code not in (0, 1, 2):
                self.findings.append(f"{name}: exit code {code}")
            if code:
                self._check_message(name, errors.getvalue() or (output.getvalue() if code == 1 else ""))
            if "Traceback" in errors.getvalue():
                self.findings.append(f"{name}: a traceback")
        except BaseException as error:
            self._report_raw(name, error)
        self._compare(name, before, may_change)

    def _check_message(self, name: str, message: str) -> None:
        lines = message.strip().split("\n")
        if not message.strip() or len(lines) > MOST_LINES or max(map(len, lines)) > LONGEST_LINE:
            self.findings.append(f"{name}: a bad message: {message[:500]!r}")

    def _report_raw(self, name: str, error: BaseException) -> None:
        place = [part for part in traceback.extract_tb(error.__traceback__) if "/fastpin/" in part.filename][-1:]
        where = f" in {place[0].filename.rpartition('/fastpin/')[2]}:{place[0].lineno}" if place else ""
        self.findings.append(f"{name}: {type(error).__name__}: {str(error)[:200]}{where}")

    def _compare(self, name: str, before: dict[str, str], may_change: tuple[str, ...]) -> None:
        after = digests(self.folder)
        for path in sorted(set(before) | set(after)):
            if before.get(path) != after.get(path) and not any(re.search(allowed, path) for allowed in may_change):
                what = "made" if path not in before else "removed" if path not in after else "changed"
                self.findings.append(f"{name}: {path} was {what}")


def digests(folder: Path) -> dict[str, str]:
    """What every path in a folder and in the folder outside is, by its relative path: a digest, a link or a kind."""
    found = {}
    for path in [*folder.rglob("*"), *folder.with_name("outside").rglob("*")]:
        mode = path.lstat().st_mode
        if stat.S_ISREG(mode) and path.stat().st_size > MOST_DIGESTED:
            kept = f"{path.stat().st_size} {path.stat().st_mtime_ns}"
        elif stat.S_ISREG(mode):
            kept = hashlib.sha256(path.read_bytes()).hexdigest()
        else:
            kept = str(path.readlink()) if stat.S_ISLNK(mode) else str(stat.S_IFMT(mode))
        found[os.path.relpath(path, folder)] = kept
    return found


def change_hostile(
    rng: np.random.Generator, operators: dict[str, hostile.Operator], path: Path, seen: Examination
) -> None:
    """Apply a random one of the hostile operators to a file."""
    seen.operator = str(rng.choice(list(operators)))
    operators[seen.operator](rng, path, seen.outside)


def change_case(rng: np.random.Generator, folder: Path, seen: Examination) -> Path:
    """Change a case file."""
    return _change_text_file(rng, folder / f"case{int(rng.integers(len(CASES)))}.toml")


def change_csv(rng: np.random.Generator, folder: Path, seen: Examination) -> Path:
    """Change a load history in a CSV file."""
    return _change_text_file(rng, folder / "loads.csv")


def change_lug(rng: np.random.Generator, folder: Path, seen: Examination) -> Path:
    """Change a lug file."""
    return _change_text_file(rng, folder / "lug.toml")


def change_joint(rng: np.random.Generator, folder: Path, seen: Examination) -> Path:
    """Change a joint file."""
    return _change_text_file(rng, folder / "joint.toml")


def _change_text_file(rng: np.random.Generator, path: Path) -> Path:
    if rng.random() < 0.3:
        path.write_bytes(change_bytes(rng, path.read_bytes()))
    else:
        path.write_text(change_text(rng, path.read_text()), encoding="utf-8", errors="surrogatepass")
    return path


def change_finished(rng: np.random.Generator, folder: Path, seen: Examination) -> Path:
    """Change a finished result, or put something beside it."""
    path = folder / str(rng.choice(["result.h5", "saved.h5"]))
    if rng.random() < HOSTILE:
        change_hostile(rng, hostile.RESULT, path, seen)
    elif rng.random() < 0.3:
        path.write_bytes(change_bytes(rng, path.read_bytes()))
    else:
        change_result(rng, path)
    return path


def change_unfinished(rng: np.random.Generator, folder: Path, seen: Examination) -> Path:
    """Change an unfinished result, its journal or both."""
    path, journal = folder / "unfinished.h5", folder / "unfinished.h5.journal"
    way = rng.integers(4)
    if rng.random() < HOSTILE:
        if rng.random() < 0.5:  # a hostile file, or a hostile journal of an honest one
            journal.unlink()
            change_hostile(rng, hostile.RESULT, path, seen)
        else:
            seen.operator = "beside"
            hostile.beside_result(rng, path, seen.outside)
    elif way == 0:
        path.write_bytes(change_bytes(rng, path.read_bytes()))
    elif way == 1:
        journal.unlink()
        change_result(rng, path)
    else:
        journal.write_bytes(change_bytes(rng, journal.read_bytes()))
    return path


def change_sweep(rng: np.random.Generator, folder: Path, seen: Examination) -> Path:
    """Change the index of a sweep, or put something beside it."""
    path = folder / "sweep" / "index.sqlite"
    if rng.random() < HOSTILE:
        change_hostile(rng, hostile.INDEX, path, seen)
    elif rng.random() < 0.3:
        path.write_bytes(change_bytes(rng, path.read_bytes()))
    else:
        change_index(rng, path)
    return path


def change_plan(rng: np.random.Generator, folder: Path, seen: Examination) -> Path:
    """Change a plan, or name a function in it."""
    path = folder / "plan.toml"
    if rng.random() < HOSTILE:
        change_hostile(rng, hostile.PLAN, path, seen)
    else:
        _change_text_file(rng, path)
    if rng.random() < 0.5:
        shutil.copy(path, folder / "sweep" / "plan.toml")
    return path


# -- attempts ------------------------------------------------------------------------------------------------


def try_case(rng: np.random.Generator, path: Path, seen: Examination) -> None:
    """Read, check and run a case."""
    case = seen.python("read_case", lambda: fastpin.read_case(path))
    seen.command("check", path)
    plan = path.with_name("of-case.toml")
    text = f'case = "{path.name}"\n[grid]\n"contact.friction" = [0.1, 0.2]\n'
    seen.python("parse_plan", lambda: plans.parse_plan(text, folder=plan.parent))
    options = case.options if case is not None else None
    if case is None or (len(case.history) * len(options.fractions) <= LARGEST_RUN and (options.increments or 0) < 50):
        smaller = () if options is None or options.arc is not None else ("--nodes", "21")
        outputs = ("--json", path.with_name("out.json"))
        seen.command("run", path, *smaller, *outputs, may_change=("^out.json$",))


def try_csv(rng: np.random.Generator, path: Path, seen: Examination) -> None:
    """Read a history in a CSV file, and the case that names it."""
    seen.python("from_csv", lambda: fastpin.LoadHistory.from_csv(path))
    try_case(rng, path.with_name("case2.toml"), seen)


def try_lug(rng: np.random.Generator, path: Path, seen: Examination) -> None:
    """Read a lug file."""
    seen.python("read_lug", lambda: read_lug(path))


def try_joint(rng: np.random.Generator, path: Path, seen: Examination) -> None:
    """Read a joint file."""
    seen.python("read_joint", lambda: read_joint(path))


def try_unfinished(rng: np.random.Generator, path: Path, seen: Examination) -> None:
    """Read an unfinished result. Only ``resume`` may repair it."""
    try_result(rng, path, seen)
    seen.python("resume", lambda: recording.resume(path), (_of_run(path),))


def _of_run(path: Path) -> str:
    """A pattern of the files that continuing a run may change."""
    return rf"^{re.escape(path.name)}(\.journal|\.checkpoint)?$"


def try_result(rng: np.random.Generator, path: Path, seen: Examination) -> None:
    """Read a result, solve from its end, and continue it."""
    result = seen.python("load", lambda: store.load(path))
    seen.python("load some", lambda: store.load(path, states=[0, -1]))
    seen.python("load after", lambda: store.load(path, after=2))
    seen.python("stored_case", lambda: stored.StoredResult(path).case)
    seen.python("stored_error", lambda: stored.StoredResult(path).error)
    seen.python("load_points", lambda: stored.StoredResult(path).points.size)
    seen.python("to_xarray", lambda: export.to_xarray(path))
    if result is not None:
        seen.python("repr", lambda: repr(result))
        seen.python("to_dataframe", lambda: export.to_dataframe(result))
        seen.python("save", lambda: store.save(result, path.with_name("again.h5")), ("^again.h5$",))
        if result.restart is not None:
            seen.python("solve", lambda: fastpin.solve(result.problem, [{"P": 1.1}], start=result))
    output: tuple[str | Path, ...] = ("--json", path.with_name("out.json"))
    if rng.random() < 0.1:  # a figure takes long
        output = (*output, "--plot", path.with_name("out.png"))
    seen.command("show", path, *output, may_change=(r"^out\.(json|png)$",))
    seen.command("run", path.with_name("case0.toml"), "--start", path)
    seen.command("resume", path, may_change=(_of_run(path),))


def try_sweep(rng: np.random.Generator, path: Path, seen: Examination) -> None:
    """Read, merge, report and continue the sweep of an index."""
    directory = path.parent
    folder = directory.parent
    plan = plans.parse_plan(PLAN)
    seen.python("load", lambda: sweep.load(directory))
    seen.python("status", lambda: sweep.status(plan, directory))
    seen.python("rows", lambda: sweep.rows(plan, directory))
    for run in plan.runs:
        seen.python("load of a run", lambda run=run: store.load(directory / "results" / f"{run}.h5"))
    outputs: tuple[str | Path, ...] = ("--table", folder / "out.csv")
    if rng.random() < 0.1:  # a figure takes long
        outputs = (*outputs, "--plot", folder / "out.png")
    written = r"^out\.(csv|png|html)$"
    seen.command("sweep", folder / "plan.toml", "-o", directory, "--status", *outputs, may_change=(written,))
    seen.command("merge", "-o", folder / "whole", folder / "part", directory, may_change=("^whole(/|$)",))
    if rng.random() < 0.1:  # a page takes long
        seen.command("report", directory, "-o", folder / "out.html", may_change=(written,))
    ran = ("^sweep/", written)
    seen.command("sweep", folder / "plan.toml", "-o", directory, *outputs, may_change=ran)
    seen.python("run", lambda: sweep.run(plan, directory, executor=Inline(), retry=True), ran)


def try_plan(rng: np.random.Generator, path: Path, seen: Examination) -> None:
    """Read and run a plan. Reading runs no function."""
    folder = path.parent
    seen.python("read_plan", lambda: plans.read_plan(path))
    seen.python("read_outcomes", lambda: read_outcomes(path))
    seen.command("sweep", path, "-o", folder / "sweep", "--status")
    if rng.random() < 0.2:  # a page takes long
        seen.command("report", folder / "sweep", "-o", folder / "out.html", may_change=("^out.html$",))
    if not re.search(r"100000|99999", path.read_text(errors="replace")):
        seen.command("sweep", path, "-o", folder / "new", may_change=("^new(/|$)", "^ran$", "__pycache__"))


class Kind(NamedTuple):
    """A kind of file.

    Attributes
    ----------
    honest : str
        An unchanged file of the kind.
    change : callable
        ``change(rng, folder, seen)`` changes a file of a folder, and returns its path.
    attempt : callable
        ``attempt(rng, path, seen)`` makes all attempts with this file.
    """

    honest: str
    change: Callable[[np.random.Generator, Path, Examination], Path]
    attempt: Callable[[np.random.Generator, Path, Examination], None]


KINDS = {
    "case": Kind("case0.toml", change_case, try_case),
    "csv": Kind("loads.csv", change_csv, try_csv),
    "result": Kind("result.h5", change_finished, try_result),
    "unfinished": Kind("unfinished.h5", change_unfinished, try_unfinished),
    "index": Kind("sweep/index.sqlite", change_sweep, try_sweep),
    "lug": Kind("lug.toml", change_lug, try_lug),
    "joint": Kind("joint.toml", change_joint, try_joint),
    "plan": Kind("plan.toml", change_plan, try_plan),
}
"""The kinds of files."""


def examine(kind: str, seed: int, before: Path) -> list[str]:
    """Change one file in a copy of the folder `before`, try to read it in another process, and return the findings."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name) / "files"
        shutil.copytree(before, folder)
        hostile.prepare_outside(folder.with_name("outside"))
        report = Path(name) / "findings.json"
        process = os.fork()
        if process == 0:
            _work(kind, seed, folder, report)
        ended = _wait(process)
        if not report.exists():
            stack = report.with_suffix(".stack").read_text()
            first = re.search(r'File "([^"]+)"', stack)
            lines = re.findall(r"/(fastpin/.*)", stack)[:1]
            return [f"{kind} {seed}: {IN_LIBRARY if first and '/h5py/' in first[1] else f'{ended} {lines}'}"]
        said = json.loads(report.read_text())
        return [f"{kind} {seed}: {said['operator']}: {finding}" for finding in said["findings"]]


def warm(before: Path) -> None:
    """Make all attempts with unchanged files in this process: so no child has to import and compile everything again.

    Raises
    ------
    RuntimeError
        If an unchanged file leads to a finding.
    """
    here = mock.patch.object(workers, "through_processes", _through_this_process)
    for kind in KINDS.values():
        with tempfile.TemporaryDirectory() as name, here, warnings.catch_warnings():
            warnings.simplefilter("ignore")
            folder = Path(name) / "files"
            shutil.copytree(before, folder)
            seen = Examination(folder)
            with contextlib.chdir(folder):
                kind.attempt(np.random.default_rng(0), folder / kind.honest, seen)
                seen.command("show", folder / "saved.h5", "--plot", folder / "one.png", may_change=("^one.png$",))
            if seen.findings:
                raise RuntimeError(f"unchanged files: {seen.findings}")


def _work(kind: str, seed: int, folder: Path, report: Path) -> None:
    """Examine one file in this process, which ends here."""
    code = 1
    stack = report.with_suffix(".stack").open("w")
    faulthandler.enable(stack)
    try:
        logging.disable()
        warnings.simplefilter("error")
        warnings.simplefilter("ignore", InputWarning)  # a doubt about a value is no fault
        workers.through_processes = _through_this_process
        used = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
        resource.setrlimit(resource.RLIMIT_AS, (used + MOST_MEMORY, used + MOST_MEMORY))
        seen = Examination(folder)
        os.chdir(folder)
        rng = np.random.default_rng([seed, list(KINDS).index(kind)])
        path = KINDS[kind].change(rng, folder, seen)
        KINDS[kind].attempt(rng, path, seen)
        report.write_text(json.dumps({"operator": seen.operator, "findings": seen.findings}))
        code = 0
    except BaseException:
        traceback.print_exc()
    finally:
        os._exit(code)


def _through_this_process(_: int, tasks: Any, submit: Callable[..., Any], size: Any) -> Any:
    """Run tasks one after the other, in place of worker processes."""
    for task in tasks:
        yield (task,), submit(Inline(), (task,)).result()


def _wait(process: int) -> str:
    """Wait for a process, and say how it ended. It is killed after the longest time."""
    began = time.monotonic()
    while True:
        done, status = os.waitpid(process, os.WNOHANG)
        if done:
            return (
                f"ended by the signal {os.WTERMSIG(status)}" if os.WIFSIGNALED(status) else f"exit code {status >> 8}"
            )
        times = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()
        worked, waited = (
            int(times[11]) / os.sysconf("SC_CLK_TCK"),
            time.monotonic() - began,
        )  # of the user, not the system
        if worked > LONGEST or waited > LONGEST_WAIT:
            os.kill(process, signal.SIGABRT)  # faulthandler writes where the process is
            os.waitpid(process, 0)
            return f"no end after {worked:.0f} s of work in {waited:.0f} s"
        time.sleep(0.002)
