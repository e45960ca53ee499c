"""The recipes of docs/cluster.md: the page shows the files, and the files work with a stand-in for SLURM."""

import os
import re
import shutil
import stat
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

import pytest

import fastpin
from fastpin.casefile import parse_case
from fastpin.cli.main import main
from fastpin.cli.options import join_words, parser
from fastpin.solver import Interrupted
from tests.support.documents import DOCS, texts
from tests.support.interrupts import StopAt
from tests.support.processes import finished

RECIPES = DOCS / "cluster"
JOBS = ("sweep.sbatch", "cases.sbatch")

SRUN = """#!/bin/bash
while [[ $1 == --* ]]; do shift; done
exec "$@"
"""
"""srun without its options: the command runs here."""

NOTE = """#!/bin/bash
echo "$@" >> notes
exit ${EXIT_CODE:-0}
"""
"""A program that writes its arguments to a file."""

FASTPIN = f"""#!/bin/bash
exec {sys.executable} -m fastpin "$@"
"""

PLAN = "[grid]\ncontact.friction = [0.3, 0.5]\nsolve.nodes = [31]\n"

CASE = """[pin]
material = "steel"
[plate]
material = "aluminium"
[contact]
load_parameter = 0.1
friction = 0.4
[[load]]
P = 1.0
[[load]]
Q = [0.1, -0.1]
[solve]
nodes = 31
"""


def job(
    tmp_path: Path, name: str, arguments: Sequence[str], task: int, programs: dict[str, str], **variables: str
) -> subprocess.CompletedProcess[str]:
    """Run a job file as a task of an array, with these programs before all others."""
    folder = tmp_path / "bin"
    folder.mkdir(exist_ok=True)
    for program, text in {"srun": SRUN, "scontrol": NOTE, **programs}.items():
        (folder / program).write_text(text, encoding="utf-8")
        (folder / program).chmod(stat.S_IRWXU)
    slurm = {"SLURM_ARRAY_JOB_ID": "7", "SLURM_ARRAY_TASK_ID": str(task), "SLURM_CPUS_PER_TASK": "1"}
    environment = os.environ | slurm | variables | {"PATH": f"{folder}{os.pathsep}{os.environ['PATH']}"}
    return finished(["bash", RECIPES / name, *arguments], cwd=tmp_path, env=environment, check=False)


def test_the_page_shows_the_recipes() -> None:
    assert texts("cluster.md", "bash", "python") == [
        (RECIPES / name).read_text(encoding="utf-8") for name in (*JOBS, "Snakefile")
    ]


def test_the_command_lines_of_all_recipes_exist() -> None:
    """With 1 in place of the values that the shell and Snakemake fill in."""
    found = []
    for path in sorted(RECIPES.iterdir()):
        text = path.read_text(encoding="utf-8").replace("\\\n", " ").replace('"\n        "', "")
        found += re.findall(r"(?:srun (?:--\S+ )?|[\"&] ?|then |else )fastpin ([^&;\n]+)", text)
    assert len(found) == 8
    for command in found:
        words = re.sub(r'"?\$\{?\w+\}?"?|\{[\w.]+\}', "1", command).replace('"', "").replace(",", "").split()
        parser().parse_args(join_words(words))


@pytest.mark.gate
@pytest.mark.parametrize(("code", "requeued"), [(0, False), (1, False), (130, True)])
@pytest.mark.parametrize("name", JOBS)
def test_a_task_that_was_stopped_goes_back_into_the_queue(tmp_path: Path, name: str, code: int, requeued: bool) -> None:
    (tmp_path / "cases.txt").write_text("a.toml\nb.toml\n")
    arguments = ["plan.toml", "8"] if name == "sweep.sbatch" else ["cases.txt"]
    fake = NOTE.replace("notes", "calls")
    (tmp_path / "b.running.h5").write_text("some states")
    programs = {"fastpin": fake, "scontrol": NOTE.replace("EXIT_CODE:-", "NONE:-")}
    done = job(tmp_path, name, arguments, 2, programs, EXIT_CODE=str(code))
    assert done.returncode == code, done.stderr
    assert (tmp_path / "notes").exists() == requeued
    if requeued:
        assert (tmp_path / "notes").read_text() == "requeue 7_2\n"
    expected = {
        "sweep.sbatch": "sweep plan.toml --shard 2/8 --workers 1 -o parts/2\n",
        "cases.sbatch": "resume b.running.h5\n",
    }
    assert (tmp_path / "calls").read_text() == expected[name]


@pytest.mark.gate
def test_a_case_whose_file_is_empty_is_begun_again(tmp_path: Path) -> None:
    (tmp_path / "cases.txt").write_text("a.toml\n")
    (tmp_path / "a.running.h5").touch()
    done = job(tmp_path, "cases.sbatch", ["cases.txt"], 1, {"fastpin": NOTE.replace("notes", "calls")})
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "calls").read_text() == "run a.toml -o a.running.h5 --overwrite\n"
    assert (tmp_path / "a.h5").exists()


@pytest.mark.gate
def test_an_unfinished_case_is_resumed_and_a_finished_one_skipped(tmp_path: Path) -> None:
    case = parse_case(CASE)
    with pytest.raises(Interrupted):
        fastpin.record(
            case.problem, case.history, tmp_path / "a.running.h5", arc=(-3.0, -0.1), nodes=61, progress=StopAt(2.0)
        )
    (tmp_path / "cases.txt").write_text("a.toml\n")
    for said in ("residual", "a.h5 is finished"):
        done = job(tmp_path, "cases.sbatch", ["cases.txt"], 1, {"fastpin": FASTPIN})
        assert done.returncode == 0, done.stderr
        assert said in done.stdout
        assert fastpin.load(tmp_path / "a.h5").complete
    assert sorted(path.name for path in tmp_path.glob("a.*")) == ["a.h5"]


@pytest.mark.skipif(shutil.which("snakemake") is None, reason="snakemake is not installed")
def test_snakemake_plans_all_parts_and_cases(tmp_path: Path) -> None:
    """Slow: Snakemake takes seconds to start."""
    (tmp_path / "cases").mkdir()
    for name in ("plan.toml", "cases/a.toml", "cases/b.toml"):
        (tmp_path / name).touch()
    planned = finished(["snakemake", "-n", "--quiet", "rules", "-s", RECIPES / "Snakefile", "-d", tmp_path])
    counts = dict(re.findall(r"^(\w+) +(\d+)$", planned.stdout + planned.stderr, re.MULTILINE))
    assert counts == {"all": "1", "case": "2", "part": "4", "sweep": "1", "total": "8"}


@pytest.mark.gate
def test_the_parts_of_a_sweep_are_solved_and_joined(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Slow: each task starts two processes."""
    monkeypatch.chdir(tmp_path)
    Path("plan.toml").write_text(PLAN)
    for task in (1, 2):
        done = job(tmp_path, "sweep.sbatch", ["plan.toml", "2"], task, {"fastpin": FASTPIN})
        assert done.returncode == 0, done.stderr
        assert f"1 runs in parts/{task}: 1 done" in done.stdout
    for command in re.findall(r"^fastpin (.*)", "".join(texts("cluster.md", "console")), re.MULTILINE):
        assert main(command.split()) == 0
    assert len(Path("sweep.csv").read_text().splitlines()) == 2 + 1 + 2
