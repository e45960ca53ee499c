"""Three tiers of tests: quick, gate and survey. This plugin chooses the tests, the seeds and the examples of a tier.

* The quick tier runs by default. :mod:`tests.support.guard` has its rules.
* ``--gate`` also runs tests marked ``gate``, with more seeds and examples. The gate of the project has this tier.
* ``--survey`` also runs tests marked ``survey``: random searches before a release, with most seeds.

Tests that use a fixture of :func:`for_gate` are of the gate without a mark of their own.

A test that loops over :func:`seeds`, or that hypothesis repeats, gets the mark ``seeded``: each tier shows more of it.
"""

import contextlib
import importlib
import os
import random
from collections.abc import Callable, Iterable, Iterator
from typing import Any

import pytest
from hypothesis import HealthCheck, settings

TIERS = ("quick", "gate", "survey")

FEW = 3
"""Seeds of a loop in the quick tier."""

MANY = 100
"""Times as many seeds in the survey as in the gate."""

EXAMPLES = {"quick": 15, "gate": 60, "survey": 2_000}
"""Examples that hypothesis draws for a test."""

_now: dict[str, Any] = {"tier": "quick", "seed": None, "seeded": True}
"""The tier, the last seed of :func:`seeds`, and whether the running test may ask for seeds."""


def pytest_addoption(parser: pytest.Parser) -> None:
    group = parser.getgroup("fastpin")
    for name, words in (("gate", "run the quick tests and those of the gate"), ("survey", "run all tests")):
        group.addoption(f"--{name}", action="store_const", dest="tier", const=name, default="quick", help=words)
    group.addoption("--shuffle", type=int, metavar="SEED", help="run the tests in a random order")


def pytest_configure(config: pytest.Config) -> None:
    tier = _now["tier"] = config.getoption("tier")
    settings.register_profile(
        tier,
        derandomize=tier != "survey",  # the same examples in every run
        **({} if tier == "survey" else {"database": None}),
        deadline=None,
        max_examples=EXAMPLES[tier],
        suppress_health_check=[HealthCheck.too_slow, HealthCheck.function_scoped_fixture],
    )
    settings.load_profile(tier)
    if tier != "survey":
        _forget_constants()


def _forget_constants() -> None:
    """Let hypothesis draw no constants of the package's files: reading them takes seconds in each worker.

    The constants also depend on what other tests have imported. Without them the examples are the same in every run.
    Older versions of hypothesis read no constants.
    """
    with contextlib.suppress(ImportError):
        providers = importlib.import_module("hypothesis.internal.conjecture.providers")
        if hasattr(providers, "_get_local_constants"):
            none = providers._local_constants
            providers._get_local_constants = lambda: none


def tier_of(item: pytest.Item) -> str:
    """The lowest tier that runs a test."""
    return next((tier for tier in reversed(TIERS) if item.get_closest_marker(tier)), "quick")


def for_gate(fixture: Callable[..., Any]) -> Callable[..., Any]:
    """Leave a fixture, and all tests that use it, to the gate. This stands below ``pytest.fixture``."""
    fixture.tier = "gate"  # type: ignore[attr-defined]
    return fixture


def tiers_of_fixtures(item: pytest.Item) -> Iterator[str]:
    """The tiers of the fixtures of a test."""
    for found in item._fixtureinfo.name2fixturedefs.values():
        if tier := getattr(found[-1].func, "tier", ""):
            yield tier


def is_seeded(item: pytest.Item) -> bool:
    """Whether a test asks for seeds by itself, or hypothesis repeats it."""
    function = getattr(item, "function", None)
    code = getattr(function, "__code__", None)
    return hasattr(function, "hypothesis") or (code is not None and "seeds" in code.co_names)


@pytest.hookimpl(tryfirst=True)  # before -m asks for the marks
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    last = TIERS.index(config.getoption("tier"))
    chosen: list[pytest.Item] = []
    others: list[pytest.Item] = []
    for item in items:
        if is_seeded(item):
            item.add_marker("seeded")
        for tier in tiers_of_fixtures(item):
            item.add_marker(tier)
        (chosen if TIERS.index(tier_of(item)) <= last else others).append(item)
    config.hook.pytest_deselected(items=others)
    if (seed := config.getoption("shuffle")) is not None:
        random.Random(seed).shuffle(chosen)
    items[:] = chosen


def seeds(count: int, first: int = 0) -> Iterator[int]:
    """Seeds of random cases, from `first` on: 3 in the quick tier, `count` in the gate, 100 times as many in a survey.

    A failure names its seed. ``FASTPIN_SEEDS=20000:20100`` chooses others, for all tests that are run. Only the test
    function itself may call this, so that its loop is seen where the test is read.
    """
    assert _now["seeded"], "seeds are asked for by the test function itself"
    number = {"quick": min(count, FEW), "gate": count, "survey": MANY * count}[_now["tier"]]
    chosen = os.environ.get("FASTPIN_SEEDS")
    begin, end = map(int, chosen.split(":")) if chosen else (first, first + number)
    for seed in range(begin, end):
        _now["seed"] = seed
        yield seed
    _now["seed"] = None


@pytest.hookimpl(wrapper=True)
def pytest_runtest_protocol(item: pytest.Item) -> Iterator[None]:
    _now.update(seed=None, seeded=is_seeded(item))
    return (yield)


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(call: pytest.CallInfo[None]) -> Iterator[None]:
    report = yield
    if report.failed and call.when == "call" and _now["seed"] is not None:
        report.sections.append(("seed of the failure", str(_now["seed"])))
    return report


def some_gate(values: Iterable[Any], *chosen: Any) -> list[Any]:
    """Parameters of a test; the `chosen` ones are left to the gate. A tuple is a row of several parameters."""
    return _some(pytest.mark.gate, values, chosen)


def some_survey(values: Iterable[Any], *chosen: Any) -> list[Any]:
    """Parameters of a test; the `chosen` ones are left to the survey."""
    return _some(pytest.mark.survey, values, chosen)


def _some(mark: pytest.MarkDecorator, values: Iterable[Any], chosen: Iterable[Any]) -> list[Any]:
    known, left = list(values), list(chosen)
    assert all(value in known for value in left), left
    rows = [(value, value if isinstance(value, tuple) else (value,)) for value in known]
    return [pytest.param(*row, marks=mark) if value in left else value for value, row in rows]


def gate(*values: Any) -> list[Any]:
    """Parameters of a test that are left to the gate. A tuple is a row of several parameters."""
    return some_gate(values, *values)
