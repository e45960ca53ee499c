"""The page tolerances.md: its plan runs, and prints its numbers."""

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from fastpin.cli.main import main
from fastpin.studies import workers
from scripts.inline import Inline

PAGE = (Path(__file__).resolve().parents[2] / "docs" / "tolerances.md").read_text(encoding="utf-8")


@pytest.mark.survey
def test_the_plan_of_the_page_prints_its_numbers(tmp_path, monkeypatch, capsys):
    def inline(_: object, tasks: list[str], submit: Callable[..., Any], size: int) -> Any:
        for task in tasks:
            yield (task,), submit(Inline(), (task,)).result()

    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(workers, "through_processes", inline)
    case, plan = re.findall(r"```toml\n(.*?)```", PAGE, re.DOTALL)
    Path("lug.toml").write_text(case)
    Path("tolerances.toml").write_text(plan)
    effects, printed = re.findall(r"```text\n(.*?)```", PAGE, re.DOTALL)
    assert main(["tolerances", "tolerances.toml"]) == 0
    out = capsys.readouterr().out
    assert "119 runs in tolerances: 119 done" in out
    assert effects in out
    (code,) = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)
    exec(compile(code, "tolerances.md", "exec"), {"__name__": "__main__"})
    assert capsys.readouterr().out == printed
