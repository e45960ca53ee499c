"""Many cases in one call: results as those of solve, and errors with their places."""

from __future__ import annotations

import os
import warnings
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import fastpin
from fastpin.model import Case, LoadHistory, SolveOptions
from tests.support.slip_cases import UNLIKE, unitless

OPTIONS = SolveOptions(nodes=41)


def case(friction: float, *corners: dict[str, float]) -> Case:
    """A case with few nodes; a pin under a load and a moment."""
    pressed = unitless(UNLIKE, 0.1, friction)
    return Case(pressed, LoadHistory([{"P": 1.0}, *corners]), OPTIONS)


CASES = [case(0.3), case(0.1, {"M": 5.0}), case(0.5, {"Q": 0.1})]


def assert_as_alone(cases: list[Case], found: list[Any]) -> None:
    """The results have the bits of single calls, and the second case fails."""
    for one, result in zip(cases, found, strict=True):
        if not isinstance(result, fastpin.Result):
            continue
        alone = fastpin.solve(one.problem, one.history, **one.options.keywords())
        assert len(result) == len(alone)
        for state, other in zip(result, alone, strict=True):
            for name in ("pressure", "shear", "gap", "slip", "status"):
                np.testing.assert_array_equal(getattr(state, name), getattr(other, name))


def test_each_case_has_its_result_or_its_error_in_its_place() -> None:
    found = fastpin.solve_many(iter(CASES))
    assert [type(end).__name__ for end in found] == ["Result", "NoEquilibriumError", "Result"]
    assert_as_alone(CASES, found)
    assert str(found[1]).startswith("cases[1]: ")
    assert len(found[1].result) == 1
    assert fastpin.solve_many([]) == []


def test_what_is_no_case_is_refused_by_its_place() -> None:
    with pytest.raises(fastpin.InputError, match=r"^cases\[1\]: must be a Case, not 3$"):
        fastpin.solve_many([CASES[0], 3])  # type: ignore[list-item]
    with pytest.raises(fastpin.InputError, match=r"^workers: "):
        fastpin.solve_many(CASES, workers=0)


def test_a_case_whose_input_does_not_fit_has_an_error_of_the_input() -> None:
    (found,) = fastpin.solve_many([replace(CASES[0], history=LoadHistory([{"sxx": 1.0, "P": 1e-80}]))])
    with pytest.raises(fastpin.InputError) as alone:
        fastpin.solve(CASES[0].problem, [{"sxx": 1.0, "P": 1e-80}])
    assert str(found) == f"cases[0]: {alone.value}"


def test_doubts_about_the_input_are_given_to_the_caller() -> None:
    doubtful = [replace(one, options=SolveOptions(nodes=41, arc=(-17.0, -13.0))) for one in (CASES[0], CASES[2])]
    with warnings.catch_warnings(record=True) as given:
        warnings.simplefilter("default")
        fastpin.solve_many(doubtful)
    assert [str(each.message).split(" is ")[0] for each in given] == ["arc: -17 rad"]
    assert given[0].filename == __file__


class Deadly(LoadHistory):
    """A history that ends the process which unpacks it."""

    def __reduce__(self) -> Any:
        return os._exit, (9,)


@pytest.mark.gate
def test_cases_have_the_same_ends_with_two_workers_one_of_which_dies() -> None:
    deadly = replace(CASES[0], history=Deadly([{"P": 1.0}]))
    found = fastpin.solve_many([*CASES, deadly], workers=2)
    assert [type(end).__name__ for end in found] == ["Result", "NoEquilibriumError", "Result", "FastpinError"]
    assert_as_alone([*CASES, deadly], found)
    assert str(found[3]).startswith("cases[3]: the worker process died")
    assert len(found[1].result) == 1
