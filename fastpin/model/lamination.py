"""Classical lamination theory: the compliances of a stack of plies, and the stresses in its plies.

All plies have the strains of the whole. :func:`whole_compliance` refuses a stack that bends when it is stretched.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from fastpin.errors import InputError
from fastpin.model.checks import as_toml, instance, items, number
from fastpin.model.layup import MOST_ANGLE, MOST_PLIES
from fastpin.model.ply import Ply

Stack = tuple[tuple[Ply, float], ...]
"""Plies and their angles, deg, from the lowest to the uppermost."""


def checked_stack(field: str, plies: object) -> Stack:
    """Check pairs of a ply and its angle in degrees, and return them.

    Raises
    ------
    InputError
        If they are no such pairs, too many, or none.
    """
    words = "pairs of a Ply and its angle in degrees"
    pairs: list[object] = items(field, plies, words)  # type: ignore[arg-type]
    if not 1 <= len(pairs) <= MOST_PLIES:
        raise InputError(field, f"must be 1 to {MOST_PLIES:,} plies, not {len(pairs):,}")
    found = []
    for pair in pairs:
        if not isinstance(pair, (tuple, list)) or len(pair) != 2:
            raise InputError(field, f"must be {words}, not {as_toml(pair)}")
        ply = instance(field, pair[0], Ply, words)
        found.append((ply, number(field, pair[1], -MOST_ANGLE, MOST_ANGLE) + 0.0))
    return tuple(found)


def stress_turn(angle: np.ndarray | float) -> np.ndarray:
    """The matrix T of stresses in axes turned counter-clockwise by `angle` (...), rad: shape (..., 3, 3).

    It makes (s_1, s_2, t_12) of (s_x, s_y, s_xy). The engineering strains are turned by the transpose of T(-angle).
    """
    return _turn(np.cos(angle), np.sin(angle))


def _turn(cos: np.ndarray | float, sin: np.ndarray | float) -> np.ndarray:
    c2, s2, cs = cos * cos, sin * sin, cos * sin
    rows = np.array([[c2, s2, 2.0 * cs], [s2, c2, -2.0 * cs], [-cs, cs, c2 - s2]])
    return np.moveaxis(rows, (0, 1), (-2, -1))


def _ply_turns(angles: Sequence[float]) -> np.ndarray:
    """T of the angles of plies, deg, shape (plies, 3, 3): exact for whole quarters of a turn."""
    degrees = np.asarray(angles, dtype=float)
    cos, sin = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    is_quarter = np.remainder(degrees, 90.0) == 0.0
    return _turn(np.where(is_quarter, np.round(cos), cos), np.where(is_quarter, np.round(sin), sin))


def whole_compliance(stack: Stack) -> tuple[float, ...]:
    """The compliances a11, a12, a22, a16, a26 and a66 of a stack in its own axes, 1/Pa.

    They are those of the mean stress: the inverse of sum(Q t) / sum(t), where Q are the stiffnesses of the plies.

    Raises
    ------
    InputError
        If stretching and bending are coupled: the stack is not symmetric about its middle.
    """
    angles = [angle for _, angle in stack]
    thickness = np.array([ply.thickness for ply, _ in stack])
    turns = _ply_turns([-angle for angle in angles])
    known = {ply: ply.stiffness for ply in dict.fromkeys(ply for ply, _ in stack)}
    own = np.array([known[ply] for ply, _ in stack])
    stiffness = turns @ own @ np.swapaxes(turns, -1, -2)
    whole = float(thickness.sum())
    part = thickness / whole
    middle = np.cumsum(part) - 0.5 * part - 0.5
    mean = np.tensordot(part, stiffness, 1)
    size = np.sqrt(np.outer(np.diag(mean), np.diag(mean)))
    if np.max(np.abs(np.tensordot(part * middle, stiffness, 1)) / size) > 1e-9:  # less is rounding
        words = "a stack that is not symmetric bends when it is stretched, and fastpin knows no bending"
        raise InputError("plies", f"must be symmetric about the middle: {words}")
    scale = 1.0 / np.sqrt(np.diag(mean))
    inverse = np.outer(scale, scale) * np.linalg.inv(mean * np.outer(scale, scale))
    compliance = 0.5 * (inverse + inverse.T)
    for row in (0, 1):
        if abs(compliance[row, 2]) <= 1e-13 * math.sqrt(compliance[row, row] * compliance[2, 2]):
            compliance[row, 2] = 0.0  # it is rounding
    return tuple(float(compliance[place]) for place in ((0, 0), (0, 1), (1, 1), (0, 2), (1, 2), (2, 2)))


def ply_strains(stack: Stack, strain: np.ndarray) -> np.ndarray:
    """The strains of plies in their own axes, from the strains of the whole in the axes of the stack.

    Parameters
    ----------
    stack : Stack
        The plies and their angles.
    strain : array, shape (..., 3)
        (e_1, e_2, g_12) of the whole. The shear strain is the engineering one.

    Returns
    -------
    array, shape (plies, ..., 3)
        (e_1, e_2, g_12) along and across the fibres of each ply.
    """
    back = _ply_turns([-angle for _, angle in stack])
    return np.array([np.asarray(strain, dtype=float) @ turn for turn in back])


def ply_stresses(stack: Stack, strain: np.ndarray) -> np.ndarray:
    """The stresses of plies in their own axes, Pa, see :func:`ply_strains`: shape (plies, ..., 3)."""
    strains = ply_strains(stack, strain)
    return np.array([each @ ply.stiffness for each, (ply, _) in zip(strains, stack, strict=True)])
