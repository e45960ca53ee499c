"""The style of all figures: colours, dashes, sheets with panels, legends, and how figures are saved.

Matplotlib is used without global state and needs no display.
"""

from __future__ import annotations

import contextlib
import io
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

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
        legend = figure.legend(
            handles=handles,
            loc="outside lower center",
            ncols=columns,
            fontsize=size,
            handlelength=2.8,
            columnspacing=2.0,
            title=title or None,
            title_fontsize=size,
            alignment="left",
        )
        share = legend.get_window_extent().width / figure.bbox.width
        if share <= 0.98 or size <= 4.0:
            return
        legend.remove()
        size = max(4.0, size * 0.96 / share)
