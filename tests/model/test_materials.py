"""The named materials."""

import copy
import pickle

import pytest

import fastpin
from fastpin import MATERIALS, InputError


@pytest.mark.parametrize(
    ("name", "words"),
    [("Steel", 'did you mean "steel"?'), ("7075", 'did you mean "7075-T6"?'), (3, "not 3"), (None, "not")],
)
def test_an_unknown_material_gets_one_sentence(name: object, words: str) -> None:
    with pytest.raises(InputError) as caught:
        MATERIALS[name]  # type: ignore[index]
    assert isinstance(caught.value, KeyError)
    assert str(caught.value).startswith('material: must be "Ti-6Al-4V", "aluminium", "steel", ')
    assert words in str(caught.value)
    again = pickle.loads(pickle.dumps(caught.value))
    assert (type(again), str(again)) == (type(caught.value), str(caught.value))


def test_the_materials_are_a_dict() -> None:
    assert MATERIALS.get("Steel") is None
    assert "Steel" not in MATERIALS
    for other in (pickle.loads(pickle.dumps(MATERIALS)), copy.deepcopy(MATERIALS)):
        assert other == MATERIALS
        with pytest.raises(fastpin.InputError, match="did you mean"):
            other["Steel"]
