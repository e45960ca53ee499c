"""Ctrl-C, held back until a run stands where it can be left and gone on from."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

SIGNALS = (signal.SIGINT, signal.SIGTERM)


class StopRequest:
    """Whether somebody asked to stop."""

    def __init__(self) -> None:
        self.stop = False


@contextmanager
def deferred_interrupts() -> Iterator[StopRequest]:
    """Note a first Ctrl-C instead of raising; a second one raises KeyboardInterrupt as ever.

    So does a first one where this is not possible: outside the main thread, or where the program has its own handlers.
    SIGTERM is treated in the same way where the program has asked for it, by Python's handler of SIGINT.
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
