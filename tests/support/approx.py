"""Arrays compared as a whole: ``pytest.approx`` compares them entry by entry in Python, some 10 us each."""

from typing import Any

import numpy as np
import pytest

_Array = type(pytest.approx(np.zeros(1)))
"""The class of what ``pytest.approx`` returns for an array."""

_entry_by_entry = _Array.__eq__


def is_close(actual: Any, approx: Any) -> bool:
    """Whether all entries of finite arrays of floating-point or complex numbers are within the tolerances of `approx`.

    False leaves the answer to pytest.
    """
    if not (hasattr(actual, "__array__") or isinstance(actual, list)) or np.isscalar(actual):
        return False
    arrays = np.asarray(actual), np.asarray(approx.expected)
    if arrays[0].shape != arrays[1].shape or any(array.dtype.kind not in "fc" for array in arrays):
        return False
    found, expected = (array.astype(complex if array.dtype.kind == "c" else float, copy=False) for array in arrays)
    if not (np.all(np.isfinite(found)) and np.all(np.isfinite(expected))):
        return False
    if any(value is not None and not value >= 0.0 for value in (approx.rel, approx.abs)):
        return False
    tolerance = 1e-12 if approx.abs is None else approx.abs
    if approx.rel is not None or approx.abs is None:
        tolerance = np.maximum((1e-6 if approx.rel is None else approx.rel) * np.abs(expected), tolerance)
    return bool(np.all(np.abs(expected - found) <= tolerance))


def quicken() -> None:
    """Let ``==`` with ``pytest.approx`` of an array accept close arrays at once; pytest judges and words the rest."""

    def equal(self: Any, actual: Any) -> bool:
        return is_close(actual, self) or bool(_entry_by_entry(self, actual))

    _Array.__eq__ = equal  # type: ignore[method-assign]
