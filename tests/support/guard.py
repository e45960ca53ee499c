"""The rules of the tiers. This plugin counts processor time, and watches processes, sockets, sleeps and figures.

A quick test takes at most 0.5 s of processor time, with its fixtures and child processes. It starts no process, opens
no socket, does not sleep, and draws no figure of full size. A test of the gate takes at most 5 s, a survey any time. A
fixture that tests share counts by itself, and has the same limit. A test that breaks a rule fails; one that takes up to
twice its time is listed, since other work on the machine slows it. On a slower machine the limits are wider. Compiling
a kernel is not counted: a machine does it once, with a process that helps. So no test fails in which a kernel was
compiled.
"""

import math
import os
import platform
import sys
import threading
import time
from collections import defaultdict
from collections.abc import Callable, Iterator
from multiprocessing.process import BaseProcess
from typing import Any

import pytest
from matplotlib.figure import Figure

from fastpin.runtime import machine
from tests.support.processes import ROOT
from tests.support.tiers import TIERS, tier_of

LIMITS = {"quick": 0.5, "gate": 5.0}
"""Seconds of processor time that a test may take on the usual machine."""

CODE = ROOT / "fastpin" / "kernels" / "__pycache__"
"""The folder that changes with each kernel that a process compiles."""

MARGIN = 2.0
"""Times of its limit that a test may take before it fails. In between it is listed."""

SHORT = 0.1
"""Seconds below which a test of the gate that breaks no rule might be a quick one."""

MOST_PIXELS = 500_000
"""Pixels of a bitmap that is no figure of full size."""

LOOP, USUAL = 200_000, 8e-3
"""Turns of a loop of plain Python, and the seconds of processor time that they take on the usual machine."""

EVENTS = {
    "subprocess.Popen": "a child process",
    "os.fork": "a child process",
    "socket.bind": "a socket",
    "socket.connect": "a socket",
}
"""Audit events of the interpreter that no quick test raises. A process that compiles kernels comes by none of them."""

_seen: dict[str, int] = defaultdict(int)
"""What the running test has done that no quick test does."""

_shared: list[tuple[float, str]] = []
"""Seconds of processor time of the shared fixtures that the running test has made, and their names."""

_compiling = [0.0]
"""Seconds of processor time that this process has compiled kernels."""


def spent() -> float:
    """Seconds of processor time of this process and of its children that have ended, without compilations."""
    children = os.times()
    return time.process_time() + children.children_user + children.children_system - _compiling[0]


def slowness() -> float:
    """How many times as long as usual plain Python takes now; at least 1."""
    best = min(_time_of_loop() for _ in range(3))
    return max(1.0, best / USUAL)


def _time_of_loop() -> float:
    begin = time.process_time()
    total = 0
    for number in range(LOOP):
        total += number
    return time.process_time() - begin


def _watch(owner: Any, name: str, count: Callable[..., str | None]) -> None:
    """Let a function count what it does for the running test, by the words that `count` makes of its arguments."""
    function = getattr(owner, name)

    def watched(*arguments: Any, **keywords: Any) -> Any:
        words = count(*arguments, **keywords)
        if words and threading.current_thread() is threading.main_thread():
            _seen[words] += 1
        return function(*arguments, **keywords)

    setattr(owner, name, watched)


def _size(figure: Figure, path: Any, **options: Any) -> str | None:
    dpi = options.get("dpi", figure.dpi)
    inches = figure.get_size_inches()
    pixels = inches[0] * inches[1] * (figure.dpi if dpi == "figure" else dpi) ** 2
    is_vector = str(path).endswith((".pdf", ".svg", ".svgz", ".eps")) or options.get("format") in ("pdf", "svg")
    return "a figure of full size" if pixels > MOST_PIXELS and not is_vector else None


def pytest_configure() -> None:
    platform.processor()  # starts a process once, which h5py would start within a test
    sys.addaudithook(lambda event, _: _seen.__setitem__(EVENTS[event], 1) if event in EVENTS else None)
    _watch(time, "sleep", lambda seconds: "a sleep" if seconds else None)
    _watch(BaseProcess, "start", lambda process: "a child process")
    _watch(Figure, "savefig", _size)
    for name in ("compile_kernel", "unpack"):
        setattr(machine, name, _uncounted(getattr(machine, name)))


def _uncounted(function: Callable[..., Any]) -> Callable[..., Any]:
    """A function whose processor time counts as compiling."""

    def timed(*arguments: Any, **keywords: Any) -> Any:
        begin = time.process_time()
        try:
            return function(*arguments, **keywords)
        finally:
            _compiling[0] += time.process_time() - begin

    return timed


@pytest.hookimpl(wrapper=True)
def pytest_fixture_setup(fixturedef: pytest.FixtureDef[Any]) -> Iterator[None]:
    begin, inner = spent(), sum(seconds for seconds, _ in _shared)
    try:
        return (yield)
    finally:
        if fixturedef.scope != "function":
            of_others = sum(seconds for seconds, _ in _shared) - inner
            _shared.append((spent() - begin - of_others, f"fixture {fixturedef.argname}: "))


BEGIN = pytest.StashKey[tuple[float, int]]()
"""The seconds that were spent, and the age of CODE."""


def _age_of_code() -> int:
    return CODE.stat().st_mtime_ns if CODE.exists() else 0


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_setup(item: pytest.Item) -> None:
    _seen.clear()
    _shared.clear()
    item.stash[BEGIN] = spent(), _age_of_code()


@pytest.hookimpl(wrapper=True, tryfirst=True)
def pytest_runtest_teardown(item: pytest.Item) -> Iterator[None]:
    result = yield
    begin, code = item.stash[BEGIN]
    tier, seconds = tier_of(item), spent() - begin
    item.user_properties += [("processor", round(seconds, 4)), ("tier", tier), ("seen", dict(_seen))]
    # Where a higher tier is running, with more seeds, its limit counts.
    limit = LIMITS.get(max(tier, item.config.getoption("tier"), key=TIERS.index), math.inf)
    parts = [(seconds - sum(each for each, _ in _shared), ""), *_shared]
    broken = [f"{name}{each:.2f} s of processor time" for each, name in parts if each > limit]
    if broken:
        slow = slowness()
        if max(parts)[0] > limit * slow:
            item.user_properties.append(("above", "; ".join(broken)))
        if max(parts)[0] <= MARGIN * limit * slow:
            broken = []
    broken += _seen if tier == "quick" else ()
    if code != _age_of_code():  # a process compiles what a machine lacks, too
        broken = []
    if broken and not item.get_closest_marker("browser"):
        above = TIERS[TIERS.index(tier) + 1]
        pytest.fail(f"too much for a test of the tier {tier}: {'; '.join(broken)}. Mark it {above}", pytrace=False)
    return result


def pytest_sessionfinish(session: pytest.Session) -> None:
    if output := getattr(session.config, "workeroutput", None):
        output["processor"] = sum(os.times()[:4])
    else:
        _workers.append(sum(os.times()[:2]))


_workers: list[float] = []
"""Seconds of processor time of each worker, from its start on."""


@pytest.hookimpl(optionalhook=True)
def pytest_testnodedown(node: Any) -> None:
    _workers.append(getattr(node, "workeroutput", {}).get("processor", 0.0))


def pytest_terminal_summary(terminalreporter: Any) -> None:
    """Say how much processor time the tests took, and which tests of the gate might be quick ones."""
    reports = [
        one for found in terminalreporter.stats.values() for one in found if getattr(one, "when", "") == "teardown"
    ]
    costs = [(one.nodeid, dict(one.user_properties)) for one in reports]
    costs = [(name, cost) for name, cost in costs if "processor" in cost]
    total = sum(cost["processor"] for _, cost in costs)
    terminalreporter.write_line(f"processor time: tests {total:.0f} s, with their workers {sum(_workers):.0f} s")
    for name, cost in costs:
        if "above" in cost:
            terminalreporter.write_line(f"above the limit of its tier: {name}, {cost['above']}")
    most: dict[str, float] = defaultdict(float)
    for name, cost in costs:
        if cost["tier"] == "gate":
            function = name.partition("[")[0]
            most[function] = max(most[function], math.inf if cost["seen"] else cost["processor"])
    for function, seconds in most.items():
        if seconds < SHORT:
            terminalreporter.write_line(f"marked gate, but quick: {function} ({seconds:.2f} s)")
