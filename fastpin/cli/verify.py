"""``fastpin verify``: the table of all checks, and whether they have passed."""

from __future__ import annotations

import argparse
import dataclasses
import time

from fastpin import report, storage, verification
from fastpin.assess.outputs import json_ready
from fastpin.cli.progress import Bar, progress_to
from fastpin.cli.terminal import EXIT_FAILED, EXIT_OK, check_outputs, say, write_outputs
from fastpin.runtime.threads import cores
from fastpin.version import __version__


def run(options: argparse.Namespace) -> int:
    """Check the installation, and print or write the checks. The exit code is 1 if a check fails."""
    check_outputs({"--json": options.json})
    began = time.perf_counter()
    with Bar(0, "check {n} of {total}") as progress_bar:
        checks = verification.verify(progress_to(progress_bar))
    seconds = time.perf_counter() - began
    count = sum(check.passed for check in checks)
    code = EXIT_OK if count == len(checks) else EXIT_FAILED
    if options.json != "-":
        libraries = ", ".join(f"{name} {version}" for name, version in storage.versions().items())
        say(*report.checks.table(checks).split("\n"), "")
        say(f"{count} of {len(checks)} within tolerance, {seconds:.0f} s; {libraries}; {cores()} cores")
    document = {
        "fastpin": __version__,
        "versions": storage.versions(),
        "cores": cores(),
        "seconds": seconds,
        "passed": code == EXIT_OK,
        "checks": [{**dataclasses.asdict(check), "passed": check.passed} for check in checks],
    }
    return write_outputs([], options.json, lambda: json_ready(document)) or code
