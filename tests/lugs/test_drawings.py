"""Lines and arcs of DXF and SVG files, and the loops that they make."""

import math
import sys
from pathlib import Path

import ezdxf
import numpy as np
import pytest

from fastpin.errors import InputError
from fastpin.lugs.drawings import from_dxf, from_svg, loops, polygon
from fastpin.lugs.outline import Part

LUG = ["arc", "line", "line", "line"]
"""A lug 44 wide and 100 high: its round end, right side, top and left side."""


def words(parts):
    return ["line" if part.through is None else "arc" for part in parts]


def length(parts):
    return sum(part.length for part in parts)


LUG_LENGTH = 22.0 * math.pi + 244.0


def drawing(tmp_path: Path, draw, **header) -> Path:
    document = ezdxf.new(**header)
    draw(document.modelspace())
    path = tmp_path / "plate.dxf"
    document.saveas(path)
    return path


def draw_lines(space):
    """In any order and direction, on two layers."""
    plate, top = {"layer": "PLATE"}, {"layer": "TOP"}
    space.add_line((22, 100), (-22, 100), dxfattribs=top)
    space.add_line((-22, 100), (-22, 0), dxfattribs=plate)
    space.add_arc((0, 0), 22, 180, 360, dxfattribs=plate)
    space.add_line((22, 100), (22, 1e-9), dxfattribs=plate)
    space.add_text("a note")
    space.add_point((3, 3))


def draw_bulges(space):
    space.add_lwpolyline([(-22, 0, 1.0), (22, 0, 0), (22, 100, 0), (-22, 100, 0)], format="xyb", close=True)


def draw_polyline(space):
    space.add_polyline2d([(22, 0, -1.0), (-22, 0, 0), (-22, 100, 0), (22, 100, 0)], format="xyb", close=True)


def draw_block(space):
    block = space.doc.blocks.new("LUG")
    draw_bulges(block)
    space.add_blockref("LUG", (0, 0))


def draw_mirrored(space):
    """From below: x of entities points to the left."""
    space.add_arc((0, 0), 22, 180, 360, dxfattribs={"extrusion": (0, 0, -1)})
    space.add_lwpolyline([(22, 0), (22, 100), (-22, 100), (-22, 0)], dxfattribs={"extrusion": (0, 0, -1)})


@pytest.mark.parametrize("draw", [draw_lines, draw_bulges, draw_polyline, draw_block, draw_mirrored])
def test_the_loop_of_a_dxf_file(draw, tmp_path):
    parts, unit = from_dxf(drawing(tmp_path, draw, units=4))
    (loop,) = loops(parts, 1e-6)
    assert sorted(words(loop)) == LUG
    assert length(loop) == pytest.approx(LUG_LENGTH)
    arc = next(part for part in loop if part.through is not None)
    assert arc.circle[:2] == pytest.approx((0j, 22.0), abs=1e-9)
    assert arc.through == pytest.approx(-22j)
    assert all(loop[k - 1].end == pytest.approx(part.start) for k, part in enumerate(loop))
    assert unit == pytest.approx(1e-3)


def test_layers_are_chosen_and_name_the_parts(tmp_path):
    path = drawing(tmp_path, draw_lines)
    parts, _ = from_dxf(path, ("TOP",))
    assert [part.name for part in parts] == ["TOP"]
    with pytest.raises(InputError, match='layer: has no lines or arcs; the layers are "0", "PLATE", "TOP"'):
        from_dxf(path, ("HOLES",))


def test_a_circle_and_a_drawing_without_a_unit(tmp_path):
    parts, unit = from_dxf(drawing(tmp_path, lambda space: space.add_circle((3, 4), 5), units=0))
    assert unit is None
    assert length(parts) == pytest.approx(10.0 * math.pi)
    assert [part.circle[:2] for part in parts] == [pytest.approx((3 + 4j, 5.0))] * 2


@pytest.mark.parametrize(
    ("draw", "message"),
    [
        (
            lambda space: space.add_spline([(0, 0), (1, 1), (2, 0)]),
            'file: has a curve SPLINE on the layer "0"; save it',
        ),
        (lambda space: space.add_ellipse((0, 0), (2, 0), 0.5), "file: has a curve ELLIPSE"),
        (lambda space: None, "file: has no lines or arcs"),
    ],
)
def test_what_a_dxf_file_may_not_have(draw, message, tmp_path):
    with pytest.raises(InputError, match=message):
        from_dxf(drawing(tmp_path, draw))


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"x, y\n1, 2\n", "file: is no DXF file"),
        (b"  0\nSECTION\nhello\n", "file: can't be read as DXF: Invalid group code"),
        (None, "file: there is no such file"),
    ],
)
def test_a_file_that_is_no_dxf_file(content, message, tmp_path):
    path = tmp_path / "plate.dxf"
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(InputError, match=message):
        from_dxf(path)


def test_a_missing_package_is_named(monkeypatch, tmp_path):
    monkeypatch.setitem(sys.modules, "ezdxf", None)
    with pytest.raises(InputError, match=r"file: a DXF file needs ezdxf: pip install 'fastpin\[dxf\]'"):
        from_dxf(tmp_path / "plate.dxf")


def svg(tmp_path: Path, body: str) -> Path:
    path = tmp_path / "plate.svg"
    path.write_text(f'<svg xmlns="http://www.w3.org/2000/svg"><g>{body}</g></svg>', encoding="utf-8")
    return path


@pytest.mark.parametrize(
    "body",
    [
        '<path d="M-22,0 A22,22 0 0 0 22,0 L22,-100 H-22 Z"/>',
        '<path d="m-22 0a22 22 0 1044 0v-100h-44z"/>',
        '<path d="M 22 0 22 -100 -22 -100 -22 0"/><path d="M22 0A22 22 0 0 1 -22 0"/>',
        '<polyline points="22,0 22,-100 -22,-100 -22,0"/><path d="M-22 0A20 20 0 0 0 22 0"/>',
        '<line x1="22" y1="0" x2="22" y2="-100"/><polyline points="22 -100-22 -100"/>'
        '<line x1="-22" y2="0" x2="-22" y1="-100"/><path d="M-22-0A22,22,0,0,0,22,0"/>',
    ],
)  # fmt: skip
def test_the_loop_of_an_svg_file(body, tmp_path):
    (loop,) = loops(from_svg(svg(tmp_path, body)), 1e-6)
    assert sorted(words(loop)) == LUG
    assert length(loop) == pytest.approx(LUG_LENGTH)
    arc = next(part for part in loop if part.through is not None)
    assert arc.through == pytest.approx(-22j)


@pytest.mark.parametrize(("large", "sweeps"), [(0, 0), (0, 1), (1, 0), (1, 1)])
def test_the_four_arcs_of_svg(large, sweeps, tmp_path):
    """SVG's y points down: an arc that sweeps goes clockwise here. Its end lies 90 deg from its start."""
    (arc,) = from_svg(svg(tmp_path, f'<path d="M1,0 A1,1 0 {large} {sweeps} 0,-1"/>'))
    _, radius, _, sweep = arc.circle
    assert radius == pytest.approx(1.0)
    assert sweep == pytest.approx((1.5 if large else 0.5) * math.pi * (-1.0 if sweeps else 1.0))


def test_a_rectangle_a_polygon_and_a_circle(tmp_path):
    body = '<rect x="-3" y="-4" width="6" height="8"/><polygon points="9,9 10,9 10,10"/><circle cx="20" r="2"/>'
    found = loops(from_svg(svg(tmp_path, body)), 1e-9)
    assert [length(loop) for loop in found] == pytest.approx([28.0, 2.0 + math.sqrt(2.0), 4.0 * math.pi])


@pytest.mark.parametrize(
    ("body", "message"),
    [
        ('<path d="M0,0 C1,1 2,1 3,0"/>', 'file: has a <path> with the curve "C"; save it as lines and arcs'),
        ('<path d="M0,0 A2,1 0 0 0 3,0"/>', "file: has an arc of an ellipse"),
        ('<path d="M0,0 L3"/>', "file: has a <path> that can't be read after"),
        ('<path d="3 4"/>', 'file: has a <path> with the curve ""'),
        ('<rect width="3" height="3" rx="1"/>', "file: has a round <rect>"),
        ('<rect width="3mm" height="3"/>', "file: has a <rect> that can't be read after"),
        ('<ellipse rx="3" ry="2"/>', "file: has a round <ellipse>; save it"),
        ('<g transform="scale(2)"><circle r="3"/></g>', "file: has a transform at <g>; apply it"),
        ("", "file: has no lines or arcs"),
        ("<path", "file: can't be read as SVG"),
    ],
)
def test_what_an_svg_file_may_not_have(body, message, tmp_path):
    with pytest.raises(InputError, match=message):
        from_svg(svg(tmp_path, body))


def test_open_and_branching_loops_have_a_place():
    square = polygon([0j, 4 + 0j, 4 + 4j, 4j])
    with pytest.raises(InputError, match=r"file: a line ends at \[0, 4\]"):
        loops(square[:3], 1e-9)
    with pytest.raises(InputError, match=r"file: a line meets 2 others at \[4, 0\]"):
        loops([*square, Part("", 4 + 0j, 8 + 0j)], 1e-9)
    with pytest.raises(InputError, match='an arc on the layer "A" ends at'):
        loops([Part("A", 0j, 2 + 0j, 1 + 1j)], 1e-9)


def test_gaps_are_closed_and_directions_turned():
    rng = np.random.default_rng(1)
    parts = polygon([complex(*pair) for pair in rng.normal(size=(20, 2))])
    mixed = [part.reversed() if k % 3 else part for k, part in enumerate(parts)]
    (loop,) = loops([mixed[k] for k in rng.permutation(20)], 1e-9)
    assert length(loop) == pytest.approx(length(parts))
