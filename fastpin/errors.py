"""Every error that fastpin raises on purpose. All derive from :class:`FastpinError`."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from fastpin.state import Result


CUT_OFF = "the contact reaches an end of the arc; give a wider one, or none"


class FastpinError(Exception):
    """Base class of all errors raised by fastpin."""


class InputError(FastpinError, ValueError):
    """Input that can't be used. ``field`` names the field, the message says what is allowed."""

    def __init__(self, field: str, message: str) -> None:
        super().__init__(f"{field}: {message}")
        self.field = field
        self.reason = message


class CaseFileError(InputError):
    """A case file with faults.

    Attributes
    ----------
    problems : list of (int, str)
        Line, from 1, and one sentence for each fault, in the order of the lines. Line 0 is the whole file.
    """

    def __init__(self, name: str, problems: list[tuple[int, str]]) -> None:
        self.problems = sorted(problems, key=lambda problem: problem[0])
        super().__init__(name, self.problems[0][1])
        lines = [f"{name}{f', line {line}' if line else ''}: {text}" for line, text in self.problems]
        self.args = ("\n".join(lines),)


class SolveError(FastpinError):
    """A history that could not be followed to its end.

    Attributes
    ----------
    step : int
        Index of the load corner towards which the load was moving.
    fraction : float
        Fraction of that step that was solved, 0 to 1.
    load : dict of str to float
        The load at which the solution was lost, in the units of the history.
    result : Result or None
        Everything that was solved before.
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
    """Ctrl-C during a solution, which stopped where it can be gone on from; ``result`` is what was solved before."""

    def __init__(self, result: Result | None = None) -> None:
        super().__init__("interrupted")
        self.result = result


class NoEquilibriumError(SolveError):
    """No state of the pin carries the load: the pin spins, slides away or loses contact."""


class ConvergenceError(SolveError):
    """The solver could not find a state that meets the contact conditions; none is returned."""


class ArcError(SolveError):
    """The contact reaches an end of the arc of nodes that was given."""
