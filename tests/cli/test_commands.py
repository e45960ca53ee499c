"""The command line: what it prints, its exit codes and its files."""

from __future__ import annotations

import csv
import json
import logging
import os
import re
import runpy
import sys
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import fastpin
from fastpin import figures, solver
from fastpin.casefile.reader import EXAMPLE, builtin_case
from fastpin.cli.main import main
from fastpin.model.loads import LATER
from fastpin.paper import catalog
from fastpin.runtime import jit, machine
from fastpin.solver import solving
from fastpin.solver.errors import NoEquilibriumError
from fastpin.version import __version__
from tests.support.processes import finished, python
from tests.support.samples import sample_result
from tests.support.tiers import some_gate

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture
def solved(monkeypatch: pytest.MonkeyPatch) -> list[dict[str, Any]]:
    """The solver is replaced by a result made by hand; what it was called with is recorded."""
    calls: list[dict[str, Any]] = []

    def solve(
        problem: object, history: object, *, progress: Callable[[float, int], None], start: object, **options: Any
    ) -> object:
        assert start is None
        calls.append(options)
        progress(0.5, 3)
        progress(3.0, 3)
        return sample_result()

    monkeypatch.setattr(solver, "solve", solve)
    return calls


@pytest.fixture
def lost(monkeypatch: pytest.MonkeyPatch) -> NoEquilibriumError:
    """The solver loses the load in the third step."""
    error = NoEquilibriumError("the pin slides away at 40 % of step 4", 3, 0.4, {}, sample_result(complete=False))

    def solve(*_: object, **__: object) -> object:
        raise error

    monkeypatch.setattr(solver, "solve", solve)
    return error


@pytest.fixture
def case(tmp_path: Path) -> Path:
    path = tmp_path / "case.toml"
    path.write_text(EXAMPLE)
    return path


def test_example_prints_a_case_file(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["example"]) == 0
    assert capsys.readouterr().out == EXAMPLE


def test_version_is_that_of_the_package(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as ended:
        main(["--version"])
    assert ended.value.code == 0
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())
    version = runpy.run_path(str(ROOT / "fastpin" / "version.py"))["__version__"]
    assert capsys.readouterr().out == f"fastpin {version}\n"
    assert __version__ == version
    assert "version" in project["project"]["dynamic"]
    assert project["tool"]["hatch"]["version"]["path"] == "fastpin/version.py"


def test_check_says_what_was_understood(case: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["check", str(case)]) == 0
    out = capsys.readouterr().out
    for words in (
        "Ti-6Al-4V, E = 116 GPa, nu = 0.32",
        "alpha = 0.2507, beta = 0.0595",
        "radius 10 mm",
        "401 nodes",
    ):
        assert words in out
    rows = [line.split() for line in out.splitlines()]
    assert rows[-4:] == [
        ["1", "2.42", "0", "0.1"],
        ["2", "2.42", "0.726", "0.09582"],
        ["3", "2.42", "-0.726", "0.09582"],
        ["4", "2.42", "0.726", "0.09582"],
    ]


def test_check_prints_all_faults_and_nothing_else(case: Path, capsys: pytest.CaptureFixture[str]) -> None:
    case.write_text(EXAMPLE.replace("nu = 0.33", "nu = 0.7").replace("nodes = 401", "nodes = 1"))
    assert main(["check", str(case)]) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    lines = captured.err.splitlines()
    assert [line.split(": ")[1] for line in lines] == ["nu", "nodes"]
    assert all(line.startswith(f"{case}, line ") for line in lines)


LIGHT: dict[str, list[list[str]]] = {
    "": [
        ["--help"],
        ["--version"],
        ["run", "--help"],
        ["paper", "--help"],
        ["sweep", "--help"],
        ["merge", "--help"],
        ["verify", "--help"],
        ["verify", "--json", "no/where.json"],
        ["converge", "--help"],
        ["converge", "CASE", "--nodes", "x"],
        ["run", "--colour"],
        ["sweep", "CASE", "--shard", "3/2"],
    ],
    "numpy": [
        ["sweep", "CASE"],
        ["example"],
        ["compliance", "--example"],
        ["compliance", "CASE"],
        ["check", "CASE"],
        ["run", "CASE", "--nodes", "1"],
    ],
}
"""Commands by the heavy packages that they may import."""


@pytest.mark.gate
@pytest.mark.parametrize("needed", some_gate(LIGHT, "numpy"))
def test_heavy_imports_wait_until_they_are_needed(needed: str, case: Path) -> None:
    """The commands run in one process, one after the other. The first that imports more is named."""
    code = (
        "import sys\nfrom fastpin.cli.main import main\n"
        "for command in sys.argv[1:]:\n"
        "    try:\n        main(command.split('|'))\n    except SystemExit:\n        pass\n"
        "    names = ('numpy', 'numba', 'scipy', 'matplotlib', 'h5py', 'tqdm')\n"
        "    print('\\nimported', command.split('|'), *(name for name in names if name in sys.modules))"
    )
    commands = [[str(case) if word == "CASE" else word for word in command] for command in LIGHT[needed]]
    done = finished(python(code, *map("|".join, commands)))
    imported = [line for line in done.stdout.splitlines() if line.startswith("imported ")]
    assert imported == [f"imported {command} {needed}".strip() for command in commands]


HEAVY = (
    "numba", "scipy", "scipy.linalg", "scipy.special", "scipy.fft", "tqdm", "matplotlib", "h5py", "multiprocessing",
    "jinja2", "shtab", "importlib.metadata", "numpy.typing", "numpy.f2py", "numpy.testing", "numpy.random",
)  # fmt: skip
"""Modules that take long to import. Nothing that is loaded from disk needs them."""


@pytest.mark.gate
@pytest.mark.skipif(jit.PLAIN or not jit.CACHED or not machine.CAN_LOAD, reason="a run needs the compiler")
def test_a_second_run_imports_neither_compiler_nor_large_packages() -> None:
    code = (
        "import sys\nfrom fastpin.cli.main import main\n"
        f"main(['run'])\nprint([name for name in {HEAVY} if name in sys.modules])"
    )
    for _ in range(2):  # the first one may have to compile
        done = finished(python(code))
        if done.stdout.splitlines()[-1] == "[]":
            break
    assert done.stdout.splitlines()[-1] == "[]"


@pytest.mark.parametrize("terminal", [True, False])
def test_a_user_at_a_terminal_reads_why_the_first_run_takes_long(
    terminal: bool, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(sys.stderr, "isatty", lambda: terminal, raising=False)
    assert main(["example"]) == 0
    logging.getLogger("fastpin.compiler").info("compiling the solver")
    assert capsys.readouterr().err == "fastpin: compiling the solver\n" * terminal


@pytest.mark.gate
def test_public_names_are_imported_when_they_are_asked_for() -> None:
    code = (
        "import sys, fastpin\nassert 'numpy' not in sys.modules\n"
        "assert set(fastpin.__all__) <= set(dir(fastpin))\n"
        "from fastpin import *\nprint([name for name in fastpin.__all__ if name not in globals()])"
    )
    done = finished(python(code))
    assert done.stdout == "[]\n"
    assert fastpin.solve is solving.solve
    with pytest.raises(AttributeError, match="attribute nothing"):
        _ = fastpin.nothing


def test_help_says_what_a_command_does_and_names_its_defaults(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main(["paper", "--help"])
    printed = " ".join(capsys.readouterr().out.split())
    assert "Compute and draw the figures of the paper. options:" in printed
    assert f"number of nodes (default {catalog.NODES})" in printed


def test_run_prints_a_line_for_each_state(solved: list[dict[str, Any]], capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run"]) == 0
    assert solved == [builtin_case().options.keywords()]
    captured = capsys.readouterr()
    assert captured.err == ""  # no progress bar where nobody watches
    lines = captured.out.splitlines()
    assert lines[0] == builtin_case().title
    assert lines[1].split()[:6] == ["load", "point", "P", "Q", "peak", "N"]
    assert "MPa" in lines[2]
    first = lines[3].split()
    assert first[:3] == ["1", "2.42", "0"]
    assert float(first[3]) == pytest.approx(100.0, rel=1e-3)  # MPa
    assert len(lines) == 10
    assert lines[-4].startswith("largest hoop stress of the plate in all kept states: ")
    assert lines[-3] == "margins of safety over all kept states, allowable/value - 1:"
    assert lines[-2].startswith("  pin: yield, von Mises  ")
    assert "81 nodes" in lines[-1]


@pytest.mark.gate
def test_run_takes_solver_options(case: Path, solved: list[dict[str, Any]]) -> None:
    arguments = ["--nodes", "99", "--method", "increment", "--increments", "7", "--between", "0.25,0.5"]
    arguments += ["--keep", "corners", "--no-shortcut"]
    assert main(["run", str(case), *arguments]) == 0
    assert main(["run", str(case), "--between", "3"]) == 0
    first, second = solved[:2]
    assert first == {
        "nodes": 99, "method": "increment", "increments": 7, "arc": None, "between": (0.25, 0.5), "keep": "corners",
        "shortcut": False, "error_bars": False, "slip_sums": False,
    }  # fmt: skip
    assert second["between"] == 3
    for arc in (["--arc", "-2.5,-0.6"], ["--arc=-2.5,-0.6"]):
        assert main(["run", *arc, str(case)]) == 0
        assert solved[-1]["arc"] == (-2.5, -0.6)
    assert second["keep"] == "all"
    for every in (["every", "10"], ["every 10"], ["every-10"]):
        assert main(["run", "--keep", *every, str(case)]) == 0
        assert solved[-1]["keep"] == "every 10"


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--nodes", "2"], "--nodes: must be a whole number"),
        (["--method", "magic"], "--method: must be"),
        (["--nodes", "abc"], '--nodes: must be a whole number from 5 to 20000, not "abc"'),
        (["--increments", "0", "--method", "increment"], "--increments: must be"),
        (["--increments", "80"], '--increments: has no effect with method "path"'),
        (["--between", "x"], "--between: must be"),
        (["--arc", "1"], "--arc: must be a list of two angles in rad"),
        (["--arc", "-90,90"], "--arc: must run from a smaller to a larger angle"),
        (["--keep", "some"], '--keep: must be "all", "corners", "cycles" or "every N"'),
        (["--keep", "every", "x"], '--keep: must be "all", "corners", "cycles" or "every N"'),
        (["--after", "3"], "--after: needs --start"),
        (["--between", "0.5,0.5"], "--between: must be"),
        (["--plot", "figure.docx"], "--plot: must be the name of a figure, which ends in"),
        (["--json", "no/such/dir/x.json"], "does not exist"),
        (["-o", "."], "is a directory"),
        (["--json", "a.png", "--plot", "a.png"], "writes the same file as --json"),
    ],
)
def test_options_are_checked_before_the_work(
    arguments: list[str],
    words: str,
    solved: list[dict[str, Any]],
    capsys: pytest.CaptureFixture[str],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["run", *arguments]) == 2
    captured = capsys.readouterr()
    assert words in captured.err
    assert captured.err.count("\n") == 1
    assert solved == []
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("option", ["--json", "--plot", "-o"])
def test_the_case_file_is_never_overwritten(
    option: str, case: Path, solved: list[dict[str, Any]], capsys: pytest.CaptureFixture[str]
) -> None:
    """argparse takes the case file after an option with an optional value for that value."""
    assert main(["run", option, str(case)]) == 2
    assert main(["run", str(case), option, str(case.parent / "." / case.name)]) == 2
    assert "by its name it is a case file or plan" in capsys.readouterr().err
    assert case.read_text() == EXAMPLE
    assert solved == []


def test_json_on_standard_output_is_the_only_thing_there(
    solved: list[dict[str, Any]], capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["run", "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    result = sample_result()
    assert document["complete"] is True
    assert document["error"] is None
    assert document["units"]["traction"] == "Pa"
    assert document["fastpin"] == __version__
    assert document["problem"]["dundurs"]["alpha"] == pytest.approx(0.2507, abs=1e-4)
    assert len(document["states"]) == len(result)
    for said, state in zip(document["states"], result, strict=True):
        assert said["peak_pressure"] == state.peak_pressure
        assert said["load"] == {name: load for name, load in state.load.items() if load or name not in LATER}
        start, stop = state.contact[0]
        assert said["contact"][0] == pytest.approx([np.degrees(start) + 90.0, np.degrees(stop) + 90.0])
        assert said["load_point"] == state.step + 1


@pytest.mark.gate
def test_all_outputs(case: Path, tmp_path: Path) -> None:
    from fastpin.storage.store import load

    names = {"--json": "a.json", "--plot": "a.png", "-o": "a.h5"}
    arguments = [word for option, name in names.items() for word in (option, str(tmp_path / name))]
    assert main(["run", str(case), "--nodes", "61", *arguments]) == 0
    assert main(["run", str(case), "--nodes", "61", *arguments]) == 2  # a result is not replaced by accident
    assert main(["run", str(case), "--nodes", "61", *arguments, "--overwrite"]) == 0
    assert {path.name for path in tmp_path.iterdir()} == {"case.toml", *names.values()}
    assert (tmp_path / "a.png").read_bytes().startswith(b"\x89PNG")
    assert len(load(tmp_path / "a.h5")) == len(json.loads((tmp_path / "a.json").read_text())["states"]) == 4


@pytest.mark.gate
@pytest.mark.parametrize("stored", [False, True])
def test_a_lost_load_keeps_what_was_solved(
    stored: bool, case: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    from fastpin.storage.store import load

    text = EXAMPLE.replace("Q = [7.26e5, -7.26e5, 7.26e5]", "M = [0, 3e4, 0]")
    case.write_text(text.replace('pin_load = "body"', 'pin_load = "centre"'))
    names = {"--json": "a.json", "--plot": "a.png", **({"-o": "a.h5"} if stored else {})}
    arguments = [word for option, name in names.items() for word in (option, str(tmp_path / name))]
    assert main(["run", str(case), "--nodes", "61", *arguments]) == 1
    captured = capsys.readouterr()
    assert captured.err.startswith("fastpin: step 3, at ")
    assert captured.err.count("\n") == 1
    assert len([line for line in captured.out.splitlines() if " to " in line]) == 2
    document = json.loads((tmp_path / "a.json").read_text())
    assert document["complete"] is False
    assert f"fastpin: {document['error']}\n" == captured.err
    assert len(document["states"]) == 2
    assert (tmp_path / "a.png").exists()
    if stored:
        result = load(tmp_path / "a.h5")
        assert len(result) == 2
        assert result.complete is False


def test_a_load_lost_at_once_has_no_states(
    lost: NoEquilibriumError, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    lost.result = None
    path = tmp_path / "a.json"
    assert main(["run", "--json", str(path), "--plot", str(tmp_path / "a.png")]) == 1
    assert "no state was reached" in capsys.readouterr().out
    assert json.loads(path.read_text())["states"] == []
    assert not (tmp_path / "a.png").exists()


def test_an_interrupted_run_ends_with_one_sentence(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    def solve(*_: object, **__: object) -> object:
        raise KeyboardInterrupt

    monkeypatch.setattr(solver, "solve", solve)
    assert main(["run", "--json", str(tmp_path / "a.json")]) == 130
    captured = capsys.readouterr()
    assert captured.out == ""
    assert captured.err.count("\n") == 1
    assert list(tmp_path.iterdir()) == []


@pytest.mark.gate
def test_a_file_that_can_not_be_written_does_not_cost_the_others(
    solved: list[dict[str, Any]],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    def full(*_: object, **__: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(figures, "plot_tractions", full)
    path = tmp_path / "a.h5"
    assert main(["run", "--plot", str(tmp_path / "a.png"), "-o", str(path)]) == 1
    assert "No space left" in capsys.readouterr().err
    assert path.exists()


@pytest.mark.gate
def test_a_reader_that_leaves_is_no_error() -> None:
    command = '"$0" -m fastpin example | true; exit "${PIPESTATUS[0]}"'
    done = finished(["bash", "-c", command, sys.executable], check=False)
    assert (done.returncode, done.stderr) == (141, "")


def test_the_real_solver_through_the_command_line(case: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", str(case), "--nodes", "61", "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    first = document["states"][0]
    # 0.52882 F/R for the load parameter 0.1, on many nodes
    assert first["peak_pressure"] * 0.01 / 2.42e6 == pytest.approx(0.5288, rel=3e-3)
    (start, stop), *rest = first["contact"]
    assert not rest
    assert (start, stop) == pytest.approx((-np.degrees(1.136), np.degrees(1.136)), abs=2.0)


# -- the figures of the paper ----------------------------------------------------------------------------------


@pytest.mark.gate
def test_paper_writes_a_figure_and_its_numbers(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["paper", "--figure", "3", "--figure", "03", "--nodes", "101", "-o", str(tmp_path / "new")]) == 0
    captured = capsys.readouterr()
    assert captured.err == ""
    (line,) = captured.out.splitlines()
    files = tmp_path / "new" / "figure03.png", tmp_path / "new" / "figure03.csv"
    assert line.startswith(f"figure 3: {files[0]}, {files[1]}, ")
    assert set((tmp_path / "new").iterdir()) == set(files)
    assert files[0].read_bytes().startswith(b"\x89PNG")
    assert files[1].read_text().splitlines()[1] == f"# fastpin {__version__}, --nodes 101"
    # as docs/paper.md says
    rows = np.genfromtxt(files[1], delimiter=",", names=True, skip_header=3, dtype=None, encoding="utf-8")
    for friction, peak in ((0.1, 0.5489), (0.7, 0.3828)):
        chosen = rows[(rows["L_p"] == 0.01) & (rows["mu"] == friction)]
        assert chosen["N"].max() == pytest.approx(peak, rel=3e-3)


@pytest.mark.gate
@pytest.mark.usefixtures("drawn")
def test_paper_writes_the_formats_that_are_asked_for(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    formats = ["--format", "pdf", "--format", "svg", "--format", "pdf"]
    assert main(["paper", "--figure", "11", "--nodes", "101", "-o", str(tmp_path), *formats]) == 0
    (line,) = capsys.readouterr().out.splitlines()
    files = [tmp_path / f"figure11.{kind}" for kind in ("pdf", "svg", "csv")]
    assert line.startswith(f"figure 11: {', '.join(map(str, files))}, ")
    assert set(tmp_path.iterdir()) == set(files)
    page, drawing = files[0].read_bytes(), files[1].read_text()
    assert page.startswith(b"%PDF")
    assert b"/FontFile2" in page  # TrueType fonts inside
    assert "<svg" in drawing
    assert "<text" not in drawing  # letters are outlines


@pytest.fixture
def made(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """No figure is computed; the names of those asked for are recorded. Figure 6 is interrupted."""
    names: list[str] = []

    def make(
        name: str, directory: Path, nodes: int, progress: Callable[[float], None], formats: list[str]
    ) -> list[Path]:
        if name == "6":
            raise KeyboardInterrupt
        progress(0.5)
        progress(1.0)
        names.append(name)
        return [directory / f"{name}.{kind}" for kind in (*formats, "csv")]

    monkeypatch.setattr(catalog, "make", make)
    return names


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--figure", "4", "--figure", "2"], "--figure: there is no '2'; there are 3 to 17 of the paper, and "),
        (["--figure", "17", "--nodes", "200"], "--nodes: figure 17 needs at least 201 nodes, not 200"),
        (["--nodes", "101"], "--nodes: figure 5 needs at least 201 nodes, not 101"),
        (["--format", "svgz"], '--format: must be "png", "pdf" or "svg", not "svgz", did you mean'),
        (["--nodes", "-1"], "--nodes: must be a whole number from 5 to 20000, not -1"),
        (["-o", "file"], "--output: file is a file, not a directory"),
        (["-o", "file/below"], "--output: can't make the directory file/below: Not a directory"),
        (["--figure", "4", "-o", "taken"], "figure04.csv: is a directory"),
    ],
)
def test_paper_checks_all_figures_before_the_first(
    arguments: list[str],
    words: str,
    made: list[str],
    capsys: pytest.CaptureFixture[str],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "file").touch()
    (tmp_path / "taken" / "figure04.csv").mkdir(parents=True)
    assert main(["paper", *arguments]) == 2
    captured = capsys.readouterr()
    assert words in captured.err
    assert captured.err.count("\n") == 1
    assert captured.out == ""
    assert made == []


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write everywhere")
def test_paper_into_a_directory_that_is_not_writable(
    made: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    tmp_path.chmod(0o555)
    assert main(["paper", "-o", str(tmp_path)]) == 2
    assert "is not writable" in capsys.readouterr().err
    assert made == []


def test_an_interrupted_paper_says_what_is_finished(
    made: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["paper", "-o", str(tmp_path)]) == 130
    captured = capsys.readouterr()
    assert captured.err == "fastpin: interrupted; figures that are finished: 3, 4, 5\n"
    assert len(captured.out.splitlines()) == len(made) == 3
    assert main(["paper", "-o", str(tmp_path), "--figure", "6"]) == 130
    assert capsys.readouterr().err == "fastpin: interrupted; no figure was finished\n"


# -- notes ---------------------------------------------------------------------------------------------------


def test_values_that_are_not_in_si_units_are_doubted(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "gigapascals.toml"
    path.write_text(EXAMPLE.replace('material = "Ti-6Al-4V"', "E = 116.0\nnu = 0.32"))
    assert main(["run", str(path), "--nodes", "41"]) == 0
    sentence = "E: 116 Pa of the pin is softer than rubber; moduli are in Pa; did you mean 116 GPa, which is 116e9?"
    assert capsys.readouterr().err == f"fastpin: warning: {sentence}\n"
    assert main(["run", "--nodes", "41"]) == 0
    assert capsys.readouterr().err == ""


# -- long histories ------------------------------------------------------------------------------------------

CYCLES = EXAMPLE.replace("# repeat = 1000  ", "repeat = 12  ").replace("nodes = 401", "nodes = 61")


@pytest.fixture
def cyclic(tmp_path: Path) -> Path:
    path = tmp_path / "cycles.toml"
    path.write_text(CYCLES)
    return path


@pytest.mark.gate
def test_cycles_are_told_stored_and_drawn(cyclic: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    stored, figure = str(tmp_path / "a.h5"), str(tmp_path / "c.png")
    assert main(["run", str(cyclic), "-o", stored, "--keep", "cycles", "--cycles", figure, "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert len(document["states"]) == len(document["cycles"]) == 12
    assert document["history"]["blocks"][1]["repeat"] == 12
    assert Path(figure).read_bytes().startswith(b"\x89PNG")
    assert main(["show", stored]) == 0
    out = capsys.readouterr().out
    assert re.search(r"to corner 37, 12 cycles of 3 corners: (not yet periodic|periodic from)", out)
    assert re.search(r"; first cycle: tractions changed by \S+ of the peak pressure, dissipated .*; last: changed", out)
    assert len([line for line in out.splitlines() if line.endswith(("e-15", "e-16"))]) == 3
    assert "... 13 to 37: repeat load point 10, 9 times ..." in out
    assert main(["show", stored, "--json", str(tmp_path / "a.json")]) == 0
    again = json.loads((tmp_path / "a.json").read_text())
    assert again["states"] == document["states"]
    assert again["cycles"] == document["cycles"]


@pytest.mark.gate
def test_the_last_cycle_is_told_and_written(cyclic: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    stored, table = str(tmp_path / "a.h5"), tmp_path / "c.csv"
    held = CYCLES.replace('pin_load = "body"', 'pin_load = "centre"').replace('rotation = "free"', 'rotation = "fixed"')
    cyclic.write_text(held)
    assert main(["run", str(cyclic), "-o", stored, "--slip-sums", "--between", "1", "--cycle-csv", str(table)]) == 0
    out = capsys.readouterr().out
    line = next(line for line in out.splitlines() if line.startswith("from corner 34 to 37: "))
    assert re.search(r"slip distance up to [\d.]+ um at .* deg, friction energy up to [\d.]+ m?J/m\^2 at ", line)
    assert "times ..." in out  # the states of the cycle are read although the table leaves out some states
    rows = list(csv.DictReader(table.read_text().splitlines()))
    assert len(rows) == 61
    assert {row["behaviour"] for row in rows} <= {"no contact", "sticks", "slips", "opens"}
    assert main(["show", stored, "--json"]) == 0
    cycle = json.loads(capsys.readouterr().out)["cycle"]
    result = fastpin.load(stored).cycle()
    assert cycle["largest_friction_energy"] == result.friction_energy.max()
    assert max(float(row["friction_energy [J/m^2]"]) for row in rows) == result.friction_energy.max()
    assert sum(cycle["nodes"].values()) == 61
    assert cycle["dissipation"] == result.dissipation
    assert f"at {cycle['largest_friction_energy_angle']:z.2f} deg" in line


SHEET = CYCLES.replace("nu = 0.33", "").replace("E  = 69e9", 'material = "2024-T3"')


@pytest.mark.gate
def test_hoop_stress_and_fatigue_are_told(cyclic: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    stored = str(tmp_path / "a.h5")
    cyclic.write_text(SHEET)
    assert main(["run", str(cyclic), "-o", stored]) == 0
    lines = capsys.readouterr().out.splitlines()
    result = fastpin.load(stored)
    assert len(result) == 37
    hoop = next(line for line in lines if line.startswith("largest hoop stress of the plate in all kept states: "))
    assert f" {max(state.peak_hoop_stress().value for state in result) / 1e6:.4g} MPa" in hoop
    fatigue = next(line for line in lines if line.startswith("fatigue of the plate in the last cycle"))
    assert fatigue.endswith(f"life {result.fatigue('smith-watson-topper').hot_spot.life:.3g} cycles")
    assert main(["show", stored]) == 0
    assert [line for line in capsys.readouterr().out.splitlines() if line in (hoop, fatigue)] == [hoop, fatigue]
    assert main(["show", stored, "--json"]) == 0
    states = json.loads(capsys.readouterr().out)["states"]
    assert [state["peak_hoop_resolved"] for state in states] == [state.peak_hoop_stress().resolved for state in result]


@pytest.mark.gate
def test_fatigue_is_not_told_if_the_states_of_the_cycle_are_not_at_hand(
    cyclic: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    cyclic.write_text(SHEET)
    stored = ["-o", str(tmp_path / "a.h5"), "--overwrite"]
    assert main(["run", str(cyclic), *stored, "--keep", "every 4"]) == 0
    assert "fatigue" not in capsys.readouterr().out
    assert main(["run", str(cyclic), *stored, "--between", "3"]) == 0  # 12 states, of which the table shows some
    assert "fatigue of the plate in the last cycle" in capsys.readouterr().out


@pytest.mark.gate
def test_a_cycle_whose_ends_were_not_kept_is_told(
    cyclic: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    table = tmp_path / "c.csv"
    assert main(["run", str(cyclic), "--keep", "every 4", "--slip-sums", "--cycle-csv", str(table)]) == 1
    captured = capsys.readouterr()
    assert "the state at corner 34 was not kept" in captured.err
    assert "from corner" not in captured.out
    assert not table.exists()
    assert main(["run", str(cyclic), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["cycle"] is None


@pytest.mark.gate
def test_long_histories_are_told_in_short(cyclic: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    cyclic.write_text(CYCLES.replace("repeat = 12  ", "repeat = 30  "))
    assert main(["check", str(cyclic)]) == 0
    out = capsys.readouterr().out
    assert "91 corners" in out
    assert out.count("x 30") == 3
    stored = str(tmp_path / "a.h5")
    assert main(["run", str(cyclic), "-o", stored, "-v"]) == 0
    captured = capsys.readouterr()
    assert re.search(r"\.\.\. \d+ to (89|9\d): repeat load points \d+ to \d+, 2\d times \.\.\.\n", captured.out)
    assert "more" not in captured.out
    assert "repeat" in captured.err
    assert main(["run", str(cyclic)]) == 0
    assert without_times(capsys.readouterr().out) == without_times(captured.out)
    assert main(["show", stored]) == 0
    assert capsys.readouterr().out == captured.out
    assert captured.err.startswith("fastpin: ")


def without_times(text: str) -> str:
    return re.sub(r"[\d.]+ seconds", "", text)


@pytest.mark.gate
def test_branches_from_the_command_line(case: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = EXAMPLE.replace("nodes = 401", "nodes = 61").replace("# arc =", "arc =")
    whole, branch, trunk = tmp_path / "whole.toml", tmp_path / "branch.toml", str(tmp_path / "trunk.h5")
    case.write_text(text)
    whole.write_text(text.replace("[7.26e5, -7.26e5, 7.26e5]", "[7.26e5, -3e5, 1e5]"))
    branch.write_text(
        text.replace("\nP = 2.42e6", "\nP = 2.42e6\nQ = -3e5").replace("[7.26e5, -7.26e5, 7.26e5]", "1e5")
    )
    assert main(["run", str(case), "-o", trunk, "--save-after", "2,3"]) == 0
    documents = []
    for arguments in ([str(branch), "--start", trunk, "--after", "2"], [str(whole)]):
        capsys.readouterr()
        assert main(["run", *arguments, "--json"]) == 0
        documents.append(json.loads(capsys.readouterr().out)["states"])
    for one, other in zip(documents[0], documents[1][2:], strict=True):
        for name in ("peak_shear", "rotation", "dissipation", "contact", "stick", "load"):
            assert one[name] == other[name]
    for wrong, words in (
        (["--start", trunk, "--after", "9"], "--after: must be a corner from 1 to 4"),
        (["--start", trunk, "--nodes", "99"], "--nodes: is fixed by the result to continue from"),
        (["--start", trunk, "-o", trunk], "--output: is the file to start from"),
    ):
        assert main(["run", str(branch), *wrong]) == 2
        assert words in capsys.readouterr().err


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["run", "CASE", "--save-after", "2"], "--save-after: needs --output"),
        (["run", "CASE", "--overwrite"], "--overwrite: needs --output"),
        (["run", "CASE", "--save-after", "5", "-o", "a.h5"], "--save-after: must be corners from 1 to 4"),
        (["run", "CASE", "--save-after", "x", "-o", "a.h5"], "--save-after: must be corners from 1 to 4"),
        (["run", "CASE", "--cycles", "c.png"], "--cycles: the history has no cycles"),
        (["run", "CASE", "--cycle-csv", "c.csv"], "--cycle-csv: the history has no cycles"),
        (["run", "CASE", "--keep", "cycles"], "--keep: the history has no cycles"),
        (["run", "CASE", "-o", "CASE"], "by its name it is a case file or plan"),
        (["run", "CASE", "--start", "CASE"], "is no result; of a case file, fastpin run"),
        (["run", "CASE", "--start", "none.h5"], "there is no such file"),
        (["resume", "none.h5"], "there is no such file"),
        (["resume", "CASE"], "is no result; of a case file, fastpin run"),
        (["show", "CASE"], "is no result; of a case file, fastpin run"),
    ],
)
def test_options_of_long_histories_are_checked(
    arguments: list[str],
    words: str,
    case: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main([str(case) if word == "CASE" else word for word in arguments]) == 2
    captured = capsys.readouterr()
    assert words in captured.err
    assert captured.err.count("\n") == 1
    assert captured.out == ""
    assert [path.name for path in tmp_path.iterdir()] == ["case.toml"]


@pytest.mark.gate
def test_an_older_result_is_not_shown_for_a_run_that_never_began(
    case: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    from fastpin.solver import arc
    from fastpin.solver.errors import Interrupted

    def stopped(*_: object) -> object:
        raise Interrupted

    stored = tmp_path / "a.h5"
    assert main(["run", str(case), "--nodes", "61", "-o", str(stored)]) == 0
    before = stored.read_bytes()
    capsys.readouterr()
    monkeypatch.setattr(arc, "_touched_arc", stopped)
    assert main(["run", str(case), "-o", str(stored), "--overwrite"]) == 130
    captured = capsys.readouterr()
    assert "no state was reached" in captured.out
    assert captured.err == "fastpin: interrupted before the first corner\n"
    assert stored.read_bytes() == before
