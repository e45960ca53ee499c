"""Compliances of finite plates: closed forms of rings, finite elements, reciprocity, symmetry and decay."""

import math

import numpy as np
import pytest

from fastpin.bodies import harmonics
from fastpin.errors import InputError
from fastpin.lugs import panels, plates
from fastpin.lugs.outline import Hole, Lug, Part, PartLoad, rectangle
from fastpin.lugs.panels import Edges, Fineness
from fastpin.lugs.plates import COARSE, KEPT, hole_compliance, plate_compliance, respond
from fastpin.lugs.several_holes import holes_in_infinite_plate
from tests.support.lugs import disc, edge_stress, make_coarse, make_rough, plate
from tests.support.ring_compliance import block, held_ring_matrix
from tests.support.tiers import for_gate, gate, some_survey

ORDER = 8

FINITE_ELEMENTS = {  # whole entries G v/R of the rectangle: triangles of second degree, 73,658 unknowns
    (0, 0): 0.609327247730502,
    (2, 2): 12.629200790680283,
    (3, 3): 1.708846627717525,
    (5, 5): 12.626130515913506,
    (7, 7): 1.0077608781099416,
}


def nothing(_: float) -> None:
    """Progress that nobody watches."""


def harmonic(matrix: np.ndarray, n: int, m: int | None = None) -> np.ndarray:
    m = n if m is None else m
    return matrix[4 * n - 2 : 4 * n + 2, 4 * m - 2 : 4 * m + 2]


@pytest.fixture(scope="module")
@for_gate
def made():
    load = PartLoad("syy", ("bottom",), normal=1.0), PartLoad("sxy", ("left", "right"), x=0.3, y=1.0)
    return plate_compliance(plate(loads=load), 10)


@pytest.mark.gate
@pytest.mark.parametrize("plane", [*gate("strain"), "stress"])
def test_a_held_ring_agrees_with_its_closed_form(plane):
    lug = Lug(0.3, plane, 5e-3, disc(10e-3), {"rim": "both"})
    made = plate_compliance(lug, ORDER).compliance.matrix
    expected = held_ring_matrix(2.0, lug.kolosov, ORDER)
    assert expected == pytest.approx(expected.T)  # the closed form is symmetric itself
    assert np.abs(made - expected).max() < 1e-9  # measured: 3e-10


@pytest.mark.gate
@pytest.mark.parametrize("plane", [*gate("strain"), "stress"])
def test_the_supports_of_a_held_ring_that_gets_warm_move_its_hole(plane):
    """By the closed form of :class:`fastpin.bodies.Ring`: -(kappa + 1)/(kappa - 1 + 2 q) all round."""
    lug = Lug(0.3, plane, 5e-3, disc(10e-3), {"rim": "both"})
    moved = plate_compliance(lug, ORDER).compliance.columns_of("temperature")
    expected = -math.sqrt(2.0) * (lug.kolosov + 1.0) / (lug.kolosov - 1.0 + 0.5)
    assert moved[0] == pytest.approx(expected, rel=1e-9)
    assert np.abs(moved[1:]).max() < 1e-9


@pytest.mark.gate
def test_supports_that_let_a_lug_expand_only_move_it(monkeypatch):
    """The edges on the left and below keep their place: the hole moves away by 3 and 4 radii, its distances."""
    make_rough(monkeypatch)
    lug = Lug(0.3, "stress", 5e-3, rectangle((-15e-3, 20e-3), (-20e-3, 25e-3)), {"left": "x", "bottom": "y"})
    moved = plate_compliance(lug, ORDER).compliance.columns_of("temperature")
    assert moved[2:6] == pytest.approx([3.0, 4.0, 4.0, -3.0])
    assert np.abs(np.delete(moved, slice(2, 6))).max() < 1e-9


@pytest.mark.gate
def test_a_free_ring_agrees_with_its_closed_form(monkeypatch):
    """The ring is held on a tiny arc. It takes up no force while the tractions are in equilibrium."""
    make_rough(monkeypatch)
    lug = Lug(0.3, "strain", 1.0, disc(2.0, gap=1e-4), {"gap": "both"})
    made = plate_compliance(lug, ORDER).compliance.matrix
    a, b, d = harmonics.ring(np.arange(2.0, ORDER + 1.0), 2.0, lug.kolosov, "free")
    for n in range(2, ORDER + 1):
        expected = block(a[n - 2], b[n - 2], d[n - 2])
        assert np.abs(harmonic(made, n) - expected).max() < 1e-6  # measured: 4e-8


def test_the_hole_is_that_of_the_closed_form():
    k = 1.7
    found = hole_compliance(6, k)
    whole = harmonics.hole(np.arange(2.0, 7.0), k, 1.0)
    for n in range(2, 7):
        expected = 2.0 * whole[n - 2]
        assert np.allclose(harmonic(found, n), block(expected[0, 0], expected[0, 1], expected[1, 1]))
    assert np.allclose(harmonic(found, 1), block(-0.5, 0.0, 0.0))
    assert np.allclose(found[:2, :2], 0.5 * np.eye(2))


def test_the_rectangle_agrees_with_finite_elements(made):
    whole = made.compliance.matrix + hole_compliance(10, 1.8)
    for place, value in FINITE_ELEMENTS.items():
        assert whole[place] == pytest.approx(
            value, rel=4e-6
        )  # finite elements converge from below; their last halving changes 1e-5


def test_the_matrix_is_symmetric_and_decays(made):
    assert made.asymmetry < 1e-9  # measured: 2e-11
    assert made.error < 1e-7  # measured: 2e-9
    sizes = plates.harmonic_sizes(made.compliance.matrix)
    assert made.last == pytest.approx(sizes[-1], rel=1e-4)
    assert np.all(sizes[4:] < 0.7 * sizes[3:-1])


def test_all_tractions_do_positive_work(made):
    whole = made.compliance.matrix + hole_compliance(10, 1.8)
    assert np.linalg.eigvalsh(whole).min() > 0.2 / 11.0  # about 1/2(n + 1) for the last harmonic


@pytest.mark.survey
def test_the_estimated_error_covers_the_error():
    """An edge that is held in its middle only has the strongest singularity: the square root."""
    outline = rectangle((-2.5, 2.5), (-2.5, 4.0))
    top = (Part("a", 2.5 + 4j, 1 + 4j), Part("held", 1 + 4j, -1 + 4j), Part("b", -1 + 4j, -2.5 + 4j))
    lug = plate(outline=(*outline[:2], *top, outline[3]), supports={"held": "both"})
    made = plate_compliance(lug, 4)
    better = respond(lug, 4, Fineness(8, 20), nothing).projected() - hole_compliance(4, lug.kolosov)
    error = np.abs(better - made.compliance.matrix).max() / np.abs(better).max()
    assert error < made.error < 1e-4
    assert error < 1e-6  # measured: 2e-7


@pytest.mark.gate
@pytest.mark.parametrize("hold", ["both", "x", "y"])
def test_loads_and_displacements_are_reciprocal(hold):
    """The work of the load on the displacement of the pin's tractions, and the other way round."""
    load = PartLoad("sxx", ("left", "bolt"), normal=1.0), PartLoad("sxx", ("bottom",), x=0.4, y=-0.7)
    supports = {"top": "both", "right": hold}
    found = respond(plate(supports=supports, loads=load, holes=(Hole("bolt", 3j, 0.8),)), 3, COARSE, nothing)
    size = 2 + 4 * 3
    of_load = np.einsum("in,inc,n->c", found.t[:, :, size], found.u[:, :, :size], found.edges.weights)
    of_pin = np.einsum("inc,in,n->c", found.t[:, :, :size], found.u[:, :, size], found.edges.weights)
    assert np.abs(of_load - of_pin).max() < 1e-7 * np.abs(of_pin).max()  # measured: 8e-9


@pytest.mark.gate
def test_held_components_do_not_move():
    found = respond(plate(supports={"top": "normal", "left": "x"}), 2, COARSE, nothing)
    names = np.array([part.name for part in found.edges.parts])[found.edges.part_of_node]
    assert np.abs(found.u[1, names == "top"]).max() == 0.0
    assert np.abs(found.u[0, names == "left"]).max() == 0.0
    assert np.abs(found.u[0, names == "top"]).max() > 0.1


@pytest.mark.gate
def test_a_wide_plate_under_tension_has_the_displacement_of_the_infinite_plate(monkeypatch):
    make_coarse(monkeypatch)
    supports, load = {"left": "x", "bottom": "y"}, (PartLoad("sxx", ("right",), x=1.0),)
    made = plate_compliance(plate((-30.0, 30.0), (-30.0, 30.0), supports=supports, loads=load), 4)
    column = made.compliance.columns["sxx"]
    size = 0.125 * (1.8 + 1.0)  # v_r = (k + 1)/8G (1 + 2 cos 2 theta), v_theta = -(k + 1)/4G sin 2 theta
    expected = np.zeros(18)
    expected[[0, 6, 9]] = math.sqrt(2.0) * size, 2.0 * size, -2.0 * size
    inner = np.r_[0:2, 6:18]
    assert np.abs(column - expected)[inner].max() < 3e-3 * size * 2.0  # (R/30 R)^2, and some


@pytest.mark.gate
def test_lengths_and_modulus_do_not_matter(monkeypatch):
    make_coarse(monkeypatch)
    load = (PartLoad("syy", ("bottom",), normal=1.0),)
    scaled = tuple(part.scaled(0.007) for part in plate().outline)
    lugs = plate(loads=load), plate(hole_radius=0.007, outline=scaled, loads=load)
    large, small = (plate_compliance(lug, 6).compliance for lug in lugs)
    assert np.allclose(small.matrix, large.matrix, atol=1e-9, rtol=0.0)
    assert np.allclose(small.columns["syy"], large.columns["syy"], atol=1e-9, rtol=0.0)


@pytest.mark.gate
def test_a_turned_plate_turns_its_matrix():
    lug = plate((-2.0, 3.0), (-2.0, 2.5))
    turned = tuple(Part(part.name, 1j * part.start, 1j * part.end) for part in lug.outline)
    one, other = (respond(each, 6, COARSE, nothing).projected() for each in (lug, plate(outline=turned)))
    # by a right angle: cos n(theta - pi/2), and sin, in cos and sin n theta
    turn = np.eye(26)
    for n in range(1, 7):
        c, s = math.cos(0.5 * n * math.pi), math.sin(0.5 * n * math.pi)
        turn[4 * n - 2 : 4 * n + 2, 4 * n - 2 : 4 * n + 2] = np.kron(np.eye(2), [[c, -s], [s, c]])
    assert np.abs(other - turn @ one @ turn.T).max() < 1e-8


@pytest.mark.gate
def test_an_incompressible_plate_that_is_held_all_round_keeps_its_hole(monkeypatch):
    make_rough(monkeypatch)
    made = plate_compliance(plate(nu=0.5, supports=dict.fromkeys(("top", "left", "right", "bottom"), "both")), 6)
    assert made.compliance.matrix[0, 0] == pytest.approx(-0.5, abs=1e-6)
    assert made.error < 1e-5  # measured: 5e-7; 4e-9 with all nodes


@pytest.mark.gate
def test_harmonics_are_taken_until_they_have_decayed(monkeypatch):
    monkeypatch.setattr(plates, "FINE", COARSE)
    lug = plate((-4.0, 4.0), (-4.0, 4.0))
    made = plate_compliance(lug)
    sizes = plates.harmonic_sizes(made.compliance.matrix)
    assert sizes[-1] > KEPT
    assert 5 <= made.compliance.order <= 16
    order = made.compliance.order + 2
    longer = respond(lug, order, COARSE, nothing).projected() - hole_compliance(order, lug.kolosov)
    assert plates.harmonic_sizes(longer)[-1] < KEPT


@pytest.mark.gate
def test_few_nodes_at_free_corners_lose_nothing(monkeypatch):
    """Measured: 2e-8 with the coarser discretisation, 2e-9 with the other one."""
    lug = plate((-4.0, 4.0), (-4.0, 10.0))
    found = respond(lug, 4, COARSE, nothing)
    monkeypatch.setattr(panels.Boundary, "halvings", lambda boundary, place, most: most)
    expected = respond(lug, 4, COARSE, nothing)
    assert found.edges.z.size < 0.8 * expected.edges.z.size
    assert np.abs(found.projected() - expected.projected()).max() < 1e-7


@pytest.mark.gate
def test_polylines_are_taken():
    """A round end of chords. Measured difference from the arc: 3e-3 of the largest entry."""
    side, top = 2.2, 6.0
    outline = [Part("right", side, side + 1j * top), Part("top", side + 1j * top, -side + 1j * top)]
    outline.append(Part("left", -side + 1j * top, -side))
    round_end = side * np.exp(1j * np.linspace(math.pi, 2.0 * math.pi, 25))
    ends = [complex(-side), *round_end[1:-1].tolist(), complex(side)]
    nose = [Part("nose", *ends[k : k + 2]) for k in range(24)]
    polyline, arc = (
        respond(plate(outline=(*outline, *last)), 4, COARSE, nothing)
        for last in (nose, [Part("nose", -side, side, -1j * side)])
    )
    assert polyline.edges.z.size < 1.3 * arc.edges.z.size
    assert np.abs(polyline.projected() - arc.projected())[6:, 6:].max() < 5e-3


@pytest.mark.gate
def test_fourteen_straight_sides_are_taken(monkeypatch):
    """Corners turn to both sides."""
    make_coarse(monkeypatch)
    half = [2 - 3j, 3 - 2j, 3 + 4j, 2 + 5j, 2 + 8j, 3 + 9j, 3 + 12j]
    corners = [*half, *(-corner.conjugate() for corner in half[::-1])]
    sides = [Part(f"side {k}", corners[k], corners[(k + 1) % 14]) for k in range(14)]
    lug = plate(outline=tuple(sides), supports={"side 6": "both"})
    assert plate_compliance(lug, 4).error < 1e-4
    assert panels.Edges(plates.boundaries(lug, 8), Fineness(10, 16)).z.size < 3000


STEP = (
    Part("nose", -2.2, 2.2, -2.2j), Part("side", 2.2, 2.2 + 5.9j),
    Part("fillet", 2.2 + 5.9j, 2.3 + 6j, 2.3 + 5.9j + 0.1 * np.exp(0.75j * np.pi)),
    Part("step", 2.3 + 6j, 3 + 6j), Part("side", 3 + 6j, 3 + 10j), Part("top", 3 + 10j, -3 + 10j),
    Part("side", -3 + 10j, -3 + 6j), Part("step", -3 + 6j, -2.3 + 6j),
    Part("fillet", -2.3 + 6j, -2.2 + 5.9j, -2.3 + 5.9j + 0.1 * np.exp(0.25j * np.pi)),
    Part("side", -2.2 + 5.9j, -2.2),
)  # fmt: skip
LUG = (Part("nose", -2.2, 2.2, -2.2j), *rectangle((-2.2, 2.2), (0.0, 10.0))[1:])
ENDS = {"floats": True, "supports": {}, "loads": (PartLoad("syy", ("top", "bottom"), normal=1.0),)}
BOLT = {"outline": LUG, "holes": (Hole("bolt", 4j, 0.5),)}


@pytest.mark.gate
@pytest.mark.parametrize(
    ("fields", "angles", "expected"),
    [
        ({"outline": rectangle((-2.0, 2.0), (-20.0, 20.0)), **ENDS}, (0, 90), (4.347599102, -1.615075197)),
        ({"outline": rectangle((-10 / 3, 10 / 3), (-30.0, 30.0)), **ENDS}, (0, 90), (3.374381781, -1.254078842)),
        ({"outline": LUG}, (-90, 0, 45, 90), (-0.133707427, 0.631529819, 0.007413040, -0.456468592)),
        ({}, (-90, 0, 45, 90), (-0.114429840, 0.478617546, 0.019911297, -0.378853267)),
        ({"outline": STEP}, (0,), (0.632129797,)),
        (BOLT, (0, 90), (0.616072553, -0.410570840)),
    ],
    ids=("strip", "wider strip", "lug", "rectangle", "stepped lug", "lug with a bolt hole"),
)  # fmt: skip
def test_hoop_stress_of_holes_in_outlines(fields, angles, expected):
    """Another method, of other nodes, gave the numbers: docs/compliance.md. A pin presses with -sin(theta)/pi."""
    lug = plate(plane="stress", **fields)
    order = 24 if lug.floats else 16
    moved = respond(lug, order, plates.FINE, nothing).projected()
    given = np.zeros(2 + 4 * order)
    given[3] = 0.0 if lug.floats else -1.0 / math.pi
    column = moved[:, -1] if lug.floats else moved[:, : given.size] @ given
    assert edge_stress(column, given, lug.kolosov, angles) == pytest.approx(np.array(expected), abs=5e-8)


@pytest.mark.gate
def test_half_of_a_plate_with_two_pins_between_sliding_edges():
    """A straight edge with `hold` "normal" mirrors the plate: two equal pins, and a bolt hole between them."""
    sides = {"bottom": "y", "top": "y", "right": "normal"}
    hole, bolt = Hole("other", -5.0, 1.0), (Hole("upper", 3j, 0.7), Hole("mirrored", -5.0 + 3j, 0.7))
    load = (PartLoad("syy", ("upper", "mirrored"), normal=1.0),)
    half = plate((-2.5, 3.0), (-3.0, 5.0), supports={**sides, "left": "normal"}, holes=bolt[:1], loads=(
        PartLoad("syy", ("upper",), normal=1.0),))  # fmt: skip
    whole = plate((-8.0, 3.0), (-3.0, 5.0), supports={**sides, "left": "normal"}, holes=(hole, *bolt), loads=load)
    one, both = respond(half, 6, plates.FINE, nothing), respond(whole, 6, plates.FINE, nothing, {"other": 6})
    each, upwards = 26, [3, 4]  # r sin and theta cos: the mirror leaves them
    expected = both.projected()[:each][:, upwards] + both.projected()[:each][:, [each + k for k in upwards]]
    assert one.edges.z.size < 0.65 * both.edges.z.size
    assert np.abs(one.projected()[:, upwards] - expected).max() < 2e-8 * np.abs(expected).max()
    assert np.abs(one.projected()[:, -1] - both.projected()[:each, -1]).max() < 2e-8


@pytest.mark.gate
def test_a_row_of_holes_is_a_pitch_between_sliding_edges():
    """Rows of 7 and 15 holes in the infinite plate, extrapolated; 3.2411 and 2.1392 are those of an endless row.

    The pitch is two diameters. The temperature moves the supports: without it the row can't contract.
    """
    half, load = 2.0, (PartLoad("syy", ("top",), normal=1.0),)
    sides = {"left": "normal", "right": "normal", "bottom": "y"}
    lug = plate((-half, half), (-10.0, 10.0), plane="stress", supports=sides, loads=load)
    moved = respond(lug, 16, plates.FINE, nothing).with_temperature()
    strain = 2.0 * (1.0 + lug.nu)  # the stress of supports that move by -z
    across, along = moved[:, -2] + lug.nu / strain * moved[:, -1], -moved[:, -1] / strain
    free = np.zeros(len(moved))
    found = [edge_stress(across, free, lug.kolosov, [0]), edge_stress(along, free, lug.kolosov, [90])]
    assert np.ravel(found) == pytest.approx([3.2411, 2.1392], abs=1e-4)
    rows = []
    for count in (7, 15):
        centres = np.roll(2.0 * half * (np.arange(count) - count // 2.0), -(count // 2)).astype(complex)
        made = holes_in_infinite_plate(lug.kolosov, centres, 6)
        columns = [(made.column("syy", 0), 0), (made.column("sxx", 0), 90)]
        rows.append([float(edge_stress(c, np.zeros(26), lug.kolosov, [angle])[0]) for c, angle in columns])
    assert rows[1] + (np.array(rows[1]) - rows[0]) * 7 / 8 == pytest.approx(np.ravel(found), abs=5e-3)


@pytest.mark.gate
@pytest.mark.parametrize("degrees", some_survey([45.0, 20.0, 90.0], 20.0, 90.0))
def test_re_entrant_corners_take_halvings_by_their_angle(degrees, monkeypatch):
    """A step on one side, against 16 halvings at its corner: measured 1e-8, 1e-9 and 7e-9 of the matrix."""
    rise = 2.0 / math.tan(math.radians(degrees))
    corners = [-2.5 - 2.5j, 2.5 - 2.5j, 2.5 + 3j, 4.5 + (3 + rise) * 1j, 4.5 + 10j, -2.5 + 10j]
    sides = [Part(f"side {k}", corners[k], corners[(k + 1) % 6]) for k in range(6)]
    lug = plate(outline=tuple(sides), supports={"side 4": "both"})
    found = respond(lug, 4, plates.FINE, nothing)
    usual = panels.Boundary.halvings

    def deep(edge, place, most):
        return 20 if edge.parts[place].name == "side 2" else usual(edge, place, most)

    monkeypatch.setattr(panels.Boundary, "halvings", deep)
    expected = respond(lug, 4, plates.FINE, nothing)
    assert found.edges.z.size < expected.edges.z.size - 90
    assert plates.largest_part(found.projected() - expected.projected(), expected.projected()) < 2e-8


@pytest.mark.gate
def test_a_wide_plate_needs_few_harmonics():
    assert plate_compliance(plate((-10.0, 10.0), (-10.0, 20.0))).compliance.order <= 8
    assert plate_compliance(plate((-300.0, 300.0), (-300.0, 300.0))).compliance.order == 4


@pytest.mark.gate
def test_more_harmonics_are_tried_near_an_edge(monkeypatch):
    make_coarse(monkeypatch)
    monkeypatch.setattr(plates, "FIRST_TRIED", 4)
    monkeypatch.setattr(plates, "KEPT", 1e-4)  # above the errors of few nodes, which never decay
    assert 4 < plate_compliance(plate((-4.0, 4.0), (-4.0, 4.0))).compliance.order <= 8


@pytest.mark.gate
def test_progress_goes_from_zero_to_one(monkeypatch):
    make_coarse(monkeypatch)
    steps = []
    plate_compliance(plate(), 6, lambda done, total: steps.append(done / total))
    assert steps == sorted(steps)
    assert steps[-1] == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("order", "message"),
    [(1, "harmonics: must be a whole number from 2 to 200"), (2.5, "harmonics: must be a whole number")],
)
def test_a_wrong_number_of_harmonics_is_refused(order, message):
    with pytest.raises(InputError, match=message):
        plate_compliance(plate(), order)


@pytest.mark.gate
def test_too_few_harmonics_are_refused(monkeypatch):
    make_coarse(monkeypatch)
    with pytest.raises(InputError, match=r"harmonics: its last harmonic 2 is .* take more harmonics"):
        plate_compliance(plate((-1.3, 1.3), (-1.3, 1.3)), 2)


def test_too_many_nodes_are_refused(monkeypatch):
    monkeypatch.setattr(panels, "MOST_NODES", 300)
    message = 'outline: needs more than 300 nodes; "right" takes .* of the first 30.: .* Some 280 sides of a round end'
    with pytest.raises(InputError, match=message):
        plate_compliance(plate(), 4)


# -- panels and kernels ---------------------------------------------------------------------------------------


def loops():
    return plates.boundaries(plate(holes=(Hole("bolt", 3j, 0.8),)), 4)


def test_panels_cover_all_edges():
    edges = Edges(loops(), COARSE)
    lengths = [edges.weights[edges.part_of_node == place].sum() for place in range(len(edges.parts))]
    assert lengths == pytest.approx([part.length for part in edges.parts], rel=1e-12)
    area = 0.5 * np.sum((np.conj(edges.z) * 1j * edges.normals * edges.weights).imag)
    assert area == pytest.approx(5.0 * 8.5 - math.pi * (1.0 + 0.64), rel=1e-12)


def test_the_nearest_panel_of_a_point():
    edges, random = Edges(loops(), COARSE), np.random.default_rng(4)
    panels, s = np.arange(edges.part.size), random.uniform(-0.9, 0.9, edges.part.size)
    z, along = edges.at(panels, s)
    found, places, away = edges.nearest(z + 1e-3j * edges.half * along, panels[3:])
    assert found[3:].tolist() == panels[3:].tolist()
    assert places[3:] == pytest.approx(s[3:], abs=1e-2)
    assert away[3:] == pytest.approx(1e-3 * edges.half[3:], rel=1e-6)
    assert (found[:3] >= 3).all()


def test_panels_shrink_towards_corners_and_other_edges():
    edges = Edges(loops(), COARSE)
    top = edges.half[edges.part == [part.name for part in edges.parts].index("top")]
    assert 2.0 * top.min() == pytest.approx(5.0 * 2.0**-COARSE.halvings)
    ligament = np.abs(edges.z - 1.6j) < 0.7  # between the two holes, 1.2 apart
    assert 2.0 * edges.half[edges.panel[ligament]].max() < 1.3


@pytest.mark.gate
@pytest.mark.parametrize("kolosov", [1.0001, 1.8, 3.0])
def test_the_matrices_reproduce_linear_and_quadratic_fields(kolosov):
    """2G u = k phi - z conj(phi') - conj(psi) with phi = a z^2 + b z, psi = c z satisfies Somigliana's identity."""
    edges = Edges(loops(), COARSE)
    whole = panels.matrices(edges, kolosov, 50.0, np.arange(edges.z.size), nothing)
    U, T = (each.reshape(2 * edges.z.size, -1) for each in whole)
    a, b, c = 0.3 - 0.2j, 0.7, 0.4 + 0.5j
    z, n = edges.z, edges.normals
    phi, slope, psi = a * z**2 + b * z, 2.0 * a * z + b, c * z
    u = kolosov * phi - z * np.conj(slope) - np.conj(psi)
    mean = 2.0 * slope.real  # (sxx + syy)/2
    deviator = np.conj(z) * 2.0 * a + c  # (syy - sxx)/2 + i sxy
    t = mean * n - np.conj(deviator) * np.conj(n)
    left, right = T @ np.r_[u.real, u.imag], U @ np.r_[t.real, t.imag]
    assert np.abs(left - right).max() < 1e-8 * np.abs(right).max()
