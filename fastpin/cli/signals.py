"""The signals that stop a command: they all raise KeyboardInterrupt, as Ctrl-C does."""

from __future__ import annotations

import _thread
import signal
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from fastpin.runtime.stopping import STOPPING

AGAIN = 0.05
"""Seconds until a lost interrupt is raised again."""


@contextmanager
def stopped_by_signals() -> Iterator[None]:
    """Interrupt the block by each of these signals, unless the parent of this process has made it ignore the signal.

    Python drops an interrupt that falls into a finalizer or a callback, and prints a note. It is raised again.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    taken = [number for number in STOPPING if signal.getsignal(number) == signal.SIG_DFL]
    hook, thread = sys.unraisablehook, threading.get_ident()

    def hear_again(lost: Any) -> None:
        if issubclass(lost.exc_type, KeyboardInterrupt):
            _thread.start_new_thread(_interrupt, (thread,))
        else:
            hook(lost)

    for number in taken:
        signal.signal(number, signal.default_int_handler)
    sys.unraisablehook = hear_again
    try:
        yield
    finally:
        sys.unraisablehook = hook
        for number in taken:
            signal.signal(number, signal.SIG_DFL)


def _interrupt(thread: int) -> None:
    """Interrupt the main thread once it has left its callback, by a signal that it does not ignore."""
    time.sleep(AGAIN)
    heard = [number for number in STOPPING if callable(signal.getsignal(number))]
    if heard and hasattr(signal, "pthread_kill"):  # it also wakes a thread that sleeps or waits
        signal.pthread_kill(thread, heard[0])
    else:
        _thread.interrupt_main(*heard[:1])
