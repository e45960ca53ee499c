"""The margins of a crack: against fracture at its first and last length, and against growth."""

import math

import numpy as np
import pytest

from fastpin.assess.crack import crack_margins
from fastpin.cracks import Crack, Nasgro, Walker, growth, paris, spectrum_growth
from fastpin.states.margins import smallest_margin
from tests.support.cracks import M, made
from tests.support.tiers import gate


def rows_of(found):
    rows = crack_margins(found)
    return {row.subject.removeprefix("plate: crack, "): row for row in rows}


def test_fracture_has_the_largest_K_on_the_way(small_states):
    """K = s sqrt(pi a) with 100 MPa: 1.7725 at 0.1 mm and 17.725 at 10 mm."""
    law = Walker(1e-10, 3.0, toughness=20.0 * M)
    found = made(small_states, law, lambda a: 100.0 * M * np.sqrt(math.pi * a))
    rows = rows_of(found)
    assert list(rows) == ["fracture at its first length", "fracture up to its last length"]  # there is no threshold
    first, last = rows.values()
    assert first.margin == pytest.approx(20.0 / 1.7724539 - 1.0)
    assert last.margin == pytest.approx(20.0 / 17.724539 - 1.0)
    assert (first.load_point, first.loads, first.owner) == (2.0, small_states[1].load, "plate")
    assert "length 10 mm, mouth at 107.19 deg" in last.remark
    breaks = rows_of(made(small_states, Walker(1e-10, 3.0, toughness=10.0 * M), lambda a: found.K_max))
    assert breaks["fracture up to its last length"].margin == pytest.approx(10.0 / 17.724539 - 1.0)


def test_a_falling_K_counts_where_it_is_largest(small_states):
    law = Walker(1e-10, 3.0, toughness=20.0 * M)
    rows = rows_of(made(small_states, law, lambda a: 10.0 * M * (1e-4 / a) ** 0.1))
    first, last = rows.values()
    assert first.margin == last.margin == pytest.approx(1.0)
    assert last.remark == first.remark


def test_a_crack_that_stops_counts_up_to_its_arrest(small_states):
    """The range is 4 at first, falls below the threshold of 3, and rises to 40 at lengths that are never reached."""
    law = Walker(1e-10, 3.0, threshold_range=3.0 * M, toughness=20.0 * M)
    found = made(small_states, law, lambda a: M * np.where(a < 1e-3, 4.0, np.where(a < 5e-3, 2.0, 40.0)))
    assert found.arrest == pytest.approx(1e-3, rel=2e-2)
    rows = rows_of(found)
    assert rows["fracture before it stops"].value == 4.0 * M
    assert rows["threshold"].margin == pytest.approx(3.0 / 4.0 - 1.0)
    assert rows["threshold"].remark.endswith("above its threshold it grows, and does not fail")


def test_growth_is_never_the_smallest_margin(small_states):
    law = Walker(1e-10, 3.0, threshold_range=3.0 * M, toughness=20.0 * M)
    rows = crack_margins(made(small_states, law, lambda a: 4.0 * M + 0.0 * a))
    assert [row.name for row in rows] == ["fracture", "fracture", "growth"]
    assert min(rows, key=lambda row: row.margin).name == "growth"
    assert smallest_margin(rows) is rows[0]


def test_a_crack_below_its_threshold_does_not_grow(small_states):
    law = Walker(1e-10, 3.0, threshold_range=3.0 * M, toughness=20.0 * M)
    rows = rows_of(made(small_states, law, lambda a: 2.0 * M + 0.0 * a))
    assert list(rows) == ["fracture at its first length", "threshold"]
    assert rows["threshold"].margin == pytest.approx(0.5)
    assert rows["threshold"].remark.endswith("; does not grow")


def test_without_a_toughness_fracture_is_not_known(small_states):
    rows = rows_of(made(small_states, paris(1e-10, 3.0), lambda a: 4.0 * M + 0.0 * a))
    for row in rows.values():
        assert math.isnan(row.margin)
        assert row.remark.startswith("not known: the law of growth has no toughness; length ")


@pytest.mark.parametrize("follow", [growth, *gate(spectrum_growth)])
def test_the_state_with_the_largest_K_governs(small_states, follow):
    """At each length the load point is that of the state whose own K_I is the largest."""
    law = Nasgro(1e-10, 2.5, 1.0, 1.0, 1.0 * M, 30.0 * M)
    crack = Crack(math.radians(-24.0))
    found = follow(small_states, crack, law, 1e-4, 1e-3)
    assert set(found.loads) == set(found.largest_at.tolist())
    by_point = {float(state.step + state.fraction): state for state in small_states}
    for point, loads in found.loads.items():
        assert by_point[point].load == loads
    for row in crack_margins(found):
        assert row.loads == by_point[row.load_point].load
    single = [follow([state, state], crack, law, 1e-4, 1e-3).K_max[0] for state in small_states]
    best = small_states[int(np.argmax(single))]
    assert found.largest_at[0] == best.step + best.fraction
