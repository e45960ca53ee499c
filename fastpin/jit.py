"""The one place for the settings of compiled code.

Set ``FASTPIN_CACHE=0`` to compile without an on-disk cache; Numba's own ``NUMBA_DISABLE_JIT=1`` runs everything
as plain Python.
"""

from __future__ import annotations

import os

import numba

compiled = numba.njit(cache=os.environ.get("FASTPIN_CACHE", "1") != "0", error_model="numpy", nogil=True)
"""Decorator of every kernel: cached, no fastmath, no parallel sums, division by zero gives inf or nan."""
