"""Texts of anybody on the terminal: titles, names of materials, names of files."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from fastpin.cli.main import main
from fastpin.errors import printable
from tests.support.case_texts import PRESSED

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


def test_texts_become_escapes_where_the_terminal_has_ascii_only(tmp_path: Path) -> None:
    case = tmp_path / "case.toml"
    case.write_text(f'title = "Größe €"{CASE}', encoding="utf-8")
    environment = {**os.environ, "PYTHONIOENCODING": "ascii", "FASTPIN_HYPOTHESIS": ""}

    def output(*arguments: str) -> tuple[int, str, str]:
        command = [sys.executable, "-m", "fastpin", *arguments]
        done = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, timeout=120, check=False)
        return done.returncode, done.stdout.decode("ascii"), done.stderr.decode("ascii")

    code, shown, trouble = output("run", "case.toml")
    assert (code, trouble) == (0, "")
    assert shown.startswith("Gr\\xf6\\xdfe \\u20ac\n")
    code, shown, trouble = output("run", "case.toml", "--json", "-")
    assert (code, json.loads(shown)["title"]) == (0, "Größe €")
    assert output("check", "case.toml")[0] == 0
    code, shown, trouble = output("check", "Größe.toml")
    assert (code, "Gr\\xf6\\xdfe.toml" in trouble) == (2, True)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a case, a result and a damaged result, all with hostile names."""
    place = tmp_path_factory.mktemp("hostile")
    (place / f"{HOSTILE}.toml").write_text(CASE, encoding="utf-8")
    (place / f"{HOSTILE}-bad.toml").write_text("[contact]\nfriction = 7\n", encoding="utf-8")
    (place / f"{HOSTILE}-plan.toml").write_text('[grid]\n"contact.friction" = [0.1]\n', encoding="utf-8")
    (place / f"{HOSTILE}-bad.h5").write_text("no result", encoding="utf-8")
    assert main(["run", str(place / f"{HOSTILE}.toml"), "-o", str(place / f"{HOSTILE}.h5"), "--nodes", "41"]) == 0
    return place


COMMANDS = [
    "run HOSTILE.toml --json HOSTILE.json --plot HOSTILE.svg --cycle-csv HOSTILE.csv --record HOSTILE.html",
    "run HOSTILE.toml --json HOSTILE.toml",
    "run HOSTILE-bad.toml",
    "check HOSTILE.toml",
    "check HOSTILE-bad.toml",
    "check HOSTILE-plan.toml",
    "check HOSTILE-none.toml",
    "show HOSTILE.h5",
    "show HOSTILE-bad.h5",
    "resume HOSTILE.h5",
    "run HOSTILE.toml -o HOSTILE.h5",
    "run HOSTILE.toml -o HOSTILE-2.h5 --start HOSTILE.h5 -v",
    "plot HOSTILE.h5 hoop -o HOSTILE.svg --csv HOSTILE-hoop.csv",
    "plot HOSTILE.h5 hoop -o HOSTILE",
    "report HOSTILE.h5 -o HOSTILE.html --case HOSTILE.toml",
    "report HOSTILE.toml -o HOSTILE-case.html",
    "sweep HOSTILE-plan.toml -o HOSTILE-sweep --workers 1 --table HOSTILE-table.csv --plot HOSTILE-sweep.svg",
    "sweep HOSTILE-plan.toml -o HOSTILE-sweep --status",
    "report HOSTILE-sweep -o HOSTILE-sweep.html",
    "merge HOSTILE-sweep -o HOSTILE-whole",
    "show HOSTILE.h5 HOSTILE",
    "compliance HOSTILE-plan.toml",
]


@pytest.mark.parametrize("command", COMMANDS)
def test_names_of_files_never_steer_the_terminal(
    folder: Path, command: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(folder)
    try:
        code = main([word.replace("HOSTILE", HOSTILE) for word in command.split()])
    except SystemExit as end:
        code = int(end.code or 0)
    out, err = capsys.readouterr()
    assert code in (0, 1, 2)
    assert out or err
    assert is_shown(out)
    assert is_shown(err)
    assert "Traceback" not in err
    assert not any(
        line.startswith("b") for line in (out + err).split("\n")
    )  # the line end in a name does not end a line


@pytest.mark.parametrize("command", ["check", "show", "sweep"])
def test_names_of_files_that_are_no_text_are_shown(
    command: str, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    name = os.fsdecode(os.fsencode(tmp_path) + b"/caf\xe9.toml")
    Path(name).write_text(CASE, encoding="utf-8")
    code = main([command, name])
    out, err = capsys.readouterr()
    assert code == (0 if command == "check" else 2), err
    assert is_shown(out + err)
    assert command == "check" or "caf\\udce9.toml" in err
