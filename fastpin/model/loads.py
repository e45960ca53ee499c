"""The loads: their names, their kinds, their order in a load vector, and the checks of a corner."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from fastpin.errors import InputError
from fastpin.model.checks import LONGEST_TEXT, as_toml, number
from fastpin.model.synonyms import closest


class Load(NamedTuple):
    """A load.

    Attributes
    ----------
    kind : str
        Its kind of quantity, a key of :func:`fastpin.model.units.units`.
    short : str
        Its name on an axis.
    words : str
        Its meaning, with its sign, for reports.
    """

    kind: str
    short: str
    words: str


LOAD = {
    "P": Load("force", "force P", "force on the pin downwards"),
    "Q": Load("force", "force Q", "force on the pin to the right"),
    "M": Load("moment", "moment M", "moment on the pin, counter-clockwise"),
    "sxx": Load("traction", "remote stress sxx", "remote stress of the plate along x"),
    "syy": Load("traction", "remote stress syy", "remote stress of the plate along y"),
    "rotation": Load("rotation", "rotation of the pin", "prescribed rotation of the pin, counter-clockwise"),
    "sxy": Load("traction", "remote stress sxy", "remote shear stress of the plate"),
    "ux": Load("displacement", "displacement ux", "prescribed displacement of the pin to the right"),
    "uy": Load("displacement", "displacement uy", "prescribed displacement of the pin upwards"),
    "friction_change": Load("ratio", "change of the friction", "relative change of the coefficient of friction"),
    "temperature": Load("temperature", "rise of the temperature", "rise of all temperatures over that of the fit"),
    "pin_temperature": Load("temperature", "rise of the pin's temperature", "further rise of the pin's temperature"),
}
"""The loads by name.

* ``P``: force on the pin downwards (-y), N/m.
* ``Q``: force on the pin along +x, N/m.
* ``M``: moment on the pin, counter-clockwise, N (per unit thickness); only for a pin that rotates freely.
* ``sxx``, ``syy``: remote normal stresses in the plate, Pa.
* ``rotation``: prescribed rotation of the pin, rad, counter-clockwise; only for a pin whose rotation is fixed, or of
  the far end of the spring that holds it.
* ``sxy``: remote shear stress in the plate, Pa.
* ``ux``, ``uy``: prescribed displacement of the pin along +x and +y, m, from the concentric position; only where the
  problem's ``drive`` says so. Q is then the reaction to ``ux``, and P to ``uy``.
* ``friction_change``: relative change of the coefficient of friction, a plain number from -1. All round the hole the
  friction is that of the problem times 1 + ``friction_change``.
* ``temperature``: rise of the temperature of all bodies, K, over that at which the clearance is given. The bodies
  expand, each by its material's ``expansion``, and the fit changes. Supports and bonded bushes may hinder them.
* ``pin_temperature``: further rise of the temperature of the pin, K. It adds to ``temperature``.

Files hold load vectors, so a new load stands at the end.
"""

LOADS = tuple(LOAD)
"""Names of the loads, in the order of every load vector."""

LOAD_KIND = {name: load.kind for name, load in LOAD.items()}
"""The kind of quantity of every load."""

P, Q, M, SXX, SYY, ROTATION, SXY, UX, UY, FRICTION_CHANGE, TEMPERATURE, PIN_TEMPERATURE = range(len(LOADS))
"""Places of the loads in a load vector."""

ACTING = FRICTION_CHANGE
"""Number of mechanical loads, the first ones. Later loads change the friction or the fit."""

LATER = LOADS[ACTING:]
"""Names of the later loads. JSON has them only where they are given, as files of older versions."""

THERMAL = (TEMPERATURE, PIN_TEMPERATURE)
"""Places of the temperatures in a load vector."""

REMOTE = tuple(place for place, kind in enumerate(LOAD_KIND.values()) if kind == "traction")
"""Places of the remote stresses in a load vector."""

STRESSING = (*REMOTE, TEMPERATURE)
"""Places of the loads that may stress a plate by themselves. A temperature does where something hinders expansion."""

Corner = Mapping[str, float]
"""Loads at a corner of a history, by name."""


def load_index(name: object, where: str) -> int:
    """Return the place of a load in a load vector.

    Raises
    ------
    InputError
        If there is no such load. Its field is `where`, the place of the name in the input.
    """
    if isinstance(name, str) and name in LOADS:
        return LOADS.index(name)
    is_word = isinstance(name, str) and len(name) < LONGEST_TEXT
    hint = closest(str(name), LOADS) if is_word else ""
    known = f"the loads are {', '.join(LOADS)}{hint}"
    raise InputError(where, f"unknown load {as_toml(name)}; {known}")


def check_corner(field: str, loads: Corner) -> dict[str, float]:
    """Return `loads` as numbers, or raise :class:`InputError` if a load is unknown or its value no finite number."""
    if not isinstance(loads, Mapping):
        raise InputError(field, f"must map load names to numbers, not {as_toml(loads)}")
    return {LOADS[load_index(name, field)]: number(f"{name} of {field}", value) for name, value in loads.items()}


def named_load(vector: np.ndarray) -> dict[str, float]:
    """A load vector, shape (loads,), as a dict from load name to value."""
    return dict(zip(LOADS, vector.tolist(), strict=True))


def complete_load(given: np.ndarray, last: np.ndarray) -> np.ndarray:
    """All loads at a corner, shape (loads,). A load that is NaN in `given` keeps its value in `last`."""
    return np.where(np.isnan(given), last, given) + 0.0  # + 0.0 turns -0 into 0
