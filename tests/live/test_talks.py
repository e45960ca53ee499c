"""Talks of pages with their server, without a network: answers, visitors, long histories, and who is let in."""

from __future__ import annotations

import asyncio
import json

import pytest
from aiohttp import WSMsgType

from fastpin import casefile
from fastpin.live import server as server_module
from fastpin.live.contact import LiveContact
from fastpin.live.page import page_files
from fastpin.live.protocol import MOST_BYTES
from fastpin.live.server import Server
from tests.support.live_pages import HeldSteps, Talk, Wire, contact, in_a_loop

TOKENLESS = "The address lacks the token: take the address that fastpin live has printed."


def small() -> LiveContact:
    return contact(nodes=21)


async def with_history(talk: Talk) -> str:
    """Let a page follow six loads, and return the name of its session."""
    name, _ = await talk.hello()
    for k in range(5):
        await talk.load(1e3 * (k + 1))
    return name


async def follow(talk: Talk) -> int:
    """Ask for the whole history with other friction."""
    return await talk.send("change", changes={"friction": 0.3}, follow="history", gesture=2)


# -- who is let in -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("port", "own"), [(8000, ["127.0.0.1:8000", "localhost:8000"]), (80, ["127.0.0.1", "localhost"])]
)
def test_a_request_needs_the_address_the_page_and_the_token(port: int, own: list[str]) -> None:
    server = Server(small)
    server.take_port(port)
    assert server.address == f"http://{own[0]}/{server.token}/"
    pages = [f"http://{name}" for name in own]
    for name in own:
        assert server.objection(name, [], server.token) == server.objection(name, pages, server.token) == ""
        for token in ("", "nothing", server.token[:-1], server.token + "x", "\u00e9"):
            assert server.objection(name, pages, token) == TOKENLESS
        for origin in ("http://example.org", "null", f"https://{name}", name, "", f"http://{name}:1"):
            for origins in ([origin], [pages[0], origin]):
                assert server.objection(name, origins, server.token) == "Another page may not use this server."
    known = {
        "127.0.0.1",
        "127.0.0.1:8000",
        "127.0.0.1:1",
        "localhost",
        "localhost:8000",
        "127.0.0.3:8000",
        "0.0.0.0:8000",
    }
    for other in (None, "", "example.org", *known - set(own)):
        assert server.objection(other, [], server.token) == "This server answers to its own address only."


def test_no_file_of_the_page_names_another_address() -> None:
    for name, (body, _) in page_files().items():
        if not name.startswith("vendor/"):
            rest = body.replace(b"http://www.w3.org", b"")
            assert b"http://" not in rest, name
            assert b"https://" not in rest, name


# -- messages ----------------------------------------------------------------------------------------------------------


@in_a_loop
async def test_a_load_is_answered_by_its_picture() -> None:
    talk = Wire(Server(small))
    _, first = await talk.hello()
    answer = await talk.load(1e5)
    assert (len(first["add"]), answer["keep"], len(answer["add"])) == (1, 1, 1)
    assert answer["add"][0]["load"]["Q"] == 1e5


BAD = ["", "{", "[]", "null", '"load"', '{"kind": "load", "id": 1}', '{"kind": "hello", "id": 1, "session": 5}', "\x00",
       '{"kind": "load", "id": 1, "loads": {"__class__": 1}, "gesture": 1}', "[" * 5_000]  # fmt: skip


@in_a_loop
async def test_bad_messages_are_answered_and_survived() -> None:
    talk = Wire(Server(small))
    assert "the first message must be hello" in (await talk.tell("undo"))["sentence"]
    await talk.hello()
    for text in BAD:
        await talk.say(text)
        answer = await talk.hear()
        assert (answer["kind"], bool(answer["sentence"])) == ("refused", True)
    await talk.say("\xff\x00", WSMsgType.BINARY)
    assert (await talk.hear())["sentence"] == "message: must be text"
    assert (await talk.load(1e5))["kind"] == "pictures"


def test_the_longest_message_of_a_page_is_far_below_the_limit() -> None:
    loads = dict.fromkeys(("P", "Q", "M", "sxx", "syy", "rotation", "sxy", "ux", "uy"), -1.2345678901234568e-300)
    longest = json.dumps({"kind": "load", "id": 2**53, "loads": loads, "gesture": 2**53})
    assert len(longest) < MOST_BYTES / 10


@in_a_loop
async def test_an_unexpected_error_is_answered_and_survived(monkeypatch, caplog):
    def broken(*_: object) -> None:
        raise ZeroDivisionError

    talk = Wire(Server(small))
    await talk.hello()
    monkeypatch.setattr(LiveContact, "_obey_undo", broken)
    assert "failed unexpectedly (ZeroDivisionError)" in (await talk.tell("undo"))["sentence"]
    assert (await talk.load(1e5))["kind"] == "pictures"
    assert "a message failed" in caplog.text


@in_a_loop
async def test_a_contact_that_cannot_be_made_says_so_and_may_be_tried_again(caplog: pytest.LogCaptureFixture) -> None:
    errors: list[BaseException] = [MemoryError()]

    def make() -> LiveContact:
        if errors:
            raise errors.pop()
        return small()

    talk = Wire(Server(make))
    assert "failed unexpectedly (MemoryError)" in (await talk.tell("hello", session=""))["sentence"]
    await talk.hello()
    assert "a message failed" in caplog.text


# -- visitors and long histories -----------------------------------------------------------------------------------


@in_a_loop
async def test_a_page_that_comes_back_finds_its_contact() -> None:
    server = Server(small)
    talk = Wire(server)
    name, _ = await talk.hello()
    await talk.load(2e5)
    other, _ = await Wire(server).hello(name)  # a copy of the tab: a contact of its own
    assert other != name
    await talk.go()
    found, pictures = await Wire(server).hello(name)
    assert (found, pictures["add"][-1]["load"]["Q"]) == (name, 2e5)


@in_a_loop
async def test_too_many_pages_are_refused_and_the_others_go_on(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(server_module, "MOST_SESSIONS", 2)
    server = Server(small)
    talks = [Wire(server) for _ in range(2)]
    names = [(await talk.hello())[0] for talk in talks]
    late = Wire(server)
    assert "2 pages are open" in (await late.tell("hello", session=""))["sentence"]
    assert (await talks[1].load(1e5))["kind"] == "pictures"
    await talks[0].go()  # its contact makes room
    newest, _ = await late.hello()
    assert list(server.contacts) == [names[1], newest]


@in_a_loop
async def test_of_too_many_messages_the_last_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(server_module, "MOST_WAITING", 3)
    talk = Wire(Server(small))
    await talk.hello()
    steps = HeldSteps(monkeypatch)
    await talk.send("load", loads={"Q": 0.0}, gesture=1)
    await steps.begun()
    numbers = [await talk.send("load", loads={"Q": 1e3 * k}, gesture=1) for k in range(5)]
    await talk.read()
    steps.let_go(4)
    refused = [(await talk.answer(number))["sentence"] for number in numbers[3:]]
    assert refused == ["message: more than 3 messages wait; this one is dropped"] * 2
    assert (await talk.answer(numbers[2]))["add"][-1]["load"]["Q"] == 2e3


@in_a_loop
async def test_a_long_history_is_stopped_by_its_page_and_leaves_the_contact_where_it_was(monkeypatch):
    talk = Wire(Server(small))
    await talk.send("stop")  # before hello: nothing happens
    await with_history(talk)
    steps = HeldSteps(monkeypatch)
    number = await follow(talk)
    await steps.begun()
    steps.let_go()
    await steps.begun()
    await talk.send("stop")
    await talk.read()
    steps.let_go(9)
    sentence = "history: was stopped on the way; the contact is where it was"
    assert (await talk.answer(number))["sentence"] == sentence
    assert len(steps.taken) == 2
    assert (await talk.load(0.0))["keep"] == 6
    again = await talk.answer(await follow(talk))  # nothing is left of the first try
    assert (again["keep"], len(again["add"]), again["case"]["friction"]) == (0, 7, 0.3)


@in_a_loop
async def test_what_others_ask_waits_for_a_long_history(monkeypatch: pytest.MonkeyPatch) -> None:
    server = Server(small)
    one, other = Wire(server), Wire(server)
    name = await with_history(one)
    await other.hello()
    steps = HeldSteps(monkeypatch)
    number = await follow(one)
    await steps.begun()
    saving = asyncio.create_task(server.saved(name, "case.toml"))
    passing = await other.send("load", loads={"Q": 1e3}, gesture=1)
    await other.read()
    steps.let_go(7)
    assert (await other.answer(passing))["kind"] == "pictures"
    assert (await one.answer(number))["kind"] == "pictures"
    case = casefile.parse_case(await saving or "")
    assert (case.problem.friction, case.history.values()[-1, 1]) == (0.3, 5e3)
    assert len(steps.taken) == 7


@in_a_loop
async def test_a_page_that_goes_in_a_long_history_finds_its_contact_where_it_was(monkeypatch):
    server = Server(small)
    talk = Wire(server)
    name = await with_history(talk)
    steps = HeldSteps(monkeypatch)
    await follow(talk)
    await steps.begun()
    steps.let_go()
    await steps.begun()
    await talk.go()
    steps.let_go()
    found, pictures = await Wire(server).hello(name)
    assert found == name
    assert (pictures["case"]["friction"], pictures["add"][-1]["load"]["Q"]) == (0.4, 5e3)
    assert len(steps.taken) == 2
