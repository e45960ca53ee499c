"""Faults of files that are refused."""

from collections.abc import Callable
from typing import Any

import pytest

from fastpin.errors import CaseFileError


def faults_of(read: Callable[..., Any], *given: Any, **more: Any) -> list[tuple[int, str]]:
    """The lines and sentences of all faults that a function finds."""
    with pytest.raises(CaseFileError) as caught:
        read(*given, **more)
    return caught.value.problems


def fault_of(read: Callable[..., Any], *given: Any, **more: Any) -> tuple[int, str]:
    """The line and the sentence of the only fault that a function finds."""
    (fault,) = faults_of(read, *given, **more)
    return fault
