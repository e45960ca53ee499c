"""The table of a held contact, filled from its blocks."""

from __future__ import annotations

from fastpin.kernels.jit import compiled


@compiled
def fill(rows, others, blocks, moved, tied_motion, moving, table):
    """Fill the table of a held contact from the blocks without motion of the pin, and from the motion.

    Parameters
    ----------
    rows, others : ndarray of int, shapes (k,) and (2n-k,)
        Places of the held and of the other variables.
    blocks : tuple of four ndarrays
        Responses without motion: of held to held (k, k) and to others (k, 2n-k), of others to held (2n-k, k) and to
        others (2n-k, 2n-k).
    moved, tied_motion : ndarray, shapes (k, 3) and (2n-k, 3)
        Responses to the motion.
    moving : ndarray, shape (3, 2n+3)
        Motion by held, by others and by the three forces.
    table : ndarray, shape (2n+3, 2n+3), column by column
        The result.
    """
    k, size = rows.size, table.shape[0]
    for column in range(size):
        x, y, turn = moving[0, column], moving[1, column], moving[2, column]
        if column < k:
            place, upper, lower, source = rows[column], blocks[0], blocks[2], column
        elif column < size - 3:
            place, upper, lower, source = others[column - k], blocks[1], blocks[3], column - k
        else:
            place, upper, lower, source = column, blocks[0], blocks[2], -1
        for i in range(k):
            value = moved[i, 0] * x + moved[i, 1] * y + moved[i, 2] * turn
            if source >= 0:
                value += upper[i, source]
            table[rows[i], place] = value
        for i in range(others.size):
            value = tied_motion[i, 0] * x + tied_motion[i, 1] * y + tied_motion[i, 2] * turn
            if source >= 0:
                value += lower[i, source]
            table[others[i], place] = value
        table[size - 3, place], table[size - 2, place], table[size - 1, place] = x, y, turn
