"""Compiled passes over the nodes: the contact conditions of a configuration, and the errors that a correction mends.

A pass takes a few microseconds with a hundred nodes. In NumPy it takes ten times as long: each operation is a call.
"""

from __future__ import annotations

import numpy as np

from fastpin.kernels.arrays import ContactValues
from fastpin.kernels.status import OPEN, STICK
from fastpin.runtime.jit import compiled, inner

SMALLEST = 1e-300
"""Least scale of a relative error."""

ROUNDING = 5e-15
"""Relative error of gap, slip and equilibrium that is rounding. Corrections end below it."""

ON_BOUND = 1e-12
"""Part of the largest pressure or gap below which a pressure, a shear or a gap is put on its bound."""


@inner
def _larger(largest, value):
    """The larger one of a number and the size of a value; NaN if one of them is NaN."""
    size = abs(value)
    return size if size > largest or size != size else largest


@inner
def _largest(values):
    """The largest size among values."""
    largest = 0.0
    for value in values:
        largest = _larger(largest, value)
    return largest


@inner
def of_load(columns, load, found):
    """Set the first rows of the product of `columns` (k, loads) and a `load`, as many as `found` has numbers."""
    for i in range(found.size):
        found[i] = 0.0
        for k in range(columns.shape[1]):
            found[i] += columns[i, k] * load[k]


@inner
def _displaced(equations, i, motion, elastic, loaded):
    """Gap (without the rest gap) or slip of row i."""
    moved = 0.0
    for k in range(motion.size):
        moved += equations.motion[i, k] * motion[k]
    return elastic[i] + moved + loaded[i]


@inner
def _carried(matrix, values, k):
    """The product of row k of a matrix (r, 2n) and the tractions, and the sum of the sizes of its terms."""
    n, carried, size = values.status.size, 0.0, 0.0
    for i in range(n):
        normal, tangential = matrix[k, i] * values.pressure[i], matrix[k, n + i] * values.shear[i]
        carried += normal + tangential
        size += abs(normal) + abs(tangential)
    return carried, size


@inner
def _balance(equations, values, forces, k):
    """What condition of equilibrium k lacks, and the sum of the sizes of its terms."""
    carried, size = _carried(equations.equilibrium, values, k)
    for j in range(values.motion.size):
        carried += equations.motion_rows[k, j] * values.motion[j]
    return forces[k] - carried, size


@compiled
def review(
    equations, resultants, weights, values, elastic, load, rest_gap, concentric_gap, force, moment, is_held,
):  # fmt: skip
    """The violations of the contact conditions, what is out of equilibrium, and the elastic energy.

    Parameters
    ----------
    equations : Equations
    resultants : ndarray, shape (3 interfaces, 2n)
        Maps (N, T) to the forces along x and y and the moment that each interface passes on.
    weights : ndarray, shape (n,)
    values : ContactValues
        The contact.
    elastic : ndarray, shape (2n,)
        Elastic part of gap and slip.
    load : ndarray, shape (loads,)
    rest_gap, concentric_gap : ndarray, shape (n,)
    force : ndarray, shape (2,)
    moment : float
        Force and moment on the pin.
    is_held : bool
        Whether the moment is the one that the interface of the pin passes on.

    Returns
    -------
    ((float, float, float, float), float, float)
        Largest violations of the conditions: "gap" and "slip" relative to the largest displacement, "cone" relative to
        the largest pressure, "equilibrium" relative to the sum of the sizes of all terms. Then the largest difference
        between what an interface passes on and what acts, relative to the sum of the resultants of the absolute
        tractions. Then the elastic energy, without that of a drive.
    """
    n, closed, gap, slip, cone, energy, left, most = values.status.size, False, 0.0, 0.0, 0.0, 0.0, 0.0, SMALLEST
    loaded, work, forces = np.empty(2 * n), np.empty(2 * n), np.empty(values.motion.size)
    of_load(equations.loads, load, loaded)
    of_load(equations.work, load, work)
    of_load(equations.forces, load, forces)
    for i in range(n):
        opened = _displaced(equations, i, values.motion, elastic, loaded) + rest_gap[i]
        pressure, shear, status = values.pressure[i], values.shear[i], values.status[i]
        energy += pressure * (0.5 * weights[i] * elastic[i] + work[i])
        energy += shear * (0.5 * weights[i] * elastic[n + i] + work[n + i])
        if status == OPEN:
            if not opened >= 0.0:
                gap = _larger(gap, opened)
            cone = _larger(_larger(cone, pressure), shear)
            continue
        closed = True
        gap = _larger(gap, opened)
        slip = _larger(slip, _displaced(equations, n + i, values.motion, elastic, loaded) - values.slip[i])
        excess = abs(shear) - equations.friction[i] * pressure
        if status != STICK:
            excess = abs(shear + status * equations.friction[i] * pressure)
        if not excess <= 0.0:
            cone = _larger(cone, excess)
        if pressure < 0.0:
            cone = _larger(cone, pressure)
    lacking, total = 0.0, 0.0
    for k in range(values.motion.size):
        lacks, size = _balance(equations, values, forces, k)
        lacking, total = _larger(lacking, lacks), total + size
    for row in range(resultants.shape[0]):
        passed, size = _carried(resultants, values, row)
        most += size
        if is_held and row == 2:
            moment = passed
        left = _larger(left, passed - (moment if row % 3 == 2 else force[row % 3]))
    length = max(_largest(elastic), _largest(values.motion), SMALLEST)
    if not closed:
        length, total = max(length, _largest(concentric_gap)), max(total, _largest(forces))
    traction = max(_largest(values.pressure), SMALLEST)
    residuals = gap / length, slip / length, cone / traction, lacking / max(total, SMALLEST)
    return residuals, left / most, energy


@compiled
def drift(elastic, true, gap, slip, motion, most_gap):
    """Largest error of gap and slip (k,), relative to the largest displacement.

    `elastic` and `true` (2k,) are the elastic part, and gap and slip from the matrices. `most_gap` is the largest gap
    of all nodes.
    """
    k, error = gap.size, 0.0
    for i in range(k):
        error = _larger(_larger(error, true[i] - gap[i]), true[k + i] - slip[i])
    return error / max(_largest(elastic), _largest(motion), 1e-4 * most_gap, SMALLEST)


@compiled
def imbalance(equations, values, elastic, loaded, forces, rest_gap, true, missing):
    """What tractions and motion lack until statuses, held slip and load hold.

    Parameters
    ----------
    equations, values, elastic, loaded, forces, rest_gap
        See :func:`review`. The slip of `values` is the one that sticking nodes hold.
    true : ndarray, shape (2n,)
        Is set to gap and slip from the matrices.
    missing : ndarray, shape (2n+m,)
        Is set to the missing gap of closed nodes, the missing slip of sticking ones, and the missing forces.

    Returns
    -------
    float
        The largest of them, relative to the largest elastic displacement and the largest sum of sizes of forces.
        These scales are the present ones, even where an unloading has left little of them.
    """
    n, error, lacking, force = values.status.size, 0.0, 0.0, 0.0
    for i in range(n):
        true[i] = _displaced(equations, i, values.motion, elastic, loaded) + rest_gap[i]
        true[n + i] = _displaced(equations, n + i, values.motion, elastic, loaded)
        missing[i] = 0.0 if values.status[i] == OPEN else -true[i]
        missing[n + i] = values.slip[i] - true[n + i] if values.status[i] == STICK else 0.0
        error = _larger(_larger(error, missing[i]), missing[n + i])
    for k in range(values.motion.size):
        lacks, size = _balance(equations, values, forces, k)
        missing[2 * n + k] = lacks
        lacking, force = _larger(lacking, lacks), _larger(force, size)
    return max(error / max(_largest(elastic), SMALLEST), lacking / max(force, SMALLEST))


@compiled
def correct(friction, tie, change, values):
    """Add a change (2n+m,) of the dependent variables to pressure, shear and motion, in place.

    The change holds tau = T + tie mu N. Slipping nodes stay on the cone of friction.
    """
    n = values.status.size
    for i in range(n):
        if values.status[i] == OPEN:
            continue
        values.pressure[i] += change[i]
        if values.status[i] == STICK:
            values.shear[i] += change[n + i] - tie[i] * friction[i] * change[i]
        else:
            values.shear[i] = -friction[i] * values.status[i] * values.pressure[i]
    for k in range(values.motion.size):
        values.motion[k] += change[2 * n + k]


@compiled
def put_on_bounds(friction, solution, bounded):
    """Set `bounded` to a solution, each value kept within the bounds of its status.

    Parameters
    ----------
    friction : ndarray, shape (n,)
    solution : ContactValues
        With the statuses. The tractions of open nodes and the gaps of closed ones count as 0.
    bounded : ContactValues
        Pressure, shear and gap are set, and the slip where a node does not stick.
    """
    tiny = ON_BOUND * max(_largest(solution.pressure), SMALLEST)
    shortest = ON_BOUND * max(_largest(solution.gap), SMALLEST)
    for i in range(solution.status.size):
        status, pressure, shear, gap = solution.status[i], 0.0, 0.0, 0.0
        if status == OPEN:
            if not solution.gap[i] <= shortest:
                gap = solution.gap[i]
        else:
            pressure, shear = solution.pressure[i], solution.shear[i]
            bound = friction[i] * pressure
            if not pressure > tiny:
                pressure, shear = 0.0, 0.0
            elif status == STICK and abs(shear) > bound - tiny:
                shear = bound if shear >= 0.0 else -bound
        bounded.pressure[i], bounded.shear[i], bounded.gap[i] = pressure, shear, gap
        if status != STICK:
            bounded.slip[i] = solution.slip[i]


@compiled
def beyond_bounds(solution, bounded):
    """How far a solution lies beyond the bounds on which :func:`put_on_bounds` has put it.

    Returns
    -------
    (float, float)
        The largest difference of a pressure, or of the shear of a sticking node; and of the gap of an open node.
    """
    traction, gap = 0.0, 0.0
    for i in range(solution.status.size):
        traction = _larger(traction, bounded.pressure[i] - solution.pressure[i])
        if bounded.status[i] == STICK:
            traction = _larger(traction, bounded.shear[i] - solution.shear[i])
        elif bounded.status[i] == OPEN:
            gap = _larger(gap, bounded.gap[i] - solution.gap[i])
    return traction, gap


@inner
def _respond(tableau, updates, given, values):
    """Set `values` (2n+m,) to the product of the tableau of a held contact, with so many updates, and `given` (2n+m,).

    `given` holds the zero-rate variables, then the m forces out of balance.
    """
    order, n, size = tableau.order, tableau.tied.size, given.size
    placed = np.zeros(size)
    for i in range(size):
        acting = given[i]
        if n <= i < 2 * n:
            acting += tableau.drag[i - n] * given[i - n]
        if acting != 0.0:
            column = tableau.matrix[:, order[i]]  # taken first: the loop over it is vector code
            for row in range(size):
                placed[row] += acting * column[row]
    for i in range(size):
        values[i] = placed[order[i]]
    for i in range(n):
        values[n + i] += tableau.tied[i] * values[i]
    for k in range(updates):
        factor = 0.0
        if tableau.source[k] >= 0:
            factor = values[tableau.source[k]]
        if tableau.slot[k] >= 0:
            factor += tableau.delta[k] * given[tableau.slot[k]]
        if factor != 0.0:
            for i in range(size):
                values[i] += factor * tableau.left[i, k]


@inner
def _multiply(operator, values, elastic):
    """Set `elastic` (2n,) to gap and slip of the tractions of `values`."""
    n = values.status.size
    elastic[:] = 0.0
    for i in range(n):
        if values.status[i] != OPEN:
            for row in range(2 * n):
                elastic[row] += operator[row, i] * values.pressure[i] + operator[row, n + i] * values.shear[i]


@compiled
def correct_held(tableau, updates, operator, equations, contact, loaded, forces, rest_gap, corrected):
    """Correct a held contact until statuses, held slip and load hold to rounding, and put it on its bounds.

    Parameters
    ----------
    tableau : Tableau
        That of a held contact, with so many `updates`.
    updates : int
    operator : ndarray, shape (2n, 2n), column by column
    equations : Equations
    contact : Contact
        It is not changed.
    loaded : ndarray, shape (2n,)
        Gap and slip of the load.
    forces : ndarray, shape (m,)
        Right sides of the conditions of equilibrium.
    rest_gap : ndarray, shape (n,)
    corrected : ContactValues
        All its arrays are set: to the corrected values within their bounds, see :func:`put_on_bounds`.

    Returns
    -------
    (float, float, float, float)
        The error that is left, see :func:`imbalance`; the error before, see :func:`drift`; and how far the corrected
        values lie beyond their bounds, see :func:`beyond_bounds`.
    """
    n, motions = contact.status.size, contact.motion.size
    elastic, true = np.empty(2 * n), np.empty(2 * n)
    missing, change = np.empty(2 * n + motions), np.empty(2 * n + motions)
    pressure, shear, motion = np.zeros(n), np.zeros(n), contact.motion.copy()
    for i in range(n):
        corrected.status[i], corrected.slip[i] = contact.status[i], contact.slip[i]
        if contact.status[i] != OPEN:
            pressure[i], shear[i] = contact.pressure[i], contact.shear[i]
    held = ContactValues(pressure, shear, contact.gap, contact.slip, contact.status, motion)
    before, last = 0.0, np.inf
    while True:
        _multiply(operator, held, elastic)
        error = imbalance(equations, held, elastic, loaded, forces, rest_gap, true, missing)
        if last == np.inf:
            before = drift(elastic, true, contact.gap, contact.slip, contact.motion, _largest(contact.gap))
        if error <= ROUNDING or not error < 0.5 * last:
            break
        last = error
        _respond(tableau, updates, missing, change)
        correct(equations.friction, contact.tie, change, held)
    for k in range(motions):
        corrected.motion[k] = motion[k]
    solution = ContactValues(pressure, shear, true[:n], true[n:], contact.status, motion)
    put_on_bounds(equations.friction, solution, corrected)
    traction, gap = beyond_bounds(solution, corrected)
    return error, before, traction, gap


@compiled
def wanted_status(friction, solution, start_slip, rest_gap, tolerance, wanted):
    """Set `wanted` (n,) to the statuses of a solution, changed where the solution breaks a condition.

    Parameters
    ----------
    friction : ndarray, shape (n,)
    solution : ContactValues
        With the statuses under which it was found.
    start_slip, rest_gap : ndarray, shape (n,)
        Slip before the increment, Eqs. (48) and (49), and the rest gap.
    tolerance : float
        Part of the largest traction or displacement below which nothing changes.
    """
    traction, length = SMALLEST, SMALLEST
    for i in range(solution.status.size):
        traction = max(traction, abs(solution.pressure[i]))
        length = max(length, abs(solution.gap[i] - rest_gap[i]), abs(solution.slip[i] - start_slip[i]))
    traction, length = tolerance * traction, tolerance * length
    for i in range(solution.status.size):
        status, pressure, shear = solution.status[i], solution.pressure[i], solution.shear[i]
        slid = solution.slip[i] - start_slip[i]
        wanted[i] = status
        if status == OPEN:
            if solution.gap[i] < -length:
                wanted[i] = -1 if slid < 0.0 else 1
        elif pressure < -traction:
            wanted[i] = OPEN
        elif status == STICK:
            if abs(shear) > friction[i] * pressure + traction:
                wanted[i] = -1 if shear > 0.0 else 1
        elif friction[i] > 0.0 and status * slid < -length:
            wanted[i] = STICK
