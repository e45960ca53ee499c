"""``fastpin live``: the page in the browser, until Ctrl-C."""

from __future__ import annotations

import argparse
import sys
import webbrowser

from fastpin import casefile, live
from fastpin.cli.options import literal
from fastpin.cli.terminal import EXIT_FAILED, EXIT_OK, as_options, fail, say
from fastpin.live.contact import NODES, NODES_OF_CLASS, LiveContact
from fastpin.live.protocol import ALONE, CLASS
from fastpin.model.checks import whole_number
from fastpin.model.doubts import doubts_given
from fastpin.model.grid import LEAST_NODES

SHARED = """\
whoever reaches {host} over the network and has this whole address can open the page: up to {most} visitors
nothing is encrypted: use a network that you trust, and give the address to your class only
"Share" on the page shows the address as a QR code"""


def run(options: argparse.Namespace) -> int:
    """Serve the page of a case, and open it in the browser."""
    case = casefile.builtin_case() if options.case is None else casefile.read_case(options.case)
    usual, limits = (NODES, ALONE) if options.host is None else (NODES_OF_CLASS, CLASS)
    given = usual if options.nodes is None else literal(options.nodes)
    nodes = whole_number("--nodes", given, LEAST_NODES, limits.nodes)
    port = whole_number("--port", literal(options.port), 0, 65_535)
    try:
        with as_options(("host", "port")):
            serve, host = live.serve, "" if options.host is None else live.address_of_machine(options.host)
    except ImportError as error:
        if error.name not in ("aiohttp", "segno"):  # the extra "live" installs them
            raise
        return fail(f"the live page needs the package {error.name}: pip install 'fastpin[live]'", EXIT_FAILED)

    def ready(address: str) -> None:
        say(f"live page: {address}")
        if host:
            say(*SHARED.format(host=host, most=limits.sessions).splitlines())
        say("Ctrl-C ends it")
        sys.stdout.flush()
        if options.browser and not webbrowser.open(address):
            say("note: no browser was found; open the address above in one", file=sys.stderr)

    with doubts_given(), as_options(("host", "port")):  # the page shows doubts, for each problem that is tried
        serve(lambda: LiveContact(case, nodes, limits), port, ready, host, limits)
    return EXIT_OK
