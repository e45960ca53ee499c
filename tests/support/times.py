"""Processor times of this process. Other processes that run meanwhile don't change them much."""

import gc
import time
from collections.abc import Callable

REPEATS = 5


def growth(work: Callable[[int], object], size: int) -> float:
    """How many times as long twice the size takes: 2 for linear work, 4 for quadratic. The least times count.

    Collecting garbage takes as long as all that other tests have left behind.
    """
    least = {size: float("inf"), 2 * size: float("inf")}
    gc.disable()
    try:
        for _ in range(REPEATS):
            for each in least:
                began = time.process_time()
                work(each)
                least[each] = min(least[each], time.process_time() - began)
    finally:
        gc.enable()
    return least[2 * size] / least[size]
