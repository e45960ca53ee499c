"""A second process that compiles kernels while this one compiles others. Each stores its own and loads the other's."""

from __future__ import annotations

import contextlib
import functools
import os
import select
import sys
from pathlib import Path

from fastpin.runtime.threads import cores

module: str | None = None
"""The module that the second process runs, as soon as this one compiles a kernel and stores it. None: no process."""


@functools.cache
def start() -> int | None:
    """Start the second process, once. Return its number; None without a core for it, or without processes.

    Nothing waits for it. It reads from a pipe that the system closes when this process ends, however it ends.
    """
    if module is None or cores() < 2 or not sys.executable:
        return None
    code = "import runpy, sys; sys.path.append(sys.argv[1]); runpy.run_module(sys.argv[2], run_name='__main__')"
    words = [sys.executable, "-P", "-c", code, str(Path(__file__).parents[2]), module]
    with contextlib.suppress(OSError):
        reading, _ = os.pipe()  # the other end stays open, and no other program inherits it
        silent = [(os.POSIX_SPAWN_OPEN, number, os.devnull, os.O_WRONLY, 0) for number in (1, 2)]
        try:
            actions = [(os.POSIX_SPAWN_DUP2, reading, 0), *silent]
            return os.posix_spawn(words[0], words, os.environ, file_actions=actions)
        finally:
            os.close(reading)
    return None


def is_needed() -> bool:
    """Whether the process that has started this one still runs."""
    return not select.select([0], [], [], 0)[0]
