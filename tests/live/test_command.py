"""The command `fastpin live`, without a server."""

from __future__ import annotations

import sys

import pytest

from fastpin.cli import live as live_command
from fastpin.cli.main import main
from fastpin.live import server as server_module
from fastpin.live.protocol import ALONE, CLASS

SHARED = "127.0.0.3"


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["--port", "70000"], "--port: must be a whole number from 0 to 65535, not 70000"),
        (["--host", "somewhere"], "--host: must be one address of this machine in numbers"),
        (["--host", "0.0.0.0"], 'not "0.0.0.0"'),
        (["--host", "::"], 'not "::"'),
        (["--host", "fe80::1%eth0"], 'not "fe80::1%eth0"'),
        (["--host", "127.0.0.1", "--nodes", "401"], "--nodes: must be a whole number from 5 to 400, not 401"),
        (["--nodes", "many"], '--nodes: must be a whole number from 5 to 1600, not "many"'),
        (["nothing.toml"], "nothing.toml: there is no such file"),
    ],
)
def test_wrong_arguments(arguments, sentence, monkeypatch, capsys):
    monkeypatch.setattr(server_module, "_such_as", str)  # it asks a socket
    assert main(["live", "--no-browser", *arguments]) == 2
    assert sentence in capsys.readouterr().err


@pytest.mark.parametrize("package", ["aiohttp", "segno"])
def test_without_its_packages_the_command_says_how_to_install_them(package, monkeypatch, capsys):
    monkeypatch.delitem(sys.modules, server_module.__name__)
    monkeypatch.delattr(live_command.live, "serve", raising=False)  # it is kept there once it was found
    monkeypatch.setitem(sys.modules, package, None)
    assert main(["live", "--no-browser"]) == 1
    sentence = f"fastpin: the live page needs the package {package}: pip install 'fastpin[live]'\n"
    assert capsys.readouterr() == ("", sentence)


def test_the_command_prints_the_address_and_who_can_reach_it(monkeypatch, capsys):
    asked: list[object] = []

    def serve(make, port, ready, host, limits):
        asked[:] = make().session.grid.size, port, host, limits
        ready(f"http://{host or '127.0.0.1'}:1/token/")

    monkeypatch.setattr(live_command.live, "serve", serve)
    monkeypatch.setattr("webbrowser.open", asked.append)  # returns nothing, as where there is no browser
    assert main(["live", "--nodes", "71"]) == 0
    assert asked == [71, 0, "", ALONE, "http://127.0.0.1:1/token/"]
    printed = capsys.readouterr()
    assert printed.out == "live page: http://127.0.0.1:1/token/\nCtrl-C ends it\n"
    assert printed.err == "note: no browser was found; open the address above in one\n"
    assert main(["live", "--no-browser", "--host", SHARED]) == 0
    assert asked == [100, 0, SHARED, CLASS]
    said = capsys.readouterr().out
    assert f"whoever reaches {SHARED} over the network and has this whole address can open the page" in said
    assert "nothing is encrypted" in said
