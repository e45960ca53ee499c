"""Kernels that a second process compiles in a first run: they are those of a run, and it ends with the first."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

from fastpin.kernels import first
from fastpin.runtime import jit, machine
from fastpin.runtime.threads import cores

pytestmark = pytest.mark.skipif(jit.PLAIN or not machine.CAN_LOAD, reason="no code is stored")

SEEN = """
import sys
from fastpin.runtime import jit
found = []
find = jit.Kernel._find
def seen(kernel, types, arguments):
    found.append(f"{kernel.__name__}: {jit.signature(types)}")
    return find(kernel, types, arguments)
jit.Kernel._find = seen
from fastpin.cli.main import main
main(["run"])
print(*found, sep="\\n", file=sys.stderr)
"""


@pytest.mark.gate
def test_the_list_has_the_kernels_and_types_of_a_run() -> None:
    done = subprocess.run([sys.executable, "-c", SEEN], capture_output=True, text=True, check=True)
    listed = [f"{one.__name__}: {jit.signature(jit.argument_types(tuple(given)))}" for one, *given in first.kernels()]
    names = {kernel.__name__ for kernel, *_ in first.kernels()}
    seen = [line for line in done.stderr.splitlines() if line.split(":")[0] in names]
    assert sorted(listed) == sorted(seen)
    assert listed[:4] == seen[:4]
    assert listed[:3:-1] == seen[4:]


MODULE = """
from fastpin.kernels.influence import clausen
from fastpin.runtime import beside
import sys, time
if __name__ == "__main__":
    time.sleep(0.5)
    if beside.is_needed():
        clausen.prepare(1.0)
"""
PARENT = """
import sys, time
from pathlib import Path
from fastpin.kernels.influence import log_kernels
from fastpin.runtime import beside
folder, waits = Path(sys.argv[1]), sys.argv[2] == "waits"
beside.module = "other"
print(beside.start(), flush=True)
end = time.monotonic() + 120.0
while waits and not list(folder.glob("*clausen*.machine")) and time.monotonic() < end:
    time.sleep(0.05)
"""


@pytest.mark.skipif(cores() < 2, reason="no core for a second process")
@pytest.mark.parametrize("how", ["waits", "ends"])
def test_a_second_process_compiles_as_long_as_the_first_one_runs(how: str, tmp_path: Path) -> None:
    (tmp_path / "other.py").write_text(MODULE)
    path = os.pathsep.join([str(tmp_path), str(Path(__file__).resolve().parents[2])])
    variables = os.environ | {"PYTHONPATH": path, "NUMBA_CACHE_DIR": str(tmp_path / "cache")}
    words = [sys.executable, "-c", PARENT, str(tmp_path / "cache"), how]
    done = subprocess.run(words, env=variables, capture_output=True, text=True, check=True)
    number = int(done.stdout)
    end = time.monotonic() + 60.0
    while time.monotonic() < end:
        try:
            os.kill(number, 0)
        except ProcessLookupError:
            break
        time.sleep(0.05)
    else:
        pytest.fail("the second process did not end")
    files = sorted(path.name.split("-")[0] for path in (tmp_path / "cache").glob("*.machine"))
    assert files == (["influence.clausen"] if how == "waits" else [])
