"""One state of the contact: tractions, motion, zones, peaks and energies."""

from __future__ import annotations

import math
from abc import abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from functools import cached_property, partial
from typing import TYPE_CHECKING, Any, TypedDict

import numpy as np

from fastpin import reading
from fastpin.kernels.status import OPEN
from fastpin.model.angles import from_bottom, interval_from_bottom, near_bottom
from fastpin.model.checks import instance, true_or_false
from fastpin.model.grid import Grid
from fastpin.model.loads import LOADS, STRESSING
from fastpin.model.points import Body, Points
from fastpin.model.problem import Problem
from fastpin.model.read_only import ReadOnly
from fastpin.model.synonyms import explains_attributes
from fastpin.model.units import named_loads, units
from fastpin.reading import peaks, zones
from fastpin.reading.cusps import ShearNodes
from fastpin.reading.exponents import Coupling
from fastpin.reading.marks import Marks
from fastpin.reading.old_borders import truly_sticking
from fastpin.reading.zones import Interval, runs
from fastpin.states.regimes import Regime, regime_of

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    # these modules import compiled code, and are loaded when a stress is asked for
    from fastpin.elasticity.tractions import RefinedTractions, Tractions
    from fastpin.reading.joint import BushFit
    from fastpin.reading.outline import OutlineHoop, OutlinePeak
    from fastpin.reading.stress import HoopPeak, Stress


class SlipFields(TypedDict, total=False):
    """The fields of a :class:`State` with the slip since an earlier state. Empty where slip is not counted."""

    slip_distance: np.ndarray
    friction_energy: np.ndarray
    slip_lowest: np.ndarray
    slip_highest: np.ndarray


@explains_attributes()
@dataclass(frozen=True, eq=False, repr=False)
class State(ReadOnly):
    """The contact at one load.

    The arrays and dicts are read-only, because steps that repeat share them. All numbers are in SI units, or in the
    units of a dimensionless problem.

    The angles that are read lie at most half a turn from the bottom of the hole, also if the grid begins elsewhere. The
    angle of a peak lies in (-3 pi/2, pi/2], and so does the middle of every interval. An interval across the top may so
    begin before -3 pi/2 or end after pi/2. Intervals are in increasing order. An interval all round is (-3 pi/2, pi/2).

    Attributes
    ----------
    step : int
        Index of the load corner that this state belongs to (0 for the first).
    fraction : float
        Part of the step from the previous corner to this one, 0 to 1; 1 at the corner itself.
    load : dict of str to float
        Loads by name, see :data:`fastpin.model.loads.LOADS`. They hold the reactions to prescribed motion, see
        :attr:`fastpin.Problem.reactions`.
    theta : ndarray, shape (n,)
        Node angles, rad; -pi/2 is the bottom of the hole.
    pressure, shear : ndarray, shape (n,)
        Contact pressure N >= 0 and shear traction T on the pin, positive along +theta (counter-clockwise), Pa.
    gap, slip : ndarray, shape (n,)
        Gap h >= 0 and slip s of the pin over the plate, positive along +theta, m. Slip counts from the position
        in which the pin first rested on the hole (for an interference fit, from the concentric position).
    status : ndarray of int8, shape (n,)
        Values of :class:`fastpin.Status`: OPEN, STICK, SLIP_POSITIVE or SLIP_NEGATIVE. Without friction every closed
        node is SLIP_POSITIVE.
    dx, dy, rotation : float
        Rigid motion of the pin along +x, +y (m) and counter-clockwise (rad) from its first resting position.
        In the paper's symbols: C_0x, -Delta and C_omega, also if a hub of another radius is held. (dx, dy) is the mean
        displacement of the pin's rim relative to the rim of the hole. It counts from the concentric position if a
        displacement is prescribed.
    dissipation, work, energy : float
        Energy dissipated by friction so far, work of the loads so far and elastic energy now, J/m. Work and energy
        leave out the part that depends on the load alone (infinite for a load at a point), so they may be negative.
        The work counts the moment that holds the pin, times C_omega. A spring at the hub lies outside: its own energy
        M^2/(2 k) is in neither. A reaction counts like a force: the part g F^2/2 of (T29) is in neither.
        An interference fit begins with the energy of its assembly in both work and energy.
    residuals : dict of str to float
        Largest violations of the contact conditions, recomputed from the matrices. "gap" and "slip" are relative to
        the largest displacement, "cone" (Coulomb's law and N >= 0) to the largest pressure, "equilibrium" to the sum of
        the resultants of the absolute tractions.
    problem : Problem
        Materials, geometry, friction and the way in which the pin is held.
    grid : Grid
        The nodes.
    marks : Marks or None
        Old borders, see :mod:`fastpin.reading.marks`. None in a result from a file of an earlier version.
    error_bars : ErrorBars or None
        Largest likely error of each quantity and of each end of a zone, by name, and of the tractions at each node, see
        :class:`fastpin.states.state.ErrorBars`. None unless ``solve(..., error_bars=True)``.
    slip_distance, friction_energy : ndarray, shape (n,), or None
        Distance int |ds| of the slip, m, and friction energy int -T ds, J/m^2, at each node while it was closed. They
        count since the state before in the result, and since the beginning of the history for the first state. None
        unless ``solve(..., slip_sums=True)``.
    slip_lowest, slip_highest : ndarray, shape (n,), or None
        Lowest and highest slip of each node while it was closed, m; NaN where it was not. They cover the time since the
        last kept corner before this state, that corner included, or since the beginning of the history. None as
        ``slip_distance``.
    seat : State or None
        The contact of a bush that slips in the plate, as a state of its own: the bush is its pin, and its slip and
        motion are those of the bush over the plate. Its ``dissipation`` is the part in the seat. Its ``work``,
        ``energy`` and ``residuals`` are those of the whole joint. None without such a bush.
    """

    step: int
    fraction: float
    load: dict[str, float]
    theta: np.ndarray
    pressure: np.ndarray
    shear: np.ndarray
    gap: np.ndarray
    slip: np.ndarray
    status: np.ndarray
    dx: float
    dy: float
    rotation: float
    dissipation: float
    work: float
    energy: float
    residuals: dict[str, float]
    problem: Problem
    grid: Grid
    marks: Marks | None = None
    error_bars: ErrorBars | None = None
    slip_distance: np.ndarray | None = None
    friction_energy: np.ndarray | None = None
    slip_lowest: np.ndarray | None = None
    slip_highest: np.ndarray | None = None
    seat: State | None = None

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.seat is not None:  # how the pin is pressed into the bush is a matter of both
            instance("seat", self.seat, State, "a State").__dict__["_joint"] = self.problem, self.grid

    def __getstate__(self) -> dict[str, Any]:
        """The fields alone: everything else is computed from them."""
        return {name: self.__dict__[name] for name in _FIELDS}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)
        self.__post_init__()

    def __repr__(self) -> str:
        unit = units(self.problem)["traction"]
        head = f"<State at load point {self.step + self.fraction:.4g}: {named_loads(self.problem, self.load)}"
        if not self.in_contact:
            return f"{head}, no contact, {self.grid.size} nodes>"
        peaks_ = [
            f"peak {name} {unit.text(value)} at {from_bottom(angle):z.2f} deg"
            for name, value, angle in (
                ("pressure", self.peak_pressure, self.peak_pressure_angle),
                ("shear", self.peak_shear, self.peak_shear_angle),
            )
            if value != 0.0
        ]
        zones_ = []
        for name, intervals in (("contact", self.contact), ("stick", self.stick)):
            ends = [interval_from_bottom(start, stop) for start, stop in intervals]
            zones_.append(f"{name} {' and '.join(f'{start:z.2f} to {stop:z.2f}' for start, stop in ends) or 'none'}")
        return f"{head}\n {', '.join(peaks_)}\n {', '.join(zones_)} deg, {self.grid.size} nodes>"

    def _repr_html_(self) -> str:
        """HTML with a small table and a figure, for notebooks."""
        import fastpin

        return fastpin.figures.state_html(self)

    @property
    def in_contact(self) -> bool:
        """Whether any node is closed."""
        return bool(np.any(self.status != OPEN))

    @cached_property
    def contact(self) -> list[Interval]:
        """Contact intervals (start, stop), rad, read between the nodes.

        The pressure is extrapolated to zero, see :mod:`fastpin.reading.zones`. A contact round the whole circle is one
        interval of length 2 pi.
        """
        return zones.in_order(self.contact_in_runs)

    @cached_property
    def contact_in_runs(self) -> list[Interval]:
        """The contact intervals of the runs of closed nodes, in their order and in the turns of the grid."""
        return zones.contact_intervals(self.grid, self.status, self.pressure, self.coupling)

    @cached_property
    def stick(self) -> list[Interval]:
        """Stick intervals (start, stop), rad, read between the nodes.

        mu N - |T| is extrapolated to zero, see :mod:`fastpin.reading.zones`. Sticking nodes that reach |T| = mu N
        exactly at this load count as slipping.
        """
        return zones.in_order(self._stick)

    @cached_property
    def _stick(self) -> list[Interval]:
        """The stick intervals of the runs of sticking nodes, in their order; inside the contact."""
        return self.nodes.stick_intervals(self.status != OPEN, self.contact_in_runs)

    @cached_property
    def stick_runs(self) -> list[tuple[np.ndarray, Interval]]:
        """The runs of sticking nodes, in their order, each with its interval in the turns of the grid."""
        return list(zip(runs(self.grid, self._sticking), self._stick, strict=True))

    @cached_property
    def slip_zones(self) -> list[tuple[float, float, int]]:
        """Slip zones (start, stop, sign), rad: the parts of the contact that do not stick, and the sign of the slip."""
        return zones.in_order(zones.complement(self.grid, self.contact_in_runs, self._stick, self.status))

    @property
    def regime(self) -> Regime:
        """Separation, full stick, partial slip or gross sliding: whether all, some or none of the closed nodes stick.

        Sticking nodes that reach |T| = mu N exactly at this load count as slipping, as in :attr:`stick`.
        """
        return regime_of(self.status != OPEN, self.slipping)

    @property
    def slipping(self) -> np.ndarray:
        """The nodes that are closed and do not stick, bool, shape (n,)."""
        return (self.status != OPEN) & ~self._sticking

    @property
    def peak_pressure(self) -> float:
        """Largest contact pressure, Pa, read between nodes; 0 without contact."""
        return self._pressure_peak[0]

    @property
    def peak_pressure_angle(self) -> float:
        """Angle of the largest contact pressure, rad; NaN without contact."""
        return self._pressure_peak[1]

    @property
    def peak_shear(self) -> float:
        """Shear traction of largest magnitude, with its sign, Pa, read between nodes; 0 without shear."""
        return self._shear_peak[0]

    @property
    def peak_shear_angle(self) -> float:
        """Angle of the shear traction of largest magnitude, rad; NaN without shear."""
        return self._shear_peak[1]

    @property
    def peak_slip(self) -> float:
        """Slip of largest magnitude of the closed nodes, with its sign, m; 0 without contact."""
        return self._slip_peak[0]

    @property
    def peak_slip_angle(self) -> float:
        """Angle of the slip of largest magnitude, rad; NaN without contact."""
        return self._slip_peak[1]

    @cached_property
    def _slip_peak(self) -> tuple[float, float]:
        if not self.in_contact:
            return 0.0, math.nan
        (node,) = peaks.slip_nodes(self.slip[None], self.status[None], self.theta)
        return float(self.slip[node]), near_bottom(float(self.theta[node]))

    @cached_property
    def _pressure_peak(self) -> tuple[float, float]:
        if not self.in_contact:
            return 0.0, math.nan
        peak, place = peaks.pressure_peak(self.grid, self.pressure)
        return peak, near_bottom(place)

    @cached_property
    def _shear_peak(self) -> tuple[float, float]:
        if not self.shear.any():
            return 0.0, math.nan
        peak, place = peaks.shear_peak(self.nodes, self._stick)
        most = self.most_friction * self.peak_pressure
        return min(max(peak, -most), most), near_bottom(place)

    @cached_property
    def friction(self) -> np.ndarray:
        """Coefficient of friction at the nodes, shape (n,)."""
        return self.friction_at(self.theta)

    def friction_at(self, theta: np.ndarray) -> np.ndarray:
        """Coefficient of friction at the angles `theta` (...), rad, shape (...), with its change at this load."""
        return self._friction_factor * self.problem.friction_at(theta)

    @property
    def most_friction(self) -> float:
        """The largest coefficient of friction round the hole, with its change at this load."""
        return self._friction_factor * self.problem.most_friction

    @property
    def _friction_factor(self) -> float:
        return 1.0 + self.load.get("friction_change", 0.0)

    @cached_property
    def coupling(self) -> Coupling:
        """How the surfaces couple pressure and shear at the nodes."""
        return Coupling.of(self.problem, self.friction, self.theta)

    @cached_property
    def _reserve(self) -> np.ndarray:
        return self.friction * self.pressure - np.abs(self.shear)

    @cached_property
    def _sticking(self) -> np.ndarray:
        return truly_sticking(self.status, self._reserve)

    @property
    def old_borders(self) -> np.ndarray | None:
        """Marks of the nodes beside old borders, int8, shape (n,), see :mod:`fastpin.reading.old_borders`; or None."""
        return None if self.marks is None else self.marks.arrays(self.grid.size)[0]

    @property
    def old_places(self) -> np.ndarray | None:
        """Places of the old borders, shape (n,), in node distances inwards from their nodes; or None.

        They are NaN where unknown.
        """
        return None if self.marks is None else self.marks.arrays(self.grid.size)[1]

    @cached_property
    def nodes(self) -> ShearNodes:
        """The nodal tractions with the marks of old borders."""
        tractions = self.grid, self.pressure, self.shear, self._sticking
        return ShearNodes(*tractions, self.marks or Marks(), self.friction, self.coupling)

    @cached_property
    def resultants(self) -> dict[str, float]:
        """The loads that the tractions balance, (50), (51): "P" and "Q" in N/m, "M" in N.

        If the rotation of the pin is held, M is the moment that holds it: the moment of the spring, if there is one.
        """
        cos, sin = self.grid.trig_moments()
        radius = self.problem.hole_radius
        return {
            "P": radius * float(cos @ self.shear - sin @ self.pressure),
            "Q": radius * float(sin @ self.shear + cos @ self.pressure),
            "M": -(radius**2) * float(self.grid.weights @ self.shear),
        }

    @property
    def _interfaces(self) -> tuple[State, ...]:
        """The states of the pin and of the seat of a bush that slips."""
        return (self,) if self.seat is None else (self, self.seat)

    @cached_property
    def _tractions(self) -> Tractions:
        return reading.stress.tractions_of(self.grid, self.status, self.pressure, self.shear)

    @cached_property
    def refined(self) -> RefinedTractions:
        """The tractions with power laws at contact edges and stick-slip borders, see :mod:`fastpin.reading.refined`."""
        return reading.refined.refined_tractions(self.nodes, self.status, self.contact_in_runs, self.stick_runs)

    def stress(self, points: Points, body: Body = "plate", straight: bool = False) -> Stress:
        """The stress at points of plate or pin, Pa, from the tractions in closed form; tension is positive.

        The remote stress, the force on the pin and the moment at its centre are included, and so is the press fit of a
        bush. The body "plate" holds its bush: points beyond the outer radius of the bush lie in the plate round it. The
        body "seat" is this plate alone: its points are counted from the seat of the bush. A compliance without its
        outline gives the stress near its hole only: up to its ``reach``.

        Parameters
        ----------
        points : Points
        body : {"plate", "pin", "seat"}
        straight : bool
            Whether the tractions are straight lines between the nodes everywhere. Otherwise they follow power laws at
            contact edges and stick-slip borders, see :attr:`refined`.

        Raises
        ------
        InputError
            If a point lies outside the body, inside a plate that a compliance describes, or where the stress is
            infinite, if the body is rigid, or if an argument is of another class.
        """
        chosen = (
            each._tractions if true_or_false("straight", straight) else each.refined.tractions
            for each in self._interfaces
        )
        return reading.stress.stress_at(self.problem, next(chosen), self.load, points, body, next(chosen, None))

    def assembly_stress(self, points: Points, body: Body = "plate") -> Stress:
        """The part of :meth:`stress` that pressed pins and bushes have before any load, Pa; tension is positive.

        The rest is the stress of the loads. It is 0 everywhere if nothing is pressed. Arguments and errors are those of
        :meth:`stress`.
        """
        return reading.stress.assembly_stress(self.problem, self._assembled, points, body)

    @property
    def _assembled(self) -> Sequence[Tractions]:
        """The tractions before any load of all interfaces, the pin first; none if nothing is pressed."""
        import fastpin

        return fastpin.solver.assembled_tractions(*self._joint)[-len(self.problem.interfaces) :]

    @cached_property
    def _joint(self) -> tuple[Problem, Grid]:
        """The joint, with the nodes of its pin. That of a seat is told by the state of the joint."""
        return self.problem, self.grid

    def hoop_stress(self, body: Body = "plate", theta: ArrayLike | None = None, straight: bool = False) -> np.ndarray:
        """The hoop stress on the edge of the hole, of the pin, or of the plate at the seat of a bush, Pa.

        Tension is positive. With a bush, "plate" is the bore of the bush, and "seat" the plate round it.

        Parameters
        ----------
        body : {"plate", "pin", "seat"}
        theta : array_like, optional
            Angles, rad; the nodes unless given.
        straight : bool
            As for :meth:`stress`.

        Raises
        ------
        InputError
            If an angle is no finite number, the body is rigid, or there is no bush.
        """
        return self.stress(Points.at_depth(0.0, self.theta if theta is None else theta), body, straight).hoop

    def peak_hoop_stress(self, body: Body = "plate") -> HoopPeak:
        """The largest hoop stress round the hole, the pin or the seat of a bush, its place and stress concentrations.

        Raises
        ------
        InputError
            If the body is rigid, or there is no bush.
        """
        reading.stress.check_body(self.problem, body)
        if body == "seat" and self.seat is not None:
            return self.seat.peak_hoop_stress()
        if body not in self._hoop_peaks:
            is_kept = "refined" in self.__dict__
            given = self.load, self.resultants, self.grid, self.status != OPEN, self.refined, body
            peak_of = partial(reading.hoop.hoop_peak, self.problem, *given)
            refined = [each.refined.tractions for each in self._interfaces]
            parts = reading.stress.edge_hoop(self.problem, self.load, body, *refined), self.assembly_stress
            self._hoop_peaks[body] = reading.hoop.peak_in_parts(peak_of, *parts, body, self._joint[0])
            if not is_kept:  # the refined tractions of many states would fill the memory
                del self.__dict__["refined"]
        return self._hoop_peaks[body]

    def outline_hoop_stress(self) -> OutlineHoop:
        """The hoop stress along outline and further holes; a plate without an outline raises :class:`InputError`."""
        own = self._interfaces[-1]
        loads = np.array([[own.load.get(LOADS[place], 0.0) for place in STRESSING]])
        found = reading.outline.outline_hoop(own.problem, own.grid, own.pressure[None], own.shear[None], loads)
        return found._replace(hoop=found.hoop[0])

    @cached_property
    def outline_peak(self) -> OutlinePeak:
        """The largest of :meth:`outline_hoop_stress`."""
        return self.outline_hoop_stress().peak

    @cached_property
    def _hoop_peaks(self) -> dict[Body, HoopPeak]:
        """The largest hoop stresses that were asked for."""
        return {}

    @property
    def displacement(self) -> dict[str, float]:
        """The displacement of the hub relative to the gauge circle, "ux" and "uy" in m, (T29).

        It counts as dx and dy do. Where it is prescribed, it is the load of the same name, less the give of the rig.
        """
        (cos, sin), pair = self.grid.trig_moments(), self.problem.surfaces
        own, coupling = self.problem.drive_compliances
        own, coupling = own * pair.beta_star, coupling * pair.beta_star * self.problem.hole_radius
        force = self.resultants
        return {
            "ux": self.dx + own * force["Q"] - coupling * float(cos @ self.pressure - sin @ self.shear),
            "uy": self.dy - own * force["P"] - coupling * float(sin @ self.pressure + cos @ self.shear),
        }

    def bush_fit(self, friction: float | None = None) -> BushFit:
        """The tractions between bush and plate, and whether the press fit holds the bush.

        Parameters
        ----------
        friction : float, optional
            Coefficient of friction between bush and plate; by default that of a bush that slips.

        Raises
        ------
        InputError
            If the plate has no bush, or `friction` is negative.
        """
        if self.seat is not None:
            return reading.joint.bush_fit_of_nodes(
                self.problem, self.seat.theta, self.seat.pressure, self.seat.shear, friction
            )
        return reading.joint.bush_fit(self.problem, partial(self.stress, straight=True), friction)

    def joint_displacement(
        self, hub_radius: float | None = None, gauge_radius: float | None = None
    ) -> dict[str, float]:
        """The mean displacement of a circle in the pin relative to a circle in the plate, "ux" and "uy" in m, (T29).

        It is the displacement that a gauge on the joint measures. It counts as dx and dy do. The compliance of
        the joint is the difference of this displacement between two states, divided by the difference of their forces.

        Parameters
        ----------
        hub_radius : float, optional
            Radius of the circle in the pin, m. The default is the mean over a body-loaded pin, the bore of another
            hollow pin, and R / sqrt(kappa_I + 1) in any other pin.
        gauge_radius : float, optional
            Radius of the circle in the plate, m. The default is the outer rim of a ring, also round a bush, the
            supports of a :class:`fastpin.bodies.Compliance`, and the edge of the hole in an infinite plate, whose
            displacement grows like the logarithm of the radius.

        Raises
        ------
        InputError
            If a circle lies outside its body, or the body has no such circle.
        """
        radii = [(hub_radius, gauge_radius)]
        if self.seat is not None:  # to the outer rim of the bush, and from its bore on
            radii = [(hub_radius, None), (None, gauge_radius)]
        parts = [
            reading.joint.joint_displacement(
                problem, each.grid, (each.pressure, each.shear), each.load, complex(each.dx, each.dy),
                complex(each.resultants["Q"], -each.resultants["P"]), *pair,
            )
            for each, problem, pair in zip(self._interfaces, self.problem.interfaces, radii, strict=True)
        ]  # fmt: skip
        if self.seat is not None:
            parts.append(reading.joint.counted_twice(self.problem.interfaces[1], self.resultants))
        return {name: sum(part[name] for part in parts) for name in ("ux", "uy")}


class ErrorBars(Mapping[str, float]):
    """The error bars of one state: a mapping from names to bars, and bars of the tractions. Computed when first read.

    The names and units are those of :func:`fastpin.states.error_bars.bars`.

    Attributes
    ----------
    coarse : State
        The state on the coarse grid.
    """

    coarse: State

    @property
    @abstractmethod
    def pressure(self) -> np.ndarray:
        """Error bars >= 0 of the pressure at the nodes, Pa, shape (n,); see :mod:`fastpin.states.error_bars`."""

    @property
    @abstractmethod
    def shear(self) -> np.ndarray:
        """Error bars >= 0 of the shear traction at the nodes, Pa, shape (n,)."""

    @abstractmethod
    def of_curves(self, theta: ArrayLike) -> tuple[np.ndarray, np.ndarray]:
        """Error bars >= 0 of pressure and shear traction on the curves that figures draw, Pa.

        Parameters
        ----------
        theta : array_like
            Angles, rad, of any shape. The bars have the same shape.

        Raises
        ------
        InputError
            If an angle is no finite number.
        """


_FIELDS = tuple(field.name for field in fields(State))


def state_again(state: State, step: int, dissipation: float, work: float) -> State:
    """The same state at another step, with the energies up to there. It shares the arrays and dicts."""
    content, again = state.__dict__, State.__new__(State)
    again.__dict__.update({name: content[name] for name in _FIELDS}, step=step, dissipation=dissipation, work=work)
    return again
