"""Every output option of every command, against every kind of file that it must not replace."""

import argparse
import fcntl
import os
import shutil
from collections.abc import Callable, Iterator
from contextlib import contextmanager, nullcontext
from pathlib import Path

import pytest

import fastpin
from fastpin.casefile import EXAMPLE, LUG_EXAMPLE
from fastpin.cli.options import parser
from fastpin.joints import JOINT_EXAMPLE
from fastpin.storage.files import INDEX
from fastpin.studies import read_plan
from fastpin.studies.index import Index
from tests.support.commands import refusal, refused, said
from tests.support.files import contents

CASE = EXAMPLE.split("[[load]]")[0] + "\n[[load]]\nP = 2e6\n[[load]]\nrepeat = 2\nQ = [1e5, -1e5]\n"

COMMANDS = {
    "run": ["run", "case.toml"],
    "resume": ["resume", "r.h5"],
    "show": ["show", "r.h5"],
    "plot": ["plot", "r.h5", "tractions"],
    "crack": ["crack", "r.h5", "--first", "1e-4", "--last", "1e-3", "--C", "1e-10", "--m", "3", "--at", "80"],
    "report": ["report", "r.h5"],
    "converge": ["converge", "case.toml"],
    "sweep": ["sweep", "plan.toml"],
    "tolerances": ["tolerances", "tolerances.toml"],
    "identify": ["identify", "case.toml", "rig.csv", "--over", "ux"],
    "compliance": ["compliance", "lug.toml"],
    "joint": ["joint", "joint.toml"],
    "benchmarks": ["benchmarks", "brazilian-disk"],
    "charts": ["charts", "kt_bearing"],
    "verify": ["verify"],
    "wear": ["wear", "case.toml", "--cycles", "2", "--coefficient", "1e-13"],
    "paper": ["paper", "--figure", "3"],
}
"""Each command with its input."""

STATES = {"--json": ".json", "--plot": ".png", "--cycles": ".svg", "--record": ".html", "--cycle-csv": ".csv"}

TEXTS: dict[str, dict[str, str]] = {
    "run": STATES,
    "resume": STATES,
    "show": {**STATES, "--shares": ".svg"},
    "plot": {"--output": ".png", "--csv": ".csv"},
    "crack": {"--output": ".png", "--csv": ".csv", "--json": ".json"},
    "report": {"--output": ".html"},
    "converge": {"--csv": ".csv", "--json": ".json", "--plot": ".pdf"},
    "sweep": {"--table": ".csv", "--plot": ".png"},
    "tolerances": {"--table": ".csv", "--plot": ".png", "--scatter": ".svg", "--json": ".json"},
    "identify": {"--csv": ".csv", "--json": ".json", "--plot": ".png"},
    "compliance": {"--output": ".json", "--plot": ".png"},
    "joint": {"--json": ".json", "--plot": ".png", "--shares": ".svg", "--record": ".html"},
    "benchmarks": {"--json": ".json"},
    "charts": {"--json": ".json", "--csv": ".csv"},
    "verify": {"--json": ".json"},
    "wear": {"--json": ".json", "--record": ".html"},
}
"""The options of texts and figures, with the ending of their files."""

ENDINGS = [(name, option, ending) for name, found in TEXTS.items() for option, ending in found.items()]
ENDINGS.append(("report", "--output", ".pdf"))
"""Commands, their options and the endings of their files."""

RESULTS = {name: {"--output"} for name in ("run", "wear", "joint")}
DIRECTORIES = {name: {"--output"} for name in ("sweep", "tolerances", "merge", "paper", "benchmarks")}
INPUTS = {
    "run": {"--start"},
    "converge": {"--outcomes"},
    "sweep": {"--outcomes"},
    "tolerances": {"--outcomes"},
    "report": {"--case", "--plan"},
    "joint": {"--resume"},
}


@pytest.fixture(scope="module")
def samples(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with an input of each kind, and a result and an index."""
    folder = tmp_path_factory.mktemp("samples")
    (folder / "case.toml").write_text(CASE)
    (folder / "lug.toml").write_text(LUG_EXAMPLE)
    (folder / "joint.toml").write_text(JOINT_EXAMPLE)
    (folder / "rig.csv").write_text("ux,Q\n1e-6,1e5\n2e-6,2e5\n")
    (folder / "plan.toml").write_text('case = "case.toml"\n[grid]\nsolve.nodes = [41]\ncontact.friction = [0.2, 0.3]\n')
    (folder / "tolerances.toml").write_text(
        'case = "case.toml"\nsamples = 2\n[tolerances]\ncontact.friction = { from = 0.2, to = 0.5 }\n'
    )
    case = fastpin.read_case(folder / "case.toml")
    fastpin.record(case.problem, case.history, folder / "r.h5", nodes=41)
    plan = read_plan(folder / "plan.toml")
    with Index(folder, write=True) as index:
        index.expect(plan, plan.points)
    return folder


@pytest.fixture
def folder(samples: Path, tmp_path: Path) -> Path:
    for name in ("case.toml", "rig.csv", "lug.toml", "joint.toml", "plan.toml", "tolerances.toml", "r.h5"):
        shutil.copyfile(samples / name, tmp_path / name)
    return tmp_path


def options_of(command: argparse.ArgumentParser) -> Iterator[str]:
    """The options of a command that take the name of a file or a directory."""
    for action in command._actions:
        if action.metavar in ("FILE", "DIR", "FIGURE", "PAGE") and action.option_strings:
            yield action.option_strings[-1]


def test_every_option_that_names_a_file_is_known_here() -> None:
    commands = next(action.choices for action in parser()._actions if isinstance(action.choices, dict))
    found = {(name, option) for name, command in commands.items() for option in options_of(command)}
    known = {
        (name, option) for table in (TEXTS, RESULTS, DIRECTORIES, INPUTS) for name in table for option in table[name]
    }
    assert found == known


@contextmanager
def locked(path: Path) -> Iterator[None]:
    """A writer's lock on a file, as another process holds it."""
    with path.open("rb") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        yield


KINDS: dict[str, tuple[Callable[[Path, Path, str], object], str]] = {
    "input": (lambda path, samples, command: os.link(COMMANDS[command][1], path), "is an input of this command"),
    "result": (lambda path, samples, command: shutil.copyfile(samples / "r.h5", path), "is a stored result"),
    "link": (lambda path, samples, command: path.symlink_to(samples / "r.h5"), "is a stored result"),
    "index": (lambda path, samples, command: shutil.copyfile(samples / INDEX, path), "is a database"),
    "running": (lambda path, samples, command: path.write_bytes(b""), "another run is writing to it"),
    "directory": (lambda path, samples, command: path.mkdir(), "is a directory, a file name is needed"),
}
"""Ways to make an existing file at a path, and words of its refusal."""


@pytest.mark.gate
@pytest.mark.parametrize(("command", "option", "ending"), ENDINGS)
def test_no_text_or_figure_replaces_another_kind(command, option, ending, folder, samples):
    for kind, (make, words) in KINDS.items():
        if kind == "input" and command in ("benchmarks", "charts", "verify"):
            continue  # they have no input
        path = Path(f"{kind}{ending}")
        make(path, samples, command)
        before, outside = contents(folder), contents(samples)
        with locked(path) if kind == "running" else nullcontext():
            sentence = refusal(*COMMANDS[command], option, path)
        assert str(path) in sentence
        # The page is refused before the result is read.
        assert words in sentence or (command, kind) == ("report", "input"), kind
        assert (contents(folder), contents(samples)) == (before, outside), kind


@pytest.mark.parametrize(
    ("kind", "words"),
    [
        ("input", "won't overwrite"),
        ("text", "is no result, and a result replaces results only"),
        ("index", "is a database"),
        ("running", "another run is writing to it"),
        ("directory", "is a directory"),
        ("link", "is no result, and a result replaces results only"),
    ],
)
@pytest.mark.parametrize("command", RESULTS)
def test_a_result_replaces_results_only(command, kind, words, folder, samples):
    path = Path("case.toml" if kind == "input" else "keep.h5")
    if kind == "text":
        path.write_text("notes")
    elif kind == "link":
        Path("notes.txt").write_text("notes")
        path.symlink_to("notes.txt")
    elif kind != "input":
        KINDS[kind][0](path, samples, command)
    before = contents(folder)
    with locked(path) if kind == "running" else nullcontext():
        assert words in refused(*COMMANDS[command], "--nodes", "41", "-o", path, "--overwrite")
    assert contents(folder) == before


@pytest.mark.parametrize(("command", "name"), [("paper", "figure03.png"), ("benchmarks", "brazilian-disk.csv")])
def test_files_in_a_directory_follow_the_rule(command, name, folder, samples):
    Path("out").mkdir()
    shutil.copyfile(samples / "r.h5", Path("out") / name)
    before = contents(folder)
    assert f"{name}: is a stored result" in refused(*COMMANDS[command], "-o", "out")
    assert contents(folder) == before


def test_files_that_the_case_names_are_inputs(folder: Path) -> None:
    Path("h.csv").write_text("P\n1e6\n2e6\n")
    Path("c.toml").write_text(EXAMPLE.split("[[load]]")[0] + '\n[[load]]\ncsv = "h.csv"\nrepeat = 2\n')
    for option in ("--json", "--cycle-csv"):
        words = refused("run", "c.toml", "--nodes", "41", option, "h.csv")
        assert "h.csv: is an input of this command" in words
    refused("run", "c.toml", "--nodes", "41", "-o", "h.csv", "--overwrite")
    assert Path("h.csv").read_text() == "P\n1e6\n2e6\n"


@pytest.mark.gate
def test_an_input_may_be_written_by_a_later_command(folder: Path) -> None:
    said("show", "r.h5", "--json", "a.json")
    said("show", "r.h5", "--json", "a.json")
    said("run", "case.toml", "--nodes", "41", "-o", "r.h5", "--overwrite")
