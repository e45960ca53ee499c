"""The live page for tests: messages, a server in a thread, and the pictures as a page would keep them.

A talk of a page and a server needs no network: :func:`in_a_loop` runs both, with a :class:`Wire` as websocket.
"""

import asyncio
import base64
import contextlib
import functools
import json
import re
import threading
from collections.abc import AsyncIterator, Awaitable, Callable, Iterator
from typing import Any, ClassVar

import numpy as np
import pytest
from aiohttp import WSMessage, WSMsgType

import fastpin
from fastpin import casefile
from fastpin.live.contact import LiveContact
from fastpin.live.pin import LivePin
from fastpin.live.protocol import Message, read_message
from fastpin.live.server import Server
from tests.support.case_texts import PRESSED
from tests.support.processes import LONGEST

LIMIT = LONGEST
"""Seconds after which a test that waits in vain fails. No test passes or fails by it otherwise."""

NODES = 61
"""Few nodes: the tests are of the page, not of the numbers."""

FREE = PRESSED
"""The text of a case with a free pin."""


def contact(text: str | None = None, nodes: int = NODES) -> LivePin:
    """Return the contact of the built-in case, or of a case's text."""
    return LivePin(casefile.builtin_case() if text is None else casefile.parse_case(text), nodes)


def message(kind: str, number: int = 1, **fields: Any) -> Message:
    """Return a message, checked as those of a page are."""
    usual: dict[str, Any] = {
        "hello": {"session": ""},
        "load": {"gesture": 1},
        "change": {"gesture": 2, "follow": "load"},
        "nodes": {"gesture": 3, "follow": "load"},
        "keep": {"on": True},
    }.get(kind, {})
    return read_message(json.dumps({"kind": kind, "id": number, **usual, **fields}))


class Page:
    """What a page keeps of the answers: the pictures of the history, and the latest of everything else."""

    def __init__(self, live: LiveContact) -> None:
        self.live = live
        self.pictures: list[dict[str, Any]] = []
        self.latest: dict[str, Any] = {}
        self.tell("hello")

    def tell(self, kind: str, **fields: Any) -> dict[str, Any]:
        """Send a message, take the answer as the page does, and return it."""
        (answer,) = self.live.obey(message(kind, **fields))
        self.take(answer)
        return answer

    def take(self, answer: dict[str, Any]) -> None:
        """Take an answer with pictures."""
        if answer["kind"] == "pictures":
            kept = self.pictures[answer["drop"] :][: answer["keep"]]
            self.pictures = kept + answer["add"]
            self.latest |= answer


def solved(live: LiveContact) -> fastpin.Result:
    """The history of a contact, by fastpin.solve."""
    session = live.session
    return fastpin.solve(session.problem, session.history, grid=session.grid, keep="corners")


def floats(text: str) -> np.ndarray:
    """Return an array of a picture."""
    return np.frombuffer(base64.b64decode(text), dtype="<f4")


def recorded(page: str) -> dict[str, Any]:
    """Return what a recording holds."""
    (found,) = re.findall(r'<script type="application/json" id="recording">(.*?)</script>', page, re.DOTALL)
    content: dict[str, Any] = json.loads(found)
    return content


class Talk:
    """What a page says to its server and hears from it."""

    def __init__(self, say: Callable[[str], Awaitable[None]], hear: Callable[[], Awaitable[str]]) -> None:
        self.say, self._hear, self.number = say, hear, 0

    async def hear(self) -> dict[str, Any]:
        answer: dict[str, Any] = json.loads(await self._hear())
        return answer

    async def send(self, kind: str, **fields: Any) -> int:
        self.number += 1
        await self.say(json.dumps({"kind": kind, "id": self.number, **fields}))
        return self.number

    async def answer(self, number: int | None) -> dict[str, Any]:
        """Return the answer to a message; others are passed over."""
        while True:
            found = await self.hear()
            if found["id"] == number and found["kind"] != "welcome":
                return found

    async def tell(self, kind: str, **fields: Any) -> dict[str, Any]:
        return await self.answer(await self.send(kind, **fields))

    async def load(self, shear: float) -> dict[str, Any]:
        """Lead the load `Q`, in gesture 1."""
        return await self.tell("load", loads={"Q": shear}, gesture=1)

    async def hello(self, session: str = "") -> tuple[str, dict[str, Any]]:
        """Return the name of the session, and the pictures."""
        await self.send("hello", session=session)
        welcome = await self.hear()
        assert welcome["kind"] == "welcome", welcome
        return welcome["session"], await self.answer(welcome["id"])


class Wire(Talk):
    """A websocket without a network: a server reads it and sends to it, a page says something to it and hears it."""

    opened: ClassVar[list["Wire"]] = []
    """The wires of the running test."""

    def __init__(self, server: Server) -> None:
        Wire.opened.append(self)
        self._said: asyncio.Queue[WSMessage | None] = asyncio.Queue()
        self.heard: asyncio.Queue[str] = asyncio.Queue()
        self.code = 0
        super().__init__(self.say, self.heard.get)
        self._served = asyncio.create_task(server.serve_page(self))  # type: ignore[arg-type]

    async def __aiter__(self) -> AsyncIterator[WSMessage]:
        while (one := await self._said.get()) is not None:
            yield one
            self._said.task_done()

    async def send_str(self, text: str) -> None:
        self.heard.put_nowait(text)

    async def close(self, code: int) -> None:
        self.code = code

    async def say(self, text: str, kind: WSMsgType = WSMsgType.TEXT) -> None:
        self._said.put_nowait(WSMessage(kind, text, ""))

    async def read(self) -> None:
        """Wait until the server has read all that was said."""
        await self._said.join()

    async def go(self) -> None:
        """Go away, and wait until the server has noticed."""
        self._said.put_nowait(None)
        await self._served


def in_a_loop(test: Callable[..., Awaitable[None]]) -> Callable[..., None]:
    """Let a test be a coroutine, in one loop with its servers. At its end all its pages go away."""

    async def run(**given: Any) -> None:
        async with asyncio.timeout(LIMIT):
            await test(**given)
            while Wire.opened:
                await Wire.opened.pop(0).go()

    @functools.wraps(test)
    def whole(**given: Any) -> None:
        Wire.opened.clear()
        asyncio.run(run(**given))

    return whole


class HeldSteps:
    """Steps of all contacts, each of which waits until a test lets it go."""

    def __init__(self, patch: pytest.MonkeyPatch) -> None:
        self._begun, self._free = threading.Semaphore(0), threading.Semaphore(0)
        self.taken: list[LiveContact] = []
        step = LiveContact._step

        def held(contact: LiveContact, *arguments: Any) -> None:
            self.taken.append(contact)
            self._begun.release()
            assert self._free.acquire(timeout=LIMIT)
            step(contact, *arguments)

        patch.setattr(LiveContact, "_step", held)

    async def begun(self) -> LiveContact:
        """Wait until one more step has begun, and return its contact."""
        assert await asyncio.to_thread(self._begun.acquire, timeout=LIMIT)
        return self.taken[-1]

    def let_go(self, count: int = 1) -> None:
        self._free.release(count)


@contextlib.contextmanager
def served(make: Callable[[], LiveContact] = contact, port: int = 0) -> Iterator[Server]:
    """Run a server in a thread of its own."""
    server, ready, failed = Server(make), threading.Event(), []
    loop = asyncio.new_event_loop()
    end = asyncio.Event()

    async def run() -> None:
        async with server.running(port):
            ready.set()
            await end.wait()

    def work() -> None:
        try:
            loop.run_until_complete(run())
        except BaseException as error:
            failed.append(error)
        finally:
            ready.set()
            loop.close()

    thread = threading.Thread(target=work, daemon=True)
    thread.start()
    ready.wait()
    try:
        if failed:
            raise failed[0]
        yield server
    finally:
        if thread.is_alive():
            loop.call_soon_threadsafe(end.set)
        thread.join(LIMIT)
        assert not thread.is_alive(), "the server does not end"
