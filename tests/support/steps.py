"""Steps of a history, one way or another."""

import pytest

from fastpin.solver import held, path, whole_step


def step_by_step(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let no step be followed by one call of the kernel: a PathStep follows each."""
    monkeypatch.setattr(whole_step, "follow", lambda *_: None)


def as_with_many_nodes(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let steps begin from factorised statuses, with columns on demand."""
    monkeypatch.setattr(held, "FEW_NODES", 0)
    monkeypatch.setattr(path, "FEW_NODES", 0)
