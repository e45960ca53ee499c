"""Figures of joints of several pins, and of a pin in one of their plates."""

import csv
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from matplotlib.patches import Circle

from fastpin import InputError, figures
from fastpin.joints import JOINT_EXAMPLE, JointResult, parse_joint, solve_joint
from fastpin.storage import record_joint
from tests.support.commands import refused, said
from tests.support.drawing import legend_words, plain
from tests.support.laps import SHEETS, lap

PULSES = [{"A.x": 4e3, "B.x": 2e3}, {"A.x": 1e3}] * 2
CASE = parse_joint(SHEETS)._replace(corners=PULSES, nodes=16)


@cache
def sheets() -> JointResult:
    return solve_joint(CASE.joint, CASE.corners, nodes=CASE.nodes)


@pytest.fixture(scope="module")
def stored(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("joints") / "joint.h5"
    record_joint(CASE, path)
    return path


def test_bars_stand_on_one_another_and_name_their_pins() -> None:
    result = sheets()
    panel = figures.plot_share_bars(result).axes[0]
    heights = np.array([[bar.get_height() for bar in bars] for bars in panel.containers])
    np.testing.assert_allclose(heights, [100.0 * result.shares("sheet")[pin] for pin in "AB"])
    assert [bar.get_y() for bar in panel.containers[1]] == pytest.approx(heights[0].tolist())
    assert {text.get_text() for text in panel.texts} == {"A", "B"}


def test_of_many_load_points_some_have_bars_with_the_largest_force(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(figures.joint, "MOST_BARS", 3)
    plot = figures.joint.share_bars_of(sheets())
    assert plot.notes == ["the figure shows 3 of 4 load points"]
    assert len(plot.curves[0].columns["load point"]) == 4
    (panel,) = figures.plot_share_bars(sheets()).axes
    assert [label.get_text() for label in panel.get_xticklabels()] == ["1", "2", "4"]


@pytest.mark.gate
def test_a_load_is_drawn_over_the_displacement_of_its_plate() -> None:
    result = solve_joint(lap((1.0, 1.0), 0.3), [{"strap.x": 1e6}, {"strap.x": 2e6}], nodes=16, harmonics=4)
    figure = figures.plot_displacement(result)
    curve = figure.axes[0].lines[0]
    np.testing.assert_allclose(curve.get_ydata(), [1.0, 2.0])
    np.testing.assert_allclose(curve.get_xdata(), [1e6 * state.moved[1, 0] for state in result], rtol=1e-9)
    assert legend_words(figure) == ["strap.x", "touch at 1: p0, p1"]
    titles = [plain(panel.get_title(loc="left")) for panel in figures.plot_share_bars(result).axes]
    assert titles == ["skin, strap"]  # both have the same shares


def test_what_a_joint_lacks_is_said() -> None:
    with pytest.raises(InputError, match="has no plate that moves under a load of its own"):
        figures.plot_displacement(sheets())
    with pytest.raises(InputError, match="at: must be a whole number from 1 to 4, not 5"):
        figures.joint.holes_plot(figures.joint.JointSubject(sheets()), at=5)


@pytest.mark.gate
def test_a_pin_in_a_plate_has_the_figures_of_one_pin(stored: Path, tmp_path: Path) -> None:
    out = said("plot", stored, "stick-slip", "--pin", "B", "-o", tmp_path / "a.svg", "--csv", tmp_path / "a.csv").out
    assert out == f"wrote {tmp_path / 'a.svg'} and {tmp_path / 'a.csv'}\n"
    assert "two bolts, B in sheet" in plain((tmp_path / "a.svg").read_text())
    said("plot", stored, "slip", "--pin", "A", "--plate", "sheet", "-o", tmp_path / "slip.svg", "--csv", tmp_path / "s")
    with (tmp_path / "s").open() as file:
        distance = max(float(row["slip_distance [m]"]) for row in csv.DictReader(file))
    cycle = sheets().of("A", "sheet")[-2:]  # the last cycle: after load point 2
    assert distance == pytest.approx(float(np.max(sum(state.slip_distance for state in cycle))), rel=1e-9)
    assert said("plot", stored, "-o", tmp_path / "map.svg").out == f"wrote {tmp_path / 'map.svg'}\n"


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["hoop"], "--pin: is missing: hoop shows one pin in one plate; the pins are A, B"),
        (["hoop", "--pin", "C"], '--pin: must be "A" or "B", not "C"'),
        (["hoop", "--pin", "A", "--plate", "lug"], '--plate: must be "sheet", not "lug"'),
        (["shares", "--pin", "A"], "--pin: has no effect on shares, which shows the whole joint"),
        (["loops", "--pin", "A"], "kind: loops shows the result of a run, but this is a pin in a plate of a joint"),
        (["hoop", "--interface", "seat"], "--interface: is for a bush that slips in its seat, not for a joint of"),
        (["shares", "--at", "2"], "--at: has no effect on shares; it is for holes"),
    ],
)
def test_wrong_options_are_refused(stored: Path, arguments: list[str], message: str) -> None:
    assert message in refused("plot", stored, *arguments)


LOADED = """
[joint]
[[plate]]
name = "sheet"
material = "aluminium"
thickness = 2e-3
[[plate]]
name = "doubler"
material = "aluminium"
thickness = 2e-3
x = [-20e-3, 60e-3]
y = [-20e-3, 20e-3]
moves = "free"
[[pin]]
name = ["A", "B"]
at = [[0, 0.0], [30e-3, 5e-3]]
material = "steel"
diameter = 6e-3
bore_radius = 1e-3
plates = ["sheet", "doubler"]
clearance = 10e-6
friction = 0.3
bush = { material = "steel", outer_radius = 5e-3, interference = 8e-6, bonded = false, friction = 0.15 }
[[load]]
"sheet.sxx" = 5e7
"sheet.syy" = -1e7
"sheet.sxy" = 1e7
"A.x" = 2e3
[[load]]
"sheet.sxx" = -5e7
"A.x" = 1e3
"""


def test_a_sketch_has_plates_pins_and_the_ranges_of_all_loads() -> None:
    figure = figures.plot_joint_sketch(parse_joint(LOADED))
    sheet, doubler = figure.axes
    assert [plain(panel.get_title(loc="left")) for panel in (sheet, doubler)] == [
        "sheet, infinite", "doubler, held by its pins",
    ]  # fmt: skip
    words = {plain(text.get_text()) for text in sheet.texts}
    assert words == {
        "A", "B", "A.x: 1 to 2 kN", "sheet.sxx: −50 to 50 MPa", "sheet.syy = −10 MPa", "sheet.sxy = 10 MPa",
    }  # fmt: skip
    assert {plain(text.get_text()) for text in doubler.texts} == {"A", "B"}
    radii = sorted({round(patch.radius, 9) for patch in doubler.patches if isinstance(patch, Circle)})
    assert radii == [1.0, 3.0, 5.0]  # bore, pin and bush, mm
    figure = figures.plot_joint_sketch(parse_joint(JOINT_EXAMPLE))
    skin, strap = figure.axes
    assert [plain(panel.get_title(loc="left")) for panel in (skin, strap)] == ["skin", "strap, moves along x"]
    assert {plain(text.get_text()) for text in strap.texts} == {"A", "B", "C", "strap.x: 1.5 to 15 kN"}
    assert legend_words(figure) == ["held"]


def test_a_sketch_of_a_result_has_the_loads_of_its_states(stored: Path, tmp_path: Path) -> None:
    texts = [{plain(text.get_text()) for text in panel.texts} for panel in figures.plot_joint_sketch(sheets()).axes]
    assert {"A.x: 1 to 4 kN", "B.x = 2 kN"} <= texts[0]
    bare = figures.plot_joint_sketch(CASE.joint).axes
    assert {text.get_text() for text in bare[0].texts} == {"A", "B"}
    said("plot", stored, "plates", "-o", tmp_path / "plates.svg")
    with pytest.raises(InputError, match="joint: must be a Joint, JointFile or JointResult, not 3"):
        figures.plot_joint_sketch(3)


@pytest.mark.gate
def test_a_joint_file_is_drawn_before_it_is_solved(tmp_path: Path) -> None:
    file = tmp_path / "joint.toml"
    file.write_text(LOADED, encoding="utf-8")
    out = tmp_path / "plates.png"
    assert f"wrote {out}" in said("plot", file, "-o", out).out
    assert out.stat().st_size > 5_000
    words = "is a joint file, drawn by plates; holes needs its result: fastpin joint FILE -o RESULT"
    assert words in refused("plot", file, "holes")
    assert "--csv: has no effect on plates" in refused("plot", file, "--csv", tmp_path / "a.csv")
    assert "--pin: has no effect on plates, which shows the whole joint" in refused("plot", file, "--pin", "A")
