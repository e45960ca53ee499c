"""Kernels that a second process compiles in a first run: they are those of a run, and it ends with the first."""

import os
import subprocess
from pathlib import Path

import pytest

from fastpin.kernels import first
from fastpin.runtime import jit, machine
from fastpin.runtime.threads import cores
from tests.support.processes import ROOT, finished, python, started

pytestmark = [pytest.mark.gate, pytest.mark.skipif(jit.PLAIN or not machine.CAN_LOAD, reason="no code is stored")]

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


def test_the_list_has_the_kernels_and_types_of_a_run() -> None:
    done = finished(python(SEEN))
    listed = [f"{one.__name__}: {jit.signature(jit.argument_types(tuple(given)))}" for one, *given in first.kernels()]
    names = {kernel.__name__ for kernel, *_ in first.kernels()}
    seen = [line for line in done.stderr.splitlines() if line.split(":")[0] in names]
    assert sorted(listed) == sorted(seen)
    assert listed[:4] == seen[:4]
    assert listed[:3:-1] == seen[4:]


MODULE = """
import os, sys
from fastpin.kernels.influence import clausen
from fastpin.runtime import beside
if __name__ == "__main__":
    os.read(int(os.environ["GO"]), 1)
    if beside.is_needed():
        clausen.prepare(1.0)
"""
PARENT = """
import os, sys
from fastpin.kernels.influence import log_kernels
from fastpin.runtime import beside
beside.module = "other"
print(beside.start(), flush=True)
os.close(int(os.environ["DONE"]))
sys.stdin.read()
"""


@pytest.mark.skipif(cores() < 2, reason="no core for a second process")
@pytest.mark.parametrize("ends", [False, True])
def test_a_second_process_compiles_as_long_as_the_first_one_runs(ends: bool, tmp_path: Path) -> None:
    """The second process reads GO until this one closes it, and the system closes DONE when it has ended."""
    (tmp_path / "other.py").write_text(MODULE)
    (go, let_go), (done, ended) = os.pipe(), os.pipe()
    variables = {"PYTHONPATH": f"{tmp_path}{os.pathsep}{ROOT}", "NUMBA_CACHE_DIR": str(tmp_path / "cache")}
    environment = os.environ | variables | {"GO": str(go), "DONE": str(ended)}
    with started(python(PARENT), env=environment, pass_fds=(go, ended), stdin=subprocess.PIPE) as parent:
        os.close(go)
        os.close(ended)
        assert parent.stdout is not None
        assert int(parent.stdout.readline()) > 0
        if ends:
            parent.communicate()
        os.close(let_go)
        assert os.read(done, 1) == b""
        assert parent.poll() == (0 if ends else None)
    os.close(done)
    files = sorted(path.name.split("-")[0] for path in (tmp_path / "cache").glob("*.machine"))
    assert files == ([] if ends else ["influence.clausen"])
