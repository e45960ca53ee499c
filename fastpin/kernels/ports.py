"""Compiled tableau of interfaces with ports: columns on demand, and exchanges, see :mod:`fastpin.joints.ports`.

There are S interfaces of k nodes. Each has p outputs and q inputs. The g motions and harmonics are the inputs of all.
"""

from __future__ import annotations

import numpy as np

from fastpin.kernels.exchange import CHUNK, NEEDED_COLUMN, STALE, UPDATES
from fastpin.kernels.exchange import follow as follow_contact
from fastpin.runtime.jit import compiled, inner

# Slots of `counts`: updates that the tables contain, updates of the answers that wait, and the pair of `latest`, or -1.
DONE, WAITING, LATEST = 0, 1, 2


@inner
def _answer(ports, begin, given, moved):
    """Set `moved` (g,) to the product of the answers, from the column `begin` on, and `given` (p,)."""
    answers, left, right = ports.answers, ports.left, ports.right
    for row in range(moved.size):
        own, total, other = answers[row], 0.0, 0.0
        for k in range(0, given.size - 1, 2):  # two sums: each waits for its own last addition only
            total += own[begin + k] * given[k]
            other += own[begin + k + 1] * given[k + 1]
        if given.size % 2 == 1:
            total += own[begin + given.size - 1] * given[given.size - 1]
        moved[row] = total + other
    for update in range(ports.counts[WAITING]):
        factor, own = 0.0, right[update]
        for k in range(given.size):
            factor += given[k] * own[begin + k]
        own = left[update]
        for row in range(moved.size):
            moved[row] += factor * own[row]


@inner
def _exchange(ports, pair, place, own):
    """Exchange the members of a pair, which has the row `own` of an interface."""
    table, inputs, left, right = ports.tables[place], ports.inputs[place], ports.left, ports.right
    nodes, waiting = ports.rows.shape[1], ports.counts[WAITING]
    column, row, moved, by_row = table[own].copy(), table[:, own].copy(), left[waiting], right[waiting]
    pivot, outputs = column[own], column.size - nodes
    column[own] += 1.0
    row[own] -= 1.0
    if ports.counts[LATEST] == pair:
        for i in range(moved.size):
            moved[i] = ports.latest[i]
    else:
        _answer(ports, place * outputs, column[nodes:], moved)
    ports.counts[LATEST] = -1
    for j in range(by_row.size):
        by_row[j] = 0.0
    for i in range(inputs.size):
        factor, answers = row[nodes + i], ports.answers[inputs[i]]
        for j in range(by_row.size):
            by_row[j] += factor * answers[j]
    for update in range(waiting):
        factor, earlier = 0.0, right[update]
        for i in range(inputs.size):
            factor += row[nodes + i] * left[update, inputs[i]]
        for j in range(by_row.size):
            by_row[j] += factor * earlier[j]
    ports.counts[WAITING] += 1
    size = pivot
    for i in range(inputs.size):
        size -= row[nodes + i] * moved[inputs[i]]
    for i in range(moved.size):
        moved[i] /= size
    for i in range(row.size):
        factor, changed = row[i] / pivot, table[i]
        for j in range(column.size):
            changed[j] -= factor * column[j]


@compiled
def catch_up(ports, tableau, updates):
    """Make the first `updates` of the tableau in the tables of their interfaces, until no more answers can wait.

    Parameters
    ----------
    ports : PortTables
        Its tables, answers that wait and counts are changed.
    tableau : Tableau
    updates : int

    Returns
    -------
    bool
        Whether all updates were made.
    """
    counts, nodes = ports.counts, ports.rows.shape[1]
    while counts[DONE] < updates and counts[WAITING] < ports.left.shape[0]:
        source, slot = tableau.source[counts[DONE]], tableau.slot[counts[DONE]]
        pair = max(source, slot)
        place, own = ports.place[pair] // nodes, ports.place[pair] % nodes
        counts[DONE] += 1
        if source == slot:
            _exchange(ports, pair, place, own)
            continue
        table, shear = ports.tables[place], own + nodes // 2
        change = -2.0 * ports.coupling[pair]
        ports.coupling[pair] = -ports.coupling[pair]
        if slot < 0:  # the tie of a sticking node has turned round
            for i in range(table.shape[0]):
                table[i, shear] += change * table[i, own]
        else:  # that of an open node
            for j in range(table.shape[1]):
                table[own, j] -= change * table[shear, j]
            counts[LATEST] = -1
    return counts[DONE] == updates


@inner
def _set_column(ports, tableau, asked):
    """Compute a column of the tableau. All updates must have been made."""
    rows, inputs, counts, moved = ports.rows, ports.inputs, ports.counts, ports.latest
    nodes = rows.shape[1]
    place, own, out = ports.place[asked] // nodes, ports.place[asked] % nodes, tableau.matrix[:, asked]
    column, values = ports.tables[place, own], np.empty(nodes)
    _answer(ports, place * (column.size - nodes), column[nodes:], moved)
    counts[LATEST] = asked
    for section in range(rows.shape[0]):
        for j in range(nodes):
            values[j] = column[j] if section == place else 0.0
        table, felt, i = ports.tables[section], inputs[section], 0
        while i + 4 <= felt.size:  # four in a pass: the values are read and written once
            a, b, c, d = moved[felt[i]], moved[felt[i + 1]], moved[felt[i + 2]], moved[felt[i + 3]]
            at = nodes + i
            first, second, third, fourth = table[at], table[at + 1], table[at + 2], table[at + 3]
            for j in range(nodes):
                values[j] -= (a * first[j] + b * second[j]) + (c * third[j] + d * fourth[j])
            i += 4
        while i < felt.size:
            factor, moving = moved[felt[i]], table[nodes + i]
            for j in range(nodes):
                values[j] -= factor * moving[j]
            i += 1
        for j in range(nodes):
            out[rows[section, j]] = values[j]
    for k in range(out.size - rows.size):
        out[rows.size + k] = -moved[k]
    tableau.fresh[asked] = counts[DONE]


@compiled
def follow(ports, tableau, contact, load, queue, friction, fixed, typical, stop, most_events, all_at_once):
    """Follow the load as :func:`fastpin.kernels.exchange.follow`, and compute the columns that it needs.

    Parameters
    ----------
    ports : PortTables
        Changed in place.
    tableau, contact, load, queue, friction, fixed, typical, stop, most_events, all_at_once
        See :func:`fastpin.kernels.exchange.follow`.

    Returns
    -------
    int
        Its code. STALE comes after every `CHUNK` of updates, and where the answers that wait have to be added up.
    """
    counts = queue.counts
    chunks = counts[UPDATES] // CHUNK
    while True:
        code = follow_contact(tableau, contact, load, queue, friction, fixed, typical, stop, most_events, all_at_once)
        updates = counts[UPDATES]
        if code != STALE or updates // CHUNK > chunks or not catch_up(ports, tableau, updates):
            return code
        _set_column(ports, tableau, counts[NEEDED_COLUMN])
