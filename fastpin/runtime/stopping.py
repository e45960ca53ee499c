"""The signals that ask a process to stop. What it keeps is written before it ends."""

from __future__ import annotations

import signal

STOPPING = [getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name)]
"""Ctrl-C; the end of a job of a batch system; the end of a terminal, which Windows does not tell by a signal."""
