"""The notation of layups: texts and angles, there and back, and one sentence for a wrong text."""

from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fastpin.errors import InputError
from fastpin.model.layup import MOST_PLIES, checked_angles, layup_text, parsed_layup
from tests.support.refusals import refused


@pytest.mark.parametrize(
    ("text", "angles"),
    [
        ("[0]", [0]),
        ("[0/90]", [0, 90]),
        ("[0/90]T", [0, 90]),
        ("[0/90]s", [0, 90, 90, 0]),
        ("[0/45/-45/90]2s", [0, 45, -45, 90, 0, 45, -45, 90, 90, -45, 45, 0, 90, -45, 45, 0]),
        ("[0/90]_2S", [0, 90, 0, 90, 90, 0, 90, 0]),
        ("[0/90]2_s", [0, 90, 0, 90, 90, 0, 90, 0]),
        ("[0/90]2", [0, 90, 0, 90]),
        ("[0_2/+-45]s", [0, 0, 45, -45, -45, 45, 0, 0]),
        ("[(0/90)2/45]s", [0, 90, 0, 90, 45, 45, 90, 0, 90, 0]),
        ("[(0/(30)_2)/45]", [0, 30, 30, 45]),
        ("[±45]", [45, -45]),
        ("[∓45]", [-45, 45]),
        ("[-+45/+/-30/-/+20]", [-45, 45, 30, -30, -20, 20]),
        ("[±45_2]", [45, -45, 45, -45]),
        ("[+45/-0/.5/1e1]", [45, 0, 0.5, 10]),
        (" [ 0 / 4 5_2 ] 1 s ", [0, 45, 45, 45, 45, 0]),
    ],
)
def test_a_layup_is_read(text: str, angles: list[float]) -> None:
    assert list(parsed_layup("layup", text)) == angles


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("[0/45//90]s", 'must be an angle at position 7 of "[0/45//90]s"'),
        ("", 'must begin with "[" at position 1 of ""'),
        ("0/90", 'must begin with "[" at position 1 of "0/90"'),
        ("[]", 'must be an angle at position 2 of "[]"'),
        ("[0/90", 'must go on with "/" or "]" at position 6 of "[0/90"'),
        ("[0,90]", 'must go on with "/" or "]" at position 3 of "[0,90]"'),
        ("[(0/90]", 'must go on with "/" or ")" at position 7 of "[(0/90]"'),
        ("[0_/90]", 'must be a count at position 4 of "[0_/90]"'),
        ("[0_0]", 'must be a count of at least 1 at position 3 of "[0_0]"'),
        ("[0]0s", 'must be a count of at least 1 at position 4 of "[0]0s"'),
        ("[0/90]x", 'must end with a count, "s" or "t" at position 7 of "[0/90]x"'),
        ("[0/90]sT", 'must end with a count, "s" or "t" at position 7 of "[0/90]sT"'),
        ("[0/400]", 'must be an angle of at most 360 degrees at position 4 of "[0/400]"'),
        ("[0 /  x]", 'must be an angle at position 7 of "[0 /  x]"'),
        ("[٣]", 'must be an angle at position 2 of "[٣]"'),
        ("[nan]", 'must be an angle at position 2 of "[nan]"'),
        ("[0]1000000000s", "must have at most 1,000 plies"),
        ("[0]" + "9" * 5_000, "must have at most 1,000 plies"),
        ("[0_1001]", "must have at most 1,000 plies"),
        ("[0_600/(90)600]", "must have at most 1,000 plies"),
        ("[0_501]s", "must have at most 1,000 plies"),
        ("[(((0_100)_100)_100)_100]", "must have at most 1,000 plies"),
        ("[" + "(" * 3_000, "must have at most 20 parentheses in one another at position 22 of"),
        ("[0" + "/0" * 10_000 + "]", "must have at most 10,000 characters, not 20,003"),
        ("[" + "0/" * 100 + "y", 'must be an angle at position 202 of "...0/0/0/0/0/0/0/0/0/0/0/0/0/0/0/y"'),
    ],
)
def test_a_wrong_layup_gets_a_sentence_with_its_place(text: str, words: str) -> None:
    error = refused(parsed_layup, "layup", text)
    assert str(error).startswith(f"layup: {words}")
    assert len(str(error)) < 200


@pytest.mark.parametrize(
    ("angles", "text"),
    [
        ([0], "[0]"),
        ([0] * 8, "[0]8"),
        ([0, 90, 0], "[0/90/0]"),
        ([0, 90, 90, 0], "[0/90]s"),
        ([0, 0, 45, -45, -45, 45, 0, 0], "[0_2/45/-45]s"),
        ([0, 45, -45, 90, 0, 45, -45, 90, 90, -45, 45, 0, 90, -45, 45, 0], "[0/45/-45/90]2s"),
        ([12.5, -12.5], "[12.5/-12.5]"),
        ([0, 90, 0, 90], "[0/90]2"),
    ],
)
def test_a_stack_has_a_usual_text(angles: list[float], text: str) -> None:
    assert layup_text(angles) == text


@pytest.mark.gate
@given(
    st.lists(st.sampled_from([0.0, 90.0, 45.0, -45.0]) | st.floats(-360.0, 360.0), min_size=1, max_size=30),
    st.booleans(),
)
def test_a_text_gives_its_angles_back(angles: list[float], folded: bool) -> None:
    stack = [angle + 0.0 for angle in angles]
    stack += stack[::-1] * folded
    assert list(parsed_layup("layup", layup_text(stack))) == stack


@given(st.text(st.sampled_from("[]()/0459_+-±s2T .e"), max_size=30))
def test_any_text_ends_in_angles_or_one_sentence(text: str) -> None:
    try:
        angles = parsed_layup("layup", text)
    except InputError:
        return
    assert 1 <= len(angles) <= MOST_PLIES
    assert parsed_layup("layup", layup_text(angles)) == angles


@pytest.mark.parametrize(
    ("layup", "words"),
    [
        (3, "must be a layup such as"),
        ([], "must have 1 to 1,000 plies, not 0"),
        ([0.0] * 1_001, "must have 1 to 1,000 plies, not 1,001"),
        ([0.0, "90"], 'must be a number, not "90"'),
        ([361.0], "must lie between -360 and 360"),
    ],
)
def test_wrong_angles_get_one_sentence(layup: Any, words: str) -> None:
    assert str(refused(checked_angles, "layup", layup)).startswith(f"layup: {words}")
