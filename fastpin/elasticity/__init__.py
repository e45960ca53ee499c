"""The linear response of pin and plate to tractions and loads. Its public names have moved to :mod:`fastpin.lugs`."""

import lazy_loader

from fastpin import lugs
from fastpin.moved import with_moved

_face, __dir__, __all__ = lazy_loader.attach(__name__)
__getattr__ = with_moved(_face, lambda: lugs, ("PlateResult", "plate_compliance"))
