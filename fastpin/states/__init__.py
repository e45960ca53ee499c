"""States of the contact, and the quantities that are read from a state.

The public names stand in ``__init__.pyi``. They are loaded when first used.
"""

import lazy_loader

from fastpin import reading
from fastpin.moved import with_moved

_face, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
__getattr__ = with_moved(
    _face, lambda: reading, ("BushFit", "HoopPeak", "Stress", "hoop", "joint", "refined", "stress")
)
