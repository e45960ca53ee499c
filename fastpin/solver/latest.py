"""The recorder of a session: it keeps the latest state, and looks beyond the arc."""

from __future__ import annotations

from fastpin.model.loads import named_load
from fastpin.solver.errors import ArcError
from fastpin.solver.growth import OutsideGap
from fastpin.solver.run import Run
from fastpin.solver.solving import MemoryRecorder
from fastpin.states.state import State


class LatestState(MemoryRecorder):
    """A recorder that keeps the latest state only, and notes whether the pin has touched the hole beyond the arc."""

    def __init__(self) -> None:
        super().__init__()
        self.outside: OutsideGap | None = None
        self.touched_outside = False

    def begin(self, run: Run) -> None:
        """Forget the state. From here on all states come from `run`."""
        super().begin(run)
        self.touched_outside = False
        if run.grid.closed:
            self.outside = None
        elif self.outside is None or self.outside.of is not run.system.operator:
            self.outside = OutsideGap(run.system)

    def add(self, state: State) -> None:
        """Keep a state in place of the one before."""
        self.states = [state]

    def corner_reached(self) -> None:
        """Look beyond the arc."""
        if self.outside is not None and not self.touched_outside:
            assert self.run is not None
            self.touched_outside = self.outside.is_closed(self.run.system, self.run.now)


def touches_outside(run: Run) -> ArcError:
    """The error of a run whose pin touches the hole beyond the arc."""
    message = f"step {run.corner}: the pin touches the hole beyond the arc"
    return ArcError(message, run.corner - 1, 1.0, named_load(run.load))
