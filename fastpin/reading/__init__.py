"""What the nodes show between them: zones, peaks, cusps, refined tractions and stresses, read from arrays.

The public names stand in ``__init__.pyi``. They are loaded when first used.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
