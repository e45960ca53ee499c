"""Wrong values, of which Python, case files, plans and the command line say the same."""

from collections.abc import Callable
from pathlib import Path

from fastpin.casefile import parse_case
from fastpin.studies import parse_plan
from tests.support import commands
from tests.support.faults import fault_of
from tests.support.refusals import refused


def one_sentence(
    make: Callable[[], object], section: str, text: str, base: str, fields: str, folder: Path
) -> tuple[int, str]:
    """The line and the sentence of a wrong case: those of its text, in one section.

    Python, by `make`, ``fastpin check``, and a plan that gives the case `base` these fields say the same.
    """
    line, words = fault_of(parse_case, text, folder=folder)
    assert refused(make).reason == words.partition(": ")[2]
    (folder / "case.toml").write_text(text)
    assert commands.refused("check", folder / "case.toml").rstrip().endswith(f"line {line}: {words}")
    (folder / "base.toml").write_text(base)
    planned = fault_of(parse_plan, f'case = "base.toml"\n{fields}', folder=folder)
    assert planned[1] == f"{section}.{words}"
    return line, words
