"""The bodies of a joint, a file each: solid and hollow pins, infinite plates, rings, bushes and any finite plate.

:mod:`fastpin.bodies.body` lists what every body answers. The public names stand in ``__init__.pyi``. They are loaded
when first used.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
