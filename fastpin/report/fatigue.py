"""Fatigue of points as a curve, and the margins of safety of fatigue and of a crack."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fastpin import cracks
from fastpin.cracks.margins import crack_margins
from fastpin.damage import Fatigue, SpectrumDamage
from fastpin.damage.margins import last_cycle_margins, reserve_margins, strength_margins
from fastpin.model.angles import from_bottom
from fastpin.model.problem import Problem
from fastpin.model.units import units
from fastpin.report.assessment import Assessed
from fastpin.report.curves import Curve
from fastpin.report.strength import StrengthFound
from fastpin.states.cycles import Cycle
from fastpin.states.margins import Margin
from fastpin.states.state import State


def spectrum_curve(damage: SpectrumDamage) -> Curve:
    """Return angle, depth, damage, plane and life of the points, in the order of the angles, as :func:`fatigue_curve`.

    The damage is that of one spectrum, and the life counts spectra.
    """
    angles = np.array([from_bottom(angle) for angle in damage.theta.ravel().tolist()])
    columns = {
        "angle [deg]": angles,
        f"depth [{units(damage.problem)['length'].name}]": damage.depth,
        f"damage by {damage.criterion}": damage.damage,
        "plane [deg]": np.degrees(damage.plane),
        "life [spectra]": damage.life,
    }
    order = np.argsort(angles, kind="stable")
    return Curve({"body": damage.body}, {name: np.ravel(values)[order] for name, values in columns.items()})


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


def life_margins(
    problem: Problem,
    states: Sequence[State],
    cycles: Sequence[Cycle],
    assessed: Assessed | None,
    grown: cracks.Growth | None,
    strength: StrengthFound | None = None,
) -> list[Margin]:
    """Return the margins of the last cycle and of the sections [fatigue], [crack] and [strength].

    `states` hold the last cycle.
    """
    rows = last_cycle_margins(problem, states, cycles)
    rows += [] if assessed is None else reserve_margins(assessed.reserves, assessed.how)
    rows += [] if grown is None else crack_margins(grown)
    return rows + ([] if strength is None else strength_margins(*strength.worst))
