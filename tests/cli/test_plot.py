"""``fastpin plot``: all kinds of figures, their numbers, and wrong options."""

import csv
import functools
import importlib
import inspect
from pathlib import Path

import matplotlib as mpl
import numpy as np
import pytest

from fastpin import MATERIALS, InputError, LoadHistory, MaterialPair, Problem, figures, load, load_wear, record
from fastpin.figures.kinds import KIND_OPTIONS, KINDS
from fastpin.storage.stored import StoredResult
from tests.support.commands import printed, refused, said
from tests.support.drawing import OF_SOME_PLATES
from tests.support.lives import sample_life
from tests.support.samples import JOINT
from tests.support.tiers import for_gate, gate


@pytest.fixture(scope="module")
def stored(tmp_path_factory):
    path = tmp_path_factory.mktemp("plot") / "joint.h5"
    pair = MaterialPair(MATERIALS["steel"], MATERIALS["2024-T3"], "stress")
    problem = Problem(pair, hole_radius=2.4e-3, clearance=10e-6, friction=0.4, pin_load="body")
    cycle = LoadHistory([{"Q": 1e5, "sxx": 60e6}, {"Q": -1e5, "sxx": 6e6}])
    record(problem, LoadHistory([{"P": 6e5}]) + cycle.repeated(2), path, nodes=101, between=1, slip_sums=True)
    return path


@pytest.fixture(scope="module")
def life(tmp_path_factory):
    path = tmp_path_factory.mktemp("plot") / "life.h5"
    sample_life(path)
    return path


@pytest.fixture
def of_kind(stored, life):
    """The file of a kind of figure: a result, or a life of wear if the kind shows no result."""
    shown = {name: kind for name, kind in KINDS.items() if "joint" not in kind.sources}
    return {name: life if "result" not in kind.sources or name == "gap" else stored for name, kind in shown.items()}


SHEET = Problem(MaterialPair(MATERIALS["steel"], MATERIALS["2024-T3"]), 1e-2, 1e-5, 0.3)

FIND = StoredResult.__dict__["extremes"].func
EXTREMES = functools.cache(lambda path: FIND(StoredResult(path)))


@pytest.fixture(autouse=True)
def _extremes_are_found_once(monkeypatch):
    """Many tables and figures of one file name its extremes. No file of these tests changes."""
    monkeypatch.setattr(StoredResult, "extremes", property(lambda stored: EXTREMES(stored.path)))


@pytest.fixture
def coarse(monkeypatch):
    """Maps of few points: those of a usual one take seconds to draw and to write."""
    monkeypatch.setattr(figures.stress, "field_curves", functools.partial(figures.stress.field_curves, fineness=40))


def read_rows(path="a.csv"):
    return list(csv.DictReader(Path(path).read_text(encoding="utf-8").splitlines()))


def test_the_function_of_each_kind_has_its_options():
    used = set()
    for name, kind in KINDS.items():
        make = getattr(importlib.import_module(f"fastpin.figures.{kind.file}"), f"{name.replace('-', '_')}_plot")
        _, *options = inspect.signature(make).parameters
        assert sorted(options) == sorted({*kind.options} - {"csv"}), name
        used |= {*options}
    assert used == set(KIND_OPTIONS)


BARE = (
    "load point", "cycle", "corner", "length", "number", "pressure_change", "shear_change", "damage", "worn off",
    "cycles to damage 1", "friction",
)  # fmt: skip
"""Columns of numbers without a unit."""


@pytest.mark.gate
@pytest.mark.usefixtures("coarse")
@pytest.mark.parametrize(
    "kind",
    [
        name
        for name, kind in KINDS.items()
        if "csv" in kind.options and name not in OF_SOME_PLATES and "joint" not in kind.sources
    ],
)
def test_a_figure_and_its_numbers_with_units(of_kind, kind):
    words = printed("plot", of_kind[kind], kind, "-o", "a.svg", "--csv", "a.csv")
    assert words.splitlines()[-1] == "wrote a.svg and a.csv"
    assert Path("a.svg").read_text(encoding="utf-8").startswith("<?xml")
    rows = read_rows()
    assert len(rows) >= 2
    for row in rows:
        for name, cell in row.items():
            is_text = not cell or cell[0].isalpha()
            assert is_text or name in BARE or (name.endswith("]") and " [" in name), (name, cell)


@pytest.mark.gate
@pytest.mark.usefixtures("coarse")
def test_a_result_in_memory_has_the_same_figures_as_its_file(stored, of_kind):
    result = load(stored)
    with mpl.rc_context({"svg.hashsalt": "fastpin"}):
        shown = [name for name, file in of_kind.items() if file == stored]
        for name in (name for name in shown if name not in OF_SOME_PLATES):
            result.plot("memory.svg", kind=name)
            said("plot", stored, name, "-o", "file.svg")
            assert Path("memory.svg").read_bytes() == Path("file.svg").read_bytes(), name


@pytest.mark.survey
@pytest.mark.usefixtures("coarse")
def test_all_kinds_but_that_of_cycles_show_a_life_of_wear(life):
    for name, kind in KINDS.items():
        code = 0 if "life" in kind.sources and name not in OF_SOME_PLATES else 2
        words = said("plot", life, name, "-o", "a.svg", code=code).out
        shows_a_profile = "the figure shows a cycle after 60 cycles\n" in words
        assert name in OF_SOME_PLATES or shows_a_profile == ({*kind.sources} - {"hole"} == {"result", "life"}), name


@pytest.mark.gate
def test_a_profile_of_a_life_is_chosen_by_its_cycles(life):
    arguments = ["plot", life, "tractions", "-o", "a.svg", "--csv", "a.csv"]
    found = load_wear(life)
    for number in (0, 20):
        assert f"the figure shows a cycle after {number} cycles\n" in printed(*arguments, "--after", number)
        points = [state.step + state.fraction for state in found.after(number).states]
        assert {float(row["load point"]) for row in read_rows()} == {*points}
    said(*arguments, "--states", "6-7")  # states on any profile
    assert {float(row["load point"]) for row in read_rows()} == {6.0, 7.0}
    with mpl.rc_context({"svg.hashsalt": "fastpin"}):
        found.plot("memory.svg", kind="tractions", after=20)
        said("plot", life, "tractions", "--after", "2e1", "-o", "file.svg")
    assert "<!-- after 20 cycles" in Path("memory.svg").read_text()
    assert "<!-- Worn lug, after 20 cycles" in Path("file.svg").read_text()


@pytest.mark.gate
def test_the_usual_kind_is_that_of_the_file(stored, life):
    Path("case.toml").write_text(f"{JOINT}\n[[load]]\nP = 1e6\n")
    for source, name in ((stored, "tractions"), (life, "scar"), ("case.toml", "sketch")):
        assert printed("plot", source).splitlines()[-1] == f"wrote {name}.png"


def test_kinds_and_options_of_a_result_in_memory_are_checked(stored):
    result = load(stored)
    with pytest.raises(InputError, match=r'^kind: must be "tractions", "stick-slip", .* not "polar"$'):
        result.plot(kind="polar")
    with pytest.raises(
        InputError, match=r"^body: has no effect on loops; it is for hoop, profile, map, fatigue, damage$"
    ):
        result.plot(kind="loops", body="pin")


@pytest.mark.gate
def test_the_terminal_says_which_states_are_drawn(stored):
    words = "the figure shows 5 of 10 states: load points 3, 3.5, 4, 4.5, 5\n"
    assert printed("plot", stored, "tractions", "-o", "a.png").startswith(words)
    said("plot", stored, "tractions", "-o", "b.png", "--sketch")
    assert Path("a.png").read_bytes() != Path("b.png").read_bytes()
    words = printed("show", stored, "--plot", "a.png", "--states", "2,5")
    assert "a.png shows 2 of 10 states: load points 2, 5\n" in words


@pytest.mark.gate
def test_bars_are_drawn_and_written():
    problem = Problem(MaterialPair(MATERIALS["steel"], MATERIALS["2024-T3"]), 2.4e-3, 10e-6, 0.4)
    record(problem, LoadHistory([{"P": 6e5}, {"Q": 1e5}]), "joint.h5", nodes=101, error_bars=True)
    arguments = ["plot", "joint.h5", "tractions", "-o", "a.png", "--csv", "a.csv", "--states", "2"]
    said(*arguments, "--bars")
    rows = read_rows()
    angle, bar = (np.array([float(row[name]) for row in rows]) for name in ("angle [deg]", "shear bar [Pa]"))
    assert np.allclose(bar, load("joint.h5")[1].error_bars.of_curves(np.radians(angle - 90.0))[1], rtol=1e-3)
    assert "pressure bar [Pa]" in rows[0]
    said(*arguments)
    assert not [name for name in read_rows()[0] if "bar" in name]


@pytest.mark.gate
def test_more_states_than_a_figure_holds_get_a_remedy(stored):
    remedy = "; of the 10 chosen states it holds 8: choose at most so many with --states\n"
    first = printed("plot", stored, "tractions", "-o", "a.png", "--states", "all").splitlines(keepends=True)[0]
    assert first.startswith("the figure shows 8 of 10 states: load points ")
    assert first.endswith(remedy)
    assert remedy in printed("show", stored, "--plot", "a.png", "--states", "all")
    assert "chosen" not in printed("plot", stored, "tractions", "-o", "a.png", "--states", "1-3")


def test_a_sketch_of_a_result_and_of_a_case_file(stored):
    Path("case.toml").write_text(printed("example"))
    for source in (stored, "case.toml"):
        said("plot", source, "sketch")
        assert Path("sketch.png").read_bytes().startswith(b"\x89PNG")
    for arguments, words in (
        (["hoop"], "case.toml: is a case file; hoop needs a result: fastpin run CASE -o FILE"),
        (["scar"], "case.toml: is a case file; scar needs a life of wear: fastpin wear CASE -o FILE"),
        (["sketch", "--states", "1"], "--states: chooses a state of a result; a case file has none"),
    ):
        assert words in refused("plot", "case.toml", *arguments)


@pytest.mark.gate
@pytest.mark.usefixtures("coarse")
def test_the_name_of_the_figure_is_the_kind(stored):
    said("plot", stored, "map", "--component", "hoop", "--extent", "3", "--body", "plate")
    assert Path("map.png").exists()


@pytest.mark.gate
def test_states_are_chosen_by_load_points(stored):
    for kind, chosen, points in (
        (["hoop", "--body", "plate"], "last", {"5"}),
        (["tractions"], "2,3.5", {"2", "3.5"}),
        (["tractions"], "cycle", {"3", "3.5", "4", "4.5", "5"}),
    ):
        said("plot", stored, *kind, "--states", chosen, "-o", "a.png", "--csv", "a.csv")
        assert {f"{float(row['load point']):g}" for row in read_rows()} == points


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["hoop", "--component", "sxx"], "--component: has no effect on hoop; it is for map"),
        (["slip", "--states", "last"], "--states: has no effect on slip; it is for tractions, stick-slip, "),
        (["sketch", "--csv", "a.csv"], "--csv: has no effect on sketch; it is for tractions, stick-slip, gap"),
        (["hoop", "--states", "20"], "--states: there is no state at load point 20; the last is 5"),
        (["hoop", "--bars"], "--bars: has no effect on hoop; it is for tractions"),
        *gate(
            (
                ["tractions", "--bars"],
                "--bars: needs states with error bars: fastpin run CASE --error-bars, or solve(..., ",
            )
        ),
        (["hoop", "--sketch"], "--sketch: has no effect on hoop; it is for tractions"),
        (["hoop", "--states", "now"], "load points such as 2,3.5, 1-9 or 10-, not 'now'"),
        (["tractions", "--states", "3-2"], "load points such as 2,3.5, 1-9 or 10-, not '3-2'"),
        (["hoop", "--cycle", "2"], "--cycle: has no effect on hoop; it is for loops"),
        (["map", "--extent", "0.5"], "--extent: must be above 1 and at most 100 radii, not 0.5"),
        (["map", "--component", "x"], "--component: must be "),
        (["profile", "--body", "both"], '--body: must be "plate", "pin" or "seat"'),
        (["fatigue", "--criterion", "crossland"], "crossland needs bending_limit, torsion_limit of the plate"),
        (["gap"], "gap: there is no initial gap, and the friction is the same all round"),
        (["scar"], "kind: scar shows a life of wear, but this is the result of a run"),
        (["hoop", "--after", "3"], "--after: chooses a profile of a life of wear, but this is the result of a run"),
        (["hoop", "-o", "hoop.txt"], "--output: must be the name of a figure, which ends in .png, .pdf or .svg, not"),
    ],
)
def test_wrong_options(stored, arguments, message, tmp_path):
    assert message in refused("plot", stored, *arguments)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["cycles"], "kind: cycles shows the result of a run, but this is a life of wear"),
        (["scar", "--after", "20"], "--after: has no effect on scar, which shows no states"),
        (["gap", "--after", "20"], "--after: has no effect on gap, which shows no states"),
        (["hoop", "--after", "7"], "--after: no profile is stored after 7 cycles; the nearest: 0 and 2"),
        (["hoop", "--after", "x"], '--after: must be a number, not "x"'),
        (["damage", "--criterion", "findley"], "fatigue: findley needs bending_limit, torsion_limit of the plate"),
    ],
)
def test_wrong_options_of_a_life_of_wear(life, arguments, message, tmp_path):
    assert message in refused("plot", life, *arguments)
    assert not list(tmp_path.iterdir())


def test_a_result_that_was_cut_short_leaves_no_figure(stored, tmp_path):
    text = stored.with_name("short.h5")
    text.write_bytes(stored.read_bytes()[: stored.stat().st_size // 2])
    assert "short.h5: is damaged or cut short" in refused("plot", text, "tractions", "-o", "a.png")
    assert not list(tmp_path.iterdir())


@pytest.mark.gate
def test_a_history_without_cycles_has_the_damage_of_a_spectrum(monkeypatch):
    """A body without constants of a life has the parameter over all states. Many states have straight lines."""
    history = LoadHistory([{"P": 4e5, "Q": 2e5}, {"P": 1e5}, {"P": 6e5, "Q": -2e5}, {"P": 2e5, "Q": 0.0}])
    record(SHEET, history, "flight.h5", nodes=61)
    command = ["plot", "flight.h5", "fatigue", "-o", "a.png", "--csv", "a.csv"]
    assert printed(*command).strip() == "wrote a.png and a.csv"
    found, rows = load("flight.h5").spectrum_damage(), read_rows()
    assert max(float(row["damage by smith-watson-topper"]) for row in rows) == pytest.approx(found.hot_spot.damage)
    assert min(float(row["life [spectra]"]) for row in rows) == pytest.approx(found.hot_spot.life)
    said(*command, "--body", "pin")
    assert {"body", "smith-watson-topper [Pa]", "plane [deg]"} < set(read_rows()[0])
    monkeypatch.setattr(figures.fatigue, "MOST_REFINED", 3)
    assert "the stresses of 4 states are those of straight lines between the nodes" in printed(*command)
    assert "crossland needs bending_limit, torsion_limit of the plate" in refused(*command, "--criterion", "crossland")
    assert "criterion: must be" in refused(*command, "--criterion", "x")


def test_a_cycle_without_its_corners_has_neither_loop_nor_fatigue():
    history = LoadHistory([{"P": 1e5}]) + LoadHistory([{"Q": 2e4}, {"Q": -2e4}]).repeated(3)
    record(SHEET, history, "ends.h5", nodes=31, keep="cycles")
    message = 'cycle: has no loop: only its ends were kept; keep "corners" or "all" keeps its corners'
    assert refused("plot", "ends.h5", "loops", "-o", "a.png").strip() == f"fastpin: {message}"
    assert "must hold all corners of the cycle, 5 to 7" in refused("plot", "ends.h5", "fatigue", "-o", "a.png")
    assert not Path("a.png").exists()


def test_the_result_is_not_overwritten(stored):
    before = stored.read_bytes()
    assert "is an input of this command" in refused("plot", stored, "hoop", "--csv", stored)
    assert "joint.h5" in refused("plot", stored, "hoop", "-o", stored)
    assert stored.read_bytes() == before


@pytest.mark.gate
def test_a_result_without_cycles():
    record(SHEET, LoadHistory([{"P": 1e5}]), "one.h5", nodes=61)
    for kind in ("loops", "cycles"):
        assert "no cycle of the history has ended" in refused("plot", "one.h5", kind, "-o", "a.png")
    said("plot", "one.h5", "hoop", "-o", "a.png")


@pytest.fixture(scope="module")
@for_gate
def blocks(tmp_path_factory):
    """Two blocks of three cycles, with slip sums."""
    path = tmp_path_factory.mktemp("blocks") / "blocks.h5"
    pair = MaterialPair(MATERIALS["steel"], MATERIALS["aluminium"])
    parts = [LoadHistory([{"Q": force}, {"Q": -force}]).repeated(3) for force in (1e5, 3e5)]
    problem = Problem(pair, 1e-2, 2e-5, 0.4, pin_load="centre", rotation="fixed")
    record(problem, LoadHistory([{"P": 1e6}]) + parts[0] + parts[1], path, nodes=41, between=2, slip_sums=True)
    return path


def test_loops_of_chosen_cycles(blocks):
    arguments = ["plot", blocks, "loops", "-o", "a.png", "--csv", "a.csv"]
    words = said(*arguments, "--cycle", "blocks")
    assert words.out.count("dissipated on the path") == 2
    assert words.out.splitlines()[1].startswith("cycle 6: area ")
    assert "few states draw the loop" in words.err
    assert {line.split(",")[0] for line in Path("a.csv").read_text().splitlines()[1:]} == {"3", "6"}
    assert "note: cycle 1 is left out: the cycle to corner 3 is not closed" in said(*arguments, "--cycle", "1-").err
    assert "not closed" in refused(*arguments, "--cycle", "1")
    assert "--cycle: there is no cycle 7; the history has 6, counted from 1" in refused(*arguments, "--cycle", "7")
    assert "--abscissa: no displacement is prescribed here" in refused(*arguments, "--abscissa", "prescribed")


def test_ranges_of_states(blocks):
    assert "states: load points 10 to 13" in printed("plot", blocks, "stick-slip", "--states", "10-", "-o", "a.png")
    said("show", blocks, "--plot", "b.png", "--states", "2-3")


def test_cycles_are_counted_from_1_and_their_numbers_have_units(blocks):
    said("plot", blocks, "cycles", "-o", "a.png", "--csv", "a.csv")
    header, first, *others = Path("a.csv").read_text().splitlines()
    assert header.startswith("cycle,corner,length,number,")
    assert "dissipation [J/m],rotation_change [rad]" in header
    assert first.startswith("1,3,2,1,")
    assert len(others) == 5


def test_a_long_map_of_stick_and_slip_says_what_its_columns_join(blocks, monkeypatch):
    monkeypatch.setattr(figures.stick_slip, "MOST_COLUMNS", 5)
    words = printed("plot", blocks, "stick-slip", "--states", "all", "-o", "a.png", "--csv", "a.csv")
    assert "states in 5 columns: each column joins 2 cycles, or states outside of cycles" in words
    header, first, *_ = Path("a.csv").read_text().splitlines()
    assert header == "load points after,to,start [deg],stop [deg],slip"
    assert first.startswith("0,")


def test_a_map_joins_all_states_of_a_long_history_with_cycles(blocks, monkeypatch):
    monkeypatch.setattr(figures.stick_slip, "MOST_COLUMNS", 5)
    arguments = ["plot", str(blocks), "stick-slip", "-o", "a.png"]
    assert "the figure shows 39 states in 5 columns" in printed(*arguments)
    monkeypatch.setattr(figures.states, "MOST_JOINED", 38)
    assert "the figure shows 7 of 39 states: load points 11, 11.333" in printed(*arguments)


def test_the_regime_is_printed(blocks):
    assert "partial slip, slip range up to" in printed("show", blocks)
