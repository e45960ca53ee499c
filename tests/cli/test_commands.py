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
from fastpin import Interrupted, NoEquilibriumError, __version__, figures, solver
from fastpin.casefile import EXAMPLE, builtin_case
from fastpin.cli.main import main
from fastpin.model.loads import LATER
from fastpin.published import catalog
from fastpin.runtime import jit, machine
from fastpin.solver import arc, solving
from tests.support.commands import printed, refusal, refused, said
from tests.support.processes import finished, python
from tests.support.samples import sample_result
from tests.support.tiers import some_gate

CASE = EXAMPLE
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


def test_example_prints_a_case_file() -> None:
    assert printed("example") == EXAMPLE


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


def test_check_says_what_was_understood(case: Path) -> None:
    out = printed("check", case)
    for words in ("Ti-6Al-4V, E = 116 GPa, nu = 0.32", "alpha = 0.2507, beta = 0.0595", "radius 10 mm", "401 nodes"):
        assert words in out
    rows = [line.split() for line in out.splitlines()]
    assert rows[-4:] == [
        ["1", "2.42", "0", "0.1"],
        ["2", "2.42", "0.726", "0.09582"],
        ["3", "2.42", "-0.726", "0.09582"],
        ["4", "2.42", "0.726", "0.09582"],
    ]


def test_check_prints_all_faults_and_nothing_else(case: Path) -> None:
    case.write_text(EXAMPLE.replace("nu = 0.33", "nu = 0.7").replace("nodes = 401", "nodes = 1"))
    captured = said("check", case, code=2)
    assert captured.out == ""
    lines = captured.err.splitlines()
    assert [line.split(": ")[1] for line in lines] == ["nu", "nodes"]
    assert all(line.startswith(f"{case}, line ") for line in lines)


LIGHT = {
    "": "--help; --version; run --help; paper --help; sweep --help; merge --help; verify --help; converge --help; "
    "verify --json no/where.json; converge case.toml --nodes x; run --colour; sweep case.toml --shard 3/2",
    "numpy": "sweep case.toml; example; compliance --example; compliance case.toml; check case.toml; "
    "run case.toml --nodes 1",
}
"""Commands by the heavy packages that they may import."""


@pytest.mark.gate
@pytest.mark.usefixtures("case")
@pytest.mark.parametrize("needed", some_gate(LIGHT, "numpy"))
def test_heavy_imports_wait_until_they_are_needed(needed: str) -> None:
    """The commands run in one process, one after the other. The first that imports more is named."""
    code = (
        "import sys\nfrom fastpin.cli.main import main\n"
        "for command in sys.argv[1:]:\n"
        "    try:\n        main(command.split())\n    except SystemExit:\n        pass\n"
        "    names = ('numpy', 'numba', 'scipy', 'matplotlib', 'h5py', 'tqdm')\n"
        "    print('\\nimported', command, *(name for name in names if name in sys.modules))"
    )
    commands = LIGHT[needed].split("; ")
    done = finished(python(code, *commands), env={**os.environ, "PYTHONPATH": str(ROOT)}, cwd=".")
    imported = [line for line in done.stdout.splitlines() if line.startswith("imported ")]
    assert imported == [f"imported {command} {needed}".strip() for command in commands]


HEAVY = (
    "numba", "scipy", "scipy.linalg", "scipy.special", "scipy.fft", "tqdm", "matplotlib", "h5py", "multiprocessing",
    "jinja2", "shtab", "importlib.metadata", "numpy.typing", "numpy.f2py", "numpy.testing", "numpy.random", "numpy.ma",
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
def test_a_user_at_a_terminal_reads_why_the_first_run_takes_long(terminal, monkeypatch, capsys):
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
    words = " ".join(capsys.readouterr().out.split())
    assert "Compute and draw the figures of the paper. options:" in words
    assert f"number of nodes (default {catalog.NODES})" in words


def test_run_prints_a_line_for_each_state(solved: list[dict[str, Any]]) -> None:
    captured = said("run")
    assert solved == [builtin_case().options.keywords()]
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
    options = "--nodes 99 --method increment --increments 7 --between 0.25,0.5 --keep corners --no-shortcut"
    said("run", case, *options.split())
    assert solved[-1] == {
        "nodes": 99, "method": "increment", "increments": 7, "arc": None, "between": (0.25, 0.5), "keep": "corners",
        "shortcut": False, "error_bars": False, "slip_sums": False,
    }  # fmt: skip
    said("run", case, "--between", "3")
    assert (solved[-1]["between"], solved[-1]["keep"]) == (3, "all")
    for words in (["--arc", "-2.5,-0.6"], ["--arc=-2.5,-0.6"]):
        said("run", *words, case)
        assert solved[-1]["arc"] == (-2.5, -0.6)
    for every in (["every", "10"], ["every 10"], ["every-10"]):
        said("run", "--keep", *every, case)
        assert solved[-1]["keep"] == "every 10"


@pytest.mark.parametrize(
    ("command", "words"),
    [
        ("run --nodes abc", '--nodes: must be a whole number from 5 to 20000, not "abc"'),
        ("run --between x", "--between: must be"),
        ("run --keep every x", '--keep: must be "all", "corners", "cycles" or "every N"'),
        ("run --after 3", "--after: needs --start"),
        ("run --plot figure.docx", "--plot: must be the name of a figure, which ends in"),
        ("run --json no/such/dir/x.json", "does not exist"),
        ("run -o .", "is a directory"),
        ("run --json a.png --plot a.png", "writes the same file as --json"),
        ("run --states last", "--states: chooses the states of a figure: it needs --plot FILE"),
        ("run --plot a.png --states 9", "--states: there is no state at load point 9; the last is 4"),
        ("run --plot a.png --states cycle", "--states: no cycle of the history has ended"),
        ("run --plot a.png --states x", "--states: must be last, cycle, all or load points such as 2,3.5"),
        ("run case.toml --save-after 2", "--save-after: needs --output"),
        ("run case.toml --overwrite", "--overwrite: needs --output"),
        ("run case.toml --save-after 5 -o a.h5", "--save-after: must be corners from 1 to 4"),
        ("run case.toml --save-after x -o a.h5", "--save-after: must be corners from 1 to 4"),
        ("run case.toml --cycles c.png", "--cycles: the history has no cycles"),
        ("run case.toml --cycle-csv c.csv", "--cycle-csv: the history has no cycles"),
        ("run case.toml --keep cycles", "--keep: the history has no cycles"),
        ("run case.toml -o case.toml", "by its name it is a case file or plan"),
        ("run case.toml --start case.toml", "is no result; fastpin run, or joint, case.toml -o FILE makes one"),
        ("run case.toml --start none.h5", "there is no such file"),
        ("resume none.h5", "there is no such file"),
        ("resume case.toml", "is no result; fastpin run, or joint, case.toml -o FILE makes one"),
        ("show case.toml", "is no result; fastpin run, or joint, case.toml -o FILE makes one"),
    ],
)
@pytest.mark.usefixtures("case")
def test_options_are_checked_before_the_work(command, words, solved, tmp_path):
    assert words in refusal(*command.split())
    assert solved == []
    assert [path.name for path in tmp_path.iterdir()] == ["case.toml"]


@pytest.mark.parametrize("option", ["--json", "--plot", "-o"])
def test_the_case_file_is_never_overwritten(option: str, case: Path, solved: list[dict[str, Any]]) -> None:
    """argparse takes the case file after an option with an optional value for that value."""
    refused("run", option, case)
    assert "by its name it is a case file or plan" in refused("run", case, option, Path.cwd() / case)
    assert case.read_text() == EXAMPLE
    assert solved == []


def test_json_on_standard_output_is_the_only_thing_there(solved: list[dict[str, Any]]) -> None:
    document = json.loads(printed("run", "--json"))
    result = sample_result()
    assert document["complete"] is True
    assert document["error"] is None
    assert document["units"]["traction"] == "Pa"
    assert document["fastpin"] == __version__
    assert document["problem"]["dundurs"]["alpha"] == pytest.approx(0.2507, abs=1e-4)
    assert len(document["states"]) == len(result)
    for told, state in zip(document["states"], result, strict=True):
        assert told["peak_pressure"] == state.peak_pressure
        assert told["load"] == {name: load for name, load in state.load.items() if load or name not in LATER}
        start, stop = state.contact[0]
        assert told["contact"][0] == pytest.approx([np.degrees(start) + 90.0, np.degrees(stop) + 90.0])
        assert told["load_point"] == state.step + 1


@pytest.mark.gate
def test_all_outputs(case: Path, tmp_path: Path) -> None:
    command = ["run", case, "--nodes", "61", "--json", "a.json", "--plot", "a.png", "-o", "a.h5"]
    said(*command)
    refused(*command)  # a result is not replaced by accident
    said(*command, "--overwrite")
    assert {path.name for path in tmp_path.iterdir()} == {"case.toml", "a.json", "a.png", "a.h5"}
    assert Path("a.png").read_bytes().startswith(b"\x89PNG")
    assert len(fastpin.load("a.h5")) == len(json.loads(Path("a.json").read_text())["states"]) == 4


@pytest.mark.gate
@pytest.mark.parametrize("stored", [False, True])
def test_a_lost_load_keeps_what_was_solved(stored: bool, case: Path) -> None:
    text = EXAMPLE.replace("Q = [7.26e5, -7.26e5, 7.26e5]", "M = [0, 3e4, 0]")
    case.write_text(text.replace('pin_load = "body"', 'pin_load = "centre"'))
    output = ["-o", "a.h5"] if stored else []
    captured = said("run", case, "--nodes", "61", "--json", "a.json", "--plot", "a.png", *output, code=1)
    assert captured.err.startswith("fastpin: step 3, at ")
    assert captured.err.count("\n") == 1
    assert len([line for line in captured.out.splitlines() if " to " in line]) == 2
    document = json.loads(Path("a.json").read_text())
    assert document["complete"] is False
    assert f"fastpin: {document['error']}\n" == captured.err
    assert len(document["states"]) == 2
    assert Path("a.png").exists()
    if stored:
        result = fastpin.load("a.h5")
        assert len(result) == 2
        assert result.complete is False


def test_a_load_lost_at_once_has_no_states(monkeypatch: pytest.MonkeyPatch) -> None:
    def lose(*_: object, **__: object) -> object:
        raise NoEquilibriumError("the pin slides away at 40 % of step 4", 3, 0.4, {})

    monkeypatch.setattr(solver, "solve", lose)
    assert "no state was reached" in said("run", "--json", "a.json", "--plot", "a.png", code=1).out
    assert json.loads(Path("a.json").read_text())["states"] == []
    assert not Path("a.png").exists()


def test_an_interrupted_run_ends_with_one_sentence(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    def solve(*_: object, **__: object) -> object:
        raise KeyboardInterrupt

    monkeypatch.setattr(solver, "solve", solve)
    captured = said("run", "--json", "a.json", code=130)
    assert captured.out == ""
    assert captured.err.count("\n") == 1
    assert list(tmp_path.iterdir()) == []


@pytest.mark.gate
def test_a_file_that_can_not_be_written_does_not_cost_the_others(solved, monkeypatch):
    def full(*_: object, **__: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(figures, "plot_tractions", full)
    assert "No space left" in said("run", "--plot", "a.png", "-o", "a.h5", code=1).err
    assert Path("a.h5").exists()


@pytest.mark.gate
def test_a_reader_that_leaves_is_no_error() -> None:
    command = '"$0" -m fastpin example | true; exit "${PIPESTATUS[0]}"'
    done = finished(["bash", "-c", command, sys.executable], check=False)
    assert (done.returncode, done.stderr) == (141, "")


def test_the_real_solver_through_the_command_line(case: Path) -> None:
    document = json.loads(printed("run", case, "--nodes", "61", "--json"))
    first = document["states"][0]
    # 0.52882 F/R for the load parameter 0.1, on many nodes
    assert first["peak_pressure"] * 0.01 / 2.42e6 == pytest.approx(0.5288, rel=3e-3)
    (start, stop), *rest = first["contact"]
    assert not rest
    assert (start, stop) == pytest.approx((-np.degrees(1.136), np.degrees(1.136)), abs=2.0)


# -- the figures of the paper ----------------------------------------------------------------------------------


@pytest.mark.gate
def test_paper_writes_a_figure_and_its_numbers() -> None:
    captured = said("paper", "--figure", "3", "--figure", "03", "--nodes", "101", "-o", "new")
    assert captured.err == ""
    (line,) = captured.out.splitlines()
    files = Path("new/figure03.png"), Path("new/figure03.csv")
    assert line.startswith(f"figure 3: {files[0]}, {files[1]}, ")
    assert set(Path("new").iterdir()) == set(files)
    assert files[0].read_bytes().startswith(b"\x89PNG")
    assert files[1].read_text().splitlines()[1] == f"# fastpin {__version__}, --nodes 101"
    # as docs/paper.md says
    rows = np.genfromtxt(files[1], delimiter=",", names=True, skip_header=3, dtype=None, encoding="utf-8")
    for friction, peak in ((0.1, 0.5489), (0.7, 0.3828)):
        chosen = rows[(rows["L_p"] == 0.01) & (rows["mu"] == friction)]
        assert chosen["N"].max() == pytest.approx(peak, rel=3e-3)


@pytest.mark.gate
@pytest.mark.usefixtures("drawn")
def test_paper_writes_the_formats_that_are_asked_for(tmp_path: Path) -> None:
    formats = ["--format", "pdf", "--format", "svg", "--format", "pdf"]
    (line,) = printed("paper", "--figure", "11", "--nodes", "101", "-o", tmp_path, *formats).splitlines()
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
def test_paper_checks_all_figures_before_the_first(arguments, words, made):
    Path("file").touch()
    Path("taken/figure04.csv").mkdir(parents=True)
    assert words in refusal("paper", *arguments)
    assert made == []


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write everywhere")
def test_paper_into_a_directory_that_is_not_writable(made: list[str], tmp_path: Path) -> None:
    tmp_path.chmod(0o555)
    assert "is not writable" in refused("paper", "-o", tmp_path)
    assert made == []


def test_an_interrupted_paper_says_what_is_finished(made: list[str]) -> None:
    captured = said("paper", "-o", ".", code=130)
    assert captured.err == "fastpin: interrupted; figures that are finished: 3, 4, 5\n"
    assert len(captured.out.splitlines()) == len(made) == 3
    words = "fastpin: interrupted; no figure was finished\n"
    assert said("paper", "-o", ".", "--figure", "6", code=130).err == words


# -- notes ---------------------------------------------------------------------------------------------------


def test_values_that_are_not_in_si_units_are_doubted(case: Path) -> None:
    case.write_text(EXAMPLE.replace('material = "Ti-6Al-4V"', "E = 116.0\nnu = 0.32"))
    sentence = "E: 116 Pa of the pin is softer than rubber; moduli are in Pa; did you mean 116 GPa, which is 116e9?"
    assert said("run", case, "--nodes", "41").err == f"fastpin: warning: {sentence}\n"
    assert said("run", "--nodes", "41").err == ""


# -- long histories ------------------------------------------------------------------------------------------

CYCLES = EXAMPLE.replace("# repeat = 1000  ", "repeat = 12  ").replace("nodes = 401", "nodes = 61")


@pytest.fixture
def cyclic(case: Path) -> Path:
    case.write_text(CYCLES)
    return case


@pytest.mark.gate
def test_cycles_are_told_stored_and_drawn(cyclic: Path) -> None:
    document = json.loads(printed("run", cyclic, "-o", "a.h5", "--keep", "cycles", "--cycles", "c.png", "--json"))
    assert len(document["states"]) == len(document["cycles"]) == 12
    assert document["history"]["blocks"][1]["repeat"] == 12
    assert Path("c.png").read_bytes().startswith(b"\x89PNG")
    out = printed("show", "a.h5")
    assert re.search(r"to corner 37, 12 cycles of 3 corners: (not yet periodic|periodic from)", out)
    assert re.search(r"; first cycle: tractions changed by \S+ of the peak pressure, dissipated .*; last: changed", out)
    assert len([line for line in out.splitlines() if line.endswith(("e-15", "e-16"))]) == 3
    assert "... 13 to 37: repeat load point 10, 9 times ..." in out
    said("show", "a.h5", "--json", "a.json")
    again = json.loads(Path("a.json").read_text())
    assert again["states"] == document["states"]
    assert again["cycles"] == document["cycles"]


@pytest.mark.gate
def test_the_last_cycle_is_told_and_written(cyclic: Path) -> None:
    held = CYCLES.replace('pin_load = "body"', 'pin_load = "centre"').replace('rotation = "free"', 'rotation = "fixed"')
    cyclic.write_text(held)
    out = printed("run", cyclic, "-o", "a.h5", "--slip-sums", "--between", "1", "--cycle-csv", "c.csv")
    line = next(line for line in out.splitlines() if line.startswith("from corner 34 to 37: "))
    assert re.search(r"slip distance up to [\d.]+ um at .* deg, friction energy up to [\d.]+ m?J/m\^2 at ", line)
    assert "times ..." in out  # the states of the cycle are read although the table leaves out some states
    rows = list(csv.DictReader(Path("c.csv").read_text().splitlines()))
    assert len(rows) == 61
    assert {row["behaviour"] for row in rows} <= {"no contact", "sticks", "slips", "opens"}
    cycle = json.loads(printed("show", "a.h5", "--json"))["cycle"]
    result = fastpin.load("a.h5").cycle()
    assert cycle["largest_friction_energy"] == result.friction_energy.max()
    written = max(float(row["friction_energy [J/m^2]"]) for row in rows)
    assert written == pytest.approx(result.friction_energy.max(), rel=1e-8)
    assert sum(cycle["nodes"].values()) == 61
    assert cycle["dissipation"] == result.dissipation
    assert f"at {cycle['largest_friction_energy_angle']:z.2f} deg" in line


SHEET = (
    CYCLES.replace("nu = 0.33", "").replace("E  = 69e9", 'material = "2024-T3"').replace("repeat = 12 ", "repeat = 4 ")
)


@pytest.mark.gate
def test_hoop_stress_is_told(cyclic: Path) -> None:
    cyclic.write_text(SHEET)
    lines = printed("run", cyclic, "-o", "a.h5").splitlines()
    result = fastpin.load("a.h5")
    assert len(result) == 13
    hoop = next(line for line in lines if line.startswith("largest hoop stress of the plate in all kept states: "))
    assert f" {max(state.peak_hoop_stress().value for state in result) / 1e6:.4g} MPa" in hoop
    assert hoop in printed("show", "a.h5").splitlines()
    states = json.loads(printed("show", "a.h5", "--json"))["states"]
    assert [state["peak_hoop_resolved"] for state in states] == [state.peak_hoop_stress().resolved for state in result]


@pytest.mark.gate
def test_a_cycle_whose_ends_were_not_kept_is_told(cyclic: Path) -> None:
    captured = said("run", cyclic, "--keep", "every 4", "--slip-sums", "--cycle-csv", "c.csv", code=1)
    assert "the state at corner 34 was not kept" in captured.err
    assert "from corner" not in captured.out
    assert not Path("c.csv").exists()
    assert json.loads(printed("run", cyclic, "--json"))["cycle"] is None


@pytest.mark.gate
def test_long_histories_are_told_in_short(cyclic: Path) -> None:
    cyclic.write_text(CYCLES.replace("repeat = 12  ", "repeat = 30  "))
    out = printed("check", cyclic)
    assert "91 corners" in out
    assert out.count("x 30") == 3
    captured = said("run", cyclic, "-o", "a.h5", "-v")
    assert re.search(r"\.\.\. \d+ to (89|9\d): repeat load points \d+ to \d+, 2\d times \.\.\.\n", captured.out)
    assert "more" not in captured.out
    assert "repeat" in captured.err
    assert without_times(printed("run", cyclic)) == without_times(captured.out)
    assert printed("show", "a.h5") == captured.out
    assert captured.err.startswith("fastpin: ")


def without_times(text: str) -> str:
    return re.sub(r"[\d.]+ seconds", "", text)


@pytest.mark.gate
def test_branches_from_the_command_line(case: Path) -> None:
    text = EXAMPLE.replace("nodes = 401", "nodes = 61").replace("# arc =", "arc =")
    forces = "[7.26e5, -7.26e5, 7.26e5]"
    case.write_text(text)
    Path("whole.toml").write_text(text.replace(forces, "[7.26e5, -3e5, 1e5]"))
    Path("branch.toml").write_text(text.replace("\nP = 2.42e6", "\nP = 2.42e6\nQ = -3e5").replace(forces, "1e5"))
    said("run", case, "-o", "trunk.h5", "--save-after", "2,3")
    begun = ["run", "branch.toml", "--start", "trunk.h5"]
    branch = json.loads(printed(*begun, "--after", "2", "--json"))["states"]
    whole = json.loads(printed("run", "whole.toml", "--json"))["states"]
    for one, other in zip(branch, whole[2:], strict=True):
        for name in ("peak_shear", "rotation", "dissipation", "contact", "stick", "load"):
            assert one[name] == other[name]
    assert "--after: must be a corner from 1 to 4" in refused(*begun, "--after", "9")
    assert "--nodes: is fixed by the result to continue from" in refused(*begun, "--nodes", "99")
    assert "--output: is the file to start from" in refused(*begun, "-o", "trunk.h5")


@pytest.mark.gate
def test_an_older_result_is_not_shown_for_a_run_that_never_began(case, monkeypatch):
    def stopped(*_: object) -> object:
        raise Interrupted

    stored = Path("a.h5")
    said("run", case, "--nodes", "61", "-o", stored)
    before = stored.read_bytes()
    monkeypatch.setattr(arc, "_touched_arc", stopped)
    captured = said("run", case, "-o", stored, "--overwrite", code=130)
    assert "no state was reached" in captured.out
    assert captured.err == "fastpin: interrupted before the first corner\n"
    assert stored.read_bytes() == before
