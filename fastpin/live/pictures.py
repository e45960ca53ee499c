"""The picture of a state: everything that the page draws of it, JSON-ready."""

from __future__ import annotations

import base64
import math
from typing import Any

import numpy as np

from fastpin.assess.outputs import ROUNDING, json_ready
from fastpin.model import LoadHistory, Points, angles
from fastpin.model.doubts import pressure_doubts
from fastpin.model.points import has_outline
from fastpin.states import LoadCycle, State
from fastpin.states.curves import one_turn, thinned, traction_patches
from fastpin.states.quantities import sizes

EVERY = 2.0
"""Degrees between two points of the curve of the hoop stress."""

LEAST_IN_CONTACT = 41
"""Points in a contact at least: a narrow one is shown as large as a wide one."""

CURVE_ERROR = 2e-4
"""Error of the straight lines in a curve of tractions, in parts of the peak pressure: a tenth of a pixel."""


def packed(values: np.ndarray, kind: str = "<f4") -> str:
    """An array as base64 of little-endian numbers: "<f4" is float32, "i1" int8."""
    return base64.b64encode(np.asarray(values).astype(kind).tobytes()).decode("ascii")


def hoop_degrees(state: State) -> np.ndarray:
    """The angles of the curve of the hoop stress, degrees from the bottom, ascending from -180 to 180, float32."""
    borders = [angles.degrees_from_bottom(angle) for ends in (*state.contact, *state.stick) for angle in ends]
    # The hoop stress has sharp peaks beside the borders.
    beside = np.add.outer(borders, (-0.4, -0.1, -0.02, 0.0, 0.02, 0.1, 0.4)).ravel()
    regular = np.linspace(-180.0, 180.0, round(360.0 / EVERY) + 1)
    narrow = [ends for ends in state.contact if math.degrees(ends[1] - ends[0]) < EVERY * LEAST_IN_CONTACT]
    inside = [np.degrees(np.linspace(*ends, LEAST_IN_CONTACT)) + 90.0 for ends in narrow]
    further = np.remainder(np.concatenate([beside, *inside]) + 180.0, 360.0) - 180.0
    return np.unique(np.concatenate([regular, further]).astype(np.float32))


def picture(state: State, serial: int, gesture: int, grid: str, history: LoadHistory) -> dict[str, Any]:
    """The picture of a state.

    Parameters
    ----------
    state : State
    serial : int
        The number of the picture in its session.
    gesture : int
        The gesture that led to the state.
    grid : str
        The name of the state's grid.
    history : LoadHistory
        The loads of the case. If they are in doubt, the pressure is not.

    Returns
    -------
    dict
        Numbers in SI units, or in the units of a dimensionless problem. Angles are in degrees from the bottom of the
        hole. The entry "seat" has zones, slip, rotation and dissipation of a bush that slips, or None. The entry
        "doubt" is a warning of a pressure above the yield strength, or "". The entry "loops" has a pair for each load:
        the load, and the displacement on which it does work. The entry "rounding" has a value for each kind of
        quantity: smaller ones are shown as 0, as in tables. The entry "curves" has the tractions as figures draw them,
        with NaN between two contact zones; "pressure" and "shear" are those of the nodes. The entry "hoop" has the part
        of the assembly, too, if something is pressed before any load, and the stress at the seat of a bush. The entry
        "outline" has the largest hoop stress along the outline of the plate, its place and its edge, or None.
    """
    curves = one_turn([thinned(points, CURVE_ERROR * state.peak_pressure) for points in traction_patches(state)]).T
    hoop = None
    if not state.problem.surfaces.plate.is_rigid:
        degrees = hoop_degrees(state)
        theta = np.radians(degrees.astype(float)) + angles.BOTTOM
        hoop = {"degrees": packed(degrees), "stress": packed(state.hoop_stress("plate", theta))}
        if state.problem.is_pressed:
            hoop["assembly"] = packed(state.assembly_stress(Points.at_depth(0.0, theta)).hoop)
        if state.problem.plate_body.bush is not None:
            hoop["seat"] = packed(state.hoop_stress("seat", theta))
    return {
        "serial": serial,
        "gesture": gesture,
        "grid": grid,
        **json_ready(_numbers(state)),
        "rounding": {kind: ROUNDING * size for kind, size in sizes(state).items()},
        "doubt": "; ".join(map(str, pressure_doubts(state.problem, history, [state.pressure]))),
        **{name: packed(getattr(state, name)) for name in ("pressure", "shear", "gap")},
        "status": packed(state.status, "i1"),
        "curves": dict(zip(("degrees", "pressure", "shear"), map(packed, curves), strict=True)),
        "hoop": hoop,
        "outline": json_ready(state.outline_peak._asdict()) if has_outline(state.problem) else None,
    }


def _numbers(state: State) -> dict[str, Any]:
    loops, seat = LoadCycle((state, state)).loops, state.seat
    of_seat = None
    if seat is not None:
        of_seat = {name: getattr(seat, name) for name in ("peak_slip", "rotation", "dissipation")}
        of_seat |= {"frictionless": seat.problem.frictionless, **_zones(seat)}
    names = ("load", "dx", "dy", "rotation", "dissipation", "peak_pressure", "peak_shear")
    places = {name: getattr(state, name) for name in ("peak_pressure_angle", "peak_shear_angle")}
    return {
        **{name: getattr(state, name) for name in names},
        **{name: math.nan if math.isnan(angle) else angles.from_bottom(angle) for name, angle in places.items()},
        "moment": state.resultants["M"],
        **_zones(state),
        "seat": of_seat,
        "residual": max(state.residuals.values()),
        "loops": {name: (float(loop.load[0]), float(loop.displacement[0])) for name, loop in loops.items()},
    }


def _zones(state: State) -> dict[str, Any]:
    """The zones of a state, in degrees from the bottom."""
    return {
        "contact": [angles.interval_from_bottom(*ends) for ends in state.contact],
        "stick": [angles.interval_from_bottom(*ends) for ends in state.stick],
        "slip": [(*angles.interval_from_bottom(start, stop), sign) for start, stop, sign in state.slip_zones],
    }
