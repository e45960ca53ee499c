"""Count what a change of the package costs: in how many files a noun stands, and how deep one call goes.

``python -m scripts.rooms [FOLDER]`` prints the numbers of a checkout, of this one unless FOLDER names another one. With
``--calls`` it also solves and runs a case in the environment of that checkout, and counts the files that are entered.
``--list NAME`` prints the places behind a number. tests/project/test_rooms.py holds the numbers down.
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
from collections import defaultdict
from collections.abc import Callable, Iterator
from functools import cached_property, partial
from pathlib import Path
from typing import TypeVar

HERE = Path(__file__).resolve().parents[1]

NOUNS = ("gauge_radius", "slip_sums", "Ring")
"""Nouns of one field, one option and one body. The files that name them are counted."""

BODIES = {"Disk", "Tube", "Plate", "Ring", "Bushing", "Compliance", "PinBody", "PlateBody"}
"""Classes of bodies."""

FEW_LINES = 5
"""A private function that is used once has more lines than this, or it could stand in its caller."""

NO_CODE = {tokenize.COMMENT, tokenize.NL, token.NEWLINE, token.INDENT, token.DEDENT, token.ENDMARKER}
"""Kinds of tokens that make no line of code."""

CALLS = """
import json, os, sys
import fastpin
from fastpin.cli.main import main

package = os.path.dirname(fastpin.__file__) + os.sep
entered, depth, deepest = set(), 0, 0

def trace(frame, event, _):
    global depth, deepest
    if frame.f_code.co_filename.startswith(package):
        if event == "call":
            entered.add(frame.f_code.co_filename)
            depth += 1
            deepest = max(deepest, depth)
        elif event == "return":
            depth -= 1

def count(call):
    global depth, deepest
    for measured in (False, True):
        entered.clear()
        depth = deepest = 0
        sys.setprofile(trace if measured else None)
        call()
        sys.setprofile(None)
    return len(entered), deepest

case = fastpin.read_case("case.toml")
found = {"solve": count(lambda: fastpin.solve(case.problem, case.history, nodes=101))}
sys.argv[1:] = []
sys.stdout = open(os.devnull, "w")
found["run"] = count(lambda: main(["run", "case.toml", "--nodes", "101"]))
sys.stdout = sys.__stdout__
print(json.dumps(found))
"""


Node = TypeVar("Node", bound=ast.AST)


class Package:
    """The Python files of the package in a checkout, and what can be counted in them."""

    def __init__(self, checkout: Path) -> None:
        folder = checkout / "fastpin"
        self.texts = {path.relative_to(folder).as_posix(): path.read_text("utf-8") for path in folder.rglob("*.py")}

    @cached_property
    def trees(self) -> dict[str, ast.Module]:
        return {name: ast.parse(text) for name, text in sorted(self.texts.items())}

    def files_naming(self, noun: str) -> list[str]:
        """The files in which a word stands."""
        return [name for name, text in sorted(self.texts.items()) if re.search(rf"\b{noun}\b", text)]

    def body_kinds(self) -> list[str]:
        """Places outside ``bodies/`` that ask by ``isinstance`` for the kind of a body."""
        return [
            f"{name}:{node.lineno}"
            for name, node in self._nodes(ast.Call)
            if isinstance(node.func, ast.Name)
            and node.func.id == "isinstance"
            and not name.startswith("bodies/")
            and BODIES & {each.id for each in ast.walk(node.args[1]) if isinstance(each, ast.Name)}
        ]

    def drives(self) -> list[str]:
        """Places that ask whether a drive is None."""
        return [
            f"{name}:{node.lineno}"
            for name, node in self._nodes(ast.Compare)
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

    def small_private_functions(self) -> list[str]:
        """Private functions and methods of few lines that one place uses."""
        found = []
        for name, tree in self.trees.items():
            for node in ast.walk(tree):
                if not isinstance(node, ast.FunctionDef) or not re.match(r"_[a-z]", node.name) or node.decorator_list:
                    continue
                uses = len(re.findall(rf"\b{node.name}\b", self.texts[name])) - 1
                body = self._code[name] & set(range(node.lineno, (node.end_lineno or 0) + 1))
                if uses == 1 and len(body) <= FEW_LINES:
                    found.append(f"{name}:{node.lineno} {node.name}")
        return found

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
        found = []
        for name, tree in self.trees.items():
            folder = name.partition("/")[0] if "/" in name else ""
            for node in ast.walk(tree):
                if isinstance(node, ast.ImportFrom) and node.module == "fastpin":
                    if folder in {alias.name for alias in node.names}:
                        found.append(f"{name}:{node.lineno}")
                elif isinstance(node, ast.Call) and re.fullmatch(
                    r"importlib.import_module\('fastpin[^()]*\)", ast.unparse(node)
                ):
                    found.append(f"{name}:{node.lineno}")
        return found

    def lines_of_code(self) -> list[str]:
        """Lines without docstrings, comments and blank lines."""
        return [f"{name}:{line}" for name in self.trees for line in sorted(self._code[name])]

    @cached_property
    def _code(self) -> dict[str, set[int]]:
        """The numbers of the lines of code of each file."""
        return {name: self._code_of(name) for name in self.trees}

    def _code_of(self, name: str) -> set[int]:
        found: set[int] = set()
        for each in tokenize.generate_tokens(io.StringIO(self.texts[name]).readline):
            if each.type not in NO_CODE:
                found.update(range(each.start[0], each.end[0] + 1))
        for node in ast.walk(self.trees[name]):
            value = node.value if isinstance(node, ast.Expr) else None
            if isinstance(value, ast.Constant) and isinstance(value.value, str):
                found.difference_update(range(value.lineno, (value.end_lineno or 0) + 1))
        return found

    def _nodes(self, kind: type[Node]) -> Iterator[tuple[str, Node]]:
        for name, tree in self.trees.items():
            for node in ast.walk(tree):
                if isinstance(node, kind):
                    yield name, node


NUMBERS: dict[str, Callable[[Package], list[str]]] = {
    **{f"files naming {noun}": partial(Package.files_naming, noun=noun) for noun in NOUNS},
    "isinstance of bodies outside bodies/": Package.body_kinds,
    "drive is None, or not": Package.drives,
    "classes defined twice": Package.twice_defined,
    "small private functions used once": Package.small_private_functions,
    "constants of modules": Package.constants,
    "hidden imports": Package.hidden_imports,
    "lines of code": Package.lines_of_code,
}
"""The numbers, and the places behind them."""


def entered(checkout: Path) -> dict[str, int]:
    """Files of the package that warm calls enter, and the depth of its own frames, in the environment of a checkout."""
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, "case.toml").write_text((checkout / "fastpin/casefile/example.toml").read_text("utf-8"), "utf-8")
        python = sys.executable if checkout == HERE else str(checkout / ".venv/bin/python")
        command = [python, "-c", CALLS]
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=True)
    counted = json.loads(done.stdout.splitlines()[-1])
    names = {"solve": "a warm solve", "run": "a warm fastpin run"}
    return {
        f"{kind} of {names[call]}": number
        for call, numbers in counted.items()
        for kind, number in zip(("files", "depth"), numbers, strict=True)
    }


def main() -> None:
    """Run the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("checkout", nargs="?", type=Path, default=HERE)
    parser.add_argument("--calls", action="store_true", help="solve and run a case, too")
    parser.add_argument("--list", choices=NUMBERS, metavar="NAME", help=f"print the places: {', '.join(NUMBERS)}")
    options = parser.parse_args()
    package = Package(options.checkout.resolve())
    if options.list:
        print(*NUMBERS[options.list](package), sep="\n")
        return
    found = {name: len(places(package)) for name, places in NUMBERS.items()}
    if options.calls:
        found |= entered(options.checkout.resolve())
    for name, number in found.items():
        print(f"{number:7,}  {name}")


if __name__ == "__main__":
    main()
