"""Do the tests notice? Change one small thing of the package at a time, and run the tests that can notice it.

``python -m scripts.mutants --tier quick [--checkout FOLDER]`` makes the fixed changes of ``mutants.toml``, one after
the other, in a private copy of a checkout: of this one, unless FOLDER names another one. The tests of the tier run
until the first failure: first the tests of the changed file, then of its folder, then those of NEAR. No time is too
long. With ``--count 400 --seed 1`` other changes are drawn, evenly over the folders of NEAR. ``--first`` and ``--last``
choose some of the changes, so that two processes can share them.

A test that fails in the unchanged copy, too, notices nothing, and is left out from then on. A run in which no test ends
for STUCK seconds is a notice. Answers are lines of JSON in ``out/mutants``, so that a run can be stopped and continued.
The list ``equivalent`` of ``mutants.toml`` has changes that alter no result, with a reason each. The exit code is 1 if
a change survives.

No library does this. mutmut 3 puts all variants of a function into the file and leaves decorated functions out; all
kernels are decorated. cosmic-ray starts the same tests for each change. Python's own ``ast`` gives the place of each
operator, so libcst is not needed.
"""

from __future__ import annotations

import argparse
import ast
import itertools
import json
import os
import random
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import tomllib
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple

from scripts.changes import changes

ROOT = Path(__file__).resolve().parents[1]

NEAR = {
    "runtime": ("kernels", "whole"),
    "kernels": ("solver", "reading", "states", "damage", "whole"),
    "elasticity": ("solver", "states", "verification", "whole"),
    "reading": ("states", "solver", "report", "whole"),
    "solver": ("states", "storage", "verification", "whole"),
    "narrow": ("solver", "whole"),
    "states": ("reading", "report", "solver", "studies", "whole"),
    "damage": ("cracks", "report", "studies"),
    "cracks": ("report", "studies", "cli"),
    "storage": ("studies", "cli", "whole"),
    "assess": ("report", "cli", "studies", "pages"),
    "report": ("cli", "pages", "studies"),
}
"""Folders whose files are changed, and the folders of tests that may notice it beside their own."""

TIERS = {"quick": ((), ("-m", "not slow")), "gate": (("--gate",), ("-m", ""))}
"""Options of pytest for each tier, and for checkouts of the time before the tiers."""

PYTEST = (
    "-x", "-v", "--no-header", "--tb=no", "-p", "no:cacheprovider", "-p", "no:xdist", "-p", "no:benchmark",
    "-p", "no:tests.support.guard",
)  # fmt: skip
"""Options of pytest. A changed test that takes longer breaks no rule of its tier."""

STUCK = 600.0
"""Seconds without the end of a test after which the tests hang: a changed kernel is compiled first."""


class Change(NamedTuple):
    """A changed line of a file: its text, without its margin, before and after. `line` is where it once stood."""

    file: str
    line: int
    before: str
    after: str

    def applied(self, source: str) -> str | None:
        """The changed file; None if the line is gone."""
        lines = source.split("\n")
        found = [number for number, line in enumerate(lines) if line.strip() == self.before]
        if not found:
            return None
        place = min(found, key=lambda number: abs(number + 1 - self.line))
        lines[place] = lines[place].replace(self.before, self.after)
        return "\n".join(lines)


@dataclass
class Copy:
    """A private copy of a checkout, in which tests run."""

    root: Path
    python: str
    options: tuple[str, ...]
    failing: set[str] = field(default_factory=set)

    @classmethod
    def of(cls, checkout: Path, folder: Path, tier: str) -> Copy:
        """Copy the files that git knows, and the machine code."""
        command = ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"]
        listed = subprocess.run(command, cwd=checkout, capture_output=True, text=True, check=True).stdout.split("\0")
        codes = (path for path in checkout.glob("fastpin/*/__pycache__/*") if path.suffix != ".pyc")
        for path in [*(checkout / name for name in listed if name), *codes]:
            if path.is_file():
                target = folder / path.relative_to(checkout)
                target.parent.mkdir(parents=True, exist_ok=True)
                shutil.copy2(path, target)
        options = TIERS[tier][not (checkout / "tests/support/tiers.py").exists()]
        return cls(folder, str(checkout / ".venv/bin/python"), options)

    def failure(self, tests: list[str]) -> str | None:
        """The first of these tests that fails, or "stuck"; None if all pass."""
        log = self.root / "said.txt"
        without = (f"--deselect={test}" for test in self.failing)
        # Bytecode of a changed file may have the time and the size of the unchanged one.
        environment = os.environ | {
            "PYTHONPATH": str(self.root),
            "PYTHONDONTWRITEBYTECODE": "1",
            "PYTHONUNBUFFERED": "1",
        }
        with log.open("w") as said:
            process = subprocess.Popen(
                [self.python, "-m", "pytest", *PYTEST, *self.options, *without, *tests],
                cwd=self.root, env=environment, stdout=said, stderr=said, start_new_session=True,
            )  # fmt: skip
            try:
                while process.poll() is None and time.time() - log.stat().st_mtime < STUCK:
                    time.sleep(0.05)
                is_stuck = process.poll() is None
            finally:
                if process.poll() is None:
                    os.killpg(process.pid, signal.SIGKILL)
        if is_stuck:
            return "stuck"
        if process.wait() in (0, 5):  # all pass, or no test is left
            return None
        failed = re.findall(r"^(tests/\S+::.+?) (?:FAILED|ERROR)|^ERROR (tests/\S+)", log.read_text(), re.MULTILINE)
        return next(("".join(each) for each in failed), "import")

    def examine(self, change: Change) -> dict[str, Any]:
        """Make a change, run the tests, and undo it. Return the test that notices it, and the seconds."""
        path, began = self.root / "fastpin" / change.file, time.monotonic()
        source = path.read_text(encoding="utf-8") if path.exists() else ""
        changed, tests = change.applied(source), self.tests_for(change.file)
        if changed is None:
            return {"test": "gone", "seconds": 0}
        while True:
            try:
                path.write_text(changed, encoding="utf-8")
                test = self.failure(tests)
            finally:
                path.write_text(source, encoding="utf-8")
            if test is None or "::" not in test or self.failure([test]) is None:
                return {"test": test, "seconds": round(time.monotonic() - began)}
            self.failing.add(test)

    def tests_for(self, file: str) -> list[str]:
        """The files of tests that may notice a change of a file, the nearest first."""
        home, stem = file.split("/")[0], Path(file).stem
        found = [path for folder in (home, *NEAR[home]) for path in sorted(self.root.glob(f"tests/{folder}/test_*.py"))]
        found.sort(key=lambda path: path.name != f"test_{stem}.py" or path.parent.name != home)
        return [str(path.relative_to(self.root)) for path in found]


def drawn(seed: int, folders: tuple[str, ...] = tuple(NEAR)) -> Iterator[Change]:
    """Changes of this checkout at random, of one folder after the other. Each lies in one line, and alters the code."""
    listed = known()["equivalent"]
    excused = {(file, before, after) for file, before, after, _ in listed}
    every = []
    for folder in folders:
        rng, found = random.Random(f"{seed} {folder}"), []
        for path in sorted((ROOT / "fastpin" / folder).glob("*.py")):
            file, source = f"{folder}/{path.name}", path.read_bytes()
            for one in changes(file, source, rng):
                if b"\n" not in source[one.start : one.stop] and (file, one.before, one.after) not in excused:
                    found.append(Change(file, one.line, one.before, one.after))
        rng.shuffle(found)
        every.append(filter(alters, found))
    for in_turn in itertools.zip_longest(*every):
        yield from (change for change in in_turn if change is not None)


def alters(change: Change) -> bool:
    """Whether a change alters the code. A sign of a constant in brackets may not."""
    source = (ROOT / "fastpin" / change.file).read_text(encoding="utf-8")
    return ast.dump(ast.parse(source)) != ast.dump(ast.parse(change.applied(source) or source))


def known() -> dict[str, Any]:
    """The lists of mutants.toml: fixed changes, and changes that alter no result."""
    return tomllib.loads(Path(__file__).with_suffix(".toml").read_text(encoding="utf-8"))


def main() -> None:
    """Run the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--tier", choices=TIERS, default="quick")
    parser.add_argument("--checkout", type=Path, default=ROOT)
    parser.add_argument("--count", type=int, help="draw so many changes, in place of the fixed ones")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--last", type=int)
    options = parser.parse_args()
    signal.signal(signal.SIGTERM, lambda *_: sys.exit("stopped"))  # what runs ends, too
    fixed = [Change(*each) for each in known()["fixed"]]
    picked = list(itertools.islice(drawn(options.seed), options.count)) if options.count else fixed
    checkout = options.checkout.resolve()
    file = ROOT / "out" / "mutants" / f"{checkout.name}-{options.tier}.jsonl"
    file.parent.mkdir(parents=True, exist_ok=True)
    answers = {}
    if file.exists():
        lines = map(json.loads, file.read_text(encoding="utf-8").splitlines())
        answers = {tuple(line["change"]): line for line in lines}
    print("| change | before | after | noticed by | seconds |\n|---|---|---|---|--:|")
    with tempfile.TemporaryDirectory() as folder:
        copy = Copy.of(checkout, Path(folder), options.tier)
        for change in picked[options.first : options.last]:
            if change not in answers:
                answers[change] = {"change": change, **copy.examine(change)}
                with file.open("a", encoding="utf-8") as out:
                    out.write(json.dumps(answers[change]) + "\n")
            answer = answers[change]
            cells = (
                f"{change.file}:{change.line}",
                f"`{change.before}`",
                f"`{change.after}`",
                answer["test"] or "**no test**",
            )
            print("|", " | ".join(cells), "|", answer["seconds"], "|", flush=True)
    sys.exit(any(answers[change]["test"] is None for change in picked[options.first : options.last]))


if __name__ == "__main__":
    main()
