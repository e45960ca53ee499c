"""Sheets: a new figure with panels, or the axes that a caller gives; heading, caption and legend on either."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Concatenate, ParamSpec, Protocol, TypeVar, overload

import matplotlib as mpl
import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.transforms import ScaledTranslation

from fastpin.assess.outputs import Curve, write_csv
from fastpin.errors import InputError
from fastpin.figures import style
from fastpin.figures.style import ANGLE, CAPTION_SIZE, wrapped, wrapped_parts
from fastpin.model.checks import file_path, instance, number, string
from fastpin.storage.files import check_writable, no_figure

WIDTH = 6.7
"""Width of most figures, inches."""

WIDE = 7.6
"""Width of a figure of several panels side by side, inches."""

HEADING = 9.5
"""Size of a title, points."""

SMALL: Any = {"font.size": 7.5}
"""Size of letters in given axes, points."""

LONGEST_TITLE = 2_000
"""Most characters of the title of a figure. The lines of ten times as many take seconds to draw."""

GAP = 0.14
"""Gap between panels inside given axes, in parts of the axes. It holds the numbers of an axis."""


@dataclass(frozen=True)
class Look:
    """How a figure looks, and where it goes.

    Attributes
    ----------
    path : path or None
        File of the figure; the suffix chooses the format.
    title : str
    width : float
        Width of a new figure, inches.
    dpi : float
        Dots per inch of a bitmap.
    ax : Axes or None
        Axes to draw in, instead of a new figure. Several panels divide them.

    Raises
    ------
    InputError
        If an attribute is out of range, the format is unknown, or the file can't be written.
    """

    path: str | Path | None = None
    title: str = ""
    width: float = WIDTH
    dpi: float = 300.0
    ax: Axes | None = None

    def __post_init__(self) -> None:
        if len(string("title", self.title)) > LONGEST_TITLE:
            most = f"must have at most {LONGEST_TITLE:,} characters in a figure, not {len(self.title):,}"
            raise InputError("title", most)
        object.__setattr__(self, "width", number("width", self.width, 1.0, 12.0))
        object.__setattr__(self, "dpi", number("dpi", self.dpi, 10.0, 1200.0))  # the largest bitmap takes 1 GB
        if self.path is not None:
            path = file_path("path", self.path)
            if path.suffix[1:].lower() not in FigureCanvasAgg.get_supported_filetypes():
                raise no_figure("path", path)
            check_writable(path)
        if self.ax is not None:
            instance("ax", self.ax, Axes, "axes of Matplotlib")

    def drawn(self, plot: Plot) -> Figure:
        """Draw a plot in the house style, save its figure if there is a path, and return the figure."""
        if self.ax is not None and plot.alone:
            raise InputError("ax", plot.alone)
        with style.house_style():
            with mpl.rc_context(None if self.ax is None else SMALL):
                sheet: Sheet = plot.draw(self)
            if sheet.host is None:
                sheet.wrap_axes()
            if self.path is not None:
                style.save_figure(sheet.figure, Path(self.path), self.dpi)
        return sheet.figure

    def sheet(self, heights: Sequence[float], columns: int = 1, extra: float = 1.35, **options: Any) -> Sheet:
        """Return a sheet with a row of panels for each of `heights`, inches.

        `extra` is the height for heading and legend. `options` go to ``Figure.subplots``.
        """
        if self.ax is None:
            figure = style.new_figure(self.width, sum(heights) + extra)
            axes = figure.subplots(len(heights), columns, squeeze=False, height_ratios=heights, **options)
            return Sheet(figure, axes, None)
        if self.ax.figure is None:
            raise InputError("ax", "belongs to no figure")
        host: Figure = self.ax.figure.figure  # the whole figure, also of axes in a part of it
        if len(heights) * columns == 1 and not options.get("subplot_kw"):
            return Sheet(host, np.array([[self.ax]]), self.ax)
        return Sheet(host, _insets(self.ax, heights, columns, options), self.ax)


@dataclass(frozen=True, eq=False)
class Plot:
    """A figure that is not drawn yet, with its numbers and its words.

    Attributes
    ----------
    draw : callable
        ``draw(look)`` draws a :class:`Sheet`.
    curves : sequence of Curve
        The numbers of the figure, for a CSV file.
    instead : str
        The text in place of the figure, for readers who can't see it.
    caption : str
        The text below the figure on a page.
    notes, doubts : sequence of str
        Sentences for the terminal: on the drawn part of the result, and on doubts.
    title : str
        Title of a figure of :func:`plotter`, unless another one is given.
    width : float
        Width of a new figure, inches, unless another one is given.
    alone : str
        Why given axes can't hold the figure; empty if they can.
    bitmap : bool
        Whether the figure is too large for a page as SVG.
    """

    draw: Callable[[Look], Any]
    curves: Sequence[Curve] = ()
    instead: str = ""
    caption: str = ""
    notes: Sequence[str] = ()
    doubts: Sequence[str] = ()
    title: str = ""
    width: float = WIDTH
    alone: str = ""
    bitmap: bool = False

    def save(self, path: Path, title: str = "") -> None:
        """Draw the figure and write it to a file."""
        Look(path, title, self.width).drawn(self)

    def write_numbers(self, path: Path) -> None:
        """Write the numbers of the figure as CSV."""
        write_csv(self.curves, path)


def draw_plot(
    make: Callable[[], Plot],
    path: str | Path | None = None,
    title: str | None = None,
    width: float | None = None,
    dpi: float = 300.0,
    ax: Axes | None = None,
) -> Figure:
    """Draw the plot that ``make()`` returns, after the look has been checked: some plots take long to make.

    See :class:`Look` for the other arguments. Title and width are those of the plot unless they are given.
    """
    look = Look(path, "" if title is None else title, WIDTH if width is None else width, dpi, ax)
    plot = make()
    if title is None:
        look = replace(look, title=plot.title)
    return (replace(look, width=plot.width) if width is None else look).drawn(plot)


Shown = TypeVar("Shown", contravariant=True)
Made = TypeVar("Made")
Options = ParamSpec("Options")


class Plotter(Protocol[Shown, Options]):
    """A function that draws figures: of a subject, with a look, and with options by name."""

    def __call__(
        self,
        shown: Shown,
        path: str | Path | None = None,
        title: str | None = None,
        width: float | None = None,
        dpi: float = 300.0,
        ax: Axes | None = None,
        *args: Options.args,
        **options: Options.kwargs,
    ) -> Figure: ...


LOOK_WORDS = """
Notes
-----
With a `path` the figure is also saved; the suffix chooses the format. `width` is in inches, `dpi` in dots per inch of a
bitmap. Axes of Matplotlib, `ax`, take the place of a new figure. Several panels divide them, and the figure of `ax` is
returned. Without a `title` and a `width` the figure has its own. An argument out of range, an unknown format, and a
file that can't be written raise :class:`InputError`.
"""
"""Words on the look, at the end of the docstring of each function of :func:`plotter`."""


@overload
def plotter(name: str, make: Callable[Concatenate[Shown, Options], Plot]) -> Plotter[Shown, Options]: ...
@overload
def plotter(
    name: str, make: Callable[Concatenate[Made, Options], Plot], of: Callable[[Shown], Made]
) -> Plotter[Shown, Options]: ...
def plotter(name: str, make: Callable[..., Plot], of: Callable[..., Any] | None = None) -> Callable[..., Figure]:
    """Return the public function `name` that draws the plots of ``make(subject, **options)``.

    The look stands between the subject and the options: path, title, width, dpi and ax. The docstring is that of
    `make`, with :data:`LOOK_WORDS`. ``of(given)`` makes the subject of what users give.
    """
    first, *options = inspect.signature(make, eval_str=True).parameters.values()
    if of is not None:
        (first,) = inspect.signature(of, eval_str=True).parameters.values()
    needed = [first, *(option for option in options if option.default is option.empty)]
    look = list(inspect.signature(draw_plot, eval_str=True).parameters.values())[1:]
    by_name = [option.replace(kind=option.KEYWORD_ONLY) for option in options if option not in needed]
    signature = inspect.Signature([*needed, *look, *by_name], return_annotation=Figure)

    def draw(*arguments: Any, **keywords: Any) -> Figure:
        given = signature.bind(*arguments, **keywords).arguments
        looks = {each.name: given.pop(each.name) for each in look if each.name in given}

        def plot() -> Plot:
            shown = given.pop(first.name)
            return make(shown if of is None else of(shown), **given)

        return draw_plot(plot, **looks)

    draw.__name__ = draw.__qualname__ = name
    draw.__module__ = make.__module__
    draw.__doc__ = inspect.cleandoc(make.__doc__ or "") + "\n" + LOOK_WORDS
    draw.__signature__ = signature  # type: ignore[attr-defined]
    return draw


@dataclass(frozen=True, eq=False)
class Sheet:
    """A figure and its panels.

    Attributes
    ----------
    figure : Figure
    axes : ndarray of Axes, shape (rows, columns)
    host : Axes or None
        The axes that the caller gave, which hold the panels.
    """

    figure: Figure
    axes: np.ndarray
    host: Axes | None

    def head(self, *lines: str, caption: str = "", lift: float = 5.0) -> None:
        """Write lines above the panels, and a caption in smaller letters below the lines. Narrow axes get no caption.

        `lift` is the distance of the caption from the panel, points.
        """
        host = self.host
        inches = self.figure.get_figwidth() if host is None else host.get_window_extent().width / self.figure.dpi
        width = inches - (0.9 if host is None else 0.0)
        text = "\n".join(row for line in lines for row in wrapped(line, width, HEADING))
        small = "\n".join(wrapped_parts(caption, width))
        if host is not None:
            small = "" if width < 2.5 else small  # inches: narrow axes have no caption
            host.set_title("\n".join(filter(None, [text, small])), fontsize=CAPTION_SIZE, parse_math=False)
            return
        if self.axes.shape[1] == 1:
            if small:
                self.axes[0, 0].set_title(small, pad=lift, fontsize=CAPTION_SIZE, color="0.25", parse_math=False)
        else:
            text = "\n".join(filter(None, [text, small]))
        if text:
            size = HEADING if self.axes.shape[1] == 1 or not small else 0.85 * HEADING
            self.figure.suptitle(text, fontsize=size, parse_math=False)

    def wrap_axes(self) -> None:
        """Break words of horizontal axes that are wider than the figure into lines."""
        for panel in self.axes.flat:
            label = panel.xaxis.label
            lines = wrapped(label.get_text(), self.figure.get_figwidth() - 0.9, label.get_size())
            if len(lines) > 1 and "\n" not in label.get_text():
                label.set_text("\n".join(lines))

    def legend(self, handles: Sequence[Artist], columns: int, title: str = "") -> None:
        """Add a legend below the panels. Blank entries keep columns apart."""
        if not handles:
            return
        if self.host is None:
            rows = -(-len(handles) // columns)
            # Figures have room for four rows of a legend. A further one is 0.16 inches high.
            self.figure.set_figheight(self.figure.get_figheight() + 0.16 * max(rows - 4, 0))
            style.fitted_legend(self.figure, list(handles), columns, title)
            return
        host = self.host
        # The words of the axis of angles have 0.45 inches between the axes and the legend below.
        below = ScaledTranslation(0.0, -0.45, self.figure.dpi_scale_trans)
        host.legend(
            handles=[entry for entry in handles if str(entry.get_label()).strip()], fontsize=6.5, title=title or None,
            title_fontsize=6.5, loc="upper center", ncols=min(columns, 2), bbox_to_anchor=(0.5, 0.0),
            bbox_transform=host.transAxes + below, borderaxespad=0.0, alignment="left",
        )  # fmt: skip

    def go_round(self) -> None:
        """Make the horizontal axes of a column of panels the angle all round the hole, with words below the last."""
        for panel in self.axes[:, 0]:
            panel.set_xlim(-180.0, 180.0)
            style.angle_axis(panel)
        self.axes[-1, 0].set_xlabel(ANGLE)
        self.figure.align_ylabels(self.axes)

    def grid(self, axis: Any = "both") -> None:
        """Draw light lines behind the curves of all panels."""
        for panel in self.axes.flat:
            style.draw_grid(panel, axis)


def _insets(host: Axes, heights: Sequence[float], columns: int, options: dict[str, Any]) -> np.ndarray:
    """Panels inside given axes, from the top down."""
    host.set_axis_off()
    rows = len(heights)
    parts = np.asarray(heights) / sum(heights) * (1.0 - GAP * (rows - 1))
    width = (1.0 - GAP * (columns - 1)) / columns
    axes = np.empty((rows, columns), dtype=object)
    keywords = options.get("subplot_kw") or {}
    for row in range(rows):
        bottom = 1.0 - float(parts[: row + 1].sum()) - GAP * row
        for column in range(columns):
            left = column * (width + GAP)
            axes[row, column] = host.inset_axes((left, bottom, width, float(parts[row])), **keywords)
            if options.get("sharex") and row:
                axes[row, column].sharex(axes[0, column])
    return axes
