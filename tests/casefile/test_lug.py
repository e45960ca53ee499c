"""Lug files: what is read, and that every fault is reported with its line."""

from pathlib import Path

import pytest

from fastpin import MATERIALS, CaseFileError, InputError
from fastpin.casefile.lug import LUG_EXAMPLE, LUG_KEYS, parse_lug, read_lug
from fastpin.lugs.outline import Hole, Lug, PartLoad, rectangle
from tests.support.faults import faults_of

GOOD = """\
title = "a plate"
[plate]
nu = 0.3
hole_radius = 0.01
[outline]
shape = "rectangle"
x = [-0.03, 0.03]
y = [-0.02, 0.05]
[[support]]
parts = "top"
[[hole]]
name = "bolt"
centre = [0.0, 0.03]
radius = 0.004
[[load]]
name = "syy"
parts = ["bottom", "bolt"]
normal = 2.0
[solve]
harmonics = 9
"""


def faults(text: str) -> list[tuple[int, str]]:
    return faults_of(parse_lug, text)


PARTS = """\
[plate]
nu = 0.3
hole_radius = 1
[outline]
start = [-3, -3]
[[part]]
name = "bottom"
to = [3, -3]
[[part]]
name = "right"
to = [3, 3]
[[part]]
name = "arch"
to = [-3, 3]
through = [0, 5]
[[part]]
name = "left"
to = [-3, -3]
[[support]]
parts = ["left"]
"""


def replaced(line: str, by: str) -> str:
    assert line in GOOD
    return GOOD.replace(line, by)


def test_a_file_is_read() -> None:
    lug, title, harmonics, _ = parse_lug(GOOD)
    assert (title, harmonics, lug.nu, lug.plane, lug.hole_radius) == ("a plate", 9, 0.3, "strain", 0.01)
    assert lug.outline == rectangle((-0.03, 0.03), (-0.02, 0.05))
    assert lug.supports == {"top": "both"}
    assert lug.holes == (Hole("bolt", 0.03j, 0.004),)
    assert lug.loads == (PartLoad("syy", ("bottom", "bolt"), normal=2.0),)


def test_the_net_section_is_kept_with_the_outline() -> None:
    lug = parse_lug(replaced("nu = 0.3", "nu = 0.3\nnet_section = 0.04")).lug
    assert lug.net_section == 0.04
    assert Lug.from_document(lug.document(), lug.nu, lug.plane, lug.hole_radius) == lug
    assert "net_section" not in parse_lug(GOOD).lug.document()
    assert any(
        text.startswith("net_section: must be positive, not -1")
        for _, text in faults(replaced("nu = 0.3", "nu = 0.3\nnet_section = -1"))
    )


def test_the_example_is_a_lug_with_a_round_end() -> None:
    lug, title, harmonics, notes = parse_lug(LUG_EXAMPLE)
    assert notes == ()
    assert title == "lug with a round end"
    assert harmonics is None
    assert lug.nu == MATERIALS["aluminium"].nu
    centre, radius, _, _ = lug.outline[0].circle or (1.0, 0.0, 0.0, 0.0)
    assert abs(centre) < 1e-15
    assert radius == pytest.approx(25e-3)
    assert [part.name for part in lug.outline] == ["round end", "right side", "top", "left side"]


def test_every_commented_block_of_the_example_is_valid() -> None:
    lines = LUG_EXAMPLE.split("\n")
    wanted = ("# [[load]]", '# name = "sxx"', '# parts = ["left', "# normal", "# [[hole]]", '# name = "bolt"')
    wanted += ("# centre", "# radius", "# [solve]", "# harmonics")
    opened = [line[2:] if line.startswith(wanted) else line for line in lines]
    assert sum(new != old for new, old in zip(opened, lines, strict=True)) == len(wanted)
    found = parse_lug("\n".join(opened))
    assert found.harmonics == 12
    assert [load.name for load in found.lug.loads] == ["sxx"]
    assert [hole.name for hole in found.lug.holes] == ["bolt"]


def test_the_example_names_every_key() -> None:
    for section, keys in LUG_KEYS.items():
        assert f"[{section}]" in LUG_EXAMPLE
        for key in keys:
            assert f"{key} " in LUG_EXAMPLE or f" {key}" in LUG_EXAMPLE, key


@pytest.mark.parametrize(
    ("text", "line", "message"),
    [
        (replaced("nu = 0.3", "nu = 0.7"), 3, "nu: must lie between 0 and 0.5, not 0.7"),
        (replaced("nu = 0.3", "n = 0.3"), 3, 'unknown key "n" in [plate], did you mean "nu"?'),
        (replaced("nu = 0.3\n", ""), 2, "[plate]: nu is missing; give nu or material"),
        (replaced("nu = 0.3", 'nu = 0.3\nmaterial = "steel"'), 3, "[plate]: nu can't be given together with material"),
        (replaced("hole_radius = 0.01", "hole_radius = -1"), 4, "hole_radius: must lie between 1e-30 and 1e+30"),
        (replaced('"rectangle"', '"round"'), 6, 'shape: must be "parts" or "rectangle", not "round"'),
        (replaced("x = [-0.03, 0.03]", "x = 0.03"), 7, "x: must be two numbers [lower, upper], not 0.03"),
        (replaced("[-0.03, 0.03]", "[0.03, -0.03]"), 7, "x: its first number must be below its second"),
        (replaced("y = [-0.02, 0.05]\n", ""), 5, "[outline]: y is missing"),
        (replaced("x = [", "start = [0, 0]\nx = ["), 7, "start: has no meaning for a rectangle"),
        (replaced('parts = "top"', 'parts = "tip"'), 10, 'parts: no part or hole is called "tip"; the names are'),
        (replaced('parts = "top"', "parts = []"), 10, "parts: must name at least one part"),
        (replaced('parts = "top"', "parts = 3"), 10, "parts: must be text in quotes, not 3"),
        (replaced('parts = "top"', 'parts = "top"\nhold = "all"'), 11, 'hold: must be "both", "x"'),
        (replaced('parts = "top"', 'parts = ["top", "top"]'), 10, 'parts: "top" has a support already'),
        (replaced('parts = "top"', 'parts = "top"\nhold = "x"'), 9, "support: the supports leave a rigid motion"),
        (replaced("centre = [0.0, 0.03]", "centre = [0.0, 3]"), 11, 'holes: the hole "bolt" does not lie inside'),
        (replaced("radius = 0.004", "radius = 0.03"), 11, 'holes: the hole "bolt" must keep 0.01 hole radii from'),
        (replaced('name = "syy"', 'name = "P"'), 16, 'name: must be "sxx", "syy" or "sxy", not "P"'),
        (replaced("normal = 2.0\n", ""), 15, "[[load]]: has no traction; give x, y or normal"),
        (replaced('["bottom", "bolt"]', '"top"'), 18, 'normal: the support of "top" takes up this component'),
        (replaced("harmonics = 9", "harmonics = 1"), 20, "harmonics: must be a whole number from 2 to 200, not 1"),
        (replaced("[solve]", "[solver]"), 19, 'unknown section [solver], did you mean "solve"?'),
        (replaced("[plate]", "[[plate]]"), 2, "plate: must be a section [plate], not"),
        (GOOD + "[[part]]\nname = 'a'\n", 21, "[[part]]: has no meaning for a rectangle"),
        ("hole = 3\n" + GOOD.replace("[[hole]]", "[[holes]]"), 1, "hole: must be a section [[hole]], not 3"),
        (PARTS[: PARTS.index("[[part]]")], 4, "[outline]: [[part]] blocks are missing"),
    ],
    ids=lambda value: value if isinstance(value, str) and "\n" not in value else "",
)  # fmt: skip
def test_a_fault_is_reported_on_its_line(text: str, line: int, message: str) -> None:
    assert any(found == line and sentence.startswith(message) for found, sentence in faults(text)), faults(text)


def test_parts_follow_one_another() -> None:
    outline = parse_lug(PARTS).lug.outline
    assert [part.start for part in outline] == [-3 - 3j, 3 - 3j, 3 + 3j, -3 + 3j]
    assert outline[2].through == 5j


@pytest.mark.parametrize(
    ("old", "new", "line", "message"),
    [
        (
            "to = [-3, -3]",
            "to = [-3, -2]",
            4,
            'outline: is not closed: "left" ends at [-3, -2], and "bottom" begins at',
        ),
        ("to = [3, 3]", "to = [-4, 0]", 4, "outline: crosses itself near ["),
        (
            "through = [0, 5]",
            "through = [0, 3]",
            4,
            'outline: part "arch" has no shape: its three points lie on a line',
        ),
        ("through = [0, 5]", "through = [0]", 15, "through: must be a point [x, y], not [0]"),
        ("to = [3, 3]\n", "", 9, "[part]: to is missing"),
        ("start = [-3, -3]\n", "", 4, "[outline]: start is missing"),
        ("start = [-3, -3]", "start = [-3, -3]\nx = [1, 2]", 6, 'x: is for shape = "rectangle" only'),
    ],
)
def test_faults_of_parts(old: str, new: str, line: int, message: str) -> None:
    assert old in PARTS
    found = faults(PARTS.replace(old, new))
    assert [(at, text[: len(message)]) for at, text in found] == [(line, message)]


def test_all_faults_are_reported_at_once() -> None:
    text = GOOD.replace("0.3\n", "3\n").replace('"top"', '"tip"').replace("normal", "n").replace("= 9", "= 0")
    assert [line for line, _ in faults(text)] == [3, 10, 15, 18, 20]


def test_missing_sections_are_named() -> None:
    assert faults("title = 'nothing'") == [
        (0, "the section [plate] is missing"),
        (0, "the section [outline] is missing"),
    ]


def test_a_file_that_is_not_there(tmp_path: Path) -> None:
    with pytest.raises(CaseFileError, match=r"no.toml: there is no such file"):
        read_lug(tmp_path / "no.toml")
    with pytest.raises(InputError, match="path: must be the name of a file"):
        read_lug(3)  # type: ignore[arg-type]
