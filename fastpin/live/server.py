"""The server of the live page, on this machine only.

The page and its websocket stand under a random token. Host and Origin are checked, so no other page of the browser can
reach the server. docs/live.md lists the limits; their numbers stand in :mod:`fastpin.live.protocol`.

Contacts are computed in one thread, one after the other. The loop of the server stays free meanwhile. Each contact has
one piece of work in the queue of this thread at most, and a piece ends after :data:`TURN`. So pages take turns.
"""

from __future__ import annotations

import asyncio
import contextlib
import functools
import hmac
import json
import logging
import secrets
import socket
import time
from collections import deque
from collections.abc import AsyncIterator, Awaitable, Callable, Generator, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Any

from aiohttp import WSCloseCode, WSMsgType, web

from fastpin.errors import FastpinError, InputError
from fastpin.live import protocol
from fastpin.live.contact import LiveContact
from fastpin.live.page import live_page, page_files, recorded_page
from fastpin.live.protocol import MOST_A_SECOND, MOST_BYTES, MOST_WAITING, Message, read_message, refusal
from fastpin.version import __version__

ADDRESS = "127.0.0.1"
"""The address on which the server listens: that of this machine, for this machine."""

TURN = 0.05
"""Seconds after which a long history lets the work of other pages pass."""

TOKEN_BYTES = 16
"""Random bytes of the token: 128 bits can't be guessed."""

LAST_WAIT = 1.0
"""Seconds that pages have to answer when the server ends."""

POLICY = (
    "default-src 'none'; script-src 'self' {map}; style-src 'self'; img-src 'self' data: blob:; "
    "connect-src 'self' ws://{host}; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)
"""The Content-Security-Policy of the page: its own files only, and no script in the HTML but the import map."""

HEADERS = {
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cache-Control": "no-store",
}
"""Headers of all answers."""

log = logging.getLogger("fastpin.live")

requests_log = logging.getLogger("fastpin.live.requests")
"""Where aiohttp writes about requests that it can't read. It goes nowhere: anyone can send such a request without the
token, and the request may hold the token. Errors of our own handlers go to :data:`log`."""
requests_log.disabled = True

Handler = Callable[[web.Request], Awaitable[web.StreamResponse]]


class Mailbox:
    """The messages of one connection that wait. Of several loads of a drag the latest one stays.

    Attributes
    ----------
    session : str
        The name of the contact that obeys them; "" before the first message.
    """

    def __init__(self) -> None:
        self.session = ""
        self._waiting: deque[Message] = deque()
        self._arrived = asyncio.Event()

    def put(self, message: Message) -> Message | None:
        """Add a message. Return the one whose place it takes, if any.

        Raises
        ------
        InputError
            If too many messages wait.
        """
        last = self._waiting[-1] if self._waiting else None
        if last is not None and message.is_drag and last.is_drag and _gesture(last) == _gesture(message):
            self._waiting[-1] = message
            return last
        if len(self._waiting) >= MOST_WAITING:
            raise InputError("message", f"more than {MOST_WAITING} messages wait; this one is dropped")
        self._waiting.append(message)
        self._arrived.set()
        return None

    async def get(self) -> Message:
        """The next message."""
        while not self._waiting:
            self._arrived.clear()
            await self._arrived.wait()
        return self._waiting.popleft()


def _gesture(message: Message) -> int:
    return int(message.fields["gesture"])


class RateLimit:
    """Whether a message may come now: at most so many in a second, counted in a moving window."""

    def __init__(self, most: int, clock: Callable[[], float] = time.monotonic) -> None:
        self._times: deque[float] = deque(maxlen=most)
        self._clock = clock

    def allows(self) -> bool:
        """Count a message, if it may come."""
        now = self._clock()
        if len(self._times) == self._times.maxlen and now - self._times[0] < 1.0:
            return False
        self._times.append(now)
        return True


class Sessions:
    """The contacts of all pages by name. A page that comes back finds its contact again.

    There are :data:`fastpin.live.protocol.MOST_SESSIONS` of them.
    """

    def __init__(self) -> None:
        self._contacts: dict[str, LiveContact] = {}
        self._turns: dict[str, asyncio.Lock] = {}
        self._open: set[str] = set()

    def find(self, name: str) -> str | None:
        """Take the contact of this name, if it is there and no other page has it."""
        if name not in self._contacts or name in self._open:
            return None
        self._contacts[name] = self._contacts.pop(name)  # the latest one is the last to be dropped
        self._open.add(name)
        return name

    def make_room(self) -> None:
        """Drop the oldest contact without a page, if there are as many contacts as may be.

        Raises
        ------
        InputError
            If all contacts have pages.
        """
        if len(self._contacts) >= protocol.MOST_SESSIONS:
            idle = next((name for name in self._contacts if name not in self._open), None)
            if idle is None:
                words = f"{protocol.MOST_SESSIONS} pages are open, no more are served; close one, and reload"
                raise InputError("session", words)
            del self._contacts[idle], self._turns[idle]

    def add(self, contact: LiveContact) -> str:
        """Add the contact of a new page, and return its name."""
        name = secrets.token_urlsafe(TOKEN_BYTES)
        self._contacts[name], self._turns[name] = contact, asyncio.Lock()
        self._open.add(name)
        return name

    def turn(self, name: str) -> asyncio.Lock:
        """The lock of a contact: who holds it may ask the contact for something."""
        return self._turns[name]

    def release(self, name: str) -> None:
        """Note that a page has gone. Its contact stays."""
        self._open.discard(name)

    def __getitem__(self, name: str) -> LiveContact:
        return self._contacts[name]

    def __contains__(self, name: str) -> bool:
        return name in self._contacts

    def stop(self) -> None:
        """End all long histories."""
        for contact in self._contacts.values():
            contact.stop()


class Server:
    """The server of the page.

    Parameters
    ----------
    make : callable
        ``make()`` returns the contact of a new page.
    clock : callable
        ``clock()`` returns seconds. Rates of messages and turns of pages are measured with it.

    Attributes
    ----------
    token : str
        The part of the address that nobody else knows.
    address : str
        The address of the page; "" before :meth:`take_port`.
    """

    def __init__(self, make: Callable[[], LiveContact], clock: Callable[[], float] = time.monotonic) -> None:
        self.token = secrets.token_urlsafe(TOKEN_BYTES)
        self.address = ""
        self._hosts: tuple[str, ...] = ()
        self._make, self._sessions, self._clock = make, Sessions(), clock
        self._greeting = asyncio.Lock()
        self._files = page_files()
        self._page, self._map = live_page()
        self._connections = 0
        self._sockets: dict[web.WebSocketResponse, web.Request] = {}
        self._thread = ThreadPoolExecutor(1, "fastpin")

    @contextlib.asynccontextmanager
    async def running(self, port: int = 0) -> AsyncIterator[Server]:
        """Listen on a port; 0 means any free one.

        Raises
        ------
        InputError
            If the port can't be used.
        """
        application = web.Application(client_max_size=MOST_BYTES, middlewares=[self._guard])
        application.router.add_get("/{token}/", self._send_page)
        application.router.add_get("/{token}/socket", self._talk)
        application.router.add_get("/{token}/save/{session}/{file}", self._save)
        application.router.add_get("/{token}/{file:.*}", self._send_file)
        runner = web.AppRunner(application, access_log=None, logger=requests_log, shutdown_timeout=LAST_WAIT)
        listening = bound_socket(port)
        try:
            await runner.setup()
            self.take_port(listening.getsockname()[1])
            await web.SockSite(runner, listening).start()
            yield self
        finally:
            self._sessions.stop()
            await self._end_pages()
            await runner.cleanup()
            listening.close()
            self._thread.shutdown(wait=True, cancel_futures=True)

    def take_port(self, port: int) -> None:
        """Take the address with this port as that of the page."""
        # Browsers leave port 80 out of the Host.
        self._hosts = tuple(name if port == 80 else f"{name}:{port}" for name in (ADDRESS, "localhost"))
        self.address = f"http://{self._hosts[0]}/{self.token}/"

    # -- requests --------------------------------------------------------------------------------------------------

    def objection(self, host: str | None, origins: Sequence[str], token: str) -> str:
        """Say why a request with this Host, these Origins and this token is refused; "" if it may come."""
        if host not in self._hosts:
            return "This server answers to its own address only."
        if not set(origins) <= {f"http://{own}" for own in self._hosts}:
            return "Another page may not use this server."
        if not hmac.compare_digest(token.encode(), self.token.encode()):
            return "The address lacks the token: take the address that fastpin live has printed."
        return ""

    @web.middleware
    async def _guard(self, request: web.Request, handler: Handler) -> web.StreamResponse:
        """Refuse requests for another host, from another page, or without the token."""
        origins, token = request.headers.getall("Origin", []), request.match_info.get("token", "")
        if sentence := self.objection(request.headers.get("Host"), origins, token):
            response: web.StreamResponse = _refused(403, sentence)
        else:
            try:
                response = await handler(request)
            except web.HTTPException as error:
                response = _refused(error.status, error.reason)
            except ConnectionError:  # the page has gone
                raise
            except Exception as error:
                log.error("a request failed", exc_info=error)
                raise
        if not response.prepared:
            response.headers.update(HEADERS)
        return response

    async def _send_page(self, request: web.Request) -> web.Response:
        policy = POLICY.format(map=self._map, host=request.headers["Host"])
        headers = {"Content-Security-Policy": policy}
        return web.Response(text=self._page, content_type="text/html", headers=headers)

    async def _send_file(self, request: web.Request) -> web.Response:
        found = self._files.get(request.match_info["file"])
        if found is None:
            return _refused(404, "There is no such file.")
        return web.Response(body=found[0], content_type=found[1], charset="utf-8")

    async def _save(self, request: web.Request) -> web.Response:
        """Send the history of a page as a case file, or as a recording."""
        file = request.match_info["file"]
        try:
            text = await self.saved(request.match_info["session"], file)
        except InputError as error:
            return _refused(409, str(error))
        if text is None:
            return _refused(404, "There is no such history.")
        headers = {"Content-Disposition": f'attachment; filename="{file}"'}
        return web.Response(text=text, content_type="application/octet-stream", headers=headers)

    async def saved(self, name: str, file: str) -> str | None:
        """Return the text of a file with the history of a page; None if there is no such page or file.

        Raises
        ------
        InputError
            If the history can't be saved.
        """
        if name not in self._sessions or file not in ("case.toml", "recording.html"):
            return None
        contact = self._sessions[name]
        work = contact.case_text if file == "case.toml" else lambda: recorded_page(contact.recording())
        async with self._sessions.turn(name):
            return str(await self._compute(work))

    async def _compute(self, work: Callable[[], Any]) -> Any:
        return await asyncio.get_running_loop().run_in_executor(self._thread, work)

    # -- websockets ------------------------------------------------------------------------------------------------

    async def _talk(self, request: web.Request) -> web.StreamResponse:
        if request.headers.get("Origin") is None:
            return _refused(403, "Only the page may use this server.")
        # A page that has gone without a word is noticed after 20 s.
        page = web.WebSocketResponse(max_msg_size=MOST_BYTES, heartbeat=20.0, compress=False)
        await page.prepare(request)
        self._sockets[page] = request
        try:
            await self.serve_page(page)
        finally:
            del self._sockets[page]
        return page

    async def _end_pages(self) -> None:
        """Tell all pages that the server ends. A page that reads nothing is cut off."""
        transports = [request.transport for request in self._sockets.values()]
        with contextlib.suppress(TimeoutError):
            async with asyncio.timeout(LAST_WAIT):
                await asyncio.gather(*map(_end, self._sockets), return_exceptions=True)
        for transport in transports:
            if transport is not None:
                transport.abort()

    async def serve_page(self, page: web.WebSocketResponse) -> None:
        """Serve a page until it has gone. If too many are open, tell it so, and close it."""
        if self._connections >= protocol.MOST_CONNECTIONS:
            # A page can read messages, but not why a websocket was refused.
            sentence = f"{protocol.MOST_CONNECTIONS} pages are open, no more are served; close one, and reload"
            await _send(page, refusal(None, InputError("connection", sentence)))
            await page.close(code=WSCloseCode.TRY_AGAIN_LATER)
            return
        self._connections += 1
        mailbox, limit = Mailbox(), RateLimit(MOST_A_SECOND, self._clock)
        working = asyncio.create_task(self._work(page, mailbox))
        try:
            async for received in page:
                if not limit.allows():
                    continue  # Messages of any kind that come faster get no answer: answers would be a flood too.
                if received.type == WSMsgType.TEXT:
                    await self._receive(page, mailbox, received.data)
                else:
                    await _send(page, refusal(None, InputError("message", "must be text")))
        finally:
            self._connections -= 1
            working.cancel()
            with contextlib.suppress(asyncio.CancelledError, ConnectionError):
                await working

    async def _receive(self, page: web.WebSocketResponse, mailbox: Mailbox, text: str) -> None:
        message = None
        try:
            message = read_message(text)
            if message.kind == "stop":
                if mailbox.session:
                    self._sessions[mailbox.session].stop()
                return
            skipped = mailbox.put(message)
            if skipped is not None:
                await _send(page, {"kind": "skipped", "id": skipped.id})
        except InputError as error:
            await _send(page, refusal(None if message is None else message.id, error))

    async def _work(self, page: web.WebSocketResponse, mailbox: Mailbox) -> None:
        """Obey the messages of a page, one after the other."""
        try:
            while True:
                message = await mailbox.get()
                try:
                    if not mailbox.session:
                        await self._greet(page, mailbox, message)
                    async with self._sessions.turn(mailbox.session):
                        text = await self._obey(self._sessions[mailbox.session], message)
                except (ConnectionError, RuntimeError):
                    raise
                except Exception as error:
                    text = [_failure(message, error)]
                for one in text:
                    await page.send_str(one)
        except (ConnectionError, RuntimeError):  # the page has gone
            log.debug("a page has gone")
        finally:
            self._sessions.release(mailbox.session)

    async def _obey(self, contact: LiveContact, message: Message) -> list[str]:
        """Carry out a message in turn with the work of other pages, and return the answers as text."""
        work = contact.steps(message)
        try:
            while True:
                text = await self._compute(functools.partial(_answers, work, message, self._clock))
                if text is not None:
                    return list(text)
        finally:  # a page that has gone leaves its work: the contact goes back to where it was
            with contextlib.suppress(RuntimeError):  # the server ends
                self._thread.submit(work.close)

    async def _greet(self, page: web.WebSocketResponse, mailbox: Mailbox, message: Message) -> None:
        """Find the contact of a page, or make one."""
        if message.kind != "hello":
            raise InputError("kind", "the first message must be hello")
        async with self._greeting:  # one after the other, so that there are never too many contacts
            name = self._sessions.find(message.fields["session"])
            if name is None:
                self._sessions.make_room()
                name = self._sessions.add(await self._compute(self._make))
            mailbox.session = name
        await _send(page, {"kind": "welcome", "id": message.id, "session": name, "version": __version__})


def _answers(
    work: Generator[None, None, list[dict[str, Any]]], message: Message, clock: Callable[[], float]
) -> list[str] | None:
    """Go on with a message for a while. Return its answers as text at its end, and None before.

    Whatever goes wrong is an answer too, and the page lives on.
    """
    end = clock() + TURN
    try:
        while clock() < end:
            next(work)
    except StopIteration as done:
        return [json.dumps(answer, allow_nan=False, separators=(",", ":")) for answer in done.value]
    except Exception as error:
        return [_failure(message, error)]
    return None


def _failure(message: Message, error: Exception) -> str:
    """The answer to a message that failed."""
    if isinstance(error, InputError):
        return json.dumps(refusal(message.id, error))
    words = str(error)
    if not isinstance(error, FastpinError):
        log.error("a message failed", exc_info=error)
        words = f"the message failed unexpectedly ({type(error).__name__}); the contact is where it was"
    return json.dumps(refusal(message.id, InputError("contact", words)))


async def _end(page: web.WebSocketResponse) -> None:
    await page.close(code=WSCloseCode.GOING_AWAY, message=b"the server ends")


async def _send(page: web.WebSocketResponse, answer: dict[str, Any]) -> None:
    with contextlib.suppress(ConnectionError, RuntimeError):  # the page has gone
        await page.send_str(json.dumps(answer, allow_nan=False))


def _refused(status: int, sentence: str) -> web.Response:
    return web.Response(status=status, text=f"{sentence}\n", headers=HEADERS)


def bound_socket(port: int) -> socket.socket:
    """A socket on a port of this machine; 0 means any free one.

    Raises
    ------
    InputError
        If the port can't be used.
    """
    found = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
    found.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        found.bind((ADDRESS, port))
        found.listen(protocol.MOST_CONNECTIONS)
    except OSError as error:
        found.close()
        reason = (error.strerror or str(error)).lower()
        raise InputError("port", f"{port} can't be used: {reason}; choose another one, or leave it out") from None
    return found


def serve(make: Callable[[], LiveContact], port: int, ready: Callable[[str], None]) -> None:
    """Serve the page until Ctrl-C.

    Parameters
    ----------
    make : callable
        ``make()`` returns the contact of a new page.
    port : int
        0 means any free port.
    ready : callable
        ``ready(address)`` is called once the page can be opened.

    Raises
    ------
    InputError
        If the port can't be used.
    """

    async def run() -> None:
        async with Server(make).running(port) as server:
            ready(server.address)
            await asyncio.Event().wait()

    with contextlib.suppress(KeyboardInterrupt, asyncio.CancelledError):
        asyncio.run(run())
