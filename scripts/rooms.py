"""Count what a change of the package costs: lines, files, places that know a noun, and the calls of one solve.

``python -m scripts.rooms [FOLDER]`` prints the numbers of a checkout, of this one unless FOLDER names another one. With
``--calls`` it also imports fastpin, solves, runs, shows and reports a case in the environment of that checkout, and
counts the tests. ``--list NAME`` prints the places behind a number. tests/project/test_rooms.py holds some down.
"""

from __future__ import annotations

import argparse
import ast
import io
import json
import re
import subprocess
import sys
import tempfile
import token
import tokenize
from collections import Counter, defaultdict
from collections.abc import Callable
from functools import cached_property, partial
from pathlib import Path
from typing import Any

HERE = Path(__file__).resolve().parents[1]

NOUNS = ("gauge_radius", "slip_sums", "Ring", "fatigue", "crack", "wear", "strength")
"""Nouns of one field, one option, one body and four sections. The files that name them are counted."""

CORE = ("runtime", "kernels", "model", "bodies", "elasticity", "reading", "states", "solver")
"""The folders that a solution needs. All other files of the package are the outer ones."""

WINGS = ("lugs", "tables", "narrow", "drift")
"""Folders that few solutions need. A plain solution imports none of their files."""

BODIES = {"Disk", "Tube", "Plate", "Ring", "Bushing", "Compliance", "PinBody", "PlateBody"}
"""Classes of bodies."""

FEW_LINES = 5
"""A private function that is used once has more lines than this, or it could stand in its caller."""

NO_CODE = {tokenize.COMMENT, tokenize.NL, token.NEWLINE, token.INDENT, token.DEDENT, token.ENDMARKER}
"""Kinds of tokens that make no line of code."""

CALLS = """
import json, os, sys, time
import numpy
began = time.process_time()
import fastpin
fastpin.solve
found = {"modules of an import": sum(name.startswith("fastpin") for name in sys.modules)}
found["ms of an import"] = round(1e3 * (time.process_time() - began))
import h5py
from fastpin.cli.main import main

package = os.path.dirname(fastpin.__file__) + os.sep
entered, counted, opened, init = set(), {}, [], h5py.File.__init__

def trace(frame, event, _):
    code = frame.f_code
    if code.co_filename.startswith(package):
        if event == "call":
            entered.add(code.co_filename)
            counted["calls"] += 1
            counted["now"] += 1
            counted["depth"] = max(counted["depth"], counted["now"])
            kernel = frame.f_locals["self"] if code.co_name == "__call__" else None
            if (getattr(kernel, "__module__", ""), getattr(kernel, "__name__", "")) == ("fastpin.kernels.held", "step"):
                counted["frames above held.step"] = max(counted["frames above held.step"], counted["now"] - 1)
        elif event == "return":
            counted["now"] -= 1

def count(name, call):
    for measured in (False, True):
        entered.clear()
        opened.clear()
        counted.update({"calls": 0, "now": 0, "depth": 0, "frames above held.step": 0})
        sys.setprofile(trace if measured else None)
        call()
        sys.setprofile(None)
    numbers = {"files": len(entered), **counted, "opens": len(opened)}
    found.update({f"{kind} of a warm {name}": number for kind, number in numbers.items() if number and kind != "now"})

def counted_init(self, *arguments, **keywords):
    if isinstance(arguments[0], (str, os.PathLike)):  # h5py also makes such objects of a file that is open
        opened.append(1)
    init(self, *arguments, **keywords)

h5py.File.__init__ = counted_init
case = fastpin.read_case("case.toml")
known = set(sys.modules)
count("solve", lambda: fastpin.solve(case.problem, case.history, nodes=101))
wings = [name for name in set(sys.modules) - known if name.count(".") == 2 and name.split(".")[1] in WINGS]
found["files of wings that a solve imports"] = len(wings)
sys.argv[1:] = []
sys.stdout = open(os.devnull, "w")
count("fastpin run", lambda: main(["run", "case.toml", "--nodes", "101"]))
if WHOLE:
    main(["run", "case.toml", "--nodes", "101", "-o", "result.h5"])
    count("fastpin show", lambda: main(["show", "result.h5"]))
    count("fastpin report", lambda: main(["report", "result.h5", "-o", "page.html"]))
sys.stdout = sys.__stdout__
print(json.dumps(found))
"""


Places = list[str] | float
"""The places behind a number, or the number itself."""


class Package:
    """The Python files of the package in a checkout, and what can be counted in them."""

    def __init__(self, checkout: Path) -> None:
        self.checkout, folder = checkout, checkout / "fastpin"
        paths = sorted(folder.rglob("*.py"), key=str)
        self.texts = {path.relative_to(folder).as_posix(): path.read_text("utf-8") for path in paths}

    @cached_property
    def trees(self) -> dict[str, ast.Module]:
        return {name: ast.parse(text) for name, text in self.texts.items()}

    @cached_property
    def nodes(self) -> dict[type, list[tuple[str, Any]]]:
        """All nodes of the trees with their files, by type."""
        found = defaultdict(list)
        for name, tree in self.trees.items():
            for node in ast.walk(tree):
                found[type(node)].append((name, node))
        return found

    @cached_property
    def words(self) -> dict[str, Counter[str]]:
        """How often each word stands in each file."""
        return {name: Counter(re.findall(r"\w+", text)) for name, text in self.texts.items()}

    @cached_property
    def code(self) -> dict[str, set[int]]:
        """The numbers of the lines of each file without docstrings, comments and blank lines."""
        found: dict[str, set[int]] = {name: set() for name in self.texts}
        for name, text in self.texts.items():
            for each in tokenize.generate_tokens(io.StringIO(text).readline):
                if each.type not in NO_CODE:
                    found[name].update(range(each.start[0], each.end[0] + 1))
        for name, node in self.nodes[ast.Expr]:
            if isinstance(node.value, ast.Constant) and isinstance(node.value.value, str):
                found[name].difference_update(lines_of(node))
        return found

    def files_naming(self, noun: str) -> list[str]:
        """The files in which a word stands."""
        return [name for name, words in self.words.items() if noun in words]

    def places_saying(self, text: str) -> list[str]:
        """The files that say something, once for each time."""
        return [name for name, whole in self.texts.items() for _ in range(whole.count(text))]

    def body_kinds(self) -> list[str]:
        """Places outside ``bodies/`` that ask by ``isinstance`` for the kind of a body."""
        return [
            f"{name}:{node.lineno}"
            for name, node in self.nodes[ast.Call]
            if isinstance(node.func, ast.Name)
            and node.func.id == "isinstance"
            and not name.startswith("bodies/")
            and BODIES & {each.id for each in ast.walk(node.args[1]) if isinstance(each, ast.Name)}
        ]

    def drives(self) -> list[str]:
        """Places that ask whether a drive is None."""
        return [
            f"{name}:{node.lineno}"
            for name, node in self.nodes[ast.Compare]
            if isinstance(node.ops[0], (ast.Is, ast.IsNot))
            and ast.unparse(node.comparators[0]) == "None"
            and ast.unparse(node.left).rpartition(".")[2].lstrip("_") == "drive"
        ]

    def twice_defined(self) -> list[str]:
        """Classes and names of types that are defined in more than one file."""
        homes = defaultdict(set)
        for name, tree in self.trees.items():
            for node in tree.body:
                if isinstance(node, ast.ClassDef):
                    homes[node.name].add(name)
                elif isinstance(node, ast.Assign) and isinstance(node.value, (ast.Subscript, ast.BinOp)):
                    targets = (each.id for each in node.targets if isinstance(each, ast.Name))
                    for target in targets:
                        if re.fullmatch(r"_?[A-Z]+[a-z]\w*", target):
                            homes[target].add(name)
        return [f"{name}: {', '.join(sorted(files))}" for name, files in sorted(homes.items()) if len(files) > 1]

    def used_once(self) -> list[tuple[str, ast.FunctionDef]]:
        """Private functions and methods without decorators that one place of their file uses."""
        return [
            (name, node)
            for name, node in self.nodes[ast.FunctionDef]
            if re.match(r"_[a-z]", node.name) and not node.decorator_list and self.words[name][node.name] == 2
        ]

    def small_private_functions(self) -> list[str]:
        """Private functions and methods of few lines that one place uses."""
        few = (at for at in self.used_once() if len(self.code[at[0]] & lines_of(at[1])) <= FEW_LINES)
        return [place(*at) for at in few]

    def constants(self) -> list[str]:
        """Constants of modules."""
        return [
            f"{name}: {target.id}"
            for name, tree in self.trees.items()
            for node in tree.body
            if isinstance(node, (ast.Assign, ast.AnnAssign))
            for whole in (node.targets if isinstance(node, ast.Assign) else [node.target])
            for target in ast.walk(whole)
            if isinstance(target, ast.Name) and re.fullmatch(r"_?[A-Z][A-Z0-9_]*", target.id)
        ]

    def hidden_imports(self) -> list[str]:
        """Imports of the own public face, and imports of a named file by ``importlib``."""
        named = r"importlib.import_module\('fastpin[^()]*\)"
        calls = (at for at in self.nodes[ast.Call] if getattr(at[1].func, "attr", "") == "import_module")
        found = [(name, node) for name, node in calls if re.fullmatch(named, ast.unparse(node))]
        for name, node in self.nodes[ast.ImportFrom]:
            if node.module == "fastpin" and name.partition("/")[0] in {alias.name for alias in node.names}:
                found.append((name, node))
        return [f"{name}:{node.lineno}" for name, node in sorted(found, key=lambda at: (at[0], at[1].lineno))]

    def defined(self, kind: type, pattern: str = r"\w+") -> list[str]:
        """Functions or classes whose whole name matches."""
        return [place(*at) for at in self.nodes[kind] if re.fullmatch(pattern, at[1].name)]

    def lines_of_code(self) -> list[str]:
        """Lines without docstrings, comments and blank lines."""
        return [f"{name}:{line}" for name, lines in self.code.items() for line in sorted(lines)]

    def mean_body(self) -> float:
        """Mean lines of code of the functions of the core, without their heads."""
        functions = [(name, node) for name, node in self.nodes[ast.FunctionDef] if core([name])]
        lines = sum(len(self.code[name] & lines_of(node, node.body[0])) for name, node in functions)
        return round(lines / len(functions), 1)

    def import_lines(self) -> list[str]:
        """Lines of imports."""
        both = self.nodes[ast.Import] + self.nodes[ast.ImportFrom]
        return sorted({f"{name}:{line}" for name, node in both for line in lines_of(node)})

    def lines_in(self, folder: str, without: str = "") -> int:
        """All lines of the texts of a folder outside the package, without one of its folders."""
        files = (
            file
            for file in (self.checkout / folder).rglob("*")
            if file.is_file() and file.suffix not in (".zip", ".pyc")
        )
        return sum(file.read_bytes().count(b"\n") for file in files if without not in file.parts)

    def functions_of_tests(self) -> int:
        """Functions of tests, each perhaps with many parameters."""
        texts = (path.read_text("utf-8") for path in (self.checkout / "tests").rglob("test_*.py"))
        return sum(len(re.findall(r"^ *(?:async )?def test_", text, re.MULTILINE)) for text in texts)


def place(name: str, node: Any) -> str:
    """The place and the name of a function or a class."""
    return f"{name}:{node.lineno} {node.name}"


def lines_of(node: Any, first: Any = None) -> set[int]:
    """The numbers of the lines of a node, from its part `first` on."""
    return set(range((first or node).lineno, node.end_lineno + 1))


def core(places: list[str]) -> list[str]:
    """The places in the core."""
    return [each for each in places if each.partition("/")[0] in CORE]


def outer(places: list[str]) -> list[str]:
    """The places outside the core."""
    return [each for each in places if each.partition("/")[0] not in CORE]


NUMBERS: dict[str, Callable[[Package], Places]] = {
    **{f"files naming {noun}": partial(Package.files_naming, noun=noun) for noun in NOUNS},
    "isinstance of bodies outside bodies/": Package.body_kinds,
    "drive is None, or not": Package.drives,
    "classes defined twice": Package.twice_defined,
    "small private functions used once": Package.small_private_functions,
    "constants of modules": Package.constants,
    "hidden imports": Package.hidden_imports,
    "lines of code": Package.lines_of_code,
    "lines of code of the core": lambda package: core(package.lines_of_code()),
    "files of the core": lambda package: core([*package.texts]),
    "functions of the core": lambda package: core(package.defined(ast.FunctionDef)),
    "private functions of the core used once": lambda package: core([place(*at) for at in package.used_once()]),
    "mean lines of a body of the core": Package.mean_body,
    "classes of the core": lambda package: core(package.defined(ast.ClassDef)),
    "constants of the core": lambda package: core(package.constants()),
    "lines of code of the outer files": lambda package: outer(package.lines_of_code()),
    "outer files": lambda package: outer([*package.texts]),
    "outer files below 50 lines of code": lambda package: outer(
        [n for n, code in package.code.items() if len(code) < 50]
    ),
    "lines of imports of the outer files": lambda package: outer(package.import_lines()),
    "documents": partial(Package.defined, kind=ast.FunctionDef, pattern=r"(\w+_)?document"),
    "places that say unknown key": partial(Package.places_saying, text="unknown key"),
    "lines of tests/ without survey": partial(Package.lines_in, folder="tests", without="survey"),
    "lines of tests/survey": partial(Package.lines_in, folder="tests/survey"),
    "lines of scripts/": partial(Package.lines_in, folder="scripts"),
    "functions of tests": Package.functions_of_tests,
}
"""The numbers, each as the places behind it or alone."""


def number_of(places: Places) -> float:
    """The number of places, or the number itself."""
    return len(places) if isinstance(places, list) else places


def entered(checkout: Path, whole: bool = False) -> dict[str, float]:
    """Files of the package that warm calls enter, their depth and more, in the environment of a checkout.

    The whole has the commands that read a result, too.
    """
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, "case.toml").write_text((checkout / "fastpin/casefile/example.toml").read_text("utf-8"), "utf-8")
        command = [_python(checkout), "-c", CALLS.replace("WHOLE", str(whole)).replace("WINGS", str(WINGS))]
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=True)
    counted: dict[str, float] = json.loads(done.stdout.splitlines()[-1])
    return counted


def _python(checkout: Path) -> str:
    return sys.executable if checkout == HERE else str(checkout / ".venv/bin/python")


def tests_of(checkout: Path) -> int:
    """The number of all tests, each with its parameters."""
    command = [_python(checkout), "-m", "pytest", "--collect-only", "-q", "-m", "", "-p", "no:cacheprovider"]
    done = subprocess.run(command, cwd=checkout, capture_output=True, text=True, check=True)
    return int(re.findall(r"^(\d+)(?:/\d+)? tests", done.stdout, re.MULTILINE)[-1])


def main() -> None:
    """Run the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("checkout", nargs="?", type=Path, default=HERE)
    parser.add_argument("--calls", action="store_true", help="solve and run a case and count the tests, too")
    parser.add_argument("--list", choices=NUMBERS, metavar="NAME", help=f"print the places: {', '.join(NUMBERS)}")
    options = parser.parse_args()
    package = Package(options.checkout.resolve())
    if options.list:
        found = NUMBERS[options.list](package)
        print(*(found if isinstance(found, list) else [found]), sep="\n")
        return
    numbers = {name: number_of(places(package)) for name, places in NUMBERS.items()}
    if options.calls:
        numbers |= entered(package.checkout, whole=True) | {"tests": tests_of(package.checkout)}
    for name, number in numbers.items():
        print(f"{number:7,}  {name}")


if __name__ == "__main__":
    main()
