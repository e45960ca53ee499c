"""``fastpin live``: the page in the browser, until Ctrl-C."""

from __future__ import annotations

import argparse
import sys
import webbrowser
from collections.abc import Callable

from fastpin import casefile, live
from fastpin.cli.options import literal
from fastpin.cli.terminal import EXIT_FAILED, EXIT_OK, fail, say
from fastpin.errors import InputError
from fastpin.live.contact import NODES, LiveContact
from fastpin.live.protocol import MOST_LIVE_NODES
from fastpin.model.checks import whole_number
from fastpin.model.doubts import doubts_given
from fastpin.model.grid import LEAST_NODES

MOST_PORT = 65_535
"""Largest port."""


def run(options: argparse.Namespace) -> int:
    """Serve the page of a case, and open it in the browser."""
    case = casefile.builtin_case() if options.case is None else casefile.read_case(options.case)
    given = NODES if options.nodes is None else literal(options.nodes)
    nodes = whole_number("--nodes", given, LEAST_NODES, MOST_LIVE_NODES)
    port = whole_number("--port", literal(options.port), 0, MOST_PORT)
    serve = server()
    if serve is None:
        return fail("the live page needs the package aiohttp: pip install 'fastpin[live]'", EXIT_FAILED)

    def ready(address: str) -> None:
        say(f"live page: {address}", "Ctrl-C ends it")
        sys.stdout.flush()
        if options.browser and not webbrowser.open(address):
            say("note: no browser was found; open the address above in one", file=sys.stderr)

    try:
        with doubts_given():  # the page shows them, for each problem that is tried
            serve(lambda: LiveContact(case, nodes), port, ready)
    except InputError as error:
        raise InputError(f"--{error.field}" if error.field == "port" else error.field, error.reason) from None
    return EXIT_OK


def server() -> Callable[[Callable[[], LiveContact], int, Callable[[str], None]], None] | None:
    """The function that serves the page; None if its package is not installed."""
    try:
        return live.serve
    except ImportError as error:
        if error.name == "aiohttp":
            return None
        raise
