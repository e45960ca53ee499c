"""Histories of recorded samples: their last cycle to be repeated, and their turning points alone."""

from __future__ import annotations

import numpy as np

from fastpin.errors import InputError
from fastpin.model.history import Block, LoadHistory
from fastpin.model.turning import least_reversal, turning_points


def with_last_cycle(history: LoadHistory) -> LoadHistory:
    """Return a history whose last block is its last cycle: a recorded cycle at its end becomes a block of its own.

    A history without such a cycle is returned as it is.
    """
    *before, last = history.blocks
    if last.cycle or last.count > 1 or not last.lengths or not last.ends[-1]:
        return history
    begin = len(last.given) - last.lengths[last.ends[-1] - 1]
    cycle = Block(last.given[begin:], np.zeros(len(last.given) - begin, dtype=np.int64), cycle=True)
    return LoadHistory.of_blocks([*before, *last.cut(0, begin), cycle])


def turning_corners(history: LoadHistory) -> LoadHistory:
    """Return the corners at which a load of a record turns back by more than its noise, with the first and the last.

    Each load counts whose column has no gaps. See :func:`fastpin.model.turning.least_reversal`.

    Raises
    ------
    InputError
        If the history is no single table of samples.
    """
    if len(history.blocks) > 1 or history.blocks[0].count > 1:
        raise InputError("history", "must be one record of samples, without repeated blocks")
    table = history.blocks[0].given
    columns = [each for each in table.T if not np.isnan(each).any() and np.ptp(each) > 0.0]
    places = [turning_points(each, least_reversal(each)) for each in columns]
    kept = np.unique(np.concatenate([np.array([0, len(table) - 1]), *places]))
    return LoadHistory.of_blocks([Block(table[kept].copy(), np.zeros(kept.size, dtype=np.int64))])
