"""Compiled exchange steps: follow the contact along a straight piece of the load history, exactly.

Between two changes of status everything is linear in the load. The tableau holds two pairs for every node: a normal
pair (N, h) and a tangential pair (tau, s), where tau = T + tie mu N. At slipping nodes the tie is the status, and
tau = 0. One member of each pair is *dependent*, the other member has rate zero:

    open:   N and tau have rate zero,  h and s are dependent
    stick:  h and s have rate zero,    N and tau are dependent
    slip:   h and tau have rate zero,  N and s are dependent

The matrix maps the zero-rate variables to the dependent variables. Its last rows give the m motions of the pin. A
change of status exchanges the members of a pair, which is a rank-one update. A change of a tie is a rank-one update
too. Updates are kept in order. A column of the matrix is brought up to date only when it is needed.
Update k adds to column j

    left[:, k] (M_k[source_k, j] + delta_k [j = slot_k]),

where M_k is the matrix before the update; for source_k < 0 the first term is absent. So an update is one vector and
three numbers. Columns are kept in blocks of `WIDTH`. The caller computes the blocks that are needed. It brings them up
to date by matrix products, `CHUNK` updates at a time. Only the rates of the dependent variables are updated
immediately.

Kernels take arrays and numbers, change only arrays among their arguments, and return a code.
"""

from __future__ import annotations

import numpy as np

from fastpin.kernels.status import OPEN, STICK
from fastpin.kernels.status import SLIP_NEGATIVE as NEGATIVE
from fastpin.kernels.status import SLIP_POSITIVE as POSITIVE
from fastpin.runtime.jit import compiled, inner

WIDTH = 32
"""Columns in a block."""

CHUNK = 64
"""Updates applied to a block at a time."""

# Codes that `follow` returns.
REACHED = 0  # the contact is at the requested point of the step
STALE = 1  # the block of the column counts[NEEDED_COLUMN] is not up to date
REBUILD = 2  # a pivot was small, or there is no room for more updates: rebuild the tableau and call again
ALL_AT_ONCE = 3  # all queued statuses were changed at once; the queue holds the old ones: rebuild and call again
NO_SUPPORT = 4  # nothing holds the pin any more
CYCLING = 5  # the statuses did not settle
ARC_END = 6  # the contact reaches an end node
ENDLESS = 7  # more events than allowed
UNBONDED = 8  # a node that must stick slips or opens

# Slots of `counts`.
UPDATES, QUEUED, NEXT, ROUND, EVENTS, EXCHANGES, NEEDED_COLUMN, SETTLED, REPEATED, COUNTS = 0, 1, 2, 3, 4, 5, 6, 7, 8, 9

# Slots of `sums`.
TIME, DISSIPATION, WORK, SEAT_DISSIPATION = 0, 1, 2, 3

# The row of the slip tally that only runs with wear have: pressure times slip distance.
WEAR = 4

MOST_REPEATED = 8  # rounds in which the same node alone changes: it stays neither open nor slipping, so it sticks

VALUE_TOLERANCE = 1e-13  # gaps and reserves mu N - |T| below this part of the largest gap or bound are zero


@inner
def _held_column(tableau, p, out):
    """Write column p of a held contact to `out`, before any update."""
    matrix, order, tied = tableau.matrix, tableau.order, tableau.tied
    n, column = tied.size, order[p]
    for i in range(out.size):
        out[i] = matrix[order[i], column]
    if p < n and tableau.drag[p] != 0.0:
        factor, column = tableau.drag[p], order[n + p]
        for i in range(out.size):
            out[i] += factor * matrix[order[i], column]
    for i in range(n):
        out[n + i] += tied[i] * out[i]


@inner
def _column(tableau, updates, p, out):
    """Write column p after so many updates to `out`. Its block must have been computed."""
    matrix, left = tableau.matrix, tableau.left
    if tableau.order.size == 0:
        for i in range(out.size):
            out[i] = matrix[i, p]
    else:
        _held_column(tableau, p, out)
    k, factors = tableau.fresh[p // tableau.width], tableau.factors
    while k < updates:
        several = 4 if k + 4 <= updates else 1  # four in a pass: the column is read and written once
        for later in range(several):
            factor, source = 0.0, tableau.source[k + later]
            if source >= 0:
                factor = out[source]
                for earlier in range(later):
                    factor += factors[earlier] * left[source, k + earlier]
            if tableau.slot[k + later] == p:
                factor += tableau.delta[k + later]
            factors[later] = factor
        a, b, c, d = factors[0], factors[1], factors[2], factors[3]
        if several == 1:
            for i in range(out.size if a != 0.0 else 0):
                out[i] += a * left[i, k]
        elif a != 0.0 or b != 0.0 or c != 0.0 or d != 0.0:
            for i in range(out.size):
                out[i] = (((out[i] + a * left[i, k]) + b * left[i, k + 1]) + c * left[i, k + 2]) + d * left[i, k + 3]
        k += several


@inner
def _stale(tableau, updates, p):
    """Whether the block of column p was never computed, or lacks a whole chunk of updates."""
    return tableau.fresh[p // tableau.width] < updates - updates % tableau.chunk


@inner
def _exchange(tableau, updates, p):
    """Exchange the members of pair p, and append this update. Column p must stand in left[:, updates]."""
    column, rates = tableau.left[:, updates], tableau.rates
    pivot = column[p]
    column[p] += 1.0
    ratio = rates[p] / pivot
    for i in range(column.size):
        rates[i] -= column[i] * ratio
        column[i] /= -pivot
    tableau.source[updates], tableau.slot[updates], tableau.delta[updates] = p, p, -1.0


@inner
def _add_row(tableau, updates, target, source, factor):
    """Add factor * row `source` to row `target`. This appends one update."""
    left = tableau.left
    for i in range(left.shape[0]):
        left[i, updates] = 0.0
    left[target, updates] = factor
    tableau.rates[target] += factor * tableau.rates[source]
    tableau.source[updates], tableau.slot[updates], tableau.delta[updates] = source, -1, 0.0


@inner
def _add_column(tableau, updates, target, source, factor):
    """Add factor * column `source` to column `target`. This appends one update."""
    column = tableau.left[:, updates]
    _column(tableau, updates, source, column)
    for i in range(column.size):
        column[i] *= factor
    tableau.source[updates], tableau.slot[updates], tableau.delta[updates] = -1, target, 1.0


@inner
def _needed_column(tableau, updates, contact, node, new):
    """The first stale column among the columns that a change of status needs; -1 if none is stale."""
    tangential, old, tie = contact.status.size + node, contact.status[node], contact.tie[node]
    if (old == OPEN or new == OPEN) and _stale(tableau, updates, node):
        return node
    if (old == STICK or new == STICK or (old == OPEN and new != tie)) and _stale(tableau, updates, tangential):
        return tangential
    return -1


@inner
def _change_status(tableau, updates, contact, friction, typical, node, new):
    """Give `node` the status `new`. The values of N and T must fit the old and the new status.

    A sticking node opens in two changes. Returns (updates, size of the pivot over a typical pivot). If the pivot
    belongs to a mechanism, the size is 0 and nothing is changed. Then left[:, updates] holds the motion that would be
    free.
    """
    tangential = contact.status.size + node
    old, tie = contact.status[node], contact.tie[node]
    column = tableau.left[:, updates]
    pair = tangential if old == STICK or new == STICK else node
    _column(tableau, updates, pair, column)
    if old == STICK:  # the stiffness is the change with s of T, not of tau
        stiffness = abs(column[tangential] - tie * friction[node] * column[node]) * typical
    elif new == OPEN:
        stiffness = abs(column[node]) * typical
    else:
        stiffness = np.inf
    if stiffness < 1e-9:  # the pivot belongs to a mechanism
        return updates, 0.0
    if old == STICK or old == OPEN:
        factor = (new - tie) * friction[node]
        if factor != 0.0:
            if old == STICK:
                _add_row(tableau, updates, tangential, node, factor)
            else:
                _add_column(tableau, updates, node, tangential, -factor)
            updates += 1
            column = tableau.left[:, updates]
            _column(tableau, updates, pair, column)
        contact.tie[node] = new
    size = abs(column[pair]) * typical
    if old == OPEN or new == STICK:  # a compliance, not a stiffness
        size = typical / abs(column[pair])
    _exchange(tableau, updates, pair)
    contact.status[node] = new
    return updates + 1, size


@inner
def _shear_rate(rates, contact, friction, i):
    """Rate of T at a sticking node."""
    return rates[contact.status.size + i] - contact.tie[i] * friction[i] * rates[i]


@inner
def _tolerances(rates, contact, friction):
    """The sizes below which rates of tractions and of displacements are zero, by the largest of these rates."""
    status, n = contact.status, contact.status.size
    traction, length = 0.0, 0.0
    for i in range(n):
        if status[i] == OPEN:
            length = max(length, abs(rates[i]), abs(rates[n + i]))
        else:
            traction = max(traction, abs(rates[i]))
            if status[i] == STICK:
                traction = max(traction, abs(_shear_rate(rates, contact, friction, i)))
            else:
                length = max(length, abs(rates[n + i]))
    return 1e-11 * traction, 1e-11 * length


@inner
def _friction_violators(contact, rates, friction, traction_tol, length_tol, queue):
    """Queue the nodes whose friction status contradicts the rates. Returns their number.

    Nodes that are to stick come first, then nodes that are to slip. A node without friction slips either way.
    """
    status, n = contact.status, contact.status.size
    queued = 0
    for i in range(n):
        slipping = status[i] == NEGATIVE or status[i] == POSITIVE
        if slipping and friction[i] > 0.0 and status[i] * rates[n + i] < -length_tol:
            queue.node[queued], queue.status[queued] = i, STICK
            queued += 1
    for i in range(n):
        if status[i] == STICK:
            bound = friction[i] * contact.pressure[i]
            growth = friction[i] * rates[i]
            shear, shear_rate = contact.shear[i], _shear_rate(rates, contact, friction, i)
            if bound == 0.0:
                direction = 1.0 if shear_rate > 0.0 else -1.0
            elif abs(shear) >= bound:
                direction = 1.0 if shear > 0.0 else -1.0
            else:
                continue
            if direction * shear_rate - growth > traction_tol:
                queue.node[queued], queue.status[queued] = i, NEGATIVE if direction > 0.0 else POSITIVE
                queued += 1
    return queued


@inner
def _contact_violators(contact, rates, traction_tol, length_tol, queue):
    """Queue the open nodes that close. If none closes, queue the closed nodes that open. Returns their number."""
    status, n = contact.status, contact.status.size
    queued = 0
    for i in range(n):
        if status[i] == OPEN and contact.gap[i] == 0.0 and rates[i] < -length_tol:
            queue.node[queued], queue.status[queued] = i, NEGATIVE if rates[n + i] < 0.0 else POSITIVE
            queued += 1
    if queued > 0:
        return queued
    for i in range(n):
        if status[i] != OPEN and contact.pressure[i] == 0.0 and rates[i] < -traction_tol:
            queue.node[queued], queue.status[queued] = i, OPEN
            queued += 1
    return queued


@inner
def _relief(free_motion, status, friction, rates, node, direction):
    """The slipping node that sticks first when `node`, the last node that holds the pin, lets go in `direction`.

    `free_motion` (2n+m,) is the motion that becomes free. A node without friction holds nothing. Returns -1 if no node
    would stop this motion.
    """
    n = status.size
    best, chosen = np.inf, -1
    for i in range(n):
        if friction[i] > 0.0 and (status[i] == NEGATIVE or status[i] == POSITIVE) and i != node:
            drift = direction * free_motion[n + i]
            if status[i] * drift < 0.0:
                ratio = abs(rates[n + i]) / abs(drift)
                if ratio < best:
                    best, chosen = ratio, i
    return chosen


@inner
def _next_event(contact, rates, friction, traction_tol, length_tol, limit):
    """Time to the next event, at most `limit`."""
    status = contact.status
    first = limit
    for i in range(status.size):
        rate = rates[i]
        if status[i] == OPEN:
            if rate < -length_tol and contact.gap[i] > 0.0:
                first = min(first, contact.gap[i] / -rate)
        elif contact.pressure[i] > 0.0:
            if rate < -traction_tol:
                first = min(first, contact.pressure[i] / -rate)
            if status[i] == STICK:
                bound, growth = friction[i] * contact.pressure[i], friction[i] * rate
                shear_rate = _shear_rate(rates, contact, friction, i)
                for direction in (-1.0, 1.0):
                    room = bound - direction * contact.shear[i]
                    closing = direction * shear_rate - growth
                    if closing > traction_tol and room > 0.0:
                        first = min(first, room / closing)
    return first


@inner
def _advance(contact, rates, friction, weights, step, stop):
    """Advance the contact by `step`, and set values that reach their bound exactly to it.

    Returns the energy that friction dissipates, and its part at the nodes from `stop` on.
    """
    status, pressure, shear, gap, slip = contact.status, contact.pressure, contact.shear, contact.gap, contact.slip
    n, tally, rest_slip = status.size, contact.slip_tally, contact.rest_slip
    counts, wears = tally.size > 0, tally.shape[0] > WEAR
    most_pressure, most_gap, dissipated, before = 0.0, 0.0, 0.0, 0.0
    for i in range(n):
        if i == stop:
            before = dissipated
        if status[i] == OPEN:
            gap[i] += step * rates[i]
            slip[i] += step * rates[n + i]
            most_gap = max(most_gap, gap[i])
        else:
            old, begin = pressure[i], slip[i]
            pressure[i] += step * rates[i]
            most_pressure = max(most_pressure, pressure[i])
            if status[i] == STICK:
                shear[i] += step * _shear_rate(rates, contact, friction, i)
            else:
                slid = step * rates[n + i]
                slip[i] += slid
                shear[i] = -status[i] * friction[i] * pressure[i]
                dissipated += weights[i] * friction[i] * 0.5 * (old + pressure[i]) * abs(slid)
                if counts:
                    tally[0, i] += abs(slid)
                    tally[1, i] += friction[i] * 0.5 * (old + pressure[i]) * abs(slid)
                if wears:
                    tally[WEAR, i] += 0.5 * (old + pressure[i]) * abs(slid)
            if counts:
                begin, end = begin - rest_slip[i], slip[i] - rest_slip[i]
                tally[2, i] = min(tally[2, i], begin, end)
                tally[3, i] = max(tally[3, i], begin, end)
    for i in range(contact.motion.size):
        contact.motion[i] += step * rates[2 * n + i]
    for i in range(n):
        if status[i] == OPEN:
            if gap[i] <= VALUE_TOLERANCE * most_gap:
                gap[i] = 0.0
        elif pressure[i] <= 1e-10 * most_pressure:  # wider, so that mirrored nodes open together
            pressure[i], shear[i] = 0.0, 0.0
        elif status[i] == STICK:
            bound = friction[i] * pressure[i]
            if abs(shear[i]) >= bound - VALUE_TOLERANCE * most_pressure * friction[i]:
                shear[i] = bound if shear[i] > 0.0 else -bound
    return dissipated, dissipated - before if stop < n else 0.0


@inner
def _reaction_work(contact, rates, friction, load, axis, step):
    """Work of the reaction to a prescribed displacement, per unit of time, over `step`."""
    status, terms = contact.status, load.reactions[axis]
    n = status.size
    moved = terms[2 * n] - terms[2 * n + 1] * rates[2 * n + axis]
    for i in range(n):
        if status[i] != OPEN:
            shear_rate = -status[i] * friction[i] * rates[i]
            if status[i] == STICK:
                shear_rate = _shear_rate(rates, contact, friction, i)
            moved += terms[i] * rates[i] + terms[n + i] * shear_rate
    return (contact.motion[axis] + 0.5 * step * rates[2 * n + axis]) * moved


@inner
def _work(contact, rates, friction, load, time, step):
    """Work of the loads over `step`, exact for the piecewise linear path. Call it before `_advance`.

    At each interface the force acts on the first two motions, the translation. The moment of the shear on its rim acts
    on the third one, the rotation.
    """
    status, n = contact.status, contact.status.size
    middle = time + 0.5 * step
    work, begin = 0.0, 0
    for rim in range(load.stops.size):
        moment, moment_rate, motion = 0.0, 0.0, 2 * n + 3 * rim
        for i in range(begin, load.stops[rim]):
            if status[i] != OPEN:
                if status[i] == STICK:
                    shear_rate = _shear_rate(rates, contact, friction, i)
                else:
                    shear_rate = -status[i] * friction[i] * rates[i]
                moment -= load.levers[i] * contact.shear[i]
                moment_rate -= load.levers[i] * shear_rate
                work += (load.column[i] + middle * load.column_rate[i]) * rates[i]
                work += (load.column[n + i] + middle * load.column_rate[n + i]) * shear_rate
        for k in range(2):
            if load.reactions[k, 2 * n + 2] != 0.0 and rim == 0:
                work += _reaction_work(contact, rates, friction, load, k, step)
            else:
                work += (load.force[k] + middle * load.force_rate[k]) * rates[motion + k]
        work += (moment + 0.5 * step * moment_rate) * rates[motion + 2]
        begin = load.stops[rim]
    return work * step


@inner
def _apply_queue(tableau, contact, queue, friction, typical, fixed):
    """Make the waiting changes of status. Returns REACHED when none is left, or another code."""
    counts = queue.counts
    while counts[NEXT] < counts[QUEUED]:
        node, wanted = queue.node[counts[NEXT]], np.int64(queue.status[counts[NEXT]])  # one type: compiled once
        old = np.int64(contact.status[node])
        if old == wanted:
            counts[NEXT] += 1
            continue
        if fixed[node]:
            return ARC_END if old == OPEN else UNBONDED
        updates = counts[UPDATES]
        if updates + 6 > tableau.left.shape[1]:  # a change needs up to 6, with that of a node that takes over
            return REBUILD
        new = POSITIVE if old == STICK and wanted == OPEN else wanted  # a sticking node slips before it opens
        counts[NEEDED_COLUMN] = _needed_column(tableau, updates, contact, node, new)
        if counts[NEEDED_COLUMN] >= 0:
            return STALE
        updates, size = _change_status(tableau, updates, contact, friction, typical, node, new)
        if size == 0.0:
            if old != STICK:
                return NO_SUPPORT
            # This is the last node that holds the pin: another node must take over first.
            other = _relief(tableau.left[:, updates], contact.status, friction, tableau.rates, node, new)
            if other < 0:
                return NO_SUPPORT
            stick = np.int64(STICK)
            counts[NEEDED_COLUMN] = _needed_column(tableau, updates, contact, other, stick)
            if counts[NEEDED_COLUMN] >= 0:
                return STALE
            updates, _ = _change_status(tableau, updates, contact, friction, typical, other, stick)
            counts[UPDATES] = updates
            updates, size = _change_status(tableau, updates, contact, friction, typical, node, new)
            if size == 0.0:
                return NO_SUPPORT
        counts[UPDATES] = updates
        if new != OPEN:
            contact.touched[node] = True
        if new == wanted:
            counts[NEXT] += 1
            counts[EXCHANGES] += 1
        if size < 1e-6:  # an unusual pivot: rounding has grown by as much
            return REBUILD
    return REACHED


@inner
def _change_all_at_once(contact, queue, queued, fixed):
    """Give all queued nodes their new statuses at once, for a new tableau. The queue keeps the old statuses."""
    for k in range(queued):
        node, new = queue.node[k], queue.status[k]
        if fixed[node]:
            return ARC_END if contact.status[node] == OPEN else UNBONDED
        contact.status[node], queue.status[k] = new, contact.status[node]
        contact.touched[node] = contact.touched[node] or new != OPEN
    queue.counts[NEXT] = queue.counts[QUEUED]
    queue.counts[EXCHANGES] += queued
    return ALL_AT_ONCE


@compiled
def follow(tableau, contact, load, queue, friction, fixed, typical, stop, most_events, all_at_once):
    """Follow the load from sums[TIME] to `stop`, event by event.

    Parameters
    ----------
    tableau, contact, load, queue : Tableau, Contact, LoadTerms, Queue
        All but `load` are changed in place. Time runs from 0 to 1 along the step. Rates are per unit of this time.
    friction : ndarray, shape (n,)
        Coefficient of friction at each node.
    fixed : ndarray of bool, shape (n,)
        Whether a node must keep its status: the end of an arc stays open, and the seat of a bonded bush sticks.
    typical : float
        A typical compliance (diagonal of the operator), to judge pivots.
    stop : float
        Time at which to stop, 0 to 1.
    most_events : int
        With more events than this the code is ENDLESS.
    all_at_once : int
        If more nodes than this violate their statuses, all change at once without exchanges, and ALL_AT_ONCE is
        returned.

    Returns
    -------
    int
        One of the codes above. After STALE, REBUILD and ALL_AT_ONCE the caller calls again. If the caller has set
        counts[SETTLED], the statuses hold until the next event.
    """
    counts, sums, rates = queue.counts, queue.sums, tableau.rates
    settled, measured, traction_tol, length_tol = counts[SETTLED] != 0, -1, 0.0, 0.0
    counts[SETTLED] = 0
    while True:
        code = _apply_queue(tableau, contact, queue, friction, typical, fixed)
        if code != REACHED:
            return code
        if counts[UPDATES] != measured:  # the rates have changed
            measured = counts[UPDATES]
            traction_tol, length_tol = _tolerances(rates, contact, friction)
            if not (np.isfinite(traction_tol) and np.isfinite(length_tol)):
                return NO_SUPPORT

        # Settle the statuses: friction first, then closing, then opening.
        if not settled:
            before = queue.node[0] if counts[QUEUED] == 1 else -1
            queued = _friction_violators(contact, rates, friction, traction_tol, length_tol, queue)
            if queued > 1 and counts[ROUND] >= 12:  # all together did not settle: the lowest node alone
                for k in range(1, queued):
                    if queue.node[k] < queue.node[0]:
                        queue.node[0], queue.status[0] = queue.node[k], queue.status[k]
                queued = 1
            if queued == 0:
                queued = _contact_violators(contact, rates, traction_tol, length_tol, queue)
            counts[NEXT], counts[QUEUED] = 0, queued
            if queued > 0:
                counts[ROUND] += 1
                counts[REPEATED] = counts[REPEATED] + 1 if queued == 1 and queue.node[0] == before else 0
                if counts[REPEATED] > 2 * MOST_REPEATED or counts[ROUND] > 4 * contact.status.size + 200:
                    return CYCLING
                if counts[REPEATED] > MOST_REPEATED and queue.status[0] == OPEN and friction[queue.node[0]] > 0.0:
                    queue.status[0] = STICK
                if queued > all_at_once:
                    return _change_all_at_once(contact, queue, queued, fixed)
                continue
            settled = True
            counts[ROUND] = 0

        # Advance to the next event.
        if sums[TIME] >= stop:
            return REACHED
        room = stop - sums[TIME]
        step = _next_event(contact, rates, friction, traction_tol, length_tol, room)
        sums[WORK] += _work(contact, rates, friction, load, sums[TIME], step)
        dissipated, in_seat = _advance(contact, rates, friction, load.weights, step, load.stops[0])
        sums[DISSIPATION] += dissipated
        sums[SEAT_DISSIPATION] += in_seat
        if step >= room:
            sums[TIME] = stop
        else:
            sums[TIME] += step
            counts[EVENTS] += 1
            settled = False
            if counts[EVENTS] > most_events:
                return ENDLESS
