"""Friction, rig stiffness, clearance and offsets from a measured loop of a displacement and its force."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from fastpin.errors import InputError
from fastpin.model import LoadHistory, Problem, checks
from fastpin.model.acting import check_loads
from fastpin.model.grid import MAX_NODES
from fastpin.model.loads import LOADS, Corner
from fastpin.solver.task import as_history
from fastpin.studies.loop_fit import LEAST, MOVED, IdentifyProgress, LoopFit, LoopModel, Start
from fastpin.studies.measured_loop import REACTIONS, MeasuredLoop, measured_loop

FITTED = ("stiffness", "clearance", "drift", "scale")
"""What may be fitted beside friction and offsets."""

HELD = 0.02
"""Most change of a load that is constant during the loop, in parts of itself."""

TELLING, UNEXPLAINED, TIED = 5.0, 1.5, 0.98
"""Largest ratio of the ends of an interval that tells a value: loops of pins that stick may have an end by chance.
Scatter beyond the noise, and a correlation, that a sentence names."""


class FittedValue(NamedTuple):
    """An identified value and its interval of 95 %.

    Attributes
    ----------
    value, low, high : float
        The value is NaN where the loop does not tell it; an end that it does not tell is infinite.
    """

    value: float
    low: float
    high: float


@dataclass(frozen=True, eq=False, repr=False)
class Identified:
    """What a measured loop tells.

    Attributes
    ----------
    problem : Problem
        The problem with what was identified: friction, the stiffness of the rig, clearance.
    names : (str, str)
        The measured loads: "ux", "uy" or "rotation", and its reaction.
    estimates : dict of str to FittedValue
        "friction", or "friction 1" and so on of each cycle; "stiffness" of the rig, N/m^2 or N/rad;
        "displacement_offset" and "force_offset", the readings where the model has 0 at the first sample; as asked
        "clearance", "displacement_drift" and "force_drift" from the first to the last sample, and "scale" of the force.
        Forces are per thickness.
    correlations : dict of (str, str) to float
        Of the errors of each two of them.
    scatter : float
        Root mean square distance of the samples from the computed loop, in standard deviations of the noise.
    loop : MeasuredLoop
    computed : (ndarray, ndarray), shape (n,)
        Displacement and force of the computed loop beside each sample, with offsets, drift and scale.
    energies : ndarray, shape (cycles, 3)
        Area of each whole cycle, J/m: measured, its standard deviation by the noise, and computed.
    notes : tuple of str
        What the loop does not tell, and doubts.
    solved : int
        Number of histories that were solved.
    """

    problem: Problem
    names: tuple[str, str]
    estimates: dict[str, FittedValue]
    correlations: dict[tuple[str, str], float]
    scatter: float
    loop: MeasuredLoop
    computed: tuple[np.ndarray, np.ndarray]
    energies: np.ndarray
    notes: tuple[str, ...]
    solved: int

    def __repr__(self) -> str:
        found = ", ".join(f"{name} {each.value:.4g}" for name, each in self.estimates.items())
        return f"<Identified: {found}>"

    @property
    def frictions(self) -> list[FittedValue]:
        """The friction, or that of each cycle."""
        return [each for name, each in self.estimates.items() if name.startswith("friction")]


def identify(
    problem: Problem,
    history: LoadHistory | Sequence[Corner],
    loop: Mapping[str, Any],
    fit: Sequence[str] = ("stiffness",),
    *,
    by_cycle: bool = False,
    start: Start = "rest",
    nodes: int = 41,
    progress: IdentifyProgress | None = None,
) -> Identified:
    """Fit friction, rig and offsets to a measured loop of a displacement and its force.

    Parameters
    ----------
    problem : Problem
        The joint of the test; the values of what is fitted are the first guess. Its ``drive``, or a held rotation, fits
        the measured displacement.
    history : LoadHistory or sequence of dicts
        The other loads. They are constant during the loop.
    loop : mapping of str to array_like, shape (n,)
        The samples, equally spaced in time: "ux" and "Q", "uy" and "P", or "rotation" and "M". In SI units and per
        thickness, as in a history.
    fit : sequence of str
        What is fitted beside friction and offsets, of :data:`FITTED`. "stiffness" is a spring in series, the rig.
        "drift" is a change of both offsets, linear in time. "scale" is that of the force.
    by_cycle : bool
        Whether each cycle, of two branches, has a friction of its own.
    start : {"rest", "cycle"}
        "rest": the record begins when the other loads act and the displacement is 0. "cycle": it begins in a steady
        cycle.
    nodes : int
        Number of nodes, 5 to 20,000, of the first fit. It is refined.
    progress : callable, optional
        Called as ``progress(done, about_all)`` after each solution.

    Raises
    ------
    InputError
        If an argument can't be used. The error names it.
    SolveError
        If the first guess has no state under these loads.
    """
    checks.instance("problem", problem, Problem, "a Problem")
    wanted = checks.items("fit", fit, "a list of names")
    for name in wanted:
        checks.known_name("fit", name, FITTED)
    checks.true_or_false("by_cycle", by_cycle)
    checks.choice("start", start, ("rest", "cycle"))
    checks.whole_number("nodes", nodes, 5, MAX_NODES)
    checks.check_callable("progress", progress)
    names = _measured(problem, loop)
    measured = measured_loop(names, loop[names[0]], loop[names[1]])
    sense = -1.0 if names[0] == "uy" else 1.0
    if sense * np.corrcoef(measured.displacement, measured.force)[0, 1] < 0.0:
        words = "falls where ux rises" if sense > 0.0 else "rises where uy rises"
        raise InputError(names[1], f"{words.replace('ux', names[0])}: turn its sign")
    model = LoopModel(
        problem, held_loads(as_history(history), names), names, measured, start, by_cycle, nodes, progress
    )
    return _result(model, LoopFit(model, wanted).fit())


def _measured(problem: Problem, loop: object) -> tuple[str, str]:
    """The names of the measured displacement and force, checked with the problem."""
    given = loop if isinstance(loop, Mapping) else {}
    names = next(((move, force) for move, force in REACTIONS.items() if {move, force} == set(given)), None)
    if names is None:
        raise InputError("loop", 'must map "ux" and "Q", "uy" and "P" or "rotation" and "M" to samples')
    if problem.dimensionless:
        raise InputError("problem", "must have units: a loop is measured in m and N")
    if isinstance(problem.friction, float) and not problem.friction:
        raise InputError("friction", "must be positive: it is the first guess")
    if not isinstance(problem.friction, float):
        raise InputError("friction", "must be a number: a profile along the rim can't be identified")
    if names[0] == "ux" and problem.rotation == "free":
        raise InputError("rotation", 'must be "fixed" or "spring": a free pin rolls under ux, and tells no friction')
    check_loads(problem, LoadHistory([{names[0]: 1e-9}]))
    return names


def held_loads(history: LoadHistory, names: tuple[str, str]) -> dict[str, float]:
    """Return the constant loads of a history, without the measured ones.

    Raises
    ------
    InputError
        If one of them changes after the first corner. The error names it.
    """
    values = history.distinct()
    after, held = values[min(1, len(values) - 1) :], {}
    for place, name in enumerate(LOADS):
        middle = float(np.median(after[:, place]))
        if name in names or not after[:, place].any():
            continue
        if np.abs(after[:, place] - middle).max() > HELD * abs(middle) or name == "friction_change":
            raise InputError(name, "must be constant: only the measured load changes during a loop")
        held[name] = middle
    return held


def _result(model: LoopModel, fit: LoopFit) -> Identified:
    """Values with their intervals, computed loop and sentences."""
    value = fit.values(fit.found)
    scatter, feet, forces = fit.scatter, *fit.compared(fit.found)[1:]
    estimates, rename = {}, []
    for place, name in enumerate(fit.names):
        middle, low, high = (float(each[place] * fit.sizes[place]) for each in (fit.found, fit.low, fit.high))
        if name == "friction":
            name = f"friction {place + 1}" if model.by_cycle else name
            estimates[name] = _inverted(middle, low, high, LEAST)
        elif name == "compliance":
            name = "stiffness"
            estimates[name] = _inverted(middle, low, high, 0.0)
        else:
            estimates[name] = FittedValue(middle, low, high)
        rename.append(name)
    size = np.where(fit.deviations > 0.0, fit.deviations, 1.0)
    related = fit.covariance / np.outer(size, size)
    pairs = [(i, j) for i in range(len(rename)) for j in range(i)]
    correlations = {(rename[j], rename[i]): float(related[i, j]) for i, j in pairs}
    loop, sign = model.loop, -1.0 if model.names[0] == "uy" else 1.0
    moved = loop.displacement - value["displacement_offset"] - value["displacement_drift"] * loop.time
    acting = (loop.force - value["force_offset"] - value["force_drift"] * loop.time) / value["scale"]
    forces = forces / value["scale"]
    energies = []
    for span in loop.cycles:
        (measured, deviation), (area, _) = (
            _area(x[span], y[span], loop.noise) for x, y in ((moved, acting), (feet, forces))
        )
        energies.append((sign * measured, deviation, sign * area))
    computed = (
        feet + value["displacement_offset"] + value["displacement_drift"] * loop.time,
        value["scale"] * forces + value["force_offset"] + value["force_drift"] * loop.time,
    )
    first = next(iter(estimates.values()))
    friction = first.value if math.isfinite(first.value) else 1.0 / value["friction"][0]
    joint = model.with_values(friction, value["compliance"], value["clearance"])
    notes = _notes(estimates, correlations, scatter, fit.moved)
    return Identified(
        joint, model.names, estimates, correlations, scatter, loop, computed, np.array(energies).reshape(-1, 3), notes,
        model.solved,
    )  # fmt: skip


def _inverted(middle: float, low: float, high: float, least: float) -> FittedValue:
    """The reciprocal of a value and its interval. A value whose interval reaches `least`, or is wide, is not told."""
    ends = 1.0 / high, math.inf if low <= least else 1.0 / low
    return FittedValue(1.0 / middle if ends[1] <= TELLING * ends[0] else math.nan, *ends)


def _area(x: np.ndarray, y: np.ndarray, noise: tuple[float, float]) -> tuple[float, float]:
    """The integral of y over x round a closed polygon, positive clockwise, and its standard deviation by the noise."""
    dx, dy = (0.5 * (np.roll(each, -1) - np.roll(each, 1)) for each in (x, y))
    return float(y @ dx), math.hypot(noise[1] * float(np.linalg.norm(dx)), noise[0] * float(np.linalg.norm(dy)))


def _notes(
    estimates: Mapping[str, FittedValue], correlations: Mapping[tuple[str, str], float], scatter: float, moved: float
) -> tuple[str, ...]:
    """Sentences on what the loop does not tell."""
    notes = []
    for name, each in estimates.items():
        if math.isnan(each.value):
            fits = "a rigid rig" if name == "stiffness" else "a pin that sticks everywhere"
            words = f"no upper bound: {fits} fits as well; it is at least {each.low:.3g}"
            if math.isfinite(each.high):
                words = f"all from {each.low:.3g} to {each.high:.3g} fit as well"
            notes.append(f"{name}: the loop does not tell it; {words}")
    if scatter > UNEXPLAINED:
        words = f"the samples lie {scatter:.2g} times their noise from the computed loop, so the bars are not sure"
        notes.append(f"{words}; a drift, a scale, a clearance or the other start may be missing in the fit")
    tied = [pair for pair, each in correlations.items() if abs(each) > TIED and "offset" not in "".join(pair)]
    notes += [f"{one} and {other} can hardly be told apart: their errors go together" for one, other in tied]
    if moved > MOVED:
        notes.append("the number of points still moves the values by more than a tenth of their deviations")
    return tuple(notes)
