"""Cells of a map whose values are classes: a colour and a hatch for each class, and lines between classes."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.patches import Patch

LOOKS = (
    ("#ECECEC", ""),
    ("#A9D0EA", "..."),
    ("#F2A541", "\\\\\\\\"),
    ("#0B3C5D", ""),
    ("#6FB58F", "////"),
    ("#F4E58A", "+++"),
    ("#C77CA6", "xxx"),
    ("#7A5C3E", "ooo"),
)
"""Colour and hatch of each class, in the order of their numbers. They differ in grey, or by the hatch."""

HATCH = "0.25"
"""Grey of the hatches."""


def draw_classes(panel: Axes, x: np.ndarray, y: np.ndarray, numbers: np.ndarray, classes: Mapping[int, str]) -> None:
    """Draw the cells of a map, and a line wherever two classes meet.

    Parameters
    ----------
    panel : Axes
    x, y : ndarray, shape (columns + 1,), (rows + 1,)
        Edges of the cells.
    numbers : ndarray, shape (rows, columns)
        Numbers of the classes; NaN without a value.
    classes : dict of int to str
        All classes, at most as many as :data:`LOOKS`.
    """
    for number, (colour, hatch) in zip(classes, LOOKS, strict=False):
        cells = [
            [(x[k], y[j]), (x[k + 1], y[j]), (x[k + 1], y[j + 1]), (x[k], y[j + 1])]
            for j, k in np.argwhere(numbers == number)
        ]
        if cells:
            panel.add_collection(
                PolyCollection(cells, facecolor=colour, edgecolor="none", linewidth=0.0, antialiased=False)
            )
        if cells and hatch:
            panel.add_collection(PolyCollection(cells, facecolor="none", edgecolor=HATCH, linewidth=0.0, hatch=hatch))
    panel.add_collection(LineCollection(class_borders(x, y, numbers), colors="black", linewidths=1.6))
    panel.set_xlim(x[0], x[-1])
    panel.set_ylim(y[0], y[-1])


def class_borders(x: np.ndarray, y: np.ndarray, numbers: np.ndarray) -> list[list[tuple[float, float]]]:
    """Return the sides that two cells of different classes share, as pairs of points."""
    beside = _differ(numbers[:, :-1], numbers[:, 1:])
    above = _differ(numbers[:-1], numbers[1:])
    upright = [[(x[k + 1], y[j]), (x[k + 1], y[j + 1])] for j, k in np.argwhere(beside)]
    level = [[(x[k], y[j + 1]), (x[k + 1], y[j + 1])] for j, k in np.argwhere(above)]
    return [*upright, *level]


def _differ(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    return np.isfinite(one) & np.isfinite(other) & (one != other)


def class_patches(classes: Mapping[int, str], present: np.ndarray) -> list[Patch]:
    """Return the entries of the legend for the classes whose numbers are `present`."""
    return [
        Patch(facecolor=colour, edgecolor=HATCH, hatch=hatch, linewidth=0.5, label=words)
        for (number, words), (colour, hatch) in zip(classes.items(), LOOKS, strict=False)
        if np.any(present == number)
    ]
