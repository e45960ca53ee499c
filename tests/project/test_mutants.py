"""The changes of scripts/mutants.py: one thing at a time, in code that still can be read."""

import ast
import random

import pytest

from scripts.changes import changes


def changed(source: str) -> set[str]:
    """All changes of a file, with several choices of the changes."""
    found = set()
    for seed in range(20):
        for change in changes("file.py", source.encode(), random.Random(seed)):
            text = change.applied(source.encode()).decode()
            ast.parse(text)
            assert change.before in source
            assert change.after in text
            found.add(text)
    return found


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ("(x) < y", {"(x) <= y", "(x) > y"}),
        ("x is not y", {"x is y"}),
        ("x in y", {"x not in y"}),
        ("x - (y)", {"x + (y)"}),
        ("x * y", {"x / y"}),
        ("-(x)", {"(x)"}),
        ("not x", {"x"}),
        ("x and y", {"x or y"}),
        ("7", {"6", "8"}),
        ("0", {"1", "2"}),
        ("0.25", {"0.5"}),
        ("True", {"False"}),
        ("'text' + x", set()),
        ("f'{1 + x}'", set()),
    ],
)
def test_expressions(before: str, after: set[str]) -> None:
    assert changed(f"a = {before}\n") == {f"a = {text}\n" for text in after}


def test_statements_are_dropped_where_no_name_gets_lost() -> None:
    source = "def f(x):\n    {}\n    {}\n    return x\n"
    first, second = "if x: return y", "x.y = z"
    assert changed(source.format(first, second)) == {source.format("if x: pass", second), source.format(first, "pass")}


def test_annotations_decorators_and_documentation_are_left_alone() -> None:
    assert not changed('@d(1)\ndef f(x: "a - b") -> 1 + 1:\n    """Text."""\n    raise E("text", 1)\n')
