"""Finite plates for tests."""

import json
import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest
from numpy.typing import ArrayLike

from fastpin import Material, MaterialPair, Problem
from fastpin.bodies import Compliance, Ring
from fastpin.bodies.compliance import complex_coefficients
from fastpin.elasticity.stress import plate_stress
from fastpin.elasticity.tractions import Tractions
from fastpin.lugs import fields, plates
from fastpin.lugs.outline import Lug, Part, rectangle
from fastpin.lugs.panels import Fineness
from fastpin.lugs.plates import hole_compliance


def disc(radius: float, gap: float = 0.0) -> tuple[Part, ...]:
    """A circle about the hole's centre in four arcs; with a `gap` (rad) in a fifth part "gap" at the angle 0."""
    angles = np.array([gap, 0.5 * np.pi, np.pi, 1.5 * np.pi, 2.0 * np.pi])
    ends = radius * np.exp(1j * angles)
    middles = radius * np.exp(0.5j * (angles[1:] + angles[:-1]))
    arcs = [Part("rim", complex(ends[k]), complex(ends[k + 1]), complex(middles[k])) for k in range(4)]
    closing = [Part("gap", arcs[-1].end, arcs[0].start, complex(radius * np.exp(0.5j * gap)))] if gap else []
    return (*arcs, *closing)


def plate(x: tuple[float, float] = (-2.5, 2.5), y: tuple[float, float] = (-2.5, 6.0), **fields: Any) -> Lug:
    """A rectangle with a hole of radius 1, held at its top."""
    return Lug(**{"nu": 0.3, "plane": "strain", "hole_radius": 1.0, "outline": rectangle(x, y),
                  "supports": {"top": "both"}, **fields})  # fmt: skip


def lug_with_nose(holes=(), **given):
    """Nose and sides at 2.2 R, held at y = 10 R."""
    side, top = 2.2 + 0j, 2.2 + 10j
    ends = side, top, -top.conjugate(), -side
    outline = [Part(name, *ends[k : k + 2]) for k, name in enumerate(("right", "top", "left"))]
    return Lug(0.3, "stress", 1.0, (*outline, Part("nose", -side, side, -2.2j)), {"top": "both"}, holes=holes, **given)


def lug_with_neck() -> Lug:
    """A lug on a neck 0.6 R wide and 6 R long, with sharp corners, held at its top."""
    names = ("step", "neck", "top", "neck", "step", "left", "bottom", "right")
    ends = [0.3 + 3j, 0.3 + 9j, -0.3 + 9j, -0.3 + 3j, -2.2 + 3j, -2.2 - 2.2j, 2.2 - 2.2j, 2.2 + 3j]
    parts = tuple(Part(name, ends[k - 1], ends[k]) for k, name in enumerate(names))
    return Lug(0.3, "stress", 1.0, parts, {"top": "both"})


def rough_body(monkeypatch: pytest.MonkeyPatch, lug: Lug, order: int = 6) -> Compliance:
    """A compliance with its outline, by few nodes."""
    monkeypatch.setattr(fields, "FINENESS", Fineness(6, 3))
    matrix = fields.PlateField(lug, 2 * order).matrix[: 2 + 4 * order, : 2 + 4 * order]
    matrix = 0.5 * (matrix + matrix.T) - hole_compliance(order, lug.kolosov)
    return Compliance(lug.nu, lug.plane, lug.hole_radius, matrix, outline=json.dumps(lug.document()))


def outlined(lug: Lug) -> Compliance:
    """A compliance with the outline of a plate, and with a matrix that means nothing."""
    matrix = np.diag(0.1 ** np.repeat([0.0, 0.0, 1.0, 4.0], [2, 4, 4, 4]))
    return Compliance(lug.nu, lug.plane, lug.hole_radius, matrix, outline=json.dumps(lug.document()))


def make_rough(monkeypatch: pytest.MonkeyPatch) -> None:
    """Compute compliances with the nodes of the coarser discretisation: errors of 2e-9, in a third of the time."""
    monkeypatch.setattr(plates, "FINE", plates.COARSE)
    monkeypatch.setattr(plates, "COARSE", Fineness(6, 8))


def make_coarse(monkeypatch: pytest.MonkeyPatch) -> None:
    """Compute compliances with fewer nodes, where their accuracy does not matter: errors of 1e-5."""
    monkeypatch.setattr(plates, "FINE", Fineness(8, 8))
    monkeypatch.setattr(plates, "COARSE", Fineness(6, 6))


def edge_stress(moved: np.ndarray, given: np.ndarray, kolosov: float, degrees: Sequence[float]) -> np.ndarray:
    """Hoop stress of the hole at some angles, from the coefficients of its displacement G v/R and of its traction."""
    one, other = complex_coefficients(moved), complex_coefficients(given)
    order = np.arange(-(len(one) // 2), len(one) // 2 + 1)
    waves = np.exp(1j * np.multiply.outer(np.radians(degrees), order))
    potential = waves @ (2.0 * (order + 1.0) * one - other) / (kolosov + 1.0)
    return np.asarray(4.0 * potential.real + (waves @ other).real)


def mesh_edge(chords: int, side: int = 30) -> np.ndarray:
    """Points on the edge of a lug 4.4 wide and 10 high, counter-clockwise from the start of its round end."""
    nose = 2.2 * np.exp(1j * np.linspace(-np.pi, 0.0, chords + 1))
    up = 10j * np.linspace(0.0, 1.0, side + 1)
    across = np.linspace(2.2, -2.2, 13) + 10j
    return np.concatenate([nose[:-1], 2.2 + up[:-1], across[:-1], -2.2 + up[:0:-1]])


def problem_with(body: Compliance | Ring) -> Problem:
    """A steel pin in a steel plate in plane stress."""
    return Problem.from_load_parameter(
        MaterialPair(Material(2.6, 0.3), Material(2.6, 0.3), plane="stress"), 0.6, 0.3, plate_body=body
    )


def stress_at(
    body: Compliance, z: ArrayLike, loads: tuple[float, float, float] = (0.0, 0.0, 0.0), pulled: bool = True
) -> np.ndarray:
    """(sxx, syy, sxy) at points under t_r = -sin(theta)/pi on the hole, resultant (0, -1), or under loads alone."""
    theta = np.linspace(-math.pi, math.pi, 20001)
    patch = np.column_stack([theta, -np.sin(theta) / math.pi, np.zeros(theta.size)])
    z = np.atleast_1d(np.asarray(z, dtype=complex))
    given = Tractions((patch,) if pulled else ())
    radial, hoop, shear = plate_stress(problem_with(body), given, np.r_[loads, 0.0], np.angle(z), np.abs(z) - 1.0)
    mean, half, turn = 0.5 * (radial + hoop), 0.5 * (radial - hoop) + 1j * shear, (z / np.abs(z)) ** 2
    return np.array([mean + (half * turn).real, mean - (half * turn).real, (half * turn).imag])
