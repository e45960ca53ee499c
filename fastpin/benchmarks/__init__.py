"""The old folder of the names of :mod:`fastpin.published`. They work here for one version, with a warning."""

from typing import Any

from fastpin import published
from fastpin.moved import with_moved


def _face(name: str) -> Any:
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


__getattr__ = with_moved(_face, lambda: published, ("half_angle", "load_term", "peak_pressure", "Outcome", "Row"))
