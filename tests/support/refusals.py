"""Input that is refused."""

import pickle
from collections.abc import Callable
from typing import Any

import pytest

from fastpin.errors import InputError


def refused(call: Callable[..., object], *arguments: Any, **options: Any) -> InputError:
    """The error with which a call refuses its input: one line, which a copy from another process says too."""
    with pytest.raises(InputError) as caught:
        call(*arguments, **options)
    assert "\n" not in str(caught.value)
    assert str(pickle.loads(pickle.dumps(caught.value))) == str(caught.value)
    return caught.value
