"""Fatigue of points as a curve, and its margins of safety over the last cycle."""

from __future__ import annotations

import contextlib
import math
from collections.abc import Sequence

import numpy as np

from fastpin.damage import Fatigue, SpectrumDamage, cycle_states
from fastpin.damage import fatigue as fatigue_of
from fastpin.errors import InputError
from fastpin.model.angles import from_bottom
from fastpin.model.points import isotropic_bodies, owner_of
from fastpin.model.problem import Problem
from fastpin.model.units import units
from fastpin.report.case import edge_body
from fastpin.report.curves import Curve
from fastpin.report.cycle import MOST_STOPS
from fastpin.report.margins import Margin
from fastpin.states.cycles import Cycle
from fastpin.states.state import State


def spectrum_curve(found: SpectrumDamage) -> Curve:
    """Return angle, depth, damage, plane and life of the points, in the order of the angles, as :func:`fatigue_curve`.

    The damage is that of one spectrum, and the life counts spectra.
    """
    angles = np.array([from_bottom(angle) for angle in found.theta.ravel().tolist()])
    columns = {
        "angle [deg]": angles,
        f"depth [{units(found.problem)['length'].name}]": found.depth,
        f"damage by {found.criterion}": found.damage,
        "plane [deg]": np.degrees(found.plane),
        "life [spectra]": found.life,
    }
    order = np.argsort(angles, kind="stable")
    return Curve({"body": found.body}, {name: np.ravel(values)[order] for name, values in columns.items()})


def fatigue_curve(found: Fatigue) -> Curve:
    """Return angle, depth, parameter, plane and life of the points, in the order of the angles.

    Angles are in degrees from the bottom of the hole, the planes' normals in degrees from the +x axis.
    """
    length = units(found.problem)["length"].name
    angles = np.array([from_bottom(angle) for angle in found.theta.ravel().tolist()])
    columns = {
        "angle [deg]": angles,
        f"depth [{length}]": found.depth,
        f"{found.criterion} [{found.unit}]": found.parameter,
    }
    if found.plane is not None:
        columns["plane [deg]"] = np.degrees(found.plane)
    if found.life is not None:
        columns["life [cycles]"] = found.life
    order = np.argsort(angles, kind="stable")
    return Curve({"body": found.body}, {name: np.ravel(values)[order] for name, values in columns.items()})


def fatigue_margins(problem: Problem, known: Sequence[Fatigue] | str, states: Sequence[State]) -> list[Margin]:
    """Return the margins of fatigue over the last cycle, with a row for each elastic edge of a hole.

    Parameters
    ----------
    problem : Problem
    known : sequence of Fatigue or str
        Smith, Watson and Topper's parameter over the last cycle; or why it is not known.
    states : sequence of State
        The states of the last cycle.
    """
    rows = []
    for body in (body for body in isotropic_bodies(problem) if body != "pin"):
        subject = f"last cycle only: {edge_body(problem, body)}, fatigue"
        limited = None
        if states and not isinstance(known, str):
            with contextlib.suppress(InputError):  # its limit follows from the bending and the torsion limit
                limited = fatigue_of(states, "findley", body)
        one = next((one for one in known if not isinstance(one, str) and one.body == body), None)
        if limited is not None:
            place = "" if math.isnan(limited.hot_spot.theta) else f"at {from_bottom(limited.hot_spot.theta):z.1f} deg"
            limit = math.nan if limited.limit is None else float(limited.limit)
            value = limited.hot_spot.parameter
            rows.append(Margin(f"{subject}, Findley", "traction", value, limit, remark=place))
        elif one is None:
            why = known.rstrip(".") if isinstance(known, str) else "no constants of fatigue given"
            rows.append(Margin(subject, remark=f"not known: {why[0].lower()}{why[1:]}"))
        else:
            remark = f"not known: no bending_limit and torsion_limit of the {owner_of(problem, body)} given"
            life = one.hot_spot.life
            if not math.isnan(life):
                remark += f"; life {life:.3g} cycles" if math.isfinite(life) else "; infinite life"
            kind = "stress times strain"
            rows.append(Margin(f"{subject}, Smith-Watson-Topper", kind, one.hot_spot.parameter, remark=remark))
    return rows


def last_cycle_margins(problem: Problem, states: Sequence[State], cycles: Sequence[Cycle]) -> list[Margin]:
    """Return the margins of fatigue over the last of the cycles that are known; none if finding them takes long."""
    try:
        stops = cycle_states(states, cycles[-1]) if cycles else []
    except InputError:  # a corner of the cycle was not kept
        return []
    rows = fatigue_margins(problem, [], stops) if len(stops) <= MOST_STOPS else []
    return [row for row in rows if not math.isnan(row.margin)]
