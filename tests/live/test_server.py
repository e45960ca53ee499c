"""The server of the page over the network: what it sends, whom it refuses, and what it survives."""

from __future__ import annotations

import asyncio
import contextlib
import re
import select
import socket
from collections.abc import Awaitable, Callable, Iterator
from functools import partial
from typing import Any

import aiohttp
import pytest
from aiohttp import web

from fastpin import casefile
from fastpin.cli.main import main
from fastpin.live import server as server_module
from fastpin.live.page import page_files
from fastpin.live.server import Server
from tests.support.live_pages import LIMIT, Talk, contact, served
from tests.support.processes import fastpin, started

pytestmark = pytest.mark.gate

OPENED: list[aiohttp.ClientWebSocketResponse] = []
"""The websockets of a test. They are closed at its end."""


@pytest.fixture(scope="module")
def server() -> Iterator[Server]:
    with served(lambda: contact(nodes=21)) as running:
        yield running


def host_of(server: Server) -> str:
    return server.address.split("/")[2]


def ask(work: Callable[[aiohttp.ClientSession], Awaitable[Any]]) -> Any:
    """Do some work with a client."""

    async def run() -> Any:
        async with asyncio.timeout(LIMIT), aiohttp.ClientSession() as client:
            try:
                return await work(client)
            finally:
                while OPENED:
                    await OPENED.pop().close()

    return asyncio.run(run())


def get(address: str, **headers: str) -> tuple[int, str, Any]:
    """Return status, text and headers of an answer."""

    async def work(client: aiohttp.ClientSession) -> tuple[int, str, Any]:
        async with client.get(address, headers=headers) as got:
            return got.status, await got.text(), got.headers

    return ask(work)


def raw_socket(server: Server) -> socket.socket:
    """Return a connection to the server; a client would shorten paths and mend requests."""
    host, port = host_of(server).split(":")
    return socket.create_connection((host, int(port)), LIMIT)


def replied(server: Server, request: bytes, is_all: bool = False) -> bytes:
    """Return what the server answers to the bytes of a request until it closes. `is_all`: no more bytes can follow."""
    with raw_socket(server) as raw:
        raw.sendall(request)
        if is_all:
            raw.shutdown(socket.SHUT_WR)
        found = b""
        with contextlib.suppress(ConnectionError):
            while part := raw.recv(65_536):
                found += part
        return found


async def connect(client: aiohttp.ClientSession, server: Server, origin: str = "") -> Talk:
    headers = {"Origin": origin or f"http://{host_of(server)}"}
    page = await client.ws_connect(f"{server.address}socket", headers=headers, max_msg_size=0)
    OPENED.append(page)
    return Talk(page.send_str, page.receive_str)


async def refused_status(client: aiohttp.ClientSession, address: str, origin: str) -> int:
    """Return the status with which a websocket is refused."""
    with pytest.raises(aiohttp.WSServerHandshakeError) as caught:
        await client.ws_connect(address, headers={"Origin": origin})
    return caught.value.status


# -- files and checks --------------------------------------------------------------------------------------------------


def test_the_page_and_its_files_are_sent(server: Server) -> None:
    status, text, headers = get(server.address)
    assert status == 200
    for name in re.findall(r'(?:src|href)="([^":]+)"', text):
        status, body, found = get(server.address + name)
        assert (status, body.encode()) == (200, page_files()[name][0])
        assert found["Content-Type"] == f"{page_files()[name][1]}; charset=utf-8"
    policy = headers["Content-Security-Policy"]
    assert "default-src 'none'" in policy
    assert "unsafe" not in policy
    assert (headers["X-Content-Type-Options"], headers["Referrer-Policy"]) == ("nosniff", "no-referrer")


NOWHERE = ("../server.py", "%2e%2e/server.py", "..%2fserver.py", "static/../../server.py", "/etc/passwd",
           "vendor/../../server.py", "page.html", "vendor", "save/x/case.toml", "main.js/")  # fmt: skip


def test_paths_lead_to_the_listed_files_only(server: Server) -> None:
    for path in NOWHERE:
        lines = f"GET /{server.token}/{path} HTTP/1.1", f"Host: {host_of(server)}", "Connection: close", "", ""
        answer = replied(server, "\r\n".join(lines).encode())
        assert answer.split(b" ")[1] in (b"403", b"404"), path
        assert b"import" not in answer, path


def test_foreign_requests_are_refused(server: Server) -> None:
    """test_talks.py asks for many more of them without a network."""
    host, port = host_of(server).split(":")
    status, text, _ = get(server.address, Host="example.org")
    assert (status, text) == (403, "This server answers to its own address only.\n")
    status, text, _ = get(server.address, Origin="http://example.org")
    assert (status, text) == (403, "Another page may not use this server.\n")
    assert get(server.address, Host=f"localhost:{port}")[0] == 200
    wrong, missing = (server.address.replace(f"{server.token}/", other) for other in ("x/", ""))
    for address in (wrong, missing, f"{wrong}main.js", f"{missing}socket"):
        status, text, _ = get(address)
        assert (status, text.startswith("The address lacks the token: ")) == (403, True)
    own = f"http://{host}:{port}"
    two = f"Host: {host}:{port}", f"Origin: {own}", "Origin: http://example.org"
    lines = f"GET /{server.token}/ HTTP/1.1", *two, "Connection: close", "", ""
    answer = replied(server, "\r\n".join(lines).encode())
    assert answer.split(b" ")[1] == b"403"
    for address, origin in ((f"{server.address}socket", "http://example.org"), (f"{wrong}socket", own)):
        assert ask(partial(refused_status, address=address, origin=origin)) == 403
    assert get(f"{server.address}socket")[:2] == (403, "Only the page may use this server.\n")


def test_the_server_listens_at_its_address_only(server: Server) -> None:
    port = int(host_of(server).split(":")[1])
    others = {info[4][0] for info in socket.getaddrinfo(socket.gethostname(), port, socket.AF_INET)}
    for address in {str(other) for other in others if not str(other).startswith("127.")}:
        with pytest.raises(OSError, match=r"refused|timed out"):
            socket.create_connection((address, port), 2.0)


MALFORMED = [
    b"\x00\x01\x02\r\n\r\n",
    b"GET\r\n\r\n",
    b"GET /{token}/ HTTP/9.9\r\nHost: x\r\n\r\n",
    b"GET /{token}/ HTTP/1.1\r\nHost: x\r\nContent-Length: -1\r\n\r\n",
    b"GET /{token}/ HTTP/1.1\r\nHost: x\r\nno colon\r\n\r\n",
    b"POST /{token}/ HTTP/1.1\r\nHost: x\r\nTransfer-Encoding: chunked\r\n\r\nzz\r\n",
    b"GET /{token}/" + b"x" * 20_000 + b" HTTP/1.1\r\n\r\n",
    b"GET //[ HTTP/1.1\r\nHost: x\r\n\r\n",
    b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03",
]
"""Requests that are no HTTP, or not quite."""


def test_malformed_requests_write_nothing_to_the_terminal(caplog: pytest.LogCaptureFixture) -> None:
    with served() as running:
        for request in MALFORMED:
            assert b"Traceback" not in replied(running, request.replace(b"{token}", running.token.encode()), True)
        assert get(running.address)[0] == 200
    assert caplog.text == ""


def test_an_error_of_a_handler_is_logged(monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture) -> None:
    monkeypatch.setattr(server_module, "POLICY", "{no_such_part}")
    with served() as running:
        assert get(running.address)[0] == 500
        assert running.token not in caplog.text
    assert "a request failed" in caplog.text


# -- talks; test_talks.py has more of them without a network -----------------------------------------------------------


def test_a_history_is_led_and_saved_as_files(server: Server) -> None:
    async def work(client: aiohttp.ClientSession) -> str:
        talk = await connect(client, server)
        name, first = await talk.hello()
        assert len(first["add"]) == 1
        assert (await talk.load(3e5))["add"][0]["load"]["Q"] == 3e5
        return name

    name = ask(work)
    status, text, headers = get(f"{server.address}save/{name}/case.toml")
    assert status == 200
    assert headers["Content-Disposition"] == 'attachment; filename="case.toml"'
    assert casefile.parse_case(text).history.values()[-1, 1] == 3e5
    status, text, _ = get(f"{server.address}save/{name}/recording.html")
    assert (status, 'id="recording"' in text) == (200, True)


def test_a_message_of_10_mb_ends_its_connection_only(server: Server) -> None:
    async def work(client: aiohttp.ClientSession) -> None:
        other, talk = await connect(client, server), await connect(client, server)
        await other.hello()
        await talk.hello()
        with contextlib.suppress(ConnectionError):  # the server closes before all is sent
            await talk.say("x" * 10_000_000)
        closed = aiohttp.WSMsgType.CLOSE, aiohttp.WSMsgType.CLOSED, aiohttp.WSMsgType.ERROR
        assert (await OPENED[-1].receive()).type in closed
        assert (await other.load(1e5))["kind"] == "pictures"

    ask(work)


UPGRADE = """GET /{token}/socket HTTP/1.1
Host: {host}
Origin: http://{host}
Upgrade: websocket
Connection: Upgrade
Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==
Sec-WebSocket-Version: 13

"""


def test_a_page_that_reads_nothing_does_not_keep_the_server_from_ending(monkeypatch: pytest.MonkeyPatch) -> None:
    """The server would wait for an answer of the page for ever. `served` sees that it ends."""
    monkeypatch.setattr(web, "WebSocketResponse", partial(web.WebSocketResponse, timeout=1e9))
    monkeypatch.setattr(server_module, "LAST_WAIT", 0.01)
    with served() as running, raw_socket(running) as raw:
        raw.sendall(UPGRADE.replace("\n", "\r\n").format(token=running.token, host=host_of(running)).encode())
        assert b"101" in raw.recv(20)
        while not running._sockets:  # the server notes the page after its answer
            select.select([], [], [], 0.01)
        (request,) = running._sockets.values()
        request.transport.get_extra_info("socket").setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, 4096)
        raw.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
        raw.setblocking(False)
        ping, sent = b"\x89\xfd" + bytes(4) + b"x" * 125, 0
        while not request.transport.get_write_buffer_size():  # until the answers have filled all other buffers
            select.select([], [raw], [], 0.01)
            with contextlib.suppress(BlockingIOError):
                sent += raw.send((ping * 100)[sent % len(ping) :])


def test_a_port_in_use_is_refused_with_one_sentence(server: Server, capsys: pytest.CaptureFixture[str]) -> None:
    port = host_of(server).split(":")[1]
    assert main(["live", "--no-browser", "--port", port]) == 2
    sentence = f"fastpin: --port: {port} can't be used: address already in use; choose another one, or leave it out\n"
    assert capsys.readouterr().err == sentence


def test_ctrl_c_ends_the_server() -> None:
    with started(fastpin("live", "--no-browser", "--nodes", 21)) as process:
        assert get(process.stdout.readline().split()[-1])[0] == 200
        process.send_signal(2)
        _, trouble = process.communicate()
    assert (process.returncode, trouble) == (0, "")
