"""The command `fastpin live`, without a server."""

from __future__ import annotations

import sys

import pytest

from fastpin.cli import live as live_command
from fastpin.cli.main import main
from fastpin.live import server as server_module


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["--port", "70000"], "--port: must be a whole number from 0 to 65535, not 70000"),
        (["--nodes", "many"], '--nodes: must be a whole number from 5 to 1600, not "many"'),
        (["nothing.toml"], "nothing.toml: there is no such file"),
    ],
)
def test_wrong_arguments(arguments, sentence, capsys):
    assert main(["live", "--no-browser", *arguments]) == 2
    assert sentence in capsys.readouterr().err


def test_without_its_package_the_command_says_how_to_install_it(monkeypatch, capsys):
    monkeypatch.delattr(live_command.live, "serve", raising=False)  # it is kept there once it was found
    monkeypatch.delitem(sys.modules, server_module.__name__)
    monkeypatch.setitem(sys.modules, "aiohttp", None)
    assert main(["live", "--no-browser"]) == 1
    sentence = "fastpin: the live page needs the package aiohttp: pip install 'fastpin[live]'\n"
    assert capsys.readouterr() == ("", sentence)


def test_the_command_prints_the_address(monkeypatch, capsys):
    asked: list[object] = []

    def serve(make, port, ready):
        asked[:] = make().session.grid.size, port
        ready("http://127.0.0.1:1/token/")

    monkeypatch.setattr(live_command.live, "serve", serve)
    monkeypatch.setattr("webbrowser.open", asked.append)  # returns nothing, as where there is no browser
    assert main(["live", "--nodes", "71"]) == 0
    assert asked == [71, 0, "http://127.0.0.1:1/token/"]
    printed = capsys.readouterr()
    assert printed.out == "live page: http://127.0.0.1:1/token/\nCtrl-C ends it\n"
    assert printed.err == "note: no browser was found; open the address above in one\n"
