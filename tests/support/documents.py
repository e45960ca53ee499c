"""Pages of docs/ that are run from top to bottom, as a reader would run them.

A block below a sentence that ends with a file's name, such as ``Write this text into `joint.toml`:``, is written to
that file. Lines of a ``console`` block that begin with ``fastpin`` are run, and ``python`` blocks too, all in one
namespace. A ``text`` block right below a ``python`` block is its output. Elsewhere each line of a ``text`` block is a
line that a command of the page has printed before.
"""

import contextlib
import io
import re
import shlex
from collections.abc import Callable, Iterator
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple

from fastpin.cli.main import main
from fastpin.cli.options import join_words, parser

DOCS = Path(__file__).resolve().parents[2] / "docs"


class Block(NamedTuple):
    """A fenced block of a page: its language, its text, and the file that the line above names."""

    kind: str
    text: str
    file: str | None


def blocks(page: str | Path) -> Iterator[Block]:
    """Yield the fenced blocks of a page of docs/, such as "tutorial.md"."""
    pattern = r"(?:`([\w.-]+)`:\n\n)?^```(\w+)\n(.*?)^```$"
    for found in re.finditer(pattern, page_text(page), re.DOTALL | re.MULTILINE):
        yield Block(found[2], found[3], found[1])


def page_text(page: str | Path) -> str:
    """The text of a page of docs/, or of the page at an absolute path."""
    return (DOCS / page).read_text(encoding="utf-8")


def statements() -> list[list[str]]:
    """The cells of the table of the paper's statements, in docs/paper.md."""
    table = page_text("paper.md").partition("## Statements")[2].partition("## Figures")[0]
    return [row.replace("\\|", "").split("|")[1:-1] for row in re.findall(r"^\| \d+ \|.*$", table, re.MULTILINE)]


def texts(page: str | Path, *kinds: str) -> list[str]:
    """The texts of the blocks of a page in some languages."""
    return [block.text for block in blocks(page) if block.kind in kinds]


def printing(page: str) -> list[tuple[str, str]]:
    """The Python blocks of a page, each with the text block right below it, or with ""."""
    found = [*blocks(page), Block("", "", None)]
    return [(one.text, below.text * (below.kind == "text")) for one, below in pairwise(found) if one.kind == "python"]


def run_python(page: str) -> dict[str, Any]:
    """Run the Python blocks of a page alone; each prints the text block right below it. Return their names."""
    names: dict[str, Any] = {"__name__": "__main__"}
    for code, text in printing(page):
        assert printed_by(code, page, names) == text
    return names


def printed_by(code: str, page: str, names: dict[str, Any]) -> str:
    """Run a Python block of a page with these names, and return its output."""
    with contextlib.redirect_stdout(io.StringIO()) as stream:
        exec(compile(code, page, "exec"), names)
    return stream.getvalue()


def run_page(page: str, changed: Callable[[str], str] = str) -> dict[str, Any]:
    """Run the blocks of a page in the working directory, and compare the output with the blocks that show it.

    `changed` gets each command line and returns the one to run, or "" for a command that is only parsed.

    Returns
    -------
    dict
        The names that the Python blocks of the page have defined.
    """
    names: dict[str, Any] = {}
    printed = output = ""
    before = ""
    for block in blocks(page):
        if block.file is not None:
            Path(block.file).write_text(block.text, encoding="utf-8")
        elif block.kind == "text" and before == "python":
            assert block.text == output
        elif block.kind == "text":
            assert_shown(block.text, printed)
        elif block.kind == "python":
            output = printed_by(block.text, page, names)
        elif block.kind == "console":
            for command in re.findall(r"^fastpin ([^#\n]*)", block.text, re.MULTILINE):
                parser().parse_args(join_words(shlex.split(command.partition(" > ")[0])))
                printed += run_command(changed(command))
        before = block.kind
    return names


def run_command(command: str) -> str:
    """Run a command line without its first word; return its output, which ``> FILE`` sends to a file."""
    line, _, file = command.partition(" > ")
    with contextlib.redirect_stdout(io.StringIO()) as stream:
        assert not line or main(shlex.split(line)) == 0, command
    if file:
        Path(file.strip()).write_text(stream.getvalue(), encoding="utf-8")
    return stream.getvalue()


def assert_shown(text: str, output: str) -> None:
    """Each line of the text is a line of the output. "..." at the end of a line stands for more of the line."""
    lines = [plain(line) for line in output.splitlines()]
    for line in filter(str.strip, text.splitlines()):
        words = plain(line)
        is_part = words.endswith(" ...")
        start = words.removesuffix(" ...")
        assert any(other.startswith(start) if is_part else other == words for other in lines), line


def plain(line: str) -> str:
    """A line with single spaces, and without the signs of angles: rounding chooses the side of a symmetric joint."""
    return re.sub(r"-(\d[\d.]* deg)", r"\1", " ".join(line.split()))
