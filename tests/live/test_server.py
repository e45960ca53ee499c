"""The server of the page: what it sends, whom it refuses, and what it survives."""

from __future__ import annotations

import asyncio
import contextlib
import io
import json
import re
import socket
import subprocess
import sys
import time
from collections.abc import Awaitable, Callable, Iterator
from typing import Any

import aiohttp
import pytest
import segno

from fastpin import casefile
from fastpin.cli import live as live_command
from fastpin.cli.main import main
from fastpin.errors import InputError
from fastpin.live import server as server_module
from fastpin.live.contact import LiveContact
from fastpin.live.page import page_files
from fastpin.live.protocol import (
    ALONE,
    CLASS,
    MOST_A_SECOND,
    MOST_BYTES,
    Limits,
    Message,
)
from fastpin.live.server import Server
from tests.support.live_pages import contact, served

WAIT = 20.0
"""Seconds after which an answer is missing. Other processes may slow the machine down."""


@pytest.fixture(scope="module")
def server() -> Iterator[Server]:
    with served() as running:
        yield running


OPENED: list[aiohttp.ClientWebSocketResponse] = []
"""The websockets of a test. They are closed at its end."""

CLOSED = (aiohttp.WSMsgType.CLOSE, aiohttp.WSMsgType.CLOSED, aiohttp.WSMsgType.ERROR)


def host_of(server: Server) -> str:
    return server.address.split("/")[2]


def ask(work: Callable[[aiohttp.ClientSession], Awaitable[Any]]) -> Any:
    """Do some work with a client."""

    async def run() -> Any:
        async with aiohttp.ClientSession() as client:
            try:
                return await asyncio.wait_for(work(client), WAIT)
            finally:
                while OPENED:
                    await OPENED.pop().close()

    return asyncio.run(run())


def get(address: str, **headers: str) -> tuple[int, str, Any]:
    """Return status, text and headers of an answer."""

    async def work(client: aiohttp.ClientSession) -> tuple[int, str, Any]:
        async with client.get(address, headers={name.replace("_", "-"): text for name, text in headers.items()}) as got:
            return got.status, await got.text(), got.headers

    return ask(work)


class Talk:
    """A websocket as a page has it."""

    def __init__(self, page: aiohttp.ClientWebSocketResponse) -> None:
        self.page, self.number = page, 0

    async def send(self, kind: str, **fields: Any) -> int:
        self.number += 1
        await self.page.send_str(json.dumps({"kind": kind, "id": self.number, **fields}))
        return self.number

    async def answer(self, number: int | None) -> dict[str, Any]:
        """Return the answer to a message; others are passed over."""
        while True:
            found = json.loads((await self.page.receive()).data)
            if found["id"] == number and found["kind"] != "welcome":
                return found

    async def tell(self, kind: str, **fields: Any) -> dict[str, Any]:
        return await self.answer(await self.send(kind, **fields))

    async def hello(self, session: str = "") -> tuple[str, dict[str, Any]]:
        """Return the name of the session, and the pictures."""
        await self.send("hello", session=session)
        welcome = json.loads((await self.page.receive()).data)
        assert welcome["kind"] == "welcome", welcome
        return welcome["session"], await self.answer(welcome["id"])


async def connect(client: aiohttp.ClientSession, server: Server, origin: str = "") -> Talk:
    headers = {"Origin": origin or f"http://{host_of(server)}"}
    OPENED.append(await client.ws_connect(f"{server.address}socket", headers=headers, max_msg_size=0))
    return Talk(OPENED[-1])


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


def test_no_file_of_the_page_names_another_address() -> None:
    for name, (body, _) in page_files().items():
        if not name.startswith("vendor/"):
            assert not re.search(rb"https?://(?!www\.w3\.org)", body), name


@pytest.mark.parametrize("path", ["", "nothing/", "nothing/socket", "nothing/main.js"])
def test_without_the_token_nothing_is_sent(server: Server, path: str) -> None:
    status, text, _ = get(f"http://{host_of(server)}/{path}")
    assert status == 403
    assert text == "The address lacks the token: take the address that fastpin live has printed.\n"


PATHS = ("../server.py", "%2e%2e/server.py", "..%2fserver.py", "static/../../server.py", "/etc/passwd",
         "vendor/../../server.py", "page.html", "vendor", "save/x/case.toml", "main.js/")  # fmt: skip


@pytest.mark.parametrize("path", PATHS)
def test_paths_lead_to_the_listed_files_only(server: Server, path: str) -> None:
    host, port = host_of(server).split(":")
    with socket.create_connection((host, int(port))) as raw:  # a client would shorten the path
        request = f"GET /{server.token}/{path} HTTP/1.1\r\nHost: {host}:{port}\r\nConnection: close\r\n\r\n"
        raw.sendall(request.encode())
        answer = b"".join(iter(lambda: raw.recv(65_536), b""))
    assert answer.split(b" ")[1] in (b"403", b"404")
    assert b"import" not in answer


@pytest.mark.parametrize("host", ["example.org", "127.0.0.1", "127.0.0.1:1", "0.0.0.0:80", "localhost"])
def test_another_host_is_refused(server: Server, host: str) -> None:
    status, text, _ = get(server.address, Host=host)
    assert (status, text) == (403, "This server answers to its own address only.\n")


def test_localhost_is_this_machine_too(server: Server) -> None:
    port = host_of(server).split(":")[1]
    assert get(server.address, Host=f"localhost:{port}", Origin=f"http://localhost:{port}")[0] == 200


@pytest.mark.parametrize("origin", ["http://example.org", "null", "https://127.0.0.1", ""])
def test_another_origin_is_refused(server: Server, origin: str) -> None:
    assert get(server.address, Origin=origin)[:2] == (403, "Another page may not use this server.\n")

    async def work(client: aiohttp.ClientSession) -> int:
        with pytest.raises(aiohttp.WSServerHandshakeError) as caught:
            await client.ws_connect(f"{server.address}socket", headers={"Origin": origin})
        return caught.value.status

    assert ask(work) == 403


def test_one_foreign_origin_of_two_is_refused(server: Server) -> None:
    host = host_of(server)
    origins = f"Origin: http://{host}\r\nOrigin: http://example.org"
    with socket.create_connection((host.split(":")[0], int(host.split(":")[1]))) as raw:
        raw.sendall(f"GET /{server.token}/ HTTP/1.1\r\nHost: {host}\r\n{origins}\r\n\r\n".encode())
        assert raw.recv(65_536).split(b" ")[1] == b"403"


def test_a_websocket_needs_an_origin(server: Server) -> None:
    assert get(f"{server.address}socket")[:2] == (403, "Only the page may use this server.\n")


def test_the_server_listens_on_this_machine_only(server: Server) -> None:
    port = int(host_of(server).split(":")[1])
    others = {info[4][0] for info in socket.getaddrinfo(socket.gethostname(), port, socket.AF_INET)} - {"127.0.0.1"}
    for address in others:
        if not address.startswith("127."):
            with pytest.raises(OSError, match=r"refused|timed out"):
                socket.create_connection((address, port), 2.0)


# -- talks -------------------------------------------------------------------------------------------------------------


def test_a_load_is_answered_by_its_picture(server: Server) -> None:
    async def work(client: aiohttp.ClientSession) -> None:
        talk = await connect(client, server)
        _, first = await talk.hello()
        answer = await talk.tell("load", loads={"Q": 1e5}, gesture=1, drag=True)
        assert (len(first["add"]), answer["keep"], len(answer["add"])) == (1, 1, 1)
        assert answer["add"][0]["load"]["Q"] == 1e5

    ask(work)


def test_a_page_that_comes_back_finds_its_contact(server: Server) -> None:
    async def work(client: aiohttp.ClientSession) -> None:
        talk = await connect(client, server)
        name, _ = await talk.hello()
        await talk.tell("load", loads={"Q": 2e5}, gesture=1, drag=False)
        twin = await connect(client, server)  # a copy of the tab: a contact of its own
        other, _ = await twin.hello(name)
        assert other != name
        await talk.page.close()
        for _ in range(100):  # until the server has noticed
            again = await connect(client, server)
            found, pictures = await again.hello(name)
            if found == name:
                break
            await again.page.close()
            await asyncio.sleep(0.02)
        assert found == name
        assert pictures["add"][-1]["load"]["Q"] == 2e5

    ask(work)


BAD = ["", "{", "[]", "null", '"load"', '{"kind": "load", "id": 1}', '{"kind": "hello", "id": 1, "session": 5}', "\x00",
       '{"kind": "load", "id": 1, "loads": {"__class__": 1}, "gesture": 1, "drag": true}', "[" * 5_000]  # fmt: skip


def test_bad_messages_are_answered_and_survived(server: Server) -> None:
    async def work(client: aiohttp.ClientSession) -> None:
        talk = await connect(client, server)
        await talk.send("undo")  # before hello
        assert "the first message must be hello" in (await talk.answer(1))["sentence"]
        await talk.hello()
        for text in BAD:
            await talk.page.send_str(text)
            answer = json.loads((await talk.page.receive()).data)
            assert (answer["kind"], bool(answer["sentence"])) == ("refused", True)
        await talk.page.send_bytes(b"\xff\x00")
        assert json.loads((await talk.page.receive()).data)["sentence"] == "message: must be text"
        assert (await talk.tell("load", loads={"Q": 1e5}, gesture=1, drag=False))["kind"] == "pictures"

    ask(work)


def test_a_message_of_10_mb_ends_its_connection_only(server: Server) -> None:
    async def work(client: aiohttp.ClientSession) -> None:
        other = await connect(client, server)
        await other.hello()
        talk = await connect(client, server)
        await talk.hello()
        with contextlib.suppress(ConnectionError):  # the server closes before all is sent
            await talk.page.send_str("x" * 10_000_000)
        assert (await talk.page.receive()).type in CLOSED
        assert (await other.tell("load", loads={"Q": 1e5}, gesture=1, drag=False))["kind"] == "pictures"

    ask(work)


def test_the_longest_message_of_a_page_is_far_below_the_limit() -> None:
    loads = dict.fromkeys(("P", "Q", "M", "sxx", "syy", "rotation", "sxy", "ux", "uy"), -1.2345678901234568e-300)
    assert (
        len(json.dumps({"kind": "load", "id": 2**53, "loads": loads, "gesture": 2**53, "drag": False}))
        < MOST_BYTES / 10
    )


def test_a_thousand_messages_a_second_neither_pile_up_nor_stop_another_page(server: Server) -> None:
    async def work(client: aiohttp.ClientSession) -> None:
        other = await connect(client, server)
        await other.hello()
        talk = await connect(client, server)
        await talk.hello()
        began = time.monotonic()
        for k in range(1_000):
            await talk.send("load", loads={"Q": 100.0 * k}, gesture=1, drag=True)
        spent = time.monotonic() - began
        answer = await other.tell("load", loads={"Q": 1e5}, gesture=1, drag=False)
        assert answer["kind"] == "pictures"
        kinds: list[str] = []
        await asyncio.sleep(1.1)  # the next second has begun
        number = await talk.send("undo")
        while True:
            found = json.loads((await talk.page.receive()).data)
            kinds.append(found["kind"])
            if found["id"] == number:
                break
        assert found["kind"] == "pictures"
        assert kinds.count("pictures") + kinds.count("skipped") <= MOST_A_SECOND * (spent + 1.0) + 1
        assert kinds.count("skipped") > 0

    ask(work)


def test_binary_messages_count_against_the_limit(server: Server) -> None:
    async def work(client: aiohttp.ClientSession) -> None:
        talk = await connect(client, server)
        await talk.hello()
        began = time.monotonic()
        for _ in range(3_000):
            await talk.page.send_bytes(b"\xff")
        spent = time.monotonic() - began
        await asyncio.sleep(1.1)  # the next second has begun
        number, answers = await talk.send("undo"), 0
        while json.loads((await talk.page.receive()).data)["id"] != number:
            answers += 1
        assert 0 < answers <= MOST_A_SECOND * (spent + 1.0) + 1

    ask(work)


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
        host, port = host_of(running).split(":")
        for request in MALFORMED:
            with socket.create_connection((host, int(port)), WAIT) as raw:
                raw.sendall(request.replace(b"{token}", running.token.encode()))
                raw.shutdown(socket.SHUT_WR)
                with contextlib.suppress(ConnectionError):
                    answer = b"".join(iter(lambda raw=raw: raw.recv(65_536), b""))  # type: ignore[misc]
            assert b"Traceback" not in answer
        assert get(running.address)[0] == 200
    assert caplog.text == ""


def test_an_error_of_a_handler_is_logged(monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture) -> None:
    monkeypatch.setattr(server_module, "POLICY", "{no_such_part}")
    with served() as running:
        assert get(running.address)[0] == 500
        assert running.token not in caplog.text
    assert "a request failed" in caplog.text


def slow_down(monkeypatch: pytest.MonkeyPatch, seconds: float) -> None:
    """Let each step of all contacts take so much longer."""
    step = LiveContact._step

    def slow(self: LiveContact, *arguments: Any) -> None:
        time.sleep(seconds)
        step(self, *arguments)

    monkeypatch.setattr(LiveContact, "_step", slow)


def test_a_long_history_is_stopped_by_its_page(monkeypatch: pytest.MonkeyPatch) -> None:
    async def work(client: aiohttp.ClientSession) -> None:
        talk = await connect(client, running)
        await talk.send("stop")  # before hello: nothing happens
        await talk.hello()
        for k in range(30):
            await talk.tell("load", loads={"Q": 1e4 * k}, gesture=1, drag=False)
        slow_down(monkeypatch, 0.05)
        began = time.monotonic()
        number = await talk.send("change", changes={"friction": 0.3}, follow="history", gesture=2)
        await asyncio.sleep(0.1)
        await talk.send("stop")
        assert "was stopped on the way" in (await talk.answer(number))["sentence"]
        assert time.monotonic() - began < 0.7 * 31 * 0.05

    with served() as running:
        ask(work)


def test_a_slow_solve_does_not_pile_up(monkeypatch: pytest.MonkeyPatch) -> None:
    steps = LiveContact.steps

    def slow(self: LiveContact, message: Message) -> Iterator[None]:
        time.sleep(0.05)
        return (yield from steps(self, message))

    monkeypatch.setattr(LiveContact, "steps", slow)

    async def work(client: aiohttp.ClientSession) -> None:
        talk = await connect(client, running)
        await talk.hello()
        began = time.monotonic()
        for k in range(100):
            last = await talk.send("load", loads={"Q": 1000.0 * k}, gesture=1, drag=True)
            await asyncio.sleep(0.002)
        answer = await talk.answer(last)
        assert answer["add"][-1]["load"]["Q"] == 99_000.0  # the latest load is followed,
        assert time.monotonic() - began < 0.5 * 100 * 0.05  # and most of the others are not

    with served() as running:
        ask(work)


def test_a_hundred_connections_are_not_too_many() -> None:
    async def work(client: aiohttp.ClientSession) -> None:
        talks = [await connect(client, running) for _ in range(100)]
        taken, others = talks[: ALONE.connections], talks[ALONE.connections :]
        for talk in others:
            assert f"{ALONE.connections} pages are open" in (await talk.answer(None))["sentence"]
            assert (await talk.page.receive()).data == aiohttp.WSCloseCode.TRY_AGAIN_LATER
        sentences = []
        for talk in taken:
            await talk.send("hello", session="")
            sentences.append(json.loads((await talk.page.receive()).data))
        assert [one["kind"] for one in sentences].count("welcome") == ALONE.sessions
        assert f"{ALONE.sessions} pages are open" in sentences[-1]["sentence"]
        for talk in taken:
            await talk.page.close()
        talk = await connect(client, running)  # the contacts of pages that have gone make room
        for _ in range(100):
            await talk.send("hello", session="")
            if json.loads((await talk.page.receive()).data)["kind"] == "welcome":
                break
            await asyncio.sleep(0.02)
        else:
            raise AssertionError("no room")

    with served(lambda: contact(nodes=21)) as running:
        ask(work)


def test_an_unexpected_error_is_answered_and_survived(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    def broken(*_: object) -> None:
        raise ZeroDivisionError

    async def work(client: aiohttp.ClientSession) -> None:
        talk = await connect(client, running)
        await talk.hello()
        monkeypatch.setattr(LiveContact, "_obey_undo", broken)
        assert "failed unexpectedly (ZeroDivisionError)" in (await talk.tell("undo"))["sentence"]
        assert (await talk.tell("load", loads={"Q": 1e5}, gesture=1, drag=False))["kind"] == "pictures"

    with served() as running:
        ask(work)
    assert "a message failed" in caplog.text


def test_a_contact_that_cannot_be_made_says_so_and_may_be_tried_again(caplog: pytest.LogCaptureFixture) -> None:
    tries = 0

    def make() -> LiveContact:
        nonlocal tries
        tries += 1
        if tries == 1:
            raise MemoryError
        return contact(nodes=21)

    async def work(client: aiohttp.ClientSession) -> None:
        talk = await connect(client, running)
        assert "failed unexpectedly (MemoryError)" in (await talk.tell("hello", session=""))["sentence"]
        await talk.hello()

    with served(make) as running:
        ask(work)
    assert "a message failed" in caplog.text


def test_history_and_recording_are_sent_as_files(server: Server) -> None:
    async def work(client: aiohttp.ClientSession) -> str:
        talk = await connect(client, server)
        name, _ = await talk.hello()
        await talk.tell("load", loads={"Q": 3e5}, gesture=1, drag=False)
        return name

    name = ask(work)
    status, text, headers = get(f"{server.address}save/{name}/case.toml")
    assert status == 200
    assert headers["Content-Disposition"] == 'attachment; filename="case.toml"'
    assert casefile.parse_case(text).history.values()[-1, 1] == 3e5
    status, text, _ = get(f"{server.address}save/{name}/recording.html")
    assert (status, 'id="recording"' in text) == (200, True)


# -- a class -----------------------------------------------------------------------------------------------------------

SHARED = "127.0.0.3"
"""An address that reaches this machine only, and is another one than that of a page for oneself."""


@pytest.fixture(scope="module")
def shared() -> Iterator[Server]:
    with served(lambda: contact(nodes=21, limits=CLASS), host=SHARED, limits=CLASS) as running:
        yield running


def test_a_shared_page_needs_its_token(shared: Server) -> None:
    assert shared.address.startswith(f"http://{SHARED}:")
    assert get(shared.address)[0] == 200
    wrong = shared.address.replace(shared.token, "x" * len(shared.token))
    missing = shared.address.replace(f"{shared.token}/", "")
    for address in (wrong, missing, f"{wrong}main.js", f"{wrong}code.svg", f"{missing}socket"):
        assert get(address)[:2] == (
            403, "The address lacks the token: take the address that fastpin live has printed.\n"
        )  # fmt: skip

    async def work(client: aiohttp.ClientSession) -> int:
        with pytest.raises(aiohttp.WSServerHandshakeError) as caught:
            await client.ws_connect(f"{wrong}socket", headers={"Origin": f"http://{host_of(shared)}"})
        talk = await connect(client, shared)
        await talk.hello()
        assert (await talk.tell("load", loads={"Q": 1e5}, gesture=1, drag=False))["kind"] == "pictures"
        return caught.value.status

    assert ask(work) == 403


@pytest.mark.parametrize("host", ["localhost", "127.0.0.1", "example.org", SHARED])
def test_a_shared_page_answers_to_its_own_address_only(shared: Server, host: str) -> None:
    port = host_of(shared).split(":")[1]
    other = host if host == SHARED else f"{host}:{port}"
    assert get(shared.address, Host=other)[:2] == (403, "This server answers to its own address only.\n")
    assert get(shared.address, Origin=f"http://{other}")[:2] == (403, "Another page may not use this server.\n")


def test_a_shared_page_listens_at_its_address_only(shared: Server) -> None:
    with pytest.raises(ConnectionRefusedError):
        socket.create_connection(("127.0.0.1", int(host_of(shared).split(":")[1])), 2.0)


def test_an_address_of_the_sixth_version_stands_in_brackets() -> None:
    try:
        with served(lambda: contact(nodes=21), host="::1", limits=CLASS) as running:
            assert running.address.startswith("http://[::1]:")
            assert get(running.address)[0] == 200
    except InputError as error:
        pytest.skip(str(error))


def test_the_qr_code_is_that_of_the_address(server: Server, shared: Server) -> None:
    status, text, headers = get(f"{shared.address}code.svg")
    assert (status, headers["Content-Type"]) == (200, "image/svg+xml")
    path = io.BytesIO()
    segno.make(shared.address, micro=False).save(path, kind="svg", light="white", xmldecl=False)
    assert text == path.getvalue().decode()
    assert get(f"{server.address}code.svg")[0] == 404  # a page for oneself is not shared

    async def work(client: aiohttp.ClientSession) -> None:
        for running, address in ((server, ""), (shared, shared.address)):
            talk = await connect(client, running)
            await talk.send("hello", session="")
            assert json.loads((await talk.page.receive()).data)["shared"] == address

    ask(work)


def test_too_many_visitors_are_refused_and_the_others_go_on() -> None:
    few = Limits(connections=5, sessions=3)

    async def work(client: aiohttp.ClientSession) -> None:
        talks = [await connect(client, running) for _ in range(3)]
        for talk in talks:
            await talk.hello()
        late = await connect(client, running)
        assert "3 pages are open" in (await late.tell("hello", session=""))["sentence"]
        waiting = await connect(client, running)
        beyond = await connect(client, running)
        assert "5 pages are open" in (await beyond.answer(None))["sentence"]
        for talk in talks:
            assert (await talk.tell("load", loads={"Q": 1e5}, gesture=1, drag=False))["kind"] == "pictures"
        assert not waiting.page.closed

    with served(lambda: contact(nodes=21, limits=few), host=SHARED, limits=few) as running:
        ask(work)


def test_a_long_history_of_one_visitor_lets_the_others_pass(monkeypatch: pytest.MonkeyPatch) -> None:
    async def work(client: aiohttp.ClientSession) -> None:
        one, other = await connect(client, running), await connect(client, running)
        name, _ = await one.hello()
        await other.hello()
        for k in range(60):
            await one.tell("load", loads={"Q": 1e3 * k}, gesture=1, drag=False)
        slow_down(monkeypatch, 0.03)
        number = await one.send("change", changes={"friction": 0.3}, follow="history", gesture=2)
        await asyncio.sleep(0.1)
        for k in range(5):  # each of them waits for a turn, not for the history of two seconds
            began = time.monotonic()
            await other.tell("load", loads={"Q": 1e3 * k}, gesture=1, drag=False)
            times.append(time.monotonic() - began)
        case = asyncio.create_task(client.get(f"{running.address}save/{name}/case.toml").__aenter__())
        assert (await one.answer(number))["kind"] == "pictures"
        text = await (await case).text()  # waits for the whole history
        assert casefile.parse_case(text).history.values()[-1, 1] == 59e3

    times: list[float] = []
    with served(lambda: contact(nodes=21, limits=CLASS), host=SHARED, limits=CLASS) as running:
        ask(work)
    assert sorted(times)[2] < 0.5


def test_a_page_that_goes_in_a_long_history_finds_its_contact_where_it_was(monkeypatch: pytest.MonkeyPatch) -> None:
    async def work(client: aiohttp.ClientSession) -> None:
        talk = await connect(client, running)
        name, _ = await talk.hello()
        for k in range(40):
            await talk.tell("load", loads={"Q": 1e3 * k}, gesture=1, drag=False)
        slow_down(monkeypatch, 0.05)
        await talk.send("change", changes={"friction": 0.3}, follow="history", gesture=2)
        await asyncio.sleep(0.2)
        await talk.page.close()
        for _ in range(100):
            again = await connect(client, running)
            found, pictures = await again.hello(name)
            if found == name:
                break
            await again.page.close()
            await asyncio.sleep(0.02)
        assert found == name
        assert (pictures["case"]["friction"], pictures["add"][-1]["load"]["Q"]) == (0.4, 39e3)

    with served(lambda: contact(nodes=21)) as running:
        ask(work)


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


# -- the command -------------------------------------------------------------------------------------------------------


def test_a_port_in_use_is_refused_with_one_sentence(server: Server, capsys: pytest.CaptureFixture[str]) -> None:
    port = host_of(server).split(":")[1]
    assert main(["live", "--no-browser", "--port", port]) == 2
    sentence = f"fastpin: --port: {port} can't be used: address already in use; choose another one, or leave it out\n"
    assert capsys.readouterr().err == sentence


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["--port", "70000"], "--port: must be a whole number from 0 to 65535, not 70000"),
        (["--host", "somewhere"], "--host: must be one address of this machine in numbers"),
        (["--host", "0.0.0.0"], 'not "0.0.0.0"'),
        (["--host", "::"], 'not "::"'),
        (["--host", "fe80::1%eth0"], 'not "fe80::1%eth0"'),
        (["--host", "203.0.113.7"], "--host: 203.0.113.7 is no address of this machine"),
        (["--host", "127.0.0.1", "--nodes", "401"], "--nodes: must be a whole number from 5 to 400, not 401"),
        (["--nodes", "many"], '--nodes: must be a whole number from 5 to 1600, not "many"'),
        (["nothing.toml"], "nothing.toml: there is no such file"),
    ],
)
def test_wrong_arguments(arguments: list[str], sentence: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["live", "--no-browser", *arguments]) == 2
    assert sentence in capsys.readouterr().err


def test_without_its_packages_the_command_says_how_to_install_them() -> None:
    program = (
        "import sys; from fastpin.cli.main import main\n"
        "for package in ('aiohttp', 'segno'):\n"
        "    sys.modules[package] = None\n    print(main(['live', '--no-browser']))\n    del sys.modules[package]"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=60, check=True)
    assert done.stdout == "1\n1\n"
    assert done.stderr.splitlines() == [
        f"fastpin: the live page needs the package {package}: pip install 'fastpin[live]'"
        for package in ("aiohttp", "segno")
    ]


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


def test_a_page_that_reads_nothing_does_not_keep_the_server_from_ending() -> None:
    with socket.socket() as raw:
        with served() as running:
            host = host_of(running)
            raw.connect((host.split(":")[0], int(host.split(":")[1])))
            lines = (
                f"GET /{running.token}/socket HTTP/1.1", f"Host: {host}", f"Origin: http://{host}",
                "Upgrade: websocket", "Connection: Upgrade", f"Sec-WebSocket-Key: {'A' * 22}==",
                "Sec-WebSocket-Version: 13",
            )  # fmt: skip
            raw.sendall("\r\n".join((*lines, "", "")).encode())
            assert b"101" in raw.recv(20)
            raw.settimeout(0.5)
            pings = (b"\x89\xfd" + bytes(4) + b"x" * 125) * 1000
            with contextlib.suppress(TimeoutError):
                for _ in range(1_000):
                    raw.sendall(pings)  # until the answers have filled all buffers
            began = time.monotonic()
        assert time.monotonic() - began < 5.0  # without a limit the server waits for ten seconds


def test_the_mailbox_has_an_end() -> None:
    mailbox = server_module.Mailbox.__new__(server_module.Mailbox)
    with asyncio.Runner() as runner:

        async def fill() -> None:
            mailbox.__init__()  # type: ignore[misc]
            for k in range(server_module.MOST_WAITING):
                assert mailbox.put(Message("undo", k)) is None
            with pytest.raises(InputError, match="more than 64 messages wait"):
                mailbox.put(Message("undo", 99))
            first = await mailbox.get()
            assert first.id == 0

        runner.run(fill())


def test_ctrl_c_ends_the_server() -> None:
    command = [sys.executable, "-m", "fastpin", "live", "--no-browser", "--nodes", "21"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        address = process.stdout.readline().split()[-1]
        assert get(address)[0] == 200
        process.send_signal(2)
        _, trouble = process.communicate(timeout=WAIT)
    assert (process.returncode, trouble) == (0, "")
