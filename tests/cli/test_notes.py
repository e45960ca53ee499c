"""Notes of the command line: unfinished results, nodes of the start, options without effect."""

import subprocess

import h5py
import pytest

from fastpin.cli.main import main
from fastpin.solver.errors import Interrupted
from fastpin.storage.recording import record
from tests.support.processes import python, started

CASE = """
pin.material = "steel"
plate.material = "aluminium"
[contact]
hole_radius = 0.01
clearance = 20e-6
friction = 0.4
[solve]
nodes = 61
[[load]]
P = 1e6
[[load]]
Q = [1e5, -1e5]
"""


@pytest.fixture
def case(tmp_path):
    path = tmp_path / "case.toml"
    path.write_text(CASE)
    return path


@pytest.mark.gate
@pytest.mark.usefixtures("undrawn")
def test_show_says_that_a_run_is_unfinished(case, tmp_path, capsys):
    from fastpin.casefile.reader import read_case

    def stop(done: float, total: int) -> None:
        if done >= 2.0:
            raise Interrupted

    parts, path = read_case(case), tmp_path / "a.h5"
    with pytest.raises(Interrupted):
        record(parts.problem, parts.history, path, nodes=61, arc=(-3.0, -0.2), progress=stop)
    assert main(["show", str(path)]) == 0
    expected = f"note: unfinished, at corner 1 of 3: interrupted; continue with: fastpin resume {path}"
    assert capsys.readouterr().out.splitlines()[-1] == expected
    assert main(["report", str(path), "-o", str(tmp_path / "a.html")]) == 0
    assert f"The reason: interrupted. Continue with: fastpin resume {path}." in (tmp_path / "a.html").read_text()
    capsys.readouterr()
    assert main(["resume", str(path)]) == 0
    assert main(["show", str(path)]) == 0
    assert "unfinished" not in capsys.readouterr().out.splitlines()[-1]


@pytest.mark.gate
def test_a_run_that_goes_on_is_told(case, tmp_path, capsys, monkeypatch):
    path = tmp_path / "a.h5"
    assert main(["run", str(case), "-o", str(path), "--nodes", "41"]) == 0
    with h5py.File(path, "r+") as file:
        file.attrs["complete"] = False
    code = f"import fcntl, sys\nfile = open({str(path)!r}, 'rb')\nfcntl.flock(file, fcntl.LOCK_EX)\nprint(flush=True)\n"
    code += "sys.stdin.read()"
    with started(python(code), stdin=subprocess.PIPE) as other:
        other.stdout.readline()
        capsys.readouterr()
        assert main(["show", str(path)]) == 0
        assert main(["resume", str(path)]) == 2
        other.stdin.close()
    captured = capsys.readouterr()
    assert captured.out.splitlines()[-1] == "note: unfinished, at corner 3 of 3; its run goes on"
    assert captured.err == f"fastpin: {path}: another run is writing to it\n"


@pytest.mark.gate
@pytest.mark.usefixtures("undrawn")
def test_a_run_that_no_equilibrium_ended_is_not_to_be_resumed(case, tmp_path, capsys):
    path = tmp_path / "a.h5"
    case.write_text(case.read_text().replace("nodes = 61", "nodes = 41") + "\n[[load]]\nM = 1e6\n")
    assert main(["run", str(case), "-o", str(path)]) == 1
    capsys.readouterr()
    assert main(["show", str(path)]) == 0
    last = capsys.readouterr().out.splitlines()[-1]
    assert last.startswith("note: unfinished, at corner 3 of 4: step 4, at ")
    assert "resume" not in last
    assert main(["report", str(path), "-o", str(tmp_path / "a.html")]) == 0
    text = (tmp_path / "a.html").read_text()
    assert "Unfinished: corner 3 of 4; " in text
    assert "fastpin resume" not in text


@pytest.mark.gate
def test_the_nodes_of_the_start_are_named(case, tmp_path, capsys):
    path = tmp_path / "a.h5"
    assert main(["run", str(case), "-o", str(path), "--nodes", "41"]) == 0
    assert main(["run", str(case), "--start", str(path)]) == 0
    assert f"note: the 41 nodes of {path} are used, not 61" in capsys.readouterr().err


def test_states_inside_steps_that_are_not_kept_are_warned_of(case, capsys):
    assert main(["run", str(case), "--between", "3", "--keep", "corners"]) == 0
    assert 'between has no effect with keep = "corners"' in capsys.readouterr().err
    assert main(["run", str(case), "--between", "3"]) == 0
    assert "between" not in capsys.readouterr().err


def test_one_fraction_of_a_step(case, capsys):
    assert main(["run", str(case), "--between", "0.25"]) == 0
    points = [line.split()[0] for line in capsys.readouterr().out.splitlines()[2:-2]]
    assert points == ["0.25", "1", "1.25", "2", "2.25", "3"]


@pytest.mark.gate
def test_error_bars_of_a_case_file_can_be_switched_off(case, tmp_path, capsys):
    case.write_text(case.read_text().replace("nodes = 61", "nodes = 101\nerror_bars = true"))
    assert main(["run", str(case)]) == 0
    assert "+-" in capsys.readouterr().out
    assert main(["run", str(case), "-o", str(tmp_path / "a.h5")]) == 0
    assert "+-" in capsys.readouterr().out
    assert main(["run", str(case), "-o", str(tmp_path / "b.h5"), "--no-error-bars"]) == 0
    assert "+-" not in capsys.readouterr().out


@pytest.mark.parametrize(
    ("command", "message"),
    [
        (["converge", "CASE", "--corner", "1.5"], "--corner: must be a whole number of at least 1, not 1.5"),
        (
            ["converge", "CASE", "--increments", "5,10,20", "--increment-nodes", "abc"],
            '--increment-nodes: must be a whole number from 51 to 20000, not "abc"',
        ),
        (["paper", "--nodes", "abc"], '--nodes: must be a whole number from 5 to 20000, not "abc"'),
    ],
)
def test_whole_numbers_are_checked_in_one_place(case, capsys, command, message):
    assert main([str(case) if word == "CASE" else word for word in command]) == 2
    assert capsys.readouterr().err == f"fastpin: {message}\n"


@pytest.mark.gate
def test_more_nodes_and_snaps_are_noted(tmp_path, capsys):
    path = tmp_path / "case.toml"
    narrow = CASE.replace("clearance = 20e-6", "clearance = 2e-3").replace("P = 1e6", "P = [1e2, 1e6]")
    path.write_text(narrow)
    assert main(["run", str(path)]) == 0
    assert "instead of 61, dense where the contact is narrow" in capsys.readouterr().out
    path.write_text(CASE.replace("friction = 0.4", "friction = 1000.0").replace("Q = [1e5, -1e5]", "Q = [5e5, -5e5]"))
    assert main(["run", str(path)]) == 0
    assert "note: the pin snapped" in capsys.readouterr().out
