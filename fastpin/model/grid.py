"""The fixed grid of nodes on which tractions live, piecewise linear between nodes."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from fastpin.checks import finite, whole_number
from fastpin.errors import InputError

LEAST_NODES = 5


@dataclass(frozen=True, eq=False)
class Grid:
    """Nodes on an arc of the hole or on the whole circle.

    Parameters
    ----------
    theta : ndarray, shape (n,)
        Node angles in rad, strictly increasing, spanning less than a full turn. theta = -pi/2 is the bottom.
    closed : bool
        Whether the last node is joined to the first one (the whole circle).

    Raises
    ------
    InputError
        If there are fewer than 5 nodes, they do not increase, or they span a full turn or more.
    """

    theta: np.ndarray
    closed: bool = False

    def __post_init__(self) -> None:
        theta = np.array(self.theta, dtype=float)
        if theta.ndim != 1 or theta.size < LEAST_NODES:
            raise InputError("nodes", f"must be at least {LEAST_NODES}, not {theta.size}")
        if not np.all(np.isfinite(theta)) or np.any(np.diff(theta) <= 0.0):
            raise InputError("theta", "node angles must be finite and strictly increasing")
        if theta[-1] - theta[0] >= 2.0 * math.pi:
            raise InputError("theta", "nodes must span less than a full turn")
        theta.setflags(write=False)
        object.__setattr__(self, "theta", theta)

    @classmethod
    def arc(cls, start: float, stop: float, nodes: int) -> Grid:
        """`nodes` equally spaced nodes from angle `start` to angle `stop`, rad, both included."""
        a, b = finite("arc start", start), finite("arc stop", stop)
        if not 0.0 < b - a < 2.0 * math.pi:
            raise InputError(
                "arc", f"must run from a smaller to a larger angle, less than a full turn, not {a:g} to {b:g}"
            )
        return cls(np.linspace(a, b, whole_number("nodes", nodes, LEAST_NODES)))

    @classmethod
    def circle(cls, nodes: int, start: float = -1.5 * math.pi) -> Grid:
        """`nodes` equally spaced nodes on the whole circle, the first one at angle `start`."""
        count = whole_number("nodes", nodes, LEAST_NODES)
        return cls(finite("start", start) + 2.0 * math.pi * np.arange(count) / count, closed=True)

    def with_nodes(self, nodes: int) -> Grid:
        """`nodes` equally spaced nodes on the same arc or circle."""
        if self.closed:
            return Grid.circle(nodes, float(self.theta[0]))
        return Grid.arc(float(self.theta[0]), float(self.theta[-1]), nodes)

    @property
    def size(self) -> int:
        return int(self.theta.size)

    def knots(self) -> tuple[np.ndarray, np.ndarray]:
        """Left and right knots of every node's hat function, shape (n,) each.

        The end nodes of an arc carry half hats (their outer knot is the node itself).
        """
        theta = self.theta
        left = np.concatenate([theta[:1], theta[:-1]])
        right = np.concatenate([theta[1:], theta[-1:]])
        if self.closed:
            left[0] = theta[-1] - 2.0 * math.pi
            right[-1] = theta[0] + 2.0 * math.pi
        return left, right

    @property
    def weights(self) -> np.ndarray:
        """Integral of every node's hat function, shape (n,), rad."""
        left, right = self.knots()
        return 0.5 * (right - left)

    @property
    def uniform(self) -> bool:
        """Whether all nodes are equally spaced, on a circle also across the seam."""
        spacing = self.knots()[1] - self.theta
        if not self.closed:
            spacing = spacing[:-1]
        return bool(np.ptp(spacing) <= 1e-12 * self.size * spacing[0])

    def trig_moments(self) -> tuple[np.ndarray, np.ndarray]:
        """Integrals of every node's hat function times cos theta and times sin theta, shape (n,) each. Exact."""
        left, right = self.knots()
        total = np.zeros(self.size, dtype=complex)
        for length, sense in ((self.theta - left, -1.0), (right - self.theta, 1.0)):
            total += _half_hat_moment(length, sense)
        total *= np.exp(1j * self.theta)
        return total.real, total.imag


def apart(angles: np.ndarray | float, angle: np.ndarray | float) -> np.ndarray:
    """How far `angles` are from `angle`, rad, the short way round: -pi to pi, positive counter-clockwise."""
    return np.remainder(np.asarray(angles) - angle + math.pi, 2.0 * math.pi) - math.pi


def _half_hat_moment(length: np.ndarray, sense: float) -> np.ndarray:
    """int_0^h (1 - t/h) exp(i sense t) dt = (h/2) sinc(h/2)^2 + i sense (1 - sin(h)/h), for lengths h >= 0."""
    even = 0.5 * length * np.sinc(0.5 * length / math.pi) ** 2
    series = np.zeros_like(length)  # of 1 - sin(h)/h, which loses no digits where h is small
    for k in range(8, 0, -1):
        series = length**2 / (2.0 * k * (2.0 * k + 1.0)) * (1.0 - series)
    odd = np.where(length > 0.5, 1.0 - np.sinc(length / math.pi), series)
    return even + 1j * sense * odd
