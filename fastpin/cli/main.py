"""The command line: read the options, carry out the command, turn errors into messages and exit codes.

The file of a command is imported only when the command is chosen. Help and wrong options are answered without NumPy.
"""

from __future__ import annotations

import _thread
import contextlib
import gc
import importlib
import io
import logging
import os
import signal
import sys
import threading
import time
import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

from fastpin.cli.options import read_options
from fastpin.cli.terminal import EXIT_FAILED, EXIT_INPUT, EXIT_INTERRUPTED, EXIT_PIPE, EXIT_READING, fail, say
from fastpin.errors import CaseFileError, FastpinError, InputError, InputWarning, ReadingError, printable
from fastpin.model.inputs import remembered_inputs
from fastpin.runtime.threads import STOPPING


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line.

    Returns
    -------
    int
        Exit code. 0: success. 1: the loads could not be followed to their end, a run of a sweep or a check of the
        installation has failed, a file could not be written, or memory did not suffice. 2: input that can't be used.
        3: a quantity could not be read from the states, which are shown and kept.
        130: interrupted by Ctrl-C, SIGTERM or SIGHUP. 141: the reader of the output has closed it.
    """
    gc.set_threshold(50_000)  # Imports make no garbage, and Python's threshold of 700 new objects costs them 30 ms.
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")  # the encoding of a terminal or pipe may lack characters
    try:
        options = read_options(sys.argv[1:] if arguments is None else list(arguments))
        _log(getattr(options, "verbose", 0))
        file, function = options.command
        with stopped_by_signals(), _printed_warnings(), remembered_inputs():
            code = int(getattr(importlib.import_module(f"fastpin.cli.{file}"), function)(options))
        sys.stdout.flush()
        return code
    except CaseFileError as error:
        say(*str(error).split("\n"), file=sys.stderr)  # a line for each fault, with the file's name
        return EXIT_INPUT
    except InputError as error:
        return fail(str(error), EXIT_INPUT)
    except ReadingError as error:
        return fail(str(error), EXIT_READING)
    except FastpinError as error:
        return fail(str(error), EXIT_FAILED)
    except KeyboardInterrupt:
        return fail("interrupted", EXIT_INTERRUPTED)
    except MemoryError:
        return fail("not enough memory: use fewer nodes or store fewer states", EXIT_FAILED)
    except BrokenPipeError:  # the reader of our output has gone (fastpin run | head)
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return EXIT_PIPE
    except OSError as error:
        return fail(str(error), EXIT_FAILED)


@contextlib.contextmanager
def _printed_warnings() -> Iterator[None]:
    """Print warnings of doubtful input as messages, each of them once."""
    printed: set[str] = set()

    def show(message: Warning | str, category: type[Warning], *place: Any, **more: Any) -> None:
        if not issubclass(category, InputWarning):
            others(message, category, *place, **more)
        elif str(message) not in printed:
            printed.add(str(message))
            say(f"fastpin: warning: {message}", file=sys.stderr)

    with warnings.catch_warnings():
        others = warnings.showwarning
        warnings.simplefilter("always", InputWarning)
        warnings.showwarning = show
        yield


class _PrintableMessages(logging.Formatter):
    """Messages of the package's log, which may name files."""

    def formatMessage(self, record: logging.LogRecord) -> str:
        return printable(super().formatMessage(record))


def _log(verbose: int) -> None:
    """Send the package's messages to standard error. `verbose` 0: warnings, 1: each step, 2: everything."""
    handler = logging.StreamHandler()
    handler.setFormatter(_PrintableMessages("fastpin: %(message)s"))
    logger = logging.getLogger("fastpin")
    logger.handlers = [handler]
    logger.setLevel((logging.WARNING, logging.INFO, logging.DEBUG)[min(verbose, 2)])
    # Compiling takes some seconds. A user at a terminal is told.
    logging.getLogger("fastpin.compiler").setLevel(logging.INFO if sys.stderr.isatty() else logging.NOTSET)


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
