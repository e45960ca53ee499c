"""Compiled start of a step whose closed nodes are all held: the rates by the table, and the expected sense of slip."""

from __future__ import annotations

from fastpin.kernels.status import OPEN, STICK
from fastpin.runtime.jit import compiled


@compiled
def begin(table, stack, contact, friction, displaced, forces, given, tableau):
    """Set the rates, ties and couplings with which a step begins.

    Parameters
    ----------
    table : ndarray, shape (2n+m, 2n+m), column by column
    stack : ndarray of int, shape (2n+m,)
        See ``HeldTable``.
    contact : Contact
        The configuration. Its ties are set.
    friction : ndarray, shape (n,)
    displaced, forces : ndarray, shape (2n,), (m,)
        Gap and slip, and the right sides of equilibrium, by the rate of the load.
    given : ndarray, shape (2n+m,)
        Memory.
    tableau : Tableau
        Its ``rates``, ``tied`` and ``drag`` are set.

    Returns
    -------
    bool
        Whether the load has turned: most of the slipping nodes with friction stick when the load goes on.
    """
    n, rates, status = contact.status.size, tableau.rates, contact.status
    for i in range(given.size):
        given[i] = 0.0
    for column in range(stack.size):
        variable = stack[column]
        if variable >= 2 * n:
            factor = forces[variable - 2 * n]
        elif status[variable % n] == OPEN:
            continue
        else:
            factor = -displaced[variable]
        for row in range(given.size):
            given[row] += factor * table[row, column]
    for row in range(stack.size):
        rates[stack[row]] = given[row]
    slipping, going_on = 0, 0
    for i in range(n):
        if status[i] == OPEN:
            rates[i] += displaced[i]
            rates[n + i] += displaced[n + i]
        elif status[i] != STICK and friction[i] > 0.0:
            slipping += 1
            if -status[i] * rates[n + i] > friction[i] * rates[i]:
                going_on += 1
    turned = going_on <= slipping // 2
    for i in range(n):
        tie = status[i]
        if turned or tie == STICK or tie == OPEN:
            forward = rates[n + i] < 0.0 if status[i] == OPEN else contact.shear[i] + rates[n + i] > 0.0
            tie = -1 if forward else 1
        contact.tie[i] = tie
        tableau.tied[i], tableau.drag[i] = 0.0, 0.0
        if status[i] == OPEN:
            tableau.drag[i] = -friction[i] * tie
        else:
            tableau.tied[i] = friction[i] * tie
            rates[n + i] += tableau.tied[i] * rates[i]
    return turned
