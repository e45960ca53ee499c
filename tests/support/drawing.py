"""Figures drawn roughly, for tests of everything else about them. The tests of figures look at their quality."""

from __future__ import annotations

from pathlib import Path

import pytest
from matplotlib.figure import Figure

from fastpin.figures import sheet, style

DPI = 30.0
"""Dots per inch of a rough bitmap."""


def draw_roughly(patch: pytest.MonkeyPatch) -> None:
    """Save figures with few dots, and leave out the search for room for their words: it takes half of the time."""
    save = style.save_figure

    def saved(figure: Figure, path: Path, dpi: float) -> None:
        figure.set_layout_engine("none")
        save(figure, path, min(dpi, DPI))

    for module in (style, sheet):
        patch.setattr(module, "save_figure", saved)
