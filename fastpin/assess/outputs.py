"""One description of an output: JSON, its schema, columns of CSV files and outcomes of sweeps follow from it."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np

from fastpin.model.angles import from_bottom
from fastpin.model.units import DEGREE, Unit

ROUNDING = 1e-9
"""Values and differences below this part of the largest of their kind are rounding. They are shown as 0."""


class Output(NamedTuple):
    """An output of a subject, such as a crack that grows.

    Attributes
    ----------
    name : str
        Its key in JSON.
    kind : str
        A key of :func:`fastpin.model.units.units`, "angle" (a place on the hole, rad), "width" (rad), "class", "text",
        "texts", "whole", "truth", "table" (of JSON), or "" for a plain number.
    of : callable
        Gives its value for a subject, in SI units: a number, an array, or a text.
    words : str
        What it is, in the schema.
    heading : str
        Its name in CSV files; unless given, `name` with spaces.
    short : str
        Its name in tables; unless given, the heading.
    classes : mapping of int to str
        The words of each value of a class.
    allowed : collection of str
        The texts that it may be; empty if it may be any.
    optional : bool
        Whether it may be unknown or infinite: null in JSON.
    """

    name: str
    kind: str
    of: Callable[[Any], Any]
    words: str = ""
    heading: str = ""
    short: str = ""
    classes: Mapping[int, str] = MappingProxyType({})
    allowed: Collection[str] = ()
    optional: bool = False

    def shown(self, subject: Any, unit: Mapping[str, Unit]) -> Any:
        """The value in printed units, angles in degrees, and a class in words."""
        value = self.of(subject)
        if self.classes:
            return self.classes[value]
        if self.kind in ("angle", "width") and not math.isnan(value):
            return from_bottom(value) if self.kind == "angle" else math.degrees(value)
        return unit[self.kind].factor * value if self.kind in unit else value

    def number(self, subject: Any) -> float:
        """The value as an outcome of sweeps, with angles in rad; NaN for a life without end."""
        value = float(self.of(subject))
        return math.nan if self.kind == "life" and math.isinf(value) else value

    def column(self, unit: Mapping[str, Unit]) -> str:
        """Its heading with its unit."""
        name = (DEGREE if self.kind in ("angle", "width") else unit.get(self.kind, Unit(1.0, ""))).name
        heading = self.heading or self.name.replace("_", " ")
        return f"{heading} [{name}]" if name else heading

    @property
    def schema(self) -> dict[str, Any]:
        """The schema of its value in JSON."""
        found: dict[str, Any] = {"enum": list(self.allowed or self.classes.values())}
        if not found["enum"]:
            found = {"type": {"text": "string", "whole": "integer", "truth": "boolean"}.get(self.kind, "number")}
        if self.kind == "texts":
            found = {"type": "array", "items": found if self.allowed else {"type": "string"}}
        elif self.kind == "table":
            found = {"anyOf": [{"type": "object"}, {"type": "null"}]}
        elif self.optional:
            found["type"] = [found["type"], "null"]
        return found | ({"description": self.words} if self.words else {})


def document(outputs: Iterable[Output], subject: Any, unit: Mapping[str, Unit]) -> dict[str, Any]:
    """Return the outputs of a subject as a dict, in printed units. An array becomes a list."""
    values = {each.name: each.shown(subject, unit) for each in outputs}
    return {name: value.tolist() if isinstance(value, np.ndarray) else value for name, value in values.items()}


def properties(outputs: Iterable[Output]) -> dict[str, dict[str, Any]]:
    """Return the schemas of outputs in JSON by name."""
    return {each.name: each.schema for each in outputs}


def chosen(outputs: Iterable[Output], names: Sequence[str]) -> dict[str, Output]:
    """Return some of the outputs by name, in the order of the names."""
    known = {each.name: each for each in outputs}
    return {name: known[name] for name in names}
