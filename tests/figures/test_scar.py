"""Figures of a life of wear: the scar, the numbers over the cycles, and the damage."""

from dataclasses import replace

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import fastpin
from fastpin import Grid, InputError
from fastpin.figures.scar import NEAR, damage_of, life_caption, scar_plot, wear_plot
from fastpin.figures.sheet import Look
from fastpin.figures.states import Subject
from fastpin.figures.style import MAX_NAMED
from fastpin.model import Profile
from fastpin.wear_lives import WearResult
from tests.support.drawing import legend_words, plain
from tests.support.lives import CONSTANTS, JOINT, sample_life
from tests.support.wear_cases import WEAR_CASES


@pytest.fixture(scope="module")
def life() -> WearResult:
    return sample_life()


def lengthened(life: WearResult, count: int) -> WearResult:
    """A life of so many stored cycles, whose depths grow linearly."""
    last = life[-1]
    cycles = [
        replace(last, cycle=k * k, solved=k, pin_depth=k * last.pin_depth, plate_depth=k * last.plate_depth)
        for k in range(count)
    ]
    return replace(life, cycles=tuple(cycles))


def curves(panel: Axes) -> list[tuple[np.ndarray, np.ndarray]]:
    """The curves of a panel, without lines across it."""
    found = [tuple(np.asarray(part, float) for part in line.get_data()) for line in panel.lines]
    return [(x, y) for x, y in found if x.size > 2]  # type: ignore[misc]


def heading(figure: Figure) -> str:
    return plain(str(figure.get_suptitle()))


@pytest.mark.gate
def test_words_of_the_angle_fit_a_narrow_figure(life: WearResult) -> None:
    figure = life.plot(width=3.4)
    label = figure.axes[-1].xaxis.label
    assert label.get_text() == "angle from the bottom of the hole,\ncounter-clockwise (deg)"
    figure.canvas.draw()
    assert 0.0 <= label.get_window_extent().x0 < label.get_window_extent().x1 <= figure.bbox.width


def test_a_scar_goes_down_on_the_profiles_of_the_cycles(life: WearResult) -> None:
    figure = life.plot(title="Scar")
    upper, lower = figure.axes
    assert upper.yaxis_inverted()
    assert len(curves(upper)) == len(curves(lower)) == 4
    assert legend_words(figure) == ["0", "2", "20", "60"]
    for (angle, depth), (_, pressure), each in zip(curves(upper), curves(lower), life, strict=True):
        assert np.all(np.diff(angle) > 0.0)
        assert depth == pytest.approx(1e9 * each.gap_growth, abs=1e-6 * 1e9 * life[-1].depth)
        assert pressure == pytest.approx(1e-6 * each.states[-1].pressure)
    assert upper.get_ylabel() == "worn depth of\nboth bodies (nm)"
    words = f"Scar largest depth of all {1e9 * life[-1].depth:.3g} nm; 20 % of the volume from the pin"
    assert heading(figure) == words


def test_of_many_cycles_some_are_drawn_evenly_over_the_depth(life: WearResult) -> None:
    plot = scar_plot(Subject(lengthened(life, 60)))
    assert plot.notes == [f"{MAX_NAMED} of 60 stored cycles are drawn"]
    figure = Look().drawn(plot)
    assert legend_words(figure) == [f"{k * k:,}" for k in (0, 8, 17, 25, 34, 42, 51, 59)]
    assert f"{MAX_NAMED} of 60 stored cycles; largest depth of all" in heading(figure)
    assert scar_plot(Subject(life)).notes == []


def test_one_body_alone_is_named() -> None:
    figure = sample_life(cycles=1, at=[1], pin=None).plot()
    assert figure.axes[0].get_ylabel().startswith("worn depth of\nthe plate (")
    assert "from the pin" not in heading(figure)


def test_captions_hold_the_parameters_of_the_wear(life: WearResult) -> None:
    text = plain(life_caption(life))
    loads, wear = text.split("; ")[-2:]
    assert loads.startswith("cycle: P = 2 MN/m, Q: −800 to 800 kN/m, M: ")  # the moment that holds the pin
    assert wear == "archard wear: pin 2e-12 1/Pa, plate 8e-12 1/Pa, tolerance 0.01"
    assert "initial gap of the hole: oval of 1 µm" in text
    zone = Profile.constant(1e-12) + Profile.zone(3e-12, -2.0, -1.0)
    other = sample_life(cycles=1, at=[1], pin=None, plate=zone, law="energy", tolerance=0.0)
    assert life_caption(other).endswith("energy wear: plate 1e-12 to 4e-12 1/Pa along the rim, every cycle solved")


def test_numbers_over_the_cycles(life: WearResult) -> None:
    volume, depth, energy, pressure = life.plot(kind="wear").axes
    both, pin, plate = (values for _, values in curves(volume))
    assert both == pytest.approx(pin + plate)
    assert pin == pytest.approx(1e12 * np.array([each.volumes[0] for each in life]))
    assert volume.get_ylabel() == "worn\nvolume (µm²)"
    assert (volume.get_yscale(), depth.get_yscale(), energy.get_yscale()) == ("log", "log", "linear")
    (cycles, lost), *_ = curves(energy)
    assert cycles.tolist() == [0.0, 2.0, 20.0, 60.0]
    assert np.isnan(lost[0])  # the first cycle begins at Q = 0
    assert lost[1:] == pytest.approx(1e3 * np.array([each.energy_per_cycle for each in life[1:]]))
    assert curves(pressure)[0][1] == pytest.approx(1e-6 * np.array([each.largest_pressure for each in life]))


@pytest.mark.gate
def test_few_cycles_have_plain_axes_and_one_has_a_point(life: WearResult) -> None:
    for count in (1, 2):
        figure = replace(life, cycles=life.cycles[:count]).plot(kind="wear")
        assert {panel.get_yscale() for panel in figure.axes} == {"linear"}
        assert all(panel.lines[0].get_xdata().size == count for panel in figure.axes)
        assert all(tick == int(tick) for tick in figure.axes[-1].get_xticks())
        assert replace(life, cycles=life.cycles[:count]).plot().axes


@pytest.mark.gate
def test_an_unfinished_life_says_so_in_each_figure(life: WearResult) -> None:
    ended = replace(life, cycles=life.cycles[:3], complete=False)
    for kind in ("scar", "wear", "damage"):
        assert "unfinished: 20 of 60 cycles" in heading(ended.plot(kind=kind)), kind
    with pytest.raises(InputError, match="has no stored cycle: the life of wear ended before its first one"):
        replace(life, cycles=()).plot()


def test_a_life_without_dimensions_has_figures() -> None:
    case = WEAR_CASES["rotation"]
    grid: Grid = case.grid(31)
    sliding = fastpin.wear(case.problem, case.history(), cycles=2, coefficient=5e-3, grid=grid)
    upper, _ = sliding.plot().axes
    assert upper.get_ylabel() == "worn depth of\nboth bodies (F β*)"
    volume, *_ = sliding.plot(kind="wear").axes
    assert volume.get_ylabel() == "worn\nvolume (F R β*)"


@pytest.mark.gate
def test_damage_is_drawn_under_the_worn_surface(life: WearResult) -> None:
    found = life.fatigue()
    figure = Look().drawn(damage_of(life, found))
    field, growth, bar = figure.axes
    assert "plate, Smith-Watson-Topper: no crack within 60 cycles; largest damage" in heading(figure)
    worn = max(y.max() for _, y in curves(field))
    assert worn == pytest.approx(1e3 * life[-1].plate_depth.max(), rel=1e-6)
    low, high = bar.get_ylim()
    assert high == pytest.approx(found.damage[-1].max())
    assert low == pytest.approx(1e-6 * high)
    left, ever = (values for _, values in curves(growth))
    assert np.isnan(left[0])  # a logarithm has no 0
    assert ever[1:] == pytest.approx(found.damage.max(axis=(1, 2))[1:])
    assert np.nanmax(ever) < NEAR
    assert growth.get_ylim()[1] < 1.0  # a crack is far


@pytest.mark.gate
def test_a_crack_is_marked() -> None:
    constants = replace(CONSTANTS, fatigue_strength=60e6, fatigue_ductility=1e-9)
    pair = replace(JOINT.pair, plate=replace(JOINT.pair.plate, fatigue=constants))
    life = sample_life(problem=replace(JOINT, pair=pair))
    found = life.fatigue()
    assert np.isfinite(found.life)
    figure = Look().drawn(damage_of(life, found))
    field, growth, _ = figure.axes
    assert "first crack" in legend_words(figure)
    assert found.words.replace(" um ", " µm ") in heading(figure)
    marks = [line for line in field.lines if line.get_marker() == "o"]
    assert [line.get_ydata()[0] for line in marks] == pytest.approx([1e3 * found.crack.depth])
    assert growth.get_ylim()[1] > 1.0
    assert [line.get_ydata()[0] for line in growth.lines if len(line.get_xdata()) == 2] == [1.0]


def test_words_for_readers_who_see_no_figure(life: WearResult) -> None:
    assert "after 0, 2, 20, 60 cycles" in scar_plot(Subject(life)).instead
    assert wear_plot(Subject(life)).instead.startswith("Line charts over 60 cycles of volume, depth")
