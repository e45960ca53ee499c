"""Notes of the command line: unfinished results, nodes of the start, options without effect."""

from __future__ import annotations

import pytest

from fastpin.cli.main import main
from fastpin.solver.errors import Interrupted
from fastpin.storage.recording import record

CASE = """
[pin]
material = "steel"
[plate]
material = "aluminium"
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


def test_show_says_that_a_run_is_unfinished(case, tmp_path, capsys):
    from fastpin.casefile.reader import read_case

    def stop(done: float, total: int) -> None:
        if done >= 2.0:
            raise Interrupted

    parts, path = read_case(case), tmp_path / "a.h5"
    with pytest.raises(Interrupted):
        record(parts.problem, parts.history, path, nodes=61, arc=(-3.0, -0.2), progress=stop)
    assert main(["show", str(path)]) == 0
    expected = f"note: unfinished, at corner 1 of 3 (interrupted); continue with: fastpin resume {path}"
    assert capsys.readouterr().out.splitlines()[-1] == expected
    assert main(["resume", str(path)]) == 0
    assert main(["show", str(path)]) == 0
    assert "unfinished" not in capsys.readouterr().out.splitlines()[-1]


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
