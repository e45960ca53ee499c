"""Notes of the command line: unfinished results, nodes of the start, options without effect."""

import subprocess
from pathlib import Path

import h5py
import pytest

from fastpin import Interrupted, read_case, record
from tests.support.body_texts import HEAD
from tests.support.commands import printed, refused, said
from tests.support.interrupts import StopAt
from tests.support.processes import python, started

CASE = HEAD.replace("friction = 0.3", "friction = 0.4") + "[[load]]\nQ = [1e5, -1e5]\n[solve]\nnodes = 61\n"


@pytest.mark.gate
@pytest.mark.usefixtures("undrawn")
def test_show_says_that_a_run_is_unfinished(case):
    parts = read_case(case)
    with pytest.raises(Interrupted):
        record(parts.problem, parts.history, "a.h5", nodes=61, arc=(-3.0, -0.2), progress=StopAt(1.0))
    expected = "note: unfinished, at corner 1 of 3: interrupted; continue with: fastpin resume a.h5"
    assert printed("show", "a.h5").splitlines()[-1] == expected
    said("report", "a.h5", "-o", "a.html")
    assert "The reason: interrupted. Continue with: fastpin resume a.h5." in Path("a.html").read_text()
    said("resume", "a.h5")
    assert "unfinished" not in printed("show", "a.h5").splitlines()[-1]


@pytest.mark.gate
def test_a_run_that_goes_on_is_told(case):
    said("run", case, "-o", "a.h5", "--nodes", "41")
    with h5py.File("a.h5", "r+") as file:
        file.attrs["complete"] = False
    code = "import fcntl, sys\nfile = open('a.h5', 'rb')\nfcntl.flock(file, fcntl.LOCK_EX)\nprint(flush=True)\n"
    code += "sys.stdin.read()"
    with started(python(code), stdin=subprocess.PIPE, cwd=".") as other:
        other.stdout.readline()
        assert printed("show", "a.h5").splitlines()[-1] == "note: unfinished, at corner 3 of 3; its run goes on"
        assert refused("resume", "a.h5") == "fastpin: a.h5: another run is writing to it\n"
        other.stdin.close()


@pytest.mark.gate
@pytest.mark.usefixtures("undrawn")
def test_a_run_that_no_equilibrium_ended_is_not_to_be_resumed(case):
    case.write_text(case.read_text().replace("nodes = 61", "nodes = 41") + "\n[[load]]\nM = 1e6\n")
    said("run", case, "-o", "a.h5", code=1)
    last = printed("show", "a.h5").splitlines()[-1]
    assert last.startswith("note: unfinished, at corner 3 of 4: step 4, at ")
    assert "resume" not in last
    said("report", "a.h5", "-o", "a.html")
    text = Path("a.html").read_text()
    assert "Unfinished: corner 3 of 4; " in text
    assert "fastpin resume" not in text


@pytest.mark.gate
def test_the_nodes_of_the_start_are_named(case):
    said("run", case, "-o", "a.h5", "--nodes", "41")
    assert "note: the 41 nodes of a.h5 are used, not 61" in said("run", case, "--start", "a.h5").err


def test_states_inside_steps_that_are_not_kept_are_warned_of(case):
    assert 'between has no effect with keep = "corners"' in said("run", case, "--between", "3", "--keep", "corners").err
    assert "between" not in said("run", case, "--between", "3").err


def test_one_fraction_of_a_step(case):
    points = [line.split()[0] for line in printed("run", case, "--between", "0.25").splitlines()[2:-2]]
    assert points == ["0.25", "1", "1.25", "2", "2.25", "3"]


@pytest.mark.gate
def test_error_bars_of_a_case_file_can_be_switched_off(case):
    case.write_text(case.read_text().replace("nodes = 61", "nodes = 101\nerror_bars = true"))
    assert "+-" in printed("run", case)
    assert "+-" in printed("run", case, "-o", "a.h5")
    assert "+-" not in printed("run", case, "-o", "b.h5", "--no-error-bars")


@pytest.mark.parametrize(
    ("command", "message"),
    [
        ("converge case.toml --corner 1.5", "--corner: must be a whole number of at least 1, not 1.5"),
        (
            "converge case.toml --increments 5,10,20 --increment-nodes abc",
            '--increment-nodes: must be a whole number from 51 to 20000, not "abc"',
        ),
        ("paper --nodes abc", '--nodes: must be a whole number from 5 to 20000, not "abc"'),
    ],
)
@pytest.mark.usefixtures("case")
def test_whole_numbers_are_checked_in_one_place(command, message):
    assert refused(*command.split()) == f"fastpin: {message}\n"


@pytest.mark.gate
def test_more_nodes_and_snaps_are_noted(case):
    case.write_text(CASE.replace("clearance = 20e-6", "clearance = 2e-3").replace("P = 1e6", "P = [1e2, 1e6]"))
    assert "instead of 61, dense where the contact is narrow" in printed("run", case)
    case.write_text(CASE.replace("friction = 0.4", "friction = 1000.0").replace("Q = [1e5, -1e5]", "Q = [5e5, -5e5]"))
    assert "note: the pin snapped" in printed("run", case)
