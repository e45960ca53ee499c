"""The scripts, with a Python that only records what it is asked to do."""

import os
import re
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from tests.support.processes import finished, started

pytestmark = pytest.mark.gate

ROOT = Path(__file__).resolve().parents[2]

# Stands for Python, for the Python of the environment and for apt-get. What it was called with goes to $LOG. An
# installation takes $INSTALLS seconds.
FAKE = """#!/bin/bash
[[ $0 == */apt-get ]] && { echo "apt-get $*" >>"$LOG"; touch "$HERE/has-ensurepip"; exit 0; }
case "$1 $2" in
"-c import ensurepip"*) [[ -e $HERE/has-ensurepip ]]; exit ;;
"-c import sys; print"*) echo python3.11-venv; exit ;;
"-c import sys; sys.exit"*) [[ ! -e $HERE/too-old ]]; exit ;;
"-c "*) exit 0 ;;
"- "*) # a script from the standard input: the versions that Numba names, or the kernels that OpenBLAS takes
    read -r first; [[ $first == *metadata ]] && { echo 11 12; exit; }
    case ${OPENBLAS_CORETYPE-} in Prescott) echo Katmai ;; SkylakeX) kill -ILL $$ ;; *) echo Haswell ;; esac; exit ;;
"-m venv") mkdir -p "$4/bin" && cp "$0" "$4/bin/python"; echo "venv" >>"$LOG"; exit ;;
"-m pip") [[ $3 == --version ]] && exit 0
    [[ -e $HERE/offline ]] && { echo "no network" >&2; exit 1; }
    sleep "${INSTALLS:-0}"; echo "pip ${!#}" >>"$LOG"; exit ;;
esac
echo "$PWD> $*" >>"$LOG"
for word; do # results of tests
    [[ $word != --junitxml=* ]] || echo '<testsuite errors="1" failures="2" skipped="3" tests="16">' >"${word#*=}"
done
[[ -z $FAIL ]] || exit "$FAIL"
"""


@pytest.fixture
def project(tmp_path: Path) -> Path:
    """A copy of the scripts in a directory with a space, beside a directory of fake commands."""
    root = tmp_path / "a b" / "fastpin"
    shutil.copytree(ROOT / "scripts", root / "scripts", ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copy(ROOT / "pyproject.toml", root)
    commands = tmp_path / "bin"
    commands.mkdir()
    (tmp_path / "has-ensurepip").touch()
    for name in ("python3.11", "python3", "apt-get"):
        (commands / name).write_text(FAKE)
        (commands / name).chmod(0o755)
    return root


def environment(project: Path, **more: str) -> dict[str, str]:
    here = project.parents[1]
    path = f"{here / 'bin'}:/usr/bin:/bin"
    return {"PATH": path, "LOG": str(here / "log"), "HERE": str(here), "HOME": str(here), "FAIL": "", **more}


def run(project: Path, script: str, *arguments: str, **more: str) -> subprocess.CompletedProcess[str]:
    command = [project / "scripts" / script, *arguments]
    return finished(command, cwd="/", env=environment(project, **more), check=False)


def log(project: Path) -> list[str]:
    file = project.parents[1] / "log"
    lines = file.read_text().splitlines() if file.exists() else []
    file.unlink(missing_ok=True)
    return lines


@pytest.mark.parametrize(
    "name",
    [
        "scripts/run",
        "scripts/test",
        "scripts/docs",
        "scripts/oldest-versions",
        "scripts/other-machines",
        "scripts/test-files",
        ".ci/run",
    ],
)
def test_scripts_can_be_run_and_parsed(name: str) -> None:
    assert os.access(ROOT / name, os.X_OK)
    finished(["bash", "-n", ROOT / name])
    finished(["bash", "-n", ROOT / "scripts" / "environment.sh"])


def test_environment_is_made_once_and_again_when_the_dependencies_change(project: Path) -> None:
    first = run(project, "run", "case.toml", "--nodes", "9")
    assert first.returncode == 0, first.stderr
    compiled = [f"/> -m compileall -q {project}/fastpin", "/> -P -m fastpin run"]
    assert log(project) == ["venv", f"pip {project}", *compiled, "/> -P -m fastpin run case.toml --nodes 9"]
    assert run(project, "run", "case.toml").stderr == ""
    assert log(project) == ["/> -P -m fastpin run case.toml"]
    with (project / "pyproject.toml").open("a") as file:
        file.write("\n# changed\n")
    run(project, "run", "case.toml")
    assert log(project)[:-1] == [f"pip {project}", *compiled]


def test_tests_need_the_tools_of_development_and_run_at_home(project: Path) -> None:
    run(project, "run", "x")
    log(project)
    assert run(project, "test", "-k", "a b").returncode == 0
    tests = f"{project}> -m pytest -n auto --dist worksteal -k a b"
    found = log(project)
    assert (found[0], found[-1]) == (f"pip {project}[dev]", tests)
    run(project, "run", "x")
    assert log(project) == ["/> -P -m fastpin run x"]


def test_the_site_needs_its_own_tools(project: Path) -> None:
    (project / "docs" / "examples").mkdir(parents=True)
    assert run(project, "docs", "--fresh", "-E").stdout == f"site: {project}/out/docs/index.html\n"
    found = log(project)
    assert (found[0], found[1]) == ("venv", f"pip {project}[docs]")
    assert found[-1] == f"{project}> -m sphinx -b html -W --keep-going -q -d out/docs/.doctrees -E docs out/docs"
    assert not (project / "docs" / "examples").exists()


def test_the_environment_of_the_site_can_be_made_alone(project: Path) -> None:
    done = run(project, "docs", "--prepare")
    assert (done.returncode, done.stdout) == (0, "")
    assert f"pip {project}[docs]" in log(project)
    assert run(project, "docs", "--prepare").returncode == 0
    assert log(project) == []


def test_without_arguments_the_built_in_case_with_its_figure(project: Path) -> None:
    done = run(project, "run")
    assert log(project)[-1].endswith(f"--plot {project}/out/tractions.png --json {project}/out/summary.json")
    assert (project / "out").is_dir()
    assert "out/tractions.png" in done.stdout


@pytest.mark.parametrize(("script", "arguments"), [("run", ()), ("run", ("x",)), ("test", ()), ("docs", ())])
def test_exit_codes_come_through(script: str, arguments: tuple[str, ...], project: Path) -> None:
    assert run(project, script, *arguments, FAIL="7").returncode == 7


def test_called_through_a_link(project: Path) -> None:
    link = project.parents[1] / "fp"
    link.symlink_to(project / "scripts" / "run")
    finished([link, "x"], env=environment(project))


def test_two_at_once_install_once(project: Path) -> None:
    command, slow = [project / "scripts" / "run", "x"], environment(project, INSTALLS="0.2")
    with started(command, env=slow) as one, started(command, env=slow) as other:
        assert (one.wait(), other.wait()) == (0, 0)
    assert sorted(line.split()[0] for line in log(project)).count("pip") == 1


@pytest.mark.parametrize(
    "failing", ["", "ruff check", "--prepare", "test --gate -m", "-n 0", "check-package", "--fresh"]
)
def test_the_gate_passes_if_all_of_its_commands_do(failing: str, project: Path) -> None:
    """Some commands run beside others, and those that are left are ended."""
    command = '#!/bin/bash\n[[ -z $FAIL || "${0##*/} $*" != *"$FAIL"* ]] || exit 7\n'
    parts = {
        project / "scripts": ("test", "docs", "check-package", "other-machines"),
        project / ".venv" / "bin": ("ruff", "mypy", "python"),
        project.parents[1] / "bin": ("chromium", "chromedriver"),
    }
    for folder, names in parts.items():
        folder.mkdir(parents=True, exist_ok=True)
        for name in names:
            (folder / name).write_text(command)
            (folder / name).chmod(0o755)
    shutil.copytree(ROOT / ".ci", project / ".ci")
    done = finished([project / ".ci" / "run"], env=environment(project, FAIL=failing), check=False)
    assert (done.returncode, done.stderr) == (7 if failing else 0, "")
    assert ("all checks passed" in done.stdout) == (not failing)


def test_too_old_a_python_is_refused_in_one_sentence(project: Path) -> None:
    (project.parents[1] / "too-old").touch()
    done = run(project, "run")
    assert done.returncode == 1
    assert done.stderr == (
        "fastpin: Python 3.11 or later is needed: apt-get install python3 python3-venv, or set PYTHON.\n"
    )
    done = run(project, "run", PYTHON="python3.11")
    assert done.stderr == "fastpin: PYTHON=python3.11 is not a Python of version 3.11 or later.\n"
    assert log(project) == []


def test_missing_venv_package(project: Path) -> None:
    (project.parents[1] / "has-ensurepip").unlink()
    done = run(project, "run", "x")
    if os.geteuid() == 0:  # root may install it
        assert done.returncode == 0, done.stderr
        assert log(project)[:2] == ["apt-get update -qq", "apt-get install -y -qq python3.11-venv"]
    else:
        assert done.returncode == 1
        assert "apt-get install python3-venv" in done.stderr
        assert log(project) == []


def test_a_failed_installation_shows_why_and_is_tried_again(project: Path) -> None:
    (project.parents[1] / "offline").touch()
    done = run(project, "run", "x")
    assert done.returncode == 1
    assert "no network" in done.stderr
    (project.parents[1] / "offline").unlink()
    log(project)
    assert run(project, "run", "x").returncode == 0
    assert log(project)[0] == f"pip {project}"


def test_the_oldest_versions_are_the_lower_bounds() -> None:
    done = finished([ROOT / "scripts" / "oldest-versions", "--list"], env={**os.environ, "PYTHON": sys.executable})
    listed = dict(line.split("==") for line in done.stdout.splitlines())
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    extras = project["optional-dependencies"].values()
    for requirement in (*project["dependencies"], *(entry for extra in extras for entry in extra)):
        name, bound = re.split(r"(?:\[\w+\])?>=", requirement)
        version = listed[name].removesuffix(".*").split(".")
        least = bound.split(".")
        assert version[: len(least)] == least
        assert listed[name].endswith(".*") == (len(version) == 2)


def test_the_environment_of_the_oldest_versions_is_made_once(project: Path) -> None:
    first = run(project, "oldest-versions", "tests/model")
    assert first.returncode == 0, first.stderr
    found = log(project)
    assert [line for line in found if line in ("venv", f"pip {project}[dev]")] == ["venv", f"pip {project}[dev]"]
    tests = f"{project}> -m pytest -n auto -W ignore::DeprecationWarning tests/model"
    assert found[-1] == tests
    assert (project / ".venv-oldest" / "constraints.txt").exists()
    run(project, "oldest-versions", "tests/model")
    assert "venv" not in log(project)


def test_other_machines_skip_what_does_not_run_and_count_the_rest(project: Path) -> None:
    """Here OpenBLAS knows Prescott, by the name Katmai, and Haswell; the kernels of SkylakeX end in a signal."""
    chosen = "--types", "Prescott,Zen,SkylakeX,Haswell", "--pythons", "3.11,3.12,3.99"
    done = run(project, "other-machines", *chosen, "tests/model", "-x")
    assert done.returncode == 0, done.stderr
    rows = [line.split(maxsplit=1) for line in done.stdout.splitlines()[-8:]]
    assert [row[0] for row in rows] == ["name", "Prescott", "Zen", "SkylakeX", "Haswell", "Python", "Python", "Python"]
    assert rows[1][1].split()[:2] == rows[4][1].split()[:2] == ["10", "3"]
    assert rows[2][1] == "skipped: OpenBLAS takes Haswell instead."
    assert rows[3][1] == "skipped: this processor can't run its kernels."
    assert rows[7][1] == "3.99    skipped: Numba names no such version."
    tests = [line for line in log(project) if "-m pytest" in line]
    assert len(tests) == 4
    assert all(line.endswith("tests/model -x") for line in tests)


def test_other_machines_leave_out_the_kernels_of_this_one(project: Path) -> None:
    done = run(project, "other-machines", "--types", "Prescott,Haswell,-own", "--list")
    assert done.stdout.splitlines()[-2:] == [
        "Prescott       ",
        "Haswell        skipped: the machine takes these kernels anyway.",
    ]


def test_other_machines_fail_where_a_run_fails(project: Path) -> None:
    done = run(project, "other-machines", "--types", "Prescott", FAIL="3")
    assert (done.returncode, len(log(project))) == (1, 5)
    assert done.stdout.splitlines()[-1].split()[:3] == ["Prescott", "10", "3"]
