"""The figure of a finite plate."""

import pytest

from fastpin.errors import InputError
from fastpin.figures.sketch import ARROWS, HOLD_WORDS, plot_lug
from fastpin.lugs.outline import Hole, PartLoad
from tests.support.drawing import legend_words
from tests.support.lugs import plate

LUG = plate(
    supports={"top": "both", "left": "x", "bolt": "normal"},
    loads=(PartLoad("syy", ("bottom",), normal=1.0),),
    holes=(Hole("bolt", 3j, 0.8),),
    hole_radius=0.9,
)


def test_parts_holes_supports_and_loads_are_drawn():
    figure = plot_lug(LUG, title="A plate")
    (panel,) = figure.axes
    assert len(panel.lines) == 4 + 4 + 4  # outline, and two circles in four arcs
    assert {text.get_text().strip() for text in panel.texts} >= {"bottom", "right", "top", "left", "pin", "bolt", "syy"}
    arrows = [text for text in panel.texts if text.get_text() == ""]
    assert len(arrows) == ARROWS
    assert all(arrow.xy[1] < arrow.xyann[1] < -2.5e3 for arrow in arrows)  # tension, in millimetres
    holds = [HOLD_WORDS[hold] for hold in ("both", "x", "normal")]
    assert [label for label in legend_words(figure) if label.strip()] == ["free", *holds]
    assert figure.get_suptitle() == "A plate"


def test_pressure_points_at_the_edge():
    (panel,) = plot_lug(plate(loads=(PartLoad("syy", ("bottom",), normal=-1.0),))).axes
    arrows = [text for text in panel.texts if text.get_text() == ""]
    assert all(arrow.xyann[1] < arrow.xy[1] < -2.5e3 for arrow in arrows)


def test_something_else_is_refused():
    with pytest.raises(InputError, match=r"lug: must be fastpin\.lugs\.Lug"):
        plot_lug("lug.toml")
