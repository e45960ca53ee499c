"""The largest values of a long history are the same wherever they are told: text, page, figure, JSON, Python, file."""

import json
import re
from dataclasses import replace
from pathlib import Path

import h5py
import numpy as np
import pytest

import fastpin
from fastpin import figures, storage
from fastpin.cli.main import main
from fastpin.states.extremes import READINGS, Extreme, marked_places
from fastpin.storage import stored_states
from fastpin.storage.stored import StoredResult
from tests.support.tiers import gate, some_survey

pytestmark = pytest.mark.gate

CASE = """
pin.material = "steel"
plate.material = "{plate}"
[contact]
hole_radius = 10e-3
clearance = {clearance}
friction = 0.3
thickness = 10e-3
{body}
[solve]
nodes = 61
"""

BUSH = """
[plate_body]
material = "C93200"
outer_radius = 12.5e-3
interference = 30e-6
"""

PEAKS = {"plain": 70, "bush": 33}
"""The place of the largest load, and of the extremes."""


def case_text(kind: str) -> str:
    """A case of many turning points, of which one goes much farther than the others."""
    peak, count = PEAKS[kind], 100 if kind == "plain" else 46
    rng = np.random.default_rng(3)
    forces = [3e3 if k % 2 else rng.uniform(27e3, 30e3) for k in range(count)]  # no rows that repeat earlier ones
    sideways = [0.0] * count if kind == "plain" else rng.uniform(-2e3, 2e3, count).tolist()
    forces[peak], sideways[peak] = 60e3, 0.0
    given = {"plate": "aluminium", "clearance": "20e-6", "body": ""}
    if kind == "bush":
        given = {"plate": "7075-T6", "clearance": "40e-6", "body": BUSH}
    steps = [f"[[load]]\nP = {P:.3f}\nQ = {Q:.3f}" for P, Q in zip(forces, sideways, strict=True)]
    return CASE.format(**given) + "\n".join(steps)


@pytest.fixture(scope="module", params=some_survey(["plain", "bush"], "bush"))
def stored(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp(request.param) / f"{request.param}.toml"
    path.write_text(case_text(request.param), encoding="utf-8")
    case = fastpin.read_case(path)
    fastpin.record(case.problem, case.history, path.with_suffix(".h5"), nodes=61)
    return path.with_suffix(".h5")


@pytest.fixture(scope="module")
def readings(stored: Path) -> dict[str, list[float]]:
    """Each quantity of every state, read one by one."""
    states = list(fastpin.load(stored))
    names = ["peak_pressure", "peak_shear", "peak_hoop"]
    names += ["peak_hoop_seat", "bush_open_margin", "bush_least_friction"] if stored.stem == "bush" else []
    return {name: [READINGS[name].of(state) for state in states] for name in names}


@pytest.fixture(scope="module")
def sentences(stored: Path, readings: dict[str, list[float]]) -> list[str]:
    """The sentences on hoop stress and bush as they must be."""
    hoop, body = readings["peak_hoop"], "bush" if stored.stem == "bush" else "plate"
    found = [f"largest hoop stress of the {body} in all kept states: {max(hoop) / 1e6:.4g} MPa"]
    found.append(f"load point {1 + hoop.index(max(hoop))};")
    if body == "bush":
        seat = max(readings["peak_hoop_seat"]) / 1e6
        found.append(f"largest hoop stress of the plate at the seat in all kept states: {seat:.4g} MPa")
        margin, friction = min(readings["bush_open_margin"]) / 1e6, max(readings["bush_least_friction"])
        found.append(f"smallest pressure between bush and plate in all kept states: {margin:.4g} MPa")
        found.append(f"the bush sticks with a friction of {friction:.3g} or more")
    return found


def test_python_and_json_agree_with_every_state(stored: Path, readings: dict[str, list[float]], tmp_path: Path) -> None:
    result, peak = fastpin.load(stored), PEAKS[stored.stem]
    found = result.extremes()
    for name, values in readings.items():
        assert (found[name].smallest.value, found[name].largest.value) == (min(values), max(values))
    assert found["peak_pressure"].largest.place == peak
    assert found["peak_pressure"].largest.load_point == peak + 1.0
    assert main(["show", str(stored), "--json", str(tmp_path / "a.json")]) == 0
    told = json.loads((tmp_path / "a.json").read_text(encoding="utf-8"))["extremes"]
    assert told["peak_pressure"]["largest"] == found["peak_pressure"].largest._asdict()
    assert told.keys() == found.keys()


def test_run_and_show_tell_the_largest_of_all(stored, sentences, capsys):
    peak = PEAKS[stored.stem] + 1
    for words in (["show", str(stored)], ["run", str(stored.with_suffix(".toml"))]):
        assert main(words) == 0
        text = capsys.readouterr().out
        for sentence in sentences:
            assert sentence in text
        assert "\\n" not in text
        assert any(line.split()[:2] == [str(peak), "60"] for line in text.splitlines())


def test_the_page_tells_and_draws_the_largest_of_all(stored, sentences, readings, tmp_path):
    page = tmp_path / "page.html"
    assert main(["report", str(stored), "-o", str(page)]) == 0
    text = page.read_text(encoding="utf-8")
    for sentence in sentences:
        assert sentence[1:] in text
    largest = max(readings["peak_pressure"]) / 1e6
    assert f"argest contact pressure in all kept states: {largest:.5g} MPa, load point {PEAKS[stored.stem] + 1}" in text
    drawn = re.findall(r"round the hole, at load points ([^.]*)\.", text)
    assert drawn
    assert all(str(PEAKS[stored.stem] + 1) in each.split(", ") for each in drawn)


def test_figures_draw_the_states_of_extremes(stored: Path, readings: dict[str, list[float]]) -> None:
    peak = PEAKS[stored.stem]
    for drawn in (figures.states.drawn_states(StoredResult(stored)), figures.states.drawn_states(fastpin.load(stored))):
        assert len(drawn) <= figures.style.MAX_NAMED
        words = dict(zip((state.step for state in drawn), drawn.marks, strict=True))
        assert words[peak] == "largest pressure, largest shear"
    hoop = figures.states.drawn_states(StoredResult(stored), extremes=figures.states.HOOP["plate"])
    best = readings["peak_hoop"].index(max(readings["peak_hoop"]))
    assert dict(zip((state.step for state in hoop), hoop.marks, strict=True))[best] == "largest hoop stress"
    if stored.stem == "bush":
        seat = figures.states.drawn_states(StoredResult(stored), extremes=figures.states.HOOP["seat"])
        best = readings["peak_hoop_seat"].index(max(readings["peak_hoop_seat"]))
        marks = dict(zip((state.step for state in seat), seat.marks, strict=True))
        assert marks[best] == "largest hoop stress at the seat"


# -- stored extremes -------------------------------------------------------------------------------------------------


LEAST = 60
"""Number of states from which on the files of these tests have extremes."""


@pytest.fixture
def least(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(stored_states, "LEAST_STORED", LEAST)


@pytest.fixture(scope="module")
def long(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A result with stored extremes."""
    path = tmp_path_factory.mktemp("long") / "a.h5"
    case = fastpin.LoadHistory([{"P": 1e6}, {"P": 2e6}]).repeated(LEAST // 2)
    pair = fastpin.MaterialPair(fastpin.MATERIALS["steel"], fastpin.MATERIALS["aluminium"])
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(stored_states, "LEAST_STORED", LEAST)
        fastpin.record(fastpin.Problem(pair, 0.01, 2e-5, 0.3), case, path, nodes=61)
    return path


def test_a_file_has_extremes_from_so_many_states_on(long: Path, least: None, tmp_path: Path) -> None:
    result = fastpin.load(long)
    for size, stored in ((LEAST - 1, False), (LEAST, True)):
        replace(result, states=result.states[:size]).save(tmp_path / f"{size}.h5")
        with h5py.File(tmp_path / f"{size}.h5") as file:
            assert ("extremes" in file) == stored


def test_a_long_result_has_its_extremes_in_the_file(long: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    known = storage.StoredResult(long).extremes
    monkeypatch.setattr(stored_states.StoredStates, "blocks", lambda self: pytest.fail("all states were read"))
    assert storage.StoredResult(long).extremes == known
    assert marked_places(known)


@pytest.mark.parametrize("damage", ["absent", "place", *gate("value"), "states", "names", "shape", "text"])
def test_extremes_in_a_file_are_checked(long: Path, tmp_path: Path, damage: str) -> None:
    path = tmp_path / "b.h5"
    path.write_bytes(long.read_bytes())
    with h5py.File(path, "r+") as file:
        group = file["extremes"]
        if damage == "absent":  # as in a file of an earlier version
            del file["extremes"]
        elif damage == "place":
            group["place"][0] = 10**9
        elif damage == "value":
            group["value"][0] *= 1.01
        elif damage == "states":
            group.attrs["states"] = 7
        elif damage == "names":
            group.attrs["names"] = ["peak_pressure largest"] * len(group["place"])
        else:
            del group["place"]
            group["place"] = np.zeros((3, 2)) if damage == "shape" else "x"
    found = {("peak_pressure", "largest"): Extreme(1.0, 2, 3.0)}
    with h5py.File(path, "r+") as file:
        assert stored_states.read_extremes(file, lambda _: found) is found
    if damage == "value":
        assert storage.StoredResult(path).extremes == storage.StoredResult(long).extremes


def test_a_saved_long_result_has_the_same_extremes(long: Path, least: None, tmp_path: Path) -> None:
    result = fastpin.load(long)
    result.save(tmp_path / "c.h5")
    with h5py.File(tmp_path / "c.h5") as file:
        assert "extremes" in file
    assert storage.StoredResult(tmp_path / "c.h5").extremes == storage.StoredResult(long).extremes
