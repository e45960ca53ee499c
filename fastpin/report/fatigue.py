"""Fatigue of points as a curve."""

from __future__ import annotations

import numpy as np

from fastpin.damage import Fatigue, SpectrumDamage
from fastpin.model.angles import from_bottom
from fastpin.model.units import units
from fastpin.report.curves import Curve


def spectrum_curve(damage: SpectrumDamage) -> Curve:
    """Return angle, depth, damage, plane and life of the points, in the order of the angles, as :func:`fatigue_curve`.

    The damage is that of one spectrum, and the life counts spectra.
    """
    columns = {f"damage by {damage.criterion}": damage.damage, "plane [deg]": np.degrees(damage.plane)}
    return _by_angle(damage, columns | {"life [spectra]": damage.life})


def fatigue_curve(found: Fatigue) -> Curve:
    """Return angle, depth, parameter, plane and life of the points, in the order of the angles.

    Angles are in degrees from the bottom of the hole, the planes' normals in degrees from the +x axis.
    """
    columns = {f"{found.criterion} [{found.unit}]": found.parameter}
    if found.plane is not None:
        columns["plane [deg]"] = np.degrees(found.plane)
    if found.life is not None:
        columns["life [cycles]"] = found.life
    return _by_angle(found, columns)


def _by_angle(found: Fatigue | SpectrumDamage, columns: dict[str, np.ndarray]) -> Curve:
    """Return columns of points with their angles and depths, in the order of the angles."""
    angles = np.array([from_bottom(angle) for angle in found.theta.ravel().tolist()])
    places = {"angle [deg]": angles, f"depth [{units(found.problem)['length'].name}]": found.depth}
    order = np.argsort(angles, kind="stable")
    return Curve({"body": found.body}, {name: np.ravel(each)[order] for name, each in (places | columns).items()})
