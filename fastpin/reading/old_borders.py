"""Old borders: places inside stick zones where an earlier slip zone or contact ended. The shear has a cusp there.

A slip zone grows along a step. When the load turns, its nodes stick again, and the cusp at its border stays in the
shear until a later slip zone passes over it. The same holds for an edge of the contact when the contact grows again. So
the borders and edges of every corner are marked, at the outermost node of the zone, and a mark is removed when its node
slips or opens. A mark is a bit of a whole number: a node may be the outermost one of several zones.

The place of each border is read between the nodes when it is marked. Later, when other borders lie beside it, it could
not be told from them.
"""

from __future__ import annotations

import functools
from typing import NamedTuple

import numpy as np

from fastpin.kernels.status import OPEN, STICK

BITS = {(1, -1): 1, (1, 1): 2, (1, 0): 4, (-1, -1): 8, (-1, 1): 16, (-1, 0): 32}
"""Bit of a border by two signs: the direction into the zone, and the shear in the slip zone beyond; 0 for an edge."""


UPWARD = sum(bit for (inwards, _), bit in BITS.items() if inwards > 0)
"""Bits of the borders whose zone lies on the side of the next nodes."""


class OldBorder(NamedTuple):
    """A border in a zone.

    Attributes
    ----------
    at : int
        Its outermost node, counted in the zone.
    inwards : int
        Direction into its stick zone, 1 or -1.
    sign : int
        Sign of the shear in its slip zone; 0 for an edge of the contact.
    place : float or None
        Its place, in node distances inwards from the outermost node; None if unknown.
    """

    at: int
    inwards: int
    sign: int
    place: float | None = None

    def mirrored(self, nodes: int) -> OldBorder:
        """The same border in the zone of so many nodes counted from its other end."""
        return self._replace(at=nodes - 1 - self.at, inwards=-self.inwards)

    def is_end(self, nodes: int) -> bool:
        """Whether it is an end of the zone, which has so many nodes."""
        return self.at == (0 if self.inwards > 0 else nodes - 1)


@functools.cache
def signs_of(mark: int) -> dict[int, int]:
    """The direction into each zone that ends at a node with this mark, and the sign of the shear in the slip zone."""
    return {inwards: sign for (inwards, sign), bit in reversed(BITS.items()) if mark & bit}  # the first of each counts


def is_ambiguous(mark: int) -> bool:
    """Whether a node with this mark ends zones in both directions, so that it has no single place."""
    return bool(mark & UPWARD and mark & ~UPWARD)


def present_borders(status: np.ndarray, closed: bool) -> list[tuple[int, int, int]]:
    """The present borders between stick and slip, and the edges of the contact.

    Parameters
    ----------
    status : ndarray, shape (n,)
    closed : bool
        Whether the last node is joined to the first node.

    Returns
    -------
    list of (int, int, int)
        Outermost node, direction into the zone, and sign of the shear in the slip zone; 0 for an edge.
    """
    changes = [(node, node + 1) for node in (status[1:] != status[:-1]).nonzero()[0].tolist()]
    if closed:
        changes.append((status.size - 1, 0))
    found = []
    for before, after in changes:
        first, second = status.item(before), status.item(after)
        for node, own, beside, inwards in ((after, second, first, 1), (before, first, second, -1)):
            if own != OPEN and beside == OPEN:
                found.append((node, inwards, 0))
            elif own == STICK and beside != STICK:
                found.append((node, inwards, -beside))
    return found


def truly_sticking(status: np.ndarray, reserve: np.ndarray) -> np.ndarray:
    """Whether each node sticks, bool, shape (n,). A node with |T| = mu N slips: its `reserve` mu N - |T| is 0."""
    return np.asarray((status == STICK) & (reserve > 1e-9 * reserve.max()))
