"""Outlines of lug files from points and drawings: what is read, what is fitted and said, and what is refused."""

from pathlib import Path

import ezdxf
import numpy as np
import pytest

from fastpin.casefile.lug import LugFile, parse_lug, read_lug
from fastpin.lugs.outline import Hole
from tests.support.faults import faults_of
from tests.support.lugs import mesh_edge

HEAD = """\
[plate]
nu = 0.3
hole_radius = 10e-3
[outline]
file = "{file}"
{keys}
[[part]]
name = "top"
at = [0.0, 0.1]
[[support]]
parts = "top"
"""


@pytest.fixture(autouse=True)
def _in_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def write_points(points: np.ndarray, head: str = "", name: str = "edge.csv") -> None:
    Path(name).write_text(head + "".join(f"{z.real:.4f},{z.imag:.4f}\n" for z in points.tolist()), encoding="utf-8")


def read(file: str = "edge.csv", keys: str = "", more: str = "") -> LugFile:
    return parse_lug(HEAD.format(file=file, keys=keys) + more)


def faults(file: str = "edge.csv", keys: str = "", more: str = "") -> list[tuple[int, str]]:
    return faults_of(read, file, keys, more)


@pytest.mark.parametrize(
    ("head", "keys"),
    [("", 'unit = "mm"'), ("x [mm], y [mm]\n", ""), ("x,y\n", 'unit = "mm"'), ("# mesh\nx,y\nmm,mm\n", "")],
)
def test_points_of_a_mesh_become_lines_and_an_arc(head: str, keys: str) -> None:
    write_points(10.0 * mesh_edge(40), head)
    lug, _, _, notes = read(keys=keys)
    assert [part.name for part in lug.outline] == ["top", "side 2", "side 3", "side 4"]
    assert lug.outline[2].circle is not None
    assert lug.outline[2].circle[:2] == pytest.approx((0j, 22e-3), abs=1e-7)
    assert notes[0] == "112 lines and arcs became 4 parts"
    assert '"side 2": 1 part, [-0.022, 0.1] to [-0.022, 0]' in notes
    assert '"side 3": an arc through 41 points, radius 0.022 about [0, 0], -180 to 0 deg, within 6e-08' in notes


def test_a_clockwise_list_that_ends_where_it_begins_is_the_same() -> None:
    points = 10.0 * mesh_edge(40)
    write_points(np.r_[points, points[:1]][::-1])
    lug = read(keys='unit = "mm"').lug
    assert len(lug.outline) == 4
    assert sum(part.length for part in lug.outline) == pytest.approx(22e-3 * np.pi + 0.244, rel=1e-6)


def test_further_columns_the_origin_and_the_system_of_units() -> None:
    points = 10.0 * mesh_edge(40) + 100.0 + 50j
    rows = [f"{k};{z.real:.4f};{z.imag:.4f};0" for k, z in enumerate(points.tolist())]
    Path("edge.csv").write_text("\n".join(["node;x;y;z", *rows]), encoding="utf-8")
    text = (
        HEAD.format(file="edge.csv", keys="origin = [100.0, 50.0]").replace("10e-3", "10.0").replace("0.1]", "100.0]")
    )
    lug, _, _, notes = parse_lug('units = "mm, N, MPa"\n' + text)
    assert lug.hole_radius == pytest.approx(10e-3)
    assert [part.name for part in lug.outline] == ["top", "side 2", "side 3", "side 4"]
    assert '"side 3": an arc through 41 points, radius 22 about [0, 0], -180 to 0 deg, within 6e-05' in notes


def test_a_polyline_stays_one_and_is_marked() -> None:
    write_points(10.0 * mesh_edge(24))
    lug, _, _, notes = read(keys='unit = "mm"\ntolerance = 0')
    assert len(lug.outline) == 96
    assert {part.name for part in lug.outline} == {"top", "side 2"}
    assert notes[-1].startswith(
        "25 corners turn by at most 7.5 deg, and no arc fits: the stress on such sides is that of"
    )


def test_the_folder_of_the_lug_file_counts(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write_points(10.0 * mesh_edge(40))
    Path("lug.toml").write_text(HEAD.format(file="edge.csv", keys='unit = "mm"'), encoding="utf-8")
    monkeypatch.chdir(Path("/"))
    assert len(read_lug(tmp_path / "lug.toml").lug.outline) == 4


def draw(name: str = "plate.dxf", layers: tuple[str, str] = ("PLATE", "PLATE"), unit: int = 4) -> None:
    """A lug with its pin's hole and a bolt hole, and its top on a layer of its own."""
    document = ezdxf.new(units=unit)
    space = document.modelspace()
    side, top = ({"layer": layer} for layer in layers)
    space.add_lwpolyline([(-22, 100), (-22, 0, 1.0), (22, 0), (22, 100)], format="xyb", dxfattribs=side)
    space.add_line((22, 100), (-22, 100), dxfattribs=top)
    space.add_circle((0, 0), 10, dxfattribs=side)
    space.add_circle((0, 40), 5, dxfattribs={"layer": "BOLT"})
    document.saveas(name)


BOLT = '[[hole]]\nname = "bolt"\ncentre = [0, 40e-3]\nradius = 5e-3\n'


def test_a_drawing_with_its_holes() -> None:
    draw()
    lug = read("plate.dxf", more=BOLT).lug
    assert [part.name for part in lug.outline] == ["side 1", "top", "side 3", "side 4"]
    assert lug.holes == (Hole("bolt", 0.04j, 5e-3),)
    assert len(read("plate.dxf", 'layer = "PLATE"').lug.holes) == 0


def test_layers_name_the_sides() -> None:
    draw(layers=("SIDES", "END"))
    text = HEAD.format(file="plate.dxf", keys='layer = ["SIDES", "END"]')
    lug = parse_lug(text[: text.index("[[part]]")] + '[[support]]\nparts = "END"\n').lug
    assert {part.name for part in lug.outline} == {"SIDES", "END"}


@pytest.mark.parametrize(
    ("keys", "line", "message"),
    [
        ("", 5, "file: plate.dxf: has a further loop of radius 0.005 about [0, 0.04]; name it by a block [[hole]]"),
        ('layer = "BOLT"', 5, "file: plate.dxf: no loop goes round the pin's hole at [0, 0]; origin is its centre"),
        ('layer = "TIP"', 6, 'layer: has no lines or arcs; the layers are "BOLT", "PLATE"'),
        ('unit = "ells"', 6, 'unit: a length must be in m, mm, um, nm, in or mil, not "ells"'),
        ('layer = "PLATE"\norigin = [1, 2]', 5, "file: plate.dxf: no loop goes round the pin's hole at [1, 2]"),
        ("x = [1, 2]", 6, "x: can't be given together with file"),
        ("tolerance = -1", 6, "tolerance: must lie between 0 and 0.0001, not -1"),
    ],
)  # fmt: skip
def test_faults_of_a_drawing(keys: str, line: int, message: str) -> None:
    draw()
    assert any(at == line and text.startswith(message) for at, text in faults("plate.dxf", keys)), faults(
        "plate.dxf", keys
    )


def test_faults_of_points() -> None:
    write_points(10.0 * np.random.default_rng(0).permutation(mesh_edge(40)))
    (fault,) = [text for _, text in faults(keys='unit = "mm"') if text.startswith("file")]
    assert fault.startswith("file: edge.csv: crosses itself near [")
    assert fault.endswith("]; the points must follow one another along the edge")
    write_points(mesh_edge(40), "a,b\n")
    assert (5, "file: edge.csv, line 1: the header must name the columns x and y; without a header they are the first "
            "two") in faults()  # fmt: skip
    write_points(mesh_edge(40)[:2])
    assert (5, "file: edge.csv: an outline has at least 3 points, not 2") in faults()
    write_points(10.0 * mesh_edge(40), "x (in), y (in)\n")
    assert any(
        "the unit is mm, and the header has in; give one of them" in text for _, text in faults(keys='unit = "mm"')
    )
    assert (5, "file: no.csv: there is no such file") in faults("no.csv")
    assert (6, "layer: is for a DXF file only") in faults(keys='layer = "A"')


@pytest.mark.parametrize(
    ("at", "message"),
    [
        ("[0.0, 0.09]", "at: the outline is 0.01 m away from this point"),
        ("[-22e-3, 0.1]", 'at: "side 1" and "side 2" meet here; give a point inside of one'),
        ("3", "at: must be a point [x, y], not 3"),
    ],
)
def test_faults_of_named_sides(at: str, message: str) -> None:
    write_points(10.0 * mesh_edge(40))
    text = HEAD.format(file="edge.csv", keys='unit = "mm"').replace("[0.0, 0.1]", at)
    assert (9, message) in faults_of(parse_lug, text)


def test_an_svg_file_needs_a_unit() -> None:
    text = '<svg><path d="M-22,0 A22,22 0 0 0 22,0 V-100 H-22 Z"/><circle r="10"/></svg>'
    Path("plate.svg").write_text(text, encoding="utf-8")
    assert any("unit: is missing, and the drawing says none" in text for _, text in faults("plate.svg"))
    assert [part.name for part in read("plate.svg", 'unit = "mm"').lug.outline] == ["side 1", "top", "side 3", "side 4"]


def test_keys_of_a_file_need_one() -> None:
    text = HEAD.replace('file = "{file}"\n{keys}', "start = [0, 0]\nunit = 3")
    found = faults_of(parse_lug, text)
    assert (6, "unit: is for a file of the outline only") in found
    assert (9, "at: is for a file of the outline only; a part ends at `to`") in found
