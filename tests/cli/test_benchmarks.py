"""``fastpin benchmarks`` on the command line."""

import json
from dataclasses import replace
from pathlib import Path

import pytest

from fastpin.published import catalog
from tests.support.commands import printed, refused, said


def test_the_list_names_all_benchmarks() -> None:
    assert [line.split()[0] for line in printed("benchmarks", "--list").splitlines()] == list(catalog.BENCHMARKS)


def test_chosen_benchmarks_are_printed_once() -> None:
    out = printed("benchmarks", "kirsch", "Shrink-Fit", "kirsch")
    assert out.count("kirsch: Kirsch: hoop stress") == 1
    assert out.count("agrees to the digits printed") == 3


def test_files_and_json() -> None:
    words = printed("benchmarks", "shrink-fit", "-o", "new", "--json", "rows.json")
    assert "shrink-fit: new/shrink-fit.csv" in words
    assert Path("new/shrink-fit.csv").exists()
    (row,) = json.loads(Path("rows.json").read_text())["benchmarks"]["shrink-fit"]
    assert row["agrees"]
    assert json.loads(printed("benchmarks", "shrink-fit", "--json"))["benchmarks"]["shrink-fit"] == [row]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["hertz"], "benchmark: there is no 'hertz'"),
        (["kirsch", "--format", "png"], "--format: has a meaning with -o only"),
        (["kirsch", "-o", "DIR", "--format", "bmp"], "--format: "),
        (["kirsch", "-o", "FILE"], "--output: "),
    ],
)
def test_wrong_options_are_refused_before_the_work(arguments, message, tmp_path):
    Path("FILE").write_text("")
    assert message in refused("benchmarks", *arguments)
    assert not list(tmp_path.glob("**/*.csv"))


def test_an_interrupted_run_says_what_is_finished(monkeypatch):
    def interrupt(progress: object = None) -> None:
        raise KeyboardInterrupt

    interrupted = replace(catalog.BENCHMARKS["shrink-fit"], compute=interrupt)
    monkeypatch.setitem(catalog.BENCHMARKS, "shrink-fit", interrupted)
    words = said("benchmarks", "kirsch", "shrink-fit", code=130).err
    assert "interrupted; benchmarks that are finished: kirsch" in words
