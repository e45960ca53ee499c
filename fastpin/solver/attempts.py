"""Attempts at a history: which grids are tried, in which order, and why.

A history is followed on one grid from no load to its end. If it can't be followed there, the next attempt begins anew:

1. On equally spaced nodes: those of the user, or nodes on the arc that a coarse run chooses. A contact that reaches an
   end of a chosen arc is cut off. Then wider arcs follow, up to the whole circle.
2. On graded grids, if the contact gets too narrow for these nodes. They are dense where a survey of the history finds
   narrow contacts. Nodes that the user has chosen have no graded grids.
3. On the arcs once more, if graded grids do not help. These attempts are not strict: a contact that carries next to
   nothing is let go, and a new one begins without memory.

A run that begins at a corner keeps its grid. It has a strict attempt, and then one that is not strict. The increment
solver has the first attempts only.
"""

from __future__ import annotations

import itertools
import logging
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from functools import partial
from typing import NamedTuple, TypeVar

import numpy as np

from fastpin.model.grid import Grid
from fastpin.model.options import SolveOptions
from fastpin.model.problem import Problem
from fastpin.solver.arc import candidate_grids, narrow_grids
from fastpin.solver.errors import CUT_OFF, ArcError, ConvergenceError, SolveError
from fastpin.solver.run import RunProgress

log = logging.getLogger(__name__)

Followed = TypeVar("Followed")


class Unfit(NamedTuple):
    """A grid on which an earlier run has ended, and its error."""

    grid: Grid
    error: SolveError


@dataclass(frozen=True, eq=False)
class Attempts:
    """The attempts at one history.

    Attributes
    ----------
    problem : Problem
    values : ndarray, shape (corners, loads)
        Loads at the corners, SI.
    force : float
        The reference force, N/m.
    options : SolveOptions
    grid : Grid or None
        The nodes of the user.
    progress : callable or None
        Called during coarse runs.
    """

    problem: Problem
    values: np.ndarray
    force: float
    options: SolveOptions
    grid: Grid | None
    progress: RunProgress | None

    def arcs(self) -> Iterator[Grid]:
        """Equally spaced nodes: those of the user, or candidates that grow to the whole circle."""
        nodes, arc = self.options.nodes, self.options.arc
        if self.grid is not None:
            return iter([self.grid])
        if arc is None:
            return candidate_grids(self.problem, self.values, self.force, nodes, self.progress)
        return iter([Grid.circle(nodes, arc[0]) if self.options.is_full_turn else Grid.arc(arc[0], arc[1], nodes)])

    def first_followed(
        self, follow: Callable[[Grid, bool], Followed], arcs: Iterable[Grid] | None = None, unfit: Unfit | None = None
    ) -> Followed:
        """Follow the history in one attempt after the other, until one reaches its end.

        Parameters
        ----------
        follow : callable
            Called with a grid, and whether the attempt is strict. Its value is returned.
        arcs : iterable of Grid, optional
            Equally spaced nodes in place of :meth:`arcs`. They are read twice.
        unfit : Unfit, optional
            The attempts begin after this one.

        Raises
        ------
        SolveError
            The error of the last attempt.
        """

        def on_arc(strict: bool, grid: Grid) -> Followed:
            log.info("%d nodes from %.5g to %.5g rad", grid.size, grid.theta[0], grid.theta[-1])
            return follow(grid, strict)

        try:
            if unfit is not None and not isinstance(unfit.error, ArcError):
                raise unfit.error
            strict_arcs = self.arcs() if arcs is None else arcs
            if unfit is not None:
                strict_arcs = arcs_after(unfit.grid, strict_arcs)
            return first_wide_enough(strict_arcs, partial(on_arc, True))
        except ConvergenceError as error:
            if self.options.method != "path":
                raise
            reason = str(error)
        for grid in self._graded(unfit):
            log.info("%s: once more with %d nodes that are dense where the contact is narrow", reason, grid.size)
            try:
                return follow(grid, True)
            except ConvergenceError as error:
                reason = str(error)
        log.info("%s", reason)
        return first_wide_enough(self.arcs() if arcs is None else arcs, partial(on_arc, False))

    def _graded(self, unfit: Unfit | None) -> Iterable[Grid]:
        """Graded grids for narrow contacts. If an earlier run has ended on one of them, the grids after it."""
        if self.grid is not None or self.options.arc is not None or self.problem.seat is not None:
            return ()
        grids = narrow_grids(self.problem, self.values, self.force, self.options, self.progress)
        if unfit is None:
            return grids
        listed = list(grids)
        tried = [number for number, grid in enumerate(listed, start=1) if _is_same(grid, unfit.grid)]
        return listed[tried[0] :] if tried else listed


def first_wide_enough(arcs: Iterable[Grid], follow: Callable[[Grid], Followed]) -> Followed:
    """Follow a history on one arc after the other, until the contact keeps clear of its ends.

    Raises
    ------
    ArcError
        If the contact reaches an end of the last arc, or if there is none.
    """
    wider = iter(arcs)
    grid = next(wider, None)
    while grid is not None:
        try:
            return follow(grid)
        except ArcError:
            grid = next(wider, None)
            if grid is None:
                raise
            log.info("the contact reaches an end of the arc: once more on a wider one")
    raise ArcError(CUT_OFF)


def arcs_after(grid: Grid, arcs: Iterable[Grid]) -> Iterator[Grid]:
    """The arcs that come after a grid among `arcs`."""
    return itertools.islice(itertools.dropwhile(lambda other: not _is_same(other, grid), arcs), 1, None)


def _is_same(one: Grid, two: Grid) -> bool:
    """Whether two grids have the same nodes, up to rounding."""
    return one.size == two.size and bool(np.allclose(one.theta, two.theta, rtol=0.0, atol=1e-9))
