"""The result of a life of wear: the profiles of pin and hole, and the states, after chosen cycles."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, overload

import numpy as np

from fastpin.errors import InputError, InputWarning
from fastpin.model.checks import number
from fastpin.model.grid import Grid
from fastpin.model.history import LoadHistory
from fastpin.model.points import Body
from fastpin.model.problem import Problem
from fastpin.model.profile import InitialGap, Profile, profile_of_nodes
from fastpin.model.read_only import ReadOnly
from fastpin.model.wear import cycles_text
from fastpin.states.cycles import Cycle
from fastpin.states.state import State


@dataclass(frozen=True, eq=False, repr=False)
class WornCycle(ReadOnly):
    """The contact after a chosen cycle.

    Attributes
    ----------
    cycle : int
        Cycles that are done; 0 before the first one.
    next_jump : int
        The number of cycles for which the next fat cycle was to stand.
    solved : int
        Cycles that were solved so far, those of control included.
    pin_depth, plate_depth : ndarray, shape (n,)
        Depth worn off pin and plate at each node, m.
    dissipation : float
        Energy dissipated by friction so far, J/m.
    removed : float
        Elastic energy that went with the material so far, J/m.
    states : tuple of State
        The states over one cycle on this profile, without further wear: at its beginning, and at its corners.
    """

    cycle: int
    next_jump: int
    solved: int
    pin_depth: np.ndarray
    plate_depth: np.ndarray
    dissipation: float
    removed: float
    states: tuple[State, ...]

    @property
    def grid(self) -> Grid:
        """The nodes."""
        return self.states[0].grid

    @property
    def theta(self) -> np.ndarray:
        """Angles of the nodes, rad, shape (n,)."""
        return self.states[0].theta

    @property
    def gap_growth(self) -> np.ndarray:
        """Growth of the gap by the wear of both bodies, m, shape (n,)."""
        total: np.ndarray = self.pin_depth + self.plate_depth
        return total

    @property
    def gap(self) -> InitialGap:
        """The initial gap of the worn joint: ``replace(problem, gap=cycle.gap)`` is the joint as it is now.

        Between the nodes the worn depths are splines.
        """
        found = {}
        for name, depth in (("hole", self.plate_depth), ("pin", self.pin_depth)):
            first: Profile = getattr(self.states[0].problem.gap, name)
            found[name] = first + profile_of_nodes(self.grid, depth) if depth.any() else first
        return InitialGap(**found)

    @property
    def depth(self) -> float:
        """Largest growth of the gap at a node, m."""
        return float(self.gap_growth.max())

    @property
    def volumes(self) -> tuple[float, float]:
        """Volume worn off pin and plate per thickness, m^2."""
        width = self.grid.weights * self.states[0].problem.hole_radius
        return float(width @ self.pin_depth), float(width @ self.plate_depth)

    @property
    def volume(self) -> float:
        """Volume worn off both bodies per thickness, m^2."""
        return sum(self.volumes)

    @property
    def pin_share(self) -> float:
        """Part of the worn volume that comes from the pin; NaN without wear."""
        pin, plate = self.volumes
        return pin / (pin + plate) if pin + plate else float("nan")

    @property
    def energy_per_cycle(self) -> float:
        """Energy dissipated by friction in a cycle on this profile, J/m."""
        return self.states[-1].dissipation - self.states[0].dissipation

    @property
    def pressure(self) -> np.ndarray:
        """Pressure at the nodes at the beginning of the next cycle, Pa, shape (n,)."""
        return self.states[0].pressure

    @property
    def largest_pressure(self) -> float:
        """Largest pressure at a node over one cycle on this profile, Pa."""
        return max(float(state.pressure.max()) for state in self.states)

    @property
    def changes(self) -> Cycle:
        """The changes of the contact over one cycle on this profile."""
        first, last = self.states[0], self.states[-1]
        peak = float(last.pressure.max()) or 1.0
        pressure, shear = (
            float(np.abs(getattr(last, name) - getattr(first, name)).max()) / peak for name in ("pressure", "shear")
        )
        turned, length = last.rotation - first.rotation, len(self.states) - 1
        return Cycle(last.step, length, self.cycle + 1, pressure, shear, self.energy_per_cycle, turned, solved=True)

    def __repr__(self) -> str:
        return f"<WornCycle: after {self.cycle:,} cycles, depth {self.depth:.4g}, volume {self.volume:.4g}>"


@dataclass(frozen=True, eq=False, repr=False)
class WearResult(ReadOnly, Sequence[WornCycle]):
    """A life of wear: a sequence of :class:`WornCycle`, one for each chosen cycle that was reached.

    Attributes
    ----------
    problem : Problem
    history : LoadHistory
        What leads to the cycle, and the cycle, at its end.
    law : str
        "archard" or "energy", see :class:`fastpin.model.Wear`.
    tolerance : float
        Largest error of the worn gap by fat cycles; 0 if every cycle was solved.
    coefficients : ndarray, shape (2, n)
        Wear coefficients of pin and plate at the nodes, 1/Pa.
    grid : Grid
    cycles : tuple of WornCycle
    complete : bool
        Whether all cycles were followed; False in the result that an error carries.
    statistics : dict of str to float
        Counts of the solver, see :class:`fastpin.Result`, and "solved": the cycles that were really solved.
    """

    problem: Problem
    history: LoadHistory
    law: str
    tolerance: float
    coefficients: np.ndarray
    grid: Grid
    cycles: tuple[WornCycle, ...]
    complete: bool
    statistics: dict[str, float]

    @property
    def theta(self) -> np.ndarray:
        """Angles of the nodes, rad, shape (n,)."""
        return self.grid.theta

    @property
    def numbers(self) -> np.ndarray:
        """The chosen cycles, shape (chosen,)."""
        return np.array([each.cycle for each in self.cycles])

    @property
    def tau(self) -> np.ndarray:
        """Cycles times the largest wear coefficient of both bodies, 1/Pa, shape (chosen,).

        For slow wear the profile depends on this product alone.
        """
        tau: np.ndarray = self.numbers * float(self.coefficients.sum(axis=0).max())
        return tau

    @property
    def all_cycles(self) -> int:
        """Cycles that were to be followed."""
        return self.history.blocks[-1].count - 1

    def after(self, cycles: float) -> WornCycle:
        """The contact after so many cycles, which must be chosen ones.

        Raises
        ------
        InputError
            If no profile is stored there.
        """
        wanted = number("after", cycles, 0.0)
        found = next((each for each in self.cycles if each.cycle == wanted), None)
        if found is None:
            near = sorted(self.cycles, key=lambda each: abs(each.cycle - wanted))[:2]
            stored = " and ".join(f"{number:,}" for number in sorted(each.cycle for each in near)) or "none"
            raise InputError("after", f"no profile is stored after {cycles_text(wanted)}; the nearest: {stored}")
        return found

    @property
    def doubts(self) -> list[InputWarning]:
        """Warnings: a pin that wears although its profile turns with it."""
        return slip_doubts(self.coefficients, self.cycles[0]) if self.cycles else []

    def summary(self) -> str:
        """The chosen cycles as a table."""
        import fastpin

        return fastpin.assess.wear.table(self)

    def fatigue(self, criterion: Any = "smith-watson-topper", body: Body = "plate", **options: Any) -> Any:
        """Damage of the material over the life: it goes with the material that wears off.

        Parameters
        ----------
        criterion, body, **options
            See :func:`fastpin.damage.worn_fatigue`.

        Returns
        -------
        fastpin.damage.WornFatigue

        Raises
        ------
        InputError
            See :func:`fastpin.damage.worn_fatigue`.
        """
        from fastpin.damage import worn_fatigue

        return worn_fatigue(self, criterion, body, **options)

    def plot(self, path: str | Path | None = None, kind: str = "scar", **options: Any) -> Any:
        """Draw the worn profiles, or another kind of figure of wear, and return the matplotlib figure.

        Parameters
        ----------
        path, **options
            See :func:`fastpin.plot_tractions`, and the options of the kind, such as ``body="pin"``.
        kind : str
            "scar": profile and pressure. "wear": the numbers over the cycles. "damage": the damage of :meth:`fatigue`.
            Other kinds of ``fastpin plot``, such as "tractions" or "loops", show one cycle on the last profile. The
            option ``after=1000`` chooses the profile after so many cycles.

        Raises
        ------
        InputError
            See :func:`fastpin.plot_tractions`, :meth:`after` and :meth:`fatigue`.
        """
        import fastpin

        return fastpin.figures.plotting.plot_result(self, kind, path, **options)

    def report(self, path: str | Path, **options: Any) -> None:
        """Write a report of the life, an HTML page or a PDF: law, numbers, worn profile, damage, contact, checks.

        Parameters
        ----------
        path, **options
            See :func:`fastpin.pages.write_report`.

        Raises
        ------
        InputError
            See :func:`fastpin.pages.write_report`.
        """
        from fastpin.pages import write_report

        write_report(self, path, **options)

    def __repr__(self) -> str:
        whole = "complete" if self.complete else "incomplete"
        head = f"<WearResult: {len(self.cycles)} chosen cycles, {self.grid.size} nodes, {whole}"
        return f"{head}\n last: {self.cycles[-1]!r}>" if self.cycles else f"{head}>"

    @overload
    def __getitem__(self, index: int) -> WornCycle: ...

    @overload
    def __getitem__(self, index: slice) -> tuple[WornCycle, ...]: ...

    def __getitem__(self, index: int | slice) -> WornCycle | tuple[WornCycle, ...]:
        return self.cycles[index]

    def __len__(self) -> int:
        return len(self.cycles)


def slip_doubts(coefficients: np.ndarray, cycle: WornCycle) -> list[InputWarning]:
    """Return a warning if the pin wears, and slips by more than a node distance in a piece of the cycle.

    `coefficients` are those of pin and plate at the nodes, 1/Pa, shape (2, n). The profile of the pin turns with it.
    """
    problem = cycle.states[0].problem
    if problem.dimensionless or not coefficients[0].any():
        return []
    slips = [state.slip_distance for state in cycle.states[1:]]
    slip = max((float(each.max()) for each in slips if each is not None), default=0.0)
    distance = float(cycle.grid.weights.min()) * problem.hole_radius
    if slip <= distance:
        return []
    words = f"the pin slips by {slip:.2g} m in a piece of the cycle, more than a node distance, {distance:.2g} m"
    return [InputWarning("pin", f"{words}; its wear is kept where the pin touched first")]
