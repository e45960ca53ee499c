"""The solvers: they follow the load history of a problem and return a result.

The public names stand in ``__init__.pyi``. They are loaded when first used.
"""

from __future__ import annotations

from typing import Any

import lazy_loader

from fastpin.moved import with_moved


def _wing(name: str) -> Any:
    import fastpin.sessions
    import fastpin.wear_lives

    return getattr(fastpin, name)


_face, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
__getattr__ = with_moved(
    with_moved(_face, lambda: _wing("sessions"), ("Session",)),
    lambda: _wing("wear_lives"),
    ("WearResult", "WornCycle"),
)
