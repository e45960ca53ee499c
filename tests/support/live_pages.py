"""The live page for tests: messages, a server in a thread, and the pictures as a page would keep them."""

from __future__ import annotations

import asyncio
import base64
import contextlib
import json
import re
import threading
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from fastpin import casefile
from fastpin.live.contact import LiveContact
from fastpin.live.protocol import ALONE, Limits, Message, read_message
from fastpin.live.server import Server
from tests.support.case_texts import PRESSED

NODES = 61
"""Few nodes: the tests are of the page, not of the numbers."""

FREE = PRESSED
"""The text of a case with a free pin."""


def contact(text: str | None = None, nodes: int = NODES, limits: Limits = ALONE) -> LiveContact:
    """Return the contact of the built-in case, or of a case's text."""
    return LiveContact(casefile.builtin_case() if text is None else casefile.parse_case(text), nodes, limits)


def message(kind: str, number: int = 1, **fields: Any) -> Message:
    """Return a message, checked as those of a page are."""
    usual: dict[str, Any] = {
        "hello": {"session": ""},
        "load": {"gesture": 1, "drag": False},
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


def floats(text: str) -> np.ndarray:
    """Return an array of a picture."""
    return np.frombuffer(base64.b64decode(text), dtype="<f4")


def recorded(page: str) -> dict[str, Any]:
    """Return what a recording holds."""
    (found,) = re.findall(r'<script type="application/json" id="recording">(.*?)</script>', page, re.DOTALL)
    content: dict[str, Any] = json.loads(found)
    return content


@contextlib.contextmanager
def served(
    make: Callable[[], LiveContact] = contact, port: int = 0, host: str = "", limits: Limits = ALONE
) -> Iterator[Server]:
    """Run a server in a thread of its own."""
    server, ready, failed = Server(make, host, limits), threading.Event(), []
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

    thread = threading.Thread(target=work)
    thread.start()
    ready.wait()
    try:
        if failed:
            raise failed[0]
        yield server
    finally:
        if thread.is_alive():
            loop.call_soon_threadsafe(end.set)
        thread.join()
