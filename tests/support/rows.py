"""Files of growing rows, for the tests of the journal. A process of its own can import this file."""

from pathlib import Path

import numpy as np

from fastpin.storage.journal import open_h5

SIZE, ARRAYS = 50, 3
ROWS = np.random.default_rng(0).random((200, SIZE))


def rows_in(path: Path) -> int:
    """Number of rows of a file, all of which must be right."""
    with open_h5(path) as h5:
        count = int(h5.attrs["rows"])
        for k in range(ARRAYS):
            assert np.array_equal(h5[f"array{k}"][()], ROWS[:count])
        return count
