"""Envelopes of strength from sweeps: the bearing stress against the bypass stress at which the first ply fails."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence

import numpy as np

from fastpin.assess.outputs import Curve
from fastpin.assess.strength import strength_words
from fastpin.errors import InputError
from fastpin.model.case import Case
from fastpin.model.loads import LOADS
from fastpin.model.strength import StrengthAssessment
from fastpin.report.sweep import TableRow, printed_rows, value_words
from fastpin.studies.plan import Plan

BYPASS, BEARING = "bypass stress [Pa]", "bearing stress [Pa]"
"""Columns of an envelope."""


def envelopes(plan: Plan, rows: Sequence[TableRow], value: str) -> list[Curve]:
    """Return the envelopes of a sweep: one for each combination of the fields that are no loads; none without a factor.

    The loads at the last corner are multiplied by the factor at failure. The bearing stress is the force on the pin
    over the diameter of the hole, per thickness. The bypass stress is the remote stress in the direction of this
    force, or along the y axis without a force. The points stand by the angle between both.

    Parameters
    ----------
    plan : Plan
    rows : sequence of dict
        From :func:`fastpin.studies.sweep.rows`.
    value : str
        An outcome ``{ strength = "factor" }`` of the plan.

    Raises
    ------
    InputError
        If the outcome is another one.
    """
    check_envelope(plan, value)
    printed, unit = printed_rows(plan, rows)
    varied = [name for name in plan.fields if len({json.dumps(row[name]) for row in rows}) > 1]
    others = {
        name: value_words(plan, printed, name, unit) for name in varied if name.split(".")[0] not in ("load", "loads")
    }
    found: dict[str, list[tuple[float, float]]] = {}
    for point, row in zip(plan.points, rows, strict=True):
        if row.get(value) is not None:
            words = ", ".join(words_of(row[name]) for name, words_of in others.items())
            found.setdefault(words, []).append(_stresses(plan.case(point), row[value]))
    how = StrengthAssessment(**json.loads(plan.outcomes[value].definition)["how"])
    fixed = {"criterion": strength_words(plan.case(plan.points[0]).problem, how)}
    curves = []
    for words, points in found.items():
        bypass, bearing = np.array(sorted(points, key=lambda point: math.atan2(*point))).T
        curves.append(Curve(fixed | ({"case": words} if words else {}), {BYPASS: bypass, BEARING: bearing}))
    return curves


def check_envelope(plan: Plan, value: str) -> None:
    """Raise :class:`InputError` if an outcome of a plan is no factor at failure."""
    outcome = plan.outcomes.get(value)
    if outcome is None or json.loads(outcome.definition).get("strength") != "factor":
        raise InputError("value", f'must be an outcome {{ strength = "factor" }} for an envelope, not "{value}"')


def _stresses(case: Case, factor: float) -> tuple[float, float]:
    """Bypass and bearing stress at failure, Pa."""
    load = dict(zip(LOADS, case.history.values()[-1].tolist(), strict=True))
    force = np.array([load["Q"], -load["P"]])
    size = float(np.hypot(*force))
    along = force / size if size else np.array([0.0, -1.0])
    remote = np.array([[load["sxx"], load["sxy"]], [load["sxy"], load["syy"]]])
    return factor * float(along @ remote @ along), factor * size / (2.0 * case.problem.hole_radius)
