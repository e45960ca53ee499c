"""Kill commands, stop them, or let their disk be full, and check their files.

A :class:`Trial` disturbs a command that writes, at random moments:

- killed: SIGKILL hits its main process, a worker or the scheduler. An output is then whole: the old one or the new one.
- full: no file may grow beyond a random size. The exit code is then 1. One sentence names the file. The old output is
  whole, and there is no other new file.
- stopped: SIGSTOP holds a worker or a reader for a moment.
- shared: a second process writes to the same output, and is refused.

After each disturbance the command is called again, undisturbed. Its files must then hold the bits of a call that nobody
has disturbed. :func:`kill_run` and :func:`kill_sweep` kill one long run or sweep again and again.
"""

from __future__ import annotations

import logging
import os
import re
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from contextlib import ExitStack, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np

from fastpin.casefile.lug import LUG_EXAMPLE
from fastpin.errors import InputError
from fastpin.model.history import LoadHistory
from fastpin.model.materials import MATERIALS, MaterialPair
from fastpin.model.problem import Problem
from fastpin.states.cycles import CYCLE_KINDS
from fastpin.storage import recording, store, writer
from fastpin.storage.files import BESIDE_RESULT
from fastpin.storage.journal import is_empty
from fastpin.storage.layout import NODE_FIELDS, NUMBER_FIELDS
from fastpin.storage.stored import StoredResult
from fastpin.studies import sweep
from fastpin.studies.plan import read_plan
from tests.support.processes import without_progress

CASE = """
[dundurs]
alpha = 0.2
beta = 0.05
nu_pin = 0.3
[contact]
load_parameter = 0.4
friction = 0.5
[[load]]
P = 1.0
[[load]]
mean = {P = 1.0}
amplitude = {Q = 0.2, M = 0.03}
phase = {M = 40.0}
points = 12
repeat = 25
[solve]
nodes = 101
shortcut = false
"""

PLAN = """
case = "case.toml"
[grid]
contact.friction = { from = 0.2, to = 0.8, count = COUNT }
solve.nodes = [61]
"""

FASTPIN = (sys.executable, "-m", "fastpin")

HERE = (sys.executable, "-m", "tests.survey.outages")
"""This file as a program, which calls :func:`cluster` or :func:`work`."""

ROOT = Path(__file__).resolve().parents[2]

LONGEST = 300.0
"""Seconds after which a command counts as hanging."""


@dataclass(frozen=True)
class Command:
    """A command that writes.

    Attributes
    ----------
    words : tuple of str
        The command, called in a folder with the input files.
    output : str
        The file or directory that it writes.
    again : tuple of str
        The command that continues or repeats it.
    grows : bool
        Whether the output grows in place. A disturbed one is then shorter, and stays.
    """

    words: tuple[str, ...]
    output: str
    again: tuple[str, ...] = ()
    grows: bool = False


_SWEEP = ("sweep", "plan.toml", "-o", "sweep")

COMMANDS = {
    "record": Command(("run", "case.toml", "-o", "out.h5"), "out.h5", ("resume", "out.h5"), grows=True),
    "json": Command(("run", "case.toml", "--json", "out.json"), "out.json"),
    "sweep": Command((*_SWEEP, "--workers", "2"), "sweep", grows=True),
    "dask": Command((*_SWEEP, "--dask", "ADDRESS"), "sweep", (*_SWEEP, "--workers", "1"), grows=True),
    "compliance": Command(("compliance", "lug.toml", "-o", "out.json"), "out.json"),
    "report": Command(("report", "result.h5", "-o", "out.html"), "out.html"),
    "figure": Command(("plot", "result.h5", "tractions", "-o", "out.png"), "out.png"),
    "table": Command((*_SWEEP[:2], "-o", "done", "--status", "--table", "out.csv"), "out.csv"),
}
"""The commands that write."""


def prepare(folder: Path) -> None:
    """Write the input files of all commands."""
    (folder / "case.toml").write_text(CASE)
    (folder / "plan.toml").write_text(PLAN.replace("COUNT", "8"))
    (folder / "lug.toml").write_text(LUG_EXAMPLE)
    call(folder, "run", "case.toml", "-o", "result.h5")
    call(folder, "sweep", "plan.toml", "-o", "done", "--workers", "1")


def started(folder: Path, *words: str, limit: int | None = None) -> subprocess.Popen[str]:
    """Start fastpin in a folder, as the leader of a group of processes. No file may have more than `limit` bytes."""

    def limited() -> None:
        if limit is not None:
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
            resource.setrlimit(resource.RLIMIT_FSIZE, (limit, resource.RLIM_INFINITY))

    pipe = subprocess.PIPE
    return subprocess.Popen(
        [*FASTPIN, *words],
        cwd=folder, stdout=subprocess.DEVNULL, stderr=pipe, text=True, start_new_session=True, preexec_fn=limited,
    )  # fmt: skip


def call(folder: Path, *words: str) -> None:
    """Call fastpin, which must not fail."""
    process = started(folder, *words)
    said = process.communicate(timeout=LONGEST)[1]
    if process.returncode:
        raise RuntimeError(f"fastpin {' '.join(words)} has failed: {said}")


def children(process: int) -> list[int]:
    """The processes that a process has started, and theirs."""
    with suppress(OSError):
        found = [int(word) for word in Path(f"/proc/{process}/task/{process}/children").read_text().split()]
        return found + [other for child in found for other in children(child)]
    return []


def content(path: Path) -> object:
    """What must be equal in two outputs: states and cycles, rows of sweeps, pages without their date, or all bytes."""
    if path.is_dir():
        plan = read_plan(path.with_name("plan.toml"))
        return {row["id"]: (row["status"], content(_result(path, row["id"]))) for row in sweep.rows(plan, path)}
    if path.suffix == ".h5":
        result = store.load(path)
        of_cycles = [name for name in CYCLE_KINDS if name != "solved"]  # a resumed run does not know it
        pairs = (result, (*NODE_FIELDS, *NUMBER_FIELDS)), (result.cycles, of_cycles)
        return [
            [tuple(np.asarray(getattr(each, name)).tobytes() for name in fields) for each in found]
            for found, fields in pairs
        ]
    if path.suffix == ".html":
        return re.sub(r"Made by .* on [^<]*", "", re.sub(r"\d+(\.\d+)? s\b", "", path.read_text()))
    if path.suffix == ".json":
        return re.sub(r'"seconds": [^,\n}]*', "", path.read_text())
    return path.read_bytes()


class Trial:
    """Disturbances of one command, in copies of a folder.

    Attributes
    ----------
    findings : list of str
    counts : Counter of str
        Disturbances that hit the command at work, by their kind.
    """

    def __init__(self, name: str, before: Path, folder: Path) -> None:
        self.name, self.command = name, COMMANDS[name]
        self.findings: list[str] = []
        self.counts: Counter[str] = Counter()
        self._before, self._folder = before, folder
        self._number = 0
        undisturbed = self._copy()
        began = time.monotonic()
        self._call(undisturbed, *self.command.words)
        self._seconds = time.monotonic() - began
        self._expected = content(undisturbed / self.command.output)
        self._bytes = max(path.stat().st_size for path in _files(undisturbed, self.command.output))

    def disturb(self, way: str, seed: int) -> None:
        """Disturb the command in one of the :data:`WAYS`."""
        self._rng = np.random.default_rng([seed, list(COMMANDS).index(self.name)])
        getattr(self, way)()

    def kill(self) -> None:
        """Kill the command, a worker or the scheduler at a random moment."""
        folder = self._copy()
        old = self._old_output(folder)
        with ExitStack() as stack:
            process, others = self._started(folder, stack)
            time.sleep(self._rng.uniform(0.1, 1.0) * self._seconds)
            victims = [process.pid, *[other for other in others + children(process.pid) if _is_worker(other)]]
            victim = victims[0] if self._rng.random() < 0.5 else int(self._rng.choice(victims))
            hit = process.poll() is None
            with suppress(ProcessLookupError):
                os.kill(victim, signal.SIGKILL)
            process.communicate(timeout=LONGEST)
            _end(process)
        kind = "killed" if victim == process.pid else "worker killed"
        self.counts[kind] += hit
        output = folder / self.command.output
        if not self.command.grows and output.read_bytes() != old and content(output) != self._expected:
            self.findings.append(f"{self.name}: {kind}: the output is in part")
        self._finish(kind, folder)

    def fill(self) -> None:
        """Let no file grow beyond a random size."""
        folder = self._copy()
        old = self._old_output(folder)
        before = _names(folder)
        limit = int(self._rng.uniform(0.0, 0.97) * self._bytes)
        process = started(folder, *self._words(self.command.words), limit=limit)
        said = without_progress(process.communicate(timeout=LONGEST)[1]).strip()
        self.counts["full"] += 1
        lines = [line for line in said.split("\n") if line.startswith("fastpin: ") and "warning" not in line]
        is_said = len(lines) == 1 and self._is_named(lines[0]) and "Traceback" not in said
        if process.returncode != 1 or not is_said:
            self.findings.append(f"{self.name}: full at {limit} bytes: exit code {process.returncode}: {said[-600:]}")
        output = folder / self.command.output
        if not self.command.grows and (output.read_bytes() != old or _names(folder) != before):
            self.findings.append(f"{self.name}: full at {limit} bytes: files are left or changed")
        beside = {self.command.output + ending for ending in BESIDE_RESULT}  # A run needs them to go on.
        if self.command.grows and (extra := _names(folder) - before - {self.command.output} - beside):
            self.findings.append(f"{self.name}: full at {limit} bytes: {', '.join(sorted(extra))} left")
        self._finish(f"full at {limit} bytes", folder)

    def stop(self) -> None:
        """Hold the command, a worker or a reader of its output for a moment."""
        folder = self._copy()
        with ExitStack() as stack:
            process, others = self._started(folder, stack)
            time.sleep(self._rng.uniform(0.2, 1.0) * self._seconds)
            reader = started(folder, "show", "out.h5") if self.name == "record" else None
            time.sleep(self._rng.uniform(0.0, 0.5) if reader else 0.0)
            victims = [reader.pid] if reader else [o for o in others + children(process.pid) if _is_worker(o)]
            victim = int(self._rng.choice(victims or [process.pid]))
            with suppress(ProcessLookupError):
                os.kill(victim, signal.SIGSTOP)
                time.sleep(1.0)
                os.kill(victim, signal.SIGCONT)
            self.counts["stopped"] += process.poll() is None
            process.communicate(timeout=LONGEST)
            if reader is not None:
                said = reader.communicate(timeout=LONGEST)[1]
                if "Traceback" in said:
                    self.findings.append(f"{self.name}: a reader: {said[-500:]}")
        if process.returncode or content(folder / self.command.output) != self._expected:
            self.findings.append(f"{self.name}: stopped: exit code {process.returncode}, or other bits")
        shutil.rmtree(folder)

    def share(self) -> None:
        """Write to one output from two processes, and read it meanwhile."""
        folder = self._copy()
        process = started(folder, *self.command.words)
        second: subprocess.Popen[str] | None = None
        found = 0
        while process.poll() is None:
            path = folder / self.command.output
            if path.suffix == ".h5" and path.exists() and path.stat().st_size:
                with suppress(InputError):  # the run has not begun
                    now = StoredResult(path).points.size
                    if now < found:
                        self.findings.append(f"{self.name}: a reader saw {now} states after {found}")
                    found = now
            if second is None and (path.is_dir() or found):
                more = ("--overwrite",) if path.suffix == ".h5" else ()
                second = started(folder, *self.command.words, *more)
                said = second.communicate(timeout=LONGEST)[1]
                hit = process.poll() is None
                self.counts["two writers"] += hit
                if hit and (second.returncode != 2 or "another" not in said):
                    self.findings.append(f"{self.name}: a second writer: exit code {second.returncode}: {said[-300:]}")
            time.sleep(0.01)
        process.communicate()
        if content(folder / self.command.output) != self._expected:
            self.findings.append(f"{self.name}: two writers: other bits")
        shutil.rmtree(folder)

    def _is_named(self, line: str) -> bool:
        """Whether a sentence names the output, or the directory of temporary files."""
        return self.command.output in line or (tempfile.gettempdir() in line and "TMPDIR" in line)

    def _copy(self) -> Path:
        self._number += 1
        folder = self._folder / f"{self.name}{self._number}"
        shutil.copytree(self._before, folder)
        return folder

    def _old_output(self, folder: Path) -> bytes:
        """Write an older output, unless the output grows."""
        if not self.command.grows:
            (folder / self.command.output).write_bytes(b"old")
        return b"old"

    def _words(self, words: tuple[str, ...]) -> tuple[str, ...]:
        """The words of a command, without dask in place of its address."""
        return words if "ADDRESS" not in words else (*words[: words.index("--dask")], "--workers", "1")

    def _call(self, folder: Path, *words: str) -> None:
        call(folder, *self._words(words))

    def _started(self, folder: Path, stack: ExitStack) -> tuple[subprocess.Popen[str], list[int]]:
        """Start the command, and for dask its cluster first. Return it and the processes of the cluster."""
        if "ADDRESS" not in self.command.words:
            return started(folder, *self.command.words), []
        program = [*HERE, "cluster"]
        process = subprocess.Popen(program, cwd=ROOT, stdout=subprocess.PIPE, text=True, stderr=subprocess.DEVNULL)
        stack.callback(_end_cluster, process)
        assert process.stdout is not None
        address = process.stdout.readline().strip()
        words = [address if word == "ADDRESS" else word for word in self.command.words]
        return started(folder, *words), [process.pid, *children(process.pid)]

    def _finish(self, kind: str, folder: Path) -> None:
        """Call the command again, and compare its output with that of an undisturbed call."""
        output = folder / self.command.output
        again = self.command.again or self.command.words
        if output.suffix == ".h5":
            if not output.exists() or is_empty(output):
                again = self.command.words
            elif not store.is_unfinished(output):
                again = ()
        if again:
            process = started(folder, *self._words(again))
            said = process.communicate(timeout=LONGEST)[1]
            if process.returncode:
                self.findings.append(f"{self.name}: after {kind}: exit code {process.returncode}: {said[-400:]}")
                return
        if content(output) != self._expected:
            self.findings.append(f"{self.name}: after {kind}: other bits")
        if output.suffix == ".h5" and (left := _names(folder) - _names(self._before) - {output.name}):
            self.findings.append(f"{self.name}: after {kind}: {', '.join(sorted(left))} left")
        shutil.rmtree(folder)


def _files(folder: Path, name: str) -> list[Path]:
    path = folder / name
    return [found for found in path.rglob("*") if found.is_file()] if path.is_dir() else [path]


def _names(folder: Path) -> set[str]:
    return {path.name for path in folder.iterdir()}


def _is_worker(process: int) -> bool:
    """Whether a process is no helper of multiprocessing."""
    with suppress(OSError):
        return b"tracker" not in Path(f"/proc/{process}/cmdline").read_bytes()
    return False


def _end(process: subprocess.Popen[str]) -> None:
    """End what a killed command has left: its group of processes."""
    with suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)


def _end_cluster(process: subprocess.Popen[str]) -> None:
    for found in (*children(process.pid), process.pid):
        with suppress(ProcessLookupError):
            os.kill(found, signal.SIGKILL)
    process.communicate()  # also closes its pipe


def cluster() -> None:
    """Run a scheduler and two workers of dask, and print the address."""
    from distributed import LocalCluster

    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as found:
        print(found.scheduler_address, flush=True)
        time.sleep(LONGEST)


WAYS = {
    "kill": tuple(COMMANDS),
    "fill": tuple(COMMANDS),
    "stop": ("record", "sweep", "dask"),
    "share": ("record", "sweep"),
}
"""Ways of disturbing, and the commands that each suits. Commands on dask are filled without it."""


# -- one run or sweep, killed again and again ----------------------------------------------------------------


class Kills(NamedTuple):
    """The number of kills that hit a process at work, and the findings."""

    hits: int
    findings: list[str]


def history(rounds: int) -> LoadHistory:
    """Rounds of ten equal cycles, which become periodic, and of 30 random loads."""
    rng = np.random.default_rng(0)
    whole = LoadHistory([{"P": 1.0}])
    for _ in range(rounds):
        steady = LoadHistory([{"Q": 0.2}, {"Q": -0.2}]).repeated(10)
        whole += steady + LoadHistory.from_array(rng.uniform(-0.28, 0.28, (30, 1)), ["Q"])
    return whole


def work(path: Path, rounds: int) -> None:
    """Begin a run, or continue it if its file exists. The log on standard error tells the states in the file."""
    logging.basicConfig(level=logging.DEBUG, format="%(message)s")
    logging.getLogger("numba").setLevel(logging.WARNING)
    writer.CHECKPOINT_EVERY, writer.CHECKPOINT_SHARE = 0.1, 1.0  # often: nobody waits for a killed process
    if path.exists():
        recording.resume(path)
        return
    pair = MaterialPair(MATERIALS["steel"], MATERIALS["steel"])
    problem = Problem.from_load_parameter(pair, 0.5, 0.55, "centre", "fixed")
    recording.record(problem, history(rounds), path, nodes=61, between=1)


def kill_run(folder: Path, most: int, rounds: int, longest: float = 1.0, seed: int = 0) -> Kills:
    """Kill a run up to `most` times, each time after up to `longest` seconds of work, then let it end.

    All states that it had acknowledged before a kill must be in its file. In the end the file must hold the bits of an
    undisturbed run.
    """
    path, whole, log, rng = folder / "killed.h5", folder / "whole.h5", folder / "said.txt", np.random.default_rng(seed)
    hits, findings = 0, []
    while hits < most and (not path.exists() or store.is_unfinished(path)):
        with log.open("w") as messages:
            process = subprocess.Popen([*HERE, "work", path, str(rounds)], cwd=ROOT, stderr=messages)
            while process.poll() is None and "in the file" not in log.read_text():
                time.sleep(0.01)
            time.sleep(rng.uniform(0.0, longest))
            process.kill()
        code = process.wait()
        if code not in (0, -signal.SIGKILL):
            return Kills(hits, [*findings, f"after {hits} kills: {log.read_text()[-600:]}"])
        hits += code != 0
        acknowledged = int(re.findall(r"(\d+) states in the file\n", log.read_text())[-1])
        if (stored := StoredResult(path).points.size) < acknowledged:
            findings.append(f"kill {hits}: {stored} of {acknowledged} acknowledged states")
    for each in (path, whole):
        subprocess.run([*HERE, "work", each, str(rounds)], cwd=ROOT, check=True, stderr=subprocess.DEVNULL)
    if content(path) != content(whole):
        findings.append("other bits than an undisturbed run")
    return Kills(hits, findings)


def kill_sweep(folder: Path, most: int, runs: int, longest: float = 1.0, seed: int = 0) -> Kills:
    """Kill the main process of a sweep up to `most` times, then let it end.

    All runs that were finished before a kill must be there, with their results. In the end all results must have the
    bits of a sweep in one process.
    """
    directory, rng = folder / "sweep", np.random.default_rng(seed)
    (folder / "case.toml").write_text(CASE)
    (folder / "plan.toml").write_text(PLAN.replace("COUNT", str(runs)))
    plan = read_plan(folder / "plan.toml")

    def finished() -> set[str]:
        return {row["id"] for row in sweep.rows(plan, directory) if row["status"] == "done"}

    hits, findings = 0, []
    while hits < most:
        known = finished()
        process = started(folder, *_SWEEP, "--workers", "2")
        while process.poll() is None and finished() == known:
            time.sleep(0.01)
        time.sleep(rng.uniform(0.0, longest))
        known, is_at_work = finished(), process.poll() is None
        process.kill()
        process.communicate()
        _end(process)
        if not is_at_work:
            break
        hits += 1
        there = {run for run in finished() if len(store.load(_result(directory, run)))}
        findings += [f"kill {hits}: {run} is lost" for run in known - there]
    call(folder, *_SWEEP, "--workers", "2")
    call(folder, *_SWEEP[:2], "-o", "serial", "--workers", "1")
    if content(directory) != content(folder / "serial"):
        findings.append("other bits than a sweep in one process")
    return Kills(hits, findings)


def _result(directory: Path, run: str) -> Path:
    return directory / "results" / f"{run}.h5"


if __name__ == "__main__":
    if sys.argv[1] == "cluster":
        cluster()
    else:
        work(Path(sys.argv[2]), int(sys.argv[3]))
