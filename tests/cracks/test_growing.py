"""Growth, life and arrest of cracks beside a pin, against another program and closed forms."""

import math
import pickle
from dataclasses import replace

import numpy as np
import pytest

import fastpin
from fastpin.cracks import Crack, Walker, growth, growth_along_edge, paris
from fastpin.errors import InputError, InputWarning
from tests.support.cracks import DIRECTION, NASGRO, M, made
from tests.support.refusals import refused
from tests.support.tiers import gate


def walker(threshold):
    """Constants for tests, of no material."""
    return Walker(1e-10, 3.0, 0.5, threshold * M, intrinsic_length=50e-6)


def grown(cycle, name, law, first=1e-5, last=1e-2):
    return growth(cycle(name), Crack(math.radians(DIRECTION[name])), law, first, last)


@pytest.mark.gate
@pytest.mark.parametrize(
    ("name", "threshold", "long", "short", "nasgro"),
    [
        ("bulk", 3.0, 1.3965e5, 4.2195e4, 1.0987e5),
        ("lug", 2.5, 4.119e5, 8.271e4, 3.584e5),
        ("Q", 3.0, 1.0928e6, 1.3903e5, 4.446e6),
    ],
)
def test_lives(cycle, name, threshold, long, short, nasgro):
    assert grown(cycle, name, walker(threshold)).life == pytest.approx(long, rel=1e-3)
    assert grown(cycle, name, walker(threshold), 1e-4, 3e-3).life == pytest.approx(short, rel=1e-3)
    assert grown(cycle, name, NASGRO).life == pytest.approx(nasgro, rel=1e-3)


@pytest.mark.gate
@pytest.mark.parametrize(("threshold", "arrest"), [*gate((3.0, 4.000e-3)), (2.0, 7.247e-3)])
def test_a_crack_that_stops(cycle, threshold, arrest):
    found = grown(cycle, "small", walker(threshold))
    assert found.arrest == pytest.approx(arrest, rel=1e-3)
    assert found.life == math.inf
    assert f"grows from 10 um and stops at {found.arrest * 1e3:.4g} mm" in repr(found)
    before = found.length < found.arrest
    assert np.isfinite(found.cycles[before]).all()
    assert np.isinf(found.cycles[~before]).all()
    assert found.rate[~before].max() == 0.0
    assert math.isnan(found.fracture)


@pytest.mark.gate
@pytest.mark.parametrize("name", ["bulk", "Q"])
def test_a_crack_that_does_not_begin(cycle, name):
    found = grown(cycle, name, walker(4.0))
    assert found.arrest == found.length[0] == 1e-5
    assert found.words == "no growth at 10 um"


@pytest.mark.gate
def test_the_fastest_growth_of_an_edge(cycle):
    """The hot spot of case Q is at -8.6 deg; a crack grows several times as fast at other places."""
    found = growth_along_edge(cycle("Q"), walker(3.0), 1e-4, 3e-3, np.radians(np.arange(-100.0, 10.0, 2.0)))
    at = int(np.argmin(found.life))
    assert found.fastest.life == found.life[at]
    assert found.fastest.crack.theta == found.theta[at]
    hot, fastest = (growth(cycle("Q"), Crack(at), walker(3.0), 1e-4, 3e-3) for at in found.theta[[46, at]])
    assert found.life[46] == pytest.approx(hot.life, rel=2e-4)  # by less lengths
    assert found.fastest.life == fastest.life
    assert found.fastest.life < 0.2 * hot.life
    assert np.all(np.isnan(found.arrest) == np.isfinite(found.life))
    assert "fastest <Growth of a crack at" in repr(found)
    stopped = growth_along_edge(cycle("small"), walker(3.0), 1e-5, 1e-2, [math.radians(-24.0), 1.5])
    assert stopped.fastest.arrest == pytest.approx(4e-3, rel=1e-3)


def test_life_of_a_crack_in_a_tension(small_states):
    """K = s sqrt(pi a) gives (a1^(1-m/2) - a0^(1-m/2))/(C (s sqrt pi)^m (1 - m/2))."""
    found = made(small_states, paris(1e-10, 3.0), lambda a: 100.0 * M * np.sqrt(math.pi * a))
    exact = (1e-2**-0.5 - 1e-4**-0.5) / (1e-10 * (100.0 * math.sqrt(math.pi)) ** 3 * -0.5)
    assert found.life == pytest.approx(exact, rel=1e-12)
    assert found.words == f"grows from 100 um to 10 mm in {exact:.3g} cycles"


def test_fracture(small_states):
    law = Walker(1e-10, 3.0, toughness=10.0 * M)
    found = made(small_states, law, lambda a: 100.0 * M * np.sqrt(math.pi * a))
    assert found.fracture == pytest.approx(0.01 / math.pi, rel=1e-5)
    assert found.words.startswith("grows from 100 um to fracture at 3.183 mm in")
    assert found.life == pytest.approx(found.cycles[np.searchsorted(found.length, found.fracture)])
    assert replace(found, law=replace(law, threshold_range=20.0 * M)).arrest == 1e-4


def test_doubts_are_given_once_and_kept(small_states):
    with pytest.warns(InputWarning, match="last: in doubt from") as given:
        found = growth(small_states, Crack(-0.5, math.radians(50.0)), walker(0.0), 1e-4, 1e-3)
    assert [str(one.message) for one in given] == [str(doubt) for doubt in found.doubts]
    assert given[0].filename == __file__


def test_the_order_of_states_makes_no_difference(small_states):
    first = growth(small_states, Crack(-0.5), walker(0.0), 1e-4, 1e-3)
    again = growth(small_states[::-1], Crack(-0.5), walker(0.0), 1e-4, 1e-3)
    assert again.life == first.life
    assert np.array_equal(first.delta_K, again.delta_K)


def test_a_residual_compression_stops_a_crack(small_states):
    free = growth(small_states, Crack(-0.5), paris(1e-10, 3.0), 1e-5, 1e-3)
    held = growth(small_states, Crack(-0.5), paris(1e-10, 3.0), 1e-5, 1e-3, residual_stress=lambda s: -1e9)
    assert math.isfinite(free.life)
    assert held.words == "no growth at 10 um"


REFUSED = {
    "states: must be the stops of a cycle, at least two, not 1": lambda s: growth(s[:1], Crack(0), NASGRO, 1e-4, 1e-3),
    "crack: must be a Crack, not 1": lambda s: growth(s, 1, NASGRO, 1e-4, 1e-3),
    "law: must be a law of growth, such as fastpin.cracks.Walker, not 3": lambda s: growth(s, Crack(0), 3, 1e-4, 1e-3),
    "first: must be positive, not 0": lambda s: growth(s, Crack(0.0), NASGRO, 0.0, 1e-3),
    "last: must be longer than the first length of 0.001 m": lambda s: growth(s, Crack(0.0), NASGRO, 1e-3, 1e-3),
    "last: must be at most 10000 radii of the hole, not 1 km": lambda s: growth(s, Crack(0.0), NASGRO, 1.0, 1e3),
    "theta: must be at least one angle": lambda s: growth_along_edge(s, NASGRO, 1e-4, 1e-3, []),
    "angle: must lie between": lambda s: growth_along_edge(s, NASGRO, 1e-4, 1e-3, angle=2.0),
}


@pytest.mark.parametrize("words", REFUSED)
def test_refusals(small_states, words):
    assert str(refused(REFUSED[words], small_states)).startswith(words)


@pytest.mark.gate
def test_states_of_two_problems_are_refused(small_states, cycle):
    with pytest.raises(InputError, match="states: must be states of one problem"):
        growth([small_states[0], cycle("lug")[0]], Crack(0.0), NASGRO, 1e-4, 1e-3)


@pytest.mark.gate
def test_a_crack_through_a_lug_is_refused(cycle):
    with pytest.raises(InputError, match=r"last: must end within 0\.9 of the wall of 10 mm, not be 9\.5 mm"):
        growth(cycle("ring"), Crack(-0.5), NASGRO, 1e-4, 9.5e-3)


@pytest.mark.gate
def test_pickles_and_figures(small_states, tmp_path):
    found = growth(small_states, Crack(-0.5), walker(0.0), 1e-4, 1e-3)
    again = pickle.loads(pickle.dumps(found))
    assert again.life == found.life
    assert repr(again) == repr(found)
    figure = fastpin.figures.plot_crack_growth([found, again], tmp_path / "crack.pdf", "a title")
    assert (tmp_path / "crack.pdf").stat().st_size > 1000
    assert [panel.get_xscale() for panel in figure.axes] == ["log", "log"]
    drawn = figure.axes[0].lines[0].get_xydata()
    assert drawn[:, 0] == pytest.approx(1e3 * found.length)
    assert drawn[:, 1] == pytest.approx(1e-6 * found.delta_K)
    with pytest.raises(InputError, match="found: must be a Growth"):
        fastpin.figures.plot_crack_growth([])
    with pytest.raises(InputError, match="found: must be a Growth"):
        fastpin.figures.plot_crack_growth(3)


@pytest.mark.gate
def test_the_figure_of_a_crack_that_never_grows(small_states, tmp_path):
    found = growth(small_states, Crack(-0.5), walker(1e3), 1e-4, 1e-3)
    assert found.rate.max() == 0.0
    figure = fastpin.figures.plot_crack_growth(found, tmp_path / "crack.pdf")
    assert [panel.get_yscale() for panel in figure.axes] == ["log", "linear"]
