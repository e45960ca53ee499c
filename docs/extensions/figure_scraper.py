"""Figures of fastpin in the gallery.

The functions of fastpin return figures that pyplot does not know. So the gallery looks for them among the variables of
a script.
"""

from __future__ import annotations

from typing import Any

import matplotlib.pyplot as plt
from matplotlib.figure import Figure
from sphinx_gallery.scrapers import figure_rst, matplotlib_scraper

DPI = 150
"""Dots per inch of a figure: sharp at twice the width of the column."""


def scrape(block: Any, block_vars: dict[str, Any], gallery_conf: dict[str, Any]) -> str:
    """Save the new figures of a block, and return the text that shows them."""
    text = str(matplotlib_scraper(block, block_vars, gallery_conf)) if plt.get_fignums() else ""
    paths = []
    for value in block_vars["example_globals"].values():
        if isinstance(value, Figure) and value.canvas.manager is None and not hasattr(value, "in_gallery"):
            assert any(axes.has_data() for axes in value.axes), "the figure of an example is empty"
            path = next(block_vars["image_path_iterator"])
            value.savefig(path, dpi=DPI)
            value.in_gallery = True  # type: ignore[attr-defined]
            paths.append(path)
    return text + (figure_rst(paths, gallery_conf["src_dir"]) if paths else "")
