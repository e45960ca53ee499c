"""Small changes of source text for :mod:`scripts.mutants`: one comparison, sign, number, flag or statement."""

from __future__ import annotations

import ast
import random
import re
from collections.abc import Iterator
from dataclasses import dataclass

COMPARISONS: dict[type[ast.cmpop], tuple[str, tuple[str, ...]]] = {
    ast.Lt: ("<", ("<=", ">")),
    ast.LtE: ("<=", ("<", ">")),
    ast.Gt: (">", (">=", "<")),
    ast.GtE: (">=", (">", "<")),
    ast.Eq: ("==", ("!=",)),
    ast.NotEq: ("!=", ("==",)),
    ast.Is: ("is", ("is not",)),
    ast.IsNot: ("is not", ("is",)),
    ast.In: ("in", ("not in",)),
    ast.NotIn: ("not in", ("in",)),
}
"""Text of each comparison, and what replaces it."""

ARITHMETIC: dict[type[ast.operator], tuple[str, str]] = {
    ast.Add: ("+", "-"),
    ast.Sub: ("-", "+"),
    ast.Mult: ("*", "/"),
    ast.Div: ("/", "*"),
}
"""Text of each operator, and what replaces it."""


@dataclass(frozen=True)
class Change:
    """One change of a file.

    Attributes
    ----------
    file : str
        Relative to the project's directory.
    line : int
        The line where the change begins, from 1.
    start, stop : int
        The bytes of the file that are replaced.
    text : str
        What replaces them.
    before, after : str
        The line without its margin, before and after the change.
    """

    file: str
    line: int
    start: int
    stop: int
    text: str
    before: str
    after: str

    def applied(self, source: bytes) -> bytes:
        """Return the changed file."""
        return source[: self.start] + self.text.encode() + source[self.stop :]


class _Finder(ast.NodeVisitor):
    """Collects the changes of a file as (first byte, last byte, text)."""

    def __init__(self, source: bytes, rng: random.Random) -> None:
        self.source, self.rng = source, rng
        self.starts = [0, *(found.end() for found in re.finditer(rb"\n", source))]
        self.found: list[tuple[int, int, str]] = []

    def begin(self, node: ast.AST) -> int:
        return self.starts[node.lineno - 1] + node.col_offset  # type: ignore[attr-defined]

    def end(self, node: ast.AST) -> int:
        return self.starts[node.end_lineno - 1] + node.end_col_offset  # type: ignore[attr-defined]

    def add(self, start: int, stop: int, text: str) -> None:
        self.found.append((start, stop, text))

    def between(self, left: ast.AST, right: ast.AST, word: str, text: str) -> None:
        """Replace the operator between two expressions. Only brackets, spaces and comments stand beside it."""
        start = self.end(left)
        gap = re.sub(rb"#[^\n]*", lambda found: b" " * len(found[0]), self.source[start : self.begin(right)])
        place = re.search(rb"\s+".join(map(re.escape, word.encode().split())), gap)
        assert place, (word, gap)
        self.add(start + place.start(), start + place.end(), text)

    # -- unchanged parts: annotations, decorators, documentation, texts of messages, names for type checkers

    def visit_FunctionDef(self, node: ast.FunctionDef) -> None:
        for default in (*node.args.defaults, *filter(None, node.args.kw_defaults)):
            self.visit(default)
        for number, statement in enumerate(node.body):
            self.visit(statement)
            # The last statement of a function returns what the function is for: dropping it is seen at once.
            if number < len(node.body) - 1:
                self.drop(statement)

    def visit_ClassDef(self, node: ast.ClassDef) -> None:
        for statement in node.body:
            self.visit(statement)

    def visit_AnnAssign(self, node: ast.AnnAssign) -> None:
        if node.value is not None:
            self.visit(node.value)

    def visit_JoinedStr(self, node: ast.JoinedStr) -> None:
        """Leave messages alone."""

    def visit_Raise(self, node: ast.Raise) -> None:
        """Leave messages alone. The statement itself can be dropped."""

    def visit_Expr(self, node: ast.Expr) -> None:
        if not isinstance(node.value, ast.Constant) and not ast.unparse(node).startswith(("logger.", "warnings.")):
            self.generic_visit(node)

    def visit_If(self, node: ast.If) -> None:
        if ast.unparse(node.test) != "TYPE_CHECKING":
            self.generic_visit(node)
            self.drop_from(node.body, node.orelse)

    def visit_For(self, node: ast.For) -> None:
        self.generic_visit(node)
        self.drop_from(node.body, node.orelse)

    def visit_While(self, node: ast.While) -> None:
        self.generic_visit(node)
        self.drop_from(node.body, node.orelse)

    def visit_With(self, node: ast.With) -> None:
        self.generic_visit(node)
        self.drop_from(node.body)

    def visit_Try(self, node: ast.Try) -> None:
        self.generic_visit(node)
        self.drop_from(node.body, node.orelse, node.finalbody, *(handler.body for handler in node.handlers))

    # -- changes

    def drop_from(self, *bodies: list[ast.stmt]) -> None:
        for body in bodies:
            for statement in body:
                self.drop(statement)

    def drop(self, node: ast.stmt) -> None:
        """Drop a statement that stores no new name: without a name the code could not even run."""
        if isinstance(node, ast.Assign):
            dropped = all(isinstance(target, ast.Attribute | ast.Subscript) for target in node.targets)
        elif isinstance(node, ast.Expr):
            dropped = isinstance(node.value, ast.Call) and not ast.unparse(node).startswith(("logger.", "warnings."))
        else:
            dropped = isinstance(node, ast.Return | ast.Raise | ast.Continue | ast.Break | ast.AugAssign)
        if dropped:
            self.add(self.begin(node), self.end(node), "pass")

    def visit_Compare(self, node: ast.Compare) -> None:
        self.generic_visit(node)
        for left, operator, right in zip([node.left, *node.comparators], node.ops, node.comparators, strict=False):
            word, others = COMPARISONS[type(operator)]
            self.between(left, right, word, self.rng.choice(others))

    def visit_BinOp(self, node: ast.BinOp) -> None:
        self.generic_visit(node)
        if type(node.op) in ARITHMETIC and not _is_text(node.left) and not _is_text(node.right):
            self.between(node.left, node.right, *ARITHMETIC[type(node.op)])

    def visit_AugAssign(self, node: ast.AugAssign) -> None:
        self.generic_visit(node)
        if type(node.op) in ARITHMETIC:
            word, text = ARITHMETIC[type(node.op)]
            self.between(node.target, node.value, f"{word}=", f"{text}=")

    def visit_UnaryOp(self, node: ast.UnaryOp) -> None:
        self.generic_visit(node)
        if isinstance(node.op, ast.USub | ast.Not):
            start, stop = self.begin(node), self.begin(node.operand)
            self.add(start, stop, "(" * self.source.count(b"(", start, stop))

    def visit_BoolOp(self, node: ast.BoolOp) -> None:
        self.generic_visit(node)
        word, text = ("and", "or") if isinstance(node.op, ast.And) else ("or", "and")
        pair = self.rng.randrange(len(node.values) - 1)
        self.between(node.values[pair], node.values[pair + 1], word, text)

    def visit_Constant(self, node: ast.Constant) -> None:
        value = node.value
        if isinstance(value, bool):
            self.add(self.begin(node), self.end(node), str(not value))
        elif isinstance(value, int):
            other = self.rng.choice((value + 1, max(value - 1, 0) or value + 2))
            self.add(self.begin(node), self.end(node), str(other))
        elif isinstance(value, float):
            self.add(self.begin(node), self.end(node), repr(2.0 * value if value else 1.0))


def _is_text(node: ast.AST) -> bool:
    return isinstance(node, ast.JoinedStr) or (isinstance(node, ast.Constant) and isinstance(node.value, str | bytes))


def changes(file: str, source: bytes, rng: random.Random) -> Iterator[Change]:
    """All places of a file where one thing can be changed, with one change each."""
    finder = _Finder(source, rng)
    finder.visit(ast.parse(source))
    for start, stop, text in finder.found:
        line = source.count(b"\n", 0, start) + 1
        changed = source[:start] + text.encode() + source[stop:]
        lines = [whole.split(b"\n")[line - 1].decode().strip() for whole in (source, changed)]
        yield Change(file, line, start, stop, text, *lines)
