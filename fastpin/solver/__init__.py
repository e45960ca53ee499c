"""The solvers: they follow the load history of a problem and return a result.

The public names stand in ``__init__.pyi``. They are loaded when first used.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
