"""Kill a run or a sweep again and again, and check that nothing is lost: ``python scripts/kills.py --kills 100``.

A process follows a load history into a file, and is killed (SIGKILL) at a random moment. Another process continues, and
so on. After every kill the file must hold all states that the process had acknowledged before. At the end the file must
hold the same bits of states and cycles as the file of an undisturbed run, except for `solved`.

With ``--sweep RUNS`` the main process of a sweep is killed. After every kill all runs that were finished before must be
there, with their results. At the end all results must have the bits of a serial solution.
"""

from __future__ import annotations

import argparse
import logging
import re
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from fastpin.model.case import Case
from fastpin.model.history import LoadHistory
from fastpin.model.materials import MATERIALS, MaterialPair
from fastpin.model.problem import Problem
from fastpin.solver.solving import solve
from fastpin.storage import recording, store, writer
from fastpin.storage.layout import CYCLE_FIELDS, NODE_FIELDS, NUMBER_FIELDS
from fastpin.studies import sweep
from fastpin.studies.plan import Plan, read_plan

NODES = 61
ROUNDS = 400
CHECKPOINT_EVERY = 0.1
"""Seconds between checkpoints, far less than usual. Their cost does not matter: nobody waits for a killed process."""


def history(rounds: int = ROUNDS) -> LoadHistory:
    """Return the history: rounds of ten equal cycles, which become periodic, and 30 random loads."""
    rng = np.random.default_rng(0)
    whole = LoadHistory([{"P": 1.0}])
    for _ in range(rounds):
        steady = LoadHistory([{"Q": 0.2}, {"Q": -0.2}]).repeated(10)
        whole += steady + LoadHistory.from_array(rng.uniform(-0.28, 0.28, (30, 1)), ["Q"])
    return whole


def problem() -> Problem:
    """A steel pin in a steel plate, held at its centre."""
    steel = MATERIALS["steel"]
    return Problem.from_load_parameter(MaterialPair(steel, steel), 0.5, 0.55, "centre", "fixed")


def work(path: Path, rounds: int) -> None:
    """Begin the run, or continue it if its file exists. The log on standard error tells the states in the file."""
    logging.basicConfig(level=logging.DEBUG, format="%(message)s")
    logging.getLogger("numba").setLevel(logging.WARNING)
    writer.CHECKPOINT_EVERY, writer.CHECKPOINT_SHARE = CHECKPOINT_EVERY, 1.0
    if path.exists():
        recording.resume(path)
    else:
        recording.record(problem(), history(rounds), path, nodes=NODES, between=1)


def differences(one: Path, other: Path) -> list[str]:
    """Return the names of the arrays in which the states or cycles of two files differ."""
    first, second = store.load(one), store.load(other)
    if (len(first), len(first.cycles)) != (len(second), len(second.cycles)):
        return ["number of states or cycles"]
    differing = [
        name
        for name in (*NODE_FIELDS, *NUMBER_FIELDS)
        if any(
            not np.array_equal(getattr(a, name), getattr(b, name), equal_nan=True)
            for a, b in zip(first, second, strict=True)
        )
    ]
    names = [name for name in CYCLE_FIELDS if name != "solved"]  # a resumed run does not know what was solved before
    return differing + [
        name
        for name in names
        if any(getattr(a, name) != getattr(b, name) for a, b in zip(first.cycles, second.cycles, strict=True))
    ]


def kill_until_done(folder: Path, kills: int, longest: float, rounds: int, seed: int = 0) -> dict[str, float]:
    """Kill the run up to `kills` times, each time after up to `longest` seconds of work, then let it end.

    Returns
    -------
    dict of str to float
        "kills": kills that hit a run at work. "lost": acknowledged states that were not in the file. "acknowledged":
        states in the file after the last kill. "states": states in the end. "different": arrays that differ from an
        undisturbed run. "transaction": kills during a transaction.
    """
    path, log = folder / "killed.h5", folder / "said.txt"
    rng = np.random.default_rng(seed)
    found = {"kills": 0.0, "lost": 0.0, "acknowledged": 0.0, "transaction": 0.0}
    while found["kills"] < kills:
        with log.open("w") as messages:
            process = subprocess.Popen([sys.executable, __file__, "--work", path, str(rounds)], stderr=messages)
            while process.poll() is None and "in the file" not in log.read_text():
                time.sleep(0.01)
            time.sleep(rng.uniform(0.0, longest))
            process.send_signal(signal.SIGKILL)
        code = process.wait()
        if code == 0:
            break  # the run has ended
        if code != -signal.SIGKILL:
            raise SystemExit(f"the run has failed, after {found['kills']:.0f} kills:\n{log.read_text()}")
        found["kills"] += 1
        journal = path.with_name(path.name + ".journal")
        found["transaction"] += journal.exists() and journal.stat().st_size > 0
        acknowledged = int(re.findall(r"(\d+) states in the file\n", log.read_text())[-1])
        stored = store.load_points(path).size
        found["lost"] += max(acknowledged - stored, 0)
        found["acknowledged"] = stored
        if not store.is_unfinished(path):
            break
    if store.is_unfinished(path):
        work(path, rounds)
    undisturbed = folder / "undisturbed.h5"
    work(undisturbed, rounds)
    found["states"] = store.load_points(path).size
    found["different"] = len(differences(path, undisturbed))
    return found


PLAN = """
[grid]
contact.friction = {{ from = 0.1, to = 0.9, count = {runs} }}
solve.nodes = [{nodes}]
"""


def finished(plan: Plan, directory: Path) -> set[str]:
    """Return the ids of the runs that are finished."""
    return {row["id"] for row in sweep.rows(plan, directory) if row["status"] == "done"}


def kill_sweep(folder: Path, runs: int, kills: int, longest: float, seed: int = 0) -> dict[str, float]:
    """Kill a sweep up to `kills` times, each time after up to `longest` seconds of work, then let it end.

    Returns
    -------
    dict of str to float
        "kills"; "lost": finished runs, or their results, that were not there after a kill; "runs": finished runs in the
        end; "different": runs whose states differ from a serial solution.
    """
    path, directory, rng = folder / "plan.toml", folder / "sweep", np.random.default_rng(seed)
    path.write_text(PLAN.format(runs=runs, nodes=NODES))
    plan = read_plan(path)
    command = [sys.executable, "-m", "fastpin", "sweep", str(path), "-o", str(directory), "--workers", "2"]
    found = {"kills": 0.0, "lost": 0.0}
    while found["kills"] < kills:
        known = finished(plan, directory)
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        while process.poll() is None and finished(plan, directory) == known:
            time.sleep(0.01)
        time.sleep(rng.uniform(0.0, longest))
        known = finished(plan, directory)
        if process.poll() is not None:
            break  # the sweep has ended
        process.kill()
        process.wait()
        found["kills"] += 1
        there = finished(plan, directory)
        found["lost"] += len(known - there) + sum(not len(store.load(_result(directory, run))) for run in there)
    sweep.run(plan, directory, workers=2)
    found["runs"] = len(finished(plan, directory))
    found["different"] = sum(_differs(plan.case(point), _result(directory, run)) for run, point in plan.runs.items())
    return found


def _result(directory: Path, run: str) -> Path:
    return directory / "results" / f"{run}.h5"


def _differs(case: Case, path: Path) -> bool:
    """Whether a stored result has other bits than a solution in this process."""
    expected, stored = solve(case.problem, case.history, **case.options.keywords()), store.load(path)
    pairs = list(zip(expected, stored, strict=True))
    return not all(np.array_equal(getattr(a, name), getattr(b, name)) for a, b in pairs for name in NODE_FIELDS)


def main() -> None:
    """Run the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--kills", type=int, default=100)
    parser.add_argument("--longest", type=float, default=1.0, help="seconds of work before a kill, at most")
    parser.add_argument("--rounds", type=int, default=ROUNDS, help="length of the history")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--sweep", type=int, metavar="RUNS", help="kill a sweep of this many runs")
    parser.add_argument("--work", nargs=2, metavar=("FILE", "ROUNDS"), help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.work:
        work(Path(options.work[0]), int(options.work[1]))
        return
    with tempfile.TemporaryDirectory() as folder:
        logging.disable()
        if options.sweep:
            found = kill_sweep(Path(folder), options.sweep, options.kills, options.longest, options.seed)
            print(
                f"{found['kills']:.0f} kills: {found['lost']:.0f} finished runs lost; {found['runs']:.0f} runs in the "
                f"end, {found['different']:.0f} different from a serial solution"
            )
            raise SystemExit(found["lost"] > 0 or found["different"] > 0)
        found = kill_until_done(Path(folder), options.kills, options.longest, options.rounds, options.seed)
    print(
        f"{found['kills']:.0f} kills, {found['transaction']:.0f} of them while the file was being written: "
        f"{found['lost']:.0f} acknowledged states lost; {found['states']:.0f} states in the end, "
        f"{found['different']:.0f} arrays different from an undisturbed run"
    )
    raise SystemExit(found["lost"] > 0 or found["different"] > 0)


if __name__ == "__main__":
    main()
