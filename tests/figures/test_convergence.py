"""The figure of a convergence study."""

from __future__ import annotations

import pytest

from fastpin import InputError, Problem, converge, figures
from tests.support.samples import PAIR


@pytest.fixture(scope="module")
def study():
    return converge(Problem(PAIR, 0.01, 2e-5, 0.4, "body"), [{"P": 1e6}, {"Q": 2e5}], nodes=(51, 101, 201))


def test_panels_show_the_distance_to_the_limit(study, tmp_path):
    figure = figures.plot_convergence(study, tmp_path / "a.png", title="Study")
    panels = [panel for panel in figure.axes if panel.get_visible()]
    assert 4 <= len(panels) <= 9
    for panel in panels:
        counts = panel.lines[0].get_xdata()
        assert list(counts) == [51, 101, 201]
        assert panel.get_yscale() == panel.get_xscale() == "log"
    assert panels[0].get_title().startswith("peak N (")
    heading = figure.get_suptitle().replace("\N{NO-BREAK SPACE}", " ")
    assert "corner 2: P = 1 MN/m, Q = 200 kN/m" in heading
    assert "friction coefficient 0.4" in figure.get_suptitle().replace("\n", " ")
    assert (tmp_path / "a.png").stat().st_size > 10_000


def test_a_corner_that_was_not_studied(study):
    with pytest.raises(InputError, match="corner: must be a studied corner: 1, 2, not 3"):
        figures.plot_convergence(study, corner=3)
