"""The progress bar of all commands."""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import Any

from tqdm import tqdm


def bar(total: int, text: str) -> Any:
    """A progress bar on standard error after two seconds; nothing when that is not a terminal."""
    return tqdm(
        total=total,
        delay=2,
        disable=None,
        leave=False,
        file=sys.stderr,
        bar_format=f"{{percentage:3.0f}}% |{{bar}}| {text}, {{remaining}} left",
    )


def progress_to(progress_bar: Any) -> Callable[[float, float], None]:
    """A callable ``progress(done, total)`` that moves a bar."""

    def progress(done: float, total: float) -> None:
        progress_bar.total = total
        progress_bar.update(done - progress_bar.n)

    return progress
