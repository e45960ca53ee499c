"""``fastpin compliance``: the file, the report, the figure and wrong input."""

from pathlib import Path

import numpy as np
import pytest

from fastpin.bodies.compliance import Compliance
from fastpin.casefile.lug import LUG_EXAMPLE
from fastpin.cli import compliance
from tests.support.commands import printed, refused, said
from tests.support.lugs import make_coarse

TEXT = """\
title = "a small plate"
[plate]
nu = 0.3
hole_radius = 1.0
[outline]
shape = "rectangle"
x = [-5.0, 5.0]
y = [-5.0, 5.0]
[[support]]
parts = "top"
[[load]]
name = "syy"
parts = "bottom"
normal = 1.0
[solve]
harmonics = 6
"""


@pytest.fixture
def lug(monkeypatch: pytest.MonkeyPatch) -> Path:
    make_coarse(monkeypatch)
    path = Path("small.toml")
    path.write_text(TEXT, encoding="utf-8")
    return path


def test_the_example_is_printed() -> None:
    assert printed("compliance", "--example") == LUG_EXAMPLE


@pytest.mark.gate
def test_a_file_a_figure_and_a_report(lug, monkeypatch):
    monkeypatch.setattr(compliance, "DOUBTFUL", 1e-2)  # the nodes are few here
    out, err = said("compliance", lug, "--plot", "small.svg")
    found = Compliance.from_file("small.json")
    assert (found.order, found.nu, found.hole_radius, list(found.columns)) == (6, 0.3, 1.0, ["syy", "temperature"])
    assert "a small plate" in found.made_by
    assert "bottom" in Path("small.svg").read_text(encoding="utf-8")
    assert [line.split("  ")[0] for line in out.splitlines()[:-1]] == [
        "harmonics", "last harmonic", "symmetry error", "estimated error", "nodes", "loads",
    ]  # fmt: skip
    assert out.endswith("wrote small.json and small.svg\n")
    assert err == ""


@pytest.mark.gate
def test_the_report_says_what_became_an_arc(lug):
    angles = np.linspace(0.0, 2.0 * np.pi, 41)[:-1]
    Path("edge.csv").write_text("".join(f"{5 * np.cos(t)},{5 * np.sin(t)}\n" for t in angles), encoding="utf-8")
    start, stop = TEXT.index("shape"), TEXT.index("[[support]]")
    text = TEXT[:start] + 'file = "edge.csv"\n' + TEXT[stop:].split("[[load]]")[0] + "[solve]\nharmonics = 4\n"
    lug.write_text(text.replace('"top"', '"side 1"'), encoding="utf-8")
    out = said("compliance", lug).out.splitlines()
    assert out[0] == "outline          40 lines and arcs became 2 parts"
    assert sum("an arc through" in line and "radius 5 about [0, 0]" in line for line in out) == 2


@pytest.mark.gate
def test_the_same_file_gives_the_same_bits(lug: Path) -> None:
    for output in ("a.json", "b.json"):
        said("compliance", lug, "-o", output)
    assert Path("a.json").read_bytes() == Path("b.json").read_bytes()


@pytest.mark.gate
def test_a_doubtful_result_has_a_note(lug, monkeypatch):
    monkeypatch.setattr(compliance, "DOUBTFUL", 1e-12)
    assert said("compliance", lug).err.startswith("note: the estimated error is above 1e-12")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ([], "fastpin: lug: the lug file is missing; start with: fastpin compliance --example > lug.toml"),
        (
            ["small.toml", "-o", "other.toml"],
            "fastpin: --output: won't overwrite other.toml: by its name it is a case file or plan",
        ),
        (
            ["small.toml", "--plot", "lug.doc"],
            "fastpin: --plot: must be the name of a figure, which ends in .png, .pdf or .svg",
        ),
        (["small.toml", "-o", "no/where.json"], "fastpin: --output: no/where.json: the directory no does not exist"),
        (["no.toml"], "no.toml: there is no such file"),
    ],
)
@pytest.mark.usefixtures("lug")
def test_wrong_arguments(arguments: list[str], message: str) -> None:
    assert refused("compliance", *arguments).startswith(message)


def test_a_fault_names_its_line(lug: Path) -> None:
    lug.write_text(TEXT.replace('"top"', '"tip"'), encoding="utf-8")
    assert refused("compliance", lug).startswith(f'{lug}, line 10: parts: no part or hole is called "tip"')


@pytest.mark.gate
def test_too_few_harmonics_name_the_file(lug: Path) -> None:
    lug.write_text(TEXT.replace("= 6", "= 2").replace("5.0", "1.5"), encoding="utf-8")
    assert refused("compliance", lug).startswith(f"{lug}: harmonics: its last harmonic 2 is ")
