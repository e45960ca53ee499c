"""Odd values for the arguments of calls: values that no argument, or few, can use.

Each is made afresh for each call, because a call may change it or use it up.
"""

from __future__ import annotations

import datetime
import decimal
import fractions
import math
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np


class Hostile:
    """An object whose methods raise."""

    def _refuse(self, *_: Any) -> Any:
        raise RuntimeError("a method of the value failed")

    __len__ = __iter__ = __getitem__ = __float__ = __int__ = __index__ = __bool__ = __str__ = __repr__ = _refuse
    __eq__ = __hash__ = __lt__ = __gt__ = __add__ = __fspath__ = __array__ = _refuse  # type: ignore[assignment]


class Pretender:
    """An object that has every attribute."""

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        return Pretender()


class Endless:
    """A sequence without an end."""

    def __getitem__(self, index: int) -> float:
        if index > 1_000_000:
            raise IndexError
        return 1.0


class Loud(float):
    """A number whose text raises."""

    def __repr__(self) -> str:
        raise RuntimeError("the text of the value failed")


def numbers_with_an_error() -> Iterator[float]:
    """Yield a number, and then raise."""
    yield 1.0
    raise RuntimeError("the generator failed")


def nested(depth: int) -> list[Any]:
    """A list inside a list, and so on."""
    value: list[Any] = []
    for _ in range(depth):
        value = [value]
    return value


def circular() -> list[Any]:
    """A list that holds itself."""
    value: list[Any] = [1.0]
    value.append(value)
    return value


VALUES: dict[str, Callable[[], Any]] = {
    "None": lambda: None,
    "True": lambda: True,
    "False": lambda: False,
    "np.True_": lambda: np.True_,
    "0": lambda: 0,
    "1": lambda: 1,
    "-1": lambda: -1,
    "2": lambda: 2,
    "7": lambda: 7,
    "2**31": lambda: 2**31,
    "2**63": lambda: 2**63,
    "10**30": lambda: 10**30,
    "-(10**30)": lambda: -(10**30),
    "10**400": lambda: 10**400,
    "10**5000": lambda: 10**5000,
    "0.0": lambda: 0.0,
    "-0.0": lambda: -0.0,
    "0.5": lambda: 0.5,
    "-1.5": lambda: -1.5,
    "1e-300": lambda: 1e-300,
    "5e-324": lambda: 5e-324,
    "1e300": lambda: 1e300,
    "-1e300": lambda: -1e300,
    "nan": lambda: math.nan,
    "inf": lambda: math.inf,
    "-inf": lambda: -math.inf,
    "1j": lambda: 1j,
    "Decimal": lambda: decimal.Decimal("0.5"),
    "Decimal NaN": lambda: decimal.Decimal("sNaN"),
    "Fraction": lambda: fractions.Fraction(1, 3),
    "date": lambda: datetime.date(2000, 1, 1),
    "timedelta64": lambda: np.timedelta64(5, "s"),
    "np.float64 nan": lambda: np.float64("nan"),
    "np.float32": lambda: np.float32(0.5),
    "np.int8": lambda: np.int8(-5),
    "np.complex128": lambda: np.complex128(1j),
    "array ()": lambda: np.array(0.5),
    "array (0,)": lambda: np.zeros(0),
    "array (1,)": lambda: np.ones(1),
    "array (3,)": lambda: np.array([0.1, 0.2, 0.3]),
    "array (2, 3)": lambda: np.arange(6.0).reshape(2, 3),
    "array (1, 1, 1, 1)": lambda: np.ones((1, 1, 1, 1)),
    "array (0, 9)": lambda: np.zeros((0, 9)),
    "array nan": lambda: np.full(3, np.nan),
    "array inf": lambda: np.array([1.0, np.inf]),
    "array 1e300": lambda: np.full(2, 1e300),
    "array bool": lambda: np.array([True, False]),
    "array int8": lambda: np.array([1, -1], dtype=np.int8),
    "array uint64": lambda: np.array([2**64 - 1], dtype=np.uint64),
    "array complex": lambda: np.array([1j, 2.0]),
    "array text": lambda: np.array(["a", "b"]),
    "array bytes": lambda: np.array([b"a"]),
    "array object": lambda: np.array([None, {}], dtype=object),
    "array time": lambda: np.array(["2000-01-01"], dtype="datetime64[D]"),
    "array record": lambda: np.zeros(2, dtype=[("x", float)]),
    "array masked": lambda: np.ma.masked_array([1.0, 2.0], mask=[True, False]),
    "masked": lambda: np.ma.masked,
    "''": lambda: "",
    "' '": lambda: " ",
    "x": lambda: "x",
    "text 1.0": lambda: "1.0",
    "text nan": lambda: "nan",
    "text NUL": lambda: "a\0b",
    "text surrogate": lambda: "\udcff\ud800",
    "text escape": lambda: "\x1b[31m\u202e\n",
    "text long": lambda: "x" * 100_000,
    "text markup": lambda: "<script>&{}%s\\$^_",
    "bytes": lambda: b"x\xff",
    "bytearray": lambda: bytearray(b"1"),
    "path": lambda: Path("missing/file.txt"),
    "path .": lambda: Path(),
    "path h5": lambda: "odd.h5",
    "path png": lambda: "odd.png",
    "[]": list,
    "()": tuple,
    "[1.0]": lambda: [1.0],
    "[1e-300]": lambda: [1e-300],
    "[1e300]": lambda: [1e300],
    "[1, 2]": lambda: [1, 2],
    "(3, 2, 1)": lambda: (3.0, 2.0, 1.0),
    "[None]": lambda: [None],
    "['x']": lambda: ["x"],
    "[[1], [2, 3]]": lambda: [[1.0], [2.0, 3.0]],
    "[[nan]]": lambda: [[math.nan]],
    "list deep": lambda: nested(3000),
    "list circular": circular,
    "{}": dict,
    "{'P': 1.0}": lambda: {"P": 1.0},
    "{'x': None}": lambda: {"x": None},
    "{1: 2}": lambda: {1: 2},
    "[{'P': nan}]": lambda: [{"P": math.nan}],
    "[{}]": lambda: [{}],
    "set": lambda: {1.0},
    "range": lambda: range(3),
    "range 2**62": lambda: range(2**62),
    "slice": lambda: slice(None, None, 0),
    "generator": lambda: (k / 2.0 for k in range(3)),
    "generator that raises": numbers_with_an_error,
    "map": lambda: map(float, "x"),
    "object": object,
    "class": lambda: float,
    "Ellipsis": lambda: Ellipsis,
    "lambda": lambda: lambda *_, **__: None,
    "Hostile": Hostile,
    "Pretender": Pretender,
    "Endless": Endless,
    "Loud": lambda: Loud(0.5),
    "ValueError": lambda: ValueError("x"),
}
"""Odd values by name, each made by a call."""
