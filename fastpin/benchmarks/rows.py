"""The record of a benchmark, and its rows: a published number as printed, fastpin's number, and what follows."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from matplotlib.figure import Figure

from fastpin.paper.curves import Report
from fastpin.report.curves import Curve

AGREES = "agrees to the digits printed"
"""The verdict on a number that differs by at most one unit of the last digit printed."""


@dataclass(frozen=True)
class Row:
    """One quantity of a benchmark.

    Attributes
    ----------
    quantity, unit : str
    published : str
        The number as printed; empty if no number was seen.
    ours : float
        fastpin's number, in `unit`.
    why : str
        The verdict if the numbers differ. It begins with "differs", "open", "comparison only" or "misprint".
    last_digit : float, optional
        A unit of the last digit of the published number, where it is not a decimal one.
    """

    quantity: str
    unit: str
    published: str
    ours: float
    why: str = "differs"
    last_digit: float | None = None

    @property
    def difference(self) -> float | None:
        """fastpin's number minus the published one; None if there is none."""
        return self.ours - float(self.published) if self.published else None

    @property
    def places(self) -> int:
        """The number of decimal places of the published number."""
        return len(self.published.partition(".")[2])

    @property
    def resolution(self) -> float:
        """A unit of the last digit printed."""
        return 10.0**-self.places if self.last_digit is None else self.last_digit

    @property
    def agrees(self) -> bool:
        """Whether the numbers differ by at most one unit of the last digit printed."""
        # The difference of two decimal numbers is rounded.
        return self.difference is not None and abs(self.difference) <= (1.0 + 1e-9) * self.resolution

    @property
    def verdict(self) -> str:
        """What follows from the difference, in words."""
        return AGREES if self.agrees else self.why


@dataclass(frozen=True)
class Outcome:
    """The rows of a benchmark, and the curves of its figure, which may be none."""

    rows: Sequence[Row]
    curves: Sequence[Curve] = field(default=(), repr=False)


@dataclass(frozen=True)
class Benchmark:
    """A problem that others publish.

    Attributes
    ----------
    name, title : str
    statement : str
        Geometry, materials and loads.
    sources : sequence of str
    compute : callable
        ``compute(progress)`` solves, and returns the outcome.
    draw : callable, optional
        ``draw(curves)`` draws the curves of the outcome.
    """

    name: str
    title: str
    statement: str
    sources: Sequence[str]
    compute: Callable[[Report | None], Outcome]
    draw: Callable[[Sequence[Curve]], Figure] | None = None
