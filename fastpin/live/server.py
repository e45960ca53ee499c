"""The server of the live page, on this machine only.

The page and its websocket stand under a random token. Host and Origin are checked, so no other page of the browser can
reach the server. docs/live.md lists the limits; their numbers stand in :mod:`fastpin.live.protocol`.

Contacts are computed in one thread, one message after the other. The loop of the server stays free meanwhile: it hears
when a page stops its work.
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
from collections.abc import AsyncIterator, Awaitable, Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Any

from aiohttp import WSCloseCode, WSMsgType, web

from fastpin.errors import FastpinError, InputError
from fastpin.live.contact import LiveContact
from fastpin.live.page import live_page, page_files, recorded_page
from fastpin.live.protocol import MOST_BYTES, MOST_SESSIONS, MOST_WAITING, Message, read_message, refusal
from fastpin.version import __version__

ADDRESS = "127.0.0.1"
"""The address on which the server listens: that of this machine, for this machine."""

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


class Server:
    """The server of the page.

    Parameters
    ----------
    make : callable
        ``make()`` returns the contact of a new page.

    Attributes
    ----------
    token : str
        The part of the address that nobody else knows.
    address : str
        The address of the page; "" before :meth:`take_port`.
    contacts : dict of LiveContact
        The contacts of the latest pages by the names of their sessions. A page that comes back finds its contact again.
    """

    def __init__(self, make: Callable[[], LiveContact]) -> None:
        self.token = secrets.token_urlsafe(TOKEN_BYTES)
        self.address = ""
        self._hosts: tuple[str, ...] = ()
        self._make = make
        self.contacts: dict[str, LiveContact] = {}
        self._open: dict[web.WebSocketResponse, str] = {}  # the names of the sessions of open pages
        self._files = page_files()
        self._page, self._map = live_page()
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
            for contact in self.contacts.values():
                contact.stop()
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
        if name not in self.contacts or file not in ("case.toml", "recording.html"):
            return None
        contact = self.contacts[name]
        work = contact.case_text if file == "case.toml" else lambda: recorded_page(contact.recording())
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
        """Serve a page until it has gone. What it has asked for last ends then."""
        messages: asyncio.Queue[Message] = asyncio.Queue(MOST_WAITING)
        working = asyncio.create_task(self._work(page, messages))
        try:
            async for received in page:
                if received.type == WSMsgType.TEXT:
                    await self._receive(page, messages, received.data)
                else:
                    await _send(page, refusal(None, InputError("message", "must be text")))
        finally:
            self._stop(page)
            working.cancel()
            with contextlib.suppress(asyncio.CancelledError, ConnectionError):
                await working

    async def _receive(self, page: web.WebSocketResponse, messages: asyncio.Queue[Message], text: str) -> None:
        try:
            message = read_message(text)
        except InputError as error:
            await _send(page, refusal(None, error))
            return
        if message.kind == "stop":
            self._stop(page)
        elif messages.full():
            sentence = f"more than {MOST_WAITING} messages wait; this one is dropped"
            await _send(page, refusal(message.id, InputError("message", sentence)))
        else:
            messages.put_nowait(message)

    def _stop(self, page: web.WebSocketResponse) -> None:
        """End a long history of a page."""
        if page in self._open:
            self.contacts[self._open[page]].stop()

    async def _work(self, page: web.WebSocketResponse, messages: asyncio.Queue[Message]) -> None:
        """Obey the messages of a page, one after the other."""
        try:
            while True:
                message = await messages.get()
                try:
                    if page not in self._open:
                        await self._greet(page, message)
                    contact = self.contacts[self._open[page]]
                    text = await self._compute(functools.partial(_answers, contact, message))
                except (ConnectionError, RuntimeError):
                    raise
                except Exception as error:
                    text = [_failure(message, error)]
                for one in text:
                    await page.send_str(one)
        except (ConnectionError, RuntimeError):  # the page has gone
            log.debug("a page has gone")
        finally:
            self._open.pop(page, None)

    async def _greet(self, page: web.WebSocketResponse, message: Message) -> None:
        """Find the contact of a page, or make one."""
        if message.kind != "hello":
            raise InputError("kind", "the first message must be hello")
        name = message.fields["session"]
        if name not in self.contacts or name in self._open.values():
            contact, name = await self._compute(self._make), secrets.token_urlsafe(TOKEN_BYTES)
            if len(self.contacts) >= MOST_SESSIONS:
                idle = next((each for each in self.contacts if each not in self._open.values()), None)
                if idle is None:
                    sentence = f"{MOST_SESSIONS} pages are open, no more are served; close one, and reload"
                    raise InputError("session", sentence)
                del self.contacts[idle]
            self.contacts[name] = contact
        self.contacts[name] = self.contacts.pop(name)  # the latest one is the last to be dropped
        self._open[page] = name
        await _send(page, {"kind": "welcome", "id": message.id, "session": name, "version": __version__})


def _answers(contact: LiveContact, message: Message) -> list[str]:
    """Carry out a message, and return the answers as text. Whatever goes wrong is an answer too: the page lives on."""
    try:
        return [json.dumps(answer, allow_nan=False, separators=(",", ":")) for answer in contact.obey(message)]
    except Exception as error:
        return [_failure(message, error)]


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
        found.listen()
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
