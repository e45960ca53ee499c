"""``fastpin live``: the page in the browser, until Ctrl-C."""

from __future__ import annotations

import argparse
import sys
import webbrowser

from fastpin import casefile, live
from fastpin.cli.options import literal
from fastpin.cli.terminal import EXIT_FAILED, EXIT_OK, as_options, fail, say
from fastpin.live.contact import LiveContact
from fastpin.live.protocol import MOST_NODES
from fastpin.model.checks import whole_number
from fastpin.model.doubts import doubts_given
from fastpin.model.grid import LEAST_NODES


def run(options: argparse.Namespace) -> int:
    """Serve the page of a case, and open it in the browser."""
    case = casefile.builtin_case() if options.case is None else casefile.read_case(options.case)
    nodes = whole_number("--nodes", literal(options.nodes), LEAST_NODES, MOST_NODES)
    port = whole_number("--port", literal(options.port), 0, 65_535)
    try:
        serve = live.serve
    except ImportError as error:
        if error.name != "aiohttp":  # the extra "live" installs it
            raise
        return fail(f"the live page needs the package {error.name}: pip install 'fastpin[live]'", EXIT_FAILED)

    def ready(address: str) -> None:
        say(f"live page: {address}", "Ctrl-C ends it")
        sys.stdout.flush()
        if options.browser and not webbrowser.open(address):
            say("note: no browser was found; open the address above in one", file=sys.stderr)

    with doubts_given(), as_options(("port",)):  # the page shows doubts, for each problem that is tried
        serve(lambda: LiveContact(case, nodes), port, ready)
    return EXIT_OK
