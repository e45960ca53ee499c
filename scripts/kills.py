"""Kill a run again and again, and see whether anything is lost: ``python scripts/kills.py --kills 100``.

A load history is followed into a file by a process that is killed (SIGKILL) at a random moment, and gone on with by
another one, and so on. After every kill the file must hold all states that the process had acknowledged before; at the
end, the same bits as the file of a run that nobody disturbed.
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

from fastpin.model.history import LoadHistory
from fastpin.model.materials import MATERIALS, MaterialPair
from fastpin.model.problem import Problem
from fastpin.storage import recording, store, writer
from fastpin.storage.layout import CYCLE_FIELDS, NODE_FIELDS, NUMBER_FIELDS

NODES = 61
ROUNDS = 400
CHECKPOINT_EVERY = 0.1
"""Seconds; far more often than usual, because nobody waits for a process that is about to be killed."""


def history(rounds: int = ROUNDS) -> LoadHistory:
    """Cycles that become periodic, then loads that are different every time, again and again."""
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
    """Begin the run, or go on with it; say on standard error how many states are in the file."""
    logging.basicConfig(level=logging.DEBUG, format="%(message)s")
    logging.getLogger("numba").setLevel(logging.WARNING)
    writer.CHECKPOINT_EVERY, writer.CHECKPOINT_SHARE = CHECKPOINT_EVERY, 1.0
    if path.exists():
        recording.resume(path)
    else:
        recording.record(problem(), history(rounds), path, nodes=NODES, between=1)


def differences(one: Path, other: Path) -> list[str]:
    """Names of the arrays in which the states or cycles of two files differ."""
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
    names = [name for name in CYCLE_FIELDS if name != "solved"]  # who goes on does not know what was solved before
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
        "kills" that hit a run at work, "acknowledged" states that were "lost", most states "found again" after a kill,
        "states" in the end, arrays that are "different", and how often a kill fell into a "transaction".
    """
    path, said = folder / "killed.h5", folder / "said.txt"
    rng = np.random.default_rng(seed)
    found = {"kills": 0.0, "lost": 0.0, "acknowledged": 0.0, "transaction": 0.0}
    while found["kills"] < kills:
        with said.open("w") as messages:
            process = subprocess.Popen([sys.executable, __file__, "--work", path, str(rounds)], stderr=messages)
            while process.poll() is None and "in the file" not in said.read_text():
                time.sleep(0.01)
            time.sleep(rng.uniform(0.0, longest))
            process.send_signal(signal.SIGKILL)
        code = process.wait()
        if code == 0:
            break  # it has come to its end
        if code != -signal.SIGKILL:
            raise SystemExit(f"the run has failed, after {found['kills']:.0f} kills:\n{said.read_text()}")
        found["kills"] += 1
        journal = path.with_name(path.name + ".journal")
        found["transaction"] += journal.exists() and journal.stat().st_size > 0
        acknowledged = int(re.findall(r"(\d+) states in the file\n", said.read_text())[-1])
        stored = store.size(path)
        found["lost"] += max(acknowledged - stored, 0)
        found["acknowledged"] = stored
        if not store.is_unfinished(path):
            break
    if store.is_unfinished(path):
        work(path, rounds)
    undisturbed = folder / "undisturbed.h5"
    work(undisturbed, rounds)
    found["states"] = store.size(path)
    found["different"] = len(differences(path, undisturbed))
    return found


def main() -> None:
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--kills", type=int, default=100)
    parser.add_argument("--longest", type=float, default=1.0, help="seconds of work before a kill, at most")
    parser.add_argument("--rounds", type=int, default=ROUNDS, help="length of the history")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--work", nargs=2, metavar=("FILE", "ROUNDS"), help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.work:
        work(Path(options.work[0]), int(options.work[1]))
        return
    with tempfile.TemporaryDirectory() as folder:
        logging.disable()
        found = kill_until_done(Path(folder), options.kills, options.longest, options.rounds, options.seed)
    print(
        f"{found['kills']:.0f} kills, {found['transaction']:.0f} of them while the file was being written: "
        f"{found['lost']:.0f} acknowledged states lost; {found['states']:.0f} states in the end, "
        f"{found['different']:.0f} arrays different from an undisturbed run"
    )
    raise SystemExit(found["lost"] > 0 or found["different"] > 0)


if __name__ == "__main__":
    main()
