"""Another system: with this folder in PYTHONPATH, no Python process loads machine code without Numba.

``PYTHONPATH=tests/support/elsewhere ./scripts/test`` runs the tests as on macOS, Windows or ARM, child processes too.
"""

import importlib.util
import sys
from importlib.machinery import ModuleSpec
from types import ModuleType
from typing import Any


class Elsewhere:
    """Finds the module that loads machine code, and tells it that it can't."""

    def find_spec(self, name: str, *_: Any) -> ModuleSpec | None:
        if name != "fastpin.runtime.machine":
            return None
        sys.meta_path.remove(self)
        found = importlib.util.find_spec(name)
        assert found is not None
        assert found.loader is not None
        execute = found.loader.exec_module

        def and_say_no(module: ModuleType) -> None:
            execute(module)
            module.CAN_LOAD = False

        found.loader.exec_module = and_say_no
        return found


sys.meta_path.insert(0, Elsewhere())
