"""The child processes of tests. They hear signals as at a terminal, and none outlives its test.

``finished`` runs a program to its end. ``started`` yields a running process, to be read, signalled or killed::

    said = finished(fastpin("check", path)).stdout
    with started(python(PROGRAM, path), ignored=[signal.SIGINT]) as process:
        assert process.stdout.readline() == "ready\\n"
        process.send_signal(signal.SIGTERM)
        out, err = process.communicate()

Tests set no time limits. A process that runs longer than :data:`LONGEST` is killed with its children, so that
``readline``, ``wait`` and ``communicate`` end. Its exit code is then -9.
"""

import contextlib
import os
import re
import signal
import subprocess
import sys
import threading
from collections.abc import Collection, Iterator, Sequence
from pathlib import Path
from typing import Any

from fastpin.runtime.threads import STOPPING

ROOT = Path(__file__).resolve().parents[2]

LONGEST = 180.0
"""Longest life of a child process, s. On a busy machine a child of a second has taken half a minute."""


PROGRESS = re.compile(r"^fastpin: \d+%: .*\n?", re.MULTILINE)
"""A line of a log, which a busy machine has time for."""


def without_progress(said: str) -> str:
    """What a process has said beside its progress."""
    return PROGRESS.sub("", said)


def hear_interrupts() -> None:
    """Let this process hear SIGINT. A shell makes what a script starts in the background deaf to it."""
    if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
        signal.signal(signal.SIGINT, signal.default_int_handler)


def python(code: str, *words: object) -> list[str]:
    """Return the command that runs this code with these arguments."""
    return [sys.executable, "-c", code, *map(str, words)]


def fastpin(*words: object) -> list[str]:
    """Return the command line of fastpin with these arguments."""
    return [sys.executable, "-P", "-m", "fastpin", *map(str, words)]


@contextlib.contextmanager
def started(command: Sequence[object], ignored: Collection[int] = (), **more: Any) -> Iterator[subprocess.Popen[Any]]:
    """Yield a process with pipes in a process group of its own. Kill the group when the block ends.

    Parameters
    ----------
    command : sequence
    ignored : collection of int
        Signals of STOPPING that the process is to ignore. It hears the others, whatever this process does.
    **more
        Arguments of ``subprocess.Popen``. By default the process runs in the project's directory and reads nothing.
    """
    usual = {"cwd": ROOT, "text": True, "stdin": subprocess.DEVNULL, "start_new_session": True}
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
    with _inherited(ignored):
        process = subprocess.Popen(list(map(str, command)), **usual | pipes | more)
    limit = threading.Timer(LONGEST, _kill, [process])
    limit.daemon = True
    limit.start()
    try:
        yield process
    finally:
        limit.cancel()
        _kill(process)
        process.wait()
        for stream in (process.stdin, process.stdout, process.stderr):
            if stream is not None:
                stream.close()


def finished(
    command: Sequence[object], said: str | None = None, check: bool = True, **more: Any
) -> subprocess.CompletedProcess[Any]:
    """Run a process to its end, with a text on its standard input. `check`: its exit code must be 0."""
    if said is not None:
        more["stdin"] = subprocess.PIPE
    with started(command, **more) as process:
        out, err = process.communicate(said)
    assert process.returncode == 0 or not check, f"exit code {process.returncode}: {err}"
    return subprocess.CompletedProcess(process.args, process.returncode, out, err)


@contextlib.contextmanager
def _inherited(ignored: Collection[int]) -> Iterator[None]:
    """A new process inherits that a signal is ignored. In place of a handler it gets the usual action."""
    before = [(number, signal.getsignal(number)) for number in STOPPING]
    try:
        for number in STOPPING:
            signal.signal(number, signal.SIG_IGN if number in ignored else signal.default_int_handler)
        yield
    finally:
        for number, handler in before:
            signal.signal(number, handler)


def _kill(process: subprocess.Popen[Any]) -> None:
    """Kill a process and its children."""
    with contextlib.suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)
