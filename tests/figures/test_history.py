"""The figure of a load history: repeated blocks are drawn once, with the numbers of their corners."""

from pathlib import Path

import numpy as np
import pytest

from fastpin.figures import plot_history
from fastpin.model.history import LoadHistory
from fastpin.model.loads import LOADS
from tests.support.refusals import refused
from tests.support.samples import sample_result

PROBLEM = sample_result(nodes=21).problem
HISTORY = (
    LoadHistory([{"P": 2e6}]) + LoadHistory([{"Q": 1e5}, {"Q": -1e5}]).repeated(1000) + LoadHistory([{"sxx": 1e7}])
)


def test_a_repeated_block_is_drawn_once_with_its_times() -> None:
    figure = plot_history(PROBLEM, HISTORY)
    forces, stress = figure.axes
    p, q = forces.get_lines()[:2]
    assert np.allclose(p.get_ydata(), [0.0, 2.0, 2.0, 2.0, 2.0])  # MN/m
    assert np.allclose(q.get_ydata(), [0.0, 0.0, 0.1, -0.1, -0.1])
    assert np.allclose(stress.get_lines()[0].get_ydata(), [0.0, 0.0, 0.0, 0.0, 10.0])  # MPa
    assert [text.get_text() for text in forces.texts] == ["× 1,000"]
    assert [tick.get_text() for tick in stress.get_xticklabels()] == ["0", "1", "2", "3", "2,002"]
    assert forces.get_ylabel() == "force P, Q (MN/m)"


def test_every_kind_of_load_has_a_panel() -> None:
    figure = plot_history(PROBLEM, LoadHistory([dict.fromkeys(LOADS, 1.0)]))
    assert [panel.get_ylabel() for panel in figure.axes] == [
        "force P, Q (N/m)", "moment M (N)", "remote stress sxx, syy, sxy (Pa)", "prescribed rotation (rad)",
        "prescribed ux, uy (m)", "relative friction_change", "rise of temperature, pin_temperature (K)",
    ]  # fmt: skip


def test_a_history_without_loads_has_an_axis() -> None:
    figure = plot_history(PROBLEM, LoadHistory([{"P": 0.0}]))
    assert np.allclose(figure.axes[0].get_lines()[0].get_ydata(), 0.0)


def test_a_long_history_has_no_dots(tmp_path: Path) -> None:
    figure = plot_history(PROBLEM, LoadHistory([{"P": float(k)} for k in range(300)]), tmp_path / "a.svg")
    assert figure.axes[0].get_lines()[0].get_marker() == "None"
    assert (tmp_path / "a.svg").stat().st_size < 100_000


@pytest.mark.parametrize(
    ("change", "field"), [({"problem": 1}, "problem"), ({"history": [1]}, "history"), ({"width": 99.0}, "width")]
)
def test_wrong_input_is_named(change: dict[str, object], field: str) -> None:
    given = {"problem": PROBLEM, "history": HISTORY, **change}
    assert refused(plot_history, **given).field == field
