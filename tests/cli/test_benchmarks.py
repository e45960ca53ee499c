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
    out = printed("benchmarks", "brazilian-disk", "NASA-TP-1862", "brazilian-disk")
    assert out.count("brazilian-disk: Brazilian disk: stresses") == 1
    assert out.count("agrees to the digits printed") == 8


def test_files_and_json() -> None:
    words = printed("benchmarks", "brazilian-disk", "-o", "new", "--json", "rows.json")
    assert "brazilian-disk: new/brazilian-disk.csv" in words
    assert Path("new/brazilian-disk.csv").exists()
    rows = json.loads(Path("rows.json").read_text())["benchmarks"]["brazilian-disk"]
    assert all(row["agrees"] for row in rows)
    assert json.loads(printed("benchmarks", "brazilian-disk", "--json"))["benchmarks"]["brazilian-disk"] == rows


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["hertz"], "benchmark: there is no 'hertz'"),
        (["brazilian-disk", "-o", "FILE"], "--output: "),
    ],
)
def test_wrong_options_are_refused_before_the_work(arguments, message, tmp_path):
    Path("FILE").write_text("")
    assert message in refused("benchmarks", *arguments)
    assert not list(tmp_path.glob("**/*.csv"))


def test_an_interrupted_run_says_what_is_finished(monkeypatch):
    def interrupt(progress: object = None) -> None:
        raise KeyboardInterrupt

    interrupted = replace(catalog.BENCHMARKS["nasa-tp-1862"], compute=interrupt)
    monkeypatch.setitem(catalog.BENCHMARKS, "nasa-tp-1862", interrupted)
    words = said("benchmarks", "brazilian-disk", "nasa-tp-1862", code=130).err
    assert "interrupted; benchmarks that are finished: brazilian-disk" in words
