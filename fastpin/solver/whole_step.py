"""A straight change of the load in one call of the kernel, from the held contact to the corrected end.

Most steps of a history with few nodes need nothing else. A :class:`fastpin.solver.path.PathStep` follows the others
from their start. It begins with the same calls, so a step has the same bits either way.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fastpin.elasticity.system import System
from fastpin.kernels import exchange
from fastpin.kernels.arrays import Contact, Queue
from fastpin.solver.configuration import Configuration
from fastpin.solver.held import HeldColumns, HeldContacts, begins_held
from fastpin.solver.path import MOST_ERROR, MOST_EVENTS, SEVERE_DRIFT, exceeds_bounds, load_terms
from fastpin.solver.slip_tally import SlipTally
from fastpin.solver.tableau import TableauMemory


class WholeStep(NamedTuple):
    """A step that was followed to its end.

    Attributes
    ----------
    now : Configuration
        The configuration at the end.
    touched : ndarray of bool, shape (n,)
        Whether each node was ever closed during the step.
    events, exchanges : int
        Changes of status that the load has reached, and exchanges that the tableau has made.
    """

    now: Configuration
    touched: np.ndarray
    events: int
    exchanges: int


def follow(system: System, start: Configuration, after: np.ndarray, memory: TableauMemory) -> WholeStep | None:
    """Follow the load from a configuration in contact, which is not changed, to `after` (loads,), dimensionless.

    None if the step needs more than this. The `memory` is overwritten.
    """
    n = start.status.size
    table = HeldContacts.of(system).table(system, start.closed) if begins_held(system) else None
    if table is None:
        return None
    contact = Contact(
        start.pressure.copy(), start.shear.copy(), start.gap.copy(), start.slip.copy(), start.status.copy(),
        start.status.copy(), np.zeros(n, dtype=bool), start.motion.copy(), start.rest_slip,
        start.slip_tally.sums.copy(),
    )  # fmt: skip
    sums = np.array([0.0, start.dissipation, start.work, start.seat_dissipation])
    counts = np.zeros(exchange.COUNTS, dtype=np.int64)
    queue = Queue(np.zeros(2 * n, dtype=np.int64), np.zeros(2 * n, dtype=np.int8), counts, sums)
    rate = after - start.load
    columns = HeldColumns(system, table, contact, start.load, rate, start.rest_gap, memory)
    code = columns.follow(load_terms(system, start.load, rate), queue, 1.0, MOST_EVENTS * n, n)
    if code != exchange.REACHED:
        return None
    correction = columns.correct(start)
    if correction.drift > SEVERE_DRIFT or not correction.error <= MOST_ERROR or exceeds_bounds(correction):
        return None
    now = correction.settled
    now.load, now.slip_tally = after.copy(), SlipTally(contact.slip_tally)
    _, now.dissipation, now.work, now.seat_dissipation = sums.tolist()
    return WholeStep(now, contact.touched, int(counts[exchange.EVENTS]), int(counts[exchange.EXCHANGES]))
