"""What all commands share: exit codes, messages, the progress bar, names of figures."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

from fastpin.errors import InputError

EXIT_OK, EXIT_FAILED, EXIT_INPUT, EXIT_INTERRUPTED, EXIT_PIPE = 0, 1, 2, 130, 141
FIGURE_FORMATS = (".png", ".pdf", ".svg")


def fail(message: str, code: int) -> int:
    """Say what went wrong, and return the exit code."""
    print(f"fastpin: {message}", file=sys.stderr)
    return code


def bar(total: int, text: str) -> Any:
    """A progress bar on standard error after two seconds; nothing when that is not a terminal."""
    from tqdm import tqdm

    return tqdm(
        total=total,
        delay=2,
        disable=None,
        leave=False,
        file=sys.stderr,
        bar_format=f"{{percentage:3.0f}}% |{{bar}}| {text}, {{remaining}} left",
    )


def check_figure(option: str, path: Path) -> None:
    """Raise :class:`InputError` naming the option if a file's name is not that of a figure."""
    if path.suffix.lower() not in FIGURE_FORMATS:
        raise InputError(option, f"the figure's name must end in {', '.join(FIGURE_FORMATS)}, not {path.name!r}")
