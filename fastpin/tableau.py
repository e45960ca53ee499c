"""Compiled exchange steps: follow the contact along a straight piece of the load history, exactly.

Between two changes of status everything is linear in the load. The tableau holds, for every node, a normal pair
(N, h) and a tangential pair (tau, s), where tau = T + sigma mu N at slipping nodes and tau = T elsewhere. One of
each pair is *dependent*, the other one has rate zero:

    open:   N and tau have rate zero,  h and s are dependent
    stick:  h and s have rate zero,    N and tau are dependent
    slip:   h and tau have rate zero,  N and s are dependent

The matrix maps the zero-rate variables to the dependent ones and to the three components of the pin's motion (its
last rows). A change of status exchanges the members of a pair, which is a rank-one update; updates are kept as
pairs of vectors (`left`, `right`) and applied to the matrix in blocks by the caller, one matrix product a block.
Only the rates of the dependent variables are updated at once.

Kernels take arrays and numbers, change only their own arrays, and return a code.
"""

from __future__ import annotations

import numpy as np

from fastpin.jit import compiled
from fastpin.state import OPEN, STICK
from fastpin.state import SLIP_NEGATIVE as NEGATIVE
from fastpin.state import SLIP_POSITIVE as POSITIVE

# What `follow` returns.
REACHED = 0  # the requested point of the step
FULL = 1  # no room for more updates: apply the block and call again
REBUILD = 2  # statuses were changed wholesale or a pivot was small: rebuild the tableau and call again
NO_SUPPORT = 3  # nothing holds the pin any more
CYCLING = 4  # the statuses did not settle
ARC_END = 5  # the contact reaches an end node

# Slots of `counts`.
PENDING, QUEUED, NEXT, ROUND, EVENTS, EXCHANGES, COUNTS = 0, 1, 2, 3, 4, 5, 6
# Slots of `sums`.
TIME, DISSIPATION, WORK, SUMS = 0, 1, 2, 3

RATE_TOLERANCE = 1e-11  # rates below this part of the largest one are zero
VALUE_TOLERANCE = 1e-13  # likewise for gaps and the reserve mu N - |T|
PRESSURE_TOLERANCE = 1e-10  # likewise for pressures; wider, for mirrored nodes to open together
SMALL_PIVOT = 1e-9  # pivots below this part of a typical one belong to a mechanism
UNUSUAL_PIVOT = 1e-6  # pivots that differ by more than this from a typical one ask for a new tableau
TOGETHER_ROUNDS = 12  # rounds in which all violators change at once; afterwards one at a time


@compiled
def _column(matrix, left, right, pending, p, out):
    for i in range(matrix.shape[0]):
        out[i] = matrix[i, p]
    for k in range(pending):
        factor = right[p, k]
        if factor != 0.0:
            for i in range(matrix.shape[0]):
                out[i] += factor * left[i, k]


@compiled
def _row(matrix, left, right, pending, p, out):
    for j in range(matrix.shape[1]):
        out[j] = matrix[p, j]
    for k in range(pending):
        factor = left[p, k]
        if factor != 0.0:
            for j in range(matrix.shape[1]):
                out[j] += factor * right[j, k]


@compiled
def _exchange(matrix, left, right, pending, rates, p):
    """Exchange the members of pair p; appends one update. Returns the pivot."""
    column, row = left[:, pending], right[:, pending]
    _column(matrix, left, right, pending, p, column)
    _row(matrix, left, right, pending, p, row)
    pivot = row[p]
    column[p] += 1.0
    row[p] -= 1.0
    ratio = rates[p] / pivot
    for i in range(column.size):
        rates[i] -= column[i] * ratio
        column[i] /= -pivot
    return pivot


@compiled
def _add_row(matrix, left, right, pending, rates, target, source, factor):
    """Row `target` += factor * row `source`; appends one update."""
    _row(matrix, left, right, pending, source, right[:, pending])
    for i in range(left.shape[0]):
        left[i, pending] = 0.0
    left[target, pending] = factor
    rates[target] += factor * rates[source]


@compiled
def _add_column(matrix, left, right, pending, target, source, factor):
    """Column `target` += factor * column `source`; appends one update."""
    _column(matrix, left, right, pending, source, left[:, pending])
    for j in range(right.shape[0]):
        right[j, pending] = 0.0
    right[target, pending] = factor


@compiled
def _diagonal(matrix, left, right, pending, p):
    value = matrix[p, p]
    for k in range(pending):
        value += left[p, k] * right[p, k]
    return value


@compiled
def _change_status(matrix, left, right, pending, rates, status, friction, node, new):
    """Give `node` the status `new`; the values of N and T must fit both. Returns (updates appended, pivot)."""
    n = status.size
    tangential = n + node
    old = status[node]
    appended = 0
    pivot = np.inf
    if old == STICK and (new == NEGATIVE or new == POSITIVE):
        if friction > 0.0:
            _add_row(matrix, left, right, pending, rates, tangential, node, new * friction)
            appended += 1
        pivot = _exchange(matrix, left, right, pending + appended, rates, tangential)
        appended += 1
    elif (old == NEGATIVE or old == POSITIVE) and new == STICK:
        pivot = _exchange(matrix, left, right, pending, rates, tangential)
        appended += 1
        if friction > 0.0:
            _add_row(matrix, left, right, pending + appended, rates, tangential, node, -old * friction)
            appended += 1
    elif old == OPEN:  # closes as slipping
        if friction > 0.0:
            _add_column(matrix, left, right, pending, node, tangential, -new * friction)
            appended += 1
        pivot = _exchange(matrix, left, right, pending + appended, rates, node)
        appended += 1
    else:  # a slipping node opens
        pivot = _exchange(matrix, left, right, pending, rates, node)
        appended += 1
        if friction > 0.0:
            _add_column(matrix, left, right, pending + appended, node, tangential, old * friction)
            appended += 1
    status[node] = new
    return appended, abs(pivot)


@compiled
def _rate_scales(rates, status):
    """Largest traction rate and largest displacement rate."""
    n = status.size
    traction, length = 0.0, 0.0
    for i in range(n):
        if status[i] == OPEN:
            length = max(length, abs(rates[i]), abs(rates[n + i]))
        else:
            traction = max(traction, abs(rates[i]))
            if status[i] == STICK:
                traction = max(traction, abs(rates[n + i]))
            else:
                length = max(length, abs(rates[n + i]))
    return traction, length


@compiled
def _friction_violators(pressure, shear, status, rates, friction, traction_tol, length_tol, node_queue, status_queue):
    """Queue the nodes whose friction status contradicts the rates: first those that stick, then those that slip."""
    n = status.size
    queued = 0
    if friction == 0.0:
        return queued
    for i in range(n):
        if (status[i] == NEGATIVE or status[i] == POSITIVE) and status[i] * rates[n + i] < -length_tol:
            node_queue[queued], status_queue[queued] = i, STICK
            queued += 1
    for i in range(n):
        if status[i] == STICK:
            bound = friction * pressure[i]
            growth = friction * rates[i]
            if pressure[i] == 0.0:
                direction = 1.0 if rates[n + i] > 0.0 else -1.0
            elif abs(shear[i]) >= bound:
                direction = 1.0 if shear[i] > 0.0 else -1.0
            else:
                continue
            if direction * rates[n + i] - growth > traction_tol:
                node_queue[queued] = i
                status_queue[queued] = NEGATIVE if direction > 0.0 else POSITIVE
                queued += 1
    return queued


@compiled
def _contact_violators(pressure, gap, status, rates, traction_tol, length_tol, node_queue, status_queue):
    """Queue the open nodes that close; if there are none, the closed nodes that open."""
    n = status.size
    queued = 0
    for i in range(n):
        if status[i] == OPEN and gap[i] == 0.0 and rates[i] < -length_tol:
            node_queue[queued] = i
            status_queue[queued] = NEGATIVE if rates[n + i] < 0.0 else POSITIVE
            queued += 1
    if queued > 0:
        return queued
    for i in range(n):
        if status[i] != OPEN and pressure[i] == 0.0 and rates[i] < -traction_tol:
            node_queue[queued], status_queue[queued] = i, OPEN
            queued += 1
    return queued


@compiled
def _relief(left_column, status, rates, node, direction):
    """The slipping node that sticks first when `node`, the last one that holds the pin, lets go in `direction`.

    `left_column` holds the motion that becomes free. Returns -1 if no node would stop it.
    """
    n = status.size
    best, chosen = np.inf, -1
    for i in range(n):
        if (status[i] == NEGATIVE or status[i] == POSITIVE) and i != node:
            drift = direction * left_column[n + i]
            if status[i] * drift < 0.0:
                ratio = abs(rates[n + i]) / abs(drift)
                if ratio < best:
                    best, chosen = ratio, i
    return chosen


@compiled
def _next_event(pressure, shear, gap, status, rates, friction, traction_tol, length_tol, limit):
    """Time to the next change of status, at most `limit`."""
    n = status.size
    first = limit
    for i in range(n):
        rate = rates[i]
        if status[i] == OPEN:
            if rate < -length_tol and gap[i] > 0.0:
                first = min(first, gap[i] / -rate)
        else:
            if rate < -traction_tol and pressure[i] > 0.0:
                first = min(first, pressure[i] / -rate)
            if status[i] == STICK and pressure[i] > 0.0:
                bound, growth = friction * pressure[i], friction * rate
                for direction in (-1.0, 1.0):
                    room = bound - direction * shear[i]
                    closing = direction * rates[n + i] - growth
                    if closing > traction_tol and room > 0.0:
                        first = min(first, room / closing)
    return first


@compiled
def _advance(pressure, shear, gap, slip, motion, status, rates, friction, weights, step, sums):
    """Move everything by `step`; values that reach their bound are put exactly there."""
    n = status.size
    most_pressure, most_gap = 0.0, 0.0
    dissipated = 0.0
    for i in range(n):
        if status[i] == OPEN:
            gap[i] += step * rates[i]
            slip[i] += step * rates[n + i]
            most_gap = max(most_gap, gap[i])
        else:
            old = pressure[i]
            pressure[i] += step * rates[i]
            most_pressure = max(most_pressure, pressure[i])
            if status[i] == STICK:
                shear[i] += step * rates[n + i]
            else:
                slid = step * rates[n + i]
                slip[i] += slid
                shear[i] = -status[i] * friction * pressure[i]
                dissipated += weights[i] * friction * 0.5 * (old + pressure[i]) * abs(slid)
    for i in range(3):
        motion[i] += step * rates[2 * n + i]
    for i in range(n):
        if status[i] == OPEN:
            if gap[i] <= VALUE_TOLERANCE * most_gap:
                gap[i] = 0.0
        elif pressure[i] <= PRESSURE_TOLERANCE * most_pressure:
            pressure[i], shear[i] = 0.0, 0.0
        elif status[i] == STICK:
            bound = friction * pressure[i]
            if abs(shear[i]) >= bound - VALUE_TOLERANCE * most_pressure * friction:
                shear[i] = bound if shear[i] > 0.0 else -bound
    sums[DISSIPATION] += dissipated


@compiled
def _work(shear, status, rates, friction, weights, load_work, load_work_rate, force, force_rate, time, step):
    """Work of the loads over a step, exact for the piecewise linear path (call it before `_advance`).

    `load_work` (2n,) are the weights with which traction rates enter the work of the load columns at time 0,
    `force` (2,) the force (Q, -P) at time 0; the `_rate` arrays their growth per unit time.
    """
    n = status.size
    middle = time + 0.5 * step
    moment, moment_rate, work = 0.0, 0.0, 0.0
    for i in range(n):
        if status[i] != OPEN:
            shear_rate = rates[n + i] if status[i] == STICK else -status[i] * friction * rates[i]
            moment -= weights[i] * shear[i]
            moment_rate -= weights[i] * shear_rate
            work += (load_work[i] + middle * load_work_rate[i]) * rates[i]
            work += (load_work[n + i] + middle * load_work_rate[n + i]) * shear_rate
    for k in range(2):
        work += (force[k] + middle * force_rate[k]) * rates[2 * n + k]
    work += (moment + 0.5 * step * moment_rate) * rates[2 * n + 2]
    return work * step


@compiled
def follow(
    matrix, left, right, rates, pressure, shear, gap, slip, motion, status, friction, weights,
    load_work, load_work_rate, force, force_rate, closed_grid, typical, stop,
    node_queue, status_queue, touched, counts, sums, most_events, wholesale,
):  # fmt: skip
    """Follow the load from sums[TIME] to `stop`, status change by status change (design of the path solver).

    Parameters
    ----------
    matrix : (2n+3, 2n), `left` (2n+3, block), `right` (2n, block)
        The tableau and its pending updates.
    rates : (2n+3,)
        Rates of the dependent variables and of the motion per unit time.
    typical : float
        A typical compliance (diagonal of the operator), to judge pivots.
    closed_grid : bool
        Whether the grid is the whole circle; if not, its end nodes must stay open.
    wholesale : int
        More changes than this at once are made in one go, without exchanges, and REBUILD is returned.

    Returns
    -------
    int
        One of the codes above. After FULL and REBUILD the caller calls again.
    """
    n = status.size
    block = left.shape[1]
    settled = False
    while True:
        # Work off the queue of status changes.
        while counts[NEXT] < counts[QUEUED]:
            if counts[PENDING] + 6 > block:
                return FULL
            node, new = node_queue[counts[NEXT]], status_queue[counts[NEXT]]
            pending = counts[PENDING]
            old = status[node]
            counts[NEXT] += 1
            if old == new:
                continue
            if old == OPEN and not closed_grid and (node == 0 or node == n - 1):
                return ARC_END
            if old == STICK:
                slipping = POSITIVE if new == OPEN else new
                if abs(_diagonal(matrix, left, right, pending, n + node)) * typical < SMALL_PIVOT:
                    # The last node that holds the pin: another one must take over first.
                    _column(matrix, left, right, pending, n + node, left[:, pending])
                    other = _relief(left[:, pending], status, rates, node, slipping)
                    if other < 0:
                        return NO_SUPPORT
                    appended, _ = _change_status(matrix, left, right, pending, rates, status, friction, other, STICK)
                    pending += appended
                    if abs(_diagonal(matrix, left, right, pending, n + node)) * typical < SMALL_PIVOT:
                        return NO_SUPPORT
                appended, pivot = _change_status(matrix, left, right, pending, rates, status, friction, node, slipping)
                pending += appended
                unusual = pivot * typical < UNUSUAL_PIVOT
            else:
                unusual = False
            if status[node] != new:
                if new == OPEN and abs(_diagonal(matrix, left, right, pending, node)) * typical < SMALL_PIVOT:
                    return NO_SUPPORT
                appended, pivot = _change_status(matrix, left, right, pending, rates, status, friction, node, new)
                pending += appended
                ratio = pivot * typical if new == OPEN else typical / pivot
                unusual = unusual or ratio < UNUSUAL_PIVOT
            if new != OPEN:
                touched[node] = True
            counts[PENDING] = pending
            counts[EXCHANGES] += 1
            if unusual:  # rounding has grown by as much
                return REBUILD
        traction_rate, length_rate = _rate_scales(rates, status)
        traction_tol, length_tol = RATE_TOLERANCE * traction_rate, RATE_TOLERANCE * length_rate
        if not (np.isfinite(traction_rate) and np.isfinite(length_rate)):
            return NO_SUPPORT

        # Settle the statuses: friction first, then closing, then opening.
        if not settled:
            queued = _friction_violators(
                pressure, shear, status, rates, friction, traction_tol, length_tol, node_queue, status_queue
            )
            if queued > 1 and counts[ROUND] >= TOGETHER_ROUNDS:
                lowest = np.argmin(node_queue[:queued])
                node_queue[0], status_queue[0] = node_queue[lowest], status_queue[lowest]
                queued = 1
            if queued == 0:
                queued = _contact_violators(
                    pressure, gap, status, rates, traction_tol, length_tol, node_queue, status_queue
                )
            counts[NEXT], counts[QUEUED] = 0, queued
            if queued > 0:
                counts[ROUND] += 1
                if counts[ROUND] > 4 * n + 200:
                    return CYCLING
                if queued > wholesale:
                    for k in range(queued):
                        node, new = node_queue[k], status_queue[k]
                        if status[node] == OPEN and not closed_grid and (node == 0 or node == n - 1):
                            return ARC_END
                        status[node] = new
                        touched[node] = touched[node] or new != OPEN
                    counts[NEXT] = counts[QUEUED]
                    counts[EXCHANGES] += queued
                    return REBUILD
                continue
            settled = True
            counts[ROUND] = 0

        # Advance to the next event.
        if sums[TIME] >= stop:
            return REACHED
        room = stop - sums[TIME]
        step = _next_event(pressure, shear, gap, status, rates, friction, traction_tol, length_tol, room)
        sums[WORK] += _work(
            shear,
            status,
            rates,
            friction,
            weights,
            load_work,
            load_work_rate,
            force,
            force_rate,
            sums[TIME],
            step,
        )
        _advance(pressure, shear, gap, slip, motion, status, rates, friction, weights, step, sums)
        if step >= room:
            sums[TIME] = stop
        else:
            sums[TIME] += step
            counts[EVENTS] += 1
            settled = False
            if counts[EVENTS] > most_events:
                return CYCLING
