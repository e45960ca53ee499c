"""The commands ``sweep`` and ``merge``: what they print, their exit codes and their files."""

from __future__ import annotations

import csv
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from fastpin.cli import progress
from fastpin.cli import sweep as sweep_command
from fastpin.cli.main import main
from fastpin.cli.progress import READ_POINTS
from fastpin.studies import sweep, workers
from scripts.inline import Inline
from tests.support.outcomes import FILE
from tests.support.plans import MOMENT


@pytest.fixture
def path(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A plan file in the working directory; its runs are made in this process."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(workers, "through_processes", lambda _, tasks, submit, size: inline(tasks, submit))
    (tmp_path / "moment.toml").write_text(MOMENT)
    return Path("moment.toml")


def inline(tasks: list[str], submit: Callable[..., Any]) -> Any:
    for task in tasks:
        yield (task,), submit(Inline(), (task,)).result()


@pytest.mark.gate
def test_a_sweep_says_what_was_done_and_what_failed(path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["sweep", str(path), "--status"]) == 0
    out = capsys.readouterr().out
    assert out == "Moment that friction carries\n6 runs in moment: 0 done, 0 failed, 6 waiting\n"
    assert not Path("moment").exists()

    assert main(["sweep", str(path)]) == 1
    captured = capsys.readouterr()
    lines = captured.out.splitlines()
    assert lines[1].startswith("6 runs in moment: 4 done, 2 failed, 0 waiting; 6 in ")
    assert len([line for line in lines if line.startswith("failed: ") and "nothing holds the pin" in line]) == 2
    assert 'contact.pin_load = "centre", solve.nodes = 41, contact.friction = 0.1, load.2.M = 3000.0' in lines[2]
    assert captured.err == ""  # no progress bar: standard error is no terminal

    assert main(["sweep", str(path), "--status"]) == 0
    assert capsys.readouterr().out.splitlines()[1] == "6 runs in moment: 4 done, 2 failed, 0 waiting"
    assert main(["sweep", str(path)]) == 1
    assert "; 0 in " in capsys.readouterr().out
    assert main(["sweep", str(path), "--retry"]) == 1
    assert "; 2 in " in capsys.readouterr().out


@pytest.mark.gate
def test_table_csv_and_figure_come_after_the_runs(path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["sweep", str(path), "-o", "out", "--table", "--plot", "a.png"]) == 1
    captured = capsys.readouterr()
    assert "note: 2 of 6 points have no value in the figure" in captured.err
    table = captured.out.splitlines()[-8:]
    assert table[0].split()[:4] == ["run", "contact.pin_load", "solve.nodes", "contact.friction"]
    assert [line.split()[-1] for line in table[2:]] == ["done", "failed", "failed", "done", "done", "done"]
    assert Path("a.png").read_bytes().startswith(b"\x89PNG")

    assert main(["sweep", str(path), "-o", "out", "--status", "--table", "a.csv"]) == 0
    lines = Path("a.csv").read_text().splitlines()
    assert lines[0].startswith("# fastpin ")
    assert "peak_pressure Pa, peak_pressure_angle deg" in lines[1]
    found = list(csv.DictReader(lines[2:]))
    known = {row["id"]: row for row in sweep.load("out")}
    assert [float(row["load.2.M"]) for row in found] == pytest.approx([1000.0, 3000.0, 9000.0] * 2)
    for row in found:
        assert row["status"] == known[row["id"]]["status"]
        if row["status"] == "done":
            assert float(row["peak_pressure"]) == known[row["id"]]["peak_pressure"]


def test_parts_are_merged(path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for part in ("1/2", "2/2"):
        main(["sweep", str(path), "--shard", part, "-o", f"part{part[0]}"])
        assert "3 runs in part" in capsys.readouterr().out
    assert main(["merge", "part1", "part2", "-o", "whole"]) == 0
    assert capsys.readouterr().out == "6 runs in whole\n"
    assert main(["sweep", str(path), "--status", "-o", "whole"]) == 0
    assert "6 runs in whole: 4 done, 2 failed, 0 waiting" in capsys.readouterr().out


@pytest.mark.gate
def test_outcomes_come_from_the_plan_and_from_the_option(path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["sweep", str(path)]) == 1
    capsys.readouterr()
    Path("mine.py").write_text(FILE)
    path.write_text(MOMENT + '[outcomes]\nshear = { quantity = "peak_shear", take = "largest magnitude" }\n')
    arguments = ["sweep", str(path), "--outcomes", "mine.py"]
    assert main([*arguments, "--table", "--plot", "a.png"]) == 1
    captured = capsys.readouterr()
    lines = captured.out.splitlines()
    run = lines[-6].split()[0]
    assert lines[1].startswith("6 runs in moment: 4 done, 2 failed, 0 waiting; 0 in ")
    assert "outcomes of 4 finished runs were read from their results" in lines
    reason = "ZeroDivisionError: division by zero (mine.py, line 20)"
    assert f"outcome broken can't be read in 4 runs, first {run}: {reason}" in lines
    assert lines[-8].split()[-5:] == ["shear", "largest_pressure", "nothing", "broken", "status"]
    assert lines[-7].split()[-2:] == ["MPa", "MPa"]
    assert [line.split()[-3:] for line in lines[-2:]] == [["-", "-", "done"]] * 2
    assert Path("a.png").read_bytes().startswith(b"\x89PNG")  # of the first outcome
    assert "2 of 6 points have no value" in captured.err

    assert main([*arguments, "--status", "--table", "a.csv", "--plot", "b.png", "--value", "largest_pressure"]) == 0
    assert "outcome broken can't be read in 4 runs" in capsys.readouterr().out
    lines = Path("a.csv").read_text().splitlines()
    assert "# units: load.2.M N, shear Pa, largest_pressure Pa, peak_pressure Pa" in lines[1]
    for row in csv.DictReader(lines[2:]):
        assert row["largest_pressure"] == row["max_pressure"]
        assert row["shear"] == row["max_shear"]


def test_points_that_share_a_run_are_counted(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "plan.toml"
    path.write_text("[grid]\nplate.nu = [0.33, 0.330]\n")
    assert main(["sweep", str(path), "--status", "-o", str(tmp_path / "out")]) == 0
    out = capsys.readouterr().out
    assert "1 runs in " in out
    assert "1 points of the plan have the same input as another and share its run" in out


@pytest.mark.gate
@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--shard", "3/2"], '--shard: must be I/N with I from 1 to N, such as 1/8, not "3/2"'),
        (["--shard", "1"], "--shard: must be I/N"),
        (["--workers", "0"], "--workers: must be a whole number of at least 1, not 0"),
        (["--workers", "2", "--dask", "x"], "--workers: is for processes of this machine"),
        (["--outcomes", "moment.txt"], "moment.txt: must end in .py or .toml to be a file of outcomes"),
        (["--outcomes", "none.py"], "none.py: there is no such file"),
        (["--outcomes", "moment.toml"], "moment.toml: the section [outcomes] is missing"),
        (["--x", "load.2.M"], "--x: says what a figure shows; --plot FILE is missing"),
        (["--plot", "a.xyz"], '--plot: must be the name of a figure, which ends in .png, .pdf or .svg, not "a.xyz"'),
        (["--plot", "a.png", "--value", "peak"], '--value: there is no outcome or key figure "peak"'),
        (["--plot", "a.png", "--x", "contact.frict"], '--x: the plan does not vary "contact.frict", did you mean'),
        (["--plot", "a.png", "--x", "contact.pin_load"], "--x: the values of contact.pin_load are not all numbers"),
        (["--plot", "none/a.png"], "the directory none does not exist"),
        (["--table", "moment.toml"], "--table: won't overwrite moment.toml: by its name it is a case file or plan"),
        (["--dask", "tcp://127.0.0.1:9"], "--dask: there is no scheduler at tcp://127.0.0.1:9"),
        (["-o", "moment.toml"], "moment.toml: can't be made: File exists"),
    ],
)
def test_what_can_not_be_done_is_told_before_the_runs(arguments, words, path, capsys, monkeypatch):
    monkeypatch.setattr(sweep_command, "CLUSTER_SECONDS", 0.1)
    assert main(["sweep", str(path), *arguments]) == 2
    captured = capsys.readouterr()
    assert words in captured.err
    assert captured.out == ""
    assert not Path("moment").exists()


def test_a_plan_with_faults_prints_them_all(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "plan.toml"
    path.write_text("[grid]\ncontact.friction = [-1]\nsolve.nodes = [1]\n")
    assert main(["sweep", str(path)]) == 2
    lines = capsys.readouterr().err.splitlines()
    assert [line.split(": ")[1] for line in lines] == ["contact.friction", "solve.nodes"]
    assert all(line.startswith(f"{path}, line ") for line in lines)


def test_a_foreign_index_is_one_sentence(path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    Path("moment").mkdir()
    Path("moment/index.sqlite").write_text("mine" * 1000)
    for arguments in ([], ["--status"]):
        assert main(["sweep", str(path), *arguments]) == 2
        err = capsys.readouterr().err
        assert "index.sqlite: is no index of a sweep, or a damaged one" in err
        assert err.count("\n") == 1


def test_the_cluster_extra_is_asked_for(path, capsys, monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    assert main(["sweep", str(path), "--dask", "tcp://x:1"]) == 2
    assert "pip install 'fastpin[cluster]'" in capsys.readouterr().err


def test_the_progress_bar_has_the_time_left(path, capsys, monkeypatch):
    shown = []

    class Bar:
        n = total = 0

        def __enter__(self) -> Bar:
            return self

        def __exit__(self, *_: object) -> None:
            pass

        def __init__(self, total: int, text: str) -> None:
            self.text = text

        def update(self, more: int) -> None:
            self.n += more
            shown.append((self.text, self.n, self.total))

    monkeypatch.setattr(sweep_command, "Bar", Bar)
    main(["sweep", str(path)])
    read, ran = [(READ_POINTS, k, 6) for k in range(6)], [("run {n} of {total}", k, 6) for k in range(7)]
    assert shown == read + ran


@pytest.mark.parametrize("command", ["sweep PLAN -o DIR --status", "report PLAN"])
def test_reading_a_plan_moves_a_bar(command, tmp_path, capsys, monkeypatch):
    (tmp_path / "plan.toml").write_text("[grid]\ncontact.friction = [0.3, 0.4]\nsolve.nodes = [41]\n")
    monkeypatch.setattr(progress, "DELAY", -1.0)
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True, raising=False)
    words = {"PLAN": str(tmp_path / "plan.toml"), "DIR": str(tmp_path / "runs")}
    main([words.get(word, word) for word in command.split()])
    assert "checking the plan, 0 of 2 points" in capsys.readouterr().err
