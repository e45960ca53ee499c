"""Many runs of one case: convergence studies and sweeps.

The public names stand in ``__init__.pyi``. They are loaded when first used.
"""

import lazy_loader

from fastpin import assess
from fastpin.moved import with_moved

_face, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
__getattr__ = with_moved(_face, lambda: assess, ("FailureLoad", "failure_load"))
