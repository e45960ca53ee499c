"""Counts on planes: compiled, as plain Python, against pylife, and against a naive count."""

import itertools

import numpy as np
import pytest

from fastpin import damage
from fastpin.damage import plane_damage, plane_search
from tests.support.kernels import in_python
from tests.support.tiers import seeds

LIFE = np.array([np.log(2e3), np.log(5e5), -0.25, -0.7, -np.inf, 0.0, 0.0, 0.5])


def one_block(states):
    return np.arange(states), np.array([[0, states, 1]])


def counted(
    path, angle, order, blocks, form=plane_search.SWING_TIMES_PUSH, kernel=plane_damage.cycles_on_plane, life=LIFE
):
    most = 3 * order.size + 2
    places, values = np.empty((most, 3), dtype=np.int64), np.empty((most, 3))
    count = kernel(path, angle, order, blocks, form, 0.0, life, places, values)
    return places[:count], values[:count]


def uniaxial(values, push=None):
    """Coefficients of a component that is alike on all planes."""
    path = np.zeros((len(values), 6))
    path[:, 0], path[:, 3] = values, values if push is None else push
    return path


def naive(values, push):
    """Ranges and largest pushes of a repeated history: take out the smallest range and close the gap, again and again.

    The history begins at its largest value. The push of a cycle is the largest one from its first reversal on, before
    the history passes the value of this reversal again.
    """
    top = int(np.argmax(values))
    u, v = (np.append(np.roll(each, -top), each[top]) for each in (values, push))
    turns = [0]
    for k in range(1, len(u)):
        if len(turns) > 1 and (u[turns[-1]] - u[turns[-2]]) * (u[k] - u[turns[-1]]) >= 0.0:
            turns[-1] = k
        elif u[k] != u[turns[-1]]:
            turns.append(k)
    found = []
    while len(turns) > 3:
        ranges = np.abs(np.diff(u[turns]))
        k = int(np.argmin(ranges[1:-1])) + 1
        first, second = turns[k], turns[k + 1]
        after = next(t for t in range(second + 1, len(u)) if (u[t] - u[first]) * (u[first] - u[second]) >= 0.0)
        found.append((ranges[k], v[first:after].max()))
        del turns[k : k + 2]
    found.append((abs(u[turns[1]] - u[turns[0]]), v.max()))
    return sorted(found)


def test_counts_of_random_histories():
    """Ranges are those of pylife, and with the largest pushes those of the naive count."""
    for seed in seeds(300):
        rng = np.random.default_rng(seed)
        values, push = rng.normal(size=int(rng.integers(2, 60))), rng.normal(size=60)
        path = uniaxial(values, push[: values.size])
        places, cycles = counted(path, 0.3, *one_block(values.size))
        ranges, most = np.abs(values[places[:, 0]] - values[places[:, 1]]), push[places[:, 2]]
        np.testing.assert_allclose(np.sort(ranges), np.sort(damage.rainflow(values).range), rtol=1e-12, atol=1e-14)
        expected = np.array(naive(values, push[: values.size]))
        np.testing.assert_allclose(np.sort(ranges), expected[:, 0], rtol=1e-12)
        np.testing.assert_array_equal(most[np.argsort(ranges)], expected[:, 1])
        np.testing.assert_allclose(cycles[:, 1], 0.5 * ranges * np.maximum(most, 0.0), rtol=1e-14)


def sums(values, found):
    """All ranges and parameters of counted cycles, in order, and the damage."""
    places, cycles = found
    ranges, times = np.abs(values[places[:, 0]] - values[places[:, 1]]), cycles[:, 0].astype(int)
    return np.sort(np.repeat(ranges, times)), np.sort(np.repeat(cycles[:, 1], times)), cycles[:, 2].sum()


def test_blocks_are_counted_as_their_passes_one_by_one():
    """Also as one list from the largest value on, where equal ranges have equal pushes."""
    for seed in seeds(40):
        rng = np.random.default_rng(seed)
        values, push = rng.normal(size=(2, 12))
        order, blocks, begin = [], [], 0
        for _ in range(4):
            size = int(rng.integers(1, 8))
            order += list(rng.integers(0, 12, size))
            blocks.append((begin, begin + size, int(rng.integers(1, 9))))
            begin += size
        order = np.array(order)
        every = np.concatenate([np.tile(order[first:last], times) for first, last, times in blocks])
        halves, whole = np.array([[0, 1, 1], [1, every.size, 1]]), np.array([[0, every.size, 1]])
        for path, pieces in ((uniaxial(values, push), halves), (uniaxial(values), whole)):
            found = sums(values, counted(path, 0.0, order, np.array(blocks)))
            for one, two in zip(found, sums(values, counted(path, 0.0, every, pieces)), strict=True):
                np.testing.assert_allclose(one, two, rtol=1e-12, atol=1e-300)


def test_the_history_of_the_standard():
    values = np.array([-2.0, 1.0, -3.0, 5.0, -1.0, 3.0, -4.0, 4.0])
    places, _ = counted(uniaxial(values), 0.0, *one_block(8))
    pairs = sorted(tuple(sorted(values[list(pair)])) for pair in places[:, :2])
    assert pairs == [(-4.0, 5.0), (-3.0, 4.0), (-2.0, 1.0), (-1.0, 3.0)]


@pytest.mark.gate
@pytest.mark.parametrize("form", [plane_search.SWING_TIMES_PUSH, plane_search.SWING_TIMES_MORE, plane_damage.POWERS])
def test_the_worst_plane_is_that_of_a_scan(form):
    rng = np.random.default_rng(5)
    for size in (2, 3, 7, 30, 80):
        paths = rng.normal(size=(4, size, 6))
        paths[..., 3:] = 3.0 * paths[..., :3]  # a stress and its strain
        out = np.empty((4, 2))
        plane_damage.worst_sums(paths, *one_block(size), form, 0.0, LIFE, out)
        for path, (found, angle) in zip(paths, out, strict=True):
            scanned = [counted(path, x, *one_block(size), form)[1][:, 2].sum() for x in np.linspace(0.0, np.pi, 2001)]
            assert found == pytest.approx(counted(path, angle, *one_block(size), form)[1][:, 2].sum(), rel=1e-12)
            assert found >= max(scanned) * (1.0 - 1e-6)
            assert -0.5 * np.pi < angle <= 0.5 * np.pi


@pytest.mark.gate
def test_compiled_and_plain_python():
    rng = np.random.default_rng(6)
    paths, order = rng.normal(size=(3, 9, 6)), rng.integers(0, 9, 14)
    blocks = np.array([[0, 5, 1], [5, 9, 6], [9, 14, 2]])
    knees = [LIFE, np.r_[LIFE[:4], 0.3, 40.0, 6.0, 0.5], np.r_[LIFE[:4], 0.3, 40.0, np.inf, 0.5]]
    plain = in_python(plane_damage)
    for form, life in itertools.product(
        (plane_search.SWING_TIMES_PUSH, plane_search.SWING_TIMES_MORE, plane_damage.POWERS), knees
    ):
        one, two = np.empty((3, 2)), np.empty((3, 2))
        plane_damage.worst_sums(paths, order, blocks, form, 0.0, life, one)
        plain.worst_sums(paths, order, blocks, form, 0.0, life, two)
        np.testing.assert_allclose(one[:, 0], two[:, 0], rtol=1e-12)
        np.testing.assert_allclose(one[:, 1], two[:, 1], rtol=0.0, atol=1e-3)
        first = counted(paths[0], 0.4, order, blocks, form, life=life)
        second = counted(paths[0], 0.4, order, blocks, form, plain.cycles_on_plane, life)
        np.testing.assert_array_equal(first[0], second[0])
        np.testing.assert_allclose(first[1], second[1], rtol=1e-12)


def test_of_two_planes_that_mirror_each_other_the_one_with_the_largest_angle_is_the_worst():
    """The planes of a free edge at many directions: U ~ sin x', and V ~ 1 + cos x' pushes."""
    edges, loads = np.linspace(-1.5, 1.5, 40), np.array([1.0, 0.1, -0.6, 0.4])
    c, s = np.cos(2.0 * edges), np.sin(2.0 * edges)
    paths = np.stack([0.0 * c, -s, c, 1.0 + 0.0 * c, c, s], axis=-1)[:, None] * loads[:, None]
    out = np.empty((len(paths), 2))
    plane_damage.worst_sums(paths, *one_block(4), plane_search.SWING_TIMES_PUSH, 0.0, LIFE, out)
    away = np.abs(np.remainder(out[:, 1] - edges + 0.5 * np.pi, np.pi) - 0.5 * np.pi)
    np.testing.assert_allclose(away, away[0], rtol=1e-3)
    both = 0.5 * np.pi - np.remainder(0.5 * np.pi - edges[:, None] - away[:, None] * [1.0, -1.0], np.pi)
    np.testing.assert_allclose(out[:, 1], both.max(axis=1), rtol=0.0, atol=1e-4)


def test_no_damage_without_tension():
    out = np.empty((1, 2))
    plane_damage.worst_sums(uniaxial([-1.0, -3.0])[None], *one_block(2), plane_search.SWING_TIMES_PUSH, 0.0, LIFE, out)
    assert out[0, 0] == 0.0
    assert np.isnan(out[0, 1])
