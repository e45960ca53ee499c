"""A measured loop of a displacement and its force: noise, branches and their ends, distances from computed curves.

Only the ends of the branches may drive a model. If every sample did, each wiggle of the noise would be a reversal: the
friction of a loop with 0.6 % noise then came out three standard deviations off.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from fastpin.errors import InputError
from fastpin.model import Problem, checks, loads
from fastpin.model.recorded import least_reversal, noise, turning_points
from fastpin.runtime.extensions import interpolate
from fastpin.tables.columns import ColumnChoice
from fastpin.tables.files import read_corners
from fastpin.tables.load_units import Basis

REACTIONS = {"ux": "Q", "uy": "P", "rotation": "M"}
"""The loads that may be measured over, and their reactions."""

FEWEST, FEWEST_OF_BRANCH = 20, 5
"""Fewest samples of a loop, and of a branch between two turning points."""

NEAR = (0.2, 0.12)
"""Parts of a branch on either side of a turning point that are fitted for its place. With a quartic in the second one,
and without noise, the place is right to 5e-5 of the range; 0.3 gave 1e-3. The largest sample lies too far out."""

BETTER = 9.0
"""Least gain of a quartic over a parabola, in variances of the noise. By chance 1 turning point of 90 has more."""

LEAST_NOISE = 1e-4
"""Least noise of a channel, in parts of its range. Smooth records have less, and a model is no better."""

NEWTON = 4
"""Gauss-Newton steps to the foot of a sample on its curve."""


@dataclass(frozen=True, eq=False)
class MeasuredLoop:
    """A loop in samples that are equally spaced in time.

    Attributes
    ----------
    displacement, force : ndarray, shape (n,)
        In SI units; the force may be a moment and the displacement a rotation.
    noise : (float, float)
        Standard deviations of the noise of both.
    width : float
        Width of the smallest reversal of the displacement that counts.
    time : ndarray, shape (n,)
        From 0 to 1 over the record.
    ends : ndarray, shape (turns + 2, 2)
        Time and displacement of the first sample, of the turning points and of the last sample, without noise.
    branch : ndarray of int, shape (n,)
        The branch of each sample; branch k lies between the ends k and k + 1.
    shares : ndarray, shape (turns, n)
        The change of the displacement of a turning point by the noise of each sample.
    """

    displacement: np.ndarray
    force: np.ndarray
    noise: tuple[float, float]
    width: float
    time: np.ndarray
    ends: np.ndarray
    branch: np.ndarray
    shares: np.ndarray

    @property
    def cycles(self) -> list[slice]:
        """The samples of each whole cycle, from one turning point to the next but one."""
        inner = np.rint(self.ends[1:-1, 0] * (self.time.size - 1)).astype(int).tolist()
        found = [slice(first, last + 1) for first, last in zip(inner[:-2:2], inner[2::2], strict=False)]
        is_whole = len(inner) == 2 and abs(self.ends[-1, 1] - self.ends[0, 1]) < max(self.width, self.step)
        return [slice(0, self.time.size)] if is_whole else found

    @property
    def step(self) -> float:
        """Largest displacement between two samples."""
        return float(np.abs(np.diff(self.displacement)).max())

    def distances(self, curves: Sequence[tuple[np.ndarray, np.ndarray]], moved: np.ndarray, acting: np.ndarray) -> Any:
        """Return the distances of all samples from the curves of their branches, in standard deviations.

        They lie along the normal, where both axes are in units of their noise. Beyond its ends a curve goes on along
        its tangents.

        Parameters
        ----------
        curves : sequence of (ndarray, ndarray)
            Displacements, monotonic, and forces of each branch.
        moved, acting : ndarray, shape (n,)
            Displacement and force of the samples, without offsets and drift.

        Returns
        -------
        distances, feet, forces : ndarray, shape (n,)
            Also the displacement of the nearest point of the curve, and the force there.
        """
        found = np.empty((3, self.time.size))
        for branch, (x, y) in enumerate(curves):
            inside = self.branch == branch
            found[:, inside] = _from_curve(x, y, moved[inside], acting[inside], self.noise)
        return found


def _from_curve(x: Any, y: Any, moved: Any, acting: Any, scale: tuple[float, float]) -> np.ndarray:
    """Distances from one curve, displacements of the feet and forces there, shape (3, samples)."""
    sense = 1.0 if x[-1] > x[0] else -1.0
    curve = interpolate.PchipInterpolator(sense * x, y)
    slope, low, high = curve.derivative(), sense * x[0], sense * x[-1]

    def at(place: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        nearest = np.clip(place, low, high)
        rate = slope(nearest)
        return curve(nearest) + rate * (place - nearest), rate

    given, foot = sense * moved, sense * moved
    for _ in range(NEWTON):
        value, rate = at(foot)
        weighted = (given - foot) / scale[0] ** 2 + rate * (acting - value) / scale[1] ** 2
        foot = foot + weighted / (1.0 / scale[0] ** 2 + (rate / scale[1]) ** 2)
    value, rate = at(foot)
    away = (acting - value - rate * (given - foot)) / np.hypot(scale[1], rate * scale[0])
    return np.array([away, sense * foot, value])


def measured_loop(names: tuple[str, str], displacement: Any, force: Any) -> MeasuredLoop:
    """Find noise, turning points and branches of a loop. `names` are those of displacement and force, for errors.

    Raises
    ------
    InputError
        If samples are no finite numbers, too few, constant, or run in one direction only.
    """
    both = []
    for name, given in zip(names, (displacement, force), strict=True):
        values = checks.number_array(name, given)
        if not np.isfinite(values).all():
            first = np.flatnonzero(~np.isfinite(values))[0] + 1
            raise InputError(name, f"sample {first:,} is missing or no finite number")
        if values.ndim != 1 or values.size < FEWEST:
            raise InputError(name, f"must be a list of at least {FEWEST} samples, not of the shape {values.shape}")
        if not np.ptp(values) > 0.0:
            raise InputError(name, f"is constant, {values[0]:g} in all samples: a loop needs a channel that moves")
        both.append(values)
    moved, acting = both
    if moved.size != acting.size:
        raise InputError(names[1], f"has {acting.size} samples, and {names[0]} has {moved.size}")
    width = least_reversal(moved)
    turns = turning_points(moved, width)
    if not turns.size:
        words = f"runs in one direction only: a loop turns back by more than its noise, here {width:.2g}"
        raise InputError(names[0], words)
    lengths = np.diff(np.r_[0, turns, moved.size - 1])
    if lengths[1:-1].size and lengths[1:-1].min() < FEWEST_OF_BRANCH:
        words = f"has {lengths[1:-1].min()} samples between two turning points; {FEWEST_OF_BRANCH} are the fewest"
        raise InputError(names[0], words)
    time = np.linspace(0.0, 1.0, moved.size)
    whole = lengths.copy()
    whole[[0, -1]] *= 2  # the record may cut these two branches off
    shares = np.zeros((turns.size, moved.size))
    deviations = [max(noise(each), LEAST_NOISE * float(np.ptp(each))) for each in both]
    inner = []
    for turn, place in enumerate(turns.tolist()):
        around = int(whole[turn]), int(whole[turn + 1])
        inner.append(_turn(moved, place, min(around), deviations[0], shares[turn]))
    outer = [_line_end(moved[: turns[0] + 1]), _line_end(moved[turns[-1] :][::-1])]
    ends = np.array([(0.0, outer[0]), *((each[0] / (moved.size - 1), each[1]) for each in inner), (1.0, outer[1])])
    branch = np.searchsorted(ends[1:-1, 0], time)
    return MeasuredLoop(moved, acting, (deviations[0], deviations[1]), width, time, ends, branch, shares)


def read_loop(
    path: str | Path,
    problem: Problem,
    over: str | None = None,
    displacement: str | None = None,
    force: str | None = None,
    force_factor: float = 1.0,
) -> dict[str, np.ndarray]:
    """Read the samples of a loop from a CSV file, in SI units and per thickness.

    Parameters
    ----------
    path : path
        The file: a header line, and a line for each sample.
    problem : Problem
        With its thickness a force in N is taken.
    over : {"ux", "uy", "rotation"}, optional
        The measured displacement; that of the problem's drive unless given.
    displacement, force : str, optional
        Header of the columns. Unless given, a column with the name of the load is taken ("Q"), or the only one with a
        unit of its kind.
    force_factor : float
        Factor of the force, such as -1.

    Returns
    -------
    dict of str to ndarray, shape (n,)
        The displacement and its reaction by name, for :func:`fastpin.identify`.

    Raises
    ------
    CaseFileError
        With the faults of the file, each with its line.
    InputError
        If another argument can't be used.
    """
    checks.instance("problem", problem, Problem, "a Problem")
    for name, header in (("displacement", displacement), ("force", force)):
        if header is not None:
            checks.string(name, header)
    usual = {"ux": "ux", "uy": "uy", "both": "ux"}.get(problem.drive, "rotation")
    moved = checks.choice("over", usual if over is None else over, tuple(REACTIONS))
    names = moved, REACTIONS[moved]
    factor = checks.number("force_factor", force_factor)
    if factor == 0.0:
        raise InputError("force_factor", "must not be 0")
    choices = {names[0]: ColumnChoice((displacement or "",)), names[1]: ColumnChoice((force or "",), factor)}
    basis = Basis("per metre" if problem.thickness is None else "with thickness", problem.unit_system)
    ((table, _),) = read_corners(checks.file_path("path", path), choices, basis)
    found = {name: table[:, loads.LOADS.index(name)] for name in names}
    found[names[1]] = found[names[1]] / (problem.thickness or 1.0)
    return found


def _turn(values: np.ndarray, place: int, length: int, deviation: float, shares: np.ndarray) -> tuple[float, float]:
    """Sample number and value of a turning point, from a polynomial through the samples around it.

    `length` is the number of samples of the shorter branch.

    It is a parabola through the samples around the vertex of a first one. Where a quartic fits better by more than the
    noise, fewer samples count, and then the quartic. A quartic for all lies 0.2 deviations too far out. The shares (n,)
    of the samples in the value are set.
    """
    around = max(int(NEAR[0] * length), 3)
    place = round(_vertex(values, place, around, 2)[0])
    for part in NEAR:
        around = max(int(part * length), 3)
        where, value, kept, cost = _vertex(values, place, around, 2)
        if kept.size < 10:
            break
        other = _vertex(values, place, around, 4)
        if cost - other[3] < BETTER * deviation**2:
            break
        where, value, kept, _ = other
    first = max(place - around, 0)
    shares[first : first + kept.size] = kept
    return where, value


def _vertex(values: np.ndarray, place: int, around: int, order: int) -> tuple[float, float, np.ndarray, float]:
    """Sample number and value of the vertex near a sample, the shares of the samples in it, and the sum of squares."""
    first, last = max(place - around, 0), min(place + around + 1, values.size)
    x = (np.arange(first, last) - float(place)) / around
    powers = np.vander(x, order + 1, increasing=True)
    of_samples = np.linalg.pinv(powers)
    coefficients = of_samples @ values[first:last]
    fit = np.polynomial.Polynomial(coefficients)
    roots = fit.deriv().roots()
    roots = roots[np.abs(roots.imag) < 1e-12].real
    roots = roots[(roots >= x[0]) & (roots <= x[-1])]
    where = float(roots[np.argmin(np.abs(roots))]) if roots.size else 0.0
    left = values[first:last] - powers @ coefficients
    return place + where * around, float(fit(where)), where ** np.arange(order + 1) @ of_samples, float(left @ left)


def _line_end(values: np.ndarray) -> float:
    """The value of the first sample without its noise, from a line through it and those behind it."""
    count = min(9, values.size // 2)
    return float(np.polyfit(np.arange(count), values[:count], 1)[1]) if count > 2 else float(values[0])
