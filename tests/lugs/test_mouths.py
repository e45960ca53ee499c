"""Mouths of cracks on edges beyond the hole: their places, their circles, and places that are no mouths."""

import math
from dataclasses import replace

import numpy as np
import pytest

from fastpin.errors import InputError
from fastpin.lugs import OtherEdges
from fastpin.lugs.mouths import FROM_ENDS, Mouth
from fastpin.lugs.outline import Hole, Part
from tests.support.lugs import lug_with_nose, outlined, plate


def text(value: float) -> str:
    return f"{value:.4g} R"


def stepped():
    """A lug with sides at 2.2 R, fillets of 0.4 R and sides at 3 R beyond."""
    centre = 2.6 + 5.6j
    side, top = 2.2 + 0j, 3.0 + 10j
    right = [("side", side, 2.2 + 5.6j, None), ("fillet", 2.2 + 5.6j, 2.6 + 6j, centre + 0.4 * np.exp(0.75j * math.pi)),
             ("step", 2.6 + 6j, 3.0 + 6j, None), ("wide", 3.0 + 6j, top, None)]  # fmt: skip
    left = [(name, -np.conj(b), -np.conj(a), c and -np.conj(c)) for name, a, b, c in reversed(right)]
    whole = [*right, ("top", top, -np.conj(top), None), *left, ("nose", -side, side, -2.2j)]
    parts = [Part(name, complex(a), complex(b), c and complex(c)) for name, a, b, c in whole]
    return replace(lug_with_nose(), outline=tuple(parts))


MOUTHS = {  # place as texts round it: edge, place, direction into the plate, radius
    2.21 + 3j: ("side", 2.2 + 3j, -1.0, None),
    2.32 + 5.88j: ("fillet", 2.6 + 5.6j + 0.4 * np.exp(0.75j * math.pi), np.exp(0.75j * math.pi), 0.4),
    -2.2j: ("nose", -2.2j, 1j, 2.2),
    3j + 0.501: ("bolt", 3j + 0.5, 1.0, 0.5),
}


@pytest.mark.parametrize("place", MOUTHS)
def test_a_mouth_lies_on_the_nearest_edge(place):
    lug = replace(stepped(), holes=(Hole("bolt", 3j, 0.5),))
    edge, expected, along, radius = MOUTHS[place]
    mouth = Mouth.at(lug, place, text)
    assert mouth.edge == edge
    assert mouth.place == pytest.approx(expected, abs=0.02)
    other = OtherEdges(outlined(lug), mouth)
    start, direction = other.start(*other.line(0.0, 0.0))
    assert (start, direction) == (mouth.place, pytest.approx(along, abs=0.02))
    assert radius is None or mouth.radius == pytest.approx(radius)
    mirrored = mouth.mirrored(np.array([start + 1e-3 * direction]))
    assert mirrored == pytest.approx(start - 1e-3 * direction, abs=1e-5)
    assert not lug.surrounds(mirrored)[0]


def test_a_mouth_keeps_from_the_ends_of_its_part_where_the_curvature_changes():
    mouth = Mouth.at(stepped(), 2.2 + 5.6j, text)
    assert abs(mouth.place - (2.2 + 5.6j)) == pytest.approx(FROM_ENDS, rel=1e-3)
    whole = replace(lug_with_nose(), holes=(Hole("bolt", 3j, 0.5),))
    assert Mouth.at(whole, 3.5j, text).place == pytest.approx(3.5j, abs=1e-12)  # quarters of one circle


@pytest.mark.parametrize(
    ("place", "words"),
    [
        (1.8 + 3j, 'place: must lie on an edge beyond the hole; the nearest one, "side", is 0.4 R away'),
        (1.0 + 10j, 'place: lies on "top", which is held, and a crack begins at a free edge'),
        (3.0 + 6j, "place: lies at the corner x = 3 R, y = 6 R: a crack begins beside it"),
    ],
)
def test_places_that_are_no_mouths(place, words):
    with pytest.raises(InputError) as refused:
        Mouth.at(stepped(), place, text)
    assert str(refused.value) == words


def test_the_line_is_known_up_to_edges_beside_it_and_up_to_mirror_images_in_the_plate():
    narrow = OtherEdges(outlined(plate())).at(2.5 - 2.4j, text)  # 0.1 above the bottom, along it
    assert narrow.ligament(0.0, 0.0) * narrow.radius == pytest.approx(5.0)
    assert narrow.known(0.0, 0.0) * narrow.radius == pytest.approx(1.0, abs=0.03)
    beside_step = OtherEdges(outlined(stepped())).at(2.2 + 5.0j, text)
    assert beside_step.known(0.0, 0.0) == beside_step.ligament(0.0, 0.0)
    line = beside_step.line(0.0, -math.radians(55.0))  # its mirror image climbs to the step
    known = beside_step.known(*line) * beside_step.radius
    assert 1.0 * math.tan(math.radians(35.0)) < 1.0 < known < 1.0 / math.sin(math.radians(55.0)) + 0.05
    assert known < beside_step.ligament(*line) * beside_step.radius
