"""Case files: from TOML text to a case, or to all faults with their lines, and from a case to text.

The public names stand in ``__init__.pyi``. They are loaded when first used.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
