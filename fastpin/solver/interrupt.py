"""Ctrl-C is held back until the run can stop at a place from which it can continue."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

SIGNALS = (signal.SIGINT, signal.SIGTERM)
"""Signals that are held back."""


class StopRequest:
    """A request to stop. ``stop`` becomes True at the first Ctrl-C."""

    def __init__(self) -> None:
        self.stop = False


@contextmanager
def deferred_interrupts() -> Iterator[StopRequest]:
    """Note a first Ctrl-C in the request instead of raising. A second Ctrl-C raises KeyboardInterrupt as usual.

    Outside the main thread, and where the program has its own handlers, the first Ctrl-C is not held back. SIGTERM is
    treated like Ctrl-C if the program has given it Python's handler of SIGINT.
    """
    request = StopRequest()

    def note(number: int, frame: FrameType | None) -> None:
        if request.stop:
            signal.default_int_handler(number, frame)
        request.stop = True

    held = []
    if threading.current_thread() is threading.main_thread():
        held = [number for number in SIGNALS if signal.getsignal(number) is signal.default_int_handler]
    for number in held:
        signal.signal(number, note)
    try:
        yield request
    finally:
        for number in held:
            signal.signal(number, signal.default_int_handler)
