"""The readers of sections of a case beside its problem, which outcomes of plans use, too."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from fastpin.casefile.cracks import read_crack
from fastpin.casefile.strength import read_strength

READERS: dict[str, Callable[..., Any]] = {"crack": read_crack, "strength": read_strength}
"""Functions of a text, a section and the values of keys that it leaves out. None: a key is wrong (reported).

The section [fatigue] is checked with the history and the options, and has a way of its own in the reader of cases.
"""
