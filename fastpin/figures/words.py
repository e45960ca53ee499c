"""The words on axes and in captions of figures."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Callable, Mapping, Sequence

import numpy as np

from fastpin.assess.outputs import ROUNDING
from fastpin.bodies.bushing import STUCK
from fastpin.model import Laminate, Material, Problem, Profile
from fastpin.model.checks import shortened
from fastpin.model.loads import LOAD_KIND, LOADS
from fastpin.model.points import owner_of
from fastpin.model.units import PASCAL, Unit, acting_loads, units
from fastpin.states.quantities import load_point, point_name
from fastpin.states.state import State

ANGLE = "angle from the bottom of the hole, counter-clockwise (deg)"
"""Words of the axis of angles."""

DIGITS, LOAD_DIGITS = 3, 5
"""Significant digits of a parameter in a caption, and of a load in a heading."""

CAPTION_SIZE = 7.2
"""Size of a caption, points."""

CHARACTER = 0.0072
"""Mean width of a character, inches for each point of its size."""


def shown_unit(unit: str) -> str:
    """A unit as figures show it: with the letters for micro and beta."""
    unit = unit.replace("beta*", "β*").replace("^2", "²").replace("^3", "³").replace("sqrt(m)", "√m")
    return f"µ{unit[1:]}" if unit[:1] == "u" and len(unit) > 1 else unit


def shown_label(label: str) -> str:
    """A label with the letters of figures in its units."""
    label = re.sub(r"\(([^()]*)\)$", lambda found: f"({shown_unit(found[1])})", label)
    return re.sub(r"(?<=\d )u(?=\w+$)", "µ", label, flags=re.MULTILINE).replace(" -", " −")


def quantity(words: str, unit: str = "") -> str:
    """The words of an axis: a quantity, with its unit in parentheses if it has one."""
    return f"{words} ({shown_unit(unit)})" if unit else words


def without_rounding(values: np.ndarray, largest: float | None = None) -> np.ndarray:
    """Values with 0 in place of those below rounding. `largest` is their natural size; theirs unless given."""
    size = float(np.nanmax(np.abs(values), initial=0.0)) if largest is None else largest
    return np.where(np.abs(values) <= ROUNDING * size, 0.0, values)


def point_text(state: State) -> str:
    """The load point of a state as text: with thousands apart, and at most three decimals."""
    return f"{load_point(state):,.3f}".rstrip("0").rstrip(".")


def points_text(states: Sequence[State]) -> str:
    """The load points of states as text, for readers who can't see their curves."""
    return ", ".join(point_name(load_point(state)) for state in states)


def load_text(states: Sequence[State], index: int, name: str) -> str:
    """A load of one of the states with its unit as text. All loads of one kind have the same unit."""
    same_kind = [state.load[other] for state in states for other in LOADS if LOAD_KIND[other] == LOAD_KIND[name]]
    factor, unit = units(states[0].problem)[LOAD_KIND[name]].scale(same_kind)
    load = states[index].load[name]
    if abs(load) <= ROUNDING * max(map(abs, same_kind)):
        return f"{name} = 0"
    value = f"{load * factor:+.4g}".replace("-", "−")
    return f"{name} = {value.lstrip('+') if name == 'P' else value} {shown_unit(unit)}"


def loads_by_change(states: Sequence[State]) -> tuple[list[str], list[str]]:
    """Return the names of the acting loads that are equal in all states, and that differ beyond rounding."""
    acting = acting_loads([state.load for state in states])
    values = {name: np.array([state.load[name] for state in states]) for name in acting}
    differing = [name for name in acting if np.ptp(values[name]) > ROUNDING * np.abs(values[name]).max()]
    return [name for name in acting if name not in differing], differing


def is_bonded(problem: Problem) -> bool:
    """Whether a contact is the seat of a bonded bush: its friction stands for the bond, and has no bounds to show."""
    return problem.pin_body.is_bush and problem.least_friction >= STUCK


def caption(problem: Problem, states: Sequence[State] = ()) -> str:
    """The parameters of a problem as text: materials, bodies, friction, sizes, and the load parameter of the states."""
    unit = units(problem)
    pair = problem.pair
    pin_body = problem.pin_body.caption(problem.pin_load, lambda length: short(length, unit["length"]))
    plate_body = problem.plate_body.caption(
        lambda length: short(length, unit["length"]), lambda material: _material(material, problem)
    )
    parts = [
        f"{owner_of(problem, 'pin')}: {_material(pair.pin, problem)}{pin_body}; plate: {_material(pair.plate, problem)}"
    ]
    parts[0] += f"{plate_body}; plane {pair.plane}"
    parts.append("bonded" if is_bonded(problem) else f"friction coefficient {problem.friction_words(DIGITS)}")
    if isinstance(problem.friction, Profile):
        parts[-1] += f": {_profile_words(problem.friction, lambda value: f'{value:.{DIGITS}g}')}"
    for name, profile in problem.gap.given.items():
        words = _profile_words(profile, lambda gap: short(gap, unit["displacement"]))
        parts.append(f"initial gap of the {name}: {words}")
    if not problem.dimensionless:
        parts.append(f"hole radius {short(problem.hole_radius, unit['length'])}")
        word = "clearance" if problem.clearance > 0.0 else "interference"
        size = short(abs(problem.clearance), unit["length"])
        parts.append(f"{word} {size}" if problem.clearance else "neat fit")
    if problem.thickness is not None:
        parts.append(f"thickness {short(problem.thickness, unit['length'])}")
    forces = [float(np.hypot(state.load["P"], state.load["Q"])) for state in states]
    parameters = sorted({f"{problem.load_parameter(force):.{DIGITS}g}": force for force in forces if force}, key=float)
    if parameters:
        ends = list(dict.fromkeys([parameters[0], parameters[-1]]))
        parts.append(f"load parameter {' to '.join(ends)}".replace("-", "−"))
    return ", ".join(parts)


def _profile_words(profile: Profile, text: Callable[[float], str]) -> str:
    """The terms of a profile as one part of a caption, which parts at commas and semicolons."""
    return profile.words(text).replace("; and", ";").replace("; ", " and ").replace(", ", ",\N{NO-BREAK SPACE}")


def wrapped(text: str, width: float, size: float = CAPTION_SIZE) -> list[str]:
    """The lines of a text that is `width` inches wide in letters of `size` points."""
    return textwrap.wrap(text, max(20, int(width / (CHARACTER * size))))


def wrapped_parts(text: str, width: float, size: float = CAPTION_SIZE) -> list[str]:
    """As :func:`wrapped`, for a list with commas or semicolons: lines end after these where they can."""
    most = max(20, int(width / (CHARACTER * size)))
    rows: list[str] = []
    for part in re.split("(?<=[,;]) ", text):
        if rows and len(rows[-1]) + 1 + len(part) <= most:
            rows[-1] += f" {part}"
        else:
            rows += wrapped(part, width, size)
    return rows


def short_load(problem: Problem, name: str, value: float) -> str:
    """A load with its unit as a caption shows it; forces and moments are in N and N m if there is a thickness."""
    return short(value, units(problem)[LOAD_KIND[name]])


def range_text(problem: Problem, name: str, span: tuple[float, float]) -> str:
    """A load, or the range of its values, with its unit."""
    if span[0] == span[1]:
        return f"{name} = {short_load(problem, name, span[0])}"
    factor, unit = units(problem)[LOAD_KIND[name]].scale(span)
    low, high = (f"{factor * value:.{DIGITS}g}".replace("-", "−") for value in span)
    return f"{name}: {low} to {high}\N{NO-BREAK SPACE}{shown_unit(unit)}"


def loads_text(problem: Problem, load: Mapping[str, float]) -> str:
    """The loads that are not zero, with their units, as a heading shows them."""
    parts = []
    for name in acting_loads([load]):
        parts.append(f"{name} = {short(load[name], units(problem)[LOAD_KIND[name]], LOAD_DIGITS)}")
    return ", ".join(parts) or "no load"


def short(value: float, unit: Unit, digits: int = DIGITS) -> str:
    """A value with its unit as a caption shows it, rounded to so many significant digits."""
    number, _, label = unit.text(value, digits).partition(" ")
    return f"{number.replace('-', '−')}\N{NO-BREAK SPACE}{shown_unit(label)}".strip()


def _material(material: Material, problem: Problem) -> str:
    if material.is_rigid:
        return "rigid"
    if isinstance(material, Laminate):
        return shortened(material.label)
    if material.label:
        return shortened(material.label)
    modulus = f"{material.E:.{DIGITS}g}/β*" if problem.dimensionless else short(material.E, PASCAL)
    return f"E = {modulus}, ν = {material.nu:.{DIGITS}g}"
