"""Finite plates: parts and their geometry, and outlines, holes and supports that are refused."""

import pickle

import numpy as np
import pytest

from fastpin.errors import InputError
from fastpin.lugs.outline import MOST_PARTS, Hole, Lug, Part, PartLoad, distances, rectangle
from tests.support.lugs import disc, plate

ARC = Part("arc", 1.0, -1.0, 1j)


@pytest.mark.parametrize("through", [1j, -1j, np.exp(0.1j), np.exp(-3.0j)])
def test_an_arc_goes_through_its_three_points(through):
    arc = Part("arc", 1.0, -1.0, complex(through))
    centre, radius, _, sweep = arc.circle
    assert abs(centre) < 1e-14
    assert radius == pytest.approx(1.0, rel=1e-14)
    assert sweep == pytest.approx(np.pi * np.sign(through.imag), rel=1e-14)
    assert arc.length == pytest.approx(np.pi, rel=1e-14)
    assert np.allclose(arc.at(np.array([0.0, 1.0])), [1.0, -1.0], atol=1e-14)
    assert distances(arc, np.array([complex(through)]))[0] < 1e-14


@pytest.mark.parametrize("part", [ARC, ARC.reversed(), Part("line", 1 + 2j, -2 + 1j)])
def test_distances_and_directions_agree_with_many_points(part):
    share = np.linspace(0.0, 1.0, 20001)
    points = part.at(share)
    asked = np.array([0.3 + 0.2j, 2.0, -1.5 - 0.1j, 0.1 + 3j, -2j])
    nearest = np.abs(asked[:, None] - points).min(axis=1)
    assert np.allclose(distances(part, asked), nearest, atol=1e-4)  # half the distance of the points
    secants = np.diff(points) / np.abs(np.diff(points))
    assert np.allclose(part.direction(0.5 * (share[1:] + share[:-1])), secants, atol=1e-10)


def test_a_clockwise_outline_is_turned_round():
    clockwise = tuple(part.reversed() for part in reversed(rectangle((-3.0, 3.0), (-2.0, 4.0))))
    turned = plate(outline=clockwise)
    inwards = [complex(1j * part.direction(np.array([0.5]))[0]) for part in turned.outline]
    assert {part.name: toward for part, toward in zip(turned.outline, inwards, strict=True)} == pytest.approx(
        {"bottom": 1j, "right": -1.0, "top": -1j, "left": 1.0}
    )


def test_the_edge_of_a_hole_is_a_clockwise_circle():
    arcs = Hole("bolt", 2 + 1j, 0.5).parts
    assert [arc.circle[3] for arc in arcs] == pytest.approx([-0.5 * np.pi] * 4)
    assert all(arc.circle[0] == pytest.approx(2 + 1j) for arc in arcs)
    assert [arc.end for arc in arcs] == pytest.approx([*(arc.start for arc in arcs[1:]), arcs[0].start])


CROSSED = (
    Part("a", -3 - 3j, 3 - 3j),
    Part("b", 3 - 3j, -3 + 3j),
    Part("top", -3 + 3j, 3 + 3j),
    Part("d", 3 + 3j, -3 - 3j),
)
TOUCHING = (*rectangle((-3.0, 3.0), (-3.0, 3.0))[:3], Part("e", -3 + 3j, 3 + 0j), Part("left", 3 + 0j, -3 - 3j))
OPEN = rectangle((-3.0, 3.0), (-3.0, 3.0))[:3]
BULGING = (*rectangle((-3.0, 3.0), (-4.0, 4.0))[:3], Part("left", -3 + 4j, -3 - 4j, 0.5))


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"outline": OPEN}, r'outline: is not closed: "top" ends at \[-3, 3\], and "bottom" begins at \[-3, -3\]'),
        ({"outline": CROSSED}, r"outline: crosses itself near \["),
        ({"outline": TOUCHING}, r"outline: crosses itself near \["),
        ({"outline": BULGING}, r"outline: the pin's hole does not lie inside the outline"),
        ({"outline": rectangle((2.0, 5.0), (-3.0, 3.0))}, "outline: the pin's hole does not lie inside the outline"),
        ({"outline": rectangle((-0.5, 5.0), (-3.0, 3.0))}, 'outline: the pin\'s hole must keep 0.01 .* part "left"'),
        ({"outline": rectangle((-1.005, 5.0), (-3.0, 3.0))}, 'outline: the pin\'s hole must keep 0.01 .* part "left"'),
        (
            {"outline": rectangle((-3.0, 5000.0), (-3.0, 3.0))},
            'outline: part "bottom" has a point more than 1000 hole radii away',
        ),
        ({"outline": ()}, f"outline: must have 2 to {MOST_PARTS} parts, not 0"),
        ({"outline": (Part("a", 1j, 1j), *OPEN)}, 'outline: part "a" has no shape: two of its points are one'),
        (
            {"outline": (Part("a", -3j, 3j, 1j), *OPEN)},
            'outline: part "a" has no shape: its three points lie on a line',
        ),
        ({"holes": (Hole("b", 9j, 1.0),)}, 'holes: the hole "b" does not lie inside the outline'),
        ({"holes": (Hole("b", 5.5j, 1.0),)}, 'holes: the hole "b" must keep 0.01 hole radii from the part "top"'),
        ({"holes": (Hole("b", 1.5j, 1.0),)}, 'holes: the hole "b" must keep 0.01 hole radii from the pin\'s hole'),
        ({"holes": (Hole("b", 3j, 1e-4),)}, 'holes: the hole "b" must have a radius of at least 0.001 of the pin'),
        ({"supports": {"tob": "both"}}, 'support: no part or hole is called "tob"; the names are "bottom", "right"'),
        ({"supports": {"top": "all"}}, 'hold: must be "both", "x", "y" or "normal", not "all"'),
        ({"loads": (PartLoad("sxx", ("side",)),)}, 'load: no part or hole is called "side"'),
        ({"loads": (PartLoad("sxx", ("top",), y=1.0),)}, 'y: the support of "top" takes up this component'),
        ({"outline": "top"}, "outline: must be a list of parts, not "),
        ({"loads": [None]}, "loads: must be a list of loads, not "),
        ({"holes": 5}, "holes: must be a list of holes, not 5"),
        ({"supports": ["top"]}, r"supports: must map names to words, not \["),
        ({"nu": 0.6}, "nu: must lie between 0 and 0.5, not 0.6"),
        ({"plane": "flat"}, 'plane: must be "strain" or "stress", not "flat"'),
        ({"hole_radius": 0.0}, "hole_radius: must lie between 1e-30 and 1e.30, not 0"),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_one_sentence_names_the_fault(fields, message):
    with pytest.raises(InputError, match=message) as caught:
        plate(**fields)
    assert str(pickle.loads(pickle.dumps(caught.value))) == str(caught.value)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Hole("b", 3j, -1.0), "radius: must be positive, not -1"),
        (lambda: Hole("b", float("nan"), 1.0), "centre: must be a finite number, not nan"),
        (lambda: Hole(5, 3j, 1.0), "name: must be text in quotes, not 5"),
        (lambda: Part("a", 1j, None), "end: must be a number, not None"),
        (lambda: Part("a", 0j, 1j, complex(0.0, float("inf"))), "through: must be a finite number, not inf"),
        (lambda: PartLoad("P", ("left",)), 'load: must be "sxx", "syy" or "sxy", not "P"'),
        (lambda: PartLoad("sxx", (None,)), "parts: must be text in quotes, not None"),
        (lambda: PartLoad("sxx", ("left",), y=float("nan")), "y: must be a finite number, not nan"),
    ],
)
def test_parts_holes_and_loads_are_checked_when_made(make, message):
    with pytest.raises(InputError, match=message):
        make()


@pytest.mark.parametrize(
    ("supports", "motion"),
    [
        ({}, "move and turn freely"),
        ({"top": "x"}, "move, and turn"),
        ({"left": "y", "right": "y"}, r"move along \("),
        ({"left": "normal", "right": "normal"}, r"move along \("),
        ({"bottom": "normal", "left": "x"}, None),
        ({"bottom": "normal", "left": "both"}, None),
        ({"bolt": "normal"}, r"turn about the point \[(-?0|[-\d.e]*e-\d+), 4\]"),
        ({"bolt": "both"}, None),
        ({"bolt": "normal", "left": "y"}, None),
    ],
    ids=str,
)
def test_supports_must_prevent_each_rigid_motion(supports, motion):
    fields = {"supports": supports, "holes": (Hole("bolt", 4j, 1.0),)}
    if motion is None:
        assert plate(**fields).rigid_motion == ""
        return
    with pytest.raises(InputError, match=f"support: the supports leave a rigid motion: the plate can {motion}"):
        plate(**fields)


def test_a_round_plate_on_rollers_turns_about_its_centre():
    with pytest.raises(InputError, match="the plate can turn about the point"):
        Lug(0.3, "strain", 1.0, disc(3.0), {"rim": "normal"})


@pytest.mark.parametrize("hold", ["both", "x", "y", "normal"])
def test_a_load_along_a_free_component_of_a_support_is_accepted(hold):
    free = {"x": {"y": 1.0}, "y": {"x": 1.0}}.get(hold, {})
    load = PartLoad("sxy", ("left",), **free)
    assert plate(supports={"top": "both", "left": hold}, loads=(load,)).loads == (load,)
