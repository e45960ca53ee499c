"""Compiled steps whose closed nodes are all held at the start.

The table of the held contact gives the rates and the expected sense of slip. Then the load is followed from event to
event, and the contact at the stop is corrected. All this is one call.
"""

from __future__ import annotations

import numpy as np

from fastpin.kernels.conditions import correct_held, of_load
from fastpin.kernels.exchange import EXCHANGES, QUEUED, REACHED, UPDATES, follow
from fastpin.kernels.status import OPEN, STICK
from fastpin.runtime.jit import compiled


@compiled
def begin(table, stack, contact, friction, displaced, forces, tableau):
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
    tableau : Tableau
        Its ``rates``, ``tied`` and ``drag`` are set.

    Returns
    -------
    bool
        Whether the load has turned: most of the slipping nodes with friction stick when the load goes on.
    """
    n, rates, status, given = contact.status.size, tableau.rates, contact.status, np.zeros(stack.size)
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


@compiled
def step(
    begins, stack, operator, equations, fixed, typical, before, rate, now, rest_gap, contact, tableau, load,
    queue, stop, most_events, all_at_once, corrected,
):  # fmt: skip
    """Follow the load from sums[TIME] to `stop`, and correct the contact there.

    Parameters
    ----------
    begins : bool
        Whether the step begins here, with all closed nodes held. Nodes that go on slipping are then let go one by one.
    stack : ndarray of int, shape (2n+m,)
        See ``HeldTable``.
    operator : ndarray, shape (2n, 2n), column by column
    equations : Equations
    before, rate, now : ndarray, shape (loads,)
        The load at the start of the step, its change along the step, and the load at `stop`.
    rest_gap : ndarray, shape (n,)
    fixed, typical, contact, tableau, queue, stop, most_events, all_at_once
        See :func:`fastpin.kernels.exchange.follow`.
    load : LoadTerms
        Its columns and forces are set.
    corrected : ContactValues
        Is set to the corrected contact if `stop` is reached.

    Returns
    -------
    (int, bool, (float, float, float, float))
        The code of :func:`fastpin.kernels.exchange.follow`; whether the load has turned where the step begins, see
        :func:`begin`; and the errors at `stop`, see :func:`fastpin.kernels.conditions.correct_held`.
    """
    n, counts, turned, friction = contact.status.size, queue.counts, False, equations.friction
    moved, forces = np.empty(2 * n), np.empty(contact.motion.size)
    of_load(equations.work, before, load.column)
    of_load(equations.work, rate, load.column_rate)
    of_load(equations.forces, before, load.force)
    of_load(equations.forces, rate, load.force_rate)
    if begins:
        of_load(equations.loads, rate, moved)
        of_load(equations.forces, rate, forces)
        turned = begin(tableau.matrix, stack, contact, friction, moved, forces, tableau)
        for i in range(n):
            if contact.status[i] == OPEN or contact.status[i] == STICK:
                continue
            if not turned:
                queue.node[counts[QUEUED]], queue.status[counts[QUEUED]] = i, contact.status[i]
                counts[QUEUED] += 1
                counts[EXCHANGES] -= 1
            contact.status[i] = STICK
    code = follow(tableau, contact, load, queue, friction, fixed, typical, stop, most_events, all_at_once)
    errors = (0.0, 0.0, 0.0, 0.0)
    if code == REACHED:
        of_load(equations.loads, now, moved)
        of_load(equations.forces, now, forces)
        errors = correct_held(
            tableau, counts[UPDATES], operator, equations, contact, moved, forces, rest_gap, corrected
        )
    return code, turned, errors
