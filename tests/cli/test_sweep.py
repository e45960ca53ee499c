"""The commands ``sweep`` and ``merge``: what they print, their exit codes and their files."""

import csv
import sys
from contextlib import AbstractContextManager
from pathlib import Path

import pytest

from fastpin.cli import progress
from fastpin.cli import sweep as sweep_command
from fastpin.cli.main import main
from fastpin.cli.progress import READ_POINTS
from fastpin.studies import sweep, workers
from tests.support.commands import printed, refusal, refused, said
from tests.support.outcomes import FILE
from tests.support.plans import MOMENT, run_here


@pytest.fixture
def path(monkeypatch: pytest.MonkeyPatch) -> Path:
    """A plan file in the working directory; its runs are made in this process."""
    monkeypatch.setattr(workers, "through_processes", run_here)
    Path("moment.toml").write_text(MOMENT)
    return Path("moment.toml")


@pytest.mark.gate
def test_a_sweep_says_what_was_done_and_what_failed(path: Path) -> None:
    out = printed("sweep", path, "--status")
    assert out == "Moment that friction carries\n6 runs in moment: 0 done, 0 failed, 6 waiting\n"
    assert not Path("moment").exists()

    captured = said("sweep", path, code=1)
    lines = captured.out.splitlines()
    assert lines[1].startswith("6 runs in moment: 4 done, 2 failed, 0 waiting; 6 in ")
    assert len([line for line in lines if line.startswith("failed: ") and "nothing holds the pin" in line]) == 2
    assert 'contact.pin_load = "centre", solve.nodes = 41, contact.friction = 0.1, load.2.M = 3000.0' in lines[2]
    assert captured.err == ""  # no progress bar: standard error is no terminal

    assert printed("sweep", path, "--status").splitlines()[1] == "6 runs in moment: 4 done, 2 failed, 0 waiting"
    assert "; 0 in " in said("sweep", path, code=1).out
    assert "; 2 in " in said("sweep", path, "--retry", code=1).out


@pytest.mark.gate
def test_table_csv_and_figure_come_after_the_runs(path: Path) -> None:
    captured = said("sweep", path, "-o", "out", "--table", "--plot", "a.png", code=1)
    assert "note: 2 of 6 points have no value in the figure" in captured.err
    table = captured.out.splitlines()[-8:]
    assert table[0].split()[:4] == ["run", "contact.pin_load", "solve.nodes", "contact.friction"]
    assert [line.split()[-1] for line in table[2:]] == ["done", "failed", "failed", "done", "done", "done"]
    assert Path("a.png").read_bytes().startswith(b"\x89PNG")

    said("sweep", path, "-o", "out", "--status", "--table", "a.csv")
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
    for part in (1, 2):
        main(["sweep", str(path), "--shard", f"{part}/2", "-o", f"part{part}"])
        assert "3 runs in part" in capsys.readouterr().out
    assert printed("merge", "part1", "part2", "-o", "whole") == "6 runs in whole\n"
    assert "6 runs in whole: 4 done, 2 failed, 0 waiting" in printed("sweep", path, "--status", "-o", "whole")


@pytest.mark.gate
def test_outcomes_come_from_the_plan_and_from_the_option(path: Path) -> None:
    said("sweep", path, code=1)
    Path("mine.py").write_text(FILE)
    path.write_text(MOMENT + '[outcomes]\nshear = { quantity = "peak_shear", take = "largest magnitude" }\n')
    arguments = ["sweep", str(path), "--outcomes", "mine.py"]
    captured = said(*arguments, "--table", "--plot", "a.png", code=1)
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

    outputs = ["--table", "a.csv", "--plot", "b.png", "--value", "largest_pressure"]
    assert "outcome broken can't be read in 4 runs" in printed(*arguments, "--status", *outputs)
    lines = Path("a.csv").read_text().splitlines()
    assert "# units: load.2.M N, shear Pa, largest_pressure Pa, peak_pressure Pa" in lines[1]
    for row in csv.DictReader(lines[2:]):
        assert row["largest_pressure"] == row["max_pressure"]
        assert row["shear"] == row["max_shear"]


def test_points_that_share_a_run_are_counted() -> None:
    Path("plan.toml").write_text("[grid]\nplate.nu = [0.33, 0.330]\n")
    out = printed("sweep", "plan.toml", "--status", "-o", "out")
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
        (["--where", "load.2.M=1"], "--where: says what a figure shows; --plot FILE is missing"),
        (["--plot", "a.png", "--where", "M"], '--where: must be FIELD=VALUE, such as contact.friction=0.3, not "M"'),
        (["--plot", "a.png", "--where", "contact.frict=1"], '--where: the plan does not vary "contact.frict", did you'),
        (["--plot", "a.png", "--x", "contact.frict"], '--x: the plan does not vary "contact.frict", did you mean'),
        (["--plot", "a.png", "--x", "contact.pin_load"], "--x: the values of contact.pin_load are not all numbers"),
        (["--plot", "none/a.png"], "the directory none does not exist"),
        (["--table", "moment.toml"], "--table: won't overwrite moment.toml: by its name it is a case file or plan"),
        (["--dask", "tcp://127.0.0.1:9"], "--dask: there is no scheduler at tcp://127.0.0.1:9"),
        (["-o", "moment.toml"], "moment.toml: can't be made: File exists"),
    ],
)
def test_what_can_not_be_done_is_told_before_the_runs(arguments, words, path, monkeypatch):
    monkeypatch.setattr(sweep_command, "CLUSTER_SECONDS", 0.1)
    assert words in refused("sweep", path, *arguments)
    assert not Path("moment").exists()


def test_a_plan_with_faults_prints_them_all() -> None:
    Path("plan.toml").write_text("[grid]\ncontact.friction = [-1]\nsolve.nodes = [1]\n")
    lines = refused("sweep", "plan.toml").splitlines()
    assert [line.split(": ")[1] for line in lines] == ["contact.friction", "solve.nodes"]
    assert all(line.startswith("plan.toml, line ") for line in lines)


def test_a_foreign_index_is_one_sentence(path: Path) -> None:
    Path("moment").mkdir()
    Path("moment/index.sqlite").write_text("mine" * 1000)
    for arguments in ([], ["--status"]):
        assert "index.sqlite: is no index of a sweep, or a damaged one" in refusal("sweep", path, *arguments)


def test_the_cluster_extra_is_asked_for(path, monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    assert "pip install 'fastpin[cluster]'" in refused("sweep", path, "--dask", "tcp://x:1")


def test_the_progress_bar_has_the_time_left(path, monkeypatch):
    shown = []

    class Bar(AbstractContextManager):
        n = total = 0

        def __exit__(self, *_: object) -> None:
            pass

        def __init__(self, total: int, text: str) -> None:
            self.text = text

        def update(self, more: int) -> None:
            self.n += more
            shown.append((self.text, self.n, self.total))

    monkeypatch.setattr(sweep_command, "Bar", Bar)
    said("sweep", path, code=1)
    read, ran = [(READ_POINTS, k, 6) for k in range(6)], [("run {n} of {total}", k, 6) for k in range(7)]
    assert shown == read + ran


@pytest.mark.parametrize("command", ["sweep plan.toml -o runs --status", "report plan.toml"])
def test_reading_a_plan_moves_a_bar(command, capsys, monkeypatch):
    Path("plan.toml").write_text("[grid]\ncontact.friction = [0.3, 0.4]\nsolve.nodes = [41]\n")
    monkeypatch.setattr(progress, "DELAY", -1.0)
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True, raising=False)
    main(command.split())
    assert "checking the plan, 0 of 2 points" in capsys.readouterr().err
