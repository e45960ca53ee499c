"""The quantities that are reported of a state: names, kinds and sizes, and how those of two grids are compared."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from typing import NamedTuple

import numpy as np

from fastpin.model.angles import angle_between, from_bottom
from fastpin.states.state import State
from fastpin.states.zones import Interval


class Quantity(NamedTuple):
    """A number that a state has.

    Attributes
    ----------
    label : str
        What tables and figures call it.
    kind : str
        A key of :func:`fastpin.report.units`, "angle" (a place on the hole, rad) or "width" (rad).
    of : callable
        Its value for a state, SI or in the units of a dimensionless problem.
    """

    label: str
    kind: str
    of: Callable[[State], float]


def width(intervals: Sequence[Interval]) -> float:
    """Length of all intervals together, rad."""
    return float(sum(stop - start for start, stop in intervals))


def _integral(state: State, traction: np.ndarray) -> float:
    """Integral of a nodal traction round the hole, N/m; that of a magnitude is off where the sign changes, O(h^2)."""
    return state.problem.hole_radius * float(state.grid.weights @ traction)


QUANTITIES: dict[str, Quantity] = {
    "peak_pressure": Quantity("peak N", "traction", lambda state: state.peak_pressure),
    "peak_pressure_angle": Quantity("peak N at", "angle", lambda state: state.peak_pressure_angle),
    "peak_shear": Quantity("peak T", "traction", lambda state: state.peak_shear),
    "peak_shear_angle": Quantity("peak T at", "angle", lambda state: state.peak_shear_angle),
    "contact_width": Quantity("contact width", "width", lambda state: width(state.contact)),
    "stick_width": Quantity("stick width", "width", lambda state: width(state.stick)),
    "rotation": Quantity("rotation", "rotation", lambda state: state.rotation),
    "dx": Quantity("dx", "displacement", lambda state: state.dx),
    "dy": Quantity("dy", "displacement", lambda state: state.dy),
    "P": Quantity("P", "force", lambda state: state.resultants["P"]),
    "Q": Quantity("Q", "force", lambda state: state.resultants["Q"]),
    "M": Quantity("M", "moment", lambda state: state.resultants["M"]),
    "pressure_integral": Quantity("int N", "force", lambda state: _integral(state, state.pressure)),
    "shear_integral": Quantity("int T", "force", lambda state: _integral(state, state.shear)),
    "shear_magnitude": Quantity("int |T|", "force", lambda state: _integral(state, np.abs(state.shear))),
    "dissipation": Quantity("dissipated", "energy", lambda state: state.dissipation),
    "work": Quantity("work", "energy", lambda state: state.work),
}
"""What every state has, by name. P, Q, M are the resultants of the tractions; integrals are over R dtheta.

To these come the ends of the intervals of contact and stick: "contact_1_start", "contact_1_stop", "contact_2_start",
"stick_1_start" and so on, angles in rad, counted along +theta. A contact all round has none.
"""

ZONES = ("contact", "stick")


def quantity(name: str) -> Quantity:
    """The quantity of a name, also that of an end of an interval."""
    if name in QUANTITIES:
        return QUANTITIES[name]
    zone = name.partition("_")[0]
    return Quantity(name.replace("_", " "), "angle", lambda state: dict(_ends(zone, intervals(state, zone)))[name])


def intervals(state: State, zone: str) -> list[Interval]:
    """The intervals of "contact" or "stick" that have ends."""
    found: list[Interval] = getattr(state, zone)
    return [] if found and width(found) >= 2.0 * math.pi - 1e-9 else found


def values(state: State) -> dict[str, float]:
    """All quantities that a state has; angles in rad, NaN where there is none (of a peak without contact)."""
    found = {name: each.of(state) for name, each in QUANTITIES.items()}
    for zone in ZONES:
        found |= _ends(zone, intervals(state, zone))
    return found


def matching_values(state: State, other: State) -> dict[str, float]:
    """The quantities of `state` as `other` has them, which is the same load on another grid.

    Angles are those next to the ones of `state`, whole turns apart. The peak shear, which may be at one of two places
    of opposite signs, is compared in magnitude, with the sign that it has in `state`. NaN stands for what can't be
    compared: the angle of such a peak, the ends of zones that are not as many.
    """
    mine, theirs = values(state), values(other)
    if mine["peak_shear"] * theirs["peak_shear"] < 0.0:
        theirs |= {"peak_shear": -theirs["peak_shear"], "peak_shear_angle": math.nan}
    for zone in ZONES:
        theirs |= _ends(zone, _match_intervals(intervals(state, zone), intervals(other, zone)))
    return {
        name: _beside(value, theirs[name]) if quantity(name).kind == "angle" else theirs[name]
        for name, value in mine.items()
    }


def size(name: str, state: State) -> float:
    """The natural size of a quantity: what is much smaller is zero. Without contact, 0 but for the pin's motion."""
    problem, pressure = state.problem, state.peak_pressure
    force = QUANTITIES["pressure_integral"].of(state)
    strain = problem.pair.beta_star * pressure or abs(problem.clearance) / problem.hole_radius
    return {
        "traction": pressure,
        "angle": width(state.contact),
        "width": width(state.contact),
        "rotation": strain,
        "displacement": problem.hole_radius * strain,
        "force": force,
        "moment": problem.hole_radius * force,
        "energy": problem.hole_radius * strain * force,
    }[quantity(name).kind]


def _ends(zone: str, found: Sequence[Interval]) -> Iterator[tuple[str, float]]:
    for number, (start, stop) in enumerate(found, start=1):
        yield f"{zone}_{number}_start", start
        yield f"{zone}_{number}_stop", stop


def _beside(angle: float, other: float) -> float:
    """`other`, whole turns from where it is, next to `angle`."""
    if not (math.isfinite(angle) and math.isfinite(other)):
        return math.nan
    return angle + math.remainder(other - angle, 2.0 * math.pi)


def _match_intervals(mine: Sequence[Interval], theirs: Sequence[Interval]) -> list[Interval]:
    """Their intervals in the order of mine, which may begin elsewhere on a circle; NaN where they are not as many."""
    if len(mine) != len(theirs):
        return [(math.nan, math.nan)] * len(mine)

    def away(turned: Sequence[Interval]) -> float:
        ends = np.subtract(turned, mine)
        return float(np.abs(angle_between(ends, 0.0)).sum())

    return min(([*theirs[k:], *theirs[:k]] for k in range(len(theirs))), key=away, default=[])


def in_degrees(name: str, value: float) -> float:
    """A quantity as it is reported: angles from the bottom of the hole and widths in degrees, all else as it is."""
    kind = quantity(name).kind
    if kind == "angle":
        return from_bottom(value) if math.isfinite(value) else math.nan
    return math.degrees(value) if kind == "width" else value


def bar_in_degrees(name: str, bar: float) -> float:
    """The error bar of a quantity as it is reported."""
    return math.degrees(bar) if quantity(name).kind in ("angle", "width") else bar


def load_point(state: State) -> float:
    """Where in the history a state is: 1 at the first corner, 1.5 halfway from there to the second."""
    return state.step + state.fraction
