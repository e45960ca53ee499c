"""Signals that stop a command: what it keeps, what it says, and the signals that its parent has made it ignore."""

from __future__ import annotations

import itertools
import re
import signal
import subprocess
import time
from pathlib import Path

import numpy as np
import psutil
import pytest

from fastpin.casefile.reader import EXAMPLE
from fastpin.runtime.threads import STOPPING
from tests.support.processes import fastpin, python, started, without_progress
from tests.support.tiers import some_survey

pytestmark = [
    pytest.mark.gate,
    pytest.mark.skipif(
        not Path("/proc/self/status").exists(), reason="the kernel doesn't show which signals are ignored"
    ),
]

LOADS = np.random.default_rng(0).uniform(-7e5, 7e5, 3000).round(1).tolist()
INPUTS = {
    "long.toml": EXAMPLE.replace("[7.26e5, -7.26e5, 7.26e5]", str(LOADS)).replace("nodes = 401", "nodes = 201"),
    "cycles.toml": EXAMPLE.replace("Q = [7.26e5, -7.26e5, 7.26e5]", "Q = [7e5, -7e5]\nrepeat = 2"),
    "plan.toml": "[grid]\ncontact.friction = { from = 0.3, to = 0.5, count = 500 }\nsolve.nodes = [201]\n",
    "tolerances.toml": 'case = "long.toml"\n[tolerances]\ncontact.friction = { from = 0.3, to = 0.5, count = 500 }\n',
}

KEPT = r"\d+ of \d+ runs are finished and kept; the same command continues"
COMMANDS = {
    "run long.toml -o a.h5": (
        "a.h5",
        r" after \d+ of 3,001 corners; continue with: fastpin resume a.h5",
    ),
    "wear cycles.toml --cycles 1e7 --coefficient 1e-15 --nodes 61 -o a.h5": (
        "a.h5",
        r"( after .*)?; continue with the same command and --resume",
    ),
    "sweep plan.toml -o out --workers 2": ("out/index.sqlite", f"; {KEPT}"),
    "tolerances tolerances.toml -o out --workers 2": ("out/index.sqlite", f"; {KEPT}"),
    "converge long.toml --nodes 201,401,801": ("", ".*"),
    "report long.toml -o a.html": ("", ".*"),
    "paper -o .": ("", ".*"),
}
"""Commands of a minute or more: the first file of each, and what it says after "interrupted"."""

STOPPED = list(itertools.product(COMMANDS, (False, True)))
OTHERS = [(command, background) for command, background in STOPPED if bool(COMMANDS[command][0]) != background]
"""The gate stops in the background what writes files, and the others before a terminal."""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for name, text in INPUTS.items():
        (tmp_path / name).write_text(text)
    return tmp_path


def wait_for_work(process: subprocess.Popen[str], file: Path | None) -> None:
    """Wait until a command has written to a file, or has worked for so long that it has imported what it needs."""
    while process.poll() is None:
        if file is None and psutil.Process(process.pid).cpu_times().user > 1.5:
            return
        if file is not None and file.exists() and file.stat().st_size > 0:
            return
        time.sleep(0.02)
    raise AssertionError(process.communicate()[1])


def ignored_by(pid: int) -> set[int]:
    """The signals that a process ignores."""
    mask = int(re.search(r"SigIgn:\s*(\w+)", Path(f"/proc/{pid}/status").read_text())[1], 16)
    return {number for number in range(1, 65) if mask >> (number - 1) & 1}


@pytest.mark.parametrize(("command", "background"), some_survey(STOPPED, *OTHERS))
def test_a_signal_stops_a_command(folder: Path, command: str, background: bool) -> None:
    """`nohup` ignores SIGHUP, and a shell makes what a script starts in the background ignore SIGINT."""
    file, words = COMMANDS[command]
    deaf = [signal.SIGINT, signal.SIGHUP] if background else []
    with started(fastpin(*command.split()), ignored=deaf, cwd=folder) as process:
        wait_for_work(process, folder / file if file else None)
        assert set(deaf) == ignored_by(process.pid) & set(STOPPING)
        for number in deaf:
            process.send_signal(number)
        process.send_signal(signal.SIGTERM if background else signal.SIGHUP)
        said = process.communicate()[1]
    assert process.returncode == 130, said
    assert re.fullmatch(f"(fastpin: note: .*\n)?fastpin: interrupted{words}\n", without_progress(said)), said
    left = {path.name for path in folder.iterdir()} - {*INPUTS, "a.h5", "out"}
    assert not {name for name in left if name.startswith((".", "a."))}


LOST = """
import signal, sys, time, weakref
from fastpin.cli import main, texts
def stopped(_):
    signal.raise_signal(signal.SIGTERM)
def work(options):
    class Part:
        pass
    part = Part()
    link = weakref.ref(part, stopped)
    del part
    time.sleep(600)
    return 0
texts.check = work
sys.exit(main.main(["check", "a.toml"]))
"""
"""A command that hears its signal in the callback of a weak reference, where Python drops exceptions."""


def test_a_signal_inside_a_callback_is_not_lost() -> None:
    with started(python(LOST)) as process:
        said = process.communicate()[1]
    assert (process.returncode, said) == (130, "fastpin: interrupted\n")


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_a_signal_ends_the_live_page(number: int) -> None:
    deaf = {signal.SIGINT, signal.SIGHUP} - {number}
    with started(fastpin("live", "--no-browser", "--nodes", 21), ignored=deaf) as process:
        assert process.stdout.readline().startswith("live page: http")
        assert deaf == ignored_by(process.pid) & set(STOPPING)
        for other in deaf:
            process.send_signal(other)
        process.send_signal(number)
        said = process.communicate()[1]
    assert (process.returncode, said) == (0, "")
