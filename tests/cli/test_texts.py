"""Texts of anybody on the terminal: titles, names of materials, names of files."""

import json
import os
from pathlib import Path

import pytest

from fastpin.cli.main import main
from fastpin.errors import printable
from tests.support.case_texts import PRESSED
from tests.support.commands import said
from tests.support.processes import fastpin, finished

CASE = f"""{PRESSED}[[load]]
Q = [1e5, -1e5]
repeat = 2
[solve]
nodes = 41
"""

HOSTILE = "a\x1b[31m\x07\u202e\nb"
"""A file's name with an escape sequence, a mark that turns the direction of writing, and a line end."""


def is_shown(text: str) -> bool:
    """Whether a terminal prints all lines of a text as they are."""
    return all(printable(line) == line for line in text.split("\n"))


@pytest.mark.gate
def test_texts_become_escapes_where_the_terminal_has_ascii_only(tmp_path: Path) -> None:
    case = tmp_path / "case.toml"
    case.write_text(f'title = "Größe €"{CASE}', encoding="utf-8")
    environment = {**os.environ, "PYTHONIOENCODING": "ascii"}

    def output(*arguments: str) -> tuple[int, str, str]:
        done = finished(fastpin(*arguments), cwd=tmp_path, env=environment, encoding="ascii", check=False)
        return done.returncode, done.stdout, done.stderr

    code, shown, trouble = output("run", "case.toml")
    assert (code, trouble) == (0, "")
    assert shown.startswith("Gr\\xf6\\xdfe \\u20ac\n")
    code, shown, trouble = output("run", "case.toml", "--json", "-")
    assert (code, json.loads(shown)["title"]) == (0, "Größe €")
    assert output("check", "case.toml")[0] == 0
    code, shown, trouble = output("check", "Größe.toml")
    assert (code, "Gr\\xf6\\xdfe.toml" in trouble) == (2, True)


COMMANDS = {
    "sweep HOSTILE-plan.toml -o HOSTILE --status": (0, "1 runs in NAME: 0 done"),  # a line of a command
    "show HOSTILE.h5 HOSTILE": (2, "error: unrecognized arguments: NAME"),  # a message of the parser
    "show HOSTILE.h5": (2, "fastpin: NAME.h5: is no HDF5 file"),  # an error
    "check HOSTILE.toml": (2, "\nNAME.toml, line 1: [contact]: hole_radius is missing"),  # one of many faults
}
"""A command for each way of a file's name to the terminal, its exit code, and what it prints."""


@pytest.mark.parametrize("command", COMMANDS)
def test_names_of_files_never_steer_the_terminal(command, capsys):
    Path(f"{HOSTILE}.toml").write_text("[contact]\nfriction = 7\n", encoding="utf-8")
    Path(f"{HOSTILE}-plan.toml").write_text('[grid]\n"contact.friction" = [0.1]\n', encoding="utf-8")
    Path(f"{HOSTILE}.h5").write_text("no result", encoding="utf-8")
    try:
        code = main([word.replace("HOSTILE", HOSTILE) for word in command.split()])
    except SystemExit as end:
        code = int(end.code or 0)
    shown = "".join(capsys.readouterr())
    expected, words = COMMANDS[command]
    assert (code, is_shown(shown)) == (expected, True)
    assert words.replace("NAME", printable(HOSTILE)) in shown


@pytest.mark.parametrize("command", ["check", "sweep"])
def test_names_of_files_that_are_no_text_are_shown(command):
    name = os.fsdecode(b"caf\xe9.toml")
    Path(name).write_text(CASE, encoding="utf-8")
    out, err = said(command, name, code=0 if command == "check" else 2)
    assert is_shown(out + err)
    assert command == "check" or "caf\\udce9.toml" in err
