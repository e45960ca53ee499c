"""The time that a history will take, roughly: to warn of long runs before they begin."""

from __future__ import annotations

import numpy as np

from fastpin.model.checks import instance
from fastpin.model.history import LoadHistory
from fastpin.model.loads import LOAD_KIND
from fastpin.model.options import SolveOptions
from fastpin.model.problem import Problem

REFERENCE = 401
"""Number of nodes of the measured times below."""

LEAST_STEP, STEP, STEP_EXPONENT = 0.002, 0.016, 2.25
"""Seconds of a step that turns the load back, and how they grow with the nodes.

docs/performance.md: half a cycle takes 3 ms with 101 nodes, 18 ms with 401, 0.16 s with 1,201 and 3.3 s with 4,096. The
law is within 40 % of these.
"""

FIRST, FIRST_EXPONENT = 0.024, 2.63
"""Seconds of the matrices and the first load, and how they grow. docs/performance.md: 24 ms with 401 nodes."""

STRAIGHT = 0.03
"""Part of a step that goes straight on: the same changes of status come in more steps, and a step has its own work."""

SETTLED = 10
"""Cycles after which a contact is taken to be periodic: then its states are copied. Fretting cycles took 3 to 12."""

INCREMENT = 0.7
"""Time of one increment in parts of a step of the path solver: 20 increments cost 6 to 20 steps (201 and 401 nodes)."""

HALF_GRID = 0.25
"""Time on a grid of half the nodes, for error bars, in parts of the time on the whole grid."""

STATE = 1e-3
"""Seconds of a state inside a step: its arrays and residuals. 3,000 states with 401 nodes took 4 s."""


def expected_seconds(problem: Problem, history: LoadHistory, options: SolveOptions) -> float:
    """Return the seconds that a history takes, within a factor of 3 on a usual machine.

    A step costs as much as the load turns in it: a reversal is a whole step, and a polygon of 24 corners two in a turn.

    An argument of another class raises :class:`InputError`.
    """
    instance("problem", problem, Problem, "a Problem")
    instance("history", history, LoadHistory, "a LoadHistory")
    instance("options", options, SolveOptions, "a SolveOptions")
    scale = options.nodes / REFERENCE
    step = LEAST_STEP + STEP * scale**STEP_EXPONENT
    if options.method == "increment":
        step *= INCREMENT * float(options.increments or 1)
    kept = len(options.fractions) * STATE * scale
    total = FIRST * scale**FIRST_EXPONENT
    natural = problem.natural_loads()
    sizes = np.array([natural[kind] for kind in LOAD_KIND.values()])
    turns = _turns(np.vstack([np.zeros(len(sizes)), history.distinct() / sizes]))
    begin = 0
    for block in history.blocks:
        rows = len(block.given)
        first = begin + (rows if block.count > 1 else 0)
        is_copied = options.shortcut and options.method == "path"
        solved = min(block.count, SETTLED) if is_copied else block.count
        work = turns[begin : begin + rows].sum() + (solved - 1) * turns[first : first + rows].sum()
        total += work * step + solved * rows * kept
        begin = first + rows
    return float(total * (1.0 + HALF_GRID * options.error_bars))


def _turns(loads: np.ndarray) -> np.ndarray:
    """The part of a whole step of each step between loads, shape (steps,). The first step is a whole one."""
    moves = np.diff(loads, axis=0)
    lengths = np.linalg.norm(moves, axis=1)
    inner = np.einsum("ij,ij->i", moves[1:], moves[:-1])
    with np.errstate(invalid="ignore", divide="ignore"):
        cosines = np.clip(inner / (lengths[1:] * lengths[:-1]), -1.0, 1.0)
    angles = np.nan_to_num(np.arccos(cosines), nan=0.0) / np.pi
    return STRAIGHT + (1.0 - STRAIGHT) * np.r_[1.0, angles]
