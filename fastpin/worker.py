"""What happens in a worker process of a sweep: one run after the other, each on one thread."""

from __future__ import annotations

import functools
import multiprocessing
import os
import signal
import socket
import threading
import time
from dataclasses import dataclass, field
from datetime import UTC, datetime
from typing import Any

from threadpoolctl import threadpool_limits

from fastpin import __version__, store
from fastpin.casefile import Case
from fastpin.errors import SolveError
from fastpin.jit import on_one_thread
from fastpin.keyfigures import key_figures
from fastpin.layout import versions
from fastpin.products import in_one_thread
from fastpin.solver import solve
from fastpin.state import Result


@dataclass(frozen=True)
class Outcome:
    """How a run ended.

    Attributes
    ----------
    id : str
    reason : str or None
        Why it failed; None if it did not.
    figures : dict
        Key figures (:data:`fastpin.keyfigures.KEY_FIGURES`); empty without a state.
    seconds : float or None
        Time in the solver.
    started : str or None
        UTC, ISO 8601.
    host : str or None
        Name of the machine.
    versions : dict of str to str
        Of fastpin, Python and the libraries.
    """

    id: str
    reason: str | None
    figures: dict[str, Any] = field(default_factory=dict)
    seconds: float | None = None
    started: str | None = None
    host: str | None = None
    versions: dict[str, str] = field(default_factory=dict)


def prepare() -> None:
    """Make this process a worker of ours: one thread, deaf to Ctrl-C, and gone when the main process is."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the main process decides what an interrupt means
    threading.Thread(target=_end_with_parent, daemon=True).start()
    on_one_thread()
    one_thread()


@functools.cache
def one_thread() -> None:
    """One thread for every BLAS and OpenMP library of this process, from now on."""
    threadpool_limits(limits=1)


def solve_run(run: str, case: Case, path: str, main_process: int, version: str) -> Outcome:
    """Solve one case and save its result.

    Parameters
    ----------
    run : str
        Id of the run.
    case : Case
    path : str
        Where the result goes. Nothing is written without a state.
    main_process : int
        Process id of the sweep: its threads are not touched where the run happens in it.
    version : str
        Of fastpin, in the sweep.
    """
    if version != __version__:
        return Outcome(run, f"the worker has fastpin {__version__}, the sweep {version}")
    if os.getpid() != main_process:
        one_thread()
    started = datetime.now(UTC).isoformat(timespec="milliseconds")
    began = time.perf_counter()
    reason: str | None = None
    figures: dict[str, Any] = {}
    try:
        try:
            with in_one_thread():
                result: Result | None = solve(case.problem, case.history, **case.options.keywords())
        except SolveError as error:
            reason, result = str(error), error.result
        seconds = time.perf_counter() - began
        if result is not None and len(result):
            figures = key_figures(result)
            store.save(result, path, error=reason, restart=False)
    except MemoryError:
        seconds, reason, figures = time.perf_counter() - began, "not enough memory", {}
    except Exception as error:  # whatever goes wrong in one run is its own failure, and the others go on
        seconds, reason, figures = time.perf_counter() - began, f"{type(error).__name__}: {error}", {}
    return Outcome(run, reason, figures, seconds, started, socket.gethostname(), versions())


def _end_with_parent() -> None:
    """A worker waits for work for ever, also after its main process was killed."""
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)
