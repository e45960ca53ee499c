"""The errors of a solution, and its interruption: the history was not followed to its end."""

from __future__ import annotations

from fastpin.errors import FastpinError
from fastpin.solver.result import Result

CUT_OFF = "the contact reaches an end of the arc; give a wider one, or none"
"""Message of an :class:`ArcError`."""

NARROW = "at the first load the contact is narrower than the nodes can resolve; use more nodes or leave that load out"
"""Message where the contact at the first load is narrower than the nodes."""

UNHELD = "nothing holds the pin any more: it spins, slides away or loses contact"
"""Message of a :class:`NoEquilibriumError`."""


OPENED = (
    "the press fit does not hold the bonded bush, it opens in its seat; to go on, give its friction in the plate and "
    "bonded = false"
)
"""Message of a :class:`NoEquilibriumError`."""


class SolveError(FastpinError):
    """The load history could not be followed to its end.

    Attributes
    ----------
    step : int
        Index of the load corner towards which the load was moving.
    fraction : float
        Fraction of that step that was solved, 0 to 1.
    load : dict of str to float
        The load at which the solution was lost, in the units of the history.
    result : Result or None
        The result up to there, with all states that were solved.
    """

    def __init__(
        self,
        message: str,
        step: int = -1,
        fraction: float = 0.0,
        load: dict[str, float] | None = None,
        result: Result | None = None,
    ) -> None:
        super().__init__(message)
        self.step = step
        self.fraction = fraction
        self.load = dict(load or {})
        self.result = result


class Interrupted(KeyboardInterrupt):
    """Ctrl-C during a solution. ``result`` holds the states before; the solution can continue from it."""

    def __init__(self, result: Result | None = None) -> None:
        super().__init__("interrupted")
        self.result = result


class NoEquilibriumError(SolveError):
    """No state of the pin carries the load: the pin spins, slides away or loses contact."""


class ConvergenceError(SolveError):
    """The solver found no state that meets the contact conditions, and returns none."""


class ArcError(SolveError):
    """The contact reaches an end of the given arc of nodes."""


class ResolutionError(ConvergenceError):
    """The contact is narrower than the nodes of this grid can resolve."""
