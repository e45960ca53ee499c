"""``fastpin live``: the page in the browser, until Ctrl-C."""

from __future__ import annotations

import argparse
import sys
import webbrowser
from collections.abc import Callable

from fastpin import casefile, joints, live
from fastpin.casefile.toml_text import read_text
from fastpin.cli.options import literal
from fastpin.cli.terminal import EXIT_FAILED, EXIT_OK, as_options, fail, say
from fastpin.joints.solving import LEAST_NODES as LEAST_IN_JOINT
from fastpin.live.contact import LiveContact
from fastpin.live.joint import LiveJoint, most_nodes
from fastpin.live.pin import NODES, LivePin
from fastpin.live.protocol import MOST_NODES
from fastpin.model.checks import whole_number
from fastpin.model.doubts import doubts_given
from fastpin.model.grid import LEAST_NODES


def _maker(options: argparse.Namespace) -> Callable[[], LiveContact]:
    """Return a function that makes the contact of a new page. A joint file gives a joint, a case file one pin."""
    nodes = None if options.nodes is None else literal(options.nodes)
    if options.case is not None and joints.is_joint_file(text := read_text(options.case)):
        file = joints.read_joint(options.case)
        nodes = None if nodes is None else whole_number("--nodes", nodes, LEAST_IN_JOINT, most_nodes(file.joint))
        return lambda: LiveJoint(file, text, nodes)
    case = casefile.builtin_case() if options.case is None else casefile.read_case(options.case)
    of_pin = NODES if nodes is None else whole_number("--nodes", nodes, LEAST_NODES, MOST_NODES)
    return lambda: LivePin(case, of_pin)


def run(options: argparse.Namespace) -> int:
    """Serve the page of a case, and open it in the browser."""
    make = _maker(options)
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
        serve(make, port, ready)
    return EXIT_OK
