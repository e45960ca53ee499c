"""The command `fastpin live`, without a server."""

from __future__ import annotations

import sys
from collections.abc import Callable

import pytest

from fastpin.cli import live as live_command
from fastpin.cli.main import main
from fastpin.live import server as server_module
from fastpin.live.contact import LiveContact
from fastpin.live.protocol import ALONE, CLASS, Limits

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
def test_wrong_arguments(
    arguments: list[str], sentence: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(server_module, "_such_as", str)  # it asks a socket
    assert main(["live", "--no-browser", *arguments]) == 2
    assert sentence in capsys.readouterr().err


@pytest.mark.parametrize("package", ["aiohttp", "segno"])
def test_without_its_packages_the_command_says_how_to_install_them(
    package: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.delitem(sys.modules, server_module.__name__)
    monkeypatch.delattr(live_command.live, "serve", raising=False)  # it is kept there once it was found
    monkeypatch.setitem(sys.modules, package, None)
    assert main(["live", "--no-browser"]) == 1
    sentence = f"fastpin: the live page needs the package {package}: pip install 'fastpin[live]'\n"
    assert capsys.readouterr() == ("", sentence)


def test_the_command_prints_the_address_and_says_that_there_is_no_browser(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def serve(
        make: Callable[[], LiveContact], port: int, ready: Callable[[str], None], host: str, limits: Limits
    ) -> None:
        assert (make().session.grid.size, port, host, limits) == (71, 0, "", ALONE)
        ready("http://127.0.0.1:1/token/")

    opened: list[str] = []

    def no_browser(address: str) -> bool:
        opened.append(address)
        return False

    monkeypatch.setattr(live_command.live, "serve", serve)
    monkeypatch.setattr("webbrowser.open", no_browser)
    assert main(["live", "--nodes", "71"]) == 0
    printed = capsys.readouterr()
    assert printed.out == "live page: http://127.0.0.1:1/token/\nCtrl-C ends it\n"
    assert printed.err == "note: no browser was found; open the address above in one\n"
    assert opened == ["http://127.0.0.1:1/token/"]


def test_the_command_says_who_can_reach_a_shared_page(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def serve(
        make: Callable[[], LiveContact], port: int, ready: Callable[[str], None], host: str, limits: Limits
    ) -> None:
        assert (make().session.grid.size, host, limits) == (100, SHARED, CLASS)
        ready(f"http://{SHARED}:1/token/")

    monkeypatch.setattr(live_command.live, "serve", serve)
    assert main(["live", "--no-browser", "--host", SHARED]) == 0
    said = capsys.readouterr().out
    assert f"whoever reaches {SHARED} over the network and has this whole address can open the page" in said
    assert "nothing is encrypted" in said
