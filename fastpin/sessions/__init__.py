"""Sessions: one load after another, with changes of the problem, and places to go back to.

The public names stand in ``__init__.pyi``. They are loaded when first used.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
