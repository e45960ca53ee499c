"""Compiled mathematics. Its functions take arrays and numbers, and return arrays or a code."""

import lazy_loader

# States read a plan's numbers without compiled code, and load it with their first fit.
__getattr__, __dir__, __all__ = lazy_loader.attach(__name__, ["least_squares"])
