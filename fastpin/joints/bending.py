"""What ties the sections of a pin to one another along x or y: springs between its plates, or a beam."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from fastpin.model.materials import Material

SHEAR = 0.9
"""Coefficient of shear of a solid round section, from its strain energy."""


class RoundBar(NamedTuple):
    """A round pin, solid or hollow, as a bar.

    Attributes
    ----------
    material : Material
    radius : float
        m.
    bore_radius : float
        m; 0 of a solid pin.
    """

    material: Material
    radius: float
    bore_radius: float = 0.0

    @property
    def second_moment(self) -> float:
        """Second moment of area, m^4."""
        return 0.25 * math.pi * (self.radius**4 - self.bore_radius**4)

    @property
    def bending(self) -> float:
        """Moment per curvature, N m^2."""
        return self.material.E * self.second_moment

    @property
    def shear(self) -> float:
        """Force per angle of shear, N.

        The coefficient of a tube is Cowper's for nu = 1/2, which is that of the strain energy for a solid pin. Source:
        G. R. Cowper, "The shear coefficient in Timoshenko's beam theory", J. Appl. Mech. 33 (1966), as usually quoted.
        """
        part = (self.bore_radius / self.radius) ** 2
        coefficient = SHEAR / (1.0 + 2.6 * part / (1.0 + part) ** 2)
        area = math.pi * (self.radius**2 - self.bore_radius**2)
        return coefficient * self.material.shear_modulus * area


class Coherence(NamedTuple):
    """Conditions on the displacements D of the S sections of a pin, and on its forces F on the plates, along one axis.

    They are displacements D + forces F = outside times the force that acts on the pin.

    Attributes
    ----------
    displacements : ndarray, shape (S - 1, S)
    forces : ndarray, shape (S - 1, S)
        m/N.
    outside : ndarray, shape (S - 1,)
        m/N.
    """

    displacements: np.ndarray
    forces: np.ndarray
    outside: np.ndarray

    def scaled(self, factor: float) -> Coherence:
        """The same with other units of force and displacement."""
        return Coherence(self.displacements, factor * self.forces, factor * self.outside)


def springs(flexibilities: Sequence[float]) -> Coherence:
    """A rigid pin with a spring before each further section, m/N. The force on the pin acts on the first section."""
    soft = np.asarray(flexibilities, dtype=float)
    further, count = soft.size, soft.size + 1
    differences = np.eye(further, count) - np.eye(further, count, k=1)
    return Coherence(differences, np.tril(np.ones((further, count))) * soft[:, None], soft)


def beam(bar: RoundBar, edges: Sequence[float], first: int, heads: float) -> Coherence:
    """A round pin as a Timoshenko beam, by the equation of three moments with the deflection by shear.

    Each section loads the pin in its middle. The ends of the pin turn freely, or against the stiffness of its heads.
    Source: S. P. Timoshenko, Strength of Materials, part 1, as usually quoted.

    Parameters
    ----------
    bar : RoundBar
    edges : sequence of float
        Ends of the S sections along the pin, from 0 to its length, m; three sections at least, two with heads.
    first : int
        Number of sections that take the force on the pin: those of its first plate, in equal parts.
    heads : float
        Moment per rotation of each end, N m/rad. 0: the pin tilts freely; infinite: its ends do not turn.
    """
    ends = np.asarray(edges, dtype=float)
    places, length = 0.5 * (ends[1:] + ends[:-1]), float(ends[-1])
    count, span = places.size, np.diff(places)[:, None]
    inertia, shear = bar.bending, bar.shear
    moved, load = np.split(np.eye(2 * count), 2)  # displacements and loads on the pin, by both
    slope = np.diff(moved, axis=0) / span + np.cumsum(load, axis=0)[:-1] / shear  # by bending alone
    moment = np.tril(places[:, None] - places) @ load
    ratio = heads * length / inertia
    held = ratio / (1.0 + ratio) if math.isfinite(ratio) else 1.0
    at_head = held * (slope[0] - span[0] * moment[1] / (6.0 * inertia))
    moment += at_head * inertia / ((1.0 - held) * length + held * (places[0] + 0.5 * span[0]))
    turned = np.vstack([
        np.diff(slope, axis=0)
        - (span[:-1] * moment[:-2] + 2.0 * (span[:-1] + span[1:]) * moment[1:-1] + span[1:] * moment[2:])
        / (6.0 * inertia),
        moment[-1] * ((1.0 - held) * length + held * (length - places[-1])) / inertia
        + held * (slope[-1] + span[-1] * (2.0 * moment[-1] + moment[-2]) / (6.0 * inertia)),
    ])  # fmt: skip
    displacements, forces = np.split(turned * (length / count), 2, axis=1)
    return Coherence(displacements, -forces, -forces[:, :first].mean(axis=1))


def bending_moments(
    bar: RoundBar, edges: Sequence[float], heads: float, loads: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """The moments in a pin of :func:`beam` under the loads on its sections, from these loads alone.

    Between the places they are linear.

    Parameters
    ----------
    bar, edges, heads
        See :func:`beam`.
    loads : ndarray, shape (S, 2)
        Forces on the pin along x and y, N; they are in balance.

    Returns
    -------
    places : ndarray, shape (S + 2,)
        Both ends and the middles of the sections, m.
    moments : ndarray, shape (S + 2, 2)
        By the forces along x and along y, N m.
    """
    ends = np.asarray(edges, dtype=float)
    middles, length = 0.5 * (ends[1:] + ends[:-1]), float(ends[-1])
    places = np.r_[0.0, middles, length]
    ratio = heads * length / bar.bending
    held = ratio / (2.0 + ratio) if math.isfinite(ratio) else 1.0
    lever = length - middles
    at_head = -(0.5 * (1.0 - held) * lever + held * 0.5 * lever**2 / length) @ loads  # both heads turn by their moments
    return places, at_head + np.maximum(places[:, None] - middles, 0.0) @ loads
