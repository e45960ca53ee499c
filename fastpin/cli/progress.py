"""The progress bar of all commands."""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import Any


def bar(total: int, text: str) -> Any:
    """Return a progress bar of `total` units. It appears on standard error after two seconds, on terminals only.

    `text` is a format with the fields of tqdm, such as ``{n} of {total}``.
    """
    from tqdm import tqdm

    return tqdm(
        total=total,
        delay=2,
        disable=None,
        leave=False,
        file=sys.stderr,
        bar_format=f"{{percentage:3.0f}}% |{{bar}}| {text}, {{remaining}} left",
    )


def progress_to(progress_bar: Any) -> Callable[[float, float], None]:
    """Return a callable ``progress(done, total)`` that moves a bar."""

    def progress(done: float, total: float) -> None:
        progress_bar.total = total
        progress_bar.update(done - progress_bar.n)

    return progress
