"""Checks of accuracy: stresses, finite bodies, laminates, gaps, friction, wear and cracks, as in `fastpin verify`."""

from functools import partial

from fastpin.bodies import Plate
from fastpin.verification.checks import FREE, HELD, Topic
from fastpin.verification.finite_elements import LIKE, UNLIKE
from tests.support.checks import (
    body_cases,
    body_rows,
    crack_rows,
    equation_rows,
    friction_rows,
    gap_rows,
    laminate_rows,
    seat_rows,
    stress_rows,
    wear_rows,
)

FURTHER = {
    "coupled": Topic(
        "Without friction, unlike bodies: Eq. (58) by Jacobi polynomials",
        {
            f"L_p = {value:g}, {name}": partial(equation_rows.coupled, pair, value)
            for name, pair in equation_rows.COUPLED.items()
            for value in (0.05, 0.5)
        },
        {"peak N": 1e-5, "half-angle": 1.2e-5},
    ),
    "sliding": Topic(
        "Full sliding, mu = 0.3, L_p = 0.5: Eq. (58) by Jacobi polynomials",
        {"like bodies": partial(equation_rows.sliding, LIKE), "unlike bodies": partial(equation_rows.sliding, UNLIKE)},
        {"peak N": 8e-6, "peak T": 8e-6, "moment": 7e-6, "end": 4e-6, "end, unlike bodies": 5e-6},
    ),
    "equations": Topic(
        "Residuals of the singular integral equations (46), (47)",
        {"P": equation_rows.singular_equations, "Q and remote stress": equation_rows.singular_equations_with_stress},
        {"(46)": 2e-5, "(47)": 2e-6, "(47), Q and remote stress": 1.5e-6},
    ),
    "strains": Topic(
        "Hoop strains of pin and plate: gap and slip",
        {
            "free rotation": partial(stress_rows.strains, FREE, 1.75),
            "held rotation": partial(stress_rows.strains, HELD, 1.2),
        },
        {"slip": 6e-5},
    ),
    "stresses, half-plane": Topic(
        "Stresses of half-planes, half-angle 0.001: Hertz, Cattaneo, Mindlin",
        {"P": stress_rows.hertz_stress, "P, Q": stress_rows.cattaneo_mindlin_stress},
        {
            "largest shear": 4e-3,
            "its depth": 1.5e-3,
            "stresses": 6e-3,
            "peak hoop stress": 4e-3,
            "its place": 6e-4,
        },
    ),
    "bodies": Topic(
        "Hollow pins, rings and bushes: 1,601 nodes, finite elements, Eq. (58), closed form",
        {name: partial(body_rows.finite_bodies, name) for name in body_cases.CASES}
        | {"stuck interference fit": body_rows.stuck_bodies},
        {
            "peak N": 1.6e-5,
            "int N": 1e-5,
            "half-angle": 1.2e-4,
            "peak N, elements": 7e-5,  # the finite elements themselves: 5e-5
            "peak N, (58)": 9e-6,
            "half-angle, (58)": 3.5e-6,
            "N, stuck": 8e-6,
            "T, stuck": 5e-6,
        },
    ),
    "bodies, exact": Topic(
        "Hollow pins, rings and bushes: exact relations",
        {"ring by its compliance": body_rows.ring_by_compliance, "cut bush": body_rows.cut_layer},
        {"N, T": 3e-11, "compliance": 1e-15},
    ),
    "seats": Topic(
        "A bush that slips in its seat: a solid pin, a bonded bush",
        {
            "pin and bush of one material": seat_rows.solid_pin,
            "much friction, infinite plate": partial(seat_rows.bonded, Plate()),
            "much friction, ring": partial(seat_rows.bonded, body_cases.RING.plate_body),
        },
        {"N, T": 4.5e-6, "dissipated": 2e-5, "peak N": 2.5e-5, "ux": 1.3e-6, "uy": 2.8e-6},
    ),
    "laminates, elements": Topic(
        "A steel pin in a laminate: finite elements",
        {name: partial(laminate_rows.finite_elements, name) for name in laminate_rows.ELEMENTS},
        {"peak N": 4.5e-4},
    ),
    "laminates": Topic(
        "Laminates: fits that stick all round, and Fourier collocation",
        laminate_rows.CASES,
        {"N, T": 3e-5, "N, T, stuck, force": 8e-7, "peak N": 4.5e-4, "least N": 6.5e-5},
    ),
    "gaps": Topic(
        "Initial gaps: interference fits with waves, and full sliding by Eq. (58)",
        {
            "like, mu = 0": partial(gap_rows.waves, LIKE, 0.0, False),
            "like, stuck": partial(gap_rows.waves, LIKE, 1.0, False),
            "unlike, stuck": partial(gap_rows.waves, UNLIKE, 1.0, False),
            "tube in ring, stuck": partial(gap_rows.waves, UNLIKE, 1.0, True),
            "full sliding": gap_rows.sliding,
        },
        {"tractions": 1.2e-4, "peak N": 5e-5, "moment": 2.5e-5, "end": 1.2e-5},
    ),
    "friction": Topic(
        "Friction that varies along the rim, or falls: (46), (47), work",
        {"along the rim": friction_rows.along_the_rim, "falls with the loads": friction_rows.with_the_loads},
        {"(46)": 3e-5, "(47)": 1.8e-6, "work": 1.4e-5, "work, falls with the loads": 1e-3},
    ),
    "wear": Topic(
        "Wear: interference fits with waves, rigid bodies, half-planes, energy",
        {
            "fit, mu = 0": partial(wear_rows.fit, 0.0),
            "fit, stuck": partial(wear_rows.fit, 1.0),
            "sliding": wear_rows.sliding,
            "partial slip": partial(wear_rows.half_planes, 12, 2e6),
            "removed material": wear_rows.energy,
        },
        {
            "tractions": 1.5e-4,
            "depth, sliding": 2.5e-2,
            "peak N": 1.7e-2,
            "volume": 0.15,  # the half-width of stick is known to a part of a node distance; the volume goes like c^-7
            "depth": 8e-2,
            "N, middle": 8e-3,
            "energy": 4.5e-6,
        },
    ),
    "wear, exact": Topic("Wear: exact relations", {"fit": wear_rows.same_fit}, {"N, T": 5e-13, "energy taken": 1e-15}),
    "cracks": Topic(
        "Cracks at the hole: limits of an open hole, and another program",
        {"open hole": crack_rows.open_hole, "ring": crack_rows.ring},
        {"K": 5e-6, "K, long": 2e-4, "K, short": 1.2e-6},
    ),
}
"""Topics as in :data:`fastpin.verification.checks.TOPICS`."""
