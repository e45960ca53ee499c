"""Kills of first runs at random moments: the store of machine code is never damaged, and later calls are right."""

from __future__ import annotations

from pathlib import Path

import pytest

from fastpin.runtime import jit, machine
from tests.support import small_kernels
from tests.support.small_kernels import VALUES, read, start

pytestmark = [
    pytest.mark.survey,
    pytest.mark.skipif(jit.PLAIN or not machine.CAN_LOAD, reason="no code is stored"),
]

KILLS = 200

SERVER = (
    f"VALUES, KILLS = {VALUES}, {KILLS}"
    + """
import ctypes, os, random, signal, sys, threading, time
from pathlib import Path
import numba.core.registry
from fastpin.runtime import machine
numba.core.registry.cpu_target.target_context.refresh()
main = threading.get_ident()

def calls(store, system):
    os.environ["NUMBA_CACHE_DIR"], machine.CAN_LOAD = store, system == "here"
    import small
    return [small.doubled(0.5), small.wave(0.5)]

def forked(work, *arguments):
    # A new process, which need not import Numba once more. 0: right, 1: wrong or a traceback, 3: stopped.
    number = os.fork()
    if number == 0:
        code = 1
        try:
            code = 0 if work(*arguments) == VALUES else 1
        except KeyboardInterrupt:
            code = 3
        finally:
            os._exit(code)
    return number

def ended(number):
    return os.waitstatus_to_exitcode(os.waitpid(number, 0)[1])

def throwing(delay, *arguments):
    def throw():
        time.sleep(delay)
        ctypes.pythonapi.PyThreadState_SetAsyncExc(ctypes.c_ulong(main), ctypes.py_object(KeyboardInterrupt))
    threading.Thread(target=throw, daemon=True).start()
    return calls(*arguments)

signal.signal(signal.SIGINT, signal.default_int_handler)
rng, hit, length = random.Random(20), 0, 1.0
for kill in range(KILLS):
    store, system = f"store{kill}", ("here", "elsewhere")[kill % 2]
    how = ("SIGKILL", "SIGTERM", "SIGINT", "exception")[kill // 2 % 4]
    delay = rng.uniform(0.0, length)
    number = forked(*(throwing, delay, store, system) if how == "exception" else (calls, store, system))
    if how != "exception":
        time.sleep(delay)
        os.kill(number, getattr(signal, how))
    code = ended(number)
    assert code in {"SIGKILL": (0, -9), "SIGTERM": (0, -15)}.get(how, (0, 3)), (kill, how, code)
    hit += code != 0
    begin, stored = time.monotonic(), len(list(Path(store).glob("*.*")))
    assert ended(forked(calls, store, system)) == 0, (kill, how)
    if not stored:
        length = time.monotonic() - begin  # of a whole run on the machine as it is now
    assert ended(forked(calls, store, system)) == 0, (kill, how)
    suffix = ".machine" if system == "here" else ".numba"
    whole = sorted(path.name.split("-")[0] for path in Path(store).glob("*" + suffix))
    assert whole == ["small.doubled", "small.wave"], (kill, how, whole)
    print(kill, how, system, code, f"{delay:.2f} of {length:.2f} s", stored, file=sys.stderr, flush=True)
print(hit)
"""
)


def test_killed_first_runs_leave_a_whole_store(tmp_path: Path) -> None:
    server = start(small_kernels.site(tmp_path), code=SERVER, OPENBLAS_NUM_THREADS="1")
    (hit,) = read(server, quiet=False)
    assert int(hit) > KILLS // 4
