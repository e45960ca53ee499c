"""The input: materials, loads, nodes, options, and the problem. All are checked, frozen and in SI units.

The public names stand in ``__init__.pyi``. They are loaded when first used. The bodies have moved to
:mod:`fastpin.bodies`, plates of any outline to :mod:`fastpin.lugs`.
"""

import lazy_loader

from fastpin import bodies, lugs
from fastpin.moved import with_moved

_face, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
__getattr__ = with_moved(
    with_moved(_face, lambda: bodies, bodies.__all__), lambda: lugs, ("Hole", "Lug", "Part", "PartLoad")
)
