"""``fastpin benchmarks`` on the command line."""

import json
from dataclasses import replace
from pathlib import Path

import pytest

from fastpin.benchmarks import catalog
from fastpin.cli.main import main


def test_the_list_names_all_benchmarks(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["benchmarks", "--list"]) == 0
    assert [line.split()[0] for line in capsys.readouterr().out.splitlines()] == list(catalog.BENCHMARKS)


def test_chosen_benchmarks_are_printed_once(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["benchmarks", "kirsch", "Shrink-Fit", "kirsch"]) == 0
    out = capsys.readouterr().out
    assert out.count("kirsch: Kirsch: hoop stress") == 1
    assert out.count("agrees to the digits printed") == 3


def test_files_and_json(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    arguments = ["benchmarks", "shrink-fit", "-o", str(tmp_path / "new"), "--json", str(tmp_path / "rows.json")]
    assert main(arguments) == 0
    assert (tmp_path / "new" / "shrink-fit.csv").exists()
    (row,) = json.loads((tmp_path / "rows.json").read_text())["benchmarks"]["shrink-fit"]
    assert row["agrees"]
    assert f"shrink-fit: {tmp_path / 'new' / 'shrink-fit.csv'}" in capsys.readouterr().out
    assert main(["benchmarks", "shrink-fit", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["benchmarks"]["shrink-fit"] == [row]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["hertz"], "benchmark: there is no 'hertz'"),
        (["kirsch", "--format", "png"], "--format: has a meaning with -o only"),
        (["kirsch", "-o", "DIR", "--format", "bmp"], "--format: "),
        (["kirsch", "-o", "FILE"], "--output: "),
    ],
)
def test_wrong_options_are_refused_before_the_work(arguments, message, tmp_path, capsys):
    (tmp_path / "FILE").write_text("")
    given = [str(tmp_path / word) if word in ("DIR", "FILE") else word for word in arguments]
    assert main(["benchmarks", *given]) == 2
    assert message in capsys.readouterr().err
    assert not list(tmp_path.glob("**/*.csv"))


def test_an_interrupted_run_says_what_is_finished(monkeypatch, capsys):
    def interrupt(progress: object = None) -> None:
        raise KeyboardInterrupt

    interrupted = replace(catalog.BENCHMARKS["shrink-fit"], compute=interrupt)
    monkeypatch.setitem(catalog.BENCHMARKS, "shrink-fit", interrupted)
    assert main(["benchmarks", "kirsch", "shrink-fit"]) == 130
    assert "interrupted; benchmarks that are finished: kirsch" in capsys.readouterr().err
