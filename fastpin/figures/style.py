"""The style of all figures: colours, dashes, legends, the words on axes and in captions, and how figures are saved."""

from __future__ import annotations

import contextlib
import io
import re
import textwrap
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from fastpin.assess.outputs import ROUNDING
from fastpin.bodies.bushing import STUCK
from fastpin.model import Laminate, Material, Problem, Profile, checks, loads, points
from fastpin.model.units import Unit, acting_loads, units
from fastpin.states.quantities import load_point, point_name
from fastpin.states.state import State
from fastpin.storage.files import replacing

COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9", "#000000", "#882255", "#777777")
"""Colours that are distinct for all kinds of colour vision.

They are Okabe and Ito's without yellow, which is too light for a line, then Tol's wine red, and grey.
"""

DASHES: tuple[tuple[int, tuple[float, ...] | None], ...] = (
    (0, None),  # not (0, ()): an SVG would have dashes of no length, which some readers do not draw
    (0, (5.0, 1.6)),
    (0, (1.2, 1.2)),
    (0, (5.0, 1.4, 1.2, 1.4)),
    (0, (8.0, 2.0)),
    (0, (3.0, 1.2, 1.0, 1.2, 1.0, 1.2)),
    (0, (2.4, 2.4)),
    (0, (9.0, 1.4, 3.0, 1.4)),
)
"""Line styles of Matplotlib, as many as colours; the first one is solid."""

MAX_NAMED = len(COLOURS)
"""Most curves that can be told apart in a panel."""

SCREEN_DPI = 110.0
"""Dots per inch of a picture in a notebook."""

FONTS = Path(mpl.get_data_path()) / "fonts" / "ttf"
"""The folder of Matplotlib's fonts, such as DejaVu Sans."""

STYLE: Any = {
    "font.size": 9.0,
    "font.family": "sans-serif",
    "axes.linewidth": 0.7,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "xtick.direction": "out",
    "ytick.direction": "out",
    "lines.linewidth": 1.4,
    "lines.solid_capstyle": "round",
    "legend.frameon": False,
    "mathtext.default": "regular",
    "svg.fonttype": "path",  # a reader may not have the font
    "pdf.fonttype": 42,  # TrueType, which journals ask for
    "ps.fonttype": 42,
}
"""Settings of Matplotlib (``rcParams``)."""


@contextlib.contextmanager
def house_style() -> Iterator[None]:
    """Draw and save figures in the house style inside a ``with`` block."""
    with mpl.rc_context(STYLE), warnings.catch_warnings():
        warnings.filterwarnings("ignore", "Glyph .* missing")  # A title may have letters that no font has.
        yield


def save_figure(figure: Figure, path: Path, dpi: float) -> None:
    """Write a figure, whole or not at all. Equal figures are equal files: no file has a date.

    Raises
    ------
    InputError
        If the file can't be written.
    """
    dated = {"svg": "Date", "pdf": "CreationDate"}.get(path.suffix[1:].lower())
    with replacing(path) as temporary:
        figure.savefig(temporary, dpi=dpi, metadata={dated: None} if dated else None)


def spread(count: int, most: int) -> list[int]:
    """Return the indices of at most `most` of `count` items, evenly spread, with the first and the last one."""
    return np.unique(np.linspace(0, count - 1, min(count, most)).round().astype(int)).tolist() if count else []


class Drawing(Figure):
    """A figure in the house style, also if it is saved later, and a picture in notebooks with and without pyplot."""

    def savefig(self, *arguments: Any, **options: Any) -> None:
        """As :meth:`matplotlib.figure.Figure.savefig`, in the house style: it embeds fonts in PDF files."""
        with mpl.rc_context(STYLE):
            super().savefig(*arguments, **options)

    def _repr_png_(self) -> bytes:
        picture = io.BytesIO()
        self.savefig(picture, format="png", dpi=SCREEN_DPI)
        return picture.getvalue()


def new_figure(width: float, height: float) -> Drawing:
    """Return an empty figure, inches, whose panels make room for their words."""
    figure = Drawing(figsize=(width, height), layout="constrained")
    FigureCanvasAgg(figure)
    return figure


Line = dict[str, Any]
"""Keywords of ``Axes.plot``: colour, dashes, width."""


def draw_zero(panel: Axes) -> None:
    """Draw the line of 0 behind the curves of a panel. Curves farther from 0 than their range are not flattened."""
    low, high = panel.dataLim.intervaly
    if max(low, -high) <= high - low:
        panel.axhline(0.0, color="0.6", linewidth=0.6, zorder=0)


def draw_grid(panel: Axes, axis: Any = "both") -> None:
    """Draw light lines behind the curves of a panel."""
    panel.grid(True, axis=axis, color="0.92", linewidth=0.6)
    panel.set_axisbelow(True)


HATCH = "0.25"
"""Grey of the hatches."""


def fill(panel: Axes, polygons: Sequence[Any], colour: str, hatch: str) -> None:
    """Fill polygons with a colour, and with a hatch if there is one."""
    panel.add_collection(PolyCollection(polygons, facecolor=colour, edgecolor="none", linewidth=0.0, antialiased=False))
    if hatch:
        panel.add_collection(PolyCollection(polygons, facecolor="none", edgecolor=HATCH, linewidth=0.0, hatch=hatch))


def line(colour: int = 0, dashes: int = 0, width: float = 1.4) -> Line:
    """Return the keywords of a line. `colour` and `dashes` are below :data:`MAX_NAMED`; dashes 0 are solid."""
    return {"color": COLOURS[colour], "linestyle": DASHES[dashes], "linewidth": width}


def angle_axis(panel: Axes) -> None:
    """Put the ticks of an axis in degrees at whole parts of a right angle."""
    panel.xaxis.set_major_locator(MaxNLocator(nbins=7, steps=[1, 1.5, 2, 3, 4.5, 6, 9, 10]))


def fitted_legend(figure: Figure, handles: list[Artist], columns: int, title: str = "") -> None:
    """Add a legend below the panels, in a font that fits the figure's width (4 to 8 points)."""
    size = 8.0
    while True:
        sizes: Any = {"fontsize": size, "title_fontsize": size, "handlelength": 2.8, "columnspacing": 2.0}
        place: Any = {"loc": "outside lower center", "alignment": "left"}
        legend = figure.legend(handles=handles, ncols=columns, title=title or None, **place, **sizes)
        share = legend.get_window_extent().width / figure.bbox.width
        if share <= 0.98 or size <= 4.0:
            return
        legend.remove()
        size = max(4.0, size * 0.96 / share)


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
    unit = re.sub(r"sqrt\((\w+)\)", r"√\1", unit.replace("beta*", "β*").replace("^2", "²").replace("^3", "³"))
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
    alike = [other for other in loads.LOADS if loads.LOAD_KIND[other] == loads.LOAD_KIND[name]]
    same_kind = [state.load[other] for state in states for other in alike]
    of_kind = units(states[0].problem)[loads.LOAD_KIND[name]]
    factor, unit = of_kind.scale(same_kind)
    load = states[index].load[name]
    if abs(load) <= ROUNDING * max(map(abs, same_kind)):
        return f"{name} = 0"
    sign = "+" if load > 0.0 and name != "P" else ""
    value = f"{sign}{of_kind.number(load * factor, 4)}".replace("-", "−")
    return f"{name} = {value} {shown_unit(unit)}"


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
    of_pin = f"{points.owner_of(problem, 'pin')}: {_material(pair.pin, problem)}{pin_body}"
    parts = [f"{of_pin}; plate: {_material(pair.plate, problem)}{plate_body}; plane {pair.plane}"]
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
    return short(value, units(problem)[loads.LOAD_KIND[name]])


def range_text(problem: Problem, name: str, span: tuple[float, float]) -> str:
    """A load, or the range of its values, with its unit."""
    return span_text(name, units(problem)[loads.LOAD_KIND[name]], span)


def span_text(name: str, of_kind: Unit, span: tuple[float, float]) -> str:
    """The name of a quantity with its value, or the range of its values, and the unit."""
    if span[0] == span[1]:
        return f"{name} = {short(span[0], of_kind)}"
    factor, unit = of_kind.scale(span)
    low, high = (of_kind.number(factor * value, DIGITS).replace("-", "−") for value in span)
    return f"{name}: {low} to {high}\N{NO-BREAK SPACE}{shown_unit(unit)}"


def loads_text(problem: Problem, load: Mapping[str, float]) -> str:
    """The loads that are not zero, with their units, as a heading shows them."""
    parts = []
    for name in acting_loads([load]):
        parts.append(f"{name} = {short(load[name], units(problem)[loads.LOAD_KIND[name]], LOAD_DIGITS)}")
    return ", ".join(parts) or "no load"


def short(value: float, unit: Unit, digits: int = DIGITS) -> str:
    """A value with its unit as a caption shows it, rounded to so many significant digits."""
    number, _, label = unit.text(value, digits).partition(" ")
    return f"{number.replace('-', '−')}\N{NO-BREAK SPACE}{shown_unit(label)}".strip()


def _material(material: Material, problem: Problem) -> str:
    if material.is_rigid:
        return "rigid"
    if isinstance(material, Laminate):
        return checks.shortened(material.label)
    if material.label:
        return checks.shortened(material.label)
    modulus = f"{material.E:.{DIGITS}g}/β*" if problem.dimensionless else short(material.E, units(problem)["modulus"])
    return f"E = {modulus}, ν = {material.nu:.{DIGITS}g}"
