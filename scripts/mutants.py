"""Do the tests notice? Change one small thing of the package at a time, and run the tests that can notice it.

``python -m scripts.mutants [--count 400] [--seed 1] [--all]`` picks places by a seed, evenly over the folders of
FOLDERS in turn: a part of a run is a fair sample, too. Each change is made in a private copy of the tree. The tests run
in a process forked from this one, which has imported the libraries, but nothing of fastpin.

The tests are chosen by a map from lines to tests. It is recorded once, with coverage.py, and again for what has
changed. Tests of the changed file's folder come first, then quick ones, until the first failure. The unchanged tests
of one change take at most BUDGET seconds; ``--all`` has no such limit. Kernels run as plain Python, since compiling
takes longer than testing. A test that takes MOST_TIMES its usual time, and MARGIN, has timed out: a notice, too.

The answers are lines of JSON in ``out/mutants``, so that a run can be stopped and continued. ``mutants.toml`` lists
changes that alter no result, with the reason. A run fails if other changes survive. ``--again`` tests old survivors.

No library does this. mutmut 3 puts all variants of a function into the file and leaves decorated functions out; all
kernels are decorated. cosmic-ray starts a new process with the same tests for each change, here a minute instead of
seconds. Python's own ``ast`` gives the place of each operator, so libcst is not needed.
"""

from __future__ import annotations

import argparse
import ast
import collections
import contextlib
import hashlib
import itertools
import json
import os
import random
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import tomllib
import traceback
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from scripts.changes import Change, changes

ROOT = Path(__file__).resolve().parents[1]
OUT = ROOT / "out" / "mutants"
FOLDERS = ("runtime", "kernels", "elasticity", "reading", "solver", "states", "damage", "cracks", "storage")
TESTS = (*FOLDERS, "whole")
"""Folders of the tests that may notice a change."""

BUDGET = 15.0
"""Seconds that the chosen tests of one change take, unchanged."""

FIRST = 1.5
"""Seconds of tests of each file, unchanged, before the longer tests of any file begin."""

LONGEST = 4.0
"""Seconds after which a test that runs as plain Python is not waited for: the compiled one takes milliseconds."""

PLAIN = "tests/kernels/"
"""Tests that run with kernels as plain Python."""

TOO_SLOW = ("tests/runtime/test_products.py",)
"""Tests of kernels that follow whole histories."""

MOST_TIMES, MARGIN = 5.0, 5.0
"""Times of a test's own time, and seconds beside it, after which it has timed out."""

MEMORY = 6 << 30
"""Bytes of address space of a process that runs tests."""

STUCK = 300.0
"""Seconds of waiting, beside MOST_TIMES of the unchanged time, after which tests hang: the machine may be busy."""

SKIPPED = ("tests/whole/test_mutations.py", "tests/runtime/test_jit.py")
"""Tests that start many processes or compile. They test no formula."""


# -- the copy and its processes ------------------------------------------------------------------------------


class Copy:
    """A private copy of the tree.

    Parameters
    ----------
    folder : Path
        Where it is made.
    """

    def __init__(self, folder: Path) -> None:
        self.root = folder / "tree"
        names = subprocess.run(
            ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
            cwd=ROOT, capture_output=True, text=True, check=True,
        ).stdout.split("\0")  # fmt: skip
        for name in filter(None, names):
            if (ROOT / name).is_file():
                (self.root / name).parent.mkdir(parents=True, exist_ok=True)
                shutil.copy2(ROOT / name, self.root / name)
        cache = Path("fastpin", "kernels", "__pycache__")
        shutil.copytree(ROOT / cache, self.root / cache, dirs_exist_ok=True)
        self.told = folder / "told.json"

    def forked(self, work: Callable[[], None], longest: float, plain: bool) -> tuple[str, float]:
        """Call a function in a process of its own. Return how it ended, and its CPU seconds with its children's."""
        self.told.write_text("{}")
        process = os.fork()
        if process == 0:
            self._enter(work, plain)
        began = time.monotonic()
        try:
            done, status, usage = 0, 0, None
            while not done and time.monotonic() - began < longest:
                time.sleep(0.005)
                done, status, usage = os.wait4(process, os.WNOHANG)
        finally:
            _kill(process)  # also what the tests have started, and left behind
        if not done:
            _, status, usage = os.wait4(process, 0)
        return _ending(status), usage.ru_utime + usage.ru_stime

    def _enter(self, work: Callable[[], None], plain: bool) -> None:
        code = 1
        try:
            os.setsid()
            signal.signal(signal.SIGTERM, signal.SIG_DFL)
            output = os.open(self.told.with_suffix(".log"), os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
            os.dup2(output, 1)
            os.dup2(output, 2)
            resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
            os.chdir(self.root)
            # The installed package is the working tree; the copy comes before it, here and in processes of tests.
            sys.path[:] = [str(self.root), *(path for path in sys.path if Path(path or ".").resolve() != ROOT)]
            os.environ["PYTHONPATH"] = str(self.root)
            if plain:
                os.environ["NUMBA_DISABLE_JIT"] = "1"
                import numba

                numba.core.config.reload_config()
            work()
            code = 0
        except BaseException:
            traceback.print_exc()
        finally:
            sys.stderr.flush()
            os._exit(code)


def _kill(process: int) -> None:
    with contextlib.suppress(ProcessLookupError):
        os.killpg(process, signal.SIGKILL)


def _ending(status: int) -> str:
    if not os.WIFSIGNALED(status):
        return f"code {os.WEXITSTATUS(status)}"
    number = os.WTERMSIG(status)
    return "timeout" if number in (signal.SIGPROF, signal.SIGKILL) else signal.Signals(number).name


def import_libraries() -> None:
    """Import what all tests import, once."""
    import h5py  # noqa: F401
    import hypothesis  # noqa: F401
    import mpmath  # noqa: F401
    import numba  # noqa: F401
    import numpy as np  # noqa: F401
    import pytest  # noqa: F401
    import scipy.integrate
    import scipy.linalg
    import scipy.optimize
    import scipy.special  # noqa: F401


# -- the map from lines to tests -----------------------------------------------------------------------------


class Recorder:
    """A plug-in of pytest that notes the lines, seconds and outcome of each test.

    Parameters
    ----------
    measured : coverage.Coverage
    longest : float or None
        CPU seconds after which a test is given up.
    """

    def __init__(self, measured: Any, longest: float | None) -> None:
        self.measured, self.longest = measured, longest
        self.seconds: dict[str, float] = {}
        self.passed: dict[str, bool] = {}

    def pytest_runtest_logstart(self, nodeid: str) -> None:
        self.measured.switch_context(nodeid)
        self.began = time.process_time()
        if self.longest:
            signal.signal(signal.SIGVTALRM, _give_up)
            signal.setitimer(signal.ITIMER_VIRTUAL, self.longest)

    def pytest_runtest_logreport(self, report: Any) -> None:
        self.passed[report.nodeid] = self.passed.get(report.nodeid, True) and report.outcome == "passed"

    def pytest_runtest_logfinish(self, nodeid: str) -> None:
        signal.setitimer(signal.ITIMER_VIRTUAL, 0.0)
        self.measured.switch_context("")
        self.seconds[nodeid] = time.process_time() - self.began


def _give_up(*_: Any) -> None:
    raise TimeoutError


class Map:
    """Which tests run through which lines, and how long they take.

    Parameters
    ----------
    copy : Copy
    plain : bool
        Whether kernels run as plain Python.
    """

    def __init__(self, copy: Copy, plain: bool) -> None:
        self.copy, self.plain = copy, plain
        self.file = OUT / f"map-{'plain' if plain else 'compiled'}.json"
        self.parts: dict[str, dict[str, Any]] = json.loads(self.file.read_text()) if self.file.exists() else {}
        self.seconds: dict[str, float] = {}
        self.lines: dict[str, set[str]] = collections.defaultdict(set)

    def record(self) -> None:
        """Run the tests of which nothing is known, a file at a time."""
        package = _digest(*sorted((ROOT / "fastpin").rglob("*.py")))
        files = [path for name in TESTS for path in sorted((ROOT / "tests" / name).glob("test_*.py"))]
        names = [name for path in files if (name := str(path.relative_to(ROOT))) not in SKIPPED]
        if self.plain:
            names = [name for name in names if name.startswith(PLAIN) and name not in TOO_SLOW]
        for name in names:
            digest = package + _digest(ROOT / name)
            if self.parts.get(name, {}).get("digest") != digest:
                self.copy.forked(lambda name=name: self._run(name), 900.0, self.plain)
                told = json.loads(self.copy.told.read_text())
                self.parts[name] = {"seconds": {}, "lines": {}} | told | {"digest": digest}
                print(f"{name}: {len(self.parts[name]['seconds'])} tests", flush=True)
                self.file.write_text(json.dumps(self.parts))
        self.parts = {name: part for name, part in self.parts.items() if name in names}
        for part in self.parts.values():
            self.seconds |= part["seconds"]
            for place, tests in part["lines"].items():
                self.lines[place].update(tests)

    def _run(self, name: str) -> None:
        import coverage
        import pytest

        measured = coverage.Coverage(data_file=None, config_file=False, include=[f"{self.copy.root}/fastpin/*"])
        plugin = Recorder(measured, LONGEST if self.plain else None)
        measured.start()
        pytest.main([name, *OPTIONS], plugins=[plugin])
        measured.stop()
        passed = {test: seconds for test, seconds in plugin.seconds.items() if plugin.passed.get(test)}
        data, lines = measured.get_data(), {}
        for file in data.measured_files():
            short = str(Path(file).relative_to(self.copy.root))
            for line, tests in data.contexts_by_lineno(file).items():
                if known := [test for test in tests if test in passed]:
                    lines[f"{short}:{line}"] = known
        self.copy.told.write_text(json.dumps({"seconds": passed, "lines": lines}))

    def choose(self, change: Change, budget: float) -> list[str]:
        """The tests that can notice a change, the most promising first."""
        last = change.line + self.copy.root.joinpath(change.file).read_bytes()[change.start : change.stop].count(b"\n")
        # A condition, an argument or a string may belong to a statement that coverage.py counts at an earlier line.
        near = [f"{change.file}:{line}" for line in range(change.line, last + 1)]
        tests = set().union(*(self.lines.get(place, set()) for place in near))
        if not tests and (lines := sorted(self._known(change.file))):
            before = [line for line in lines if line <= change.line]
            within = change.function and before
            places = [before[-1]] if within else lines  # a constant of a file: whatever uses the file
            tests = set().union(*(self.lines[f"{change.file}:{line}"] for line in places))
        # Values that a fixture or a cache has made are seen by other tests of the file, too.
        files = {test.partition("::")[0] for test in tests}
        others = {test for file in files for test in self.parts[file]["seconds"]} - tests
        chosen, spent = [], 0.0
        for test in [*self._ordered(tests, change), *self._ordered(others, change)]:
            if chosen and spent + self.seconds[test] > budget:
                continue
            spent += self.seconds[test]
            chosen.append(test)
        return chosen

    def _known(self, file: str) -> Iterator[int]:
        for place in self.lines:
            name, _, line = place.rpartition(":")
            if name == file:
                yield int(line)

    def _ordered(self, tests: set[str], change: Change) -> list[str]:
        home = change.file.split("/")[1]
        stem = Path(change.file).stem
        by_file: dict[str, list[str]] = collections.defaultdict(list)
        for test in sorted(tests, key=lambda test: (self.seconds[test], test)):
            by_file[test.partition("::")[0]].append(test)
        ranks = []
        for file, own in by_file.items():
            spent = 0.0
            rank = (f"test_{stem}.py" not in file, f"tests/{home}/" not in file, sum(self.seconds[t] for t in own))
            for test in own:
                spent += self.seconds[test]
                ranks.append((spent > FIRST, rank, file, test))
        ranks.sort(key=lambda one: one[:3])
        return [test for *_, test in ranks]


OPTIONS = (
    "-q", "--no-header", "-m", "not slow", "-p", "no:cacheprovider", "-p", "no:xdist", "-p", "no:benchmark",
    "-W", "ignore::pytest.PytestAssertRewriteWarning",
)  # fmt: skip
"""Options of pytest."""


def _digest(*files: Path) -> str:
    return hashlib.sha256(b"\0".join(file.read_bytes() for file in files)).hexdigest()[:16]


# -- one change ----------------------------------------------------------------------------------------------


class Watcher:
    """A plug-in of pytest that runs tests in the chosen order, and notes the first that fails.

    Parameters
    ----------
    tests : list of str
    seconds : dict
        The CPU time of each unchanged test.
    told : Path
        Where it says which test is running or has failed.
    """

    def __init__(self, tests: list[str], seconds: dict[str, float], told: Path) -> None:
        self.order = {test: number for number, test in enumerate(tests)}
        self.seconds, self.told = seconds, told

    def pytest_collection_modifyitems(self, items: list[Any]) -> None:
        items[:] = sorted(
            (item for item in items if item.nodeid in self.order), key=lambda item: self.order[item.nodeid]
        )

    def pytest_runtest_logstart(self, nodeid: str) -> None:
        self.told.write_text(json.dumps({"test": nodeid}))
        signal.setitimer(signal.ITIMER_PROF, MOST_TIMES * self.seconds[nodeid] + MARGIN)

    def pytest_runtest_logfinish(self) -> None:
        signal.setitimer(signal.ITIMER_PROF, 0.0)


def examine(copy: Copy, known: Map, change: Change, budget: float) -> dict[str, Any]:
    """Make a change, run the tests, and undo it. Return the answer: noticed by which test, timed out, or survived."""
    tests = known.choose(change, budget)
    unchanged = sum(known.seconds[test] for test in tests)
    answer: dict[str, Any] = {"tests": len(tests), "unchanged": round(unchanged, 2)}
    if not tests:
        return answer | {"outcome": "survived", "test": None, "seconds": 0.0}
    path = copy.root / change.file
    source = path.read_bytes()

    def work() -> None:
        import pytest

        sys.dont_write_bytecode = True  # bytecode of a changed file may have the time and the size of the unchanged one
        os.environ["PYTHONDONTWRITEBYTECODE"] = "1"
        watcher = Watcher(tests, known.seconds, copy.told)
        files = list(dict.fromkeys(test.partition("::")[0] for test in tests))
        code = pytest.main(["-x", *files, *OPTIONS], plugins=[watcher])
        os._exit(int(code))

    try:
        path.write_bytes(change.applied(source))
        for stale in (path.parent / "__pycache__").glob(f"{path.stem}.cpython-*.pyc"):
            stale.unlink()
        ending, seconds = copy.forked(work, MOST_TIMES * unchanged + STUCK, known.plain)
    finally:
        path.write_bytes(source)
    test = json.loads(copy.told.read_text()).get("test", "import")
    outcome = {"code 0": "survived", "timeout": "timed out"}.get(ending, "noticed")
    return answer | {"outcome": outcome, "test": test if outcome != "survived" else None, "seconds": round(seconds, 2)}


# -- the whole -----------------------------------------------------------------------------------------------


def sample(count: int, seed: int) -> list[Change]:
    """Pick places evenly over the folders, the folders in turn."""
    picked = []
    share = -(-count // len(FOLDERS))
    for folder in FOLDERS:
        rng = random.Random(f"{seed} {folder}")
        found = [
            change
            for path in sorted((ROOT / "fastpin" / folder).glob("*.py"))
            if path.name != "__init__.py"
            for change in changes(str(path.relative_to(ROOT)), path.read_bytes(), rng)
        ]
        rng.shuffle(found)
        picked.append(list(itertools.islice(filter(is_change, found), share)))
    in_turn = [part[number] for number in range(max(map(len, picked))) for part in picked if number < len(part)]
    return in_turn[:count]


def is_change(change: Change) -> bool:
    """Whether a change alters the code. A sign of a constant in brackets may not."""
    source = (ROOT / change.file).read_bytes()
    return ast.dump(ast.parse(source)) != ast.dump(ast.parse(change.applied(source)))


def equivalents() -> dict[tuple[str, ...], str]:
    """The changes that alter no result, and why."""
    listed = tomllib.loads(Path(__file__).with_suffix(".toml").read_text(encoding="utf-8"))["equivalent"]
    return {tuple(one[name] for name in ("file", "function", "before", "after")): one["reason"] for one in listed}


def runs_compiled(file: str) -> bool:
    """Whether a file holds kernels, or constants that are compiled into them."""
    text = (ROOT / file).read_text(encoding="utf-8")
    is_kernel = any(line in ("@compiled", "@inner") for line in text.splitlines())
    return is_kernel or file in ("fastpin/kernels/arrays.py", "fastpin/kernels/status.py")


def examine_all(options: argparse.Namespace, picked: list[Change]) -> dict[tuple[str, ...], dict[str, Any]]:
    """Examine the changes that have no answer yet. Return all answers by the keys of the changes."""
    answers_file = OUT / "answers.jsonl"
    answers: dict[tuple[str, ...], dict[str, Any]] = {}
    if answers_file.exists():
        for line in answers_file.read_text(encoding="utf-8").splitlines():
            answer = json.loads(line)
            answers[tuple(answer["key"])] = answer
    excused = equivalents()
    open_changes = [
        one
        for one in picked
        if one.key not in answers
        or (options.again and answers[one.key]["outcome"] == "survived" and one.key not in excused)
    ]
    if not open_changes:
        return answers
    import_libraries()
    with tempfile.TemporaryDirectory() as name:
        copy = Copy(Path(name))
        plain, compiled = Map(copy, plain=True), Map(copy, plain=False)
        for known in (compiled, plain):
            known.record()
        for number, change in enumerate(open_changes):
            # Where plain Python is too slow for every test, the changed kernel is compiled.
            known = plain if runs_compiled(change.file) and plain.choose(change, 0.0) else compiled
            answer = examine(copy, known, change, float("inf") if options.all else BUDGET)
            answer = {"key": list(change.key), "line": change.line, **answer}
            answers[change.key] = answer
            with answers_file.open("a", encoding="utf-8") as file:
                file.write(json.dumps(answer) + "\n")
            print(f"{number + 1}/{len(open_changes)} {change.file}:{change.line}: {answer['outcome']}", flush=True)
    return answers


def summary(picked: list[Change], answers: dict[tuple[str, ...], dict[str, Any]]) -> int:
    """Print the counts of each folder and the survivors. Return how many survivors have no reason."""
    excused = equivalents()
    counts: dict[str, collections.Counter[str]] = collections.defaultdict(collections.Counter)
    survivors = []
    for change in picked:
        outcome = answers[change.key]["outcome"]
        if outcome == "survived" and change.key in excused:
            outcome = "equivalent"
        elif outcome == "survived":
            survivors.append(change)
        counts[change.file.split("/")[1]][outcome] += 1
    for change in survivors:
        print(f"{change.file}:{change.line} {change.function}\n  - {change.before}\n  + {change.after}")
    for folder, count in counts.items():
        print(f"{folder:12}", ", ".join(f"{number} {outcome}" for outcome, number in sorted(count.items())))
    print(f"CPU time: {sum(answers[change.key]['seconds'] for change in picked):.0f} s")
    return len(survivors)


def main() -> None:
    """Run the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=400, help="places")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--all", action="store_true", help="run all tests that can notice a change, however long")
    parser.add_argument("--again", action="store_true", help="test the survivors of earlier runs again")
    options = parser.parse_args()
    for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS"):
        os.environ[name] = "1"
    signal.signal(signal.SIGTERM, lambda *_: sys.exit("stopped"))
    OUT.mkdir(parents=True, exist_ok=True)
    picked = sample(options.count, options.seed)
    raise SystemExit(summary(picked, examine_all(options, picked)) > 0)


if __name__ == "__main__":
    main()
