"""The search for the worst plane: compiled, as plain Python, and against a scan of many planes."""

import numpy as np
import pytest

from fastpin.damage import plane_search
from tests.support.kernels import in_python

FORMS = (plane_search.SWING_TIMES_PUSH, plane_search.SWING_TIMES_MORE, plane_search.SWING_AND_PUSH)


def on_plane(path, x, form):
    """The criterion on the planes x, without any search."""
    sums = np.stack([np.ones_like(x), np.cos(x), np.sin(x)])
    swung, push = path[:, :3] @ sums, path[:, 3:] @ sums
    swing, most = 0.5 * np.ptp(swung, axis=0), push.max(axis=0)
    if form == plane_search.SWING_AND_PUSH:
        return swing + most
    return swing * (np.maximum(most, 0.0) + (form == plane_search.SWING_TIMES_MORE))


def scan(path, form, levels=6):
    """The largest value on a fine grid of planes, refined about its best planes."""
    x = np.linspace(-np.pi, np.pi, 20_001)
    step = x[1] - x[0]
    values = on_plane(path, x, form)
    for _ in range(levels):
        best = x[np.argsort(values)[-20:]]
        x = (best[:, None] + np.linspace(-step, step, 41)).ravel()
        step, values = step / 20.0, on_plane(path, x, form)
    return values.max()


def random_paths(seed, points, times):
    """Random paths: rough, smooth and closed, and in proportion."""
    rng = np.random.default_rng(seed)
    rough = rng.normal(size=(points, times, 6))
    turn = np.linspace(0.0, 2.0 * np.pi, times)
    waves = [rng.normal(size=(points, 1, 6)) * np.cos(k * turn + rng.uniform(0.0, 6.0))[:, None] for k in range(4)]
    straight = rng.normal(size=(points, 1, 6)) * np.sin(turn)[:, None] + rng.normal(size=(points, 1, 6))
    return np.ascontiguousarray(np.concatenate([rough, sum(waves), straight]))


@pytest.mark.gate
@pytest.mark.parametrize("form", FORMS)
def test_the_worst_plane_is_that_of_a_scan(form):
    paths = random_paths(1, 40, 50)
    out = np.empty((len(paths), 2))
    plane_search.worst_planes(paths, form, out)
    for path, (value, angle) in zip(paths, out, strict=True):
        scanned = scan(path, form)
        assert value == pytest.approx(scanned, rel=1e-10)
        assert value >= scanned * (1.0 - 1e-13)
        if value == 0.0:  # no push on any plane
            assert np.isnan(angle)
            continue
        assert on_plane(path, np.array([2.0 * angle]), form)[0] == pytest.approx(value, rel=1e-12)
        assert -0.5 * np.pi < angle <= 0.5 * np.pi
    assert np.count_nonzero(out[:, 0]) > 100


@pytest.mark.parametrize("form", FORMS)
def test_compiled_and_plain_python_agree(form):
    paths = random_paths(2, 3, 12)
    out, plain = np.empty((len(paths), 2)), np.empty((len(paths), 2))
    plane_search.worst_planes(paths, form, out)
    in_python(plane_search).worst_planes(paths, form, plain)
    np.testing.assert_allclose(out[:, 0], plain[:, 0], rtol=1e-13)
    np.testing.assert_allclose(out[:, 1], plain[:, 1], rtol=1e-7)


def test_the_angle_is_a_zero_of_the_derivative():
    """U = 1 + cos x is swung once, V = 2 + sin x pushes: (1 + cos x)(2 + sin x)/2 is largest near x = 0.27."""
    path = np.array([[[1.0, 1.0, 0.0, 2.0, 0.0, 1.0], [0.0, 0.0, 0.0, 2.0, 0.0, 1.0]]])
    out = np.empty((1, 2))
    plane_search.worst_planes(path, plane_search.SWING_TIMES_PUSH, out)
    x = 2.0 * out[0, 1]
    assert -np.sin(x) * (2.0 + np.sin(x)) + (1.0 + np.cos(x)) * np.cos(x) == pytest.approx(0.0, abs=1e-14)


@pytest.mark.parametrize("form", FORMS)
def test_of_two_planes_that_mirror_each_other_the_one_with_the_largest_angle_is_the_worst(form):
    """The shear and the normal stress on the planes of a free edge at many directions: U ~ sin x', V ~ 1 + cos x'."""
    edges = np.linspace(-1.5, 1.5, 40)
    for mirrored in (1.0, -1.0):
        c, s = np.cos(2.0 * mirrored * edges), np.sin(2.0 * mirrored * edges)
        shear, normal = np.stack([0.0 * c, -s, c], axis=-1), np.stack([1.0 + 0.0 * c, c, s], axis=-1)
        paths = np.concatenate([shear, 0.4 * normal], axis=-1)[:, None] * np.array([1.0, 0.1, -0.6])[:, None]
        out = np.empty((len(paths), 2))
        plane_search.worst_planes(paths, form, out)
        away = np.remainder(2.0 * out[:, 1] - 2.0 * mirrored * edges, 2.0 * np.pi)
        first = np.minimum(away, 2.0 * np.pi - away)  # from the edge's normal, either way
        np.testing.assert_allclose(first, first[0], rtol=1e-6)
        both = 0.5 * (2.0 * mirrored * edges[:, None] + first[:, None] * [1.0, -1.0])
        both = 0.5 * np.pi - np.remainder(0.5 * np.pi - both, np.pi)
        np.testing.assert_allclose(out[:, 1], both.max(axis=1), rtol=0.0, atol=1e-7)


@pytest.mark.parametrize("turned", [-1e-12, 0.0, 1e-12])
def test_rounding_turns_no_plane_at_90_degrees_round(turned):
    assert in_python(plane_search).plane_angle(np.pi + turned, 1e-6) == pytest.approx(0.5 * np.pi, abs=1e-11)
    assert in_python(plane_search).plane_angle(-np.pi + turned, 1e-6) == pytest.approx(0.5 * np.pi, abs=1e-11)
    assert in_python(plane_search).plane_angle(1.0 + turned, 1e-6) == pytest.approx(0.5, abs=1e-11)


def test_a_swing_without_push_counts_nothing():
    path = np.array([[[1.0, 0.3, 0.2, -2.0, 0.5, 0.5], [0.0, -0.4, 0.1, -2.0, 0.4, 0.4]]])
    out = np.empty((1, 2))
    plane_search.worst_planes(path, plane_search.SWING_TIMES_PUSH, out)
    assert out[0, 0] == 0.0
    assert np.isnan(out[0, 1])


@pytest.mark.gate
@pytest.mark.parametrize("excess", [1e-1, 1e-3, 1e-5, 1e-7])
def test_planes_that_are_hardly_pushed_are_found(excess):
    """V is above 0 on a few planes only, by a small excess."""
    paths = random_paths(5, 10, 60)
    paths[..., 3] -= np.max(paths[..., 3] + np.hypot(paths[..., 4], paths[..., 5]), axis=1)[:, None] - excess
    out = np.empty((len(paths), 2))
    plane_search.worst_planes(paths, plane_search.SWING_TIMES_PUSH, out)
    scanned = np.array([scan(path, plane_search.SWING_TIMES_PUSH, levels=8) for path in paths])
    assert np.all(out[:, 0] > 0.0)
    rounding = 1e-15 * np.abs(paths).max() ** 2  # of V, a small difference of large terms
    np.testing.assert_array_less(scanned - out[:, 0], 1e-10 * scanned + rounding)


def test_planes_that_are_all_alike_end_the_search():
    """A component that turns with time: all planes are alike, up to the number of stops."""
    turn = np.linspace(0.0, 2.0 * np.pi, 721)[:-1]
    ones = np.ones_like(turn)
    path = np.stack([0.0 * ones, np.cos(turn), np.sin(turn), ones, 0.5 * np.cos(turn), 0.5 * np.sin(turn)], axis=-1)
    out = np.empty((1, 2))
    plane_search.worst_planes(path[None], plane_search.SWING_TIMES_PUSH, out)
    assert out[0, 0] == pytest.approx(1.5, rel=1e-12)


@pytest.mark.parametrize("form", FORMS)
def test_components_in_other_units_have_the_same_worst_plane(form):
    """A power of two changes no bit. Where a criterion adds 1 to V, only U is in another unit."""
    paths, factor = random_paths(7, 5, 15), 2.0**-30
    scaled = factor * paths
    if form == plane_search.SWING_TIMES_MORE:
        scaled[..., 3:] = paths[..., 3:]
    out, small = np.empty((len(paths), 2)), np.empty((len(paths), 2))
    plane_search.worst_planes(paths, form, out)
    plane_search.worst_planes(scaled, form, small)
    assert np.array_equal(small[:, 0], (factor**2 if form == plane_search.SWING_TIMES_PUSH else factor) * out[:, 0])
    assert np.array_equal(small[:, 1], out[:, 1], equal_nan=True)
