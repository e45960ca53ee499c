"""The figure of a convergence study."""

from dataclasses import replace

import pytest

from fastpin import InputError, Problem, converge, figures
from fastpin.report.convergence import reported_series
from tests.support.drawing import plain
from tests.support.samples import PAIR


@pytest.fixture(scope="module")
def study():
    return converge(Problem(PAIR, 0.01, 2e-5, 0.4, "body"), [{"P": 1e6}, {"Q": 2e5}], nodes=(51, 101, 201))


@pytest.mark.gate
def test_panels_show_the_distance_to_the_limit(study, tmp_path):
    figure = figures.plot_convergence(study, tmp_path / "a.png", title="Study")
    panels = [panel for panel in figure.axes if panel.get_visible()]
    assert 4 <= len(panels) <= 9
    for panel in panels:
        counts = panel.lines[0].get_xdata()
        assert list(counts) == [51, 101, 201]
        assert panel.get_yscale() == panel.get_xscale() == "log"
    assert panels[0].get_title() == "peak N"
    assert {panel.get_ylim() for panel in panels} == {panels[0].get_ylim()}
    assert panels[0].get_ylabel() == "relative distance"
    heading = plain(figure.get_suptitle())
    assert "corner 2: P = 1 MN/m, Q = 200 kN/m" in heading
    assert "friction coefficient 0.4" in heading
    assert (tmp_path / "a.png").stat().st_size > 10_000


def test_panels_tell_the_verdict_and_relative_distances(study):
    rows = {row.label: row for row in reported_series(study.studies[0], study.problem, 2)}
    figure = figures.plot_convergence(study)
    for panel in figure.axes:
        if panel.get_visible():
            row = rows[panel.get_title()]
            words = panel.texts[0].get_text().replace("\N{MINUS SIGN}", "-")
            assert words == row.words
            limit = row.limit if row.verdict == "observed" else row.values[-1]
            distance = abs(row.values[0] - limit) / row.reference
            assert panel.lines[0].get_ydata()[0] == pytest.approx(distance)
            assert panel.lines[1].get_ydata()[0] == pytest.approx(row.bar / row.reference)
            assert panel.lines[0].get_fillstyle() == ("full" if row.verdict == "observed" else "none")


@pytest.mark.gate
def test_two_solvers_have_marks_before_their_verdicts(study):
    both = converge(study.problem, [{"P": 1e6}], nodes=(51, 101, 201), increments=(2, 4, 8), increment_nodes=51)
    marks = {text.get_text()[0] for panel in figures.plot_convergence(both).axes for text in panel.texts}
    assert marks == {"\N{BLACK CIRCLE}", "\N{BLACK SQUARE}"}


def test_a_study_whose_values_are_all_exact_has_an_empty_figure(study):
    only = replace(study.studies[0], series=tuple(s for s in study.studies[0].series if s.name == "P"))
    figure = figures.plot_convergence(replace(study, studies=(only,)))
    assert not any(panel.get_visible() for panel in figure.axes)


def test_a_corner_that_was_not_studied(study):
    with pytest.raises(InputError, match="corner: must be a studied corner: 1, 2, not 3"):
        figures.plot_convergence(study, corner=3)
