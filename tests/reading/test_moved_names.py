"""Names that have moved to ``fastpin.reading`` are still found in ``fastpin.states``, with a warning."""

import pytest

import fastpin
from fastpin import reading


@pytest.mark.parametrize("name", ["BushFit", "HoopPeak", "Stress", "hoop", "joint", "refined", "stress"])
def test_names_have_their_old_place_too(name: str) -> None:
    with pytest.warns(DeprecationWarning, match=f"this is fastpin.reading.{name} now"):
        old = getattr(fastpin.states, name)
    assert old is getattr(reading, name)
    assert name not in dir(fastpin.states)


def test_other_names_are_missing() -> None:
    with pytest.raises(AttributeError, match="nothing"):
        fastpin.states.nothing  # noqa: B018
