"""Tornados and samples of tolerance studies: their bars, marks and words."""

import numpy as np
import pytest

from fastpin.errors import InputError
from fastpin.figures import plot_samples, plot_tornado
from fastpin.figures.tolerances import LOW, samples_of, tornado_of
from fastpin.report.tolerances import Cloud, FieldBar, ToleranceChart


def chart(fields: int = 2, **changed: object) -> ToleranceChart:
    bars = [FieldBar(f"field {k}", (f"{k} um", "9 um"), np.array([9.0 - k, 10.0, 13.0 - k])) for k in range(fields)]
    samples = np.linspace(8.0, 13.0, 30)
    clouds = [Cloud(f"field {k} (um)", samples / (k + 1), k == 1, 0.9 / (k + 1)) for k in range(fields)]
    given = {
        "title": "Study", "label": "largest pressure (MPa)", "nominal": 10.0, "bars": bars, "corners": (6.0, 14.0),
        "percentiles": {5: 8.0, 50: 10.0, 95: 12.0}, "clouds": clouds, "samples": samples, "missing": 0,
    }  # fmt: skip
    return ToleranceChart(**{**given, **changed})  # type: ignore[arg-type]


def test_bars_reach_from_the_nominal_value_to_the_limits() -> None:
    panel = plot_tornado(chart()).axes[0]
    bars = {(round(bar.get_y() + 0.5 * bar.get_height()), bar.get_hatch()): bar for bar in panel.patches}
    assert {key: (bar.get_x(), bar.get_width()) for key, bar in bars.items()} == {
        (0, None): (10.0, -1.0), (0, "////"): (10.0, 3.0), (1, None): (10.0, -2.0), (1, "////"): (10.0, 2.0),
    }  # fmt: skip
    names = [label.get_text() for label in panel.get_yticklabels()]
    assert names == ["field 0", "field 1", "all corners", "samples, 5 % to 95 %"]
    lines = {tuple(line.get_xdata()) for line in panel.lines if len(line.get_xdata()) == 2}
    assert {(6.0, 14.0), (8.0, 12.0)} <= lines
    assert panel.get_xlabel() == "largest pressure (MPa)"
    assert [text.get_text() for text in panel.texts] == ["0 µm", "9 µm", "1 µm", "9 µm"]
    alone = plot_tornado(chart(corners=None, percentiles={})).axes[0]
    assert [label.get_text() for label in alone.get_yticklabels()] == ["field 0", "field 1"]


def test_limits_on_one_side_share_the_height_of_a_bar() -> None:
    bars = [FieldBar("friction", ("0.1", "0.6"), np.array([12.0, 10.0, 11.0]))]
    low, high = plot_tornado(chart(bars=bars)).axes[0].patches
    assert low.get_y() + low.get_height() == pytest.approx(high.get_y())
    assert low.get_facecolor() != high.get_facecolor()
    assert low.get_linewidth() == LOW["linewidth"]


def test_a_limit_without_a_value_says_so() -> None:
    bars = [FieldBar("friction", ("0.1", "0.6"), np.array([np.nan, 10.0, 11.0]))]
    panel = plot_tornado(chart(bars=bars, missing=3)).axes[0]
    assert [text.get_text() for text in panel.texts] == ["0.1: no value", "0.6"]
    assert len(panel.patches) == 1
    assert "3 runs have no value" in tornado_of([chart(missing=3)]).caption
    nothing = chart(bars=[FieldBar("friction", ("0.1", "0.6"), np.full(3, np.nan))], nominal=np.nan, corners=None)
    assert not plot_tornado(nothing).axes[0].patches


def test_samples_stand_over_each_field_in_the_order_of_the_correlations() -> None:
    found = chart()
    first, second = plot_samples(found).axes
    assert first.get_title() == "rank correlation +0.90"
    assert np.array_equal(first.lines[0].get_ydata(), found.samples)
    assert np.array_equal(second.lines[0].get_xdata(), found.clouds[1].values)
    assert (first.get_xscale(), second.get_xscale()) == ("linear", "log")
    assert first.lines[0].get_color() != plot_samples(
        chart(clouds=[Cloud("x", found.samples, False, 0.2)])
    ).axes[0].lines[0].get_color()  # fmt: skip
    with pytest.raises(InputError, match="the study has no samples"):
        samples_of([chart(samples=np.empty(0))])


@pytest.mark.gate
def test_many_fields_show_the_strongest() -> None:
    figure = plot_samples([chart(12)] * 3)
    assert len([panel for panel in figure.axes if panel.get_visible()]) == 24
    assert "the 8 of 12 fields with the largest correlations" in figure.get_suptitle()
    with pytest.raises(InputError, match="must be 1 to 4 charts, not 5"):
        plot_tornado([chart()] * 5)
