"""Exponents of the tractions at edges of the contact and at borders of stick zones, (T21), (T26), (T52)."""

from __future__ import annotations

import functools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from fastpin.model.problem import Problem


@dataclass(frozen=True, eq=False)
class Coupling:
    """How the two surfaces couple pressure and shear at each node. Like bodies couple them nowhere.

    Arrays of the shape (3, n) have a row for the sign 0, 1 and -1 of the shear in the slip zone at an edge or border.
    So the sign is their first index.

    Attributes
    ----------
    tilt : ndarray, shape (3, n)
        Shift of the exponents away from 1/2: arctan(mu beta_D)/pi, (T26), or that of a laminate, (T52).
    beta : ndarray, shape (n,)
        beta_D, or s/sqrt(det Lambda) of a laminate: the coupling where both bodies stick.
    share : ndarray, shape (3, n)
        The number rho of (T52): at a border mu N is the reserve less rho times the shear's part; 1 if isotropic.
    cusp : ndarray, shape (3, n)
        The number that takes the place of beta_D in the cusp of the pressure beside a border.
    """

    tilt: np.ndarray
    beta: np.ndarray
    share: np.ndarray
    cusp: np.ndarray

    @classmethod
    def of(cls, problem: Problem, friction: np.ndarray, theta: np.ndarray) -> Coupling:
        """The coupling of the surfaces of a problem at the angles `theta` (n,), with the `friction` (n,) there."""
        laminate = None if problem.pair.plate.is_isotropic else problem.joint.hole.laminate
        if laminate is None or laminate.is_isotropic_contact:
            return isotropic_coupling(friction.tobytes(), problem.surfaces.dundurs()[1])
        surfaces, turned = problem.surfaces, laminate.delta * np.exp(-2j * theta)
        mean, s = 0.5 * surfaces.beta_star, 0.25 * surfaces.alpha_star
        pressed = mean + turned.real  # Lambda_rr of both bodies; Lambda_rt is that of the plate
        held = pressed - np.outer([0.0, 1.0, -1.0], friction * turned.imag)
        ones = np.ones((3, theta.size))
        tilt = np.arctan2(friction * s, held) / math.pi * np.array([[0.0], [1.0], [1.0]])
        beta = s / np.sqrt(mean * mean - abs(laminate.delta) ** 2)
        share = pressed / held
        return cls(tilt, np.full(theta.size, beta), share, ones * share * s / held)

    def at(self, nodes: np.ndarray) -> Coupling:
        """The coupling at some `nodes` (k,)."""
        return Coupling(self.tilt[:, nodes], self.beta[nodes], self.share[:, nodes], self.cusp[:, nodes])

    @cached_property
    def is_smooth(self) -> bool:
        """Whether the pressure is smooth at borders, as of like bodies."""
        return not self.tilt.any() and bool(np.all(self.share == 1.0))


@functools.lru_cache(maxsize=8)  # the states of a run share them
def isotropic_coupling(friction: bytes, beta: float) -> Coupling:
    """The coupling of isotropic bodies with Dundurs' parameter `beta`. The `friction` (n,) is that of the nodes."""
    values = np.frombuffer(friction).tolist()
    known = {value: math.atan(value * beta) / math.pi for value in set(values)}
    tilt = np.array([known[value] for value in values])
    ones = np.ones((3, tilt.size))
    return Coupling(np.array([np.zeros_like(tilt), tilt, tilt]), np.full(tilt.size, beta), ones, beta * ones)


def contact_exponents(status: np.ndarray, tilt: np.ndarray, run: np.ndarray) -> tuple[float, float]:
    """Exponents of the pressure at both ends of the contact of the nodes `run`, (T21).

    `status` (n,) is that of the state, and `tilt` (3, n) that of its :class:`Coupling`.
    """
    first, last = (int(sign) for sign in status[run[[0, -1]]])
    return 0.5 - float(tilt[-first, run[0]]) * first, 0.5 + float(tilt[-last, run[-1]]) * last


def stick_exponents(shear: np.ndarray, tilt: np.ndarray, run: np.ndarray) -> tuple[float, float]:
    """Exponents of mu N - |T| at both ends of the stick zone of the nodes `run`, (T26).

    `shear` (n,) is that of the state, and `tilt` (3, n) that of its :class:`Coupling`.
    """
    before, after = signs_beside(shear, run)
    return 0.5 - float(tilt[before, run[0]]) * before, 0.5 + float(tilt[after, run[-1]]) * after


def signs_beside(shear: np.ndarray, run: np.ndarray) -> tuple[int, int]:
    """Signs of the shear traction, shape (n,), before and after the stick zone of the nodes `run`.

    They are 0 beside an open node, and for a stick zone all round.
    """
    if run.size == shear.size:
        return 0, 0
    before, after = np.sign(shear[[run[0] - 1, (run[-1] + 1) % shear.size]])
    return int(before), int(after)


def reserve_beside(
    sticking: Sequence[np.ndarray], friction: np.ndarray, pressure: np.ndarray, shear: np.ndarray
) -> np.ndarray:
    """The reserve beside the start and beside the stop of each run of `sticking` nodes, shape (2, n).

    It is mu N - s T, where s T = mu N in the slip zone beside. So it has no kink where T changes its sign.
    """
    reserve = np.array([friction * pressure - np.abs(shear)] * 2)
    for run in sticking:
        for values, sign in zip(reserve, signs_beside(shear, run), strict=True):
            if sign != 0:
                values[run] = friction[run] * pressure[run] - sign * shear[run]
    return reserve
