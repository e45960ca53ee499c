"""Kernels that run as Python at first: as Python they give the bits of compiled code."""

import copy
from typing import Any

import numpy as np
import pytest

import fastpin
from fastpin.runtime import jit

pytestmark = pytest.mark.skipif(jit.PLAIN, reason="nothing is compiled")

NAMES = {
    "end_places", "evaluate", "exponential", "fit", "least_squares", "match",
    "residuals", "series", "solve", "solve_few", "value_errors", "wanted_status",
}  # fmt: skip
"""The kernels of :func:`fastpin.runtime.jit.late`. No one may be missing in the calls below."""


def bits(value: Any) -> Any:
    """What two equal values have in common."""
    if isinstance(value, tuple):
        return [bits(part) for part in value]
    if isinstance(value, np.ndarray):
        return value.tobytes()
    return None if value is None else repr(complex(value))


@pytest.mark.gate
def test_they_give_the_same_bits_as_python(monkeypatch: pytest.MonkeyPatch) -> None:
    found: dict[str, list[bool]] = {}
    call = jit.Kernel.__call__

    def both(kernel: Any, *arguments: Any) -> Any:
        if kernel.inner or kernel.spent == np.inf:
            return call(kernel, *arguments)
        again = copy.deepcopy(arguments)
        answer = call(kernel, *arguments)
        with monkeypatch.context() as patch, np.errstate(all="ignore"):
            patch.setattr(jit.Kernel, "__call__", call)
            same = bits((kernel.py_func(*again), again)) == bits((answer, arguments))
        found.setdefault(kernel.__name__, []).append(same)
        return answer

    monkeypatch.setattr(jit.Kernel, "__call__", both)
    rng = np.random.default_rng(0)
    for _ in range(12):
        young, friction, parameter = rng.uniform(0.3, 3.0), rng.uniform(0.1, 0.9), rng.uniform(0.02, 1.0)
        bodies = fastpin.Material(100e9 * young, 0.3), fastpin.Material(100e9, rng.uniform(0.2, 0.4))
        problem = fastpin.Problem.from_load_parameter(fastpin.MaterialPair(*bodies), parameter, friction=friction)
        history = [{"P": 1.0}, *({"Q": way * rng.uniform(0.05, 0.2)} for way in (1, -1, 1))]
        states = fastpin.solve(problem, history, nodes=int(rng.integers(41, 82))).states
        assert all(state.peak_shear != 0.0 and state.peak_hoop_stress().value > 0.0 for state in states)
    assert {name: all(same) for name, same in found.items()} == dict.fromkeys(NAMES, True)


def test_they_are_compiled_when_they_have_taken_long(monkeypatch: pytest.MonkeyPatch) -> None:
    compiled: list[Any] = []

    def compile_kernel(source: Any, arguments: tuple[Any, ...]) -> tuple[Any, None]:
        compiled.append(source)
        return lambda x: x + 0.0, None

    monkeypatch.setattr("fastpin.runtime.machine.compile_kernel", compile_kernel)
    monkeypatch.setattr("fastpin.runtime.stored.StoredCode.load", lambda *_: None)
    monkeypatch.setattr(jit, "PATIENCE", 0.1)
    kernel: Any = jit.late(_doubled)
    assert kernel(1.0) == 2.0
    assert not compiled
    kernel.spent = 0.2
    assert [kernel(1.0), kernel(1.0)] == [2.0, 1.0]
    assert compiled == [kernel]


def test_where_python_raises_they_are_compiled(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("fastpin.runtime.machine.compile_kernel", lambda *_: (lambda x: np.inf, None))
    monkeypatch.setattr("fastpin.runtime.stored.StoredCode.load", lambda *_: None)
    monkeypatch.setattr(jit, "PATIENCE", 0.1)
    kernel: Any = jit.late(_inverse)
    assert [kernel(2.0), kernel(0.0), kernel(4.0)] == [0.5, np.inf, np.inf]


def _doubled(x: float) -> float:
    return x + x


def _inverse(x: float) -> float:
    return 1.0 / x
