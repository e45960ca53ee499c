"""Completion in shells."""

import shutil
import sys
from pathlib import Path

import pytest

from fastpin.cli.main import main
from fastpin.cli.options import SHELLS
from tests.support.commands import printed, refused
from tests.support.processes import finished

COMPLETE = r"""
source "$1"; shift
name=$(complete -p fastpin | sed 's/.*-F \([^ ]*\).*/\1/')
COMP_WORDS=(fastpin "$@") COMP_CWORD=$#
"$name" fastpin "${COMP_WORDS[COMP_CWORD]}"
printf '%s\n' "${COMPREPLY[@]}"
"""


@pytest.mark.gate
@pytest.mark.parametrize("shell", SHELLS)
def test_each_shell_has_a_script(shell: str) -> None:
    script = printed("completion", shell)
    long = "error-bars" if shell == "fish" else "--error-bars"
    assert long in script or shell == "tcsh"
    Path("script").write_text(script)
    if shutil.which(shell):
        assert finished([shell, "-n", "script"], cwd=".").stderr == ""


@pytest.mark.gate
@pytest.mark.skipif(shutil.which("bash") is None, reason="there is no bash")
def test_bash_completes_commands_options_choices_and_files() -> None:
    Path("script").write_text(printed("completion", "bash"))
    Path("case.toml").write_text("")

    def completed(*words: str) -> list[str]:
        return finished(["bash", "-c", COMPLETE, "bash", "./script", *words], cwd=".").stdout.split()

    assert completed("sw") == ["sweep"]
    assert completed("run", "--nod") == ["--nodes"]
    assert completed("plot", "a.h5", "hoo") == ["hoop"]
    assert completed("check", "ca") == ["case.toml"]


def test_a_missing_package_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "shtab", None)
    sentence = "completion: needs the package shtab: pip install 'fastpin[completion]'"
    assert refused("completion", "bash") == f"fastpin: {sentence}\n"


def test_an_unknown_shell_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main(["completion", "powershell"])
    assert 'shell: must be bash, zsh, fish or tcsh, not "powershell"' in capsys.readouterr().err
