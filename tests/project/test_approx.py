"""Arrays that are accepted as a whole are those that pytest accepts entry by entry."""

import itertools

import numpy as np
import pytest

from tests.support.approx import _entry_by_entry, is_close

TOLERANCES = ({}, {"rel": 1e-3}, {"abs": 1e-3}, {"rel": 1e-3, "abs": 1e-2}, {"rel": 0.0, "abs": 0.0}, {"rel": 1})
EXPECTED = np.array([[1.0, -2.0, 0.0], [1e-9, 1e6, -0.0]])
CHANGES = [0.0, *(sign * size for sign in (1.0, -1.0) for size in (1e-13, 1e-12, 5e-7, 1e-6, 9e-4, 1e-3, 2e-3, 1e-2))]


@pytest.mark.parametrize("tolerances", TOLERANCES, ids=str)
@pytest.mark.parametrize("expected", [EXPECTED, EXPECTED + 1e-3j, EXPECTED.astype(np.float32)], ids=["f8", "c16", "f4"])
def test_close_arrays_are_those_of_pytest(tolerances, expected):
    answers = set()
    for change, place in itertools.product(CHANGES, np.ndindex(expected.shape)):
        for factor, shift in ((1.0 + change, 0.0), (1.0, change)):
            actual = expected.copy()
            actual[place] = actual[place] * factor + shift
            approx = pytest.approx(expected, **tolerances)
            answer = is_close(actual, approx)
            assert answer == _entry_by_entry(approx, actual), (actual[place], expected[place])
            answers.add(answer)
    assert answers == {True, False}


@pytest.mark.parametrize(
    ("actual", "expected"),
    [
        (np.array([1.0, np.nan]), np.array([1.0, np.nan])),
        (np.array([1.0, np.inf]), np.array([1.0, np.inf])),
        (np.array([1.0, np.inf]), np.array([1.0, 2.0])),
        (np.array([1, 2]), np.array([1.0, 2.0])),
        (np.array([True]), np.array([1.0])),
        (np.array([1.0]), np.array([True])),
        (np.array([1.0, 1.0]), np.array([1.0])),
        (1.0, np.array([1.0, 1.0])),
        ([1, 1], np.array([1.0, 1.0])),
        ((1.0, 1.0), np.array([1.0, 1.0])),
        (np.array([1.0], dtype=object), np.array([1.0])),
    ],
    ids=str,
)
def test_other_values_are_left_to_pytest(actual, expected):
    approx = pytest.approx(expected)
    assert not is_close(actual, approx)
    assert (actual == approx) == _entry_by_entry(approx, actual)


class Matrix:
    """An object that becomes an array."""

    def __array__(self, dtype=None, copy=None):
        return np.eye(2)


def test_what_becomes_an_array_is_compared_as_a_whole():
    for value in (Matrix(), np.eye(2).tolist()):
        assert is_close(value, pytest.approx(Matrix()))
        assert value == pytest.approx(Matrix())
        assert value != pytest.approx(2.0 * np.eye(2))


def test_a_wrong_tolerance_is_left_to_pytest():
    for wrong in (-1.0, float("nan")):
        assert not is_close(np.ones(2), pytest.approx(np.ones(2), abs=wrong))


def test_pytest_words_what_differs():
    with pytest.raises(AssertionError, match=r"Mismatched elements: 1 / 2(.|\n)*\(1,\)\s*\| 2.0"):
        assert np.array([1.0, 2.0]) == pytest.approx(np.array([1.0, 2.1]))
    assert np.array([1.0, 2.0]) != pytest.approx(np.array([1.0, 2.1]))
