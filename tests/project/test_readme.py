"""README and CONTRIBUTING say what is true: the example runs, the map is complete."""

import re
import tomllib
from pathlib import Path

from tests.support.documents import page_text, printed_by, texts
from tests.support.layout import ABOVE_BODIES, LEVELS, RANKS

ROOT = Path(__file__).resolve().parents[2]
CONTRIBUTING = page_text(ROOT / "CONTRIBUTING.md")


def test_example_runs() -> None:
    (code,) = texts(ROOT / "README.md", "python")
    assert len(printed_by(code, "README.md", {}).splitlines()) == 3


def test_map_names_every_folder_with_its_rank_and_no_other() -> None:
    folders = {path.parent.name for path in (ROOT / "fastpin").glob("*/__init__.py")}
    rows = re.findall(r"^\| (\d+) \| `(\w+)/` \|", CONTRIBUTING, re.MULTILINE)
    assert sorted(folder for _, folder in rows) == sorted(folders)
    assert {folder: int(rank) for rank, folder in rows} == RANKS
    assert f"| {LEVELS.index(ABOVE_BODIES)} | upper floor of `model/` |" in CONTRIBUTING
    upper = re.search(r"stands on the upper floor: (.*?)\.\s+The lower floor", CONTRIBUTING, re.DOTALL)
    assert {f"model/{name}" for name in re.findall(r"`(\w+\.py)`", upper[1])} == {*ABOVE_BODIES} - {"model/__init__.py"}


def test_files_and_folders_named_in_contributing_exist() -> None:
    places = (ROOT, ROOT / "fastpin", ROOT / "tests")
    names = set(re.findall(r"`(\w+/(?:[\w/]+\.py)?)`", CONTRIBUTING))
    assert len(names) > 20
    for name in names:
        assert any((place / name).exists() for place in places), name


def test_names_stand_in_the_files_that_contributing_names() -> None:
    named = re.findall(r"`(?:\w+\.)?(\w+)`\s+(?:of|in)\s+`([\w/]+\.py)`", CONTRIBUTING)
    assert len(named) > 40
    places = (ROOT, ROOT / "fastpin", ROOT / "tests")
    for name, file in named:
        (text,) = (path.read_text("utf-8") for place in places if (path := place / file).exists())
        assert re.search(rf"^\s*(?:(?:def|class) )?{name}\b", text, re.MULTILINE), f"{name} of {file}"


def test_every_dependency_has_its_reason() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    (table,) = re.findall(r"^## Dependencies\n(.*?)^## ", CONTRIBUTING, re.DOTALL | re.MULTILINE)
    extras = project["optional-dependencies"]
    for requirement in [*project["dependencies"], *extras["dev"], *extras["docs"]]:
        assert re.match(r"[\w-]+", requirement)[0] in table  # type: ignore[index]
