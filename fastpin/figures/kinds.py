"""The kinds of figures of a result, with their options. Nothing heavy is imported here: help is answered at once.

A line of :data:`KINDS` is a kind for ``fastpin plot``.
"""

from __future__ import annotations

from typing import NamedTuple


class KindOption(NamedTuple):
    """An option of some kinds of figures.

    Attributes
    ----------
    words : str
        Its help on the command line.
    metavar : str or None
        The name of its value there.
    type : str
        "text", "number" or "flag" (without a value).
    """

    words: str
    metavar: str | None = None
    type: str = "text"


DEFAULT_KEY_FIGURE = "peak_pressure"
"""The key figure in the figure of a sweep without outcomes, unless another one is chosen."""

STATES_HELP = "last, cycle (the last one), all, load points such as 2,3.5, or ranges such as 1-9,20-"
"""Help on the choice of states."""

KIND_OPTIONS = {
    "states": KindOption(STATES_HELP, "WHICH"),
    "cycle": KindOption(
        "loops: last (default), blocks (the last cycle of each block), all, or cycles such as 3, 1,5 or 10-, "
        "counted from 1",
        "N",
    ),
    "corners": KindOption("loops, slip: a part of the history in place of a cycle, such as 21-101", "A-B"),
    "abscissa": KindOption(
        "loops: prescribed (default where a displacement is prescribed) or pin (its displacement)", "WHICH"
    ),
    "sketch": KindOption("tractions: add a small sketch of the joint", type="flag"),
    "bars": KindOption("tractions: draw the error bars as bands (run --error-bars)", type="flag"),
    "body": KindOption("plate, pin, seat (the plate round a bush), or (hoop and map) both"),
    "at": KindOption("holes: load point (default: the last)", "N", "number"),
    "component": KindOption(
        "map: von_mises (default), largest, hoop, radial, shear, sxx, ..., or utilization of a laminate"
    ),
    "extent": KindOption("map: outer radius (default 2)", "RADII", "number"),
    "angle": KindOption("profile: place (default: the largest hoop stress)", "DEG", "number"),
    "depth": KindOption(
        "profile: largest depth, in radii; fatigue, strength: depth of the points, m or in the units of the case",
        "D",
        "number",
    ),
    "criterion": KindOption(
        "fatigue, damage: smith-watson-topper (default), fatemi-socie, findley, ...; "
        "strength: that of [strength], else hashin, ..."
    ),
}
"""Options of figures, in the order of the help. Each is a keyword of the functions of the kinds that have it."""


class Kind(NamedTuple):
    """A kind of figure of a result.

    Attributes
    ----------
    file : str
        The file of this folder that makes the figure. Its function ``KIND_plot(subject, **options)`` returns a
        :class:`fastpin.figures.sheet.Plot` of a :class:`fastpin.figures.states.Subject`.
    words : str
        Its help on the command line; empty if the name says it.
    options : tuple of str
        Names of :data:`KIND_OPTIONS`, and "csv" if the figure has numbers.
    sources : tuple of str
        What the figure may show, keys of :data:`SOURCES`.
    whole : bool
        Whether it shows a plate of any outline beyond the hole.
    """

    file: str
    words: str
    options: tuple[str, ...]
    sources: tuple[str, ...] = ("result", "life", "hole")
    whole: bool = False


SOURCES = {
    "result": "the result of a run",
    "life": "a life of wear",
    "case": "a case file",
    "joint": "a joint of several pins",
    "joint file": "a joint file",
    "hole": "a pin in a plate of a joint",
}
"""Words for what a figure may show."""


KINDS = {
    "tractions": Kind("tractions", "", ("states", "csv", "sketch", "bars")),
    "stick-slip": Kind("stick_slip", "map of stick and slip over load points", ("states", "csv")),
    "sketch": Kind("sketch", "pin, plate and loads", ("states",), sources=("result", "life", "case", "hole")),
    "gap": Kind("history", "initial gap and friction along the rim", ("csv",), sources=("result", "life", "case")),
    "hoop": Kind("stress", "hoop stress round hole and pin", ("states", "csv", "body")),
    "outline": Kind("stress", "hoop stress along the edges of a plate of any outline", ("states", "csv"), whole=True),
    "profile": Kind("stress", "stresses below the edge", ("states", "csv", "body", "angle", "depth")),
    "map": Kind(
        "stress",
        "one component of the stress in both bodies",
        ("states", "csv", "body", "component", "extent"),
        whole=True,
    ),
    "stiffness": Kind("laminates", "moduli of a laminate by direction", ("csv",), sources=("result", "life", "case")),
    "strength": Kind(
        "laminates", "strength ratio of a laminate round the hole", ("states", "csv", "criterion", "depth")
    ),
    "cycles": Kind("cycles", "changes in each cycle", ("csv",), sources=("result",)),
    "slip": Kind("load_cycle", "slip and friction energy in the last cycle", ("csv", "corners")),
    "loops": Kind(
        "load_cycle",
        "hysteresis loops of the last cycle, or of several",
        ("csv", "cycle", "corners", "abscissa"),
        ("result", "life"),
    ),
    "fatigue": Kind(
        "fatigue",
        "a criterion along the edge over the last cycle, or damage",
        ("csv", "body", "criterion", "depth"),
    ),
    "plates": Kind("joint_sketch", "a joint or its file: plates, pins and loads", (), ("joint", "joint file")),
    "holes": Kind("joint", "a joint: hoop stress, contact and forces in all holes", ("at",), ("joint",)),
    "shares": Kind("joint", "a joint: the force of each pin at all load points", ("csv",), ("joint",)),
    "share-bars": Kind("joint", "a joint: the share of each pin in the force on each plate", ("csv",), ("joint",)),
    "displacement": Kind("joint", "a joint: loads over the displacement of plates", ("csv",), ("joint",)),
    "scar": Kind("scar", "a life of wear: worn profile and pressure after some cycles", ("csv",), sources=("life",)),
    "wear": Kind(
        "scar", "a life of wear: volume, depth, dissipation, pressure over the cycles", ("csv",), sources=("life",)
    ),
    "damage": Kind("scar", "a life of wear: damage of the material", ("csv", "body", "criterion"), sources=("life",)),
}
"""The kinds of figures by their names on the command line."""


def kinds_with(option: str) -> str:
    """Return the kinds with an option, as text; empty if there is none."""
    return ", ".join(name for name, kind in KINDS.items() if option in kind.options)
