"""Rainflow counts and stress-life curves through pylife."""

import sys

import numpy as np
import pytest

from fastpin import InputError, damage
from tests.support.refusals import refused

ASTM = [-2, 1, -3, 5, -1, 3, -4, 4, -2]
"""The history of ASTM E1049, figures 6 and 7."""


def test_the_repeated_history_of_the_standard():
    """Ranges 3, 4, 7 and 9, each once."""
    counted = damage.rainflow(ASTM)
    assert sorted(counted.range.tolist()) == [3.0, 4.0, 7.0, 9.0]
    assert dict(zip(counted.range.tolist(), counted.mean.tolist(), strict=True)) == {9: 0.5, 7: 0.5, 4: 1.0, 3: -0.5}


def test_the_beginning_of_the_period_makes_no_difference():
    for turn in range(8):
        values = np.roll(ASTM[:-1], turn)
        assert sorted(damage.rainflow(values).range.tolist()) == [3.0, 4.0, 7.0, 9.0]


def test_simple_histories():
    turn = np.linspace(0.0, 2.0 * np.pi, 401)
    counted = damage.rainflow(50.0 + 100.0 * np.sin(turn))
    assert counted.range.tolist() == pytest.approx([200.0])
    assert counted.mean.tolist() == pytest.approx([50.0])
    assert damage.rainflow(np.full(5, 3.0)).range.size == 0
    assert damage.rainflow([0.0, 1.0, 0.0, 1.0]).range.tolist() == [1.0, 1.0]


def test_the_largest_range_is_the_whole_range_and_no_reversal_is_lost():
    values = np.random.default_rng(1).normal(size=501)
    counted = damage.rainflow(values)
    closed = np.append(values, values[0])
    assert counted.range.max() == pytest.approx(np.ptp(values), rel=1e-15)
    assert 2.0 * counted.range.sum() == pytest.approx(np.abs(np.diff(closed)).sum(), rel=1e-12)


def test_a_stress_life_curve():
    """Slope 5 above the knee of 100 MPa at 1e6 cycles, 9 below, or a fatigue limit."""
    amplitude = np.array([[200e6, 100e6], [50e6, 99e6]])
    cycles = damage.stress_life(amplitude, 100e6, 1e6, 5.0, 9.0)
    np.testing.assert_allclose(cycles, [[31_250.0, 1e6], [1e6 * 2.0**9, 1e6 * 0.99**-9]], rtol=1e-12)
    assert np.isinf(damage.stress_life(50e6, 100e6, 1e6, 5.0))


def test_a_spectrum_adds_up():
    counted = damage.rainflow(np.array(ASTM) * 100e6)
    lives = damage.stress_life(0.5 * counted.range, 100e6, 1e6, 5.0, 5.0)
    expected = sum((50.0 * size / 100.0) ** 5 / 1e6 for size in (3, 4, 7, 9))
    assert damage.miner(np.full(4, 1000), lives) == pytest.approx(1000.0 * expected, rel=1e-12)


def test_without_pylife_a_sentence_says_what_to_install(monkeypatch):
    for name in ("pylife.stress.rainflow", "pylife.materiallaws"):
        monkeypatch.setitem(sys.modules, name, None)
    for call in (lambda: damage.rainflow(ASTM), lambda: damage.stress_life(1.0, 1.0, 1.0, 1.0)):
        with pytest.raises(InputError, match=r"^pylife: is not installed: pip install 'fastpin\[fatigue\]'$"):
            call()


BAD = {
    "values: must be a list of at least two numbers, not of the shape (1,)": (damage.rainflow, [1.0]),
    "values: must be a finite number, not nan": (damage.rainflow, [1.0, np.nan]),
    "amplitude: must be above 0, not 0": (damage.stress_life, 0.0, 1.0, 1.0, 1.0),
    "knee_cycles: must be positive, not 0": (damage.stress_life, 1.0, 1.0, 0.0, 1.0),
    "slope: must lie between 1 and inf, not 0.5": (damage.stress_life, 1.0, 1.0, 1.0, 0.5),
}


@pytest.mark.parametrize("sentence", BAD)
def test_bad_input(sentence):
    assert str(refused(*BAD[sentence])) == sentence
