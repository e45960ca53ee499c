"""Steps of a history, one way or another."""

import pytest

from fastpin.solver import arc, first_contact, held, path, path_stepper


def step_by_step(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let no step be followed by one call of the kernel: a PathStep follows each."""
    for module in (arc, first_contact, path_stepper):
        monkeypatch.setattr(module, "follow_whole", lambda *_: None)


def as_with_many_nodes(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let steps begin from factorised statuses, with columns on demand."""
    monkeypatch.setattr(held, "FEW_NODES", 0)
    monkeypatch.setattr(path, "FEW_NODES", 0)
