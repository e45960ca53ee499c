"""The input: materials, loads, nodes, options, and the problem. All are checked, frozen and in SI units.

The public names stand in ``__init__.pyi``. They are loaded when first used. The bodies have moved to
:mod:`fastpin.bodies`.
"""

import lazy_loader

from fastpin import bodies
from fastpin.moved import with_moved

_face, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
__getattr__ = with_moved(_face, lambda: bodies, bodies.__all__)
