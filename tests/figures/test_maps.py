"""The map of stick and slip and the sketch: what is drawn, and where."""

import dataclasses

import numpy as np
import pytest
from matplotlib.collections import PolyCollection
from matplotlib.patches import Circle, FancyArrowPatch, Polygon, Rectangle, Wedge

from fastpin import MATERIALS, Case, InputError, LoadHistory, Material, MaterialPair, Problem, figures
from fastpin.bodies import Bushing, Ring, Tube
from fastpin.figures.sketch import ARROWS
from fastpin.figures.states import Frame
from fastpin.figures.stick_slip import BOTH_WAYS, LOOKS, MOST_COLUMNS, columns_of, zone_boxes
from fastpin.kernels.status import OPEN, SLIP_NEGATIVE, SLIP_POSITIVE, STICK
from fastpin.lugs.outline import Hole, PartLoad, rectangle
from fastpin.lugs.plates import plate_compliance
from fastpin.states.cycles import Cycle
from tests.support.drawing import legend_words, plain
from tests.support.lugs import make_coarse, plate
from tests.support.samples import PAIR, sample_result, with_values

# -- the map of stick and slip ------------------------------------------------------------------------------------


def test_the_map_has_a_box_for_each_zone_of_each_state():
    result = sample_result()
    boxes = list(zone_boxes(result, Frame(result)))
    assert len(boxes) == 9
    for state in result:
        mine = [box for box in boxes if box.point == state.step + 1]
        assert {(box.left, box.right) for box in mine} == {(state.step + 0.5, state.step + 1.5)}
        (stick,) = (box for box in mine if box.kind == STICK)
        assert (stick.start, stick.stop) == pytest.approx(tuple(np.degrees(state.stick[0]) + 90.0))
        slips = {box.kind: box for box in mine if box.kind != STICK}
        assert slips[SLIP_POSITIVE].stop == pytest.approx(stick.start)
        assert slips[SLIP_NEGATIVE].start == pytest.approx(stick.stop)


@pytest.mark.gate
def test_the_map_is_drawn_below_the_loads_that_change(tmp_path):
    figure = figures.plot_stick_slip(sample_result(), tmp_path / "map.png", title="A map")
    loads, panel = figure.axes
    assert loads.get_legend().get_texts()[0].get_text() == "Q, largest 484\N{NO-BREAK SPACE}kN/m"
    assert loads.lines[0].get_ydata() == pytest.approx([0.0, 1.0, -1.0])
    filled = [shape for shape in panel.collections if isinstance(shape, PolyCollection) and len(shape.get_facecolor())]
    assert [len(shape.get_paths()) for shape in filled] == [3, 3, 3]
    assert panel.get_xlim() == (0.5, 3.5)
    assert "load point" in panel.get_xlabel()
    assert "(deg)" in panel.get_ylabel()
    assert legend_words(figure) == ["sticks", "pin slips counter-clockwise", "pin slips clockwise", "open"]
    assert figure.get_suptitle() == "A map\nP = 2.42 MN/m"
    assert (tmp_path / "map.png").stat().st_size > 10_000


def test_states_without_contact_have_white_columns():
    result = sample_result()
    result.states[0] = with_values(result[0], pressure=0.0, shear=0.0, status=2)
    panel = figures.plot_stick_slip(result).axes[-1]
    assert panel.get_xlim() == (0.5, 3.5)
    assert {box.point for box in zone_boxes(result, Frame(result))} == {2.0, 3.0}


def test_the_axis_of_one_state_has_one_number():
    figure = figures.plot_stick_slip(sample_result()[0])
    axis = figure.axes[-1]
    first, last = axis.get_xlim()
    assert [tick for tick in axis.get_xticks() if first <= tick <= last] == [1.0]


def test_the_two_directions_of_slip_differ_without_colour():
    _, first, _ = LOOKS[SLIP_POSITIVE]
    _, second, _ = LOOKS[SLIP_NEGATIVE]
    assert first[0] == "/"
    assert second[0] == "\\"


def test_a_triangle_marks_a_narrow_slip_zone():
    result = sample_result(nodes=401)
    state = result[0]
    status, shear = np.where(state.status != 2, STICK, state.status), np.zeros(state.shear.size)
    first = np.flatnonzero(status != 2)[:1]
    status[first], shear[first] = SLIP_POSITIVE, 0.4 * state.pressure[first]
    result.states[0] = with_values(state, status=status, shear=shear)
    panel = figures.plot_stick_slip(result).axes[-1]
    (marks,) = panel.lines
    assert (marks.get_marker(), marks.get_xdata().tolist()) == ("^", [1.0])
    assert "narrow slip zone" in legend_words(panel.figure)


def test_slip_without_friction_has_no_direction():
    result = sample_result(friction=0.0)
    for figure in (figures.plot_stick_slip(result), figures.plot_sketch(result[0])):
        assert legend_words(figure)[0] == "slips without friction"
        assert not [text for text in legend_words(figure) if "clockwise" in text or "narrow" in text]


@pytest.mark.gate
def test_without_a_choice_many_cycles_show_the_extremes_and_the_last_cycle():
    result = sample_result([{"P": 1e6 * (2 + k % 2)} for k in range(MOST_COLUMNS + 50)], nodes=21)
    result.cycles = tuple(Cycle(k, 2, k // 2, 0.0, 0.0, 0.0, 0.0, True) for k in range(3, len(result), 2))
    drawn = figures.states.drawn_states(result, None, MOST_COLUMNS)
    assert [state.step for state in drawn] == [0, 247, 248, 249]


def long_result(corners=700, largest=650, friction=0.4):
    """Corners between which the outermost nodes slip forth and back; one late corner slips everywhere."""
    (first,) = sample_result([{"P": 1e6}], nodes=21, friction=friction).states
    closed = first.status != OPEN
    outer = closed & (np.abs(first.theta + 0.5 * np.pi) > 0.8)
    states = []
    for step in range(corners):
        moved = closed if step == largest else outer
        slip = np.where(moved, 1e-6 * (-1.0) ** step, 0.0)
        load = first.load | {"Q": 1e5 * (-1.0) ** step * (3.0 if step == largest else 1.0)}
        states.append(dataclasses.replace(first, step=step, slip=slip, load=load))
    return states, closed, outer


def test_a_long_history_has_a_column_for_some_cycles_each_and_hides_no_extreme():
    states, closed, outer = long_result()
    cycles = tuple(Cycle(k, 2, k // 2, 0.0, 0.0, 0.0, 0.0, True) for k in range(2, 700, 2))
    result = dataclasses.replace(sample_result([{"P": 1e6}], nodes=21), states=states, cycles=cycles)
    drawn = figures.states.drawn_states(result, "all", MOST_COLUMNS, whole=True)
    assert len(drawn) == 700
    columns, words = figures.stick_slip.long_columns(drawn)
    assert words == "each column joins 2 cycles, or states outside of cycles"
    assert len(columns) <= MOST_COLUMNS
    assert [column.left for column in columns[1:]] == [column.right for column in columns[:-1]]
    ends = [column.right for column in columns[1:-1]]
    assert all((end - 1.0) % 2.0 == 0.0 for end in ends)  # no column ends inside a cycle
    (late,) = (column for column in columns if 650 in column.places)
    found = figures.stick_slip.extents([states[k] for k in late.places], states[late.places[0] - 1])
    assert set(found[closed & ~outer]) == {SLIP_POSITIVE}  # and back in the next column
    usual = columns[20]
    found = figures.stick_slip.extents([states[k] for k in usual.places], states[usual.places[0] - 1])
    assert set(found[outer]) == {BOTH_WAYS}
    assert set(found[closed & ~outer]) == {STICK}
    assert set(found[~closed]) == {OPEN}


@pytest.mark.gate
def test_the_map_of_a_long_history_is_drawn_with_the_range_of_the_loads(tmp_path):
    states, _, _ = long_result()
    figure = figures.plot_stick_slip(states, tmp_path / "long.png")
    loads, panel = figure.axes
    assert loads.get_legend().get_texts()[0].get_text().startswith("Q, largest 300")
    assert max(loads.lines[0].get_ydata()) == 1.0  # the largest load is drawn
    assert panel.get_xlim()[1] == 700.0
    texts = legend_words(figure)  # the first state has statuses only, in both directions
    assert [texts[0], *texts[3:]] == ["sticks whenever it touches", "pin slips both ways", "open all the time"]
    assert "700 states; each column joins 4 states" in loads.get_title().replace("\n", " ")


def test_recorded_slip_counts_between_the_kept_states():
    states, closed, outer = long_result(3)
    still = [
        dataclasses.replace(state, slip=np.zeros(21), slip_distance=np.where(outer, 2e-6, 0.0)) for state in states
    ]
    found = figures.stick_slip.extents(still[1:], still[0])
    assert set(found[outer]) == {BOTH_WAYS}
    assert set(found[closed & ~outer]) == {STICK}  # their status may be slip, at |T| = mu N


def test_columns_of_cycles_and_of_single_states():
    cycles = [Cycle(c, 2, k, 0.0, 0.0, 0.0, 0.0, True) for k, c in enumerate((2, 4), start=1)]
    columns, words = columns_of(np.arange(1.0, 8.0), cycles, 10)
    assert words == "each column is one cycle, or one state outside of cycles"
    assert [column.places.tolist() for column in columns] == [[0], [1, 2], [3, 4], [5], [6]]
    assert [(column.left, column.right) for column in columns[:3]] == [(0.0, 1.0), (1.0, 3.0), (3.0, 5.0)]
    assert columns_of(np.arange(1.0, 8.0), (), 10)[1] == "each column is one state"
    apart, _ = columns_of(np.array([1.0, 2.0, 3.0, 4.0, 9.0]), (), 10)
    assert apart[-1].left == 8.0  # nothing is drawn where states are left out


# -- the sketch ------------------------------------------------------------------------------------------------------


def words(panel):
    return [plain(text.get_text()) for text in panel.texts]


def arrows(panel):
    return [patch for patch in panel.patches if isinstance(patch, FancyArrowPatch)]


def test_a_sketch_of_a_result_names_the_ranges_of_the_loads():
    (panel,) = figures.plot_sketch(sample_result()).axes
    assert words(panel) == ["P = 2.42 MN/m", "Q: −484 to 484 kN/m"]
    down, sideways = arrows(panel)
    (tail, head) = down._posA_posB
    assert tail == (0.0, 0.0)
    assert head[1] < 0.0 == head[0]
    assert type(sideways.get_arrowstyle()).__name__ == "CurveFilledAB"  # a head at both ends
    assert isinstance(panel.patches[0], Rectangle)
    assert "clearance exaggerated" in panel.get_title().replace("\n", " ")


def test_a_sketch_of_a_state_shows_its_loads_and_its_contact():
    figure = figures.plot_sketch(sample_result()[2])
    (panel,) = figure.axes
    assert words(panel) == ["P = 2.42 MN/m", "Q = −484 kN/m"]
    assert arrows(panel)[1]._posA_posB[1][0] < 0.0
    arcs = [patch for patch in panel.patches if isinstance(patch, Wedge)]
    assert len(arcs) == 3
    assert legend_words(figure) == ["sticks", "pin slips counter-clockwise", "pin slips clockwise"]
    assert figure.get_suptitle() == "load point 3"


def test_bodies_have_their_true_proportions():
    pair = MaterialPair(MATERIALS["steel"], MATERIALS["aluminium"])
    bush = Bushing(MATERIALS["2024-T3"], 12e-3, 10e-6, Ring(20e-3))
    (panel,) = figures.plot_sketch(Problem(pair, 10e-3, 20e-6, 0.3, pin_body=Tube(5e-3), plate_body=bush)).axes
    radii = sorted(round(patch.radius, 3) for patch in panel.patches if isinstance(patch, Circle))
    assert radii == [0.5, 0.93, 1.0, 1.2, 2.0]


def test_remote_stresses_stand_at_the_sides_of_the_plate():
    history = LoadHistory([{"P": 1e6, "sxx": -3e7, "sxy": 1e7, "M": 100.0}])
    case = Case(Problem(PAIR, 0.01, -1e-5, 0.3), history, title="fit")
    figure = figures.plot_sketch(case)
    (panel,) = figure.axes
    assert words(panel) == ["P = 1 MN/m", "M = 100 N", "sxx = −30 MPa", "sxy = 10 MPa"]
    pushed = [arrow._posA_posB for arrow in arrows(panel)[2:8]]
    assert all(abs(tail[0]) > abs(head[0]) > 2.5 for tail, head in pushed)  # compression points inwards
    assert len(arrows(panel)) == 2 + 6 + 4


@pytest.mark.gate
def test_a_sketch_of_a_plate_of_any_outline_shows_its_supports_and_loads(monkeypatch):
    make_coarse(monkeypatch)
    load = PartLoad("syy", ("top",), normal=1.0)
    lug = plate(hole_radius=12e-3, plane="stress", outline=rectangle((-0.03, 0.03), (-0.04, 0.06)), loads=(load,),
                supports={"bottom": "both", "bolt": "normal"}, holes=(Hole("bolt", 0.035j, 4e-3),))  # fmt: skip
    body = plate_compliance(lug, 6).compliance
    for plate_body, size in ((body, 12e-3), (Bushing(MATERIALS["steel"], 12e-3, 1e-5, body), 10e-3)):
        pair = MaterialPair(MATERIALS["steel"], Material(7e10, 0.3), plane="stress")
        problem = Problem(pair, size, 20e-6, 0.3, plate_body=plate_body)
        figure = figures.plot_sketch(problem, history=LoadHistory([{"P": 1e6, "syy": 3e7}]))
        (panel,) = figure.axes
        assert [text for text in words(panel) if text] == ["syy = 30 MPa", "P = 1 MN/m"]
        assert words(panel).count("") == ARROWS
        outline = next(patch for patch in panel.patches if isinstance(patch, Polygon))
        assert np.abs(outline.get_xy()).max(axis=0) == pytest.approx([0.03 / size, 0.06 / size])
        circles = [patch.radius for patch in panel.patches if isinstance(patch, Circle)]
        assert 4e-3 / size == pytest.approx(circles[0])
        assert legend_words(figure) == ["held", "held along the normal"]
        assert panel.get_ylim()[0] < -0.04 / size < 0.06 / size < panel.get_ylim()[1]


def test_a_sketch_needs_a_joint_and_may_stand_in_given_axes():
    with pytest.raises(InputError, match="joint: must be a Problem, Case, Result or State"):
        figures.plot_sketch("case.toml")
    with pytest.raises(InputError, match="history: must be a LoadHistory"):
        figures.plot_sketch(sample_result().problem, history=[{"P": 1.0}])
    with pytest.raises(InputError, match="history: is for a Problem; a case, a result and a state have loads"):
        figures.plot_sketch(sample_result(), history=LoadHistory([{"P": 1.0}]))
    figure = figures.plot_stick_slip(sample_result())
    panel = figure.add_axes((0.8, 0.8, 0.2, 0.2))
    assert figures.plot_sketch(sample_result()[0], ax=panel) is figure
    assert panel.get_aspect() == 1.0
