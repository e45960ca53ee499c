"""The fixed grid of nodes. Tractions are given at the nodes and are piecewise linear between them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from fastpin.errors import InputError
from fastpin.model.angles import angle_between, distinct
from fastpin.model.checks import check_fields, number, numbers, set_fields, true_or_false, whole_number

LEAST_NODES = 5
MAX_NODES = 20_000
"""Limits of the number of nodes. The matrices hold 4 nodes^2 numbers: 13 GB for the largest grid."""


@dataclass(frozen=True, eq=False, repr=False)
class Grid:
    """Nodes on an arc of the hole or on the whole circle.

    Parameters
    ----------
    theta : ndarray, shape (n,)
        Node angles in rad, strictly increasing, spanning less than a full turn. theta = -pi/2 is the bottom.
    closed : bool
        Whether the last node is joined to the first node: the grid is the whole circle.

    Raises
    ------
    InputError
        If there are fewer than 5 nodes, they do not increase, or they span a full turn or more.
    """

    theta: np.ndarray
    closed: bool = False

    def __post_init__(self) -> None:
        theta = numbers("theta", self.theta).copy()
        if theta.ndim != 1:
            raise InputError("theta", f"must have the shape (nodes,), not {theta.shape}")
        whole_number("nodes", theta.size, LEAST_NODES, MAX_NODES)
        if (theta[1:] <= theta[:-1]).any():
            raise InputError("theta", "node angles must be finite and strictly increasing")
        if theta[-1] - theta[0] >= 2.0 * math.pi:
            raise InputError("theta", "nodes must span less than a full turn")
        theta.setflags(write=False)
        set_fields(self, theta=theta)
        check_fields(self, true_or_false, "closed")

    def __getstate__(self) -> dict[str, Any]:
        return {"theta": self.theta, "closed": self.closed}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)
        self.theta.setflags(write=False)  # a copy through pickle could be written to

    def __repr__(self) -> str:
        where = "on the circle" if self.closed else f"from {self.theta[0]:.6g} to {self.theta[-1]:.6g} rad"
        return f"<Grid: {self.size} nodes {where}>"

    @classmethod
    def arc(cls, start: float, stop: float, nodes: int) -> Grid:
        """An arc of `nodes` equally spaced nodes from angle `start` to angle `stop`, rad, both included."""
        a, b = number("arc start", start), number("arc stop", stop)
        if not 0.0 < b - a < 2.0 * math.pi:
            raise InputError(
                "arc", f"must run from a smaller to a larger angle, less than a full turn, not {a:g} to {b:g}"
            )
        return cls(np.linspace(a, b, whole_number("nodes", nodes, LEAST_NODES, MAX_NODES)))

    @classmethod
    def circle(cls, nodes: int, start: float = -1.5 * math.pi) -> Grid:
        """A whole circle of `nodes` equally spaced nodes. The first node is at angle `start`, rad."""
        count = whole_number("nodes", nodes, LEAST_NODES, MAX_NODES)
        return cls(number("start", start) + 2.0 * math.pi * np.arange(count) / count, closed=True)

    @classmethod
    def graded(cls, places: Sequence[tuple[float, float]], nodes: int, node_at: float | None = None) -> Grid:
        """A whole circle of nodes that are dense at some places, where contacts are narrow.

        At each place the spacing is the place's width divided by the same number m. Away from it the spacing grows in
        proportion to the distance, by 2/m from one node to the next. :func:`graded_size` gives the nodes for an m.

        Parameters
        ----------
        places : sequence of (float, float)
            Angle and width of each place, rad; the widths are positive.
        nodes : int
        node_at : float, optional
            Angle at which a node lies, rad.

        Raises
        ------
        InputError
            If there are no places, a width is not positive, or the number of nodes is out of range.
        """
        count = whole_number("nodes", nodes, LEAST_NODES, MAX_NODES)
        theta, number_below = _graded_counts(places)
        shift = 0.0
        if node_at is not None:
            turned = theta[0] + (number("node_at", node_at) - theta[0]) % (2.0 * math.pi)
            shift = float(np.interp(turned, theta, number_below)) / number_below[-1] * count % 1.0
        wanted = (np.arange(count) + shift) / count * number_below[-1]
        return cls(np.interp(wanted, number_below, theta), closed=True)

    def with_nodes(self, nodes: int) -> Grid:
        """A grid of `nodes` nodes on the same arc or circle. Its spacings are in proportion to the present ones."""
        nodes = whole_number("nodes", nodes, LEAST_NODES, MAX_NODES)
        if not self.uniform:
            ends = np.r_[self.theta, self.theta[0] + 2.0 * math.pi] if self.closed else self.theta
            places = np.linspace(0.0, ends.size - 1.0, nodes + 1 if self.closed else nodes)
            finer = np.interp(places, np.arange(ends.size), ends)
            return Grid(finer[:-1] if self.closed else finer, self.closed)
        if self.closed:
            return Grid.circle(nodes, float(self.theta[0]))
        return Grid.arc(float(self.theta[0]), float(self.theta[-1]), nodes)

    @cached_property
    def size(self) -> int:
        """Number of nodes n."""
        return int(self.theta.size)

    def knots(self) -> tuple[np.ndarray, np.ndarray]:
        """Left and right knots of every node's hat function, rad, shape (n,) each. They can't be written to.

        The end nodes of an arc carry half hats. The outer knot of a half hat is the node itself.
        """
        return self._knots

    @cached_property
    def _knots(self) -> tuple[np.ndarray, np.ndarray]:
        theta = self.theta
        left = np.concatenate([theta[:1], theta[:-1]])
        right = np.concatenate([theta[1:], theta[-1:]])
        if self.closed:
            left[0] = theta[-1] - 2.0 * math.pi
            right[-1] = theta[0] + 2.0 * math.pi
        for knots in (left, right):
            knots.setflags(write=False)
        return left, right

    @cached_property
    def halves(self) -> tuple[np.ndarray, np.ndarray]:
        """Lengths of the left and the right half of every node's hat function, rad, shape (n,) each; 0 for no half.

        They are the distances of a node from its neighbours. They can't be written to.
        """
        left, right = self._knots
        found = self.theta - left, right - self.theta
        for lengths in found:
            lengths.setflags(write=False)
        return found

    @property
    def weights(self) -> np.ndarray:
        """Integral of every node's hat function, shape (n,), rad."""
        left, right = self.knots()
        return 0.5 * (right - left)

    @cached_property
    def uniform(self) -> bool:
        """Whether all nodes are equally spaced; on a circle also from the last node to the first."""
        spacing = self.halves[1] if self.closed else self.halves[1][:-1]
        return bool(np.ptp(spacing) <= 1e-12 * self.size * spacing[0])

    def trig_moments(self) -> tuple[np.ndarray, np.ndarray]:
        """Exact integrals of every node's hat function times cos theta and times sin theta, shape (n,) each.

        They can't be written to.
        """
        return self._trig_moments

    @cached_property
    def _trig_moments(self) -> tuple[np.ndarray, np.ndarray]:
        # int_0^h (1 - t/h) exp(-+ i t) dt = (h/2) sinc(h/2)^2 -+ i (1 - sin(h)/h) of the left and right halves
        length = np.array(self.halves)
        even = 0.5 * length * np.sinc(0.5 * length / math.pi) ** 2
        series, square = np.zeros_like(length), length**2  # of 1 - sin(h)/h: no digits are lost where h is small
        for k in range(8, 0, -1):
            series = square / (2.0 * k * (2.0 * k + 1.0)) * (1.0 - series)
        odd = np.where(length > 0.5, 1.0 - np.sinc(length / math.pi), series)
        odd[0] *= -1.0
        left, right = even + 1j * odd
        total = (left + right) * np.exp(1j * self.theta)
        total.setflags(write=False)
        return total.real, total.imag


def arc_of(grid: Grid, nodes: np.ndarray) -> Grid:
    """The arc of the neighbouring `nodes` of a grid, indices of shape (k,), in their order round the hole."""
    turns = np.r_[0, np.cumsum(np.diff(nodes) < 0)]
    return Grid(grid.theta[nodes] + 2.0 * math.pi * turns)


def graded_size(places: Sequence[tuple[float, float]], across: float) -> int:
    """Number of nodes of :meth:`Grid.graded` with `across` nodes on the width of each place."""
    return math.ceil(across * float(_graded_counts(places)[1][-1]))


def _graded_counts(places: Sequence[tuple[float, float]]) -> tuple[np.ndarray, np.ndarray]:
    """Angles round the hole, and the number of nodes below each of them, with one node on the width of each place."""
    pairs = numbers("places", places)
    if pairs.ndim != 2 or pairs.shape[1:] != (2,) or not pairs.size or pairs[:, 1].min() <= 0.0:
        raise InputError("places", "must be angles with positive widths, rad: (angle, width), ...")
    angles, widest, count = pairs[:, 0], 2.0, 400  # a wider contact, rad, needs no grading; and angles round a place
    widths = np.minimum(pairs[:, 1], widest)
    away = np.geomspace(0.5, math.pi / float(widths.min()), max(count // widths.size, 30))
    offsets = np.outer(widths, np.r_[0.0, 0.25, away])
    start = -1.5 * math.pi
    samples = (np.concatenate([angles[:, None] + offsets, angles[:, None] - offsets]) - start) % (2.0 * math.pi)
    steps = np.linspace(0.0, 2.0 * math.pi, count)
    every: np.ndarray = np.r_[steps, samples[samples > 0.0]]
    theta = distinct(every.round(13)) + start
    spacing = np.full(theta.size, widest)
    for angle, width in zip(angles, widths, strict=True):
        spacing = np.minimum(spacing, np.maximum(width, 2.0 * np.abs(angle_between(theta, angle))))
    density = 1.0 / spacing
    return theta, np.r_[0.0, np.cumsum(0.5 * (density[1:] + density[:-1]) * np.diff(theta))]


def halved(grid: Grid, direction: float | None) -> Grid:
    """The grid with half the intervals: every second node.

    One of these nodes is the node nearest to the angle `direction`, rad. Equal spacings become twice as large, also
    where the number of intervals is odd. A coarse arc then ends beyond the fine arc. This changes nothing, for
    the nodes there are open. A grid with unequal spacings keeps its first node, and an arc also its last.
    """
    n = grid.size
    if not grid.uniform:
        ends = grid.theta[-1:] if not grid.closed else grid.theta[:1]
        return Grid(distinct(np.r_[grid.theta[::2], ends]), grid.closed)
    parity = 0 if direction is None else int(np.argmin(np.abs(angle_between(grid.theta, direction)))) % 2
    if grid.closed:
        return Grid.circle((n + 1) // 2, float(grid.theta[parity]))
    spacing = float(grid.theta[-1] - grid.theta[0]) / (n - 1)
    first, last = -parity, n - 1 + (n - 1 + parity) % 2
    room = math.floor((2.0 * math.pi / spacing - (last - first)) / 4.0 - 0.5)  # at each end, in coarse nodes
    if room < 0:
        last -= 2
    extra = 2 * max(0, min(2, room))  # at each end: the contact may be wider on the coarse grid
    first, last = first - extra, last + extra
    start = float(grid.theta[0]) + spacing * first
    return Grid.arc(start, start + spacing * (last - first), (last - first) // 2 + 1)
