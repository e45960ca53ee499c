"""Quantities over a load cycle: ranges, slip, friction energy, sticking, and the loops of the loads."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntEnum
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from fastpin.elasticity.system import load_columns
from fastpin.elasticity.terms import body_terms
from fastpin.errors import InputError
from fastpin.kernels.status import OPEN, SLIP_NEGATIVE, SLIP_POSITIVE
from fastpin.model.angles import near_bottom
from fastpin.model.checks import instances, number_array
from fastpin.model.loads import LOAD_KIND, LOADS
from fastpin.model.read_only import ReadOnly
from fastpin.model.recorded import is_back
from fastpin.model.ties import top_angle
from fastpin.model.units import units_per_thickness
from fastpin.states.regimes import Regime, regime_of
from fastpin.states.state import State

if TYPE_CHECKING:
    import pandas

NO_SLIP = 1e-9
"""Slip that is rounding, in parts of R beta* times the largest pressure of the states that are looked at."""


class NodeBehaviour(IntEnum):
    """What a node does over a cycle."""

    NO_CONTACT = 0
    """Never closed."""

    STICKS = 1
    """Closed all the time, without slip."""

    SLIPS = 2
    """Closed all the time, and slips at some time."""

    OPENS = 3
    """Closed at some time and open at another."""


NODE_KINDS = {
    "theta": "angle",
    "behaviour": "",
    "slip_range": "displacement",
    "slip_distance": "displacement",
    "friction_energy": "energy density",
    **dict.fromkeys(("pressure_min", "pressure_max", "shear_min", "shear_max"), "traction"),
}
"""The kinds of the values of all nodes of a cycle by name, see :meth:`LoadCycle.columns`."""


@dataclass(frozen=True, eq=False)
class Loop(ReadOnly):
    """A load against the displacement on which it does work, at the states of a cycle.

    Attributes
    ----------
    load : ndarray, shape (states,)
        P and Q in N/m, M in N, remote stresses in Pa.
    displacement : ndarray, shape (states,)
        For Q, along +x, and for P, downwards: displacement of the pin where its force acts, relative to the hole, m.
        For M: the rotation, rad. For a remote stress: the integral of the tractions times the displacement of the hole
        per unit of the stress, m^2. Terms that depend on the loads alone are left out, see docs/theory.md, section 6.
    """

    load: np.ndarray
    displacement: np.ndarray

    @property
    def work(self) -> float:
        """Work of the load, J/m; over a closed cycle it is the area of the loop.

        The loop is a polygon through the states. It is exact if statuses change at states only. Otherwise the error
        falls with the square of the number of states.
        """
        return float(np.sum(0.5 * (self.load[1:] + self.load[:-1]) * np.diff(self.displacement)))


@dataclass(frozen=True, eq=False, repr=False)
class LoadCycle:
    """The part of a load history between two corners, and its quantities.

    Numbers are in SI units, or in the units of a dimensionless problem. Ranges and extremes of tractions are over the
    states, so states inside steps (``between``) make them finer. Where the states have slip sums, slip ranges, slip
    distances and friction energy are exact for any states.

    Attributes
    ----------
    states : tuple of State
        The kept states from the first corner to the last one, both included; at least two.

    Raises
    ------
    InputError
        If there are fewer than two states, or they are not of one problem and on one grid.
    """

    states: tuple[State, ...]

    def __post_init__(self) -> None:
        states = tuple(instances("states", self.states, State, "a sequence of fastpin.State"))
        if len(states) < 2:
            raise InputError("states", f"must be two or more, not {len(states)}")
        if any(state.problem != states[0].problem or state.theta.shape != states[0].theta.shape for state in states):
            raise InputError("states", "must be of one problem, and on one grid")
        object.__setattr__(self, "states", states)

    def __repr__(self) -> str:
        kind = "closed" if self.is_closed else "open"
        return f"<LoadCycle: corners {self.first} to {self.last}, {kind}, {len(self.states)} states>"

    @property
    def first(self) -> int:
        """The corner at which the cycle begins, counted from 1."""
        return self.states[0].step + 1

    @property
    def last(self) -> int:
        """The corner at which the cycle ends, counted from 1."""
        return self.states[-1].step + 1

    @property
    def theta(self) -> np.ndarray:
        """Node angles, rad, shape (n,); -pi/2 is the bottom of the hole."""
        return self.states[0].theta

    @property
    def is_closed(self) -> bool:
        """Whether the loads at both ends are equal. Reactions are no loads here."""
        return not self.differing_loads

    @property
    def differing_loads(self) -> list[str]:
        """Names of the loads that differ between the two ends; in a record of samples, by more than it can tell.

        See :func:`fastpin.model.recorded.is_back`. States inside steps are no samples.
        """
        given = [name for name in LOADS if name not in self.states[0].problem.reactions]
        corners = [state for state in self.states if state.fraction == 1.0]
        values = {name: np.array([state.load[name] for state in corners]) for name in given}
        return [name for name, each in values.items() if each[0] != each[-1] and not is_back(each)]

    @cached_property
    def status(self) -> np.ndarray:
        """Statuses of the nodes at each state, int8, shape (states, n); see :class:`fastpin.Status`."""
        return np.array([state.status for state in self.states])

    @cached_property
    def behaviour(self) -> np.ndarray:
        """What each node does over the cycle: values of :class:`NodeBehaviour`, int8, shape (n,).

        Slip and contact between two states count if slip distances are known. A node that opens between two states,
        and is back at both, is not seen.
        """
        closed = self.status != OPEN
        slips = np.any(np.isin(self.status[1:], (SLIP_NEGATIVE, SLIP_POSITIVE)), axis=0)
        distance = self.slip_distance
        if distance is not None:
            slips |= distance > 1e-12 * float(distance.max())  # less is rounding
        ever, always = ~np.isnan(self.slip_extremes[0]), closed.all(axis=0)
        behaviours = NodeBehaviour.NO_CONTACT, NodeBehaviour.SLIPS, NodeBehaviour.STICKS
        return np.select([~ever, always & slips, always], behaviours, NodeBehaviour.OPENS).astype(np.int8)

    @cached_property
    def regime(self) -> Regime:
        """Separation, full stick, partial slip or gross sliding, over the whole cycle.

        Full stick: no node slips while it is closed. Partial slip: some nodes slip, and others that are closed at some
        time never do. Gross sliding: every node that is closed at some time slips. The slip is that of the whole path
        if :attr:`has_exact_slip_range`. Otherwise it is read from the states: from the change of the slip between two
        states at which a node is closed, and from the statuses of nodes that were open before. Without friction all
        closed nodes slip.
        """
        closed = ~np.isnan(self.slip_extremes[0])
        problem = self.states[0].problem
        if problem.frictionless:
            return regime_of(closed, closed)
        least = NO_SLIP * problem.hole_radius * problem.surfaces.beta_star * float(self.pressure_extremes[1].max())
        if self.slip_distance is not None:
            return regime_of(closed, self.slip_distance > least)
        opened = self.status[:-1] == OPEN
        slipping = np.array([state.slipping for state in self.states[1:]])
        moved = np.abs(np.diff([state.slip for state in self.states], axis=0)) > least
        both = ~opened & (self.status[1:] != OPEN)
        return regime_of(closed, np.any((both & moved) | (opened & slipping), axis=0))

    # -- slip ----------------------------------------------------------------------------------------------------

    @cached_property
    def slip_range(self) -> np.ndarray:
        """Range of the slip of each node while closed, m, shape (n,); 0 where it never is.

        It is exact, for any states, if :attr:`has_exact_slip_range`. Otherwise it is the range at the states. A node
        that opens may close again at another slip. Its range is then at most the slip distance, if that is known.
        """
        lowest, highest = self.slip_extremes
        spread = np.where(np.isnan(lowest), 0.0, highest - lowest)
        return spread if self.slip_distance is None else np.minimum(spread, self.slip_distance)

    @property
    def has_exact_slip_range(self) -> bool:
        """Whether the extremes of the slip between the states are known. They are known where slip distances are."""
        return self.slip_distance is not None

    @cached_property
    def slip_extremes(self) -> tuple[np.ndarray, np.ndarray]:
        """Lowest and highest slip of each node while closed, m, shape (n,) each; NaN where it never is.

        They are exact if :attr:`has_exact_slip_range`, and otherwise read from the states.
        """
        if self.has_exact_slip_range:  # the states after the first count from it, or from a later corner
            later = self.states[1:]
            lowest = np.array([state.slip_lowest for state in later], dtype=float)
            highest = np.array([state.slip_highest for state in later], dtype=float)
        else:
            lowest = highest = np.array([np.where(state.status != OPEN, state.slip, np.nan) for state in self.states])
        return np.fmin.reduce(lowest), np.fmax.reduce(highest)

    @property
    def largest_slip_range(self) -> float:
        """Largest slip range of a node, m."""
        return float(self.slip_range.max())

    @property
    def largest_slip_range_angle(self) -> float:
        """Angle of the node with the largest slip range, rad; NaN without slip."""
        return self.angle_of_largest(self.slip_range)

    @cached_property
    def slip_distance(self) -> np.ndarray | None:
        """Distance int |ds| of the slip of each node while closed, m, shape (n,).

        None if the states have no slip sums, or if states between were left out when the result was loaded.
        """
        parts = [state.slip_distance for state in self.states[1:]]
        return _total(parts)

    @cached_property
    def friction_energy(self) -> np.ndarray | None:
        """Energy int -T ds that friction dissipates at each node, J/m^2, shape (n,). None as :attr:`slip_distance`.

        Its integral over the hole is :attr:`dissipation`, to rounding.
        """
        return _total([state.friction_energy for state in self.states[1:]])

    @property
    def dissipation(self) -> float:
        """Energy that friction dissipates in the cycle, J/m."""
        return self.states[-1].dissipation - self.states[0].dissipation

    # -- tractions -----------------------------------------------------------------------------------------------

    @cached_property
    def pressure_extremes(self) -> tuple[np.ndarray, np.ndarray]:
        """Smallest and largest pressure of each node, Pa, shape (n,) each."""
        return _extremes([state.pressure for state in self.states])

    @cached_property
    def shear_extremes(self) -> tuple[np.ndarray, np.ndarray]:
        """Smallest and largest shear traction of each node, with their signs, Pa, shape (n,) each."""
        return _extremes([state.shear for state in self.states])

    @property
    def pressure_range(self) -> np.ndarray:
        """Range of the pressure of each node, Pa, shape (n,)."""
        lowest, highest = self.pressure_extremes
        return highest - lowest

    @property
    def shear_range(self) -> np.ndarray:
        """Range of the shear traction of each node, Pa, shape (n,)."""
        lowest, highest = self.shear_extremes
        return highest - lowest

    # -- loads ---------------------------------------------------------------------------------------------------

    @cached_property
    def loops(self) -> dict[str, Loop]:
        """The loop of each load, by name: "P", "Q", "M", and the remote stresses that act.

        Over a closed cycle of a settled contact, the sum of their works is the dissipation, up to the discretisation.
        """
        states, problem = self.states, self.states[0].problem.interfaces[0]
        _, columns = load_columns(problem, self.theta, body_terms(problem))
        weights = np.r_[states[0].grid.weights, states[0].grid.weights]
        tractions = np.array([np.r_[state.pressure, state.shear] for state in states])
        moved = problem.surfaces.beta_star * problem.hole_radius * (tractions @ (weights[:, None] * columns))
        motion = {
            "P": np.array([-state.dy for state in states]),
            "Q": np.array([state.dx for state in states]),
            "M": np.array([state.rotation for state in states]),
        }
        moments = np.array([state.resultants["M"] for state in states])
        found = {}
        for place, (name, kind) in enumerate(LOAD_KIND.items()):
            load = moments if name == "M" else np.array([state.load[name] for state in states])
            if name in motion:
                found[name] = Loop(load, motion[name] + moved[:, place])
            elif kind == "traction" and load.any():
                found[name] = Loop(load, problem.hole_radius * moved[:, place])
        seats = tuple(state.seat for state in states if state.seat is not None)
        if not seats:
            return found
        # The loads act across both interfaces, remote stresses on the plate alone.
        across = LoadCycle(seats).loops
        ways = {name: found[name].displacement if name in motion else 0.0 for name in across}
        return {name: Loop(found[name].load, ways[name] + loop.displacement) for name, loop in across.items()}

    # -- output --------------------------------------------------------------------------------------------------

    def angle_of_largest(self, values: np.ndarray) -> float:
        """Angle of the node with the largest of `values`, shape (n,), rad; NaN if none is above 0.

        Of equal nodes it is the one farthest to the right.

        Another shape raises :class:`InputError`.
        """
        values = number_array("values", values)
        if values.shape != self.theta.shape:
            raise InputError("values", f"must have the shape {self.theta.shape}, not {values.shape}")
        return near_bottom(float(self.theta[top_angle(values, self.theta)])) if values.max() > 0.0 else math.nan

    def columns(self) -> dict[str, tuple[np.ndarray, str]]:
        """The values of all nodes, shape (n,), and their unit, by name. Quantities that are not known are left out."""
        unit = {**units_per_thickness(self.states[0].problem), "angle": "rad", "": ""}
        pressures, shears = self.pressure_extremes, self.shear_extremes
        values = (
            self.theta, self.behaviour, self.slip_range, self.slip_distance, self.friction_energy, *pressures, *shears
        )  # fmt: skip
        found = zip(NODE_KINDS.items(), values, strict=True)
        return {name: (each, unit[kind]) for (name, kind), each in found if each is not None}

    def to_dataframe(self) -> pandas.DataFrame:
        """The values of :meth:`columns` with a row for each node; ``frame.attrs["units"]`` names the units.

        Raises
        ------
        InputError
            If pandas is not installed.
        """
        try:
            import pandas
        except ImportError:
            raise InputError("pandas", "is not installed: pip install 'fastpin[pandas]'") from None
        columns = self.columns()
        frame = pandas.DataFrame({name: values for name, (values, _) in columns.items()})
        frame.attrs["units"] = {name: unit for name, (_, unit) in columns.items()}
        return frame


def _total(parts: Sequence[np.ndarray | None]) -> np.ndarray | None:
    """The sum of arrays; None if one of them is None."""
    known = [part for part in parts if part is not None]
    return np.sum(known, axis=0) if len(known) == len(parts) else None


def _extremes(values: list[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """The smallest and the largest value of each node, shape (n,) each."""
    return np.min(values, axis=0), np.max(values, axis=0)
