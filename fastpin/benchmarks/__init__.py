"""The old folder of the names of :mod:`fastpin.published`. They work here for one version, with a warning."""

import lazy_loader

from fastpin import published
from fastpin.moved import with_moved

_face, __dir__, __all__ = lazy_loader.attach(__name__)
__getattr__ = with_moved(_face, lambda: published, ("half_angle", "load_term", "peak_pressure", "Outcome", "Row"))
