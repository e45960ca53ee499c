"""CSV files of loads and profiles: columns of any name, unit and sign. Imported when a file is read.

The public names stand in ``__init__.pyi``. They are loaded when first used.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
