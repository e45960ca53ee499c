"""``fastpin schema``: the JSON schema of a document that commands write."""

from __future__ import annotations

import argparse
import json
import sys

from fastpin.cli.terminal import EXIT_OK
from fastpin.report.schema import json_schema


def run(options: argparse.Namespace) -> int:
    """Print the schema."""
    sys.stdout.write(json.dumps(json_schema(options.written_by), indent=2) + "\n")
    return EXIT_OK
