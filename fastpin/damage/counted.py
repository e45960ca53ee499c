"""Cycles of stress histories, counted on planes: the damage of a spectrum at each point of one material.

On each plane the cycles of its strain are counted over the whole history. A cycle has its
strain amplitude and the largest normal stress of its stops, and does the damage 1/N of the criterion. The sum over the
cycles is the damage of the plane (Palmgren 1924, Miner 1945). The worst plane counts.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from functools import partial
from typing import NamedTuple

import numpy as np

from fastpin.damage import plane_damage
from fastpin.damage.criteria import FATIGUE_CRITERIA, ROUNDING, PlaneCount
from fastpin.damage.lives import LifeCurve, curve_with_knee, cycles_on_curve, life_shift, scattered
from fastpin.errors import InputError
from fastpin.model import FatigueConstants, Material
from fastpin.model.assessment import USUAL, FatigueAssessment
from fastpin.model.checks import alternatives, choice
from fastpin.runtime.threads import in_chunks

SPECTRUM_CRITERIA = tuple(name for name, criterion in FATIGUE_CRITERIA.items() if criterion.counting is not None)
"""The criteria with lives, whose cycles are counted."""

CHUNK, COUNTED = 8, 64
"""Points that one thread counts at a time, and points that are counted between two calls of the progress."""

MOST_PATHS = 2**20
"""Most states of the points that are counted at a time: their paths fill 50 MB, and as much again while made."""

TRIED = 16
"""Places at which a block of repeated stops may end."""


class Spectrum(NamedTuple):
    """The stops of a spectrum in the order of time, in blocks.

    Attributes
    ----------
    order : ndarray of int64, shape (stops,)
        The place of each stop among the different states. Blocks of many passes are held once.
    blocks : ndarray of int64, shape (blocks, 3)
        First stop of each block, the stop after its last one, and the number of its passes.
    """

    order: np.ndarray
    blocks: np.ndarray

    @classmethod
    def of(cls, order: np.ndarray) -> Spectrum:
        """Find the blocks of stops that come at least four times in a row."""
        kept: list[np.ndarray] = []
        blocks: list[tuple[int, int, int]] = []
        later: dict[int, list[int]] = {}
        for place, state in enumerate(order.tolist()):
            later.setdefault(state, []).append(place)
        first = begin = held = 0  # of the stops that are in no block yet; the present stop; stops in blocks
        while begin <= order.size:
            length, passes = (0, 0) if begin == order.size else _repeated(order, begin, later[int(order[begin])])
            if begin < order.size and passes < 4:
                begin += 1
                continue
            for start, stop, times in ((first, begin, 1), (begin, begin + length, passes)):
                if stop > start:
                    kept.append(order[start:stop])
                    blocks.append((held, held + stop - start, times))
                    held += stop - start
            begin += max(length * passes, 1)
            first = begin
        return cls(np.concatenate(kept), np.array(blocks, dtype=np.int64))


def _repeated(order: np.ndarray, begin: int, places: list[int]) -> tuple[int, int]:
    """Return length and passes of the repeated block that begins at a stop; no passes if none does.

    `places` are all places of the state of this stop; those up to `begin` are taken off.
    """
    while places and places[0] <= begin:
        del places[0]
    for end in places[:TRIED]:
        length = end - begin
        if begin + 4 * length > order.size:
            break
        same = order[begin + length :] == order[begin : order.size - length]
        if same[: 3 * length].all():
            alike = same.size if same.all() else int(np.argmin(same))
            return length, alike // length + 1
    return 0, 0


def _together(history: np.ndarray) -> Iterator[slice]:
    """Yield the points that are counted at a time, from stresses (states, points, 4): few of a long history."""
    states, points = history.shape[:2]
    step = min(COUNTED, max(MOST_PATHS // max(states, 1), 1))
    for begin in range(0, points, step):
        yield slice(begin, min(begin + step, points))


class CountedMaterial(NamedTuple):
    """A criterion with the constants of one material.

    Attributes
    ----------
    name : str
        The criterion.
    counting : PlaneCount
    material : Material
    constants : tuple of float
        The constants of the parameter.
    life : ndarray, shape (8,)
        The curve of lives with its knee, see :func:`fastpin.damage.lives.curve_with_knee`.
    shift : float
        log10 of the median life over the life at the reliability that is asked for.
    scatter : float
        Standard error of log10 life; NaN if it is unknown.
    """

    name: str
    counting: PlaneCount
    material: Material
    constants: tuple[float, ...]
    life: np.ndarray
    shift: float
    scatter: float

    @classmethod
    def of(
        cls,
        name: str,
        material: Material,
        constants: FatigueConstants | None,
        body: str,
        how: FatigueAssessment = USUAL,
    ) -> CountedMaterial:
        """Check a criterion, the constants, by default those of the material of a body, and how cycles do damage.

        Raises
        ------
        InputError
            If the criterion has no life, or a constant is missing. The message names the constants and the `body`.
            Also if its curve has no such knee.
        """
        criterion = FATIGUE_CRITERIA[choice("criterion", name, tuple(FATIGUE_CRITERIA))]
        if criterion.counting is None:
            raise InputError("criterion", f"{name} has no life; use {alternatives(SPECTRUM_CRITERIA)}")
        given = (material.fatigue if constants is None else constants) or FatigueConstants()
        known = given.required((*criterion.needs, *criterion.life_needs), name, body)
        needs = len(criterion.needs)
        shift = life_shift(how, given, body)
        curve = scattered(criterion.counting.curve(material, *known[needs:]), shift)
        power = known[0] if criterion.counting.form == plane_damage.POWERS else 0.0
        life = curve_with_knee(curve, criterion.counting.degree, how.small_cycles, how.knee, power)
        scatter = given.curve_scatter if name == "stress-life" and given.curve_scatter else math.nan
        return cls(name, criterion.counting, material, known[:needs], life, shift, scatter)

    def worst(
        self, history: np.ndarray, spectrum: Spectrum, progress: Callable[[float], None] | None = None
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return damage and plane of each point, both (points,), from stresses (states, points, 4), Pa.

        The plane is given by the angle of its normal from the +x axis, rad; NaN where there is no damage.
        """
        points, least = history.shape[1], self._least(history)
        out = np.empty((points, 2))
        for part in _together(history):
            paths, rows = self._paths(history[:, part]), out[part]
            chunk = CHUNK if len(history) * COUNTED <= MOST_PATHS else 1  # few points at a time are for all threads
            in_chunks(len(paths), chunk, partial(self._count, spectrum, least, paths, rows))
            if progress is not None:
                progress(part.stop / points)
        return out[:, 0], out[:, 1]

    def _count(self, spectrum: Spectrum, least: float, paths: np.ndarray, rows: np.ndarray, part: slice) -> None:
        plane_damage.worst_sums(paths[part], *spectrum, self.counting.form, least, self.life, rows[part])

    def cycles(self, history: np.ndarray, spectrum: Spectrum, plane: float) -> tuple[np.ndarray, np.ndarray]:
        """Count the cycles of one point on one plane, from its stresses (states, 1, 4), Pa.

        Returns
        -------
        places : ndarray of int64, shape (cycles, 3)
            The states of both reversals, and the state with the largest normal stress.
        values : ndarray, shape (cycles, 3)
            How often the cycle comes, its parameter, and the damage of all its times.
        """
        most = 3 * spectrum.order.size + 2
        places, values = np.empty((most, 3), dtype=np.int64), np.empty((most, 3))
        given = self.counting.form, self._least(history), self.life
        count = plane_damage.cycles_on_plane(self._paths(history)[0], plane, *spectrum, *given, places, values)
        return places[:count], values[:count]

    def largest(self, history: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the largest parameter of a cycle of each point on any plane, and this plane, both (points,), rad."""
        out = np.empty((2, history.shape[1]))
        for part in _together(history):
            found = FATIGUE_CRITERIA[self.name].values(history[:, part], self.material, *self.constants)
            assert found.plane is not None
            out[0, part], out[1, part] = found.parameter, found.plane
        return out[0], out[1]

    def most_damage(self, parameter: np.ndarray) -> np.ndarray:
        """Return the damage 1/N of cycles without a rule of small cycles, which is no less than with one."""
        curve = LifeCurve((math.exp(self.life[0]), math.exp(self.life[1])), (self.life[2], self.life[3]))
        with np.errstate(divide="ignore"):
            return 1.0 / cycles_on_curve(parameter, curve)

    def _least(self, history: np.ndarray) -> float:
        """The parameter that is rounding beside the stresses."""
        return ROUNDING * self.counting.natural(float(np.abs(history).max(initial=0.0)), self.material)

    def _paths(self, history: np.ndarray) -> np.ndarray:
        swung, push = self.counting.swung_and_push(history, self.material, *self.constants)
        return np.ascontiguousarray(np.concatenate([swung, push], axis=-1).transpose(1, 0, 2))
