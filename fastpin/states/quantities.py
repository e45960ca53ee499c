"""The reported quantities of a state: names, kinds, sizes, and the comparison of two grids."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from types import MappingProxyType
from typing import NamedTuple

import numpy as np

from fastpin.model.angles import angle_between, degrees_from_bottom, from_bottom
from fastpin.model.points import Body, elastic_bodies, has_outline
from fastpin.model.problem import Problem
from fastpin.reading.zones import Interval, is_all_round
from fastpin.states.regimes import REGIMES
from fastpin.states.state import State


class Quantity(NamedTuple):
    """A reported number of a state.

    Attributes
    ----------
    label : str
        Its name in tables and figures.
    kind : str
        A key of :func:`fastpin.model.units.units`, "angle" (a place on the hole, rad), "width" (rad) or "class".
    of : callable
        Gives its value for a state, in SI units or in the units of a dimensionless problem; NaN if there is none.
    words : str
        Its meaning, for reports.
    classes : dict of int to str
        Of the kind "class": the words of each value.
    edge : {"plate", "seat"} or None
        Of a number of the largest hoop stress: the edge.
    is_part : bool
        Whether it is a part of another quantity, at the place of that. It has no extremes of its own.
    exists : callable
        Tells whether the states of a problem have it. See :func:`only_where`.
    """

    label: str
    kind: str
    of: Callable[[State], float]
    words: str = ""
    classes: Mapping[int, str] = MappingProxyType({})
    edge: Body | None = None
    is_part: bool = False
    exists: Callable[[Problem], bool] = lambda problem: True

    def is_resolved(self, state: State) -> bool:
        """Whether the nodes resolve its value in a state, if there is one, see :class:`fastpin.reading.HoopPeak`."""
        return self.edge is None or math.isnan(self.of(state)) or state.peak_hoop_stress(self.edge).resolved

    def shown(self, state: State) -> float | str:
        """The value for tables of other programs: a class in words."""
        value = self.of(state)
        return self.classes[int(value)] if self.classes else value


def width(intervals: Sequence[Interval]) -> float:
    """Total length of all intervals, rad."""
    return float(sum(stop - start for start, stop in intervals))


def _integral(state: State, traction: np.ndarray) -> float:
    """Integral of a nodal traction round the hole, N/m.

    The integral of a magnitude has an error of O(h^2) where the sign of the traction changes.
    """
    return state.problem.hole_radius * float(state.grid.weights @ traction)


def only_where(exists: Callable[[Problem], bool], quantity: Quantity) -> Quantity:
    """A quantity that the states of some problems have; NaN in all others."""
    return quantity._replace(of=lambda state: quantity.of(state) if exists(state.problem) else math.nan, exists=exists)


def _hoop(label: str, kind: str, name: str, words: str, edge: Body = "plate", is_part: bool = False) -> Quantity:
    """A number of the largest hoop stress on an edge of an elastic body, by its name there.

    The parts of assembly and loads exist where something is pressed.
    """
    return only_where(
        lambda problem: edge in elastic_bodies(problem) and (problem.is_pressed or not is_part),
        Quantity(
            label, kind, lambda state: float(getattr(state.peak_hoop_stress(edge), name)), words, edge=edge,
            is_part=is_part,
        ),
    )  # fmt: skip


def of_bush(label: str, kind: str, name: str, words: str = "") -> Quantity:
    """A reading of the interface between bush and plate, by its name there. The margin of slip is that of a seat."""
    return only_where(
        lambda problem: (problem.seat if name == "slip_margin" else problem.plate_body.bush) is not None,
        Quantity(label, kind, lambda state: float(getattr(state.bush_fit(), name)), words),
    )


QUANTITIES: dict[str, Quantity] = {
    "peak_pressure": Quantity("peak N", "traction", lambda state: state.peak_pressure, "largest contact pressure N"),
    "peak_pressure_angle": Quantity("peak N at", "angle", lambda state: state.peak_pressure_angle, "its place"),
    "peak_shear": Quantity(
        "peak T", "traction", lambda state: state.peak_shear, "largest shear traction T, with its sign"
    ),
    "peak_shear_angle": Quantity("peak T at", "angle", lambda state: state.peak_shear_angle, "its place"),
    "contact_width": Quantity("contact width", "width", lambda state: width(state.contact), "width of the contact"),
    "stick_width": Quantity("stick width", "width", lambda state: width(state.stick), "width of the stick zones"),
    "rotation": Quantity(
        "rotation", "rotation", lambda state: state.rotation, "rotation of the pin, counter-clockwise"
    ),
    "dx": Quantity("dx", "displacement", lambda state: state.dx, "motion of the pin to the right"),
    "dy": Quantity("dy", "displacement", lambda state: state.dy, "motion of the pin upwards"),
    "P": Quantity("P", "force", lambda state: state.resultants["P"], "force of the tractions on the pin, P"),
    "Q": Quantity("Q", "force", lambda state: state.resultants["Q"], "force of the tractions on the pin, Q"),
    "M": Quantity("M", "moment", lambda state: state.resultants["M"], "moment of the tractions on the pin, M"),
    "pressure_integral": Quantity(
        "int N", "force", lambda state: _integral(state, state.pressure), "integral of N round the hole"
    ),
    "shear_integral": Quantity(
        "int T", "force", lambda state: _integral(state, state.shear), "integral of T round the hole"
    ),
    "shear_magnitude": Quantity(
        "int |T|", "force", lambda state: _integral(state, np.abs(state.shear)), "integral of |T| round the hole"
    ),
    "dissipation": Quantity("dissipated", "energy", lambda state: state.dissipation, "energy dissipated so far"),
    "work": Quantity("work", "energy", lambda state: state.work, "work of the loads so far"),
    "peak_hoop": _hoop("peak hoop", "traction", "value", "largest hoop stress round the hole"),
    "peak_hoop_angle": _hoop("peak hoop at", "angle", "angle", "its place"),
    "peak_hoop_assembly": _hoop("of the assembly", "traction", "assembly", "its part before any load", is_part=True),
    "peak_hoop_loads": _hoop("of the loads", "traction", "loads", "its part of the loads", is_part=True),
    "kt_gross": _hoop("Kt gross", "ratio", "kt_gross", "ratio of the loads' part to the remote stress, Kt gross"),
    "kt_bearing": _hoop(
        "Kt bearing", "ratio", "kt_bearing", "ratio of the loads' part to the bearing stress, Kt bearing"
    ),
    "kt_net": _hoop("Kt net", "ratio", "kt_net", "ratio of the loads' part to the net-section stress, Kt net"),
    "peak_hoop_seat": _hoop(
        "peak hoop seat", "traction", "value", "largest hoop stress of the plate at the seat of the bush", "seat"
    ),
    "peak_hoop_seat_angle": _hoop("peak hoop seat at", "angle", "angle", "its place", "seat"),
    "peak_hoop_seat_assembly": _hoop(
        "seat, of the assembly", "traction", "assembly", "its part before any load", "seat", True
    ),
    "peak_hoop_seat_loads": _hoop("seat, of the loads", "traction", "loads", "its part of the loads", "seat", True),
    "peak_hoop_outline": only_where(
        has_outline,
        Quantity(
            "peak hoop outline",
            "traction",
            lambda state: state.outline_peak.value,
            "largest hoop stress along the outline and the further holes of the plate",
        ),
    ),
    "joint_ux": Quantity(
        "joint ux",
        "displacement",
        lambda state: state.joint_displacement()["ux"],
        "displacement of the joint to the right",
    ),
    "joint_uy": Quantity(
        "joint uy", "displacement", lambda state: state.joint_displacement()["uy"], "displacement of the joint upwards"
    ),
    "bush_open_margin": of_bush("bush open margin", "traction", "open_margin", "least pressure between bush and plate"),
    "bush_slip_margin": of_bush(
        "bush slip margin",
        "traction",
        "slip_margin",
        "least pressure between bush and plate, minus shear over friction",
    ),
    "regime": Quantity("regime", "class", lambda state: float(state.regime), "regime of the contact", REGIMES),
}
"""The quantities of every state, by name. P, Q, M are the resultants of the tractions; integrals are over R dtheta.

"peak_hoop" is the largest hoop stress round the hole, with a bush in the bore of the bush. "peak_hoop_assembly" is the
part that press fits leave before any load, and "peak_hoop_loads" the rest; both are NaN where nothing is pressed.
"kt_gross", "kt_bearing" and "kt_net" are the ratios of the largest stress of the loads to the remote stress, the
bearing stress and the net-section stress, see :class:`fastpin.reading.HoopPeak`. "peak_hoop_seat" is the largest hoop
stress of the plate round a bush, at the seat of the bush, with the same parts, NaN without a bush. All are NaN for a
rigid body.
"peak_hoop_outline" is :attr:`State.outline_peak`, NaN for a plate without an outline.
"joint_ux" and "joint_uy" are :meth:`State.joint_displacement`. "bush_open_margin" and "bush_slip_margin" are those of
:class:`fastpin.reading.BushFit`, NaN without a bush, and without its friction. "regime" is a number of
:class:`fastpin.states.Regime`, :attr:`State.regime`.

A state also has the ends of its contact and stick intervals: "contact_1_start", "contact_1_stop", "contact_2_start",
"stick_1_start" and so on. They are angles in rad, counted along +theta, in the order of :attr:`State.contact` and
:attr:`State.stick`. A contact all round has no ends.
"""

ZONES = ("contact", "stick")
"""Zones whose ends are quantities."""


def quantity(name: str) -> Quantity:
    """The quantity of a name in :data:`QUANTITIES`, or of the end of an interval such as "contact_1_start".

    The name is not checked. Reading an end from a state without that interval raises KeyError.
    """
    if name in QUANTITIES:
        return QUANTITIES[name]
    zone = name.partition("_")[0]
    return Quantity(name.replace("_", " "), "angle", lambda state: dict(_ends(zone, intervals(state, zone)))[name])


def intervals(state: State, zone: str) -> list[Interval]:
    """The intervals of the zone "contact" or "stick", rad; none for a zone round the whole hole, which has no ends."""
    zones: list[Interval] = getattr(state, zone)
    return [] if zones and is_all_round(width(zones)) else zones


def values(state: State) -> dict[str, float]:
    """All quantities of a state by name, without classes, which have no error bars and no order.

    Angles are in rad; the angle of a peak that does not exist is NaN.
    """
    numbers = {name: entry.of(state) for name, entry in QUANTITIES.items() if not entry.classes}
    for zone in ZONES:
        numbers |= _ends(zone, intervals(state, zone))
    return numbers


def matching_values(state: State, other: State) -> dict[str, float]:
    """The quantities of `other`, the same load on another grid, in a form to compare with `state`.

    An angle is moved by whole turns next to the angle of `state`. The peak shear may be at one of two places with
    opposite signs. It is compared in magnitude: it gets the sign that it has in `state`. NaN stands for a value that
    can't be compared: the angle of such a peak, and the ends of zones whose number differs.

    Returns
    -------
    dict of str to float
        Values by the names of the quantities of `state`, in the units of :func:`values`.
    """
    mine, theirs = values(state), values(other)
    if mine["peak_shear"] * theirs["peak_shear"] < 0.0:
        theirs |= {"peak_shear": -theirs["peak_shear"], "peak_shear_angle": math.nan}
    for zone in ZONES:
        theirs |= _ends(zone, _match_intervals(intervals(state, zone), intervals(other, zone)))
    for name, angle in mine.items():
        if quantity(name).kind == "angle":
            is_known = math.isfinite(angle) and math.isfinite(theirs[name])
            theirs[name] = angle + math.remainder(theirs[name] - angle, 2.0 * math.pi) if is_known else math.nan
    return {name: theirs[name] for name in mine}


def size(name: str, state: State) -> float:
    """The natural size of a quantity, in its unit. A much smaller value is zero.

    Without contact all sizes are 0 except the sizes of the pin's motion.
    """
    return sizes(state)[quantity(name).kind]


def sizes(state: State) -> dict[str, float]:
    """The natural size of each kind of quantity."""
    problem, pressure = state.problem, state.peak_pressure
    force = QUANTITIES["pressure_integral"].of(state)
    strain = problem.surfaces.beta_star * pressure or max(map(abs, problem.clearances)) / problem.hole_radius
    return {
        "traction": pressure,
        "angle": width(state.contact),
        "width": width(state.contact),
        "rotation": strain,
        "displacement": problem.hole_radius * strain,
        "force": force,
        "moment": problem.hole_radius * force,
        "energy": problem.hole_radius * strain * force,
        "ratio": 1.0,
        "class": 1.0,
    }


def _ends(zone: str, found: Sequence[Interval]) -> Iterator[tuple[str, float]]:
    for number, (start, stop) in enumerate(found, start=1):
        yield f"{zone}_{number}_start", start
        yield f"{zone}_{number}_stop", stop


def _match_intervals(mine: Sequence[Interval], theirs: Sequence[Interval]) -> list[Interval]:
    """Reorder `theirs` to match `mine` around the circle. Return NaN intervals if the numbers differ."""
    if len(mine) != len(theirs):
        return [(math.nan, math.nan)] * len(mine)

    def away(turned: Sequence[Interval]) -> float:
        ends = np.subtract(turned, mine)
        return float(np.abs(angle_between(ends, 0.0)).sum())

    return min(([*theirs[k:], *theirs[:k]] for k in range(len(theirs))), key=away, default=[])


def in_degrees(name: str, value: float) -> float:
    """Convert a value for reports: angles (from the bottom of the hole) and widths in degrees, others unchanged.

    The angle of a peak lies in (-180, 180]. The ends of an interval across the top may lie beyond.
    """
    kind = quantity(name).kind
    if kind == "angle":
        in_turn = from_bottom if name in QUANTITIES else degrees_from_bottom
        return in_turn(value) if math.isfinite(value) else math.nan
    return math.degrees(value) if kind == "width" else value


def bar_in_degrees(name: str, bar: float) -> float:
    """Convert an error bar for reports: bars of angles and widths in degrees, others unchanged."""
    return math.degrees(bar) if quantity(name).kind in ("angle", "width") else bar


def load_point(state: State) -> float:
    """The place of a state in the history: step + fraction, 1 at the first corner, 1.5 halfway to the second one."""
    return state.step + state.fraction


def point_name(point: float) -> str:
    """A load point as text, with at most three decimals."""
    return f"{point:.3f}".rstrip("0").rstrip(".")
