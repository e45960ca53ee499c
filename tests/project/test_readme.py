"""The README says what is true: its example runs, its commands exist, its map is complete."""

from __future__ import annotations

import re
import shlex
import tomllib
from pathlib import Path

import pytest

from fastpin.cli.main import _parser

ROOT = Path(__file__).resolve().parents[2]
README = (ROOT / "README.md").read_text(encoding="utf-8")


def test_example_runs(capsys: pytest.CaptureFixture[str]) -> None:
    (code,) = re.findall(r"```python\n(.*?)```", README, re.DOTALL)
    exec(compile(code, "README.md", "exec"), {})
    assert len(capsys.readouterr().out.splitlines()) == 3


def test_commands_exist() -> None:
    commands = re.findall(r"^fastpin ([^#>\n]*)", README, re.MULTILINE)
    assert len(commands) > 3
    for command in commands:
        _parser().parse_args(shlex.split(command))


def test_map_names_every_module_and_no_other() -> None:
    modules = {path.name for path in (ROOT / "fastpin").glob("[a-z]*.py")}
    table = README[README.index("## Map of the package") : README.index("## Dependencies")]
    rows = "\n".join(line.split("|")[1] for line in table.splitlines() if line.startswith("| `"))
    assert set(re.findall(r"`(\w+\.py)`", rows)) == modules


def test_every_dependency_has_its_reason() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    table = README[README.index("## Dependencies") : README.index("## Development")]
    for requirement in [*project["dependencies"], *project["optional-dependencies"]["dev"]]:
        assert re.match(r"[\w-]+", requirement)[0] in table  # type: ignore[index]


def test_linked_files_exist() -> None:
    for target in re.findall(r"\]\(([^):]+)\)", README):
        assert (ROOT / target).exists(), target
