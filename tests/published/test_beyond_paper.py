"""The figures of the system memory and of the onset of sliding, on few nodes and in few cases."""

import math

import numpy as np
import pytest

from docs.beyond import memory, sliding_onset
from docs.beyond.figures import FIGURES
from fastpin import Problem, solve
from fastpin.assess.outputs import Curve
from fastpin.published import tractions
from tests.support.checks.sliding import solve_sliding
from tests.support.tiers import for_gate

NODES = 61


def held(load_parameter: float, friction: float) -> Problem:
    return Problem.from_load_parameter(tractions.PAIRS["Ti/Ti"], load_parameter, friction, "centre", "fixed")


@pytest.fixture(scope="module")
@for_gate
def remembered() -> list[Curve]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(memory, "LOAD_PARAMETERS", (0.05, 0.2, 0.5, 2.0, 8.0))
        patch.setattr(memory, "AMPLITUDES", (0.5, 1.0, 1.25))
        return FIGURES["memory"].compute(NODES)


def test_memory_is_largest_in_between_and_grows_with_the_amplitude(remembered):
    half, full, more = (curve["memory_T"] for curve in remembered)
    assert half == pytest.approx([0.019, 0.033, 0.024, 0.008, 0.002], abs=0.0025)
    assert full == pytest.approx([0.059, 0.106, 0.092, 0.040, 0.011], abs=0.005)
    assert np.all(full > half)
    assert more[:3] == pytest.approx([0.083, 0.146, 0.125], abs=0.006)


def test_sliding_forgets(remembered):
    more = remembered[-1]
    assert more["memory_T"][3:] == pytest.approx([0.0, 0.0], abs=1e-9)
    assert more["memory_N"][3:] == pytest.approx([0.0, 0.0], abs=1e-9)
    assert more["first_forward_T"][3:] == pytest.approx([0.0, 0.0], abs=1e-9)


def test_states_are_steady_from_the_first_reversal_on_unless_strongly_conforming(remembered):
    for curve in remembered:
        assert curve["first_reverse_T"][2:] == pytest.approx(0.0, abs=1e-9)
        assert curve["second_forward_T"][2:] == pytest.approx(0.0, abs=1e-9)
        assert curve["first_reverse_T"][0] > 0.01
        assert curve["second_forward_T"][0] < 0.2 * curve["first_reverse_T"][0]


@pytest.mark.parametrize(("load_parameter", "friction", "expected"), [(0.5, 0.55, 2.313), (1.0, 0.3, 1.308)])
def test_at_the_onset_the_tractions_are_those_of_full_sliding(load_parameter, friction, expected):
    problem = held(load_parameter, friction)
    onset = sliding_onset.forward_onset(problem, sliding_onset.LARGEST, 161)
    assert onset / friction == pytest.approx(expected, abs=0.003)
    state = solve(problem, [{"P": 1.0}, {"Q": onset}], nodes=161)[-1]
    found = solve_sliding(problem, {"P": 1.0, "Q": onset})
    assert state.peak_pressure == pytest.approx(found.peak_pressure, rel=2e-4)
    assert state.resultants["M"] == pytest.approx(found.moment, rel=2e-4)


@pytest.mark.gate
def test_onset_is_later_than_mu_P_and_earlier_on_the_way_back():
    for load_parameter, friction, expected in ((0.5, 0.1, 1.352), (1.0, 0.3, 1.252), (2.0, 0.8, 1.225)):
        problem = held(load_parameter, friction)
        forward = sliding_onset.forward_onset(problem, sliding_onset.LARGEST, NODES)
        back = sliding_onset.reverse_onset(problem, forward, NODES)
        assert friction < back < forward
        assert back / friction == pytest.approx(expected, abs=0.02)


@pytest.mark.gate
def test_a_conforming_contact_does_not_slide():
    problem = held(0.2, 0.55)
    assert math.isnan(sliding_onset.forward_onset(problem, sliding_onset.LARGEST, NODES))
    assert math.isnan(sliding_onset.reverse_onset(problem, sliding_onset.LARGEST, NODES))


@pytest.mark.parametrize("name", ["memory", "sliding-onset"])
def test_drawn(name, remembered, monkeypatch):
    monkeypatch.setattr(sliding_onset, "LOAD_PARAMETERS", (0.5, 2.0))
    monkeypatch.setattr(sliding_onset, "FRICTION", (0.1, 0.5))
    monkeypatch.setattr(sliding_onset, "SHOWN_FRICTION", (0.1, 0.3))
    monkeypatch.setattr(sliding_onset, "SHOWN_LOAD_PARAMETERS", (1.0,))
    chosen = FIGURES[name]
    curves = remembered if name == "memory" else chosen.compute(41)
    figure = chosen.draw(curves)
    figure.draw_without_rendering()
    assert len(figure.axes) == 2
    lines = [line for panel in figure.axes for line in panel.lines if len(line.get_xdata()) > 2 or name != "memory"]
    assert len(lines) == (9 if name == "memory" else 8)
    assert all(panel.get_xlabel() for panel in figure.axes)
    heading = figure._suptitle.get_text()
    assert "Like bodies (Ti-6Al-4V), plane strain" in heading
    assert "can't rotate" in heading
    if name == "memory":
        assert "friction coefficient 0.55" in heading
        assert len({line.get_marker() for line in figure.axes[0].lines}) == len(remembered)
        return
    left, right = ({line.get_color() for line in panel.lines if len(line.get_xdata()) == 2} for panel in figure.axes)
    assert len(left & right) == 1  # the line at one
    titles = [panel.get_legend().get_title().get_text() for panel in figure.axes]
    assert titles == ["friction coefficient", "load parameter"]
    assert [text.get_text() for text in figure.axes[0].get_legend().get_texts()] == ["0.1", "0.3"]
