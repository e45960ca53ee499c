"""Units in which people write loads: their names, and the way of a number in such a unit to SI units."""

from __future__ import annotations

import math
import re
from typing import Literal, NamedTuple

from fastpin.errors import InputError
from fastpin.model.checks import as_toml
from fastpin.model.loads import LOAD_KIND
from fastpin.model.synonyms import closest
from fastpin.model.unit_systems import INCH, POUND, SI, Measure
from fastpin.model.units import measures_of


class LoadUnit(NamedTuple):
    """The way of a number in a unit to SI units: times `factor` and 10 to the `power`.

    A power of ten is put behind the digits of a number, so 1.005 kN are exactly 1005 N. The number `zero` is 0; a unit
    whose own zero lies elsewhere has NaN until the user gives it.
    """

    power: int = 0
    factor: float = 1.0
    zero: float = 0.0


class Basis(NamedTuple):
    """How loads are given.

    Attributes
    ----------
    how : {"per metre", "with thickness", "dimensionless"}
        Per metre of thickness, in N and N m for a given thickness, or in the paper's units.
    system : str
        The system of units of numbers without a unit, see :func:`fastpin.model.unit_systems.checked_system`.
    """

    how: Literal["per metre", "with thickness", "dimensionless"] = "per metre"
    system: str = SI


IN_SI = Basis()
"""Loads per metre of thickness in SI units."""

_UNITS = {
    "traction": {
        "Pa": LoadUnit(),
        "kPa": LoadUnit(3),
        "MPa": LoadUnit(6),
        "GPa": LoadUnit(9),
        "N/mm^2": LoadUnit(6),
        "bar": LoadUnit(5),
        "psi": LoadUnit(0, POUND / INCH**2),
        "ksi": LoadUnit(3, POUND / INCH**2),
    },
    "rotation": {
        "rad": LoadUnit(),
        "mrad": LoadUnit(-3),
        "urad": LoadUnit(-6),
        "deg": LoadUnit(0, 0.017453292519943295),
    },
    "displacement": {
        "m": LoadUnit(),
        "mm": LoadUnit(-3),
        "um": LoadUnit(-6),
        "nm": LoadUnit(-9),
        "in": LoadUnit(0, INCH),
        "mil": LoadUnit(-3, INCH),
    },
    "ratio": {"%": LoadUnit(-2)},
    "temperature": {"K": LoadUnit(), "C": LoadUnit(zero=math.nan), "F": LoadUnit(factor=5.0 / 9.0, zero=math.nan)},
}
_PER_METRE = {
    **_UNITS,
    "force": {
        "N/m": LoadUnit(),
        "kN/m": LoadUnit(3),
        "MN/m": LoadUnit(6),
        "N/mm": LoadUnit(3),
        "kN/mm": LoadUnit(6),
        "lbf/in": LoadUnit(0, POUND / INCH),
    },
    "moment": {
        "N": LoadUnit(),
        "kN": LoadUnit(3),
        "N m/m": LoadUnit(),
        "kN m/m": LoadUnit(3),
        "N mm/mm": LoadUnit(),
        "lbf in/in": LoadUnit(0, POUND),
    },
}
_WITH_THICKNESS = {
    **_UNITS,
    "force": {
        "N": LoadUnit(),
        "kN": LoadUnit(3),
        "MN": LoadUnit(6),
        "daN": LoadUnit(1),
        "kgf": LoadUnit(0, 9.80665),
        "lbf": LoadUnit(0, POUND),
        "kip": LoadUnit(3, POUND),
    },
    "moment": {
        "N m": LoadUnit(),
        "kN m": LoadUnit(3),
        "N mm": LoadUnit(-3),
        "lbf in": LoadUnit(0, POUND * INCH),
        "lbf ft": LoadUnit(0, 12.0 * POUND * INCH),
    },
}

_OTHER_WORDS = {
    "lb": "lbf",
    "lbs": "lbf",
    "kips": "kip",
    "Nm": "N m",
    "kNm": "kN m",
    "Nmm": "N mm",
    "Nm/m": "N m/m",
    "kNm/m": "kN m/m",
    "in lbf": "lbf in",
    "ft lbf": "lbf ft",
    "in lb": "lbf in",
    "lb in": "lbf in",
    "ft lb": "lbf ft",
    "lb ft": "lbf ft",
    "lb/in": "lbf/in",
    "N/mm2": "N/mm^2",
    "micron": "um",
    "microns": "um",
    "inch": "in",
    "degree": "deg",
    "degrees": "deg",
    "degC": "C",
    "degF": "F",
    "deg C": "C",
    "deg F": "F",
}
_SIGNS = str.maketrans({"µ": "u", "μ": "u", "²": "2", "·": " ", "⋅": " ", "*": " ", "°": "deg", "-": " ", ".": " "})


def unit_name(text: str) -> str:
    """Return the usual spelling of a unit, without brackets around it. An unknown text is returned as it is."""
    bare = text.strip()
    inner = re.fullmatch(r"\[(.*)\]|\((.*)\)", bare)
    bare = (inner[1] or inner[2] or "").strip() if inner else bare
    plain = " ".join(bare.translate(_SIGNS).replace("^", "").replace("2", "^2").split())
    name = _OTHER_WORDS.get(plain, plain)
    return name if is_unit(name) else bare


def is_unit(name: str) -> bool:
    """Whether a name is the usual spelling of a unit of some load."""
    return any(name in units for table in (_PER_METRE, _WITH_THICKNESS) for units in table.values())


def is_unit_of(load: str, name: str) -> bool:
    """Whether a name is the usual spelling of a unit of this load: of a force or moment, per thickness or not.

    A moment per thickness in N is left out: it looks like a force.
    """
    kind = LOAD_KIND[load]
    return name in _WITH_THICKNESS[kind] or (name in _PER_METRE[kind] and name not in _WITH_THICKNESS["force"])


def plain_unit(kind: str, basis: Basis) -> LoadUnit:
    """The unit of a number of a kind without a unit."""
    way = measures_of(basis.system, basis.how == "with thickness").get(kind, Measure(""))
    return LoadUnit(way.power, way.factor)


def load_unit(load: str, name: str, basis: Basis) -> LoadUnit:
    """Return a unit by its usual spelling; an empty one is that of the basis.

    Raises
    ------
    InputError
        If the load can't be in this unit. The sentence lists the units. Its field is the load.
    """
    if not name:
        return plain_unit(LOAD_KIND.get(load, ""), basis)
    if basis.how == "dimensionless":
        words = "the loads of a problem with load_parameter have no units; leave the unit out"
        raise InputError(load, f"{words}, not {as_toml(name)}")
    kind = LOAD_KIND[load]
    units = (_PER_METRE if basis.how == "per metre" else _WITH_THICKNESS)[kind]
    if name in units:
        return units[name]
    other = (_WITH_THICKNESS if basis.how == "per metre" else _PER_METRE)[kind]
    hint = closest(name, units)
    if name in other:
        hint = (
            "; give the thickness for loads in N and N m"
            if basis.how == "per metre"
            else "; with a thickness loads are in N and N m"
        )
    *most, last = units
    allowed = f"in {', '.join(most)} or {last}" if most else f"a plain number or in {last}"
    words = {"traction": "stress", "displacement": "length"}.get(kind, kind)
    raise InputError(load, f"a {words} must be {allowed}, not {as_toml(name)}{hint}")
