"""Large load parameters: Cattaneo-Mindlin tractions of like half-planes."""

import numpy as np
import pytest

from fastpin import Problem, solve
from fastpin.verification import closed_forms
from fastpin.verification.comparisons import cattaneo_mindlin_differences

FRICTION, RATIO = 0.5, 0.6


def half_plane_errors(pair, load_parameter, nodes):
    """int |dT| / int mu N after +Q, -Q and +Q again, stick ratio, and the peak pressure over Hertz's minus 1."""
    problem = Problem.from_load_parameter(pair, load_parameter, FRICTION, "centre", "fixed")
    Q = RATIO * FRICTION
    result = solve(problem, [{"P": 1.0}, {"Q": Q}, {"Q": -Q}, {"Q": Q}], nodes=nodes)
    half = closed_forms.hertz_half_angle(load_parameter)
    peak = closed_forms.hertz_peak_pressure(load_parameter)
    differences = cattaneo_mindlin_differences(result[1:], RATIO)
    start, stop = result[1].stick[0]
    return differences, 0.5 * (stop - start) / half, result[0].peak_pressure / peak - 1.0


def test_differences_fall_with_the_load_parameter(similar):
    parameters = [20.0, 200.0, 2000.0]
    found = [half_plane_errors(similar, value, 301) for value in parameters]
    for branch in range(3):
        shear = [differences[branch] for differences, _, _ in found]
        assert shear[1] < 0.03
        order = -np.polyfit(np.log(parameters), np.log(shear), 1)[0]
        assert order == pytest.approx(0.5, abs=0.08)  # the contact shifts by a part of its size that falls so
    assert found[-1][1] == pytest.approx(np.sqrt(1.0 - RATIO), abs=2e-3)
    assert [excess for _, _, excess in found] == pytest.approx([0.0042, 0.00042, 0.000042], rel=0.15)
