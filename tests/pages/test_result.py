"""The page of a result: what it holds, what it escapes, what it refuses, and how it treats long histories."""

import base64
import dataclasses
import pickle
import re
import tempfile
from collections.abc import Callable
from pathlib import Path

import pytest

import fastpin
from fastpin.assess.outputs import MAX_ROWS
from fastpin.bodies import Bushing
from fastpin.errors import InputError, OutputError
from fastpin.figures.states import Subject
from fastpin.figures.stick_slip import stick_slip_plot
from fastpin.model import Laminate, Material, MaterialPair
from fastpin.model.loads import LOAD, LOADS
from fastpin.model.options import OPTIONS, SolveOptions
from fastpin.pages import content, sections, write_report
from fastpin.pages.content import Album, Facts, Text
from fastpin.pages.source import MOST_DRAWN, Source
from fastpin.solver.errors import Interrupted
from fastpin.states.quantities import QUANTITIES
from fastpin.storage.layout import RESIDUALS
from fastpin.storage.stored import StoredResult
from tests.support.drawing import outline_figures
from tests.support.html import Page, words_of
from tests.support.samples import JOINT, sample_result
from tests.support.tiers import for_gate, gate

CASE = f"""title = "A <b>bold</b> & \\"quoted\\" title <script>alert(1)</script>"
{JOINT}
[[load]]
P = 1e6
[[load]]
Q = [1e5, -1e5]
repeat = 30
[solve]
nodes = 61
"""


@pytest.fixture(scope="module")
def stored(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A stored result of 61 corners that becomes periodic, and its case file beside it."""
    folder = tmp_path_factory.mktemp("pages")
    (folder / "case.toml").write_text(CASE)
    case, path = fastpin.read_case(folder / "case.toml"), folder / "result.h5"
    fastpin.record(case.problem, case.history, path, title=case.title, nodes=61)
    return path


@pytest.fixture(scope="module")
@for_gate
def text(stored: Path) -> str:
    """The page of the stored result, with its case file."""
    path = stored.with_name("page.html")
    with pytest.MonkeyPatch.context() as patch:
        outline_figures(patch)
        write_report(stored, path, case=stored.with_name("case.toml"))
    return path.read_text(encoding="utf-8")


@pytest.fixture
def only(monkeypatch: pytest.MonkeyPatch) -> Callable[..., None]:
    """A function that leaves these sections on the page: all of them take half a second."""
    return lambda *chosen: monkeypatch.setattr("fastpin.pages.result.SECTIONS", chosen)


def test_page_is_well_formed_and_needs_nothing_from_outside(text: str) -> None:
    page = Page(text)
    assert len(page.ids) == len(set(page.ids))
    assert {link.removeprefix("#") for link in page.links} <= set(page.ids)
    assert all(source.startswith("data:image/png;base64,") for source in page.sources)
    assert not {"script", "link", "iframe", "object", "base", "form"} & set(page.tags)
    assert "http" not in re.sub(r'http-equiv="[^"]*"', "", text)
    assert "@import" not in text
    assert re.findall(r"url\((?!#)", text) == []
    assert len(text) < 1_000_000


def test_figures_keep_their_colours_and_lose_ids_that_nothing_refers_to(tmp_path: Path) -> None:
    figure = """<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink" width="9" height="9"
     viewBox="0 0 9 9"><metadata>of no use</metadata><defs><style>* {fill: red}</style><pattern id="h"/></defs>
     <g id="unused"><path id="p" fill="#a8d8f0" style="stroke: url(#h)"/><use xlink:href="#p" clip-path="url(#h)"/></g>
     </svg>"""
    found = Album().picture(lambda path: path.write_text(figure), "words", "caption").markup
    _, *elements = Page(found).attributes
    assert elements == [
        ("defs", {}), ("pattern", {"id": "f1-1"}), ("g", {}),
        ("path", {"id": "f1-2", "fill": "#a8d8f0", "style": "stroke: url(#f1-1)"}),
        ("use", {"href": "#f1-2", "clip-path": "url(#f1-1)"}),
    ]  # fmt: skip


def test_page_can_be_read_without_seeing_it(text: str) -> None:
    page = Page(text)
    elements = page.attributes
    assert ("html", {"lang": "en"}) in elements
    assert page.tags.count("h1") == 1
    assert all(found.get("alt") for tag, found in elements if tag == "img")
    assert all(found.get("aria-label") and found.get("role") == "img" for tag, found in elements if tag == "svg")
    assert page.tags.count("svg") + page.tags.count("img") == page.tags.count("figcaption") >= 6
    assert page.tags.count("table") == page.tags.count("caption") == page.tags.count("thead")
    assert all(found.get("scope") in ("row", "col") for tag, found in elements if tag == "th")
    assert any(tag == "meta" and found.get("name") == "viewport" for tag, found in elements)


def test_every_section_stands_in_the_contents(text: str) -> None:
    page = Page(text)
    names = [found["id"] for tag, found in page.attributes if tag == "section"]
    assert len(names) == len(sections.SECTIONS) - 4 == 13  # no seat and no questions
    links = [found["href"] for tag, found in page.attributes if tag == "a"]
    assert links == ["#content", *(f"#{name}" for name in names)]


def test_text_of_the_user_is_escaped(text: str) -> None:
    page = Page(text)
    assert "b" not in page.tags
    assert page.text.count('A <b>bold</b> & "quoted" title <script>alert(1)</script>') == 2  # title and heading


def test_page_names_case_loads_key_figures_checks_and_origin(text: str, stored: Path) -> None:
    words = Page(text).text
    result = fastpin.load(stored)
    for part in (
        "Ti-6Al-4V", "hole radius 10 mm, clearance 20 um, friction 0.4", "9.98 mm", "force on the pin downwards",
        f"{max(state.peak_pressure for state in result) / 1e6:.5g} MPa", "periodic from cycle", "x 30", "met",
        f"fastpin {fastpin.__version__}", "SHA-256 of the file", "[[load]]\nP = 1e6", "id of the input",
        "There are no error bars", "fastpin converge CASE.toml",
    ):  # fmt: skip
        assert part in words, part
    assert "not met" not in words


def test_rows_that_repeat_are_folded(text: str, stored: Path) -> None:
    states, gaps = Source.of_file(StoredResult(stored)).rows
    points = [state.step + 1 for state in states]
    ((row, words),) = gaps.items()
    first, last, begin, end, times = map(int, re.findall(r"\d+", words))
    assert words == f"{first} to {last}: repeat load points {begin} to {end}, {times} times"
    assert points[row - 1] == first - 1 == end
    assert last - first + 1 == times * (end - begin + 1)
    assert len(states) + last - first + 1 == 61
    assert max(points[-1], last) == 61
    full = fastpin.load(stored)
    period = end - begin + 1
    for place in range(first - 1, last):
        assert full[place].peak_pressure == pytest.approx(full[place - period].peak_pressure, rel=1e-4)
    assert words in text


@pytest.mark.gate
@pytest.mark.usefixtures("undrawn")
def test_a_gap_may_be_the_last_row(tmp_path: Path) -> None:
    result = sample_result([{"P": 1e6}, *[{"P": 1e6}] * 8], nodes=21)
    states = [dataclasses.replace(result[0], step=step) for step in range(9)]
    write_report(dataclasses.replace(result, states=states), tmp_path / "a.html")
    assert "… 2 to 9: repeat load point 1, 8 times …" in (tmp_path / "a.html").read_text()


@pytest.mark.parametrize(("joined", "words"), [(69, "Only 60 of 70 states, load points 1 to 60: stick"), (70, "Stick")])
def test_a_map_holds_all_states_or_says_that_it_does_not(joined: int, words: str, undrawn: None, monkeypatch) -> None:
    monkeypatch.setattr("fastpin.pages.source.MOST_JOINED", joined)
    source = Source.of_result(sample_result([{"P": 1e6 + 100.0 * k} for k in range(70)], nodes=21))
    picture = Album().figure(stick_slip_plot(Subject(source.mapped)))
    assert picture.caption.startswith(f"{words} and slip over the angle")


@pytest.mark.gate
def test_few_states_of_a_long_history_are_read_and_drawn(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("fastpin.report.states.MOST_COMPARED", 100)
    result = sample_result([{"P": 1e6 + 100.0 * k, "Q": 1e5 * (-1) ** k} for k in range(200)], nodes=21)
    source = Source.of_result(result)
    read: list[int] = []
    monkeypatch.setattr(source.held, "read", lambda places: read.extend(places) or [result[k] for k in places])
    states, gaps = source.rows
    assert (len(states), gaps) == (MAX_ROWS, {MAX_ROWS // 2: "160 more"})
    assert len(source.drawn) == MOST_DRAWN
    assert 199 in read
    assert len(read) == MAX_ROWS + MOST_DRAWN + 1  # one tells the load at the beginning


@pytest.mark.gate
def test_the_extremes_of_a_long_history_are_drawn_and_have_rows() -> None:
    corners = [{"P": 3e6 if k == 77 else 1e6 + 100.0 * k} for k in range(200)]
    source = Source.of_result(fastpin.solve(sample_result().problem, corners, nodes=61))
    words = "largest pressure, largest shear, largest hoop stress, largest von Mises stress of the pin"
    assert source.held.marks == {77: words}
    assert [state.step for state in source.held.peaks] == [77]
    assert [state.step for state in source.drawn][-1] == 199
    assert dict(zip((state.step for state in source.drawn), source.drawn.marks, strict=True))[77] == words
    states, gaps = source.rows
    assert 77 in [state.step for state in states]
    assert gaps == {20: "57 more", 21: "102 more"}


def test_the_last_closed_part_of_a_history_without_blocks_is_its_cycle() -> None:
    corners = [{"P": 2e6, "Q": load} for load in (0.0, 4e5, -4e5, 1e5, 4e5)]
    source = Source.of_result(sample_result(corners))
    assert (source.cycle.first, source.cycle.last) == (2, 5)
    assert Source.of_result(sample_result(corners[:4])).cycle is None


@pytest.mark.gate
def test_a_result_in_memory_has_the_same_page(tmp_path: Path) -> None:
    path, calls = tmp_path / "page.htm", []
    result = fastpin.solve(
        sample_result().problem, [{"P": 1e6}, {"Q": 1e5}, {"Q": -1e5}, {"Q": 1e5}], nodes=121, error_bars=True
    )
    result.report(path, title="My joint", progress=lambda done, total: calls.append((done, total)))
    words = Page(path.read_text(encoding="utf-8")).text
    assert "My joint" in words
    assert "a result in memory" in words
    assert re.search(r"\d ± \d", words)
    assert "There are no error bars" not in words
    assert "shortcut" not in words  # the options of the solver are not known
    assert calls == [(k, len(sections.SECTIONS) - 4) for k in range(len(sections.SECTIONS) - 3)]


@pytest.mark.usefixtures("undrawn")
def test_a_convergence_study_is_shown(only: Callable[..., None], tmp_path: Path) -> None:
    only(sections.convergence)
    result = sample_result()
    study = fastpin.converge(result.problem, [{"P": 2.42e6}], nodes=(51, 101, 201))
    words = words_of(result, tmp_path / "page.html", convergence=study)
    assert "Corner 1, path solver" in words
    assert "Distance to the limit" in words
    assert "There is no convergence study" not in words


@pytest.mark.gate
@pytest.mark.usefixtures("undrawn")
def test_the_case_file_beside_a_result_is_shown_if_it_is_that_of_the_result(only, tmp_path):
    only(sections.provenance)
    file, page = tmp_path / "result.h5", tmp_path / "page.html"
    sample_result().save(file)
    own = f'{JOINT}\npin_load = "body"\n[[load]]\nP = 2.42e6\n[[load]]\nQ = [4.84e5, -4.84e5]\n'
    for text, shown in ((own, True), (own.replace("0.4", "0.3"), False), ("[pin", False), (None, False)):
        file.with_suffix(".toml").unlink(missing_ok=True)
        if text is not None:
            file.with_suffix(".toml").write_text(text)
        words = words_of(file, page)
        assert (own in words) == shown
        assert ("--case CASE.toml shows it" in words) != shown


@pytest.mark.usefixtures("undrawn")
def test_a_branch_begins_with_the_loads_of_its_start(only: Callable[..., None], tmp_path: Path) -> None:
    only(sections.loads)
    problem = sample_result().problem
    first = fastpin.solve(problem, [{"P": 1e6}], nodes=61, arc=(-3.0, -0.2))
    branch = fastpin.solve(problem, [{"Q": 1e5}, {"Q": -1e5}], start=first)
    source = Source.of_result(branch)
    assert source.initial == pytest.approx([1e6 if name == "P" else 0.0 for name in LOADS], rel=1e-12)
    assert not Source.of_result(first).initial.any()
    words = words_of(branch, tmp_path / "page.html")
    assert "It begins with its loads: P = 1 MN/m." in words
    assert "from no load" not in words


@pytest.mark.gate
@pytest.mark.usefixtures("drawn")
def test_a_figure_has_the_same_markup_each_time_and_refers_to_its_own_elements() -> None:
    result = sample_result(nodes=21)
    first, second = (
        Album().picture(lambda path: fastpin.plot_tractions(result, path), "words", "caption") for _ in range(2)
    )
    assert first == second
    used = set(re.findall(r"url\(#([^)]+)\)", first.markup))
    assert len(used) >= 3
    assert used <= set(Page(first.markup).ids)


def test_a_large_figure_becomes_a_bitmap(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(content, "MOST_SVG", 10)
    bitmap = b"\x89PNG\r\n\x1a\n" + bytes([0, 0, 0, 13]) + b"IHDR" + bytes([0, 0, 0, 200, 0, 0, 0, 100])
    drawn = {".svg": b"a figure that is too long", ".png": bitmap}
    found = Album().picture(lambda path: path.write_bytes(drawn[path.suffix]), 'say "so"', "caption")
    (element,) = Page(found.markup).attributes
    assert element[0] == "img"
    assert base64.b64decode(element[1]["src"].rpartition(",")[2]) == bitmap
    assert element[1]["alt"] == 'say "so"'


@pytest.mark.gate
@pytest.mark.usefixtures("undrawn")
def test_a_run_that_goes_on_or_ended_early_has_a_page(only: Callable[..., None], tmp_path: Path) -> None:
    only(sections.overview)
    problem, path, page = sample_result().problem, tmp_path / "a.h5", tmp_path / "a.html"
    found: list[str] = []

    def stop(done: float, total: float) -> None:
        if done >= 3.0:
            found.append(words_of(path, page))
            raise Interrupted

    with pytest.raises(Interrupted):
        fastpin.record(problem, [{"P": k * 1e5} for k in range(1, 9)], path, nodes=61, arc=(-3.0, -0.2), progress=stop)
    ended = words_of(path, page)
    for words in (*found, ended):
        assert "Unfinished: corner" in words
        assert ("Its run goes on." in words) == (words in found)
        assert (f"fastpin resume {path}" in words) == (words not in found)
    assert "interrupted" in ended


@pytest.mark.usefixtures("undrawn")
def test_a_result_without_states_says_what_is_missing(tmp_path: Path) -> None:
    empty = sample_result(complete=False)
    empty.states.clear()
    words = words_of(empty, tmp_path / "page.html")
    assert words.count("There is no state") >= 5
    assert "Unfinished" in words


@pytest.mark.usefixtures("undrawn")
def test_doubtful_values_and_notes_stand_in_the_overview(only: Callable[..., None], tmp_path: Path) -> None:
    only(sections.overview, sections.materials)
    result = sample_result(friction=4.0)
    result.statistics["jumps"] = 2.0
    words = words_of(result, tmp_path / "page.html")
    assert re.search(r"Warning: friction: 4 is above 2[^\n]*\.", words)
    assert "Note: the pin snapped 2 times; work does not balance there." in words
    assert "828 MPa" in words  # the yield strength of the pin


@pytest.mark.usefixtures("undrawn")
def test_the_materials_show_a_laminate_with_its_plies_and_sources(only: Callable[..., None], tmp_path: Path) -> None:
    only(sections.materials)
    plate = Laminate.from_layup("[0/45/-45/90]2s", "T300/5208")
    problem = fastpin.Problem(MaterialPair(Material(210e9, 0.3), plate, "stress"), 10e-3, 2e-5, 0.2)
    history = fastpin.LoadHistory([{"P": 1e6}, {"P": 5e5}]).repeated(2)
    words = words_of(fastpin.solve(problem, history, nodes=31), tmp_path / "page.html")
    assert "[0/45/-45/90]2s of T300/5208" in words
    assert "69.676 GPa" in words
    assert "axis 1 at 0 deg from the bottom" in words
    assert "Source of the constants of T300/5208: Jones, Mechanics of Composite Materials" in words


@pytest.mark.usefixtures("undrawn")
@pytest.mark.filterwarnings("ignore::fastpin.errors.InputWarning")
@pytest.mark.parametrize(("interference", "clearance"), [*gate((30e-6, 15e-6)), (0.0, -20e-6), (0.0, 40e-6)])
def test_the_pin_radius_is_that_of_the_free_pin(interference: float, clearance: float) -> None:
    bush = Bushing(Material(103e9, 0.34, yield_strength=138e6), 12.5e-3, interference)
    pair = MaterialPair(Material(210e9, 0.3), Material(71e9, 0.33))
    problem = fastpin.Problem(pair, 10e-3, clearance, 0.2, plate_body=bush)
    page = sections.PageParts(Source.of_result(fastpin.solve(problem, [{"P": 1e5}], nodes=61)), Album())
    rows = dict(next(part.rows for part in sections.case(page).parts if isinstance(part, Facts)))
    assert rows["pin radius"] == f"{1e3 * (10e-3 - clearance):.6g} mm"
    name = "clearance after the press fit / radius" if interference else "clearance / radius"
    assert rows[name] == f"{problem.assembled_clearance / 10e-3:.4g}"
    # the press fit that yields stands in the overview
    notes = [part.words for part in sections.overview(page).parts if isinstance(part, Text)]
    assert any("in the bore of the bush, before any load" in note for note in notes) == (clearance < 40e-6)


@pytest.mark.usefixtures("undrawn")
def test_a_pin_that_does_not_touch_has_no_tractions(tmp_path: Path) -> None:
    result = fastpin.solve(sample_result().problem, [{"sxx": 1e6}], nodes=61)
    words = words_of(result, tmp_path / "page.html")
    assert "Pin and hole do not touch in the drawn states." in words
    assert "no contact" in words
    assert "The pin touches the hole in no kept state." in words
    assert "nan" not in words.split()


@pytest.mark.usefixtures("undrawn")
def test_loops_of_few_states_are_doubted(only: Callable[..., None], tmp_path: Path) -> None:
    only(sections.hysteresis)
    result = sample_result([{"P": 2e6, "Q": load} for load in (0.0, 4e5, -4e5, 1e5, 4e5)])
    assert "Corners 2 to 5: the areas differ by " in words_of(result, tmp_path / "page.html")


def test_words_cover_all_names() -> None:
    assert all(each.words for each in (*QUANTITIES.values(), *LOAD.values()))
    assert all(each["words"] for each in OPTIONS.values())
    assert set(OPTIONS) == set(SolveOptions().keywords())
    assert set(sections.RESIDUAL_WORDS) == set(RESIDUALS)


@pytest.mark.parametrize(
    ("change", "field", "words"),
    [
        ({"path": "page.txt"}, "path", 'must be the name of a page, which ends in .html, .htm or .pdf, not "page.txt"'),
        ({"path": "no/page.html"}, "no/page.html", "the directory no does not exist"),
        ({"result": "missing.h5"}, "missing.h5", "there is no such file"),
        ({"result": "junk.h5"}, "junk.h5", "is no HDF5 file, and no result"),
        ({"result": 3.0}, "result", "must be"),
        ({"title": 5}, "title", "must be"),
        ({"about": "me"}, "about", "must be an About"),
        ({"case": "other.toml"}, "case", "other.toml is not the case of this result: friction differs"),
        ({"convergence": 5}, "convergence", "must be a Convergence"),
        ({"progress": 5}, "progress", "must be"),
    ],
)
def test_wrong_input_is_one_sentence_and_loses_nothing(change, field, words, stored, monkeypatch):
    folder = stored.parent
    monkeypatch.chdir(folder)
    Path("junk.h5").write_bytes(b"junk")
    Path("other.toml").write_text(CASE.replace("friction = 0.4", "friction = 0.3"))
    Path("kept.html").write_text("kept")
    given = {"result": stored, "path": "kept.html", **change}
    with pytest.raises(InputError, match=re.escape(words)) as caught:
        write_report(given.pop("result"), given.pop("path"), **given)  # type: ignore[arg-type]
    assert caught.value.field == field
    assert str(pickle.loads(pickle.dumps(caught.value))) == str(caught.value)
    assert Path("kept.html").read_text() == "kept"
    assert [path.name for path in folder.glob(".*")] == []


def test_the_result_is_never_overwritten(stored: Path) -> None:
    odd = stored.with_name("result.html")
    odd.write_bytes(stored.read_bytes())
    with pytest.raises(InputError, match="is a stored result, which only a result replaces"):
        write_report(odd, odd)
    assert odd.read_bytes() == stored.read_bytes()


def test_a_full_directory_of_temporary_files_is_named(tmp_path, monkeypatch) -> None:
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))

    def draw(path: Path) -> None:
        raise OutputError(str(path), "can't be written: No space left on device")

    with pytest.raises(OutputError) as caught:
        Album().picture(draw, "words", "caption")
    words = "a figure of the page can't be written: No space left on device; set TMPDIR to another directory"
    assert str(caught.value) == f"{tmp_path}: {words}"
    assert not [*tmp_path.iterdir()]
