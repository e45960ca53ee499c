"""Recordings of lives of wear: a page with a slider of cycles."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import fastpin
from fastpin.live import recording as life_module
from fastpin.live.recording import record_life
from fastpin.wear_lives import WearResult
from tests.support.live_pages import floats, recorded
from tests.support.lives import fretting
from tests.support.wear_cases import WEAR_CASES

pytestmark = pytest.mark.gate


@pytest.fixture(scope="module")
def result() -> WearResult:
    return fretting(cycles=10, at=(3,), nodes=21)


@pytest.fixture(scope="module")
def recording(result: WearResult) -> dict:
    return recorded(record_life(result, "Fretting"))


def test_a_recording_holds_the_states_of_all_stored_cycles(result: WearResult, recording: dict) -> None:
    cycles = recording["life"]["cycles"]
    assert [each["cycle"] for each in cycles] == [0, 3, 10]
    assert (recording["add"], recording["case"]["title"]) == ([], "Fretting")
    serials = [picture["serial"] for each in cycles for picture in each["pictures"]]
    assert serials == list(range(1, 10))
    for each, worn in zip(cycles, result, strict=True):
        for picture, state in zip(each["pictures"], worn.states, strict=True):
            assert picture["load"] == state.load
            for name in ("pressure", "shear", "gap"):
                assert np.array_equal(floats(picture[name]), getattr(state, name).astype("<f4"))


def test_worn_depths_and_numbers_are_those_of_the_life(result: WearResult, recording: dict) -> None:
    life = recording["life"]
    shown = {each["name"]: each for each in life["quantities"]}
    assert shown["worn volume"]["values"] == [each.volume for each in result]
    assert shown["largest depth"]["values"] == [each.depth for each in result]
    assert shown["dissipated in a cycle"]["values"] == [each.energy_per_cycle for each in result]
    assert shown["largest pressure"]["values"] == [each.largest_pressure for each in result]
    assert all(each["kind"] in recording["case"]["units"] for each in shown.values())
    assert life["cycles"][-1]["pin_share"] == pytest.approx(0.2)
    worn = life["cycles"][-1]["worn"]
    degrees, order = floats(worn["degrees"]), np.argsort(result.theta)
    assert np.allclose(degrees, np.degrees(result.theta[order]) + 90.0, atol=1e-4)
    assert np.array_equal(floats(worn["pin"]), result[-1].pin_depth[order].astype("<f4"))
    assert np.array_equal(floats(worn["hole"]), result[-1].plate_depth[order].astype("<f4"))


def test_the_damage_is_that_of_the_material_that_is_still_there(result: WearResult, recording: dict) -> None:
    """The titanium of the pin has no constants for a life."""
    life, found = recording["life"], result.fatigue()
    assert list(life["damage"]["values"]) == ["plate"]
    assert life["damage"]["words"] == [f"plate, smith-watson-topper: {found.words}"]
    (largest,) = [each["values"] for each in life["quantities"] if each["name"] == "largest damage, plate"]
    assert largest == [spot.damage for spot in found.hot_spots]
    assert largest[-1] > 0.0
    degrees = floats(life["damage"]["degrees"])
    assert np.all(np.diff(degrees) >= 0.0)
    for text, spot in zip(life["damage"]["values"]["plate"], found.hot_spots, strict=True):
        values = floats(text)
        assert values.max() == np.float32(spot.damage)
        if spot.damage:
            assert degrees[np.argmax(values)] == pytest.approx(np.degrees(spot.theta) + 90.0, abs=1e-3)


def test_depths_round_the_whole_hole_go_on_to_the_top() -> None:
    case = WEAR_CASES["lobed hole"]
    result = fastpin.wear(case.problem, case.history(), cycles=2, plate=5.0, tolerance=0.0, grid=case.grid(21))
    worn = recorded(record_life(result))["life"]["cycles"][-1]["worn"]
    degrees, hole = floats(worn["degrees"]), floats(worn["hole"])
    assert (degrees[0], degrees[-1], degrees.size) == (-180.0, 180.0, 23)
    assert hole[0] == hole[-1]
    assert not floats(worn["pin"]).any()
    assert hole.max() == np.float32(result[-1].depth)


def test_of_many_cycles_an_even_choice_is_recorded(result: WearResult, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(life_module, "MOST_PICTURES", 6)
    life = recorded(record_life(result))["life"]
    assert [each["cycle"] for each in life["cycles"]] == [0, 10]
    assert [len(each["values"]) for each in life["quantities"]] == [2] * 5
    assert [len(texts) for texts in life["damage"]["values"].values()] == [2]
    assert life["stored"] == 3


def test_what_is_not_modelled_and_what_is_in_doubt_is_told(result: WearResult, recording: dict) -> None:
    """A pin that slips by more than a node distance turns its own profile."""
    assert recording["life"]["remark"] == "debris is not modelled"
    assert recording["case"]["doubts"] == []
    problem = fastpin.Problem(result.problem.pair, 0.01, 5e-5, 0.4, rotation="fixed")
    turns = fastpin.LoadHistory([{"rotation": -0.1}, {"rotation": 0.1}]).repeated(1)
    turned = fastpin.wear(problem, fastpin.LoadHistory([{"P": 1e6}]) + turns, pin=1e-15, nodes=21, tolerance=0.0)
    (doubt,) = recorded(record_life(turned))["case"]["doubts"]
    assert "the pin slips by" in doubt
    assert [str(each) for each in turned.doubts] == [doubt]


def test_a_life_that_ended_at_its_beginning_has_one_cycle_and_no_damage(result: WearResult) -> None:
    begun = replace(result, cycles=result.cycles[:1], complete=False)
    found = recorded(record_life(begun, sentence="interrupted"))
    assert found["sentence"] == "interrupted"
    assert [each["cycle"] for each in found["life"]["cycles"]] == [0]
    assert found["life"]["damage"] == {"degrees": "", "words": [], "values": {}}


def test_what_is_no_life_with_cycles_is_refused(result: WearResult) -> None:
    with pytest.raises(fastpin.InputError, match=r"result: must be a fastpin\.wear_lives\.WearResult"):
        record_life([])  # type: ignore[arg-type]
    with pytest.raises(fastpin.InputError, match="result: there is no stored cycle to record"):
        record_life(replace(result, cycles=(), complete=False))
